"""Two methods, or one, by the runs that there are: what is measured, and why it decides nothing, if so."""

from typing import NamedTuple, Optional

from intervals import Interval, median_ratio, ratio
from markdown import counted, interval
from verdicts import NOT_MEASURED, changed_by

# Pairs that a verdict needs: what is declared for a main row. In worlds of files only the start differs.
NEEDED, NEEDED_OF_FILES = 20, 10


class Compared(NamedTuple):
    """A ratio of two methods, of how many runs it is, and why it decides nothing, if so."""
    found: Optional[Interval]
    said: str
    open: str

    def judged(self, verdict, *arguments, **options):
        return self.open or verdict(self.found, *arguments, **options)


def needed(results, task):
    return NEEDED_OF_FILES if results.experiments.file_of(task) else NEEDED


def too_few(results, tasks, method, other):
    """Why these are not enough pairs to judge, or nothing. Failed runs count: they are there."""
    counts = {task: len(results.pairs(task, method, other)) for task in tasks}
    if not any(counts.values()):
        return NOT_MEASURED
    if empty := [task for task, n in counts.items() if not n]:
        return f"open: no pairs of {', '.join(empty)}"
    for task, n in counts.items():
        if n < needed(results, task):
            return f"open: {n} of {needed(results, task)} pairs" + (f" of {task}" if len(tasks) > 1 else "")
    return ""


def to_a_level(results, tasks, method, other, measure):
    """By all runs: one that never got there, whatever ended it, is later than any other."""
    groups = [results.pairs(task, method, other) for task in tasks]
    found = median_ratio(groups, measure)
    never = [[pair[i] for pairs in groups for pair in pairs if measure(pair[i]) == float("inf")] for i in (0, 1)]
    said = [counted(sum(map(len, groups)), "pair")] if any(groups) else []
    for runs, which in zip(never, ("first", "second")):
        if runs:
            early = sum(r.ended_early for r in runs)
            said.append(f"{len(runs)} never of the {which}" + (f", {early} of them ended by their own rule" if early else ""))
    return Compared(found, "; ".join(said),
                    too_few(results, tasks, method, other) or endless(tasks, groups, measure))


def is_endless(found):
    """A ratio in whose median pair one run never got there."""
    return found is not None and found.value in (0.0, float("inf"))


def endless(tasks, groups, measure):
    """Why a mean of worlds says nothing, or nothing: in one of them half of the other method's runs never got there, and
    their ratios of 0 would outweigh any world in which it is the faster one."""
    if len(tasks) > 1:
        for task, pairs in zip(tasks, groups):
            never = sum(measure(b) == float("inf") for _, b in pairs)
            if pairs and 2 * never >= len(pairs):
                return f"open: at least half of the second never got there in {task}"
    return ""


def ended_early(results, tasks, method):
    """Why being faster than a method says nothing, or nothing: more than a tenth of its runs ended by their own rule before
    their world was mapped."""
    runs = [r for task in tasks for r in results.of(task, method)]
    early = sum(r.ended_early for r in runs)
    return f"open: {early} of {counted(len(runs), 'run')} of the second ended by their own rule before" if 10 * early > len(runs) else ""


def at_the_end(results, tasks, method, other, measure):
    """By pairs of which neither failed: a failed run has no end to compare."""
    return ratio([results.done_pairs(task, method, other) for task in tasks], measure)


def too_many_failed(results, tasks, *methods):
    """More than a tenth of a method's runs, had they not failed, could have decided otherwise."""
    for method in methods:
        runs = [r for task in tasks for r in results.of(task, method)]
        lost = sum(bool(r.failure) for r in runs)
        if 10 * lost > len(runs):
            return f"open: {lost} of {counted(len(runs), 'run')} failed ({results.experiments.title(method)})"
    return ""


def to_the_end(results, tasks, method, other):
    """The time that each method takes by its own rule."""
    said = counted(sum(len(results.done_pairs(task, method, other)) for task in tasks), "pair")
    return Compared(at_the_end(results, tasks, method, other, end_of), said,
                    too_few(results, tasks, method, other) or too_many_failed(results, tasks, method, other))


def in_all(results, task, method, other, measure):
    """Of what has a value however much was mapped: by all pairs that have ended."""
    pairs = [pair for pair in results.pairs(task, method, other) if not any(r.crashed for r in pair)]
    incomplete = [sum(bool(pair[i].failure) for pair in pairs) for i in (0, 1)]
    said = [counted(len(pairs), "pair"), *(f"{n} of the {which} with less than 90 % mapped"
                                           for n, which in zip(incomplete, ("first", "second")) if n)] if pairs else []
    return Compared(ratio([pairs], measure), "; ".join(said), too_few(results, [task], method, other))


def relative(compared, sign=1):
    """The ratio as a relative change, with sign -1 what is saved; and what to say of it."""
    found = compared.found
    if found is None:
        return compared
    change = changed_by(found, lambda v: 1 - v)
    if sign > 0:
        change = changed_by(change, lambda v: -v)
    said = "at least half never got there" if is_endless(found) else interval(change, 1, 100, " %", sign > 0)
    return compared._replace(found=change, said=f"{said}, {compared.said}")


def as_times(found):
    return "half never got there" if is_endless(found) else interval(found, 2, unit="×")


def times(compared):
    return f"{as_times(compared.found)}, {compared.said}" if compared.found else compared.said


def in_each(results, methods):
    """How many runs a verdict needs of each of these methods in each world for which it is declared."""
    return {(task, method): needed(results, task) for task in results.experiments.tasks for method in methods
            if (task, method) in results.experiments.rows}


def seconds_mapped(run):
    return run.seconds_mapped


def end_of(run):
    return run.seconds("end")
