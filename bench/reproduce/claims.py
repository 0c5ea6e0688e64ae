"""What the paper claims and what this program shall hold, judged on the runs. Every line can fail."""

from typing import NamedTuple

import paper
from intervals import FEWEST, Interval, bootstrap, mean, ratio
from markdown import interval, percent, value

NOT_MEASURED = "not measured"
TEAMS = ("tour", "tour_uav", "tour_2uav", "tour_3uav", "tour_4uav")  # as they are by default, without bumpers
SEPARATION = 0.1  # [m], what a trajectory keeps between bodies


class Line(NamedTuple):
    claim: str
    measured: str
    verdict: str


def failed(word):
    return f"**{word}**"


def at_most(found, limit, yes="holds", no="does not hold", strictly=False):
    """The whole interval has to be there; without one nothing is decided."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return f"open: fewer than {FEWEST} runs in a world"
    if found.high < limit or (found.high == limit and not strictly):
        return yes
    return failed(no) if found.low > limit or (found.low == limit and strictly) else "open: the interval contains the limit"


def at_least(found, limit, yes="holds", no="does not hold"):
    if found is None:
        return NOT_MEASURED
    turned = None if found.low is None else (-found.high, -found.low)
    return at_most(Interval(-found.value, *(turned or (None, None)), found.count), -limit, yes, no)


def effect(found, claimed):
    """A relative change that the paper prints, above 0: it is reproduced if there is one beyond chance, and one as
    large cannot be excluded."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return f"open: fewer than {FEWEST} runs in a world"
    if found.high < 0:
        return failed("not reproduced: the opposite")
    if found.low <= 0:
        return failed("not reproduced: no effect shown")
    return "reproduced" if found.high >= claimed else failed("not reproduced: smaller")


def change(found, sign=1):
    """A ratio's interval as a relative change; with sign -1 what is saved."""
    if found is None:
        return None
    ends = [None if v is None else sign * (v - 1) for v in (found.low, found.high)]
    return Interval(sign * (found.value - 1), *(ends if sign > 0 or ends[0] is None else reversed(ends)), found.count)


def lost(ours, theirs):
    words = [f"{n} pairs lost to failures of the {which}" for n, which in ((ours, "first"), (theirs, "second")) if n]
    return "".join(f"; {word}" for word in words)


def compared(results, tasks, method, other, measure):
    """The ratio of two methods, what to say of it, and how many runs of the first failed."""
    pairs = [results.pairs(task, method, other) for task in tasks]
    found = ratio([p for p, _, _ in pairs], measure)
    ours, theirs = (sum(n[i] for n in pairs) for i in (1, 2))
    said = interval(found, 2, unit="×") + f", {found.count} pairs" + lost(ours, theirs) if found else ""
    if not found and ours + theirs:
        said = lost(ours, theirs).removeprefix("; ")
    return found, said, ours


def ours_below(results, claim, tasks, method, other, measure, limit, strictly=False):
    found, said, failures = compared(results, tasks, method, other, measure)
    verdict = failed(f"does not hold: {failures} runs failed") if failures else at_most(found, limit, strictly=strictly)
    return Line(claim, said, verdict)


def end_of(run):
    return run.seconds("end")


def saving(results, world, method, other, measure):
    """What the first method saves of the second's, and what to say."""
    found, said, _ = compared(results, [world], method, other, measure)
    saved = change(found, -1)
    return saved, (interval(saved, 1, 100, " %") + f", {saved.count} pairs" + said.partition("pairs")[2]) if saved else said


def paper_team_lines(results):
    low, high = paper.STEPS_SAVED
    for world in paper.WORLDS:
        saved, said = saving(results, world, "steps", "steps_uav", lambda r: r.steps(0.9))
        yield Line(f"{world}: the team takes at least 30 % (up to 54 %) fewer planning steps than the UAV alone; to 90 %",
                   said, at_least(saved, low, "reproduced", "not reproduced"))
    shorter = 1 - paper.UAV_TEAM_LENGTH / paper.UAV_ALONE_LENGTH
    saved, said = saving(results, "station", "steps", "steps_uav", lambda r: r.metres("uav"))
    yield Line(f"station: the UAV's path is {100 * shorter:.0f} % shorter in the team than alone (1,147 and 663 m)", said,
               effect(saved, shorter))


def paper_distribution_lines(results):
    for other, what in (("steps_unassigned", "against no assignment"), ("steps_uav", "against the UAV alone")):
        found, said, _ = compared(results, ["factory"], "steps", other, lambda r: r.efficiency("uav"))
        gained = change(found)
        yield Line(f"factory: distributing frontiers raises the UAV's efficiency by 24 %; share mapped per 100 m, {what}",
                   interval(gained, 1, 100, " %", True) + f", {gained.count} pairs" + said.partition("pairs")[2]
                   if gained else said, effect(gained, paper.DISTRIBUTION - 1))


def paper_optimisation_lines(results):
    for world in paper.WORLDS:
        before, after = paper.UAV_SHARE[world]
        found, said, _ = compared(results, [world], "steps", "steps_yaw_ahead", lambda r: r.share("uav"))
        gained = change(found)
        yield Line(f"{world}: optimisation raises the UAV's share of the map from {before} to {after} %",
                   interval(gained, 1, 100, " %", True) + f" of it, {gained.count} pairs" + said.partition("pairs")[2]
                   if gained else said, effect(gained, after / before - 1))
    for world in paper.WORLDS:
        before, after = paper.UAV_LENGTH[world]
        saved, said = saving(results, world, "steps", "steps_yaw_ahead", lambda r: r.metres("uav"))
        yield Line(f"{world}: optimisation shortens the UAV's path by {100 * (1 - after / before):.0f} % "
                   f"({before} and {after} m)", said, effect(saved, 1 - after / before))
    for world in paper.WORLDS:
        pairs = [(r.gain("uav", "gain_predicted"), r.gain("uav", "gain_tangent")) for r in results.done(world, "steps")]
        pairs = [(a, b) for a, b in pairs if a is not None and b]
        found = bootstrap([pairs], lambda groups: sum(a for a, _ in groups[0]) / sum(b for _, b in groups[0]))
        yield Line(f"{world}: optimised yaws see more frontiers along a path than looking ahead (no number printed)",
                   interval(found, 2, unit="×") + f", {found.count} runs" if found else "",
                   at_least(found, 1 + 1e-9, "reproduced", "not reproduced"))


def paper_coverage_lines(results):
    for world in paper.WORLDS:
        found = mean(r.coverage for r in results.of(world, "steps") if r.facts)
        yield Line(f"{world}: {percent(paper.COVERAGE[world])} are covered at the end; of the observable space",
                   interval(found, 1, 100, " %") + f", {found.count} runs" if found else "",
                   at_least(found, paper.COVERAGE[world], "reproduced", "not reproduced"))


def paper_time_lines(results):
    for world in paper.WORLDS:
        timed = results.of(world, "steps", timed=True)
        seconds = [r.measured["planning_mean_s"] for r in timed if r.facts]
        verdict = NOT_MEASURED if not seconds else \
            "reproduced" if max(seconds) < paper.LONGEST_PLANNING else failed("not reproduced")
        yield Line(f"{world}: planning takes less than 5 s a step on average", value(max(seconds), 3, " s") if seconds else
                   "", verdict)


def paper_lines(results):
    """Line by line."""
    lines = [*paper_team_lines(results), *paper_distribution_lines(results), *paper_optimisation_lines(results),
             *paper_coverage_lines(results), *paper_time_lines(results)]
    no = "not comparable"
    return lines + [
        Line("69, 74 and 137 steps until the end", "other worlds of the same names, of other sizes", no),
        Line("252 to 1,147 m of path", "as above; ratios are compared in the lines above", no),
        Line("2.6, 5.6 and 10.4 minutes of planning in all for the UAV", "the paper's computer is not named", no)]


def speed_lines(results):
    built_in, others = results.tasks(of_files=False), results.tasks(of_files=True)
    three = [t for t in paper.WORLDS if results.pairs(t, "tour", "render")[0]]
    where = ", ".join(three)
    yield ours_below(results, f"Time to the end: tours at most 0.7 of view quality's, mean of {where or 'the worlds'}",
                     built_in, "tour", "render", end_of, 0.7)
    for task in built_in or paper.WORLDS:
        yield ours_below(results, f"Time to the end: tours below view quality, {task}", [task], "tour", "render", end_of, 1, True)
        yield ours_below(results, f"Time to 95 %: tours below view quality, {task}", [task], "tour", "render",
                         lambda r: r.seconds("95"), 1, True)
        yield ours_below(results, f"Metres of all robots: tours below view quality, {task}", [task], "tour", "render",
                         lambda r: r.metres(), 1, True)
    for task in others:
        yield ours_below(results, f"Time to the end: tours below view quality, {task}", [task], "tour", "render", end_of, 1, True)
    for other in ("cluster", "nearest", "paper"):
        yield ours_below(results, f"Time to the end: tours below {results.experiments.title(other)}, mean of worlds",
                         built_in, "tour", other, end_of, 1, True)


def team_lines(results):
    built_in, others = results.tasks(of_files=False), results.tasks(of_files=True)
    yield ours_below(results, "Tours, time to the end: UAV and UGV at most 0.8 of the UAV alone, mean of worlds", built_in,
                     "tour", "tour_uav", end_of, 0.8)
    for task in [*built_in, *others]:
        yield ours_below(results, f"Tours, time to the end: UAV and UGV below the UAV alone, {task}", [task], "tour",
                         "tour_uav", end_of, 1, True)
    for method, limit in (("tour_2uav", 0.6), ("tour_4uav", 0.4)):
        yield ours_below(results, f"Time to the end: {results.experiments.title(method)} at most {limit} of one UAV, "
                         "station", ["station"], method, "tour_uav", end_of, limit)


def safety_lines(results):
    everything = [r for r in results.all.values() if r.run.method in TEAMS and not r.run.timed]
    runs = [r for r in everything if r.facts]
    touched = [r for r in runs if r.facts["contacts"]]
    yield Line("Tours without bumpers: no body touches a surface",
               f"{sum(r.facts['contacts'] for r in runs)} contacts in {len(touched)} of {len(runs)} runs" +
               ("" if touched else f"; so with 95 % confidence fewer than {percent(1 - 0.05 ** (1 / len(runs)))} of runs have any")
               if runs else "",
               NOT_MEASURED if not runs else failed(f"does not hold: {len(touched)} runs") if touched else "holds")
    apart = [r.facts["separation_min_m"] for r in runs if r.facts["separation_min_m"] is not None]
    yield Line(f"Tours: bodies stay {SEPARATION} m apart", f"least {value(min(apart), 2, ' m')} in {len(apart)} runs" if apart
               else "", NOT_MEASURED if not apart else "holds" if min(apart) >= SEPARATION - 1e-9 else failed("does not hold"))
    failures = [r for r in everything if r.failure]
    yield Line("Tours: every run ends by itself with the world mapped (99 %, hospital 90 %)",
               f"{len(failures)} failures in {len(everything)} runs" if everything else "",
               NOT_MEASURED if not everything else failed(f"does not hold: {len(failures)} runs") if failures else "holds")


def time_lines(results):
    timed = [r for r in results.all.values() if r.run.timed and r.run.method == "tour" and r.facts]
    late = [r for r in timed if r.measured["planning_p99_s"] > r.content["task"]["latency_s"]]
    yield Line("Tours: 99 % of plannings take at most what the clock charges",
               "; ".join(f"{r.run.task} {r.measured['planning_p99_s']:.3f} of {r.content['task']['latency_s']} s"
                         for r in timed), NOT_MEASURED if not timed else failed(f"does not hold: {len(late)} runs") if late
               else "holds")


def sameness_lines(results):
    def line(claim, pairs):
        unlike = [a.run.name for a, b in pairs if a.same_everywhere != b.same_everywhere]
        return Line(claim, f"{len(pairs) - len(unlike)} of {len(pairs)} pairs of runs are the same" if pairs else "",
                    NOT_MEASURED if not pairs else failed(f"does not hold: {len(unlike)} pairs") if unlike else "holds")

    plain_runs = {(r.run.task, r.run.method, r.run.seed): r for r in results.all.values() if not r.run.timed}
    grid = [(r, plain_runs[r.run.task, "tour", r.run.seed]) for r in results.all.values()
            if r.run.method == "tour_grid_caster" and (r.run.task, "tour", r.run.seed) in plain_runs]
    yield line("The fast and the grid caster give the same run", grid)
    timed = [(r, plain_runs[r.run[:3]]) for r in results.all.values() if r.run.timed and r.run[:3] in plain_runs]
    yield line("One and two threads give the same run", timed)


def our_lines(results):
    return [*speed_lines(results), *team_lines(results), *safety_lines(results), *time_lines(results),
            *sameness_lines(results)]
