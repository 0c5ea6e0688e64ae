"""The reproduction on Dask: lost workers, failed runs, Ctrl-C, and the same results wherever they were made.

cluster_test.py FOLDER, that of bench/reproduce; runs are made up.
"""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import warnings
from pathlib import Path

from made_up_runs import FAILURE

REPRODUCE = Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(REPRODUCE))

from distributed import Client
from experiments import FIRST_SEED, Experiments

PATIENCE = 120  # [s]
SOME = ["--quick", "--seeds", "1"]
ALL = [run.name for run in Experiments().runs("quick") if run.seed == FIRST_SEED]
MAZE, FACTORY = f"maze-tour-{FIRST_SEED}", f"factory-tour-{FIRST_SEED}"


# Each starts a cluster or two.
long_test = unittest.skipUnless(os.environ.get("FRONTLUX_LONG") == "1", "set FRONTLUX_LONG=1")


def until(true, what):
    deadline = time.monotonic() + PATIENCE
    while not true():
        if time.monotonic() > deadline:
            raise AssertionError(f"{what}: not within {PATIENCE} s")
        time.sleep(0.05)


def is_running(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


class Cluster(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.log = self.folder / "log"
        self.command = self.folder / "frontlux"
        program = Path(__file__).resolve().parent / "made_up_runs.py"
        self.command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -B "{program}" "$@"\n')
        self.command.chmod(0o755)

    def start(self, arguments, **environment):
        process = subprocess.Popen([sys.executable, "-B", *map(str, arguments)], text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, start_new_session=True,
                                   env={**os.environ, "MADE_UP_LOG": str(self.log), **environment})
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def reproduce(self, *arguments, runs="runs", **environment):
        return self.start([REPRODUCE / "reproduce.py", *SOME, "--command", self.command, "--runs", self.folder / runs,
                           "--page", self.folder / f"page_of_{runs}.md", *arguments], **environment)

    def finish(self, process, code):
        self.output, self.errors = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, code, self.output + self.errors)

    def calls(self):
        """Name, parent and process of each call of the program."""
        return [line.split() for line in self.log.read_text().splitlines()] if self.log.exists() else []

    def results(self, runs="runs"):
        """By name, without what was measured."""
        read = {file.stem: json.loads(file.read_text()) for file in (self.folder / runs).glob("*.json")}
        return {name: json.dumps({**result, "measured": None}, sort_keys=True) for name, result in read.items()}

    def number_of_workers(self, address):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of Dask, about its own use of Tornado
            with Client(address) as client:
                return len(client.nthreads())

    def workers(self, number, scheduler=True, **environment):
        """A scheduler, unless it is there, and workers in processes of their own; its address."""
        file = self.folder / "scheduler.json"
        if scheduler:
            self.start(["-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                        "--scheduler-file", file])
        until(lambda: file.exists() and file.read_text().rstrip().endswith("}"), "a scheduler")
        for _ in range(number):
            self.start(["-m", "distributed.cli.dask_worker", "--scheduler-file", file, "--nthreads", "1", "--no-nanny",
                        "--no-dashboard", "--local-directory", tempfile.mkdtemp(dir=self.folder)], **environment)
        return json.loads(file.read_text())["address"]

    def test_a_killed_worker_loses_its_run_only(self):
        self.finish(self.reproduce("--workers", "1"), 0)
        alone = self.results()
        self.assertEqual(sorted(alone), sorted(ALL))
        self.log.unlink()
        address = self.workers(2, MADE_UP_DIES_ONCE=FACTORY)
        self.finish(self.reproduce("--scheduler", address, runs="elsewhere"), 0)
        self.assertEqual(self.results("elsewhere"), alone)
        died, other = self.assert_repeated(FACTORY)
        self.assertFalse(is_running(died))
        self.assertTrue(is_running(other))

    def assert_repeated(self, name):
        """Every run was begun once, this one twice; a result that the dead worker had not handed over yet is made again.
        Returns both workers."""
        died, other = (int(parent) for run, parent, _ in self.calls() if run == name)
        self.assertNotEqual(died, other)
        elsewhere = [run for run, parent, _ in self.calls() if int(parent) != died]
        self.assertEqual(len(set(elsewhere)), len(elsewhere))
        self.assertEqual({run for run, *_ in self.calls()}, set(ALL))
        self.assertLessEqual(len(self.calls()), len(ALL) + 2)
        return died, other

    @long_test
    def test_what_a_machine_loses_is_missing_and_no_failure(self):
        self.finish(self.reproduce("--workers", "1", MADE_UP_DIES=FACTORY), 1)
        self.assertEqual(sorted(self.results()), sorted(set(ALL) - {FACTORY}))
        self.assertIn(f"{FACTORY}: LOST: its worker died again and again", self.output)
        self.assertIn("1 runs were lost by their machines", self.output)
        self.finish(self.reproduce("--workers", "1"), 0)
        self.assertEqual(sorted(self.results()), sorted(ALL))

    @long_test
    def test_a_program_that_changes_meanwhile_makes_no_more_runs(self):
        script = self.command.read_text()
        self.command.write_text(script.replace("exec", '[ "$1" = --version ] || echo "# built anew" >> "$0"\nexec'))
        self.finish(self.reproduce("--workers", "1"), 1)
        self.assertEqual(len(self.results()), 1)
        self.assertIn(f"{len(ALL) - 1} runs were lost by their machines", self.output)
        self.assertRegex(self.output, r"LOST: .* is 9.9 \(.*\) instead of 9.9 \(")

    @long_test
    def test_another_program_of_the_same_version_makes_all_runs_again(self):
        self.finish(self.reproduce("--workers", "2"), 0)
        self.log.unlink()
        before = hashlib.sha256(self.command.read_bytes()).hexdigest()
        self.command.write_text(self.command.read_text() + "# built anew\n")
        self.finish(self.reproduce("--workers", "2", "--like", before), 0)
        self.assertEqual(self.calls(), [])
        self.finish(self.reproduce("--workers", "2"), 0)
        self.assertEqual(sorted(name for name, *_ in self.calls()), sorted(ALL))
        programs = {json.loads(file.read_text())["measured"]["program"] for file in (self.folder / "runs").glob("*.json")}
        self.assertEqual(programs, {hashlib.sha256(self.command.read_bytes()).hexdigest()[:12]})

    @long_test
    def test_all_workers_need_the_same_program(self):
        other = self.folder / "other"
        other.mkdir()
        (other / "frontlux").write_text(self.command.read_text() + "# built anew\n")
        (other / "frontlux").chmod(0o755)
        address = self.workers(1, PATH=f"{self.folder}:{os.environ['PATH']}")
        self.workers(1, PATH=f"{other}:{os.environ['PATH']}", scheduler=False)
        until(lambda: self.number_of_workers(address) == 2, "two workers")
        self.finish(self.reproduce("--scheduler", address, "--command", "frontlux"), 2)
        self.assertIn("the workers have different programs frontlux: 9.9 (", self.errors)
        self.assertEqual(self.calls(), [])

    @long_test
    def test_a_worker_of_the_local_cluster_is_replaced(self):
        self.finish(self.reproduce("--workers", "2", MADE_UP_DIES_ONCE=FACTORY), 0)
        self.assertEqual(sorted(self.results()), sorted(ALL))
        self.assert_repeated(FACTORY)

    def test_failed_runs_are_failures_and_are_run_again(self):
        self.finish(self.reproduce("--workers", "2", MADE_UP_FAILS=MAZE), 1)
        self.assertEqual(len(self.results()), len(ALL))
        self.assertIn(f"{MAZE}: FAILED: exit code 3: {FAILURE}", self.output)
        text = (self.folder / "page_of_runs.md").read_text()
        self.assertIn(f"- {MAZE}: exit code 3: no", text)
        self.log.unlink()
        self.finish(self.reproduce("--workers", "2"), 0)
        self.assertEqual([name for name, *_ in self.calls()], [MAZE])
        page = (self.folder / "page_of_runs.md").read_text()
        self.assertIn(f"- {MAZE}, before this run of it: exit code 3: no", page)
        # What is published needs no files any more.
        shutil.rmtree(self.folder / "runs")
        self.log.unlink()
        self.finish(self.reproduce("--workers", "2"), 0)
        self.assertIn(f"{len(ALL)} of {len(ALL)} runs are kept or published from before", self.output)
        self.assertEqual((self.calls(), (self.folder / "page_of_runs.md").read_text()), ([], page))

    def test_ctrl_c_leaves_nothing_running_and_goes_on_later(self):
        for runs, interrupt in (("runs", lambda process: os.killpg(process.pid, signal.SIGINT)),  # as a terminal does
                                ("others", lambda process: process.send_signal(signal.SIGTERM))):
            self.log.unlink(missing_ok=True)
            process = self.reproduce("--workers", "1", runs=runs, MADE_UP_SLEEPS=FACTORY)
            until(lambda: [FACTORY] == [name for name, *_ in self.calls()][-1:], "a run that sleeps")
            worker, asleep = map(int, self.calls()[-1][1:])
            self.assertTrue(is_running(asleep))
            interrupt(process)
            self.finish(process, 130)
            self.assertRegex(self.errors, r"^\nstopped; finished runs are kept in .*\n$")
            until(lambda: not is_running(asleep) and not is_running(worker), "the end of the run and its worker")
            before = [name for name, *_ in self.calls() if name != FACTORY]
            self.assertEqual(sorted(self.results(runs)), sorted(before))
            self.assertGreater(len(before), 0)
            self.assertFalse((self.folder / f"page_of_{runs}.md").exists())
        self.finish(self.reproduce("--workers", "1"), 0)
        self.assertEqual(sorted(self.results()), sorted(ALL))

    def test_hours(self):
        self.finish(self.reproduce("--workers", "1", "--hours", "0"), 2)
        self.assertIn("no result in", self.errors)
        self.assertEqual(self.calls(), [])

    def test_nobody_there(self):
        self.finish(self.reproduce("--scheduler", "tcp://127.0.0.1:9"), 2)
        self.assertIn("no scheduler answers at tcp://127.0.0.1:9: start one with dask-scheduler", self.errors)

    @long_test
    def test_a_worker_without_the_program(self):
        address = self.workers(1)
        self.finish(self.reproduce("--scheduler", address, "--command", "/nonexistent/frontlux"), 2)
        self.assertIn("there is no program /nonexistent/frontlux", self.errors)


if __name__ == "__main__":
    unittest.main()
