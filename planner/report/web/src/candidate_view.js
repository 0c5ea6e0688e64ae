import { BufferAttribute, BufferGeometry, Color, GLSL3, Points, RawShaderMaterial, Vector3 } from "three";
import { SCENE, qualityColor } from "./palette.js";
import { SQUARE_FRAGMENT, SQUARE_VERTEX } from "./shaders.js";

const ORIGIN = 32768;
const spot = new Vector3();

/** The view quality of a robot's candidates that lie anywhere in space: a square in the middle of each cell. */
export class CandidateView {
  constructor(run, robot) {
    this.run = run;
    this.robot = robot;
    this.shown = undefined; // step
    const most = run.images.reduce((count, image, i) => (image && i % run.robots === robot ? Math.max(count, image.count) : count), 0);
    this.colors = Array.from({ length: 256 }, (_, i) => qualityColor(i / 255));
    const geometry = new BufferGeometry();
    this.places = new BufferAttribute(new Float32Array(3 * most), 3);
    this.tints = new BufferAttribute(new Uint8Array(4 * most), 4, true); // red, green, blue, quality
    geometry.setAttribute("position", this.places).setAttribute("tint", this.tints);
    const uniforms = { size: { value: 100 }, paper: { value: new Vector3() } };
    this.mesh = new Points(geometry, new RawShaderMaterial({ glslVersion: GLSL3, vertexShader: SQUARE_VERTEX, fragmentShader: SQUARE_FRAGMENT, uniforms }));
    this.mesh.frustumCulled = false;
  }

  /** The candidates of the step that is shown; null if it has none. */
  get shownImage() {
    return this.shown >= 0 ? this.run.images[this.shown * this.run.robots + this.robot] : null;
  }

  show(step) {
    if (this.shown === step) return;
    this.shown = step;
    const image = this.shownImage;
    this.mesh.visible = image !== null;
    if (!image) return;
    for (let i = 0; i < image.count; ++i) {
      this.places.setXYZ(i, ...this.placeOf(image, i));
      this.tints.array.set([...this.colors[image.quality[i]], image.quality[i]], 4 * i);
    }
    this.places.needsUpdate = this.tints.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, image.count);
  }

  /** The middle of a cell [m]. */
  placeOf(image, i) {
    return [image.x[i], image.y[i], image.z[i]].map((key) => (key - ORIGIN + 0.5) * this.run.facts.resolution);
  }

  setTheme(theme) {
    const { r, g, b } = new Color(SCENE[theme].background).convertLinearToSRGB();
    this.mesh.material.uniforms.paper.value.set(r, g, b);
  }

  /** @param pixels height of the view @param slope tangent of half the camera's opening angle */
  setPointScale(pixels, slope) {
    this.mesh.material.uniforms.size.value = (this.run.facts.resolution * pixels) / (2 * slope);
  }

  /** The candidate nearest to the viewer among those at a ray: { i, distance } or null. */
  pick(ray) {
    const image = this.shownImage, within = 0.5 * this.run.facts.resolution;
    let best = null;
    for (let i = 0; image && i < image.count; ++i) {
      spot.set(...this.placeOf(image, i));
      if (ray.distanceToPoint(spot) > within) continue;
      const distance = spot.distanceTo(ray.origin) - within;
      if (!best || distance < best.distance) best = { i, distance };
    }
    return best;
  }

  dispose() {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}
