"""The figures of docs/results.md."""

import math
from statistics import fmean

import paper
from comparisons import at_the_end, end_of, seconds_mapped, to_a_level
from markdown import counted
from palette import PALETTE, UAV, UGV
from svg_chart import MARGIN, WIDTH, Drawing, svg

AXIS, GAP, PANEL_HEIGHT, TOP = 40, 24, 210, 142
SAMPLES = 200  # along a curve


def line_of(results, method):
    """How a method is drawn, if it is: its colours, on light and on dark background, and its dashes."""
    line = results.experiments.methods[method].get("line")
    if line is None:
        return None
    section, _, which = line["colour"].partition(" ")
    colours = PALETTE[section]
    return tuple(colours[int(which) if which.isdigit() else which] if which else colours), line["dash"]


def drawn_methods(results, table):
    return [m for m in results.experiments.methods_of(table) if line_of(results, m)]


def is_drawn(results, run):
    """Whether figures show its curve."""
    return not run.timed and results.experiments.file_of(run.task) is None and any(
        run.method in drawn_methods(results, table) for table in ("main", "lock-step"))


def colours_of(results, methods):
    return {m: line_of(results, m)[0] for m in methods}


def round_step(largest, most):
    """1, 2 or 5 times a power of ten, so that at most so many steps fit."""
    power = 10.0 ** math.floor(math.log10(largest / most))
    return next(m * power for m in (1, 2, 5, 10) if m * power * most >= largest * (1 - 1e-9))


class Panel:
    """Axes from 0 and what is drawn between them."""

    def __init__(self, drawing, column, columns, x_end, y_end, title, x_title, y_title):
        self.drawing, self.x_end, self.y_end = drawing, x_end, y_end
        self.width = (WIDTH - 2 * MARGIN - columns * AXIS - (columns - 1) * GAP) / columns
        self.left = MARGIN + AXIS + column * (self.width + AXIS + GAP)
        self.right, self.bottom = self.left + self.width, TOP + PANEL_HEIGHT
        drawing.text(self.left - AXIS + 6, TOP - 28, title, "map")
        drawing.text(self.left - AXIS + 6, TOP - 13, y_title, "faint")
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
        return self.left + x / self.x_end * self.width, self.bottom - min(y / self.y_end, 1) * PANEL_HEIGHT

    def path(self, points):
        return "L".join("{:.1f} {:.1f}".format(*self.at(x, y)) for x, y in points)

    def area(self, name, lower, upper):
        outline = self.path(upper) + "L" + self.path(reversed(lower))
        self.drawing.lines.append(f'<path d="M{outline}z" class="fill-{name}" opacity="0.85"/>')

    def curve(self, name, points, dash=None):
        """A thick one with dashes, or a thin one."""
        path = self.path(points)
        style = 'stroke-width="0.8" opacity="0.22"' if dash is None else f'stroke-width="2.2" stroke-dasharray="{dash}"'
        self.drawing.lines.append(f'<path d="M{path}" class="line-{name}" fill="none" stroke-linejoin="round" {style}/>')


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


def xs_of(run):
    return [x for x, _, _ in run.curve]


def mean_curve(curves):
    return [(points[0][0], fmean(y for _, y in points)) for points in zip(*curves)]


def chart(title, note, titles, dashes):
    """With its head and a legend: of lines, and of areas where a name has no dashes."""
    drawing = Drawing()
    drawing.text(MARGIN, 40, title, "title")
    drawing.text(MARGIN, 61, note, "faint")
    x = MARGIN + 6
    for name in titles:
        if name in dashes:
            drawing.lines.append(f'<path d="M{x} 78h26" class="line-{name}" stroke-width="2.2" '
                                 f'stroke-dasharray="{dashes[name]}"/>')
        else:
            drawing.bar(x, 72, 26, 11, name)
        drawing.text(x + 33, 82, titles[name])
        x += 33 + 7 * len(titles[name]) + 18
    return drawing


def progress(results, tasks, names, title, x_title):
    """Coverage against seconds or steps: thin lines by seed, a thick one for their mean. Failed runs are drawn as well."""
    tasks = [t for t in tasks if any(r.curve for name in names for r in results.of(t, name))]
    names = [n for n in names if any(r.curve for t in tasks for r in results.of(t, n))]
    dashes = {n: line_of(results, n)[1] for n in names}
    drawing = chart(title, "Thin: each seed; thick: their mean, where a run that has ended keeps its last value; with "
                    "failed runs", {n: results.experiments.title(n) for n in names}, dashes)
    for column, task in enumerate(tasks):
        runs = {name: [r for r in results.of(task, name) if r.curve] for name in names}
        ends = {name: max((r.curve[-1][0] for r in runs[name]), default=0) for name in names}
        x_end = max(min(max(ends.values()), 3 * (ends.get(names[0]) or max(ends.values()))), 1)
        panel = Panel(drawing, column, len(tasks), x_end, 100, task, x_title, "mapped part of the observable space [%]")
        for name in reversed(names):
            curves = [sampled(xs_of(r), [100 * mapped for _, mapped, _ in r.curve], x_end) for r in runs[name]]
            for points, run in zip(curves, runs[name]):
                panel.curve(name, [p for p in points if p[0] <= run.curve[-1][0]] or points[:1])
            if curves:
                panel.curve(name, mean_curve(curves), dashes[name])
    return svg(title, TOP + PANEL_HEIGHT + 35 + MARGIN - 8, colours_of(results, names), drawing)


def contributions(results, method="steps"):
    """What each kind of robot mapped first, stacked, by step: means over seeds."""
    title, kinds = "What each robot mapped first, the paper's method", ("ugv", "uav")
    drawing = chart(title, "Means over seeds, where a run that has ended keeps its last value; with failed runs",
                    {"ugv": "UGV", "uav": "UAV"}, {})
    tasks = [t for t in paper.WORLDS if any(r.curve for r in results.of(t, method))]
    for column, task in enumerate(tasks):
        runs = [r for r in results.of(task, method) if r.curve]
        x_end = max(max(r.curve[-1][0] for r in runs), 1)
        panel = Panel(drawing, column, len(tasks), x_end, 100, task, "steps", "mapped part of the observable space [%]")
        lower = [(x_end * i / SAMPLES, 0) for i in range(SAMPLES + 1)]
        for kind in kinds:
            own = mean_curve([sampled(xs_of(r), [100 * (by_ugv if kind == "ugv" else mapped - by_ugv)
                                                 for _, mapped, by_ugv in r.curve], x_end) for r in runs])
            upper = [(x, below + y) for (x, below), (_, y) in zip(lower, own)]
            panel.area(kind, lower, upper)
            lower = upper
    return svg(title, TOP + PANEL_HEIGHT + 35 + MARGIN - 8, {"ugv": UGV, "uav": UAV}, drawing)


def ratios(results, first="tour"):
    """For each task and method two marks with their intervals, on a logarithmic axis about 1: until the world was mapped,
    full, and to the end, hollow."""
    title, row_height, left = "Time until the world was mapped: tours by each other method", 28, 330
    others = [m for m in drawn_methods(results, "main") if m != first]
    rows = []
    for task in results.tasks():
        for other in others:
            mapped = to_a_level(results, [task], first, other, seconds_mapped).found
            if mapped:
                rows.append((task, other, mapped, at_the_end(results, [task], first, other, end_of)))
    drawing = Drawing()
    drawing.text(MARGIN, 40, title, "title")
    drawing.text(MARGIN, 61, "By pairs with the same seed, with 95 % intervals; left of 1 tours are earlier. Full: median of "
                 "ratios until mapped", "faint")
    drawing.text(MARGIN, 78, "(99 %, hospital 90 %); hollow: ratio of means to the end, which each method chooses by its "
                 "own rule", "faint")
    right, top = WIDTH - MARGIN - 90, 108
    values = [v for row in rows for found in row[2:] if found for v in found[:3] if v and math.isfinite(v)] or [1]
    low, high = max(min(*values, 0.5), 0.05) / 1.05, min(max(*values, 1.1), 5) * 1.05

    def at(x):
        x = min(max(x, low), high)  # an infinite one lies at the edge
        return left + (math.log(x) - math.log(low)) / (math.log(high) - math.log(low)) * (right - left)

    bottom = top + row_height * len(rows)
    for tick in (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0):
        if low <= tick <= high:
            drawing.line(at(tick), top - 8, at(tick), bottom, "base" if tick == 1 else "rule")
            drawing.text(at(tick), bottom + 16, f"{tick:g}", "faint", "middle")
    previous = None
    for i, (task, other, *both) in enumerate(rows):
        y = top + row_height * (i + 0.5)
        if task != previous:
            drawing.text(MARGIN, y + 4, task.replace("_", " "), "strong")
        previous = task
        drawing.text(left - 12, y + 4, results.experiments.title(other), "", "end")
        for found, down, width, mark in ((both[0], -5, 2.2, f'r="4.2" class="fill-{other}"'),
                                         (both[1], 6, 1, f'r="3" class="line-{other}" fill="none"')):
            if found is None:
                continue
            if found.low is not None:
                drawing.lines.append(f'<path d="M{at(found.low):.1f} {y + down:.1f}H{at(found.high):.1f}" '
                                     f'class="line-{other}" stroke-width="{width}"/>')
            drawing.lines.append(f'<circle cx="{at(found.value):.1f}" cy="{y + down:.1f}" {mark}/>')
        drawing.text(WIDTH - MARGIN, y + 4, counted(both[0].count, "pair"), "faint", "end")
    return svg(title, bottom + 30 + MARGIN - 8, colours_of(results, others), drawing)


def figures(results):
    """{name: SVG}; those of runs in lock-step if there are some."""
    drawn = {
        "coverage_by_time": progress(results, results.tasks(of_files=False), drawn_methods(results, "main"),
                                     "Coverage by time", "time on the clock [s]"),
        "ratios": ratios(results),
    }
    if any(results.methods(world, "lock-step") for world in paper.WORLDS):
        drawn |= {
            "coverage_by_step": progress(results, paper.WORLDS, drawn_methods(results, "lock-step"),
                                         "Coverage by step, the paper's method", "steps"),
            "contributions": contributions(results),
        }
    return drawn
