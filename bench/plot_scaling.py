#!/usr/bin/env python3
"""Draws the JSON of bench_scaling as scaling_<axis>.svg and scaling_cost.svg: plot_scaling.py RESULTS.json FOLDER"""

import argparse
import json
import math
import re
import statistics
import sys
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

from plot import colours_of, digits, ratio_text
from svg_chart import MARGIN, WIDTH, Drawing, save, svg

ROW = re.compile(r"(?P<axis>[^/]+)/(?P<query>[^/]+)/(?P<map>[^/]+)/(?P<label>[^/]+)/(?P<caster>[^/]+)/"
                 r"threads:(?P<threads>\d+)")
BASELINE, FAST, CASTERS = "octomap", "fast", ("octomap", "fast", "embree", "grid")
NAMES = {"octomap": "castRay", "fast": "fast", "embree": "embree", "grid": "grid"}
COST_NAMES = {**NAMES, "octomap": "octree"}

TITLES = {
    "resolution": "Voxels of the same building, finer and coarser",
    "length": "Rays of growing length",
    "density": "More and more occupied voxels",
    "size": "Larger and larger maps",
    "width": "Wider and wider maps",
    "order": "One thread and more, rays in order and shuffled",
    "cost": "What a caster costs",
}
SUBTITLES = {
    "resolution": "Numbers: fast as a multiple of castRay",
    "length": "Above a nearly empty box, below a building; numbers: fast as a multiple of castRay",
    "density": "Random cubes in a box of free voxels, rays of 20 m; numbers: fast as a multiple of castRay",
    "size": "Equal rooms side by side and on top of each other, rays of 5 m; numbers: fast as a multiple of castRay",
    "width": "Streets of a town, rays of 30 m; numbers: fast as a multiple of castRay",
    "order": "Hollow: 1 thread; filled: all threads; numbers: speed-up by threads, Mrays/s",
    "cost": "Memory and time from the octree to the caster, the grid included; updates without it",
}
X_TITLES = {
    "resolution": "edge of a voxel [m]",
    "length": "length of the rays [m]",
    "density": "occupied fraction of the box [%]",
    "size": "known voxels [millions]",
    "width": "edge of the map [km]",
}
QUERIES = {
    "visible": "visible: between voxels, unknown blocks",
    "cast": "cast: first occupied voxel",
    "visible_uav": "visible_uav: voxels to frontiers, 10 m",
    "cast_lidar": "cast_lidar: 32-beam lidar, 30 m",
}

PANEL_WIDTH, PANEL_HEIGHT, PANEL_GAP, AXIS_WIDTH, LEGEND_Y = 330, 210, 72, 46, 88


class Row(NamedTuple):
    axis: str
    query: str
    map: str
    label: str
    caster: str
    threads: int
    rate: float  # median [rays/s]
    facts: dict

    @property
    def x(self):
        return self.facts["x"] * (1e-6 if self.axis == "size" else 1.0)

    @property
    def known(self):
        return self.facts["free_voxels"] + self.facts["occupied_voxels"]


def read_rows(document):
    """One row for all repetitions, in the order in which they were registered."""
    samples, facts = defaultdict(list), {}
    runs = [r for r in document["benchmarks"] if r.get("run_type", "iteration") == "iteration"]
    for run in sorted(runs, key=lambda r: r.get("family_index", 0)):
        match = ROW.match(run["run_name"])
        if match and "items_per_second" in run and "x" in run:
            samples[match.groups()].append((run["items_per_second"], run.get("busy_processors", 0.0)))
            facts[match.groups()] = dict(run)
    rows = []
    for key, values in samples.items():
        facts[key]["busy_processors"] = statistics.median(busy for _, busy in values)
        rows.append(Row(*key[:5], int(key[5]), statistics.median(rate for rate, _ in values), facts[key]))
    return rows


class Scale:
    """Logarithmic, from a range of values to a range of pixels."""

    def __init__(self, values, first, last, below=1.0, above=1.0):
        self.low, self.high = min(values) / below, max(values) * above
        if self.low == self.high:
            self.low, self.high = self.low / 2, self.high * 2
        self.first, self.last = first, last

    def __call__(self, value):
        part = math.log(value / self.low) / math.log(self.high / self.low)
        return self.first + part * (self.last - self.first)

    def ticks(self):
        """1, 2, 5, 10, ... or powers of ten alone where those are many."""
        decades = math.log10(self.high / self.low)
        steps = (1, 2, 5) if decades < 2.5 else (1,)
        powers = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        ticks = [step * 10.0**power for power in powers for step in steps]
        return [t for t in ticks if self.low * 0.999 <= t <= self.high * 1.001]


def tick_text(value):
    return f"{value:,.0f}" if value >= 1000 else f"{value:g}"


def x_text(axis, value):
    if axis != "size":
        return f"{value:g}"
    return f"{value:.1f}" if value < 10 else f"{value:.0f}"


class Chart(Drawing):
    """Markers, curves and heads of line charts."""

    def marker(self, caster, x, y, style=None):
        """A shape of its own for every caster, so that colour is not needed."""
        style = style or f"fill-{caster}"
        if caster == "grid":
            shape = f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8"'
        elif caster == "embree":
            shape = f'<path d="M{x:.1f} {y - 5.5:.1f}l5 5.5l-5 5.5l-5 -5.5z"'
        elif caster == FAST:
            shape = f'<path d="M{x:.1f} {y - 5.5:.1f}l5 9h-10z"'
        else:
            shape = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.2"'
        self.lines.append(f'{shape} class="{style}"/>')

    def curve(self, caster, points):
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
        self.lines.append(f'<path d="M{path}" class="line-{caster}" fill="none" stroke-width="2"/>')
        for x, y in points:
            self.marker(caster, x, y)

    def head(self, axis, facts, casters, names):
        self.text(MARGIN, 40, TITLES[axis], "title")
        self.text(MARGIN, 61, " · ".join(f for f in facts if f), "faint")
        x = MARGIN + 6
        for caster in casters:
            self.marker(caster, x, LEGEND_Y - 4)
            self.text(x + 11, LEGEND_Y, names[caster])
            x += 26 + 7 * len(names[caster]) + 14
        self.text(x + 4, LEGEND_Y, SUBTITLES[axis], "faint")


class Panel(NamedTuple):
    """Curves over one axis: {caster: [(x, y)]}."""
    axis: str
    title: str
    unit: str
    curves: dict
    ratios: dict  # x to the number at the curve of the fast caster


def panel_corner(index, pitch=PANEL_HEIGHT + 92):
    column, row = index % 2, index // 2
    x = MARGIN + AXIS_WIDTH + column * (PANEL_WIDTH + PANEL_GAP + 34)
    return x, LEGEND_Y + 52 + row * pitch


def draw_ratios(chart, panel, x_scale, y_scale):
    """Beside the points of the fast caster, on the side with fewer curves."""
    pixels = {c: [(x_scale(x), y_scale(y)) for x, y in sorted(points)] for c, points in panel.curves.items()}
    own = pixels.get(FAST, [])
    for i, (x, _) in enumerate(sorted(panel.curves.get(FAST, []))):
        if x not in panel.ratios:
            continue
        at, here = own[i]
        others = [y - here for c, points in pixels.items() if c != FAST for u, y in points if u == at]
        # A steep line to a neighbour crosses the text, half of which reaches towards it.
        others += [(y - here) * 14 / abs(u - at) for u, y in own[max(i - 1, 0):i] + own[i + 1:i + 2]]
        above = sum(-22 < y < 0 for y in others) <= sum(0 <= y < 26 for y in others)
        chart.lines.append(f'<text x="{at:.1f}" y="{here + (-9 if above else 18):.1f}" text-anchor="middle" '
                           f'class="value faint">{ratio_text(panel.ratios[x])}</text>')


def draw_panel(chart, panel, index, y_values, names):
    left, top = panel_corner(index)
    right, bottom = left + PANEL_WIDTH, top + PANEL_HEIGHT
    x_values = sorted({x for points in panel.curves.values() for x, _ in points})
    x_scale = Scale(x_values, left + 14, right - 14)
    y_scale = Scale(y_values, bottom, top, below=1.35, above=1.7)
    chart.text(left - AXIS_WIDTH, top - 22, panel.title, "map")
    chart.text(left - AXIS_WIDTH, top - 6, panel.unit, "faint")
    for tick in y_scale.ticks():
        chart.line(left, y_scale(tick), right, y_scale(tick), "rule")
        chart.text(left - 7, y_scale(tick) + 4, tick_text(tick), "faint", "end")
    labelled = -math.inf
    for x in x_values:
        chart.line(x_scale(x), bottom, x_scale(x), bottom + 4, "rule")
        if x_scale(x) - labelled > 26:
            chart.text(x_scale(x), bottom + 18, x_text(panel.axis, x), "faint", "middle")
            labelled = x_scale(x)
    chart.text((left + right) / 2, bottom + 36, X_TITLES[panel.axis], "faint", "middle")

    ends = []
    for caster, points in panel.curves.items():
        pixels = [(x_scale(x), y_scale(y)) for x, y in sorted(points)]
        chart.curve(caster, pixels)
        ends.append([pixels[-1][1], caster])
    draw_ratios(chart, panel, x_scale, y_scale)
    # The names beside the last points, moved apart where they would overlap.
    ends.sort()
    for previous, end in zip(ends, ends[1:]):
        end[0] = max(end[0], previous[0] + 14)
    for y, caster in ends:
        chart.text(right + 1, y + 4, names[caster], "faint")
    return bottom + 44


def draw_panels(axis, panels, facts):
    chart = Chart()
    names = COST_NAMES if axis == "cost" else NAMES
    chart.head(axis, facts, [c for c in CASTERS if any(c in p.curves for p in panels)], names)
    bottom = 0
    for index, panel in enumerate(panels):
        together = panels if axis != "cost" else [p for p in panels if p.unit == panel.unit]
        values = [y for p in together for points in p.curves.values() for _, y in points]
        bottom = max(bottom, draw_panel(chart, panel, index, values, names))
    return svg(TITLES[axis], bottom + MARGIN - 12, colours_of(CASTERS), chart)


def family(map_name):
    """building_0.3m is one of the buildings, rooms_2x2x2 one of the rooms."""
    return map_name.split("_")[0]


def rate_panels(axis, rows):
    panels = []
    groups = defaultdict(list)
    for row in rows:
        groups[family(row.map) if axis != "length" else row.map, row.query].append(row)
    for (_, query), group in groups.items():
        curves = {c: [(r.x, r.rate * 1e-6) for r in group if r.caster == c] for c in CASTERS}
        curves = {c: points for c, points in curves.items() if points}
        base, fast = dict(curves.get(BASELINE, [])), dict(curves.get(FAST, []))
        ratios = {x: fast[x] / base[x] for x in fast if x in base}
        where = f", {group[0].map}" if axis == "length" else ""
        panels.append(Panel(axis, QUERIES.get(query, query), f"million rays per second{where}", curves, ratios))
    return panels


def cost_panels(rows):
    """Memory, build time and time of an update of the maps of every axis that varies them."""
    panels = []
    for axis in ("size", "density", "resolution"):
        memory, build, update = defaultdict(dict), defaultdict(dict), defaultdict(dict)
        for row in rows:
            if row.axis != axis:
                continue
            if row.caster == BASELINE:
                memory[row.caster][row.x] = row.facts["octree_bytes"] / row.known
            else:
                memory[row.caster][row.x] = row.facts["memory_bytes"] / row.known
                build[row.caster][row.x] = row.facts["build_seconds"] * 1e9 / row.known
                if row.caster != "grid" and axis == "size":  # it refers to the map itself
                    update[row.caster][row.x] = row.facts["update_seconds"] * 1e3
        what = {"size": "rooms", "density": "box of random cubes", "resolution": "building"}[axis]
        for kind, unit, curves in (("Memory", "bytes per known voxel", memory),
                                   ("Build time", "nanoseconds per known voxel", build),
                                   ("After a look all around, 6 m", "milliseconds for an update", update)):
            if curves:
                points = {c: sorted(v.items()) for c, v in curves.items()}
                panels.append(Panel(axis, f"{kind}, {what}", unit, points, {}))
    return panels


def draw_order(rows, facts):
    """For every query and map, a line per caster and order, from one thread to all."""
    chart = Chart()
    chart.head("order", facts, CASTERS, NAMES)
    groups = defaultdict(list)
    for row in rows:
        groups[row.map, row.query].append(row)
    bottom = 0
    scale_values = [r.rate * 1e-6 for r in rows]
    for index, ((map_name, query), group) in enumerate(groups.items()):
        left, top = panel_corner(index, pitch=254 + 26 * 2)
        right = left + PANEL_WIDTH
        names = left + 68
        chart.text(left - AXIS_WIDTH, top - 22, QUERIES.get(query, query), "map")
        chart.text(left - AXIS_WIDTH, top - 6, f"million rays per second, {map_name}", "faint")
        scale = Scale(scale_values, names, right - 62, below=1.2)
        lines = [(c, label) for c in CASTERS for label in ("sorted", "shuffled")]
        end = top + 12 + 26 * len(lines)
        for tick in scale.ticks():
            chart.line(scale(tick), top + 4, scale(tick), end, "rule")
            chart.text(scale(tick), end + 16, tick_text(tick), "faint", "middle")
        for i, (caster, label) in enumerate(lines):
            y = top + 24 + 26 * i
            found = sorted((r.threads, r.rate * 1e-6) for r in group if (r.caster, r.label) == (caster, label))
            if not found:
                continue
            first, last = found[0], found[-1]
            chart.text(left - AXIS_WIDTH, y + 4, f"{NAMES[caster]}, {label}", "faint")
            chart.lines.append(f'<line x1="{scale(first[1]):.1f}" y1="{y}" x2="{scale(last[1]):.1f}" y2="{y}" '
                               f'class="line-{caster}" stroke-width="2"/>')
            chart.marker(caster, scale(last[1]), y)
            if first != last:
                chart.marker(caster, scale(first[1]), y, f'paper line-{caster}" stroke-width="2')
                chart.lines.append(f'<text x="{max(scale(first[1]), scale(last[1])) + 9:.1f}" y="{y + 4:.1f}" '
                                   f'class="value faint">{last[1] / first[1]:.2f}×, {digits(last[1])}</text>')
        bottom = max(bottom, end + 24)
    return svg(TITLES["order"], bottom + MARGIN - 12, colours_of(CASTERS), chart)


def disturbance(rows):
    """What a reader must know if the machine was busy with something else; empty if it was not."""
    threads = max(r.threads for r in rows)
    busy = [r.facts["busy_processors"] for r in rows if r.threads == threads]
    typical = statistics.median(busy)
    return f"CAUTION: measured beside other work, {typical:.1f} processors" if typical < 0.9 * threads else ""


def draw_all(document):
    """{name: svg} of every axis that was measured."""
    rows = [row for row in read_rows(document) if row.axis in TITLES]
    if not rows:
        raise ValueError("no rows of bench_scaling")
    context = document.get("context", {})
    date = context.get("date", "")[:10]
    caution = disturbance(rows)
    figures = {}
    for axis in dict.fromkeys(row.axis for row in rows):
        chosen = [r for r in rows if r.axis == axis]
        threads = max(r.threads for r in chosen)
        counted = f"{threads} threads" if threads > 1 else "1 thread"
        facts = [context.get("cpu_name", ""), counted, date, "medians", caution]
        if axis == "order":
            figures[axis] = draw_order(chosen, facts)
        else:
            figures[axis] = draw_panels(axis, rate_panels(axis, chosen), facts)
    panels = cost_panels(rows)
    if panels:
        figures["cost"] = draw_panels("cost", panels, [context.get("cpu_name", ""), date, "median of 3 builds"])
    return figures


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, metavar="RESULTS.json")
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    arguments = parser.parse_args()
    try:
        document = json.loads(arguments.results.read_text(encoding="utf-8"))
        figures = draw_all(document)
        arguments.folder.mkdir(parents=True, exist_ok=True)
        for name, figure in figures.items():
            save(arguments.folder / f"scaling_{name}.svg", figure)
    except (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError) as error:
        print(f"plot_scaling.py: {arguments.results}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
