import { ByteReader, RunError, damaged } from "./byte_reader.js";
import { readFacts } from "./run_facts.js";
import { inMotion } from "./run_numbers.js";

export const CHUNK = 32; // edge of a chunk in voxels; src/run_data.cpp cuts them
export const UNKNOWN = 0, FREE = 1, OCCUPIED = 2;
const MOST_REASSIGNED = 2 ** 22; // frontiers, in all steps: Assignment takes some 50 bytes for each
const MOST_CHUNKS = 2 ** 15; // VoxelStore takes 32 KiB for each
const INFLATED = 2 ** 24, TIMES = 100; // bytes that the data may take: so many, and this many for each packed one

/** A growing list of numbers in one typed array. */
class Pool {
  constructor(Type) {
    this.items = new Type(4096);
    this.length = 0;
  }
  push(number) {
    if (this.length === this.items.length) {
      const larger = new this.items.constructor(2 * this.length);
      larger.set(this.items);
      this.items = larger;
    }
    this.items[this.length++] = number;
  }
  done() {
    return this.items.slice(0, this.length);
  }
}

/** From base64 of zlib's format, whose checksum is checked. */
async function inflate(text) {
  let binary;
  try {
    binary = atob(text);
  } catch {
    throw damaged("they are not in base64");
  }
  const packed = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) packed[i] = binary.charCodeAt(i);
  const parts = [], most = INFLATED + TIMES * packed.length;
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate")).getReader();
  let length = 0;
  for (;;) {
    const { done, value } = await stream.read().catch(() => {
      throw damaged("they cannot be decompressed");
    });
    if (done) break;
    parts.push(value);
    length += value.length;
    if (length > most) {
      stream.cancel().catch(() => {});
      throw damaged(`they take more than ${most} bytes`);
    }
  }
  const bytes = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

/** The cubes of voxels that a run touches, by number. */
export class ChunkTable {
  constructor() {
    this.numbers = new Map();
    this.corners = new Pool(Int32Array); // x, y, z of each chunk's lowest voxel, as keys
  }
  get length() {
    return this.corners.length / 3;
  }
  /** Adds the chunk if it is new. */
  number(x, y, z) {
    const name = (x * 4096 + y) * 4096 + z;
    let number = this.numbers.get(name);
    if (number === undefined) {
      number = this.numbers.size;
      this.numbers.set(name, number);
      for (const k of [x, y, z]) this.corners.push(k * CHUNK);
    }
    return number;
  }
  /** Of the chunk that holds these keys; -1 if there is none. */
  find(x, y, z) {
    return this.numbers.get(((x >> 5) * 4096 + (y >> 5)) * 4096 + (z >> 5)) ?? -1;
  }
}

/**
 * A run as the page needs it. Changes are in groups of one chunk each; the groups of step s and robot r are
 * those from blocks[s * robots + r] to the next one, and the changes of group g those from begins[g] on.
 * Throws a RunError, and nothing else, if the text is not what src/run_data.cpp and src/run_facts.cpp wrote.
 */
export async function readRun(text) {
  const reader = new ByteReader(await inflate(text));
  const facts = readFacts(new TextDecoder().decode(reader.take(reader.u32())));
  const robots = facts.robots.length, steps = facts.steps.length;
  const chunks = new ChunkTable();
  const groups = new Pool(Int32Array), begins = new Pool(Int32Array), blocks = new Pool(Int32Array);
  const locals = new Pool(Uint16Array), states = new Pool(Uint8Array);
  const poses = new Pool(Float32Array);
  const motion = inMotion(facts);
  const images = [], paths = [], tours = [], trajectories = [], reassigned = [];
  let assignments = 0;
  for (let block = 0; block < steps * robots; ++block) {
    blocks.push(groups.length);
    for (let left = reader.count(); left > 0; --left) {
      const [x, y, z] = [0, 1, 2].map(() => reader.below(65536 / CHUNK, "the place of a chunk"));
      groups.push(chunks.number(x, y, z));
      if (chunks.length > MOST_CHUNKS) throw new RunError(`the run's map lies in more than ${MOST_CHUNKS} cubes of ${CHUNK} voxels a side, which is more than a page can hold. Explore in larger voxels or smaller bounds.`);
      begins.push(locals.length);
      let local = 0;
      for (let voxels = reader.count(); voxels > 0; --voxels) {
        const change = reader.below(4 * (CHUNK ** 3 - local), "the place of a voxel");
        if ((change & 3) > OCCUPIED) throw damaged("a voxel's state is 3");
        local += change >> 2;
        locals.push(local);
        states.push(change & 3);
      }
    }
    images.push(readImage(reader));
    const count = reader.count(), travelled = reader.below(count + 1, "the travelled part of a path");
    reader.need(count, 16);
    paths.push({ begin: poses.length, count, travelled });
    for (let i = 0; i < 4 * count; ++i) poses.push(reader.f32());
    tours.push(readTour(reader, poses));
    trajectories.push(readTrajectory(reader));
    const keys = reader.count();
    reassigned.push(readKeys(reader, keys));
    assignments += keys;
  }
  if (reader.at !== reader.bytes.length) throw damaged("there is something after the last step");
  blocks.push(groups.length);
  begins.push(locals.length);
  if (assignments > MOST_REASSIGNED) reassigned.fill([[], [], []]); // frontiers without their robots
  if (motion) for (const list of [images, tours]) hold(facts, list);
  return {
    facts, motion, steps, robots, chunks, images, paths, tours, trajectories, reassigned,
    groups: groups.done(), begins: begins.done(), blocks: blocks.done(),
    locals: locals.done(), states: states.done(), poses: poses.done(),
    size: reader.bytes.length,
  };
}

/** Robots in motion plan one at a time: the image or tour of a robot's planning holds for as long as it has a goal. */
function hold(facts, list) {
  const robots = facts.robots.length;
  for (let i = robots; i < list.length; ++i)
    if (facts.steps[Math.floor(i / robots)].robots[i % robots].goal) list[i] ??= list[i - robots];
}

/** Points x, y, z of the trajectory that a robot in motion planned; null if it planned none. */
function readTrajectory(reader) {
  const count = reader.count();
  reader.need(count, 12);
  const points = Float32Array.from({ length: 3 * count }, () => reader.f32());
  return count > 1 ? points : null;
}

/** Keys x, y, z of so many voxels, each in an array. */
function readKeys(reader, count) {
  reader.need(count, 3);
  return [0, 1, 2].map(() => {
    const keys = new Uint16Array(count);
    let key = 0;
    for (let i = 0; i < count; ++i) {
      key += reader.difference();
      if (!(key >= 0 && key < 65536)) throw damaged(`the key of a voxel is ${key}`);
      keys[i] = key;
    }
    return keys;
  });
}

/** The stops of a planned tour; null if there are none. */
function readTour(reader, poses) {
  const count = reader.count();
  if (count === 0) return null;
  reader.need(count, 18);
  const tour = { begin: poses.length, count, clusters: [], frontiers: [] };
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < 4; ++k) poses.push(reader.f32());
    tour.clusters.push(reader.count());
    tour.frontiers.push(reader.count());
  }
  return tour;
}

function readImage(reader) {
  const count = reader.count();
  if (count === 0) return null;
  reader.need(count, 5);
  const gainMost = reader.f32(), qualityMost = reader.f32();
  const axes = readKeys(reader, count);
  return { count, gainMost, qualityMost, x: axes[0], y: axes[1], z: axes[2], gain: reader.take(count), quality: reader.take(count) };
}

/** Where robot `r` is at the end of step `s` or, along < 1, while it moves there: [x, y, z, yaw] into `out`. */
export function poseAt(run, s, r, along, out) {
  const path = run.paths[s * run.robots + r];
  const moves = path.travelled > 0;
  if (!moves) {
    for (let before = s - 1; before >= 0; --before) {
      const earlier = run.paths[before * run.robots + r];
      if (earlier.travelled > 0) return copyPose(run, earlier, earlier.travelled - 1, out);
    }
    const start = run.facts.robots[r].start ?? [0, 0, 0, 0];
    for (let i = 0; i < 4; ++i) out[i] = start[i];
    return out;
  }
  if (along >= 1 || path.travelled === 1) return copyPose(run, path, path.travelled - 1, out);
  const reached = Math.max(0, along) * (path.travelled - 1), from = Math.floor(reached), fraction = reached - from;
  const a = path.begin + 4 * from;
  for (let i = 0; i < 3; ++i) out[i] = run.poses[a + i] * (1 - fraction) + run.poses[a + 4 + i] * fraction;
  let turn = run.poses[a + 7] - run.poses[a + 3];
  turn -= 2 * Math.PI * Math.round(turn / (2 * Math.PI));
  out[3] = run.poses[a + 3] + fraction * turn;
  return out;
}

function copyPose(run, path, i, out) {
  for (let k = 0; k < 4; ++k) out[k] = run.poses[path.begin + 4 * i + k];
  return out;
}
