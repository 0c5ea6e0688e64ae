"""Results of runs: files that are kept, and what tables ask of them."""

import json
import os
from pathlib import Path

from explore import kind_of

FORMAT = 1
BY_ITSELF = ("low_gain", "nothing_to_do", "coverage")
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


def refuse_constant(name):
    raise ValueError(f"{name} is not a number")


def read_result(file):
    """Raises OSError, or ValueError for what write_result() has not written."""
    try:
        result = json.loads(Path(file).read_text(encoding="utf-8"), parse_constant=refuse_constant)
        whole = result["format"] == FORMAT and isinstance(result["task"], dict) and isinstance(result["version"], str) \
            and isinstance(result["measured"], dict)
        if whole and "failure" not in result:
            end = result["curve"][-1]
            facts, number = result["facts"], (int, float)
            whole = isinstance(facts["end"], str) and isinstance(facts["time_s"]["end"], number) \
                and 0 <= facts["coverage_observable"] <= 1 and isinstance(result["gains"], dict) \
                and all(isinstance(end[member], kind) for member, kind in
                        (("time_s", number), ("coverage", number), ("length_m", dict), ("first", dict)))
    except (KeyError, IndexError, TypeError, RecursionError) as error:
        raise ValueError(f"{file} is not the result of a run: {error!r}") from error
    except ValueError as error:
        raise ValueError(f"{file} is not the result of a run: {error}") from error
    if not whole:
        raise ValueError(f"{file} is not the result of a run of this version")
    return result


def is_kept(folder, run, task, version):
    """Whether this very run has a result. A failed run is done again."""
    try:
        result = read_result(folder / f"{run.name}.json")
    except (OSError, ValueError):
        return False
    return result["task"] == task and result["version"] == version and "failure" not in result


class Result:
    """Of one run. Times and metres are None where it did not get so far."""

    def __init__(self, run, content, complete):
        self.run, self.content, self.measured = run, content, content["measured"]
        self.facts, self.curve = content.get("facts", {}), content.get("curve", [])
        self.failure = content.get("failure") or self.why_incomplete(complete)

    def why_incomplete(self, complete):
        end, coverage = self.facts["end"], self.facts["coverage_observable"]
        if end not in BY_ITSELF:
            return f"{end} at {100 * coverage:.1f} %"
        return f"ended at {100 * coverage:.1f} % ({end})" if coverage < complete else None

    @property
    def coverage(self):
        return self.facts["coverage_observable"]

    def seconds(self, level):
        """To 50, 90, 95 or 99 % of the observable space, or to the end."""
        return self.facts["time_s"].get(level)

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
        robots = [r for name, r in (self.facts.get("by_robot") or {}).items() if kind_of(name) == kind and "revisited" in r]
        metres = sum(r["length_m"] for r in robots)
        return sum(r["revisited"] * r["length_m"] for r in robots) / metres if metres else None

    def efficiency(self, kind):
        """Percent of the observable space that robots of a kind mapped first, per 100 m of their path."""
        metres = self.metres(kind)
        return 1e4 * self.curve[-1]["first"].get(kind, 0.0) / metres if metres else None

    def gain(self, kind, column):
        return self.content["gains"].get(kind, {}).get(column)

    @property
    def same_everywhere(self):
        """What does not depend on the machine, nor on what the run is called."""
        return {key: self.content.get(key) for key in ("failure", "facts", "gains", "curve")}


class Results:
    """Of all wanted runs: those that are there, and what is missing or broken."""

    def __init__(self, experiments, runs, folder):
        self.experiments, self.wanted, self.all, self.broken = experiments, list(runs), {}, {}
        for run in self.wanted:
            file = folder / f"{run.name}.json"
            try:
                content = read_result(file)
                if content["task"] != experiments.task_file(run):
                    raise ValueError(f"{file} is of another declaration of this run; run it again")
                self.all[run] = Result(run, content, experiments.complete(run))
            except FileNotFoundError:
                pass
            except (OSError, ValueError) as error:
                self.broken[run.name] = str(error)

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
        """Of runs of two methods with the same seed that are both done, and the numbers of seeds that were lost
        because the one or the other failed."""
        others = {r.run.seed: r for r in self.of(task, other)}
        both = [(r, others[r.run.seed]) for r in self.of(task, method) if r.run.seed in others]
        return ([(a, b) for a, b in both if not a.failure and not b.failure],
                sum(bool(a.failure) for a, _ in both), sum(bool(b.failure) for _, b in both))

    def tasks(self, of_files=None):
        """In the declaration's order, those that have runs."""
        there = {run.task for run in self.all}
        return [t for t in self.experiments.tasks if t in there
                and of_files in (None, self.experiments.file_of(t) is not None)]

    def methods(self, task, prefix=""):
        there = {run.method for run in self.all if run.task == task and not run.timed}
        return [m for m in self.experiments.methods if m in there and m.startswith(prefix)]
