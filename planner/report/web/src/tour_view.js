import { CanvasTexture, Color, Group, InstancedInterleavedBuffer, InterleavedBufferAttribute, Sprite, SpriteMaterial, SRGBColorSpace, Vector3 } from "three";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";

const NUMBERED = 9; // stops; those after are dots
const DISC = 19, DOT = 9; // [px]
const spot = new Vector3();

/** The planned tour of one robot: a dashed line from the robot to each stop in order, whose first stops have numbers. */
export class TourView {
  /** @param dash length of a dash [m] */
  constructor(run, r, dash) {
    this.run = run;
    this.r = r;
    const most = run.tours.reduce((count, tour, i) => (tour && i % run.robots === r ? Math.max(count, tour.count) : count), 1);
    this.points = new Float32Array(6 * most);
    this.distances = new Float32Array(2 * most);
    this.material = new LineMaterial({ linewidth: 2.4, dashed: true, dashSize: dash, gapSize: 0.7 * dash });
    const geometry = new LineSegmentsGeometry().setPositions(this.points);
    const along = new InstancedInterleavedBuffer(this.distances, 2, 1);
    geometry.setAttribute("instanceDistanceStart", new InterleavedBufferAttribute(along, 1, 0));
    geometry.setAttribute("instanceDistanceEnd", new InterleavedBufferAttribute(along, 1, 1));
    this.buffers = [geometry.attributes.instanceStart.data, along];
    this.line = new LineSegments2(geometry, this.material);
    this.line.frustumCulled = false;
    this.line.renderOrder = 4;
    this.marks = Array.from({ length: most }, (_, i) => this.makeMark(i));
    this.group = new Group().add(this.line, ...this.marks);
    this.shown = null;
  }

  makeMark(i) {
    const mark = new Sprite(new SpriteMaterial({ transparent: true, depthTest: false, depthWrite: false, sizeAttenuation: false }));
    mark.renderOrder = 1000 - i; // the next stop is on top
    return mark;
  }

  /** Whether there is a tour to show. */
  get there() {
    return this.shown !== null;
  }

  /** @param step of the last planning that counts @param pose where the robot is */
  show(step, pose) {
    const { run } = this, tour = step < 0 ? null : run.tours[step * run.robots + this.r];
    if (tour && this.shown !== tour) this.place(tour);
    this.shown = tour;
    if (!tour) return;
    // The line begins at the robot, wherever it is.
    const points = this.buffers[0].array;
    for (let k = 0; k < 3; ++k) points[k] = pose[k];
    this.buffers[1].array[0] = -Math.hypot(points[3] - points[0], points[4] - points[1], points[5] - points[2]);
    for (const buffer of this.buffers) buffer.needsUpdate = true;
  }

  place({ begin, count }) {
    const [{ array: points }, { array: along }] = this.buffers, { poses } = this.run;
    let length = 0;
    for (let i = 0; i < count; ++i) {
      for (let k = 0; k < 3; ++k) {
        points[6 * i + k] = i > 0 ? poses[begin + 4 * (i - 1) + k] : 0;
        points[6 * i + 3 + k] = poses[begin + 4 * i + k];
      }
      along[2 * i] = length;
      if (i > 0) length += Math.hypot(...[0, 1, 2].map((k) => points[6 * i + 3 + k] - points[6 * i + k]));
      along[2 * i + 1] = length;
      this.marks[i].position.fromArray(points, 6 * i + 3);
    }
    this.line.geometry.instanceCount = count;
    this.marks.forEach((mark, i) => (mark.visible = i < count));
  }

  setColor(css, paper) {
    this.material.color = new Color(css);
    this.disposeMarks();
    this.marks.forEach((mark, i) => {
      const number = i < NUMBERED ? i + 1 : 0;
      mark.material.map = (this.textures[number] ??= disc(number, css, paper));
      mark.material.needsUpdate = true;
    });
  }

  /** @param unit height of the view's image plane at a distance of 1, divided by the pixels of the view's height */
  setScale(unit) {
    this.marks.forEach((mark, i) => mark.scale.setScalar(unit * (i < NUMBERED ? DISC : DOT)));
  }

  /** The stop nearest to a ray: { i, distance } or null. */
  pick(ray, within) {
    if (!this.shown) return null;
    let best = null;
    for (let i = 0; i < this.shown.count; ++i) {
      spot.copy(this.marks[i].position);
      if (ray.distanceToPoint(spot) > within) continue;
      const distance = spot.distanceTo(ray.origin);
      if (!best || distance < best.distance) best = { i, distance };
    }
    return best;
  }

  disposeMarks() {
    for (const texture of this.textures ?? []) texture?.dispose();
    this.textures = [];
  }

  dispose() {
    this.disposeMarks();
    this.line.geometry.dispose();
    this.material.dispose();
    for (const mark of this.marks) mark.material.dispose();
  }
}

/** A disc with a number, or a dot for 0. */
function disc(number, css, paper) {
  const canvas = document.createElement("canvas"), size = 64;
  canvas.width = canvas.height = size;
  const paint = canvas.getContext("2d");
  paint.fillStyle = css;
  paint.strokeStyle = paper;
  paint.lineWidth = number > 0 ? 5 : 12;
  paint.beginPath();
  paint.arc(size / 2, size / 2, size / 2 - paint.lineWidth / 2 - 1, 0, 2 * Math.PI);
  paint.fill();
  paint.stroke();
  if (number > 0) {
    paint.fillStyle = paper;
    paint.font = "bold 40px system-ui, sans-serif";
    paint.textAlign = "center";
    paint.textBaseline = "middle";
    paint.fillText(String(number), size / 2, size / 2 + 3);
  }
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return texture;
}
