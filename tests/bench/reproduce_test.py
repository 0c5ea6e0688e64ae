"""The reproduction's numbers against values worked out by hand, and what it makes of runs that are broken or fail.

reproduce_test.py FOLDER, that of bench/reproduce; runs are made up in a temporary folder.
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree
from pathlib import Path

from made_up_runs import FAILURE, write_run

REPRODUCE = Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(REPRODUCE))

from checklist import means, savings, verdict
from figures import figures, mean_curve, round_step, value_at
from markdown import plain, spread_of
from recorded import Recorded, Results, first_difference, spread
from runs import Run, next_action, wanted_runs
from tables import document

CURVE = [0.1, 0.5, 0.9, 0.95]


def reaching(step, last=0.96):
    """A curve that has 90 % first in that step, and ends two steps later."""
    return [0.1] * step + [0.9, 0.93, last]


class Made(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def make(self, run, coverage, **facts):
        robots = (run.variant,) if run.variant in ("uav", "ugv") else ("ugv", "uav")
        write_run(self.folder / run.name, run.world, run.seed, coverage, robots, **facts)
        return run

    def row(self, text, heading, first):
        """Cells of the first row of that section that begins so."""
        section = text.split(f"## {heading}\n")[1].split("\n## ")[0]
        line = next(line for line in section.splitlines() if line.startswith(f"| {first} |"))
        return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


class Numbers(Made):
    def test_spread(self):
        self.assertEqual(spread([97.0, 99.0, 98.0]), (98.0, 97.0, 99.0, 1.0, 3))
        self.assertEqual(spread([5.0, None, float("nan")]), (5.0, 5.0, 5.0, 0.0, 1))
        self.assertIsNone(spread([]))
        self.assertEqual(spread_of(spread([0.97, 0.99, 0.98]), 1, 100, " %"), "98.0 % (97.0..99.0, sd 1.0)")

    def test_one_run(self):
        run = self.make(Run("maze", "team", 1), CURVE)
        recorded = Recorded(run, self.folder / run.name)
        self.assertEqual(recorded.steps, 3)
        self.assertEqual(recorded.coverage, CURVE)
        self.assertEqual(recorded.steps_to(0.9), 2)
        self.assertIsNone(recorded.steps_to(0.96))
        self.assertEqual(recorded.steps_or_limit(0.96), 1000)
        self.assertEqual(recorded.length_to(0.9), 2 * (4 + 8))
        self.assertEqual(recorded.travelled("uav"), [0, 8, 16, 24])
        self.assertAlmostEqual(recorded.fraction_of("uav"), 0.75)
        self.assertEqual(recorded.gains("uav", "gain_predicted"), [150] * 3)
        self.assertEqual(recorded.seconds("optimization_s"), [0.010] * 3)

    def test_a_limit_of_its_own(self):
        run = self.make(Run("maze", "team", 1), [0.1, 0.2], max_steps=77)
        self.assertEqual(Recorded(run, self.folder / run.name).steps_or_limit(0.9), 77)

    def test_several_robots_of_a_kind(self):
        run = Run("maze", "team", 1)
        self.make(run, CURVE)
        file = self.folder / run.name / "steps.csv"
        lines = file.read_text().splitlines()
        twice = [lines[0]] + [line.replace(",uav,", f",uav{i},") for line in lines[1:] for i in (1, 2)
                              if i == 1 or ",uav," in line]
        file.write_text("\n".join(twice) + "\n")
        self.assertEqual(Recorded(run, file.parent).travelled("uav")[-1], 48)

    def test_savings(self):
        runs = [self.make(Run("maze", "team", 1), reaching(6)), self.make(Run("maze", "uav", 1), reaching(10)),
                self.make(Run("maze", "team", 2), reaching(5)), self.make(Run("maze", "uav", 2), [0.1, 0.8]),
                self.make(Run("maze", "team", 3), reaching(5))]
        results = Results(runs, self.folder, {})
        counted, reached = savings(results, "team", "uav", ["maze"])
        self.assertEqual(counted.count, 2)  # seed 3 has no partner
        self.assertAlmostEqual(counted.mean, (0.4 + 0.995) / 2)
        self.assertEqual(reached.count, 1)
        self.assertAlmostEqual(reached.mean, 0.4)
        pairs = results.pairs("team", "uav", ["maze"])
        self.assertEqual(means(pairs, lambda run: run.steps), ((8 + 7) / 2, (12 + 1) / 2))
        self.assertEqual(means(pairs, lambda run: run.length_to(0.9)), (6 * 12, 10 * 8))  # UAV alone: 8 m a step

    def test_verdicts(self):
        self.assertEqual(verdict(97.2, 97.2), "holds")
        self.assertEqual(verdict(97.0, 97.2, " points", 2), "**falls short by 0.20 points**")
        self.assertEqual(verdict(0.5, 0.5, at_most=True), "holds")
        self.assertEqual(verdict(0.75, 0.5, " s", 2, at_most=True), "**falls short by 0.25 s**")
        self.assertEqual(verdict(10, 12, below=True), "holds")
        self.assertEqual(verdict(12, 12, below=True), "**falls short: the same**")
        self.assertEqual(verdict(None, 1), "not measured")

    def test_differences(self):
        one, slower, other, shorter = (Run("maze", "team", seed) for seed in range(1, 5))
        self.make(one, CURVE)
        self.make(slower, CURVE, phases=(0.1, 0.2, 0.3, 0.4, 0.5))
        self.make(other, [0.1, 0.5, 0.8, 0.95])
        self.make(shorter, CURVE[:3])
        read = Results([one, slower, other, shorter], self.folder, {}).runs
        self.assertIsNone(first_difference(read[one], read[slower]))
        self.assertEqual(first_difference(read[one], read[other]), 2)
        self.assertEqual(first_difference(read[one], read[shorter]), 3)

    def test_curves(self):
        self.assertEqual([value_at([0, 2, 4], [0, 10, 30], x) for x in (0, 1, 2, 3, 4, 9)], [0, 5, 10, 20, 30, 30])
        self.assertEqual(mean_curve([[(0, 1), (1, 4)], [(0, 3), (1, 8)]]), [(0, 2), (1, 6)])
        self.assertEqual([round_step(v, 5) for v in (100, 137, 0.9, 5)], [20, 50, 0.2, 1])


class Document(Made):
    def results(self, runs, failures=None):
        return Results(runs, self.folder, failures or {})

    def test_cells(self):
        runs = [self.make(Run("maze", "team", 1), reaching(6, 0.975)),
                self.make(Run("maze", "team", 2), reaching(8, 0.965)),
                self.make(Run("maze", "uav", 1), reaching(12)), self.make(Run("maze", "uav", 2), [0.1, 0.8]),
                self.make(Run("maze", "unoptimised", 1), CURVE, uav_part=0.6, optimize=False),
                self.make(Run("maze", "team", 1, "fast", 2, True), reaching(6, 0.975), threads=2),
                self.make(Run("maze", "team", 1, "grid", 2, True), reaching(7, 0.975), threads=2,
                          phases=(0.001, 0.002, 0.023, 0.004, 0.010))]
        text = document(self.results(runs), "images")
        self.assertEqual(self.row(text, "Coverage and steps", "maze"),
                         ["maze", "97.2 %", "97.0 % (96.5..97.5, sd 0.7)", "69", "9.0 (8.0..10.0, sd 1.4)",
                          "8.0, 1 of 2 runs", "7.0"])
        row = self.row(text, "The team and each robot alone", "maze")
        self.assertEqual(row[1:4], ["7.0", "506.0 (12.0 in 1 of 2 that reached it)", "–"])
        self.assertEqual(row[4:6], ["74.6 % (50.0..99.2, sd 34.8)", "50.0 % (1 of 2)"])
        self.assertEqual(row[6:], ["60 m (8..112, sd 74)", "72 m (64..80, sd 11)"])
        self.assertEqual(self.row(text, "Contributions", "maze")[2:4], ["60 %", "75 % (75..75, sd 0)"])
        self.assertEqual(self.row(text, "Planning time", "maze")[1:9],
                         ["1.0", "2.0", "3.0", "4.0", "10.0", "20.0", "40.0", "2.26 s"])
        self.assertEqual(self.row(text, "The ray casters", "maze | grid")[2:8],
                         ["**not the same** from step 6 on", "9", "97.5 %", "40.0", "80.0", "2.00×"])
        self.assertIn("| lowest 96.5 %, mean 97.0 %; seeds 1, 2 | **falls short by 0.70 points** |", text)
        self.assertIn("| maze: **not the same** from step 6 on | **falls short in 1 worlds** |", text)

    def test_broken_runs_are_listed_and_left_out(self):
        good, *bad = (Run("maze", "team", seed) for seed in range(1, 15))
        for run in (good, *bad):
            self.make(run, CURVE)

        def change(run, name, edit):
            file = self.folder / run.name / name
            file.write_text(edit(file.read_text(encoding="utf-8")), encoding="utf-8")

        change(bad[0], "steps.csv", lambda t: t[:-40])
        change(bad[1], "steps.csv", lambda t: t[:t.rindex("3,37.5,uav")])
        change(bad[2], "steps.csv", lambda t: t.replace("0.95,", "nan,"))
        change(bad[3], "steps.csv", lambda t: t.replace("0.95,", "1.5,"))
        change(bad[4], "steps.csv", lambda t: t.replace("planning_s", "thinking_s"))
        change(bad[5], "steps.csv", lambda t: "")
        change(bad[6], "steps.csv", lambda t: t[:t.index("\n2,25.0,ugv")] + "\n")
        change(bad[7], "run.json", lambda t: t.replace('"wall_s": 36.0', '"wall_s": NaN'))
        change(bad[8], "run.json", lambda t: t.replace('"wall_s": 36.0', '"wall_s": 1e999'))
        change(bad[9], "run.json", lambda t: t.replace('"low_gain"', '"stopped"'))
        change(bad[10], "run.json", lambda t: "[" * 100000)
        (self.folder / bad[11].name / "run.json").write_bytes(b"\xff\xfe\x00{")
        (self.folder / bad[12].name / "steps.csv").unlink()
        results = self.results([good, *bad])
        self.assertEqual([run.run for run in results.runs.values()], [good])
        self.assertEqual(len(results.broken), len(bad))
        reasons = list(results.broken.values())
        for reason, part in zip(reasons, ("cells, not", "every robot in every step", "not within", "not within 0 and 1",
                                          "no column planning_s", "no column", "3 steps, steps.csv 1",
                                          "NaN is not a number", "wall_s is inf", "not finished", "too deeply")):
            self.assertIn(part, reason)
        text = document(results, "images")
        for run, reason in zip(bad, reasons):
            self.assertIn(f"- {plain(run.name)}: {plain(reason)}\n", text)
        self.assertIn("1 of 14 runs", text)
        self.assertIn("13 failed or missing | **falls short by 13 runs**", text)

    def test_hostile_names(self):
        runs = [self.make(Run("maze", "team", 1), CURVE, end=FAILURE, machine=FAILURE + "\n# x", version="<b>|")]
        text = document(self.results([*runs, Run("maze", "uav", 1)], {"maze_uav_1": FAILURE + "\n\n## y"}), "images")
        self.assertNotIn("<script", text)
        self.assertNotIn("[here](x)", text)
        self.assertNotIn("\n# x", text)
        self.assertNotIn("\n## y", text)
        columns = None
        for line in text.splitlines():
            cells = len(re.findall(r"(?<!\\)\|", line)) if line.startswith("|") else None
            if cells is not None and columns is not None:
                self.assertEqual(cells, columns, line)
            columns = cells

    def test_figures(self):
        runs = [self.make(Run("maze", "team", 1), [0.0, 0.5, 1.0])]
        drawn = figures(self.results(runs))
        for name, figure in drawn.items():
            xml.etree.ElementTree.fromstring(figure)
            self.assertNotRegex(figure, r"\bnan\b|\binf\b", name)
        # From the origin to the corner of the panel: 0 % in step 0, 100 % in the last, in a straight line.
        lines = re.findall(r'<path d="M([^"]*)" class="line-team" fill="none"[^>]*stroke-width="2.4"',
                           drawn["coverage_by_step"])
        points = [tuple(map(float, point.split())) for point in lines[0].split("L")]
        (x0, y0), (xm, ym), (x1, y1) = points[0], points[len(points) // 2], points[-1]
        self.assertAlmostEqual(y0 - y1, 200, delta=0.2)
        self.assertAlmostEqual(ym, (y0 + y1) / 2, delta=0.2)
        self.assertAlmostEqual(xm, (x0 + x1) / 2, delta=0.2)


class Running(Made):
    def setUp(self):
        super().setUp()
        self.log, self.runs = self.folder / "log", self.folder / "runs"
        self.command = self.folder / "frontlux"
        program = Path(__file__).resolve().parent / "made_up_runs.py"
        self.command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -B "{program}" "$@"\n')
        self.command.chmod(0o755)

    def start(self, *arguments, **environment):
        return subprocess.Popen(
            [sys.executable, "-B", REPRODUCE / "results.py", "--seeds", "1", "--jobs", "2", "--command", self.command,
             "--runs", self.runs, "--results", self.folder / "docs/results.md", "--images", self.folder / "docs/images",
             *arguments], env={**os.environ, "MADE_UP_LOG": str(self.log), **environment}, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def reproduce(self, code, *arguments, **environment):
        """The calls that it made."""
        self.log.unlink(missing_ok=True)
        process = self.start(*arguments, **environment)
        self.output, self.errors = process.communicate()
        self.assertEqual(process.returncode, code, self.output + self.errors)
        return self.log.read_text().splitlines() if self.log.exists() else []

    def test_kept_resumed_repeated_and_failed(self):
        calls = self.reproduce(1, MADE_UP_FAILS="maze_uav_1", MADE_UP_STOPS="factory_ugv_1")
        self.assertEqual(len(calls), len(wanted_runs(1)))
        self.assertIn("exit code 3", self.errors)
        text = (self.folder / "docs/results.md").read_text()
        self.assertIn(f"- maze\\_uav\\_1: exit code 3: {plain(FAILURE)}\n", text)
        self.assertIn("- factory\\_ugv\\_1: exit code 0, but", text)
        self.assertEqual(len(list((self.folder / "docs/images").glob("*.svg"))), 5)
        # The failed one once more, the unfinished one from where it is, one of another version from anew.
        file = self.runs / "station_paper_1/run.json"
        file.write_text(file.read_text().replace('"9.9"', '"9.8"'))
        calls = sorted(self.reproduce(0))
        self.assertEqual(len(calls), 3)
        self.assertEqual(calls[0], f"explore --resume {self.runs / 'factory_ugv_1'} --report off")
        self.assertEqual(calls[1].split(" -o ")[0], "explore maze --lockstep --seed 1 --threads 1 --caster fast "
                         "--max-steps 1000 --team uav --report off")
        self.assertRegex(calls[2], r"^explore station .*--mode paper.* --force$")
        self.assertIn("None.", (self.folder / "docs/results.md").read_text())
        self.assertEqual(self.reproduce(0), [])

    def test_ctrl_c_keeps_what_is_finished(self):
        process = self.start("--jobs", "1", MADE_UP_SLEEPS="maze_team_1")
        asleep = self.runs / "logs/maze_team_1.log"
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and not (asleep.exists() and "asleep" in asleep.read_text()):
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertIn("stopped", errors)
        calls = self.log.read_text().splitlines()
        self.assertEqual(calls[-1], "interrupted")
        finished = [run for run in wanted_runs(1) if next_action(run, self.runs / run.name, "9.9") == "keep"]
        self.assertEqual(len(finished), len(calls) - 2)
        self.assertGreater(len(finished), 0)
        self.assertFalse((self.folder / "docs").exists())
        self.assertEqual(len(self.reproduce(0)), len(wanted_runs(1)) - len(finished))

    def test_other_options_are_another_run(self):
        run = Run("maze", "nearest", 1)
        for facts, expected in (({"goal": "nearest"}, "keep"), ({"goal": "render"}, "force"), ({}, "force"),
                                ({"goal": "nearest", "threads": 2}, "force"), ({"goal": "nearest", "seed": 2}, "force"),
                                ({"goal": "nearest", "optimize": False}, "force"),
                                ({"goal": "nearest", "end": "stopped"}, "resume"),
                                ({"goal": "nearest", "end": None}, "resume")):
            with self.subTest(facts):
                write_run(self.runs / run.name, "maze", facts.pop("seed", 1), CURVE, **facts)
                self.assertEqual(next_action(run, self.runs / run.name, "9.9"), expected)
        (self.runs / run.name / "run.json").write_text("{")
        self.assertEqual(next_action(run, self.runs / run.name, "9.9"), "force")
        (self.runs / run.name / "run.json").unlink()
        self.assertEqual(next_action(run, self.runs / run.name, "9.9"), "resume")
        self.assertEqual(next_action(run, self.runs / "none", "9.9"), "start")

    def test_bad_calls(self):
        self.reproduce(2, "--seeds", "0")
        self.reproduce(2, "--seeds", "many")
        self.reproduce(2, "--command", str(self.folder / "none"))
        self.assertIn("./dev build", self.errors)
        self.reproduce(2, "--tables-only")
        self.assertFalse((self.folder / "docs").exists())


if __name__ == "__main__":
    unittest.main()
