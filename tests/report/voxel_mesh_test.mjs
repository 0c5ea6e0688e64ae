// What the page draws after going on and back by changes is what it draws of the same map at once, and both are
// what a look at every voxel says: voxel_mesh_test.mjs WEB. Random runs of few changes, most at chunks' borders.
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const source = (name) => import(pathToFileURL(resolve(process.argv[2], "src", name)).href);
const { CHUNK, ChunkTable } = await source("run_data.js");
const { VoxelStore } = await source("voxel_store.js");
const { VoxelMesher } = await source("voxel_mesher.js");

const kBase = 32768 - CHUNK, kSteps = 24, kRobots = 2;
const kSides = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];

/** Numbers from 0 to below n, the same for the same seed. */
function dice(seed) {
  let state = seed;
  return (n) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * n);
  };
}

/** With the robot if it was without, and without it if it was with it. */
const turnedOver = (robots, r) => (robots.includes(r) ? robots.filter((other) => other !== r) : [...robots, r]);

/** A run in the shape that readRun gives, and the map at the end of each step. */
function makeRun(seed) {
  const roll = dice(seed), chunks = new ChunkTable(), maps = [];
  const run = { robots: kRobots, steps: kSteps, chunks, groups: [], begins: [], blocks: [], locals: [], states: [], reassigned: [] };
  const map = new Map(), owned = new Map(); // the robots, by voxel, whose frontier it is
  const edge = () => kBase + [0, 15, 30, 31, 32, 33, 63][roll(7)];
  for (let block = 0; block < kSteps * kRobots; ++block) {
    run.blocks.push(run.groups.length);
    const changes = new Map();
    for (let i = roll(6); i >= 0; --i) changes.set([edge(), edge(), edge()].join(), roll(8) === 0 ? 0 : 1 + roll(2));
    for (const [name, state] of changes) {
      const key = name.split(",").map(Number);
      run.groups.push(chunks.number(...key.map((k) => k >> 5)));
      run.begins.push(run.locals.length);
      run.locals.push((key[0] & 31) | ((key[1] & 31) << 5) | ((key[2] & 31) << 10));
      run.states.push(state);
      const old = map.get(name), owner = old?.state ? old.owner : block % kRobots;
      map.set(name, { state, owner });
    }
    const turned = new Set(Array.from({ length: roll(40) }, () => [edge() + roll(3) - 1, edge(), edge()].join()));
    for (const name of turned) owned.set(name, turnedOver(owned.get(name) ?? [], block % kRobots));
    run.reassigned.push([0, 1, 2].map((k) => [...turned].map((name) => Number(name.split(",")[k]))));
    if (block % kRobots === kRobots - 1) maps.push({ voxels: new Map(map), owned: new Map(owned) });
  }
  run.blocks.push(run.groups.length);
  run.begins.push(run.locals.length);
  return { run, maps };
}

/** What is drawn of a chunk: faces and frontiers, a voxel each, as sorted text. */
function drawn(mesher, corner) {
  const out = [];
  for (let f = 0; f < mesher.faces; ++f) {
    const at = (corner_, k) => mesher.corners[16 * f + 4 * corner_ + k], tag = at(0, 3), axis = (tag % 6) >> 1;
    const low = [0, 1, 2].map((k) => Math.min(at(0, k), at(2, k))), high = [0, 1, 2].map((k) => Math.max(at(0, k), at(2, k)));
    const side = tag % 6, inside = side & 1 ? -1 : 0; // the voxel behind the face
    const range = (k) => (k === axis ? [low[k] + inside] : Array.from({ length: high[k] - low[k] }, (_, i) => low[k] + i));
    for (const x of range(0)) for (const y of range(1)) for (const z of range(2)) out.push(`face ${[corner[0] + x, corner[1] + y, corner[2] + z]} ${side} ${Math.floor(tag / 6)}`);
    // Counter-clockwise as seen from the side that it looks to.
    const u = [0, 1, 2].map((k) => at(1, k) - at(0, k)), v = [0, 1, 2].map((k) => at(2, k) - at(1, k));
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    assert.ok(normal[axis] * (side & 1 ? 1 : -1) > 0, "a face has the wrong orientation");
  }
  for (let i = 0; i < mesher.frontiers; ++i) out.push(`frontier ${[0, 1, 2].map((k) => corner[k] + mesher.points[4 * i + k])} of ${mesher.points[4 * i + 3]}`);
  return out.sort();
}

/** The same by a look at every voxel of the map. */
function expected({ voxels: map, owned }, bounds, cut, closed) {
  const out = [], state = (key) => map.get(key.join())?.state ?? 0;
  const frontiers = new Set();
  for (const [name, { state: here, owner }] of map) {
    const key = name.split(",").map(Number);
    kSides.forEach((side, s) => {
      const next = key.map((k, i) => k + side[i]), there = state(next), opened = next[2] >= cut;
      if (here === 2 && key[2] < cut && (opened || there === 1 || (closed && there === 0))) out.push(`face ${key} ${s} ${owner + 1}`);
      if (here === 1 && there === 0 && next[2] < cut && next.every((k, i) => k >= bounds[0][i] && k <= bounds[1][i])) frontiers.add(`frontier ${next} of ${owned.get(next.join())?.length === 1 ? owned.get(next.join())[0] + 1 : 0}`);
    });
  }
  return [...out, ...frontiers].sort();
}

let compared = 0;
for (let seed = 1; seed <= (process.env.FRONTLUX_LONG === "1" ? 40 : 6); ++seed) {
  const { run, maps } = makeRun(seed), roll = dice(seed + 1000);
  const bounds = [[kBase - 1, kBase, kBase], [kBase + 63, kBase + 64, kBase + 40]];
  const store = new VoxelStore(run), mesher = new VoxelMesher(store, bounds);
  mesher.closed = seed % 3 === 0;
  if (seed % 4 === 0) mesher.cut = kBase + [31, 32, 33, 64][roll(4)];
  const shown = store.chunks.map(() => []);
  for (let visit = 0; visit < 20; ++visit) {
    const step = visit % 3 === 0 ? roll(kSteps + 1) - 1 : Math.min(kSteps - 1, Math.max(-1, store.step + roll(3) - 1));
    store.seek(step);
    store.dirty.forEach((dirty, c) => {
      if (!dirty) return;
      mesher.make(c);
      shown[c] = drawn(mesher, run.chunks.corners.items.subarray(3 * c, 3 * c + 3));
    });
    store.dirty.fill(0);
    const all = shown.flat().sort(), wanted = step < 0 ? [] : expected(maps[step], bounds, mesher.cut, mesher.closed);
    assert.deepEqual(all, wanted, `seed ${seed}, visit ${visit}, step ${step}`);
    compared += all.length;
  }
}
assert.ok(compared > 10000, `only ${compared} faces and frontiers compared`);
console.log(`${compared} faces and frontiers are as they should be`);
