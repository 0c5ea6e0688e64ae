// How runs are compared: comparison_test.mjs WEB, where WEB is planner/report/web. The runs are made up.
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const part = (name) => import(pathToFileURL(resolve(process.argv[2], "src", name)).href);
const { bandOf, differences, isWhole, meanOf, meanTo, positionAt, sameWorld, seedGroups, seedsOf } = await part("comparison.js");

/** A run that maps a fifth each `pace` seconds. */
function runOf(name, options, other = {}, pace = 1) {
  const time = [0, 1, 2, 3, 4, 5].map((s) => pace * s), coverage = [0, 0.2, 0.4, 0.6, 0.8, 1];
  const facts = { world: "maze", resolution: 0.3, bounds: [[0, 0, 0], [9, 9, 9]], observable: 100, end: "low_gain", truncated: false, robots: [{ name: "uav" }], options: JSON.stringify({ lockstep: false, latency: 0.1, ...options }), ...other };
  return { name, facts, numbers: { time, coverage } };
}

const said = (...runs) => differences(runs).join("; ");

{ // Runs of one world are those with its name, layout and voxels; the seed of a file's world is no layout.
  const a = runOf("a", { seed: 1 });
  assert.deepEqual(seedsOf(a.facts), { seed: 1, layout: 1 });
  assert.deepEqual(seedsOf(runOf("", { seed: 2, world_seed: 7 }).facts), { seed: 2, layout: 7 });
  assert.deepEqual(seedsOf(runOf("", { seed: 2, world_uri: "file:///w.ply" }).facts), { seed: 2, layout: null });
  assert.ok(sameWorld(a, runOf("b", { seed: 1, team: "2uav" })));
  assert.ok(!sameWorld(a, runOf("b", { seed: 2 })));
  assert.ok(sameWorld(a, runOf("b", { seed: 2, world_seed: 1 })));
  assert.ok(!sameWorld(a, runOf("b", { seed: 1 }, { resolution: 0.2 })));
  assert.ok(!sameWorld(a, runOf("b", { seed: 1 }, { world: "station" })));
  assert.equal(said(a, runOf("b", { seed: 1 })), "");
}
{ // What makes runs unlike each other is said.
  const a = runOf("a", { seed: 1 });
  assert.match(said(a, runOf("b", { seed: 1 }, { world: "station" })), /^the runs are in different worlds \(maze, station\); .* not compared in percent$/);
  assert.match(said(a, runOf("b", { seed: 2 })), /^each seed has another layout of maze;/);
  assert.match(said(a, runOf("b", { seed: 1 }, { resolution: 0.2 })), /^the voxels are not of one size \(0.3 m, 0.2 m\)/);
  assert.match(said(a, runOf("b", { seed: 1 }, { observable: 90 })), /do not count the same space as observable/);
  assert.match(said(a, runOf("b", { seed: 1, lockstep: true })), /^some runs are in motion and others in lock-step/);
  assert.match(said(a, runOf("b", { seed: 1, latency: 0.25 })), /^the clock charges different times for a planning \(0.1 s, 0.25 s\)$/);
  for (const other of [{ end: "stopped" }, { end: null }, { end: "time_limit" }, { end: "cut_off" }, { truncated: true }]) {
    assert.ok(!isWhole(runOf("b", {}, other)));
    assert.match(said(a, runOf("b", { seed: 1 }, other)), /^not all runs went on until the planner ended them \(b did not\)/);
  }
  assert.equal(said(runOf("a", { seed: 1 }, { options: "none" }), runOf("b", { seed: 1 }, { options: "none" })), "");
}
{ // Runs that differ in their seeds only are a group; the same run twice is none.
  const runs = [runOf("a", { seed: 1 }), runOf("b", { seed: 2 }, {}, 2), runOf("c", { seed: 1, goal: "render" }), runOf("d", { world_seed: 4, seed: 3 }, {}, 3), runOf("e", { seed: 1, goal: "render" })];
  assert.deepEqual(seedGroups(runs), [[0, 1, 3]]);
  const group = [0, 1, 3].map((i) => runs[i]);
  assert.deepEqual(meanTo(group, 0.6, "time"), { mean: 6, deviation: 3, count: 3, of: 3 });
  group[2].numbers.coverage = [0, 0.1, 0.1, 0.1, 0.1, 0.1];
  assert.deepEqual(meanTo(group, 0.6, "time"), { mean: 4.5, deviation: Math.sqrt(4.5), count: 2, of: 3 });
  assert.deepEqual(meanOf([5]), { mean: 5, deviation: NaN, count: 1 });
}
{ // A band: the mean over the runs, of which those that are over stay at their end.
  const { xs, mean, low, high } = bandOf([runOf("a", {}), runOf("b", {}, {}, 2)], "time", "coverage");
  assert.deepEqual([xs[0], xs.at(-1), xs.length], [0, 10, 201]);
  const at = xs.findIndex((x) => x >= 4.5 - 1e-9), spread = Math.sqrt(2 * 0.2 ** 2);
  assert.ok(Math.abs(mean[at] - 0.6) < 1e-12 && Math.abs(high[at] - mean[at] - spread) < 1e-12 && Math.abs(mean[at] - low[at] - spread) < 1e-12);
  assert.deepEqual([mean.at(-1), low.at(-1), high.at(-1)], [1, 1, 1]);
  assert.deepEqual(bandOf([runOf("a", {}, {}, 0)], "time", "coverage").xs, [0]);
}
{ // Another run at the same time: the step during which it was, and the part of it that was over.
  assert.deepEqual([0, 1, 2.5, 4, 9].map((time) => positionAt([0, 2, 2, 4], time)), [{ step: 0, along: 1 }, { step: 1, along: 0.5 }, { step: 3, along: 0.25 }, { step: 3, along: 1 }, { step: 3, along: 1 }]);
}
console.log("comparisons are right");
