"""Text, numbers and tables of a Markdown file; names may hold any characters."""

import re

NOTHING = "–"


def plain(text):
    """Text without any meaning in Markdown or HTML, on one line."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return re.sub(r"([\\`*_\[\]|!#~$@])", r"\\\1", text)


def table(header, rows, texts=1, none="No runs."):
    """The first columns are text, the others numbers; cells are Markdown already. `none` stands for a table of no rows."""
    if not rows:
        return none + "\n"
    rule = ["---"] * texts + ["---:"] * (len(header) - texts)
    lines = [header, rule, *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"


def value(number, digits=0, unit=""):
    return NOTHING if number is None else f"{number:,.{digits}f}{unit}"


def counted(number, word):
    return f"{number} {word}" + ("s" if number != 1 else "")


def percent(part, digits=1):
    return value(None if part is None else 100 * part, digits, " %")


def interval(found, digits=0, scale=1.0, unit="", sign=False):
    """Value, and in brackets its interval if it has one."""
    if found is None or found.value != found.value:
        return NOTHING
    mark = "+" if sign else ""
    middle, *ends = (None if v is None else f"{scale * v:{mark},.{digits}f}".replace("inf", "∞") for v in found[:3])
    return middle + unit + (f" ({ends[0]} to {ends[1]})" if ends[0] is not None else "")


def as_first_word(text):
    """Of a sentence."""
    return text[:1].upper() + text[1:]
