"""Calls everything in the Python module at random, with arguments that fit and that do not: exceptions are answers,
a crash is none. misuse_test.py [SECONDS [SEED]]"""
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

SECONDS = float(sys.argv[1]) if len(sys.argv) > 1 else 10
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
        self.calls = self.answers = 0

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

    def arguments(self, function):
        """Of the right number, mostly; some by name."""
        signature = (function.__doc__ or "").split("\n")[0]
        names = [part.split(":")[0].strip() for part in signature[signature.find("(") + 1:].split(",") if ":" in part]
        names = [name for name in names if name.isidentifier() and (name != "self" or not inspect.ismethod(function))]
        values = [self.value() for _ in names]
        if self.random.random() < 0.1:
            return [self.value() for _ in range(self.random.randrange(6))], {}
        kept = len(names) if self.random.random() < 0.7 else self.random.randrange(len(names) + 1)
        return values[:kept], dict(zip(names[kept:], values[kept:])) if self.random.random() < 0.3 else {}

    def step(self):
        choose = self.random.random()
        if choose < 0.1:
            kind = self.random.choice(KINDS)
            made = kind.__new__(kind) if self.random.random() < 0.2 else None
            function = kind if made is None else getattr(made, "__init__")
            args, kwargs = self.arguments(kind.__init__)
        elif choose < 0.15:
            function = self.random.choice(FUNCTIONS)
            args, kwargs = self.arguments(function)
        else:
            one = self.random.choice(self.objects)
            name = self.random.choice([n for n in dir(type(one)) if not n.startswith("__") or
                                       n in ("__eq__", "__len__", "__init__", "__copy__")])
            if name == "write":
                return
            # Of the object, or of its class with anything for self.
            member = getattr(one if self.random.random() < 0.9 else type(one), name)
            if not callable(member):
                self.keep(member)
                return
            function = member
            args, kwargs = self.arguments(member)
        self.calls += 1
        result = function(*args, **kwargs)
        self.answers += 1
        self.keep(result)

    def keep(self, result):
        if isinstance(result, tuple(KINDS)):
            if len(self.objects) > 200:
                self.objects[self.random.randrange(20, 200)] = result
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


def run(misuse, end):
    while time.monotonic() < end:
        try:
            misuse.step()
        except EXPECTED:
            pass


def main():
    print(f"seed {SEED}", flush=True)
    warnings.simplefilter("ignore")  # numpy's, about numbers that do not fit
    objects = first_objects()
    users = [Misuse(SEED + i, objects) for i in range(3)]  # threads that share their objects
    end = time.monotonic() + SECONDS
    threads = [threading.Thread(target=run, args=(user, end)) for user in users[1:]]
    for thread in threads:
        thread.start()
    run(users[0], end)
    for thread in threads:
        thread.join()
    calls, answers = sum(user.calls for user in users), sum(user.answers for user in users)
    print(f"{calls} calls, {answers} of them with an answer and no exception")
    if not calls > answers > calls / 100:
        sys.exit("that tests nothing")


if __name__ == "__main__":
    main()
