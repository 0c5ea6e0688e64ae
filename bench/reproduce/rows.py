"""A run as a row of results.csv and a thin curve: all that the page is made of, wherever the run was made.

Rows that are published need no file of the run any more: other machines, and later days, add to them.
"""

import csv
import io
import math

from experiments import Run, declaration, digest
from explore import kind_of

LEVELS = ("50", "90", "95", "99", "end")
KINDS = ("ugv", "uav")
GAINS = ("gain_tangent", "gain_predicted", "gained")  # of the UAVs
MAP = ("false_free", "false_occupied", "surface_found")
UNSEEN = ("narrow", "hidden", "in_view")
PLANNING = ("planning_mean_s", "planning_p99_s", "planning_max_s")
PLANNING_HALVES = ("planning_p99_first_half_s", "planning_p99_second_half_s")
WHO = ("task", "method", "seed")

COUNT, TEXT, NUMBER, PART = "count", "text", "number", "part"
COLUMNS = {
    "task": TEXT, "method": TEXT, "seed": COUNT, "timed": COUNT,
    "failure": TEXT,  # why it has left no numbers
    **{f"s_to_{level}": NUMBER for level in LEVELS},
    **{f"m_{kind}": NUMBER for kind in KINDS}, "m_mapped": NUMBER, "m_uav_mapped": NUMBER,
    **{f"revisited_{kind}": PART for kind in KINDS},
    **{f"first_{kind}": PART for kind in KINDS},
    "steps": COUNT, "steps_to_90": COUNT,
    "end": TEXT, "coverage_observable": PART, "auc": PART,
    "contacts": COUNT, "contacts_in_free": COUNT, "held_back": COUNT, "clearance_min_m": NUMBER, "separation_min_m": NUMBER,
    "worst_of_limits": NUMBER,
    **dict.fromkeys(MAP, PART), **dict.fromkeys(UNSEEN, PART), **dict.fromkeys(GAINS, NUMBER),
    "wall_s": NUMBER, **dict.fromkeys(PLANNING + PLANNING_HALVES, NUMBER), "machine": TEXT,  # but the first of timed runs
    "failed_before": TEXT,  # why earlier attempts at it by this program crashed or hung
    "version": TEXT, "program": TEXT, "date": TEXT,
    "declared": TEXT,  # digests: of what the run is, and of all of its outcome that does not depend on the machine
    "outcome": TEXT,
}
ALWAYS = ("s_to_end", "steps", "end", "coverage_observable", "contacts", "held_back")  # of a run that has ended
FACTS = ("end", "coverage_observable", "auc", "contacts", "contacts_in_free", "held_back", "clearance_min_m", "separation_min_m",
         "worst_of_limits")
DIGITS = 9
CURVE_COLUMNS = (*WHO, "outcome", "x", "mapped", "by_ugv")
CURVE_POINTS = 50


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
        **{column: facts.get(column) for column in FACTS},
        **{column: (facts.get("map") or {}).get(column) for column in MAP},
        **{column: (facts.get("unseen") or {}).get(column) for column in UNSEEN},
        **{column: content["gains"].get("uav", {}).get(column) for column in GAINS},
        **{f"s_to_{level}": facts["time_s"].get(level) for level in LEVELS},
        **{f"m_{kind}": last["length_m"].get(kind) for kind in KINDS},
        "m_mapped": mapped and total(mapped["length_m"]), "m_uav_mapped": mapped and mapped["length_m"].get("uav"),
        **{f"revisited_{kind}": revisited(facts.get("by_robot"), kind) for kind in KINDS},
        **{f"first_{kind}": last["first"].get(kind) for kind in KINDS},
        "steps": len(curve) - 1, "steps_to_90": first_with(curve, 0.9)[0]}


def row_of(run, content, complete):
    """Of a run's file. As read_row() gives it of a table: what is rounded there is rounded here. Raises ValueError."""
    measured = content["measured"]
    numbers = numbers_of(content, complete) if "facts" in content else {"failure": content["failure"]}
    measures = ("wall_s", "failed_before", "date", *((*PLANNING, "machine") if run.timed else ()))
    halves = dict(zip(PLANNING_HALVES, measured.get("planning_p99_halves_s") or ())) if run.timed else {}
    row = {**numbers, **run._asdict(), **halves, **{column: measured.get(column) for column in measures},
           "version": content["version"], "program": measured.get("program") or "unknown",
           "declared": declaration(content["task"], complete), "outcome": digest(same_everywhere(content))}
    return read_row({column: written(row.get(column), kind) for column, kind in COLUMNS.items()})


def written(value, kind):
    if value is None:
        return ""
    if kind == TEXT:
        return " ".join(str(value).split())
    return str(int(value)) if kind == COUNT else f"{value:.{DIGITS}g}"


def read_value(text, kind):
    if text == "":
        return None
    if kind == TEXT:
        return text
    value = int(text) if kind == COUNT else float(text)
    if not 0 <= value <= (1 if kind == PART else 1e15):
        raise ValueError(f"{text} is no {kind}")
    return value


def read_row(cells):
    """Raises ValueError if a cell is not what its column holds, or one is empty that tables need."""
    row = {column: read_value(cells[column], kind) for column, kind in COLUMNS.items()}
    together = [column for columns in (MAP, UNSEEN) if any(row[c] is not None for c in columns) for column in columns]
    needed = (*WHO, "timed", "version", "program", "declared", "outcome", *(() if row["failure"] else ALWAYS), *together)
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
    return table_of(CURVE_COLUMNS, ([*(r[c] for c in CURVE_COLUMNS[:-3]), *(" ".join(f"{v:g}" for v in values) for values in zip(*r.curve))]
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


def read_curve(line):
    lists = [[read_value(v, PART if column != "x" else NUMBER) for v in line[column].split()] for column in CURVE_COLUMNS[-3:]]
    if not len(lists[0]) == len(lists[1]) == len(lists[2]) > 0:
        raise ValueError(f"the curve of {line['task']} {line['method']} {line['seed']} is cut off")
    return list(zip(*lists))


def read_published(table, curves):
    """What rows_table() and curves_table() have written: {run: (row, curve)}; nothing if there is no such file. Raises OSError,
    ValueError."""
    if not table.exists():
        return {}
    published = {}
    try:
        rows = [read_row(line) for line in read_table(table, COLUMNS)]
        points = {(Run(line["task"], line["method"], int(line["seed"])), line["outcome"]): read_curve(line)
                  for line in read_table(curves, CURVE_COLUMNS)}
        for row in rows:
            if run_of(row) in published:
                raise ValueError(f"{run_of(row).name} has two rows; leave one")
            published[run_of(row)] = row, points.get((run_of(row), row["outcome"]), [])
    except FileNotFoundError as error:
        raise ValueError(f"{table} is there and {curves} is not: bring it back, or remove {table.name} to begin anew") from error
    except ValueError as error:
        raise ValueError(f"{table} or {curves.name}: {error}") from error
    return published
