import { MILESTONES, differences, isWhole, meanTo, meanOf, sameWorld, seedGroups, seedsOf } from "./comparison.js";
import { el, table } from "./dom.js";
import { ENDS, clearanceOf, contactsText, narrowText, teamName } from "./facts_view.js";
import { centimetres, clockTime, cubicMetres, metres, percent, seconds, stepOfCoverage, whole } from "./run_numbers.js";

const sum = (list) => list.reduce((a, b) => a + b, 0);
const known = (number, text) => (Number.isFinite(number) ? text(number) : "–");

/** What makes the runs unlike, then tables: a row for each run, one for each group of seeds, and what else is known of each run. */
export function comparison(runs) {
  const groups = seedGroups(runs);
  return [
    ...differences(runs).map((text) => el("p", { class: "warning", role: "note", text: `Compare with care: ${text}.` })),
    runTable(runs),
    ...(groups.length > 0 ? [groupTable(runs, groups)] : []),
    planningAndSafety(runs),
    ...(runs.some(({ facts }) => facts.measured) ? [unseenAndMap(runs)] : []),
  ];
}

const signed = (value, reference) => {
  const change = (100 * (value - reference)) / reference;
  return `${change >= 0 ? "+" : "−"}${Math.abs(change).toFixed(0)} %`;
};

function endOf({ facts }) {
  if (facts.truncated || facts.end === null) return "recording incomplete";
  return facts.end in ENDS ? facts.end.replaceAll("_", " ") : facts.end;
}

function seedText({ facts }) {
  const { seed, layout } = seedsOf(facts);
  if (seed === null) return "–";
  return layout === null || layout === seed ? String(seed) : `${seed}, world ${layout}`;
}

function runTable(runs) {
  const [first] = runs;
  // Only between runs in the same world that have mapped the same can less time or path be better.
  const alike = (run) => run !== first && sameWorld(run, first) && run.numbers.clock === first.numbers.clock;
  const change = (run, value, reference) => (alike(run) && reference > 0 ? ` (${signed(value, reference)})` : "");
  const to = (run, list, part, format) => {
    const at = (numbers) => numbers[list][stepOfCoverage(numbers, part)], value = at(run.numbers);
    return value === undefined ? "never" : `${format(value)}${change(run, value, at(first.numbers))}`;
  };
  const timeTo = (run, part) => (run.numbers.clock ? to(run, "time", part, clockTime) : "not recorded");
  const end = (run) => {
    if (!run.numbers.clock) return "not recorded";
    const { time } = run.numbers.result, compared = isWhole(run) && isWhole(first);
    return `${clockTime(time)}${compared ? change(run, time, first.numbers.result.time) : ""}`;
  };
  const heads = ["run", "world", "seed", "voxels", "team", "moves", "end", "coverage", "time", ...MILESTONES.map((part, i) => `${i === 0 ? "time " : ""}to ${percent(part, 0)}`), "volume", "path", "path to 90 %", "planning"];
  return table("Comparison", heads, runs.map((run) => [
    run.name, run.facts.world, seedText(run), `${run.facts.resolution} m`, teamName(run.facts), run.numbers.motion ? "in motion" : "lock-step", endOf(run), percent(run.numbers.result.coverage),
    end(run), ...MILESTONES.map((part) => timeTo(run, part)), cubicMetres(run.numbers.result.volume),
    metres(run.numbers.result.length), to(run, "teamTravelled", 0.9, metres), seconds(run.numbers.result.planningMean),
  ]));
}

/** The names of the runs of a group; of many, the first. */
export function groupName(runs, group) {
  const names = group.map((i) => runs[i].name);
  return names.length > 3 ? `${names[0]} and ${names.length - 1} more` : names.join(", ");
}

function groupTable(runs, groups) {
  const text = ({ mean, deviation, count, of = count }, format) => {
    if (count === 0) return "never";
    return `${format(mean)}${Number.isFinite(deviation) ? ` ± ${format(deviation)}` : ""}${count < of ? `, ${count} of ${of} runs` : ""}`;
  };
  return table("Several seeds of a kind: mean ± standard deviation", ["runs", "", "world", "team", "moves", "seeds", "coverage", "time", ...MILESTONES.map((part) => `to ${percent(part, 0)}`), "path", "ended by themselves"], groups.map((group) => {
    const of = group.map((i) => runs[i]), clock = of.every(({ numbers }) => numbers.clock);
    const time = (mean) => (clock ? text(mean, clockTime) : "not recorded");
    return [
      groupName(runs, group), group.length, of[0].facts.world, teamName(of[0].facts), of[0].numbers.motion ? "in motion" : "lock-step", of.map(seedText).join("; "), text(meanOf(of.map(({ numbers }) => numbers.result.coverage)), percent),
      time(meanOf(of.map(({ numbers }) => numbers.result.time))), ...MILESTONES.map((part) => time(meanTo(of, part, "time"))),
      text(meanOf(of.map(({ numbers }) => numbers.result.length)), metres), `${of.filter(isWhole).length} of ${of.length}`,
    ];
  }));
}

function planningAndSafety(runs) {
  return table("Planning and safety", ["run", "planning, 99 % within", "max", "latency charged", "idle", "clearance", "between robots", "contacts", "held back"], runs.map(({ name, numbers: { result } }) => [
    name, seconds(result.planningUsual), seconds(result.planningMost), known(result.latency, seconds), known(sum(result.idle), clockTime), known(result.clearance, clearanceOf),
    known(result.separation, centimetres), contactsText(result), result.bumpers ? known(sum(result.heldBack), (times) => `${whole(times)} times`) : "no bumpers",
  ]));
}

function unseenAndMap(runs) {
  return table("Unseen places and the map", ["run", "unseen: narrow", "hidden", "in view", "openings too narrow", "surface found", "false free", "false occupied"], runs.map(({ name, facts, numbers: { result } }) => {
    const { unseen, map, narrowBy, inViewThen } = result;
    const openings = facts.robots.flatMap((robot, r) => (narrowBy[r] > 0 ? [`${robot.name} ${narrowText(narrowBy[r], inViewThen[r])}`] : []));
    return [name, ...[unseen.narrow, unseen.hidden, unseen.inView].map((part) => known(part, percent)), openings.join("; ") || "–", ...[map.surfaceFound, map.falseFree, map.falseOccupied].map((part) => known(part, percent))];
  }));
}
