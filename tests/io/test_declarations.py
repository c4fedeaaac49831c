"""What formats declare: each is held to what it needs and keeps, for every kind of content."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path

import laspy
import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, Format, FormatError, InputError, WriteResult
from liftmesh.base.colors import as_float, as_uint8
from liftmesh.io.columns import edges_of
from liftmesh.io.format import CONTENT, NEEDS
from liftmesh.io.metadata import user_entries
from liftmesh.io.registry import FORMATS

WRITABLE = {each.name: each for each in FORMATS if each.write and each.read}
OPTIONS = {name: [{}] for name in WRITABLE} | {
    "ply": [
        {},
        {"colors": "exact"},
        {"encoding": "ascii"},
        {"encoding": "ascii", "colors": "exact"},
    ],
    "npz": [{}, {"compressed": True}],
    "las": [{}, {"compressed": True}, {"scale": 1e-6}, {"point_format": 10}],
    "obj": [{}, {"colors": "comments"}, {"colors": "none"}],
    "text": [{}, {"delimiter": ","}, {"delimiter": ";"}, {"delimiter": "\t"}],
}
CALLS = [(name, options) for name, several in OPTIONS.items() for options in several]

# Four vertices, three of them in a face; single precision holds every coordinate.
POINTS = np.array([[0, 0, 1], [4, 0, 2.5], [0, 3, 0.25], [8, 8, 8]], dtype=np.float64)
FACES = np.array([[0, 1, 2]], dtype=np.int32)
ALL_FACES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
EDGES = np.array([[1, 2], [0, 3]], dtype=np.int32)
NORMALS = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0.6, 0.8]], dtype=np.float32)
RGB = np.array([[0, 128, 255], [1, 2, 3], [254, 127, 64], [9, 9, 9]], dtype=np.uint8)
RGBA = np.column_stack([RGB, [255, 10, 0, 128]]).astype(np.uint8)
DEEP = np.array([[0, 1, 65535], [300, 2, 3], [4, 5, 6], [7, 8, 9]], dtype=np.uint16)

METADATA = {"survey": "Höhe\x7f\n2024", "extent": [0, 1.5, {"a": None}], "comments": ("b", "a")}

MESH = Cloud(POINTS, faces=ALL_FACES)

# A cloud for each kind of content, and the words of `Format.keeps` that it takes to keep it.
CONTENTS: dict[str, tuple[Cloud, set[str]]] = {
    "a mesh": (MESH, {"faces"}),
    "points": (Cloud(POINTS), {"points"}),
    "a row in no face": (Cloud(POINTS, faces=FACES), {"faces", "points"}),
    "colours": (replace(MESH, colors=RGB), {"faces", "colors"}),
    "colours of points": (Cloud(POINTS, colors=RGB), {"points", "colors"}),
    "opaque colours": (
        replace(MESH, colors=np.column_stack([RGB, [255] * 4]).astype(np.uint8)),
        {"faces", "colors"},
    ),
    "signed colours": (replace(MESH, colors=RGB.astype(np.int64)), {"faces", "colors"}),
    "8-bit colours as floats": (replace(MESH, colors=RGB / 255.0), {"faces", "colors"}),
    "alpha": (replace(MESH, colors=RGBA), {"faces", "colors", "alpha"}),
    "16-bit colours": (replace(MESH, colors=DEEP), {"faces", "colors", "deep_colors"}),
    "float colours": (replace(MESH, colors=DEEP / 65535.0), {"faces", "colors", "deep_colors"}),
    "colours near 8 bits": (
        replace(MESH, colors=RGB / 255.0 + np.where(RGB == 9, 4e-7, 0)),
        {"faces", "colors", "deep_colors"},
    ),
    "normals": (replace(MESH, normals=NORMALS), {"faces", "normals"}),
    "normals of other lengths": (replace(MESH, normals=2 * NORMALS), {"faces", "normals"}),
    "a row in no face that single precision does not hold": (
        Cloud(np.vstack([POINTS[:3], [[0.1, 0.2, 0.3]]]), faces=FACES),
        {"faces", "points", "float64"},
    ),
    "normals of points": (Cloud(POINTS, normals=NORMALS), {"points", "normals"}),
    "edges": (replace(MESH, edges=EDGES), {"faces", "edges"}),
    "edges of points": (Cloud(POINTS, edges=EDGES), {"points", "edges"}),
    "named values": (
        replace(MESH, attributes={"class": np.arange(4, dtype=np.uint8), "z0": POINTS[:, 2]}),
        {"faces", "attributes"},
    ),
    "a coordinate system": (replace(MESH, crs="EPSG:25832"), {"faces", "crs"}),
    "a long coordinate system": (
        replace(MESH, crs='PROJCRS["ETRS89 / Gauß",\n  "two lines\\and \x07"]' * 50),
        {"faces", "crs"},
    ),
    "metadata": (replace(MESH, metadata=METADATA), {"faces", "metadata"}),
    "double precision": (replace(MESH, points=POINTS + 0.1), {"faces", "float64"}),
    "far away": (replace(MESH, points=POINTS / 3 + [450000.1, 5200000.2, 0]), {"faces", "float64"}),
    "everything": (
        replace(
            MESH,
            points=POINTS / 7,
            faces=FACES,
            edges=EDGES,
            colors=DEEP,
            normals=NORMALS,
            attributes={"class": np.arange(4, dtype=np.uint8)},
            crs="EPSG:2056",
            metadata=METADATA,
        ),
        set(CONTENT) - {"alpha"},
    ),
}


LAST_BITS = "last bits of coordinates, whose decimals are the same"
BY_WRITERS = "holes between faces"  # which they find out, and no `loses`
"""What LAS says instead of double precision where only the rounding of binary numbers differs."""


def round_trip(cloud: Cloud, kind: str, options: dict[str, str]) -> tuple[Cloud, WriteResult]:
    stream = io.BytesIO()
    written = liftmesh.write(stream, cloud, format=kind, **options)
    return liftmesh.read(io.BytesIO(stream.getvalue()), format=kind), written


def corners(cloud: Cloud) -> set[tuple[bytes, ...]]:
    """Give the triangles by the positions of their corners, whatever the order of rows."""
    assert cloud.faces is not None
    return {tuple(sorted(row.tobytes() for row in cloud.points[face])) for face in cloud.faces}


def same_colors(ours: np.ndarray | None, theirs: np.ndarray | None, channels: int) -> bool:
    if ours is None or theirs is None:
        return ours is theirs
    return np.array_equal(as_float(ours)[:, :channels], as_float(theirs)[:, :channels])


def eight(colors: np.ndarray | None) -> np.ndarray | None:
    return None if colors is None else as_uint8(colors)


def kept(back: Cloud, cloud: Cloud) -> dict[str, bool]:
    """Compare what came back with what was written, for each word of `Format.keeps`."""
    near = same_rows(back, cloud)
    return {
        "points": len(back) == len(cloud) and near,
        "faces": cloud.faces is None or (back.faces is not None and len(back.faces) > 0),
        "edges": np.array_equal(*(np.sort(np.sort(edges_of(x)), axis=0) for x in (back, cloud))),
        "colors": same_colors(eight(back.colors), eight(cloud.colors), 3),
        "alpha": same_colors(back.colors, cloud.colors, 4),
        "deep_colors": same_colors(back.colors, cloud.colors, 3),
        "normals": equal(back.normals, cloud.normals),
        "attributes": {*back.attributes} - of_the_format(back) == {*cloud.attributes}
        and all(np.array_equal(back.attributes[k], v) for k, v in cloud.attributes.items()),
        "crs": back.crs == cloud.crs,
        "metadata": {k: v for k, v in user_entries(back.metadata).items() if k != "las"}
        == cloud.metadata,
        "float64": same_positions(back, cloud),
    }


def of_the_format(cloud: Cloud) -> set[str]:
    """Return the values that every point of a LAS file has, where they are 0."""
    layout = cloud.metadata.get("las")
    names = laspy.PointFormat(layout["point_format"]).dimension_names if layout else ()
    return {name for name in names if name in cloud.attributes and not cloud.attributes[name].any()}


def same_rows(back: Cloud, cloud: Cloud) -> bool:
    """Say whether every row came back in its place, as far as single precision tells."""
    scale = np.abs(cloud.points).max()
    return len(back) == len(cloud) and np.allclose(back.points, cloud.points, atol=1e-6 * scale)


def same_positions(back: Cloud, cloud: Cloud) -> bool:
    both = cloud.faces is not None and back.faces is not None
    if both and corners(back) != corners(cloud):
        return False
    return len(back) != len(cloud) or np.array_equal(back.points, cloud.points)


def equal(ours: np.ndarray | None, theirs: np.ndarray | None) -> bool:
    """Compare normals in the precision that they were given in."""
    if ours is None or theirs is None:
        return ours is theirs
    return np.array_equal(ours.astype(theirs.dtype), theirs)


def expected_drops(cloud: Cloud, lost: set[str]) -> set[str]:
    if "colors" in lost:
        lost -= {"alpha", "deep_colors"}
    names = {CONTENT[word] for word in lost - {"attributes", "metadata"}}
    entries = {f"metadata {key}" for key in cloud.metadata} if "metadata" in lost else set()
    return names | entries | (set(cloud.attributes) if "attributes" in lost else set())


@pytest.mark.parametrize("content", CONTENTS)
@pytest.mark.parametrize(("kind", "options"), CALLS, ids=[f"{k}-{o}" for k, o in CALLS])
def test_a_format_keeps_what_it_declares_and_names_the_rest(
    kind: str, options: dict[str, str], content: str
) -> None:
    cloud, needed = CONTENTS[content]
    declared = WRITABLE[kind]
    if "faces" in declared.needs and cloud.faces is None:
        with pytest.raises(FormatError, match=f"without faces .* as {kind.upper()}"):
            round_trip(cloud, kind, options)
        return
    if kind == "landxml" and content == "a long coordinate system":
        with pytest.raises(FormatError, match=r"the unit of 'PROJCRS.* is not known"):
            round_trip(cloud, kind, options)
        return
    back, written = round_trip(cloud, kind, options)
    losses = set() if declared.loses is None else set(declared.loses(cloud, options))
    promised = set(declared.keeps) - {"float64" if name == LAST_BITS else name for name in losses}
    lost = needed - promised
    if "points" in lost and content == "a row in no face that single precision does not hold":
        lost -= {"float64"}  # the row is not in the file
    found = kept(back, cloud)
    assert {word for word in promised & needed if not found[word]} == set()
    if kind == "dxf" and found["points"]:  # no row is without an edge
        lost -= {"points"}
    assert {word for word in lost if found[word]} == set()
    if LAST_BITS in losses & set(written.dropped):
        lost -= {"float64"}
        assert np.allclose(back.points, cloud.points, rtol=1e-15, atol=0)
    assert set(written.dropped) - {BY_WRITERS} == expected_drops(cloud, lost) | (
        losses - CONTENT.keys()
    )
    assert len(set(written.dropped)) == len(written.dropped)


@pytest.mark.parametrize("kind", WRITABLE)
def test_every_need_is_refused_and_nothing_else(kind: str, tmp_path: Path) -> None:
    lacking = {
        "points": Cloud(np.zeros((0, 3)), faces=np.zeros((0, 3), dtype=np.int32)),
        "faces": Cloud(POINTS),
        "finite": Cloud(np.where(POINTS == 4, np.inf, POINTS), faces=ALL_FACES),
    }
    declared = set(WRITABLE[kind].needs)
    refused = {need for need in NEEDS if is_refused(lacking[need], kind, tmp_path)}
    assert refused == declared | ({"points"} if "faces" in declared else set())
    assert not list(tmp_path.glob("*refused*"))


def is_refused(cloud: Cloud, kind: str, folder: Path) -> bool:
    try:
        liftmesh.write(folder / "refused", cloud, format=kind)
    except FormatError as error:
        return re.search("vertex 1 is|without (points|faces)", str(error)) is not None
    (folder / "refused").unlink()
    return False


@pytest.mark.parametrize("kind", ["ply", "obj", "text", "npz", "off", "stl", "glb"])
def test_an_error_after_the_bytes_are_written_leaves_the_old_file(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> tuple[str, ...]:
        raise MemoryError

    monkeypatch.setattr("liftmesh.io.write.dropped", fail)
    target = tmp_path / f"mesh.{kind}"
    target.write_bytes(b"old")
    with pytest.raises(MemoryError):
        liftmesh.write(target, MESH)
    assert target.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def test_stl_looks_at_the_rows_of_its_triangles_alone() -> None:
    points = POINTS.copy()
    points[3] = np.nan
    back, written = round_trip(Cloud(points, faces=FACES), "stl", {})
    assert len(back) == 3
    assert written.dropped == ("rows in no face",)


@pytest.mark.parametrize("words", [{"keeps": ("colours",)}, {"needs": ("rows",)}])
def test_a_declaration_of_unknown_words_is_refused(words: dict[str, tuple[str, ...]]) -> None:
    with pytest.raises(InputError, match=r"of the format 'odd' holds '(colours|rows)': known are"):
        Format("odd", (".odd",), None, None, "", **words)


def test_every_word_is_kept_by_some_format_and_lost_by_another() -> None:
    for word in CONTENT:
        keeping = [name for name, each in WRITABLE.items() if word in each.keeps]
        assert keeping, word
        if word != "faces":
            assert set(keeping) < set(WRITABLE), word
