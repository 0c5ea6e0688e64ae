import { el, table } from "./dom.js";
import { NOT_GIVEN, metres, optionsOf, percent, seconds, stepOfCoverage, whole } from "./run_numbers.js";

// Deng, Xu, Zhao and Shimada's results, by world: team's coverage and steps, planning of each robot in all and
// per step, share of what the UAV saw and its path, both before and after optimisation.
const PAPER = {
  maze: { coverage: "97.2 %", steps: "69", uav: "2.6 min (2.26 s)", ugv: "0.14 s (2 ms)", share: "57 / 64 %", path: "286 / 252 m" },
  factory: { coverage: "97.5 %", steps: "74", uav: "5.6 min (4.54 s)", ugv: "4.0 s (54 ms)", share: "72 / 93 %", path: "777 / 232 m" },
  station: { coverage: "96.0 %", steps: "137", uav: "10.4 min (4.55 s)", ugv: "18.6 s (136 ms)", share: "66 / 81 %", path: "713 / 316 m" },
};

const ENDS = {
  quiet: "the paths promised too little for some steps running",
  nothing_to_do: "no robot had anything left to do",
  step_limit: "the limit on steps was reached",
  stopped: "it was stopped",
};

/** Why a run is over, as the end of a sentence. */
export function ending(facts) {
  return facts.end === null ? "the recording breaks off here" : (ENDS[facts.end] ?? facts.end);
}

export function teamName(facts) {
  return facts.robots.map((robot) => robot.name).join(" + ");
}

function headline(run) {
  const { facts, numbers } = run, { result } = numbers;
  const box = Number.isFinite(result.coverageBox) ? ` (${percent(result.coverageBox)} of the world's box)` : "";
  return `${facts.robots.length > 1 ? "The team" : "The robot"} came to know ${percent(result.coverage)} of what can be observed${box} in ${result.steps} steps. It ended because ${ending(facts)}.`;
}

function worldsOf(runs) {
  const worlds = [...new Set(runs.map((run) => run.facts.world))];
  return `${worlds.length > 1 ? "Worlds" : "World"}: ${worlds.join(", ")}. The replay shows one of the runs at a time.`;
}

/** The first thing a reader sees: what was run and what came of it. */
export function header(runs, written) {
  const [{ facts, numbers }] = runs, { result } = numbers;
  const single = runs.length === 1;
  const tile = (name, value, note) => el("div", { class: "tile" }, el("dt", { text: name }), el("dd", {}, el("strong", { text: value }), note ? el("span", { class: "note", text: note }) : null));
  const tiles = single
    ? el("dl", { class: "tiles" },
        tile("coverage", percent(result.coverage), "of the observable"),
        tile("steps", whole(result.steps)),
        tile("path length", metres(result.length), facts.robots.length > 1 ? facts.robots.map((robot, r) => `${robot.name} ${metres(result.lengths[r])}`).join(", ") : ""),
        tile("planning a step", seconds(result.planningMean), `at most ${seconds(result.planningMost)}`),
        tile("collisions", whole(result.collisions)))
    : null;
  return [
    el("div", { class: "title" }, el("h1", { text: single ? `${facts.world}, explored by ${teamName(facts)}` : `${runs.length} runs compared` }),
    el("p", { class: "lead", text: single ? headline(runs[0]) : worldsOf(runs) }),
    ),
    tiles,
    runs.some((run) => run.facts.truncated) ? el("p", { class: "warning", text: "The recording's last step is unfinished and was left out." }) : null,
  ].filter(Boolean);
}

/** A run a line, against the first. */
export function comparison(runs) {
  const first = runs[0].numbers.result;
  const against = (result, name) => (result === first || !(first[name] > 0) ? "" : ` (${signed(result[name], first[name])})`);
  const reached = (numbers, share, tell) => {
    const s = stepOfCoverage(numbers, share);
    return s < 0 ? "never" : tell(s);
  };
  const heads = ["run", "team", "coverage", "steps", "steps to 90 %", "to 95 %", "path length", "metres to 90 %", "planning a step", "collisions"];
  return table("Side by side", heads, runs.map(({ name, facts, numbers }) => [
    name, teamName(facts), percent(numbers.result.coverage),
    `${numbers.result.steps}${against(numbers.result, "steps")}`,
    reached(numbers, 0.9, (s) => numbers.steps[s]), reached(numbers, 0.95, (s) => numbers.steps[s]),
    `${metres(numbers.result.length)}${against(numbers.result, "length")}`,
    reached(numbers, 0.9, (s) => metres(numbers.teamTravelled[s])),
    seconds(numbers.result.planningMean), whole(numbers.result.collisions),
  ]));
}

function signed(value, reference) {
  const share = (100 * (value - reference)) / reference;
  return `${share >= 0 ? "+" : "−"}${Math.abs(share).toFixed(0)} %`;
}

/** All else that is known of a run: team, options, the paper's numbers. */
export function details(run, written) {
  const { facts, numbers } = run, { result } = numbers;
  const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(0)}°`;
  const sensor = (robot) => {
    const rays = robot.columns * robot.rows > 0 ? `, ${robot.columns} × ${robot.rows} rays` : "";
    if (robot.shape === "spinning") return `all around, ±${degrees(robot.vertical / 2)} up and down, ${metres(robot.max_range)}${rays}`;
    if (robot.shape === "pyramid") return `${degrees(robot.horizontal)} × ${degrees(robot.vertical)}, ${metres(robot.max_range)}${rays}`;
    return `cone of ${degrees(robot.horizontal)}, ${metres(robot.max_range)}${rays}`;
  };
  const parts = [
    table("The run", [], [
      ["World", facts.world], ["Seed", optionsOf(facts).find(([name]) => name === "seed")?.[1] ?? "not recorded"], ["Voxels", `${facts.resolution} m`],
      ["Observable", facts.observable > 0 ? `${whole(facts.observable)} voxels` : "unknown"],
      ["Coverage", `${percent(result.coverage)} of the observable, ${percent(result.coverageBox)} of the box`],
      ["Steps", `${whole(result.steps)}, after the look around at the start`], ["Ended because", ending(facts)],
      ["Planning", `${seconds(result.planningTotal)} in all, ${seconds(result.planningMean)} a step, at most ${seconds(result.planningMost)}`],
      ["Rays cast to plan", whole(result.rays)], ["Collisions", whole(result.collisions)], ["Report by", `frontlux ${written}`],
    ]),
    table("The team", ["", ...facts.robots.map((robot) => robot.name)], [
      ["moves", ...facts.robots.map((robot) => (robot.plane ? "on the ground" : "in the air"))],
      ["collision box", ...facts.robots.map((robot) => `${robot.extents.map((k) => k.toFixed(1)).join(" × ")} m`)],
      ["sensor", ...facts.robots.map(sensor)],
      ["path", ...result.lengths.map(metres)],
      ["share of what is known", ...result.shares.map((share) => percent(share))],
    ]),
  ];
  const paper = PAPER[Object.keys(PAPER).find((name) => facts.world.toLowerCase().startsWith(name))];
  if (paper) parts.push(besidePaper(facts, result, paper));
  const all = optionsOf(facts), options = all.filter(([, value]) => value !== NOT_GIVEN);
  const left = all.filter(([, value]) => value === NOT_GIVEN).map(([name]) => name);
  if (left.length > 0) options.push(["not given", left.join(", ")]);
  parts.push(options.length > 0 ? table("Options", [], options) : table("Options", [], [["as recorded", facts.options || "none"]]));
  return parts;
}

function besidePaper(facts, result, paper) {
  const uav = facts.robots.findIndex((robot) => !robot.plane);
  const block = table("Beside the paper's numbers", ["", "here", "paper"], [
    ["coverage, team", percent(result.coverage), paper.coverage],
    ["steps", whole(result.steps), paper.steps],
    ["planning, whole team (a step)", `${seconds(result.planningTotal)} (${seconds(result.planningMean)})`, `UAV ${paper.uav}, UGV ${paper.ugv}`],
    ["UAV's share of the coverage", uav < 0 ? "no UAV" : percent(result.shares[uav], 0), `${paper.share} *`],
    ["UAV's path", uav < 0 ? "no UAV" : metres(result.lengths[uav]), `${paper.path} *`],
  ]);
  block.append(el("p", { class: "note", text: "* Before / after optimisation. Deng, Xu, Zhao and Shimada, “Coordinated Aerial-Ground Robot Exploration via Monte-Carlo View Quality Rendering”. Their worlds are not published: ours have the same name and kind, not the same shape, so metres and steps are no contest." }));
  return block;
}

/** Every step's numbers, for those who would rather read. Made when it is opened. */
export function stepTable(run) {
  const { facts, numbers } = run;
  const heads = ["step", "known", "frontiers", "nobody's", "planning", ...facts.robots.flatMap((robot) => ["part", "predicted", "gained", "path", "goal"].map((word) => `${robot.name} ${word}`))];
  const rows = facts.steps.map((step, s) => [
    step.number, percent(numbers.coverage[s], 2), numbers.frontiers[s], numbers.unassigned[s], seconds(numbers.planning[s]),
    ...facts.robots.flatMap((_, r) => [percent(numbers.robotCoverage[r][s], 2), numbers.predicted[r][s], numbers.gained[r][s], metres(numbers.travelled[r][s]), step.number === 0 ? "looks around" : step.robots[r].reason || step.robots[r].state]),
  ]);
  return table("Every step", heads, rows);
}

const WORDS = [
  ["Voxel", "A cube of space. It is unknown until a sensor's ray goes through it (free) or ends in it (occupied)."],
  ["Frontier", "An unknown voxel next to a free one: where known space ends and more may be found."],
  ["Observable", "What robots can get to know at all: the free space that is connected with their start, and the surfaces around it. Coverage is the known share of it."],
  ["View quality", "Painted on the floor: how many frontiers the ground robot expects to see from there, less the further away it is. Light yellow is best; its goal is the best place."],
  ["Step", "All robots plan, then go; the map grows at every viewpoint on the way. Step 0 is a look around at the start."],
  ["Gain", "Frontiers that a path will have in view (predicted), and those of them that became known (gained)."],
  ["Given up", "Frontiers that stayed unknown although they were looked at; no robot goes for them any more."],
];

export function glossary() {
  return el("dl", { class: "words" }, ...WORDS.flatMap(([word, meaning]) => [el("dt", { text: word }), el("dd", { text: meaning })]));
}
