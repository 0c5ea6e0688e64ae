"""The runs of the reproduction, and a runner for those that are missing."""

import json
import signal
import subprocess
import threading
import time
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import NamedTuple

WORLDS = ("maze", "factory", "station")
CASTERS = ("fast", "embree", "grid", "octomap")
STEP_LIMIT = 1000
COMPARED, COMPARED_SEEDS = ("team", "uav"), 5  # with at least so many seeds
LONGEST_RUN = 3600  # [s], after which a run counts as hanging

DEFAULTS = {"mode": "default", "goal": "render", "assign": "on", "optimize": "on", "caster": "fast",
            "robots": {"uav", "ugv"}, "lockstep": "on"}


class Variant(NamedTuple):
    title: str
    arguments: tuple = ()
    differs: dict = {}  # from DEFAULTS in run.json; None: any value


VARIANTS = {
    "team": Variant("team (default)"),
    "uav": Variant("UAV alone", ("--team", "uav"), {"robots": {"uav"}}),
    "ugv": Variant("UGV alone", ("--team", "ugv"), {"robots": {"ugv"}}),
    "unoptimised": Variant("no optimisation", ("--optimize", "off"), {"optimize": "off"}),
    "unassigned": Variant("no assignment", ("--assign", "off"), {"assign": "off"}),
    "paper": Variant("paper mode", ("--mode", "paper"), {"mode": "paper", "goal": None}),
    "cluster": Variant("cluster goals", ("--goal", "cluster"), {"goal": "cluster"}),
    # The nearest cell is always next to the robot. With steps of 0.6 m most runs would not end.
    "nearest": Variant("nearest goals", ("--goal", "nearest", "--min-distance", "3"), {"goal": "nearest"}),
}


class Run(NamedTuple):
    world: str
    variant: str
    seed: int
    caster: str = "fast"
    threads: int = 1
    timed: bool = False  # alone on the machine

    @property
    def name(self):
        return f"{self.world}_{self.caster}_timed" if self.timed else f"{self.world}_{self.variant}_{self.seed}"

    def arguments(self, folder):
        return ["explore", self.world, "--lockstep", "--seed", str(self.seed), "--threads", str(self.threads), "--caster",
                self.caster, "--max-steps", str(STEP_LIMIT), *VARIANTS[self.variant].arguments, "--report", "off",
                "-o", str(folder)]


def wanted_runs(seeds):
    """Seed by seed, so that an early end leaves runs to compare; the timed runs last."""
    runs = [Run(w, v, s) for s in range(1, max(seeds, COMPARED_SEEDS) + 1) for w in reversed(WORLDS)
            for v in (VARIANTS if s <= seeds else COMPARED)]
    return runs + [Run(w, "team", 1, c, 2, True) for c in CASTERS for w in WORLDS]


def refuse_constant(name):
    raise ValueError(f"{name} is not a number")


def read_facts(folder):
    """run.json. Raises OSError or ValueError."""
    try:
        facts = json.loads((folder / "run.json").read_text(encoding="utf-8"), parse_constant=refuse_constant)
    except RecursionError as error:
        raise ValueError("run.json is nested too deeply") from error
    if not isinstance(facts, dict):
        raise ValueError("run.json is not a JSON object")
    return facts


def kind_of(robot):
    """uav2 is a uav."""
    return robot.rstrip("0123456789")


def mismatch(run, facts, version):
    """The first value in run.json that belongs to another run than this one; empty if there is none."""
    expected = {**DEFAULTS, "caster": run.caster, **VARIANTS[run.variant].differs, "world": run.world,
                "seed": run.seed, "threads": run.threads, "version": version}
    for key, value in expected.items():
        found = facts.get(key)
        if isinstance(found, bool):
            found = "on" if found else "off"
        if key == "robots" and isinstance(found, list):
            found = {kind_of(str(robot)) for robot in found}
        if value is not None and found != value:
            return f"{key} is {found!r} instead of {value!r}"
    return ""


def is_finished(facts):
    return isinstance(facts.get("end"), str) and facts["end"] not in ("", "stopped")


def next_action(run, folder, version):
    """What to do with the folder: "keep", "resume", "force" (overwrite another run, or an incomplete one) or "start"."""
    if not folder.is_dir() or not any(folder.iterdir()):
        return "start"
    try:
        facts = read_facts(folder)
    except OSError:
        facts = None  # killed before it was written
    except ValueError:
        return "force"
    if facts is not None and mismatch(run, facts, version):
        return "force"
    if facts is not None and is_finished(facts):
        return "keep"
    return "resume" if (folder / "run.frontlux").is_file() else "force"


def last_line(text):
    lines = [line.strip() for line in text.replace("\r", "\n").splitlines() if line.strip()]
    return lines[-1][:300] if lines else ""


class Runner:
    """Runs `frontlux explore`, several at a time; ends the processes that it has started."""

    def __init__(self, command, folder, version, say=print):
        self.command, self.folder, self.version, self.say = str(command), folder, version, say
        self.failures = {}  # name of the run to what went wrong
        self.started, self.stopping, self.lock = set(), False, threading.Lock()

    def call(self, run, arguments):
        """Exit code and output of the command; the output is also kept beside the runs."""
        log = self.folder / "logs" / f"{run.name}.log"
        with open(log, "w", encoding="utf-8") as output:
            with self.lock:
                if self.stopping:
                    return -signal.SIGINT, "stopped"
                # In a session of its own, so that Ctrl-C reaches it once, through stop().
                process = subprocess.Popen([self.command, *arguments], stdin=subprocess.DEVNULL, stdout=output,
                                           stderr=subprocess.STDOUT, start_new_session=True)
                self.started.add(process)
            try:
                code = process.wait(LONGEST_RUN)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                code = -signal.SIGKILL
            finally:
                with self.lock:
                    self.started.discard(process)
        return code, last_line(log.read_text(encoding="utf-8", errors="replace"))

    def execute(self, run):
        """Executes a run; returns the seconds that it took."""
        begin, folder = time.monotonic(), self.folder / run.name
        todo = next_action(run, folder, self.version)
        code = 1
        if todo == "resume":
            code, said = self.call(run, ["explore", "--resume", str(folder), "--report", "off"])
            if code == 0 and next_action(run, folder, self.version) != "keep":
                code = 1  # it continued another run
            todo = "force"
        if code != 0 and not self.stopping:
            code, said = self.call(run, run.arguments(folder) + (["--force"] if todo == "force" else []))
        if code != 0:
            self.failures[run.name] = f"exit code {code}: {said}" if code > 0 else f"ended by signal {-code}: {said}"
        elif next_action(run, folder, self.version) != "keep":
            self.failures[run.name] = "exit code 0, but no finished run with these options was left"
        return time.monotonic() - begin

    def stop(self):
        with self.lock:
            self.stopping = True
            started = list(self.started)
        for process in started:
            process.send_signal(signal.SIGINT)
        deadline = time.monotonic() + 30
        for process in started:
            try:
                process.wait(max(deadline - time.monotonic(), 0.1))
            except subprocess.TimeoutExpired:
                process.kill()

    def run_all(self, runs, jobs):
        (self.folder / "logs").mkdir(parents=True, exist_ok=True)
        left = [run for run in runs if next_action(run, self.folder / run.name, self.version) != "keep"]
        self.say(f"{len(runs) - len(left)} of {len(runs)} runs are finished already, {len(left)} to do")
        done, seconds = 0, []
        for group, at_once in ((False, jobs), (True, 1)):
            with ThreadPoolExecutor(at_once) as pool:
                pending = {pool.submit(self.execute, run): run for run in left if run.timed == group}
                try:
                    while pending:
                        for future in wait(pending, return_when=FIRST_COMPLETED).done:
                            run = pending.pop(future)
                            seconds.append(future.result())
                            done += 1
                            self.report(run, done, left, seconds, jobs)
                except BaseException:
                    for future in pending:
                        future.cancel()
                    self.stop()
                    raise

    def report(self, run, done, left, seconds, jobs):
        if run.name in self.failures:
            outcome = f"FAILED, {self.failures[run.name]}"
        else:
            facts = read_facts(self.folder / run.name)
            outcome = f"{facts.get('end')} after {facts.get('steps')} steps"
        timed = sum(other.timed for other in left[done:])
        # Estimated from the mean so far; the timed runs are done one after the other.
        minutes = sum(seconds) / len(seconds) * ((len(left) - done - timed) / jobs + timed) / 60
        self.say(f"[{done}/{len(left)}] {run.name}: {outcome}, {seconds[-1]:.0f} s; about {minutes:.0f} min left")


def version_of(command):
    """The version that `frontlux --version` prints."""
    if not command.is_file():
        raise OSError(f"{command} does not exist: build it with ./dev build")
    said = subprocess.run([command, "--version"], capture_output=True, text=True, timeout=60, check=True)
    return said.stdout.strip().removeprefix("frontlux ").strip()
