"""The palette is legible and told apart by the colour-blind: palette_test.py PALETTE.json."""

import itertools
import json
import sys
import unittest

PAPER = {"light": "#ffffff", "dark": "#161b22"}  # of the report, style.css
LEAST_CONTRAST = 3.0  # of lines and marks, WCAG 1.4.11
LEAST_DISTANCE = 0.07  # in Oklab

# Machado, Oliveira and Fernandes 2009, severity 1, on linear RGB.
VISIONS = {
    "usual": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protanopia": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deuteranopia": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
    "tritanopia": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900)),
}


def linear(colour):
    values = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]


def contrast(a, b):
    light = [sum(w * v for w, v in zip((0.2126, 0.7152, 0.0722), linear(c))) for c in (a, b)]
    return (max(light) + 0.05) / (min(light) + 0.05)


def oklab(rgb):
    def times(matrix, vector):
        return [sum(m * v for m, v in zip(row, vector)) for row in matrix]
    lms = times(((0.4122214708, 0.5363325363, 0.0514459929), (0.2119034982, 0.6806995451, 0.1073969566),
                 (0.0883024619, 0.2817188376, 0.6299787005)), rgb)
    return times(((0.2104542553, 0.7936177850, -0.0040720468), (1.9779984951, -2.4285922050, 0.4505937099),
                  (0.0259040371, 0.7827717662, -0.8086757660)), [max(v, 0) ** (1 / 3) for v in lms])


def distance(a, b, vision):
    seen = [oklab([sum(m * v for m, v in zip(row, linear(c))) for row in VISIONS[vision]]) for c in (a, b)]
    return sum((x - y) ** 2 for x, y in zip(*seen)) ** 0.5


class Palette(unittest.TestCase):
    def setUp(self):
        with open(sys.argv[1], encoding="utf-8") as file:
            self.palette = json.load(file)

    def pairs(self):
        for section, colours in self.palette.items():
            if section == "":
                continue
            flat = list(colours.values()) if isinstance(colours, dict) else colours if isinstance(colours[0], list) else [colours]
            for pair in flat:
                yield section, pair

    def test_all_are_pairs_of_colours(self):
        for section, pair in self.pairs():
            self.assertEqual(len(pair), 2, section)
            for colour in pair:
                self.assertRegex(colour, "^#[0-9a-f]{6}$")

    def test_lines_and_marks_stand_out(self):
        for section, pair in self.pairs():
            if section in ("aerial", "ground", "team", "runs", "other", "frontier", "goals"):
                for (theme, paper), colour in zip(PAPER.items(), pair):
                    self.assertGreaterEqual(contrast(colour, paper), LEAST_CONTRAST, f"{section}, {theme}: {colour}")

    def test_what_stands_together_is_told_apart(self):
        p = self.palette
        together = {
            "a team of four": [p["team"], p["ground"][0], *p["aerial"][:3]],
            "two of each": [p["team"], *p["ground"][:2], *p["aerial"][:2]],
            "frontiers": [p["team"], p["frontier"], p["ground"][0], *p["aerial"][:2]],
            "phases": list(p["phases"].values())[:5],
            "goals": [p["team"], *p["goals"].values()],
            "runs": p["runs"][:4],
        }
        for vision in VISIONS:
            for theme in (0, 1):
                for name, colours in together.items():
                    for a, b in itertools.combinations(colours, 2):
                        self.assertGreater(distance(a[theme], b[theme], vision), LEAST_DISTANCE,
                                           f"{name}, {vision}: {a[theme]} and {b[theme]}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
