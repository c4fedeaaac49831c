"""Clouds for surfaces in tiles, and what they are compared with: one call of `triangulate`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from tilings import ordered

import liftmesh

if TYPE_CHECKING:
    from liftmesh import Cloud, Surface, TiledSurface

POLICIES = ("first", "last", "lowest", "highest", "mean")


def steep_cloud(seed: int = 3, rows: int = 1_200, side: int = 22) -> Cloud:
    """A lattice with several heights at most positions, and very many at one of them."""
    rng = np.random.default_rng(seed)
    points = np.column_stack((rng.integers(0, side, (rows, 2)), rng.integers(-2, 3, rows) * 0.3))
    points[rng.integers(0, rows, rows // 5), :2] = points[7, :2]
    points[rng.integers(0, rows, rows // 20)] *= [1, 1, -0.0]
    return liftmesh.Cloud(
        points,
        colors=rng.integers(0, 60_000, (rows, 3)).astype(np.uint16),
        normals=rng.normal(size=(rows, 3)).astype(np.float32),
        attributes={
            "classification": rng.integers(1, 4, rows).astype(np.uint8),
            "waveform": rng.integers(0, 99, (rows, 2)).astype(">i4"),
        },
        crs="EPSG:7415",
    )


def check(tiled: TiledSurface, expected: Surface) -> None:
    """Compare triangles, vertices with all values, and the use of every row, bit for bit."""
    ours, theirs = (ordered(_turned(each)) for each in (tiled.to_array(), expected.faces))
    assert np.array_equal(ours, theirs)
    one, other = tiled.report, expected.report
    counts = ("rows", "used", "duplicates", "overhangs", "skipped", "triangles")
    for name in (*(f"n_{each}" for each in counts), "policy"):
        assert getattr(one, name) == getattr(other, name), name
    assert (one.columns, one.color_depth) == (other.columns, other.color_depth)
    assert one.left_out.dtype == one.representatives.dtype == np.int64
    assert np.array_equal(one.left_out, other.left_out)
    assert np.array_equal(one.representatives, other.representatives)
    assert (tiled.crs, tiled.bounds) == (expected.crs, expected.bounds)
    seen = [check_vertices(vertices, expected) for vertices in tiled.iter_vertices()]
    assert np.array_equal(np.unique(np.concatenate(seen)), np.unique(expected.faces))
    assert tiled.is_sound()


def _turned(triangles: Any) -> Any:
    """Let each triangle begin with its least row."""
    first = np.argmin(triangles, axis=1)[:, None]
    return np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)


def check_vertices(vertices: Any, expected: Surface) -> Any:
    """Compare the vertices of a shard with those of a surface; return their rows."""
    rows = vertices["row"]
    assert (np.diff(rows) > 0).all()
    points = np.stack([vertices[name] for name in ("x", "y", "z")], axis=1)
    assert points.tobytes() == expected.vertices[rows].tobytes()
    values = {"colors": expected.colors, "normals": expected.normals, **expected.attributes}
    named = {name: each for name, each in values.items() if each is not None}
    assert list(vertices.dtype.names[4:]) == [*named]
    for name, each in named.items():
        assert vertices[name].dtype == each.dtype, name
        assert vertices[name].tobytes() == each[rows].tobytes(), name
    return rows
