import { AmbientLight, Color, DirectionalLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { CandidateView } from "./candidate_view.js";
import { ImageView, onFloor } from "./image_view.js";
import { RobotView } from "./robot_view.js";
import { SensorView } from "./sensor_view.js";
import { TourView } from "./tour_view.js";
import { TrajectoryView } from "./trajectory_view.js";
import { VoxelStore } from "./voxel_store.js";
import { VoxelView } from "./voxel_view.js";
import { SCENE, robotColor } from "./palette.js";
import { el } from "./dom.js";

const ORIGIN = 32768;
const SLOPE = Math.tan((40 / 2 / 180) * Math.PI);

export const LAYERS = ["voxels", "frontiers", "quality", "robots", "views", "travelled", "planned", "goals", "tours", "trajectories"];

/** Thrown where the browser cannot draw in three dimensions. */
export class NoWebGL extends Error {}

/** The replay in 3-D. Draws only when something has changed. */
export class ReplayScene {
  constructor(host) {
    this.host = host;
    // Checked first, because the renderer writes to the console if it fails.
    if (!document.createElement("canvas").getContext("webgl2")) throw new NoWebGL("there is no WebGL 2");
    try {
      this.renderer = new WebGLRenderer({ antialias: false, powerPreference: "high-performance" });
    } catch (error) {
      throw new NoWebGL(error.message);
    }
    this.canvas = this.renderer.domElement;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.camera = new PerspectiveCamera(40, 1, 0.3, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.screenSpacePanning = false;
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 1;
    this.controls.addEventListener("start", () => (this.standing = null));
    this.controls.addEventListener("change", () => this.draw());
    this.scene = new Scene();
    this.scene.add(new AmbientLight(0xffffff, 1.9), makeSun());
    this.layers = Object.fromEntries(LAYERS.map((name) => [name, true]));
    this.byOwner = false;
    this.asPlanned = false; // the map before the step instead of after it
    this.follow = -1;
    this.theme = "light";
    this.standing = null; // direction from which the whole map is shown, until the user moves the camera
    this.labels = [];
    this.drawn = 0; // frames, for tests
    this.position = { step: 0, along: 1 };
    this.frame = () => this.render();
    host.prepend(this.canvas);
    this.sensorView = new SensorView(host);
    this.sensor = -1; // robot whose sensor's view is shown
    new ResizeObserver(() => this.resize()).observe(host);
  }

  load(run) {
    this.unload();
    this.run = run;
    this.store = new VoxelStore(run);
    this.voxels = new VoxelView(this.store, run.facts);
    this.robots = run.facts.robots.map((_, r) => new RobotView(run, r));
    const { half } = this.extent(), dash = Math.hypot(...half) / 35;
    this.tours = run.tours.some(Boolean) ? run.facts.robots.map((_, r) => new TourView(run, r, dash)) : [];
    this.trajectories = run.trajectories.some(Boolean) ? run.facts.robots.map((_, r) => new TrajectoryView(run, r, dash / 4)) : [];
    const rated = run.facts.robots.map((_, r) => r).filter((r) => run.images.some((image, i) => image && i % run.robots === r));
    this.images = rated.map((r) => (onFloor(run, r) ? new ImageView(run, r) : new CandidateView(run, r)));
    this.scene.add(this.voxels.voxels, this.voxels.frontiers);
    for (const robot of this.robots) this.scene.add(robot.body, robot.view, robot.trail, robot.recent, robot.plan, robot.goal);
    for (const tour of this.tours) this.scene.add(tour.group);
    for (const trajectory of this.trajectories) this.scene.add(trajectory.line);
    for (const image of this.images) this.scene.add(image.mesh);
    this.labels = run.facts.robots.map((robot) => el("div", { class: "robot-label", "aria-hidden": "true", text: robot.name }));
    this.host.append(...this.labels);
    this.sensor = -1;
    this.setTheme(this.theme);
    this.resize();
    this.home();
  }

  unload() {
    if (!this.run) return;
    this.voxels.dispose();
    for (const part of [...this.robots, ...this.images, ...this.tours, ...this.trajectories]) part.dispose();
    for (const label of this.labels) label.remove();
    this.scene.clear();
    this.scene.add(new AmbientLight(0xffffff, 1.9), makeSun());
  }

  /** Shows a step: its end, or the robots on their paths. */
  show(position) {
    const { step, along } = position;
    this.position = { step, along };
    this.store.seek(this.mapStep);
    this.voxels.update();
    const old = this.follow >= 0 ? this.robots[this.follow].pose.slice() : null;
    for (const robot of this.robots) robot.show(step, along, (this.store.heights[0] + 1 - ORIGIN) * this.run.facts.resolution);
    // A robot in motion plans at the end of a step, in lock-step at its begin.
    for (const tour of this.tours) tour.show(along < 1 ? step - 1 : step, this.robots[tour.r].pose);
    for (const trajectory of this.trajectories) trajectory.show(along < 1 ? step - 1 : step);
    for (const image of this.images) image.show(this.run.motion && along < 1 ? step - 1 : step);
    if (old) this.moveBy(this.robots[this.follow].pose, old);
    this.applyLayers();
    this.draw();
  }

  /** The step after which the map was as it is shown; -1: before the start. */
  get mapStep() {
    const { step, along } = this.position;
    return this.asPlanned || along < 1 ? step - 1 : step;
  }

  moveBy(pose, old) {
    const by = new Vector3(pose[0] - old[0], pose[1] - old[1], pose[2] - old[2]);
    this.camera.position.add(by);
    this.controls.target.add(by);
    this.controls.update();
  }

  setFollow(r) {
    this.follow = r;
    if (r < 0) return;
    this.standing = null;
    const target = new Vector3(...this.robots[r].pose.subarray(0, 3));
    const back = this.camera.position.clone().sub(this.controls.target).clampLength(8, 22);
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(back);
    this.controls.update();
    this.draw();
  }

  applyLayers() {
    const { layers } = this;
    this.voxels.voxels.visible = layers.voxels;
    this.voxels.frontiers.visible = layers.frontiers;
    for (const robot of this.robots) {
      robot.body.visible = layers.robots;
      robot.view.visible = layers.views;
      robot.trail.visible = layers.travelled && robot.trail.geometry.instanceCount > 0;
      robot.recent.visible = layers.travelled && robot.recent.geometry.instanceCount > 0;
      robot.plan.visible = layers.planned;
      robot.goal.visible = layers.goals && robot.goal.userData.there;
    }
    for (const tour of this.tours) tour.group.visible = layers.tours && tour.there;
    for (const trajectory of this.trajectories) trajectory.line.visible = layers.trajectories && trajectory.there;
    for (const image of this.images) image.mesh.visible = layers.quality && image.shownImage !== null;
  }

  setLayer(name, on) {
    this.layers[name] = on;
    this.applyLayers();
    this.draw();
  }

  setTheme(theme) {
    this.theme = theme;
    this.scene.background = new Color(SCENE[theme].background);
    if (!this.run) return;
    this.voxels.setColors(theme, this.byOwner);
    for (const robot of this.robots) robot.setColor(robotColor(robot.robot, theme), SCENE[theme].ink);
    for (const image of this.images) image.setTheme?.(theme);
    for (const trajectory of this.trajectories) trajectory.setColor(robotColor(this.run.facts.robots[trajectory.r], theme));
    for (const tour of this.tours) tour.setColor(robotColor(this.run.facts.robots[tour.r], theme), SCENE[theme].background);
    this.labels.forEach((label, r) => (label.style.borderColor = robotColor(this.run.facts.robots[r], theme)));
    this.draw();
  }

  setByOwner(byOwner) {
    this.byOwner = byOwner;
    this.setTheme(this.theme);
  }

  /** Number of voxel layers that are shown, from the lowest. */
  setCut(layers) {
    this.voxels.setCut(layers >= this.layerCount() ? 65536 : this.store.low[2] + layers);
    this.show(this.position);
  }

  layerCount() {
    return this.store.high[2] - this.store.low[2] + 1;
  }

  /** How much of the travelled paths stands out [s], in steps without a clock. */
  setTrail(last) {
    for (const robot of this.robots) robot.last = last;
    this.show(this.position);
  }

  setClosed(closed) {
    this.voxels.setClosed(closed);
    this.show(this.position);
  }

  setAsPlanned(asPlanned) {
    this.asPlanned = asPlanned;
    this.show(this.position);
  }

  /** The centre of the box of all voxels that become known, and half its edges [m]. */
  extent() {
    const size = this.run.facts.resolution;
    const low = this.store.low.map((k) => (k - ORIGIN) * size), high = this.store.high.map((k) => (k + 1 - ORIGIN) * size);
    return { middle: low.map((k, i) => (k + high[i]) / 2), half: low.map((k, i) => (high[i] - k) / 2) };
  }

  /** From above and from one side, with the whole map in view. */
  home() {
    const { half } = this.extent();
    const long = half[0] >= half[1];
    this.look(new Vector3(long ? -0.25 : -1, long ? -1 : -0.25, 1.15));
  }

  top() {
    this.look(new Vector3(0, -1e-4, 1));
  }

  look(from) {
    const { middle, half } = this.extent(), target = new Vector3(...middle);
    this.follow = -1;
    this.standing = from.clone();
    this.controls.target.copy(target);
    this.camera.position.copy(target).add(from.normalize());
    this.camera.lookAt(target);
    this.camera.updateMatrixWorld();
    // The smallest distance at which all corners of the box are in view.
    const turned = this.camera.matrixWorldInverse.copy(this.camera.matrixWorld).invert();
    let distance = 2;
    for (let corner = 0; corner < 8; ++corner) {
      const q = new Vector3(...half.map((k, i) => ((corner >> i) & 1 ? k : -k)));
      const length = q.length();
      q.transformDirection(turned).multiplyScalar(length);
      distance = Math.max(distance, q.z + Math.abs(q.y) / SLOPE, q.z + Math.abs(q.x) / (SLOPE * this.camera.aspect));
    }
    this.camera.position.copy(target).addScaledVector(from, 1.02 * distance);
    const size = Math.hypot(...half);
    this.camera.near = Math.max(0.1, size / 400);
    this.camera.far = distance * 4 + size * 8;
    this.controls.maxDistance = distance * 4;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** For keys: angles [rad], fractions of the distance. */
  orbit(turn, tilt) {
    this.standing = null;
    const offset = this.camera.position.clone().sub(this.controls.target), length = offset.length();
    const azimuth = Math.atan2(offset.y, offset.x) + turn;
    const polar = Math.min(Math.max(Math.acos(offset.z / length) + tilt, 1e-3), Math.PI - 1e-3);
    offset.set(Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar)).multiplyScalar(length);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  pan(right, ahead) {
    this.standing = null;
    const offset = this.camera.position.clone().sub(this.controls.target), length = offset.length();
    const forward = new Vector3(-offset.x, -offset.y, 0);
    if (forward.length() < 1e-6) forward.set(0, 1, 0);
    forward.normalize();
    const by = new Vector3(forward.y, -forward.x, 0).multiplyScalar(right * length).addScaledVector(forward, ahead * length);
    this.camera.position.add(by);
    this.controls.target.add(by);
    this.controls.update();
    this.draw();
  }

  zoom(factor) {
    this.standing = null;
    const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    for (const tour of this.tours ?? []) tour.setScale((2 * SLOPE) / height);
    for (const points of [this.voxels, ...(this.images ?? [])]) points?.setPointScale?.(height * this.renderer.getPixelRatio(), SLOPE);
    if (this.standing) this.look(this.standing);
    this.draw();
  }

  /** Where the camera is and looks: six numbers [m]. */
  get place() {
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()];
  }

  set place(numbers) {
    this.standing = null;
    this.follow = -1;
    this.camera.position.fromArray(numbers);
    this.controls.target.fromArray(numbers, 3);
    this.controls.update();
    this.draw();
  }

  /** Once, at the next frame. */
  draw() {
    if (this.waiting || !this.run) return;
    this.waiting = requestAnimationFrame(this.frame);
  }

  render() {
    this.waiting = 0;
    ++this.drawn;
    this.renderer.render(this.scene, this.camera);
    this.drawSensorView();
    this.placeLabels();
    this.onDraw?.();
  }

  drawSensorView() {
    const robot = this.robots[this.sensor];
    if (!robot) return this.sensorView.hide();
    const hidden = [this.voxels.frontiers, robot.body, ...this.robots.flatMap(({ view, trail, recent, plan, goal }) => [view, trail, recent, plan, goal]), ...this.tours.map((tour) => tour.group), ...this.trajectories.map((trajectory) => trajectory.line), ...this.images.map((image) => image.mesh)];
    this.sensorView.draw(this.renderer, this.scene, hidden, robot.robot, robot.pose, this.host.clientWidth, this.host.clientHeight);
  }

  setSensor(r) {
    this.sensor = r;
    this.draw();
  }

  /** Shows what another scene shows of its run: layers, colours and cut. */
  mirror(other) {
    const { cut, closed } = other.voxels.mesher;
    const asOther = JSON.stringify([other.layers, other.byOwner, other.theme, other.asPlanned, cut, closed, other.robots[0].last]);
    if (this.mirrored === asOther) return;
    this.mirrored = asOther;
    Object.assign(this.layers, other.layers);
    this.byOwner = other.byOwner;
    this.voxels.setCut(cut);
    this.voxels.setClosed(closed);
    this.asPlanned = other.asPlanned;
    for (const robot of this.robots) robot.last = other.robots[0].last;
    this.setTheme(other.theme);
    this.show(this.position);
  }

  /** Looks from where another scene does. */
  lookAs(other) {
    const close = 1e-4; // [m]
    if (this.camera.position.distanceTo(other.camera.position) < close && this.controls.target.distanceTo(other.controls.target) < close) return;
    this.standing = null;
    this.camera.near = other.camera.near;
    this.camera.far = other.camera.far;
    this.controls.maxDistance = other.controls.maxDistance;
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  placeLabels() {
    const { clientWidth: width, clientHeight: height } = this.host;
    this.robots.forEach((robot, r) => {
      spot.set(robot.pose[0], robot.pose[1], robot.pose[2] + 0.9).project(this.camera);
      const there = this.layers.robots && Math.abs(spot.x) < 1 && Math.abs(spot.y) < 1 && spot.z < 1;
      this.labels[r].hidden = !there;
      if (there) this.labels[r].style.transform = `translate(-50%, -100%) translate(${((spot.x + 1) / 2) * width}px, ${((1 - spot.y) / 2) * height}px)`;
    });
  }

  /** Frames a second while the camera turns, waiting for each frame. */
  measure(frames) {
    const gl = this.renderer.getContext(), began = performance.now();
    const pixel = new Uint8Array(4);
    for (let i = 0; i < frames; ++i) {
      this.orbit((2 * Math.PI) / frames, 0);
      this.render();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits until everything is drawn
    }
    return (1000 * frames) / (performance.now() - began);
  }
}

const spot = new Vector3();

function makeSun() {
  const sun = new DirectionalLight(0xffffff, 1.6);
  sun.position.set(-0.4, -0.7, 1);
  return sun;
}
