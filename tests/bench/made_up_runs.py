"""Runs as `frontlux explore` leaves them, made up; started as a program it stands in for the command.

The environment tells it what to do to runs by their name: MADE_UP_FAILS ends with exit code 3, MADE_UP_SLEEPS
waits until it is killed, MADE_UP_DIES_ONCE kills its parent, the worker, the first time, MADE_UP_DIES each time. MADE_UP_LOG is a file that
gets a line for every call: name, parent's and own process.
"""

import csv
import json
import math
import os
import signal
import sys
import time
from pathlib import Path

VERSION, PROGRAM = "9.9", "0123456789ab"
FAILURE = 'no "maze" <script>alert(1)</script> | [here](x) `x`'
COLUMNS = ("step", "time_s", "robot", "coverage_observable", "robot_observable", "viewpoints", "travelled_m",
           "gain_tangent", "gain_predicted", "gained")


def kinds_of(task):
    return ["uav"] if "uav" == task.get("team") else ["ugv"] if task.get("team") == "ugv" else ["ugv", "uav"]


def made_up(task, seconds=None, coverage=0.999, uav_part=0.75, speeds=(0.5, 1.0), gains=(100, 150, 120), steps=40,
            **facts):
    """(run.json, rows of steps.csv) of a run that maps all at a steady pace until `seconds`."""
    robots = kinds_of(task)
    seconds = seconds or 300.0 + 10.0 * math.sin(task["seed"]) + 50.0 * len(task["method"])
    parts = {"ugv": 1 - uav_part, "uav": uav_part} if len(robots) == 2 else {robots[0]: 1.0}
    speed = dict(zip(("ugv", "uav"), speeds))
    rows = []
    for step in range(steps + 1):
        part = step / steps
        for robot in robots:
            rows.append(dict(zip(COLUMNS, (step, seconds * part, robot, coverage * part, coverage * part * parts[robot],
                                           int(step > 0), seconds * part * speed[robot], *(gains if step else (0, 0, 0))))))
    levels = {str(level): seconds * level / 100 / coverage for level in (50, 90, 95, 99) if level / 100 <= coverage}
    run = {"version": VERSION, "end": "nothing_to_do", "steps": steps, "coverage_observable": coverage,
           "coverage_box": 0.8 * coverage, "unseen": None, "time_s": {**levels, "end": seconds}, "auc": 0.5,
           "explored_m3": 1000.0, "clearance_min_m": 0.05, "contacts": 0, "contacts_in_free": 0, "held_back": 0,
           "worst_of_limits": 1.0, "separation_min_m": 0.4 if len(robots) > 1 else None,
           "by_robot": {r: {"length_m": seconds * speed[r], "revisited": 0.1 if r == "uav" else 0.3, "idle_s": 1.0,
                          "held_back": 0} for r in robots},
           "map": {"false_free": 0.02, "false_occupied": 0.0, "surface_found": 0.9},
           "path_length_m": {r: seconds * speed[r] for r in robots},
           "planning_mean_s": 0.02, "planning_p99_s": 0.1, "planning_max_s": 0.2,
           "planning_p99_halves_s": [0.08, 0.1],
           "phases_s": {"frontiers": 1.0, "caster": 1.0, "goals": 1.0, "paths": 1.0, "optimization": 1.0, "moving": 1.0},
           "wall_s": 36.0, "memory_mb": 300.0, "machine": "A|B <cpu>", "instructions": "avx2", "threads": 1, **facts}
    return run, rows


def write_files(folder, run, rows):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "run.json").write_text(json.dumps(run), encoding="utf-8")
    with open(folder / "steps.csv", "w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)


def named(what, name):
    return name in os.environ.get(what, "").split()


def main(arguments):
    if arguments == ["--version"]:
        print(f"frontlux {VERSION}, vector instructions: none")
        return 0
    given = dict(zip(arguments[1::2], arguments[2::2])) | {"-o": arguments[-1]}
    task = json.loads(Path(given["--task"]).read_text(encoding="utf-8"))
    with open(os.environ["MADE_UP_LOG"], "a", encoding="utf-8") as log:
        log.write(f"{task['name']} {os.getppid()} {os.getpid()}\n")
    if named("MADE_UP_FAILS", task["name"]):
        print(FAILURE, file=sys.stderr)
        return 3
    if named("MADE_UP_SLEEPS", task["name"]):
        time.sleep(600)
    mark = Path(os.environ["MADE_UP_LOG"] + ".died")
    if named("MADE_UP_DIES", task["name"]) or named("MADE_UP_DIES_ONCE", task["name"]) and not mark.exists():
        mark.touch()
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(600)
    write_files(Path(given["-o"]), *made_up(task))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
