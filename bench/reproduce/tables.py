"""The tables of the page of results."""

import paper
from claims import compared, end_of
from intervals import difference, mean, ratio
from markdown import NOTHING, interval, percent, plain, table, value
from results import LEVELS

# In motion, of the main table. Methods of the name "steps..." are in lock-step and have tables of their own.
MAIN = ("tour", "render", "cluster", "nearest", "paper", "tour_uav", "render_uav", "tour_2uav", "tour_3uav",
        "tour_4uav")
BUMPERS = {"tour_bumper": "tour", "render_bumper": "render"}  # with bumpers: the same without
REALITY = ("tour_noise", "tour_dropout", "tour_drift", "tour_lost_place", "tour_late", "tour_lost_scans", "tour_fail")


def means(runs, measure, digits=0, unit="", scale=1.0):
    found = mean(map(measure, runs))
    return value(found and scale * found.value, digits, unit)


def mean_interval(runs, measure):
    return interval(mean(map(measure, runs)))


def parts(runs, measure):
    return means(runs, measure, 1, " %", 100)


def least(runs, fact):
    values = [r.facts[fact] for r in runs if r.facts.get(fact) is not None]
    return value(min(values) if values else None, 3)


def with_facts(runs):
    return [r for r in runs if r.facts]


def total(runs, fact):
    return sum(r.facts[fact] for r in runs)


def contacts_of(runs):
    """All, and those whose voxels were free in the map: no planner could have known."""
    return f"{total(runs, 'contacts')} / {sum(r.facts.get('contacts_in_free') or 0 for r in runs)}"


def why_unseen(runs):
    """Where only smaller robots would see it, nobody would, or ours would: estimates, in percent of the observable
    space."""
    unseen = [r.facts["unseen"] for r in runs if r.facts.get("unseen")]
    if not unseen:
        return NOTHING
    return " / ".join(f"{100 * sum(u[p] for u in unseen) / len(unseen):.1f}" for p in ("narrow", "hidden", "in_view"))


def main_table(results, tasks):
    rows = []
    for task in tasks:
        for method in (m for m in results.methods(task) if m in MAIN):
            runs, done = results.of(task, method), results.done(task, method)
            moved = with_facts(runs)
            rows.append([
                task, results.experiments.title(method), str(len(runs)), str(len(runs) - len(done)),
                *(means(done, lambda r, k=level: r.seconds(k)) for level in LEVELS[:-1]), mean_interval(done, end_of),
                parts(done, lambda r: r.coverage), means(done, lambda r: r.metres()),
                means(done, lambda r: r.metres("uav")), parts(done, lambda r: r.revisited("uav")),
                contacts_of(moved), least(moved, "clearance_min_m"), least(moved, "separation_min_m"),
                why_unseen(done)])
    return table(["task", "method", "runs", "failed", "50 % [s]", "90 %", "95 %", "99 %", "end", "mapped", "metres",
                  "UAVs' metres", "revisited", "contacts / in free voxels", "clearance [m]", "bodies apart [m]",
                  "unseen [%]: narrow / hidden / in view"], rows, texts=2)


def pairs_table(results, first="tour"):
    """The first method less the others."""
    rows = []
    for task in results.tasks():
        for other in (m for m in MAIN if m != first):
            pairs, ours, theirs = results.pairs(task, first, other)
            if pairs or ours or theirs:
                rows.append([
                    task, results.experiments.title(other), str(len(pairs)), f"{ours} / {theirs}",
                    *(interval(difference(pairs, lambda r, k=level: r.seconds(k)), sign=True) for level in ("95", "99")),
                    interval(difference(pairs, end_of), sign=True),
                    interval(difference(pairs, lambda r: r.metres()), sign=True),
                    interval(ratio([pairs], end_of), 2, unit="×")])
    return table(["task", f"{results.experiments.title(first)} less", "pairs", "pairs lost, failures of first / second",
                  "to 95 % [s]", "to 99 % [s]", "to the end [s]", "metres", "ratio of times to the end"], rows, texts=2)


def variants_table(results, base, of_reality=False):
    """Each variant against its base, by pairs; built-in tasks together."""
    rows = []
    tasks = results.tasks(of_files=False)
    for method in results.experiments.methods:
        if not method.startswith(f"{base}_") or method in MAIN or method in BUMPERS or method == "tour_grid_caster" \
                or (method in REALITY) != of_reality:
            continue
        found, said, failures = compared(results, tasks, method, base, end_of)
        if found or said:
            pairs = [results.pairs(task, method, base)[0] for task in tasks]
            ratios = [interval(ratio(pairs, measure), 2, unit="×") for measure in
                      (lambda r: r.seconds("90"), lambda r: r.seconds("99"), end_of, lambda r: r.metres())]
            contacts = sum(total(with_facts(results.of(t, method)), "contacts") for t in tasks)
            rows.append([results.experiments.title(method), str(found.count if found else 0), str(failures), *ratios,
                         str(contacts)])
    return table(["changed", "pairs", "failed", "time to 90 %", "to 99 %", "to the end", "metres", "contacts"], rows)


def maps_table(results, base):
    """How right maps are by the true world, with and without the errors of reality; built-in tasks together."""
    rows = []
    tasks = results.tasks(of_files=False)
    for method in (base, *REALITY):
        runs = [r for task in tasks for r in with_facts(results.of(task, method)) if r.facts.get("map")]
        if runs:
            rows.append([results.experiments.title(method), str(len(runs)),
                         *(parts(runs, lambda r, k=kind: r.facts["map"][k])
                           for kind in ("false_free", "false_occupied", "surface_found"))])
    return table(["", "runs", "free voxels that hold a surface", "occupied ones in free space",
                  "surface voxels found"], rows)


def bumpers_table(results):
    rows = []
    for task in results.tasks():
        for method, without in BUMPERS.items():
            runs, bare = with_facts(results.of(task, method)), with_facts(results.of(task, without))
            if runs:
                rows.append([task, results.experiments.title(without), str(len(runs)), str(total(runs, "held_back")),
                             str(len(bare)), str(total(bare, "contacts"))])
    return table(["task", "method", "runs with bumpers", "times held back", "runs without", "contacts"], rows, texts=2)


def lines_table(lines):
    return table(["claim", "measured", ""],
                 [[plain(x.claim), plain(x.measured) or NOTHING, x.verdict] for x in lines], texts=3)


def steps_table(results):
    rows = []
    for world in paper.WORLDS:
        for method in results.methods(world, "steps"):
            runs, done = results.of(world, method), results.done(world, method)
            rows.append([
                world, results.experiments.title(method), str(len(runs)), str(len(runs) - len(done)),
                parts(with_facts(runs), lambda r: r.coverage),
                f"{percent(paper.COVERAGE[world])} in {paper.STEPS[world]}" if method == "steps" else NOTHING,
                mean_interval(done, lambda r: r.steps()), mean_interval(done, lambda r: r.steps(0.9)),
                means(done, lambda r: r.metres("uav")), parts(done, lambda r: r.revisited("uav")),
                means(done, lambda r: r.share("uav"), 0, " %", 100),
                means(done, lambda r: r.efficiency("uav"), 1)])
    return table(["world", "", "runs", "failed", "mapped, by all runs", "paper, mapped in steps", "steps",
                  "steps to 90 %", "UAV's metres", "revisited", "UAV's share", "% per 100 m of the UAV"], rows, texts=2)


def optimisation_table(results):
    rows = []
    for world, steps in ((w, s) for s in ("steps", "steps_render") for w in paper.WORLDS):
        before, after = results.done(world, f"{steps}_yaw_ahead"), results.done(world, steps)
        if before or after:
            seen = [means(after, lambda r, c=c: r.gain("uav", c)) for c in ("gain_tangent", "gain_predicted", "gained")]
            shares = " / ".join(means(runs, lambda r: r.share("uav"), 0, " %", 100) for runs in (before, after))
            metres = " / ".join(means(runs, lambda r: r.metres("uav"), 0, " m") for runs in (before, after))
            rows.append([world, results.experiments.title(steps), *seen, means(before, lambda r: r.gain("uav", "gained")),
                         "{} / {} %".format(*paper.UAV_SHARE[world]), shares,
                         "{} / {} m".format(*paper.UAV_LENGTH[world]), metres])
    return table(["world", "", "frontiers in view, looking ahead", "with optimised yaws", "mapped by a path",
                  "without optimisation", "UAV's share, paper, before / after", "ours",
                  "UAV's path, paper, before / after", "ours"], rows, texts=2)


def planning_table(results):
    rows = []
    for run, result in results.all.items():
        if run.timed and result.facts:
            lockstep = result.content["task"].get("lockstep")
            printed = paper.UAV_PLANNING[run.task] + paper.UGV_PLANNING[run.task]
            rows.append([run.task, results.experiments.title(run.method) + (", lock-step" if lockstep else ""),
                         *(value(result.measured[key], 3, " s") for key in
                           ("planning_mean_s", "planning_p99_s", "planning_max_s")),
                         NOTHING if lockstep else f"{result.content['task']['latency_s']} s",
                         f"{printed:.2f} s" if lockstep else NOTHING])
    if not rows:
        return ("Not measured: they are published from runs alone on an idle machine (`./dev reproduce --timed`), and "
                "there are none yet.\nIn all other tables the clock charges a fixed latency, which no load changes.\n")
    return table(["task", "method", "mean", "99 %", "longest", "charged", "paper, UAV and UGV"], rows, texts=2)


def missing_table(results):
    rows = {}
    for run in results.wanted:
        name = run.method + (" (timed)" if run.timed else "")
        counts = rows.setdefault(run.task, {}).setdefault(name, [0, 0])
        counts[0] += run not in results.all
        counts[1] += 1
    cells = [[task, ", ".join(f"{name} {missing} of {wanted}" for name, (missing, wanted) in methods.items()
                              if 0 < missing < wanted),
              ", ".join(name for name, (missing, wanted) in methods.items() if missing == wanted)]
             for task, methods in rows.items()]
    return table(["task", "missing in part", "without any run"],
                 [[task, plain(part) or NOTHING, plain(whole) or NOTHING] for task, part, whole in cells if part or whole],
                 texts=3, none="None.")


def failures_list(results):
    lines = [f"- {plain(r.run.name)}: {plain(r.failure)}\n" for r in results.all.values() if r.failure]
    lines += [f"- {plain(name)}: {plain(reason)}\n" for name, reason in results.broken.items()]
    return "".join(lines) or "None.\n"
