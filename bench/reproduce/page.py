"""docs/results.md: the results in short, what is compared, the main tables, why, the paper, limits."""

from collections import Counter

from claims import control_lines, our_lines, runs_in_motion, teams
from comparisons import NEEDED, NEEDED_OF_FILES, end_of, is_endless, needed, seconds_mapped, to_a_level
from explore import LONGEST
from experiments import FIRST_SEED
from intervals import FEWEST, LEVEL, RESAMPLES, mean
from markdown import as_first_word, counted, interval, plain
from paper_claims import MODES, paper_lines
from tables import (bumpers_table, failures_list, lines_table, maps_table, means, missing_table, optimisation_table, pairs_table,
                    planning_table, published_list, safety_table, steps_table, times_table, unseen_table, variants_table)
from verdicts import NOT_COMPARABLE, NOT_MEASURED, touching

MOST_IN_SHORT = 4  # lines that do not hold

METHODS = """\
- **tours** (`--goal tour`, the default): tours over all that is left to see, shared out to the robots. They end when
  nothing is left to see: no cluster of 1.5 m2 and more of which enough frontiers would be in view (10, but 0.3 to 0.9 m2).
- **view quality** (`--goal render`): one goal after the other, by eq. 1 and exact view quality. It ends when the gain
  that each robot expected of its last three goals was below 10 frontiers.
- **clusters** (`--goal cluster`): the same with other goals, and the same end.
- **nearest frontier** (`--goal nearest`): Yamauchi's, the nearest cluster of frontiers. It ends below 1 frontier instead
  of 10, since its goal is often a single one.
- **as printed, in motion** (`--mode paper`): the paper's method under the same clock. It ends below 1 frontier summed over
  viewpoints, so that it does not end by our choice. The paper leaves open how many frontiers are drawn (here 64), how much
  distance costs (here 0.139 per metre), how large clusters are (here 4.8 m) and more: [paper_map.md](paper_map.md) has what was chosen,
  and what does not come out may be due to that.

Any of them also ends when no robot finds a goal. **Since each ends by its own rule, methods are judged by the time until the world
counts as mapped**: 99 % of the observable space, 90 % of the hospital's. The time to the end stands beside it.

All have the same map, sensors, robots, limits and clock. The paper's tables further down are in lock-step, Alg. 1 as
printed (`--mode paper --lockstep`). There view quality differs from that in motion by more than the clock: sensors measure
only at viewpoints, with more rays, robots stop at each viewpoint and wait for each other, and goals nearer than 4 m
(2 m in motion) lose value."""

LIMITS = f"""\
- Worlds are simulated: nothing moves in them, and sensors, poses, motions and messages have no errors unless a row says
  so. All robots plan with one map; maps that differ from robot to robot, and radios with a radius, are not simulated.
- In worlds of others nothing is random but the start, which is moved by up to 0.6 m: their intervals say how far
  that moves a result, not how other worlds would do.
- Bootstrap intervals of few values are too narrow: of normal values they hold the mean in about 87 % of cases for six,
  89 % for eight and 93 % for twenty, instead of {100 * LEVEL:.0f} %. Those by order are as wide as they have to be.
- Many lines are judged at once, each by itself: one interval in twenty is expected to miss.
- All rows of *Why* and *What reality adds* are compared with the same runs, so that luck in these moves all rows alike: many
  rows above 1 are not as many confirmations. What luck does shows the row in which nothing but luck changed.
- The observable space is the free space connected with the start and the surfaces around it, at the run's voxels. The
  paper does not define its coverage, and does not publish its worlds: ours have the same names and other sizes."""


def summary(lines):
    words = ("reproduced", "holds", "**not reproduced", "**does not hold", "open", NOT_COMPARABLE, NOT_MEASURED)
    counts = [(word.strip("*"), sum(line.verdict.startswith(word) for line in lines)) for word in words]
    return f"Of {len(lines)} lines: " + ", ".join(f"{n} {word}" for word, n in counts if n) + "."


def paper_summaries(lines):
    """Of the paper's method, and of what replaces it: one says nothing of the other."""
    return [(mode, summary(of_mode)) for mode in MODES if (of_mode := [line for line in lines if line.claim.startswith(f"{mode}, ")])]


def noticed_summary(lines):
    counts = {word: sum(line.verdict.startswith(word) for line in lines) for word in ("noticed", "open", "**missed", NOT_MEASURED)}
    return ", ".join(f"{n} {word.strip('*')}" for word, n in counts.items() if n) + "; *open* is what so few pairs cannot tell."


def origin(results):
    runs = results.all.values()
    versions = ", ".join(sorted({plain(r["version"]) for r in runs}))
    seeds = [run.seed for run in results.all]
    dates = sorted({r["date"] for r in runs if r["date"]})
    return (f"{len(runs)} of {len(results.wanted)} runs, seeds {min(seeds)} to {max(seeds)}, by version {versions}, "
            f"{named_programs(results)}" +
            (f", {plain(dates[0])}" + (f" to {plain(dates[-1])}" if len(dates) > 1 else "") if dates else ""))


def named_programs(results):
    program, *like = map(plain, results.programs)
    if not like:
        return f"program {program}"
    counts = Counter(plain(r["program"]) for r in results.all.values())
    return (f"program {program} ({counted(counts[program], 'run')}) and by what was given as like it: " +
            ", ".join(f"{p} ({counted(counts[p], 'run')})" for p in like))


def others_left_out(results):
    like = f" --like {','.join(results.programs[1:])}" if results.programs[1:] else ""
    return (f" Of other programs than {' and '.join(map(plain, results.programs))} there are {counted(results.of_others, 'run')}, which are left out "
            f"everywhere: the next `./dev reproduce{like}` makes them again.") if results.of_others else ""


def duration(results):
    """How long the runs took: with more workers the command took less."""
    seconds = [r["wall_s"] for r in results.all.values() if r["wall_s"] is not None]
    return f"{counted(len(seconds), 'run')} took {sum(seconds) / 3600:.1f} hours in all, one after the other"


def in_short(results, ours, papers):
    """Sentences of what has an interval, and how many lines hold, with the first ones that do not."""
    experiments = results.experiments

    def in_world(task, method, other, measure):
        pairs, title = len(results.pairs(task, method, other)), experiments.task_title(task)
        if pairs < FEWEST:
            return f"{title} has {pairs} of {counted(needed(results, task), 'pair')}"
        found = to_a_level(results, [task], method, other, measure).found
        if is_endless(found):
            return f"{title}: at least half of {experiments.title(other if found.value == 0 else method)} never got there"
        return f"{title} {interval(found, 2, unit='×')}"

    def against(said, method, other, measure):
        """World by world, if one has enough pairs: their mean, and what it shall be, is a line below."""
        worlds = [t for t in experiments.declared_tasks(method, other) if not experiments.file_of(t)]
        if all(len(results.pairs(t, method, other)) < FEWEST for t in worlds):
            return []
        return [f"{said}: {', '.join(in_world(t, method, other, measure) for t in worlds)}."]

    lines = [
        *against("Time until 99 % is mapped, tours by view quality", "tour", "render", seconds_mapped),
        *against("Tours by the paper's method in motion", "tour", "paper", seconds_mapped),
        *against("UAV and UGV by the UAV alone, with tours", "tour", "tour_uav", seconds_mapped)]
    for which, of_files in (("built-in worlds", False), ("worlds of others", True)):
        runs = [r for r in runs_in_motion(results, teams(results), results.tasks(of_files)) if not r.crashed]
        if len(runs) >= FEWEST:
            touched = sum(r["contacts"] > 0 for r in runs)
            lines.append(f"With tours, without bumpers, in {which}: a body touched a surface in {touched} of {counted(len(runs), 'run')}; "
                         f"{touching(touched, len(runs))}, if runs are independent.")
    lines += against("Steps to 90 %, as printed, in lock-step, team by UAV alone", "steps", "steps_uav", lambda r: r.steps_to_90)
    for task in experiments.tasks_of(of_files=True):
        if published := experiments.tasks[task].get("published"):
            done = results.done(task, "tour")
            found = mean(map(end_of, done))
            if found and found.low is not None:
                lines.append(f"{plain(experiments.task_title(task))}: the end after {interval(found, 0, unit=' s')}, with tours, 99 % after "
                             f"{means(done, lambda r: r.seconds_mapped)} s; published to the end, of one video each, by another clock and rule: " +
                             ", ".join(f"{name} {low} to {high} s" for name, (low, high) in published["seconds"].items()) + ".")
    lines += [f"[What must hold](#what-must-hold): {summary(ours)}"]
    lines += [f"[The paper](#the-paper-line-by-line), {mode}: {said}" for mode, said in paper_summaries(papers)]
    failing = [line for line in ours if line.verdict.startswith("**does not hold")]
    lines += [f"Does not hold: {plain(line.claim)} ({plain(line.measured)})." for line in failing[:MOST_IN_SHORT]]
    if failing[MOST_IN_SHORT:]:
        lines.append(f"Nor do {counted(len(failing) - MOST_IN_SHORT, 'line')} more.")
    return "".join(f"- {line}\n" for line in lines) or "Too few runs for an interval.\n"


def page(results, images, rows, curves):
    """images, rows, curves: the figures' folder and the tables of all runs, as seen from the page."""
    built_in, others = results.tasks(of_files=False), results.tasks(of_files=True)
    ours, papers, spoilt = our_lines(results), paper_lines(results), control_lines(results)

    def figure(name, title):
        return f"![{title}]({images}/{name}.svg)\n"

    def of_each(kind, table):
        """A table for each method that has others against it, in as many pairs as an interval needs."""
        tables = {base: table(results, kind, base) for base in results.experiments.bases(kind)}
        return "\n".join(f"{as_first_word(results.experiments.title(base))}:\n\n{text}"
                         for base, text in tables.items() if "|" in text) or f"No world has {FEWEST} pairs yet.\n"

    in_lockstep = "\n".join((
        steps_table(results), figure("coverage_by_step", "Mapped part against steps, by team"),
        figure("contributions", "What each robot mapped first, against steps"),
        optimisation_table(results))) if any(results.methods(t, "lock-step") for t in built_in) else "No runs.\n"

    return f"""\
# Results

Written by `./dev reproduce` from {origin(results)}.
{duration(results)}. [{rows}]({rows}) has a row for each, and [{curves}]({curves}) what figures draw: what the page says of
runs is made of them alone, so more can be added anywhere ([reproducing.md](reproducing.md)). What is missing stands at the end of the page.

## Results in short

{in_short(results, ours, papers)}
## What is compared

{METHODS}

Robots, unless a row says otherwise: a UGV (1.0 m/s, lidar of 6 m, 480 x 32 rays at 4 Hz) and a UAV (1.5 m/s, camera of
10 m, 96 x 72 rays at 5 Hz), both with 2 m/s2 and 60 degrees/s, and margins of 0.05 and 0.025 m; voxels of 0.3 m; the clock charges 0.25 s for each
planning. By default `explore` has more rays at higher rates, 0.1 s and bumpers. In lock-step they are the built-in robots, with 720 x 32 and 160 x 120 rays and no margin. The offices have one
UAV of 2 m/s with a margin of 0.05 m, voxels of 0.1 m and 0.15 s. **No bumpers**: a body that touches a surface goes on, and that is a contact.
`bench/reproduce/experiments.json` declares all of it.

Nothing was chosen or tried on layouts from {FIRST_SEED} on, and no run on them had been looked at before this program was made. Worlds
of others were run while things were tried, four of the starts in complex office among them. Seed n is layout n with {results.experiments.seed_offset:,} + n for planner and sensors. Methods are compared
by pairs with the same seed; in brackets are {100 * LEVEL:.0f} % intervals, none for fewer than {FEWEST} values: of a median in one world by order (the true
median is between these two of the values, whatever their distribution), of a share of runs the exact binomial one, else by bootstrap ({RESAMPLES:,} resamples).

A run has **failed** if it crashed, hung ({LONGEST:,} s of the machine's time, so a far slower machine could fail it), reached a limit, or
ended with less than 99 % of the observable space mapped (hospital 90 %, the paper's steps 90 %). A robot that was cut off from
what is left to see is no failure once so much is mapped. A run that its machine lost is missing, not failed.

Times, steps and metres **to a level** are compared by the median of the pairs' ratios, of all runs: one that never got
there, whatever ended it, counts as later than any that did, and two that never did as alike (1). What is measured **at the end** is
compared by the ratio of means, of pairs of which neither run failed. Differences of times are medians of the pairs', by order. Several worlds count by the mean of their ratios.

## Main tables

Means of the runs that did not fail; "; 3 of 10" says that only these got to that level, and that it is their mean.

{times_table(results, built_in)}
{figure("coverage_by_time", "Mapped part of the observable space against seconds, by method")}
By pairs; with a ratio below 1, or below 0, tours are better.

{pairs_table(results)}
{figure("ratios", "Time until mapped of tours by that of the others, with intervals, and time to the end")}
Paths and safety: contacts, and those at which the map had all voxels around the body as free, since beams had passed the
surface that is in them; least clearance of a body to a surface and least distance of two bodies, of all runs; runs that ended with a
robot cut off.

{safety_table(results, built_in)}
What was not mapped is in view only of smaller robots (narrow), of none (hidden), or of these (in view), by estimates.

{unseen_table(results, built_in)}
## What must hold

{summary(ours)} *Open* is what these runs do not decide: a verdict needs
{NEEDED} pairs in each world ({NEEDED_OF_FILES} in worlds of others, where only the start differs), or so many runs (of planning times, and
of runs that are to be the same, as many as are declared). To be faster counts only where at most a tenth of the other's runs ended by their own rule too early.

{lines_table(ours)}
**Would they notice?** Lines of the same kinds about runs that are spoilt on purpose, judged by as few pairs as are declared of
these: none of them may hold. (What limits, planning times and sameness of runs would notice is tested with made-up runs.)

{noticed_summary(spoilt)}

{lines_table(spoilt)}
## Why

One thing changed at a time, by pairs with the method unchanged, in worlds with {FEWEST} pairs and more; above 1 the change costs. All rows have the
same runs without the change, so that they are not independent of each other; the first row is what luck alone does.

{of_each("why", variants_table)}
## What reality adds

Errors of sensors, poses, motions and messages, a robot that fails, and another sensor model; otherwise as above.

{of_each("reality", variants_table)}
What that does to the map, in points, by pairs with the same world and seed without it.

{of_each("reality", maps_table)}
## Contacts and bumpers

Without bumpers contacts are counted. With them, the default of `explore`, a robot that would touch a surface rests, and
that is counted as held back.

{bumpers_table(results)}
## Worlds of others

{times_table(results, others)}
{safety_table(results, others)}
{unseen_table(results, others)}
Published times to the end of others' planners, by their own clocks and rules:

{published_list(results.experiments)}
## The paper, line by line

{"".join(f"- {as_first_word(mode)}: {said}" + chr(10) for mode, said in paper_summaries(papers))}
In lock-step, once as printed, once with what replaces it by default (`--goal render --lockstep`). A change that the
paper prints is *reproduced* if the whole interval is at least half as large; *not reproduced* if the interval excludes one as large, or is of the
opposite; else *open*. A limit is reproduced if the whole interval keeps it. *Open*
is also what has too few pairs, as above. What is measured until 90 % counts runs that never got there as later than all others; shares, efficiencies and gains
are of all runs, whatever they mapped. The paper does not say of how many runs its numbers are.

{lines_table(papers)}
## The paper's tables

In lock-step; a voxel belongs to the robot that observed it first. Robots go in straight lines from viewpoint to viewpoint, and a run with a contact
is one in which a body touched a surface there.

{in_lockstep}
## Planning times

{planning_table(results)}
## Limits

{LIMITS}

## Failed runs

{failures_list(results)}
## Missing runs

Worlds of others are no part of this project, and are run where `--worlds` names their folder.{others_left_out(results)}

{missing_table(results)}"""
