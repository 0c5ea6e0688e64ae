"""What the paper claims and what this program shall hold, judged on the runs. Every verdict can go the other way."""

from collections import Counter
from typing import NamedTuple, Optional

import paper
from experiments import FIRST_SEED, Run
from intervals import FEWEST, Interval, mean, median_ratio, proportion, ratio
from markdown import as_first_word, counted, interval, percent, value

# Pairs that a verdict needs: what is declared for a main row. In worlds of files only the start differs.
NEEDED, NEEDED_OF_FILES = 20, 10
MODES = {"as printed": "steps", "default mode": "steps_render"}  # of the paper's steps, and the methods that show them
NOT_MEASURED = "not measured"
NOT_JUDGED = "not judged"
UNDECIDED = "open: the interval contains the limit"
TOO_FEW = f"open: fewer than {FEWEST} values in a world"
CLEARANCE = 0.01  # [m], less is luck: a trajectory keeps the robot's margin to what the map knows
LIMITS_KEPT = 1.001
SEPARATION = 0.32  # [m], what a trajectory keeps between bodies (kSeparation)


class Line(NamedTuple):
    claim: str
    measured: str
    verdict: str


# Verdicts.


def failed(word):
    return f"**{word}**"


def none_of(bad, runs, what="run", fewest=1):
    """Of facts that are there or not: one fails the line, and few runs without any are no reason to rely on it. `fewest`: in
    all, or {(task, method): of each}."""
    if not runs:
        return NOT_MEASURED
    if bad:
        return failed(f"does not hold: {counted(len(bad), what)}")
    if isinstance(fewest, dict):
        there = Counter(r.run[:2] for r in runs)
        few = sorted((there[row], f"{there[row]} of {n} {what}s of {' '.join(row)}") for row, n in fewest.items() if there[row] < n)
        others = f", and too few in {counted(len(few) - 1, 'other row')}" if few[1:] else ""
        return f"open: {few[0][1]}{others}" if few else "holds"
    return "holds" if len(runs) >= fewest else f"open: {len(runs)} of {counted(fewest, what)}"


def in_each(results, methods):
    """How many runs a verdict needs of each of these methods in each world for which it is declared."""
    return {(task, method): needed(results, task) for task in results.experiments.tasks for method in methods
            if (task, method) in results.experiments.rows}


def touching(count, of):
    """How frequent contacts are, by so many runs; of none, how frequent they may be all the same."""
    if count == 0:
        return f"so with 95 % confidence in fewer than {percent(1 - 0.05 ** (1 / of))}"
    return interval(proportion(count, of), 1, 100, " %")


def at_most(found, limit, yes="holds", no="does not hold", strictly=False):
    """The whole interval has to be there; without one nothing is decided."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return TOO_FEW
    if found.high < limit or (found.high == limit and not strictly):
        return yes
    return failed(no) if found.low > limit or (found.low == limit and strictly) else UNDECIDED


def changed_by(found, of):
    """A falling function of a value and its interval."""
    return found and Interval(of(found.value), *(None if v is None else of(v) for v in (found.high, found.low)), found.count)


def at_least(found, limit, yes="reproduced", no="not reproduced"):
    return at_most(changed_by(found, lambda v: -v), -limit, yes, no)


def effect(found, claimed):
    """A relative change that the paper prints, above 0: it is reproduced if the whole interval is at least half as
    large."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return TOO_FEW
    if found.high < 0:
        return failed("not reproduced: the opposite")
    if found.low <= 0:
        return "open: no effect shown, none excluded" if found.high >= claimed else \
            failed("not reproduced: no effect shown, and one as large is excluded")
    if found.low >= claimed / 2:
        return "reproduced"
    return "open: an effect, its size open" if found.high >= claimed else failed("not reproduced: smaller than claimed")


# What is measured.


class Compared(NamedTuple):
    """A ratio of two methods, of how many runs it is, and why it decides nothing, if so."""
    found: Optional[Interval]
    said: str
    open: str

    def judged(self, verdict, *arguments, **options):
        return self.open or verdict(self.found, *arguments, **options)


def needed(results, task):
    return NEEDED_OF_FILES if results.experiments.file_of(task) else NEEDED


def too_few(results, tasks, method, other):
    """Why these are not enough pairs to judge, or nothing. Failed runs count: they are there."""
    counts = {task: len(results.pairs(task, method, other)) for task in tasks}
    if not any(counts.values()):
        return NOT_MEASURED
    if empty := [task for task, n in counts.items() if not n]:
        return f"open: no pairs of {', '.join(empty)}"
    for task, n in counts.items():
        if n < needed(results, task):
            return f"open: {n} of {needed(results, task)} pairs" + (f" of {task}" if len(tasks) > 1 else "")
    return ""


def too_many_failed(results, tasks, *methods):
    """More than a tenth of a method's runs, had they not failed, could have decided otherwise."""
    for method in methods:
        runs = [r for task in tasks for r in results.of(task, method)]
        lost = sum(bool(r.failure) for r in runs)
        if 10 * lost > len(runs):
            return f"open: {lost} of {counted(len(runs), 'run')} failed ({results.experiments.title(method)})"
    return ""


def of_each(counts, what):
    return [f"{n} {what} of the {which}" for n, which in zip(counts, ("first", "second")) if n]


def to_a_level(results, tasks, method, other, measure):
    """By all runs: one that never got there, whatever ended it, is later than any other."""
    groups = [results.pairs(task, method, other) for task in tasks]
    found = median_ratio(groups, measure)
    never = [sum(measure(pair[i]) == float("inf") for pairs in groups for pair in pairs) for i in (0, 1)]
    said = [counted(sum(map(len, groups)), "pair")] if any(groups) else []
    return Compared(found, "; ".join(said + of_each(never, "never")),
                    too_few(results, tasks, method, other) or endless(results, tasks, groups, measure))


def is_endless(found):
    """A ratio in whose median pair one run never got there."""
    return found is not None and found.value in (0.0, float("inf"))


def endless(results, tasks, groups, measure):
    """Why a mean of worlds says nothing, or nothing: in one of them the other method's median run never got there, and
    would outweigh any world in which it is the faster one."""
    if len(tasks) > 1:
        for task, pairs in zip(tasks, groups):
            found = median_ratio([pairs], measure)
            if found and found.value == 0:
                return f"open: at least half of the second never got there in {task}"
    return ""


def at_the_end(results, tasks, method, other, measure):
    """By pairs of which neither failed: a failed run has no end to compare."""
    groups = [results.done_pairs(task, method, other) for task in tasks]
    found = ratio(groups, measure)
    lost = [sum(len(results.failed(task, m)) for task in tasks) for m in (method, other)]
    said = [counted(sum(map(len, groups)), "pair")] if any(groups) else []
    return Compared(found, "; ".join(said + of_each(lost, "failed")),
                    too_few(results, tasks, method, other) or too_many_failed(results, tasks, method, other))


def relative(compared, sign=1):
    """The ratio as a relative change, with sign -1 what is saved; and what to say of it."""
    found = compared.found
    if found is None:
        return compared
    change = changed_by(found, lambda v: 1 - v)
    if sign > 0:
        change = changed_by(change, lambda v: -v)
    said = "at least half never got there" if is_endless(found) else interval(change, 1, 100, " %", sign > 0)
    return compared._replace(found=change, said=f"{said}, {compared.said}")


def times(compared):
    return f"{interval(compared.found, 2, unit='×')}, {compared.said}" if compared.found else compared.said


# The paper.


def paper_team_lines(results, mode, steps):
    for world in paper.WORLDS:
        saved = relative(to_a_level(results, [world], steps, f"{steps}_uav", lambda r: r.steps_to_90), -1)
        yield Line(f"{mode}, {world}: the team takes at least 30 % fewer planning steps than the UAV alone (up to 54 %)"
                   "; to 90 %", saved.said, saved.judged(at_least, paper.STEPS_SAVED))
    shorter = 1 - paper.UAV_TEAM_LENGTH / paper.UAV_ALONE_LENGTH
    saved = relative(at_the_end(results, ["station"], steps, f"{steps}_uav", lambda r: r.metres("uav")), -1)
    yield Line(f"{mode}, station: the UAV's path is {100 * shorter:.0f} % shorter in the team than alone "
               "(1,147 and 663 m)", saved.said, saved.judged(effect, shorter))


def paper_distribution_lines(results, mode, steps):
    for other, what in (("unassigned", "no assignment"), ("uav", "the UAV alone")):
        gained = relative(at_the_end(results, ["factory"], steps, f"{steps}_{other}", lambda r: r.efficiency("uav")))
        yield Line(f"{mode}, factory: distributing frontiers raises the UAV's efficiency by 24 %; mapped per 100 m, "
                   f"against {what}", gained.said, gained.judged(effect, paper.DISTRIBUTION - 1))


def paper_optimisation_lines(results, mode, steps):
    before_it = f"{steps}_yaw_ahead"
    for world in paper.WORLDS:
        before, after = paper.UAV_SHARE[world]
        gained = relative(at_the_end(results, [world], steps, before_it, lambda r: r.share("uav")))
        yield Line(f"{mode}, {world}: optimisation raises the UAV's share of the map from {before} to {after} %, by "
                   f"{100 * (after / before - 1):.0f} % of it", gained.said, gained.judged(effect, after / before - 1))
    for world in paper.WORLDS:
        before, after = paper.UAV_LENGTH[world]
        saved = relative(at_the_end(results, [world], steps, before_it, lambda r: r.metres("uav")), -1)
        yield Line(f"{mode}, {world}: optimisation shortens the UAV's path by {100 * (1 - after / before):.0f} % "
                   f"({before} and {after} m)", saved.said, saved.judged(effect, 1 - after / before))
    for world in paper.WORLDS:
        gained = relative(at_the_end(results, [world], steps, before_it, lambda r: r["gained"]))
        yield Line(f"{mode}, {world}: optimisation improves the UAV's information gain by {percent(paper.UAV_GAIN[world])};"
                   " of what, the paper does not say: here of the frontiers that the scans along a path mapped",
                   gained.said, gained.judged(effect, paper.UAV_GAIN[world]))


def paper_coverage_lines(results, mode, steps):
    for world in paper.WORLDS:
        runs = results.of(world, steps)
        found = mean(r.coverage for r in runs if not r.crashed)
        crashed = sum(r.crashed for r in runs)
        yield Line(f"{mode}, {world}: {percent(paper.COVERAGE[world])} are covered at the end; of the observable space",
                   f"{interval(found, 1, 100, ' %')}, {counted(found.count, 'run')}" if found else "",
                   f"open: {crashed} of {counted(len(runs), 'run')} crashed" if crashed else
                   f"open: {len(runs)} of {needed(results, world)} runs" if 0 < len(runs) < needed(results, world) else
                   at_least(found, paper.COVERAGE[world]))


def paper_time_lines(results, mode, steps):
    for world in paper.WORLDS:
        seconds = [r["planning_mean_s"] for r in results.of(world, steps, timed=True) if r["planning_mean_s"] is not None]
        late = [s for s in seconds if s >= paper.LONGEST_PLANNING]
        yield Line(f"{mode}, {world}: planning takes less than 5 s a step on average",
                   f"{value(max(seconds), 3, ' s')} at most, {counted(len(seconds), 'run')}" if seconds else "",
                   NOT_MEASURED if not seconds else failed("not reproduced") if late else "reproduced")


def paper_lines(results):
    """Line by line: by the method as printed, and by what replaces it by default."""
    no = "not comparable"
    return [*(line for of in (paper_team_lines, paper_distribution_lines, paper_optimisation_lines, paper_coverage_lines,
                              paper_time_lines)
              for mode, steps in MODES.items()
              for line in of(results, mode, steps)),
            Line("69, 74 and 137 steps until the end", "other worlds of the same names, of other sizes", no),
            Line("252 to 1,147 m of path", "as above; ratios are compared in the lines above", no),
            Line("2.6, 5.6 and 10.4 minutes of planning in all for the UAV", "the paper's computer is not named", no)]


# Ours.


def seconds_mapped(run):
    return run.seconds_mapped


def end_of(run):
    return run.seconds("end")


def below(results, claim, tasks, method, other, measure, limit=None):
    """A measure to a level by that of another method; without a limit, less."""
    found = to_a_level(results, tasks, method, other, measure)
    return Line(claim, times(found), found.judged(at_most, 1 if limit is None else limit, strictly=limit is None))


def where(results, tasks):
    return "mean of worlds" if len(tasks) > 1 else results.experiments.task_title(tasks[0])


def less_than(results, what, tasks, method, other, measure, limit=None):
    """below(), by the methods' titles."""
    first, second = map(results.experiments.title, (method, other))
    relation = f"at most {limit} of" if limit else "below"
    return below(results, f"{what}: {first} {relation} {second}, {where(results, tasks)}", tasks, method, other, measure, limit)


def faster(results, tasks, method, other, limit=None):
    """The time until the world counts as mapped; and beside it that to the end, which each method chooses by its own rule."""
    yield less_than(results, f"Time to {results.experiments.level(tasks[0])} %", tasks, method, other, seconds_mapped, limit)
    found = at_the_end(results, tasks, method, other, end_of)
    first, second = map(results.experiments.title, (method, other))
    yield Line(f"Time to the end, each by its own rule: {first} against {second}, {where(results, tasks)}", times(found),
               NOT_JUDGED if found.found else found.open)


def speed_lines(results):
    tasks = results.experiments.declared_tasks("tour", "render")
    built_in = [t for t in tasks if not results.experiments.file_of(t)]
    yield from faster(results, built_in, "tour", "render", 0.7)
    for task in built_in:
        yield less_than(results, "Time to 95 %", [task], "tour", "render", lambda r: r.until("95"))
        yield from faster(results, [task], "tour", "render")
        yield less_than(results, "Metres of all robots to 99 %", [task], "tour", "render", lambda r: r.metres_mapped)
    for task in (t for t in tasks if t not in built_in):
        yield from faster(results, [task], "tour", "render")
    for other in ("cluster", "nearest", "paper"):
        yield from faster(results, built_in, "tour", other)


def motion_lines(results):
    """What the clock gains over Alg. 1's steps, by the same method."""
    limits = {"maze": (0.8, 0.8), "factory": (0.8, 0.8), "station": (0.65, 0.7)}
    for task, limits_of_levels in limits.items():
        for level, limit in zip(("90", "99"), limits_of_levels):
            yield below(results, f"View quality, time to {level} %: in motion at most {limit} of lock-step, {task}", [task],
                        "render", "steps_render", lambda r, k=level: r.until(k), limit)


def team_lines(results):
    tasks = results.experiments.declared_tasks("tour", "tour_uav")
    yield from faster(results, [t for t in tasks if not results.experiments.file_of(t)], "tour", "tour_uav", 0.8)
    for task in tasks:
        yield from faster(results, [task], "tour", "tour_uav")
    for method, limit in (("tour_2uav", 0.6), ("tour_4uav", 0.4)):
        yield from faster(results, ["station"], method, "tour_uav", limit)


def teams(results):
    """Tours as they are by default, without bumpers."""
    methods = results.experiments.methods
    return [m for m in results.experiments.methods_of("main") if methods[m]["task"]["method"] == "tour"]


def contacts_line(results, who, methods, fewest=None):
    runs = [r for r in results.all.values() if r.run.method in methods and not r.run.timed and not r.crashed]
    touched = [r for r in runs if r["contacts"]]
    said = (f"{counted(sum(r['contacts'] for r in runs), 'contact')}, in {len(touched)} of {len(runs)} runs; "
            f"{touching(len(touched), len(runs))}") if runs else ""
    return Line(f"{who} without bumpers: no body touches a surface", said,
                none_of(touched, runs, fewest=fewest or in_each(results, methods)))


def clear_line(who, runs, fewest):
    near = [r for r in runs if r["clearance_min_m"] is not None and r["clearance_min_m"] < CLEARANCE]
    return Line(f"{who}: bodies keep {CLEARANCE} m from surfaces",
                f"less in {len(near)} of {counted(len(runs), 'run')}" if runs else "", none_of(near, runs, fewest=fewest))


def apart_line(who, runs, fewest):
    several = [r for r in runs if r["separation_min_m"] is not None]
    near = [r for r in several if r["separation_min_m"] < SEPARATION - 1e-9]
    least = min((r["separation_min_m"] for r in several), default=None)
    return Line(f"{who}: bodies stay {SEPARATION} m apart",
                f"least {value(least, 3, ' m')} in {len(several)} runs" if several else "", none_of(near, several, fewest=fewest))


def mapped_line(who, runs, fewest):
    failures = [r for r in runs if r.failure or r["failed_before"]]
    return Line(f"{who}: every run ends by itself with the world mapped (99 %, hospital 90 %)",
                f"{counted(len(failures), 'failure')} in {counted(len(runs), 'run')}" if runs else "",
                none_of(failures, runs, fewest=fewest))


def safety_lines(results):
    of_tours = teams(results)
    yield contacts_line(results, "Tours", of_tours)
    yield contacts_line(results, "View quality", ("render",))

    everything = [r for r in results.all.values() if r.run.method in of_tours and not r.run.timed]
    runs = [r for r in everything if not r.crashed]
    fewest = in_each(results, of_tours)
    yield clear_line("Tours", runs, fewest)
    yield apart_line("Tours", runs, {row: n for row, n in fewest.items()
                                     if len(results.experiments.task_file(Run(*row, FIRST_SEED))["robots"]) > 1})

    moving = [r for r in runs if r["worst_of_limits"] is not None]
    over = [r for r in moving if r["worst_of_limits"] > LIMITS_KEPT]
    yield Line("Tours: speed, acceleration and yaw rate, sampled at 100 Hz, exceed no limit by more than 0.1 %",
               f"at most {max(r['worst_of_limits'] for r in moving):.6f} of a limit in {counted(len(moving), 'run')}"
               if moving else "", none_of(over, moving, fewest=fewest))

    yield mapped_line("Tours", everything, fewest)


def declared(results, which):
    """How many of such runs there are to be."""
    return sum(map(which, results.wanted))


def time_lines(results):
    timed = [r for r in results.all.values() if r.run.timed and r.run.method == "tour"
             and r["planning_p99_s"] is not None]
    charged = {r.run: results.experiments.task_file(r.run)["latency_s"] for r in timed}
    late = [r for r in timed if r["planning_p99_s"] > charged[r.run]]
    yield Line("Tours: 99 % of plannings take at most what the clock charges",
               "; ".join(f"{r.run.task} {r['planning_p99_s']:.3f} of {charged[r.run]} s" for r in timed),
               none_of(late, timed, fewest=declared(results, lambda run: run.timed and run.method == "tour")))


def sameness_lines(results):
    plain_runs = {(r.run.task, r.run.method, r.run.seed): r for r in results.all.values() if not r.run.timed}
    methods = results.experiments.methods
    casters = results.experiments.methods_of("caster")
    for claim, others, is_other in (
            ("The fast and the grid caster give the same run",
             {(r.run.task, methods[r.run.method]["against"], r.run.seed): r for r in results.all.values()
              if r.run.method in casters}, lambda run: run.method in casters),
            ("One and two threads give the same run", {r.run[:3]: r for r in results.all.values() if r.run.timed},
             lambda run: run.timed)):
        pairs = [(plain_runs[key], other) for key, other in others.items()
                 if key in plain_runs and not plain_runs[key].crashed and not other.crashed]
        unlike = [a for a, b in pairs if a["outcome"] != b["outcome"]]
        yield Line(claim, f"{len(pairs) - len(unlike)} of {len(pairs)} pairs of runs are the same" if pairs else "",
                   none_of(unlike, pairs, "pair", declared(results, is_other)))


def noticed(verdict):
    """Of a line about runs that are spoilt on purpose: it must not hold, and what is open says nothing."""
    if verdict == "holds":
        return failed("missed: it holds all the same")
    return f"noticed: {verdict.strip('*')}" if verdict.startswith("**") else verdict


def control_lines(results):
    """Lines of tours, judged of runs that are spoilt on purpose, as few as are declared: one that holds all the same would
    not have noticed."""
    title = results.experiments.title

    def runs(method):
        return [r for task in results.tasks() for r in results.of(task, method)]

    swaying = [r for r in runs("tour_swaying") if not r.crashed]
    lines = []
    for method, other in (("tour_hasty", "render"), ("tour_alone", "tour_uav")):
        for task in results.experiments.declared_tasks(method):
            found = to_a_level(results, [task], method, other, seconds_mapped)
            lines.append(Line(f"Time to 99 %: {title(method)}, below {title(other)}, {task}", times(found),
                              at_most(found.found, 1, strictly=True)))
    lines += [mapped_line(as_first_word(title("tour_hasty")), runs("tour_hasty"), 1),
              contacts_line(results, as_first_word(title("tour_swaying")), ("tour_swaying",), 1),
              clear_line(as_first_word(title("tour_swaying")), swaying, 1),
              apart_line(as_first_word(title("tour_swaying")), swaying, 1)]
    return [line._replace(verdict=noticed(line.verdict)) for line in lines]


def our_lines(results):
    return [*speed_lines(results), *motion_lines(results), *team_lines(results), *safety_lines(results), *time_lines(results),
            *sameness_lines(results)]
