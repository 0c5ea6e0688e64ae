import uPlot from "uplot";
import { el, swatch } from "./dom.js";
import { DASHES, PHASES, SCENE, robotColor } from "./palette.js";
import { percent, seconds, whole } from "./run_numbers.js";

const HEIGHT = 170;

/**
 * The charts of the run that is replayed, and the coverage of the other runs. A line marks the step that
 * the time line shows; a click goes to a step.
 */
export class Charts {
  constructor(host, timeline) {
    this.host = host;
    this.timeline = timeline;
    this.charts = [];
    this.width = 0;
    new ResizeObserver(() => this.resize()).observe(host);
  }

  /** @param runs [{ name, facts, numbers }] @param shown index of the run that is replayed */
  load(runs, shown, theme) {
    this.runs = runs;
    this.shown = shown;
    this.build(theme);
  }

  build(theme) {
    this.host.replaceChildren();
    this.width = Math.max(240, this.host.clientWidth);
    this.theme = theme;
    this.charts = this.specifications().map((spec) => this.make(spec));
    this.mark(this.timeline.position.step);
  }

  specifications() {
    const { numbers, facts } = this.runs[this.shown], { theme } = this, ink = SCENE[theme].ink;
    const others = this.runs.map((run, i) => ({ ...run, dash: DASHES[i % DASHES.length] })).filter((_, i) => i !== this.shown);
    const robots = facts.robots.map((robot, r) => ({ name: robot.name, color: robotColor(r, theme), r }));
    const team = robots.length > 1;
    const muted = theme === "light" ? "#6b7684" : "#93a0af";
    const coverage = (x, xs) => [
      { name: team ? "team" : robots[0].name, xs: x, ys: numbers.coverage, color: team ? ink : robots[0].color, width: 2.5 },
      ...(team ? robots.map(({ name, color, r }) => ({ name, xs: xs(numbers, r), ys: numbers.robotCoverage[r], color })) : []),
      ...others.map((run) => ({ name: run.name, xs: x === numbers.steps ? run.numbers.steps : run.numbers.teamTravelled, ys: run.numbers.coverage, color: muted, dash: run.dash.length ? run.dash : [6, 4], other: true })),
    ];
    return [
      { id: "coverage-step", title: "Coverage by step", note: "fraction of the observable space", unit: percent, fraction: true, x: "step", series: coverage(numbers.steps, () => numbers.steps) },
      { id: "coverage-length", title: "Coverage by path length", note: "sum of all paths for the team, own path for each robot", unit: percent, fraction: true, x: "m", atX: (s) => numbers.teamTravelled[s], series: coverage(numbers.teamTravelled, (n, r) => n.travelled[r]) },
      { id: "frontiers", title: "Frontiers left", note: "at the start of the step", unit: whole, x: "step", series: [
        { name: "frontiers", xs: numbers.steps, ys: numbers.frontiers, color: SCENE[theme].frontier },
        { name: "unassigned", xs: numbers.steps, ys: numbers.unassigned, color: ink, dash: [6, 3] },
        { name: "abandoned", xs: numbers.steps, ys: numbers.abandoned, color: muted, dash: [2, 3] },
      ] },
      { id: "planning", title: "Planning time by phase", note: "stacked, whole team", unit: seconds, x: "step", stacked: true, series: numbers.phases.slice(0, -1).map((ys, p) => ({ name: facts.phases[p], xs: numbers.steps, ys, color: PHASES[theme][p] })) },
      { id: "gain", title: "Gain of the paths", note: "frontiers expected in view, and frontiers that became known", unit: whole, x: "step", series: robots.flatMap(({ name, color, r }) => [
        { name: `${name} expected`, xs: numbers.steps, ys: numbers.predicted[r], color, dash: [5, 4] },
        { name: `${name} gained`, xs: numbers.steps, ys: numbers.gained[r], color },
      ]) },
    ];
  }

  make(spec) {
    const values = spec.series.map(() => el("span", { class: "value" }));
    const legend = el("ul", { class: "legend" }, ...spec.series.map((series, i) => el("li", {}, swatch(series.color, series.dash ? "dashed" : "line"), el("span", { text: series.name }), values[i])));
    const mark = el("div", { class: "chart-mark", "aria-hidden": "true" });
    const figure = el("figure", { class: "chart", id: `chart-${spec.id}` }, el("figcaption", {}, el("strong", { text: spec.title }), el("span", { class: "note", text: spec.note })), legend);
    this.host.append(figure);
    const summary = `${spec.title}, ${spec.note}; the numbers are in the table of steps below`;
    const plot = new uPlot(this.options(spec), dataOf(spec), figure);
    plot.root.setAttribute("role", "img");
    plot.root.setAttribute("aria-label", summary);
    plot.over.append(mark);
    plot.over.addEventListener("click", () => this.seekTo(plot, spec));
    return { spec, plot, mark, values };
  }

  options(spec) {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--muted").trim(), grid = { stroke: style.getPropertyValue("--line").trim(), width: 1 };
    const font = "12px system-ui, sans-serif", bars = spec.stacked ? uPlot.paths.bars({ size: [0.9, 40], align: 0 }) : undefined;
    const integers = (_, ticks) => ticks.map((tick) => (Number.isInteger(tick) ? String(tick) : ""));
    const axis = { stroke: ink, grid, ticks: { show: false }, font, labelFont: font };
    return {
      width: this.width, height: HEIGHT, padding: [8, 12, 0, 0], legend: { show: false },
      hooks: { ready: [() => this.mark(this.timeline.position.step)] },
      cursor: { y: false, drag: { x: false, y: false }, points: { show: !spec.stacked } },
      scales: { x: { time: false, range: spec.stacked ? (_, low, high) => [low - 0.6, Math.max(high, low + 1) + 0.6] : (_, low, high) => [low, high > low ? high : low + 1] }, y: { range: (_, low, high) => [0, spec.fraction ? 1 : high > 0 ? high * 1.06 : 1] } },
      axes: [
        { ...axis, size: 22, label: spec.x === "m" ? "path length, m" : "step", labelSize: 16, labelGap: -2, gap: 2, values: integers, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000] },
        { ...axis, size: 56, values: (_, ticks) => ticks.map((tick) => (spec.unit === percent ? percent(tick, 0) : spec.unit === seconds ? (tick === 0 ? "0" : seconds(tick)) : whole(tick))) },
      ],
      series: [{}, ...spec.series.map((series) => ({
        label: series.name, stroke: series.color, width: series.width ?? 1.75, dash: series.dash, spanGaps: true, points: { show: false },
        ...(spec.stacked ? { paths: bars, fill: series.color, width: 0 } : {}),
      }))].map((series, i, all) => (spec.stacked && i > 0 ? { ...all[all.length - i] } : series)),
    };
  }

  seekTo(plot, spec) {
    const x = plot.posToVal(plot.cursor.left, "x"), { steps, teamTravelled } = this.runs[this.shown].numbers;
    const xs = spec.atX ? teamTravelled : steps;
    let best = 0;
    xs.forEach((value, s) => {
      if (Math.abs(value - x) < Math.abs(xs[best] - x)) best = s;
    });
    this.timeline.pause();
    this.timeline.seek(best);
  }

  /** Puts the lines on a step and writes its values into the legends. */
  mark(step) {
    const { numbers } = this.runs[this.shown];
    if (numbers.steps.length === 0) return;
    for (const { spec, plot, mark, values } of this.charts) {
      const x = plot.valToPos(spec.atX ? spec.atX(step) : numbers.steps[step], "x");
      mark.style.transform = `translateX(${x}px)`;
      spec.series.forEach((series, i) => {
        const value = series.other ? series.ys.at(Math.min(step, series.ys.length - 1)) : series.ys[step];
        values[i].textContent = value === undefined ? "" : spec.unit(value);
      });
    }
  }

  resize() {
    const width = Math.max(240, this.host.clientWidth);
    if (!this.runs || Math.abs(width - this.width) < 2) return;
    this.width = width;
    for (const { plot } of this.charts) plot.setSize({ width, height: HEIGHT });
    this.mark(this.timeline.position.step);
  }
}

/** One x for all series. Stacked ones are sums, the tallest first, so that each is drawn over the taller ones. */
function dataOf(spec) {
  if (spec.stacked) {
    const sums = [];
    spec.series.forEach((series, p) => sums.push(series.ys.map((y, s) => y + (p > 0 ? sums[p - 1][s] : 0))));
    return [spec.series[0].xs, ...sums.reverse()];
  }
  if (spec.series.every((series) => series.xs === spec.series[0].xs)) return [spec.series[0].xs, ...spec.series.map((series) => series.ys)];
  return uPlot.join(spec.series.map((series) => strictlyRising(series.xs, series.ys)));
}

/** A robot that did not move keeps its last value only. */
function strictlyRising(xs, ys) {
  const x = [], y = [];
  xs.forEach((value, i) => {
    if (x.length > 0 && value <= x.at(-1)) y[y.length - 1] = ys[i];
    else {
      x.push(value);
      y.push(ys[i]);
    }
  });
  return [x, y];
}

