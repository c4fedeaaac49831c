"""Edges of a triangulation, short forms of results, ``~`` in paths, what `help` shows."""

from __future__ import annotations

import inspect
import pydoc
import typing
from pathlib import Path

import numpy as np
import pytest
from clouds import FAMILIES

import liftmesh
from liftmesh import Cloud, InputError

ROWS = np.random.default_rng(3).random((40, 3))


@pytest.mark.parametrize("family", FAMILIES)
def test_each_edge_stands_once(family: str) -> None:
    tri = liftmesh.delaunay(FAMILIES[family](500, np.random.default_rng(2)))
    corners = tri.simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    expected = np.unique(np.sort(corners, axis=1), axis=0)
    assert tri.edges.dtype == np.int32
    assert (tri.edges[:, 0] < tri.edges[:, 1]).all()
    assert np.array_equal(np.unique(tri.edges, axis=0), expected)
    assert len(tri.edges) == len(expected) == tri.verify().n_edges


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


@pytest.mark.slow
def test_a_tilde_is_the_home_of_what_is_no_cloud(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    surface = liftmesh.triangulate(ROWS)
    tiled = liftmesh.tile_surface(ROWS, "~/tiles")
    for written in (
        surface.raster(0.1).save("~/a.tif"),
        tiled.save_raster("~/b.tif", 0.1),
        surface.contours([0.5]).save("~/c.geojson"),
        surface.profile([[0.2, 0.2], [0.8, 0.8]]).save("~/d.geojson"),
        liftmesh.voronoi(ROWS).save("~/e.geojson"),
    ):
        assert written.path.is_file()
        assert written.path.parent == tmp_path
    assert len(surface.trim(polygon="~/e.geojson").vertices) == 40


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
def test_help_is_short(name: str) -> None:
    longer = {"TiledSurface": 600}  # methods of two classes
    assert len(help_of(name)) <= longer.get(name, 400)


def test_help_names_parameters_and_types() -> None:
    text = " ".join(" ".join(help_of("delaunay")).split()).replace("( ", "(")
    assert "delaunay(points: 'ArrayLike', *, algorithm: 'Algorithm' = 'auto'," in text
    assert inspect.signature(liftmesh.delaunay).parameters["threads"].default is None
    assert typing.get_type_hints(liftmesh.lower_hull)["return"] is liftmesh.LowerHull
