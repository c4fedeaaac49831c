"""COPC: a box or a resolution reads the nodes that it needs, with the rows of the whole file."""

from __future__ import annotations

import io
import struct
from typing import Any

import laspy
import numpy as np
import pytest
from file_samples import assert_same_bits
from files.las import copc, encoded, patched, tile

import liftmesh
from liftmesh import Cloud, FormatError, InputError
from liftmesh.io.formats.las.laz import Index
from liftmesh.io.formats.las.reader import Points

COUNT = 4000
LAS = tile(COUNT, point_format=6, version="1.4")
DATA = copc(LAS)
BOX = (500100.0, 5400200.0, 500420.0, 5400650.0)
INFO = 375 + 54  # the place of the record


def read(data: bytes = DATA, **options: Any) -> Cloud:
    return liftmesh.read(io.BytesIO(data), format="laz", **options)


@pytest.fixture
def decoded(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Record the points of every block that is decoded."""
    seen: list[int] = []

    def recording(self: Points, *rest: Any) -> Any:
        for block in original(self, *rest):
            seen.append(len(block))
            yield block

    original = Points.blocks_of
    monkeypatch.setattr(Points, "blocks_of", recording)
    return seen


def test_laspy_reads_what_the_tests_make() -> None:
    with laspy.CopcReader(io.BytesIO(DATA)) as reader:
        assert len(reader.query()) == COUNT
        assert len(reader.query(level=0)) == np.ceil(COUNT / 3)


def test_the_whole_file_is_laz_like_another() -> None:
    cloud = read()
    assert len(cloud) == COUNT
    assert cloud.metadata["las"]["copc"] == {"spacing": 16.0, "levels": 3}
    assert cloud.metadata.get("not_read") is None


@pytest.mark.parametrize(
    "options",
    [
        {"bounds": BOX},
        {"z_range": (10.0, 20.0)},
        {"bounds": BOX, "classes": 2, "returns": "last", "every": 3},
        {"bounds": BOX, "classes": "ground"},
        {"bounds": (0.0, 0.0, 1.0, 1.0)},
        {"every": 7},
    ],
)
def test_the_rows_are_those_of_the_whole_file(options: Any, decoded: list[int]) -> None:
    whole = read()
    text = Cloud(whole.points, attributes=whole.attributes)
    stream = io.BytesIO()
    liftmesh.write(stream, text, format="npz")
    expected = liftmesh.read(io.BytesIO(stream.getvalue()), format="npz", **options)
    found = read(**options)
    assert_same_bits(found.points, expected.points)
    for name, values in found.attributes.items():
        assert_same_bits(values, expected.attributes[name])
    counts = dict(found.metadata["selection"])
    assert counts.pop("rows") == COUNT
    counts.pop("ground", None)
    assert counts.pop("selected") == len(found) == COUNT - sum(counts.values())
    if "bounds" in options:
        assert sum(decoded) < 0.7 * COUNT


@pytest.mark.parametrize(("resolution", "levels"), [(100, 1), (16, 1), (15.9, 2), (8, 2), (0.1, 3)])
def test_a_resolution_reads_the_levels_that_it_needs(resolution: float, levels: int) -> None:
    found = read(copc_resolution=resolution)
    rows = np.arange(COUNT) % 3 < levels
    expected = np.asarray(LAS.xyz)[rows]
    assert {*map(tuple, found.points.tolist())} == {*map(tuple, expected.tolist())}
    finer = {} if levels == 3 else {"copc_resolution": COUNT - len(found)}
    assert found.metadata["selection"] == {"rows": COUNT, "selected": len(found), **finer}


def test_ground_beyond_the_box_counts() -> None:
    las = tile(COUNT, point_format=6, version="1.4")
    x, y = np.asarray(las.x), np.asarray(las.y)
    inside = (x >= BOX[0]) & (x <= BOX[2]) & (y >= BOX[1]) & (y <= BOX[3])
    las.classification = np.where(inside | (np.arange(COUNT) > 2), 5, 2).astype(np.uint8)
    first = np.flatnonzero(~inside)[0]
    las.classification[first] = 2
    assert len(read(copc(las), bounds=BOX, classes="ground")) == 0
    las.classification = np.full(COUNT, 5, np.uint8)
    assert len(read(copc(las), bounds=BOX, classes="ground")) == inside.sum()


def test_a_resolution_needs_an_index() -> None:
    plain = encoded(LAS, compressed=True)
    with pytest.raises(
        FormatError, match=r"by copc_resolution, for which the file has no index \(COPC"
    ):
        read(plain, copc_resolution=1.0)
    with pytest.raises(InputError, match="copc_resolution is 0: give a positive number"):
        read(copc_resolution=0)


def test_written_it_is_laz_without_the_index() -> None:
    cloud = read()
    stream = io.BytesIO()
    written = liftmesh.write(stream, cloud, format="laz")
    assert written.dropped == ("the index of COPC",)
    again = read(stream.getvalue())
    assert_same_bits(again.points, cloud.points)
    assert "copc" not in again.metadata["las"]
    assert b"copc" not in stream.getvalue()


ROOT, SIZE = struct.unpack_from("<2Q", DATA, INFO + 40)
LIES = {
    "a cube of no size": (patched(DATA, "<d", INFO + 24, 0.0), "a cube of 0 around"),
    "a page beyond the end": (patched(DATA, "<Q", INFO + 40, 2**40), "outside the file"),
    "a page of half an entry": (patched(DATA, "<Q", INFO + 48, SIZE - 16), "cannot be one"),
    "a page that is very long": (patched(DATA, "<Q", INFO + 48, 2**60), "cannot be one"),
    "a page at no byte": (patched(DATA, "<Q", INFO + 40, 2**64 - 1), "outside the file"),
    "a page that is itself": (patched(DATA, "<Qi", ROOT + SIZE - 16, ROOT, SIZE), "cannot be one"),
    "a page of less than nothing": (patched(DATA, "<i", ROOT + SIZE - 8, -32), "outside the file"),
    "a node of another chunk": (patched(DATA, "<i", ROOT + 28, 7), "are not the chunks of the"),
    "a node that is elsewhere": (patched(DATA, "<Q", ROOT + 16, 400), "are not the chunks of the"),
    "a level below the root": (patched(DATA, "<i", ROOT, -5), "of no level from 0 to 32"),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_damaged_index_is_named_and_not_used(lie: str) -> None:
    data, cause = LIES[lie]
    with pytest.raises(FormatError, match=cause):
        read(data, copc_resolution=1.0)
    found = read(data, bounds=BOX)
    assert found.metadata["not_read"] == ("the index of COPC (damaged)",)
    assert_same_bits(found.points, read(bounds=BOX).points)


CENTRE, HALF = struct.unpack_from("<d", DATA, INFO)[0], struct.unpack_from("<d", DATA, INFO + 24)[0]
MOVED = {
    "a cube elsewhere": patched(DATA, "<d", INFO, CENTRE + 5000),
    "a cube a bit off": patched(DATA, "<d", INFO + 8, 5400000 + HALF * 1.1),
    "a cube that is tiny": patched(DATA, "<d", INFO + 24, 1e-3),
    "a cube a bit small": patched(DATA, "<d", INFO + 24, HALF * 0.98),
    "a node elsewhere": patched(DATA, "<i", ROOT + 32 + 4, 2**31 - 1),
    "a root of another level": patched(DATA, "<i", ROOT, 7),
}


@pytest.mark.parametrize("case", MOVED)
def test_an_index_that_points_contradict_is_named_and_not_used(case: str) -> None:
    data = MOVED[case]
    assert data != DATA
    for options in (
        {"bounds": BOX},
        {"z_range": (10.0, 20.0)},
        {"bounds": BOX, "classes": "ground"},
    ):
        found, expected = read(data, **options), read(**options)
        assert found.metadata["not_read"] == ("the index of COPC (damaged)",)
        assert_same_bits(found.points, expected.points)
        counts = [each.metadata["selection"]["selected"] for each in (found, expected)]
        assert counts[0] == counts[1] == len(found)
    with pytest.raises(FormatError, match="COPC: points lie outside the cubes of their nodes"):
        read(data, copc_resolution=1.0)


def test_points_that_decoding_shows_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    checked = []
    check = Index.check

    def all_but_the_first(self: Index, *rest: Any) -> None:
        checked.append(len(rest[1]))
        if len(checked) > 1:  # first come those that are not compressed
            check(self, *rest)

    monkeypatch.setattr(Index, "check", all_but_the_first)
    found = read(MOVED["a cube a bit small"], bounds=BOX)
    assert found.metadata["not_read"] == ("the index of COPC (damaged)",)
    assert len(checked) > 1
    monkeypatch.undo()
    assert_same_bits(found.points, read(bounds=BOX).points)


def test_nodes_of_one_name_are_no_index() -> None:
    same = patched(DATA, "<4i", ROOT + 32, 0, 0, 0, 0)
    with pytest.raises(FormatError, match="COPC: two nodes are one"):
        read(same, copc_resolution=1.0)
