"""Calls everything in the Python module at random, with arguments that fit and that do not: exceptions are answers,
a crash is none. misuse_test.py [SECONDS [SEED]]"""
import collections
import inspect
import random
import sys
import threading
import time
import warnings

import numpy as np

import frontlux

try:
    from frontlux import planner
except ModuleNotFoundError:  # a build without it
    planner = None

SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 5
SEED = int(sys.argv[2]) if len(sys.argv) > 2 else 1
KINDS = [value for module in (frontlux, planner) if module is not None for value in vars(module).values()
         if inspect.isclass(value) and not issubclass(value, int)]
FUNCTIONS = [frontlux.best_window, frontlux.pinhole_directions, frontlux.instruction_set]
if planner is not None:
    FUNCTIONS += [planner.ugv, planner.uav]
EXPECTED = (TypeError, ValueError, RuntimeError, MemoryError, OverflowError, AttributeError, ZeroDivisionError)


class Misuse:
    def __init__(self, seed, objects):
        self.random, self.numpy, self.objects = random.Random(seed), np.random.default_rng(seed), objects
        self.kept = len(objects)
        self.time = 0.0  # of the planner's clocks
        self.calls, self.answers = 0, collections.Counter()

    def array(self):
        shape = self.random.choice([(), (3,), (0, 3), (7, 3), (7, 3), (7,), (2, 5, 3), (4, 4), (3, 3), (3, 4, 5), (7, 2)])
        kind = self.random.choice(["f4", "f8", "f8", "u2", "u2", "u1", "?", "i8", ">f4", "c16", "O", "U3", "M8[s]"])
        values = self.numpy.normal(size=shape) * self.random.choice([1, 1, 100, 1e4, 1e30])
        if kind[0] in "ui?":
            values = self.numpy.integers(0, self.random.choice([2, 3, 65536]), shape).astype("u2")
        if kind in ("f4", "f8") and values.ndim and self.random.random() < 0.2:
            values.flat[0:2] = self.random.choice([np.nan, np.inf, -np.inf, 0, 1e308])
        with np.errstate(all="ignore"):
            array = np.asarray(values).astype(kind) if kind != "M8[s]" else np.zeros(shape, kind)
        change = self.random.random()
        if change < 0.05 and array.ndim:
            array = np.repeat(array, 2, axis=0)[::2]
        elif change < 0.1:
            array = np.asfortranarray(array)
        elif change < 0.15:
            array.flags.writeable = False
        elif change < 0.2:
            array = np.broadcast_to(array, (2, *array.shape))
        return array

    def value(self):
        choose = self.random.random()
        if choose < 0.4:
            return self.array()
        if choose < 0.7 and self.objects:
            return self.random.choice(self.objects)
        if choose < 0.72 and self.objects:
            return [self.random.choice(self.objects) for _ in range(self.random.randrange(1, 3))]
        if choose < 0.75:
            names = ["stop", "state", "key", "end", "entry", "distance", "unknown", "free", "occupied", 3]
            return {self.random.choice(names): self.array() for _ in range(self.random.randrange(3))}
        return self.random.choice([None, True, 0, 1, -1, 2, 3, 7, 64, 2**31, 2**63, -2**63, 2**70, 0.1, 0.2, 0.5, 1.0, 1.5, -0.0,
                                   1e-300, 1e300, float("nan"), float("inf"), "block", "pass", "fast", "grid", "embree",
                                   "rays", "exact", "", "x\0y", b"bytes", (), (1, 2, 3), [0.0, 0.0, 1.0], [[1, 2], [3]],
                                   (32768, 32768, 32768), (32700, 32700, 32760), (1.0, 1.0, 1.0, 0.5),
                                   [[1.0, 1.0, 1.0, 0.0]], ((0.0, 0.0, 0.0), (3.0, 2.0, 2.0)), "plane", "space", "tour", "render",
                                   lambda *_: None, lambda *_: (np.eye(3), np.ones(3)), object(), int, print, 1j, {}, range(3)])

    def fitting(self, name):
        """What may well be taken for an argument of this name."""
        self.time += self.random.choice([0.0, 0.1, 0.5])
        pose = np.array([self.random.uniform(0.3, 2.7), self.random.uniform(0.3, 1.7), 1.0, self.random.uniform(-9, 9)])
        directions = frontlux.FieldOfView.spinning(1.0, 2.0).directions(16, 8)
        values = {"robot": 0, "pose": pose, "time": self.time, "times": self.time + self.numpy.uniform(-1, 3, 5),
                  "directions": directions, "ranges": self.numpy.uniform(0.1, 3, (8, 16)), "starts": pose[None], "blocked": None,
                  "points": self.numpy.normal(size=(50, 3)), "free_radius": 0.3, "bounds": ((0.0, 0.0, 0.0), (3.0, 2.0, 2.0)),
                  "resolution": 0.2, "method": "default", "goal": self.random.choice(["render", "nearest"]), "latency": 0.1,
                  "seed": 1, "period": 1.0, "epsilon": None, "max_steps": None,
                  "drive": lambda *_: (directions, self.numpy.uniform(0.1, 3, (8, 16)))}
        places, keys = self.numpy.uniform(0, 2, (2, 7, 3)), self.numpy.integers(32768, 32780, (7, 3)).astype(np.uint16)
        values |= {"origins": pose[:3], "origin": pose[:3], "max_range": 2.0, "unknown": self.random.choice(["block", "pass"]),
                   "from_points": places[0], "to_points": places[1], "out": None, "keys": keys, "viewpoints": keys, "targets": keys,
                   "renderer": "rays", "samples": 10, "azimuth_bins": 4, "kind": "fast", "columns": 4, "rows": 3, "offsets": places[0], "yaw": pose[3]}
        kinds = {"grid": "VoxelGrid", "caster": "RayCaster", "before": "VoxelGrid", "after": "VoxelGrid", "change": "MapChange", "view": "FieldOfView",
                 "field_of_view": "FieldOfView", "robots": "Robot"}
        if name in kinds:
            fitting = [one for one in self.objects if type(one).__name__ == kinds[name]]
            return fitting[:1] if name == "robots" else self.random.choice(fitting)
        return values[name] if name in values else self.value()

    def arguments(self, function):
        """Of the right number, mostly; some by name."""
        signature = (function.__doc__ or "").split("\n")[0]
        names = [part.split(":")[0].strip() for part in signature[signature.find("(") + 1:].split(",") if ":" in part]
        names = [name for name in names if name.isidentifier() and (name != "self" or not inspect.ismethod(function))]
        wild = self.random.choice([0.0, 0.2, 1.0])
        values = [self.value() if self.random.random() < wild else self.fitting(name) for name in names]
        if self.random.random() < 0.1:
            return [self.value() for _ in range(self.random.randrange(6))], {}
        kept = len(names) if self.random.random() < 0.7 else self.random.randrange(len(names) + 1)
        return values[:kept], dict(zip(names[kept:], values[kept:])) if self.random.random() < 0.3 else {}

    def step(self):
        choose, label = self.random.random(), ""
        if choose < 0.1:
            kind = self.random.choice(KINDS)
            made = kind.__new__(kind) if self.random.random() < 0.2 else None
            function = kind if made is None else getattr(made, "__init__")
            args, kwargs = self.arguments(kind.__init__)
        elif choose < 0.15:
            function = self.random.choice(FUNCTIONS)
            args, kwargs = self.arguments(function)
        else:
            kind = self.random.choice(KINDS)
            one = self.random.choice([one for one in self.objects if type(one) is kind] or self.objects)
            name = self.random.choice([n for n in dir(type(one)) if not n.startswith("__") or
                                       n in ("__eq__", "__len__", "__init__", "__copy__")])
            if name == "write":
                return
            # Of the object, or of its class with anything for self.
            member = getattr(one if self.random.random() < 0.9 else type(one), name)
            if not callable(member):
                self.keep(member)
                return
            function, label = member, f"{type(one).__name__}.{name}"
            args, kwargs = self.arguments(member)
        self.calls += 1
        result = function(*args, **kwargs)
        self.answers[label] += 1
        self.keep(result)

    def keep(self, result):
        if isinstance(result, tuple(KINDS)):
            if len(self.objects) > 200:
                self.objects[self.random.randrange(self.kept, 200)] = result
            else:
                self.objects.append(result)


def first_objects():
    states = np.random.default_rng(SEED).integers(0, 3, (12, 12, 12), np.uint8)
    grid = frontlux.VoxelGrid.from_occupancy(states, 0.2)
    live = frontlux.LiveMap(0.2)
    views = [frontlux.FieldOfView.spinning(0.5, 3.0), frontlux.FieldOfView.pyramid(1.0, 1.0, 2.0),
             frontlux.FieldOfView.cone(0.5, 2.0)]
    return [grid, frontlux.RayCaster(grid), frontlux.RayCaster(grid, "grid"), live, live.caster,
            live.insert(np.ones((5, 3)), (0, 0, 0)), *views, frontlux.FrontierSet(grid),
            *[frontlux.ViewQualityImage(0.2, view, "exact", azimuth_bins=4) for view in views],
            *[frontlux.ViewQualityImage(0.2, view) for view in views], *(first_explorations() if planner is not None else [])]


def first_explorations():
    """Some that have begun in a box of 3 x 2 x 2 m."""
    robot = planner.Robot("robot", "space", (0.3, 0.3, 0.3), frontlux.FieldOfView.spinning(1.0, 2.0), 16, 8)
    bounds, start = ((0.0, 0.0, 0.0), (3.0, 2.0, 2.0)), [[1.0, 1.0, 1.0, 0.0]]
    directions = robot.view.directions(16, 8)
    objects = [robot, planner.ContinuousExploration([robot], bounds, 0.2), planner.Exploration([robot], bounds, 0.2)]
    for goal in ("tour", "render"):
        exploration = planner.ContinuousExploration([robot], bounds, 0.2, goal)
        step = exploration.begin(start)
        exploration.insert(0, start[0], directions, np.full((8, 16), 0.7))
        plan = exploration.plan(0.0)
        objects += [exploration, step, plan, plan.trajectory]
    lockstep = planner.Exploration([robot], bounds, 0.2)
    lockstep.begin(start, lambda *_: (directions, np.full((8, 16), 0.7)))
    return [*objects, lockstep]


def run(misuse, end, failures):
    try:
        while time.monotonic() < end:
            try:
                misuse.step()
            except EXPECTED:
                pass
    except Exception as failure:  # which a thread would only print
        failures.append(failure)


def main():
    print(f"seed {SEED}", flush=True)
    warnings.simplefilter("ignore")  # numpy's, about numbers that do not fit
    objects = first_objects()
    users = [Misuse(SEED + i, objects) for i in range(3)]  # threads that share their objects
    end = time.monotonic() + SECONDS
    failures = []
    threads = [threading.Thread(target=run, args=(user, end, failures)) for user in users[1:]]
    for thread in threads:
        thread.start()
    run(users[0], end, failures)
    for thread in threads:
        thread.join()
    if failures:
        raise failures[0]
    calls, answered = sum(user.calls for user in users), sum((user.answers for user in users), collections.Counter())
    answers = answered.total()
    print(f"{calls} calls, {answers} of them with an answer and no exception")
    wanted = ["RayCaster.cast", "LiveMap.insert"]
    if planner is not None:
        wanted += ["ContinuousExploration.insert", "ContinuousExploration.plan", "Exploration.step", "Trajectory.at"]
    if not calls > answers > calls / 100 or not all(answered[name] for name in wanted):
        sys.exit(f"that tests nothing: {answered}")


if __name__ == "__main__":
    main()
