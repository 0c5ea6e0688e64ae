#!/usr/bin/env python3
"""Draws the table of bench_view_error, a map's rows: plot_view_error.py RESULTS.csv CHART.svg [MAP]"""

import argparse
import csv
import math
import sys
from pathlib import Path
from typing import NamedTuple

from palette import colours
from plot_scaling import PANEL_HEIGHT, PANEL_WIDTH, Scale, panel_corner, tick_text
from svg_chart import MARGIN, Drawing, save, svg

COLOURS = colours("view_quality")
SAMPLINGS = {
    "feasible": "drawn from frontiers in reach",
    "buckets": "drawn from buckets",
    "paper": "hits as gain, as the paper has it",
}
ROBOTS = {"ugv": "ground robot, 6 m", "uav": "aerial robot, 10 m"}
LEFT_OF_AXIS = 46


class Curve(NamedTuple):
    name: str
    points: list  # (n_r, value)


class Panel(NamedTuple):
    title: str
    unit: str
    curves: list
    levels: list  # (label, value, style) of horizontal lines
    guide: float  # value at the first n_r of a line that falls with 1/sqrt(n_r); 0: none
    logarithmic: bool


class Linear:
    """From 0 to the largest value, to a range of pixels."""

    def __init__(self, values, first, last):
        self.high, self.first, self.last = max([*values, 1e-9]) * 1.12, first, last

    def __call__(self, value):
        return self.first + value / self.high * (self.last - self.first)

    def ticks(self):
        step = 10.0 ** math.floor(math.log10(self.high))
        step = next(step / part for part in (1, 2, 5, 10) if self.high * part / step >= 4)
        return [i * step for i in range(int(self.high / step) + 1)]


def read_rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError("has no rows")
    return rows


def curve(rows, name, column, factor=1.0):
    points = [(int(r["samples"]), factor * float(r[column])) for r in rows if r["sampling"] == name]
    return Curve(name, sorted(points))


def cpu_of_all(rows, method):
    return next(float(r["cpu_ms"]) for r in rows if r["method"] == method and not r["samples"])


def panels_of(robot, rows):
    where = ROBOTS.get(robot, robot)
    count = int(next(r["viewpoints"] for r in rows if r["method"] == "exact"))
    errors = [curve(rows, name, "rms_error", 100) for name in ("feasible", "buckets")]
    times = [curve(rows, name, "cpu_ms") for name in ("feasible", "buckets")]
    losses = [curve(rows, name, "place_loss", 100) for name in SAMPLINGS]
    levels = [("exact", cpu_of_all(rows, "exact"), "line-exact"), ("all rays", cpu_of_all(rows, "fast"), "base")]
    return [
        Panel(f"Error, {where}", "root mean square, % of the mean gain", errors, [], errors[0].points[0][1], True),
        Panel(f"Time, {count:,} viewpoints", "milliseconds of one processor", times, levels, 0, True),
        Panel("Loss of goal quality", "% of eq. 1, mean over 64 places of the robot", losses, [], 0, False),
    ]


def values_of(panel):
    return [y for c in panel.curves for _, y in c.points if y > 0 or not panel.logarithmic] + \
        [value for _, value, _ in panel.levels]


def label_ends(drawing, right, bottom, ends):
    """The names beside the last points, moved apart where they would overlap, and up where they would be
    below the axis."""
    ends.sort()
    for previous, end in zip(ends, ends[1:]):
        end[0] = max(end[0], previous[0] + 13)
    lowest = bottom
    for end in reversed(ends):
        end[0] = min(end[0], lowest)
        lowest = end[0] - 13
    for y, name in ends:
        drawing.text(right + 3, y + 4, name, "faint")


def draw_panel(drawing, panel, index):
    left, top = panel_corner(index)
    right, bottom = left + PANEL_WIDTH, top + PANEL_HEIGHT
    numbers = sorted({x for c in panel.curves for x, _ in c.points})
    across = Scale(numbers, left + 14, right - 14)
    values = values_of(panel)
    up = Scale(values, bottom, top, below=1.25, above=1.4) if panel.logarithmic else Linear(values, bottom, top)
    drawing.text(left - LEFT_OF_AXIS, top - 22, panel.title, "map")
    drawing.text(left - LEFT_OF_AXIS, top - 6, panel.unit, "faint")
    for tick in up.ticks():
        drawing.line(left, up(tick), right, up(tick), "rule")
        drawing.text(left - 7, up(tick) + 4, tick_text(tick), "faint", "end")
    for x in numbers:
        drawing.line(across(x), bottom, across(x), bottom + 4, "rule")
        drawing.text(across(x), bottom + 18, str(x), "faint", "middle")
    drawing.text((left + right) / 2, bottom + 36, "frontiers drawn for a viewpoint, n_r", "faint", "middle")
    ends = []
    for label, value, style in panel.levels:
        stroke = f'{style}" stroke-width="2' if style != "base" else style
        drawing.line(left, up(value), right, up(value), stroke)
        ends.append([up(value), label])
    if panel.guide:
        last = panel.guide * math.sqrt(numbers[0] / numbers[-1])
        drawing.line(across(numbers[0]), up(panel.guide), across(numbers[-1]), up(last), "base")
        ends.append([up(last), "1/√n_r"])
    for name, points in panel.curves:
        pixels = [(across(x), up(y)) for x, y in points if y > 0 or not panel.logarithmic]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in pixels)
        drawing.lines.append(f'<path d="M{path}" class="line-{name}" fill="none" stroke-width="2"/>')
        for x, y in pixels:
            drawing.lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.6" class="fill-{name}"/>')
        ends.append([pixels[-1][1], name])
    label_ends(drawing, right, bottom, ends)
    return bottom + 44


def draw(rows, map_name):
    rows = [r for r in rows if r["map"] == map_name]
    if not rows:
        raise ValueError(f"has no rows of the map {map_name}")
    robots = list(dict.fromkeys(r["robot"] for r in rows))
    columns = [panels_of(robot, [r for r in rows if r["robot"] == robot]) for robot in robots]
    drawing = Drawing()
    title = "View quality: drawn frontiers against all of them"
    drawing.text(MARGIN, 40, title, "title")
    passes, threads = rows[0]["passes"], int(rows[0]["threads"])
    drawing.text(MARGIN, 61, f"{map_name} · medians of {passes} passes, {threads} "
                 f"thread{'s' if threads > 1 else ''}, processor time · the truth is the exact image", "faint")
    x = MARGIN
    for name, words in {**SAMPLINGS, "exact": "all, by the exact renderer"}.items():
        drawing.bar(x, 78, 16, 10, name)
        drawing.text(x + 22, 88, words)
        x += 22 + 6.3 * len(words) + 22
    bottom = 0
    for column, panels in enumerate(columns):
        for row, panel in enumerate(panels):
            bottom = max(bottom, draw_panel(drawing, panel, 2 * row + column))
    return svg(title, bottom + MARGIN - 12, COLOURS, drawing)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, metavar="RESULTS.csv")
    parser.add_argument("chart", type=Path, metavar="CHART.svg")
    parser.add_argument("map", nargs="?", metavar="MAP", help="the first of the table if not given")
    arguments = parser.parse_args()
    try:
        rows = read_rows(arguments.results)
        save(arguments.chart, draw(rows, arguments.map or rows[0]["map"]))
    except (OSError, ValueError, LookupError, TypeError, StopIteration) as error:
        print(f"plot_view_error.py: {arguments.results}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
