import { el } from "./dom.js";
import { percent } from "./run_numbers.js";

const SPEEDS = [0.5, 1, 2, 4, 8, 16];

/** The time line's buttons and slider. */
export function makeTimeControls(timeline, current) {
  const button = (id, label, text, act) => el("button", { type: "button", id, class: "round", "aria-label": label, title: label, text, on: { click: act } });
  const play = button("play", "Play (space)", "▶", () => timeline.toggle());
  const slider = el("input", { type: "range", id: "time", min: 0, max: Math.max(0, timeline.steps - 1), step: 1, "aria-label": "Step", on: { input: () => {
    timeline.pause();
    timeline.seek(Number(slider.value));
  } } });
  const speed = el("select", { id: "speed", "aria-label": "Speed", on: { change: () => (timeline.speed = Number(speed.value)) } }, ...SPEEDS.map((value) => el("option", { value, text: `${value} steps/s` })));
  speed.value = String(timeline.speed);
  const told = el("output", { id: "step-label", for: "time" });
  const update = () => {
    const { facts, numbers } = current(), { step } = timeline;
    const number = facts.steps[step]?.number ?? 0, last = facts.steps.at(-1)?.number ?? 0;
    slider.max = Math.max(0, timeline.steps - 1);
    slider.value = step;
    slider.style.setProperty("--done", `${timeline.steps > 1 ? (100 * step) / (timeline.steps - 1) : 100}%`);
    const known = numbers.coverage[step], text = `Step ${number} of ${last}${Number.isFinite(known) ? ` · ${percent(known)} known` : ""}`;
    told.textContent = text;
    slider.setAttribute("aria-valuetext", text);
    if (play.dataset.playing !== String(timeline.playing)) {
      play.dataset.playing = String(timeline.playing);
      play.textContent = timeline.playing ? "❚❚" : "▶";
      play.setAttribute("aria-label", timeline.playing ? "Pause (space)" : "Play (space)");
      play.title = play.getAttribute("aria-label");
    }
  };
  timeline.addEventListener("change", update);
  const bar = el("div", { class: "timeline", role: "group", "aria-label": "Time line" },
    el("div", { class: "buttons" },
      button("first", "To the start (Home)", "⏮", () => timeline.move(-timeline.step)), button("back", "One step back (←)", "◀", () => timeline.move(-1)), play,
      button("forward", "One step on (→)", "▶▎", () => timeline.move(1)), button("last", "To the end (End)", "⏭", () => timeline.move(timeline.steps))),
    slider, told, speed);
  return { bar, update };
}
