"""docs/results.md: what is compared, the main table, why, the paper, limits."""

from claims import our_lines, paper_lines
from explore import LONGEST
from intervals import FEWEST, LEVEL, RESAMPLES
from markdown import plain
from tables import (bumpers_table, failures_list, lines_table, main_table, maps_table, missing_table,
                    optimisation_table, pairs_table, planning_table, steps_table, variants_table)

METHODS = """\
- **tours** (`--goal tour`, the default): tours over all that is left to see, shared out to the robots.
- **view quality** (`--goal render`): one goal after the other, by eq. 1 and exact view quality.
- **clusters** and **nearest frontier** (`--goal cluster`, `--goal nearest`): the same with other goals; the nearest is
  Yamauchi's, the nearest cluster of frontiers.
- **as printed, in motion** (`--mode paper`): the paper's method under the same clock; it ends by its own rule, with a
  gain below 1 frontier summed over viewpoints, so that it does not end by our choice.

All have the same map, sensors, robots, limits and clock. The paper's tables further down are in lock-step, Alg. 1 as
printed (`--mode paper --lockstep`)."""

LIMITS = f"""\
- Worlds are simulated: nothing moves in them, sensors, poses and messages have no errors unless a row says so. All
  robots plan with one map; maps that differ from robot to robot, and radios with a radius, are not simulated.
- In worlds of others nothing is random but the start, which is moved by up to 0.6 m: their intervals say how far
  that moves a result, not how other worlds would do.
- Percentile intervals of few values are too narrow: of normal values they hold the mean in about 87 % of cases for six,
  89 % for eight and 93 % for twenty, instead of {100 * LEVEL:.0f} %.
- Many lines are judged at once, each by itself: among forty intervals two are expected to miss.
- The observable space is the free space connected with the start and the surfaces around it, at the run's voxels. The
  paper does not define its coverage, and does not publish its worlds: ours have the same names and other sizes."""


def summary(lines):
    words = ("reproduced", "holds", "**not reproduced", "**does not hold", "open", "not comparable", "not measured")
    counts = [(word.strip("*"), sum(line.verdict.startswith(word) for line in lines)) for word in words]
    return f"Of {len(lines)} lines: " + ", ".join(f"{n} {word}" for word, n in counts if n) + "."


def origin(results):
    runs = results.all.values()
    versions = ", ".join(sorted({plain(r.content["version"]) for r in runs}))
    builds = len({r.measured.get("program") for r in runs} - {None})
    seeds = [run.seed for run in results.all]
    return (f"{len(runs)} of {len(results.wanted)} runs, seeds {min(seeds)} to {max(seeds)}, version {versions}" +
            (f" ({builds} builds of it)" if builds > 1 else ""))


def page(results, images, runs):
    """images, runs: the figures' folder and the table of all runs, as seen from the page."""
    built_in, others = results.tasks(of_files=False), results.tasks(of_files=True)
    ours, papers = our_lines(results), paper_lines(results)

    def figure(name, title):
        return f"![{title}]({images}/{name}.svg)\n"

    return f"""\
# Results

Written by `./dev reproduce` from {origin(results)}.
[{runs}]({runs}) has a row for each run; [reproducing.md](reproducing.md) says how to make them. What is missing stands at
the end of the page.

## What is compared

{METHODS}

Robots, unless a row says otherwise: a UGV (1.0 m/s, lidar of 6 m, 480 x 32 rays at 4 Hz) and a UAV (1.5 m/s, camera of
10 m, 96 x 72 rays at 5 Hz), both with 2 m/s2 and 60 degrees/s; voxels of 0.3 m; the clock charges 0.25 s for each planning. In
lock-step they are the built-in robots, with 720 x 32 and 160 x 120 rays. The offices have one UAV of 2 m/s, voxels of
0.1 m and 0.15 s. **No bumpers**: a body that touches a surface goes on, and that is a contact.
`bench/reproduce/experiments.json` declares all of it.

Parameters were fixed on seeds 1 to 5. Seed n is layout n with {results.experiments.seed_offset:,} + n for planner and sensors. Methods are compared
by pairs with the same seed; in brackets are {100 * LEVEL:.0f} % bootstrap intervals ({RESAMPLES:,} resamples), none for fewer than {FEWEST} values. A run
has **failed** if it crashed, hung ({LONGEST:,} s of computing), was cut off, reached a limit, or ended with less than 99 % of the
observable space mapped (hospital 90 %, the paper's steps 90 %). A failed run enters no mean; its pair is lost, and that is counted.

## Main table

Means of the runs that did not fail; contacts, and those at which the map had all voxels around the body as free, since
beams had passed the surface that is in them; least clearance of a body to a surface and least distance of two bodies
of all runs. What was not mapped is in view only of smaller robots (narrow), of none (hidden), or of these (in view), by
estimates.

{main_table(results, built_in)}
{figure("coverage_by_time", "Mapped part of the observable space against seconds, by method")}
By pairs; below 0, or with a ratio below 1, tours are better.

{pairs_table(results)}
{figure("ratios", "Time to the end of tours by that of the others, with intervals")}
## What must hold

{summary(ours)} *Open* is what these runs do not decide.

{lines_table(ours)}
## Why

One thing changed at a time, by pairs with the method unchanged; above 1 the change costs. Tours:

{variants_table(results, "tour")}
View quality:

{variants_table(results, "render")}
## What reality adds

Errors of sensors, poses and messages, and a robot that fails, otherwise as above; tours:

{variants_table(results, "tour", of_reality=True)}
What that does to the map:

{maps_table(results, "tour")}
## Contacts and bumpers

Without bumpers contacts are counted. With them, the default of `explore`, a robot that would touch a surface rests, and
that is counted as held back.

{bumpers_table(results)}
## Worlds of others

{main_table(results, others)}
## The paper, line by line

{summary(papers)}

In lock-step, once as printed, once with what replaces it by default (`--goal render --lockstep`). A change that the paper prints is *reproduced* if there is one beyond chance, and the interval does not
exclude one as large as the paper's; a limit, if the whole interval keeps it; *open*, if failures took more than a tenth
of the pairs. The paper prints one run of each kind.

{lines_table(papers)}
## The paper's tables

In lock-step; a voxel belongs to the robot that observed it first.

{steps_table(results)}
{figure("coverage_by_step", "Mapped part against steps: team, UAV alone, UGV alone")}
{figure("contributions", "What each robot mapped first, against steps")}
{optimisation_table(results)}
## Planning times

{planning_table(results)}
## Limits

{LIMITS}

## Failed runs

{failures_list(results)}
## Missing runs

Worlds of others are no part of this project, and are run where `--worlds` names their folder.

{missing_table(results)}"""
