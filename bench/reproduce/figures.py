"""The figures of docs/results.md: one panel for each world, side by side."""

import math
import sys
from pathlib import Path

sys.path.insert(1, str(Path(__file__).resolve().parent.parent))  # of all plots

from palette import TEAM, UAV, UGV, colours
from recorded import PHASES
from runs import VARIANTS, WORLDS
from svg_chart import MARGIN, WIDTH, Drawing, svg

COLOURS = {"team": TEAM, "uav": UAV, "ugv": UGV, **colours("goals"), **colours("phases")}
DASHES = {"team": "", "uav": "7 3", "ugv": "2 3", "cluster": "7 3", "nearest": "2 3"}
TITLES = {"uav": "UAV", "ugv": "UGV"}

AXIS, GAP, PANEL_HEIGHT, TOP = 40, 24, 200, 142
PANEL_WIDTH = (WIDTH - 2 * MARGIN - 3 * AXIS - 2 * GAP) / 3
SAMPLES = 160  # along a curve


def round_step(largest, most):
    """1, 2 or 5 times a power of ten, so that at most so many steps fit."""
    power = 10.0 ** math.floor(math.log10(largest / most))
    return next(m * power for m in (1, 2, 5, 10) if m * power * most >= largest * (1 - 1e-9))


class Panel:
    """Axes from 0 and what is drawn between them."""

    def __init__(self, drawing, column, row, x_end, y_end, title, x_title, y_title):
        self.drawing, self.x_end, self.y_end = drawing, x_end, y_end
        self.left = MARGIN + AXIS + column * (PANEL_WIDTH + AXIS + GAP)
        self.top = TOP + row * (PANEL_HEIGHT + 92)
        self.right, self.bottom = self.left + PANEL_WIDTH, self.top + PANEL_HEIGHT
        drawing.text(self.left - AXIS + 6, self.top - 28, title, "map")
        drawing.text(self.left - AXIS + 6, self.top - 13, y_title, "faint")
        drawing.text((self.left + self.right) / 2, self.bottom + 35, x_title, "faint", "middle")
        for step, end, horizontal in ((round_step(y_end, 5), y_end, True), (round_step(x_end, 5), x_end, False)):
            for i in range(int(end / step * (1 + 1e-9)) + 1):
                x, y = self.at(0 if horizontal else i * step, i * step if horizontal else 0)
                if horizontal:
                    drawing.line(self.left, y, self.right, y, "rule")
                    drawing.text(self.left - 7, y + 4, f"{i * step:,.6g}", "faint", "end")
                else:
                    drawing.line(x, self.bottom, x, self.bottom + 4, "rule")
                    drawing.text(x, self.bottom + 18, f"{i * step:,.6g}", "faint", "middle")

    def at(self, x, y):
        return self.left + x / self.x_end * PANEL_WIDTH, self.bottom - min(y / self.y_end, 1) * PANEL_HEIGHT

    def path(self, points):
        return "L".join("{:.1f} {:.1f}".format(*self.at(x, y)) for x, y in points)

    def curve(self, name, points, mean):
        style = f'stroke-width="2.4" stroke-dasharray="{DASHES[name]}"' if mean else 'stroke-width="1" opacity="0.35"'
        self.drawing.lines.append(f'<path d="M{self.path(points)}" class="line-{name}" fill="none" '
                                  f'stroke-linejoin="round" {style}/>')

    def area(self, name, lower, upper):
        outline = self.path(upper) + "L" + self.path(reversed(lower))
        self.drawing.lines.append(f'<path d="M{outline}z" class="fill-{name}" opacity="0.85"/>')


def value_at(xs, ys, x):
    """Between the points in a straight line, beyond the last as there."""
    if x >= xs[-1]:
        return ys[-1]
    i = next(i for i, other in enumerate(xs) if other > x)
    if i == 0:
        return ys[0]
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])


def sampled(xs, ys, end):
    return [(x, value_at(xs, ys, x)) for x in (end * i / SAMPLES for i in range(SAMPLES + 1))]


def mean_curve(curves):
    return [(points[0][0], sum(y for _, y in points) / len(points)) for points in zip(*curves)]


def chart(title, note, names, titles, dashed=True):
    """With its head and a legend."""
    drawing = Drawing()
    drawing.text(MARGIN, 40, title, "title")
    drawing.text(MARGIN, 61, note, "faint")
    x = MARGIN + 6
    for name in names:
        if dashed:
            drawing.lines.append(f'<path d="M{x} 78h26" class="line-{name}" stroke-width="2.4" '
                                 f'stroke-dasharray="{DASHES[name]}"/>')
        else:
            drawing.bar(x, 72, 26, 11, name)
        drawing.text(x + 33, 82, titles[name])
        x += 33 + 7 * len(titles[name]) + 22
    return drawing


def finish(drawing, title, names, rows=1):
    height = TOP + rows * (PANEL_HEIGHT + 92) - 92 + 35 + MARGIN - 8
    return svg(title, height, {name: COLOURS[name] for name in names}, drawing)


def progress(results, names, title, measure, x_title):
    """Coverage against what `measure` gives by step: thin lines by seed, a thick one for their mean."""
    drawing = chart(title, "Thin: each seed; thick: their mean, where a finished run keeps its last value; cut at three "
                    "times the longest run of the team", names, {n: VARIANTS[n].title for n in names})
    for column, world in enumerate(WORLDS):
        runs = {name: results.of(world, name) for name in names}
        ends = [(name, measure(run)[-1]) for name in names for run in runs[name]]
        team = max((end for name, end in ends if name == "team"), default=math.inf)
        x_end = max(min(max((end for _, end in ends), default=1), 3 * team), 1)
        panel = Panel(drawing, column, 0, x_end, 100, world, x_title, "coverage of the observable space [%]")
        for name in reversed(names):
            curves = [sampled(measure(r), [100 * c for c in r.coverage], x_end) for r in runs[name]]
            for points, run in zip(curves, runs[name]):
                panel.curve(name, [p for p in points if p[0] <= measure(run)[-1]] or points[:1], False)
            if curves:
                panel.curve(name, mean_curve(curves), True)
    return finish(drawing, title, names)


def steps_of(run):
    return list(range(run.steps + 1))


def contributions(results):
    names, title = ("ugv", "uav"), "What each robot observed first"
    drawing = chart(title, "Means over seeds; a finished run keeps its last value", names, TITLES, False)
    for row, variant in enumerate(("team", "unoptimised")):
        for column, world in enumerate(WORLDS):
            runs = results.of(world, variant)
            x_end = max((run.steps for run in results.of(world, "team") + results.of(world, "unoptimised")), default=1)
            panel = Panel(drawing, column, row, max(x_end, 1), 100, f"{world}, {VARIANTS[variant].title}", "steps",
                          "coverage of the observable space [%]")
            lower = [(0, 0), (x_end, 0)]
            total = [0.0] * (SAMPLES + 1)
            for name in names if runs else ():
                own = mean_curve([sampled(steps_of(r), [100 * k for k in r.known_by(name)], x_end) for r in runs])
                total = [t + y for t, (_, y) in zip(total, own)]
                upper = [(x, t) for (x, _), t in zip(own, total)]
                panel.area(name, lower, upper)
                lower = upper
    return finish(drawing, title, names, 2)


def planning_time(results):
    title = "Planning time of each step"
    drawing = chart(title, "Both robots; one run for each world, alone on the machine, 2 threads; dashed lines are "
                    "the means", PHASES, {name: name for name in PHASES}, False)
    for column, world in enumerate(WORLDS):
        run = results.timed(world)
        sums = [1e3 * s for s in run.seconds("planning_s")] if run else []
        highest = max(max(sums, default=1), 1e-3)
        x_end, y_end = max(len(sums), 1), math.ceil(highest / round_step(highest, 5)) * round_step(highest, 5)
        panel = Panel(drawing, column, 0, x_end, y_end, world, "steps", "planning [ms]")
        lower = [0.0] * len(sums)
        for phase in PHASES if sums else ():
            upper = [a + 1e3 * s for a, s in zip(lower, run.seconds(f"{phase}_s"))]
            panel.area(phase, *([(x, y) for i, y in enumerate(ys) for x in (i, i + 1)] for ys in (lower, upper)))
            lower = upper
        if sums:
            (x1, y), (x2, _) = panel.at(0, sum(sums) / len(sums)), panel.at(x_end, 0)
            drawing.line(x1, y, x2, y, "base")
    return finish(drawing, title, PHASES)


def figures(results):
    """{name: SVG}"""
    robots, goals = ("team", "uav", "ugv"), ("team", "cluster", "nearest")
    return {
        "coverage_by_step": progress(results, robots, "Coverage by step", steps_of, "steps"),
        "coverage_by_path": progress(results, robots, "Coverage by path", lambda run: run.travelled(),
                                     "length of all robots' paths [m]"),
        "goals": progress(results, goals, "Coverage by how goals are chosen", steps_of, "steps"),
        "contributions": contributions(results),
        "planning_time": planning_time(results),
    }
