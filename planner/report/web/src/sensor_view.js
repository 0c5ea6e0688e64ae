import { PerspectiveCamera } from "three";
import { el } from "./dom.js";

const SLICES = 6; // of a spinning sensor's panorama
const MARGIN = 8, LARGEST = 0.42, HIGHEST = 0.36; // [px], parts of the view's width and height
const degrees = (angle) => (angle * 180) / Math.PI;

/** What a robot's sensor would see of the map that is shown, in the corner of the view: its shape, its range, from where it is. */
export class SensorView {
  constructor(host) {
    this.frame = el("div", { class: "sensor-view", hidden: true }, (this.title = el("span", {})));
    host.append(this.frame);
    this.camera = new PerspectiveCamera();
    this.camera.up.set(0, 0, 1);
  }

  /** Draws into the canvas, over what is there. @param hidden objects of the scene that no sensor sees */
  draw(renderer, scene, hidden, robot, pose, width, height) {
    const spinning = robot.shape === "spinning", slices = spinning ? SLICES : 1;
    const across = Math.tan(spinning ? Math.PI / SLICES : robot.horizontal / 2), up = Math.tan((robot.shape === "cone" ? robot.horizontal : robot.vertical) / 2);
    const aspect = across / up, each = Math.floor(Math.min((spinning ? 1.6 : 1) * LARGEST * width, HIGHEST * height * aspect * slices) / slices), high = Math.floor(each / aspect);
    const shown = hidden.map((object) => object.visible);
    hidden.forEach((object) => (object.visible = false));
    Object.assign(this.camera, { fov: degrees(2 * Math.atan(up)), aspect, near: 0.05, far: robot.max_range });
    this.camera.updateProjectionMatrix();
    this.camera.position.set(pose[0], pose[1], pose[2]);
    renderer.setScissorTest(true);
    for (let i = 0; i < slices; ++i) {
      const yaw = pose[3] + ((slices - 1) / 2 - i) * ((2 * Math.PI) / SLICES);
      this.camera.lookAt(pose[0] + Math.cos(yaw), pose[1] + Math.sin(yaw), pose[2]);
      const box = [MARGIN + i * each, height - MARGIN - high, each, high];
      renderer.setViewport(...box);
      renderer.setScissor(...box);
      renderer.render(scene, this.camera);
    }
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, width, height);
    hidden.forEach((object, i) => (object.visible = shown[i]));
    this.frame.hidden = false;
    Object.assign(this.frame.style, { width: `${slices * each + 2}px`, height: `${high + 2}px` });
    this.title.textContent = `${robot.name}: ${spinning ? "all around, ahead in the middle" : "ahead"}, ${robot.max_range} m`;
  }

  hide() {
    this.frame.hidden = true;
  }
}
