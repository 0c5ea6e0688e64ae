import { Color } from "three";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";

/** The trajectory that a robot in motion follows as of its last planning: dotted, on to its end. */
export class TrajectoryView {
  /** @param dot length of a dot [m] */
  constructor(run, r, dot) {
    this.run = run;
    this.r = r;
    const all = run.trajectories.filter((points, i) => points && i % run.robots === r);
    this.points = new Float32Array(2 * Math.max(6, ...all.map((points) => points.length)));
    this.material = new LineMaterial({ linewidth: 3, dashed: true, dashSize: dot, gapSize: dot });
    this.line = new LineSegments2(new LineSegmentsGeometry().setPositions(this.points), this.material);
    this.line.frustumCulled = false;
    this.shown = null;
  }

  get there() {
    return this.shown !== null;
  }

  /** @param step up to which plannings count */
  show(step) {
    const { run, r } = this;
    let points = null;
    for (let s = step; s >= 0 && !points; --s) points = run.trajectories[s * run.robots + r];
    if (points && points !== this.shown) this.place(points);
    this.shown = points;
  }

  place(points) {
    const segments = points.length / 3 - 1, { geometry } = this.line, { data } = geometry.attributes.instanceStart;
    for (let i = 0; i < segments; ++i) data.array.set(points.subarray(3 * i, 3 * i + 6), 6 * i);
    data.needsUpdate = true;
    geometry.instanceCount = segments;
    this.line.computeLineDistances();
  }

  setColor(css) {
    this.material.color = new Color(css);
  }

  dispose() {
    this.line.geometry.dispose();
    this.material.dispose();
  }
}
