"""Intervals and verdicts against values worked out by hand.

intervals_test.py FOLDER, that of bench/reproduce.
"""

import math
import unittest

import made_up_results  # finds bench/reproduce

from intervals import Interval, bootstrap, difference, mean, median_difference, median_ratio, ratio
from markdown import interval
from verdicts import at_least, at_most, changed_by, effect, touching


class Intervals(unittest.TestCase):
    def test_values(self):
        self.assertEqual(mean([2, None, 4])[:], (3, None, None, 2))
        self.assertIsNone(mean([None]))
        self.assertEqual(mean([5] * 6), (5, 5, 5, 6))
        pairs = [(i, 2 * i) for i in range(1, 9)]
        self.assertEqual(difference([pairs], lambda v: v).value, -4.5)
        self.assertEqual(difference([pairs, [(1, 0)]], lambda v: v).value, -1.75)
        self.assertEqual(ratio([pairs], lambda v: v), (0.5, 0.5, 0.5, 8))
        # The ratio of the means, not the mean of the ratios; of two groups the mean.
        self.assertEqual(ratio([[(1, 1), (9, 4)]], lambda v: v).value, 2)
        self.assertEqual(ratio([[(1, 1), (9, 4)], [(1, 1)]], lambda v: v).value, 1.5)
        self.assertIsNone(ratio([[(1, 1), (9, 4)], [(1, 1)], []], lambda v: v))  # a world is missing
        self.assertEqual(ratio([[(1, 1), (None, 4)]], lambda v: v).count, 1)

    def test_differences_and_ratios_say_the_same(self):
        found = median_difference([(1, 2), (3, 2), (5, 1), (9, 4), (2, 9), (7, 1)], lambda v: v)
        self.assertEqual(found, (2.5, -7, 6, 6))
        never = math.inf
        self.assertEqual(median_difference([(1, never)] * 6, lambda v: v).value, -never)
        self.assertEqual(median_difference([(never, never)] * 6 + [(never, 1)], lambda v: v).value, 0)
        self.assertIsNone(median_difference([], lambda v: v))
        tie = median_difference([(1, never)] * 3 + [(never, 1)] * 3, lambda v: v)
        self.assertEqual(interval(tie), "–")

    def test_how_frequent_contacts_may_be(self):
        # Clopper's and Pearson's intervals, from tables of them.
        self.assertEqual(touching(9, 212), "4.2 % (2.0 to 7.9)")
        self.assertEqual(touching(1, 10), "10.0 % (0.3 to 44.5)")
        self.assertEqual(touching(10, 10), "100.0 % (69.2 to 100.0)")
        self.assertEqual(touching(9, 5000), "0.2 % (0.1 to 0.3)")
        self.assertEqual(touching(0, 20), "so with 95 % confidence in fewer than 13.9 %")

    def test_who_never_got_there_is_later_than_any_other(self):
        never = math.inf
        self.assertEqual(median_ratio([[(1, 2)] * 4 + [(never, 2)] * 2], lambda v: v)[:2], (0.5, 0.5))
        self.assertEqual(median_ratio([[(1, 2)] * 4 + [(never, 2)] * 5], lambda v: v).value, never)
        self.assertEqual(median_ratio([[(1, never)] * 6], lambda v: v), (0, 0, 0, 6))
        self.assertEqual(median_ratio([[(never, never)] * 6], lambda v: v), (1, 1, 1, 6))
        self.assertEqual(median_ratio([[(1, 2)], [(3, 2)]], lambda v: v).value, 1)
        self.assertEqual(interval(Interval(2, 1, never, 6), 1), "2.0 (1.0 to ∞)")

    def test_intervals_by_order(self):
        # Of as many throws of a coin at most one in forty has fewer heads than that place, less one.
        for count, first, last in ((6, 1, 6), (10, 2, 9), (20, 6, 15)):
            found = median_ratio([[(i, 1) for i in range(1, count + 1)]], lambda v: v)
            self.assertEqual(found, ((count + 1) / 2, first, last, count))
        self.assertIsNone(median_ratio([[(i, 1) for i in range(1, 6)]], lambda v: v).low)

    def test_interval_of_a_coin(self):
        # 20 throws, half of them heads: the binomial's 2.5 and 97.5 % quantiles are 6 and 14.
        found = mean([0, 1] * 10)
        self.assertEqual(found.value, 0.5)
        self.assertAlmostEqual(found.low, 0.3, delta=0.051)
        self.assertAlmostEqual(found.high, 0.7, delta=0.051)

    def test_same_values_same_interval(self):
        values = [1, 5, 2, 8, 3, 9, 4]
        self.assertEqual(mean(values), mean(values))
        self.assertLess(mean(values).low, mean(values).value)

    def test_too_few_values_have_no_interval(self):
        self.assertIsNone(mean([1, 2, 3, 4, 5]).low)
        self.assertIsNotNone(mean([1, 2, 3, 4, 5, 6]).low)
        self.assertIsNone(bootstrap([[1] * 20, [1] * 5], lambda groups: 1).low)

    def test_text(self):
        self.assertEqual(interval(Interval(0.5, 0.25, 0.75, 8), 1, 100, " %"), "50.0 % (25.0 to 75.0)")
        self.assertEqual(interval(Interval(-3, None, None, 1), sign=True, unit=" s"), "-3 s")
        self.assertEqual(interval(None), "–")


class Verdicts(unittest.TestCase):
    def test_limits(self):
        self.assertEqual(at_most(Interval(0.6, 0.5, 0.7, 8), 0.7), "holds")
        self.assertEqual(at_most(Interval(0.6, 0.5, 0.7, 8), 0.7, strictly=True), "open: the interval contains the limit")
        self.assertEqual(at_most(Interval(0.6, 0.5, 0.71, 8), 0.7), "open: the interval contains the limit")
        self.assertEqual(at_most(Interval(0.9, 0.8, 1.0, 8), 0.7), "**does not hold**")
        self.assertEqual(at_most(Interval(0.1, None, None, 5), 0.7), "open: fewer than 6 values in a world")
        self.assertEqual(at_most(None, 0.7), "not measured")
        self.assertEqual(at_least(Interval(0.9, 0.8, 1.0, 8), 0.7), "reproduced")
        self.assertEqual(at_least(Interval(0.6, 0.5, 0.65, 8), 0.7), "**not reproduced**")
        self.assertEqual(at_least(Interval(0.9, None, None, 2), 0.7), "open: fewer than 6 values in a world")

    def test_effects(self):
        self.assertEqual(effect(Interval(0.2, 0.12, 0.3, 8), 0.24), "reproduced")
        self.assertEqual(effect(Interval(0.5, 0.4, 0.6, 8), 0.24), "reproduced")
        self.assertEqual(effect(Interval(0.15, 0.13, 0.2, 8), 0.24), "reproduced")
        self.assertEqual(effect(Interval(0.2, 0.1, 0.3, 8), 0.24), "open: an effect, its size open")
        for found in (0.119, 0.121):  # which side of a half it is, is chance
            self.assertEqual(effect(Interval(found, 0.01, 0.2, 8), 0.24), "**not reproduced: smaller than claimed**")
        self.assertEqual(effect(Interval(0.1, 0.01, 0.3, 8), 0.24), "open: an effect, its size open")
        self.assertEqual(effect(Interval(0.1, -0.1, 0.3, 8), 0.24), "open: no effect shown, none excluded")
        self.assertEqual(effect(Interval(0.1, -0.1, 0.2, 8), 0.24),
                         "**not reproduced: no effect shown, and one as large is excluded**")
        self.assertEqual(effect(Interval(-0.2, -0.3, -0.1, 8), 0.24), "**not reproduced: the opposite**")
        self.assertEqual(effect(None, 0.24), "not measured")
        self.assertEqual(changed_by(Interval(0.75, 0.5, 1.25, 8), lambda v: 1 - v), (0.25, -0.25, 0.5, 8))


if __name__ == "__main__":
    unittest.main()
