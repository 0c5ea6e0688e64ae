#!/usr/bin/env python3
"""Prints a line for each step of a run: read_recording.py DIR/run.frontlux. The format: docs/recording.md."""
import struct
import sys
import zlib


class Bytes:
    def __init__(self, data): self.data, self.at = data, 0

    def take(self, size):
        self.at += size
        return self.data[self.at - size:self.at]

    def count(self):
        value = shift = 0
        while (byte := self.take(1)[0]) >= 0x80:
            value, shift = value | (byte & 0x7F) << shift, shift + 7
        return value | byte << shift

    def counts(self, how_many): return [self.count() for _ in range(how_many)]
    def doubles(self, how_many): return struct.unpack(f"<{how_many}d", self.take(8 * how_many))


def step_line(step, version):
    number, frontiers, _unassigned, _abandoned, _rays, _contacts = step.counts(6)
    (time,) = step.doubles(1)
    step.doubles(6)  # that each phase took
    known = [step.counts(2) for _ in range(step.count())]
    line = f"step {number} until {time:.1f} s: {frontiers} frontiers"
    for robot in range(step.count()):
        step.counts(5)  # gains, and the viewpoints travelled
        (length,) = step.doubles(1)
        step.counts(2)  # path outcome, goal state
        step.doubles(4 if step.take(1)[0] else 0)  # goal: x, y, z, yaw
        step.counts(3)  # its voxel
        step.take(step.count())  # the goal's reason
        step.doubles(4), step.counts(4)
        planned = [step.doubles(4) for _ in range(step.count())]
        changes = step.count()
        step.counts(3 * changes)  # keys
        after = [pair % 3 for pair in step.counts(changes)]
        step.counts(3 * step.count())  # frontiers still unknown
        step.counts(3 * step.count())  # blocked cells
        cells = step.count()
        step.counts(3 * cells), step.doubles(5 * cells), step.counts(cells)  # the image
        stops = [(step.doubles(4), step.counts(2)) for _ in range(step.count())] if version > 3 else []
        trajectory = [step.doubles(4) for _ in range(step.count())] if version > 4 else []
        step.counts(3 * step.count() if version > 4 else 0)  # frontiers that have become its own, or ceased to be
        line += (f"; robot {robot}: {length:.2f} m, {len(planned)} viewpoints, {after.count(1)} voxels free, "
                 f"{after.count(2)} occupied, knows {known[robot][0]}, tour of {len(stops)} stops, trajectory of {len(trajectory)} poses")
    return line


with open(sys.argv[1], "rb") as file:
    title = file.readline()
    if title not in [b"frontlux recording, format %d\n" % version for version in (3, 4, 5)]:
        sys.exit(f"{sys.argv[1]}: {title!r} is not 'frontlux recording, format 3' to 5; read it with the frontlux that wrote it")
    version = int(title.split()[-1])
    data, at = file.read(), 0
    zeros = len(data.rstrip(b"\0"))  # where they begin that a loss of power has left
    while at + 16 <= len(data):
        tag, packed, _plain, checksum = struct.unpack_from("<4s3I", data, at)
        whole = zlib.crc32(data[at:at + 12]) == checksum
        begin, at = at + 16, at + 16 + (packed + 4 if whole else 0)
        whole = whole and at <= len(data) and zlib.crc32(data[begin:at - 4]) == struct.unpack_from("<I", data, at - 4)[0]
        if not whole and zeros >= at:
            sys.exit(f"{sys.argv[1]}: damaged before byte {len(title) + at}")
        if not whole:
            break  # the run was cut off here
        record = Bytes(zlib.decompress(data[begin:at - 4]))
        if tag == b"step":
            print(step_line(record, version))
        elif tag == b"end ":
            print("end:", record.take(record.count()).decode())
