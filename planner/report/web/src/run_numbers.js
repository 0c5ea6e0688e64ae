/** The numbers of a run that the charts and tables show. Lengths in metres, times in seconds, fractions from 0 to 1. */
export function numbersOf(facts) {
  const robots = facts.robots.length, steps = facts.steps.length;
  const column = (of) => facts.steps.map(of);
  const perRobot = (of) => facts.robots.map((_, r) => facts.steps.map((step) => of(step, r)));
  const sum = (list) => list.reduce((a, b) => a + b, 0);
  const of = (count, total) => (total > 0 ? count / total : NaN);
  const numbers = {
    steps: column((step) => step.number),
    coverage: column((step) => of(sum(step.known.map((known) => known[0])), facts.observable)),
    coverageBox: column((step) => of(sum(step.known.map((known) => known[1])), facts.bounding)),
    robotCoverage: perRobot((step, r) => of(step.known[r][0], facts.observable)),
    robotBox: perRobot((step, r) => of(step.known[r][1], facts.bounding)),
    frontiers: column((step) => step.frontiers),
    unassigned: column((step) => step.unassigned),
    abandoned: column((step) => step.abandoned),
    rays: column((step) => step.rays),
    collisions: column((step) => step.collisions),
    phases: facts.phases.map((_, p) => column((step) => step.seconds[p])),
    planning: column((step) => sum(step.seconds.slice(0, -1))), // moving is the last
    tangent: perRobot((step, r) => step.robots[r].gain_tangent),
    predicted: perRobot((step, r) => step.robots[r].gain_predicted),
    gained: perRobot((step, r) => step.robots[r].gained),
    length: perRobot((step, r) => step.robots[r].length),
  };
  numbers.travelled = numbers.length.map(runningSum);
  numbers.teamTravelled = facts.steps.map((_, s) => sum(numbers.travelled.map((list) => list[s])));
  const last = steps - 1, planned = facts.steps.map((_, s) => s).filter((s) => facts.steps[s].number > 0);
  const planning = planned.map((s) => numbers.planning[s]);
  numbers.result = {
    steps: planned.length,
    coverage: steps ? numbers.coverage[last] : NaN,
    coverageBox: steps ? numbers.coverageBox[last] : NaN,
    fractions: facts.robots.map((_, r) => (steps ? of(facts.steps[last].known[r][0], sum(facts.steps[last].known.map((known) => known[0]))) : NaN)),
    lengths: facts.robots.map((_, r) => (steps ? numbers.travelled[r][last] : 0)),
    length: steps ? numbers.teamTravelled[last] : 0,
    planningTotal: sum(planning),
    planningMean: planning.length ? sum(planning) / planning.length : NaN,
    planningMost: planning.length ? Math.max(...planning) : NaN,
    collisions: sum(numbers.collisions),
    rays: sum(numbers.rays),
    robots,
  };
  return numbers;
}

/** The first step at whose end the coverage is at least this fraction; -1: none. */
export function stepOfCoverage(numbers, fraction) {
  return numbers.coverage.findIndex((value) => value >= fraction);
}

function runningSum(list) {
  let sum = 0;
  return list.map((value) => (sum += value));
}

export const NOT_SET = "not set";

/** Options as [name, value] pairs, those of members as name.member; nothing if the text is not a JSON object. */
export function optionsOf(facts) {
  let options;
  try {
    options = JSON.parse(facts.options);
  } catch {
    return [];
  }
  const rows = [];
  const visit = (prefix, value) => {
    if (value !== null && typeof value === "object" && !Array.isArray(value)) for (const [name, member] of Object.entries(value)) visit(prefix === "" ? name : `${prefix}.${name}`, member);
    else rows.push([prefix, Array.isArray(value) ? value.map((item) => (typeof item === "object" ? JSON.stringify(item) : String(item))).join(", ") || "none" : value === "" ? NOT_SET : String(value)]);
  };
  if (options !== null && typeof options === "object" && !Array.isArray(options)) visit("", options);
  return rows;
}

/** A fraction below 1 never reads as 100 %. */
export function percent(fraction, digits = 1) {
  if (!Number.isFinite(fraction)) return "unknown";
  const text = (100 * fraction).toFixed(digits), step = 10 ** -digits;
  return `${fraction < 1 && Number(text) === 100 ? (100 - step).toFixed(digits) : text} %`;
}
export const metres = (length) => (Number.isFinite(length) ? `${length.toFixed(length < 100 ? 1 : 0)} m` : "unknown");
export function seconds(time) {
  if (!Number.isFinite(time)) return "unknown";
  if (time < 1) return `${(1000 * time).toFixed(time < 0.01 ? 1 : 0)} ms`;
  return time < 120 ? `${time.toFixed(time < 10 ? 2 : 1)} s` : `${(time / 60).toFixed(1)} min`;
}
export const whole = (number) => (Number.isFinite(number) ? Math.round(number).toLocaleString("en") : "unknown");
