"""What this program shall hold, judged on the runs. Every verdict can go the other way."""

from comparisons import end_of, ended_early, in_each, needed, seconds_mapped, times, to_a_level, to_the_end, too_many_failed
from experiments import FIRST_SEED, Run
from intervals import mean
from markdown import as_first_word, counted, interval, percent, value
from rows import PLANNING_HALVES
from verdicts import NOT_MEASURED, Line, at_most, failed, none_of, touching

CLEARANCE = 0.01  # [m], less is luck: a trajectory keeps the robot's margin to what the map knows
LIMITS_KEPT = 1.001
REVISITED = 0.15  # of a UAV's path
PLANNING, OFFICE_PLANNING, GROWTH = 0.1, 0.15, 1.3  # [s] 99th percentiles, and the second half's by the first's
SEPARATION = 0.32  # [m], what a trajectory keeps between bodies (kSeparation)


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


def sooner_done(results, tasks, method, other, limit=None):
    """By the time to the end."""
    first, second = map(results.experiments.title, (method, other))
    relation = f"at most {limit} of" if limit else "below"
    found = to_the_end(results, tasks, method, other)
    return Line(f"Time to the end, each by its own rule: {first} {relation} {second}, {where(results, tasks)}",
                times(found) if found.found else "", found.judged(at_most, limit or 1, strictly=limit is None))


def faster(results, tasks, method, other, limit=None):
    """By the time until the world counts as mapped."""
    line = less_than(results, f"Time to {results.experiments.level(tasks[0])} %", tasks, method, other, seconds_mapped, limit)
    return line._replace(verdict=ended_early(results, tasks, other) or "holds") if line.verdict == "holds" else line


def speed_lines(results):
    tasks = results.experiments.declared_tasks("tour", "render")
    built_in = [t for t in tasks if not results.experiments.file_of(t)]
    yield faster(results, built_in, "tour", "render", 0.7)
    yield less_than(results, "Time to 95 %", built_in, "tour", "render", lambda r: r.until("95"), 0.7)
    yield sooner_done(results, built_in, "tour", "render", 0.7)
    for task in built_in:
        yield less_than(results, "Time to 95 %", [task], "tour", "render", lambda r: r.until("95"))
        yield faster(results, [task], "tour", "render")
        yield sooner_done(results, [task], "tour", "render")
        yield less_than(results, "Metres of all robots to 99 %", [task], "tour", "render", lambda r: r.metres_mapped)
    for task in (t for t in tasks if t not in built_in):
        yield faster(results, [task], "tour", "render")
    for other in ("cluster", "nearest", "paper"):
        yield faster(results, built_in, "tour", other)


def motion_lines(results):
    """What the clock gains over Alg. 1's steps, by the same method."""
    limits = {"maze": (0.8, 0.8), "factory": (0.8, 0.8), "station": (0.65, 0.7)}
    for task, limits_of_levels in limits.items():
        for level, limit in zip(("90", "99"), limits_of_levels):
            yield below(results, f"View quality, time to {level} %: in motion at most {limit} of lock-step, {task}", [task],
                        "render", "steps_render", lambda r, k=level: r.until(k), limit)


def team_lines(results):
    tasks = results.experiments.declared_tasks("tour", "tour_uav")
    for line in (faster, sooner_done):
        yield line(results, [t for t in tasks if not results.experiments.file_of(t)], "tour", "tour_uav", 0.8)
        for task in tasks:
            yield line(results, [task], "tour", "tour_uav")
    for method, limit in (("tour_2uav", 0.6), ("tour_4uav", 0.4)):
        yield faster(results, ["station"], method, "tour_uav", limit)


def judged_mean(results, task, method, measure, limit, claim, digits=0, scale=1, unit=" s"):
    """Of the runs that did not fail."""
    done = results.done(task, method)
    found = mean(map(measure, done))
    title = results.experiments.task_title(task)
    return Line(f"{as_first_word(results.experiments.title(method))}, {title}: {claim}",
                f"{interval(found, digits, scale, unit)}, {counted(len(done), 'run')}" if found else "",
                NOT_MEASURED if found is None else f"open: {len(done)} of {needed(results, task)} runs"
                if len(done) < needed(results, task) else too_many_failed(results, [task], method) or at_most(found, limit))


def goal_lines(results):
    """What was aimed at in numbers."""
    for limit, claim in ((165, "the end after at most 165 s"), (138, "the end after at most 138 s, as FALCON's in its video")):
        yield judged_mean(results, "complex_office", "tour", end_of, limit, claim)
    for method in ("tour", "tour_uav"):
        for task in results.experiments.declared_tasks(method):
            if method == "tour" or not results.experiments.file_of(task):
                yield judged_mean(results, task, method, lambda r: r["revisited_uav"], REVISITED,
                                  f"at most {percent(REVISITED, 0)} of a UAV's path leads to where it has been", 1, 100, " %")


def teams(results):
    """Tours as they are by default, without bumpers."""
    methods = results.experiments.methods
    return [m for m in results.experiments.methods_of("main") if methods[m]["task"]["method"] == "tour"]


def runs_in_motion(results, methods, tasks):
    """All that are not timed."""
    return [r for task in tasks for method in methods for r in results.of(task, method)]


def contacts_line(who, runs, fewest):
    touched = [r for r in runs if r["contacts"]]
    said = (f"{counted(sum(r['contacts'] for r in runs), 'contact')}, in {len(touched)} of {len(runs)} runs; "
            f"{touching(len(touched), len(runs))}") if runs else ""
    return Line(f"{who} without bumpers: no body touches a surface", said, none_of(touched, runs, fewest=fewest))


def clear_line(who, runs, fewest):
    runs = [r for r in runs if r["clearance_min_m"] is not None]
    near = [r for r in runs if r["clearance_min_m"] < CLEARANCE]
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
    for who, methods in (("Tours", of_tours), ("View quality", ["render"])):
        for which, of_files in (("built-in worlds", False), ("worlds of others", True)):
            tasks = results.experiments.tasks_of(of_files)
            yield contacts_line(f"{who}, {which},", [r for r in runs_in_motion(results, methods, tasks) if not r.crashed],
                                {row: n for row, n in in_each(results, methods).items() if row[0] in tasks})

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
    of_tours = teams(results)
    timed = [r for r in results.all.values() if r.run.timed and r.run.method in of_tours and r["planning_p99_s"] is not None]
    charged = {r.run: results.experiments.task_file(r.run)["latency_s"] for r in timed}
    late = [r for r in timed if r["planning_p99_s"] > charged[r.run]]
    of_each = declared(results, lambda run: run.timed and run.method in of_tours)
    yield Line("Tours: 99 % of plannings take at most what the clock charges, in one run of each kind",
               "; ".join(f"{' '.join(r.run[:2])} {r['planning_p99_s']:.3f} of {charged[r.run]} s" for r in timed),
               none_of(late, timed, fewest=of_each))

    def limit(run):
        return OFFICE_PLANNING if results.experiments.file_of(run.task) else PLANNING
    yield Line(f"Tours: 99 % of plannings take at most {PLANNING} s, at voxels of 0.1 m {OFFICE_PLANNING} s, in one run of each kind",
               "; ".join(f"{' '.join(r.run[:2])} {r['planning_p99_s']:.3f} s" for r in timed),
               none_of([r for r in timed if r["planning_p99_s"] > limit(r.run)], timed, fewest=of_each))
    halves = {r.run: [r[column] for column in PLANNING_HALVES] for r in timed if r[PLANNING_HALVES[0]]}
    growth = {run: second / first for run, (first, second) in halves.items()}
    yield Line(f"Tours: that of the second half of a run is at most {GROWTH} times that of the first",
               "; ".join(f"{' '.join(run[:2])} {by:.2f}×" for run, by in growth.items()),
               none_of([by for by in growth.values() if by > GROWTH], growth, fewest=of_each))


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
              contacts_line(as_first_word(title("tour_swaying")), swaying, 1),
              clear_line(as_first_word(title("tour_swaying")), swaying, 1),
              apart_line(as_first_word(title("tour_swaying")), swaying, 1)]
    return [line._replace(verdict=noticed(line.verdict)) for line in lines]


def our_lines(results):
    return [*speed_lines(results), *team_lines(results), *goal_lines(results), *motion_lines(results), *safety_lines(results), *time_lines(results),
            *sameness_lines(results)]
