"""The runs that experiments.json declares: each is one task file for `frontlux explore`."""

import hashlib
import json
from pathlib import Path
from typing import NamedTuple

DECLARED = Path(__file__).resolve().parent / "experiments.json"
FIRST_SEED = 201  # what comes before is for choosing and trying, or has been looked at
COMPLETE = 0.99  # of the observable space, unless the task says otherwise
COMPLETES = (0.9, 0.95, 0.99)  # parts for which runs say when they had mapped them
FIRST_PASS = 2  # seeds of each block that come before all others, unless it says otherwise
# What shows a method, and whether it is shown against another one.
TABLES = {"main": False, "lock-step": False, "controls": False, "why": True, "reality": True, "bumpers": True, "caster": True}


class Run(NamedTuple):
    task: str
    method: str
    seed: int
    timed: bool = False  # alone on the machine, with two threads

    @property
    def name(self):
        return f"{self.task}-{self.method}-{self.seed}" + ("-timed" if self.timed else "")


def merged(one, other):
    """`other` wins; its nulls remove members."""
    result = dict(one)
    for key, value in other.items():
        if value is None:
            result.pop(key, None)
        elif isinstance(value, dict) and isinstance(result.get(key), dict):
            result[key] = merged(result[key], value)
        else:
            result[key] = value
    return result


def digest(value):
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:12]


def declaration(task, complete):
    """A digest of what a run is, and of when its world counts as mapped."""
    return digest([task, complete])


class Experiments:
    """All that is declared; raises ValueError, with the file and the value, for what is wrong."""

    def __init__(self, file=DECLARED):
        self.file = file
        try:
            self.declared = json.loads(Path(file).read_text(encoding="utf-8"))
            self.tasks, self.methods, self.sets = (self.declared[k] for k in ("tasks", "methods", "sets"))
            self.common, self.robots, self.seed_offset, self.start_shifts = (
                self.declared[k] for k in ("common", "robots", "seed_offset", "start_shifts"))
        except KeyError as error:
            raise ValueError(f"{file}: the member {error} is missing; add it") from error
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from error
        try:
            self.check_methods()
            for name in self.sets:
                for run in self.runs(name):
                    self.task_file(run)
                    if self.complete(run) not in COMPLETES:
                        raise self.wrong(f"{run.task} or {run.method} is complete at {self.complete(run)}",
                                         f"give one of {', '.join(map(str, COMPLETES))}")
            self.rows = {run[:2] for name in self.sets for run in self.runs(name) if not run.timed}
        except (KeyError, TypeError, AttributeError) as error:
            raise self.wrong(f"a task, a method or a block of a set lacks a member, or has one of another type ({error})",
                             "docs/reproducing.md says what they have") from error

    def wrong(self, what, do):
        return ValueError(f"{self.file}: {what}; {do}")

    def check_methods(self):
        for name, method in self.methods.items():
            if method.get("table") not in TABLES:
                raise self.wrong(f"method {name!r} is in table {method.get('table')!r}",
                                 f"give one that the page has: {', '.join(TABLES)}")
            if TABLES[method["table"]] != ("against" in method) or method.get("against", name) not in self.methods:
                raise self.wrong(f"method {name!r} is in table {method['table']!r} against {method.get('against')!r}",
                                 "give the method that it changes, or leave it out for " +
                                 ", ".join(name for name, against in TABLES.items() if not against))

    def runs(self, set_name):
        """Of each block the `first` few seeds, then the others; in each block seed by seed, so that an early end leaves
        pairs to compare."""
        if set_name not in self.sets:
            raise self.wrong(f"there is no set {set_name!r}", f"there are {', '.join(self.sets)}")
        passes = [], []
        for block in self.sets[set_name]:
            for kind, known in (("tasks", self.tasks), ("methods", self.methods)):
                for name in block[kind]:
                    if name not in known:
                        raise self.wrong(f"{kind[:-1]} {name!r} of set {set_name!r} is not declared",
                                         f"there are {', '.join(known)}")
            first, last = block["seeds"]
            if not FIRST_SEED <= first <= last:
                raise self.wrong(f"seeds of set {set_name!r} are {first} to {last}",
                                 f"give a first one from {FIRST_SEED} on and a last one that is not before it")
            for seed in range(first, last + 1):
                passes[seed >= first + block.get("first", FIRST_PASS)].extend(
                    Run(task, method, seed, set_name == "timed") for task in block["tasks"] for method in block["methods"])
        return list(dict.fromkeys(passes[0] + passes[1]))

    def tasks_of(self, of_files=None):
        """In the declaration's order: all, or those with built-in worlds, or those with worlds from files."""
        return [t for t in self.tasks if of_files in (None, self.file_of(t) is not None)]

    def methods_of(self, table=None, against=None):
        return [name for name, method in self.methods.items()
                if table in (None, method["table"]) and against in (None, method.get("against"))]

    def bases(self, table):
        """The methods that those of a table are shown against."""
        return list(dict.fromkeys(self.methods[m]["against"] for m in self.methods_of(table)))

    def declared_tasks(self, *methods):
        """Those that all of the methods are run on."""
        return [t for t in self.tasks if all((t, m) in self.rows for m in methods)]

    def file_of(self, task):
        """The name of the world's file; None for built-in worlds."""
        return self.tasks[task].get("file")

    def complete(self, run):
        """How much of the observable space the run has to map, or it has failed."""
        return min(self.tasks[run.task].get("complete", COMPLETE), self.methods[run.method].get("complete", COMPLETE))

    def declaration(self, run):
        return declaration(self.task_file(run), self.complete(run))

    def level(self, task):
        """complete() in percent, of what is in motion."""
        return f"{100 * self.tasks[task].get('complete', COMPLETE):.0f}"

    def task_title(self, task):
        return self.tasks[task]["title"]

    def title(self, method):
        return self.methods[method]["title"]

    def team(self, words, faster):
        """The robots that 3uav+ugv stands for, with some limits by factors of what they are."""
        robots = []
        for word in words.split("+"):
            name = word.lstrip("0123456789")
            if name not in self.robots:
                raise self.wrong(f"robot {name!r} of team {words!r} is not declared", f"there are {', '.join(self.robots)}")
            robot = self.robots[name]
            limits = {limit: factor * robot["limits"][limit] for limit, factor in faster.items()}
            robots += [merged(robot, {"limits": limits})] * int(word.removesuffix(name) or 1)
        return robots

    def task_file(self, run):
        """What the run is, with the name and the hash of the world's file instead of its path."""
        declared = self.tasks[run.task]
        task = merged(merged(self.common, declared.get("task", {})), self.methods[run.method]["task"])
        task["name"], task["seed"] = run.name, run.seed + self.seed_offset
        if "team" in task and not task.get("lockstep"):
            task["robots"] = self.team(task.pop("team"), self.methods[run.method].get("faster", {}))
        if self.file_of(run.task) is None:
            return {**task, "world_seed": run.seed}
        shift = self.start_shifts[(run.seed - FIRST_SEED) % len(self.start_shifts)]
        start = [round(p + d, 3) for p, d in zip(declared["start"], shift)] + declared["start"][2:]
        if len(start) == 4:  # with a yaw
            task["robots"] = [{**task["robots"][0], "start": start}, *task["robots"][1:]]
        else:
            task = merged(task, {"options": {"start": ",".join(map(str, start))}})
        return {**task, "world": self.file_of(run.task), "world_sha256": declared["sha256"]}
