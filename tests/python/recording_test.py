"""Recordings as arrays, against what the same run wrote as tables and as a map; and damaged ones."""
import csv
import dataclasses
import json
import os
import pathlib
import struct
import subprocess
import tempfile
import tracemalloc
import unittest
import zlib
from unittest import mock

import numpy as np

import frontlux
from frontlux import _record_bytes


def explore(folder, *options):
    subprocess.run([os.environ["FRONTLUX_COMMAND"], "explore", "room", "--seed", "1", *options, "-o", folder], check=True,
                   stdout=subprocess.DEVNULL)


def whole(number):
    digits = bytearray()
    while number > 0x7F:
        digits.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes(digits + bytes([number]))


def record(tag, plain):
    payload = zlib.compress(plain)
    sizes = struct.pack("<4s2I", tag, len(payload), len(plain))
    return sizes + struct.pack("<I", zlib.crc32(sizes)) + payload + struct.pack("<I", zlib.crc32(payload))


class WholeNumbers(unittest.TestCase):
    def test_those_written_are_read_in_parts_of_any_size(self):
        random = np.random.default_rng(1)
        numbers = [0, 0x7F, 0x80, 2**63 - 1] + [int(random.integers(2**63)) >> int(random.integers(63)) for _ in range(200)]
        data = b"".join(map(whole, numbers))
        for part in (1, 2, 7, 203, 204, 1000):
            with mock.patch.object(_record_bytes, "_PART", part):
                read = _record_bytes.RecordBytes(data + b"\5")
                self.assertEqual(read.counts(len(numbers)).tolist(), numbers)
                self.assertEqual(read.count(), 5)
                self.assertEqual(read.counts(0).tolist(), [])
                with self.assertRaisesRegex(ValueError, "ends too early"):
                    _record_bytes.RecordBytes(data[:-1] + b"\x80").counts(len(numbers))

    def test_too_large_ones_are_refused(self):
        for data, what in ((whole(2**63), "too large"), (whole(2**64 - 1), "too large"), (b"\x80" * 11, "more than 64 bits"),
                           (b"\x80" * 9, "ends too early"), (b"\xff" * 10 + b"\1", "more than 64 bits")):
            with self.subTest(data=data), self.assertRaisesRegex(ValueError, what):
                _record_bytes.RecordBytes(data).counts(1)

    def test_keys_are_sums_of_differences_across_parts(self):
        keys = np.random.default_rng(2).integers(0x10000, size=(50, 3))
        steps = np.diff(keys, axis=0, prepend=0).T
        data = b"".join(whole(2 * int(step) if step >= 0 else -2 * int(step) - 1) for step in steps.ravel())
        for part in (1, 7, 50, 1000):
            with mock.patch.object(_record_bytes, "_PART", part):
                np.testing.assert_array_equal(_record_bytes.RecordBytes(data).keys(50), keys)
        for outside in (b"\1\0\0", whole(2 * 0x10000) + b"\0\0"):
            with self.assertRaisesRegex(ValueError, "outside the key range"):
                _record_bytes.RecordBytes(outside).keys(1)


    def test_stops_are_those_of_a_plain_loop(self):
        random = np.random.default_rng(4)

        def number():
            if random.random() < 0.1:  # with bytes that it does not need
                return b"\x80" * int(random.integers(10)) + b"\0"
            return whole(int(random.integers(2**63)) >> int(random.integers(63)))

        stops = [(random.bytes(32), number(), number()) for _ in range(300)]
        data = b"".join(map(b"".join, stops))
        value = lambda digits: sum((digit & 0x7F) << 7 * i for i, digit in enumerate(digits))
        poses = b"".join(struct.pack("<4d", *struct.unpack("<4d", pose)) for pose, *_ in stops)
        seen = [[value(numbers) for numbers in stop[1:]] for stop in stops]
        for part in (1, 7, 299, 300, 1000):
            with mock.patch.object(_record_bytes, "_PART", part):
                read = _record_bytes.RecordBytes(data + b"\5")
                found = read.stops(300)
                self.assertEqual((found[0].tobytes(), found[1].tolist()), (poses, seen))
                self.assertEqual((found[0].shape, read.count()), ((300, 4), 5))
                for size in (len(data) - 1, len(data) - len(stops[-1][2]) - 20, 31):
                    with self.assertRaisesRegex(ValueError, "too early"):
                        _record_bytes.RecordBytes(data[:size]).stops(300)
        for bad, what in ((b"\x80" * 10 + b"\0", "more than 64 bits"), (whole(2**63), "too large")):
            with self.assertRaisesRegex(ValueError, what):
                _record_bytes.RecordBytes(data + bytes(32) + b"\1" + bad).stops(301)
        self.assertEqual([part.shape for part in _record_bytes.RecordBytes(b"").stops(0)], [(0, 4), (0, 2)])


class Recordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.run_folder = pathlib.Path(cls.folder.name) / "run"
        explore(cls.run_folder, "--lockstep")
        cls.recording = frontlux.read_recording(cls.run_folder / "run.frontlux")
        with open(cls.run_folder / "steps.csv", encoding="utf-8") as table:
            cls.rows = list(csv.DictReader(table))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def column(self, name, dtype=float):
        """A column of the table, whose rows are steps and in them robots, of shape (steps, robots)."""
        return np.array([row[name] for row in self.rows], dtype).reshape(-1, len(self.recording.robots))

    def test_the_head(self):
        self.assertEqual((self.recording.world, self.recording.robots), ("room", ["ugv", "uav"]))
        self.assertEqual(self.recording.resolution, 0.3)
        self.assertEqual(self.recording.options["seed"], 1)
        self.assertEqual(self.recording.starts.shape, (2, 4))
        self.assertEqual((self.recording.end, self.recording.truncated), ("nothing_to_do", False))

    def test_recordings_are_told_apart_and_shown_in_short(self):
        other = frontlux.read_recording(self.run_folder / "run.frontlux")
        self.assertEqual(self.recording, self.recording)
        self.assertNotEqual(self.recording, other)
        self.assertEqual(len({self.recording, self.recording, other}), 2)
        self.assertRegex(repr(other), r"^<frontlux.Recording of 'room': \d+ steps of ugv, uav; nothing_to_do>$")
        self.assertRegex(repr(dataclasses.replace(other, end=None)), "; unfinished>$")

    def test_steps_are_those_of_the_table(self):
        steps = self.recording.steps
        self.assertGreater(len(steps["number"]), 3)
        for name in ("frontiers", "unassigned", "abandoned", "contacts", "rays"):
            np.testing.assert_array_equal(steps[name], self.column(name, int)[:, 0], name)
        for name in ("gain_tangent", "gain_predicted", "gained"):
            np.testing.assert_array_equal(steps[name], self.column(name, int), name)
        np.testing.assert_allclose(steps["time"], self.column("time_s")[:, 0])
        np.testing.assert_allclose(steps["length"], self.column("length_m"), atol=1e-6)
        np.testing.assert_allclose(steps["known"] / self.recording.observable, self.column("robot_observable"))
        np.testing.assert_allclose(steps["seconds"][:, -1], self.column("moving_s")[:, 0])

    def test_poses_begin_at_the_starts_and_end_as_often_as_robots_travelled(self):
        poses = self.recording.poses
        for robot, start in enumerate(self.recording.starts):
            np.testing.assert_array_equal(poses["pose"][poses["robot"] == robot][0], start)
        self.assertEqual(len(poses["step"]), self.recording.steps["travelled"].sum())

    def test_changes_make_the_map(self):
        self.assertEqual(self.recording.grid(), frontlux.VoxelGrid.read(self.run_folder / "map.bt"))
        changes = self.recording.changes
        first = changes["step"] == 0
        _, places = np.unique(changes["keys"][first], axis=0, return_index=True)
        self.assertEqual(sum(self.recording.grid(0).count()[1:]), len(places))
        self.assertTrue((changes["before"] != changes["after"]).all())
        for step in (-1, len(self.recording.steps["number"])):
            with self.assertRaisesRegex(ValueError, f"step is {step}, but has to be 0 to"):
                self.recording.grid(step)

    def test_a_run_in_motion(self):
        folder = pathlib.Path(self.folder.name) / "motion"
        explore(folder)
        recording = frontlux.read_recording(folder / "run.frontlux")
        self.assertEqual(recording.grid(), frontlux.VoxelGrid.read(folder / "map.bt"))
        self.assertTrue((np.diff(recording.steps["time"]) >= 0).all())
        with open(folder / "tours.csv", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        tours = recording.tours
        np.testing.assert_array_equal(tours["step"], [int(row["step"]) for row in rows])
        self.assertEqual([recording.robots[robot] for robot in tours["robot"]], [row["robot"] for row in rows])
        np.testing.assert_allclose(tours["pose"], [[float(row[name]) for name in ("x_m", "y_m", "z_m", "yaw_rad")] for row in rows])
        for name in ("clusters", "frontiers"):
            np.testing.assert_array_equal(tours[name], [int(row[name]) for row in rows])
        plans, handed = recording.trajectories, recording.reassigned
        steps = set(recording.steps["number"])
        self.assertEqual(steps - {max(steps)} - set(plans["step"]), {0}, "steps in which nobody planned")
        self.assertEqual(plans["pose"].shape, (len(plans["step"]), 4))
        self.assertGreater(len(handed["keys"]), 100)
        low, high = recording.bounds
        self.assertTrue(((handed["keys"] >= low) & (handed["keys"] <= high)).all())

    def test_a_robot_on_the_ground(self):
        folder = pathlib.Path(self.folder.name) / "ground"
        robot = pathlib.Path(self.folder.name) / "ground.json"
        robot.write_text(json.dumps({
            "name": "rover", "motion": "ground", "step_m": 0.3, "slope_deg": 20, "mount_height_m": 0.5,
            "body": {"kind": "cylinder", "diameter_m": 0.6, "height_m": 0.5},
            "sensor": {"kind": "spinning", "vertical_deg": 40, "range_m": 6, "columns": 90, "rows": 16, "rate_hz": 2}}))
        explore(folder, "--team", "uav", "--robot", str(robot), "--max-steps", "4")
        recording = frontlux.read_recording(folder / "run.frontlux")
        self.assertEqual(recording.robots, ["rover", "uav"])
        self.assertEqual(recording.grid(), frontlux.VoxelGrid.read(folder / "map.bt"))

    def test_damage_is_found_and_named(self):
        whole = (self.run_folder / "run.frontlux").read_bytes()
        file = pathlib.Path(self.folder.name) / "damaged.frontlux"
        random = np.random.default_rng(1)
        for place in random.integers(len(whole), size=200):
            file.write_bytes(whole[:place] + bytes([whole[place] ^ 1 << random.integers(8)]) + whole[place + 1:])
            with self.assertRaisesRegex(RuntimeError, "damaged.frontlux"):
                frontlux.read_recording(file)
        file.write_bytes(b"frontlux recording, format 2\n")
        with self.assertRaisesRegex(RuntimeError, "has format 2, but this frontlux reads 3 to 5"):
            frontlux.read_recording(file)

    def test_what_has_its_checksums_but_no_run_has_written(self):
        whole = (self.run_folder / "run.frontlux").read_bytes()
        begin = whole.index(b"\n") + 1
        tag, packed, _, _ = struct.unpack("<4s3I", whole[begin:begin + 16])
        head = zlib.decompress(whole[begin + 16:begin + 16 + packed])
        options = head[head.index(b'{"'):head.index(b"}") + 1]
        file = pathlib.Path(self.folder.name) / "made.frontlux"
        for text, what in ((b"[1]", "options that are no object"), (b"{", "made.frontlux"), (b"\xff", "made.frontlux")):
            other = head.replace(options, text.ljust(len(options)))
            file.write_bytes(whole[:begin] + record(tag, other))
            with self.assertRaisesRegex(RuntimeError, what):
                frontlux.read_recording(file)

    def test_few_bytes_that_stand_for_many_take_little_more_than_what_is_read(self):
        whole_run = (self.run_folder / "run.frontlux").read_bytes()
        first = whole_run.index(b"\n") + 1
        head = whole_run[:first + 20 + struct.unpack("<I", whole_run[first + 4:first + 8])[0]]
        many = 1_000_000
        robot = bytes(5 + 8 + 3 + 4 + 32 + 4) + b"\0%b" + bytes(10)
        changes = whole(many) + bytes(3 * many) + b"\1" * many
        step = bytes(6 + 8 + 48) + b"\2" + bytes(4) + b"\2" + robot % changes + robot % b"\0"
        file = pathlib.Path(self.folder.name) / "many.frontlux"
        file.write_bytes(head + record(b"step", step))
        self.assertLess(file.stat().st_size - len(head), len(step) / 500)
        tracemalloc.start()
        try:
            with self.assertRaisesRegex(RuntimeError, "outside the bounds"):
                frontlux.read_recording(file)
            self.assertLess(tracemalloc.get_traced_memory()[1], 6 * len(step))
        finally:
            tracemalloc.stop()

    def test_a_grid_takes_no_memory_for_what_lies_between_its_voxels(self):
        changes = {"step": np.int64([0, 0, 0, 0]), "keys": np.uint16([[0, 0, 0], [65535] * 3, [7, 9, 40000], [7, 9, 40000]]),
                   "after": np.uint8([1, 2, 1, 2])}
        grid = dataclasses.replace(self.recording, changes=changes).grid()
        self.assertEqual(grid.count()[1:], [1, 2])
        np.testing.assert_array_equal(grid.at(changes["keys"]), [1, 2, 2, 2])

    def test_zeros_from_any_byte_on_are_an_unfinished_step(self):
        whole = (self.run_folder / "run.frontlux").read_bytes()
        file = pathlib.Path(self.folder.name) / "zeros.frontlux"
        begins, at = [], whole.index(b"\n") + 1
        while at < len(whole):
            begins.append(at)
            at += 20 + struct.unpack_from("<I", whole, at + 4)[0]
        random = np.random.default_rng(3)
        last = begins[-1]  # the record of the end
        for number, begin, end in ((3, begins[4], begins[5]), (len(begins) - 2, last, len(whole))):
            # Where a record ends in zeros of its own it is whole.
            for place in sorted({begin, begin + 1, begin + 8, begin + 15, begin + 16, end - 5, *random.integers(begin, end, 20)}):
                if not whole[place:end].strip(b"\0"):
                    continue
                file.write_bytes(whole[:place] + bytes(len(whole) - place + 100))
                with self.subTest(number=number, place=place - begin):
                    recording = frontlux.read_recording(file)
                    self.assertEqual((len(recording.steps["number"]), recording.end, recording.truncated), (number, None, True))

    def test_a_world_whose_files_name_is_not_utf_8_is_read(self):
        whole = (self.run_folder / "run.frontlux").read_bytes()
        begin = whole.index(b"\n") + 1
        packed = struct.unpack_from("<I", whole, begin + 4)[0]
        head = zlib.decompress(whole[begin + 16:begin + 16 + packed])
        self.assertEqual(head[:5], b"\4room")
        file = pathlib.Path(self.folder.name) / "name.frontlux"
        file.write_bytes(whole[:begin] + record(b"head", b"\4h\xe4us" + head[5:]) + whole[begin + 20 + packed:])
        self.assertEqual(frontlux.read_recording(file).world, "h\ufffdus")

    def test_a_recording_that_is_cut_off_is_read_up_to_there(self):
        whole = (self.run_folder / "run.frontlux").read_bytes()
        file = pathlib.Path(self.folder.name) / "cut.frontlux"
        file.write_bytes(whole[:len(whole) * 3 // 4])
        recording = frontlux.read_recording(file)
        self.assertEqual((recording.end, recording.truncated), (None, True))
        steps = len(recording.steps["number"])
        self.assertGreater(steps, 0)
        self.assertLess(steps, len(self.recording.steps["number"]))
        self.assertEqual(recording.grid(), self.recording.grid(steps - 1))
        file.write_bytes(whole + b"\0" * 5000)
        recording = frontlux.read_recording(file)
        self.assertEqual((recording.end, recording.truncated), (self.recording.end, False))
        file.write_bytes(whole + b"abc")
        with self.assertRaisesRegex(RuntimeError, "goes on after its end"):
            frontlux.read_recording(file)
        last = whole.rindex(b"end ")
        file.write_bytes(whole[:last] + b"abc")
        with self.assertRaisesRegex(RuntimeError, "no record begins here"):
            frontlux.read_recording(file)
        with self.assertRaises(FileNotFoundError):
            frontlux.read_recording(self.run_folder / "none")


if __name__ == "__main__":
    unittest.main()
