"""The committed tables: whole, of the form the program writes, and what the page shows.

What the methods count is counted again here. Their seconds are those of one machine: the tests of
these hold the words of the page to the tables, for the day when tables are committed anew.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from liftmesh.paper.experiments import Measurement, Trial, measure
from liftmesh.paper.printed import SIZES, TABLES, TableName
from liftmesh.paper.results import Settings, from_lines
from liftmesh.paper.tables import COLUMNS

ROOT = Path(__file__).parents[2]
COMMITTED = ROOT / "data" / "paper"
PAGE = (ROOT / "docs/explanation/paper.md").read_text("utf-8")
ERRATA = (ROOT / "docs/explanation/paper-errata.md").read_text("utf-8")


def rows(table: TableName) -> list[dict[str, str]]:
    """Read a committed table."""
    name = f"table_{table.replace('.', '_')}.csv"
    with (COMMITTED / name).open(newline="", encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


@pytest.mark.parametrize("table", ["5.1", "5.2"])
def test_a_table_is_whole_and_stands_beside_the_printed_one(table: TableName) -> None:
    found = rows(table)
    assert list(found[0]) == list(COLUMNS)
    assert [int(row["n"]) for row in found] == list(SIZES)
    for row, printed in zip(found, TABLES[table].rows, strict=True):
        assert float(row["printed_lf"]) == printed.lf
        assert float(row["printed_lfres"]) == printed.lfres
        assert float(row["lf_dot_products"]) > float(row["lfres_dot_products"])
        median = printed.median or ("", "")
        assert [row["printed_median_x"], row["printed_median_y"]] == [f"{x:.6}" for x in median]


def measurements() -> dict[Trial, list[Measurement]]:
    """Read the committed measurements."""
    _, _, *lines = (COMMITTED / "measurements.csv").read_text("utf-8").splitlines()
    by_trial: dict[Trial, list[Measurement]] = {}
    for measurement in from_lines(lines, first=3):
        by_trial.setdefault(measurement.trial, []).append(measurement)
    return by_trial


def counts(measurement: Measurement) -> dict[str, object]:
    """What is counted; not the planes of the index, whose order of visits is its own affair."""
    found = {name: getattr(measurement, name) for name in ("facets", "evaluations", "rejected")}
    if measurement.method != "lfres-indexed":
        found |= {"calls": measurement.calls, "planes": measurement.planes}
    return {"method": measurement.method, **found}


@pytest.mark.slow
@pytest.mark.parametrize("trial", [Trial(table, 1000, seed) for table in TABLES for seed in (1, 2)])
def test_the_methods_count_what_is_committed(trial: Trial, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("liftmesh.paper.experiments.ROUNDS", 1)  # seconds do not count here
    committed = [*map(counts, measurements()[trial])]
    assert [*map(counts, measure(trial))] == committed


def test_lfres_looks_at_exactly_the_points_lf_looks_at() -> None:
    by_trial = measurements()
    assert by_trial.keys() == {*Settings(SIZES, 3, "any").trials(["5.1", "5.2"])}
    for lf, lfres, indexed, engine in by_trial.values():
        assert lf.evaluations == lfres.evaluations + sum(lfres.rejected.values())
        assert lf.facets == lfres.facets == indexed.facets == engine.facets


def test_lf_is_faster_than_printed_and_lfres_in_all_rows_but_two() -> None:
    slower: dict[str, list[tuple[str, int]]] = {"lf": [], "lfres": []}
    for table in TABLES:
        for row in rows(table):
            for method, found in slower.items():
                if float(row[method]) >= float(row[f"printed_{method}"]):
                    found.append((table, int(row["n"])))
    assert slower == {"lf": [], "lfres": [("5.1", 7_000), ("5.2", 3_000)]}


def test_the_index_gains_a_factor_of_twenty_at_a_thousand_points() -> None:
    firsts = [rows(table)[0] for table in TABLES]
    assert [row["n"] for row in firsts] == ["1000", "1000"]
    assert min(float(row["lf_over_indexed"]) for row in firsts) >= 20


def test_the_page_shows_the_committed_tables() -> None:
    shown = (COMMITTED / "tables.md").read_text("utf-8")
    lines = [line for line in shown.splitlines() if line.startswith("|")]
    assert len(lines) > 2 * len(SIZES)
    assert [line for line in lines if line not in PAGE] == []
    assert "<!--" not in PAGE


def test_the_machine_and_the_command_are_told() -> None:
    told = json.loads((COMMITTED / "paper.json").read_text("utf-8"))
    assert told["command"].startswith("liftmesh paper")
    assert "processor" in told["machine"]
    assert set(told["columns"]) == set(COLUMNS)


def test_every_erratum_names_a_test_that_exists() -> None:
    tests = "".join(path.read_text("utf-8") for path in (ROOT / "tests/paper").glob("test_*.py"))
    named = [word.strip("`.,;:") for word in ERRATA.split() if word.startswith("`test_")]
    assert len(named) > 20
    assert [name for name in named if f"def {name}(" not in tests] == []
