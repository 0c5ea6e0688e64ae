// The numbers, warnings, times and tables that the page makes of a run: run_numbers_test.mjs WEB, where WEB is
// planner/report/web. The runs are made up; what is expected is written down here, or found by search.
import assert from "node:assert/strict";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const part = (name) => import(pathToFileURL(resolve(process.argv[2], "src", name)).href);
const { clockTime, cubicMetres, lastUpTo, numbersOf, percent, stepOfCoverage } = await part("run_numbers.js");
const { contactsText, details, ending, warnings } = await part("facts_view.js");
const { comparison } = await part("comparison_view.js");
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
  const said = (options) => {
    const facts = factsOf(RUN, { options: JSON.stringify(options) });
    return warnings({ facts, numbers: numbersOf(facts) });
  };
  assert.match(said({ lockstep: false, latency: 0.25 }).join(), /up to 300 ms, and 250 ms are charged/);
  for (const options of [{ lockstep: false, latency: 0.31 }, { lockstep: true, latency: 0.25 }, { lockstep: false }, { lockstep: false, latency: "0.1" }]) assert.deepEqual(said(options), [], JSON.stringify(options));
}
const ofRobot = (numbers, goal = "") => ({ idle_s: null, held_back: null, narrow_by_m: null, in_view_then: null, without_min_height: null, ...numbers, goal });
{ // What only run.json knows; what it does not know is NaN, or no text.
  const measured = {
    clearance_min_m: 0.125, separation_min_m: null, contacts_in_free: 2, warnings: [], surface_out_of_bounds: 0.5, unseen: { in_view: 0.01, narrow: 0.25, hidden: 0 }, map: { false_free: 0.02, false_occupied: null, surface_found: 0.9 },
    robots: [ofRobot({ idle_s: 1.5, held_back: 0, narrow_by_m: 0.15, in_view_then: 0.2, without_min_height: 0.01 }, "no goal"), ofRobot({ held_back: 3, in_view_then: 0 })],
  };
  const result = (options, facts) => numbersOf(factsOf(RUN, { options: JSON.stringify(options), ...facts })).result;
  const shown = result({ lockstep: false, latency: 0.25 }, { measured });
  assert.deepEqual([shown.latency, shown.clearance, shown.separation, shown.idle, shown.heldBack, shown.bumpers], [0.25, 0.125, NaN, [1.5, NaN], [0, 3], true]);
  assert.deepEqual([shown.contactsInFree, shown.outOfBounds, shown.unseen, shown.map], [2, 0.5, { inView: 0.01, narrow: 0.25, hidden: 0 }, { falseFree: 0.02, falseOccupied: NaN, surfaceFound: 0.9 }]);
  assert.deepEqual([shown.narrowBy, shown.inViewThen, shown.withoutMinHeight, shown.goals], [[0.15, NaN], [0.2, 0], [0.01, NaN], ["no goal", ""]]);
  for (const facts of [{ measured: null }, {}]) {
    const none = result({ bumper: false }, facts);
    assert.deepEqual([none.clearance, none.contactsInFree, none.idle, none.narrowBy, none.goals, none.bumpers], [NaN, NaN, [NaN, NaN], [NaN, NaN], ["", ""], false]);
    assert.deepEqual([none.outOfBounds, none.unseen, none.map], [NaN, { inView: NaN, narrow: NaN, hidden: NaN }, { falseFree: NaN, falseOccupied: NaN, surfaceFound: NaN }]);
  }
  // Its warnings say why; without any, what the recording tells is enough to warn.
  const said = (list, other) => {
    const facts = factsOf(RUN.slice(0, 5), { measured: { ...measured, warnings: list }, ...other });
    return warnings({ facts, numbers: numbersOf(facts) });
  };
  const why = ["the run has ended with 90.0 % mapped; 9.0 % are hidden", "the robot 'a' failed"];
  assert.deepEqual(said(why), why);
  assert.deepEqual(said(why, { truncated: true }), [...why, "the last step of the recording is incomplete and is not shown"]);
  assert.match(said([]).join(), /^the exploration ended by itself, but only 90.0 % of the observable space was mapped$/);
  assert.deepEqual(said([], { end: "stopped" }), []);
  for (const [contacts, inFree, text] of [[0, 0, "0"], [3, 0, "3, 0 with surfaces in free voxels"], [3, 2, "3, 2 with surfaces in free voxels"], [3, NaN, "3"]])
    assert.equal(contactsText({ contacts, contactsInFree: inFree }), text);
}
{ // The tables have it, and leave out what is not known.
  const element = (tag) => ({ tag, children: [], textContent: "", setAttribute() {}, append(...more) { this.children.push(...more); } });
  const all = (node) => [node, ...node.children.flatMap(all)];
  const rowsOf = (blocks, caption) => {
    const block = blocks.find((one) => all(one).some(({ tag, textContent }) => tag === "caption" && textContent === caption));
    return block && all(block).filter(({ tag }) => tag === "tr").map((row) => row.children.map((cell) => cell.textContent));
  };
  const robots = ["a", "b"].map((name) => ({ name, plane: true, extents: [1, 1, 1], shape: "cone", horizontal: 1, vertical: 1, max_range: 9, columns: 0, rows: 0 }));
  const runOf = (measured, plane = true) => {
    const facts = factsOf(RUN, { world: "room", bounds: [], robots: robots.map((robot, r) => ({ ...robot, plane: plane || r === 0 })), measured });
    return { name: "run", facts, numbers: numbersOf(facts) };
  };
  const known = { in_view: 0.0123, narrow: 0.25, hidden: 0 };
  const full = {
    clearance_min_m: null, separation_min_m: null, contacts_in_free: null, warnings: [], surface_out_of_bounds: 0.4, unseen: known, map: { false_free: 0.02, false_occupied: 0, surface_found: 0.9 },
    robots: [ofRobot({ narrow_by_m: 0.15, in_view_then: 0.2, without_min_height: 0 }, "no goal"), ofRobot({ in_view_then: 0, without_min_height: 0.05 })],
  };
  const bare = { ...full, surface_out_of_bounds: null, unseen: { in_view: null, narrow: null, hidden: null }, map: { false_free: null, false_occupied: null, surface_found: null }, robots: [ofRobot({}), ofRobot({})] };
  globalThis.document = { createElement: element };
  const shown = details(runOf(full), "1"), row = (blocks, caption, name) => rowsOf(blocks, caption).find(([head]) => head === name)?.slice(1);
  assert.deepEqual(row(shown, "The run", "Unseen"), ["25.0 % of the observable space where only smaller robots, or those that fly, see it, 0.0 % hidden from everywhere, 1.2 % that the robots could have seen"]);
  assert.match(row(details(runOf(full, false), "1"), "The run", "Unseen")[0], /only smaller robots see it/);
  assert.deepEqual(row(shown, "The run", "Out of bounds"), ["40.0 % of the world's surface lies outside what is explored"]);
  assert.equal(row(details(runOf({ ...full, surface_out_of_bounds: 0 }), "1"), "The run", "Out of bounds"), undefined);
  assert.deepEqual(row(shown, "The run", "Accuracy of the map"), ["90.0 % of the surface voxels are occupied, 2.0 % of the free voxels hold a surface, 0.0 % of the occupied ones are in free space"]);
  assert.deepEqual(row(shown, "The team", "openings too narrow"), ["by 0.15 m, 20.0 % behind them", "a smaller body does not help"]);
  assert.deepEqual(row(shown, "The team", "in view without minimum height"), ["0.0 %", "5.0 %"]);
  assert.deepEqual(rowsOf(shown, "The last goals"), [["a", "no goal"], ["b", "unknown"]]);
  for (const measured of [bare, null]) {
    const without = details(runOf(measured), "1");
    for (const [caption, name] of [["The run", "Unseen"], ["The run", "Accuracy of the map"], ["The team", "openings too narrow"], ["The team", "in view without minimum height"]]) assert.equal(row(without, caption, name), undefined, name);
    assert.equal(rowsOf(without, "The last goals"), undefined);
  }
  assert.deepEqual(rowsOf(comparison([runOf(full), runOf(null)]), "Unseen places and the map").slice(1),
    [["run", "25.0 %", "0.0 %", "1.2 %", "a by 0.15 m, 20.0 % behind them", "90.0 %", "2.0 %", "0.0 %"], ["run", ...Array(7).fill("–")]]);
  assert.equal(rowsOf(comparison([runOf(null), runOf(null)]), "Unseen places and the map"), undefined);
  delete globalThis.document;
}
{
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
console.log("numbers, warnings, times and tables are right");
