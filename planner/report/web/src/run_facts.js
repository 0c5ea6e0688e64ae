import { damaged } from "./byte_reader.js";

// What src/run_facts.cpp writes, an example of each. A number that is not finite is written as null.
const ROBOT = { name: "", plane: true, extents: [0], sensor_height: 0, shape: "", horizontal: 0, vertical: 0, max_range: 0, columns: 0, rows: 0, colors: [""] };
const ROBOT_STEP = { state: "", reason: "", path: "", gain_predicted: 0, gained: 0, length: 0 };
const STEP = { number: 0, time: 0, frontiers: 0, unassigned: 0, abandoned: 0, rays: 0, contacts: 0, seconds: [0], known: [[0]], robots: [ROBOT_STEP] };
const FACTS = {
  name: "", written_by: "", world: "", resolution: 0, bounds: [[0]], observable: 0, bounding: 0, options: "", truncated: true,
  phases: [""], robots: [ROBOT], steps: [STEP],
};
const MEASURED = { // null without a run.json
  clearance_min_m: 0, separation_min_m: 0, contacts_in_free: 0, warnings: [""], surface_out_of_bounds: 0, unseen: { in_view: 0, narrow: 0, hidden: 0 }, map: { false_free: 0, false_occupied: 0, surface_found: 0 },
  robots: [{ idle_s: 0, held_back: 0, narrow_by_m: 0, in_view_then: 0, without_min_height: 0, goal: "" }],
};

function check(value, example, name) {
  if (Array.isArray(example)) {
    if (!Array.isArray(value)) throw damaged(`${name} is no list`);
    value.forEach((item, i) => check(item, example[0], `${name}[${i}]`));
  } else if (typeof example === "object") {
    if (typeof value !== "object" || value === null) throw damaged(`${name} is no object`);
    for (const member of Object.keys(example)) check(value[member], example[member], `${name}.${member}`);
  } else if (typeof value !== typeof example && !(typeof example === "number" && value === null)) throw damaged(`${name} is no ${typeof example}`);
}

function checkLength(list, length, name) {
  if (list.length !== length) throw damaged(`${name} has ${list.length} elements instead of ${length}`);
}

/** The facts of a run, from JSON. Throws a RunError unless they have the shape that the page relies on. */
export function readFacts(text) {
  let facts;
  try {
    facts = JSON.parse(text);
  } catch {
    throw damaged("the facts are no JSON");
  }
  check(facts, FACTS, "facts");
  if (!(facts.resolution > 0)) throw damaged(`facts.resolution is ${facts.resolution}`);
  if (facts.end !== null) check(facts.end, "", "facts.end");
  if (facts.measured !== null) {
    check(facts.measured, MEASURED, "facts.measured");
    checkLength(facts.measured.robots, facts.robots.length, "what was measured of the robots");
  }
  checkLength(facts.bounds, 2, "facts.bounds");
  for (const corner of facts.bounds) checkLength(corner, 3, "a corner of facts.bounds");
  if (facts.robots.length === 0 || facts.steps.length === 0) throw damaged("there are no robots or no steps");
  for (const robot of facts.robots) {
    checkLength(robot.extents, 3, "the extents of a robot");
    checkLength(robot.colors, 2, "the colours of a robot");
    if (!robot.colors.every((color) => /^#[0-9a-f]{6}$/.test(color))) throw damaged("a colour of a robot is none");
    if (robot.start !== undefined) checkPose(robot.start, "the start of a robot");
  }
  for (const step of facts.steps) {
    checkLength(step.seconds, facts.phases.length, "the seconds of a step");
    for (const list of [step.known, step.robots]) checkLength(list, facts.robots.length, "a list by robot");
    for (const known of step.known) checkLength(known, 2, "known voxels");
    for (const robot of step.robots)
      if (robot.goal !== undefined) checkPose(robot.goal, "a goal");
  }
  return facts;
}

function checkPose(pose, name) {
  check(pose, [0], name);
  checkLength(pose, 4, name);
}
