import { el } from "./dom.js";
import { clockTime, percent } from "./run_numbers.js";

// Drawn as paths in a square of 16, since not every font has these symbols.
const ICONS = {
  play: "M4 2v12l9-6z", pause: "M3 2h3.6v12H3zM9.4 2H13v12H9.4z", first: "M2 2h2.4v12H2zM14 2v12L5.4 8z", last: "M11.6 2H14v12h-2.4zM2 2v12l8.6-6z",
  back: "M11 2v12L3 8zM12 2h1.5v12H12z", forward: "M5 2v12l8-6zM2.5 2H4v12H2.5z",
};

function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS(svg.namespaceURI, "path");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

const SPEEDS = [1, 2, 5, 10, 20, 50, 100];
const LONGEST = 30; // [s] to play a run at the speed that is chosen for it

/** The time line's buttons and slider. */
export function makeTimeControls(timeline, current) {
  const button = (id, label, act) => el("button", { type: "button", id, class: "round", "aria-label": label, title: label, on: { click: act } }, icon(id));
  const play = button("play", "Play (space)", () => timeline.toggle());
  const slider = el("input", { type: "range", id: "time", min: 0, max: Math.max(0, timeline.steps - 1), step: 1, "aria-label": "Step", on: { input: () => {
    timeline.pause();
    timeline.seek(Number(slider.value));
  } } });
  const speed = el("select", { id: "speed", "aria-label": "Speed", on: { change: () => (timeline.speed = Number(speed.value)) } }, ...SPEEDS.map((value) => el("option", { value })));
  const label = el("output", { id: "step-label", for: "time", "aria-live": "off" });
  const update = () => {
    const { facts, numbers } = current(), { step } = timeline;
    const number = facts.steps[step]?.number ?? 0, last = facts.steps.at(-1)?.number ?? 0;
    slider.max = Math.max(0, timeline.steps - 1);
    slider.value = step;
    slider.style.setProperty("--done", `${timeline.steps > 1 ? (100 * step) / (timeline.steps - 1) : 100}%`);
    // While robots move, the map is the one at the start of the step.
    const known = numbers.coverage[timeline.along < 1 ? step - 1 : step], mapped = Number.isFinite(known) ? `${percent(known)} mapped` : "";
    const time = numbers.clock ? `${timeline.time.toFixed(1)} of ${clockTime(timeline.times.at(-1))}` : "", steps = `${numbers.clock ? "step" : "Step"} ${number} of ${last}`;
    const text = [time, steps, mapped].filter(Boolean).join(" · ");
    label.textContent = text;
    slider.setAttribute("aria-valuetext", text);
    if (play.dataset.playing !== String(timeline.playing)) {
      play.dataset.playing = String(timeline.playing);
      play.replaceChildren(icon(timeline.playing ? "pause" : "play"));
      play.setAttribute("aria-label", timeline.playing ? "Pause (space)" : "Play (space)");
      play.title = play.getAttribute("aria-label");
    }
  };
  timeline.addEventListener("change", update);
  /** Chooses a speed for the run. */
  const chooseSpeed = () => {
    const { clock } = current().numbers, whole = timeline.times.at(-1) ?? 0;
    for (const option of speed.options) option.textContent = clock ? `${option.value} ×` : `${option.value} steps/s`;
    timeline.speed = clock ? (SPEEDS.find((value) => whole / value <= LONGEST) ?? SPEEDS.at(-1)) : 2;
    speed.value = String(timeline.speed);
    speed.title = clock ? "seconds of the run in one second" : "";
  };
  const bar = el("div", { class: "timeline", role: "group", "aria-label": "Time line" },
    el("div", { class: "buttons" },
      button("first", "First step (Home)", () => timeline.move(-timeline.step)), button("back", "Previous step (←)", () => timeline.move(-1)), play,
      button("forward", "Next step (→)", () => timeline.move(1)), button("last", "Last step (End)", () => timeline.move(timeline.steps))),
    slider, label, speed);
  return { bar, chooseSpeed };
}
