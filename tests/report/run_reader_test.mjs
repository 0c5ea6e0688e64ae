// What the page reads of a report: run_reader_test.mjs WEB [SECONDS]. Whatever the text, readRun gives a run that
// the page can show, or throws a RunError, in seconds of a processor and within 1 GiB. Replays what once failed, and
// damages of small runs, the same every time; with SECONDS, other damages for so long.
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { setFlagsFromString } from "node:v8";
import { runInNewContext } from "node:vm";
import { deflateSync } from "node:zlib";

const source = (name) => import(pathToFileURL(resolve(process.argv[2], "src", name)).href);
const { RunError } = await source("byte_reader.js");
const { poseAt, readRun } = await source("run_data.js");
const { numbersOf, optionsOf } = await source("run_numbers.js");
const { warnings } = await source("facts_view.js");
const { VoxelStore } = await source("voxel_store.js");
const { VoxelMesher } = await source("voxel_mesher.js");

/** Numbers from 0 to below n, the same for the same seed. */
function dice(seed) {
  let state = seed;
  return (n) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * n);
  };
}

// ---- runs as the report writes them: facts, and lists of numbers

const count = (number) => {
  const bytes = [];
  for (; number >= 128; number = Math.floor(number / 128)) bytes.push((number % 128) + 128);
  return [...bytes, number];
};
const counts = (...numbers) => numbers.flatMap(count);
const f32 = (...numbers) => [...new Uint8Array(new Float32Array(numbers).buffer)];
const BASE64 = (bytes) => Buffer.from(bytes).toString("base64");

function packed(facts, data) {
  const head = Buffer.from(typeof facts === "string" ? facts : JSON.stringify(facts)), length = Buffer.alloc(4);
  length.writeUInt32LE(head.length);
  return Buffer.concat([length, head, Buffer.from(data)]);
}
const textOf = (facts, data) => BASE64(deflateSync(packed(facts, data)));

function factsOf(steps, robots) {
  const robotStep = (r) => ({
    state: "reachable", reason: "", path: "was found by the search", gain_predicted: 2, gained: 1, length: null,
    ...(r === 0 ? { goal: [1, 2, 0.5, 0.25] } : {}),
  });
  const list = (length, of) => Array.from({ length }, (_, i) => of(i));
  return {
    name: "run", written_by: "0.1.0", world: "room", resolution: 0.5, bounds: [[32700, 32700, 32700], [32900, 32900, 32800]],
    observable: 1000, bounding: 2000, options: '{"lockstep": false, "robots": {"a": [1, 2]}}', end: "low_gain", truncated: false,
    phases: ["frontiers", "goals", "moving"],
    measured: {
      clearance_min_m: 0.25, separation_min_m: null, contacts_in_free: 0, warnings: ["too little"], surface_out_of_bounds: 0, unseen: { in_view: 0.01, narrow: 0.1, hidden: 0 }, map: { false_free: 0.02, false_occupied: null, surface_found: 0.9 },
      robots: list(robots, (r) => ({ idle_s: 1.5, held_back: r, narrow_by_m: 0.15, in_view_then: 0.06, without_min_height: 0, goal: "no goal" })),
    },
    robots: list(robots, (r) => ({ name: `robot ${r}`, plane: r === 0, extents: [1, 1, 0.5], sensor_height: 0.7, shape: "cone", horizontal: 1, vertical: 1, max_range: 9, columns: 16, rows: 8, colors: ["#0072b2", "#56b4e9"], start: [0, 0, 1, 0] })),
    steps: list(steps, (s) => ({ number: s, time: s / 2, frontiers: 5, unassigned: 1, abandoned: 0, rays: 9, contacts: 0, seconds: [0.1, 0.2, 3], known: list(robots, () => [s, 2 * s]), robots: list(robots, robotStep) })),
  };
}

function dataOf(steps, robots, roll) {
  const bytes = [];
  for (let block = 0; block < steps * robots; ++block) {
    const groups = roll(3), cells = roll(4), poses = roll(4);
    bytes.push(...counts(groups));
    for (let g = 0; g < groups; ++g) {
      const voxels = 1 + roll(5);
      bytes.push(...counts(1022 + roll(4), 1022 + roll(4), 1023, voxels));
      for (let i = 0; i < voxels; ++i) bytes.push(...counts(4 * roll(6000) + roll(3)));
    }
    bytes.push(...counts(cells));
    if (cells > 0) {
      bytes.push(...f32(4, 2));
      for (let axis = 0; axis < 3; ++axis) for (let i = 0; i < cells; ++i) bytes.push(...counts(i === 0 ? 2 * 32768 : roll(9)));
      for (let i = 0; i < 2 * cells; ++i) bytes.push(roll(256));
    }
    bytes.push(...counts(poses, roll(poses + 1)));
    for (let i = 0; i < poses; ++i) bytes.push(...f32(i, roll(9), 1, i / 2));
    const stops = roll(3);
    bytes.push(...counts(stops));
    for (let i = 0; i < stops; ++i) bytes.push(...f32(i, roll(9), 2, i / 3), ...counts(1 + roll(3), roll(300)));
    const points = roll(4), keys = roll(4);
    bytes.push(...counts(points), ...f32(...Array.from({ length: 3 * points }, () => roll(9))), ...counts(keys));
    for (let axis = 0; axis < 3; ++axis) for (let i = 0; i < keys; ++i) bytes.push(...counts(i === 0 ? 2 * 32768 : roll(9)));
  }
  return bytes;
}

// ---- damages

const WILD = [null, -1, 0, 1e300, 2 ** 31, 0.5, "", "text", true, [], {}, [[]], { length: 1e9 }];

/** Some member of the facts replaced, left out, or doubled. */
function damagedFacts(facts, roll) {
  const copy = structuredClone(facts), places = [];
  const visit = (value) => {
    if (typeof value !== "object" || value === null) return;
    for (const name of Object.keys(value)) {
      places.push([value, name]);
      visit(value[name]);
    }
  };
  visit(copy);
  for (let times = roll(3); times >= 0; --times) {
    const [owner, name] = places[roll(places.length)], kind = roll(4);
    if (kind === 0) delete owner[name];
    else if (kind === 1 && Array.isArray(owner)) owner.push(owner[name]);
    else owner[name] = WILD[roll(WILD.length)];
  }
  return copy;
}

function damagedBytes(bytes, roll) {
  let out = Buffer.from(bytes);
  for (let times = roll(4); times >= 0 && out.length > 0; --times) {
    const at = roll(out.length), kind = roll(5);
    if (kind === 0) out[at] = roll(256);
    else if (kind === 1) out[at] ^= 1 << roll(8);
    else if (kind === 2) out = Buffer.concat([out.subarray(0, at), out.subarray(at + 1 + roll(9))]);
    else if (kind === 3) out = Buffer.concat([out.subarray(0, at), Buffer.alloc(1 + roll(9), 255), out.subarray(at)]);
    else out = out.subarray(0, at);
  }
  return out;
}

/** What the page computes of a run before it draws. */
function use(run) {
  run.numbers = numbersOf(run.facts);
  optionsOf(run.facts);
  const store = new VoxelStore(run), mesher = new VoxelMesher(store, run.facts.bounds), out = [0, 0, 0, 0];
  warnings(run);
  for (const step of [run.steps - 1, -1, run.steps >> 1]) {
    store.seek(step);
    for (let r = 0; step >= 0 && r < run.robots; ++r) poseAt(run, step, r, 0.4, out);
  }
  for (let c = 0; c < Math.min(9, run.chunks.length); ++c) mesher.make(c);
  store.at(32768, 32768, 32768);
}

setFlagsFromString("--expose-gc");
const collectGarbage = runInNewContext("gc");

/** Of this process [ms]: other processes may keep it waiting. */
const worked = () => (process.cpuUsage().user + process.cpuUsage().system) / 1000;

let inputs = 0, readable = 0, slowest = 0, largest = 0;

async function read(text, what) {
  if (inputs++ % 1000 === 0 || text.length > 10000) collectGarbage(); // what was left of inputs before is not this one's
  const began = worked();
  try {
    use(await readRun(text));
    ++readable;
  } catch (error) {
    assert.ok(error instanceof RunError && error.message.length < 400, `${what}: ${error.stack}\n${text.length < 3000 ? text : text.length}`);
  }
  slowest = Math.max(slowest, worked() - began);
  largest = Math.max(largest, process.memoryUsage().rss);
  assert.ok(slowest < 10000, `${what}: ${slowest} ms`);
  assert.ok(largest < 2 ** 30, `${what}: ${largest} bytes`);
}

async function refused(text, message) {
  await assert.rejects(readRun(text), (error) => error instanceof RunError && message.test(error.message), String(message));
  await read(text, String(message));
}

// ---- good runs

{
  const roll = dice(1), run = await readRun(textOf(factsOf(2, 1), [
    ...counts(1, 1024, 1023, 7, 2, 4 * 33 + 1, 4 * 2 + 2), ...counts(1), ...f32(8, 4), ...counts(65536, 65534, 0), 9, 255, ...counts(2, 1), ...f32(1, 2, 3, 4, 5, 6, 7, 8),
    ...counts(1), ...f32(9, 10, 11, 12), ...counts(2, 300),
    ...counts(2), ...f32(1, 2, 3, 4, 5, 6), ...counts(2, 10, 2, 20, 1, 0, 0), ...counts(0, 0, 0, 0, 0, 0, 0)]));
  assert.deepEqual([[...run.locals], [...run.states], [...run.begins], [...run.blocks]], [[33, 35], [1, 2], [0, 2], [0, 1, 1]]);
  assert.deepEqual([...run.chunks.corners.items.subarray(0, 3)], [32768, 32736, 224]);
  assert.deepEqual([run.images[0].x[0], run.images[0].y[0], run.images[0].z[0], run.images[0].gain[0], run.images[0].quality[0]], [32768, 32767, 0, 9, 255]);
  assert.deepEqual([...run.poses], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
  assert.deepEqual(run.tours, Array(2).fill({ begin: 8, count: 1, clusters: [2], frontiers: [300] }), "a tour holds until the next planning");
  assert.deepEqual([run.trajectories.map((points) => points && [...points]), run.reassigned.map((keys) => keys.map((axis) => [...axis]))], [[[1, 2, 3, 4, 5, 6], null], [[[5, 6], [10, 9], [0, 0]], [[], [], []]]]);
  for (let i = 0; i < 20; ++i) use(await readRun(textOf(factsOf(3, 2), dataOf(3, 2, roll))));
}

// ---- what failed, or took too much, before the reader checked it

const one = factsOf(1, 1), huge = 2 ** 45;
await refused("", /decompressed/);
await refused("%", /base64/);
await refused(BASE64(deflateSync(Buffer.alloc(0))), /too early/);
await refused(BASE64(deflateSync(Buffer.from([255, 255, 255, 255, 1]))), /too early/);
for (const facts of ["", "null", "[]", "{", "[".repeat(1e6)]) await refused(textOf(facts, []), /facts/);
for (const [name, value] of [["robots", { length: 1e9 }], ["steps", null], ["robots", []], ["resolution", 0], ["options", {}], ["phases", ["a"]], ["bounds", [[1, 2, 3]]], ["measured", {}], ["measured", { ...one.measured, robots: [] }], ["measured", { ...one.measured, unseen: null }]])
  await refused(textOf({ ...one, [name]: value }, counts(0, 0, 0, 0, 0)), /robots|steps|resolution|options|phases|bounds|seconds|measured/);
await refused(textOf(one, []), /too early/);
await refused(textOf(one, counts(huge)), /too early/);
await refused(textOf(one, counts(1, 2048, 0, 0, 0)), /place of a chunk is 2048/);
await refused(textOf(one, counts(1, 0, 0, 0, 1, 4 * 32768)), /place of a voxel/);
await refused(textOf(one, counts(1, 0, 0, 0, 1, 3)), /state is 3/);
await refused(textOf(one, counts(0, huge)), /too early/); // an image of so many cells
await refused(textOf(one, [...counts(0, 1), ...f32(1, 1), ...counts(2 * 65536, 0, 0, 0, 0, 0, 0)]), /key of a voxel/);
await refused(textOf(one, counts(0, 0, huge, 0)), /too early/); // a path of so many poses
await refused(textOf(one, counts(0, 0, 0, 1)), /travelled/);
await refused(textOf(one, counts(0, 0, 0, 0, huge)), /too early/); // a tour of so many stops
await refused(textOf(one, counts(0, 0, 0, 0, 0, huge)), /too early/); // a trajectory of so many points
await refused(textOf(one, counts(0, 0, 0, 0, 0, 0, huge)), /too early/); // so many frontiers that change hands
await refused(textOf(one, counts(0, 0, 0, 0, 0, 0, 1, 1, 0, 0)), /key of a voxel is -1/);
await refused(textOf(one, counts(0, 0, 0, 0, 0, 0, 0, 0)), /after the last step/);
await refused(textOf(one, [0, ...Array(3000).fill(255)]), /too early/);
{ // Few bytes that become many: data, facts, cubes. Each was more than a gigabyte, or near it.
  await refused(textOf(one, new Uint8Array(80e6)), /more than \d+ bytes/);
  await refused(textOf(`[${"{},".repeat(5e6)}0]`, []), /facts/);
  const spread = (groups) => [...counts(groups), ...Array.from({ length: groups }, (_, i) => counts(2 * (i & 1023), (i >> 10) * 2, 7, 1, 1)).flat(), 0, 0, 0, 0, 0, 0];
  await refused(textOf(one, spread(40000)), /more than 32768 cubes/);
  await read(textOf(one, spread(11000)), "cubes apart"); // 100 kB of them
  const most = 2 ** 22, handed = async (count) => (await readRun(textOf(one, Buffer.concat([Buffer.from(counts(0, 0, 0, 0, 0, 0, count)), Buffer.alloc(3 * count)])))).reassigned[0][0].length;
  assert.deepEqual([await handed(most), await handed(most + 1)], [most, 0], "of too many frontiers that change hands none has a robot");
}

// ---- damages

const seconds = Number(process.argv[3] ?? 0), end = performance.now() + 1000 * seconds;
const rounds = process.env.FRONTLUX_LONG === "1" ? 3000 : 300;
const seeds = seconds > 0 ? [Date.now() % 1e9] : [1];
console.log(`seed ${seeds[0]}`);
const roll = dice(seeds[0]);
for (let i = 0; seconds > 0 ? performance.now() < end : i < rounds; ++i) {
  const steps = 1 + roll(3), robots = 1 + roll(2), facts = factsOf(steps, robots), data = dataOf(steps, robots, roll);
  const kind = roll(8);
  const text = kind === 0 ? damagedBytes(textOf(facts, data), roll).toString("latin1")
    : kind === 1 ? BASE64(damagedBytes(deflateSync(packed(facts, data)), roll))
    : kind === 2 ? BASE64(deflateSync(damagedBytes(packed(facts, data), roll)))
    : kind < 5 ? textOf(damagedFacts(facts, roll), data)
    : textOf(facts, damagedBytes(data, roll));
  await read(text, `damage ${i} of seed ${seeds[0]}`);
}
assert.ok(readable > inputs / 20, `only ${readable} of ${inputs} can be read`);
console.log(`${inputs} inputs read, ${readable} of them as runs; the slowest took ${Math.round(slowest)} ms, the largest process ${Math.round(largest / 2 ** 20)} MiB`);
