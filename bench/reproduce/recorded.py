"""A recorded run, checked, and the numbers for the tables."""

import csv
import math
import statistics
from typing import NamedTuple

from runs import STEP_LIMIT, is_finished, kind_of, read_facts

PHASES = ("frontiers", "caster", "goals", "paths", "optimization")
FRACTIONS = ("coverage_observable", "coverage_box", "robot_observable", "robot_box")
TIMES = tuple(f"{phase}_s" for phase in PHASES) + ("planning_s", "moving_s")
COUNTS = ("viewpoints", "collisions", "gain_tangent", "gain_predicted", "gained")
LENGTHS = ("length_m", "travelled_m")
LARGEST = 1e15  # no count and no measurement is larger


def number(value, what, high=LARGEST):
    """A number from 0 to `high`, from text or JSON; raises ValueError otherwise."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise ValueError(f"{what} is {value!r}, not a number")
    try:
        result = float(value)
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{what} is {str(value)[:40]!r}, not a number") from error
    if not 0.0 <= result <= high:
        raise ValueError(f"{what} is {result}, not within 0 and {high:g}")
    return result


class Recorded:
    """Steps are counted from 0, the scan at the start; lists are by step."""

    def __init__(self, run, folder):
        """Raises OSError or ValueError if the run is missing, not finished or incomplete."""
        self.run = run
        self.facts = read_facts(folder)
        if not is_finished(self.facts):
            raise ValueError("not finished")
        self.end = self.facts["end"]
        self.planning_mean = number(self.facts.get("planning_mean_s"), "planning_mean_s")
        self.planning_max = number(self.facts.get("planning_max_s"), "planning_max_s")
        self.wall = number(self.facts.get("wall_s"), "wall_s")
        self.memory = number(self.facts.get("memory_mb"), "memory_mb")
        self.collisions = number(self.facts.get("collisions"), "collisions")
        self.read_steps(folder / "steps.csv")
        if number(self.facts.get("steps"), "steps") not in (self.steps, self.steps + 1):
            raise ValueError(f"run.json has {self.facts['steps']} steps, steps.csv {self.steps}")

    def read_steps(self, file):
        with open(file, encoding="utf-8", newline="") as stream:
            reader = csv.reader(stream)
            header = next(reader, [])
            absent = [c for c in ("step", "robot", *FRACTIONS, *TIMES, *COUNTS, *LENGTHS) if c not in header]
            if absent:
                raise ValueError(f"steps.csv has no column {absent[0]}")
            self.cells = []
            for cells in reader:
                if len(cells) != len(header):
                    raise ValueError(f"line {reader.line_num} of steps.csv has {len(cells)} cells, not {len(header)}")
                self.cells.append(dict(zip(header, cells)))
        rows = [self.checked(row) for row in self.cells]
        self.robots = list(dict.fromkeys(row["robot"] for row in rows))
        order = [(i // max(len(self.robots), 1), self.robots[i % len(self.robots)]) for i in range(len(rows))]
        if not rows or len(rows) % len(self.robots) or [(r["step"], r["robot"]) for r in rows] != order:
            raise ValueError("steps.csv does not hold every robot in every step")
        self.by_step = [rows[i:i + len(self.robots)] for i in range(0, len(rows), len(self.robots))]
        self.steps = len(self.by_step) - 1

    @staticmethod
    def checked(row):
        result = {"robot": row["robot"], "step": number(row["step"], "step")}
        result.update((c, number(row[c], c, 1.0)) for c in FRACTIONS)
        result.update((c, number(row[c] or "0", c)) for c in (*TIMES, *COUNTS, *LENGTHS))
        return result

    def of_kind(self, kind):
        """Rows of the robots of that kind, by step."""
        return [[row for row in rows if kind_of(row["robot"]) == kind] for rows in self.by_step]

    @property
    def coverage(self):
        return [rows[0]["coverage_observable"] for rows in self.by_step]

    @property
    def coverage_box(self):
        return self.by_step[-1][0]["coverage_box"]

    def known_by(self, kind):
        return [sum(row["robot_observable"] for row in rows) for rows in self.of_kind(kind)]

    def fraction_of(self, kind):
        """The fraction of the known space of the whole run that robots of a kind observed first."""
        everything = sum(row["robot_observable"] for row in self.by_step[-1])
        return self.known_by(kind)[-1] / everything if everything else math.nan

    def travelled(self, kind=None):
        """[m] by all robots, or by those of a kind."""
        steps = self.by_step if kind is None else self.of_kind(kind)
        return [sum(row["travelled_m"] for row in rows) for rows in steps]

    def steps_to(self, coverage):
        """The first step with that coverage; None if there is none."""
        return next((step for step, value in enumerate(self.coverage) if value >= coverage), None)

    def steps_or_limit(self, coverage):
        found = self.steps_to(coverage)
        return found if found is not None else int(number(self.facts.get("max_steps", STEP_LIMIT), "max_steps"))

    def length_to(self, coverage):
        found = self.steps_to(coverage)
        return self.travelled()[found] if found is not None else None

    def seconds(self, column):
        """[s] of the planned steps, without step 0."""
        return [rows[0][column] for rows in self.by_step[1:]]

    def gains(self, kind, column):
        """Of the steps in which a robot of that kind had a path."""
        return [row[column] for rows in self.of_kind(kind)[1:] for row in rows if row["viewpoints"] > 0]


def first_difference(one, other):
    """The first step in which the runs differ, apart from times; None if they are the same."""
    def timeless(run):
        return [{c: v for c, v in row.items() if c not in TIMES} for row in run.cells]

    rows, others = timeless(one), timeless(other)
    for row, its in zip(rows, others):
        if row != its:
            return int(float(row["step"]))
    return None if len(rows) == len(others) else min(one.steps, other.steps) + 1


class Spread(NamedTuple):
    mean: float
    low: float
    high: float
    deviation: float  # of a sample; 0 for a single value
    count: int


def spread(values):
    """None if there are no values."""
    values = [v for v in values if v is not None and not math.isnan(v)]
    if not values:
        return None
    deviation = statistics.stdev(values) if len(values) > 1 else 0.0
    return Spread(statistics.fmean(values), min(values), max(values), deviation, len(values))


class Results:
    """All runs that could be read, and the errors of the others."""

    def __init__(self, runs, folder, failures):
        self.runs, self.broken = {}, {}
        self.wanted = len(runs)
        for run in runs:
            try:
                if run.name in failures:
                    raise ValueError(failures[run.name])
                self.runs[run] = Recorded(run, folder / run.name)
            except FileNotFoundError as error:
                self.broken[run.name] = f"{error.filename} is missing"
            except (OSError, ValueError, csv.Error) as error:
                self.broken[run.name] = str(error) or type(error).__name__

    def of(self, world, variant):
        return [r for r in self.runs.values() if (r.run.world, r.run.variant, r.run.timed) == (world, variant, False)]

    def timed(self, world, caster="fast"):
        return next((r for r in self.runs.values() if r.run.timed and (r.run.world, r.run.caster) == (world, caster)),
                    None)

    def pairs(self, variant, other, worlds):
        """Runs of two variants in the same world with the same seed."""
        there = {(r.run.world, r.run.seed): r for w in worlds for r in self.of(w, other)}
        return [(r, there[r.run.world, r.run.seed]) for w in worlds for r in self.of(w, variant)
                if (r.run.world, r.run.seed) in there]
