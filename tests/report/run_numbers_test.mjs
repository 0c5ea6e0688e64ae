// The numbers, warnings and times that the page makes of a run: run_numbers_test.mjs WEB, where WEB is
// planner/report/web. The runs are made up; what is expected is written down here, or found by search.
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const part = (name) => import(pathToFileURL(resolve(process.argv[2], "src", name)).href);
const { clockTime, cubicMetres, lastUpTo, numbersOf, percent, stepOfCoverage } = await part("run_numbers.js");
const { ending, warnings } = await part("facts_view.js");
const { Timeline } = await part("timeline.js");
const { placeText, readPlace } = await part("place.js");

/** Of two robots; a step is [time, known of each, length of each, who plans (-1: all)]. */
function factsOf(rows, other = {}) {
  const robot = (r, length, plans) => ({ gain_predicted: plans ? 10 * (r + 1) : 0, gained: 1, length, path: plans ? "was found by the search" : "has no length: start and goal are the same point" });
  return {
    observable: 1000, bounding: 2000, resolution: 0.5, options: '{"lockstep": false}', end: "low_gain", truncated: false,
    phases: ["frontiers", "caster", "goals", "paths", "optimization", "moving"], robots: [{ name: "a" }, { name: "b" }],
    steps: rows.map(([time, known, lengths, plans], number) => ({
      number, time, frontiers: plans === undefined ? 0 : 7 + number, unassigned: 1, abandoned: 2, rays: 0, contacts: 0,
      seconds: plans === undefined ? [0.1, 0, 0, 0, 0, 0] : [0.1, 0, 0.2, 0, 0, 9], known: known.map((voxels) => [voxels, 2 * voxels]),
      robots: lengths.map((length, r) => robot(r, length, plans === r || plans === -1)),
    })),
    ...other,
  };
}

const RUN = [
  [0, [0, 0], [0, 0], undefined], [0, [10, 0], [0, 0], 0], [0, [10, 20], [0, 0], 1], [2.5, [300, 200], [3, 1], 0],
  [4, [400, 500], [1, 2.5], 1], [7.25, [440, 512], [0, 4], 0], [9, [450, 545], [2, 0.5], undefined],
];

{
  const numbers = numbersOf(factsOf(RUN));
  assert.equal(numbers.motion, true);
  assert.equal(numbers.clock, true);
  assert.deepEqual(numbers.time, [0, 0, 0, 2.5, 4, 7.25, 9]);
  assert.deepEqual(numbers.coverage, [0, 0.01, 0.03, 0.5, 0.9, 0.952, 0.995]);
  assert.deepEqual(numbers.teamTravelled, [0, 0, 0, 4, 7.5, 11.5, 14]);
  assert.deepEqual(numbers.travelled, [[0, 0, 0, 3, 4, 4, 6], [0, 0, 0, 1, 3.5, 7.5, 8]]);
  assert.deepEqual(numbers.volume, [0, 10, 30, 500, 900, 952, 995].map((voxels) => 2 * voxels * 0.125));
  assert.deepEqual(numbers.robotVolume[1], [0, 0, 20, 200, 500, 512, 545].map((voxels) => 2 * voxels * 0.125));
  // A robot's expected gain holds until it plans again, and what was counted at a planning until the next one.
  assert.deepEqual(numbers.predicted, [[0, 10, 10, 10, 10, 10, 10], [0, 0, 20, 20, 20, 20, 20]]);
  assert.deepEqual(numbers.frontiers, [0, 8, 9, 10, 11, 12, 12]);
  assert.deepEqual([0.5, 0.9, 0.95, 0.99, 1].map((part) => stepOfCoverage(numbers, part)), [3, 4, 5, 6, -1]);
  const { result } = numbers;
  assert.deepEqual([result.time, result.length, result.volume, result.steps], [9, 14, 248.75, 6]);
  assert.ok(Math.abs(result.planningMost - 0.3) < 1e-12 && Math.abs(result.planningMean - 0.3) < 1e-12);
  assert.equal(result.plannings, 5, "in the last step nobody plans");
}
{ // In lock-step, or if nothing is said, each step is as it is.
  for (const options of ['{"lockstep": true}', "{}", "none", "null", "[1]"]) {
    const numbers = numbersOf(factsOf(RUN, { options }));
    assert.equal(numbers.motion, false, options);
    assert.deepEqual(numbers.predicted[0], [0, 10, 0, 10, 0, 10, 0]);
    assert.deepEqual(numbers.frontiers, [0, 8, 9, 10, 11, 12, 0]);
  }
}
{ // Without a clock a step stands for itself; a time that is missing or goes back is the one before.
  const numbers = numbersOf(factsOf(RUN.map(([, ...rest]) => [0, ...rest])));
  assert.equal(numbers.clock, false);
  assert.deepEqual(numbers.time, [0, 1, 2, 3, 4, 5, 6]);
  assert.ok(Number.isNaN(numbers.result.time));
  const times = [0, 1, null, 0.5, 3, 3, 4];
  assert.deepEqual(numbersOf(factsOf(RUN.map(([, ...rest], s) => [times[s], ...rest]))).time, [0, 1, 1, 1, 3, 3, 4]);
}
{ // A warning for what nobody asked for, and for nothing else.
  const said = (end, steps, truncated = false) => {
    const facts = factsOf(RUN.slice(0, steps), { end, truncated });
    return warnings({ facts, numbers: numbersOf(facts) }).length;
  };
  for (const end of ["low_gain", "nothing_to_do"]) assert.deepEqual([said(end, 5), said(end, 6), said(end, 7)], [1, 0, 0], end);
  for (const end of ["time_limit", "coverage", "step_limit", "stopped"]) assert.deepEqual([said(end, 5), said(end, 7)], [0, 0], end);
  assert.deepEqual([said(null, 5), said(null, 7)], [1, 1], "a run that was killed");
  assert.deepEqual([said("cut_off", 5), said("cut_off", 7), said("time_limit", 7, true)], [1, 1, 1]);
}
{ // Plannings that take longer than the clock charges; in lock-step nobody moves meanwhile.
  const result = (options, measured) => numbersOf(factsOf(RUN, { options: JSON.stringify(options), measured })).result;
  const said = (options) => warnings({ facts: factsOf(RUN, { options: JSON.stringify(options) }), numbers: { result: result(options) } });
  assert.match(said({ lockstep: false, latency: 0.25 }).join(), /up to 300 ms, and 250 ms are charged/);
  for (const options of [{ lockstep: false, latency: 0.31 }, { lockstep: true, latency: 0.25 }, { lockstep: false }, { lockstep: false, latency: "0.1" }]) assert.deepEqual(said(options), [], JSON.stringify(options));
  // What only run.json knows.
  const measured = { clearance_min_m: 0.125, separation_min_m: null, idle: [1.5, null], held_back: [0, 3] }, shown = result({ lockstep: false, latency: 0.25 }, measured);
  assert.deepEqual([shown.latency, shown.clearance, shown.separation, shown.idle, shown.heldBack, shown.bumpers], [0.25, 0.125, NaN, [1.5, NaN], [0, 3], true]);
  assert.deepEqual([result({}, null).clearance, result({}).idle, result({ bumper: false }).bumpers], [NaN, [NaN, NaN], false]);
  assert.match(ending(factsOf(RUN)), /plannings/);
  assert.match(ending(factsOf(RUN, { options: "{}" })), /steps/);
}
{
  const list = [0, 0, 1, 1, 1, 2.5, 7];
  for (const x of [-1, 0, 0.5, 1, 2, 2.5, 6.9, 7, 8]) assert.equal(lastUpTo(list, x), Math.max(0, list.findLastIndex((value) => value <= x)), `up to ${x}`);
  assert.equal(clockTime(1200.59), "1200.6 s");
  assert.equal(clockTime(NaN), "unknown");
  assert.equal(cubicMetres(1234.5), "1,235 m³");
  assert.equal(cubicMetres(9.96), "10.0 m³");
  assert.equal(percent(0.9999), "99.9 %");
}
{ // What is shown comes back from its link, also where several steps end at the same time, or one a little after another.
  const times = [0, 0, 0, 2.5, 1 / 3 + 2.5, 2.8334, 4, 4, 7.25];
  for (const along of [1, 0.4])
    times.forEach((_, step) => {
      const from = new Timeline(times), to = new Timeline(times);
      Object.assign(from, { step, along: times[step] > (times[step - 1] ?? 0) ? along : 1 });
      const link = placeText({ time: from.time, step: from.along === 1 ? step : null, run: 0 }), place = readPlace(link);
      to.seekTime(place.time, place.step);
      assert.equal(to.step, step, link);
      assert.ok(Math.abs(to.along - from.along) < 1e-9, link);
    });
  const elsewhere = new Timeline([0, 3, 5]); // a link to a run that is not this one any more: the moment counts
  elsewhere.seekTime(4, 1);
  assert.deepEqual(elsewhere.position, { step: 2, along: 0.5 });
}
{ // It plays by the clock: at 2 seconds of the run in a second, and so fast that a frame passes several steps.
  let frame = null, now = 1000;
  globalThis.requestAnimationFrame = (tick) => (frame = tick);
  const { performance } = globalThis;
  Object.defineProperty(globalThis, "performance", { value: { now: () => now }, configurable: true });
  const times = [0, 0, 0, 2.5, 4, 7.25, 9];
  for (const [speed, each] of [[2, 0.05], [2, 0.7], [100, 0.03]]) {
    const timeline = new Timeline(times);
    timeline.speed = speed;
    timeline.toggle();
    const began = now;
    for (let frames = 0; timeline.playing && frames < 1000; ++frames) {
      now += 1000 * each;
      frame(now);
      const clock = Math.min(9, (speed * (now - began)) / 1000);
      assert.ok(Math.abs(timeline.time - clock) < 1e-9, `${timeline.time} instead of ${clock}`);
      const { step, along } = timeline.position;
      assert.ok(along >= 0 && along <= 1 && clock <= times[step] && (clock >= (times[step - 1] ?? 0)), `step ${step}, ${along}`);
    }
    assert.deepEqual([timeline.playing, timeline.step, timeline.along], [false, 6, 1]);
  }
  Object.defineProperty(globalThis, "performance", { value: performance, configurable: true });
}
console.log("numbers, warnings and times are right");
