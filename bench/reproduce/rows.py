"""A run as a row of results.csv and a thin curve: all that the page is made of, wherever the run was made.

Rows that are published need no file of the run any more: other machines, and later days, add to them.
"""

import csv
import hashlib
import io
import json
import math

from experiments import Run
from explore import kind_of

LEVELS = ("50", "90", "95", "99", "end")
KINDS = ("ugv", "uav")
GAINS = ("gain_tangent", "gain_predicted", "gained")  # of the UAVs
PLANNING = ("planning_mean_s", "planning_p99_s", "planning_max_s")
WHO = ("task", "method", "seed")

COUNT, TEXT = "count", "text"
SECONDS, METRES, GAIN, PART = 4, 4, 4, 6  # decimal places
COLUMNS = {
    "task": TEXT, "method": TEXT, "seed": COUNT, "timed": COUNT,
    "failure": TEXT,  # why it has left no numbers
    **{f"s_to_{level}": SECONDS for level in LEVELS},
    **{f"m_{kind}": METRES for kind in KINDS}, "m_mapped": METRES,
    **{f"revisited_{kind}": PART for kind in KINDS},
    **{f"first_{kind}": PART for kind in KINDS},
    "steps": COUNT, "steps_to_90": COUNT,
    "end": TEXT, "coverage_observable": PART, "auc": PART,
    "contacts": COUNT, "contacts_in_free": COUNT, "held_back": COUNT, "clearance_min_m": METRES, "separation_min_m": METRES,
    "worst_of_limits": PART,
    "false_free": PART, "false_occupied": PART, "surface_found": PART,
    "narrow": PART, "hidden": PART, "in_view": PART,
    **{gain: GAIN for gain in GAINS},
    **{column: SECONDS for column in PLANNING}, "wall_s": SECONDS,
    "failed_before": TEXT,  # why earlier attempts at it by this program crashed or hung
    "version": TEXT, "program": TEXT, "date": TEXT,
    "declared": TEXT,  # digests: of the task, and of all that does not depend on the machine
    "outcome": TEXT,
}
ALWAYS = ("s_to_end", "steps", "end", "coverage_observable", "contacts", "held_back")  # of a run that has ended
CURVE_COLUMNS = (*WHO, "x", "mapped", "by_ugv")
CURVE_POINTS = 50


def digest(value):
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:12]


def same_everywhere(content):
    """Of a run's file, what does not depend on the machine, nor on what the run and its program are called."""
    facts = {key: value for key, value in content.get("facts", {}).items() if key != "version"}
    return {"facts": facts, **{key: content.get(key) for key in ("failure", "gains", "curve")}}


def total(by_kind):
    return math.fsum(by_kind.values())


def revisited(by_robot, kind):
    """The part of the path of robots of a kind that led to where they had been."""
    robots = [r for name, r in (by_robot or {}).items() if kind_of(name) == kind and r.get("revisited") is not None]
    metres = math.fsum(r["length_m"] for r in robots)
    return math.fsum(r["revisited"] * r["length_m"] for r in robots) / metres if metres else None


def first_with(curve, coverage):
    return next(((i, row) for i, row in enumerate(curve) if row["coverage"] >= coverage), (None, None))


def numbers_of(content, complete):
    """What a run that has ended has left."""
    facts, curve = content["facts"], content["curve"]
    last, (_, mapped) = curve[-1], first_with(curve, complete)
    return {
        **facts, **(facts.get("map") or {}), **(facts.get("unseen") or {}), **content["gains"].get("uav", {}),
        **{f"s_to_{level}": facts["time_s"].get(level) for level in LEVELS},
        **{f"m_{kind}": last["length_m"].get(kind) for kind in KINDS},
        "m_mapped": mapped and total(mapped["length_m"]),
        **{f"revisited_{kind}": revisited(facts.get("by_robot"), kind) for kind in KINDS},
        **{f"first_{kind}": last["first"].get(kind) for kind in KINDS},
        "steps": len(curve) - 1, "steps_to_90": first_with(curve, 0.9)[0]}


def row_of(run, content, complete):
    """Of a run's file. As read_row() gives it of a table: what is rounded there is rounded here."""
    numbers = numbers_of(content, complete) if "facts" in content else {"failure": content["failure"]}
    row = {**run._asdict(), **content["measured"], **numbers, "version": content["version"],
           "program": content["measured"].get("program") or "unknown",
           "declared": digest(content["task"]), "outcome": digest(same_everywhere(content))}
    return read_row({column: written(row.get(column), kind) for column, kind in COLUMNS.items()})


def written(value, kind):
    if value is None:
        return ""
    if kind == TEXT:
        return " ".join(str(value).split())
    return str(int(value)) if kind == COUNT else f"{value:.{kind}f}".rstrip("0").rstrip(".")


def read_value(text, kind):
    if text == "":
        return None
    if kind == TEXT:
        return text
    value = int(text) if kind == COUNT else float(text)
    if not abs(value) < 1e15:
        raise ValueError(f"{text} is not a number")
    return value


def read_row(cells):
    """Raises ValueError if a cell is not what its column holds, or one is empty that tables need."""
    row = {column: read_value(cells[column], kind) for column, kind in COLUMNS.items()}
    needed = WHO + ("version", "program", "declared", "outcome") + (() if row["failure"] else ALWAYS)
    if empty := [column for column in needed if row[column] is None]:
        raise ValueError(f"a row of {row['task']} {row['method']} {row['seed']} has no {', '.join(empty)}")
    return row


def curve_of(content):
    """Points at which each fiftieth of the space was mapped first, and the last one: (seconds, or steps in lock-step; mapped,
    by whom it was mapped first or not at all)."""
    points, level = [], 0
    rows, lockstep = content.get("curve", []), content["task"].get("lockstep")
    for i, row in enumerate(rows):
        if CURVE_POINTS * row["coverage"] >= level or i == len(rows) - 1:
            level = math.floor(CURVE_POINTS * row["coverage"]) + 1
            points.append((i if lockstep else round(row["time_s"], 1), round(row["coverage"], 3),
                           round(row["first"].get("ugv", 0.0), 3)))
    return points


def table_of(columns, rows):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return text.getvalue()


def rows_table(results):
    return table_of(COLUMNS, ([written(r[column], kind) for column, kind in COLUMNS.items()] for r in results))


def curves_table(results):
    return table_of(CURVE_COLUMNS, ([*(r[c] for c in WHO), *(" ".join(f"{v:g}" for v in values) for values in zip(*r.curve))]
                                    for r in results if r.curve))


def read_table(file, columns):
    """Its lines as dictionaries. Raises OSError, or ValueError if it is not a table of these columns."""
    with open(file, encoding="utf-8", newline="") as stream:
        try:
            lines = list(csv.reader(stream, strict=True))
        except csv.Error as error:
            raise ValueError(f"{file}: {error}") from error
    if not lines or lines[0] != list(columns):
        raise ValueError(f"{file} is not a table of runs of this version; remove it to begin anew")
    for number, line in enumerate(lines[1:], 2):
        if len(line) != len(lines[0]):
            raise ValueError(f"{file}: row {number} has {len(line)} of {len(lines[0])} cells")
    return [dict(zip(lines[0], line)) for line in lines[1:]]


def run_of(row):
    return Run(row["task"], row["method"], row["seed"], bool(row["timed"]))


def read_published(table, curves):
    """What rows_table() and curves_table() have written: {run: (row, curve)}; nothing if there is no such file. Raises OSError,
    ValueError."""
    if not table.exists():
        return {}
    try:
        rows = [read_row(line) for line in read_table(table, COLUMNS)]
        points = {Run(line["task"], line["method"], int(line["seed"])):
                  list(zip(*([float(v) for v in line[c].split()] for c in CURVE_COLUMNS[len(WHO):])))
                  for line in read_table(curves, CURVE_COLUMNS)}
    except ValueError as error:
        raise ValueError(f"{table} or {curves.name}: {error}") from error
    return {run_of(row): (row, points.get(run_of(row), [])) for row in rows}
