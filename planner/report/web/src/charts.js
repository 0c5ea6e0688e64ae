import uPlot from "uplot";
import { el, swatch } from "./dom.js";
import { bandOf, seedGroups } from "./comparison.js";
import { groupName } from "./comparison_view.js";
import { DASHES, SCENE, otherColor, phaseColor, robotColor, runColor } from "./palette.js";
import { chartSvg, chartTable, save } from "./save.js";
import { cubicMetres, lastUpTo, percent, seconds, whole } from "./run_numbers.js";

const HEIGHT = 170;
const PRINTED = 330; // [px] width on paper
const MOST_BARS = 120;

/**
 * The charts of the run that is replayed, and the coverage and volume of the other runs, over time, path length or
 * steps. A line marks the step that the time line shows, or the one at the pointer in all charts at once; a click
 * goes to a step.
 */
export class Charts {
  constructor(host, timeline) {
    this.host = host;
    this.timeline = timeline;
    this.charts = [];
    this.width = 0;
    this.over = 0; // which of the quantities
    new ResizeObserver(() => this.resize()).observe(host);
  }

  /** @param runs [{ name, facts, numbers }] @param shown index of the run that is replayed */
  load(runs, shown, theme) {
    this.runs = runs;
    this.shown = shown;
    this.build(theme);
  }

  /** In light colours, narrow enough for two columns of a page. */
  print() {
    this.printed = true;
    this.build("light", PRINTED);
  }

  endPrint(theme) {
    this.printed = false;
    this.build(theme);
  }

  build(theme, width = Math.max(240, this.host.clientWidth)) {
    this.host.replaceChildren();
    this.width = width;
    this.theme = theme;
    this.host.append(this.chooser());
    this.charts = this.specifications(theme).map((spec) => this.make(spec));
    this.mark(this.timeline.position.step);
  }

  /** What charts can be drawn over: a list of the numbers, its name for people, and its axis. */
  quantities() {
    const { numbers, facts } = this.runs[this.shown];
    return [
      ...(numbers.clock ? [{ name: "time", choice: "time", over: "over time", label: "time, s" }] : []),
      { name: "teamTravelled", choice: "path length", over: "over path length", label: facts.robots.length > 1 ? "path length of all robots, m" : "path length, m" },
      { name: "steps", choice: "steps", over: "by step", label: "step" },
    ].map((quantity) => ({ ...quantity, xs: numbers[quantity.name] }));
  }

  chooser() {
    const choices = this.quantities(), name = (q) => q.choice;
    this.over = Math.min(this.over, choices.length - 1);
    const select = el("select", { id: "over", on: { change: () => {
      this.over = Number(select.value);
      this.build(this.theme);
      this.host.querySelector("#over").focus();
    } } }, ...choices.map((q, i) => el("option", { value: i, text: name(q), selected: i === this.over })));
    return el("label", { class: "field" }, el("span", { text: "Charts over" }), select);
  }

  specifications(theme) {
    const { numbers, facts } = this.runs[this.shown], ink = SCENE[theme].ink, x = this.quantities()[this.over];
    const groups = seedGroups(this.runs), grouped = new Set(groups.flat());
    const others = this.runs.map((run, i) => ({ ...run, dash: DASHES[i % DASHES.length] })).filter((_, i) => i !== this.shown && !grouped.has(i));
    const robots = facts.robots.map((robot, r) => ({ name: robot.name, color: robotColor(robot, theme), r }));
    const team = robots.length > 1;
    const muted = otherColor(theme);
    // Runs that differ in their seeds only are drawn as their mean, with a band of the deviation.
    const bands = (all) => groups.filter((group) => group.every((i) => this.runs[i].numbers.clock === numbers.clock)).flatMap((group, k) => {
      const { xs, mean, low, high } = bandOf(group.map((i) => this.runs[i]), x.name, all), color = runColor(k, theme), edge = { xs, color, other: true, edge: true };
      return [{ ...edge, ys: high, name: "" }, { ...edge, ys: low, name: "" }, { name: `${groupName(this.runs, group)}: mean ± deviation`, xs, ys: mean, color, width: 2.2, other: true, band: true }];
    });
    // How much the team knows, what each robot has seen first, and how much the teams of the other runs know.
    const known = (all, parts) => [
      { name: team ? "team" : robots[0].name, xs: x.xs, ys: numbers[all], color: team ? ink : robots[0].color, width: 2.5 },
      ...(team ? robots.map(({ name, color, r }) => ({ name, xs: x.xs, ys: numbers[parts][r], color })) : []),
      ...others.filter((run) => x.name !== "time" || run.numbers.clock).map((run) => ({ name: run.name, xs: run.numbers[x.name], ys: run.numbers[all], color: muted, dash: run.dash.length ? run.dash : [6, 4], other: true })),
      ...bands(all),
    ];
    const coverage = { note: "fraction of the observable space", unit: percent, fraction: true }, volume = { note: "free and occupied", unit: cubicMetres };
    return [
      { id: "coverage", title: `Coverage ${x.over}`, ...coverage, x, series: known("coverage", "robotCoverage") },
      { id: "volume", title: `Explored volume ${x.over}`, ...volume, x, series: known("volume", "robotVolume") },
      { id: "frontiers", title: "Frontiers left", note: numbers.motion ? "at each planning" : "at the start of the step", unit: whole, x, series: [
        { name: "frontiers", xs: x.xs, ys: numbers.frontiers, color: SCENE[theme].frontier },
        { name: "unassigned", xs: x.xs, ys: numbers.unassigned, color: ink, dash: [6, 3] },
        { name: "abandoned", xs: x.xs, ys: numbers.abandoned, color: muted, dash: [2, 3] },
      ] },
      this.planning(numbers, facts, x, theme),
      numbers.motion
        ? { id: "gain", title: "Expected gain of the paths", note: "frontiers in view, when the robot planned", unit: whole, x, series: robots.map(({ name, color, r }) => ({ name, xs: x.xs, ys: numbers.predicted[r], color, width: 1.2 })) }
        : { id: "gain", title: "Gain of the paths", note: "frontiers expected in view, and frontiers that became known", unit: whole, x, series: robots.flatMap(({ name, color, r }) => [
            { name: `${name} expected`, xs: x.xs, ys: numbers.predicted[r], color, dash: [5, 4] },
            { name: `${name} gained`, xs: x.xs, ys: numbers.gained[r], color },
          ]) },
    ];
  }

  /** Of long runs, each bar is the mean of some steps that follow each other. */
  planning(numbers, facts, x, theme) {
    const each = Math.ceil(x.xs.length / MOST_BARS), ends = barEnds(x.xs, each);
    const note = `stacked, ${numbers.motion ? "one robot's planning" : "whole team"}${each > 1 ? `, mean of ${each} ${numbers.motion ? "plannings" : "steps"}` : ""}`;
    return {
      id: "planning", title: "Planning time by phase", note, unit: seconds, x, stacked: true, ends,
      series: numbers.phases.slice(0, -1).map((ys, p) => ({ name: facts.phases[p], xs: x.xs, ys, color: phaseColor(facts.phases[p], theme) })),
    };
  }

  make(spec) {
    const values = spec.series.map(() => el("span", { class: "value" }));
    const legend = el("ul", { class: "legend" }, ...spec.series.map((series, i) => (series.edge ? null : el("li", {}, swatch(series.color, series.band ? "band" : series.dash ? "line dashed" : "line", series.dash), el("span", { text: series.name }), values[i]))));
    const mark = el("div", { class: "chart-mark", "aria-hidden": "true" });
    const button = (kind, title, act) => el("button", { type: "button", class: "small", title, text: kind, "aria-label": `${kind}: ${title}, ${spec.title}`, on: { click: act } });
    const buttons = el("span", { class: "save" }, button("SVG", "save as a picture", () => this.savePicture(spec.id)), button("CSV", "save the numbers", () => save(`${this.fileName(spec)}.csv`, new Blob([chartTable(spec)], { type: "text/csv" }))));
    const figure = el("figure", { class: "chart", id: `chart-${spec.id}` }, el("figcaption", {}, el("strong", { text: spec.title }), el("span", { class: "note", text: spec.note }), buttons), legend);
    this.host.append(figure);
    const summary = `${spec.title}, ${spec.note}; the numbers are in the table of steps below`;
    const plot = new uPlot(this.options(spec), dataOf(spec), figure);
    plot.root.setAttribute("role", "img");
    plot.root.setAttribute("aria-label", summary);
    const pointed = el("div", { class: "chart-mark pointed", "aria-hidden": "true", hidden: true });
    plot.over.append(mark, pointed);
    plot.over.addEventListener("mousemove", () => this.point(this.stepAt(plot, spec)));
    plot.over.addEventListener("mouseleave", () => this.point(-1));
    plot.over.addEventListener("click", () => this.seekTo(plot, spec));
    return { spec, plot, mark, pointed, values };
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
        { ...axis, size: 56, values: (_, ticks) => ticks.map(axisText(spec)) },
      ],
      bands: spec.series.flatMap((series, i) => (series.edge && spec.series[i + 1].edge ? [{ series: [i + 1, i + 2], fill: `${series.color}38` }] : [])),
      series: [{}, ...spec.series.map((series) => ({
        label: series.name, stroke: series.color, width: series.width ?? 1.75, dash: series.dash, spanGaps: true, points: { show: false },
        ...(series.edge ? { width: 0, stroke: "transparent" } : {}),
        ...(spec.stacked ? { paths: bars, fill: series.color, width: 0 } : {}),
      }))].map((series, i, all) => (spec.stacked && i > 0 ? { ...all[all.length - i] } : series)),
    };
  }

  fileName(spec) {
    return `${this.runs[this.shown].name}_${spec.id}_${this.quantities()[this.over].choice}`;
  }

  /** On white, whatever the page is on. */
  savePicture(id) {
    const spec = this.specifications("light").find((one) => one.id === id);
    save(`${this.fileName(spec)}.svg`, new Blob([chartSvg(spec, axisText(spec), spec.stacked ? dataOf(spec) : null)], { type: "image/svg+xml" }));
  }

  /** The step nearest to the pointer. */
  stepAt(plot, { x: { xs } }) {
    const x = plot.posToVal(plot.cursor.left, "x"), last = lastUpTo(xs, x), next = Math.min(last + 1, xs.length - 1);
    return Math.abs(xs[next] - x) < Math.abs(xs[last] - x) ? next : last;
  }

  seekTo(plot, spec) {
    this.timeline.pause();
    this.timeline.seek(this.stepAt(plot, spec));
  }

  /** Shows a step's values in all charts as long as the pointer is there; -1: those of the time line again. */
  point(step) {
    for (const { spec, plot, pointed } of this.charts) {
      pointed.hidden = step < 0;
      if (step >= 0) pointed.style.transform = `translateX(${plot.valToPos(spec.x.xs[step], "x")}px)`;
    }
    this.write(step < 0 ? this.timeline.position.step : step);
  }

  /** Puts the lines on a step, and its values into the legends. */
  mark(step) {
    const { numbers } = this.runs[this.shown];
    if (numbers.steps.length === 0) return;
    for (const { spec, plot, mark } of this.charts) mark.style.transform = `translateX(${plot.valToPos(spec.x.xs[step], "x")}px)`;
    this.write(step);
  }

  /** The values of a step; of other runs, those at the same time, path length or step. */
  write(step) {
    for (const { spec, values } of this.charts) {
      const at = spec.x.xs[step];
      spec.series.forEach((series, i) => {
        const value = series.ys[series.other ? lastUpTo(series.xs, at) : step];
        values[i].textContent = value === undefined ? "" : spec.unit(value);
      });
    }
  }

  resize() {
    const width = Math.max(240, this.host.clientWidth);
    if (!this.runs || this.printed || Math.abs(width - this.width) < 2) return;
    this.width = width;
    for (const { plot } of this.charts) plot.setSize({ width, height: HEIGHT });
    this.mark(this.timeline.position.step);
  }
}

/** How values of the upright axis are written. */
const axisText = (spec) => (tick) => (spec.unit === percent ? percent(tick, 0) : spec.unit === seconds ? (tick === 0 ? "0" : seconds(tick)) : tick < 10 && !Number.isInteger(tick) ? String(Number(tick.toPrecision(6))) : whole(tick));

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
