"""The mutation campaign, on a small made-up tree: what is drawn, and what survives."""

from __future__ import annotations

import importlib
import random
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.campaign  # `nox -s nightly` installs what draws the mutants

SOURCE = '''
"""Prose with 1 + 1."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import decimal as number; ROUND = 1 < 2

__all__ = ["half", "name"]
CHUNK_ROWS = 1 << 20


@dataclass(slots=True)
class Tile:
    pass


@cache
def half(value: int | None, low: float | None = None) -> int | None:
    if value is None or value == low:
        raise ValueError(f"give {1 + 1}")
    return value // 2


def untested(value):
    return value + 1
'''
TESTS = """
from liftmesh.roof.tile import half

def test_half():
    assert half(10) == 5
"""


@pytest.fixture
def mutants() -> Any:
    return importlib.import_module("mutants")


@pytest.fixture
def tile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mutants: Any) -> Path:
    files = {
        "liftmesh/__init__.py": "",
        "liftmesh/roof/__init__.py": "",
        "liftmesh/roof/tile.py": SOURCE,
        "liftmesh/roof/other.py": "",
        "tests/roof/test_tile.py": TESTS,
        "tests/roof/test_broken.py": "def test_other(): assert True\n",
    }
    for name, text in files.items():
        path = tmp_path / "house" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    monkeypatch.setattr(mutants, "ROOT", tmp_path / "house")
    monkeypatch.setattr(mutants, "PACKAGE", tmp_path / "house" / "liftmesh")
    return tmp_path / "house" / "liftmesh" / "roof" / "tile.py"


def test_what_no_test_should_notice_is_counted_and_not_drawn(tile: Path, mutants: Any) -> None:
    places, counts = mutants.sites_of(tile)
    lines = SOURCE.splitlines()
    assert {lines[row - 1].strip() for row, _ in places} == {
        "if value is None or value == low:", "return value // 2", "return value + 1",
        "@dataclass(slots=True)",
    }  # fmt: skip
    assert set(counts) == {
        "annotations", "messages", "type checkers", "decorators", "sizes of blocks", "identity",
    }  # fmt: skip


def test_a_draw_is_repeated_by_its_seed_and_shows_what_is_changed(tile: Path, mutants: Any) -> None:
    one, two = (mutants.drawn(mutants.files_of(["roof"]), 5, random.Random(1)) for _ in range(2))
    assert one == two
    assert len(set(one)) == 5
    for site in one:
        assert site.changed() != SOURCE
        assert "--- liftmesh/roof/tile.py" in site.diff()
    assert mutants.tests_of(tile) == ["tests/roof/test_tile.py", "tests/roof/test_broken.py"]


def test_mutants_are_killed_or_survive_in_a_copy(tile: Path, tmp_path: Path, mutants: Any) -> None:
    places, _ = mutants.sites_of(tile)
    tree = mutants.copied(tmp_path / "copy")
    found = {}
    for text in ("return value // 2", "return value + 1"):
        row = SOURCE.splitlines().index(f"    {text}") + 1
        site = next(s for place, sites in places.items() if place[0] == row for s in sites)
        found[text] = mutants.outcome(site, tree, 100)
    assert found["return value // 2"].verdict == mutants.KILLED
    assert found["return value // 2"].test == "tests/roof/test_tile.py::test_half"
    assert found["return value + 1"].verdict == mutants.SURVIVED
    assert (tree / "liftmesh" / "roof" / "tile.py").read_text() == tile.read_text() == SOURCE


def test_the_campaign_tells_what_survives(
    tile: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], mutants: Any
) -> None:
    monkeypatch.setattr("sys.argv", ["mutants", "--count", "4", "--seed", "2", "--rooms", "roof"])
    mutants.main()
    told = capsys.readouterr().out
    assert "4 mutants, seed 2: " in told
    assert "of annotations" in told
