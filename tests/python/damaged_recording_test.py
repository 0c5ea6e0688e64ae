"""Recordings that are damaged, or made to take more than they bring: what is read of them, and what that takes."""
import pathlib
import struct
import sys
import tempfile
import tracemalloc
import unittest
from unittest import mock

import numpy as np

import frontlux
from frontlux import _recording
from recording_test import record, whole

TITLE = b"frontlux recording, format 5\n"


def head(robots, starts=None, options=b"{}", boxes=b"\0"):
    """Of a run of so many robots in a map of all keys."""
    robot = b"\1r" + bytes(1 + 24 + 1 + 16 + 3) + boxes + bytes(24 + 1 + 24 + 24 + 1 + 8 + 2)
    text = whole(len(options)) + options
    starts = whole(robots) + bytes(33 * robots) if starts is None else starts
    return b"\1w" + bytes(8 + 3) + 3 * whole(0xFFFF) + bytes(2) + text + whole(robots) + robots * robot + starts


def step(number, robots, changes=b"\0", unknown=b"\0", tour=b"\0", reassigned=b"\0"):
    """Of robots that all do the same."""
    robot = bytes(5 + 8 + 7 + 32 + 4 + 1) + changes + unknown + bytes(2) + tour + b"\0" + reassigned
    return whole(number) + bytes(5 + 56) + whole(robots) + bytes(2 * robots) + whole(robots) + robots * robot


class Cost:
    """What a reading takes, beside numpy's time, which follows from the bytes that a record holds: calls of functions, and
    memory [bytes] at its peak."""

    def __enter__(self):
        self.calls = 0
        tracemalloc.start()
        sys.setprofile(self._note)
        return self

    def _note(self, _frame, event, _what):
        self.calls += event in ("call", "c_call")

    def __exit__(self, *_):
        sys.setprofile(None)
        self.memory = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()


class Damage(unittest.TestCase):
    """No file of less than 100 kB may take more than 10 s or 1 GB; these are smaller, and may take as much less."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.file = pathlib.Path(self.folder.name) / "bad.frontlux"

    def read(self, data):
        """What is wrong with a recording, or an empty text."""
        self.file.write_bytes(data)
        what = ""
        with Cost() as cost:
            try:
                frontlux.read_recording(self.file)
            except RuntimeError as error:
                what = str(error)
        if what:
            self.assertRegex(what, "bad.frontlux: .")
        self.assertLess(cost.calls, 200 * len(data) + 50_000)
        self.assertLess(cost.memory, 10_000 * len(data) + 10_000_000)
        return what

    def test_few_bytes_that_stand_for_many(self):
        def made(begin, *steps):
            data = TITLE + record(b"head", begin) + b"".join(record(b"step", one) for one in steps)
            self.assertLess(len(data), 30_000)
            return self.read(data)

        many, bytes_of = 60_000, 2_000_000
        for lists in ({"changes": whole(many) + bytes(3 * many) + b"\1" * many},
                      {"tour": whole(many) + bytes(34 * many)},
                      {"tour": whole(many) + (bytes(32) + b"\x80\0\x80\0") * many},
                      {"unknown": whole(many) + bytes(3 * many)}, {"reassigned": whole(many) + bytes(3 * many)}):
            self.assertEqual(made(head(1), step(0, 1, **lists)), "")
        too_many = whole(bytes_of) + bytes(bytes_of)
        self.assertRegex(made(head(1, whole(bytes_of // 33) + bytes(bytes_of))), "not one start for each robot")
        self.assertRegex(made(head(1), bytes(6 + 56) + too_many), "not as many robots as the team")
        self.assertRegex(made(head(1, boxes=too_many)), "longer than what is there")
        self.assertRegex(made(head(1, options=b"[" * (_recording._MOST_OPTIONS + 1))), "at most 16777216 are read")
        few = b"\1" + 3 * b"\x80\0"
        with mock.patch.object(_recording, "_MOST_STEPS", 100):
            for lists in ({}, {"unknown": few, "reassigned": few}):
                steps = [step(number, 300, **lists) for number in range(20)]
                self.assertRegex(made(head(300), *steps), "more steps and lists than so few bytes can")

    def test_replayed(self):
        tour = whole(2) + 2 * (struct.pack("<4d", 1, 2, 3, 4) + whole(300) + b"\1")
        keys = whole(3) + 3 * (whole(2 * 40_000) + bytes(2))
        seeds = [(b"head", head(2)), (b"step", step(0, 2, whole(3) + keys[1:] + b"\1\2\5", keys, tour, keys)),
                 (b"step", step(1, 2, tour=tour)), (b"end ", b"\7stopped")]
        self.assertEqual(self.read(TITLE + b"".join(record(*seed) for seed in seeds)), "")
        random = np.random.default_rng(6)

        def damaged(plain):
            plain, at = bytearray(plain), int(random.integers(len(plain)))
            kind = random.integers(5)
            if kind == 0:
                plain[at] = random.integers(256)
            elif kind == 1:
                del plain[at:at + int(random.integers(1, 9))]
            elif kind == 2:
                plain[at:at] = plain[at // 2:at // 2 + 20]
            elif kind == 3:  # a count beyond what is there
                plain[at:at + 1] = whole(1 << int(random.integers(64)))
            else:
                del plain[at:]
            return bytes(plain)

        refused = 0
        for _ in range(150):
            records, bad = list(seeds), random.integers(len(seeds))
            records[bad] = records[bad][0], damaged(records[bad][1])
            data = TITLE + b"".join(record(*one) for one in records)
            refused += self.read(data if random.random() < 0.8 else damaged(data)) != ""
        self.assertGreater(refused, 40)
        self.assertLess(refused, 145)


if __name__ == "__main__":
    unittest.main()
