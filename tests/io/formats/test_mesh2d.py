"""2DM: meshes of SMS, with materials and nodestrings."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from file_samples import assert_same_mesh
from surfaces import hills

import liftmesh
from liftmesh import Cloud, FormatError

MESH = """MESH2D
MESHNAME "a mesh"
NUM_MATERIALS_PER_ELEM 1
E3T 1 10 20 40 1
E4Q 2 10 20 40 30 2
E3T 3 30 20 10
ND 10 0.0e+000 0 5
ND 30 0 1 7
ND 20 1 0 6
ND 40 1 1 8
NS 10 20
NS -40 3
NS 30 -10 7
BEGPARAMDEF
GM "Mesh"
"""


def loaded(text: str | bytes) -> Cloud:
    data = text.encode() if isinstance(text, str) else text
    return liftmesh.read(io.BytesIO(data), format="2dm")


def words_of(data: bytes) -> dict[str, list[list[str]]]:
    """Read the words of each card: this is all there is to the format."""
    found: dict[str, list[list[str]]] = {}
    for line in data.decode().splitlines():
        card, *words = line.split()
        found.setdefault(card, []).append(words)
    return found


def test_elements_name_nodes_by_their_numbers() -> None:
    found = loaded(MESH)
    assert found.points.tolist() == [[0, 0, 5], [0, 1, 7], [1, 0, 6], [1, 1, 8]]
    assert found.faces is not None
    assert found.faces.tolist() == [[0, 2, 3], [1, 2, 0], [0, 2, 3], [0, 3, 1]]
    assert found.edges is not None
    assert found.edges.tolist() == [[0, 2], [2, 3], [1, 0]]
    assert found.metadata["markers"].tolist() == [3, 3, 7]
    assert found.metadata["not_read"] == ("2 further materials", "1 line BEGPARAMDEF", "1 line GM")
    assert "markers" not in loaded(MESH.replace("-10 7", "-10")).metadata


BAD = {
    "no mesh": ("MESH3D\n", "not a 2DM file, which begins with MESH2D"),
    "no nodes": ("MESH2D\n", r"no nodes \(ND\)"),
    "a node twice": (MESH.replace("ND 30", "ND 10"), "two nodes have the number 10"),
    "half a node": (MESH.replace("ND 30", "ND 3.5"), "a number of a node: 3.5 is not an index"),
    "a short node": (MESH.replace("ND 30 0", "ND 30"), "line 8: ND has 3 numbers: expected a num"),
    "no number": (MESH.replace("0 1 7", "0 b 7"), "line 8, value 3: 'b' is not a number"),
    "no such node": (MESH.replace("20 40 1", "20 41 1"), "line 4: the node 41 is not there"),
    "a short element": (MESH.replace("3 30 20 10", "3 30 20"), "line 6: E3T has 3 numbers"),
    "quadratic": (MESH.replace("E3T 3", "E6T 3"), "line 6: .* is an element that is not read"),
    "an empty card": (MESH.replace("NS -40 3", "NS"), "line 12: 'NS' is without numbers"),
    "no end": (MESH.replace("-10 7", "10"), "line 13: a string without a negative end"),
    "a string beyond": (MESH.replace("NS 30", "NS 31"), "line 13: the node 31 is not there"),
    "a node beyond": (MESH.replace("ND 30", f"ND {2**63}"), "e.18 is not an index"),
    "a marker": (MESH.replace("-10 7", "-10 7000000000"), "7000000000 is not an index"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_name_the_line(case: str) -> None:
    text, cause = BAD[case]
    with pytest.raises(FormatError, match=cause):
        loaded(text)


def test_what_is_written_comes_back(tmp_path: Path) -> None:
    frame = np.array([[0, 0], [9, 0], [9, 6], [0, 6]], np.float64)
    lines = {"polygons": [frame], "polylines": [np.array([[6.0, 0], [6, 6]])]}
    tri = liftmesh.refine(liftmesh.constrained_delaunay([], **lines), max_area=0.5).triangulation
    liftmesh.write(tmp_path / "a.2dm", tri)
    found = words_of((tmp_path / "a.2dm").read_bytes())
    nodes = np.array(found["ND"])
    assert np.array_equal(nodes[:, 1:3].astype(float), tri.points)
    elements = np.array(found["E3T"], int)
    assert np.array_equal(elements[:, 1:4] - 1, tri.simplices)
    assert np.array_equal(elements[:, 4] - 1, tri.regions)
    strings = " ".join(" ".join(each) for each in found["NS"]).split()
    assert [word for word in strings if word.startswith("-")] == ["-1", "-2"] or len(strings) > 4
    back = liftmesh.read(tmp_path / "a.2dm")
    assert back.edges is not None
    pairs = {frozenset(each) for each in tri.constraints.tolist()}
    assert {frozenset(each) for each in back.edges.tolist()} == pairs
    assert {*back.metadata["markers"].tolist()} == {1, 2}
    liftmesh.write(tmp_path / "b.2dm", back)
    assert (tmp_path / "a.2dm").read_bytes() == (tmp_path / "b.2dm").read_bytes()


def test_surfaces_keep_every_bit(tmp_path: Path) -> None:
    hill = liftmesh.triangulate(hills() / 3).to_cloud()
    written = liftmesh.write(tmp_path / "a.2dm", replace(hill, crs="EPSG:25832"))
    assert written.dropped == ("crs",)
    assert_same_mesh(liftmesh.read(tmp_path / "a.2dm"), hill)


def test_strings_end_where_lines_meet_and_negative_markers_are_refused() -> None:
    mesh = Cloud(np.zeros((6, 3)), faces=np.array([[0, 1, 2]], np.int32))
    star = np.array([[0, 1], [2, 0], [0, 3], [4, 5], [5, 4]], np.int32)
    stream = io.BytesIO()
    marked = replace(mesh, edges=star, metadata={"markers": [4, 4, 4, 9, 9]})
    liftmesh.write(stream, marked, format="2dm")
    assert words_of(stream.getvalue())["NS"] == [
        ["1", "-2", "4"],
        ["1", "-3", "4"],
        ["1", "-4", "4"],
        ["5", "6", "-5", "9"],
    ]
    negative = replace(marked, metadata={"markers": [4, -1, 4, 9, 9]})
    with pytest.raises(FormatError, match="the marker of edge 1 is -1, but markers of 2DM are"):
        liftmesh.write(io.BytesIO(), negative, format="2dm")
