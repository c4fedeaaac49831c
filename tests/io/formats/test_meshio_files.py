"""MSH, SU2 and the tags of VTU: what meshio and Gmsh read is the mesh, its markers and regions."""

from __future__ import annotations

import io
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import meshio
import numpy as np
import pytest
from constrained.families import FAMILIES
from gmsh_apart import apart, read
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import Cloud, FormatError, InputError
from liftmesh.io.tags import regions_of

FRAME = np.array([[0, 0], [9, 0], [9, 6], [0, 6]], np.float64)
HOLE = np.array([[2, 2], [4, 2], [4, 4], [2, 4]], np.float64)
WALL = np.array([[6, 0], [6, 6]], np.float64)


def plate() -> liftmesh.RefineResult:
    """Refine a plate with a hole, and a wall from side to side."""
    given = {"polygons": [[FRAME, HOLE]], "polylines": [WALL], "carve": "holes"}
    return liftmesh.refine(liftmesh.constrained_delaunay([], **given), max_area=0.5)


def lines_by(tags: Any, lines: Any) -> dict[int, set[frozenset[int]]]:
    """Group lines by their tags."""
    return {int(tag): {*map(frozenset, lines[tags == tag].tolist())} for tag in np.unique(tags)}


def expected_lines(tri: liftmesh.ConstrainedTriangulation) -> dict[int, set[frozenset[int]]]:
    """Tell the frame, the hole and the wall by where their corners are."""
    x, y = tri.points[tri.constraints].transpose(2, 0, 1)
    is_wall = (x == 6).all(axis=1)
    is_frame = ((x == 0) | (x == 9)).all(axis=1) | ((y == 0) | (y == 6)).all(axis=1)
    return lines_by(np.select([is_wall, is_frame], [3, 1], 2), tri.constraints)


def test_gmsh_reads_what_was_refined(tmp_path: Path) -> None:
    refined = plate()
    tri = refined.triangulation
    written = liftmesh.write(tmp_path / "a.msh", refined)
    assert (written.format, written.dropped) == ("msh", ())
    points, found = apart(read, str(tmp_path / "a.msh"))
    assert points[:, :2].tobytes() == tri.points.tobytes()
    assert {k: {*map(frozenset, v.tolist())} for (d, k), v in found.items() if d == 1} == (
        expected_lines(tri)
    )
    for k in range(2):
        assert np.array_equal(found[2, k + 1], tri.simplices[tri.regions == k])


def test_su2_has_a_marker_for_each_closed_line(tmp_path: Path) -> None:
    refined = plate()
    tri, expected = refined.triangulation, expected_lines(refined.triangulation)
    written = liftmesh.write(tmp_path / "a.su2", refined)
    assert written.dropped == ("edges inside",)
    mesh = meshio.read(tmp_path / "a.su2")
    assert mesh.points.tobytes() == tri.points.tobytes()
    assert np.array_equal(mesh.cells_dict["triangle"], tri.simplices)
    tags = mesh.cell_data_dict["su2:tag"]["line"]
    assert lines_by(tags, mesh.cells_dict["line"]) == {k: expected[k] for k in (1, 2)}


def test_vtu_has_regions_and_markers_of_cells(tmp_path: Path) -> None:
    refined = plate()
    tri = refined.triangulation
    liftmesh.write(tmp_path / "a.vtu", refined)
    mesh = meshio.read(tmp_path / "a.vtu")
    values = mesh.cell_data_dict
    assert np.array_equal(values["region"]["triangle"], tri.regions)
    assert set(values["region"]["line"]) == {-1}
    assert set(values["marker"]["triangle"]) == {0}
    assert lines_by(values["marker"]["line"], mesh.cells_dict["line"]) == expected_lines(tri)


def test_markers_of_input_edges(tmp_path: Path) -> None:
    edges = [[0, 1], [1, 2], [2, 3], [3, 0]]
    tri = liftmesh.constrained_delaunay(FRAME, edges, polylines=[WALL])
    made = liftmesh.refine(tri, max_area=1).triangulation
    cloud = made.to_cloud(markers=[7, 8, 7])
    markers = cloud.metadata["markers"]
    for side, tag in ((0, 7), (1, 8), (2, 7), (3, 0), (4, 0)):
        assert {*markers[made.constraint_inputs[1] == side]} == {tag}
    liftmesh.write(tmp_path / "a.su2", cloud)
    tags = meshio.read(tmp_path / "a.su2").cell_data_dict["su2:tag"]["line"]
    counts = [np.count_nonzero(markers == tag) for tag in (7, 8)]
    boundary = np.count_nonzero((made.neighbors < 0).ravel())
    assert [np.count_nonzero(tags == tag) for tag in (7, 8, 9)] == [*counts, boundary - sum(counts)]
    assert liftmesh.write(tmp_path / "a.poly", cloud).dropped == ("faces",)
    back = liftmesh.read(tmp_path / "a.poly")
    assert np.array_equal(back.edges, cloud.edges)  # type: ignore[arg-type]
    assert np.array_equal(back.metadata["markers"], markers)
    assert "metadata markers" in liftmesh.write(io.BytesIO(), cloud, format="ply").dropped


def test_an_edge_on_several_input_edges_has_the_first_marker() -> None:
    tri = liftmesh.constrained_delaunay(FRAME, [[0, 1], [1, 0], [0, 1]])
    for markers, expected in (([0, 5, 6], 5), ([4, 5, 6], 4), ([], 0), ([-3], -3)):
        assert tri.to_cloud(markers=markers).metadata["markers"].tolist() == [expected]
    bare = liftmesh.constrained_delaunay(FRAME, [])
    assert bare.to_cloud(markers=[]).metadata["markers"].shape == (0,)
    for wrong in ([1, 2, 3, 4], [1.5], [[1]], ["a"], [[1], [2, 3]], [1 << 31]):
        with pytest.raises(InputError, match=r"give one for each input edge: whole numbers of 32"):
            tri.to_cloud(markers=wrong)  # type: ignore[arg-type]


def corners(points: Any, cells: Any, kind: str) -> set[frozenset[bytes]]:
    """Return cells of a kind by the bits of their corners."""
    rows = np.asarray(points, np.float64)[:, :2]
    found = [rows[each.data] for each in cells if each.type == kind]
    return {frozenset(map(bytes, cell)) for each in found for cell in each}


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(sorted(FAMILIES)), st.integers(20, 60), st.integers(0, 99))
def test_any_triangulation_comes_back(name: str, n: int, seed: int) -> None:
    points, edges = FAMILIES[name](n, np.random.default_rng(seed))
    carve: Any = "holes" if name in {"coast", "nested rings"} else None
    tri = liftmesh.constrained_delaunay(points, edges, carve=carve)
    cloud = tri.to_cloud()
    assert np.array_equal(regions_of(cloud), tri.regions)
    assert cloud.points[:, :2].tobytes() == np.asarray(tri.points, np.float64).tobytes()
    with TemporaryDirectory() as folder:
        for kind in ("msh", "su2", "vtu"):
            path = Path(folder, f"a.{kind}")
            liftmesh.write(path, cloud)
            mesh = meshio.read(path)
            assert {*map(bytes, mesh.points[:, :2])} <= {*map(bytes, cloud.points[:, :2])}
            assert corners(mesh.points, mesh.cells, "triangle") == corners(
                tri.points, [meshio.CellBlock("triangle", tri.simplices)], "triangle"
            )
            lines = tri.constraints
            if kind == "su2":  # all of the boundary, and nothing else
                sides = [np.roll(tri.simplices, -k, axis=1)[:, 1:] for k in range(3)]
                lines = np.concatenate([s[tri.neighbors[:, k] < 0] for k, s in enumerate(sides)])
            assert corners(mesh.points, mesh.cells, "line") == corners(
                tri.points, [meshio.CellBlock("line", lines)], "line"
            )


def test_few_nodes(tmp_path: Path) -> None:
    square = liftmesh.constrained_delaunay(FRAME, [[0, 1], [1, 2], [2, 3], [3, 0]])
    for markers, count in (([1, 1, 1, 1], 2), ([1, 2, 3, 3], 4)):
        liftmesh.write(tmp_path / "a.msh", square.to_cloud(markers=markers))
        assert len(meshio.read(tmp_path / "a.msh").cells) == count
    with pytest.raises(FormatError, match="4 vertices are too few for the 5 regions and markers"):
        liftmesh.write(tmp_path / "b.msh", square.to_cloud(markers=[1, 2, 3, 4]))
    for name in ("b.msh", "b.su2"):
        with pytest.raises(FormatError, match=r"edge 1 is -4, but markers of (MSH|SU2) are"):
            liftmesh.write(tmp_path / name, square.to_cloud(markers=[1, 2, 3, -4]))
        assert not (tmp_path / name).exists()


def test_markers_that_do_not_fit(tmp_path: Path) -> None:
    cloud = plate().to_cloud()
    for wrong in ([1, 2], "oak", np.ones(len(cloud.edges))):  # type: ignore[arg-type]
        for kind in ("msh", "su2", "vtu", "poly"):
            with pytest.raises(FormatError, match="metadata markers are no whole numbers of 32"):
                liftmesh.write(tmp_path / f"a.{kind}", replace(cloud, metadata={"markers": wrong}))


def test_surfaces_and_rows_without_faces(tmp_path: Path) -> None:
    rows = np.array([[0, 0, 5], [1, 0, 6], [1, 1, 7], [9, 9, 9], [0, 1, 8]], np.float64)
    mesh = Cloud(rows, faces=np.array([[0, 1, 2], [0, 2, 4]], np.int32))
    assert liftmesh.write(tmp_path / "a.msh", mesh).dropped == ()
    found = meshio.read(tmp_path / "a.msh")
    assert (found.points[:, 2].tolist(), len(found.cells)) == ([5, 6, 7, 9, 8], 1)
    assert liftmesh.write(tmp_path / "a.su2", mesh).dropped == ("rows in no face", "heights")
    found = meshio.read(tmp_path / "a.su2")
    assert found.cells_dict["triangle"].tolist() == [[0, 1, 2], [0, 2, 3]]
    lined = replace(mesh, edges=np.array([[0, 3]], np.int32))
    dropped = liftmesh.write(tmp_path / "b.su2", lined).dropped
    assert sorted(dropped) == ["edges inside", "heights", "rows in no face"]
    assert (len(found.points), len(found.cells_dict["line"])) == (4, 4)
    for kind in ("msh", "su2"):
        with pytest.raises(FormatError, match=f"without faces cannot be written as {kind.upper()}"):
            liftmesh.write(tmp_path / "b", rows, format=kind)


def test_formats_that_meshio_has_not(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"'med', but `meshio convert` makes such files of"):
        liftmesh.write(tmp_path / "a.med", plate())


def test_without_meshio(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(liftmesh.MissingDependencyError, match=r"liftmesh\[solvers\]"):
        liftmesh.write(tmp_path / "a.msh", plate())
