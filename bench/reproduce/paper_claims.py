"""What the paper claims, judged on the runs."""

import paper
from comparisons import in_all, needed, relative, to_a_level
from intervals import mean
from markdown import counted, interval, percent, value
from verdicts import NOT_COMPARABLE, NOT_MEASURED, Line, at_least, effect, failed, none_of

MODES = {"as printed": "steps", "default mode": "steps_render"}  # of the paper's steps, and the methods that show them


def paper_team_lines(results, mode, steps):
    for world in paper.WORLDS:
        saved = relative(to_a_level(results, [world], steps, f"{steps}_uav", lambda r: r.steps_to_90), -1)
        yield Line(f"{mode}, {world}: the team takes at least 30 % fewer planning steps than the UAV alone (up to 54 %)"
                   "; to 90 %", saved.said, saved.judged(at_least, paper.STEPS_SAVED))
    shorter = 1 - paper.UAV_TEAM_LENGTH / paper.UAV_ALONE_LENGTH
    saved = relative(to_a_level(results, ["station"], steps, f"{steps}_uav", lambda r: r.uavs_metres_mapped), -1)
    yield Line(f"{mode}, station: the UAV's path is {100 * shorter:.0f} % shorter in the team than alone "
               "(1,147 and 663 m); to 90 %", saved.said, saved.judged(effect, shorter))


def paper_distribution_lines(results, mode, steps):
    for other, what in (("unassigned", "no assignment"), ("uav", "the UAV alone")):
        gained = relative(in_all(results, "factory", steps, f"{steps}_{other}", lambda r: r.efficiency("uav")))
        yield Line(f"{mode}, factory: distributing frontiers raises the UAV's efficiency by 24 %; mapped per 100 m at the end, "
                   f"against {what}", gained.said, gained.judged(effect, paper.DISTRIBUTION - 1))


def paper_optimisation_lines(results, mode, steps):
    before_it = f"{steps}_yaw_ahead"
    for world in paper.WORLDS:
        before, after = paper.UAV_SHARE[world]
        gained = relative(in_all(results, world, steps, before_it, lambda r: r.share("uav")))
        yield Line(f"{mode}, {world}: optimisation raises the UAV's share of the map from {before} to {after} %, by "
                   f"{100 * (after / before - 1):.0f} % of it", gained.said, gained.judged(effect, after / before - 1))
    for world in paper.WORLDS:
        before, after = paper.UAV_LENGTH[world]
        saved = relative(to_a_level(results, [world], steps, before_it, lambda r: r.uavs_metres_mapped), -1)
        yield Line(f"{mode}, {world}: optimisation shortens the UAV's path by {100 * (1 - after / before):.0f} % "
                   f"({before} and {after} m); to 90 %", saved.said, saved.judged(effect, 1 - after / before))
    for world in paper.WORLDS:
        gained = relative(in_all(results, world, steps, before_it, lambda r: r["gained"]))
        yield Line(f"{mode}, {world}: optimisation improves the UAV's information gain by {percent(paper.UAV_GAIN[world])};"
                   " of what, the paper does not say: here of the frontiers that the scans along a path mapped",
                   gained.said, gained.judged(effect, paper.UAV_GAIN[world]))


def paper_coverage_lines(results, mode, steps):
    for world in paper.WORLDS:
        runs = results.of(world, steps)
        found = mean(r.coverage for r in runs if not r.crashed)
        yield Line(f"{mode}, {world}: {percent(paper.COVERAGE[world])} are covered at the end; of what, the paper does not say: here of "
                   "the observable space", f"{interval(found, 1, 100, ' %')}, {counted(found.count, 'run')}" if found else "",
                   NOT_COMPARABLE if found else NOT_MEASURED)
    for world in paper.WORLDS:
        runs = results.of(world, steps)
        few = [r for r in runs if r.failure]
        yield Line(f"{mode}, {world}: every run ends by itself with 90 % of the observable space mapped",
                   f"{counted(len(few), 'failure')} in {counted(len(runs), 'run')}" if runs else "",
                   none_of(few, runs, fewest=needed(results, world)))


def paper_time_lines(results, mode, steps):
    for world in paper.WORLDS:
        seconds = [r["planning_mean_s"] for r in results.of(world, steps, timed=True) if r["planning_mean_s"] is not None]
        late = [s for s in seconds if s >= paper.LONGEST_PLANNING]
        yield Line(f"{mode}, {world}: planning takes less than 5 s a step on average, in one run, by a computer of today",
                   f"{value(max(seconds), 3, ' s')}" if seconds else "",
                   NOT_MEASURED if not seconds else failed("not reproduced") if late else "reproduced")


def paper_lines(results):
    """Line by line: by the method as printed, and by what replaces it by default."""
    return [*(line for of in (paper_team_lines, paper_distribution_lines, paper_optimisation_lines, paper_coverage_lines,
                              paper_time_lines)
              for mode, steps in MODES.items()
              for line in of(results, mode, steps)),
            Line("69, 74 and 137 steps until the end", "other worlds of the same names, of other sizes", NOT_COMPARABLE),
            Line("252 to 1,147 m of path", "as above; ratios are compared in the lines above", NOT_COMPARABLE),
            Line("2.6, 5.6 and 10.4 minutes of planning in all for the UAV, 0.14, 4.0 and 18.6 s for the UGV",
                 "the paper's computer is not named", NOT_COMPARABLE),
            Line("the team reduces planning time by taking fewer steps", "steps are compared in the lines above; times by step are in the table of planning times",
                 NOT_COMPARABLE),
            Line("a UGV alone maps less than the team, by figures without numbers", "its runs are in the table of steps below",
                 NOT_COMPARABLE),
            Line("complete coverage is impossible, because of what is hidden and of the bodies",
                 "so it is here; what is hidden from everywhere is no part of the observable space", NOT_COMPARABLE)]
