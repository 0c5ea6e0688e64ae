"""Results of made-up runs: what the tests of the reproduction have in common. Its folder, that of bench/reproduce, is the first
argument.
"""

import sys
import tempfile
import unittest
from pathlib import Path

from made_up_runs import PROGRAM, VERSION, kinds_of, made_up, write_files

REPRODUCE = Path(sys.argv.pop(1)).resolve()
sys.path[:0] = [str(REPRODUCE), str(REPRODUCE.parent)]

import comparisons
import explore
import intervals
from experiments import Experiments, Run
from results import Results, write_result

NEEDED = comparisons.NEEDED, comparisons.NEEDED_OF_FILES
intervals.RESAMPLES, comparisons.NEEDED, comparisons.NEEDED_OF_FILES = 200, 8, 7  # enough for what is asked here, and quick
SEEDS = range(6, 6 + comparisons.NEEDED)
FEW_SEEDS = range(6, 6 + comparisons.NEEDED_OF_FILES)
BUILT_IN = ("maze", "factory", "station")
OTHERS = ("small_maze", "small_warehouse", "hospital", "techbase", "building", "complex_office", "duplex_office")
LOCKSTEP = ("steps", "steps_render")


class Made(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.experiments = Experiments()

    MADE = {}  # what came of runs, by what it depends on

    def outcome(self, run, **how):
        task = self.experiments.task_file(run)
        key = repr((kinds_of(task), how, None if "seconds" in how else (task["seed"], task["method"])))
        if key not in self.MADE:
            facts, rows = made_up(task, **how)
            write_files(self.folder / "files", facts, rows)
            curve, gains = explore.read_steps(self.folder / "files/steps.csv")
            self.MADE[key] = {"facts": {key: facts.get(key) for key in explore.FACTS}, "gains": gains, "curve": curve,
                              "measured": {key: facts.get(key) for key in (*explore.MEASURED, "planning_p99_halves_s")}}
        made = self.MADE[key]
        return {**made, "measured": dict(made["measured"])}

    def make(self, run, program=PROGRAM, **how):
        outcome = {"failure": how["failure"], "measured": {}} if "failure" in how else self.outcome(run, **how)
        outcome["measured"].update(program=program, date="2026-01-02")
        write_result(self.folder, run, self.experiments.task_file(run), VERSION, outcome)
        return run

    def results(self, runs):
        return Results(self.experiments, runs, self.folder)


def all_hold(make):
    """Runs of which every line holds."""
    for seed in SEEDS:
        for world in BUILT_IN:
            for method, seconds in (("tour", 100.0), ("render", 200.0), ("cluster", 180.0), ("nearest", 400.0),
                                    ("paper", 300.0), ("tour_uav", 150.0), ("tour_2uav", 80.0), ("tour_3uav", 60.0), ("tour_4uav", 40.0)):
                make(Run(world, method, seed), seconds=seconds + seed)
            for steps in LOCKSTEP:
                make(Run(world, steps, seed), seconds=400.0, uav_part=0.93, steps=40)
                make(Run(world, f"{steps}_uav", seed), seconds=800.0, steps=80)
                make(Run(world, f"{steps}_unassigned", seed), seconds=520.0, uav_part=0.75, steps=50)
                make(Run(world, f"{steps}_yaw_ahead", seed), seconds=1600.0, uav_part=0.6, steps=60, gains=(100, 100, 85))
        for method, seconds in (("tour", 100.0), ("render", 200.0), ("tour_uav", 150.0), ("tour_3uav", 90.0)) if seed in FEW_SEEDS else ():
            for task in OTHERS:
                make(Run(task, method, seed), seconds=seconds)
        make(Run("maze", "tour_grid_caster", seed), seconds=100.0 + seed)
    for world in BUILT_IN:
        make(Run(world, "tour", 6, True), seconds=106.0)
        for steps in LOCKSTEP:
            make(Run(world, steps, 6, True), seconds=400.0, uav_part=0.93, steps=40)


def none_hold(make):
    """Runs of which no line holds: each is worse where a line looks."""
    again = {"uav": {"length_m": 100.0, "revisited": 0.2, "idle_s": 0.0, "held_back": 0}}
    for seed in SEEDS:
        for world in BUILT_IN:
            for method, seconds in (("tour", 300.0), ("render", 200.0), ("cluster", 180.0), ("nearest", 100.0),
                                    ("paper", 100.0), ("tour_uav", 150.0), ("tour_2uav", 280.0), ("tour_4uav", 250.0)):
                make(Run(world, method, seed), seconds=seconds + seed, contacts=int(method in ("tour", "render")),
                     separation_min_m=0.01, clearance_min_m=0.0, worst_of_limits=1.0011, by_robot=again)
            for steps in LOCKSTEP:
                make(Run(world, steps, seed), seconds=200.0, uav_part=0.5, coverage=0.89, steps=90, gains=(100, 90, 80))
                make(Run(world, f"{steps}_uav", seed), seconds=100.0, steps=80)
                make(Run(world, f"{steps}_unassigned", seed), seconds=130.0, uav_part=0.75, steps=50)
                make(Run(world, f"{steps}_yaw_ahead", seed), seconds=100.0, uav_part=0.6, steps=60)
        for method, seconds in (("tour", 300.0), ("render", 200.0), ("tour_uav", 150.0)) if seed in FEW_SEEDS else ():
            for task in OTHERS:
                make(Run(task, method, seed), seconds=seconds, contacts=int(method != "tour_uav"), by_robot=again)
        make(Run("maze", "tour_grid_caster", seed), seconds=301.0 + seed)
    make(Run("maze", "tour_3uav", 6), coverage=0.5)
    for world in BUILT_IN:
        make(Run(world, "tour", 6, True), seconds=107.0, planning_p99_s=0.3, planning_p99_halves_s=[0.2, 0.27])
        for steps in LOCKSTEP:
            make(Run(world, steps, 6, True), seconds=200.0, planning_mean_s=5.1)
