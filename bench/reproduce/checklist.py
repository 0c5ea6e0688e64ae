"""What the reproduction must hold, measured on the runs, and by how much a run falls short."""

import paper
from markdown import NOTHING, percent, plain, table, value
from recorded import first_difference, spread
from runs import WORLDS

SEEDS_ASKED = 5


def verdict(measured, limit, unit="", digits=1, at_most=False, below=False):
    """`below`: the limit itself is too much."""
    if measured is None:
        return "not measured"
    missing = measured - limit if at_most or below else limit - measured
    if missing < -1e-9 or (missing <= 1e-9 and not below):
        return "holds"
    if missing <= 1e-9:
        return "**falls short: the same**"
    return f"**falls short by {max(missing, 10.0**-digits):,.{digits}f}{unit}**"


def savings(results, variant, other, worlds, coverage=0.9):
    """The fraction of the other variant's steps to that coverage that the first variant saves, by pair of runs; and
    the same for the pairs in which both reached it."""
    pairs = results.pairs(variant, other, worlds)
    counted = [1 - a.steps_or_limit(coverage) / b.steps_or_limit(coverage) for a, b in pairs
               if b.steps_or_limit(coverage)]
    reached = [1 - a.steps_to(coverage) / b.steps_to(coverage) for a, b in pairs
               if a.steps_to(coverage) is not None and b.steps_to(coverage)]
    return spread(counted), spread(reached)


def means(pairs, measure):
    """Of both sides of the pairs, where both have a value."""
    both = [(measure(a), measure(b)) for a, b in pairs]
    both = [(a, b) for a, b in both if a is not None and b is not None]
    if not both:
        return None, None
    return sum(a for a, _ in both) / len(both), sum(b for _, b in both) / len(both)


def coverage_lines(results):
    for world in WORLDS:
        runs = results.of(world, "team")
        found = spread(run.coverage[-1] for run in runs)
        seeds = ", ".join(str(run.run.seed) for run in runs)
        said = found and f"lowest {percent(found.low)}, mean {percent(found.mean)}; seeds {seeds}"
        held = verdict(found and 100 * found.low, 100 * paper.COVERAGE[world], " points", 2)
        if held == "holds" and found.count < SEEDS_ASKED:
            held += f" (of the {SEEDS_ASKED} seeds asked for, {found.count} were run)"
        yield f"Coverage of the {world}, seeds 1 to 5: at least {percent(paper.COVERAGE[world])}", said, held


def team_lines(results):
    counted, reached = savings(results, "team", "uav", WORLDS)
    team, alone = means(results.pairs("team", "uav", WORLDS), lambda run: run.steps_or_limit(0.9))
    said = counted and (f"{percent(counted.mean)} (counting limits), {percent(reached and reached.mean)} over the "
                        f"{reached.count if reached else 0} of {counted.count} pairs in which both reached it; of the "
                        f"mean steps, {team:,.1f} and {alone:,.1f}, it is {percent(1 - team / alone) if alone else NOTHING}")
    yield ("Steps to 90 % that the team saves against the UAV alone, mean over worlds and seeds: at least 30 %", said,
           verdict(counted and 100 * counted.mean, 30, " points"))
    team, alone = means(results.pairs("team", "uav", WORLDS), lambda run: run.travelled("uav")[-1])
    yield ("The UAV flies less in the team than alone, mean", alone and f"{team:,.0f} m, alone {alone:,.0f} m",
           verdict(team, alone, " m", 0, below=True))


def nearest_lines(results):
    for world in WORLDS:
        pairs = results.pairs("team", "nearest", [world])
        for what, measure in (("to the end", lambda run: run.steps),
                              ("to 90 %", lambda run: run.steps_or_limit(0.9))):
            own, nearest = means(pairs, measure)
            yield (f"Fewer steps {what} than nearest goals, {world}, mean",
                   own is not None and f"{own:,.1f}, nearest {nearest:,.1f}",
                   verdict(own, nearest, " steps", below=True))
    pairs = results.pairs("team", "nearest", WORLDS)
    for what, measure in (("to the end", lambda run: run.travelled()[-1]), ("to 90 %", lambda run: run.length_to(0.9))):
        own, nearest = means(pairs, measure)
        yield (f"Shorter paths {what} than nearest goals, all robots, mean over worlds and seeds",
               own is not None and f"{own:,.0f} m, nearest {nearest:,.0f} m",
               verdict(own, nearest, " m", 0, below=True))


def time_lines(results):
    for world in WORLDS:
        run = results.timed(world)
        mean = run and run.planning_mean
        aim = "" if run is None else " (aim of 0.1 s: " + verdict(mean, 0.1, " s", 3, at_most=True) + ")"
        yield (f"Planning in the {world} on 2 threads: mean at most 0.5 s a step", run and f"{mean:.3f} s",
               verdict(mean, 0.5, " s", 3, at_most=True) + aim)
    run = results.timed("station")
    yield ("Station, team, on 2 threads: under 5 minutes", run and f"{run.wall:,.0f} s",
           verdict(run and run.wall, 300, " s", 0, below=True))
    yield ("Station, team: under 2 GB", run and f"{run.memory:,.0f} MB",
           verdict(run and run.memory, 2000, " MB", 0, below=True))


def same(one, other):
    step = first_difference(one, other)
    return "the same" if step is None else f"**not the same** from step {step} on"


def sameness_lines(results):
    for what, partner in (
            ("Same rows, times aside, on 1 and 2 threads",
             lambda w: next((r for r in results.of(w, "team") if r.run.seed == 1), None)),
            ("The fast caster and the BVH alone give the same run", lambda w: results.timed(w, "embree")),
            ("The fast and the grid caster give the same run", lambda w: results.timed(w, "grid"))):
        said, differ, compared = [], 0, 0
        for world in WORLDS:
            one, other = results.timed(world), partner(world)
            if one and other:
                compared += 1
                differ += first_difference(one, other) is not None
                said.append(f"{world}: {same(one, other)}")
        held = "not measured" if not compared else "holds" if not differ else f"**falls short in {differ} worlds**"
        if held == "holds" and compared < len(WORLDS):
            held += f" (in {compared} of {len(WORLDS)} worlds)"
        yield what, "; ".join(said), held


def safety_lines(results):
    runs = list(results.runs.values())
    hits = sum(run.collisions for run in runs)
    yield ("No collision in any run", runs and f"{hits:,.0f} in {len(runs)} runs",
           verdict(hits if runs else None, 0, " collisions", 0, at_most=True))
    limited = sum(run.end == "step_limit" for run in runs)
    yield ("Every run ends by itself, with its reason",
           runs and f"{len(runs) - limited} of {results.wanted} runs; {limited} at the step limit, "
           f"{len(results.broken)} failed or missing",
           verdict(limited + len(results.broken) if runs else None, 0, " runs", 0, at_most=True))
    hours = sum(run.wall / (1 if run.run.timed else 2) for run in runs) / 3600
    yield ("At most two hours on two cores", runs and value(hours, 2, " h") + " (wall times, halved where two ran)",
           verdict(hours if runs else None, 2, " h", 2, at_most=True))


def checklist(results):
    rows = []
    for lines in (coverage_lines, team_lines, nearest_lines, time_lines, safety_lines, sameness_lines):
        for what, said, held in lines(results):
            rows.append([plain(what), said or NOTHING, held])
    return table(["must hold", "measured", ""], rows, texts=3)
