"""Lines that hold and that fail.

lines_test.py FOLDER, that of bench/reproduce; runs are made up in a temporary folder.
"""

import unittest

from made_up_results import LOCKSTEP, NEEDED, Made, all_hold, none_hold
from made_up_runs import VERSION

import comparisons
import intervals
from claims import control_lines, our_lines
from experiments import Run
from paper_claims import paper_lines
from results import Result, Results
from rows import row_of


class Lines(Made):
    SHOWN = ("not comparable",)

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
            self.addCleanup(setattr, comparisons, name, getattr(comparisons, name))
            setattr(comparisons, name, needed)
        for line in self.judged(lambda make: [make(run, steps=4) for run in declared]).values():
            self.assertNotRegex(line.verdict, "^open: [0-9]+ of|^open: no pairs|^not measured", line)

    def test_few_pairs_decide_nothing(self):
        lines = self.judged(all_hold, lambda run, how: how if run.seed < 12 else None)
        self.assertEqual(lines["Time to 99 %: tours below view quality, maze"].verdict, "open: 6 of 8 pairs")
        self.assertRegex(lines["Time to 99 %: tours below view quality, maze"].measured, r"^0\.\d+× \(.* to .*\), 6 pairs$")
        self.assertEqual(lines["Time to 90 %: tours below view quality, hospital, one floor (AWS RoboMaker)"].verdict,
                         "open: 6 of 7 pairs")
        self.assertEqual(lines["as printed, maze: every run ends by itself with 90 % of the observable space mapped"].verdict,
                         "open: 6 of 8 runs")
        self.assertEqual(lines["View quality, worlds of others, without bumpers: no body touches a surface"].verdict,
                         "open: 6 of 7 runs of building render, and too few in 6 other rows")
        one = self.judged(all_hold, lambda run, how: how if run[:3] == ("maze", "render", 6) else None)
        self.assertEqual(one["View quality, built-in worlds, without bumpers: no body touches a surface"].verdict,
                         "open: 0 of 8 runs of factory render, and too few in 2 other rows")

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
        # Half of them are enough to outweigh worlds in which tours are slower.
        for last, verdict in ((9, "open: at least half of the second never got there in maze"), (6, "**does not hold**")):
            line = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.97} if run[:2] == ("maze", "nearest") and
                               run.seed <= last else {**how, "seconds": 500.0} if run[1] == "tour" else how)[
                                   "Time to 99 %: tours below nearest frontier, mean of worlds"]
            self.assertEqual(line.verdict, verdict)

    def test_an_end_by_ones_own_rule_makes_nobody_else_faster(self):
        for end, verdict in (("low_gain", "open: 4 of 8 runs of the second ended by their own rule before"), ("time_limit", "holds")):
            line = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.97, "end": end} if run[:2] == ("maze", "render") and
                               run.seed < 10 else how)["Time to 99 %: tours below view quality, maze"]
            self.assertEqual(line.verdict, verdict)
            self.assertEqual("4 never of the second, 4 of them ended by their own rule" in line.measured, end == "low_gain")

    def test_what_has_no_clearance_keeps_none(self):
        line = self.judged(all_hold, lambda run, how: {**how, "clearance_min_m": None})["Tours: bodies keep 0.01 m from surfaces"]
        self.assertEqual((line.measured, line.verdict), ("", "not measured"))

    def test_a_level_that_was_reached_counts_whatever_ended_the_run(self):
        claim = "as printed, maze: the team takes at least 30 % fewer planning steps than the UAV alone (up to 54 %); to 90 %"
        whole = self.judged(all_hold)[claim]
        cut = self.judged(all_hold, lambda run, how: {**how, "end": "step_limit"} if run[1] == "steps_uav" else how)[claim]
        self.assertEqual(cut, whole)
        never = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.8} if run[1] == "steps_uav" else how)[claim]
        self.assertEqual((never.verdict, never.measured),
                         ("reproduced", "at least half never got there, 8 pairs; 8 never of the second, 8 of them ended by their own rule"))

    def test_shares_are_of_all_runs_whatever_they_mapped(self):
        claim = "as printed, maze: optimisation raises the UAV's share of the map from 57 to 64 %, by 12 % of it"
        whole = self.judged(all_hold)[claim]
        line = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.8} if run[1] == "steps_yaw_ahead" and run.seed < 10 else how)[claim]
        self.assertEqual(line, whole._replace(measured=f"{whole.measured}; 4 of the second with less than 90 % mapped"))
        metres = "as printed, maze: optimisation shortens the UAV's path by 12 % (286 and 252 m); to 90 %"
        line = self.judged(all_hold, lambda run, how: {**how, "coverage": 0.8} if run[1] == "steps" else how)[metres]
        self.assertEqual(line.verdict, "**not reproduced: the opposite**")
        self.assertIn("8 never of the first", line.measured)

    def test_no_line_asks_for_what_is_not_declared(self):
        claims = [line.claim for line in self.lines(lambda make: None)]
        self.assertFalse([c for c in claims if "office" in c and "UAV alone" in c])


if __name__ == "__main__":
    unittest.main()
