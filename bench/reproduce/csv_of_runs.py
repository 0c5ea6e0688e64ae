"""All runs of the page as a table to compute with: a row for each."""

import csv
import io

from results import LEVELS

FACTS = ("end", "coverage_observable", "auc", "contacts", "contacts_in_free", "held_back", "clearance_min_m", "separation_min_m")
MAP = ("false_free", "false_occupied", "surface_found")
HEADER = ("task", "method", "seed", "failure", *(f"s_to_{level}" for level in LEVELS), "m_ugv", "m_uav",
          "revisited_ugv", "revisited_uav", "share_uav", "steps", "steps_to_90", *FACTS, *MAP)


def rounded(value):
    return "" if value is None else round(value, 4) if isinstance(value, float) else value


def row_of(run):
    row = [run.run.task, run.run.method, run.run.seed, run.failure or ""]
    if run.facts:
        row += [*map(run.seconds, LEVELS), run.metres("ugv"), run.metres("uav"), run.revisited("ugv"),
                run.revisited("uav"), run.share("uav"), run.steps(), run.steps(0.9), *map(run.facts.get, FACTS),
                *map(run.map_error, MAP)]
    return [rounded(value) for value in row] + [""] * (len(HEADER) - len(row))


def csv_of_runs(results):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    writer.writerows(row_of(results.all[run]) for run in results.wanted if run in results.all and not run.timed)
    return text.getvalue()
