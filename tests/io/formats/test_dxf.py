"""DXF: surfaces, lines and points of drawings, as ezdxf writes and reads them."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from commands import liftmesh as command
from surfaces import hills

import liftmesh
from liftmesh import Cloud, FormatError

SQUARE = [(0, 0, 1), (8, 0, 2), (8, 8, 3), (0, 8, 4)]
FACES = [[(0, 0, 1), (8, 0, 2), (8, 8, 3)], [(0, 0, 1), (8, 8, 3), (0, 8, 4)]]


def drawing(version: str = "R2010") -> tuple[Any, Any]:
    made = ezdxf.new(version)
    return made, made.modelspace()


def loaded(made: Any) -> Cloud:
    if isinstance(made, str):
        return liftmesh.read(io.BytesIO(made.encode()), format="dxf")
    stream = io.StringIO()
    made.write(stream)
    return liftmesh.read(io.BytesIO(stream.getvalue().encode()), format="dxf")


def corners_of(cloud: Cloud, rows: Any) -> list[Any]:
    return cloud.points[rows].tolist()  # type: ignore[no-any-return]


@pytest.mark.parametrize("version", ["R12", "R2000", "R2018"])
def test_faces_of_every_kind(version: str) -> None:
    made, space = drawing(version)
    for each in FACES:
        space.add_3dface(each)
    space.add_3dface(SQUARE)
    space.add_polyface().append_faces([SQUARE, SQUARE[:3]])
    found = loaded(made)
    assert found.faces is not None
    assert found.points.tolist() == [[0, 0, 1], [8, 0, 2], [8, 8, 3], [0, 8, 4]]
    two = [[0, 1, 2], [0, 2, 3]]
    assert found.faces.tolist() == [*two, *two, *two, [0, 1, 2]]
    assert found.edges is None
    assert "not_read" not in found.metadata


def test_lines_are_edges_and_points_are_rows() -> None:
    made, space = drawing()
    space.add_point((1, 2, 3))
    space.add_point((1, 2, 3))
    space.add_line((0, 0, 0), (1, 1, 1))
    space.add_polyline3d([(1, 1, 1), (5, 5, 5), (7, 7, 7)], close=True)
    space.add_polyline2d([(3, 3), (4, 4)], dxfattribs={"elevation": (0, 0, 8)})
    space.add_lwpolyline([(0, 0), (2, 2, 0, 0, 0.5), (9, 9)], dxfattribs={"elevation": 4})
    found = loaded(made)
    assert found.faces is None
    assert found.edges is not None
    assert found.points[:2].tolist() == [[1, 2, 3], [1, 2, 3]]
    assert corners_of(found, found.edges) == [
        [[0, 0, 0], [1, 1, 1]],
        [[1, 1, 1], [5, 5, 5]],
        [[5, 5, 5], [7, 7, 7]],
        [[7, 7, 7], [1, 1, 1]],
        [[3, 3, 8], [4, 4, 8]],
        [[0, 0, 4], [2, 2, 4]],
        [[2, 2, 4], [9, 9, 4]],
    ]
    assert found.metadata["not_read"] == ("1 arc",)


def test_what_is_left_out_is_counted() -> None:
    made, space = drawing()
    space.add_point((1, 2, 3))
    space.add_circle((0, 0), 5)
    space.add_polymesh((3, 3))
    space.add_lwpolyline([(0, 0), (2, 2)], dxfattribs={"extrusion": (1, 0, 0)})
    made.blocks.new("tree").add_line((0, 0), (1, 1))
    space.add_blockref("tree", (5, 5))
    found = loaded(made)
    assert found.points.tolist() == [[1, 2, 3]]
    assert found.metadata["not_read"] == (
        "1 CIRCLE",
        "1 POLYLINE grid",
        "1 turned LWPOLYLINE",
        "1 INSERT",
    )


def entities(text: str, end: str = "0\nENDSEC\n0\nEOF\n") -> str:
    return f"0\nSECTION\n2\nENTITIES\n{text}{end}"


POINT = "0\nPOINT\n8\n0\n10\n1\n20\n2\n30\n3\n"
FACE = (
    "0\nPOLYLINE\n70\n64\n0\nVERTEX\n70\n192\n10\n1\n20\n2\n30\n3\n0\nVERTEX\n70\n128\n71\n1\n72\n"
    "-2\n73\n1\n0\nSEQEND\n"
)
BAD = {
    "no text of pairs": ("abc\ndef\n", "line 1: 'abc' is no code of DXF"),
    "binary": ("AutoCAD Binary DXF\r\n\x1a\0\0\n\n", "binary DXF is not read: save it as text"),
    "nothing": (entities(""), "no faces, lines and points in it"),
    "another section": (entities(POINT).replace("ENTITIES", "BLOCKS"), "no faces, lines"),
    "cut off": (entities(POINT, end=""), "it ends within a POINT: it is cut off"),
    "no number": (entities(POINT.replace("\n2\n", "\nb\n")), "line 12: 'b' is not a number"),
    "an underscore": (entities(POINT.replace("\n2\n", "\n1_2\n")), "'1_2' is not a number"),
    "no y": (entities(POINT.replace("20\n2\n", "")), r"line 6: an entity without x and y \(codes"),
    "an odd line": (entities(POINT + "x\n"), "line 15: 'x' is no code of DXF"),
    "no vertex": (entities(FACE), "a face of a polyface mesh names vertex 2 of 1"),
    "half a corner": (
        entities("0\nLWPOLYLINE\n10\n1\n20\n1\n10\n2\n"),
        "line 6: LWPOLYLINE has 2 x and 1 y",
    ),
    "an endless line": ("0\nSECTION\n2\n" + "a" * 3_000_000, "a line of more than 1,048,576 bytes"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_name_the_line(case: str) -> None:
    text, cause = BAD[case]
    with pytest.raises(FormatError, match=cause):
        loaded(text)


def test_polylines_seen_from_below_are_mirrored() -> None:
    """Of plane entities x, y and elevation are in a system of their own: here that of -z."""
    made, space = drawing()
    below = {"extrusion": (0, 0, -1)}
    space.add_lwpolyline([(1, 2), (3, 5)], dxfattribs={**below, "elevation": 7})
    space.add_polyline2d([(1, 2), (4, 5)], dxfattribs={**below, "elevation": (0, 0, 7)})
    space.add_line((1, 2, 3), (3, 5, 3), dxfattribs=below)  # in that of the world, as all lines
    found = loaded(made)
    expected = [[*each.ocs().to_wcs((1, 2, 7))] for each in space.query("LWPOLYLINE")]
    assert found.points[0].tolist() == expected[0] == [-1, 2, -7]
    ends = [[[-1, 2, -7], [-3, 5, -7]], [[-1, 2, -7], [-4, 5, -7]], [[1, 2, 3], [3, 5, 3]]]
    assert corners_of(found, found.edges) == ends


def test_turned_polylines_are_left_out_but_for_those_in_space() -> None:
    head = "0\nPOLYLINE\n70\n{}\n30\n0\n210\n1\n"
    rest = "".join(f"0\nVERTEX\n10\n{x}\n20\n0\n30\n5\n" for x in (1, 2)) + "0\nSEQEND\n"
    for flags in (8, 9):
        found = loaded(entities(head.format(flags) + rest))
        assert corners_of(found, found.edges)[0] == [[1, 0, 5], [2, 0, 5]]
    found = loaded(entities(head.format(0) + rest + POINT))
    assert (len(found), found.metadata["not_read"]) == (1, ("1 turned POLYLINE",))


def test_polylines_without_an_end_are_kept() -> None:
    """SEQEND may be missing, and other entities may stand between the vertices and it."""
    vertex = "0\nVERTEX\n10\n{}\n20\n0\n30\n5\n"
    line = "0\nPOLYLINE\n70\n8\n" + vertex.format(1) + vertex.format(2)
    for text in (line, line + POINT, line + "0\nLINE\n10\n8\n20\n8\n11\n9\n21\n9\n0\nSEQEND\n"):
        found = loaded(entities(text))
        assert corners_of(found, found.edges)[0] == [[1, 0, 5], [2, 0, 5]]


def test_what_is_on_paper_and_frames_of_splines_are_left_out() -> None:
    made, space = drawing()
    made.layout("Layout1").add_line((0, 0), (297, 210))
    space.add_line((0, 0), (1, 1))
    found = loaded(made)
    assert len(found.edges) == 1
    title = "0\nLINE\n67\n1\n10\n0\n20\n0\n11\n297\n21\n210\n"
    sheet = "0\nPOLYLINE\n67\n1\n70\n8\n0\nVERTEX\n67\n1\n10\n1\n20\n0\n0\nSEQEND\n67\n1\n"
    found = loaded(entities(title + sheet + POINT))
    assert found.points.tolist() == [[1, 2, 3]]
    assert found.metadata["not_read"] == ("1 paper LINE", "1 paper POLYLINE")
    vertex = "0\nVERTEX\n10\n{}\n20\n0\n70\n{}\n"
    spline = "0\nPOLYLINE\n70\n4\n" + vertex.format(9, 16) + vertex.format(1, 8)
    found = loaded(entities(spline + vertex.format(2, 8) + "0\nSEQEND\n"))
    assert corners_of(found, found.edges) == [[[1, 0, 0], [2, 0, 0]]]
    with pytest.raises(FormatError, match=r"no faces, lines and points in it, but 2 INSERTs"):
        loaded(entities("0\nINSERT\n2\na\n" * 2))


def test_line_ends_and_blanks() -> None:
    for text in (entities(POINT).replace("\n", "\r\n"), entities(POINT).replace("10\n", " 10\n")):
        assert loaded(text).points.tolist() == [[1, 2, 3]]


def test_ezdxf_reads_what_is_written(tmp_path: Path) -> None:
    hill = liftmesh.triangulate(hills() / 3)
    mesh = replace(hill.to_cloud(), edges=hill.faces[:9, :2])
    written = liftmesh.write(tmp_path / "a.dxf", mesh)
    assert written.dropped == ()
    made = ezdxf.readfile(tmp_path / "a.dxf")
    assert made.audit().errors == []
    kinds = ("vtx0", "vtx1", "vtx2", "vtx3")
    found = [[tuple(face.dxf.get(each)) for each in kinds] for face in made.query("3DFACE")]
    assert np.array_equal(found, mesh.points[hill.faces[:, [0, 1, 2, 2]]])
    lines = [(tuple(line.dxf.start), tuple(line.dxf.end)) for line in made.query("LINE")]
    assert np.array_equal(lines, mesh.points[mesh.edges])
    back = liftmesh.read(tmp_path / "a.dxf")
    assert back.faces is not None
    assert np.array_equal(back.points[back.faces], mesh.points[hill.faces])
    surface = liftmesh.as_surface(tmp_path / "a.dxf")
    assert len(surface.faces) == len(hill.faces)
    assert (
        "rows in no face"
        in liftmesh.write(
            tmp_path / "b.dxf", Cloud(np.zeros((4, 3)), faces=np.array([[0, 1, 2]]))
        ).dropped
    )


def test_rows_of_edges_alone_are_held(tmp_path: Path) -> None:
    rows = np.array([[0, 0, 5], [4, 0, 6], [0, 4, 7], [9, 9, 9.0]])
    mesh = Cloud(rows, faces=np.array([[0, 1, 2]]), edges=np.array([[0, 3]]))
    assert liftmesh.write(tmp_path / "a.dxf", mesh).dropped == ()
    assert liftmesh.read(tmp_path / "a.dxf").points.tolist() == rows.tolist()
    rows[3, 2] = np.nan
    with pytest.raises(FormatError, match=r"vertex 3 is .*nan.*: dxf holds finite coordinates"):
        liftmesh.write(tmp_path / "b.dxf", mesh)
    assert not (tmp_path / "b.dxf").exists()


def test_a_drawing_becomes_a_surface(tmp_path: Path) -> None:
    made, space = drawing()
    for each in SQUARE:
        space.add_point(each)
    made.saveas(tmp_path / "survey.dxf")
    done = command("triangulate", "survey.dxf", "tin.dxf", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert len(ezdxf.readfile(tmp_path / "tin.dxf").query("3DFACE")) == 2
