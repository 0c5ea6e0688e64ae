import { RunError } from "./byte_reader.js";
import { Charts } from "./charts.js";
import { el } from "./dom.js";
import { positionAt, sameWorld } from "./comparison.js";
import { comparison } from "./comparison_view.js";
import { details, glossary, header, stepTable, teamName } from "./facts_view.js";
import { addKeys } from "./keys.js";
import { describePick, pick } from "./picking.js";
import { robotColor } from "./palette.js";
import { placeText, readPlace } from "./place.js";
import { readRun } from "./run_data.js";
import { clockTime, numbersOf, percent, seconds } from "./run_numbers.js";
import { save, viewPicture } from "./save.js";
import { NoWebGL, ReplayScene } from "./scene.js";
import { makeTimeControls } from "./time_controls.js";
import { Timeline } from "./timeline.js";
import { makeToolbar } from "./toolbar.js";

const root = document.documentElement;
const dark = matchMedia("(prefers-color-scheme: dark)");

function themeNow() {
  return root.dataset.theme ?? (dark.matches ? "dark" : "light");
}

/** The whole page. */
class Page {
  constructor(runs) {
    this.runs = runs;
    this.shown = 0;
    this.timeline = new Timeline(this.run.numbers.time);
    this.build();
    this.timeline.addEventListener("change", ({ detail }) => this.show(detail));
    dark.addEventListener("change", () => this.setTheme());
    addKeys(this);
    this.select(0);
    addEventListener("resize", () => this.fit());
    addEventListener("beforeprint", () => this.preparePrint());
    addEventListener("afterprint", () => this.endPrint());
    this.goTo(location.hash);
    addEventListener("hashchange", () => location.hash !== this.hash && this.goTo(location.hash));
    this.noted = this.place();
  }

  get run() {
    return this.runs[this.shown];
  }

  build() {
    const { runs } = this, written = runs[0].facts.written_by;
    this.view = el("div", { class: "view", id: "view" });
    this.beside = el("div", { class: "view", id: "beside-view" });
    this.picked = el("div", { class: "picked", id: "picked", role: "status", hidden: true });
    this.controls = makeTimeControls(this.timeline, () => this.run);
    this.chartHost = el("div", { class: "charts", id: "charts" });
    this.details = el("section", { class: "details", "aria-label": "Facts" });
    this.views = el("div", { class: "views" }, this.view, this.beside);
    this.stage = el("section", { class: "stage", "aria-label": "Replay" }, this.views, this.controls.bar);
    this.makeScene();
    const choose = runs.length > 1 ? el("label", { class: "field" }, el("span", { text: "Replay" }), el("select", { id: "run", on: { change: (event) => this.select(Number(event.target.value)) } }, ...runs.map((run, i) => el("option", { value: i, text: run.name })))) : null;
    const choices = [el("option", { value: -1, text: "none" }), ...runs.map((run, i) => el("option", { value: i, text: run.name }))];
    const chooseBeside = runs.length > 1 && this.scene ? el("label", { class: "field", title: "another run at the same time of its clock" }, el("span", { text: "Beside" }), el("select", { id: "beside", on: { change: (event) => this.showBeside(Number(event.target.value)) } }, ...choices)) : null;
    this.themeButton = el("button", { type: "button", id: "theme", on: { click: () => this.switchTheme() } });
    this.steps = el("details", { class: "fold", on: { toggle: () => this.fillSteps() } }, el("summary", { text: "Table of steps" }), el("div", { class: "body" }));
    document.getElementById("app").replaceChildren(
      el("header", {}, el("div", { class: "corner" }, choose, chooseBeside, this.themeButton), ...header(runs)),
      runs.length > 1 ? el("section", { class: "comparison", "aria-label": "Comparison" }, ...comparison(runs)) : null,
      el("div", { class: "main" }, this.stage, el("section", { "aria-label": "Charts" }, this.chartHost)),
      this.details, this.steps,
      el("details", { class: "fold" }, el("summary", { text: "Glossary" }), glossary()),
      el("details", { class: "fold" }, el("summary", { text: "Mouse and keys" }), keyTable()));
    for (const child of [...document.getElementById("app").childNodes]) if (child.nodeType === Node.TEXT_NODE) child.remove();
  }

  /** The stage fills the window below the header, and the whole window once the header is scrolled away. */
  fit() {
    const top = this.stage.parentElement.offsetTop;
    root.style.setProperty("--head", `${Math.min(top, innerHeight / 3)}px`);
  }

  makeScene() {
    try {
      this.scene = new ReplayScene(this.view);
    } catch (error) {
      if (!(error instanceof NoWebGL)) throw error;
      this.scene = null;
      this.view.append(el("div", { class: "no-webgl", id: "no-webgl", role: "note" }, el("strong", { text: "The 3-D replay needs WebGL 2, which is not available in this browser." }), el("p", { text: "Enable hardware acceleration, or open this file in another browser. The time line, charts and tables work without it." })));
      return;
    }
    const { canvas } = this.scene;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "3-D map. Drag to turn, right-drag to move, wheel to zoom, or use the keys W A S D, Q E, R V, plus and minus. The table of steps below holds the numbers of the same run.");
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.describe([["WebGL context lost", "reload the page to see the map again"]]);
    });
    canvas.addEventListener("pointerdown", (event) => (this.pressed = [event.clientX, event.clientY]));
    canvas.addEventListener("click", (event) => {
      const [x, y] = this.pressed ?? [0, 0];
      if (Math.hypot(event.clientX - x, event.clientY - y) < 4) this.pickAt(event.offsetX, event.offsetY);
    });
    this.scene.controls.addEventListener("change", () => this.notePlace());
    this.view.append(this.picked);
  }

  /** Replays another run. */
  select(i) {
    this.shown = i;
    this.fit();
    const { run } = this, theme = themeNow();
    this.toolbar?.bar.remove();
    this.toolbar?.key.remove();
    if (this.scene) {
      this.scene.theme = theme;
      this.scene.load(run);
      this.toolbar = makeToolbar(this.scene, run, () => this.savePicture());
      this.stage.prepend(this.toolbar.bar);
      this.views.append(this.toolbar.key);
    }
    this.details.replaceChildren(...details(run, run.facts.written_by));
    this.steps.open = false;
    this.steps.lastElementChild.replaceChildren();
    this.charts ??= new Charts(this.chartHost, this.timeline);
    this.charts.load(this.runs, i, theme);
    this.timeline.reset(run.numbers.time);
    this.controls.chooseSpeed();
    this.nameViews();
    this.setTheme();
  }

  place() {
    const { time, step, along } = this.timeline;
    return placeText({ time, step: along === 1 ? step : null, run: this.shown, camera: this.scene?.place });
  }

  /** Shows the run, the moment and the place that an address names. */
  goTo(hash) {
    const { time, step, run, camera } = readPlace(hash);
    if (run !== null && run !== this.shown && this.runs[run]) {
      this.select(run);
      document.getElementById("run").value = String(run);
    }
    if (time !== null) this.timeline.seekTime(time, step);
    if (camera && this.scene) this.scene.place = camera;
  }

  /** Once nothing changes for a moment, the address says what is shown. */
  notePlace() {
    clearTimeout(this.noting);
    this.noting = setTimeout(() => {
      const place = this.place();
      if (this.timeline.playing || place === this.noted) return;
      this.noted = this.hash = place;
      history.replaceState(null, "", place);
    }, 300);
  }

  /** A dark page wastes ink, so it turns light; a canvas keeps no picture for the printer, so views become pictures. */
  preparePrint() {
    this.themeWished = root.dataset.theme;
    root.dataset.theme = "light";
    this.setTheme();
    this.charts.print();
    for (const scene of [this.scene, this.besideRun && this.second].filter(Boolean)) {
      scene.setTheme("light");
      scene.render();
      scene.canvas.after(el("img", { class: "print-view", alt: "The map as it is shown on the screen", src: scene.canvas.toDataURL("image/png") }));
    }
  }

  endPrint() {
    for (const picture of document.querySelectorAll(".print-view")) picture.remove();
    if (this.themeWished) root.dataset.theme = this.themeWished;
    else delete root.dataset.theme;
    this.setTheme();
    this.charts.endPrint(themeNow());
  }

  /** The view as a PNG file. */
  async savePicture() {
    if (!this.scene) return;
    const { run, timeline } = this, { facts } = run, number = facts.steps[timeline.step].number;
    const moment = run.numbers.clock ? clockTime(timeline.time) : `step ${number}`;
    const robots = facts.robots.map((robot) => ({ name: robot.name, color: robotColor(robot, this.scene.theme) }));
    const blob = await viewPicture(this.scene, `${facts.world}, ${moment}, ${percent(run.numbers.coverage[this.scene.mapStep] ?? 0)} mapped`, robots);
    save(`${run.name}_${moment}.png`, blob);
  }

  /** Replays another run in a second view, at the same time; -1: none. */
  showBeside(i) {
    this.views.classList.toggle("two", i >= 0);
    this.besideRun = i >= 0 ? this.runs[i] : null;
    this.scene.resize();
    if (i < 0) return;
    if (!this.second) {
      this.second = new ReplayScene(this.beside);
      this.second.canvas.setAttribute("aria-label", "3-D map of the run beside. It follows the first map.");
      this.beside.append((this.besideName = el("div", { class: "view-name" })));
      this.view.append((this.viewName = el("div", { class: "view-name" })));
      const together = () => this.besideRun && sameWorld(this.run, this.besideRun);
      this.scene.onDraw = () => {
        if (this.besideRun) this.second.mirror(this.scene);
        if (together()) this.second.lookAs(this.scene);
      };
      this.second.onDraw = () => together() && this.scene.lookAs(this.second);
    }
    this.second.load(this.besideRun);
    this.second.mirrored = null;
    this.nameViews();
    this.showSecond();
    this.scene.draw();
  }

  nameViews() {
    if (!this.second || !this.besideRun) return;
    this.viewName.textContent = this.run.name;
    this.besideName.textContent = this.besideRun.name;
  }

  showSecond() {
    if (this.besideRun) this.second.show(positionAt(this.besideRun.numbers.time, this.timeline.time));
  }

  show(position) {
    this.scene?.show(position);
    this.showSecond();
    this.charts.mark(position.step);
    this.notePlace();
    if (this.describedStep !== position.step) this.describe(null);
    this.describedStep = position.step;
  }

  fillSteps() {
    const body = this.steps.lastElementChild;
    if (this.steps.open && body.childElementCount === 0) body.append(stepTable(this.run));
  }

  switchTheme() {
    root.dataset.theme = themeNow() === "dark" ? "light" : "dark";
    this.setTheme();
  }

  setTheme() {
    const theme = themeNow();
    this.themeButton.textContent = theme === "dark" ? "Light" : "Dark";
    this.themeButton.setAttribute("aria-label", `Switch to ${theme === "dark" ? "light" : "dark"} colours`);
    if (this.scene && this.scene.theme !== theme) this.scene.setTheme(theme);
    this.toolbar?.drawKey();
    if (this.charts.theme !== theme) this.charts.build(theme);
  }

  /** At a place of the view, in its pixels. */
  pickAt(x, y) {
    const { clientWidth: width, clientHeight: height } = this.view;
    const hit = pick(this.scene, (2 * x) / width - 1, 1 - (2 * y) / height);
    this.describe(hit && describePick(this.scene, hit));
    return hit;
  }

  describe(rows) {
    this.picked.hidden = !rows;
    this.picked.replaceChildren(...(rows ?? []).map(([name, value]) => el("div", {}, el("span", { class: "note", text: name }), el("span", { text: value }))));
  }
}

function keyTable() {
  const keys = [
    ["Space", "play, pause"], ["← →", "previous step, next step"], ["Home End", "first, last step"], ["1 to 9, 0", "layers on and off"],
    ["H T", "show the whole map, view from above"], ["F", "camera: next robot or none"], ["P", "save the view as a picture"], ["W A S D", "move over the map"], ["Q E, R V", "turn, tilt"], ["+ −", "zoom in, out"],
    ["Mouse", "drag to turn, right-drag to move, wheel to zoom, click for details of a voxel, viewpoint or cell"],
  ];
  return el("dl", { class: "words" }, ...keys.flatMap(([key, meaning]) => [el("dt", { text: key }), el("dd", { text: meaning })]));
}

async function start() {
  const sources = [...document.querySelectorAll("script.run")];
  const runs = [];
  for (const source of sources) {
    const run = await readRun(source.textContent);
    source.remove();
    runs.push(Object.assign(run, { name: run.facts.name, numbers: numbersOf(run.facts) }));
  }
  return new Page(runs);
}

window.frontlux = { ready: false };
start().then(
  (page) => Object.assign(window.frontlux, { page, ready: true, team: teamName, percent, seconds }),
  (error) => {
    window.frontlux.error = String(error);
    const said = error instanceof RunError ? error.message : `${error.message}. Make it again with frontlux report, or open it in a newer browser.`;
    document.getElementById("app").replaceChildren(el("p", { class: "warning", text: `This report cannot be shown: ${said}` }));
    throw error;
  },
);
