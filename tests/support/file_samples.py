"""Clouds and meshes for the tests of files, and how to compare them bit for bit."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

import liftmesh
from liftmesh import Cloud

# Coordinates that lose something in careless hands: signs of zero, denormals, both ends of the
# range, decimals, map coordinates.
AWKWARD = np.array(
    [
        [0.1, 0.2, 0.30000000000000004],
        [-0.0, 0.0, 5e-324],
        [1e300, -1.7976931348623157e308, 2.2250738585072014e-308],
        [450000.123456789, 5200000.987654321, 1 / 3],
        [-1e-310, 123456789.0, 1e22],
    ]
)
FACES = np.array([[0, 1, 2], [2, 3, 0], [4, 3, 1]], dtype=np.int32)
COLORS = np.array(
    [[0, 128, 255], [1, 2, 3], [254, 127, 64], [200, 100, 50], [77, 0, 9]], dtype=np.uint8
)
NORMALS = np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0.6, 0.0, 0.8], [-0.0, -1.0, 0.1]])


def full_mesh() -> Cloud:
    """Make a mesh with everything that PLY holds."""
    return Cloud(
        AWKWARD,
        colors=COLORS,
        normals=NORMALS,
        attributes={
            "intensity": np.array([0, 1, 65535, 7, 8], dtype=np.uint16),
            "class": np.array([2, 6, 255, 0, 1], dtype=np.uint8),
            "height": np.array([0.1, -0.0, 1e300, np.nan, 3.5]),
            "weight": np.array([0.1, 0.2, 1e30, 1e-45, 3.5], dtype=np.float32),
            "row": np.array([-(2**31), 2**31 - 1, 0, 1, 2], dtype=np.int32),
        },
        faces=FACES,
    )


def small_mesh() -> Cloud:
    """Make a mesh whose coordinates single precision holds exactly."""
    points = np.array([[0, 0, 0], [1, 0, 0.5], [0, 1, 0.25], [1, 1, 2]], dtype=np.float64)
    return Cloud(points, faces=np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32))


def saved(mesh: object, kind: str, **options: Any) -> bytes:
    """Write to memory."""
    stream = io.BytesIO()
    liftmesh.write(stream, mesh, format=kind, **options)
    return stream.getvalue()


def loaded(data: bytes, kind: str) -> Cloud:
    """Read from memory."""
    return liftmesh.read(io.BytesIO(data), format=kind)


def assert_same_bits(actual: Any, expected: Any) -> None:
    """Compare two arrays bit for bit: type, shape, signs of zero, NaN."""
    assert actual.dtype == expected.dtype
    assert actual.shape == expected.shape
    assert actual.tobytes() == np.ascontiguousarray(expected).tobytes()


def assert_same_mesh(actual: Cloud, expected: Cloud, *, attributes: bool = True) -> None:
    """Compare everything that two clouds hold, bit for bit."""
    assert_same_bits(actual.points, expected.points)
    for key in ("colors", "normals", "faces"):
        ours, theirs = getattr(actual, key), getattr(expected, key)
        assert (ours is None) == (theirs is None), key
        if ours is not None:
            assert_same_bits(ours, theirs)
    if attributes:
        assert list(actual.attributes) == list(expected.attributes)
        for key, values in expected.attributes.items():
            assert_same_bits(actual.attributes[key], values)
