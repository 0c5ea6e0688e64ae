"""The tables of the page of results."""

from statistics import fmean

import paper
from comparisons import as_times, at_the_end, end_of, seconds_mapped, to_a_level
from intervals import FEWEST, difference, mean, median_difference
from markdown import NOTHING, counted, interval, percent, plain, table, value
from rows import GAINS, LEVELS, MAP, PLANNING, PLANNING_HALVES, UNSEEN
from verdicts import NOT_MEASURED


def means(runs, measure, digits=0, unit="", scale=1.0):
    found = mean(map(measure, runs))
    return value(found and scale * found.value, digits, unit)


def mean_interval(runs, measure):
    return interval(mean(map(measure, runs)))


def parts(runs, measure):
    return means(runs, measure, 1, " %", 100)


def least(runs, fact):
    values = [r[fact] for r in runs if r[fact] is not None]
    return value(min(values) if values else None, 3)


def with_numbers(runs):
    return [r for r in runs if not r.crashed]


def total(runs, fact):
    return sum(r[fact] for r in runs)


def contacts_of(runs):
    """All, and those whose voxels were free in the map: no planner could have known."""
    return f"{total(runs, 'contacts')} / {sum(r['contacts_in_free'] or 0 for r in runs)}"


def touched(runs):
    return f"{sum(r['contacts'] > 0 for r in runs)} of {len(runs)}"


def why_unseen(runs):
    """Where only smaller robots would see it, nobody would, or ours would: estimates, in percent of the observable
    space."""
    known = [r for r in runs if r["hidden"] is not None]
    return " / ".join(f"{100 * fmean(r[p] for r in known):.1f}" for p in UNSEEN) if known else NOTHING


def level(runs, measure, mean_of):
    """A mean to a level; if not all runs got there it says how many did, since theirs is the mean of the best."""
    there = [r for r in runs if measure(r) is not None]
    cell = mean_of(there, measure)
    return cell if len(there) in (0, len(runs)) else f"{cell}; {len(there)} of {len(runs)}"


def rows_of(results, tasks, cells):
    """A row for each task and method of the main table."""
    return [[plain(results.experiments.task_title(task)), results.experiments.title(method),
             *cells(results.of(task, method), results.done(task, method))]
            for task in tasks for method in results.methods(task, "main")]


def times_table(results, tasks):
    """With intervals at the level at which the task's world counts as mapped."""
    def cells(task):
        judged = results.experiments.level(task)
        return lambda runs, done: [
            str(len(runs)), str(len(runs) - len(done)),
            *(level(done, lambda r, k=k: r.seconds(k), mean_interval if k == judged else means) for k in LEVELS[:-1]),
            mean_interval(done, end_of)]

    return table(["task", "method", "runs", "failed", "50 % [s]", "90 %", "95 %", "99 %", "end"],
                 [row for task in tasks for row in rows_of(results, [task], cells(task))], texts=2)


def safety_table(results, tasks):
    return table(["task", "method", "metres", "UAVs' metres", "of them revisited", "cut off", "contacts / in free voxels",
                  "clearance [m]", "bodies apart [m]"],
                 rows_of(results, tasks, lambda runs, done: [
                     means(done, lambda r: r.metres()), means(done, lambda r: r.metres("uav")),
                     parts(done, lambda r: r["revisited_uav"]),
                     str(sum(r["end"] == "cut_off" for r in runs)), contacts_of(with_numbers(runs)),
                     least(with_numbers(runs), "clearance_min_m"), least(with_numbers(runs), "separation_min_m")]), texts=2)


def unseen_table(results, tasks):
    return table(["task", "method", "mapped", "unseen [%]: narrow / hidden / in view"],
                 rows_of(results, tasks, lambda runs, done: [parts(done, lambda r: r.coverage), why_unseen(done)]), texts=2)


def failed_of(results, tasks, method, other):
    """Of the pairs, by method."""
    pairs = [pair for task in tasks for pair in results.pairs(task, method, other)]
    return " / ".join(str(sum(bool(pair[i].failure) for pair in pairs)) for i in (0, 1))


def pairs_table(results, first="tour"):
    """The first method by the others."""
    rows = []
    for task in results.tasks():
        for other in (m for m in results.methods(task, "main") if m != first):
            if pairs := results.pairs(task, first, other):
                rows.append([
                    plain(results.experiments.task_title(task)), results.experiments.title(other), str(len(pairs)),
                    failed_of(results, [task], first, other),
                    *(as_times(to_a_level(results, [task], first, other, measure).found) for measure in
                      (seconds_mapped, lambda r: r.metres_mapped)),
                    interval(median_difference(pairs, seconds_mapped), sign=True),
                    interval(at_the_end(results, [task], first, other, end_of), 2, unit="×")])
    return table(["task", f"{results.experiments.title(first)} by", "pairs", "failed", "time until mapped",
                  "metres until mapped", "difference until mapped [s]", "time to the end"],
                 rows, texts=2)


def ended_pairs(results, tasks, method, other):
    return [pair for task in tasks for pair in results.pairs(task, method, other) if not any(r.crashed for r in pair)]


def compared_tasks(results, method, other):
    """Of fewer pairs there is no interval: they would say little, and look as if they said much."""
    return [t for t in results.tasks() if len(results.pairs(t, method, other)) >= FEWEST]


def variants_table(results, kind, base):
    """Each variant against its base, by pairs; the tasks together that both have runs enough of."""
    rows = []
    for method in results.experiments.methods_of(kind, base):
        tasks = compared_tasks(results, method, base)
        if tasks:
            pairs = ended_pairs(results, tasks, method, base)
            contacts = " / ".join(str(total(runs, "contacts")) for runs in zip(*pairs))
            rows.append([results.experiments.title(method), str(sum(len(results.pairs(t, method, base)) for t in tasks)),
                         failed_of(results, tasks, method, base),
                         *(as_times(to_a_level(results, tasks, method, base, measure).found) for measure in
                           (lambda r: r.until("90"), seconds_mapped, lambda r: r.metres_mapped)),
                         interval(at_the_end(results, tasks, method, base, end_of), 2, unit="×"), contacts])
    return table(["changed", "pairs", "failed: with / without", "time to 90 %", "time until mapped", "metres until mapped",
                  "time to the end", "contacts: with / without"], rows, none=f"No world has {FEWEST} pairs yet.")


def maps_table(results, kind, base):
    """How right maps are by the true world: with errors of reality less without, by pairs of the same world and seed."""
    methods = results.experiments.methods_of(kind, base)
    tasks = [t for t in results.tasks() if any(t in compared_tasks(results, m, base) for m in methods)]
    runs = [r for task in tasks for r in results.of(task, base) if r[MAP[0]] is not None]
    rows = [[results.experiments.title(base), str(len(runs)),
             *(parts(runs, lambda r, f=fact: r[f]) for fact in MAP)]] if runs else []
    for method in methods:
        groups = [results.pairs(task, method, base) for task in compared_tasks(results, method, base)]
        found = [difference(groups, lambda r, f=fact: r[f]) for fact in MAP]
        if any(found):
            rows.append([results.experiments.title(method), str(max(f.count for f in found if f)),
                         *(interval(f, 2, 100, sign=True) for f in found)])
    return table(["", "runs or pairs", "free voxels that hold a surface", "occupied ones in free space",
                  "surface voxels found"], rows, none=f"No world has {FEWEST} pairs yet.")


def bumpers_table(results):
    rows = []
    for task in results.tasks():
        for method in results.methods(task, "bumpers"):
            without = results.experiments.methods[method]["against"]
            if pairs := ended_pairs(results, [task], method, without):
                runs, bare = zip(*pairs)
                rows.append([plain(results.experiments.task_title(task)), results.experiments.title(without),
                             str(len(pairs)), str(total(runs, "held_back")), str(total(bare, "contacts")),
                             as_times(to_a_level(results, [task], method, without, seconds_mapped).found)])
    return table(["task", "method", "pairs", "with bumpers, times held back", "without, contacts",
                  "time until mapped, with by without"], rows, texts=2)


def lines_table(lines):
    """Those that are not measured are named below it."""
    rows = [[plain(x.claim), plain(x.measured) or NOTHING, x.verdict] for x in lines if x.verdict != NOT_MEASURED]
    missing = [f"- {plain(x.claim)}\n" for x in lines if x.verdict == NOT_MEASURED]
    text = table(["claim", "measured", "verdict"], rows, texts=3)
    if missing:
        text += f"\n<details><summary>{counted(len(missing), 'line')} not measured</summary>\n\n{''.join(missing)}\n</details>\n"
    return text


def steps_table(results):
    rows = []
    for world in paper.WORLDS:
        for method in results.methods(world, "lock-step"):
            runs, done = results.of(world, method), results.done(world, method)
            rows.append([
                world, results.experiments.title(method), str(len(runs)), str(len(runs) - len(done)),
                str(sum(r["end"] == "cut_off" for r in runs)),
                parts(with_numbers(runs), lambda r: r.coverage), touched(with_numbers(runs)),
                f"{percent(paper.COVERAGE[world])} in {paper.STEPS[world]}" if method == "steps" else NOTHING,
                mean_interval(done, lambda r: r["steps"]), level(done, lambda r: r["steps_to_90"], mean_interval),
                means(done, lambda r: r.metres("uav")), parts(done, lambda r: r["revisited_uav"]),
                means(done, lambda r: r.share("uav"), 0, " %", 100),
                means(done, lambda r: r.efficiency("uav"), 1)])
    return table(["world", "", "runs", "failed", "ended cut off", "mapped, by all runs", "runs with a contact", "paper, mapped in steps", "steps",
                  "steps to 90 %", "UAV's metres", "of them revisited", "UAV's share", "% per 100 m of the UAV"], rows, texts=2)


def optimisation_table(results):
    rows = []
    for world, steps in ((w, s) for s in ("steps", "steps_render") for w in paper.WORLDS):
        before, after = results.done(world, f"{steps}_yaw_ahead"), results.done(world, steps)
        if before or after:
            seen = [means(after, lambda r, c=c: r[c]) for c in GAINS]
            shares = " / ".join(means(runs, lambda r: r.share("uav"), 0, " %", 100) for runs in (before, after))
            metres = " / ".join(means(runs, lambda r: r.metres("uav"), 0, " m") for runs in (before, after))
            rows.append([world, results.experiments.title(steps), *seen, means(before, lambda r: r["gained"]),
                         "{} / {} %".format(*paper.UAV_SHARE[world]), shares,
                         "{} / {} m".format(*paper.UAV_LENGTH[world]), metres])
    return table(["world", "", "frontiers in view, looking ahead", "with optimised yaws", "mapped by a path",
                  "without optimisation", "UAV's share, paper, before / after", "ours",
                  "UAV's path, paper, before / after", "ours"], rows, texts=2)


def planning_table(results):
    rows = []
    for run, result in results.all.items():
        if run.timed and not result.crashed:
            task = results.experiments.task_file(run)
            lockstep = task.get("lockstep")
            rows.append([run.task, results.experiments.title(run.method) + (", lock-step" if lockstep else ""),
                         *(value(result[column], 3, " s") for column in (*PLANNING, *PLANNING_HALVES)),
                         NOTHING if lockstep else f"{task['latency_s']} s",
                         f"{paper.UAV_PLANNING[run.task] + paper.UGV_PLANNING[run.task]:.2f} s" if lockstep else NOTHING, plain(result["machine"] or NOTHING)])
    if not rows:
        return ("Not measured: they are published from runs alone on an idle machine (`./dev reproduce --timed`), and "
                "there are none yet.\nIn all other tables the clock charges a fixed latency, which no load changes.\n")
    return table(["task", "method", "mean", "99 %", "longest", "99 %, first half", "second half", "charged", "paper, UAV and UGV", "processor"], rows, texts=2)


def published_list(experiments):
    """What others have published of the same tasks."""
    lines = []
    for task in experiments.tasks:
        if published := experiments.tasks[task].get("published"):
            lines.append(f"- {plain(experiments.task_title(task))}: " + ", ".join(
                f"{name} {low} to {high} s" for name, (low, high) in published["seconds"].items()) +
                f" ({published['source']}).\n")
    return "".join(lines) or "None.\n"


def missing_table(results):
    """By task: rows are a method's runs there."""
    rows = {}
    for run in results.wanted:
        counts = rows.setdefault(run.task, {}).setdefault((run.method, run.timed), [0, 0])
        counts[0] += run in results.all
        counts[1] += 1
    cells = []
    for task, counts in rows.items():
        there, wanted = (sum(n) for n in zip(*counts.values()))
        if there < wanted:
            kinds = [(n > 0) + (n == all_of_them) for n, all_of_them in counts.values()]
            cells.append([plain(results.experiments.task_title(task)), f"{wanted - there} of {wanted}",
                          *(str(kinds.count(kind)) for kind in (2, 1, 0))])
    return table(["task", "runs missing", "methods with all runs", "with some", "with none"], cells, none="None.")


def failures_list(results):
    spoilt = results.experiments.methods_of("controls")
    lines = [f"- {plain(r.run.name)}: {plain(r.failure)}\n" for r in results.all.values()
             if r.failure and (r.crashed or r.run.method not in spoilt)]
    lines += [f"- {plain(r.run.name)}, before this run of it: {plain(r['failed_before'])}\n" for r in results.all.values()
              if r["failed_before"]]
    lines += [f"- {plain(name)}: {plain(reason)}\n" for name, reason in results.broken.items()]
    return "".join(lines) or "None.\n"
