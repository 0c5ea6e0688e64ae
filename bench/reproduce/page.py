"""docs/results.md: what is compared, the main table, why, the paper's tables, limits."""

import paper
from claims import compared, end_of, our_lines, paper_lines
from explore import LONGEST
from intervals import LEVEL, RESAMPLES, difference, mean, ratio
from markdown import NOTHING, interval, percent, plain, table, value
from results import LEVELS

# Of the main table; "steps" are lock-step and have tables of their own.
MAIN = ("tour", "render", "cluster", "nearest", "paper", "tour_uav", "render_uav", "tour_2uav", "tour_3uav", "tour_4uav")
NO_VARIANTS = ("tour_bumper", "render_bumper", "tour_grid_caster")  # they have tables and lines of their own
REALITY = ("tour_noise", "tour_dropout")
METHODS = """\
- **tours** (`--goal tour`, the default): tours over all that is left to see, shared out to the robots.
- **view quality** (`--goal render`): one goal after the other, by eq. 1 and exact view quality.
- **clusters** and **nearest frontier** (`--goal cluster`, `--goal nearest`): the same with other goals; the nearest is
  Yamauchi's, the nearest cluster of frontiers.
- **as printed, in motion** (`--mode paper`): the paper's method under the same clock; it ends by its own rule, with a gain
  below 1 frontier summed over viewpoints, so that it does not end by our choice.

All plan with the same map, corridor, trajectories, limits and clock. The paper's tables further down are in lock-step, Alg. 1
as printed (`--mode paper --lockstep`)."""
LIMITS = """\
- Worlds are simulated: meshes without moving things, sensors without noise unless a row says so, exact poses, perfect tracking
  and communication. Pose drift, tracking errors, lost messages and robots that fail are not simulated.
- What noise does to the map (false free, false occupied) is not measured; only times, coverage and contacts are.
- The built-in worlds are our own. In worlds of others nothing is random but the start, which is moved by up to half a metre;
  their intervals say how far such a change moves a result, not how other worlds would do.
- Percentile intervals of few values are somewhat too narrow: with 8 pairs about 90 % instead of 95 %.
- Many lines are judged at once: of twenty that are true by a hair, one interval misses by chance.
- The observable space is the free space connected with the start and the surfaces around it, at the run's voxels; the paper does
  not define its coverage.
- Limits of speed and acceleration were not varied."""



def means(runs, measure, digits=0, unit="", scale=1.0):
    found = mean(map(measure, runs))
    return value(found and scale * found.value, digits, unit)


def least(runs, fact, unit):
    values = [r.facts[fact] for r in runs if r.facts.get(fact) is not None]
    return value(min(values) if values else None, 2, unit)


def why_unseen(runs):
    """Where only smaller robots would see it, nobody would, or ours would; estimates, in percent of the observable space."""
    unseen = [r.facts["unseen"] for r in runs if r.facts.get("unseen")]
    return " / ".join(f"{100 * sum(u[part] for u in unseen) / len(unseen):.1f}" for part in ("narrow", "hidden", "in_view")) + " %" \
        if unseen else NOTHING


def main_table(results, tasks, methods):
    rows = []
    for task in tasks:
        for method in results.methods(task):
            if method not in methods:
                continue
            runs, done = results.of(task, method), results.done(task, method)
            moved = [r for r in runs if r.facts]
            rows.append([task, results.experiments.title(method), str(len(runs)), str(len(runs) - len(done)),
                         *(means(done, lambda r, k=level: r.seconds(k)) for level in LEVELS[:-1]),
                         interval(mean(map(end_of, done))), means(done, lambda r: r.coverage, 1, " %", 100),
                         means(done, lambda r: r.metres()), means(done, lambda r: r.metres("uav")),
                         str(sum(r.facts["contacts"] for r in moved)), least(moved, "clearance_min_m", ""),
                         least(moved, "separation_min_m", ""), why_unseen(done)])
    return table(["task", "method", "runs", "failed", "50 % [s]", "90 %", "95 %", "99 %", "end", "mapped", "metres", "UAVs' metres",
                  "contacts", "clearance [m]", "bodies apart [m]", "unseen: narrow / hidden / in view"], rows, texts=2)


def pairs_table(results, tasks, first, others):
    rows = []
    for task in tasks:
        for other in others:
            pairs, ours, theirs = results.pairs(task, first, other)
            if not pairs and not ours + theirs:
                continue
            rows.append([task, results.experiments.title(other), str(len(pairs)), f"{ours} / {theirs}",
                         interval(difference(pairs, lambda r: r.seconds("95")), sign=True),
                         interval(difference(pairs, end_of), sign=True),
                         interval(difference(pairs, lambda r: r.metres()), sign=True),
                         interval(ratio([pairs], end_of), 2, unit="×")])
    return table(["task", f"{results.experiments.title(first)} less ...", "pairs", "lost: failures of first / second", "to 95 % [s]",
                  "to the end [s]", "metres", "ratio of times to the end"], rows, texts=2)


def variants_table(results, base, of_reality=False):
    """Each variant against its base, by pairs; tasks together."""
    rows = []
    tasks = results.tasks(of_files=False)
    for method in results.experiments.methods:
        if not method.startswith(f"{base}_") or method in (*MAIN, *NO_VARIANTS) or (method in REALITY) != of_reality:
            continue
        found, said, failures = compared(results, tasks, method, base, end_of)
        if not found and not said:
            continue
        pairs = [results.pairs(task, method, base) for task in tasks]
        contacts = sum(r.facts["contacts"] for t in tasks for r in results.of(t, method) if r.facts)
        rows.append([results.experiments.title(method), str(found.count if found else 0), str(failures),
                     *(interval(ratio([p for p, _, _ in pairs], m), 2, unit="×")
                       for m in (lambda r: r.seconds("90"), lambda r: r.seconds("99"), end_of, lambda r: r.metres())),
                     str(contacts)])
    return table(["changed", "pairs", "failed", "time to 90 %", "to 99 %", "to the end", "metres", "contacts"], rows)


def held_back_table(results):
    rows = []
    for task in results.tasks():
        for method, without in (("tour_bumper", "tour"), ("render_bumper", "render")):
            runs, bare = ([r for r in results.of(task, m) if r.facts] for m in (method, without))
            if runs:
                rows.append([task, results.experiments.title(without), str(len(runs)), str(sum(r.facts["held_back"] for r in runs)),
                             f"{sum(r.facts['contacts'] for r in bare)} in {len(bare)}"])
    return table(["task", "method", "runs with bumpers", "times held back", "contacts without, in runs"], rows, texts=2)


def lines_table(lines):
    return table(["claim", "measured", ""], [[plain(x.claim), plain(x.measured) or NOTHING, x.verdict] for x in lines], texts=3)


def summary(lines):
    words = ("reproduced", "holds", "**not reproduced", "**does not hold", "open", "not comparable", "not measured")
    counts = [(word.strip("*"), sum(line.verdict.startswith(word) for line in lines)) for word in words]
    return ", ".join(f"{n} {word}" for word, n in counts if n) + f"; {len(lines)} lines"


def steps_table(results):
    rows = []
    for world in paper.WORLDS:
        for method in results.methods(world, "steps"):
            runs, done = results.of(world, method), results.done(world, method)
            rows.append([world, results.experiments.title(method), str(len(runs)), str(len(runs) - len(done)),
                         means([r for r in runs if r.facts], lambda r: r.coverage, 1, " %", 100),
                         str(paper.STEPS[world]) if method == "steps" else NOTHING,
                         interval(mean(r.steps() for r in done)), interval(mean(r.steps(0.9) for r in done)),
                         means(done, lambda r: r.metres("uav")), means(done, lambda r: r.share("uav"), 0, " %", 100),
                         means(done, lambda r: r.efficiency("uav"), 1)])
    return table(["world", "", "runs", "below 90 %", "mapped, of all runs", "steps, paper", "steps", "steps to 90 %", "UAV's metres",
                  "UAV's share", "% per 100 m of the UAV"], rows, texts=2)


def optimisation_table(results):
    rows = []
    for world in paper.WORLDS:
        before, after = results.done(world, "steps_yaw_ahead"), results.done(world, "steps")
        if before or after:
            rows.append([world, *(means(after, lambda r, c=c: r.gain("uav", c)) for c in ("gain_tangent", "gain_predicted", "gained")),
                         means(before, lambda r: r.gain("uav", "gained")), "{} / {} %".format(*paper.UAV_SHARE[world]),
                         means(before, lambda r: r.share("uav"), 0, " %", 100) + " / " +
                         means(after, lambda r: r.share("uav"), 0, " %", 100),
                         "{} / {} m".format(*paper.UAV_LENGTH[world]),
                         means(before, lambda r: r.metres("uav")) + " / " + means(after, lambda r: r.metres("uav"), 0, " m")])
    return table(["world", "frontiers in view, looking ahead", "with optimised yaws", "mapped by a path", "without optimisation",
                  "UAV's share, paper, before / after", "ours", "UAV's path, paper, before / after", "ours"], rows)


def planning_table(results):
    rows = []
    for task in results.tasks():
        for method in results.experiments.methods:
            for r in results.of(task, method, timed=True):
                if r.facts:
                    latency = "" if r.content["task"].get("lockstep") else f"{r.content['task']['latency_s']} s"
                    rows.append([task, results.experiments.title(method) + (" (lock-step)" if not latency else ""),
                                 value(r.measured["planning_mean_s"], 3, " s"), value(r.measured["planning_p99_s"], 3, " s"),
                                 value(r.measured["planning_max_s"], 3, " s"), latency or NOTHING,
                                 f"{paper.UAV_PLANNING[task] + paper.UGV_PLANNING[task]:.2f} s" if not latency else NOTHING])
    if not rows:
        return ("Not measured: planning times are published from runs alone on an idle machine (`./dev reproduce --timed`), and "
                "there are none yet. In all other tables the clock charges a fixed latency, which no load changes.\n")
    return table(["task", "method", "mean", "99 %", "longest", "charged", "paper, UAV and UGV"], rows, texts=2)


def seeds_of(results):
    seeds = sorted({r.seed for r in results.all if not r.timed})
    return f"{seeds[0]} to {seeds[-1]}" if seeds else "none"


def origin(results):
    runs = list(results.all.values())
    versions = sorted({r.content["version"] for r in runs})
    programs = {r.measured.get("program") for r in runs} - {None}
    return (f"{len(runs)} of {len(results.wanted)} runs of version {', '.join(map(plain, versions))}"
            f" ({len(programs)} {'builds' if len(programs) != 1 else 'build'} of it), layouts of seeds {seeds_of(results)}.")


def missing_table(results, absent):
    wanted, there = {}, {}
    for run in results.wanted:
        key = (run.task, run.method + (" (timed)" if run.timed else ""))
        wanted[key] = wanted.get(key, 0) + 1
        there[key] = there.get(key, 0) + (run in results.all)
    rows = {}
    for (task, method), number in wanted.items():
        if there[task, method] < number:
            rows.setdefault(task, []).append(f"{method} {number - there[task, method]} of {number}")
    text = table(["task", "runs that are missing"], [[task, plain(", ".join(words))] for task, words in rows.items()], texts=2)
    if absent:
        text += f"\nFiles that no folder given by `--worlds` holds: {plain(', '.join(absent))}.\n"
    return text if rows else "None.\n"


def failures_list(results):
    lines = [f"- {plain(r.run.name)}: {plain(r.failure)}\n" for r in results.all.values() if r.failure]
    lines += [f"- {plain(name)}: {plain(reason)}\n" for name, reason in results.broken.items()]
    return "".join(lines) or "None.\n"


def page(results, images, runs, absent=()):
    """images, runs: the figures' folder and the table of all runs, as seen from the page; absent: files of worlds."""
    built_in, others = results.tasks(of_files=False), results.tasks(of_files=True)
    ours, papers = our_lines(results), paper_lines(results)

    def figure(name, title):
        return f"![{title}]({images}/{name}.svg)\n"

    return f"""\
# Results

Written by `./dev reproduce` from {origin(results)}
[{runs}]({runs}) has a row for each; [reproducing.md](reproducing.md) says how to make them. What is missing stands at the end of the page.

## What is compared

{METHODS}

Robots, unless a row says otherwise: a UGV (1.0 m/s, lidar 6 m) and a UAV (1.5 m/s, camera 10 m), both with 2 m/s2 and 60
degrees/s; voxels of 0.3 m; the clock charges 0.25 s for each planning. The offices have a UAV of 2 m/s, voxels of 0.1 m and 0.15 s.
**No bumpers**: a body that touches a surface goes on, and that is a contact. `bench/reproduce/experiments.json` declares all of it.

Parameters were fixed on seeds 1 to 5; results are of other seeds. The seed of a row's run is its layout's plus
{results.experiments.seed_offset:,}. In brackets: {100 * LEVEL:.0f} % bootstrap intervals ({RESAMPLES:,} resamples); methods are compared by
pairs with the same layout and seed. **Failed** is a run that crashed, hung ({LONGEST:,} s of computing), was cut off, reached a limit, or
ended with less than 99 % of the observable space mapped (hospital 90 %, the paper's steps 90 %). A failed run enters no mean, and
its pair is lost, which is counted.

## Main table

Means of the runs that did not fail; contacts, least clearance of a body to a surface and least distance of two bodies of all runs.
What was not mapped is in view only of smaller robots (narrow), of none (hidden), or of these (in view), by estimates.

{main_table(results, built_in, MAIN)}
{figure("coverage_by_time", "Mapped part of the observable space against seconds, by method")}
Tours less the others, by pairs; below zero, or a ratio below 1, tours are better.

{pairs_table(results, [*built_in, *others], "tour", [m for m in MAIN if m != "tour"])}
{figure("ratios", "Time to the end of tours by that of the others, with intervals")}
## What must hold

{summary(ours)}. **Open** is what the runs do not decide.

{lines_table(ours)}
## Why

One thing changed at a time, by pairs with the method unchanged; above 1 the change costs. Tours:

{variants_table(results, "tour")}
View quality:

{variants_table(results, "render")}
## What reality adds

Errors of the simulated sensors, otherwise as above; tours:

{variants_table(results, "tour", of_reality=True)}
## Contacts and bumpers

Without bumpers contacts are counted; with them, the default of `explore`, a robot that would touch a surface rests, which is counted as
held back.

{held_back_table(results)}
## Worlds of others

{main_table(results, others, MAIN)}
## The paper, line by line

{summary(papers)}. In lock-step as printed. A number that the paper prints is *reproduced* if there is an effect beyond chance and
one as large as the paper's is not excluded by the interval; a limit if the whole interval keeps it. The paper prints one run of
each kind.

{lines_table(papers)}
## The paper's tables

Lock-step; a voxel belongs to the robot that observed it first.

{steps_table(results)}
{figure("coverage_by_step", "Mapped part against steps: team, UAV alone, UGV alone")}
{optimisation_table(results)}
## Planning times

{planning_table(results)}
## Limits

{LIMITS}

## Failed runs

{failures_list(results)}
## Missing runs

{missing_table(results, absent)}"""
