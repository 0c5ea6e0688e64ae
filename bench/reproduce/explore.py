"""One exploration, done by a worker: no other file of this folder is needed here."""

import csv
import errno
import hashlib
import json
import math
import os
import re
import shutil
import signal
import socket
import subprocess
import tempfile
from datetime import datetime, timezone
from pathlib import Path
from typing import NamedTuple

KILLED = (-signal.SIGKILL, -signal.SIGTERM, 128 + signal.SIGINT)  # by its machine, as for want of memory: no crash
LONGEST = 3600  # [s] of the machine's time, after which a run counts as hanging
# Of run.json: what is the same on every machine, and what is not.
FACTS = ("version", "end", "steps", "coverage_observable", "coverage_box", "unseen", "time_s", "auc", "explored_m3",
         "clearance_min_m", "contacts", "contacts_in_free", "held_back", "separation_min_m", "by_robot", "path_length_m", "map",
         "worst_of_limits")
MEASURED = ("planning_mean_s", "planning_p99_s", "planning_max_s", "phases_s", "wall_s", "memory_mb", "machine",
            "instructions", "threads")
GAINS = ("gain_tangent", "gain_predicted", "gained")


def find_program(command):
    """The program's path. Raises OSError."""
    found = shutil.which(command)
    if found is None:
        raise OSError(f"there is no program {command} on {socket.gethostname()}: build it with ./dev build, or install "
                      "it")
    return found


class Program(NamedTuple):
    """What made a run: programs of one version differ, so the file itself counts."""
    version: str
    sha256: str  # its first 12 digits


def program_of(command):
    """The version that `frontlux --version` prints, and the hash of its file, with those of our libraries if it is not linked
    statically. Raises OSError."""
    file = find_program(command)
    try:
        said = subprocess.run([file, "--version"], capture_output=True, text=True, timeout=60, check=True)
        linked = subprocess.run(["ldd", file], capture_output=True, text=True, timeout=60, check=False)  # of a script nothing
    except subprocess.SubprocessError as error:
        raise OSError(f"{file} on {socket.gethostname()} does not run: {error}") from error
    digest = hashlib.sha256(Path(file).read_bytes())
    for library in sorted(re.findall(r"^\s*libfrontlux\S* => (/.*) \(0x", linked.stdout, re.MULTILINE), key=os.path.basename):
        digest.update(Path(library).read_bytes())
    return Program(said.stdout.split(",")[0].strip().removeprefix("frontlux "), digest.hexdigest()[:12])


def kind_of(robot):
    """uav2 is a uav."""
    return robot.rstrip("0123456789")


def last_line(text):
    lines = [line.strip() for line in text.replace("\r", "\n").splitlines() if line.strip()]
    return lines[-1][:300] if lines else "it said nothing"


def read_steps(file):
    """The curve, and by kind of robot the mean gains of a path: steps.csv in short. Raises ValueError."""
    curve, gains, number = [], {}, None
    with open(file, encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(stream):
            if None in row or None in row.values():
                raise ValueError(f"steps.csv is cut off in step {row.get('step')}")
            if row["step"] != number:
                number = row["step"]
                curve.append({"time_s": round(float(row["time_s"] or 0), 4),
                              "coverage": round(float(row["coverage_observable"]), 6), "length_m": {}, "first": {}})
            kind, now = kind_of(row["robot"]), curve[-1]
            for member, column in (("length_m", "travelled_m"), ("first", "robot_observable")):
                now[member][kind] = round(now[member].get(kind, 0.0) + float(row[column] or 0), 6)
            if len(curve) > 1 and int(row["viewpoints"] or 0) > 0:
                sums = gains.setdefault(kind, [0, [0] * len(GAINS)])
                sums[0] += 1
                sums[1] = [total + int(row[column] or 0) for total, column in zip(sums[1], GAINS)]
    if not curve:
        raise ValueError("steps.csv has no steps")
    means = {kind: {c: round(total / n, 4) for c, total in zip(GAINS, totals)} for kind, (n, totals) in gains.items()}
    return curve, means


def worst_of_limits(file, robots):
    """By motion.csv, the largest speed, acceleration and yaw rate of any robot as a part of its limit; speeds and yaw
    rates also by where it was a row before. None if it has no two rows of a robot. Raises ValueError."""
    limits = {robot["name"]: robot["limits"] for robot in robots}
    worst, before = None, {}
    with open(file, encoding="utf-8", newline="") as stream:
        rows = csv.reader(stream)
        next(rows, None)  # time_s, robot, x_m, y_m, z_m, yaw_rad, vx_m_s, vy_m_s, vz_m_s, yaw_rate_rad_s
        for time, name, *row in rows:
            time, (x, y, z, yaw, *velocity, yaw_rate) = float(time), map(float, row)
            last, before[name] = before.get(name), (time, (x, y, z), yaw, velocity)
            if last is None:
                continue
            limit, seconds = limits[name], time - last[0]
            size = (lambda v: max(map(abs, v))) if limit["per_axis"] else (lambda v: math.hypot(*v))

            def rate(now, then):
                return size([(b - a) / seconds for a, b in zip(then, now)])

            turned = abs(math.remainder(yaw - last[2], 2 * math.pi)) / seconds
            worst = max(worst or 0.0, size(velocity) / limit["speed_m_s"], rate((x, y, z), last[1]) / limit["speed_m_s"],
                        rate(velocity, last[3]) / limit["acceleration_m_s2"],
                        max(abs(yaw_rate), turned) / math.radians(limit["yaw_rate_deg_s"]))
    return None if worst is None else round(worst, 6)


def with_world(task, file):
    """The task of a world from a file, with its path. Raises OSError if that is another file than the declared one."""
    task = dict(task)
    declared = task.pop("world_sha256")
    if not Path(file).is_file():
        raise OSError(f"there is no {file} on {socket.gethostname()}: copy it there")
    found = hashlib.sha256(Path(file).read_bytes()).hexdigest()
    if found != declared:
        raise OSError(f"{file} on {socket.gethostname()} is another file than the declared one: its SHA-256 is {found} instead of "
                      f"{declared}")
    return {**task, "world": str(file)}


def planning_halves(file):
    """By events.csv, the 99th percentiles of the planning times in the first and in the second half of all plannings. None if there
    are fewer than two. Raises ValueError."""
    with open(file, encoding="utf-8", newline="") as stream:
        seconds = [float(row["planning_s"]) for row in csv.DictReader(stream)]
    middle = len(seconds) // 2
    return [sorted(half)[math.ceil(0.99 * len(half)) - 1] for half in (seconds[:middle], seconds[middle:])] if middle else None


def explore(command, program, task, world, threads=1, folder=None):
    """Runs a task: what came of it, either "facts", "gains" and "curve", or why it failed, "failure"; "measured"
    depends on the machine, nothing else does. The world's file is given apart, or empty. Files go to a new folder in
    `folder`, which is removed. Raises OSError if this machine does not have that very program or the file."""
    file, found = find_program(command), program_of(command)
    if found != program:
        raise OSError(f"{file} on {socket.gethostname()} is {found.version} ({found.sha256}) instead of "
                      f"{program.version} ({program.sha256}): install that")
    if world:
        task = with_world(task, world)
    with tempfile.TemporaryDirectory(prefix="frontlux-", dir=folder) as temporary:
        outcome = run_in(Path(temporary), file, task, threads)
    if "failure" in outcome:
        outcome["failure"] = outcome["failure"].replace(temporary, "")
    outcome["measured"].update(program=program.sha256, date=datetime.now(timezone.utc).date().isoformat())
    return outcome


def run_in(folder, program, task, threads):
    """explore() with its files in this folder. Raises OSError if its machine ends it."""
    file, run, log = folder / "task.json", folder / "run", folder / "log"
    file.write_text(json.dumps(task), encoding="utf-8")
    arguments = [program, "explore", "--task", str(file), "--threads", str(threads), "--report", "off", "--quiet",
                 "-o", str(run)]
    if setpriv := shutil.which("setpriv"):  # it ends with the worker, even if that is killed
        arguments = [setpriv, "--pdeathsig", "KILL", *arguments]
    with open(log, "w", encoding="utf-8") as output:
        # In a session of its own, so that Ctrl-C reaches the client alone.
        process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                                   start_new_session=True)
        try:
            code = process.wait(LONGEST)
        except subprocess.TimeoutExpired:
            return {"failure": f"not done after {LONGEST} s", "measured": {}}
        finally:
            process.kill()
            process.wait()
    if code in KILLED:
        raise OSError(f"{socket.gethostname()} has ended the run")
    if code != 0:
        said = last_line(log.read_text(encoding="utf-8", errors="replace"))
        if os.strerror(errno.ENOSPC) in said:
            raise OSError(f"{socket.gethostname()} has no room for the run: {said}")
        ended = f"exit code {code}" if code > 0 else f"ended by {signal.Signals(-code).name}"
        return {"failure": f"{ended}: {said}", "measured": {}}
    try:
        facts = json.loads((run / "run.json").read_text(encoding="utf-8"))
        curve, gains = read_steps(run / "steps.csv")
        if (run / "motion.csv").exists():
            facts["worst_of_limits"] = worst_of_limits(run / "motion.csv", facts["task"]["robots"])
        measured = {key: facts.get(key) for key in MEASURED}
        if (run / "events.csv").exists():
            measured["planning_p99_halves_s"] = planning_halves(run / "events.csv")
        return {"facts": {key: facts.get(key) for key in FACTS}, "gains": gains, "curve": curve, "measured": measured}
    except (OSError, ValueError, LookupError, TypeError, AttributeError, ArithmeticError, csv.Error) as error:
        return {"failure": f"what it left cannot be read: {error}", "measured": {}}


def explore_on_worker(*arguments):
    """explore() in the worker's own folder, which Dask clears if the worker is killed."""
    from distributed import get_worker
    return explore(*arguments, folder=get_worker().local_directory)
