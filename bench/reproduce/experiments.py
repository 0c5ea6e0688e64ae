"""The runs that experiments.json declares: each is one task file for `frontlux explore`."""

import json
from pathlib import Path
from typing import NamedTuple

DECLARED = Path(__file__).resolve().parent / "experiments.json"
FIRST_SEED = 6  # parameters were fixed on seeds 1 to 5
COMPLETE = 0.99  # of the observable space, unless the task says otherwise


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
        for name in self.sets:
            for run in self.runs(name):
                self.task_file(run)

    def wrong(self, what, do):
        return ValueError(f"{self.file}: {what}; {do}")

    def runs(self, set_name):
        """In the order of the blocks, and in each seed by seed, so that an early end leaves pairs to compare."""
        if set_name not in self.sets:
            raise self.wrong(f"there is no set {set_name!r}", f"there are {', '.join(self.sets)}")
        runs = []
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
            runs += [Run(t, m, s, set_name == "timed") for s in range(first, last + 1) for t in block["tasks"]
                     for m in block["methods"]]
        return list(dict.fromkeys(runs))

    def file_of(self, task):
        """The name of the world's file; None for built-in worlds."""
        return self.tasks[task].get("file")

    def complete(self, run):
        """How much of the observable space the run has to map, or it has failed."""
        return min(self.tasks[run.task].get("complete", COMPLETE), self.methods[run.method].get("complete", COMPLETE))

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
        """What the run is, without the folder of the world's file."""
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
        return {**task, "world": self.file_of(run.task)}
