"""Results of runs: files that are kept, and what tables ask of them."""

import json
import math
import os
from collections import Counter
from pathlib import Path

from explore import kind_of

FORMAT = 1
BY_ITSELF = ("low_gain", "nothing_to_do", "coverage", "cut_off")
LEVELS = ("50", "90", "95", "99", "end")


def write_result(folder, run, task, version, outcome):
    """Complete or not at all."""
    file = folder / f"{run.name}.json"
    unfinished = file.with_name(f"{file.name}.{os.getpid()}.unfinished")
    try:
        unfinished.write_text(json.dumps({"format": FORMAT, "task": task, "version": version, **outcome},
                                         sort_keys=True) + "\n", encoding="utf-8")
        unfinished.replace(file)
    finally:
        unfinished.unlink(missing_ok=True)


# What files have to hold: a kind is a function that says whether a value is of it.


def number(value):
    return type(value) in (int, float) and abs(value) < 1e15


def count(value):
    return type(value) is int and 0 <= value < 1e15


def part(value):
    return number(value) and 0 <= value <= 1


def text(value):
    return isinstance(value, str)


def absent_or(kind):
    return lambda value: value is None or kind(value)


def by_name(kind):
    return lambda value: isinstance(value, dict) and all(map(kind, value.values()))


def members(**kinds):
    """An object with these members and any others."""
    return lambda value: isinstance(value, dict) and all(kind(value.get(name)) for name, kind in kinds.items())


def some(kind):
    return lambda value: isinstance(value, list) and value and all(map(kind, value))


def object_(value):
    return isinstance(value, dict)


EVERY_RUN = members(
    format=lambda value: count(value) and value == FORMAT, task=object_, version=text,
    measured=members(program=absent_or(text), date=absent_or(text), **dict.fromkeys(
        ("wall_s", "planning_mean_s", "planning_p99_s", "planning_max_s"), absent_or(number))))
FAILED_RUN = members(failure=text)
FINISHED_RUN = members(
    facts=members(
        end=text, coverage_observable=part, steps=count, contacts=count, held_back=count,
        contacts_in_free=absent_or(count),
        time_s=lambda value: by_name(absent_or(number))(value) and number(value.get("end")),
        unseen=absent_or(members(narrow=number, hidden=number, in_view=number)),
        map=absent_or(members(false_free=number, false_occupied=number, surface_found=number)),
        by_robot=absent_or(by_name(members(length_m=number, revisited=absent_or(number)))),
        **dict.fromkeys(("auc", "clearance_min_m", "separation_min_m", "worst_of_limits"), absent_or(number))),
    gains=by_name(by_name(number)),
    curve=some(members(time_s=number, coverage=part, length_m=by_name(number), first=by_name(number))))


def refuse_constant(name):
    raise ValueError(f"{name} is not a number")


def read_result(file):
    """Raises OSError, or ValueError for what write_result() has not written."""
    try:
        result = json.loads(Path(file).read_text(encoding="utf-8"), parse_constant=refuse_constant)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{file} is not the result of a run: {error}") from error
    if not EVERY_RUN(result) or not (FAILED_RUN if "failure" in result else FINISHED_RUN)(result):
        raise ValueError(f"{file} is not the result of a run of this version")
    return result


def is_kept(folder, run, task, programs):
    """Whether one of these programs has made this very run. A failed run is done again."""
    try:
        result = read_result(folder / f"{run.name}.json")
    except (OSError, ValueError):
        return False
    return result["task"] == task and result["measured"].get("program") in programs and "failure" not in result


def programs_in(folder):
    """Of the results in a folder."""
    programs = set()
    for file in folder.glob("*.json"):
        try:
            programs.add(read_result(file)["measured"].get("program"))
        except (OSError, ValueError):
            pass
    return programs - {None}


def same_everywhere(result):
    """What does not depend on the machine, nor on what the run and its program are called."""
    facts = {key: value for key, value in result.get("facts", {}).items() if key != "version"}
    return {"facts": facts, **{key: result.get(key) for key in ("failure", "gains", "curve")}}


def unlike(folder, other):
    """How many runs are in two folders, and a line for each that is not the same in both, what was measured aside."""
    names = sorted({file.name for one in (folder, other) for file in one.glob("*.json")})
    lines = []
    for name in names:
        try:
            one, two = (read_result(where / name) for where in (folder, other))
        except FileNotFoundError as error:
            lines.append(f"{name}: not in {Path(error.filename).parent}")
            continue
        except (OSError, ValueError) as error:
            lines.append(str(error))
            continue
        one, two = ({"task": result["task"], **same_everywhere(result)} for result in (one, two))
        parts = [key for key in sorted(one) if one[key] != two[key]]
        if parts:
            lines.append(f"{name}: not the same {', '.join(parts)}")
    return len(names), lines


class Result:
    """Of one run. Seconds and metres are None where it did not get so far."""

    def __init__(self, run, content, complete):
        self.run, self.content, self.measured, self.complete = run, content, content["measured"], complete
        self.facts, self.curve = content.get("facts", {}), content.get("curve", [])
        self.program = self.measured.get("program") or "unknown"
        self.failure = content.get("failure") or self.why_incomplete()

    def why_incomplete(self):
        """A robot that was cut off from what is left to see is no failure once the world is mapped."""
        end = self.facts["end"]
        if end not in BY_ITSELF:
            return f"{end} at {100 * self.coverage:.1f} %"
        return f"ended at {100 * self.coverage:.1f} % ({end})" if self.coverage < self.complete else None

    @property
    def crashed(self):
        """It has left no numbers at all."""
        return not self.facts

    @property
    def coverage(self):
        return self.facts["coverage_observable"]

    def seconds(self, level):
        """To 50, 90, 95 or 99 % of the observable space, or to the end."""
        return self.facts.get("time_s", {}).get(level)

    @property
    def seconds_mapped(self):
        """Until the world counts as mapped; infinite if it never did, whatever ended the run."""
        return self.until(f"{100 * self.complete:.0f}")

    def until(self, level):
        """seconds(), infinite if it never got there."""
        seconds = self.seconds(level)
        return math.inf if seconds is None else seconds

    def steps_until(self, coverage):
        steps = self.steps(coverage)
        return math.inf if steps is None else steps

    @property
    def metres_mapped(self):
        """Of all robots, until the world counts as mapped; infinite if it never did."""
        metres = self.metres(None, self.complete)
        return math.inf if metres is None else metres

    def metres(self, kind=None, coverage=None):
        """By all robots, or those of a kind; to the end, or to that coverage."""
        row = self.curve[-1] if coverage is None else self.first_with(coverage)
        return None if row is None else sum(v for k, v in row["length_m"].items() if kind in (None, k))

    def first_with(self, coverage):
        return next((row for row in self.curve if row["coverage"] >= coverage), None)

    def steps(self, coverage=None):
        """Without the look around at the start."""
        if coverage is None:
            return len(self.curve) - 1
        return next((i for i, row in enumerate(self.curve) if row["coverage"] >= coverage), None)

    def share(self, kind):
        """The part of all that was mapped that robots of a kind mapped first."""
        first = self.curve[-1]["first"]
        return first.get(kind, 0.0) / sum(first.values()) if sum(first.values()) else None

    def revisited(self, kind):
        """The part of the path of robots of a kind that led to where they had been; None of runs before it was measured."""
        robots = [r for name, r in (self.facts.get("by_robot") or {}).items()
                  if kind_of(name) == kind and r.get("revisited") is not None]
        metres = sum(r["length_m"] for r in robots)
        return sum(r["revisited"] * r["length_m"] for r in robots) / metres if metres else None

    def efficiency(self, kind):
        """Percent of the observable space that robots of a kind mapped first, per 100 m of their path."""
        metres = self.metres(kind)
        return 1e4 * self.curve[-1]["first"].get(kind, 0.0) / metres if metres else None

    def gain(self, kind, column):
        return self.content["gains"].get(kind, {}).get(column)

    def map_error(self, kind):
        """One of false_free, false_occupied and surface_found."""
        return (self.facts.get("map") or {}).get(kind)


class Results:
    """Of all wanted runs those that one program has made, if none is given that of most runs, or those that are given as
    like it; how many are of others, and what is missing or broken."""

    def __init__(self, experiments, runs, folder, like=(), program=None):
        self.experiments, self.wanted, self.broken = experiments, list(runs), {}
        read = {}
        for run in self.wanted:
            file = folder / f"{run.name}.json"
            try:
                content = read_result(file)
                if content["task"] != experiments.task_file(run):
                    raise ValueError(f"{file} is of another declaration of this run; run it again")
                read[run] = Result(run, content, experiments.complete(run))
            except FileNotFoundError:
                pass
            except (OSError, ValueError) as error:
                self.broken[run.name] = str(error)
        programs = Counter(result.program for result in read.values())
        if program is None:
            program = max(sorted({*programs} - {*like} or programs), key=programs.get, default=None)
        self.programs = [program, *sorted(({*like} & {*programs}) - {program})]
        # Which program is faster its decisions do not say.
        self.all = {run: result for run, result in read.items()
                    if result.program in (self.programs[:1] if run.timed else self.programs)}
        self.of_others = sum(result.program not in self.programs for result in read.values())

    @property
    def missing(self):
        return [run for run in self.wanted if run not in self.all]

    def of(self, task, method, timed=False):
        """All runs, by seed."""
        key = (task, method, timed)
        return sorted((r for r in self.all.values() if (r.run.task, r.run.method, r.run.timed) == key),
                      key=lambda r: r.run.seed)

    def done(self, task, method):
        return [r for r in self.of(task, method) if not r.failure]

    def failed(self, task, method):
        return [r for r in self.of(task, method) if r.failure]

    def pairs(self, task, method, other):
        """Of runs of two methods with the same seed, failed ones as well."""
        others = {r.run.seed: r for r in self.of(task, other)}
        return [(r, others[r.run.seed]) for r in self.of(task, method) if r.run.seed in others]

    def done_pairs(self, task, method, other):
        return [(a, b) for a, b in self.pairs(task, method, other) if not a.failure and not b.failure]

    def tasks(self, of_files=None):
        """In the declaration's order, those that have runs."""
        there = {run.task for run in self.all}
        return [t for t in self.experiments.tasks_of(of_files) if t in there]

    def methods(self, task, table=None):
        """In the declaration's order, those that have runs: all, or those of a table."""
        there = {run.method for run in self.all if run.task == task and not run.timed}
        return [m for m in self.experiments.methods_of(table) if m in there]
