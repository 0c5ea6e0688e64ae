#!/usr/bin/env python3
"""Runs the explorations that reproduce the paper, and writes its tables and figures with ours beside."""

import argparse
import os
import signal
import subprocess
import sys
from pathlib import Path

from figures import figures
from recorded import Results
from runs import Runner, version_of, wanted_runs
from svg_chart import save
from tables import document


def stop(*_):
    raise KeyboardInterrupt


def at_least_one(text):
    number = int(text)
    if not 1 <= number <= 1000:
        raise ValueError(text)
    return number


at_least_one.__name__ = "number from 1 to 1000"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=at_least_one, default=3, help="so many for every variant (3)")
    parser.add_argument("--jobs", type=at_least_one, default=os.cpu_count() or 1, help="runs at a time (one per core)")
    parser.add_argument("--command", type=Path, default=Path("build/release/bin/frontlux"), metavar="FRONTLUX")
    parser.add_argument("--runs", type=Path, default=Path("out/reproduce"), metavar="FOLDER", help="of all runs")
    parser.add_argument("--results", type=Path, default=Path("docs/results.md"), metavar="FILE.md")
    parser.add_argument("--images", type=Path, default=Path("docs/images/results"), metavar="FOLDER")
    parser.add_argument("--tables-only", action="store_true", help="run nothing, take the runs that are there")
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, stop)
    runs, failures = wanted_runs(arguments.seeds), {}
    try:
        if not arguments.tables_only:
            command = arguments.command.absolute()
            runner = Runner(command, arguments.runs, version_of(command),
                            lambda line: print(line, flush=True))
            runner.run_all(runs, arguments.jobs)
            failures = runner.failures
        results = Results(runs, arguments.runs, failures)
        if not results.runs:
            raise ValueError(f"no finished run in {arguments.runs}; " +
                             next(iter(f"{name}: {reason}" for name, reason in results.broken.items())))
        drawn = figures(results)
        text = document(results, os.path.relpath(arguments.images, arguments.results.parent))
        arguments.images.mkdir(parents=True, exist_ok=True)
        for name, figure in drawn.items():
            save(arguments.images / f"{name}.svg", figure)
        save(arguments.results, text)
    except KeyboardInterrupt:
        print(f"\nstopped; finished runs are kept in {arguments.runs}, the same command goes on", file=sys.stderr)
        return 130
    except (OSError, ValueError, subprocess.SubprocessError) as error:
        print(f"reproduce: {error}", file=sys.stderr)
        return 2
    for name, reason in results.broken.items():
        print(f"reproduce: {name}: {reason}", file=sys.stderr)
    print(f"results in {arguments.results}, figures in {arguments.images}, runs in {arguments.runs}")
    return 1 if results.broken else 0


if __name__ == "__main__":
    sys.exit(main())
