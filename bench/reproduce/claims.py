"""What the paper claims and what this program shall hold, judged on the runs. Every line can fail."""

from typing import NamedTuple

import paper
from intervals import FEWEST, Interval, bootstrap, mean, ratio
from markdown import counted, interval, percent, value

NOT_MEASURED = "not measured"
UNDECIDED = "open: the interval contains the limit"
TOO_FEW = f"open: fewer than {FEWEST} runs in a world"
TEAMS = ("tour", "tour_uav", "tour_2uav", "tour_3uav", "tour_4uav")  # as they are by default, without bumpers
CLEARANCE = 0.01  # [m], less is luck: a trajectory keeps the robot's margin, which is 0 here
LIMITS_KEPT = 1.001
SEPARATION = 0.32  # [m], what a trajectory keeps between bodies (kSeparation)


class Line(NamedTuple):
    claim: str
    measured: str
    verdict: str


# Verdicts.


def failed(word):
    return f"**{word}**"


def none_of(bad, runs, what="run"):
    """Of facts that are there or not."""
    if not runs:
        return NOT_MEASURED
    return failed(f"does not hold: {counted(len(bad), what)}") if bad else "holds"


def at_most(found, limit, yes="holds", no="does not hold", strictly=False):
    """The whole interval has to be there; without one nothing is decided."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return TOO_FEW
    if found.high < limit or (found.high == limit and not strictly):
        return yes
    return failed(no) if found.low > limit or (found.low == limit and strictly) else UNDECIDED


def negative(found):
    return found and Interval(-found.value, *(None if v is None else -v for v in (found.high, found.low)), found.count)


def at_least(found, limit, yes="reproduced", no="not reproduced"):
    return at_most(negative(found), -limit, yes, no)


def effect(found, claimed):
    """A relative change that the paper prints, above 0: it is reproduced if there is one beyond chance, and one as
    large cannot be excluded."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return TOO_FEW
    if found.high < 0:
        return failed("not reproduced: the opposite")
    if found.low <= 0:
        return failed("not reproduced: no effect shown")
    return "reproduced" if found.high >= claimed else failed("not reproduced: smaller")


# What is measured.


def end_of(run):
    return run.seconds("end")


def compared(results, tasks, method, other, measure):
    """The ratio of two methods, how many pairs it is of, and how many runs of the first failed."""
    pairs = [results.pairs(task, method, other) for task in tasks]
    found = ratio([p for p, _, _ in pairs], measure)
    ours, theirs = (sum(n[i] for n in pairs) for i in (1, 2))
    where = ", ".join(task for task, (p, _, _) in zip(tasks, pairs) if p)
    said = [counted(found.count, "pair") + (f" of {where}" if len(tasks) > 1 else "")] if found else []
    said += [f"{counted(n, 'failure')} of the {which}" for n, which in ((ours, "first"), (theirs, "second")) if n]
    return found, "; ".join(said), ours


def changed(results, world, method, other, measure, sign=1):
    """The ratio as a relative change, with sign -1 what is saved; what to say of it; and how many pairs were lost."""
    found, said, _ = compared(results, [world], method, other, measure)
    seeds = [{r.run.seed for r in results.of(world, m)} for m in (method, other)]
    lost = len(seeds[0] & seeds[1]) - len(results.pairs(world, method, other)[0])
    if found is None:
        return None, said, lost
    change = Interval(found.value - 1, *(None if v is None else v - 1 for v in found[1:3]), found.count)
    change = change if sign > 0 else negative(change)
    return change, f"{interval(change, 1, 100, ' %', sign > 0)}, {said}", lost


def unless_lost(verdict, change, lost):
    """More than a tenth of the pairs, had they not failed, could have decided otherwise."""
    every = lost + (change.count if change else 0)
    return f"open: failures took {counted(lost, 'pair')}" if 10 * lost > every else verdict


def ours_below(results, claim, tasks, method, other, measure, limit=None):
    """Without a limit, below the other. A failed run of the first fails the line: a lost pair would help it."""
    found, said, failures = compared(results, tasks, method, other, measure)
    verdict = failed(f"does not hold: {counted(failures, 'run')} failed") if failures else \
        at_most(found, 1 if limit is None else limit, strictly=limit is None)
    return Line(claim, f"{interval(found, 2, unit='×')}, {said}" if found else said, verdict)


# The paper.


def paper_team_lines(results, mode, steps):
    for world in paper.WORLDS:
        saved, said, lost = changed(results, world, steps, f"{steps}_uav", lambda r: r.steps(0.9), -1)
        yield Line(f"{mode}, {world}: the team takes at least 30 % fewer planning steps than the UAV alone (up to 54 %)"
                   "; to 90 %", said, unless_lost(at_least(saved, paper.STEPS_SAVED), saved, lost))
    shorter = 1 - paper.UAV_TEAM_LENGTH / paper.UAV_ALONE_LENGTH
    saved, said, lost = changed(results, "station", steps, f"{steps}_uav", lambda r: r.metres("uav"), -1)
    yield Line(f"{mode}, station: the UAV's path is {100 * shorter:.0f} % shorter in the team than alone "
               "(1,147 and 663 m)",
               said, unless_lost(effect(saved, shorter), saved, lost))


def paper_distribution_lines(results, mode, steps):
    for other, what in (("unassigned", "no assignment"), ("uav", "the UAV alone")):
        gained, said, lost = changed(results, "factory", steps, f"{steps}_{other}", lambda r: r.efficiency("uav"))
        yield Line(f"{mode}, factory: distributing frontiers raises the UAV's efficiency by 24 %; mapped per 100 m, "
                   f"against {what}", said, unless_lost(effect(gained, paper.DISTRIBUTION - 1), gained, lost))


def paper_optimisation_lines(results, mode, steps):
    for world in paper.WORLDS:
        before, after = paper.UAV_SHARE[world]
        gained, said, lost = changed(results, world, steps, f"{steps}_yaw_ahead", lambda r: r.share("uav"))
        yield Line(f"{mode}, {world}: optimisation raises the UAV's share of the map from {before} to {after} %, by "
                   f"{100 * (after / before - 1):.0f} % of it", said,
                   unless_lost(effect(gained, after / before - 1), gained, lost))
    for world in paper.WORLDS:
        before, after = paper.UAV_LENGTH[world]
        saved, said, lost = changed(results, world, steps, f"{steps}_yaw_ahead", lambda r: r.metres("uav"), -1)
        yield Line(f"{mode}, {world}: optimisation shortens the UAV's path by {100 * (1 - after / before):.0f} % "
                   f"({before} and {after} m)", said,
                   unless_lost(effect(saved, 1 - after / before), saved, lost))
    for world in paper.WORLDS:
        seen = [(r.gain("uav", "gain_predicted"), r.gain("uav", "gain_tangent")) for r in results.done(world, steps)]
        seen = [(a, b) for a, b in seen if a is not None and b]
        found = bootstrap([seen], lambda groups: sum(a for a, _ in groups[0]) / sum(b for _, b in groups[0]))
        yield Line(f"{mode}, {world}: with optimised yaws a path sees more frontiers than looking ahead (no number is "
                   "printed)", f"{interval(found, 2, unit='×')}, {counted(found.count, 'run')}" if found else "",
                   at_least(found, 1 + 1e-9))


def paper_coverage_lines(results, mode, steps):
    for world in paper.WORLDS:
        found = mean(r.coverage for r in results.of(world, steps) if r.facts)
        yield Line(f"{mode}, {world}: {percent(paper.COVERAGE[world])} are covered at the end; of the observable space",
                   f"{interval(found, 1, 100, ' %')}, {counted(found.count, 'run')}" if found else "",
                   at_least(found, paper.COVERAGE[world]))


def paper_time_lines(results, mode, steps):
    for world in paper.WORLDS:
        seconds = [r.measured["planning_mean_s"] for r in results.of(world, steps, timed=True) if r.facts]
        late = [s for s in seconds if s >= paper.LONGEST_PLANNING]
        yield Line(f"{mode}, {world}: planning takes less than 5 s a step on average",
                   value(max(seconds), 3, " s") if seconds else "",
                   NOT_MEASURED if not seconds else failed("not reproduced") if late else "reproduced")


def paper_lines(results):
    """Line by line: by the method as printed, and by what replaces it by default."""
    no = "not comparable"
    return [*(line for of in (paper_team_lines, paper_distribution_lines, paper_optimisation_lines, paper_coverage_lines,
                              paper_time_lines)
              for mode, steps in (("as printed", "steps"), ("default mode", "steps_render"))
              for line in of(results, mode, steps)),
            Line("69, 74 and 137 steps until the end", "other worlds of the same names, of other sizes", no),
            Line("252 to 1,147 m of path", "as above; ratios are compared in the lines above", no),
            Line("2.6, 5.6 and 10.4 minutes of planning in all for the UAV", "the paper's computer is not named", no)]


# Ours.


def speed_lines(results):
    built_in, others = results.tasks(of_files=False), results.tasks(of_files=True)
    yield ours_below(results, "Time to the end: tours at most 0.7 of view quality, mean of worlds", built_in, "tour",
                     "render", end_of, 0.7)
    for task in built_in or paper.WORLDS:
        for what, measure in (("Time to 95 %", lambda r: r.seconds("95")), ("Time to 99 %", lambda r: r.seconds("99")),
                              ("Time to the end", end_of), ("Metres of all robots", lambda r: r.metres())):
            yield ours_below(results, f"{what}: tours below view quality, {task}", [task], "tour", "render", measure)
    for task in others:
        yield ours_below(results, f"Time to the end: tours below view quality, {task}", [task], "tour", "render", end_of)
    for other in ("cluster", "nearest", "paper"):
        yield ours_below(results, f"Time to the end: tours below {results.experiments.title(other)}, mean of worlds",
                         built_in, "tour", other, end_of)


def motion_lines(results):
    """What the clock gains over Alg. 1's steps, by the same method."""
    limits = {"maze": (("end", 0.8),), "factory": (("end", 0.8),), "station": (("90", 0.65), ("end", 0.7))}
    for task, pairs in limits.items():
        for level, limit in pairs:
            what = "the end" if level == "end" else f"{level} %"
            yield ours_below(results, f"View quality, time to {what}: in motion at most {limit} of lock-step, {task}", [task],
                             "render", "steps_render", lambda r, k=level: r.seconds(k), limit)


def team_lines(results):
    built_in, others = results.tasks(of_files=False), results.tasks(of_files=True)
    yield ours_below(results, "Tours, time to the end: UAV and UGV at most 0.8 of the UAV alone, mean of worlds",
                     built_in, "tour", "tour_uav", end_of, 0.8)
    for task in [*(built_in or paper.WORLDS), *others]:
        yield ours_below(results, f"Tours, time to the end: UAV and UGV below the UAV alone, {task}", [task], "tour",
                         "tour_uav", end_of)
    for method, limit in (("tour_2uav", 0.6), ("tour_4uav", 0.4)):
        yield ours_below(results, f"Time to the end: {results.experiments.title(method)} at most {limit} of one UAV, "
                         "station", ["station"], method, "tour_uav", end_of, limit)


def contacts_line(results, who, methods):
    runs = [r for r in results.all.values() if r.run.method in methods and not r.run.timed and r.facts]
    touched = [r for r in runs if r.facts["contacts"]]
    said = f"{sum(r.facts['contacts'] for r in runs)} contacts, in {len(touched)} of {len(runs)} runs"
    if runs and not touched:
        said += f"; so with 95 % confidence fewer than {percent(1 - 0.05 ** (1 / len(runs)))} of runs have any"
    return Line(f"{who} without bumpers: no body touches a surface", said if runs else "", none_of(touched, runs))


def safety_lines(results):
    yield contacts_line(results, "Tours", TEAMS)
    yield contacts_line(results, "View quality", ("render",))

    everything = [r for r in results.all.values() if r.run.method in TEAMS and not r.run.timed]
    runs = [r for r in everything if r.facts]
    near = [r for r in runs if r.facts["clearance_min_m"] is not None and r.facts["clearance_min_m"] < CLEARANCE]
    yield Line(f"Tours: bodies keep {CLEARANCE} m from surfaces", f"less in {len(near)} of {counted(len(runs), 'run')}"
               if runs else "", none_of(near, runs))
    several = [r for r in runs if r.facts["separation_min_m"] is not None]
    near = [r for r in several if r.facts["separation_min_m"] < SEPARATION - 1e-9]
    least = min((r.facts["separation_min_m"] for r in several), default=None)
    yield Line(f"Tours: bodies stay {SEPARATION} m apart",
               f"least {value(least, 3, ' m')} in {len(several)} runs" if several else "", none_of(near, several))

    moving = [r for r in runs if r.facts.get("worst_of_limits") is not None]
    over = [r for r in moving if r.facts["worst_of_limits"] > LIMITS_KEPT]
    yield Line("Tours: speed, acceleration and yaw rate, sampled at 100 Hz, exceed no limit by more than 0.1 %",
               f"at most {max(r.facts['worst_of_limits'] for r in moving):.6f} of a limit in {counted(len(moving), 'run')}"
               if moving else "", none_of(over, moving))

    failures = [r for r in everything if r.failure]
    yield Line("Tours: every run ends by itself with the world mapped (99 %, hospital 90 %)",
               f"{counted(len(failures), 'failure')} in {counted(len(everything), 'run')}" if everything else "",
               none_of(failures, everything))


def time_lines(results):
    timed = [r for r in results.all.values() if r.run.timed and r.run.method == "tour" and r.facts]
    late = [r for r in timed if r.measured["planning_p99_s"] > r.content["task"]["latency_s"]]
    yield Line("Tours: 99 % of plannings take at most what the clock charges",
               "; ".join(f"{r.run.task} {r.measured['planning_p99_s']:.3f} of {r.content['task']['latency_s']} s"
                         for r in timed), none_of(late, timed))


def sameness_lines(results):
    plain_runs = {(r.run.task, r.run.method, r.run.seed): r for r in results.all.values() if not r.run.timed}
    for claim, others in (
            ("The fast and the grid caster give the same run",
             {(r.run.task, "tour", r.run.seed): r for r in results.all.values() if r.run.method == "tour_grid_caster"}),
            ("One and two threads give the same run", {r.run[:3]: r for r in results.all.values() if r.run.timed})):
        pairs = [(plain_runs[key], other) for key, other in others.items() if key in plain_runs]
        unlike = [a for a, b in pairs if a.same_everywhere != b.same_everywhere]
        yield Line(claim, f"{len(pairs) - len(unlike)} of {len(pairs)} pairs of runs are the same" if pairs else "",
                   none_of(unlike, pairs, "pair"))


def our_lines(results):
    return [*speed_lines(results), *motion_lines(results), *team_lines(results), *safety_lines(results), *time_lines(results),
            *sameness_lines(results)]
