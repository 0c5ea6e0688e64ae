import { inMotion, lastUpTo, recordedOptions, stepOfCoverage } from "./run_numbers.js";

export const MILESTONES = [0.5, 0.9, 0.95, 0.99];
const SEEDS = ["seed", "world_seed"];
// The planner chose these ends: the others are limits, or the run was stopped, or is not whole.
export const NORMAL_ENDS = ["low_gain", "nothing_to_do"];
const SAMPLES = 200; // along a band

/** The seed of a run, and that of its world's layout; null if the world is a file, or nothing is recorded. */
export function seedsOf(facts) {
  const { seed = null, world_seed: layout = seed, world_uri: file } = recordedOptions(facts) ?? {};
  return { seed, layout: file ? null : layout };
}

/** Equal for runs in the same world, cut into the same voxels. */
export function worldKey(facts) {
  return JSON.stringify([facts.world, seedsOf(facts).layout, facts.resolution, facts.bounds]);
}

export const sameWorld = (a, b) => worldKey(a.facts) === worldKey(b.facts);

/** Equal for runs that differ in nothing but their seeds. */
function kindKey(facts) {
  const options = { ...recordedOptions(facts) };
  for (const seed of SEEDS) delete options[seed];
  return JSON.stringify([facts.world, facts.resolution, facts.robots.map((robot) => robot.name), Object.entries(options).sort()]);
}

/** Runs that differ in nothing but their seeds, and have two seeds at least: lists of indices. */
export function seedGroups(runs) {
  const kinds = new Map();
  runs.forEach(({ facts }, i) => kinds.set(kindKey(facts), [...(kinds.get(kindKey(facts)) ?? []), i]));
  const seeds = (group) => new Set(group.map((i) => JSON.stringify(seedsOf(runs[i].facts))));
  return [...kinds.values()].filter((group) => seeds(group).size > 1);
}

/** Whether nothing but the planner ended the run. */
export const isWhole = ({ facts }) => NORMAL_ENDS.includes(facts.end) && !facts.truncated;

const list = (values) => [...new Set(values)].join(", ");

/** What makes the runs unlike each other, in sentences without a full stop. */
export function differences(runs) {
  const said = [], differ = (of) => new Set(runs.map((run) => JSON.stringify(of(run)))).size > 1;
  const all = (of) => list(runs.map(of));
  const layouts = (world) => new Set(runs.filter(({ facts }) => facts.world === world).map(({ facts }) => seedsOf(facts).layout));
  const changing = [...new Set(runs.map(({ facts }) => facts.world))].filter((world) => layouts(world).size > 1);
  if (differ(({ facts }) => facts.world)) said.push(`the runs are in different worlds (${all(({ facts }) => facts.world)}); runs in different worlds are not compared in percent`);
  if (changing.length > 0) said.push(`each seed has another layout of ${changing.join(" and ")}; runs in different layouts are not compared in percent`);
  if (differ(({ facts }) => facts.resolution)) said.push(`the voxels are not of one size (${all(({ facts }) => `${facts.resolution} m`)}); runs with different voxels are not compared in percent`);
  else if (!differ(({ facts }) => worldKey(facts)) && differ(({ facts }) => facts.observable)) said.push("the runs do not count the same space as observable, since they begin at different places or with other robots; equal percentages are not equal volumes");
  if (differ(({ facts }) => inMotion(facts))) said.push("some runs are in motion and others in lock-step, where robots stop to measure and wait for each other");
  else if (differ(({ facts }) => recordedOptions(facts)?.latency ?? null)) said.push(`the clock charges different times for a planning (${all(({ facts }) => `${recordedOptions(facts)?.latency ?? "unknown"} s`)})`);
  const cut = runs.filter((run) => !isWhole(run));
  if (cut.length > 0 && cut.length < runs.length) said.push(`not all runs went on until the planner ended them (${cut.map((run) => run.name).join(", ")} did not); times to the end compare only those that did`);
  return said;
}

/** Mean and standard deviation of a sample; the deviation of one value is NaN. */
export function meanOf(values) {
  const mean = values.reduce((a, b) => a + b, 0) / values.length;
  const squares = values.reduce((sum, value) => sum + (value - mean) ** 2, 0);
  return { mean, deviation: values.length > 1 ? Math.sqrt(squares / (values.length - 1)) : NaN, count: values.length };
}

/** Of the runs of a group that have mapped so much, a number of the step in which they had. */
export function meanTo(runs, fraction, name) {
  const values = runs.map(({ numbers }) => numbers[name][stepOfCoverage(numbers, fraction)]).filter((value) => value !== undefined);
  return { ...meanOf(values), of: runs.length };
}

/**
 * Mean and deviation of a curve over the runs of a group, from 0 to the last end: a run that is over counts with its
 * end. `x` and `y` name lists of `numbers`.
 */
export function bandOf(runs, x, y) {
  const end = Math.max(...runs.map(({ numbers }) => numbers[x].at(-1))), xs = [], mean = [], low = [], high = [];
  for (let i = 0; i <= SAMPLES; ++i) {
    const at = (end * i) / SAMPLES;
    if (i > 0 && !(at > xs.at(-1))) break;
    const here = meanOf(runs.map(({ numbers }) => numbers[y][lastUpTo(numbers[x], at)])), deviation = here.deviation || 0;
    xs.push(at);
    mean.push(here.mean);
    low.push(Math.max(0, here.mean - deviation));
    high.push(here.mean + deviation);
  }
  return { xs, mean, low, high };
}

/** Where a run is at a time of its clock: { step, along } as the time line has it. */
export function positionAt(times, time) {
  const last = times.length - 1, after = times.findIndex((end) => end >= time), step = after < 0 ? last : after;
  const from = times[step - 1] ?? 0, lasts = times[step] - from;
  return { step, along: after < 0 || !(lasts > 0) ? 1 : Math.min((time - from) / lasts, 1) };
}
