"""The Python module against known answers, against itself, and with arguments that it has to refuse."""
import copy
import os
import pathlib
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
from frontlux import Occupancy, RayStop

MAPS = pathlib.Path(__file__).parents[2] / "data/maps"


def room():
    """A box of 2 x 2 x 2 m with walls of one voxel, 0.1 m, whose lower corner is the origin; free inside."""
    states = np.full((20, 20, 20), Occupancy.OCCUPIED, np.uint8)
    states[1:-1, 1:-1, 1:-1] = Occupancy.FREE
    return states


def random_rays(count, seed=1, low=(0.5, 0.5, 0.2), high=(11.5, 11.5, 2.8)):
    random = np.random.default_rng(seed)
    return random.uniform(low, high, (count, 3)), random.normal(size=(count, 3))


class Casting(unittest.TestCase):
    def setUp(self):
        self.grid = frontlux.VoxelGrid.from_occupancy(room(), 0.1)
        self.caster = frontlux.RayCaster(self.grid)

    def test_a_ray_in_a_room(self):
        hit = self.caster.cast((1.05, 1.05, 1.05), (1, 0, 0))
        self.assertEqual(hit["stop"], RayStop.OCCUPIED)
        self.assertEqual(hit["state"], Occupancy.OCCUPIED)
        np.testing.assert_array_equal(hit["key"], [32768 + 19, 32768 + 10, 32768 + 10])
        np.testing.assert_allclose(hit["end"], [1.95, 1.05, 1.05], atol=1e-6)
        np.testing.assert_allclose(hit["entry"], [1.9, 1.05, 1.05], atol=1e-6)
        np.testing.assert_allclose(hit["distance"], 0.85, atol=1e-6)
        dtypes = {name: str(array.dtype) for name, array in hit.items()}
        self.assertEqual(dtypes, {"stop": "uint8", "state": "uint8", "key": "uint16", "end": "float32",
                                  "entry": "float32", "distance": "float32"})

    def test_shapes_follow_the_arguments(self):
        directions = frontlux.FieldOfView.spinning(0.5, 10.0).directions(columns=12, rows=5)
        self.assertEqual(directions.shape, (5, 12, 3))
        for origins, ranges in [((1, 1, 1), -1), (np.ones((5, 12, 3)), np.full((5, 12), 0.3)),
                                (np.ones(3, np.float32), np.full((5, 12), 0.3, np.float32))]:
            hits = self.caster.cast(origins, directions, ranges)
            self.assertEqual(hits["end"].shape, (5, 12, 3))
            self.assertEqual(hits["distance"].shape, (5, 12))
        self.assertTrue((hits["stop"] == RayStop.OUT_OF_RANGE).all())
        self.assertEqual(self.caster.cast(np.ones((7, 3)), (0, 0, 1.0))["key"].shape, (7, 3))
        self.assertEqual(self.caster.cast(np.ones((0, 3)), np.ones((0, 3)))["end"].shape, (0, 3))
        self.assertEqual(self.caster.visible((1, 1, 1), np.ones((4, 6, 3))).shape, (4, 6))

    def test_all_casters_agree_on_a_real_map_and_float64_is_rounded(self):
        grid = frontlux.VoxelGrid.read(MAPS / "room_0.1m.bt")
        origins, directions = random_rays(200_000)
        for unknown in ("block", "pass"):
            answers = [frontlux.RayCaster(grid, kind).cast(o, d, 5.0, unknown)
                       for kind, o, d in [("grid", origins, directions), ("embree", origins, directions),
                                          ("fast", np.float32(origins), np.float32(directions))]]
            for other in answers[1:]:
                for name, array in answers[0].items():
                    np.testing.assert_array_equal(array, other[name], name)
            self.assertGreater(len(np.unique(answers[0]["stop"])), 1)

    def test_out_is_written_and_nothing_else(self):
        origins, directions = np.ones((1000, 3)), random_rays(1000)[1]
        expected = self.caster.cast(origins, directions)
        out = {"distance": np.empty(1000, np.float32), "key": np.empty((1000, 3), np.uint16)}
        self.assertIs(self.caster.cast(origins, directions, out=out), out)
        self.assertEqual(set(out), {"distance", "key"})
        np.testing.assert_array_equal(out["distance"], expected["distance"])
        np.testing.assert_array_equal(out["key"], expected["key"])

    def test_visibility_and_counts(self):
        inside, outside = (1.05, 1.05, 1.05), (3.05, 1.05, 1.05)
        self.assertTrue(self.caster.visible(inside, (1.95, 1.05, 1.05)))
        self.assertFalse(self.caster.visible(inside, outside))
        keys = self.grid.keys_of(np.array([inside, outside]))
        self.assertFalse(self.caster.visible(keys[0], keys[1], unknown="pass"))
        count = self.caster.count(inside, (1, 0, 0))
        self.assertEqual([int(count[n]) for n in ("unknown", "free", "occupied", "stop")], [0, 9, 0, RayStop.OCCUPIED])
        between = self.caster.count_between(keys[:1], keys[1:], unknown="pass")
        self.assertEqual([int(between[n][0]) for n in ("unknown", "free", "occupied")], [0, 9, 0])
        single = self.caster.count_between(keys[0], np.array([keys[0], keys[1]]))
        self.assertEqual(single["stop"].tolist(), [RayStop.REACHED, RayStop.OCCUPIED])

    def test_others_run_meanwhile(self):
        caster = frontlux.RayCaster(self.grid, "grid")
        points, directions = np.ones((3_000_000, 3), np.float32), random_rays(3_000_000)[1]
        keys, view = np.full((8_000_000, 3), 32769, np.uint16), frontlux.FieldOfView.spinning(0.5, 10.0)
        for function, args in [(caster.cast, (points, directions)), (self.grid.keys_of, (points,)), (self.grid.centers, (keys,)),
                               (self.grid.at, (keys,)), (view.directions, (1000, 1000)),
                               (frontlux.pinhole_directions, (np.eye(3), 1000, 1000))]:
            worker = threading.Thread(target=function, args=args)
            worker.start()
            turns = 0
            while worker.is_alive():
                time.sleep(0.001)
                turns += 1
            self.assertGreater(turns, 3, function)

    def test_python_exits_while_a_thread_casts(self):
        script = """
import threading, time
import numpy as np
import frontlux
caster = frontlux.RayCaster(frontlux.VoxelGrid.from_occupancy(np.zeros((30, 30, 30), bool), 0.1))
directions = np.random.default_rng(1).normal(size=(100_000, 3))
def cast():
    while True:
        caster.cast((1.5, 1.5, 1.5), directions)
for _ in range(2):
    threading.Thread(target=cast, daemon=True).start()
time.sleep(0.1)
"""
        for _ in range(10):
            done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_signal_stops_a_long_cast(self):
        caster = frontlux.RayCaster(self.grid, "grid")
        out = {"distance": np.full(5_000_000, np.nan, np.float32)}
        directions = np.full((5_000_000, 3), (0.5, 1.0, 0.2), np.float32)
        def interrupt():
            while np.isnan(out["distance"][0]):
                time.sleep(0.001)
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt).start()
        with self.assertRaises(KeyboardInterrupt):
            caster.cast((1.05, 1.05, 1.05), directions, out=out)
        self.assertTrue(np.isnan(out["distance"][-1]))


class Refusals(unittest.TestCase):
    def setUp(self):
        self.caster = frontlux.RayCaster(frontlux.VoxelGrid.from_occupancy(room(), 0.1))
        self.points = np.ones((4, 3))

    def refuses(self, error, pattern, function, *args, **kwargs):
        with self.assertRaisesRegex(error, pattern):
            function(*args, **kwargs)

    def test_arrays_that_are_none_of_ours(self):
        cast, p = self.caster.cast, self.points
        self.refuses(ValueError, r"origins: shape \(4, 2\), but has to be \(\.\.\., 3\)", cast, np.ones((4, 2)), p)
        self.refuses(ValueError, r"directions: shape \(\)", cast, p, np.float64(1))
        self.refuses(TypeError, "directions: dtype int64, but has to be float32 or float64", cast, p, np.ones((4, 3), int))
        self.refuses(TypeError, "origins: dtype float16", cast, np.ones((4, 3), np.float16), p)
        self.refuses(TypeError, "origins: dtype >f8", cast, p.astype(">f8"), p)
        self.refuses(ValueError, "origins: not contiguous.*numpy.require", cast, np.ones((8, 3))[::2], p)
        self.refuses(ValueError, "directions: not contiguous", cast, p, np.asfortranarray(np.ones((4, 3))))
        self.refuses(ValueError, r"directions and origins: for shapes \(3,\) and \(4,\)", cast, p, np.ones((3, 3)))
        self.refuses(ValueError, "max_range and origins", cast, p, p, np.ones(3))
        self.refuses(TypeError, "origins: no array", cast, "here", p)
        self.refuses(ValueError, "unknown: 'stop', but has to be 'block' or 'pass'", cast, p, p, unknown="stop")
        unaligned = np.frombuffer(b"\0" * 97, np.uint8)[1:].view(np.float64).reshape(4, 3)
        self.refuses(ValueError, "not contiguous", cast, unaligned, p)

    def test_what_is_no_number(self):
        cast, p = self.caster.cast, self.points
        self.refuses(TypeError, "origins: no array of numbers", cast, ("1.05", "1", "1"), p)
        self.refuses(TypeError, "max_range: no array of numbers", cast, p, p, None)
        self.refuses(TypeError, "directions: no array of numbers", cast, p, [[1.0, None, 0.0]])
        self.refuses(TypeError, "origins: no array of numbers", cast, [True, False, True], p)
        self.refuses(TypeError, "origins: no array", cast, [[1.0, 2.0], [3.0]], p)
        self.refuses(TypeError, "keys: ", self.caster.grid.at, None)
        class Broken:
            def __init__(self, error):
                self.error = error
            def __array__(self, *_, **__):
                raise self.error
        for error in (KeyboardInterrupt, MemoryError, ZeroDivisionError):
            self.refuses(error, "", cast, Broken(error), p)
        self.refuses(TypeError, "origins: no array: ValueError: it has none", cast, Broken(ValueError("it has none")), p)
        np.testing.assert_array_equal(cast((1, 1, 1), p)["key"], cast([1.0, np.float32(1), np.int8(1)], p)["key"])

    def test_read_only_arguments_are_read(self):
        self.points.flags.writeable = False
        self.assertEqual(self.caster.cast(self.points, self.points)["stop"].shape, (4,))

    def test_outputs_that_do_not_fit(self):
        def cast(out):
            return self.caster.cast(self.points, self.points, out=out)
        self.refuses(ValueError, r'out\["distance"\]: shape \(5,\), but has to be \(4,\)', cast, {"distance": np.empty(5, "f4")})
        self.refuses(TypeError, r'out\["distance"\]: dtype float64, but has to be float32', cast, {"distance": np.empty(4)})
        self.refuses(ValueError, r'out\["end"\]: not contiguous', cast, {"end": np.empty((4, 6), "f4")[:, ::2]})
        read_only = np.empty(4, np.float32)
        read_only.flags.writeable = False
        self.refuses(ValueError, r'out\["distance"\]: read-only', cast, {"distance": read_only})
        self.refuses(TypeError, r'out\["key"\]: no numpy array', cast, {"key": [1, 2]})
        self.refuses(ValueError, "none of an answer's arrays", cast, {"normal": np.empty(4)})

    def test_grids(self):
        make = frontlux.VoxelGrid.from_occupancy
        self.refuses(TypeError, "states: dtype float64", make, np.zeros((2, 2, 2)), 0.1)
        self.refuses(ValueError, "states: 2 axes", make, np.zeros((2, 2), bool), 0.1)
        self.refuses(ValueError, "states: holds 7", make, np.full((2, 2, 2), 7, np.uint8), 0.1)
        self.refuses(ValueError, "axis 2 ends at key 65537", make, np.zeros((1, 1, 5), bool), 0.1, (0, 0, 3276.5))
        self.refuses(ValueError, "corner", make, np.zeros((1, 1, 5), bool), 0.1, (0, 0, np.nan))
        self.refuses(ValueError, "resolution", frontlux.VoxelGrid, -1.0)
        grid = make(room(), 0.1)
        self.refuses(ValueError, r"min_key: has to be one key, of shape \(3,\)", grid.states, np.zeros((2, 3), "u2"), (0, 0, 0))
        self.refuses(ValueError, "at most 2\\^31", grid.states, (0, 0, 0), (65535, 65535, 65535))
        self.refuses(ValueError, "points: number 1", grid.keys_of, np.array([[0, 0, 0], [0, 0, 1e9]]))
        self.refuses(ValueError, "free or occupied", grid.keys, Occupancy.UNKNOWN)
        for keys in ([-1, 0, 0], [[0, 0, 0], [0, 65536, 0]]):
            self.refuses(ValueError, "0 to 65535", grid.at, keys)
        self.refuses(TypeError, "integers", grid.at, [0.5, 1.0, 2.0])
        self.assertEqual(grid.at([0, 0, 65535]), Occupancy.UNKNOWN)
        self.refuses(RuntimeError, "no_such_file.bt", frontlux.VoxelGrid.read, "no_such_file.bt")
        self.refuses(ValueError, "resolution", self.caster.update, frontlux.VoxelGrid(0.2))

    def test_live_maps(self):
        live = frontlux.LiveMap(0.1)
        self.refuses(ValueError, "LiveMap", live.caster.update, live.grid)
        self.refuses(ValueError, "origin", live.insert, self.points, (np.nan, 0, 0))
        self.refuses(ValueError, "max_range", live.insert, self.points, (0, 0, 0), np.nan)
        self.refuses(ValueError, r"pose: has to be of shape \(4, 4\)", live.insert_scan, self.points, np.ones((3, 4)))
        self.refuses(ValueError, "rotation", live.insert_scan, self.points, 2 * np.eye(4))
        shifted = np.eye(4)
        shifted[:3, 3] = 1.0, 2.0, 3.0
        for wrong in (np.diag([1.0, 1.0, -1.0, 1.0]), np.ascontiguousarray(shifted.T), np.diag([1.0, 1.0, 1.0, 2.0]),
                      np.full((4, 4), np.nan)):
            self.refuses(ValueError, r"pose: .*rotation.*\(0, 0, 0, 1\)", live.insert_scan, self.points, wrong)
        live.insert_scan(self.points, shifted)
        self.refuses(ValueError, r"ends in \.bt or \.ot", live.write, "map.txt")

    def test_changes_that_do_not_follow(self):
        a, b = frontlux.LiveMap(0.1), frontlux.LiveMap(0.1)
        frontiers, image = frontlux.FrontierSet(a.grid), frontlux.ViewQualityImage(0.1, frontlux.FieldOfView.cone(1.0, 3.0))
        insert = lambda live, x: live.insert([[x, 0.05, 0.05]], (0.05, 0.05, 0.05))
        def update(change):
            image.update(a.caster, a.grid.keys(Occupancy.FREE), frontiers.keys, change)
        first = insert(a, 1.0)
        frontiers.update(first)
        update(first)
        other, _, third = insert(b, -1.0), insert(a, 2.0), insert(a, 3.0)
        keys, gain = frontiers.keys, image.gain
        for change in (other, third, insert(frontlux.LiveMap(0.2), 1.0)):
            self.refuses(ValueError, "", frontiers.update, change)
            self.refuses(ValueError, "", update, change)
        self.refuses(ValueError, "change: .*another map", frontiers.update, other)
        np.testing.assert_array_equal(frontiers.keys, keys)
        np.testing.assert_array_equal(image.gain, gain)
        # Whoever begins anew goes on; so does who takes every change.
        frontiers = frontlux.FrontierSet(a.grid)
        image.render(a.caster, a.grid.keys(Occupancy.FREE), frontiers.keys)
        last = insert(a, 4.0)
        frontiers.update(last)
        update(last)
        np.testing.assert_array_equal(frontiers.keys, frontlux.FrontierSet(a.grid).keys)

    def test_changes_of_other_resolutions(self):
        self.refuses(ValueError, "0.1.* and of 0.2.* m cannot be compared", frontlux.MapChange, frontlux.VoxelGrid(0.1), frontlux.VoxelGrid(0.2))
        self.refuses(TypeError, "incompatible", frontlux.MapChange, frontlux.VoxelGrid(0.1), None)

    def test_views(self):
        view = frontlux.FieldOfView.cone(0.5, 2.0)
        self.refuses(ValueError, "offsets", view.contains, np.ones((3, 2)), 0.0)
        self.refuses(ValueError, "yaw and offsets|offsets and yaw", view.contains, np.ones((3, 3)), [0.0, 1.0])
        self.refuses(TypeError, "yaw", view.contains, np.ones((3, 3)), None)

    def test_rays_that_octomap_cannot_follow(self):
        fine = frontlux.LiveMap(0.001)
        self.refuses(ValueError, "a ray passes 120000 voxels.*give a max_range", fine.insert, [[0.0, 0.0, 0.0], [25.0, 25.0, 25.0]],
                     (-15.0, -15.0, -15.0))
        self.assertEqual(fine.grid.count()[1:], [0, 0])
        fine.insert([[25.0, 25.0, 25.0]], (-15.0, -15.0, -15.0), 1.0)
        self.assertGreater(fine.grid.count()[1], 1000)
        # The end of what would be free is outside the key range.
        self.assertEqual(fine.insert([[60.0, 0.0, 0.0]], (30.0, 0.0, 0.0), 5.0).keys.size, 0)
        # Nearer to each other than a float can tell, in two voxels; and so far that their distance is infinite.
        self.assertEqual(frontlux.LiveMap(0.1).insert([[-1e-30, -1e-30, 0.05]], (1e-30, 1e-30, 0.05)).keys.size, 0)
        self.assertEqual(frontlux.LiveMap(1e15).insert([[3e19, 3e19, 3e19]], (-3e19, 0.0, 0.0)).keys.size, 0)

    def test_objects_that_were_never_made(self):
        for kind in (frontlux.VoxelGrid, frontlux.RayCaster, frontlux.LiveMap, frontlux.FieldOfView, frontlux.MapChange,
                     frontlux.FrontierSet, frontlux.ViewQualityImage):
            for name, member in vars(kind).items():
                if isinstance(member, property):
                    self.refuses(RuntimeError, "", getattr, kind.__new__(kind), name)
        self.refuses(TypeError, "No constructor", frontlux.FieldOfView)

    def test_none_is_no_object(self):
        self.refuses(TypeError, "incompatible", frontlux.VoxelGrid.count, None)
        self.refuses(TypeError, "incompatible", frontlux.RayCaster, None)
        self.refuses(TypeError, "incompatible", frontlux.FrontierSet(frontlux.VoxelGrid(0.1)).update, None)
        self.refuses(TypeError, "incompatible", frontlux.ViewQualityImage, 0.1, None)
        self.refuses(TypeError, "incompatible", self.caster.update, None)
        self.assertNotEqual(frontlux.VoxelGrid(0.1), None)


class Maps(unittest.TestCase):
    def test_grids_are_arrays_and_back(self):
        states = np.random.default_rng(2).integers(0, 3, (9, 20, 17), np.uint8)
        grid = frontlux.VoxelGrid.from_occupancy(states, 0.2, corner=(-1.0, 0.4, 3.0))
        low = grid.keys_of((-0.9, 0.5, 3.1))
        np.testing.assert_array_equal(grid.states(low, low + np.uint16([8, 19, 16])), states)
        self.assertEqual(repr(grid), "<frontlux.VoxelGrid of 0.2 m: known within 9 x 20 x 17 voxels>")
        self.assertEqual(repr(frontlux.VoxelGrid(0.1)), "<frontlux.VoxelGrid of 0.1 m: all unknown>")
        self.assertEqual(grid.count()[1:], [(states == 1).sum(), (states == 2).sum()])
        np.testing.assert_array_equal(grid.keys(Occupancy.FREE), np.argwhere(states == 1) + low)
        np.testing.assert_array_equal(grid.at(grid.keys(Occupancy.OCCUPIED)), 2)
        np.testing.assert_allclose(grid.centers(low), [-0.9, 0.5, 3.1], atol=1e-6)
        grid.set_states(low, states > 1)
        self.assertEqual(grid.count()[2], (states == 2).sum())
        self.assertEqual(grid.count()[1], (states != 2).sum())

    def test_copies_are_snapshots(self):
        grid = frontlux.VoxelGrid.from_occupancy(room(), 0.1)
        for other in (grid.copy(), copy.copy(grid), copy.deepcopy(grid)):
            self.assertEqual(grid, other)
            other.set_states((1, 2, 3), np.ones((1, 1, 1), bool))
            self.assertNotEqual(grid, other)
        self.assertNotEqual(grid, 3)
        self.assertIsNone(frontlux.VoxelGrid(0.1).known_bounds)
        np.testing.assert_array_equal(grid.known_bounds, [[32768] * 3, [32787] * 3])

    def test_a_caster_follows_its_live_map(self):
        live = frontlux.LiveMap(0.1)
        caster, frontiers = live.caster, frontlux.FrontierSet(live.grid)
        random = np.random.default_rng(3)
        for _ in range(5):
            before = live.grid
            change = live.insert(random.uniform(-2, 2, (300, 3)), (0.05, 0.05, 0.05), max_range=1.5)
            self.assertFalse(change.keys.flags.writeable)
            self.assertTrue((before.at(change.keys) != live.grid.at(change.keys)).all())
            self.assertEqual(change.grid, live.grid)
            origins, directions = random_rays(2000, 4, -1, 1)
            np.testing.assert_array_equal(caster.cast(origins, directions)["key"],
                                          frontlux.RayCaster(live.grid).cast(origins, directions)["key"])
            frontiers.update(change)
            np.testing.assert_array_equal(frontiers.keys, frontlux.FrontierSet(live.grid).keys)

    def test_scans_with_poses(self):
        points = np.random.default_rng(5).normal(size=(500, 3))
        pose = np.eye(4)
        pose[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
        pose[:3, 3] = [0.3, 0.2, 0.1]
        a, b = frontlux.LiveMap(0.1), frontlux.LiveMap(0.1)
        a.insert_scan(points, pose, 2.0)
        b.insert(np.float32(points) @ pose[:3, :3].T + pose[:3, 3], pose[:3, 3].copy(), 2.0)
        self.assertEqual(a.grid, b.grid)
        points[::7] = np.nan
        points[::11] = np.inf
        a.insert_scan(points, pose)
        self.assertGreater(a.grid.count()[2], 100)

    def test_files(self):
        live = frontlux.LiveMap.read(MAPS / "color_room_0.2m.ot")
        live.insert(np.array([[1.0, 1.0, 1.0]]), (2, 2, 1))
        with tempfile.TemporaryDirectory() as folder:
            for name in ("map.bt", "map.ot"):
                live.write(os.path.join(folder, name))
                self.assertEqual(frontlux.VoxelGrid.read(pathlib.Path(folder) / name), live.grid)

    def test_view_quality(self):
        grid = frontlux.VoxelGrid.read(MAPS / "storage_0.2m.bt")
        caster, view = frontlux.RayCaster(grid), frontlux.FieldOfView.pyramid(1.5, 1.0, 5.0)
        free = np.ascontiguousarray(grid.keys(Occupancy.FREE)[::997])
        targets = frontlux.FrontierSet(grid, *grid.known_bounds).keys
        exact = frontlux.ViewQualityImage(0.2, view, "exact", azimuth_bins=16)
        exact.render(caster, free, targets)
        every = frontlux.ViewQualityImage(0.2, view, samples=None)
        every.render(caster, free, targets)
        np.testing.assert_array_equal(exact.gain, every.gain)
        np.testing.assert_array_equal(exact.bin_hits.sum(axis=1), exact.gain)
        self.assertEqual(exact.best, np.argmax(exact.gain))
        np.testing.assert_array_equal(exact.viewpoints, free)
        yaw, hits = frontlux.best_window(exact.bin_hits[exact.best], 1.5)
        self.assertLessEqual(hits, exact.gain[exact.best])
        self.assertLessEqual(abs(yaw), np.pi)
        for wrong, error in (([1, -2, 3, 4], ValueError), ([2**32, 1], ValueError), ([0.5, 1.0], TypeError), ("many", TypeError)):
            with self.assertRaisesRegex(error, "bin_hits"):
                frontlux.best_window(wrong, 2.0)
        self.assertEqual(frontlux.best_window([1, 2, 3, 4], 2.0)[1], 4)
        # By hand, for the best one.
        seen = caster.visible(free[exact.best], targets)
        self.assertGreaterEqual(seen.sum(), exact.gain[exact.best])

    def test_changes_of_grids_that_were_written_to(self):
        random = np.random.default_rng(3)
        grid = frontlux.VoxelGrid.from_occupancy(random.integers(0, 3, (30, 30, 30), np.uint8), 0.2)
        view = frontlux.FieldOfView.spinning(1.0, 2.0)
        frontiers, image = frontlux.FrontierSet(grid), frontlux.ViewQualityImage(0.2, view, samples=None)
        caster = frontlux.RayCaster(grid)
        viewpoints = np.ascontiguousarray(grid.keys(Occupancy.FREE)[::50])
        image.render(caster, viewpoints, frontiers.keys)
        low, size = grid.known_bounds[0] + np.uint16([3, 20, 11]), (6, 5, 9)
        for _ in range(3):
            before, states = grid.copy(), random.integers(0, 3, size, np.uint8)
            was = before.states(low, low + np.uint16(size) - np.uint16(1))
            grid.set_states(low, states)
            change = frontlux.MapChange(before, grid)
            np.testing.assert_array_equal(change.keys, np.argwhere(was != states) + low)
            self.assertEqual(change.grid, grid)
            frontiers.update(change)
            np.testing.assert_array_equal(frontiers.keys, frontlux.FrontierSet(grid).keys)
            caster.update(grid)
            image.update(caster, viewpoints, frontiers.keys, change)
            anew = frontlux.ViewQualityImage(0.2, view, samples=None)
            anew.render(caster, viewpoints, frontiers.keys)
            np.testing.assert_array_equal(image.gain, anew.gain)
        self.assertEqual(frontlux.MapChange(grid, grid).keys.shape, (0, 3))

    def test_what_is_in_view(self):
        offsets = np.random.default_rng(4).uniform(-4, 4, (40, 50, 3))
        distance = np.linalg.norm(offsets, axis=-1)
        azimuth, elevation = np.arctan2(offsets[..., 1], offsets[..., 0]), np.arcsin(offsets[..., 2] / distance)
        turned = np.angle(np.exp(1j * (azimuth - 2.5)))  # seen from a yaw of 2.5
        lidar, camera, sonar = (frontlux.FieldOfView.spinning(0.8, 3.0), frontlux.FieldOfView.pyramid(1.2, 0.7, 3.5),
                                frontlux.FieldOfView.cone(1.0, 4.0))
        expected = {lidar: (distance < 3.0) & (np.abs(elevation) < 0.4),
                    camera: (distance < 3.5) & (np.abs(turned) < 0.6) &
                            (np.abs(offsets[..., 2]) < np.tan(0.35) * np.hypot(*offsets[..., :2].T).T * np.cos(turned)),
                    sonar: (distance < 4.0) & (np.arccos(np.cos(elevation) * np.cos(turned)) < 0.5)}
        for view, seen in expected.items():
            self.assertGreater(seen.sum(), 5)
            np.testing.assert_array_equal(view.contains(offsets, 2.5), seen, view.shape)
            np.testing.assert_array_equal(view.contains(offsets, np.full((40, 50), 2.5)), seen)
            self.assertFalse(view.contains((0.0, 0.0, 0.0), 2.5))
        self.assertEqual([(v.shape, v.horizontal, v.vertical, v.max_range) for v in expected],
                         [("spinning", None, 0.8, 3.0), ("pyramid", 1.2, 0.7, 3.5), ("cone", 1.0, None, 4.0)])
        turns = np.linspace(-3, 3, 13)
        np.testing.assert_array_equal(sonar.contains((1.0, 0.0, 0.0), turns), np.abs(turns) <= 0.5)

    def test_cameras(self):
        intrinsics = np.array([[500.0, 0, 320], [0, 510, 240], [0, 0, 1]])
        directions = frontlux.pinhole_directions(intrinsics, 640, 480)
        self.assertEqual(directions.shape, (480, 640, 3))
        fine = np.array([[500.0, 0, 320.1], [0, 510, 240.1], [0, 0, 1]])
        v, u = np.indices((480, 640)) + 0.5
        centers = np.stack([(u - 320.1) / 500, (v - 240.1) / 510, np.ones_like(u)], axis=-1)
        centers /= np.sqrt((centers**2).sum(axis=-1, keepdims=True))
        ours = frontlux.pinhole_directions(fine, 640, 480)
        # Some are rounded to the other neighbour in float32; with intrinsics in float32 two fifths would be.
        self.assertLess((ours != np.float32(centers)).mean(), 1e-3)
        pixels = directions[17, 5] @ intrinsics.T
        np.testing.assert_allclose(pixels[:2] / pixels[2], [5.5, 17.5], atol=1e-3)
        self.assertEqual(frontlux.FieldOfView.cone(0.3, 2.0).directions(10, 3).shape, (3, 10, 3))


class Module(unittest.TestCase):
    def test_everything_is_documented_and_typed(self):
        public_names.expect_documented_and_typed(self, frontlux, {"IntEnum"})

    def test_its_version_is_that_of_the_project(self):
        project = (pathlib.Path(__file__).parents[2] / "CMakeLists.txt").read_text()
        self.assertIn(f"project(frontlux VERSION {frontlux.__version__} ", project.replace("\n", " "))

    @unittest.skipUnless(np.__version__.startswith("1."), "may be built for numpy 2")
    def test_a_numpy_that_it_cannot_read_is_refused(self):
        script = "import sys, types; numpy = sys.modules['numpy'] = types.ModuleType('numpy'); numpy.__version__ = '2.0.1'; import frontlux"
        done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        self.assertIn("ImportError: numpy 2.0.1, but this frontlux", done.stderr)

    def test_import_is_quick(self):
        def seconds(code):
            """Of processors: the clock would count what else runs on this machine."""
            begin = os.times()
            subprocess.run([sys.executable, "-c", code], check=True)
            end = os.times()
            return end.children_user + end.children_system - begin.children_user - begin.children_system
        ours, of_numpy = zip(*([seconds(f"import {name}") for name in ("frontlux", "numpy")] for _ in range(5)))
        print(f"import frontlux: {1e3 * min(ours):.0f} ms, numpy: {1e3 * min(of_numpy):.0f} ms")
        self.assertLess(min(ours), 2 * min(of_numpy))


if __name__ == "__main__":
    unittest.main()
