"""What is declared, what a worker makes of it, and calls of the command.

declared_runs_test.py FOLDER, that of bench/reproduce; runs are made up in a temporary folder.
"""

import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

from made_up_results import BUILT_IN, REPRODUCE, Made
from made_up_runs import VERSION, made_up, write_files

import explore
import reproduce
from experiments import FIRST_SEED, Experiments, Run, merged


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

    def test_the_docs_say_how_many(self):
        page = (REPRODUCE.parent.parent / "docs/reproducing.md").read_text()
        runs = self.experiments.runs("full")
        first = next(i for i, run in enumerate(runs) if run.seed > FIRST_SEED + 5)
        for said in (f"begin at {FIRST_SEED},", f"The first pass is {first} runs, and all are {len(runs):,}; `--timed` adds "
                     f"{len(self.experiments.runs('timed'))}."):
            self.assertIn(said, page)

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


class PlanningTimes(Made):
    def halves(self, seconds):
        file = self.folder / "events.csv"
        file.write_text("time_s,planning_s\n" + "".join(f"0,{s}\n" for s in seconds))
        return explore.planning_halves(file)

    def test_are_by_halves_of_the_plannings(self):
        self.assertEqual(self.halves([*range(1, 101), *range(200, 100, -1)]), [99, 199])
        self.assertEqual(self.halves([3, 1, 2, 5, 4]), [3, 5])
        self.assertIsNone(self.halves([1]))
        self.assertIsNone(self.halves([]))
        with self.assertRaises(ValueError):
            self.halves(["x", 1])


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
    @unittest.skipUnless(shutil.which("git"), "needs git")
    def test_a_program_of_our_own_build_has_a_commit(self):
        def git(*arguments):
            return subprocess.run(["git", "-C", root, "-c", "user.name=x", "-c", "user.email=x", *arguments], capture_output=True, text=True,
                                  check=True).stdout.strip()
        with tempfile.TemporaryDirectory() as temporary, unittest.mock.patch.object(reproduce, "ROOT", Path(temporary).resolve()):
            root = reproduce.ROOT
            program, source = root / "frontlux", root / "engine/ray.cpp"
            source.parent.mkdir()
            for file in (program, source):
                file.touch()
            self.assertEqual(reproduce.commit_of(str(program)), "")
            git("init", "-q")
            git("add", "engine")
            git("commit", "-qm", "x")
            git("commit", "-qm", "y", "--allow-empty")
            commit = f" of commit {git('rev-parse', 'HEAD~')[:10]}"
            self.assertEqual(reproduce.commit_of(str(program)), commit)
            self.assertEqual(reproduce.commit_of("git"), "")
            source.write_text("changed")
            self.assertEqual(reproduce.commit_of(str(program)), commit + " with changes")

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
