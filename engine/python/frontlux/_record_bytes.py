"""The plain bytes of a recording's record, read as arrays."""
import re
from math import prod

import numpy as np

MOST_BYTES = 1 << 30  # of a record
POSE_BYTES, KEY_BYTES = 32, 3  # of a key: at least
_PART = 1 << 16  # whole numbers at once: what a few bytes are packed from may be many
_DIGITS = 10  # of a whole number, at most
_SEEN = re.compile(rb"(?:[\x80-\xff]{0,9}[\0-\x7f]){2}")  # from a stop of a tour: two whole numbers


class RecordBytes:
    """Whole numbers of 7 bits a byte, lowest first; doubles; texts."""

    def __init__(self, data):
        self.data, self.bytes, self.at = data, np.frombuffer(data, np.uint8), 0
        self.parts = 0  # of lists, that have been read

    def take(self, size):
        if size > len(self.data) - self.at:
            raise ValueError("a record ends too early")
        self.at += size
        return self.bytes[self.at - size:self.at]

    def counts(self, how_many, dtype=np.int64, make=lambda part: part):
        """(how_many,) of a type, of what is made of each part"""
        numbers, done = np.empty(how_many, dtype), 0
        while done < how_many:
            part = make(self._part(min(how_many - done, _PART)))
            numbers[done:done + len(part)] = part
            done += len(part)
        return numbers

    def _part(self, most):
        """int64, at least one number and at most so many: those that end in so many bytes and some more"""
        self.parts += 1
        begin = self.bytes[self.at:self.at + most + _DIGITS - 1]
        if len(begin) >= most and begin[:most].max() < 0x80:
            return self.take(most).astype(np.int64)
        ends = np.flatnonzero(begin < 0x80)[:most]
        begins = np.concatenate(([0], ends + 1))[:-1]
        if (ends - begins).max(initial=0) >= _DIGITS or len(ends) == 0 and len(begin) >= _DIGITS:
            raise ValueError("a whole number has more than 64 bits")
        if len(ends) == 0:
            raise ValueError("a record ends too early")
        digits = self.take(int(ends[-1]) + 1).astype(np.int64) & 0x7F
        shifts = 7 * (np.arange(len(digits)) - np.repeat(begins, ends - begins + 1))
        numbers = np.add.reduceat(digits << shifts, begins)
        if numbers.min() < 0 or (digits[shifts == 63] > 0).any():
            raise ValueError("a whole number is too large")
        return numbers

    def count(self):
        value = shift = 0
        while shift < 64:
            byte = self.data[self.at]
            self.at += 1
            value, shift = value | (byte & 0x7F) << shift, shift + 7
            if byte < 0x80:
                if value >> 63:
                    raise ValueError("a whole number is too large")
                return value
        raise ValueError("a whole number has more than 64 bits")

    def length(self, element=1):
        """Of a list, each of whose elements has so many bytes at least."""
        size = self.count()
        if size > (len(self.data) - self.at) // element:
            raise ValueError("a list is longer than what is there")
        return size

    def doubles(self, *shape):
        return self.take(8 * prod(shape)).view("<f8").astype(np.float64).reshape(shape)

    def text(self, most=MOST_BYTES):
        size = self.length()
        if size > most:
            raise ValueError(f"a text has {size} bytes, but at most {most} are read")
        return self.take(size).tobytes().decode("utf-8", "replace")

    def keys(self, how_many):
        """(how_many, 3) uint16, from differences: all x, then y, then z"""
        last = 0

        def places(zigzag):
            nonlocal last
            keys = last + np.cumsum((zigzag >> 1) ^ -(zigzag & 1))
            if keys.min() < 0 or keys.max() > 0xFFFF:
                raise ValueError("a voxel lies outside the key range")
            last = keys[-1]
            return keys

        keys = np.empty((how_many, 3), np.uint16)
        for axis in keys.T if how_many else ():
            last = 0
            axis[:] = self.counts(how_many, np.uint16, places)
        return keys

    def states(self, how_many):
        """(how_many,) uint8, each of what a voxel was and became"""
        def known(states):
            if states.max() > 8:
                raise ValueError("a voxel changes to no state")
            return states

        return self.counts(how_many, np.uint8, known)

    def stops(self, how_many):
        """Of a tour: (how_many, 4) float64, poses; (how_many, 2) int64, clusters and frontiers in view."""
        poses, seen = np.empty((how_many, 4)), np.empty((how_many, 2), np.int64)
        for begin in range(0, how_many, _PART):
            part = slice(begin, min(begin + _PART, how_many))
            self.parts += 1
            begins, at = np.empty(part.stop - begin, np.int64), self.at
            for i in range(len(begins)):
                begins[i] = at
                numbers = _SEEN.match(self.data, at + POSE_BYTES)
                if numbers is None:
                    raise ValueError("a tour ends too early, or a whole number in it has more than 64 bits")
                at = numbers.end()
            begins -= self.at
            stops = self.take(at - self.at)
            is_pose = np.zeros(len(stops), bool)
            is_pose[begins[:, None] + np.arange(POSE_BYTES)] = True
            poses[part] = stops[is_pose].view("<f8").reshape(-1, 4)
            seen[part] = RecordBytes(stops[~is_pose].tobytes()).counts(2 * len(begins)).reshape(-1, 2)
        return poses, seen
