"""STL: binary or text, sizes that lie, text line by line, equal corners merged."""

from __future__ import annotations

import io
import logging
import math
import struct
import tracemalloc

import numpy as np
import pytest
import trimesh
from file_samples import loaded, saved, small_mesh

import liftmesh
from liftmesh import Cloud, FormatError
from liftmesh.io.formats import stl

TEXT = """solid a thing
  facet normal 0 0 1
    outer loop
      vertex 0 0 0.1
      vertex 1 0 0
      vertex 0 1 1e-300
    endloop
  endfacet
endsolid a thing
"""
CORNERS = [[0, 0, 0.1], [1, 0, 0], [0, 1, 1e-300]]


def binary(
    corners: np.ndarray, *, title: bytes = b"", count: int | None = None, mark: int = 0
) -> bytes:
    """Pack triangles."""
    stated = len(corners) if count is None else count
    facets = [struct.pack("<3f9fH", 0, 0, 0, *triangle.ravel(), mark) for triangle in corners]
    return struct.pack("<80sI", title, stated) + b"".join(facets)


def random_corners(count: int = 50) -> np.ndarray:
    """Make triangles among few positions, zeros of both signs among them."""
    rng = np.random.default_rng(5)
    places = rng.choice(np.array([-0.0, 0.0, 1.5, -2.25, 1e-30]), (count, 3, 3))
    return places.astype(np.float32)


def first_appearances(corners: np.ndarray) -> tuple[list[list[float]], list[int]]:
    """Merge equal corners one by one; NaN equals nothing."""
    kept: list[list[float]] = []
    place: dict[tuple[float, ...], int] = {}
    rows = []
    for corner in corners.reshape(-1, 3).astype(np.float64).tolist():
        known = place.get(tuple(corner))
        if known is None or any(map(math.isnan, corner)):
            known = place[tuple(corner)] = len(kept)
            kept.append(corner)
        rows.append(known)
    return kept, rows


@pytest.mark.parametrize("title", [b"", b"solid", b"solid of binary facets" + b" " * 40])
def test_a_title_of_any_words_is_binary_if_the_size_fits(title: bytes) -> None:
    back = loaded(binary(random_corners(), title=title), "stl")
    assert back.faces is not None
    np.testing.assert_array_equal(back.points[back.faces], random_corners())


@pytest.mark.parametrize("title", [b"", b"solid", b" Solid \x01"])
@pytest.mark.parametrize("count", [0, 1, 49, 51, 2**31, 2**32 - 1])
def test_a_count_that_lies_is_told_in_bytes(title: bytes, count: int) -> None:
    data = binary(random_corners(), title=title, count=count)
    cause = f"byte 80: {count} facets would take {84 + 50 * count} bytes, but the file has 2584"
    with pytest.raises(FormatError, match=cause):
        loaded(data, "stl")


@pytest.mark.parametrize("change", [-50, -1, 1, 50])
def test_bytes_that_are_missing_or_follow(change: int) -> None:
    data = binary(random_corners())
    data = data[:change] if change < 0 else data + bytes(change)
    with pytest.raises(FormatError, match=f"50 facets would take 2584 bytes.* {2584 + change}:"):
        loaded(data, "stl")


@pytest.mark.parametrize("data", [b"\xff\xfe\x80solid", b"facet", b"\0" * 83])
def test_short_files_that_are_neither(data: bytes) -> None:
    with pytest.raises(FormatError, match=f"its {len(data)} bytes are neither text that begins"):
        loaded(data, "stl")


def test_attribute_bytes_are_told() -> None:
    assert "not_read" not in loaded(binary(random_corners()), "stl").metadata
    marked = loaded(binary(random_corners(), mark=7), "stl")
    assert marked.metadata["not_read"] == ("attribute bytes of 50 facets",)


@pytest.mark.parametrize(
    "text",
    [
        TEXT,
        TEXT.upper(),
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n", "\n\n"),
        TEXT.replace(" ", " \t "),
        "\ufeff" + TEXT,
        "\n \n" + TEXT,
        TEXT.removesuffix("\n"),
        TEXT.replace(" a thing", ""),
        TEXT.replace("a thing", "von Müller"),
        TEXT.replace("0 0 1\n", "nan -nan inf\n"),
        TEXT.replace("\n", "\n" + " " * 100),
        TEXT.replace("0 0 1\n", "-nan(ind) -nan(ind) -nan(ind)\n"),
        TEXT.replace("0 0 1\n", "1.#QNAN -1.#IND 0\n"),
        TEXT.replace("0 0 1\n", "0 0\n"),
        TEXT.replace(" 0 0 1\n", "\n"),
        TEXT.replace(" normal 0 0 1\n", "\n"),
        TEXT.replace("normal 0 0 1\n", "\n"),
        TEXT.replace("normal ", ""),
        TEXT.replace("endf", "end f").replace("endl", "end  l").replace("ends", "end\ts"),
        TEXT.replace("endf", "END F").replace("endl", "End L").replace("ends", "END S"),
        TEXT + "\0" * 300,
        TEXT + "\x1a",
        TEXT + "\n\x1a\0\0\n\0",
        TEXT.removesuffix(" a thing\n") + "\0\0",
        TEXT.removesuffix("\n") + "\x1a",
        "# made by hand\n" + TEXT,
        "; made by hand\n;\n" + TEXT,
        "\ufeff# made by hand\n" + TEXT,
        "#" * 1000 + "\n" + TEXT,
        TEXT.replace("\n", "\n # more\n;\n"),
        TEXT.replace("1 0 0\n", "1 0 0 # a corner\n"),
        TEXT.replace(" a thing", " colour; color #3"),
        TEXT.removesuffix("endsolid a thing\n") + "solid b\nendsolid b\n",
        "solid b\n" + TEXT,
    ],
)
def test_text_in_many_styles(text: str) -> None:
    back = loaded(text.encode(), "stl")
    assert back.points.tolist() == CORNERS
    assert back.faces is not None
    assert back.faces.tolist() == [[0, 1, 2]]
    assert "not_read" not in back.metadata


@pytest.mark.parametrize("color", ["color 1 0 0", "COLOR\t1 0 0", "color"])
def test_colours_are_told(color: str, monkeypatch: pytest.MonkeyPatch) -> None:
    text = TEXT.replace("\n", f"\n  {color}\n") * 5
    for size in (1, 4, 1 << 17):
        monkeypatch.setattr("liftmesh.io.formats.stl.BLOCK", size)
        back = loaded(text.encode(), "stl")
        assert back.points.tolist() == CORNERS
        assert back.metadata["not_read"] == ("45 lines of colours",)
    with pytest.raises(FormatError, match="line 2: 'colors', where 'solid' should be"):
        loaded(b"#\ncolors\n", "stl")


def test_solids_without_an_end_are_joined() -> None:
    begun = TEXT.removesuffix("endsolid a thing\n")
    back = loaded((begun.replace("0.1", "7") + begun * 2 + TEXT).encode(), "stl")
    assert back.faces is not None
    assert back.faces.tolist() == [[0, 1, 2], [3, 1, 2], [3, 1, 2], [3, 1, 2]]


@pytest.mark.parametrize("data", [TEXT[8:], "facet " * 100, "v 1 2 3\n" * 100, "solids\n" + TEXT])
def test_a_text_of_another_kind_is_neither(data: str) -> None:
    cause = f"its {len(data)} bytes are neither text that begins with 'solid' nor binary facets"
    with pytest.raises(FormatError, match=cause):
        loaded(data.encode(), "stl")


def test_solids_are_joined() -> None:
    empty = "solid\nendsolid\n"
    moved = TEXT.replace("0.1", "7")
    back = loaded((empty + TEXT + empty + moved + TEXT).encode(), "stl")
    assert back.points.tolist() == [*CORNERS, [0, 0, 7]]
    assert back.faces is not None
    assert back.faces.tolist() == [[0, 1, 2], [3, 1, 2], [0, 1, 2]]
    assert back.metadata["repeated_vertices"] == 5


@pytest.mark.parametrize(
    ("old", "new", "cause"),
    [
        ("facet normal", "facetnormal", "line 2: .* where 'facet' or 'endsolid' should be"),
        ("facet normal", "normal", "line 2: 'normal 0 0 1', where 'facet' or 'endsolid' should be"),
        ("facet normal", "end facet", "line 2: 'end facet 0 0 1', where 'facet' or 'endsolid'"),
        ("1 0 0\n", "1 0 -nan(ind)\n", r"line 5, value 3: '-nan\(ind\)' is not a number"),
        ("1 0 0\n", "\n", "line 5: 'vertex', where 'vertex' with three"),
        ("endloop", "end loops", "line 7: 'end loops', where 'endloop' should be"),
        ("endloop", "end", "line 7: 'end', where 'endloop' should be"),
        ("endfacet\n", "endfacet\n\0\n", "line 9: .* where 'facet' or 'endsolid' should be"),
        ("outer loop", "outer", "line 3: 'outer', where 'outer loop' should be"),
        ("1 0 0\n", "1 0 0 0\n", "line 5: expected 3 values, found 4"),
        ("1 0 0\n", "1 0 1_0\n", "line 5, value 3: '1_0' is not a number"),
        ("1 0 0\n", "1 0 1.0.0\n", "line 5, value 3: '1.0.0' is not a number"),
        ("vertex 1", "vertex1", "line 5: 'vertex1 0 0', where 'vertex' with three"),
        ("      vertex 1 0 0\n", "", "line 6: 'endloop', where 'vertex' with three"),
        ("    endloop\n", "    vertex 1 1 1\n    endloop\n", "line 7: .* 'endloop' should be"),
        ("endloop", "endloop 3", "line 7: 'endloop 3', where 'endloop' should be"),
        ("  endfacet\n", "", "line 8: 'endsolid a thing', where 'endfacet' should be|within a f"),
        ("endsolid a thing\n", "", "line 8: the file ends within the solid that begins in line 1"),
        ("endsolid", "solid", "line 9: the file ends within the solid that begins in line 9"),
        ("endsolid", "endsolidus", "line 9: .* where 'facet' or 'endsolid' should be"),
        ("endsolid a thing\n", "endsolid\nendsolid\n", "line 10: 'endsolid', where 'solid' should"),
        ("endsolid a thing\n", "endsolid\nsolid\nfacet", "line 11: the file ends within a facet"),
        ("endsolid a thing\n", "endsolid\nnonsense", "line 10: 'nonsense', where 'solid' should"),
        ("endsolid a thing\n", "endsolid\nfacet normal 0 0 1\n" * 9, "line 10: .* 'solid' should"),
    ],
)
def test_text_that_is_broken(
    old: str, new: str, cause: str, caplog: pytest.LogCaptureFixture
) -> None:
    assert TEXT.count(old) == 1 or old in {"facet normal", "endsolid"}
    for before in ("", TEXT * 20):
        lines = before.count("\n")
        data = (before + TEXT.replace(old, new, 1)).encode()
        with pytest.raises(FormatError, match=_later(cause, lines)):
            loaded(data, "stl")
    assert not [each for each in caplog.records if each.levelno >= logging.WARNING]


def _later(cause: str, lines: int) -> str:
    """Move the line numbers in a message."""
    words = cause.split(" ")
    for at, word in enumerate(words[:-1]):
        if word == "line":
            number = words[at + 1].rstrip(",:")
            words[at + 1] = words[at + 1].replace(number, str(int(number) + lines))
    return " ".join(words)


def test_facets_across_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    corners = random_corners(60)
    text = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(180).reshape(-1, 3), process=False)
    data = text.export(file_type="stl_ascii").encode()
    whole = loaded(data * 2, "stl")
    for size in (1, 6, 7, 8, 100):
        monkeypatch.setattr("liftmesh.io.formats.stl.BLOCK", size)
        parts = loaded(data * 2, "stl")
        assert parts.points.tobytes() == whole.points.tobytes()
        assert np.array_equal(parts.faces, whole.faces)


@pytest.mark.parametrize("part", [1, 10, 1 << 20])
@pytest.mark.parametrize("collide", [False, True])
def test_equal_corners_are_merged_as_one_by_one(
    monkeypatch: pytest.MonkeyPatch, part: int, collide: bool
) -> None:
    monkeypatch.setattr(stl, "_PART", part)
    if collide:
        monkeypatch.setattr(stl, "_FACTORS", (1 << 63, 1 << 63, 1 << 63))
    corners = random_corners(200)
    corners[3, 1, 2] = corners[9, 0, 0] = corners[9, 1, 0] = np.nan
    corners[11:13] = np.inf
    kept, rows = first_appearances(corners)
    back = loaded(binary(corners), "stl")
    np.testing.assert_array_equal(back.points, kept)
    assert np.array_equal(np.signbit(back.points), np.signbit(kept))
    assert back.faces is not None
    assert back.faces.reshape(-1).tolist() == rows
    assert back.metadata["repeated_vertices"] == 600 - len(kept)


@pytest.mark.parametrize("others", [0, 1, 1000])
def test_very_many_equal_corners_take_no_more_memory(
    monkeypatch: pytest.MonkeyPatch, others: int
) -> None:
    monkeypatch.setattr(stl, "_PART", 1000)
    points = np.ones((200_000, 3))
    points[:others, 0] = np.arange(others) + 2
    tracemalloc.start()
    try:
        kept, place = stl.weld(points)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert kept.tolist() == [*range(others + 1)]
    assert place.tolist() == [*range(others)] + [others] * (len(points) - others)
    assert peak < 200 * len(points)  # 10 bytes for each of a binary file


def test_colliding_factors_do_collide(monkeypatch: pytest.MonkeyPatch) -> None:
    points = random_corners(200).reshape(-1, 3).astype(np.float64)
    different = len(np.unique(points + 0.0, axis=0))
    assert len(np.unique(stl._hashes(points))) == different
    monkeypatch.setattr(stl, "_FACTORS", (1 << 63, 1 << 63, 1 << 63))
    assert len(np.unique(stl._hashes(points))) < different


def test_normals_are_those_of_the_triangles() -> None:
    points = np.array([[0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 1e-9], [1e-9, 0, 0]])
    mesh = Cloud(points, faces=np.array([[0, 1, 2], [0, 2, 1], [0, 0, 1], [0, 4, 3]], np.int32))
    data = saved(mesh, "stl")
    normals = [struct.unpack_from("<3f", data, 84 + 50 * k) for k in range(4)]
    assert normals == [(0, 0, 1), (0, 0, -1), (0, 0, 0), (0, -1, 0)]


def test_written_as_trimesh_does() -> None:
    mesh = small_mesh()
    scene = trimesh.Trimesh(mesh.points, mesh.faces, process=False)
    assert saved(mesh, "stl")[80:] == scene.export(file_type="stl")[80:]


@pytest.mark.parametrize("origin", [b"nan 0 0", b"1e999 0 0", b"1 2", b"1 2 3 4", b"a b c"])
def test_origins_that_are_none(origin: bytes) -> None:
    with pytest.raises(FormatError, match=r"<stream>: the origin (in the header )?is"):
        loaded(binary(random_corners(), title=b"liftmesh origin " + origin), "stl")


def test_a_file_within_a_stream() -> None:
    for data in (binary(random_corners()), TEXT.encode()):
        stream = io.BytesIO(b"before" + data)
        stream.seek(6)
        assert len(liftmesh.read(stream, format="stl")) == len(loaded(data, "stl"))


@pytest.mark.parametrize("kind", ["stl", "glb", "3mf"])
def test_the_least_denormals_are_refused_by_name(kind: str) -> None:
    mesh = small_mesh()
    tiny = Cloud(np.sign(mesh.points) * 5e-324, faces=mesh.faces)
    with pytest.raises(FormatError, match="do not fit the single precision of"):
        liftmesh.write(io.BytesIO(), tiny, format=kind)
