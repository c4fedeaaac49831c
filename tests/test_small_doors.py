"""Edges of a triangulation, short forms of results, ``~`` in paths, what `help` shows."""

from __future__ import annotations

import inspect
import pydoc
import re
import typing
from pathlib import Path

import numpy as np
import pytest
from clouds import FAMILIES

import liftmesh
from liftmesh import Cloud, InputError
from liftmesh.signatures import Readable, make_readable

ROWS = np.random.default_rng(3).random((40, 3))


@pytest.mark.parametrize("family", FAMILIES)
def test_each_edge_stands_once(family: str) -> None:
    tri = liftmesh.delaunay(FAMILIES[family](500, np.random.default_rng(2)))
    corners = tri.simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    expected = np.unique(np.sort(corners, axis=1), axis=0)
    assert tri.edges.dtype == np.int32
    assert (tri.edges[:, 0] < tri.edges[:, 1]).all()
    assert np.array_equal(np.unique(tri.edges, axis=0), expected)
    assert len(tri.edges) == len(expected) == tri.verify().edges


def test_edges_cannot_be_changed_and_are_computed_once() -> None:
    tri = liftmesh.delaunay(ROWS)
    assert tri.edges is tri.edges
    with pytest.raises(ValueError, match="read-only"):
        tri.edges[0] = 0
    assert tri.points[tri.edges].shape == (len(tri.edges), 2, 2)


def test_a_cloud_is_shown_in_one_line() -> None:
    assert repr(Cloud(ROWS)) == "<Cloud of 40 points>"
    assert repr(Cloud(ROWS[:1], faces=np.zeros((1, 3), np.int32))) == "<Cloud of 1 point, 1 face>"
    values = {f"value {number}": ROWS[:, 0] for number in range(30)}
    full = Cloud(ROWS, colors=ROWS, normals=ROWS, attributes=values, crs="WKT " * 100)
    shown = repr(full)
    assert shown.startswith("<Cloud of 40 points, colors, normals, value 0, value 1, ")
    assert "24 more named values, crs 'WKT WKT" in shown
    assert len(shown) < 250
    assert "\n" not in shown


def test_a_lower_hull_is_shown_in_one_line() -> None:
    hull = liftmesh.lower_hull(ROWS)
    assert repr(hull) == f"<LowerHull of {len(hull.faces)} facets over 40 points>"


@pytest.mark.parametrize("kind", [str, Path])
def test_a_tilde_is_the_home(kind: type, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    written = liftmesh.triangulate(ROWS).save(kind("~/mesh.ply"))
    assert written.path == tmp_path / "mesh.ply"
    assert len(liftmesh.read(kind("~/mesh.ply"))) == 40
    assert [len(chunk) for chunk in liftmesh.read_chunks(kind("~/mesh.ply"))] == [40]
    assert liftmesh.verify(kind("~/mesh.ply")).canonical
    with pytest.raises(FileNotFoundError, match=str(tmp_path / "nowhere.ply")):
        liftmesh.triangulate(kind("~/nowhere.ply"))


def test_a_tilde_inside_a_name_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a~b.ply", "~nobody-of-this-name.ply", "./~.ply"):
        liftmesh.write(name, ROWS)
        assert (tmp_path / name).is_file()
        assert len(liftmesh.read(name)) == 40


def test_a_path_with_nul_is_refused() -> None:
    for call in (liftmesh.read, lambda path: liftmesh.write(path, ROWS)):
        with pytest.raises(InputError, match=r"holds NUL, which no path can"):
            call("a\0b.ply")


def help_of(name: str) -> list[str]:
    return pydoc.plain(pydoc.render_doc(getattr(liftmesh, name))).splitlines()


@pytest.mark.parametrize("name", sorted(set(liftmesh.__all__) - {"__version__"}))
def test_help_fits_a_terminal_and_shows_types_as_they_are(name: str) -> None:
    lines = help_of(name)
    shown = [line for line in lines if not re.match(r"class |.*keeps: tuple", line)]  # long lists
    assert max(map(len, shown)) <= 104  # lines of a docstring, indented
    own = [line for line in shown if not re.match(r" \|  __(?!init__)", line)]
    assert not any(re.search(r"\w: '|-> '", line) for line in own)
    longer = {"Surface": 1020, "TiledSurface": 600}  # methods of many kinds, or of two classes
    assert len(shown) < longer.get(name, 400)


def test_help_shows_one_parameter_in_a_line() -> None:
    begin = ["delaunay(", "    points: ArrayLike,", "    *,", "    method: Method = 'auto',"]
    assert help_of("delaunay")[2:6] == begin
    assert ") -> Surface" in help_of("triangulate")
    assert "lift(points: ArrayLike, q: ParaboloidVertex = 'origin') -> Floats" in help_of("lift")
    methods = [line.removeprefix(" |  ") for line in help_of("Surface")]
    at = methods.index("replace(")
    assert methods[at + 1 : at + 3] == ["    self,", "    *,"]
    assert methods[3:6] == ["Surface(", "    vertices: Floats,", "    faces: Rows,"]


def test_signatures_mean_what_they_did() -> None:
    text = str(inspect.signature(liftmesh.Surface.with_attributes))
    assert " ".join(text.split()).endswith("= None, /, **named: ArrayLike, ) -> Surface")
    without = Readable([inspect.Parameter("a", inspect.Parameter.VAR_POSITIONAL)])
    assert str(without) == "(*a)"
    make_readable(None)
    bound = inspect.signature(liftmesh.delaunay).bind(ROWS, threads=2)
    assert bound.arguments["threads"] == 2
    assert typing.get_type_hints(liftmesh.lower_hull)["return"] is liftmesh.LowerHull
