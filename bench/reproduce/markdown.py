"""Text and tables of a Markdown file; names may hold any characters."""

import re

NOTHING = "–"


def plain(text):
    """Text without any meaning in Markdown or HTML, on one line."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return re.sub(r"([\\`*_\[\]|!#~$@])", r"\\\1", text)


def table(header, rows, texts=1):
    """The first columns are text, the others numbers; cells are Markdown already."""
    rule = ["---"] * texts + ["---:"] * (len(header) - texts)
    lines = [header, rule, *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"


def value(number, digits=0, unit=""):
    return NOTHING if number is None else f"{number:,.{digits}f}{unit}"


def percent(part, digits=1):
    return value(None if part is None else 100 * part, digits, " %")


def mean_of(spread, digits=0, scale=1.0, unit=""):
    return value(spread and scale * spread.mean, digits, unit)


def spread_of(spread, digits=0, scale=1.0, unit=""):
    """Mean, and where there are more values than one, the smallest, largest and standard deviation."""
    if spread is None or spread.count == 1:
        return mean_of(spread, digits, scale, unit)
    low, high, deviation = (f"{scale * v:,.{digits}f}" for v in spread[1:4])
    return f"{scale * spread.mean:,.{digits}f}{unit} ({low}..{high}, sd {deviation})"
