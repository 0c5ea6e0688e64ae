"""The reproduction's numbers against values worked out by hand, lines that hold and that fail, and broken runs.

reproduce_test.py FOLDER, that of bench/reproduce; runs are made up in a temporary folder.
"""

import argparse
import contextlib
import csv
import hashlib
import io
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

from made_up_runs import FAILURE, PROGRAM, VERSION, kinds_of, made_up, write_files

REPRODUCE = Path(sys.argv.pop(1)).resolve()
sys.path[:0] = [str(REPRODUCE), str(REPRODUCE.parent)]

import claims
import explore
import intervals
import reproduce
from claims import at_least, at_most, changed_by, control_lines, effect, our_lines, paper_lines, touching
from experiments import FIRST_SEED, Experiments, Run, merged
from figures import figures, is_drawn, mean_curve, round_step, value_at
from intervals import Interval, bootstrap, difference, mean, median_difference, median_ratio, ratio
from markdown import interval, plain
from page import page
from results import Result, Results, failed_before, is_kept, is_published, unlike, write_result
from rows import curves_table, read_published, row_of, rows_table

NEEDED = claims.NEEDED, claims.NEEDED_OF_FILES
intervals.RESAMPLES, claims.NEEDED, claims.NEEDED_OF_FILES = 200, 8, 7  # enough for what is asked here, and quick
SEEDS = range(6, 6 + claims.NEEDED)
FEW_SEEDS = range(6, 6 + claims.NEEDED_OF_FILES)
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
                              "measured": {key: facts.get(key) for key in explore.MEASURED}}
        made = self.MADE[key]
        return {**made, "measured": dict(made["measured"])}

    def make(self, run, program=PROGRAM, **how):
        outcome = {"failure": how["failure"], "measured": {}} if "failure" in how else self.outcome(run, **how)
        outcome["measured"].update(program=program, date="2026-01-02")
        write_result(self.folder, run, self.experiments.task_file(run), VERSION, outcome)
        return run

    def results(self, runs):
        return Results(self.experiments, runs, self.folder)


class Declared(Made):
    def test_tasks_of_runs(self):
        task = self.experiments.task_file(Run("maze", "tour", 7))
        robots = task.pop("robots")
        self.assertEqual(task, {"name": "maze-tour-7", "world": "maze", "world_seed": 7, "seed": 1007, "method": "tour",
                                "resolution_m": 0.3, "latency_s": 0.25, "end": {"time_s": 7200},
                                "options": {"bumper": "off"}})
        self.assertEqual([r["name"] for r in robots], ["uav", "ugv"])
        three = self.experiments.task_file(Run("station", "tour_3uav", 7))["robots"]
        self.assertEqual([r["name"] for r in three], ["uav"] * 3)
        faster = self.experiments.task_file(Run("maze", "tour_speed", 7))["robots"]
        self.assertEqual([r["limits"]["speed_m_s"] for r in faster], [2.25, 1.5])
        self.assertEqual([r["limits"]["yaw_rate_deg_s"] for r in faster], [60, 60])
        steps = self.experiments.task_file(Run("maze", "steps_uav", 7))
        self.assertEqual((steps["lockstep"], steps["team"], "end" in steps), (True, "uav", False))
        mesh = self.experiments.task_file(Run("hospital", "tour", FIRST_SEED + 1))
        self.assertEqual((mesh["world"], mesh["options"]["start"]), ("hospital_aws_floor1.ply", "-9.15,-4.35,0.45"))
        self.assertNotIn("world_seed", mesh)
        office = self.experiments.task_file(Run("complex_office", "tour", FIRST_SEED + 2))
        self.assertEqual((office["robots"][0]["start"], "team" in office), ([1.3, 0, 1, 0], False))

    def test_no_two_runs_are_the_same_exploration(self):
        for name in ("quick", "full", "timed"):
            runs = self.experiments.runs(name)
            tasks = {json.dumps({**self.experiments.task_file(r), "name": ""}, sort_keys=True) for r in runs}
            self.assertEqual(len(tasks), len(runs))
            self.assertGreaterEqual(min(r.seed for r in runs), FIRST_SEED)

    def test_main_rows_have_twenty_seeds(self):
        runs = self.experiments.runs("full")
        for task in BUILT_IN:
            for method in ("tour", "render", "cluster", "nearest", "paper", "tour_uav", "tour_3uav", "steps",
                           "steps_uav"):
                self.assertEqual(sum((r.task, r.method) == (task, method) for r in runs), 20, (task, method))
        for (task, method), seeds in self.seeds_of(runs).items():
            if method in self.experiments.methods_of("main"):
                self.assertEqual(len(seeds), 10 if self.experiments.file_of(task) else 20, (task, method))

    def seeds_of(self, runs):
        seeds = {}
        for run in runs:
            seeds.setdefault(run[:2], []).append(run.seed)
        return seeds

    def test_a_first_pass_has_few_seeds_of_everything(self):
        runs = self.experiments.runs("full")
        rows = {run[:2] for run in runs}
        first = runs[:next(i for i, run in enumerate(runs) if run.seed > FIRST_SEED + 5)]
        self.assertEqual({run[:2] for run in first}, rows)
        for row, seeds in self.seeds_of(first).items():
            self.assertGreaterEqual(len(seeds), 2, row)
        for task in self.experiments.tasks:
            self.assertGreaterEqual(len(self.seeds_of(first)[task, "tour"]), 6)
        self.assertEqual(len(set(runs)), len(runs))

    def test_merged(self):
        self.assertEqual(merged({"a": {"b": 1, "c": 2}, "d": 3}, {"a": {"b": None, "e": 4}, "d": 5}),
                         {"a": {"c": 2, "e": 4}, "d": 5})

    def test_wrong_declarations(self):
        good = json.loads((REPRODUCE / "experiments.json").read_text())
        for change_it, said in ((lambda d: d.pop("tasks"), "'tasks' is missing"),
                                (lambda d: d["sets"]["quick"][0].update(seeds=[1, 9]), "seeds of set 'quick' are 1 to 9"),
                                (lambda d: d["sets"]["quick"][0].update(seeds=[9, 8]), "9 to 8"),
                                (lambda d: d["common"].update(team="2uav+car"), "'car' of team '2uav\\+car' is not declared"),
                                (lambda d: d["sets"]["quick"][0].update(methods=["tuor"]), "method 'tuor' of set 'quick'"),
                                (lambda d: d["methods"].update(new={"title": "new", "task": {}}), "'new' is in table None"),
                                (lambda d: d["methods"]["tour"].update(table="x"), "'tour' is in table 'x'"),
                                (lambda d: d["methods"]["tour_late"].pop("against"), "'tour_late' .* against None"),
                                (lambda d: d["methods"]["tour_late"].update(against="x"), "against 'x'"),
                                (lambda d: d["tasks"]["hospital"].update(complete=0.8), "hospital .* is complete at 0.8")):
            wrong = json.loads(json.dumps(good))
            change_it(wrong)
            file = self.folder / "experiments.json"
            file.write_text(json.dumps(wrong))
            with self.assertRaisesRegex(ValueError, f"{file}.*{said}"):
                Experiments(file)
        with self.assertRaisesRegex(ValueError, "there is no set 'all'"):
            self.experiments.runs("all")


class Motion(Made):
    HEAD = "time_s,robot,x_m,y_m,z_m,yaw_rad,vx_m_s,vy_m_s,vz_m_s,yaw_rate_rad_s\n"

    def worst(self, rows, **limits):
        robot = {"name": "one", "limits": {"speed_m_s": 2, "acceleration_m_s2": 4, "yaw_rate_deg_s": 180 / math.pi,
                                           "per_axis": False, **limits}}
        file = self.folder / "motion.csv"
        file.write_text(self.HEAD + "".join(",".join(map(str, row)) + "\n" for row in rows))
        return explore.worst_of_limits(file, [robot, {**robot, "name": "two"}])

    def test_each_limit_can_be_the_worst(self):
        rest = [0, "one", 0, 0, 0, 3.1, 0, 0, 0, 0]
        for row, per_axis, worst in (([0.5, "one", 0.6, 0.8, 0, 3.1, 0, 0, 0, 0], False, 1.0),  # moved
                                     ([0.5, "one", 0.6, 0.8, 0, 3.1, 0, 0, 0, 0], True, 0.8),
                                     ([2.0, "one", 0, 0, 0, 3.1, 0, 0, 3, 0], False, 1.5),  # speed
                                     ([0.5, "one", 0, 0, 0, 3.1, 1.8, 0, 0, 0], False, 0.9),
                                     ([0.25, "one", 0, 0, 0, 3.1, 1.5, 0, 0, 0], False, 1.5),  # acceleration
                                     ([1.0, "one", 0, 0, 0, -3.1, 0, 0, 0, 0], False, round(2 * math.pi - 6.2, 6)),
                                     ([1.0, "one", 0, 0, 0, 3.1, 0, 0, 0, -1.25], False, 1.25)):
            self.assertEqual(self.worst([rest, [0, "two", 9, 9, 9, 0, 0, 0, 0, 0], row], per_axis=per_axis), worst, row)

    def test_nothing_moves_in_one_row(self):
        self.assertIsNone(self.worst([]))
        self.assertIsNone(self.worst([[0, "one", 0, 0, 0, 0, 9, 0, 0, 0], [0, "two", 0, 0, 0, 0, 9, 0, 0, 0]]))

    def test_what_is_cut_off_is_refused(self):
        for row in ([1, "one", 0, 0], [1, "one", 0, 0, 0, 0, 0, 0, 0, "x"], [1]):
            with self.assertRaises(ValueError):
                self.worst([[0, "one", 0, 0, 0, 0, 0, 0, 0, 0], row])


class Intervals(unittest.TestCase):
    def test_values(self):
        self.assertEqual(mean([2, None, 4])[:], (3, None, None, 2))
        self.assertIsNone(mean([None]))
        self.assertEqual(mean([5] * 6), (5, 5, 5, 6))
        pairs = [(i, 2 * i) for i in range(1, 9)]
        self.assertEqual(difference([pairs], lambda v: v).value, -4.5)
        self.assertEqual(difference([pairs, [(1, 0)]], lambda v: v).value, -1.75)
        self.assertEqual(ratio([pairs], lambda v: v), (0.5, 0.5, 0.5, 8))
        # The ratio of the means, not the mean of the ratios; of two groups the mean.
        self.assertEqual(ratio([[(1, 1), (9, 4)]], lambda v: v).value, 2)
        self.assertEqual(ratio([[(1, 1), (9, 4)], [(1, 1)]], lambda v: v).value, 1.5)
        self.assertIsNone(ratio([[(1, 1), (9, 4)], [(1, 1)], []], lambda v: v))  # a world is missing
        self.assertEqual(ratio([[(1, 1), (None, 4)]], lambda v: v).count, 1)

    def test_differences_and_ratios_say_the_same(self):
        found = median_difference([(1, 2), (3, 2), (5, 1), (9, 4), (2, 9), (7, 1)], lambda v: v)
        self.assertEqual(found, (2.5, -7, 6, 6))
        never = math.inf
        self.assertEqual(median_difference([(1, never)] * 6, lambda v: v).value, -never)
        self.assertEqual(median_difference([(never, never)] * 6 + [(never, 1)], lambda v: v).value, 0)
        self.assertIsNone(median_difference([], lambda v: v))
        tie = median_difference([(1, never)] * 3 + [(never, 1)] * 3, lambda v: v)
        self.assertEqual(interval(tie), "–")

    def test_how_frequent_contacts_may_be(self):
        # Clopper's and Pearson's intervals, from tables of them.
        self.assertEqual(touching(9, 212), "4.2 % (2.0 to 7.9)")
        self.assertEqual(touching(1, 10), "10.0 % (0.3 to 44.5)")
        self.assertEqual(touching(10, 10), "100.0 % (69.2 to 100.0)")
        self.assertEqual(touching(9, 5000), "0.2 % (0.1 to 0.3)")
        self.assertEqual(touching(0, 20), "so with 95 % confidence in fewer than 13.9 %")

    def test_who_never_got_there_is_later_than_any_other(self):
        never = math.inf
        self.assertEqual(median_ratio([[(1, 2)] * 4 + [(never, 2)] * 2], lambda v: v)[:2], (0.5, 0.5))
        self.assertEqual(median_ratio([[(1, 2)] * 4 + [(never, 2)] * 5], lambda v: v).value, never)
        self.assertEqual(median_ratio([[(1, never)] * 6], lambda v: v), (0, 0, 0, 6))
        self.assertEqual(median_ratio([[(never, never)] * 6], lambda v: v), (1, 1, 1, 6))
        self.assertEqual(median_ratio([[(1, 2)], [(3, 2)]], lambda v: v).value, 1)
        self.assertEqual(interval(Interval(2, 1, never, 6), 1), "2.0 (1.0 to ∞)")

    def test_intervals_by_order(self):
        # Of as many throws of a coin at most one in forty has fewer heads than that place, less one.
        for count, first, last in ((6, 1, 6), (10, 2, 9), (20, 6, 15)):
            found = median_ratio([[(i, 1) for i in range(1, count + 1)]], lambda v: v)
            self.assertEqual(found, ((count + 1) / 2, first, last, count))
        self.assertIsNone(median_ratio([[(i, 1) for i in range(1, 6)]], lambda v: v).low)

    def test_interval_of_a_coin(self):
        # 20 throws, half of them heads: the binomial's 2.5 and 97.5 % quantiles are 6 and 14.
        found = mean([0, 1] * 10)
        self.assertEqual(found.value, 0.5)
        self.assertAlmostEqual(found.low, 0.3, delta=0.051)
        self.assertAlmostEqual(found.high, 0.7, delta=0.051)

    def test_same_values_same_interval(self):
        values = [1, 5, 2, 8, 3, 9, 4]
        self.assertEqual(mean(values), mean(values))
        self.assertLess(mean(values).low, mean(values).value)

    def test_too_few_values_have_no_interval(self):
        self.assertIsNone(mean([1, 2, 3, 4, 5]).low)
        self.assertIsNotNone(mean([1, 2, 3, 4, 5, 6]).low)
        self.assertIsNone(bootstrap([[1] * 20, [1] * 5], lambda groups: 1).low)

    def test_text(self):
        self.assertEqual(interval(Interval(0.5, 0.25, 0.75, 8), 1, 100, " %"), "50.0 % (25.0 to 75.0)")
        self.assertEqual(interval(Interval(-3, None, None, 1), sign=True, unit=" s"), "-3 s")
        self.assertEqual(interval(None), "–")


class Verdicts(unittest.TestCase):
    def test_limits(self):
        self.assertEqual(at_most(Interval(0.6, 0.5, 0.7, 8), 0.7), "holds")
        self.assertEqual(at_most(Interval(0.6, 0.5, 0.7, 8), 0.7, strictly=True), "open: the interval contains the limit")
        self.assertEqual(at_most(Interval(0.6, 0.5, 0.71, 8), 0.7), "open: the interval contains the limit")
        self.assertEqual(at_most(Interval(0.9, 0.8, 1.0, 8), 0.7), "**does not hold**")
        self.assertEqual(at_most(Interval(0.1, None, None, 5), 0.7), "open: fewer than 6 values in a world")
        self.assertEqual(at_most(None, 0.7), "not measured")
        self.assertEqual(at_least(Interval(0.9, 0.8, 1.0, 8), 0.7), "reproduced")
        self.assertEqual(at_least(Interval(0.6, 0.5, 0.65, 8), 0.7), "**not reproduced**")
        self.assertEqual(at_least(Interval(0.9, None, None, 2), 0.7), "open: fewer than 6 values in a world")

    def test_effects(self):
        self.assertEqual(effect(Interval(0.2, 0.12, 0.3, 8), 0.24), "reproduced")
        self.assertEqual(effect(Interval(0.5, 0.4, 0.6, 8), 0.24), "reproduced")
        self.assertEqual(effect(Interval(0.15, 0.13, 0.2, 8), 0.24), "reproduced")
        self.assertEqual(effect(Interval(0.2, 0.1, 0.3, 8), 0.24), "open: an effect, its size open")
        for found in (0.119, 0.121):  # which side of a half it is, is chance
            self.assertEqual(effect(Interval(found, 0.01, 0.2, 8), 0.24), "**not reproduced: smaller than claimed**")
        self.assertEqual(effect(Interval(0.1, 0.01, 0.3, 8), 0.24), "open: an effect, its size open")
        self.assertEqual(effect(Interval(0.1, -0.1, 0.3, 8), 0.24), "open: no effect shown, none excluded")
        self.assertEqual(effect(Interval(0.1, -0.1, 0.2, 8), 0.24),
                         "**not reproduced: no effect shown, and one as large is excluded**")
        self.assertEqual(effect(Interval(-0.2, -0.3, -0.1, 8), 0.24), "**not reproduced: the opposite**")
        self.assertEqual(effect(None, 0.24), "not measured")
        self.assertEqual(changed_by(Interval(0.75, 0.5, 1.25, 8), lambda v: 1 - v), (0.25, -0.25, 0.5, 8))


class OneRun(Made):
    def test_numbers(self):
        run = self.make(Run("maze", "tour", 6), seconds=400.0, coverage=0.995)
        result = self.results([run]).all[run]
        self.assertIsNone(result.failure)
        self.assertEqual((result.seconds("end"), result.coverage, result["steps"]), (400, 0.995, 40))
        self.assertAlmostEqual(result.seconds("50"), 400 * 0.5 / 0.995, places=4)
        self.assertEqual((result.metres(), result.metres("uav"), result.metres("ugv")), (600, 400, 200))
        self.assertEqual(result.steps_to_90, 37)  # 0.995 * 37 / 40 = 0.920
        self.assertAlmostEqual(result.metres_mapped, 600)  # 0.995 * 39 / 40 = 0.970
        hospital = self.make(Run("hospital", "tour", 6), seconds=400.0, coverage=0.995)
        self.assertAlmostEqual(self.results([hospital]).all[hospital].metres_mapped, 555)  # 90 %
        self.assertAlmostEqual(result.share("uav"), 0.75, places=5)
        self.assertAlmostEqual(result.efficiency("uav"), 99.5 * 0.75 / 4, places=3)
        self.assertEqual((result["revisited_uav"], result["gain_predicted"]), (0.1, 150))

    def test_revisits_count_by_metres(self):
        robots = {"uav1": {"length_m": 100, "revisited": 0.1}, "uav2": {"length_m": 300, "revisited": 0.3},
                  "ugv": {"length_m": 50}}  # as runs left it before it was measured
        run = self.make(Run("maze", "tour", 6), by_robot=robots)
        result = self.results([run]).all[run]
        self.assertAlmostEqual(result["revisited_uav"], 0.25)
        self.assertIsNone(result["revisited_ugv"])

    def test_robots_of_a_kind_are_added(self):
        run = Run("maze", "tour", 6)
        facts, rows = made_up(self.experiments.task_file(run), seconds=100.0)
        write_files(self.folder / "two", facts, [{**row, "robot": f"uav{i}"} for row in rows if row["robot"] == "uav"
                                                 for i in (1, 2)])
        curve, gains = explore.read_steps(self.folder / "two/steps.csv")
        self.assertEqual(curve[-1]["length_m"], {"uav": 200})
        self.assertEqual(gains["uav"], {"gain_tangent": 100, "gain_predicted": 150, "gained": 120})

    def test_what_counts_as_a_failure(self):
        for seed, (how, failure) in enumerate((
                ({"coverage": 0.98}, "ended at 98.0 % (nothing_to_do)"), ({"end": "cut_off"}, None),
                ({"end": "cut_off", "coverage": 0.9}, "ended at 90.0 % (cut_off)"),
                ({"end": "time_limit"}, "time_limit at 99.9 %"), ({"failure": "exit code 1: x"}, "exit code 1: x"),
                ({}, None)), 6):
            run = self.make(Run("maze", "tour", seed), **how)
            self.assertEqual(self.results([run]).all[run].failure, failure)
        run = self.make(Run("hospital", "tour", 6), coverage=0.95)
        self.assertIsNone(self.results([run]).all[run].failure)

    def test_until_a_level(self):
        self.make(Run("maze", "tour", 6), seconds=100.0)
        self.make(Run("maze", "tour", 7), coverage=0.95)
        self.make(Run("maze", "tour", 8), failure="exit code 1: x")
        self.make(Run("hospital", "tour", 6), seconds=100.0, coverage=0.95)
        runs = [Run("maze", "tour", seed) for seed in (6, 7, 8)] + [Run("hospital", "tour", 6)]
        whole, part, crashed, hospital = (self.results(runs).all[run] for run in runs)
        self.assertAlmostEqual(whole.seconds_mapped, 99 / 0.999, places=4)
        self.assertEqual((whole.steps_to_90, part.seconds_mapped, crashed.seconds_mapped), (37, math.inf, math.inf))
        self.assertEqual((crashed.steps_to_90, crashed.metres_mapped), (math.inf, math.inf))
        self.assertAlmostEqual(hospital.seconds_mapped, 90 / 0.95, places=4)

    def test_failed_runs_enter_no_mean_and_lose_their_pair_at_the_end(self):
        runs = [self.make(Run("maze", "tour", 6), seconds=100.0), self.make(Run("maze", "tour", 8), seconds=300.0),
                self.make(Run("maze", "tour", 7), seconds=5.0, coverage=0.5)]
        runs += [self.make(Run("maze", "render", 6), seconds=200.0), self.make(Run("maze", "render", 7), seconds=200.0),
                 self.make(Run("maze", "render", 8), failure="exit code 1: x"), self.make(Run("maze", "render", 9))]
        results = self.results(runs)
        self.assertEqual([a.run.seed for a, _ in results.pairs("maze", "tour", "render")], [6, 7, 8])
        self.assertEqual([a.run.seed for a, _ in results.done_pairs("maze", "tour", "render")], [6])
        text = page(results, "images", "runs.csv", "curves.csv")
        row = next(line for line in text.splitlines() if line.startswith("| maze | tours | 3 | 1 |"))
        self.assertIn("| 200 |", row)  # of 100 and 300
        self.assertIn("- maze-tour-7: ended at 50.0 % (nothing\\_to\\_do)\n", text)
        # Of maze-tour 7 and 8, ratios are infinite and 0, of maze-tour 6 it is half.
        self.assertIn("| maze | view quality | 3 | 1 / 1 | 0.50× |", text)

    def test_a_mean_to_a_level_says_how_many_got_there(self):
        runs = [self.make(Run("hospital", "tour", seed), seconds=100.0, coverage=0.96 if seed == 6 else 0.92)
                for seed in (6, 7, 8)]
        text = page(self.results(runs), "images", "runs.csv", "curves.csv")
        row = next(line for line in text.splitlines() if "| tours | 3 | 0 |" in line)
        self.assertIn("| 99; 1 of 3 | – | 100 |", row)

    def test_kept_if_it_is_the_same_run_by_the_same_program(self):
        run = Run("maze", "tour", 6)
        task, program = self.experiments.task_file(run), {PROGRAM}
        self.assertFalse(is_kept(self.folder, run, task, program))
        self.make(run)
        self.assertTrue(is_kept(self.folder, run, task, program))
        self.assertFalse(is_kept(self.folder, run, {**task, "latency_s": 0.5}, program))
        self.assertFalse(is_kept(self.folder, run, task, {"another"}))
        self.assertTrue(is_kept(self.folder, run, task, {"another", PROGRAM}))
        self.make(run, failure="exit code 1: x")
        self.assertFalse(is_kept(self.folder, run, task, program))
        self.make(run)
        file = self.folder / f"{run.name}.json"
        file.write_text(file.read_text().replace('"contacts": 0', '"contacts": "0"'))
        self.assertFalse(is_kept(self.folder, run, task, program))

    def test_runs_of_one_program_alone_are_used(self):
        runs = [self.make(Run("maze", "tour", seed)) for seed in (6, 7)]
        runs += [self.make(Run("maze", "tour", 8), "another"), self.make(Run("maze", "render", 8), "another")]
        results = self.results(runs + [self.make(Run("maze", "render", 6))])
        self.assertEqual((results.programs, len(results.all), results.of_others), ([PROGRAM], 3, 2))
        text = page(results, "images", "runs.csv", "curves.csv")
        self.assertIn(f"program {PROGRAM}, 2026-01-02", text[:400])
        self.assertIn(f"Of other programs than {PROGRAM} there are 2 runs, which are left out", text)
        # Planning times are of one program, and the program that was run is the one, however few its runs.
        timed = self.make(Run("maze", "tour", 6, True), "another")
        results = Results(self.experiments, [*results.wanted, timed], self.folder, ["another"])
        self.assertEqual((len(results.all), timed in results.all), (5, False))
        results = Results(self.experiments, results.wanted, self.folder, [], "another")
        self.assertEqual((results.programs, len(results.all)), (["another"], 3))
        for like in ("another", PROGRAM):  # the program is the one that others are like
            results = Results(self.experiments, list(results.wanted), self.folder, [like])
            self.assertEqual((set(results.programs), len(results.all), results.of_others),
                             ({PROGRAM, "another"}, 5 + (like == PROGRAM), 0))
            self.assertNotEqual(results.programs[0], like)
            text = page(results, "images", "runs.csv", "curves.csv")
            self.assertIn(f"program {results.programs[0]} (", text[:400])
            self.assertIn(f"and by what was given as like it: {like} (", text[:400])

    def test_damaged_members_are_named_and_no_table_meets_them(self):
        run = self.make(Run("maze", "tour", 6))
        file = self.folder / f"{run.name}.json"
        whole = json.loads(file.read_text())

        def paths(value, path=()):
            """Of all members but the task, whose every change is noticed, and those that nothing reads."""
            unread = ("task", "coverage_box", "explored_m3", "path_length_m", "phases_s", "memory_mb", "machine",
                      "instructions", "threads", "idle_s", "version")
            for key, inner in value.items() if isinstance(value, dict) else enumerate(value[:1]):
                if key not in unread:
                    yield path + (key,)
                    if isinstance(inner, (dict, list)):
                        yield from paths(inner, path + (key,))

        tried = 0
        for path in paths(whole):
            for bad in ("text", [1], 1e400, True):
                damaged = json.loads(json.dumps(whole))
                where = damaged
                for key in path[:-1]:
                    where = where[key]
                if isinstance(where[path[-1]], str) and bad == "text" or path[-1] == "held_back" and len(path) > 2:
                    continue
                where[path[-1]] = bad
                file.write_text(json.dumps(damaged).replace("Infinity", "1e400"))
                self.assertIn(run.name, self.results([run]).broken, (path, bad))
                tried += 1
        self.assertGreater(tried, 100)
        # What is optional may be absent.
        for member in ("map", "by_robot", "unseen", "clearance_min_m", "separation_min_m", "worst_of_limits", "auc"):
            del whole["facts"][member]
        for member in ("wall_s", "planning_mean_s", "planning_p99_s", "planning_max_s", "date"):
            del whole["measured"][member]
        file.write_text(json.dumps(whole))
        timed = self.make(Run("maze", "tour", 6, True))
        file = self.folder / f"{timed.name}.json"
        file.write_text(file.read_text().replace('"planning_p99_s": 0.1', '"planning_p99_s": null'))
        results = self.results([run, timed])
        self.assertEqual(len(results.all), 2)
        page(results, "images", "runs.csv", "curves.csv"), figures(results), rows_table(results.all.values())

    def test_folders_of_the_same_runs(self):
        for name in ("one", "two"):
            (self.folder / name).mkdir()
        runs = [Run("maze", "tour", seed) for seed in (6, 7)]
        one, two = self.folder / "one", self.folder / "two"
        for run in runs:
            for where, wall in ((one, 1.0), (two, 2.0)):
                outcome = self.outcome(run, wall_s=wall)
                write_result(where, run, self.experiments.task_file(run), VERSION, outcome)
        self.assertEqual(unlike(one, two), (2, []))
        write_result(two, runs[0], self.experiments.task_file(runs[0]), VERSION, self.outcome(runs[0], contacts=1))
        (one / f"{runs[1].name}.json").unlink()
        count, lines = unlike(one, two)
        self.assertEqual((count, lines[0]), (2, "maze-tour-6.json: not the same facts"))
        self.assertEqual(lines[1], f"maze-tour-7.json: not in {one}")
        for other, code in ((two, 1), (one, 0)):
            done = subprocess.run([sys.executable, "-B", REPRODUCE / "reproduce.py", "--compare", one, other],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertIn("1 of 1 runs are the same", done.stdout)

    def test_broken_results_are_named_and_left_out(self):
        run = self.make(Run("maze", "tour", 6))
        other = self.make(Run("maze", "tour", 7))
        file = self.folder / f"{run.name}.json"
        whole = file.read_text()
        for text in ("", "{", "[]", "[" * 100000, whole[:-200], whole.replace('"format": 1', '"format": 2'),
                     whole.replace('"coverage_observable": 0.999', '"coverage_observable": NaN'),
                     whole.replace('"coverage_observable": 0.999', '"coverage_observable": 1.5'),
                     whole.replace('"curve"', '"curves"'), whole.replace('"latency_s": 0.25', '"latency_s": 0.5')):
            self.assertNotEqual(text, whole)
            file.write_text(text)
            results = self.results([run, other])
            self.assertEqual((list(results.all), list(results.broken)), ([other], [run.name]), text[:80])
            self.assertIn(file.name, results.broken[run.name])
        file.write_bytes(b"\xff\xfe{")
        self.assertIn(run.name, self.results([run, other]).broken)


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
    for seed in SEEDS:
        for world in BUILT_IN:
            for method, seconds in (("tour", 300.0), ("render", 200.0), ("cluster", 180.0), ("nearest", 100.0),
                                    ("paper", 100.0), ("tour_uav", 150.0), ("tour_2uav", 280.0), ("tour_4uav", 250.0)):
                make(Run(world, method, seed), seconds=seconds + seed, contacts=int(method in ("tour", "render")),
                     separation_min_m=0.01, clearance_min_m=0.0, worst_of_limits=1.0011)
            for steps in LOCKSTEP:
                make(Run(world, steps, seed), seconds=200.0, uav_part=0.5, coverage=0.91, steps=90, gains=(100, 90, 80))
                make(Run(world, f"{steps}_uav", seed), seconds=100.0, steps=80)
                make(Run(world, f"{steps}_unassigned", seed), seconds=130.0, uav_part=0.75, steps=50)
                make(Run(world, f"{steps}_yaw_ahead", seed), seconds=100.0, uav_part=0.6, steps=60)
        for method, seconds in (("tour", 300.0), ("render", 200.0), ("tour_uav", 150.0)) if seed in FEW_SEEDS else ():
            for task in OTHERS:
                make(Run(task, method, seed), seconds=seconds)
        make(Run("maze", "tour_grid_caster", seed), seconds=301.0 + seed)
    make(Run("maze", "tour", SEEDS.stop), coverage=0.5)  # and no partner
    for world in BUILT_IN:
        make(Run(world, "tour", 6, True), seconds=107.0, planning_p99_s=0.3)
        for steps in LOCKSTEP:
            make(Run(world, steps, 6, True), seconds=200.0, planning_mean_s=5.1)


class Lines(Made):
    SHOWN = ("not comparable", "not judged")

    def setUp(self):
        super().setUp()
        resamples, intervals.RESAMPLES = intervals.RESAMPLES, 40  # for hundreds of intervals in each test
        self.addCleanup(setattr, intervals, "RESAMPLES", resamples)

    def lines(self, fill, but=lambda run, how: how):
        """Of the runs that `fill` makes, changed, or left out, by `but`."""
        runs = {}

        def make(run, **how):
            how = but(run, how)
            if how is not None:
                made = {"failure": how["failure"], "measured": {}} if "failure" in how else self.outcome(run, **how)
                content = {"task": self.experiments.task_file(run), "version": VERSION, **made}
                runs[run] = Result(row_of(run, content, self.experiments.complete(run)), [], self.experiments.complete(run))
        fill(make)
        results = Results(self.experiments, [], self.folder)
        results.all = runs
        return [*our_lines(results), *paper_lines(results)]

    def judged(self, *arguments):
        return {line.claim: line for line in self.lines(*arguments) if line.verdict not in self.SHOWN}

    def test_every_line_can_hold(self):
        for line in self.judged(all_hold).values():
            self.assertIn(line.verdict, ("holds", "reproduced"), line)

    def test_every_line_can_fail(self):
        bad = self.judged(none_hold)
        # A run in lock-step maps too little, or is faster to 99 % than one in motion.
        fast = self.judged(none_hold, lambda run, how: {**how, "coverage": 0.999} if run[1] in LOCKSTEP else how)
        self.assertGreater(len(bad), 70)
        for claim, line in bad.items():
            verdicts = (line.verdict, fast[claim].verdict)
            self.assertTrue(any(v.startswith(("**does not hold", "**not reproduced")) for v in verdicts), (line, fast[claim]))

    def test_lines_notice_what_is_spoilt(self):
        def verdicts(but=lambda run, how: how):
            runs = [Run(task, method, seed) for task in ("maze", "factory") for seed in range(6, 12)
                    for method in ("tour_hasty", "tour_alone", "tour_swaying", "render", "tour_uav")]
            for run in runs:
                self.make(run, **but(run, {"seconds": 400.0 if run.method in ("render", "tour_uav") else 300.0}))
            return [line.verdict for line in control_lines(self.results(runs))]

        self.assertEqual(set(verdicts()), {"**missed: it holds all the same**"})
        bad = {"tour_hasty": {"coverage": 0.98}, "tour_alone": {"seconds": 401.0},
               "tour_swaying": {"separation_min_m": 0.3, "contacts": 2, "clearance_min_m": 0.0}}
        for verdict in verdicts(lambda run, how: {**how, **bad.get(run.method, {})}):
            self.assertTrue(verdict.startswith("noticed: does not hold"), verdict)
        self.assertEqual({line.verdict for line in control_lines(self.results([]))}, {"not measured"})
        same = verdicts(lambda run, how: {"seconds": 400.0 + (run.seed % 2 * 20 - 10) * (run.method in ("render", "tour_uav") or -1)})
        self.assertEqual([v for v in same if v.startswith("noticed")], [])
        self.assertIn("open: the interval contains the limit", same)

    def test_nothing_holds_without_runs(self):
        for line in self.judged(lambda make: None).values():
            self.assertEqual((line.measured, line.verdict), ("", "not measured"))

    def test_every_line_has_the_runs_it_needs_declared(self):
        declared = self.experiments.runs("full") + self.experiments.runs("timed")
        for name, needed in zip(("NEEDED", "NEEDED_OF_FILES"), NEEDED):
            self.addCleanup(setattr, claims, name, getattr(claims, name))
            setattr(claims, name, needed)
        for line in self.judged(lambda make: [make(run, steps=4) for run in declared]).values():
            self.assertNotRegex(line.verdict, "^open: [0-9]+ of|^open: no pairs|^not measured", line)

    def test_few_pairs_decide_nothing(self):
        lines = self.judged(all_hold, lambda run, how: how if run.seed < 12 else None)
        self.assertEqual(lines["Time to 99 %: tours below view quality, maze"].verdict, "open: 6 of 8 pairs")
        self.assertRegex(lines["Time to 99 %: tours below view quality, maze"].measured, r"^0\.\d+× \(.* to .*\), 6 pairs$")
        self.assertEqual(lines["Time to 90 %: tours below view quality, hospital, one floor (AWS RoboMaker)"].verdict,
                         "open: 6 of 7 pairs")
        self.assertEqual(lines["as printed, maze: 97.2 % are covered at the end; of the observable space"].verdict,
                         "open: 6 of 8 runs")
        self.assertEqual(lines["View quality without bumpers: no body touches a surface"].verdict,
                         "open: 6 of 7 runs of building render, and too few in 9 other rows")
        one = self.judged(all_hold, lambda run, how: how if run[:3] == ("maze", "render", 6) else None)
        self.assertEqual(one["View quality without bumpers: no body touches a surface"].verdict,
                         "open: 0 of 7 runs of building render, and too few in 9 other rows")

    def test_a_world_without_pairs_leaves_the_mean_open(self):
        lines = self.judged(all_hold, lambda run, how: None if run[:2] == ("station", "render") else how)
        self.assertEqual(lines["Time to 99 %: tours at most 0.7 of view quality, mean of worlds"].verdict,
                         "open: no pairs of station")

    def test_a_method_that_never_maps_the_world_loses(self):
        claim = "Time to 99 %: {} of view quality, mean of worlds".format("tours at most 0.7")
        for method, verdict, said in (("render", "open: at least half of the second never got there in maze", "8 never of the second"),
                                      ("tour", "**does not hold**", "8 never of the first")):
            line = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.97} if run[:2] == ("maze", method) else how)[claim]
            self.assertEqual(line.verdict, verdict)
            self.assertIn(said, line.measured)

    def test_a_level_that_was_reached_counts_whatever_ended_the_run(self):
        claim = "as printed, maze: the team takes at least 30 % fewer planning steps than the UAV alone (up to 54 %); to 90 %"
        whole = self.judged(all_hold)[claim]
        cut = self.judged(all_hold, lambda run, how: {**how, "end": "step_limit"} if run[1] == "steps_uav" else how)[claim]
        self.assertEqual(cut, whole)
        never = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.8} if run[1] == "steps_uav" else how)[claim]
        self.assertEqual((never.verdict, never.measured),
                         ("reproduced", "at least half never got there, 8 pairs; 8 never of the second"))

    def test_many_failures_leave_what_is_measured_at_the_end_open(self):
        claim = "as printed, maze: optimisation shortens the UAV's path by 12 % (286 and 252 m)"
        for last, verdict in ((5, "reproduced"), (6, "open: 1 of 8 runs failed (team, no optimisation, as printed)")):
            line = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.8} if run[1] == "steps_yaw_ahead" and
                               run.seed <= last else how)[claim]
            self.assertEqual(line.verdict, verdict)
        # Failures count where a partner is missing, too.
        line = self.judged(all_hold, lambda run, how: None if run[1] == "steps" and run.seed <= 6 else
                           {**how, "coverage": 0.8} if run[1] == "steps_yaw_ahead" and run.seed <= 6 else how)[claim]
        self.assertIn("1 failed of the second", line.measured)

    def test_crashes_leave_coverage_open(self):
        lines = self.judged(all_hold, lambda run, how: {"failure": "x"} if run[:3] == ("maze", "steps", 9) else how)
        self.assertEqual(lines["as printed, maze: 97.2 % are covered at the end; of the observable space"].verdict,
                         "open: 1 of 8 runs crashed")

    def test_the_end_is_shown_and_not_judged(self):
        lines = [line for line in self.lines(all_hold) if "to the end, each by" in line.claim]
        self.assertGreater(len(lines), 10)
        self.assertEqual({line.verdict for line in lines}, {"not judged"})

    def test_no_line_asks_for_what_is_not_declared(self):
        claims = [line.claim for line in self.lines(lambda make: None)]
        self.assertFalse([c for c in claims if "office" in c and "UAV alone" in c])


class Page(Made):
    def columns_agree(self, text):
        columns = None
        for line in text.splitlines():
            cells = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("|") else None
            if cells is not None and columns is not None:
                self.assertEqual(cells, columns, line)
            columns = cells

    def test_whole(self):
        runs = []
        all_hold(lambda run, **how: runs.append(self.make(run, **how)))
        runs += [self.make(Run("maze", "tour_drift", seed), map={"false_free": 0.02 + 0.01 * (seed % 2), "false_occupied": 0,
                                                                 "surface_found": 0.8}) for seed in range(6, 12)]
        results = Results(self.experiments, runs + [Run("factory", "render_bumper", 6)], self.folder)
        text = page(results, "pictures", "runs.csv", "curves.csv")
        self.columns_agree(text)
        self.assertIn(f"from {len(runs)} of {len(runs) + 1} runs, seeds 6 to 13, by version 9.9, program {PROGRAM}, "
                      "2026-01-02.", text[:500])
        self.assertIn(f"{len(runs)} runs took {len(runs) * 36 / 3600:.1f} hours in all", text)
        self.assertRegex(text, r"\| factory \| 1 of \d+ \| \d+ \| 0 \| 1 \|")
        self.assertNotRegex(text, r"\| maze \| \d+ of \d+ \|")
        # In points, by the pairs of the six seeds, not of all eight.
        self.assertIn("| 6 | +0.50 (+0.17 to +0.83) | +0.00 (+0.00 to +0.00) | -10.00 (-10.00 to -10.00) |", text)
        short = text[text.index("## Results in short"):text.index("## What is compared")]
        self.assertIn("Time until 99 % is mapped, tours by view quality: maze 0.5", short)
        self.assertIn("complex office (FALCON): the end after 100 s (100 to 100), with tours, 99 % after 99 s; published", short)
        self.assertIn("FALCON 138 to 153 s, FAEP 178 to 197 s", short)
        self.assertLessEqual(len(short.strip().splitlines()) - 2, 6)
        tables = text[text.index("## Main tables"):text.index("## What must hold")]
        self.assertLessEqual(max(line.count(" | ") for line in tables.splitlines() if line.startswith("| ")), 9)
        for name in figures(results):
            self.assertIn(f"(pictures/{name}.svg)", text)
        self.assertEqual(text, page(results, "pictures", "runs.csv", "curves.csv"))
        self.assertNotIn(str(self.folder), text)

    def test_every_declared_method_is_on_the_page(self):
        runs = [self.make(Run("maze", method, seed)) for method in self.experiments.methods for seed in range(6, 12)]
        text = page(self.results(runs), "images", "runs.csv", "curves.csv")
        for method, declared in self.experiments.methods.items():
            shown = {"caster": " of 6 pairs of runs are the same |",
                     "bumpers": f"| maze | {self.experiments.title(declared.get('against', method))} | 6 | 0 | 0 |"}
            title = declared["title"]
            shown["controls"] = title[1:]  # its first letter may be the line's
            self.assertIn(shown.get(declared["table"], f"| {title} |"), text, method)

    def test_table_of_runs(self):
        runs = [self.make(Run("maze", "tour", 6), seconds=400.0, coverage=0.995, separation_min_m=None),
                Run("maze", "tour", 7), self.make(Run("maze", "tour", 8), failure='a "b", c'), self.make(Run("maze", "tour", 6, True))]
        rows = list(csv.DictReader(io.StringIO(rows_table(self.results(runs).all.values()))))
        self.assertEqual([(row["seed"], row["timed"]) for row in rows], [("6", "0"), ("8", "0"), ("6", "1")])
        columns = ("s_to_end", "m_ugv", "m_uav", "revisited_ugv", "revisited_uav", "first_uav", "steps_to_90", "end",
                   "separation_min_m")
        self.assertEqual([rows[0][key] for key in columns],
                         ["400", "200", "400", "0.3", "0.1", "0.74625", "37", "nothing_to_do", ""])
        self.assertEqual((rows[0]["false_free"], rows[0]["surface_found"]), ("0.02", "0.9"))
        self.assertEqual((rows[1]["failure"], rows[1]["s_to_end"]), ('a "b", c', ""))

    def tables(self, results):
        """As they are published."""
        rows, curves = self.folder / "page.csv", self.folder / "page_curves.csv"
        rows.write_text(rows_table(results.all.values()))
        curves.write_text(curves_table(r for r in results.all.values() if is_drawn(results, r.run)))
        return rows, curves

    def of_tables(self, runs, folder="nowhere", program=None):
        published = read_published(self.folder / "page.csv", self.folder / "page_curves.csv")
        return Results(self.experiments, runs, self.folder / folder, (), program, published)

    def whole(self, results):
        return page(results, "pictures", "runs.csv", "curves.csv"), figures(results), *(t.read_text() for t in self.tables(results))

    def test_published_tables_are_enough(self):
        runs = []
        all_hold(lambda run, **how: runs.append(self.make(run, **how)) if run.seed < 9 or run.task == "maze" else None)
        runs += [self.make(Run("maze", "tour", 30), failure='a "b",  c\n'), self.make(Run("maze", "tour", 31), coverage=0.98994),
                 self.make(Run("maze", "tour_noise", 6), separation_min_m=None)]
        of_files = self.whole(self.results(runs))
        self.assertTrue(self.whole(self.of_tables(runs)) == of_files)  # too long to print

    def test_runs_are_added_to_those_published(self):
        runs = [self.make(Run("maze", method, seed)) for seed in SEEDS for method in ("tour", "steps")]
        whole = self.whole(self.results(runs))
        first, second = self.folder / "first", self.folder / "second"
        for folder, part in ((first, runs[::3]), (second, [r for r in runs if r not in runs[::3]] + runs[:1])):
            folder.mkdir()
            for run in part:
                (folder / f"{run.name}.json").write_text((self.folder / f"{run.name}.json").read_text())
        (self.folder / "page.csv").unlink()
        self.tables(self.of_tables(runs, "first"))
        self.assertTrue(self.whole(self.of_tables(runs, "nowhere")) != whole)
        self.assertTrue(self.whole(self.of_tables(runs, "second")) == whole)
        self.assertTrue(self.whole(self.of_tables(runs, "nowhere")) == whole)
        # Of one program a run has one outcome; a failed one is done again, and what another program made is left out.
        published = read_published(self.folder / "page.csv", self.folder / "page_curves.csv")
        declared = self.experiments.declaration(runs[0])
        self.assertTrue(is_published(published, runs[0], declared, {PROGRAM}))
        self.assertFalse(is_published(published, runs[0], declared, {"another"}))
        self.assertFalse(is_published(published, runs[0], self.experiments.declaration(runs[1]), {PROGRAM}))
        self.assertFalse(is_published(published, Run("maze", "tour", 99), declared, {PROGRAM}))

    def test_what_is_published_stays(self):
        run, other = self.make(Run("maze", "tour", 6), wall_s=1.0), self.make(Run("maze", "tour", 7))
        self.tables(self.results([run, other]))

        def now(program=None):
            results = self.of_tables([run, other], ".", program)
            self.tables(results)
            return results

        self.make(run, wall_s=2.0)  # the same once more
        self.assertEqual((now().all[run]["wall_s"], now().broken), (1.0, {}))
        self.make(run, contacts=7)
        for _ in range(2):
            results = now()
            self.assertEqual((results.all[run]["contacts"], list(results.broken)), (0, [run.name]))
        self.make(run, failure="exit code 1: x")  # of an earlier attempt
        self.assertEqual((now().all[run].crashed, now().all[run]["failed_before"]), (False, "exit code 1: x"))
        (self.folder / f"{run.name}.json").write_text("{")
        self.assertEqual((now().all[run].crashed, now().broken), (False, {}))
        # What another program made is left out, and what is not asked for is counted.
        self.make(run, program="another", contacts=7)
        results = self.of_tables([run, other], ".", "another")
        self.assertEqual((list(results.all), results.of_others, results.broken), ([run], 1, {}))
        self.assertEqual((results.all[run]["contacts"], results.outdated), (7, 0))
        self.assertEqual(self.of_tables([other]).outdated, 1)

    def test_a_published_crash_is_done_again_and_stays_on_the_page(self):
        run = self.make(Run("maze", "tour", 6), failure="exit code 1: x")
        self.tables(self.results([run]))
        published = read_published(self.folder / "page.csv", self.folder / "page_curves.csv")
        self.assertFalse(is_published(published, run, self.experiments.declaration(run), {PROGRAM}))
        self.make(run)
        result = self.of_tables([run], ".").all[run]
        self.assertEqual((result.failure, result["failed_before"]), (None, "exit code 1: x"))

    def test_few_runs_of_another_program_get_a_page_of_their_own(self):
        runs = [self.make(Run("maze", "tour", seed)) for seed in (6, 7, 8)]
        file, own = self.folder / "docs/results.md", self.folder / "out/results.md"
        self.addCleanup(setattr, reproduce, "OWN_PAGE", reproduce.OWN_PAGE)
        reproduce.OWN_PAGE = own

        def write(program, replace=False):
            options = argparse.Namespace(page=file, replace=replace, runs=self.folder, like=[])
            with contextlib.redirect_stdout(io.StringIO()) as said:
                reproduce.write_page(self.experiments, runs, options, program)
            return said.getvalue()

        self.assertNotIn("other programs", write(PROGRAM))
        whole = file.read_text()
        self.make(runs[0], program="another")
        self.assertIn("has 2 runs of other programs and would have 1 of this one", write("another"))
        self.assertEqual(file.read_text(), whole)
        self.assertIn("from 1 of 3 runs", own.read_text())
        write("another", replace=True)
        self.assertIn("from 1 of 3 runs, seeds 6 to 6, by version 9.9, program another", file.read_text())

    def test_tables_that_are_not_ours_are_refused(self):
        rows, curves = self.tables(self.results([self.make(Run("maze", "tour", 6))]))
        whole, drawn = rows.read_text(), curves.read_text()
        self.assertEqual(len(read_published(rows, curves)), 1)
        for text, other in (("", drawn), (whole.replace("seed", "sead"), drawn), (whole + "maze,tour\n", drawn), (whole, drawn[:60]),
                            (whole.replace("nothing_to_do", ""), drawn), (whole.replace("0.999", "0.99x"), drawn),
                            (whole.replace("0.999", "nan"), drawn), (whole.replace(",6,0,", ",6,2.5,"), drawn),
                            (whole.replace("0.999", "7"), drawn), (whole.replace(",6,0,", ",6,,"), drawn),
                            (whole.replace(",0.02,0,0.9,", ",,0,0.9,"), drawn), (whole + whole.splitlines()[1] + "\n", drawn),
                            (whole, drawn.replace("12.7", "inf")), (whole, drawn.replace("12.7", "nan")),
                            (whole, drawn.replace("0 12.7", "0"))):
            self.assertNotEqual((text, other), (whole, drawn))
            rows.write_text(text)
            curves.write_text(other)
            with self.assertRaisesRegex(ValueError, "page.*csv", msg=(text, other)):
                read_published(rows, curves)
        rows.write_text(whole)
        curves.unlink()
        with self.assertRaisesRegex(ValueError, "page.csv is there and .* is not: bring it back"):
            read_published(rows, curves)
        rows.unlink()
        self.assertEqual(read_published(rows, curves), {})

    def test_earlier_failures_of_a_run_stay_on_the_page(self):
        run = self.make(Run("maze", "tour", 6), failure="exit code 1: x")
        task = self.experiments.task_file(run)
        self.assertEqual(failed_before(self.folder, run, task, PROGRAM), "exit code 1: x")
        self.assertIsNone(failed_before(self.folder, run, task, "another"))
        self.assertIsNone(failed_before(self.folder, run, {**task, "seed": 0}, PROGRAM))
        self.assertIsNone(failed_before(self.folder, Run("maze", "tour", 7), task, PROGRAM))
        again = {"failure": "hung", "measured": {"program": PROGRAM, "failed_before": "exit code 1: x"}}
        write_result(self.folder, run, task, VERSION, again)
        self.assertEqual(failed_before(self.folder, run, task, PROGRAM), "exit code 1: x; hung")
        outcome = self.outcome(run)
        outcome["measured"].update(program=PROGRAM, failed_before="exit code 1: x; hung")
        write_result(self.folder, run, task, VERSION, outcome)
        text = page(self.results([run]), "images", "runs.csv", "curves.csv")
        self.assertIn("- maze-tour-6, before this run of it: exit code 1: x; hung\n", text)

    def test_hostile_names(self):
        runs = [self.make(Run("maze", "tour", 6), failure=FAILURE + "\n# x"), self.make(Run("maze", "tour", 7)),
                self.make(Run("maze", "tour", 8), end="<b>|\n## y")]
        text = page(self.results(runs), "images", "runs.csv", "curves.csv")
        for bad in ("<script", "[here](x)", "\n# x", "\n## y", "<b>"):
            self.assertNotIn(bad, text)
        self.assertIn(plain(FAILURE), text)
        self.columns_agree(text)

    def test_figures(self):
        runs = [self.make(Run("maze", m, s), seconds=200.0 if m == "steps" else None)
                for m in ("tour", "render", "steps") for s in SEEDS]
        for chosen in (runs, runs[:1], [self.make(Run("maze", "tour", 20), failure="x")]):
            drawn = figures(self.results(chosen))
            for name, figure in drawn.items():
                xml.etree.ElementTree.fromstring(figure)
                self.assertNotRegex(figure, r"\bnan\b|\binf\b", name)
        # From the origin to the panel's corner, 0 to 99.9 %, in a straight line.
        drawn = figures(self.results(runs))["coverage_by_step"]
        lines = re.findall(r'<path d="M([^"]*)" class="line-steps" fill="none"[^>]*stroke-width="2.2"', drawn)
        points = [tuple(map(float, point.split())) for point in lines[0].split("L")]
        (_, y0), (_, ym), (_, y1) = points[0], points[len(points) // 2], points[-1]
        self.assertAlmostEqual(y0 - y1, 210 * 0.999, delta=0.2)
        self.assertAlmostEqual(ym, (y0 + y1) / 2, delta=0.2)
        # Three quarters are the UAV's: its area begins a quarter up at the end.
        area = re.search(r'<path d="M([^"]*)z" class="fill-uav"', figures(self.results(runs))["contributions"])[1]
        points = [tuple(map(float, point.split())) for point in area.split("L")]
        self.assertAlmostEqual(points[len(points) // 2 - 1][1] - points[len(points) // 2][1], -210 * 0.999 * 0.75, delta=0.3)

    def test_curves(self):
        self.assertEqual([value_at([0, 2, 4], [0, 10, 30], x) for x in (0, 1, 2, 3, 4, 9)], [0, 5, 10, 20, 30, 30])
        self.assertEqual(mean_curve([[(0, 1), (1, 4)], [(0, 3), (1, 8)]]), [(0, 2), (1, 6)])
        self.assertEqual([round_step(v, 5) for v in (100, 137, 0.9, 5)], [20, 50, 0.2, 1])


class Exploring(Made):
    """What a worker does, without Dask."""

    def setUp(self):
        super().setUp()
        self.command = self.folder / "frontlux"
        self.is_program(f'exec "{sys.executable}" -B "{Path(__file__).resolve().parent / "made_up_runs.py"}" "$@"')
        self.scratch = self.folder / "scratch"
        self.scratch.mkdir()
        os.environ["MADE_UP_LOG"] = str(self.folder / "log")
        self.task = self.experiments.task_file(Run("maze", "tour", 6))

    def is_program(self, script):
        version = f'if [ "$1" = --version ]; then echo "frontlux {VERSION}, x"; exit; fi'
        self.command.write_text(f"#!/bin/sh\n{version}\n{script}\n")
        self.command.chmod(0o755)

    def explore(self, world=""):
        program = explore.program_of(str(self.command))
        result = explore.explore(str(self.command), program, self.task, world, folder=str(self.scratch))
        self.assertEqual(list(self.scratch.iterdir()), [])
        return result

    def test_a_run(self):
        result = self.explore()
        self.assertEqual(result["facts"], {key: made_up(self.task)[0].get(key) for key in explore.FACTS})
        self.assertEqual(len(result["curve"]), 41)
        for key in ("planning_mean_s", "wall_s", "machine", "memory_mb"):
            self.assertNotIn(key, json.dumps({**result, "measured": None}))
        digest = hashlib.sha256(self.command.read_bytes()).hexdigest()
        self.assertEqual(result["measured"]["program"], digest[:12])
        self.assertRegex(result["measured"]["date"], r"^\d{4}-\d\d-\d\d$")
        self.assertEqual(self.explore(), result)

    def test_the_worlds_file_is_given_apart(self):
        mesh = self.folder / "mesh.ply"
        mesh.touch()
        self.task = {**self.task, "world": "mesh.ply", "world_sha256": hashlib.sha256(b"").hexdigest()}
        self.is_program('cat "$3" >&2; exit 2')
        self.assertIn(str(mesh), self.explore(str(mesh))["failure"])
        with self.assertRaisesRegex(OSError, "there is no .*none.ply on .*: copy it there"):
            self.explore(str(self.folder / "none.ply"))
        mesh.write_text("another mesh")
        with self.assertRaisesRegex(OSError, r"mesh.ply on .* is another file than the declared one: its SHA-256 is [0-9a-f]{64} instead"):
            self.explore(str(mesh))

    def test_failures(self):
        for script, said in (("echo no; echo why >&2; exit 3", "exit code 3: why"), ("kill -SEGV $$", "ended by SIGSEGV"),
                             ("exit 0", "what it left cannot be read"), ("exit 4", "exit code 4: it said nothing")):
            self.is_program(script)
            result = self.explore()
            self.assertEqual((set(result), set(result["measured"])), ({"failure", "measured"}, {"program", "date"}))
            self.assertIn(said, result["failure"])
            self.assertNotIn(str(self.scratch), result["failure"])

    def test_a_run_that_its_machine_ends_is_no_failure_of_the_run(self):
        for script in ("kill -9 $$", "kill -TERM $$", "exit 130"):
            self.is_program(script)
            with self.assertRaisesRegex(OSError, "has ended the run"):
                self.explore()

    def test_a_program_that_does_not_run_is_no_failure_of_the_run(self):
        program = explore.program_of(str(self.command))
        self.command.write_text("#!/bin/sh\nexit 127\n")
        with self.assertRaisesRegex(OSError, "does not run"):
            explore.explore(str(self.command), program, self.task, "", folder=str(self.scratch))

    def test_a_run_that_hangs_is_ended(self):
        self.is_program("exec sleep 600")
        longest, explore.LONGEST = explore.LONGEST, 0.3
        try:
            self.assertEqual(self.explore()["failure"], "not done after 0.3 s")
        finally:
            explore.LONGEST = longest

    def test_cut_off_tables_are_failures(self):
        self.explore()
        facts, rows = made_up(self.task)
        for cut in (lambda text: text[:-9], lambda text: text.split("\n")[0],
                    lambda text: text.replace("travelled_m", "x")):
            kept = self.folder / "kept"
            write_files(kept, facts, rows)
            (kept / "steps.csv").write_text(cut((kept / "steps.csv").read_text()))
            self.is_program(f'for last in "$@"; do :; done; mv "{kept}" "$last"')
            self.assertIn("cannot be read", self.explore()["failure"])

    def test_our_libraries_count_as_the_program(self):
        library, other = self.folder / "libfrontlux_planner.so.0", self.folder / "libc.so.6"
        (self.folder / "ldd").write_text("#!/bin/sh\n" + "".join(f"echo '\t{f.name} => {f} (0x00)'\n" for f in (other, library)))
        (self.folder / "ldd").chmod(0o755)
        path = os.environ["PATH"]
        self.addCleanup(os.environ.update, PATH=path)
        alone = explore.program_of(str(self.command))
        os.environ["PATH"] = f"{self.folder}:{path}"
        programs = [alone]
        for file, text in ((library, "one"), (library, "two"), (other, "three")):
            other.touch()
            file.write_text(text)
            programs.append(explore.program_of(str(self.command)))
        self.assertEqual(len(set(programs)), 3)
        self.assertEqual(programs[2], programs[3])

    def test_a_full_disk_is_no_failure_of_the_run(self):
        self.is_program("echo 'cannot write x: No space left on device' >&2; exit 1")
        with self.assertRaisesRegex(OSError, "has no room for the run"):
            self.explore()

    def test_another_program_is_no_failure_of_the_run(self):
        program = explore.program_of(str(self.command))
        self.is_program("exit 3")  # of the same version
        with self.assertRaisesRegex(OSError, rf"is {VERSION} \(.*\) instead of {VERSION} \({program.sha256}\)"):
            explore.explore(str(self.command), program, self.task, "", folder=str(self.scratch))
        with self.assertRaisesRegex(OSError, "there is no program"):
            explore.explore(str(self.folder / "none"), program, self.task, "", folder=str(self.scratch))


class Calls(unittest.TestCase):
    def test_bad_calls(self):
        for arguments, said in ((["--seeds", "0"], "1 to 1000"), (["--hours", "x"], "--hours"),
                                (["--quick", "--timed"], "not allowed"),
                                (["--like", "9a48"], "is no SHA-256; give 12 digits"),
                                (["--tables-only", "--runs", "/nonexistent", "--like", "0123456789AB,"], "'' is no SHA-256"),
                                (["--tables-only", "--runs", "/nonexistent", "--like", "0123456789AB"],
                                 "no run in /nonexistent or published is of program 0123456789ab; there are"),
                                (["--tables-only", "--tasks", "mase"], "'mase'"), (["--tables-only", "--methods", "x"], "'x'"),
                                (["--timed", "--scheduler", "tcp://x:1"], "--scheduler"),
                                (["--tables-only", "--runs", "/nonexistent", "--page", "/nonexistent/x.md"], "no result in /nonexistent"),
                                (["--compare", "/nonexistent"], "expected 2 arguments"),
                                (["--compare", "/nonexistent", "/none"], "no result in /nonexistent; give two")):
            done = subprocess.run([sys.executable, "-B", REPRODUCE / "reproduce.py", *arguments], capture_output=True,
                                  text=True)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main()
