import { BoxGeometry, BufferAttribute, BufferGeometry, Color, ConeGeometry, DoubleSide, EdgesGeometry, Group, InstancedMesh, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, Object3D, OctahedronGeometry } from "three";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { poseAt } from "./run_data.js";

const spot = new Object3D();

/** One robot: its collision box, the field of view, the travelled path, the planned path and the goal. */
export class RobotView {
  constructor(run, r) {
    this.run = run;
    this.r = r;
    this.pose = new Float64Array(4);
    this.robot = run.facts.robots[r];
    this.materials = {
      body: new MeshLambertMaterial(),
      edge: new LineBasicMaterial(),
      view: new LineBasicMaterial({ transparent: true, opacity: 0.75 }),
      beam: new MeshBasicMaterial({ transparent: true, opacity: 0.1, side: DoubleSide, depthWrite: false }),
      trail: new LineMaterial({ linewidth: 3, transparent: true }),
      recent: new LineMaterial({ linewidth: 3 }),
      plan: new LineMaterial({ linewidth: 1.6, transparent: true, opacity: 0.85 }),
      stem: new LineBasicMaterial({ transparent: true, opacity: 0.7, depthTest: false }),
      goal: new MeshLambertMaterial({ transparent: true, depthTest: false }),
    };
    this.body = this.makeBody();
    this.view = this.makeView();
    this.trail = this.makeTrail();
    this.recent = this.makeLines(new Float32Array(this.trailPoints.length), this.materials.recent);
    this.last = Infinity; // [s], in steps without a clock, of the trail that stands out
    this.plan = this.makePlan();
    this.goal = this.makeGoal();
    this.shown = undefined;
  }

  /** The box of whole voxels that has to be free around the robot, and a wedge that shows its yaw. */
  makeBody() {
    const { robot } = this, size = this.run.facts.resolution;
    const odd = (length) => 2 * Math.ceil((length / size - 1) / 2 - 1e-9) + 1;
    const [x, y] = robot.extents.map((length) => odd(length) * size);
    let z = odd(robot.extents[2]) * size, middle = 0;
    if (robot.plane) {
      const layer = Math.floor(robot.sensor_height / size + 1e-9);
      z = Math.max(Math.ceil(robot.extents[2] / size - 1e-9), layer + 1) * size;
      middle = z / 2 - robot.sensor_height;
    }
    const group = new Group();
    const solid = new Mesh(new BoxGeometry(...robot.extents), this.materials.body);
    solid.position.z = robot.plane ? robot.extents[2] / 2 - robot.sensor_height : 0;
    const box = new LineSegments(new EdgesGeometry(new BoxGeometry(x, y, z)), this.materials.edge);
    box.position.z = middle;
    this.nose = new Mesh(new ConeGeometry(0.22, 0.5, 4).rotateZ(-Math.PI / 2), this.materials.body);
    this.nose.position.z = robot.plane ? 0.05 : 0;
    this.noseAhead = Math.max(...robot.extents) / 2 + 0.25;
    group.add(solid, box, this.nose);
    return group;
  }

  makeView() {
    const { robot } = this, lines = [], faces = [], range = robot.max_range;
    const line = (a, b) => lines.push(...a, ...b);
    if (robot.shape === "pyramid") {
      const w = Math.tan(robot.horizontal / 2), h = Math.tan(robot.vertical / 2);
      const far = (u, v) => [1, u * w, v * h].map((k) => (k * range) / Math.hypot(1, u * w, v * h));
      const corners = [far(1, 1), far(-1, 1), far(-1, -1), far(1, -1)], n = 8;
      corners.forEach((corner) => line([0, 0, 0], corner));
      [[1, 1, -1, 1], [-1, 1, -1, -1], [-1, -1, 1, -1], [1, -1, 1, 1]].forEach(([u0, v0, u1, v1]) => {
        for (let i = 0; i < n; ++i) {
          const a = far(u0 + ((u1 - u0) * i) / n, v0 + ((v1 - v0) * i) / n), b = far(u0 + ((u1 - u0) * (i + 1)) / n, v0 + ((v1 - v0) * (i + 1)) / n);
          line(a, b);
          faces.push(0, 0, 0, ...a, ...b);
        }
      });
    } else {
      const spinning = robot.shape === "spinning", n = 64;
      const tilt = spinning ? robot.vertical / 2 : robot.horizontal / 2;
      const rings = spinning ? [-tilt, tilt] : [tilt];
      const point = (ring, i) => {
        const turn = (2 * Math.PI * i) / n;
        return spinning
          ? [Math.cos(ring) * Math.cos(turn) * range, Math.cos(ring) * Math.sin(turn) * range, Math.sin(ring) * range]
          : [Math.cos(ring) * range, Math.sin(ring) * Math.cos(turn) * range, Math.sin(ring) * Math.sin(turn) * range];
      };
      for (const ring of rings)
        for (let i = 0; i < n; ++i) {
          line(point(ring, i), point(ring, i + 1));
          if (i % 16 === 0) line([0, 0, 0], point(ring, i));
        }
    }
    const group = new Group();
    const wires = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(lines), 3));
    group.add(new LineSegments(wires, this.materials.view));
    if (faces.length > 0) {
      const beam = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(faces), 3));
      const mesh = new Mesh(beam, this.materials.beam);
      mesh.renderOrder = 3;
      group.add(mesh);
    }
    return group;
  }

  /** The travelled path of the whole run; `instanceCount` says how much of it is shown. */
  makeTrail() {
    const { run, r } = this, points = [];
    this.trailEnd = []; // segments by the end of each step
    for (let s = 0; s < run.steps; ++s) {
      const path = run.paths[s * run.robots + r];
      for (let i = 0; i + 1 < path.travelled; ++i) {
        const at = path.begin + 4 * i;
        points.push(...run.poses.subarray(at, at + 3), ...run.poses.subarray(at + 4, at + 7));
      }
      this.trailEnd.push(points.length / 6);
    }
    if (points.length === 0) points.push(0, 0, 0, 0, 0, 0);
    this.trailPoints = Float32Array.from(points);
    return this.makeLines(points, this.materials.trail);
  }

  makeLines(points, material) {
    const lines = new LineSegments2(new LineSegmentsGeometry().setPositions(points), material);
    lines.frustumCulled = false;
    return lines;
  }

  /** The path planned in one step, with an arrow at each viewpoint. */
  makePlan() {
    const { run, r } = this;
    let most = 2;
    for (let s = 0; s < run.steps; ++s) most = Math.max(most, run.paths[s * run.robots + r].count);
    this.planPoints = new Float32Array(6 * most);
    this.planLine = this.makeLines(this.planPoints, this.materials.plan);
    this.arrows = new InstancedMesh(new ConeGeometry(0.16, 0.62, 4).rotateZ(-Math.PI / 2), this.materials.body, most);
    this.arrows.frustumCulled = false;
    return new Group().add(this.planLine, this.arrows);
  }

  makeGoal() {
    const stem = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array([0, 0, 0, 0, 0, -1]), 3));
    this.stem = new LineSegments(stem, this.materials.stem);
    this.gem = new Mesh(new OctahedronGeometry(0.5), this.materials.goal);
    const goal = new Group().add(this.stem, this.gem);
    for (const part of goal.children) part.renderOrder = 900; // over everything
    return goal;
  }

  setColor(css, ink) {
    const color = new Color(css);
    for (const material of Object.values(this.materials)) material.color.copy(color);
    this.materials.edge.color.set(ink);
  }

  /** @param floor [m] where the goal's stem ends */
  show(step, along, floor) {
    const { run, r } = this;
    poseAt(run, Math.max(step, 0), r, step < 0 ? 0 : along, this.pose);
    const [x, y, z, yaw] = this.pose;
    this.body.position.set(x, y, z);
    this.nose.rotation.z = yaw;
    this.nose.position.set(Math.cos(yaw) * this.noseAhead, Math.sin(yaw) * this.noseAhead, this.nose.position.z);
    this.view.position.set(x, y, z);
    this.view.rotation.z = yaw;
    const path = run.paths[Math.max(step, 0) * run.robots + r];
    const before = step > 0 ? this.trailEnd[step - 1] : 0, here = Math.max(0, path.travelled - 1);
    this.showTrail(before + Math.floor(Math.min(along, 1) * here), step, along);
    this.showGoal(run.facts.steps[run.motion && along < 1 ? step - 1 : step]?.robots[r].goal, floor);
    if (this.shown === step) return;
    this.shown = step;
    this.showPlan(path);
  }

  /** So many segments; those of the last seconds stand out. */
  showTrail(end, step, along) {
    const { time } = this.run.numbers, now = (time[step - 1] ?? 0) + along * ((time[step] ?? 0) - (time[step - 1] ?? 0));
    const old = Number.isFinite(this.last) ? time.findIndex((ended) => ended > now - this.last) : 0;
    const begin = Math.min(end, old > 0 ? this.trailEnd[old - 1] : 0), { data } = this.recent.geometry.attributes.instanceStart;
    this.trail.geometry.instanceCount = end;
    this.materials.trail.opacity = begin > 0 ? 0.25 : 1;
    this.recent.geometry.instanceCount = begin > 0 ? end - begin : 0;
    if (begin === 0) return;
    data.array.set(this.trailPoints.subarray(6 * begin, 6 * end));
    data.needsUpdate = true;
  }

  showPlan(path) {
    const { run } = this, segments = Math.max(0, path.count - 1), start = this.planLine.geometry.attributes.instanceStart.data;
    for (let i = 0; i < segments; ++i)
      for (let k = 0; k < 6; ++k) start.array[6 * i + k] = run.poses[path.begin + 4 * i + (k < 3 ? k : k + 1)];
    start.needsUpdate = true;
    this.planLine.geometry.instanceCount = segments;
    for (let i = 0; i < path.count; ++i) {
      const at = path.begin + 4 * i;
      spot.position.set(run.poses[at], run.poses[at + 1], run.poses[at + 2]);
      spot.rotation.z = run.poses[at + 3];
      spot.updateMatrix();
      this.arrows.setMatrixAt(i, spot.matrix);
    }
    this.arrows.count = path.count;
    this.arrows.instanceMatrix.needsUpdate = true;
  }

  showGoal(goal, floor) {
    this.goal.userData.there = goal !== undefined;
    if (!goal) return;
    this.goal.position.set(goal[0], goal[1], goal[2]);
    this.stem.scale.z = Math.max(0.01, goal[2] - floor);
  }

  /** The viewpoint of the plan nearest to a ray: { i, distance } or null. */
  pickViewpoint(ray, within) {
    const { run, r } = this, path = run.paths[Math.max(this.shown ?? 0, 0) * run.robots + r];
    let best = null;
    for (let i = 0; i < path.count; ++i) {
      const at = path.begin + 4 * i;
      spot.position.set(run.poses[at], run.poses[at + 1], run.poses[at + 2]);
      const along = spot.position.clone().sub(ray.origin).dot(ray.direction);
      if (along <= 0 || ray.distanceToPoint(spot.position) > within) continue;
      if (!best || along < best.distance) best = { i, distance: along };
    }
    return best;
  }

  dispose() {
    for (const part of [this.body, this.view, this.trail, this.recent, this.plan, this.goal]) part.traverse((object) => object.geometry?.dispose());
    for (const material of Object.values(this.materials)) material.dispose();
  }
}
