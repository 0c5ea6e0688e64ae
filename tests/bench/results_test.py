"""Numbers of runs, and runs that are broken, published, or made by several programs.

results_test.py FOLDER, that of bench/reproduce; runs are made up in a temporary folder.
"""

import json
import math
import subprocess
import sys
import unittest

from made_up_results import REPRODUCE, Made
from made_up_runs import PROGRAM, VERSION, made_up, write_files

import explore
from experiments import Run
from figures import figures
from page import page
from results import Results, is_kept, unlike, write_result
from rows import rows_table


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
        # The interval is where the hospital counts as mapped.
        runs += [self.make(Run("hospital", "tour", seed), seconds=100.0, coverage=0.92) for seed in (9, 10, 11)]
        text = page(self.results(runs), "images", "runs.csv", "curves.csv")
        self.assertIn("| tours | 6 | 0 | 54 | 97 (96 to 98) | 99; 1 of 6 | – | 100 (100 to 100) |", text)

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
        for member in ("wall_s", "planning_mean_s", "planning_p99_s", "planning_max_s", "planning_p99_halves_s", "date"):
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


if __name__ == "__main__":
    unittest.main()
