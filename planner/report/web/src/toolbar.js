import { el, swatch } from "./dom.js";
import { LAYERS } from "./scene.js";
import { CandidateView } from "./candidate_view.js";
import { SCENE, qualityColor, qualityStops, robotColor, scaleGradient } from "./palette.js";

const NAMES = {
  voxels: "Voxels", frontiers: "Frontiers", quality: "View quality", robots: "Robots",
  views: "Fields of view", travelled: "Travelled paths", planned: "Planned paths", goals: "Goals",
  tours: "Tours", trajectories: "Trajectories",
};

/** Controls for layers, colours and the camera. */
export function makeToolbar(scene, { facts, motion, numbers }, savePicture) {
  const assigned = scene.run.reassigned.some(([x]) => x.length > 0);
  const boxes = {}, absent = { tours: scene.tours.length === 0, trajectories: scene.trajectories.length === 0, quality: scene.images.length === 0 };
  const layer = (name, i) => {
    if (absent[name]) return null; // the keys of the others stay
    boxes[name] = el("input", { type: "checkbox", id: `layer-${name}`, on: { change: (event) => scene.setLayer(name, event.target.checked) } });
    boxes[name].checked = scene.layers[name];
    const [text, title] = motion && name === "planned" ? ["Scans", "where robots took scans since the planning before, "] : [NAMES[name], ""];
    return el("label", { class: "chip", title: `${title}key ${(i + 1) % 10}` }, boxes[name], el("span", { text }));
  };
  const select = (id, label, choices, change, chosen) => el("label", { class: "field" }, el("span", { text: label }), el("select", { id, on: { change: (event) => change(event.target.value) } }, ...choices.map(([value, text]) => el("option", { value, text, selected: value === chosen }))));
  const check = (id, label, title, change, checked) => el("label", { class: "chip", title }, el("input", { type: "checkbox", id, checked, on: { change: (event) => change(event.target.checked) } }), el("span", { text: label }));
  const colors = select("colors", "Colour by", [["height", "height"], ["owner", "first robot"]], (value) => {
    scene.setByOwner(value === "owner");
    drawKey();
  }, scene.byOwner ? "owner" : "height");
  const unit = numbers.clock ? "s" : "steps";
  const trail = select("trail", "Trail", [["Infinity", "whole"], ["30", `last 30 ${unit}`], ["10", `last 10 ${unit}`]], (value) => scene.setTrail(Number(value)));
  const follow = select("follow", "Follow", [["-1", "none"], ...facts.robots.map((robot, r) => [String(r), robot.name])], (value) => scene.setFollow(Number(value)));
  const sensor = select("sensor", "Sensor's view", [["-1", "none"], ...facts.robots.map((robot, r) => [String(r), robot.name])], (value) => scene.setSensor(Number(value)));
  const layers = scene.layerCount();
  const cut = el("input", { type: "range", id: "cut", min: 1, max: layers, step: 1, on: { input: () => scene.setCut(Number(cut.value)) } });
  cut.value = layers;
  const view = (id, text, title, act) => el("button", { type: "button", id, title, text, on: { click: () => { act(); follow.querySelector("select").value = "-1"; } } });
  const key = el("div", { class: "key", "aria-label": "Colours" });
  const drawKey = () => {
    const theme = scene.theme, size = facts.resolution, [low, high] = scene.store.heights;
    const bar = (colors, from, to, name) => {
      const strip = el("span", { class: "strip", "aria-hidden": "true" });
      strip.style.background = scaleGradient(colors);
      return el("div", {}, el("span", { text: name }), el("span", { class: "note from", text: from }), strip, el("span", { class: "note", text: to }));
    };
    const dot = (color, text, kind) => el("span", {}, swatch(color, kind), text), { ink } = SCENE[theme];
    key.replaceChildren(
      ...(scene.byOwner ? [] : [bar(SCENE[theme].heights, `${((low - 32768) * size).toFixed(1)} m`, `${((high + 1 - 32768) * size).toFixed(1)} m`, "height")]),
      ...(scene.images.length > 0 ? [bar(qualityStops(), "low", "high", "view quality")] : []),
      el("div", { class: "names" }, dot(SCENE[theme].frontier, assigned ? "frontier of nobody or several" : "frontier", "dot"), ...(assigned ? facts.robots.map((robot) => dot(robotColor(robot, theme), `of ${robot.name}`, "dot")) : []), ...facts.robots.map((robot) => dot(robotColor(robot, theme), robot.name))),
      el("div", { class: "names" }, dot(ink, "travelled", "line"), dot(ink, motion ? "scan" : "planned", "thin"),
        scene.trajectories.length > 0 ? dot(ink, "planned trajectory", "dotted") : null,
        scene.tours.length > 0 ? dot(ink, "planned tour", "tour") : null, dot(ink, "goal", "diamond"),
        scene.images.some((image) => image instanceof CandidateView) ? dot(`rgb(${qualityColor(0.5).join(",")})`, "candidate") : null));
  };
  drawKey();
  const bar = el("div", { class: "toolbar" },
    el("fieldset", { class: "layers" }, el("legend", { text: "Layers" }), ...LAYERS.map(layer)),
    el("fieldset", {}, el("legend", { text: "View" }),
      view("view-home", "Whole map", "the whole map from one side (H)", () => scene.home()), view("view-top", "From above", "the whole map from above (T)", () => scene.top()), el("button", { type: "button", id: "save-view", title: "save what the view shows as a PNG picture (P)", text: "Save PNG", on: { click: savePicture } }), follow, sensor, trail, colors,
      el("label", { class: "field", title: "hide the voxels above" }, el("span", { text: "Cut above" }), cut),
      check("closed", "Back faces", "also show the faces next to unknown space", (on) => scene.setClosed(on), false),
      check("as-planned", "Before the step", "show the map on which the step was planned, instead of the map after it", (on) => scene.setAsPlanned(on), scene.asPlanned)));
  return {
    bar, key, drawKey,
    toggleLayer(i) {
      const name = LAYERS[i];
      if (!boxes[name]) return;
      boxes[name].checked = !boxes[name].checked;
      scene.setLayer(name, boxes[name].checked);
    },
    nextFollow() {
      const field = follow.querySelector("select");
      field.value = String(scene.follow + 2 > facts.robots.length ? -1 : scene.follow + 1);
      scene.setFollow(Number(field.value));
    },
    noFollow() {
      follow.querySelector("select").value = "-1";
    },
  };
}
