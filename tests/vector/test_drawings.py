"""Lines of DXF and OBJ files."""

from __future__ import annotations

from pathlib import Path

import ezdxf
import numpy as np
import pytest

import liftmesh
from liftmesh.errors import FormatError
from liftmesh.vector.drawings import read_dxf
from liftmesh.vector.files import lines_of
from liftmesh.vector.polygons import areas_in, lines_in

CORNERS = [(0.1, 0.2), (3.0, 1 / 3), (2.5, 7.0)]


def drawing(path: Path) -> ezdxf.document.Drawing:
    made = ezdxf.new()
    space = made.modelspace()
    space.add_line((0.1, 0.3, 5), (1.1, 0.7, 6))
    space.add_lwpolyline(CORNERS, close=True)
    space.add_polyline3d([(0, 0, 1), (2, 2, 5), (3, 2, 5)])
    space.add_text("not a line")
    space.add_point((1, 2))
    block = made.blocks.new("symbol")
    block.add_line((0, 0), (1, 0))
    space.add_blockref("symbol", (10, 10))
    made.saveas(path)
    return made


def test_straight_lines_keep_every_bit(tmp_path: Path) -> None:
    path = tmp_path / "plan.DXF"
    drawing(path)
    lines = lines_in(path)
    assert lines is not None
    assert [line.tolist() for line in lines] == [
        [[0.1, 0.3], [1.1, 0.7]],
        [list(corner) for corner in (*CORNERS, CORNERS[0])],
        [[0, 0], [2, 2], [3, 2]],
        [[10, 10], [11, 10]],
    ]
    areas = areas_in(path)
    assert areas is not None
    (((ring,),), is_unsaid) = areas
    assert is_unsaid
    assert ring.tolist() == lines[1].tolist()
    assert len(lines_of(path, None)) == 4


def test_curves_become_chords(tmp_path: Path) -> None:
    made = ezdxf.new()
    made.modelspace().add_circle((5, 5), 2)
    made.modelspace().add_lwpolyline([(0, 0, 1), (1, 0, 0)], format="xyb")
    made.saveas(tmp_path / "round.dxf")
    circle, arc = lines_in(tmp_path / "round.dxf") or ()
    np.testing.assert_allclose(np.hypot(*(circle - 5).T), 2, rtol=1e-3)
    assert len(circle) > 60
    assert circle[0].tolist() == circle[-1].tolist()
    np.testing.assert_allclose(np.hypot(*(arc - [0.5, 0]).T), 0.5, rtol=1e-3)


def test_nested_curves_are_holes_and_islands(tmp_path: Path) -> None:
    made = ezdxf.new()
    for k in (0, 1, 2):
        low, high = k, 9 - k
        corners = [(low, low), (high, low), (high, high), (low, high)]
        made.modelspace().add_lwpolyline(corners[:: 1 - 2 * (k % 2)], close=True)
    made.modelspace().add_line((0, 0), (9, 9))
    made.saveas(tmp_path / "lakes.dxf")
    tri = liftmesh.constrained_delaunay(
        [[-1, -1], [20, -1], [-1, 20]], polygons=tmp_path / "lakes.dxf", carve="holes"
    )
    found = tri.find_simplex([[-0.5, 0], [0.5, 4], [1.5, 4], [4, 4.5]]) >= 0
    assert found.tolist() == [False, True, False, True]


@pytest.mark.parametrize(
    "text", ["", "no drawing", "  0\nSECTION\n  2\nENTITIES\n  0\nLINE\n", "0\nSECTION\n2\nX\n1e\n"]
)
def test_damaged_drawings_are_named(text: str, tmp_path: Path) -> None:
    (tmp_path / "bad.dxf").write_text(text)
    with pytest.raises(liftmesh.FormatError, match=r"bad.dxf: "):
        lines_in(tmp_path / "bad.dxf")
    with pytest.raises(FileNotFoundError):
        lines_in(tmp_path / "missing.dxf")


def test_lines_of_obj(tmp_path: Path) -> None:
    path = tmp_path / "lines.obj"
    path.write_text(
        "# lines\nv 0.1 0 7\nv 1 0.3 7 1.0\nf 1 2 1\nv 1 1 0\nl 1 2 \\\n 3 # here\nl -1/4 -3/5\n"
        "l 1\nl 1 2 3 1\nusemtl x\n"
    )
    lines = lines_in(path)
    assert lines is not None
    assert [line.tolist() for line in lines] == [
        [[0.1, 0], [1, 0.3], [1, 1]],
        [[1, 1], [0.1, 0]],
        [[0.1, 0], [1, 0.3], [1, 1], [0.1, 0]],
    ]
    tri = liftmesh.constrained_delaunay([[-1, -1], [4, 0], [0, 4]], polygons=path, carve="outside")
    assert tri.nsimplex == 1


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("l 1 4", "line 4: 'l 1 4' cannot be read: vertex 4 of 2"),
        ("l 1 -3", "vertex -3 of 2"),
        ("l 0 1", "vertex 0 of 2"),
        ("l 1 x", "line 4"),
        ("v 1", "line 4"),
        ("v 1 nan\nl 1 3", "a corner of a line is not finite"),
        ("f 1 2 1", "there is no line in what is given"),
    ],
)
def test_wrong_lines_of_obj_are_named(line: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.obj"
    path.write_text(f"v 0 0 0\nv 1 0 0\n\n{line}\n")
    with pytest.raises(liftmesh.FormatError, match=f"wrong.obj: .*{said}"):
        lines_in(path)


def nested(depth: int, times: int, leaf: str, placed: str = "") -> str:
    """Blocks, each of which holds the next one so many times; the first is inserted."""
    insert = "0\nINSERT\n8\n0\n2\nB{}\n10\n0\n20\n0\n"
    blocks = [insert.format(k + 1) * times for k in range(depth - 1)] + [leaf]
    texts = (f"0\nBLOCK\n2\nB{k}\n70\n0\n{each}0\nENDBLK\n" for k, each in enumerate(blocks))
    version = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n0\nENDSEC\n"
    body = f"0\nSECTION\n2\nBLOCKS\n{''.join(texts)}0\nENDSEC\n"
    end = f"0\nSECTION\n2\nENTITIES\n{insert.format(0)}{placed}0\nENDSEC\n0\nEOF\n"
    return version + body + end


A_LINE = "0\nLINE\n8\n0\n10\n0\n20\n0\n11\n1\n21\n1\n"
BOMBS = {
    "blocks in blocks": (nested(9, 10, A_LINE), "its blocks expand to .* entities, more than"),
    "blocks of nothing": (nested(20, 10, ""), "its blocks expand to .* entities, more than"),
    "an array": (
        nested(1, 1, A_LINE, "70\n30000\n71\n30000\n44\n1\n45\n1\n"),
        "its blocks expand to 900,000,001 entities, more than 20,0",
    ),
    "a block in itself": (nested(2, 1, "0\nINSERT\n2\nB0\n10\n0\n20\n0\n"), "hold each other"),
    "a curve without end": (
        nested(1, 1, A_LINE, "0\nCIRCLE\n10\n0\n20\n0\n40\n1e308\n"),
        "a CIRCLE is beyond 1e.100, or not finite",
    ),
}


@pytest.mark.parametrize("case", BOMBS)
def test_few_bytes_do_not_become_very_many_lines(case: str, tmp_path: Path) -> None:
    text, cause = BOMBS[case]
    path = tmp_path / "a.dxf"
    path.write_text(text)
    with pytest.raises(FormatError, match=cause):
        read_dxf(path)
    path.write_text(nested(3, 5, A_LINE))
    assert len(read_dxf(path)["coordinates"]) == 25
