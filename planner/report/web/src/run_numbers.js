/** Whether each robot plans for itself while it moves; else all robots plan, then all move, as in the paper. */
export function inMotion(facts) {
  return recordedOptions(facts)?.lockstep === false;
}

/**
 * The numbers of a run that the charts and tables show. Lengths in metres, volumes in cubic metres, times in
 * seconds, fractions from 0 to 1. `time` is the clock's at the end of each step; of a run without a clock it is
 * the step's number.
 */
export function numbersOf(facts) {
  const robots = facts.robots.length, steps = facts.steps.length;
  const column = (of) => facts.steps.map(of);
  const perRobot = (of) => facts.robots.map((_, r) => facts.steps.map((step) => of(step, r)));
  const sum = (list) => list.reduce((a, b) => a + b, 0);
  const of = (count, total) => (total > 0 ? count / total : NaN);
  const volume = (voxels) => voxels * facts.resolution ** 3;
  // In the last step in motion nobody looks for a goal: only frontiers were updated.
  const goals = facts.phases.indexOf("goals"), isPlanned = (step) => step.seconds[goals] > 0;
  const motion = inMotion(facts), clock = steps > 0 && facts.steps[steps - 1].time > 0;
  const numbers = {
    motion, clock,
    time: rising(column((step) => (clock ? step.time : step.number))),
    steps: column((step) => step.number),
    coverage: column((step) => of(sum(step.known.map((known) => known[0])), facts.observable)),
    coverageBox: column((step) => of(sum(step.known.map((known) => known[1])), facts.bounding)),
    robotCoverage: perRobot((step, r) => of(step.known[r][0], facts.observable)),
    volume: column((step) => volume(sum(step.known.map((known) => known[1])))),
    robotVolume: perRobot((step, r) => volume(step.known[r][1])),
    frontiers: held(column((step) => (motion && !isPlanned(step) ? null : step.frontiers))),
    unassigned: held(column((step) => (motion && !isPlanned(step) ? null : step.unassigned))),
    abandoned: held(column((step) => (motion && !isPlanned(step) ? null : step.abandoned))),
    rays: column((step) => step.rays),
    contacts: column((step) => step.contacts),
    phases: facts.phases.map((_, p) => column((step) => step.seconds[p])),
    planning: column((step) => sum(step.seconds.slice(0, -1))), // moving is the last
    predicted: perRobot((step, r) => step.robots[r].gain_predicted).map((list, r) => (motion ? held(list.map((gain, s) => (gain > 0 || hasPath(facts.steps[s].robots[r]) ? gain : null))) : list)),
    gained: perRobot((step, r) => step.robots[r].gained),
    length: perRobot((step, r) => step.robots[r].length),
  };
  numbers.travelled = numbers.length.map(runningSum);
  numbers.teamTravelled = facts.steps.map((_, s) => sum(numbers.travelled.map((list) => list[s])));
  const { measured } = facts, known = (number) => number ?? NaN, { latency, bumper } = recordedOptions(facts) ?? {};
  const ofRobots = (name) => facts.robots.map((_, r) => known(measured?.robots[r][name]));
  const last = steps - 1, planning = numbers.planning.filter((_, s) => facts.steps[s].number > 0 && isPlanned(facts.steps[s]));
  numbers.result = {
    steps: facts.steps.filter((step) => step.number > 0).length,
    plannings: planning.length,
    coverage: steps ? numbers.coverage[last] : NaN,
    coverageBox: steps ? numbers.coverageBox[last] : NaN,
    fractions: facts.robots.map((_, r) => (steps ? of(facts.steps[last].known[r][0], sum(facts.steps[last].known.map((known) => known[0]))) : NaN)),
    lengths: facts.robots.map((_, r) => (steps ? numbers.travelled[r][last] : 0)),
    length: steps ? numbers.teamTravelled[last] : 0,
    planningTotal: sum(planning),
    planningMean: planning.length ? sum(planning) / planning.length : NaN,
    planningMost: percentile(planning, 1),
    planningUsual: percentile(planning, 0.99),
    time: clock ? numbers.time[last] : NaN,
    volume: steps ? numbers.volume[last] : NaN,
    latency: motion && typeof latency === "number" ? latency : NaN,
    bumpers: bumper !== false,
    contacts: sum(numbers.contacts),
    clearance: known(measured?.clearance_min_m),
    separation: known(measured?.separation_min_m),
    contactsInFree: known(measured?.contacts_in_free),
    unseen: { inView: known(measured?.unseen.in_view), narrow: known(measured?.unseen.narrow), hidden: known(measured?.unseen.hidden) },
    outOfBounds: known(measured?.surface_out_of_bounds),
    map: { falseFree: known(measured?.map.false_free), falseOccupied: known(measured?.map.false_occupied), surfaceFound: known(measured?.map.surface_found) },
    idle: ofRobots("idle_s"),
    heldBack: ofRobots("held_back"),
    narrowBy: ofRobots("narrow_by_m"), // and the part that is in view of a robot that is smaller by so much
    inViewThen: ofRobots("in_view_then"),
    withoutMinHeight: ofRobots("without_min_height"),
    goals: facts.robots.map((_, r) => measured?.robots[r].goal ?? ""),
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

/** No time is earlier than the one before, and none is missing. */
function rising(list) {
  let last = 0;
  return list.map((value) => (last = value > last ? value : last));
}

/** Each missing value is the one before. */
function held(list) {
  let last = 0;
  return list.map((value) => (last = value ?? last));
}

const hasPath = (robot) => !robot.path.startsWith("has no length");

/** The least value that is not exceeded by this part of the list. */
function percentile(list, part) {
  if (list.length === 0) return NaN;
  return [...list].sort((a, b) => a - b)[Math.max(1, Math.ceil(part * list.length)) - 1];
}

/** The index of the last value that is not greater than x, in a list that rises; 0 if there is none. */
export function lastUpTo(list, x) {
  let low = 0, high = list.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] <= x) low = middle;
    else high = middle;
  }
  return low;
}

export const NOT_SET = "not set";

/** Options as [name, value] pairs, those of members as name.member; nothing if the text is not a JSON object. */
export function optionsOf(facts) {
  const options = recordedOptions(facts), rows = [];
  const visit = (prefix, value) => {
    if (value !== null && typeof value === "object" && !Array.isArray(value)) for (const [name, member] of Object.entries(value)) visit(prefix === "" ? name : `${prefix}.${name}`, member);
    else rows.push([prefix, Array.isArray(value) ? value.map((item) => (typeof item === "object" ? JSON.stringify(item) : String(item))).join(", ") || "none" : value === "" ? NOT_SET : String(value)]);
  };
  if (options !== null) visit("", options);
  return rows;
}

/** The options as an object; null if the text is not that of a JSON object. */
export function recordedOptions(facts) {
  try {
    const options = JSON.parse(facts.options);
    return typeof options === "object" && !Array.isArray(options) ? options : null;
  } catch {
    return null;
  }
}

/** A fraction below 1 never reads as 100 %. */
export function percent(fraction, digits = 1) {
  if (!Number.isFinite(fraction)) return "unknown";
  const text = (100 * fraction).toFixed(digits), step = 10 ** -digits;
  return `${fraction < 1 && Number(text) === 100 ? (100 - step).toFixed(digits) : text} %`;
}
/** For distances between bodies. */
export const centimetres = (length) => `${length.toFixed(2)} m`;
export const metres = (length) => (Number.isFinite(length) ? `${length.toFixed(length < 100 ? 1 : 0)} m` : "unknown");
export function seconds(time) {
  if (!Number.isFinite(time)) return "unknown";
  if (time < 1) return `${(1000 * time).toFixed(time < 0.01 ? 1 : 0)} ms`;
  return time < 120 ? `${time.toFixed(time < 10 ? 2 : 1)} s` : `${(time / 60).toFixed(1)} min`;
}
/** A time of the clock, which is always in seconds. */
export const clockTime = (time) => (Number.isFinite(time) ? `${time.toFixed(1)} s` : "unknown");
export const cubicMetres = (volume) => (Number.isFinite(volume) ? `${volume.toLocaleString("en", { minimumFractionDigits: volume < 100 ? 1 : 0, maximumFractionDigits: volume < 100 ? 1 : 0 })} m³` : "unknown");
export const whole = (number) => (Number.isFinite(number) ? Math.round(number).toLocaleString("en") : "unknown");
