"""Recordings of explorations (run.frontlux) as arrays. Needs nothing but numpy."""
import json
import struct
import zlib
from dataclasses import dataclass
from os import fspath
from typing import Any, Dict, List, Optional

import numpy as np

from ._engine import VoxelGrid
from ._record_bytes import KEY_BYTES, MOST_BYTES, POSE_BYTES, RecordBytes

_TITLE = b"frontlux recording, format "
_FORMATS = (3, 4, 5)  # 3 has no tours, 4 no trajectories and no reassigned frontiers
_MOST_RATIO = 1032  # zlib compresses to no less than that part, and a few bytes more
_MOST_ROBOTS = 1000
_MOST_OPTIONS = 1 << 24  # [bytes]
# Steps of one robot, beside one for each byte of the file, since each takes time, however short it is. A part of a list
# takes as long as so many; in recordings of runs it has more than 40 bytes of the file.
_MOST_STEPS, _STEPS_OF_PART = 10_000, 8
_TAGS = (b"head", b"step", b"end ")
_CUBE = 16  # [voxels]

_STEP_COUNTS = ("number", "frontiers", "unassigned", "abandoned", "rays", "contacts")
_ROBOT_COUNTS = ("gain_tangent", "gain_predicted", "gain_sum", "gained", "travelled")


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """A run: n steps (in motion: plannings) of r robots. Step 0 is the start. Times are in seconds on the run's clock,
    lengths in metres, poses (x, y, z, yaw) of sensors in metres and radians in the map's frame.

    world         str, for people; what of a file's name is not UTF-8 is replaced
    resolution    float [m], the edge of a voxel
    bounds        (2, 3) uint16, the least and the greatest key of the map
    options       dict, the run's own options
    robots        r names
    starts        (r, 4) float64, poses
    steps         dict of arrays, one row a step: number, frontiers, unassigned, abandoned, rays, contacts (n,) int64;
                  time (n,) float64 [s] at the step's end; seconds (n, 6) float64, what planning and moving took
                  [s]: frontiers, caster, goals, paths, optimization, moving; known (n, r) int64, the observable voxels that
                  each robot mapped first, and known_in_bounds, of all voxels; length (n, r) float64 [m]
                  travelled in the step; gained, gain_tangent, gain_predicted, gain_sum, travelled (n, r) int64
    observable    int, voxels that can be observed; 0 if that is not known
    poses         dict of arrays, one row a viewpoint or, in motion, a scan: step, robot (p,) int64, pose (p, 4) float64
    changes       dict of arrays, one row for each voxel that a robot changed in a step: step, robot (c,) int64; keys
                  (c, 3) uint16; before, after (c,) uint8, as in Occupancy
    tours         dict of arrays, one row for each stop of the tour of a robot that chose its goal in a step, in order:
                  step, robot (t,) int64; pose (t, 4) float64; clusters, frontiers (t,) int64, seen from there. Empty
                  without tours and in recordings of format 3
    trajectories  dict of arrays, one row for each pose along the trajectory of a robot in motion that planned in a step:
                  step, robot (p,) int64, pose (p, 4) float64. Empty in lock-step, and in formats before 5
    reassigned    dict of arrays, one row for each frontier that became a robot's own to look at in a step, or ceased to be:
                  step, robot (f,) int64; keys (f, 3) uint16. Empty in formats before 5
    end           str, why the run ended; None if it was cut off
    truncated     bool, an unfinished step at the end of the file was left out
    """
    world: str
    resolution: float
    bounds: np.ndarray
    options: Dict[str, Any]
    robots: List[str]
    starts: np.ndarray
    observable: int
    steps: Dict[str, np.ndarray]
    poses: Dict[str, np.ndarray]
    changes: Dict[str, np.ndarray]
    tours: Dict[str, np.ndarray]
    trajectories: Dict[str, np.ndarray]
    reassigned: Dict[str, np.ndarray]
    end: Optional[str]
    truncated: bool

    def __repr__(self):
        return (f"<frontlux.Recording of {self.world!r}: {len(self.steps['number'])} steps of {', '.join(self.robots)}; "
                f"{self.end or 'unfinished'}>")

    def grid(self, step: Optional[int] = None) -> VoxelGrid:
        """The map after a step, counted from 0; without one, after the last step. ValueError if there is no such step."""
        last = len(self.steps["number"]) - 1
        step = last if step is None else step
        if not 0 <= step <= last:
            raise ValueError(f"step is {step}, but has to be 0 to {last}")
        grid = VoxelGrid(self.resolution)
        rows = self.changes["step"] <= step
        if rows.any():
            keys, after = self.changes["keys"][rows].astype(np.int64), self.changes["after"][rows]
            # Of equal ones the last counts; cube by cube, since they may be far apart.
            _, last = np.unique(np.ravel_multi_index(keys[::-1].T, 3 * (0x10000,)), return_index=True)
            keys, after = keys[len(keys) - 1 - last], after[len(after) - 1 - last]
            cubes = np.ravel_multi_index((keys // _CUBE).T, 3 * (0x10000 // _CUBE,))
            order = np.argsort(cubes)
            for part in np.split(order, np.flatnonzero(np.diff(cubes[order])) + 1):
                low = keys[part[0]] // _CUBE * _CUBE
                states = np.zeros((_CUBE, _CUBE, _CUBE), np.uint8)
                states[tuple((keys[part] - low).T)] = after[part]
                grid.set_states(low.astype(np.uint16), states)
        return grid


_MOTIONS = "plane", "space", "ground"


def _read_robot(record):
    name = record.text()
    motion = record.count() % len(_MOTIONS)  # and the body's shape
    record.doubles(3), record.count(), record.doubles(2), record.count()
    record.doubles(2 if record.count() else 0)
    record.count(), record.counts(6 * record.length(6)), record.doubles(3)
    record.doubles(2 if _MOTIONS[motion] == "ground" else 0)  # its highest step and its steepest slope
    record.count(), record.doubles(3)  # its field of view
    record.doubles(3), record.count()  # its limits
    record.doubles(1), record.counts(2)
    return name


def _read_head(record):
    head = {"world": record.text(), "resolution": float(record.doubles(1)[0]),
            "bounds": record.counts(6).reshape(2, 3).astype(np.uint16), "observable": record.count()}
    record.count()
    head["options"] = json.loads(record.text(_MOST_OPTIONS))
    if not isinstance(head["options"], dict):
        raise ValueError("has options that are no object")
    team = record.length()
    if team > _MOST_ROBOTS:
        raise ValueError(f"has {team} robots, but at most {_MOST_ROBOTS} are read")
    head["robots"] = [_read_robot(record) for _ in range(team)]
    if record.length() != team:
        raise ValueError("has not one start for each robot")
    starts = []
    for _ in range(team):
        starts.append(record.doubles(4))
        record.keys(record.length(KEY_BYTES))
    head["starts"] = np.array(starts).reshape(-1, 4)
    return head


def _read_step(record, number, head, run, version):
    step = dict(zip(_STEP_COUNTS, record.counts(len(_STEP_COUNTS))))
    if step["number"] != number:
        raise ValueError(f"step {number} has another number")
    step["time"] = record.doubles(1)[0]
    step["seconds"] = record.doubles(6)
    team = len(head["robots"])

    def check_team():
        if record.length() != team:
            raise ValueError(f"step {number} has not as many robots as the team")

    def add(name, *rows):
        if len(rows[0]):
            run[name].append((number, robot, *rows))

    check_team()
    step["known"], step["known_in_bounds"] = record.counts(2 * team).reshape(-1, 2).T
    check_team()
    robots = []
    for robot in range(team):
        of_robot = {name: record.count() for name in _ROBOT_COUNTS}
        of_robot["length"] = record.doubles(1)[0]
        record.count(), record.count()  # outcome of the path search, state of the goal
        record.take(POSE_BYTES if record.count() else 0)
        for _ in range(3):  # the goal
            record.count()
        record.take(record.length()), record.take(4 * 8)
        for _ in range(4):
            record.count()
        add("poses", record.doubles(record.length(POSE_BYTES), 4)[:of_robot["travelled"]])
        changed = record.length(KEY_BYTES + 1)
        keys, states = record.keys(changed), record.states(changed)
        if changed and ((keys < head["bounds"][0]) | (keys > head["bounds"][1])).any():
            raise ValueError(f"step {number} changes a voxel outside the bounds")
        add("changes", keys, states // 3, states % 3)
        for _ in ("still unknown", "blocked"):
            record.keys(record.length(KEY_BYTES))
        cells = record.length(KEY_BYTES + 5 * 8 + 1)
        record.keys(cells), record.doubles(5, cells), record.counts(cells)  # the image
        if version > 3:
            poses, seen = record.stops(record.length(POSE_BYTES + 2))
            add("tours", poses, *seen.T)
        if version > 4:
            add("trajectories", record.doubles(record.length(POSE_BYTES), 4))
            add("reassigned", record.keys(record.length(KEY_BYTES)))
        robots.append(of_robot)
    for name in (*_ROBOT_COUNTS, "length"):
        step[name] = np.array([of_robot[name] for of_robot in robots], np.float64 if name == "length" else np.int64)
    run["steps"].append(step)


def _records(data, title):
    """The format, then (tag, bytes) of each record; None at the end if one is unfinished."""
    at = data.find(b"\n", 0, len(title) + 20) + 1
    if not data.startswith(title) or not at:
        raise ValueError("is no recording of frontlux")
    version = data[len(title):at - 1].decode("ascii", "replace")
    if version not in map(str, _FORMATS):
        raise ValueError(f"has format {version}, but this frontlux reads {_FORMATS[0]} to {_FORMATS[-1]}")
    yield int(version)
    # What a file grew by before the machine lost its power may read as zeros: here they begin.
    zeros = len(data.rstrip(b"\0"))
    tag = None
    while at < len(data):
        if zeros > at and tag == b"end ":
            raise ValueError("goes on after its end")
        begin = at + 16
        written = data[at:max(at, min(zeros, at + 4))]
        if not any(known.startswith(written) for known in _TAGS):
            raise ValueError(f"is damaged at byte {at}: no record begins here")
        if zeros <= at or begin > len(data):
            yield None
            return
        tag, packed, plain, checksum = struct.unpack_from("<4s3I", data, at)
        if zlib.crc32(data[at:begin - 4]) != checksum:
            if zeros < begin:
                yield None
                return
            raise ValueError(f"is damaged at byte {at}")
        if plain > min(MOST_BYTES, _MOST_RATIO * (packed + 1)):
            raise ValueError(f"is damaged at byte {at}: a record announces {plain} bytes, more than it can hold")
        end = begin + packed + 4
        payload = data[begin:end - 4]
        if end > len(data) or zlib.crc32(payload) != struct.unpack_from("<I", data, end - 4)[0]:
            if zeros < end:
                yield None
                return
            raise ValueError(f"is damaged at byte {at}")
        unpacked = zlib.decompressobj().decompress(payload, plain + 1)
        if len(unpacked) != plain:
            raise ValueError(f"is damaged at byte {at}")
        yield tag, unpacked
        at = end


def _columns(rows, *shapes):
    """Lists of (step, robot, array...) as one array each: step, robot, and the arrays behind each other. Empties the list."""
    sizes = [len(row[2]) for row in rows]
    numbers = [np.array([row[i] for row in rows], np.int64) for i in (0, 1)]
    columns = [np.concatenate([np.empty((0, *shape), dtype), *(row[i] for row in rows)])
               for i, (shape, dtype) in enumerate(shapes, 2)]
    rows.clear()  # before more memory is taken
    return [np.repeat(number, sizes) for number in numbers] + columns


def read_recording(file):
    """Reads a recording, such as run.frontlux in the folder that `frontlux explore` leaves; also of a run in progress.

    file: str or os.PathLike. Returns a Recording. RuntimeError naming the file if it is damaged or none of ours, OSError
    if it cannot be opened.
    """
    head, end, truncated, robot_steps = None, None, False, 0
    run = {"steps": [], "poses": [], "changes": [], "tours": [], "trajectories": [], "reassigned": []}
    with open(file, "rb") as opened:
        try:
            data = opened.read()
            parts = _records(data, _TITLE)
            version = next(parts)
            for part in parts:
                if part is None:
                    truncated = end is None
                    break
                tag, record = part[0], RecordBytes(part[1])
                if (head is None) != (tag == b"head"):
                    raise ValueError("has no head, or two")
                if tag == b"head":
                    head = _read_head(record)
                elif tag == b"step":
                    _read_step(record, len(run["steps"]), head, run, version)
                    robot_steps += len(head["robots"]) + _STEPS_OF_PART * record.parts
                    if robot_steps > _MOST_STEPS + len(data):
                        raise ValueError("holds more steps and lists than so few bytes can")
                elif tag == b"end ":
                    end = record.text()
                if record.at != len(record.bytes):
                    raise ValueError("has a record with bytes too many")
            if head is None:
                raise ValueError("has no head")
        except (ValueError, IndexError, OverflowError, RecursionError, MemoryError, zlib.error) as error:
            raise RuntimeError(f"{fspath(file)}: {str(error) or type(error).__name__}") from error
    robots = len(head["robots"])
    del part, record
    names = {"time": ((), np.float64), "seconds": ((6,), np.float64), "length": ((robots,), np.float64),
             **{name: ((), np.int64) for name in _STEP_COUNTS},
             **{name: ((robots,), np.int64) for name in ("known", "known_in_bounds", *_ROBOT_COUNTS)}}
    steps = {name: np.array([step[name] for step in run["steps"]], dtype).reshape(len(run["steps"]), *shape)
             for name, (shape, dtype) in names.items()}
    poses = dict(zip(("step", "robot", "pose"), _columns(run["poses"], ((4,), np.float64))))
    changes = dict(zip(("step", "robot", "keys", "before", "after"),
                       _columns(run["changes"], ((3,), np.uint16), ((), np.uint8), ((), np.uint8))))
    tours = dict(zip(("step", "robot", "pose", "clusters", "frontiers"),
                     _columns(run["tours"], ((4,), np.float64), ((), np.int64), ((), np.int64))))
    trajectories = dict(zip(("step", "robot", "pose"), _columns(run["trajectories"], ((4,), np.float64))))
    reassigned = dict(zip(("step", "robot", "keys"), _columns(run["reassigned"], ((3,), np.uint16))))
    return Recording(steps=steps, poses=poses, changes=changes, tours=tours, trajectories=trajectories,
                     reassigned=reassigned, end=end, truncated=truncated, **head)
