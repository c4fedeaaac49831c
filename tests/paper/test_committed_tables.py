"""The committed tables: whole, of the form the program writes, and what the page shows."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from liftmesh.paper.printed import SIZES, TABLES, TableName
from liftmesh.paper.tables import COLUMNS

ROOT = Path(__file__).parents[2]
COMMITTED = ROOT / "data" / "paper"
PAGE = (ROOT / "PAPER.md").read_text("utf-8")


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
        shares = sum(float(row[name]) for name in COLUMNS if name.startswith("rejected "))
        evaluated = float(row["lfres_dot_products"]) / float(row["lf_dot_products"])
        assert shares + evaluated == pytest.approx(1, abs=2e-3)  # medians of several sets


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
    named = [word.strip("`.,;:") for word in PAGE.split() if word.startswith("`test_")]
    assert len(named) > 20
    assert [name for name in named if f"def {name}(" not in tests] == []
