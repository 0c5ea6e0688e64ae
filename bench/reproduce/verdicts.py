"""Whether an interval, or a count, shows what is claimed."""

from collections import Counter
from typing import NamedTuple

from intervals import FEWEST, Interval, proportion
from markdown import counted, interval, percent

NOT_MEASURED = "not measured"
NOT_COMPARABLE = "not comparable"
UNDECIDED = "open: the interval contains the limit"
TOO_FEW = f"open: fewer than {FEWEST} values in a world"


class Line(NamedTuple):
    claim: str
    measured: str
    verdict: str


def failed(word):
    return f"**{word}**"


def none_of(bad, runs, what="run", fewest=1):
    """Of facts that are there or not: one fails the line, and few runs without any are no reason to rely on it. `fewest`: in
    all, or {(task, method): of each}."""
    if not runs:
        return NOT_MEASURED
    if bad:
        return failed(f"does not hold: {counted(len(bad), what)}")
    if isinstance(fewest, dict):
        there = Counter(r.run[:2] for r in runs)
        few = sorted((there[row], f"{there[row]} of {n} {what}s of {' '.join(row)}") for row, n in fewest.items() if there[row] < n)
        others = f", and too few in {counted(len(few) - 1, 'other row')}" if few[1:] else ""
        return f"open: {few[0][1]}{others}" if few else "holds"
    return "holds" if len(runs) >= fewest else f"open: {len(runs)} of {counted(fewest, what)}"


def touching(count, of):
    """How frequent contacts are, by so many runs; of none, how frequent they may be all the same."""
    if count == 0:
        return f"so with 95 % confidence in fewer than {percent(1 - 0.05 ** (1 / of))}"
    return interval(proportion(count, of), 1, 100, " %")


def at_most(found, limit, yes="holds", no="does not hold", strictly=False):
    """The whole interval has to be there; without one nothing is decided."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return TOO_FEW
    if found.high < limit or (found.high == limit and not strictly):
        return yes
    return failed(no) if found.low > limit or (found.low == limit and strictly) else UNDECIDED


def changed_by(found, of):
    """A falling function of a value and its interval."""
    return found and Interval(of(found.value), *(None if v is None else of(v) for v in (found.high, found.low)), found.count)


def at_least(found, limit, yes="reproduced", no="not reproduced"):
    return at_most(changed_by(found, lambda v: -v), -limit, yes, no)


def effect(found, claimed):
    """A relative change that the paper prints, above 0: it is reproduced if the whole interval is at least half as
    large."""
    if found is None:
        return NOT_MEASURED
    if found.low is None:
        return TOO_FEW
    if found.high < 0:
        return failed("not reproduced: the opposite")
    if found.low <= 0:
        return "open: no effect shown, none excluded" if found.high >= claimed else \
            failed("not reproduced: no effect shown, and one as large is excluded")
    if found.low >= claimed / 2:
        return "reproduced"
    return "open: an effect, its size open" if found.high >= claimed else failed("not reproduced: smaller than claimed")
