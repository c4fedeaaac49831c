"""Files of Triangle: what they say is read, and what is written is read again, bit for bit."""

from __future__ import annotations

import gzip
import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, FormatError, constrained_delaunay

FRAME = [[-1, -1], [17, -2], [18, 18], [-2, 17]]

# As on https://www.cs.cmu.edu/~quake/triangle.poly.html: a box with a hole, and remarks.
BOX = """# A box with eight vertices and eight edges.
8 2 1 1
 # Outer box has these vertices:
 1   0 0   0.5  5
 2   0 3   1.5  5
 3   3 0   2.5  0
 4   3 3   3.5  33     # A special marker for this vertex.

 5   1 1   4.5  0
 6   1 2   5.5  0
 7   2 1   6.5  0
 8   2 2   7.5  0
# Five segments of the outer box, with markers, and four of the hole.
8 1
 1   1 2   5
 2   5 7   0
 3   7 8   0
 4   8 6   10
 5   6 5   0
 6   1 3   0
 7   3 4   0
 8   2 4   0
# One hole in the middle of the inner square.
1
 1   1.5 1.5
"""
EDGES = [[0, 1], [4, 6], [6, 7], [7, 5], [5, 4], [0, 2], [2, 3], [1, 3]]


def box(low: float, high: float) -> list[list[float]]:
    return [[low, low], [high, low], [high, high], [low, high]]


def read(text: str | bytes, kind: str = "poly") -> Cloud:
    return liftmesh.read(
        io.BytesIO(text if isinstance(text, bytes) else text.encode()), format=kind
    )


def written(cloud: Any, kind: str = "poly") -> tuple[bytes, liftmesh.WriteResult]:
    stream = io.BytesIO()
    result = liftmesh.write(stream, cloud, format=kind)
    return stream.getvalue(), result


def read_as_triangle(data: bytes) -> dict[str, Any]:
    """Read a .poly file as the documentation says, and as triangle.c does, line by line."""
    lines = data.decode().split("\n")
    assert max(map(len, lines)) < 1023  # its buffer, with the line end
    rows = [[float(word) for word in line.split("#")[0].split()] for line in lines]
    rows = [row for row in rows if row]
    count, dimension, attributes, markers = map(int, rows.pop(0))
    assert dimension == 2
    points = np.array([rows.pop(0) for _ in range(count)])
    assert points.shape == (count, 3 + attributes + markers)
    assert points[:, 0].tolist() == [*range(count)]
    count, markers = map(int, rows.pop(0))
    segments = np.array([rows.pop(0) for _ in range(count)]).reshape(-1, 3 + markers)
    holes = np.array([rows.pop(0) for _ in range(int(rows.pop(0)[0]))]).reshape(-1, 3)
    regions = np.array([rows.pop(0) for _ in range(int(rows.pop(0)[0]))]) if rows else None
    assert not rows
    return {
        "points": points[:, 1:3],
        "attributes": points[:, 3 : 3 + attributes],
        "segments": segments[:, 1:],
        "holes": holes[:, 1:],
        "regions": regions,
    }


@pytest.mark.parametrize("kind", ["one", "zero", "beside", "compressed"])
def test_what_a_poly_file_says(kind: str, tmp_path: Path) -> None:
    text = BOX
    if kind == "zero":
        lines = (line.split("#")[0].split() for line in BOX.split("\n"))
        rows = [[float(word) for word in line] for line in lines if line]
        for row in rows[1:9]:
            row[0] -= 1
        for row in rows[10:18]:
            row[:3] = [each - 1 for each in row[:3]]
        text = "\n".join(" ".join(f"{each:g}" for each in row) for row in rows)
    if kind in ("beside", "compressed"):
        points, segments = BOX.split("# Five")
        (tmp_path / "box.node").write_text(points)
        text = f"0 2 1 1\n# Five{segments}"
    path = tmp_path / "box.poly"
    path.write_text(text)
    if kind == "compressed":
        path = tmp_path / "box.poly.gz"
        path.write_bytes(gzip.compress(text.encode()))
    cloud = liftmesh.read(path)
    assert cloud.points.tolist()[3:5] == [[3, 3, 0], [1, 1, 0]]
    assert cloud.attributes["attribute_1"].tolist() == [k + 0.5 for k in range(8)]
    assert cloud.attributes["boundary_marker"].tolist() == [5, 5, 0, 33, 0, 0, 0, 0]
    assert cloud.edges is not None
    assert cloud.edges.tolist() == EDGES
    assert cloud.metadata["holes"].tolist() == [[1.5, 1.5]]
    assert cloud.metadata["markers"].tolist() == [5, 0, 0, 10, 0, 0, 0, 0]
    assert "not_read" not in cloud.metadata
    assert "regions" not in cloud.metadata
    tri = constrained_delaunay(cloud.points[:, :2], cloud.edges, seeds=cloud.metadata["holes"])
    assert tri.nsimplex == 8


def test_regions_are_kept() -> None:
    text = BOX + "2\n1 0.5 0.5 7 0.25\n2 1.5 1.5 8 -1\n"
    cloud = read(text)
    assert cloud.metadata["regions"].tolist() == [[0.5, 0.5, 7, 0.25], [1.5, 1.5, 8, -1]]
    data, result = written(cloud)
    assert result.dropped == ()
    found = read_as_triangle(data)
    assert found["regions"].tolist() == [[0, 0.5, 0.5, 7, 0.25], [1, 1.5, 1.5, 8, -1]]
    assert found["holes"].tolist() == [[1.5, 1.5]]
    again = read(data)
    for name in ("holes", "regions"):
        np.testing.assert_array_equal(again.metadata[name], cloud.metadata[name])
    assert "metadata holes" in written(cloud, "ply")[1].dropped


@pytest.mark.parametrize(
    ("old", "new", "cause"),
    [
        ("8 2 1 1\n", "8 3 1 1\n", "line 4: expected 6 values, found 5"),
        ("8 2 1 1\n", "0 2 1 1\n", r"points are in a \.node file .* give a path"),
        ("1   1 2   5", "1   1 9   5", "edge 0 refers to vertex 8"),
        (
            "1   1 2   5",
            "1   1 2.5   5",
            "segment 1: an index or marker is 1.5, which is not int32",
        ),
        ("3.5  33", "3.5  3.5", "point 4: an index or marker is 3.5, which is not int32"),
        ("\n8 1\n", "\n9 1\n", "line 24: expected 4 values, found 1"),
        ("\n8 1\n", "\n7 1\n", "line 22: expected the numbers of holes, found '8 2 4 0'"),
        ("1   1.5 1.5\n", "", "the header promises 1 holes, but 0"),
        ("1   1.5 1.5\n", "1 1.5 1.5\n1\n", "promises 1 regions, but 0"),
        ("1   1.5 1.5\n", "1 1.5 1.5\n1\n1 2 3\n", "a region has x, y, an attribute and at most"),
        ("1   1.5 1.5\n", "1 1.5 1.5\n0\n0\n", "more rows follow"),
        ("1   1.5 1.5\n", "1 1.5 1.5\nx\n", "expected the numbers of regions, found 'x'"),
    ],
)
def test_what_is_wrong_is_named(old: str, new: str, cause: str) -> None:
    assert old in BOX
    with pytest.raises(FormatError, match=cause):
        read(BOX.replace(old, new, 1))


EXTREME = [5e-324, -0.0, 0.1, 1e308, -1 / 3, 2.0**-1074 * 3, 123456789.123456789, -1e-300]


@pytest.mark.parametrize("kind", ["node", "poly"])
@pytest.mark.parametrize("z", [0.0, -0.0, 7.25])
def test_every_bit_comes_back(kind: str, z: float) -> None:
    x = np.array(EXTREME)
    values = {
        "Höhe, \n#1": x[::-1].copy(),
        "z": np.arange(8.0),
        "vector": np.arange(16.0).reshape(8, 2) / 7,
        "boundary_marker": np.arange(-4, 4, dtype=np.int32),
    }
    edges = np.array([[7, 0], [3, 4], [3, 4]], np.int32)
    cloud = Cloud(np.c_[x, x[::-1], [z] * 8], attributes=values, edges=edges)
    data, result = written(cloud, kind)
    back = read(data, kind)
    assert result.dropped == (("edges",) if kind == "node" else ())
    assert back.points.tobytes() == cloud.points.tobytes()
    assert [*back.attributes] == ["Höhe, \n#1", "z", "vector_0", "vector_1", "boundary_marker"]
    assert back.attributes["z"].tobytes() == values["z"].tobytes()
    assert back.attributes["vector_1"].tolist() == values["vector"][:, 1].tolist()
    assert back.attributes["boundary_marker"].dtype == np.int32
    assert back.attributes["boundary_marker"].tolist() == values["boundary_marker"].tolist()
    assert written(back, kind)[0] == data
    if kind == "poly":
        assert np.array_equal(back.edges, edges)
        found = read_as_triangle(data)
        assert found["points"].tobytes() == cloud.points[:, :2].tobytes()
        assert found["segments"].tolist() == edges.tolist()
        assert found["attributes"].shape[1] == 4 + (z != 0 or np.signbit(z))
    assert (f"\n8 {2 if kind == 'poly' or z.hex() == '0x0.0p+0' else 3} " in data.decode()) is True


def test_names_that_do_not_fit_are_no_names() -> None:
    """Comments of others, and those of values that somebody has taken out."""
    rows = "2 2 1 0\n0 0 0 5\n1 1 1 6\n"
    for comments in (
        "",
        "# attribute 1\n",
        '# attribute "a"\n# attribute "b"\n',
        "# attribute [\n",
    ):
        assert [*read(comments + rows, "node").attributes] == ["attribute_1"]
    taken = '# attribute "boundary_marker"\n2 2 1 1\n0 0 0 5 1\n1 1 1 6 2\n'
    assert [*read(taken, "node").attributes] == ["attribute_1", "boundary_marker"]
    assert [*read('# attribute "a"\n' + rows, "node").attributes] == ["a"]
    assert read("# heights\n" + rows, "node").points[:, 2].tolist() == [5, 6]
    spatial = "# heights\n2 3 1 0\n0 0 0 5 8\n1 1 1 6 9\n"
    assert read(spatial, "node").points[:, 2].tolist() == [5, 6]
    assert read(spatial, "node").attributes["attribute_1"].tolist() == [8, 9]


@pytest.mark.parametrize("values", [[1.5, 1, 2], [2**40, 1, 2]])
def test_markers_that_are_none_are_values(values: list[float]) -> None:
    cloud = Cloud(np.eye(3), attributes={"a": np.arange(3.0), "boundary_marker": np.array(values)})
    back = read(written(cloud)[0])
    assert back.points.tolist() == cloud.points.tolist()
    assert back.attributes["a"].tolist() == [0, 1, 2]
    assert back.attributes["boundary_marker"].tolist() == values


@pytest.mark.parametrize(
    ("values", "cause"),
    [
        ({"a": np.array([0, np.nan, 1])}, "attribute 'a' is nan in row 1: .* finite values only"),
        ({"a": np.array(["x", "y", "z"])}, "attribute 'a' of type <U1"),
        ({"a" * 1000: np.zeros(3)}, "the name of attribute 'aaa.* is too long"),
    ],
)
@pytest.mark.parametrize("kind", ["node", "poly"])
def test_values_that_triangle_does_not_read_are_refused(kind: str, values: Any, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        written(Cloud(np.eye(3), attributes=values), kind)


@pytest.mark.parametrize(
    "holes", [18, [1.0, 2.0], [[1, 2, 3]], [[1, np.nan]], [["a", "b"]], [[1], []]]
)
def test_holes_that_are_no_points_are_refused(holes: Any) -> None:
    with pytest.raises(FormatError, match="metadata holes are no rows of 2 finite numbers"):
        written(Cloud(np.eye(3), metadata={"holes": holes}))


def test_what_is_not_kept_is_named() -> None:
    numbers = np.array([2**53 + 1, 0, 0])
    entries = {"survey": "2024", "holes": [[0.25, 0.5]], "regions": []}
    cloud = Cloud(np.eye(3), attributes={"a": numbers}, metadata=entries, crs="EPSG:25832")
    data, result = written(cloud)
    assert set(result.dropped) == {"crs", "metadata survey", "whole numbers of a beyond 2**53"}
    assert read_as_triangle(data)["holes"].tolist() == [[0.25, 0.5]]
    assert read_as_triangle(data)["regions"] is None


def as_sets(simplices: Any) -> set[tuple[int, ...]]:
    return set(map(tuple, np.sort(simplices, axis=1).tolist()))


def mesh_of(tri: liftmesh.ConstrainedTriangulation, **parts: Any) -> Cloud:
    points = np.c_[tri.points, np.zeros(tri.npoints)]
    return Cloud(points, **{"faces": tri.simplices, "edges": tri.constraints, **parts})


def blob(rng: np.random.Generator, corners: int, radius: float, x: float) -> Any:
    turn = np.sort(rng.random(corners)) * 2 * np.pi
    return np.c_[np.cos(turn), np.sin(turn)] * radius * rng.uniform(0.8, 1, (corners, 1)) + [x, 0]


@pytest.mark.parametrize("scale", [1.0, 1e-150, 1e307, 2.0**-1060])
def test_a_carved_mesh_has_a_point_in_each_hole(scale: float) -> None:
    """Lakes, an island with a lake of its own, ponds beside, and breaklines in a lake."""
    rng = np.random.default_rng(2)
    land = [blob(rng, 60, 2, 0), blob(rng, 20, 1, -0.4), blob(rng, 9, 0.3, 1.2)]
    island = [blob(rng, 12, 0.5, -0.4), blob(rng, 6, 0.2, -0.4)]
    beside = [blob(rng, 25, 1, 4), blob(rng, 5, 0.4, 4)]
    polygons = [[ring * scale for ring in each] for each in (land, island, beside)]
    lines = [blob(rng, 30, 0.7, -0.4)[[*range(30), 0]] * scale]
    points = rng.uniform(-2, 5, (300, 2)) * scale
    options: dict[str, Any] = {"carve": "holes", "crossing": "split"}
    tri = constrained_delaunay(points, polygons=polygons, polylines=lines, **options)
    data, result = written(mesh_of(tri))
    assert result.dropped == ("faces",)
    found = read_as_triangle(data)
    assert len(found["holes"]) == 5  # the lake with the breakline is two for Triangle
    assert (tri.find_simplex(found["holes"]) == -1).all()
    # As Triangle carves: from outside, and from holes, up to segments.
    back = constrained_delaunay(
        found["points"], found["segments"].astype(int), carve="outside", seeds=found["holes"]
    )
    assert as_sets(back.simplices) == as_sets(tri.simplices)


def test_regions_at_the_hull_need_points_if_others_there_are_left() -> None:
    ring = box(0, 16)
    divided = [*FRAME, *ring]
    edges = [[4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
    tri = constrained_delaunay(divided, edges, seeds=[[8, -1]])
    (hole,) = read_as_triangle(written(mesh_of(tri))[0])["holes"].tolist()
    assert tri.find_simplex(hole) == -1
    carved = constrained_delaunay(divided, edges[:4], carve="outside")
    assert len(read_as_triangle(written(mesh_of(carved))[0])["holes"]) == 0


def test_meshes_that_edges_do_not_make_have_no_holes() -> None:
    points, edges = box(0, 2), [[0, 1], [1, 2], [2, 3], [3, 0]]
    whole = constrained_delaunay([*points, [1, 1]], edges)
    other = mesh_of(whole, faces=np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    part = mesh_of(whole, faces=whole.simplices[1:])
    crossed = mesh_of(whole, edges=np.array([[0, 2], [1, 3], [0, 1]], np.int32)[:2])
    unbound = mesh_of(whole, edges=None)
    flat = Cloud(
        np.eye(1, 3).repeat(3, 0), faces=np.array([[0, 1, 2]]), edges=np.zeros((1, 2), int)
    )
    for mesh in (mesh_of(whole), other, part, crossed, unbound, flat):
        data, result = written(mesh)
        assert len(read_as_triangle(data)["holes"]) == 0
        lost = "holes between faces" in result.dropped
        assert lost == any(mesh is each for each in (other, flat))
    for mesh, carved, is_lost in ((part, True, False), (other, True, True), (part, "oak", True)):
        result = written(replace(mesh, metadata={"carved": carved}))[1]
        assert ("metadata carved" in result.dropped) == is_lost


def test_a_hole_that_is_stated_gets_no_second_point() -> None:
    polygons = [[box(0, 9), box(1, 3), box(5, 7)]]
    tri = constrained_delaunay([], polygons=polygons, carve="holes")
    for stated, count in (([[1.5, 2.75]], 2), ([[1.5, 2.75], [6.5, 5.25]], 2), ([[99, 99]], 3)):
        holes = read_as_triangle(written(mesh_of(tri, metadata={"holes": stated}))[0])["holes"]
        assert (len(holes), holes[: len(stated)].tolist()) == (count, stated)


def test_faces_of_later_rows_at_a_position_are_found() -> None:
    rows = [*box(0, 3), *box(0, 3), *box(1, 2)]
    tri = constrained_delaunay(rows, polygons=[[box(0, 3), box(1, 2)]], carve="holes")
    names = np.arange(12, dtype=np.int32)
    names[:4] += 4
    mesh = mesh_of(tri, faces=names[tri.simplices])
    assert read_as_triangle(written(mesh)[0])["holes"].shape == (1, 2)


def test_a_hole_too_narrow_for_a_point_is_refused() -> None:
    up = np.nextafter(1.0, 2)
    slit = [[1, 1], [up, 1], [up, up]]
    tri = constrained_delaunay(FRAME, polygons=[[box(0, 3), slit]], carve="holes")
    with pytest.raises(FormatError, match=r"the hole at rows \[8, 9, 10\] is too narrow"):
        written(mesh_of(tri))
