"""Robots that explore: scans go in as numpy arrays, trajectories come out. See docs/python.md."""
import math

from ._planner import ContinuousExploration, Exploration, Plan, Robot, Step, Trajectory, uav, ugv


def run(exploration, sense, until=math.inf, planned=None):
    """Explores by a clock of its own, second by second: robots follow their trajectories exactly, and take scans at their rates.

    exploration: ContinuousExploration that has begun. sense(robot, pose, time): called for each scan with the robot's number,
    the pose of its sensor, float64 (4,), and the time [s]; returns (directions, ranges) as `insert` takes them, or None for no
    scan. until: [s] of the clock. planned(plan): called with each Plan. Exceptions of both end the run; it can go on with another
    call. Returns the time [s] of the last scan.
    """
    begin = now = exploration.time
    rates = [robot.rate for robot in exploration.robots]
    taken = [0] * len(rates)
    while exploration.end is None:
        due = [begin + count / rate for count, rate in zip(taken, rates)]
        if min(due) > until:
            break
        now = min(due)
        for robot in (robot for robot, time in enumerate(due) if time == now):
            taken[robot] += 1
            pose = exploration.at(robot, now)["pose"]
            scan = sense(robot, pose, now)
            if scan is not None:
                exploration.insert(robot, pose, *scan)
        while exploration.end is None and (plan := exploration.plan(now)):
            if planned is not None:
                planned(plan)
    return now
