"""docs/results.md: the tables of the paper beside ours."""

import paper
from checklist import checklist, same, savings
from markdown import NOTHING, mean_of, percent, plain, spread_of, table, value
from recorded import PHASES, spread
from runs import CASTERS, STEP_LIMIT, VARIANTS, WORLDS

NOT_COMPARABLE = f"""\
- The paper's worlds are not published. Ours have the same names and are generated from a seed, with other sizes and
  contents: metres and steps in one row of a table belong to different worlds.
- The paper does not define coverage. Ours is the known fraction of the observable space, which is the free space
  connected with the start and the surfaces around it. The table of all variants also has the coverage of the box.
- A step ends where its path ends, so the number of steps depends on the length of the paths. The paper prints one run
  of each kind, without a spread.
- Our sensors are simulated from the meshes of the worlds without noise, and poses are exact.
- The paper does not name the processor of its planning times. It prints them by robot; we measure by phase, both
  robots together.
- Where the paper leaves a choice open, the default mode uses what works best, and paper mode what is printed.
- A run that never reaches 90 % counts with its step limit, {STEP_LIMIT:,} steps; the means of the runs that reached it
  are beside."""


def steps_to_90(runs):
    """Mean with the step limit for runs that did not reach it, mean of the others alone, and their number."""
    reached = [run.steps_to(0.9) for run in runs if run.steps_to(0.9) is not None]
    counted = mean_of(spread(run.steps_or_limit(0.9) for run in runs), 1)
    if not runs or len(reached) == len(runs):
        return counted
    there = mean_of(spread(reached), 1) + " in " if reached else ""
    return f"{counted} ({there}{len(reached)} of {len(runs)} that reached it)"


def coverage_table(results):
    rows = []
    for world in WORLDS:
        runs = results.of(world, "team")
        aim = paper.COVERAGE[world]
        got_there = [s for s in (run.steps_to(aim) for run in runs) if s is not None]
        rows.append([world, percent(aim), spread_of(spread(r.coverage[-1] for r in runs), 1, 100, " %"),
                     str(paper.STEPS[world]), spread_of(spread(r.steps for r in runs), 1),
                     spread_of(spread(got_there), 1) + f", {len(got_there)} of {len(runs)} runs",
                     steps_to_90(runs)])
    return table(["world", "coverage, paper", "ours", "steps, paper", "ours", "ours, to the paper's coverage",
                  "ours, to 90 %"], rows)


def uav_path(runs):
    return spread_of(spread(r.travelled("uav")[-1] for r in runs), 0, 1, " m")


def team_table(results):
    rows = []
    for world in (*WORLDS, "all"):
        worlds = WORLDS if world == "all" else [world]
        team, uav, ugv = ([r for w in worlds for r in results.of(w, v)] for v in ("team", "uav", "ugv"))
        counted, reached = savings(results, "team", "uav", worlds)
        pairs = f" ({reached.count if reached else 0} of {counted.count if counted else 0})"
        rows.append([world, *(steps_to_90(runs) for runs in (team, uav, ugv)), spread_of(counted, 1, 100, " %"),
                     mean_of(reached, 1, 100, " %") + pairs, uav_path(uav), uav_path(team)])
    return table(["world", "steps to 90 %: team", "UAV alone", "UGV alone", "saved by the team", "if both reached it",
                  "UAV's path alone", "in the team"], rows)


def uav_efficiency(runs):
    """Percent of the observable space per 100 m of flight."""
    return spread(1e4 * r.known_by("uav")[-1] / r.travelled("uav")[-1] for r in runs if r.travelled("uav")[-1] > 0)


def contribution_table(results):
    rows = []
    for world in WORLDS:
        before, after, mixed = (results.of(world, v) for v in ("unoptimised", "team", "unassigned"))
        rows.append([world, "{} / {} %".format(*paper.UAV_SHARE[world]),
                     *(spread_of(spread(r.fraction_of("uav") for r in runs), 0, 100, " %") for runs in (before, after)),
                     *(mean_of(uav_efficiency(runs), 2) for runs in (mixed, after, results.of(world, "uav")))])
    return table(["world", "UAV's fraction, paper, before / after", "ours, before", "ours, after",
                  "% per 100 m: no assignment", "team", "UAV alone"], rows)


def optimisation_table(results):
    rows = []
    for world in WORLDS:
        before, after = results.of(world, "unoptimised"), results.of(world, "team")
        gains = [spread(g for r in after for g in r.gains("uav", column))
                 for column in ("gain_tangent", "gain_predicted", "gained")]
        ratio = gains[0] and gains[0].mean and gains[1].mean / gains[0].mean
        rows.append([world, *(mean_of(g, 0) for g in gains), value(ratio or None, 2, "×"),
                     mean_of(spread(g for r in before for g in r.gains("uav", "gained")), 0),
                     "{} / {} m".format(*paper.UAV_LENGTH[world]),
                     uav_path(before), uav_path(after)])
    return table(["world", "frontiers per path, before", "after", "gained", "after / before",
                  "gained without optimisation", "UAV's path, paper, before / after", "ours, before", "ours, after"],
                 rows)


def planning_table(results):
    rows = []
    for world in WORLDS:
        both = f"{paper.UAV_PLANNING[world] + paper.UGV_PLANNING[world]:.2f} s"
        run = results.timed(world)
        beside = spread(r.planning_mean for r in results.of(world, "team"))
        phases = [mean_of(spread(run.seconds(f"{p}_s")), 1, 1e3) if run else NOTHING for p in PHASES]
        rows.append([world, *phases, value(run and 1e3 * run.planning_mean, 1),
                     value(run and 1e3 * run.planning_max, 1), both,
                     value(run and paper.UAV_PLANNING[world] / max(run.planning_mean, 1e-9), 0, "×"),
                     mean_of(beside, 1, 1e3)])
    return table(["world", *PHASES, "planning, mean [ms]", "max", "paper, UAV and UGV", "paper's UAV / ours",
                  "mean of the runs side by side, 1 thread"], rows)


def engine_table(results):
    rows = []
    for world in WORLDS:
        fast = results.timed(world)
        for caster in CASTERS:
            run = results.timed(world, caster)
            if run:
                ratio = run.planning_mean / fast.planning_mean if fast and fast.planning_mean else None
                rows.append([world, caster, same(fast, run) if fast else NOTHING, str(run.steps),
                             percent(run.coverage[-1]), value(1e3 * run.planning_mean, 1),
                             value(1e3 * run.planning_max, 1), value(ratio, 2, "×"), value(run.wall, 0, " s")])
    return table(["world", "caster", "run", "steps", "coverage", "planning, mean [ms]", "max", "mean / fast's",
                  "whole run"], rows, texts=3)


def goal_table(results):
    rows = []
    for world in (*WORLDS, "all"):
        for variant in ("team", "cluster", "nearest"):
            runs = [r for w in (WORLDS if world == "all" else [world]) for r in results.of(w, variant)]
            rows.append([world, "method" if variant == "team" else VARIANTS[variant].title,
                         spread_of(spread(r.steps for r in runs), 1), steps_to_90(runs),
                         spread_of(spread(r.travelled()[-1] for r in runs), 0, 1, " m"),
                         spread_of(spread(r.length_to(0.9) for r in runs), 0, 1, " m")])
    return table(["world", "goals", "steps", "steps to 90 %", "path, all robots", "path to 90 %"], rows, texts=2)


def variant_table(results):
    rows = []
    for world in WORLDS:
        for name, variant in VARIANTS.items():
            runs = results.of(world, name)
            ends = [run.end for run in runs]
            rows.append([world, variant.title, spread_of(spread(r.coverage[-1] for r in runs), 1, 100, " %"),
                         mean_of(spread(r.coverage_box for r in runs), 1, 100, " %"),
                         mean_of(spread(r.steps for r in runs), 1), steps_to_90(runs),
                         mean_of(spread(r.travelled()[-1] for r in runs), 0, 1, " m"),
                         mean_of(spread(r.planning_mean for r in runs), 1, 1e3),
                         ", ".join(f"{ends.count(e)} × {plain(e)}" for e in sorted(set(ends))) or NOTHING,
                         value(sum(r.collisions for r in runs) if runs else None)])
    return table(["world", "variant", "coverage", "of the box", "steps", "steps to 90 %", "path, all robots",
                  "planning, mean [ms]", "ends", "collisions"], rows, texts=2)


def origin(results):
    def said(key):
        values = sorted({plain(run.facts.get(key, "unknown")) for run in results.runs.values()})
        return "; ".join(values) or "unknown"

    seeds = sorted({run.run.seed for run in results.runs.values() if not run.run.timed})
    return (f"{len(results.runs)} of {results.wanted} runs, seeds {', '.join(map(str, seeds)) or 'none'} (of world and "
            f"run alike), version {said('version')}, voxels of {said('resolution_m')} m, on {said('machine')}.")


def broken_list(results):
    if not results.broken:
        return "None.\n"
    return "".join(f"- {plain(name)}: {plain(reason)}\n" for name, reason in results.broken.items())


def document(results, images):
    """images: the figures' folder, as seen from the document."""
    def figure(name, title):
        return f"![{title}]({images}/{name}.svg)\n"

    return f"""\
# Results: the figures of the paper and ours

Written by `./dev reproduce`: {origin(results)}
Values are means over seeds; the team and the UAV alone have more seeds than the other variants. The smallest value, the
largest value and the standard deviation are in brackets. Coverage is of the observable space. Planning times are those
of one run in each world, alone on the machine, with 2 threads; all other times are those of runs with 1 thread, one run
on each core.

## What is not comparable

{NOT_COMPARABLE}

## What must hold

Computed from the runs. Coverage holds if the worst seed does.

{checklist(results)}
## Coverage and steps

{coverage_table(results)}
{figure("coverage_by_step", "Coverage against steps, for the team and each robot alone")}
## The team and each robot alone

The paper: 30 to 54 % fewer steps than the UAV alone; the UAV flies 1,147 m alone and 663 m in the team in one world.

{team_table(results)}
{figure("coverage_by_path", "Coverage against the length of all robots' paths")}
## Contributions

A voxel belongs to the robot that observed it first. Before: without optimisation. In the paper, assignment of
frontiers raises the efficiency of the UAV by 24 % in the factory; coverage per 100 m is one reading of that.

{contribution_table(results)}
{figure("contributions", "What each robot observed first, against steps")}
## Path optimisation

Frontiers in view of the UAV's path in a step, with yaws along the path (before) and optimised yaws (after), and
frontiers that its scans made known. Means over steps with a path.

{optimisation_table(results)}
## Planning time

Mean of each phase, in ms per step, both robots.

{planning_table(results)}
{figure("planning_time", "Planning time of each step, by phase")}
## The ray casters

The same runs with other casters. The rounding of the octomap caster leads to other decisions; planning times are
compared per step.

{engine_table(results)}
## Goals

{goal_table(results)}
{figure("goals", "Coverage against steps, by how goals are chosen")}
## Every variant

{variant_table(results)}
## Runs that failed or are missing

{broken_list(results)}"""
