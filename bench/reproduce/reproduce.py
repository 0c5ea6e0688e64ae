#!/usr/bin/env python3
"""Runs what experiments.json declares on a cluster, and writes the page of results and its figures from it."""

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from experiments import Experiments
from explore import program_of
from results import Results, failed_before, is_kept, is_published, programs_in, unlike, write_result
from rows import curves_table, read_published, rows_table

ROOT = Path(__file__).resolve().parent.parent.parent
OWN_PAGE = ROOT / "out/reproduce/results.md"  # of a program that has made fewer runs than are published
sys.path.insert(1, str(ROOT / "bench"))  # of all plots


def stop(*_):
    raise KeyboardInterrupt


def number(low, high, kind=int):
    def read(text):
        value = kind(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"it is {text}, but has to be {low} to {high}")
        return value
    return read


def digests(text):
    found = [part.strip().lower() for part in text.split(",")]
    for digest in found:
        if not re.fullmatch("[0-9a-f]{12,64}", digest):
            raise argparse.ArgumentTypeError(f"{digest!r} is no SHA-256; give 12 digits of it, or all, with commas between")
    return [digest[:12] for digest in found]


def read_options():
    parser = argparse.ArgumentParser(prog="./dev reproduce", description=__doc__)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--quick", action="store_const", const="quick", dest="set", help="a reduced set, about ten "
                       "minutes on two cores; its page is out/reproduce/quick.md")
    which.add_argument("--timed", action="store_const", const="timed", dest="set", help="the runs whose planning times "
                       "are published: one after the other, with two threads, on a machine without other work")
    parser.add_argument("--list", action="store_true", help="print the runs and do nothing")
    which.add_argument("--tables-only", action="store_true", help="run nothing; write the page from the runs "
                       "that are there")
    which.add_argument("--compare", nargs=2, type=Path, metavar=("FOLDER", "OTHER"), help="run nothing; say whether the "
                       "results in two folders are the same, but for what depends on the machine")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster whose workers have the program "
                        "[a local cluster of one worker a core]")
    parser.add_argument("--workers", type=number(1, 1000), default=os.cpu_count() or 1, metavar="N",
                        help="of the local cluster [one a core]")
    parser.add_argument("--hours", type=number(0.0, 10000.0, float), metavar="H", help="begin no run after so "
                        "long; the page says what is missing")
    parser.add_argument("--seeds", type=number(1, 1000), metavar="N", help="only the first N seeds of each row")
    parser.add_argument("--tasks", metavar="NAME,...", help="only these")
    parser.add_argument("--methods", metavar="NAME,...", help="only these")
    parser.add_argument("--worlds", action="append", type=Path, default=[], metavar="FOLDER", help="where the files of "
                        "worlds of others lie, on all workers; repeatable [FRONTLUX_WORLDS, folders joined by :]")
    parser.add_argument("--command", metavar="FRONTLUX", help="the program [build/release/bin/frontlux; with "
                        "--scheduler: frontlux on the workers' PATH]")
    parser.add_argument("--like", type=digests, default=[], metavar="SHA256,...", help="runs of these programs count as "
                        "well, since they decide the same: 12 digits each, as the page has them")
    parser.add_argument("--runs", type=Path, default=ROOT / "out/reproduce/runs", metavar="FOLDER",
                        help="of all results")
    parser.add_argument("--page", type=Path, metavar="FILE.md", help="[docs/results.md; if "
                        "that has more runs of another program, out/reproduce/results.md]")
    options = parser.parse_args()
    options.set = options.set or "full"
    if options.set == "timed" and options.scheduler:
        parser.error("--timed is for this machine alone: leave out --scheduler")
    options.worlds += [Path(folder) for folder in os.environ.get("FRONTLUX_WORLDS", "").split(":") if folder]
    options.replace = options.page is not None or options.set == "quick"
    options.page = options.page or (ROOT / "out/reproduce/quick.md" if options.set == "quick" else ROOT / "docs/results.md")
    options.command = options.command or ("frontlux" if options.scheduler else str(ROOT / "build/release/bin/frontlux"))
    return options


def names(text, known, what):
    chosen = text.split(",") if text else list(known)
    for name in chosen:
        if name not in known:
            raise ValueError(f"there is no {what} {name!r}: there are {', '.join(known)}")
    return chosen


def chosen_runs(experiments, options):
    """Those of the set that the options leave, and whose world is there; and the files that are not."""
    tasks = names(options.tasks, experiments.tasks, "task")
    methods = names(options.methods, experiments.methods, "method")
    runs, absent = [], set()
    first = {}
    for run in experiments.runs(options.set):
        first.setdefault((run.task, run.method), run.seed)
        if run.task not in tasks or run.method not in methods:
            continue
        if options.seeds and run.seed >= first[run.task, run.method] + options.seeds:
            continue
        file = experiments.file_of(run.task)
        if file and not world_file(file, options):
            absent.add(file)
            continue
        runs.append(run)
    return runs, sorted(absent)


def world_file(name, options):
    """Its path, or nothing for a built-in world and for what is in no folder."""
    for folder in options.worlds if name else ():
        if (folder / name).is_file():
            return str((folder / name).absolute())
    return ""


def commit_of(command):
    """The last one that changed the sources in whose build a program lies; a word more if they have changed since."""
    def git(*arguments):
        return subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True, check=True).stdout.strip()
    if not (ROOT / ".git").exists() or not Path(shutil.which(command) or command).resolve().is_relative_to(ROOT):
        return ""
    sources = ("--", "engine", "planner", "cmake", "CMakeLists.txt")
    try:
        changed = git("status", "--porcelain", *sources)
        return f" of commit {git('log', '-1', '--abbrev=10', '--format=%h', *sources)}" + (" with changes" if changed else "")
    except (OSError, subprocess.SubprocessError):
        return ""


def say(line):
    print(line, flush=True)


def describe(result):
    if "failure" in result:
        return f"FAILED: {result['failure']}"
    facts = result["facts"]
    return f"{facts['end']} after {facts['time_s']['end']:.0f} s, {100 * facts['coverage_observable']:.1f} %"


def execute(experiments, runs, options, published):
    """Runs those that have no result of this program yet; how many of them were lost, and the program's digest."""
    from cluster import connect, run_all  # only here: tables need no Dask
    folder = options.runs
    folder.mkdir(parents=True, exist_ok=True)
    workers = 1 if options.set == "timed" else options.workers
    lost = 0
    with connect(options.scheduler, workers, folder.parent / "workers") as client:
        found = sorted(set(client.run(program_of, options.command).values()))
        if len(found) > 1:
            raise ValueError(f"the workers have different programs {options.command}: " + ", ".join(
                f"{p.version} ({p.sha256})" for p in found) + "; install the same file everywhere")
        program = found[0]
        version = program.version + commit_of(options.command)
        tasks = {run: experiments.task_file(run) for run in runs}
        programs = {program.sha256, *options.like}
        left = []
        for run in runs:
            wanted = {program.sha256} if run.timed else programs
            if not is_kept(folder, run, tasks[run], wanted) and not is_published(published, run, experiments.declaration(run), wanted):
                left.append(run)
        say(f"{len(runs) - len(left)} of {len(runs)} runs are kept or published from before, {len(left)} to do")
        calls = {run.name: (options.command, program, tasks[run], world_file(experiments.file_of(run.task), options),
                            2 if run.timed else 1) for run in left}
        by_name = {run.name: run for run in left}
        begin = time.monotonic()
        until = begin + 3600 * options.hours if options.hours is not None else None
        for number_done, (name, result) in enumerate(run_all(client, calls, until), 1):
            if "lost" in result:
                lost += 1
                say(f"[{number_done}/{len(left)}] {name}: LOST: {result['lost']}")
                continue
            run = by_name[name]
            if before := failed_before(folder, run, tasks[run], program.sha256):
                result["measured"]["failed_before"] = before
            write_result(folder, run, tasks[run], version, result)
            minutes = (time.monotonic() - begin) / number_done * (len(left) - number_done) / 60
            took = result["measured"].get("wall_s")
            say(f"[{number_done}/{len(left)}] {name}: {describe(result)}" + (f"; took {took:.0f} s" if took else "") +
                f"; about {minutes:.0f} min left")
    if lost:
        say(f"{lost} runs were lost by their machines and are missing; the same command makes them")
    return lost, program.sha256


def tables_of(page):
    """Beside it: of all its runs the rows, and the curves."""
    return page.with_suffix(".csv"), page.with_name(f"{page.stem}_curves.csv")


def write_page(experiments, runs, options, program):
    from figures import figures, is_drawn
    from page import page
    from svg_chart import save
    published = read_published(*tables_of(options.page))  # others may have added to it meanwhile
    results = Results(experiments, runs, options.runs, options.like, program, published)
    if not results.all:
        raise ValueError(f"there is no result in {options.runs} to write a page from; let runs finish first")
    if not options.replace and results.of_others > len(results.all):
        say(f"{options.page} has {results.of_others} runs of other programs and would have {len(results.all)} of this one: the page "
            f"goes to {OWN_PAGE} (--page replaces)")
        options.page = OWN_PAGE
    images = options.page.parent / "images/results"
    drawn = figures(results)
    rows, curves = tables_of(options.page)
    text = page(results, os.path.relpath(images, options.page.parent), rows.name, curves.name)
    images.mkdir(parents=True, exist_ok=True)
    if without := sum(is_drawn(results, r.run) and not r.curve and not r.crashed for r in results.all.values()):
        say(f"{without} published rows have no curve in {curves.name}, so that figures leave them out")
    if results.outdated:
        say(f"{results.outdated} published rows are of runs that are not declared, or declared otherwise, and are left out")
    for name, figure in drawn.items():
        save(images / f"{name}.svg", figure)
    save(curves, curves_table(r for r in results.all.values() if is_drawn(results, r.run)))
    save(rows, rows_table(results.all.values()))
    save(options.page, text)
    for name, reason in results.broken.items():
        print(f"reproduce: {name}: {reason}", file=sys.stderr)
    failed = sum(bool(r.failure) for r in results.all.values())
    others = f"; {results.of_others} of other programs are left out" if results.of_others else ""
    say(f"{options.page}: {len(results.all)} of {len(results.wanted)} runs, {failed} of them failed{others}; figures in {images}")
    return 1 if results.broken or any(r.crashed for r in results.all.values()) else 0


def compare(folder, other):
    for one in (folder, other):
        if not any(one.glob("*.json")):
            raise ValueError(f"there is no result in {one}; give two folders of runs")
    count, lines = unlike(folder, other)
    say("\n".join([*lines, f"{count - len(lines)} of {count} runs are the same in {folder} and {other}"]))
    return 1 if lines else 0


def main():
    signal.signal(signal.SIGTERM, stop)
    options = read_options()
    try:
        experiments = Experiments()
        runs, absent = chosen_runs(experiments, options)
        if options.list:
            say("\n".join(run.name for run in runs))
            return 0
        if options.compare:
            return compare(*options.compare)
        published = read_published(*tables_of(options.page))
        there = programs_in(options.runs) | {row["program"] for row, _ in published.values()} if options.like else set()
        if unknown := {*options.like} - there:
            raise ValueError(f"--like: no run in {options.runs} or published is of program {', '.join(sorted(unknown))}; there are " +
                             (", ".join(sorted(there)) or "none"))
        lost, program = 0, None
        if options.tables_only:  # what others are like
            program = program_of(options.command).sha256 if options.like else None
        else:
            for file in absent:
                say(f"left out: {file} is in none of the folders given by --worlds")
            lost, program = execute(experiments, runs, options, published)
        # The page is about all that is declared.
        sets = ("quick",) if options.set == "quick" else ("full", "timed")
        return write_page(experiments, [run for name in sets for run in experiments.runs(name)], options,
                          program) or int(lost > 0)
    except KeyboardInterrupt:
        print(f"\nstopped; finished runs are kept in {options.runs}, the same command goes on", file=sys.stderr)
        return 130
    except (OSError, ValueError, subprocess.SubprocessError) as error:
        print(f"reproduce: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
