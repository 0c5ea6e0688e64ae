"""Folders as `frontlux explore` leaves them, made up; started as a program it stands in for the command.

The environment tells it what to do to a run of a folder's name: MADE_UP_FAILS ends with exit code 3,
MADE_UP_STOPS leaves it unfinished, MADE_UP_SLEEPS goes on until it is interrupted. MADE_UP_LOG is a file that gets
a line for every call.
"""

import json
import math
import os
import signal
import sys
import time
from pathlib import Path

HEADER = ("step,time_s,robot,coverage_observable,coverage_box,robot_observable,robot_box,frontiers,unassigned,"
          "abandoned,goal_state,assigned,released,received,left_over,goal_x_m,goal_y_m,goal_z_m,goal_yaw_rad,goal_gain,"
          "path,viewpoints,length_m,travelled_m,gain_tangent,gain_predicted,gained,still_unknown,collisions,rays,"
          "frontiers_s,caster_s,goals_s,paths_s,optimization_s,planning_s,moving_s")
FAILURE = 'no "maze" <script>alert(1)</script> | [here](x) `x`'


def write_run(folder, world, seed, coverage, robots=("ugv", "uav"), uav_part=0.75, metres=(4.0, 8.0),
              phases=(0.001, 0.002, 0.003, 0.004, 0.010), gains=(100, 150, 120), **facts):
    """coverage: by step. The UAV made known `uav_part` of it; `metres` per step of the UGV and the UAV."""
    folder.mkdir(parents=True, exist_ok=True)
    parts = {"ugv": 1 - uav_part, "uav": uav_part} if len(robots) == 2 else {robots[0]: 1.0}
    metres = dict(zip(("ugv", "uav"), metres))
    lines = [HEADER]
    for step, covered in enumerate(coverage):
        for robot in robots:
            length = metres[robot] if step else 0.0
            goal = "3.5,2.5,1.2,0.1,150" if step else ",,,,"
            gain = "{},{},{}".format(*gains) if step else "0,0,0"
            times = ",".join(map(str, (*phases, sum(phases), 0.05)))
            part = covered * parts[robot]
            lines.append(f"{step},{12.5 * step},{robot},{covered},{covered * 0.8},{part},{part * 0.8},900,3,0,"
                         f"chosen,400,0,0,50,{goal},planned,{9 if step else 0},{length},{length * step},{gain},0,0,"
                         f"50000,{times}")
    (folder / "steps.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    total = {"version": "9.9", "world": world, "seed": seed, "mode": "default", "goal": "render", "assign": True,
             "optimize": True, "lockstep": True, "caster": "fast", "threads": 1, "resolution_m": 0.3,
             "robots": list(robots), "machine": "A|B <cpu>", "end": "low_gain", "steps": len(coverage) - 1,
             "coverage_observable": coverage[-1], "coverage_box": coverage[-1] * 0.8, "planning_mean_s": sum(phases),
             "planning_max_s": 2 * sum(phases), "wall_s": 36.0, "memory_mb": 300.0, "collisions": 0,
             "path_length_m": {r: metres[r] * (len(coverage) - 1) for r in robots}, **facts}
    (folder / "run.json").write_text(json.dumps(total), encoding="utf-8")
    (folder / "run.frontlux").write_text(json.dumps(total), encoding="utf-8")


def explore(arguments):
    """Curves that look like those of a run."""
    options = [word for word in arguments[2:] if word != "--lockstep"]
    given = dict(zip(options[::2], options[1::2])) if arguments[1] != "--resume" else None
    if given is None:
        folder = Path(arguments[2])
        facts = json.loads((folder / "run.frontlux").read_text())
    else:
        folder = Path(given["-o"])
        team = given.get("--team", "uav+ugv")
        facts = {"world": arguments[1], "seed": int(given["--seed"]), "threads": int(given["--threads"]),
                 "caster": given["--caster"], "mode": given.get("--mode", "default"),
                 "goal": given.get("--goal", "render"), "lockstep": "--lockstep" in arguments, "assign": given.get("--assign", "on") == "on",
                 "optimize": given.get("--optimize", "on") == "on",
                 "robots": ["ugv", "uav"] if team == "uav+ugv" else [team]}
    world, seed = facts["world"], facts["seed"]
    slow = {"maze": 18, "factory": 22, "station": 40}[world] * (1 + 0.12 * math.sin(7 * seed))
    slow *= 1.6 if len(facts["robots"]) == 1 else 1.25 if facts["goal"] != "render" else 1.0
    limit = 0.55 if facts["robots"] == ["ugv"] else 0.975 - 0.004 * seed
    coverage = [round(limit * (1 - 0.93 * math.exp(-i / slow)), 6) for i in range(int(4.5 * slow))]
    kept = {k: facts[k] for k in ("threads", "caster", "mode", "goal", "lockstep", "assign", "optimize")}
    if folder.name in os.environ.get("MADE_UP_STOPS", "").split() and given is not None:
        kept["end"] = "stopped"
    write_run(folder, world, seed, coverage, tuple(facts["robots"]), 0.7 if facts["optimize"] else 0.6, **kept)


def main(arguments):
    if arguments == ["--version"]:
        print("frontlux 9.9")
        return 0
    with open(os.environ["MADE_UP_LOG"], "a", encoding="utf-8") as log:
        log.write(" ".join(arguments) + "\n")
    name = next(Path(b).name for a, b in zip(arguments, arguments[1:]) if a in ("-o", "--resume"))
    if name in os.environ.get("MADE_UP_FAILS", "").split():
        print(FAILURE, file=sys.stderr)
        return 3
    if name in os.environ.get("MADE_UP_SLEEPS", "").split():
        def leave(*_):
            with open(os.environ["MADE_UP_LOG"], "a", encoding="utf-8") as log:
                log.write("interrupted\n")
            sys.exit(130)
        signal.signal(signal.SIGINT, leave)
        print("asleep", flush=True)
        time.sleep(60)
    explore(arguments)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
