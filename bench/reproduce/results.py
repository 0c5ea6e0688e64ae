"""Results of runs: files that are kept, rows that are published, and what tables ask of them."""

import json
import math
import os
from collections import Counter
from pathlib import Path

from rows import KINDS, curve_of, row_of, run_of, same_everywhere, total

FORMAT = 1
BY_ITSELF = ("low_gain", "nothing_to_do", "coverage", "cut_off")


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
        ("wall_s", "planning_mean_s", "planning_p99_s", "planning_max_s"), absent_or(number)),
        planning_p99_halves_s=absent_or(lambda value: some(number)(value) and len(value) == 2)))
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


def is_published(published, run, declared, programs):
    """is_kept(), of rows."""
    row, _ = published.get(run, (None, None))
    return row is not None and row["declared"] == declared and row["program"] in programs and not row["failure"]


def joined(*texts):
    """Each once."""
    return "; ".join(dict.fromkeys(filter(None, texts))) or None


def failed_before(folder, run, task, program):
    """How earlier attempts at this very run by this program ended in no result, or nothing."""
    try:
        result = read_result(folder / f"{run.name}.json")
    except (OSError, ValueError):
        return None
    if result["task"] != task or result["measured"].get("program") != program:
        return None
    return joined(result["measured"].get("failed_before"), result.get("failure"))


def programs_in(folder):
    """Of the results in a folder."""
    programs = set()
    for file in folder.glob("*.json"):
        try:
            programs.add(read_result(file)["measured"].get("program"))
        except (OSError, ValueError):
            pass
    return programs - {None}


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
    """Of one run: its row, and what follows from it. Seconds and metres are None where it did not get so far."""

    def __init__(self, row, curve, complete):
        self.run, self.row, self.curve, self.complete = run_of(row), row, curve, complete
        self.failure = row["failure"] or self.why_incomplete()

    def __getitem__(self, column):
        return self.row[column]

    def after(self, others):
        """With how these attempts at it crashed or hung."""
        failures = joined(self["failed_before"], *(text for r in others for text in (r["failed_before"], r["failure"])))
        return Result({**self.row, "failed_before": failures}, self.curve, self.complete)

    def why_incomplete(self):
        """A robot that was cut off from what is left to see is no failure once the world is mapped."""
        end = self["end"]
        if end not in BY_ITSELF:
            return f"{end} at {100 * self.coverage:.1f} %"
        return f"ended at {100 * self.coverage:.1f} % ({end})" if self.coverage < self.complete else None

    @property
    def ended_early(self):
        """By its own rule, before the world counted as mapped."""
        return self["end"] in BY_ITSELF and self.coverage < self.complete

    @property
    def crashed(self):
        """It has left no numbers at all."""
        return self["failure"] is not None

    @property
    def coverage(self):
        return self["coverage_observable"]

    def seconds(self, level):
        """To 50, 90, 95 or 99 % of the observable space, or to the end."""
        return self[f"s_to_{level}"]

    @property
    def seconds_mapped(self):
        """Until the world counts as mapped; infinite if it never did, whatever ended the run."""
        return self.until(f"{100 * self.complete:.0f}")

    def until(self, level):
        """seconds(), infinite if it never got there."""
        seconds = self.seconds(level)
        return math.inf if seconds is None else seconds

    @property
    def steps_to_90(self):
        """Without the look around at the start; infinite if it never got there."""
        steps = self["steps_to_90"]
        return math.inf if steps is None else steps

    @property
    def metres_mapped(self):
        """Of all robots, until the world counts as mapped; infinite if it never did."""
        metres = self["m_mapped"]
        return math.inf if metres is None else metres

    @property
    def uavs_metres_mapped(self):
        """Until the world counts as mapped; infinite if it never did."""
        metres = self["m_uav_mapped"]
        return math.inf if metres is None else metres

    def metres(self, kind=None):
        """By all robots, or those of a kind, to the end."""
        return total({k: self[f"m_{k}"] or 0.0 for k in KINDS if kind in (None, k)})

    def share(self, kind):
        """The part of all that was mapped that robots of a kind mapped first."""
        first = {k: self[f"first_{k}"] or 0.0 for k in KINDS}
        return first[kind] / total(first) if total(first) else None

    def efficiency(self, kind):
        """Percent of the observable space that robots of a kind mapped first, per 100 m of their path."""
        metres = self.metres(kind)
        return 1e4 * (self[f"first_{kind}"] or 0.0) / metres if metres else None


class Results:
    """Of all wanted runs those that one program has made, if none is given that of most runs, or those that are given as
    like it, in files or published; how many are of others, and what is missing or broken."""

    def __init__(self, experiments, runs, folder, like=(), program=None, published=None):
        self.experiments, self.wanted, self.broken, self.outdated = experiments, list(runs), {}, 0
        read, wanted = {}, {*self.wanted}  # of each run those of each program
        for run, (row, curve) in (published or {}).items():
            if run in wanted and row["declared"] == experiments.declaration(run):
                read.setdefault(run, {})[row["program"]] = Result(row, curve, experiments.complete(run))
            else:
                self.outdated += 1
        for run in self.wanted:
            try:
                result = self.read_file(run, folder / f"{run.name}.json")
            except FileNotFoundError:
                continue
            except (OSError, ValueError) as error:
                if run not in read:
                    self.broken[run.name] = str(error)
                continue
            others = read.setdefault(run, {})
            others[result["program"]] = self.merged(others[result["program"]], result) if result["program"] in others else result
        programs = Counter(p for results in read.values() for p in results)
        if program is None:
            program = max(sorted({*programs} - {*like} or programs), key=programs.get, default=None)
        self.programs = [program, *sorted(({*like} & {*programs}) - {program})]
        self.all, self.of_others = {}, 0
        for run in self.wanted:
            results = read.get(run, {})
            # Which program is faster its decisions do not say.
            usable = [results[p] for p in (self.programs[:1] if run.timed else self.programs) if p in results]
            if usable:
                used = next((r for r in usable if not r.crashed), usable[0])
                self.all[run] = used.after(r for r in usable if r is not used)
            self.of_others += bool(results) and not {*results} & {*self.programs}

    def read_file(self, run, file):
        """Raises OSError, or ValueError if it is not the result of this very run."""
        content, complete = read_result(file), self.experiments.complete(run)
        row = row_of(run, content, complete)
        if row["declared"] != self.experiments.declaration(run):
            raise ValueError(f"{file} is of another declaration of this run; run it again")
        return Result(row, curve_of(content), complete)

    def merged(self, row, file):
        """Of one program, published and in a file: what is published stays, unless only the file has an outcome."""
        kept, other = (file, row) if row.crashed else (row, file)
        if not kept.crashed and not other.crashed and kept["outcome"] != other["outcome"]:
            self.broken[row.run.name] = "it is published with another outcome by the same program; find out which one is right"
        failures = joined(other["failed_before"], other["failure"], kept["failed_before"]) if not kept.crashed else kept["failed_before"]
        return Result({**kept.row, "failed_before": failures}, kept.curve, kept.complete)

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
