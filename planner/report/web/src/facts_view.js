import { MILESTONES, NORMAL_ENDS } from "./comparison.js";
import { el, table } from "./dom.js";
import { NOT_SET, centimetres, clockTime, cubicMetres, inMotion, metres, optionsOf, percent, seconds, stepOfCoverage, whole } from "./run_numbers.js";

// Deng, Xu, Zhao and Shimada's results, by world: the team's coverage and steps, planning time of each robot in total and
// per step, and, before and after optimisation, the UAV's fraction of the coverage and its path.
const PAPER = {
  maze: { coverage: "97.2 %", steps: "69", uav: "2.6 min (2.26 s)", ugv: "0.14 s (2 ms)", fraction: "57 / 64 %", path: "286 / 252 m" },
  factory: { coverage: "97.5 %", steps: "74", uav: "5.6 min (4.54 s)", ugv: "4.0 s (54 ms)", fraction: "72 / 93 %", path: "777 / 232 m" },
  station: { coverage: "96.0 %", steps: "137", uav: "10.4 min (4.55 s)", ugv: "18.6 s (136 ms)", fraction: "66 / 81 %", path: "713 / 316 m" },
};

export const ENDS = {
  low_gain: "the expected gain stayed too low for several steps",
  low_gain_in_motion: "the expected gain stayed too low for several plannings of each robot",
  nothing_to_do: "no robot had a goal left",
  step_limit: "the step limit was reached",
  cut_off: "a robot is where it cannot leave, and there is more to see from where it came from",
  coverage: "the coverage that was asked for was reached",
  time_limit: "the time limit was reached",
  stopped: "it was stopped",
};

const ENOUGH = 0.95; // of the observable space, at a normal end
const MOST_ROWS = 500; // in the table of steps

/** Why a run ended, as the end of a sentence. */
export function ending(facts) {
  return facts.end === null ? "the recording is incomplete" : ((inMotion(facts) && ENDS[`${facts.end}_in_motion`]) || ENDS[facts.end] || facts.end);
}

export function teamName(facts) {
  return facts.robots.map((robot) => robot.name).join(" + ");
}

function headline(run) {
  const { facts, numbers } = run, { result } = numbers;
  const box = Number.isFinite(result.coverageBox) ? ` (${percent(result.coverageBox)} of the world's box)` : "";
  const effort = numbers.clock ? `${clockTime(result.time)} and ${metres(result.length)}` : `${result.steps} steps`;
  return `${facts.robots.length > 1 ? "The team" : "The robot"} mapped ${percent(result.coverage)} of the observable space${box} in ${effort}. It ended because ${ending(facts)}.`;
}

/** Who would see what only smaller robots see. */
const smallerRobots = (facts) => (facts.robots.every((robot) => robot.plane) ? "smaller robots, or those that fly," : "smaller robots");

/** What a reader must know before trusting the numbers. run.json has it with the reasons. */
export function warnings({ facts, numbers }) {
  const { coverage, latency, planningUsual } = numbers.result, list = [...(facts.measured?.warnings ?? [])];
  if (list.length === 0) {
    if (facts.end === "cut_off") list.push("a robot was cut off: it could not leave its place, and there was more to see");
    if (NORMAL_ENDS.includes(facts.end) && coverage < ENOUGH) list.push(`the exploration ended by itself, but only ${percent(coverage)} of the observable space was mapped`);
    if (planningUsual > latency) list.push(`planning was too slow for this run's clock: 99 % of the plannings took up to ${seconds(planningUsual)}, and ${seconds(latency)} are charged for each. On that machine robots would get their trajectories later than shown here; explore with a greater --latency`);
  }
  if (facts.end === null) list.push("the recording has no end: the run was killed, or it goes on");
  if (facts.truncated) list.push("the last step of the recording is incomplete and is not shown");
  return list;
}

/** A function of the first step with this coverage, or "never". */
function reached(numbers, fraction, format) {
  const s = stepOfCoverage(numbers, fraction);
  return s < 0 ? "never" : format(s);
}

function worldsOf(runs) {
  const worlds = [...new Set(runs.map((run) => run.facts.world))];
  return `${worlds.length > 1 ? "Worlds" : "World"}: ${worlds.join(", ")}. The replay shows one of the runs at a time.`;
}

/** The first thing a reader sees: what was run, and the result. */
export function header(runs) {
  const [{ facts, numbers }] = runs, { result } = numbers;
  const single = runs.length === 1;
  const tile = (name, value, note) => el("div", { class: "tile" }, el("dt", { text: name }), el("dd", {}, el("strong", { text: value }), note ? el("span", { class: "note", text: note }) : null));
  const tiles = single
    ? el("dl", { class: "tiles" },
        tile("coverage", percent(result.coverage), "of the observable space"),
        numbers.clock ? tile("time", clockTime(result.time), [0.5, 0.9, 0.99].filter((part) => result.coverage >= part).map((part) => `${percent(part, 0)} after ${reached(numbers, part, (s) => clockTime(numbers.time[s]))}`).join(", ")) : tile("steps", whole(result.steps)),
        tile("explored volume", cubicMetres(result.volume)),
        tile("path length", metres(result.length), facts.robots.length > 1 ? facts.robots.map((robot, r) => `${robot.name} ${metres(result.lengths[r])}`).join(", ") : ""),
        tile("planning time", seconds(result.planningMean), numbers.motion ? `mean of ${whole(result.plannings)} plannings, 99 % within ${seconds(result.planningUsual)}${charged(result)}` : `mean of ${whole(result.steps)} steps, max ${seconds(result.planningMost)}`),
        tile("contacts", whole(result.contacts), bumpers(result)))
    : null;
  return [
    el("div", { class: "title" }, el("h1", { text: single ? `${facts.world}, explored by ${teamName(facts)}` : `${runs.length} runs compared` }),
    el("p", { class: "lead", text: single ? headline(runs[0]) : worldsOf(runs) }),
    ),
    tiles,
    ...runs.flatMap((run) => warnings(run).map((text) => el("p", { class: "warning", role: "note", text: `Warning${single ? "" : `, ${run.name}`}: ${text}.` }))),
  ].filter(Boolean);
}

/** What the clock charges for a planning, as the end of a sentence; empty if that is not recorded. */
const charged = ({ latency }) => (Number.isFinite(latency) ? `; ${seconds(latency)} are charged` : "");

/** How often all robots were held back; no contacts then says nothing. */
function bumpers({ bumpers, heldBack }) {
  if (!bumpers) return "robots without bumpers";
  const times = heldBack.reduce((a, b) => a + b, 0);
  return Number.isFinite(times) ? `robots held back ${times === 1 ? "once" : `${whole(times)} times`}` : "";
}

/** How many, and at how many of them the map had all of the body's place as free. */
export function contactsText({ contacts, contactsInFree }) {
  return `${whole(contacts)}${contacts > 0 && Number.isFinite(contactsInFree) ? `, ${whole(contactsInFree)} with surfaces in free voxels` : ""}`;
}

const anyKnown = (numbers) => Object.values(numbers).some(Number.isFinite);

/** By how much openings are too narrow for a robot, and how much is behind them. */
export const narrowText = (by, behind) => `by ${centimetres(by)}, ${percent(behind)} behind them`;

/** Greater ones are not told apart by the simulator. */
export const clearanceOf = (length) => (length < 1 ? centimetres(length) : "1 m or more");

/** Everything else about a run: team, options, the paper's numbers. */
export function details(run, written) {
  const { facts, numbers } = run, { result } = numbers, { unseen, map } = result;
  const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(0)}°`;
  const sensor = (robot) => {
    const rays = robot.columns * robot.rows > 0 ? `, ${robot.columns} × ${robot.rows} rays` : "";
    if (robot.shape === "spinning") return `360° × ±${degrees(robot.vertical / 2)}, ${metres(robot.max_range)}${rays}`;
    if (robot.shape === "pyramid") return `${degrees(robot.horizontal)} × ${degrees(robot.vertical)}, ${metres(robot.max_range)}${rays}`;
    return `cone of ${degrees(robot.horizontal)}, ${metres(robot.max_range)}${rays}`;
  };
  const parts = [
    table("The run", [], [
      ["World", facts.world], ["Seed", optionsOf(facts).find(([name]) => name === "seed")?.[1] ?? "not recorded"], ["Voxels", `${facts.resolution} m`],
      ["Observable", facts.observable > 0 ? `${whole(facts.observable)} voxels` : "unknown"],
      ["Coverage", `${percent(result.coverage)} of the observable space, ${percent(result.coverageBox)} of the box`],
      ...(anyKnown(unseen) ? [["Unseen", `${percent(unseen.narrow)} of the observable space where only ${smallerRobots(facts)} see it, ${percent(unseen.hidden)} hidden from everywhere, ${percent(unseen.inView)} that the robots could have seen`]] : []),
      ...(result.outOfBounds > 0 ? [["Out of bounds", `${percent(result.outOfBounds)} of the world's surface lies outside what is explored`]] : []),
      ["Explored volume", cubicMetres(result.volume)],
      ...(anyKnown(map) ? [["Accuracy of the map", `${percent(map.surfaceFound)} of the surface voxels are occupied, ${percent(map.falseFree)} of the free voxels hold a surface, ${percent(map.falseOccupied)} of the occupied ones are in free space`]] : []),
      ["Robots", numbers.motion ? "in motion: each plans for itself while it moves" : "in lock-step: all plan, then all move"],
      ["Steps", numbers.motion ? `${whole(result.steps)}, with a planning in ${whole(result.plannings)}` : `${whole(result.steps)}, after a scan at the start`], ["Reason for the end", ending(facts)],
      ["Planning", `${seconds(result.planningTotal)} in total; for each ${numbers.motion ? "planning" : "step"}: mean ${seconds(result.planningMean)}, 99 % within ${seconds(result.planningUsual)}, max ${seconds(result.planningMost)}`],
      ...(numbers.motion ? [
        ["Latency charged", Number.isFinite(result.latency) ? `${seconds(result.latency)} for each planning` : "not recorded"],
        ...(Number.isFinite(result.clearance) ? [["Clearance", `${clearanceOf(result.clearance)}, the least between a body and a surface`]] : []),
        ...(Number.isFinite(result.separation) ? [["Between robots", `${centimetres(result.separation)}, the least between the boxes around two bodies`]] : []),
      ] : []),
      ["Contacts", [contactsText(result), bumpers(result)].filter(Boolean).join("; ")],
      ["Rays cast for planning", whole(result.rays)], ["Report written by", `frontlux ${written}`],
    ]),
    milestones(numbers),
    table("The team", ["", ...facts.robots.map((robot) => robot.name)], [
      ["moves", ...facts.robots.map((robot) => (robot.plane ? "on the ground" : "in the air"))],
      ["collision box", ...facts.robots.map((robot) => `${robot.extents.map((k) => String(Number(k.toFixed(3)))).join(" × ")} m`)],
      ["sensor", ...facts.robots.map(sensor)],
      ["path length", ...result.lengths.map(metres)],
      ...(facts.measured ? [["idle", ...result.idle.map(clockTime)], ["held back", ...result.heldBack.map((times) => (Number.isFinite(times) ? `${whole(times)} times` : "unknown"))]] : []),
      ...(anyKnown(result.inViewThen) ? [["openings too narrow", ...result.narrowBy.map((by, r) => (by > 0 ? narrowText(by, result.inViewThen[r]) : "a smaller body does not help"))]] : []),
      ...(result.withoutMinHeight.some((part) => part > 0) ? [["in view without minimum height", ...result.withoutMinHeight.map((part) => percent(part))]] : []),
      ["fraction of the known space", ...result.fractions.map((fraction) => percent(fraction))],
    ]),
    ...(result.goals.some((goal) => goal !== "") ? [table("The last goals", [], facts.robots.map(({ name }, r) => [name, result.goals[r] || "unknown"]))] : []),
  ];
  const paper = PAPER[Object.keys(PAPER).find((name) => facts.world.toLowerCase().startsWith(name))];
  if (paper) parts.push(comparedWithPaper(facts, numbers, paper));
  const all = optionsOf(facts), options = all.filter(([, value]) => value !== NOT_SET);
  const left = all.filter(([, value]) => value === NOT_SET).map(([name]) => name);
  if (left.length > 0) options.push([NOT_SET, left.join(", ")]);
  parts.push(options.length > 0 ? table("Options", [], options) : table("Options", [], [["as recorded", facts.options || "none"]]));
  return parts;
}

/** When, after how many metres and in which step so much was mapped. */
function milestones(numbers) {
  const { result } = numbers, clock = (s) => (numbers.clock ? [clockTime(numbers.time[s])] : []);
  const row = (s) => [...clock(s), metres(numbers.teamTravelled[s]), whole(numbers.steps[s])];
  const never = [...(numbers.clock ? ["never"] : []), "never", "never"];
  return table("Progress", ["mapped", ...(numbers.clock ? ["time"] : []), "path length of all robots", "step"], [
    ...MILESTONES.map((part) => {
      const s = stepOfCoverage(numbers, part);
      return [percent(part, 0), ...(s < 0 ? never : row(s))];
    }),
    [`end, ${percent(result.coverage)}`, ...row(numbers.steps.length - 1)],
  ]);
}

function comparedWithPaper(facts, numbers, paper) {
  const { result } = numbers;
  const uav = facts.robots.findIndex((robot) => !robot.plane);
  const block = table("Compared with the paper", ["", "here", "paper"], [
    ["coverage, team", percent(result.coverage), paper.coverage],
    ...(numbers.motion ? [] : [["steps", whole(result.steps), paper.steps]]), // the paper's robots move in lock-step
    [`planning, whole team (per ${numbers.motion ? "planning" : "step"})`, `${seconds(result.planningTotal)} (${seconds(result.planningMean)})`, `UAV ${paper.uav}, UGV ${paper.ugv}`],
    ["UAV's fraction of the coverage", uav < 0 ? "no UAV" : percent(result.fractions[uav], 0), `${paper.fraction} *`],
    ["UAV's path length", uav < 0 ? "no UAV" : metres(result.lengths[uav]), `${paper.path} *`],
  ]);
  block.append(el("p", { class: "note", text: "* Before / after optimisation. Deng, Xu, Zhao and Shimada, “Coordinated Aerial-Ground Robot Exploration via Monte-Carlo View Quality Rendering”. Their worlds are not published. Ours have the same names but other shapes, so metres and steps cannot be compared directly." }));
  return block;
}

/** The numbers of the steps; of many, some. Made when it is opened. */
export function stepTable(run) {
  const { facts, numbers } = run, { length } = facts.steps, each = Math.ceil(length / MOST_ROWS);
  const heads = ["step", ...(numbers.clock ? ["time"] : []), "coverage", "frontiers", "unassigned", "planning", ...facts.robots.flatMap((robot) => ["coverage", "expected", "gained", "path", "goal"].map((word) => `${robot.name} ${word}`))];
  const rows = facts.steps.map((step, s) => s).filter((s) => s % each === 0 || s === length - 1).map((s) => ({ step: facts.steps[s], s })).map(({ step, s }) => [
    step.number, ...(numbers.clock ? [clockTime(numbers.time[s])] : []), percent(numbers.coverage[s], 2), numbers.frontiers[s], numbers.unassigned[s], seconds(numbers.planning[s]),
    ...facts.robots.flatMap((_, r) => [percent(numbers.robotCoverage[r][s], 2), numbers.predicted[r][s], numbers.gained[r][s], metres(numbers.travelled[r][s]), step.number === 0 ? "scan at the start" : step.robots[r].reason || step.robots[r].state]),
  ]);
  return table(each > 1 ? `One of ${each} steps, and the last` : "Every step", heads, rows);
}

const WORDS = [
  ["Voxel", "A cube of space. It is unknown until a ray of a sensor passes through it (free) or ends in it (occupied)."],
  ["Frontier", "An unknown voxel next to a free one: the edge of the known space."],
  ["Observable space", "What the robots can observe at all: the free space that is connected with their start, and the surfaces around it. Coverage is the known fraction of it; a robot's coverage is what it observed first."],
  ["View quality", "How many frontiers a robot expects to see from a place, less the farther away it is: of the cells on the floor, or of the candidates in space, squares. Light yellow is best. Without tours the best place becomes the goal; a tour is made of places that see much and lie on the way."],
  ["Time", "The run's own clock, in seconds: how long robots with these speeds, sensors and planning times need. It stands for the end of a step."],
  ["Path length", "Of all robots together, in metres, unless a robot is named."],
  ["Explored volume", "The volume of all voxels that are known to be free or occupied, within the bounds of the map."],
  ["Step", "In lock-step: all robots plan, then move; the map grows at every viewpoint of their paths; step 0 is a scan at the start. In motion: one robot plans; its path and its scans since the planning before, and those of the others, belong to the step."],
  ["Idle", "How long a robot rested without turning, in seconds of the run's clock."],
  ["Contacts", "How often a body touched a surface. A robot with a bumper is held back before it touches one; that is counted as held back. If the map had every voxel of the box around the body as free, the contact is with a surface in free voxels."],
  ["Unseen", "Why the rest of the observable space was not mapped, by the true world, as estimated parts of all of it. Narrow: only robots that are smaller, or that fly, see it. Hidden: it is in no robot's field of view from anywhere. In view: a robot fits where it would have seen it."],
  ["Openings too narrow", "By how much the body of a robot would have to be smaller, in metres, to see at least half of what is narrow, and which part of the observable space comes into view then. Each robot is judged alone, so their parts overlap."],
  ["Accuracy of the map", "By the true world. Surface found: the part of the observable surface voxels that are occupied. False free: the part of the free voxels that hold a surface; rays that graze a surface free some of its voxels. False occupied: the part of the occupied voxels that are in free space and touch no surface."],
  ["Tour", "In motion: the places from which a robot means to look next, in order. It is dashed from the robot to its stops, the first nine with numbers. Each planning makes the tours of all robots anew."],
  ["Gain", "How many frontiers a path is expected to have in view (expected), and how many the scans of the robot made known (gained)."],
  ["Unassigned", "Frontiers that are assigned to no robot in this step."],
  ["Abandoned", "Frontiers that stayed unknown although a robot looked at them. No robot is sent to them any more."],
];

export function glossary() {
  return el("dl", { class: "words" }, ...WORDS.flatMap(([word, meaning]) => [el("dt", { text: word }), el("dd", { text: meaning })]));
}
