#!/usr/bin/env python3
"""Draws the speed-up over castRay from the JSON of bench_rays: plot.py RESULTS.json CHART.svg"""

import argparse
import json
import re
import statistics
import sys
from collections import defaultdict
from pathlib import Path

from palette import colours
from svg_chart import MARGIN, WIDTH, Drawing, save, svg

BASELINE = "octomap"
ROW = re.compile(r"(?P<query>[^/]+)/(?P<map>[^/]+)/(?P<caster>[^/]+)/threads:(?P<threads>\d+)")

WHAT_IT_ASKS = {
    "visible_ugv": "ground robot to frontiers, 6 m",
    "visible_uav": "aerial robot to frontiers, 10 m",
    "cast_lidar": "32-beam lidar, 30 m",
    "cast_random": "all directions, 10 m",
    "cast_single": "one castRay at a time",
}

COLOURS = colours("casters")
NAMES = {"fast": "fast (make_ray_caster)", "embree": "embree (BVH, no table)", "grid": "grid (voxel by voxel)"}
OTHER = ("#56b4e9", "#0072b2")

LABELS, VALUES = 330, 140
BAR, GAP, ROW_GAP, SECTION = 13, 2, 15, 34


def read_results(document):
    """By map, query, threads and caster, in the order of the file's families: median rays per second and the
    fraction of answers that agree."""
    samples = defaultdict(list)
    runs = [r for r in document["benchmarks"] if r.get("run_type", "iteration") == "iteration"]
    for run in sorted(runs, key=lambda r: r.get("family_index", 0)):
        row = ROW.match(run["run_name"])
        if row and "items_per_second" in run:
            key = (row["map"], row["query"], int(row["threads"]), row["caster"])
            samples[key].append((run["items_per_second"], run.get("agreement", 1.0)))
    results = defaultdict(lambda: defaultdict(dict))
    for (map_name, query, threads, caster), values in samples.items():
        rate = statistics.median(rate for rate, _ in values)
        results[map_name][query].setdefault(threads, {})[caster] = (rate, min(a for _, a in values))
    return results


def digits(value):
    return f"{value:.2f}" if value < 9.995 else f"{value:.1f}" if value < 99.95 else f"{value:.0f}"


def ratio_text(value):
    return f"{value:.1f}×" if value < 19.95 else f"{value:.0f}×"


def tick_step(largest):
    """A round step that gives four to nine ticks."""
    step = 1.0
    while largest / step > 9:
        step *= 2.5 if str(step).startswith("2") else 2
    return step


def colours_of(casters):
    return {c: COLOURS.get(c, OTHER) for c in casters}


def compare(results, threads):
    """[(map, [(query, castRay's rate, [(caster, rate, ratio, fraction of wrong answers)])])]"""
    charts = []
    for map_name, queries in results.items():
        rows = []
        for query, by_threads in queries.items():
            found = by_threads.get(threads, {})
            if BASELINE in found:
                baseline = found.pop(BASELINE)[0]
                bars = [(c, rate, rate / baseline, 1 - agreement) for c, (rate, agreement) in found.items()]
                rows.append((query, baseline, bars))
        if rows:
            charts.append((map_name, rows))
    if not charts:
        raise ValueError(f"no rows of {BASELINE} to compare with")
    return charts


def draw(results, context):
    counts = {t for queries in results.values() for by_threads in queries.values() for t in by_threads}
    threads = max(counts, default=1)
    charts = compare(results, threads)
    every_bar = [bar for _, rows in charts for _, _, bars in rows for bar in bars]
    casters = list(dict.fromkeys(caster for caster, *_ in every_bar))
    largest = max((ratio for _, _, ratio, _ in every_bar), default=1.0)

    left, right = MARGIN + LABELS, WIDTH - MARGIN - VALUES
    step = tick_step(largest)
    scale = (right - left) / max(largest, 1.0)
    drawing = Drawing()
    drawing.text(MARGIN, 40, "How many times as fast as OctoMap's castRay", "title")
    facts = [context.get("cpu_name", ""), f"{threads} threads" if threads > 1 else "1 thread",
             context.get("date", "")[:10], "the same rays for all casters, medians"]
    drawing.text(MARGIN, 61, " · ".join(f for f in facts if f), "faint")
    x = MARGIN
    for caster in casters:
        drawing.bar(x, 76, 22, 11, caster)
        drawing.text(x + 29, 86, NAMES.get(caster, caster))
        x += 29 + 6.4 * len(NAMES.get(caster, caster)) + 22
    drawing.line(x + 6, 74, x + 6, 89, "base")
    drawing.text(x + 14, 86, "castRay = 1×")

    y = 104
    for map_name, rows in charts:
        y += SECTION
        drawing.text(MARGIN, y - 10, map_name, "map")
        heights = [max(2 * (BAR + GAP), len(bars) * (BAR + GAP)) + ROW_GAP for _, _, bars in rows]
        bottom = y + sum(heights)
        tick = 0.0
        while tick <= largest:
            drawing.line(left + tick * scale, y - 4, left + tick * scale, bottom - ROW_GAP + 6, "rule")
            drawing.text(left + tick * scale, bottom + 4, f"{tick:g}×" if tick else "0", "faint", "middle")
            tick += step
        for (query, baseline, bars), height in zip(rows, heights):
            drawing.text(MARGIN, y + 11, query, "query")
            drawing.text(left - 14, y + 18, f"castRay {digits(baseline * 1e-6)} Mrays/s", "faint", "end")
            drawing.text(MARGIN, y + 25, WHAT_IT_ASKS.get(query, ""), "faint")
            for i, (caster, rate, ratio, wrong) in enumerate(bars):
                remark = f", {100 * wrong:.2g} % of answers wrong" if wrong > 0 else ""
                top = y + i * (BAR + GAP)
                drawing.bar(left, top, ratio * scale, BAR, caster)
                drawing.lines.append(
                    f'<text x="{left + ratio * scale + 7:.1f}" y="{top + 11:.1f}" class="value">'
                    f'<tspan class="strong">{ratio_text(ratio)}</tspan>'
                    f'<tspan class="faint" dx="8">{digits(rate * 1e-6)} Mrays/s{remark}</tspan></text>')
            y += height
        drawing.line(left + scale, bottom - sum(heights) - 4, left + scale, bottom - ROW_GAP + 6, "base")
        y += 12
    height = y + MARGIN - 8

    return svg("Speed-up over castRay", height, colours_of(casters), drawing)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, metavar="RESULTS.json")
    parser.add_argument("chart", type=Path, metavar="CHART.svg")
    arguments = parser.parse_args()
    try:
        document = json.loads(arguments.results.read_text(encoding="utf-8"))
        save(arguments.chart, draw(read_results(document), document.get("context", {})))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        print(f"plot.py: {arguments.results}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
