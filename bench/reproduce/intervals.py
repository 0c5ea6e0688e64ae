"""Means with bootstrap intervals, medians with intervals by order; the same values give the same interval."""

import math
import random
from statistics import fmean, median
from typing import NamedTuple, Optional

RESAMPLES, SEED, LEVEL = 2000, 24, 0.95
FEWEST = 6  # fewer values have no interval


class Interval(NamedTuple):
    value: float
    low: Optional[float]  # None: too few values
    high: Optional[float]
    count: int


def bootstrap(groups, statistic):
    """The statistic of several groups of values, with its percentile interval when each group is drawn from itself with
    replacement. None if a group has no values."""
    groups = [list(group) for group in groups]
    if not groups or not all(groups):
        return None
    count, value = sum(map(len, groups)), statistic(groups)
    if min(map(len, groups)) < FEWEST:
        return Interval(value, None, None, count)
    draw = random.Random(SEED)
    values = sorted(statistic([draw.choices(group, k=len(group)) for group in groups]) for _ in range(RESAMPLES))
    tail = round(RESAMPLES * (1 - LEVEL) / 2)
    return Interval(value, values[tail], values[-1 - tail], count)


def by_order(values):
    """The median, which is no number if it lies between two opposite infinities, with the interval between two of the values that holds the true one in at least LEVEL of all samples,
    whatever their distribution: a bootstrap of few pairs' medians promises more than it keeps."""
    values, count = sorted(values), len(values)
    if count < FEWEST:
        return Interval(median(values), None, None, count)
    below, k = 0.5 ** count, 0  # the chance that fewer than k + 1 values are below the true median
    while 1 - 2 * below >= LEVEL:
        k += 1
        below += math.comb(count, k) * 0.5 ** count
    return Interval(median(values), values[k - 1], values[count - k], count)


def proportion(count, of):
    """Of so many independent runs so many did, with Clopper's and Pearson's exact interval."""
    def chance(p, counts):
        return math.fsum(math.exp(math.lgamma(of + 1) - math.lgamma(k + 1) - math.lgamma(of - k + 1) + k * math.log(p) +
                                  (of - k) * math.log1p(-p)) for k in counts)

    def least(holds):
        """The least p for which this holds; it holds for all above."""
        low, high = 0.0, 1.0
        for _ in range(50):
            middle = (low + high) / 2
            low, high = (low, middle) if holds(middle) else (middle, high)
        return high

    tail = (1 - LEVEL) / 2
    return Interval(count / of, least(lambda p: chance(p, range(count, of + 1)) >= tail) if count else 0.0,
                    least(lambda p: chance(p, range(count + 1)) <= tail) if count < of else 1.0, of)


def present(values):
    return [v for v in values if v is not None]


def mean(values):
    return bootstrap([present(values)], lambda groups: fmean(groups[0]))


def both(pairs, measure):
    """What `measure` gives of both runs of the pairs, where it gives something."""
    values = [(measure(a), measure(b)) for a, b in pairs]
    return [(a, b) for a, b in values if a is not None and b is not None]


def difference(groups_of_pairs, measure):
    """The first run's less the second's, in each group the mean; of several groups the mean of that."""
    return bootstrap([both(pairs, measure) for pairs in groups_of_pairs],
                     lambda groups: fmean(fmean(a - b for a, b in pairs) for pairs in groups))


def median_difference(pairs, measure):
    """The median of the first run's less the second's; who never got there is later than any other, as for median_ratio()."""
    found = [0.0 if a == b else a - b for a, b in both(pairs, measure)]
    return by_order(found) if found else None


def ratio(groups_of_pairs, measure):
    """The first runs' mean by the second runs', in each group; of several groups the mean of that."""
    def of(pairs):
        below = math.fsum(b for _, b in pairs)
        return math.fsum(a for a, _ in pairs) / below if below else 0.0
    return bootstrap([both(pairs, measure) for pairs in groups_of_pairs], lambda groups: fmean(map(of, groups)))


def median_ratio(groups_of_pairs, measure):
    """The median of the pairs' ratios, in each group; of several groups the mean of that. A run that never got there has
    an infinite value and is later than any that did; two that never did are alike."""
    def of(a, b):
        return 1.0 if a == b else a / b if b else math.inf
    groups = [[of(a, b) for a, b in both(pairs, measure)] for pairs in groups_of_pairs]
    if len(groups) == 1 and groups[0]:
        return by_order(groups[0])
    return bootstrap(groups, lambda drawn: fmean(map(median, drawn)))
