import uPlot from "uplot";
import { el, swatch } from "./dom.js";
import { bandOf, seedGroups } from "./comparison.js";
import { groupName } from "./comparison_view.js";
import { DASHES, SCENE, otherColor, phaseColor, robotColor, runColor } from "./palette.js";
import { cubicMetres, lastUpTo, percent, seconds, whole } from "./run_numbers.js";

const HEIGHT = 170;
const MOST_BARS = 120;

/**
 * The charts of the run that is replayed, and the coverage and volume of the other runs. A line marks the step
 * that the time line shows; a click goes to a step.
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
    const groups = seedGroups(this.runs), grouped = new Set(groups.flat());
    const others = this.runs.map((run, i) => ({ ...run, dash: DASHES[i % DASHES.length] })).filter((_, i) => i !== this.shown && !grouped.has(i));
    const robots = facts.robots.map((robot, r) => ({ name: robot.name, color: robotColor(robot, theme), r }));
    const team = robots.length > 1;
    const muted = otherColor(theme);
    const clock = numbers.clock ? { name: "time", label: "time, s", xs: numbers.time } : { name: "time", label: "step", xs: numbers.time };
    const length = { name: "teamTravelled", label: team ? "path length of all robots, m" : "path length, m", xs: numbers.teamTravelled };
    // Runs that differ in their seeds only are drawn as their mean, with a band of the deviation.
    const bands = (x, all) => groups.filter((group) => group.every((i) => this.runs[i].numbers.clock === numbers.clock)).flatMap((group, k) => {
      const { xs, mean, low, high } = bandOf(group.map((i) => this.runs[i]), x.name, all), color = runColor(k, theme), edge = { xs, color, other: true, edge: true };
      return [{ ...edge, ys: high, name: "" }, { ...edge, ys: low, name: "" }, { name: `${groupName(this.runs, group)}: mean ± deviation`, xs, ys: mean, color, width: 2.2, other: true, band: true }];
    });
    // How much the team knows, what each robot has seen first, and how much the teams of the other runs know.
    const known = (x, all, parts) => [
      { name: team ? "team" : robots[0].name, xs: x.xs, ys: numbers[all], color: team ? ink : robots[0].color, width: 2.5 },
      ...(team ? robots.map(({ name, color, r }) => ({ name, xs: x.xs, ys: numbers[parts][r], color })) : []),
      ...others.filter((run) => x !== clock || run.numbers.clock === numbers.clock).map((run) => ({ name: run.name, xs: run.numbers[x.name], ys: run.numbers[all], color: muted, dash: run.dash.length ? run.dash : [6, 4], other: true })),
      ...bands(x, all),
    ];
    const over = numbers.clock ? "over time" : "by step";
    const coverage = { note: "fraction of the observable space", unit: percent, fraction: true }, volume = { note: "free and occupied", unit: cubicMetres };
    return [
      { id: "coverage-time", title: `Coverage ${over}`, ...coverage, x: clock, series: known(clock, "coverage", "robotCoverage") },
      { id: "coverage-length", title: "Coverage over path length", ...coverage, x: length, series: known(length, "coverage", "robotCoverage") },
      { id: "volume-time", title: `Explored volume ${over}`, ...volume, x: clock, series: known(clock, "volume", "robotVolume") },
      { id: "volume-length", title: "Explored volume over path length", ...volume, x: length, series: known(length, "volume", "robotVolume") },
      { id: "frontiers", title: "Frontiers left", note: numbers.motion ? "at each planning" : "at the start of the step", unit: whole, x: clock, series: [
        { name: "frontiers", xs: clock.xs, ys: numbers.frontiers, color: SCENE[theme].frontier },
        { name: "unassigned", xs: clock.xs, ys: numbers.unassigned, color: ink, dash: [6, 3] },
        { name: "abandoned", xs: clock.xs, ys: numbers.abandoned, color: muted, dash: [2, 3] },
      ] },
      this.planning(numbers, facts, clock),
      numbers.motion
        ? { id: "gain", title: "Expected gain of the paths", note: "frontiers in view, when the robot planned", unit: whole, x: clock, series: robots.map(({ name, color, r }) => ({ name, xs: clock.xs, ys: numbers.predicted[r], color, width: 1.2 })) }
        : { id: "gain", title: "Gain of the paths", note: "frontiers expected in view, and frontiers that became known", unit: whole, x: clock, series: robots.flatMap(({ name, color, r }) => [
            { name: `${name} expected`, xs: clock.xs, ys: numbers.predicted[r], color, dash: [5, 4] },
            { name: `${name} gained`, xs: clock.xs, ys: numbers.gained[r], color },
          ]) },
    ];
  }

  /** Of long runs, each bar is the mean of some steps that follow each other. */
  planning(numbers, facts, x) {
    const each = Math.ceil(x.xs.length / MOST_BARS), ends = barEnds(x.xs, each);
    const note = `stacked, ${numbers.motion ? "one robot's planning" : "whole team"}${each > 1 ? `, mean of ${each} ${numbers.motion ? "plannings" : "steps"}` : ""}`;
    return {
      id: "planning", title: "Planning time by phase", note, unit: seconds, x, stacked: true, ends,
      series: numbers.phases.slice(0, -1).map((ys, p) => ({ name: facts.phases[p], xs: x.xs, ys, color: phaseColor(facts.phases[p], this.theme) })),
    };
  }

  make(spec) {
    const values = spec.series.map(() => el("span", { class: "value" }));
    const legend = el("ul", { class: "legend" }, ...spec.series.map((series, i) => (series.edge ? null : el("li", {}, swatch(series.color, series.band ? "band" : series.dash ? "dashed" : "line"), el("span", { text: series.name }), values[i]))));
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
    // The bar of a step reaches back to the end of the step before.
    const font = "12px system-ui, sans-serif", bars = spec.stacked ? uPlot.paths.stepped({ align: -1 }) : undefined;
    const integers = (_, ticks) => ticks.map((tick) => (Number.isInteger(tick) ? String(tick) : ""));
    const axis = { stroke: ink, grid, ticks: { show: false }, font, labelFont: font };
    return {
      width: this.width, height: HEIGHT, padding: [8, 20, 0, 0], legend: { show: false },
      hooks: { ready: [() => this.mark(this.timeline.position.step)] },
      cursor: { y: false, drag: { x: false, y: false }, points: { show: !spec.stacked } },
      scales: { x: { time: false, range: (_, low, high) => [Math.min(0, low), high > 0 ? high : 1] }, y: { range: (_, low, high) => [0, spec.fraction ? 1 : high > 0 ? high * 1.06 : 1] } },
      axes: [
        { ...axis, size: 22, label: spec.x.label, labelSize: 16, labelGap: -2, gap: 2, values: integers, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000] },
        { ...axis, size: 56, values: (_, ticks) => ticks.map((tick) => (spec.unit === percent ? percent(tick, 0) : spec.unit === seconds ? (tick === 0 ? "0" : seconds(tick)) : tick < 10 && !Number.isInteger(tick) ? String(tick) : whole(tick))) },
      ],
      bands: spec.series.flatMap((series, i) => (series.edge && spec.series[i + 1].edge ? [{ series: [i + 1, i + 2], fill: `${series.color}38` }] : [])),
      series: [{}, ...spec.series.map((series) => ({
        label: series.name, stroke: series.color, width: series.width ?? 1.75, dash: series.dash, spanGaps: true, points: { show: false },
        ...(series.edge ? { width: 0, stroke: "transparent" } : {}),
        ...(spec.stacked ? { paths: bars, fill: series.color, width: 0 } : {}),
      }))].map((series, i, all) => (spec.stacked && i > 0 ? { ...all[all.length - i] } : series)),
    };
  }

  seekTo(plot, { x: { xs } }) {
    const x = plot.posToVal(plot.cursor.left, "x"), last = lastUpTo(xs, x), next = Math.min(last + 1, xs.length - 1);
    this.timeline.pause();
    this.timeline.seek(Math.abs(xs[next] - x) < Math.abs(xs[last] - x) ? next : last);
  }

  /** Puts the lines on a step and writes its values into the legends; of other runs, those at the same time or path length. */
  mark(step) {
    const { numbers } = this.runs[this.shown];
    if (numbers.steps.length === 0) return;
    for (const { spec, plot, mark, values } of this.charts) {
      const at = spec.x.xs[step];
      mark.style.transform = `translateX(${plot.valToPos(at, "x")}px)`;
      spec.series.forEach((series, i) => {
        const value = series.ys[series.other ? lastUpTo(series.xs, at) : step];
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

/** The last step of each bar: of so many steps, and with a greater x than the bar before. */
function barEnds(xs, each) {
  const ends = [];
  for (let begin = 0; begin < xs.length; ) {
    let end = Math.min(begin + each, xs.length) - 1;
    while (end + 1 < xs.length && xs[end + 1] <= xs[end]) ++end;
    if (ends.length > 0 && xs[end] <= xs[ends.at(-1)]) ends.pop();
    ends.push(end);
    begin = end + 1;
  }
  return ends;
}

/** One x for all series. Stacked ones are sums, the tallest first, so that each is drawn over the taller ones. */
function dataOf(spec) {
  if (spec.stacked) {
    const sums = [];
    const mean = (ys, k) => {
      const steps = ys.slice(k > 0 ? spec.ends[k - 1] + 1 : 0, spec.ends[k] + 1);
      return steps.reduce((a, b) => a + b, 0) / steps.length;
    };
    spec.series.forEach((series, p) => sums.push(spec.ends.map((_, k) => mean(series.ys, k) + (p > 0 ? sums[p - 1][k] : 0))));
    return [spec.ends.map((s) => spec.x.xs[s]), ...sums.reverse()];
  }
  if (spec.series.every((series) => series.xs === spec.series[0].xs)) return [spec.series[0].xs, ...spec.series.map((series) => series.ys)];
  return uPlot.join(spec.series.map((series) => strictlyRising(series.xs, series.ys)));
}

/** Of steps with the same x, the last one. */
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
