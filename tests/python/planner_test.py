"""The planner in Python: explorations of a room that frontlux's own caster measures, and arguments it has to refuse."""
import functools
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import frontlux
import public_names
from frontlux import Occupancy, RayStop, planner

DATA = pathlib.Path(__file__).parents[2] / "data"
INF, NAN = np.inf, np.nan


def drone(name="drone", rate=4.0):
    view = frontlux.FieldOfView.pyramid(1.5, 1.2, 5.0)
    return planner.Robot(name, "space", (0.6, 0.6, 0.4), view, 48, 36, rate, speed=1.5)


class Room:
    """A closed room of 6 x 5 x 3 m with a wall in its middle, measured by casts."""
    bounds = ((0.0, 0.0, 0.0), (6.0, 5.0, 3.0))
    start = (1.5, 1.3, 1.5, 0.4)

    def __init__(self):
        states = np.full((60, 50, 30), Occupancy.OCCUPIED, np.uint8)
        states[2:-2, 2:-2, 2:-2] = Occupancy.FREE
        states[29:31, 2:30, 2:-2] = Occupancy.OCCUPIED
        self.grid = frontlux.VoxelGrid.from_occupancy(states, 0.1)
        self.caster = frontlux.RayCaster(self.grid)

    def measure(self, robot, pose):
        directions = robot.view.directions(robot.columns, robot.rows)
        turned = directions @ np.float32(turn(pose[3]).T)
        hits = self.caster.cast(pose[:3], turned, robot.view.max_range, "pass")
        return directions, np.where(hits["stop"] == RayStop.OCCUPIED, hits["distance"], np.float32(INF))

    def known(self, grid):
        """The part of the room's free voxels that a map knows to be free."""
        free = self.grid.centers(self.grid.keys(Occupancy.FREE))
        return (grid.at(grid.keys_of(free)) == Occupancy.FREE).mean()


@functools.lru_cache(None)
def room():
    return Room()


def turn(yaw):
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def matrix(pose):
    """(4, 4) of x, y, z and yaw."""
    T_map_sensor = np.eye(4)
    T_map_sensor[:3, :3], T_map_sensor[:3, 3] = turn(pose[3]), pose[:3]
    return T_map_sensor


def in_motion(robots=1, **options):
    exploration = planner.ContinuousExploration([drone(f"drone{i}") for i in range(robots)], room().bounds, 0.2, **options)
    exploration.begin([np.add(room().start, (0.0, 2.0 * i, 0.0, 0.0)) for i in range(robots)])
    return exploration


def sense_for(exploration):
    return lambda robot, pose, _: room().measure(exploration.robots[robot], pose)


class Robots(unittest.TestCase):
    def test_files_have_the_values_of_the_papers_robots(self):
        for name, robot in (("ugv", planner.ugv()), ("uav", planner.uav())):
            read = planner.Robot.read(DATA / f"robots/{name}.json")
            for one in ("name", "motion", "columns", "rows", "rate", "speed", "acceleration"):
                self.assertEqual(getattr(read, one), getattr(robot, one), one)
            self.assertAlmostEqual(read.yaw_rate, robot.yaw_rate)
            self.assertEqual(read.view.max_range, robot.view.max_range)
            np.testing.assert_array_equal(read.box, robot.box)
            moving = robot.in_motion(0.3)
            self.assertEqual((read.margin, read.min_height), (moving.margin, moving.min_height))
            self.assertGreater(moving.margin, robot.margin)
        self.assertEqual(planner.uav().in_motion(0.2).margin, 0.05)
        with self.assertRaisesRegex(ValueError, "resolution"):
            planner.uav().in_motion(0.0)

    def test_a_robot_of_values_is_the_one_of_its_file(self):
        files = {
            "box": (dict(name="a", motion="plane", box=(0.8, 0.6, 0.5), columns=8, rows=4, margin=0.05, sensor_height=0.4,
                         require_ground=False, ground=(0.5, 0.4), per_axis=True),
                    {"motion": "plane", "box_m": [0.8, 0.6, 0.5], "margin_m": 0.05, "mount_height_m": 0.4,
                     "require_ground": False, "ground_m": [0.5, 0.4], "limits": {"per_axis": True}}),
            "cylinder": (dict(name="a", motion="ground", box=(0.6, 0.6, 0.5), body="cylinder", columns=8, rows=4, step=0.2, slope=0.25,
                              sensor_height=0.6),
                         {"motion": "ground", "body": {"kind": "cylinder", "diameter_m": 0.6, "height_m": 0.5},
                          "step_m": 0.2, "slope_deg": np.degrees(0.25), "mount_height_m": 0.6}),
            "sphere": (dict(name="a", motion="space", box=(0.5, 0.5, 0.5), body="sphere", columns=8, rows=4, min_height=0.7, node_edge=1.2),
                       {"motion": "space", "body": {"kind": "sphere", "diameter_m": 0.5}, "min_height_m": 0.7, "node_edge_m": 1.2})}
        names = ("motion", "body", "margin", "sensor_height", "require_ground", "step", "slope", "min_height", "node_edge", "per_axis")
        for body, (values, members) in files.items():
            sensor = {"kind": "spinning", "vertical_deg": 40, "range_m": 5, "columns": 8, "rows": 4}
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder) / "a.json"
                file.write_text(json.dumps({"name": "a", **members, "sensor": sensor}))
                read = planner.Robot.read(file)
            made = planner.Robot(view=frontlux.FieldOfView.spinning(np.radians(40), 5.0), **values)
            self.assertEqual(made.body, body)
            np.testing.assert_array_equal(made.box, values["box"])
            np.testing.assert_array_equal(made.ground, read.ground)
            for name in names:
                if name == "slope" and made.slope is not None:
                    self.assertAlmostEqual(made.slope, read.slope)
                    continue
                self.assertEqual(getattr(made, name), getattr(read, name), name)
                if name in values:
                    self.assertEqual(getattr(made, name), values[name], name)
        self.assertIsNone(made.step)
        self.assertIsNone(made.sensor_height)
        self.assertIsNone(planner.ugv().node_edge)

    def test_a_body_is_free_at_its_start_and_no_more(self):
        view = frontlux.FieldOfView.spinning(1.0, 5.0)
        beside = np.maximum(np.abs(np.arange(-7, 8)) - 0.5, 0.0)  # [voxels] from the middle of a cell to others
        x, y, z = np.meshgrid(beside, beside, beside, indexing="ij")
        expected = {"box": np.maximum(np.maximum(x, y), z) < 5, "cylinder": (np.hypot(x, y) < 5) & (z < 5),
                    "sphere": np.sqrt(x**2 + y**2 + z**2) < 5}
        for body, voxels in expected.items():
            robot = planner.Robot("r", "space", (1.0, 1.0, 1.0), view, 8, 8, body=body)
            exploration = planner.ContinuousExploration([robot], room().bounds, 0.1)
            exploration.begin([room().start])
            self.assertEqual(exploration.grid.count()[Occupancy.FREE], voxels.sum(), body)

    def test_a_robot_on_nodes_leaves_a_start_beside_the_middle_of_its_node(self):
        robot = planner.Robot("r", "space", (0.8, 0.8, 0.8), drone().view, 48, 36, 4.0, node_edge=1.2, min_height=0.6)
        exploration = planner.ContinuousExploration([robot], room().bounds, 0.1)
        exploration.begin([(1.45, 1.25, 1.45, 0.4)])
        planner.run(exploration, sense_for(exploration), until=6.0)
        self.assertGreater(np.linalg.norm(exploration.at(0, 6.0)["pose"][:3] - (1.45, 1.25, 1.45)), 0.3)

    def test_values_are_kept_and_bad_ones_named(self):
        robot = drone()
        self.assertEqual(repr(robot), "<frontlux.planner.Robot 'drone': space, box of 0.6 x 0.6 x 0.4 m>")
        self.assertEqual((robot.name, robot.motion, robot.columns, robot.rows, robot.rate), ("drone", "space", 48, 36, 4.0))
        np.testing.assert_array_equal(robot.box, [0.6, 0.6, 0.4])
        rover = planner.Robot("rover", "ground", (0.6, 0.5, 0.4), robot.view, 8, 8, step=0.2, slope=0.3)
        self.assertEqual(rover.motion, "ground")
        good = {"name": "r", "motion": "plane", "box": (1, 1, 1), "view": robot.view, "columns": 8, "rows": 8}
        planner.Robot(**good)
        with self.assertRaisesRegex(ValueError, "ground: .*space"):
            planner.Robot(**{**good, "motion": "space", "ground": (0.5, 0.5)})
        for name, value, error in [
                ("min_height", 0.5, ValueError), ("node_edge", 1.2, ValueError),
                ("name", "", ValueError), ("name", 3, TypeError), ("motion", "water", ValueError), ("step", 0, ValueError), ("slope", 2, ValueError), ("box", (1, 1), ValueError),
                ("box", (1, 1, NAN), ValueError), ("box", np.ones((3, 3)), ValueError), ("box", "big", TypeError),
                ("view", None, TypeError), ("columns", 0, ValueError), ("columns", -1, TypeError), ("rows", 2**40, ValueError),
                ("rate", 0.0, ValueError), ("rate", INF, ValueError), ("margin", -0.1, ValueError), ("speed", 0.0, ValueError),
                ("acceleration", NAN, ValueError), ("yaw_rate", 0.0, ValueError), ("sensor_height", 1e9, ValueError),
                ("ground", (0.0, 1.0), ValueError), ("min_height", -1.0, ValueError), ("body", "cube", ValueError),
                ("node_edge", 1.2, ValueError)]:
            with self.assertRaisesRegex(error, name if error is ValueError else ""):
                planner.Robot(**{**good, name: value})
        for body, box in (("cylinder", (0.5, 0.6, 0.5)), ("sphere", (0.5, 0.5, 0.6)), ("sphere", (0.6, 0.5, 0.5))):
            with self.assertRaisesRegex(ValueError, f"box: .*{max(box)}.* of a {body} x"):
                planner.Robot(**{**good, "body": body, "box": box})
        with self.assertRaisesRegex(ValueError, "node_edge: 0.9, but has to be 1.0 to"):
            planner.Robot(**{**good, "motion": "space", "node_edge": 0.9})
        planner.Robot(**{**good, "name": 20 * "é"})
        with self.assertRaisesRegex(ValueError, "name: .*40 bytes"):
            planner.Robot(**{**good, "name": 21 * "é"})
        with self.assertRaisesRegex(ValueError, "max_range: 2000"):
            planner.Robot(**{**good, "view": frontlux.FieldOfView.cone(0.5, 2000.0)})
        with self.assertRaisesRegex(RuntimeError, "no_robot.json"):
            planner.Robot.read("no_robot.json")


class Scans(unittest.TestCase):
    def test_a_scan_changes_the_map_as_octomap_would(self):
        exploration, live = in_motion(), frontlux.LiveMap(0.2)
        pose = np.array([1.5, 1.3, 1.5, 0.7])
        before = exploration.grid
        body = before.keys(Occupancy.FREE)
        directions, ranges = room().measure(exploration.robots[0], pose)
        change = exploration.insert(0, pose, directions, ranges)
        self.assertTrue((before.at(change.keys) != exploration.grid.at(change.keys)).all())
        self.assertEqual(change.grid, exploration.grid)
        # A thousandth of a metre behind the surface; what met nothing is free up to 5 m.
        ends = pose[:3] + (directions @ turn(pose[3]).T) * (np.where(ranges <= 5.0, ranges + 1e-3, 10.0)[..., None])
        live.insert(ends, pose[:3].copy(), max_range=5.01)
        low, high = exploration.grid.known_bounds
        ours, theirs = exploration.grid.states(low, high), live.grid.states(low, high)
        differ = np.argwhere(ours != theirs) + low
        # But for what was known before, and rays along the faces of voxels that rounding moves.
        rest = [key for key in differ if not (body == key).all(axis=1).any()]
        self.assertLess(len(rest), 0.001 * len(change.keys))
        self.assertGreater(len(change.keys), 1000)

    def test_the_forms_of_a_scan_agree(self):
        pose = np.array([2.0, 1.4, 1.2, -2.5])
        directions, ranges = room().measure(drone(), pose)
        grids = []
        for insert in (lambda e: e.insert(0, pose, directions, ranges),
                       lambda e: e.insert(0, matrix(pose), directions.astype(np.float64), ranges.astype(np.float64)),
                       lambda e: e.insert(0, list(pose), directions.reshape(-1, 3), np.where(np.isinf(ranges), 99.0, ranges).ravel()),
                       lambda e: e.insert_points(0, pose, directions * np.where(np.isinf(ranges), 99.0, ranges)[..., None])):
            exploration = in_motion()
            insert(exploration)
            grids.append(exploration.grid)
        for other in grids[1:3]:
            self.assertEqual(grids[0], other)
        states = [grid.states(*grids[0].known_bounds) for grid in (grids[0], grids[3])]
        self.assertLess((states[0] != states[1]).mean(), 1e-3)  # ranges of points are rounded

    def test_a_range_of_the_sensors_own_is_a_hit_in_either_precision(self):
        robot = planner.Robot("drone", "space", (0.6, 0.6, 0.4), frontlux.FieldOfView.cone(0.1, 1.1), 8, 8)
        for dtype in (np.float32, np.float64):
            exploration = planner.ContinuousExploration([robot], room().bounds, 0.2)
            exploration.begin([room().start])
            exploration.insert(0, room().start, np.array([[1.0, 0.0, 0.0]]), np.array([1.1], dtype))
            self.assertEqual(exploration.grid.count()[2], 1, dtype)

    def test_what_was_not_measured_changes_nothing(self):
        exploration = in_motion()
        before = exploration.grid
        directions = drone().view.directions(10, 10)
        self.assertEqual(len(exploration.insert(0, room().start, directions, np.full((10, 10), NAN)).keys), 0)
        exploration.insert_points(0, room().start, np.array([[NAN, 0, 0], [0, INF, 0], [0, 0, 0]]))
        exploration.insert(0, room().start, np.empty((0, 3)), np.empty(0))
        self.assertEqual(exploration.grid, before)
        self.assertGreater(len(exploration.insert(0, room().start, directions, np.full((10, 10), INF)).keys), 100)

    def test_a_hit_stays_by_the_sensor_model(self):
        for options, state in (({}, Occupancy.FREE), ({"sensor_model": "cautious"}, Occupancy.OCCUPIED),
                               ({"sensor_model": "octomap"}, Occupancy.FREE)):
            exploration = in_motion(**options)
            for ahead in (0.7, 1.3, 1.3, 1.3):
                exploration.insert_points(0, (*room().start[:3], 0.0), np.array([[ahead, 0.0, 0.0]]))
            grid = exploration.grid
            self.assertEqual(grid.at(grid.keys_of(np.add(room().start[:3], (0.7, 0.0, 0.0)))), state, options)


class InMotion(unittest.TestCase):
    def test_a_run_explores_the_room_and_repeats(self):
        runs = []
        for _ in range(2):
            exploration, plans = in_motion(), []
            end = planner.run(exploration, sense_for(exploration), until=300.0, planned=plans.append)
            self.assertIn(exploration.end, ("nothing_to_do", "low_gain"))
            self.assertTrue(exploration.end_reason)
            self.assertGreater(room().known(exploration.grid), 0.95)
            self.assertEqual(exploration.time, end)
            runs.append((end, [(plan.reason, plan.trajectory.begin, plan.trajectory.end) for plan in plans], exploration.grid))
        self.assertEqual(runs[0], runs[1])
        self.assertEqual(plans[0].reason, "start")
        counts = exploration.grid.count()
        self.assertAlmostEqual(exploration.known_volume, (counts[1] + counts[2]) * 0.2**3)
        self.check_plans(plans, exploration.robots[0])

    def test_a_run_goes_on_from_the_map_of_one_that_has_crashed(self):
        crashed = in_motion()
        planner.run(crashed, sense_for(crashed), until=8.0)
        self.assertIsNone(crashed.end)
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "map.ot"
            crashed.write(file)
            exploration = planner.ContinuousExploration([drone()], room().bounds, 0.2, known=file)
            self.assertEqual(exploration.grid, crashed.grid)
            in_steps = planner.Exploration([drone()], room().bounds, 0.2, known=str(file))
            self.assertEqual(in_steps.grid, crashed.grid)
            with self.assertRaisesRegex(RuntimeError, "no.ot"):
                planner.ContinuousExploration([drone()], room().bounds, 0.2, known=file.with_name("no.ot"))
            with self.assertRaisesRegex(ValueError, "map.ot.*0.2.*0.3"):
                planner.ContinuousExploration([drone()], room().bounds, 0.3, known=file)
        in_steps.begin([crashed.at(0, crashed.time)["pose"]], lambda _, pose: room().measure(drone(), pose))
        self.assertGreater(in_steps.known_volume, crashed.known_volume)
        exploration.begin([crashed.at(0, crashed.time)["pose"]], time=100.0)
        end = planner.run(exploration, sense_for(exploration), until=400.0)
        self.assertIsNotNone(exploration.end)
        self.assertGreater(room().known(exploration.grid), 0.95)
        from_nothing = in_motion()
        self.assertLess(end - 100.0, planner.run(from_nothing, sense_for(from_nothing), until=300.0))

    def check_plans(self, plans, robot):
        for plan in plans:
            trajectory, step = plan.trajectory, plan.step
            self.assertGreaterEqual(trajectory.begin, step.time)
            times = np.linspace(trajectory.begin, trajectory.end, 40).reshape(2, 20)
            motion = trajectory.at(times)
            self.assertEqual([motion[name].shape for name in ("pose", "velocity", "yaw_rate")], [(2, 20, 4), (2, 20, 3), (2, 20)])
            self.assertLessEqual(np.linalg.norm(motion["velocity"], axis=-1).max(), robot.speed * (1 + 1e-9))
            self.assertLessEqual(np.abs(motion["yaw_rate"]).max(), robot.yaw_rate * (1 + 1e-9))
            np.testing.assert_array_equal(trajectory.at(trajectory.end)["velocity"], 0)
            self.assertEqual(step.goals.shape, (1, 4))
            self.assertEqual(len(step.goal_states), 1)
            self.assertRegex(step.goal_reasons[0], "^(goal for|stop 1 of) " if np.isfinite(step.goals).all() else "^no goal: ")
            self.assertEqual(step.poses[0].shape[1], 4)
            self.assertEqual(step.tours[0]["pose"].shape, (len(step.tours[0]["clusters"]), 4))
            self.assertEqual(set(step.seconds), {"frontiers", "caster", "goals", "paths", "optimization", "moving"})
        self.assertEqual([plan.step.number for plan in plans], list(range(1, len(plans) + 1)))
        self.assertGreater(sum(plan.step.lengths[0] for plan in plans), 3.0)
        self.assertGreater(plans[0].step.frontiers, 0)

    def test_a_loop_of_ones_own_is_the_same(self):
        by_run, by_hand = in_motion(), in_motion()
        end = planner.run(by_run, sense_for(by_run), until=3.1)
        self.assertEqual(end, 3.0)
        for scan in range(13):
            now = scan / 4
            pose = by_hand.at(0, now)["pose"]
            by_hand.insert(0, pose, *room().measure(by_hand.robots[0], pose))
            while by_hand.plan(now):
                pass
        self.assertEqual(by_run.grid, by_hand.grid)
        times = np.arange(0, 6, 0.1)
        np.testing.assert_array_equal(by_run.at(0, times)["pose"], by_hand.at(0, times)["pose"])
        self.assertEqual(by_hand.finish(3.5).time, 3.5)

    def test_a_robot_with_rare_scans_plans_between_them(self):
        exploration, plans = planner.ContinuousExploration([drone("slow", 0.2)], room().bounds, 0.2), []
        exploration.begin([room().start])
        planner.run(exploration, sense_for(exploration), until=12.0, planned=lambda plan: plans.append(exploration.time))
        self.assertEqual(exploration.period, 1.0)
        self.assertLessEqual(np.diff([*plans, 12.0]).max(), 1.25 + 1e-9)

    def test_runs_in_parts_are_one_run(self):
        runs = []
        for parts in ([4.0], [0.0, 0.1, 1.0, 1.0, 2.0, 2.9, 3.0, 4.0]):
            exploration = planner.ContinuousExploration([drone("quick"), drone("slow", 3.0)], room().bounds, 0.2)
            exploration.begin([room().start, np.add(room().start, (0.0, 2.0, 0.0, 0.0))], time=0.7)
            scans = []
            def sense(robot, pose, now):
                scans.append((robot, now, *pose))
                return room().measure(exploration.robots[robot], pose)
            ends = [planner.run(exploration, sense, until=0.7 + part) for part in parts]
            self.assertEqual(sorted(ends), ends)
            runs.append((ends[-1], scans, exploration.grid))
        self.assertEqual(len(scans), 17 + 13)
        self.assertEqual(runs[0], runs[1])

    def test_a_run_goes_on_after_an_exception_and_after_calls_of_ones_own(self):
        exploration, scans = in_motion(2), []
        def sense(robot, pose, now):
            if robot == 1 and now == 0.5 and scans.count((1, 0.25)) and not broken:
                broken.append(now)
                raise KeyboardInterrupt
            scans.append((robot, now))
            return room().measure(exploration.robots[robot], pose)
        broken = []
        with self.assertRaises(KeyboardInterrupt):
            planner.run(exploration, sense, until=1.0)
        planner.run(exploration, sense, until=1.0)
        expected = [(robot, scan / 4) for scan in range(5) for robot in (0, 1)]
        self.assertEqual(scans, expected)
        exploration.plan(1.6)
        planner.run(exploration, sense, until=2.0)
        self.assertEqual(scans, [*expected, (0, 1.75), (1, 1.75), (0, 2.0), (1, 2.0)])

    def test_frontiers_follow_the_scans(self):
        exploration = in_motion(2)
        frontiers = frontlux.FrontierSet(exploration.grid)
        def sense(robot, pose, now):
            frontiers.update(exploration.insert(robot, pose, *room().measure(exploration.robots[robot], pose)))
        planner.run(exploration, sense, until=3.0)
        np.testing.assert_array_equal(frontiers.keys, frontlux.FrontierSet(exploration.grid).keys)

    def test_two_robots_share_the_room(self):
        exploration = in_motion(2, goal="render")
        senders = []
        def sense(robot, pose, now):
            senders.append(robot)
            return None if now > 2.0 and robot == 1 else room().measure(exploration.robots[robot], pose)
        planner.run(exploration, sense, until=4.0)
        self.assertEqual(senders[:4], [0, 1, 0, 1])
        apart = exploration.at(0, np.arange(0, 5, 0.1))["pose"] - exploration.at(1, np.arange(0, 5, 0.1))["pose"]
        self.assertGreater(np.linalg.norm(apart[:, :2], axis=1).min(), 0.6)

    def test_a_robot_that_was_stopped_plans_anew(self):
        exploration = in_motion()
        planner.run(exploration, sense_for(exploration), until=1.0)
        pose = exploration.at(0, 1.2)["pose"]
        exploration.stopped(0, pose, 1.2)
        np.testing.assert_array_equal(exploration.at(0, 1.3)["pose"], pose)
        plan = exploration.plan(1.3)
        self.assertEqual(plan.reason, "stopped")
        self.assertRegex(repr(plan), r"^<frontlux.planner.Plan of robot 0: stopped, 1.\d\d to \d+.\d\d s>$")
        self.assertEqual(repr(plan.step), f"<frontlux.planner.Step {plan.step.number}: 1.30 s, {plan.step.frontiers} frontiers>")

    def test_a_displaced_robot_plans_from_where_it_is_and_keeps_its_cell(self):
        exploration = in_motion()
        planner.run(exploration, sense_for(exploration), until=1.0)
        pose = exploration.at(0, 1.2)["pose"] + (0.05, 0.0, 0.0, 0.5)
        exploration.displaced(0, pose, 1.2)
        np.testing.assert_array_equal(exploration.at(0, 1.3)["pose"], pose)
        plan = exploration.plan(1.3)
        self.assertEqual(plan.reason, "stopped")
        self.assertEqual(plan.step.goal_states, ["assigned"])  # after `stopped` it would be "no_corridor"
        np.testing.assert_array_equal(plan.trajectory.at(plan.trajectory.begin)["pose"], pose)
        self.assertGreater(plan.trajectory.length, 0.0)

    def test_a_lost_robot_plans_no_more(self):
        exploration = in_motion()
        planner.run(exploration, sense_for(exploration), until=1.0)
        pose = exploration.at(0, 1.2)["pose"]
        exploration.lose(0, pose, 1.2)
        np.testing.assert_array_equal(exploration.at(0, 9.0)["pose"], pose)
        self.assertIsNone(exploration.plan(9.0))
        self.assertIsNotNone(exploration.end)

    def test_lost_robots_take_no_scans(self):
        exploration, scans = in_motion(2), []
        def sense(robot, pose, now):
            scans.append(robot)
            return room().measure(exploration.robots[robot], pose)
        planner.run(exploration, sense, until=1.0)
        self.assertEqual(exploration.lost, [])
        exploration.lose(0, exploration.at(0, 1.1)["pose"], 1.1)
        self.assertEqual(exploration.lost, [0])
        scans.clear()
        self.assertEqual(planner.run(exploration, sense, until=2.0), 2.0)
        self.assertEqual(scans, [1] * 4)
        exploration.lose(1, exploration.at(1, 2.0)["pose"], 2.0)
        self.assertEqual(exploration.lost, [0, 1])
        scans.clear()
        self.assertEqual(planner.run(exploration, sense), 2.0)
        self.assertEqual(scans, [])
        self.assertIsNotNone(exploration.end)

    def test_a_robot_joins_the_others(self):
        exploration, scans = in_motion(2), []
        def sense(robot, pose, now):
            scans.append((robot, now))
            return room().measure(exploration.robots[robot], pose)
        waits = exploration.at(1, 0.0)["pose"]
        exploration.lose(1, waits, 0.0)
        planner.run(exploration, sense, until=2.0)
        self.assertEqual({robot for robot, _ in scans}, {0})
        exploration.join(1, waits, 2.1)
        self.assertEqual(exploration.lost, [])
        with self.assertRaisesRegex(ValueError, "robot 1 takes part already"):
            exploration.join(1, waits, 2.1)
        plans = []
        scans.clear()
        planner.run(exploration, sense, until=7.0, planned=plans.append)
        self.assertEqual(scans, sorted(scans, key=lambda scan: scan[1]))
        self.assertEqual([now for robot, now in scans if robot == 1][:2], [2.25, 2.5])
        self.assertEqual([plan.reason for plan in plans if plan.robot == 1][0], "start")
        self.assertGreater(np.linalg.norm((exploration.at(1, 7.0)["pose"] - waits)[:3]), 0.3)

    def test_a_ground_robot(self):
        lidar = frontlux.FieldOfView.spinning(0.9, 5.0)
        robot = planner.Robot("cart", "plane", (0.5, 0.5, 0.5), lidar, 240, 24, 4.0, sensor_height=0.5)
        exploration = planner.ContinuousExploration([robot], room().bounds, 0.2)
        exploration.begin([(1.5, 1.3, 0.75, 0.0)], free_radius=1.0)
        planner.run(exploration, sense_for(exploration), until=120.0)
        self.assertIsNotNone(exploration.end)
        self.assertGreater(room().known(exploration.grid), 0.7)
        with self.assertRaisesRegex(ValueError, "free_radius"):
            planner.ContinuousExploration([robot], room().bounds, 0.2).begin([(1.5, 1.3, 0.75, 0.0)], free_radius=-1.0)

    def test_the_map_is_written(self):
        exploration = in_motion()
        planner.run(exploration, sense_for(exploration), until=1.0)
        with tempfile.TemporaryDirectory() as folder:
            exploration.write(os.path.join(folder, "map.bt"))
            self.assertEqual(frontlux.VoxelGrid.read(os.path.join(folder, "map.bt")), exploration.grid)

    def test_others_run_meanwhile_and_exceptions_pass(self):
        exploration = in_motion()
        worker = threading.Thread(target=planner.run, args=(exploration, sense_for(exploration), 5.0))
        worker.start()
        while worker.is_alive():
            self.assertGreaterEqual(exploration.known_volume, 0.0)  # waits for it, and does not stop it
            time.sleep(0.001)
        self.assertEqual(exploration.time, 5.0)
        def interrupt(robot, pose, now):
            os.kill(os.getpid(), signal.SIGINT)
            return None
        with self.assertRaises(KeyboardInterrupt):
            planner.run(exploration, interrupt, until=100.0)
        known = exploration.known_volume
        planner.run(exploration, sense_for(exploration), until=8.0)
        self.assertGreater(exploration.known_volume, known)


class InLockStep(unittest.TestCase):
    def exploration(self, **options):
        return planner.Exploration([drone()], room().bounds, 0.2, **options)

    def drive(self, _, pose):
        return room().measure(drone(), pose)

    def test_steps_explore_the_room(self):
        exploration, steps = self.exploration(), []
        steps.append(exploration.begin([room().start], self.drive))
        while exploration.end is None:
            steps.append(exploration.step(self.drive))
        self.assertEqual([step.number for step in steps], list(range(len(steps))))
        self.assertGreater(room().known(exploration.grid), 0.95)
        self.assertEqual(exploration.poses.shape, (1, 4))
        reached = [step.poses[0][step.travelled[0] - 1] for step in steps if step.travelled[0] > 0]
        np.testing.assert_array_equal(exploration.poses[0], reached[-1])
        everywhere = frontlux.FrontierSet(exploration.grid, *(exploration.grid.keys_of(np.add(corner, shift)) for corner, shift in
                                                              zip(room().bounds, (0.1, -0.1))))
        np.testing.assert_array_equal(exploration.frontiers, everywhere.keys)

    def test_a_robot_that_cannot_go_stays(self):
        exploration = self.exploration(method="paper", goal="nearest")
        exploration.begin([room().start], self.drive)
        before = exploration.poses
        exploration.step(lambda robot, pose: None)
        np.testing.assert_array_equal(exploration.poses[:, :3], before[:, :3])

    def test_a_map_outlives_its_drive(self):
        def broken(robot, pose):
            raise KeyboardInterrupt
        for scans in (0, 1, 2):
            exploration, count = self.exploration(), iter(range(scans))
            def drive(robot, pose):
                return self.drive(robot, pose) if next(count, None) is not None else broken(robot, pose)
            with self.assertRaises(KeyboardInterrupt):
                exploration.begin([room().start], drive)
            self.assertEqual(exploration.end, "interrupted")
            self.assertIn("drive", exploration.end_reason)
            self.assertEqual(exploration.poses.shape[1], 4)
            self.assertEqual(exploration.frontiers.shape[1], 3)
            counts = exploration.grid.count()
            self.assertEqual(counts[1] > 1000, scans > 0)
            self.assertAlmostEqual(exploration.known_volume, (counts[1] + counts[2]) * 0.2**3)
            with tempfile.TemporaryDirectory() as folder:
                exploration.write(os.path.join(folder, "map.bt"))
                self.assertEqual(frontlux.VoxelGrid.read(os.path.join(folder, "map.bt")), exploration.grid)
            for call in (lambda: exploration.begin([room().start], self.drive), lambda: exploration.step(self.drive)):
                with self.assertRaisesRegex(RuntimeError, "unfinished, since drive raised"):
                    call()

    def test_drive_may_return_any_pair(self):
        grids = []
        for kind in (tuple, list):
            exploration = self.exploration()
            exploration.begin([room().start], lambda robot, pose: kind(self.drive(robot, pose)))
            grids.append(exploration.grid)
        self.assertEqual(*grids)

    def test_what_is_refused_before_it_drives_breaks_nothing(self):
        exploration = self.exploration()
        with self.assertRaisesRegex(ValueError, "before its beginning"):
            exploration.step(self.drive)
        exploration.begin([room().start], self.drive)
        with self.assertRaisesRegex(ValueError, "begun already"):
            exploration.begin([room().start], self.drive)
        self.assertIsNone(exploration.end)
        exploration.step(self.drive)

    def test_python_exits_while_robots_drive(self):
        script = """
import threading, time
import numpy as np
from frontlux import planner
robot = planner.Robot("drone", "space", (0.6, 0.6, 0.4), planner.uav().view, 40, 30)
directions = robot.view.directions(40, 30)
def drive(robot, pose):
    time.sleep(0.001)
    return directions, np.full((30, 40), 1.5)
def explore():
    while True:
        exploration = planner.Exploration([robot], ((0.0, 0.0, 0.0), (6.0, 5.0, 3.0)), 0.2)
        exploration.begin([(3.0, 2.5, 1.5, 0.0)], drive)
        exploration.step(drive)
for _ in range(2):
    threading.Thread(target=explore, daemon=True).start()
time.sleep(0.2)
"""
        for _ in range(5):
            done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_wrong_drives(self):
        for wrong, error, pattern in [(lambda r, p: 3, TypeError, "drive: has to return"),
                                      (lambda r, p: [np.ones((4, 3))], TypeError, "drive: has to return"),
                                      (lambda r, p: "ab", TypeError, "directions: no array of numbers"),
                                      (lambda r, p: (np.ones((4, 3)), np.ones(4)), ValueError, "not of unit length"),
                                      (lambda r, p: 1 / 0, ZeroDivisionError, "")]:
            exploration = self.exploration()
            with self.assertRaisesRegex(error, pattern):
                exploration.begin([room().start], wrong)
            with self.assertRaisesRegex(RuntimeError, "unfinished, since drive raised"):
                exploration.step(self.drive)
        exploration = self.exploration()
        with self.assertRaisesRegex(ValueError, "drive cannot use it"):
            exploration.begin([room().start], lambda r, p: exploration.grid)
        with self.assertRaises(TypeError):
            self.exploration().begin([room().start], None)
        with self.assertRaisesRegex(ValueError, "before its beginning"):
            self.exploration().step(self.drive)
        with self.assertRaisesRegex(ValueError, "method: 'best'"):
            self.exploration(method="best")
        with self.assertRaisesRegex(ValueError, "goal: 'tour', but has to be 'render'"):
            self.exploration(goal="tour")


class Refusals(unittest.TestCase):
    def refuses(self, error, pattern, function, *args, **kwargs):
        with self.assertRaisesRegex(error, pattern):
            function(*args, **kwargs)

    def test_clocks(self):
        self.refuses(ValueError, "until", planner.run, in_motion(), sense_for(in_motion()), until=NAN)

    def test_teams(self):
        make, bounds = planner.ContinuousExploration, room().bounds
        self.refuses(ValueError, "no robot", make, [], bounds)
        self.refuses(TypeError, "incompatible", make, [None], bounds)
        self.refuses(TypeError, "incompatible", make, drone(), bounds)
        self.refuses(ValueError, r"bounds: has to be of shape \(2, 3\)", make, [drone()], (0.0, 0.0, 0.0))
        self.refuses(ValueError, "lower corner first", make, [drone()], bounds[::-1])
        self.refuses(ValueError, "bounds: not finite", make, [drone()], ((0.0, 0.0, 0.0), (1.0, 1.0, NAN)))
        self.refuses(ValueError, "resolution", make, [drone()], bounds, -0.1)
        self.refuses(ValueError, "robot 'drone': .*extents", make, [drone()], ((0.0, 0.0, 0.0), (0.1, 0.1, 0.1)), 0.0001)
        self.refuses(ValueError, "goal: 'best', but has to be 'tour'", make, [drone()], bounds, goal="best")
        self.refuses(ValueError, "latency", make, [drone()], bounds, latency=0.0)
        self.refuses(ValueError, "sensor_model: 'bold'", make, [drone()], bounds, sensor_model="bold")
        self.refuses(ValueError, "epsilon", make, [drone()], bounds, epsilon=NAN)
        self.refuses(ValueError, "max_steps", make, [drone()], bounds, max_steps=-1)
        self.refuses(TypeError, "incompatible", make, [drone()], bounds, seed=-1)

    def test_calls_before_the_begin_and_wrong_starts(self):
        exploration = planner.ContinuousExploration([drone()], room().bounds)
        for call in (lambda: exploration.plan(0.0), lambda: exploration.insert_points(0, room().start, np.ones((1, 3))),
                     lambda: exploration.at(0, 0.0), lambda: exploration.finish(0.0),
                     lambda: exploration.stopped(0, room().start, 0.0), lambda: exploration.displaced(0, room().start, 0.0), lambda: exploration.lose(0, room().start, 0.0)):
            self.refuses(ValueError, "has not begun", call)
        begin = exploration.begin
        self.refuses(ValueError, r"starts: shape \(4,\), but has to be \(1, 4\)", begin, room().start)
        self.refuses(ValueError, r"starts: shape \(2, 4\)", begin, [room().start] * 2)
        self.refuses(ValueError, "starts: number 0 is not finite, or outside the bounds", begin, [(99.0, 0.0, 0.0, 0.0)])
        self.refuses(ValueError, "starts: number 0", begin, [(1.0, 1.0, 1.0, NAN)])
        self.refuses(ValueError, "time: nan", begin, [room().start], NAN)
        self.refuses(ValueError, "free_radius", begin, [room().start], free_radius=NAN)
        begin([room().start], time=3.0)
        self.refuses(ValueError, "has begun already", begin, [room().start])
        self.refuses(ValueError, r"time: 2.0+ s, but it was 3.0+ s already", exploration.plan, 2.0)
        self.refuses(ValueError, "time: inf", exploration.plan, INF)

    def test_scans_and_times(self):
        exploration, start = in_motion(), room().start
        ahead = np.array([[1.0, 0.0, 0.0]])
        insert = exploration.insert
        self.refuses(ValueError, "robot: 1, but there are 1", insert, 1, start, ahead, [1.0])
        self.refuses(TypeError, "incompatible", insert, -1, start, ahead, [1.0])
        self.refuses(ValueError, r"pose: shape \(3, 4\), but has to be \(4,\)", insert, 0, np.ones((3, 4)), ahead, [1.0])
        self.refuses(ValueError, "pose: .*rotation", insert, 0, 2 * np.eye(4), ahead, [1.0])
        self.refuses(ValueError, "pose: .*rotation", insert, 0, np.diag([1.0, 1.0, -1.0, 1.0]), ahead, [1.0])
        self.refuses(ValueError, r"pose: .*\(0, 0, 0, 1\)", insert, 0, np.ascontiguousarray(matrix(start).T), ahead, [1.0])
        self.refuses(TypeError, "ranges: no array of numbers", insert, 0, start, ahead, None)
        self.refuses(TypeError, "pose: no array of numbers", insert, 0, ("1", "1", "1", "0"), ahead, [1.0])
        self.refuses(ValueError, "pose: not finite", insert, 0, (0.0, 0.0, NAN, 0.0), ahead, [1.0])
        self.refuses(ValueError, "pose: .*outside the key range", insert, 0, (1e9, 0.0, 0.0, 0.0), ahead, [1.0])
        self.refuses(ValueError, "ranges and directions", insert, 0, start, ahead, [1.0, 2.0])
        self.refuses(ValueError, "direction 0 is not of unit length", insert, 0, start, 2 * ahead, [1.0])
        self.refuses(ValueError, "direction 0 is not of unit length", insert, 0, start, NAN * ahead, [1.0])
        self.refuses(ValueError, "range 0 is -1", insert, 0, start, ahead, [-1.0])
        self.refuses(TypeError, "directions: dtype int64", insert, 0, start, np.ones((1, 3), int), [1.0])
        self.refuses(ValueError, "points: not contiguous", exploration.insert_points, 0, start, np.ones((4, 6))[:, ::2])
        self.refuses(ValueError, "times: number 1 is not finite", exploration.at, 0, [0.0, NAN])
        self.refuses(ValueError, "robot: 7", exploration.at, 7, 0.0)
        self.refuses(TypeError, "blocked: dtype float64", exploration.stopped, 0, start, 1.0, np.ones((1, 3)))
        read_only = np.ones((2, 3))
        read_only.flags.writeable = False
        exploration.insert_points(0, start, read_only)
        self.assertEqual(exploration.time, 0.0)

    def test_objects_that_were_never_made(self):
        for kind in (planner.Robot, planner.Trajectory, planner.Step, planner.Plan, planner.ContinuousExploration,
                     planner.Exploration):
            for name, member in vars(kind).items():
                if isinstance(member, property):
                    self.refuses(RuntimeError, "", getattr, kind.__new__(kind), name)
        self.refuses(TypeError, "No constructor", planner.Plan)


class Module(unittest.TestCase):
    def test_everything_is_documented_and_typed(self):
        public_names.expect_documented_and_typed(self, planner)

    def test_the_package_can_be_moved(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(pathlib.Path(frontlux.__file__).parent, os.path.join(folder, "frontlux"))
            maps = subprocess.run([sys.executable, "-c", "import frontlux.planner; print(open('/proc/self/maps').read())"],
                                  env={**os.environ, "PYTHONPATH": folder}, check=True, capture_output=True, text=True).stdout
            ours = {line.split()[-1] for line in maps.splitlines() if "frontlux" in line}
            self.assertGreater(len(ours), 1)
            self.assertEqual([file for file in ours if not file.startswith(folder)], [])


if __name__ == "__main__":
    unittest.main()
