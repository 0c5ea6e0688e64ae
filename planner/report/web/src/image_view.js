import { DataTexture, DoubleSide, Mesh, MeshBasicMaterial, NearestFilter, Plane, PlaneGeometry, SRGBColorSpace, Vector3 } from "three";
import { qualityColor } from "./palette.js";

const ORIGIN = 32768;
const MOST = 4096; // texels along an edge
const point = new Vector3();

/** Whether a robot's images are of one floor, cell by cell, and not of places anywhere. */
export function onFloor(run, robot) {
  const of = (list) => list.filter((part, i) => part && i % run.robots === robot);
  if (!run.facts.robots[robot].plane || of(run.tours).length > 0) return false;
  const { columns, rows } = boxOf(run, robot);
  return columns <= MOST && rows <= MOST && of(run.images).every((image) => image.z.every((key) => key === image.z[0]));
}

/** The view quality of a robot on a plane: the cells rendered for its goal, painted on the floor. */
export class ImageView {
  constructor(run, robot) {
    this.run = run;
    this.robot = robot;
    this.colors = Array.from({ length: 256 }, (_, i) => qualityColor(i / 255));
    this.box = boxOf(run, robot);
    this.shown = undefined; // step
    const { facts } = run, { low, columns, rows } = this.box;
    this.texels = new Uint8Array(4 * columns * rows);
    this.texture = new DataTexture(this.texels, columns, rows);
    this.texture.magFilter = this.texture.minFilter = NearestFilter;
    this.texture.colorSpace = SRGBColorSpace;
    this.material = new MeshBasicMaterial({ map: this.texture, transparent: true, side: DoubleSide, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 });
    this.mesh = new Mesh(new PlaneGeometry(1, 1), this.material);
    const size = facts.resolution;
    this.mesh.scale.set(columns * size, rows * size, 1);
    this.mesh.position.set((low[0] - ORIGIN + columns / 2) * size, (low[1] - ORIGIN + rows / 2) * size, 0);
    this.mesh.renderOrder = 1;
  }

  /** Of the step that is shown; null if it has none. */
  get shownImage() {
    return this.shown >= 0 ? this.run.images[this.shown * this.run.robots + this.robot] : null;
  }

  /** Shows the image of a step; hides it if the step has none. */
  show(step) {
    if (this.shown === step) return;
    this.shown = step;
    const image = this.shownImage;
    this.mesh.visible = image !== null;
    if (!image) return;
    const { low, columns } = this.box;
    this.texels.fill(0);
    for (let i = 0; i < image.count; ++i) {
      const at = 4 * (image.x[i] - low[0] + columns * (image.y[i] - low[1])), color = this.colors[image.quality[i]];
      for (let k = 0; k < 3; ++k) this.texels[at + k] = color[k];
      this.texels[at + 3] = 70 + 0.72 * image.quality[i]; // cells without gain do not hide the floor
    }
    this.texture.needsUpdate = true;
    this.mesh.position.z = this.floor(image.z[0]) + 0.04;
  }

  /** Height of the floor [m] below a cell of the sensor's layer. */
  floor(key) {
    const { resolution, robots } = this.run.facts;
    return (key - ORIGIN - Math.floor(robots[this.robot].sensor_height / resolution + 1e-9)) * resolution;
  }

  /** The cell of the image that is shown where a ray meets the floor: { i, distance } or null. */
  pick(ray) {
    const image = this.shownImage;
    if (!image || !ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -this.mesh.position.z), point)) return null;
    const [x, y] = [point.x, point.y].map((k) => Math.floor(k / this.run.facts.resolution) + ORIGIN);
    for (let i = 0; i < image.count; ++i) if (image.x[i] === x && image.y[i] === y) return { i, distance: point.distanceTo(ray.origin) - 0.05 };
    return null;
  }

  dispose() {
    this.texture.dispose();
    this.material.dispose();
    this.mesh.geometry.dispose();
  }
}

/** The columns of voxels that any of a robot's images covers. */
function boxOf(run, robot) {
  const low = [65535, 65535], high = [-1, -1];
  for (let s = 0; s < run.steps; ++s) {
    const image = run.images[s * run.robots + robot];
    if (!image) continue;
    for (const [k, keys] of [image.x, image.y].entries())
      for (let i = 0; i < image.count; ++i) {
        if (keys[i] < low[k]) low[k] = keys[i];
        if (keys[i] > high[k]) high[k] = keys[i];
      }
  }
  const columns = high[0] - low[0] + 1, rows = high[1] - low[1] + 1;
  return { low, columns, rows };
}
