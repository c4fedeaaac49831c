"""The module graph of ARCHITECTURE.md, and the counts of the sources, on a small made-up tree."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import counts
import import_graph
import pytest
from import_graph import Graph, imports_of, includes_of, main, mermaid, reachable, reduced

MODULES = {
    "__init__.py": "",
    "__init__.pyi": "from house.roof.tiles import Tile as Tile",
    "__main__.py": "import house.roof",
    "_engine.pyi": "",
    "roof/__init__.py": "",
    "roof/tiles.py": "from house import walls\nfrom house.roof import nails\n",
    "roof/nails.py": "def drive():\n    from house.tools import hammer\n",
    "tools.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import house.ground\n",
    "walls.py": "from house import (\n    ground,\n    _engine,\n)\n",
    "ground.py": "import json\n",
    "attic.py": "",
    "_core/top/main.cpp": '#include <vector>\n#include "lines/cut.hpp"\n  #  include "point.hpp"\n',
    "_core/top/point.hpp": "",
    "_core/lines/cut.hpp": '#include "side.hpp"\n#include "planes/plane.hpp"\n',
    "_core/lines/side.hpp": "",
    "_core/planes/plane.hpp": '#include "../lines/side.hpp"\n// #include "none.hpp"\n',
}
IMPORTS: Graph = {
    "_engine": set(),
    "roof": {"walls", "tools"},
    "tools": {"ground"},
    "walls": {"ground", "_engine"},
    "ground": set(),
    "attic": set(),
}
INCLUDES: Graph = {"top": {"lines"}, "lines": {"planes"}, "planes": {"lines"}}
PAGE = """\
# A house
<!-- imports: begin -->
<!-- imports: end -->
Between them.
<!-- includes: begin -->
old
<!-- includes: end -->
"""


@pytest.fixture
def house(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.syspath_prepend(tmp_path)
    for name, text in MODULES.items():
        path = tmp_path / "house" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "house"


def test_the_imports_of_rooms(house: Path) -> None:
    assert imports_of(house) == IMPORTS


def test_the_includes_of_rooms(house: Path) -> None:
    assert includes_of(house / "_core") == INCLUDES


def test_an_include_that_is_not_there_is_named(house: Path) -> None:
    (house / "_core" / "lines" / "side.hpp").write_text('#include "none.hpp"')
    with pytest.raises(SystemExit, match=r"lines includes none\.hpp"):
        includes_of(house / "_core")


@pytest.mark.parametrize(
    ("arrows", "drawn"),
    [
        ("ab bc ac", "ab bc"),
        ("ab bc cd ad ac bd", "ab bc cd"),
        ("ab ac bd cd", "ab ac bd cd"),
        ("ab ba", "ab ba"),
        ("ab bc ca ac", "ab bc ca ac"),
        ("ab bc cb ac", "ab bc cb ac"),
        ("ab ba bc ac", "ab ba bc ac"),
        ("ab bc cb cd ad bd", "ab bc cb cd bd"),
    ],
)
def test_implied_arrows_are_left_out_but_those_of_cycles(arrows: str, drawn: str) -> None:
    graph = graph_of(arrows)
    assert reduced(graph) == graph_of(drawn, graph)


def test_a_reduced_graph_has_the_same_paths() -> None:
    chain = [f"room{k}" for k in range(12)]
    graph: Graph = {a: {*chain[k + 1 :: 1 + k % 3]} for k, a in enumerate(chain)}
    graph["room7"].add("room5")
    less = reduced(graph)
    assert sum(map(len, less.values())) < sum(map(len, graph.values()))
    assert {a: reachable(less, a) for a in less} == {a: reachable(graph, a) for a in graph}


def graph_of(arrows: str, rooms: Graph | None = None) -> Graph:
    graph: Graph = {room: set() for room in rooms or {*arrows} - {" "}}
    for a, b in arrows.split():
        graph[a].add(b)
    return graph


def test_the_drawing() -> None:
    assert mermaid({"b": {"a"}, "a": set(), "alone": set()}).splitlines() == [
        "```mermaid", "flowchart TD", "    alone", "    b --> a", "```",
    ]  # fmt: skip


def test_the_page_is_written_and_checked(
    house: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.md"
    page.write_text(PAGE)
    assert main(["--check"], page, house) == 1
    assert "page.md is out of date" in capsys.readouterr().err
    assert page.read_text() == PAGE
    assert main([], page, house) == 0
    assert main(["--check"], page, house) == 0
    text = page.read_text()
    parts = ["# A house\n<!-- imports: begin -->\n```mermaid\n", "    roof --> walls\n",
             "```\n<!-- imports: end -->\nBetween them.\n<!-- includes: begin -->\n```mermaid\n",
             "    top --> lines\n", "```\n<!-- includes: end -->\n"]  # fmt: skip
    assert all(text.index(a) < text.index(b) for a, b in pairwise(parts))
    assert "old" not in text
    (house / "attic.py").write_text("import house.ground")
    assert main(["--check"], page, house) == 1


def test_a_page_without_markers_is_refused(house: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(PAGE.replace("<!-- includes: end -->", ""))
    with pytest.raises(SystemExit, match="includes: end"):
        main([], page, house)


@pytest.mark.slow
def test_the_graphs_of_the_architecture_are_up_to_date() -> None:
    assert import_graph.main(["--check"]) == 0


COUNTED = {
    "house/roof/chimney.py": '"""Two lines\nof prose."""\n\nimport house.attic  # why\n# one\n',
    "house/attic.py": "import typing\nif typing.TYPE_CHECKING:\n    import house.roof.chimney\n",
    "house/_core/top/main.cpp": "/* two\nlines */\nint main() {}  // why\n\n// alone\n",
    "tests/test_house.py": "def test() -> None:\n    '''Prose.'''\n    assert True\n",
    "scripts/count.py": "",
}


def test_the_counts_of_a_tree(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, text in COUNTED.items():
        path = house.parent / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    found = {room: counts.counted(files) for room, files in counts.rooms(house.parent, house)}
    assert found["house/roof"] == (4, 9, 5)
    assert found["house/_core, C++"] == (5, 9, 4)
    assert found["tests, Python"] == (1, 3, 2)
    assert found["house, all"].files == found["house/roof"].files + 6
    assert counts.circles(house) == [{"house.roof.chimney", "house.attic"}]
    assert counts.loose(house) == ["attic", "ground", "tools", "walls"]
    counts.main(["--sources"], house.parent, house)
    told = capsys.readouterr().out
    assert "circles of imports: 1 (modules: 2)" in told
    assert "loose modules: 4 (attic, ground, tools, walls)" in told


def test_no_modules_import_each_other() -> None:
    assert counts.circles(import_graph.ROOT / import_graph.PACKAGE) == []


@pytest.mark.slow
def test_the_modules_that_a_call_loads(tmp_path: Path) -> None:
    counts.make_files(tmp_path)
    found = {name: counts.loaded(call, tmp_path) for name, call in counts.CALLS.items()}
    assert 1 < found["delaunay(array)"] < min(list(found.values())[1:])
