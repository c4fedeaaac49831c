"""Colours of 8 bits that stand in the 16 of LAS: the same numbers come out, whatever the way."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pytest
from commands import liftmesh
from files.las import encoded, tile

import liftmesh as lm
from liftmesh import Cloud

CHANNELS = ("red", "green", "blue")


def dark(top: int = 255) -> Any:
    las = tile(40)
    las.withheld[:] = 0
    rng = np.random.default_rng(2)
    for name in CHANNELS:
        las[name] = rng.integers(0, top + 1, 40)
    las.red[0] = top
    return las


def read(las: Any) -> Cloud:
    return lm.read(io.BytesIO(encoded(las)), format="las")


def channels(data: bytes) -> Any:
    las = laspy.read(io.BytesIO(data))
    return np.column_stack([las[name] for name in CHANNELS])


def written(source: object) -> bytes:
    stream = io.BytesIO()
    lm.write(stream, source, format="las")
    return stream.getvalue()


@pytest.mark.parametrize("kind", ["ply", "npz"])
def test_by_way_of_another_format(kind: str) -> None:
    las = dark()
    stream = io.BytesIO()
    lm.write(stream, read(las), format=kind)
    again = lm.read(io.BytesIO(stream.getvalue()), format=kind)
    found = laspy.read(io.BytesIO(written(again))).points.array
    assert np.array_equal(found, las.points.array)


def test_by_way_of_a_surface(tmp_path: Path) -> None:
    las = dark()
    data = written(lm.triangulate(read(las)))
    assert np.array_equal(channels(data), channels(encoded(las)))
    las.write(str(tmp_path / "a.las"))
    done = liftmesh("triangulate", "a.las", "b.las", "--all-classes", cwd=tmp_path)
    assert done.returncode == 0
    before, after = (laspy.read(tmp_path / name).points.array for name in ("a.las", "b.las"))
    assert np.array_equal(before, after)


def test_merged_tiles() -> None:
    one, other = read(dark()), read(dark())
    assert np.array_equal(channels(written(lm.merge([one, other])))[:40], channels(encoded(dark())))
    bright = lm.merge([one, read(dark(60_000)), other])
    assert bright.colors is not None
    assert bright.colors.dtype == np.uint16
    expected = np.vstack([channels(encoded(dark(top))) for top in (255, 60_000, 255)])
    assert np.array_equal(channels(written(bright)), expected)
    assert np.array_equal(bright.colors, expected)


def test_full_colours_stay_full() -> None:
    cloud = Cloud(np.eye(3), colors=np.full((3, 3), 255, np.uint8))
    assert channels(written(cloud)).min() == 65535
    bright = read(dark(60_000))
    assert bright.colors is not None
    assert "color_depth" not in bright.metadata["las"]
