"""The colours of all plots, (on light, on dark background), from data/palette.json."""

import json
from pathlib import Path

PALETTE = json.loads((Path(__file__).resolve().parent.parent / "data/palette.json").read_text(encoding="utf-8"))


def colours(section):
    """{name: (on light, on dark)} of a section that has names."""
    return {name: tuple(pair) for name, pair in PALETTE[section].items()}


TEAM, UAV, UGV = tuple(PALETTE["team"]), tuple(PALETTE["aerial"][0]), tuple(PALETTE["ground"][0])
