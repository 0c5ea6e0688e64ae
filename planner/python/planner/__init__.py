"""Robots that explore: scans go in as numpy arrays, trajectories come out. See docs/python.md."""
import math
import weakref

from ._planner import ContinuousExploration, Exploration, Plan, Robot, Step, Trajectory, uav, ugv

_TAKEN = weakref.WeakKeyDictionary()  # by an exploration's runs: of each robot, the number of scans


def run(exploration, sense, until=math.inf, planned=None):
    """Explores by a clock of its own, second by second: robots follow their trajectories exactly, and take scans at their rates.

    exploration: ContinuousExploration that has begun; it may plan after each scan, and where scans are rare every quarter of its
    `period`. sense(robot, pose, time): called for each scan with the robot's number,
    the pose of its sensor, float64 (4,), and the time [s]; returns (directions, ranges) as `insert` takes them, or None for no
    scan. Robots that are lost take none until they join again. until: [s] of the clock. planned(plan): called with each Plan. Exceptions of both end the
    run. Returns the time [s] of the last scan or, between scans, moment to plan; `exploration.time` if there was none.

    Scans are due at multiples of their periods since the exploration's begin, so that some runs one after the other are the same
    as one. What was due before `exploration.time` is left out; a scan whose `sense` raised an exception is due again.
    """
    if math.isnan(until):
        raise ValueError("until: not a number")
    begin, now = exploration.begin_time, exploration.time
    if begin is None:
        raise ValueError("the exploration has not begun: call begin first")
    rates = [robot.rate for robot in exploration.robots]
    taken = _TAKEN.setdefault(exploration, [0] * len(rates))

    def next_scan(robot):
        rate = rates[robot]
        taken[robot] = max(taken[robot], math.floor((now - begin) * rate) - 1)  # rounding may have added one
        while begin + taken[robot] / rate < now:
            taken[robot] += 1
        return begin + taken[robot] / rate

    while exploration.end is None:
        lost = exploration.lost
        due = {robot: next_scan(robot) for robot in range(len(rates)) if robot not in lost}
        earliest = min(due.values(), default=now)
        to_plan = now + exploration.period / 4
        moment = to_plan if to_plan < earliest - 1e-9 else earliest
        if due and moment > until:
            break
        now = moment
        for robot in [robot for robot, time in due.items() if time == now]:
            pose = exploration.at(robot, now)["pose"]
            scan = sense(robot, pose, now)
            if scan is not None:
                exploration.insert(robot, pose, *scan)
            taken[robot] += 1
        while exploration.end is None and (plan := exploration.plan(now)):
            if planned is not None:
                planned(plan)
        if not due:
            break
    return now
