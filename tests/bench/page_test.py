"""The page, its tables and its figures.

page_test.py FOLDER, that of bench/reproduce; runs are made up in a temporary folder.
"""

import argparse
import contextlib
import csv
import io
import re
import unittest
import xml.etree.ElementTree

from made_up_results import SEEDS, Made, all_hold
from made_up_runs import FAILURE, PROGRAM, VERSION

import reproduce
from experiments import Run
from figures import figures, is_drawn, mean_curve, round_step, value_at
from markdown import plain
from page import page
from results import Results, failed_before, is_published, write_result
from rows import curves_table, read_published, rows_table


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
        self.assertRegex(short, r"- \[What must hold\]\(#what-must-hold\): Of \d+ lines: \d+ holds?")
        self.assertLessEqual(len(short.strip().splitlines()) - 2, 10)
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
        # Planning times of runs side by side say nothing.
        self.assertEqual([row["planning_p99_s"] for row in rows], ["", "", "0.1"])

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

    def test_a_program_that_is_like_another_hides_no_crash_of_it(self):
        run = self.make(Run("maze", "tour", 6), "another")
        self.tables(self.results([run]))
        self.make(run, failure="ended by SIGSEGV: x")
        published = read_published(self.folder / "page.csv", self.folder / "page_curves.csv")
        results = Results(self.experiments, [run], self.folder, ["another"], PROGRAM, published)
        self.assertEqual((results.all[run].failure, results.all[run]["failed_before"]), (None, "ended by SIGSEGV: x"))
        self.assertIn("- maze-tour-6, before this run of it: ended by SIGSEGV: x", page(results, "images", "runs.csv", "curves.csv"))

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


if __name__ == "__main__":
    unittest.main()
