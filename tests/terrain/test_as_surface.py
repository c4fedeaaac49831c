"""Surfaces from meshes: the faces of a file, found again in a triangulation."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from clouds import FAMILIES
from commands import liftmesh as run
from hypothesis import given, settings
from surfaces import LATTICE, LIMITS, drawn, meadow, trimmed, with_heights

import liftmesh


def names(surface: liftmesh.Surface) -> set[tuple[int, ...]]:
    return {tuple(sorted(face)) for face in surface.faces.tolist()}


@pytest.mark.parametrize("family", FAMILIES)
def test_a_mesh_is_the_surface_that_it_was(family: str) -> None:
    points = with_heights(FAMILIES[family](60, np.random.default_rng(2)))
    surface = liftmesh.triangulate(points, on_duplicate="lowest")
    found = liftmesh.as_surface(surface.to_cloud())
    assert names(found) == names(surface)
    assert found.mask is None
    used = np.unique(surface.faces)
    np.testing.assert_array_equal(found.sample(points[used, :2]), surface.sample(points[used, :2]))


@settings(max_examples=50)
@given(LATTICE, LIMITS)
def test_faces_that_were_trimmed_stay_away(points, limit: float) -> None:
    surface = drawn(points)
    surface = surface and trimmed(surface, max_edge=limit)
    if surface is None:
        return
    found = liftmesh.as_surface(surface.to_cloud())
    assert names(found) == names(surface)
    queries = np.stack(np.meshgrid(np.arange(0, 5.5, 0.25), np.arange(0, 5.5, 0.25)), axis=-1)
    np.testing.assert_array_equal(found.sample(queries), surface.sample(queries))
    assert [len(ring) for ring in found.boundary()] == [len(r) for r in surface.boundary()]


@pytest.mark.parametrize("suffix", ["ply", "obj", "off", "npz"])
def test_files_are_read_whole(tmp_path, suffix: str) -> None:
    surface = liftmesh.triangulate(meadow(), crs="EPSG:25832").trim(max_edge=14)
    surface.save(tmp_path / f"tin.{suffix}")
    found = liftmesh.as_surface(tmp_path / f"tin.{suffix}")
    assert names(found) == names(surface)
    lines, expected = found.contours(interval=1), surface.contours(interval=1)
    np.testing.assert_array_equal(lines.points, expected.points)
    np.testing.assert_array_equal(found.raster(1).values, surface.raster(1).values)


def test_other_planes_and_rows_in_no_face() -> None:
    points = np.vstack([meadow(), [[50, 50, 99]]])[:, [0, 2, 1]]
    mesh = liftmesh.triangulate(points[:-1], plane="xz").to_cloud()
    mesh = liftmesh.Cloud(points, faces=mesh.faces)
    found = liftmesh.as_surface(mesh, plane="xz")
    assert found.report.n_unused == 1
    assert found.report.left_out.tolist() == [len(points) - 1]
    assert "1 row in no face" in str(found.report)
    assert liftmesh.as_surface(found) is found


@pytest.mark.parametrize(
    ("points", "faces", "said"),
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], None, "there are no faces: triangulate"),
        (
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
            [[0, 1, 2], [0, 1, 3]],
            r"face 0, of .*\[0, 1, 2\], and face 1, of .* overlap .*, or triangulate the vertices$",
        ),
        (
            [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 0], [9, 9, 0]],
            [[0, 1, 2], [1, 2, 4], [0, 3, 2]],
            r"face 0, of .*\[0, 1, 2\], and face 2, of .* overlap .*, or triangulate the vertices$",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 5], [1, 1, 0]],
            [[0, 1, 2], [1, 4, 3]],
            "rows 2 and 3 of faces are at one planar position",
        ),
        ([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], "row 2 of a face is not finite"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, np.inf]], [[0, 1, 2]], "row 2 of a face is not finite"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]], "7"),
    ],
)
def test_other_meshes_are_refused(points, faces, said: str) -> None:
    corners = None if faces is None else np.array(faces, dtype=np.int32)
    with pytest.raises(liftmesh.LiftmeshError, match=said):
        liftmesh.as_surface(liftmesh.Cloud(np.array(points, dtype=float), faces=corners))


def test_sides_that_are_not_delaunay_become_constraints() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 5]], dtype=float)
    canonical = liftmesh.triangulate(square)
    for faces in ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]):
        found = liftmesh.as_surface(liftmesh.Cloud(square, faces=np.array(faces, dtype=np.int32)))
        assert names(found) == {tuple(face) for face in faces}
        assert found.verify()
        is_plain = names(found) == names(canonical)
        assert hasattr(found.triangulation, "constraints") == (not is_plain)


@pytest.mark.parametrize("kind", ["glb", "stl"])
def test_a_mesh_that_was_rounded_is_refused_with_the_reason(tmp_path, kind: str) -> None:
    x, y = (each.ravel() for each in np.mgrid[:9, :9])
    # Turned squares: rounding decides which diagonal each has.
    points = np.column_stack([0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, x * y]) / 3
    path, exact = tmp_path / f"tin.{kind}", tmp_path / "tin.ply"
    surface = liftmesh.triangulate(points)
    for each in (path, exact):
        surface.save(each)
    assert names(liftmesh.as_surface(exact)) == names(surface)
    said = r"has no area seen .*, or triangulate the vertices; .* single precision, .*: write PLY"
    with pytest.raises(liftmesh.InputError, match=said):
        liftmesh.as_surface(path)
    done = run("contour", path.name, "a.geojson", "--interval", "1", cwd=tmp_path)
    assert done.returncode == 3
    assert re.search(said, done.stderr)


@pytest.mark.parametrize("given", ["weights", "radii", "metric"])
def test_meshes_by_weights_or_in_a_metric_are_found_again(tmp_path, given: str) -> None:
    points = meadow()
    sizes = np.random.default_rng(8).uniform(0, 4, len(points))
    by = {given: [[2.0, 0.5], [0.5, 1.0]] if given == "metric" else sizes}
    surface = liftmesh.triangulate(points, **by).trim(max_edge=14)
    surface.save(tmp_path / "tin.ply")
    found = liftmesh.as_surface(tmp_path / "tin.ply")
    assert names(found) == names(surface) != names(liftmesh.triangulate(points).trim(max_edge=14))
    np.testing.assert_array_equal(found.raster(2).values, surface.raster(2).values)


def lined() -> liftmesh.Surface:
    """Make a surface along a line that many Delaunay sides cross."""
    rows = np.random.default_rng(5).integers(0, 64, (300, 3)).astype(np.float64)
    line = [[1.0, 1.5, 9.0], [40.0, 20.0, 8.0], [63.0, 62.5, 7.0]]
    return liftmesh.triangulate(rows, breaklines=[line])


@pytest.mark.parametrize("kind", ["obj", "ply", "npz"])
def test_a_file_keeps_the_lines_of_a_surface(kind: str, tmp_path: Path) -> None:
    surface = lined()
    assert "edges" not in surface.save(tmp_path / f"a.{kind}").dropped
    again = liftmesh.as_surface(tmp_path / f"a.{kind}")
    assert len(surface.triangulation.constraints) >= 2
    assert np.array_equal(again.triangulation.constraints, surface.triangulation.constraints)
    assert np.array_equal(again.vertices, surface.vertices)
    assert again.verify().valid
    found = liftmesh.verify(tmp_path / f"a.{kind}")
    assert (found.valid, found.member) == (True, "constrained")
    assert set(map(frozenset, again.faces.tolist())) == set(map(frozenset, surface.faces.tolist()))


def test_edges_at_rows_in_no_face_are_left_out() -> None:
    trimmed = lined().trim(max_edge=12)
    again = liftmesh.as_surface(trimmed.to_cloud())
    assert len(again.faces) == len(trimmed.faces)


def test_edges_that_are_no_rows_are_refused() -> None:
    cloud = replace(lined().to_cloud(), edges=np.array([[0, 900]]))
    with pytest.raises(liftmesh.FormatError, match=r"the mesh: edge 0 refers to vertex 900"):
        liftmesh.as_surface(cloud)
    with pytest.raises(liftmesh.FormatError, match=r"edge 0 refers to vertex 900"):
        liftmesh.write(io.BytesIO(), cloud, format="ply")
