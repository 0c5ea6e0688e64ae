import { Raycaster, Vector2 } from "three";
import { FREE, OCCUPIED, UNKNOWN } from "./run_data.js";
import { clockTime } from "./run_numbers.js";

const ORIGIN = 32768;
const FAR = 4000; // voxels looked at along a ray
const raycaster = new Raycaster();

/** The nearest object shown at a position of the view, from -1 to 1 along both axes. */
export function pick(scene, x, y) {
  raycaster.setFromCamera(new Vector2(x, y), scene.camera);
  const { ray } = raycaster, found = [];
  if (scene.layers.voxels || scene.layers.frontiers) found.push(pickVoxel(scene, ray));
  if (scene.layers.planned) found.push(...scene.robots.map((robot) => pickViewpoint(scene, robot, ray)));
  if (scene.layers.tours) found.push(...scene.tours.map((tour) => pickStop(tour, ray)));
  if (scene.layers.quality) found.push(...scene.images.map((image) => pickCell(image, ray)));
  return found.filter(Boolean).sort((a, b) => a.distance - b.distance)[0] ?? null;
}

/** Visits the voxels along the ray until one is drawn. */
function pickVoxel(scene, ray) {
  const { store, voxels } = scene, size = voxels.resolution, { mesher } = voxels;
  const origin = ray.origin.toArray().map((k) => k / size + ORIGIN), direction = ray.direction.toArray();
  const key = origin.map(Math.floor), sign = direction.map(Math.sign);
  const next = direction.map((d, k) => (d === 0 ? Infinity : (key[k] + (d > 0 ? 1 : 0) - origin[k]) / d));
  const each = direction.map((d) => (d === 0 ? Infinity : Math.abs(1 / d)));
  let last = UNKNOWN, entered = 0;
  for (let steps = 0; steps < FAR; ++steps) {
    const shown = key[2] < mesher.cut, voxel = shown ? store.at(...key) : FREE, state = voxel & 3;
    const seen = last === FREE || (mesher.closed && last === UNKNOWN);
    if (state === OCCUPIED && seen && scene.layers.voxels) return { kind: "voxel", key: [...key], voxel, distance: entered * size };
    if (state === UNKNOWN && shown && scene.layers.frontiers && nearMiddle(origin, direction, key) && isFrontier(scene, key))
      return { kind: "frontier", key: [...key], voxel, distance: entered * size };
    last = state;
    const axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : next[1] < next[2] ? 1 : 2;
    entered = next[axis];
    next[axis] += each[axis];
    key[axis] += sign[axis];
  }
  return null;
}

/** Frontiers are drawn as dots: the ray has to pass within 0.4 voxels of the middle. */
function nearMiddle(origin, direction, key) {
  const to = key.map((k, i) => k + 0.5 - origin[i]);
  const along = to.reduce((sum, k, i) => sum + k * direction[i], 0);
  return to.reduce((sum, k) => sum + k * k, 0) - along * along < 0.16;
}

function isFrontier(scene, [x, y, z]) {
  const [low, high] = scene.run.facts.bounds;
  if ([x, y, z].some((k, i) => k < low[i] || k > high[i])) return false;
  return [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]].some(([dx, dy, dz]) => (scene.store.at(x + dx, y + dy, z + dz) & 3) === FREE);
}

function pickViewpoint(scene, robot, ray) {
  const hit = robot.pickViewpoint(ray, 0.3);
  return hit && { kind: "viewpoint", robot: robot.r, i: hit.i, distance: hit.distance - 0.3 };
}

function pickStop(tour, ray) {
  const hit = tour.pick(ray, 0.4);
  return hit && { kind: "stop", robot: tour.r, i: hit.i, tour: tour.shown, distance: hit.distance - 0.4 };
}

function pickCell(image, ray) {
  const hit = image.mesh.visible ? image.pick(ray) : null;
  return hit && { kind: "cell", robot: image.robot, image: image.shownImage, ...hit };
}

/** What was picked, in words: [name, value] pairs. */
export function describePick(scene, hit) {
  const { run, store } = scene, { facts } = run, size = facts.resolution;
  const metres = (key) => key.map((k) => ((k - ORIGIN + 0.5) * size).toFixed(2)).join(", ") + " m";
  if (hit.kind === "voxel" || hit.kind === "frontier") {
    const rows = [[hit.kind === "voxel" ? "Occupied voxel" : "Frontier", metres(hit.key)], ["Key", hit.key.join(", ")]];
    const owner = hit.kind === "frontier" ? store.assignment.ownerOf(...hit.key) : 0;
    if (owner > 0) rows.push(["Assigned to", facts.robots[owner - 1].name]);
    if (hit.kind === "voxel") {
      const owner = (hit.voxel >> 2) - 1, since = store.since(...hit.key);
      rows.push(["First seen by", facts.robots[owner]?.name ?? "?"]);
      if (since >= 0) rows.push(["Occupied since", `step ${facts.steps[since].number}${run.numbers?.clock ? `, ${clockTime(run.numbers.time[since])}` : ""}`]);
    }
    return rows;
  }
  const name = facts.robots[hit.robot].name, step = scene.position.step;
  if (hit.kind === "cell") {
    const { image } = hit;
    return [
      ["Candidate", `${metres([image.x[hit.i], image.y[hit.i], image.z[hit.i]])}, ${name}`],
      ["View quality", ((image.quality[hit.i] / 255) ** 2 * image.qualityMost).toFixed(1)],
      ["Expected gain", `${((image.gain[hit.i] / 255) * image.gainMost).toFixed(0)} frontiers`],
    ];
  }
  if (hit.kind === "stop") {
    const { tour, i } = hit, [x, y, z, yaw] = run.poses.subarray(tour.begin + 4 * i, tour.begin + 4 * i + 4);
    return [
      ["Stop of the tour", `${i + 1} of ${tour.count}, ${name}`],
      ["To look at", `${tour.frontiers[i]} frontiers in ${tour.clusters[i]} ${tour.clusters[i] === 1 ? "cluster" : "clusters"}`],
      ...placeOf(x, y, z, yaw),
    ];
  }
  const path = run.paths[step * run.robots + hit.robot], at = path.begin + 4 * hit.i, [x, y, z, yaw] = run.poses.subarray(at, at + 4);
  const planned = facts.steps[step].robots[hit.robot];
  const place = [
    [run.motion ? "Scan" : "Viewpoint", `${hit.i + 1} of ${path.count}, ${name}, step ${facts.steps[step].number}`],
    ...placeOf(x, y, z, yaw),
  ];
  if (run.motion) return place;
  return [
    ...place,
    ["Gain of the path", `${planned.gain_predicted} frontiers expected, ${planned.gained} gained`],
    ["Reached", hit.i < path.travelled ? "yes" : "no"],
  ];
}

const placeOf = (x, y, z, yaw) => [["Position", `${x.toFixed(2)}, ${y.toFixed(2)}, ${z.toFixed(2)} m`], ["Yaw", `${((yaw * 180) / Math.PI).toFixed(1)}°`]];
