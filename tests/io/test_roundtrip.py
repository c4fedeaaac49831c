"""Any mesh, written and read again, is the same bit for bit."""

from __future__ import annotations

import io

import numpy as np
import pytest
from file_samples import assert_same_bits, assert_same_mesh, loaded, saved
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as hnp

import liftmesh
from liftmesh import Cloud

DOUBLES = st.floats(width=64, allow_nan=False)
SINGLES = st.floats(width=32, allow_nan=False)
UNITS = st.floats(0, 1)
NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,8}", fullmatch=True).filter(
    lambda name: name not in {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha"}
)
PORTABLE = ("u1", "<u2", "<i4", "<f4", "<f8")


@st.composite
def meshes(draw: st.DrawFn, *, attributes: bool = False) -> Cloud:
    rows = draw(st.integers(1, 12))
    points = draw(hnp.arrays(np.float64, (rows, 3), elements=DOUBLES))
    normals = draw(st.none() | hnp.arrays(np.float64, (rows, 3), elements=DOUBLES))
    colors = draw(st.none() | hnp.arrays(np.uint8, (rows, 3)))
    index = st.integers(0, rows - 1)
    count = draw(st.integers(1, 8))
    faces = draw(st.none() | hnp.arrays(np.int32, (count, 3), elements=index))
    named = st.dictionaries(NAMES, st.sampled_from(PORTABLE), max_size=3 if attributes else 0)
    values = {key: draw(hnp.arrays(kind, rows)) for key, kind in draw(named).items()}
    return Cloud(points, colors=colors, normals=normals, faces=faces, attributes=values)


@given(meshes(attributes=True))
def test_ply(mesh: Cloud) -> None:
    assert_same_mesh(loaded(saved(mesh, "ply"), "ply"), mesh)


@given(meshes())
def test_ply_as_text(mesh: Cloud) -> None:
    assert_same_mesh(loaded(saved(mesh, "ply", encoding="ascii"), "ply"), mesh)


@given(hnp.arrays("<f4", 5, elements=SINGLES), hnp.arrays("<i4", 5), hnp.arrays("u1", 5))
def test_attributes_as_text(single: np.ndarray, whole: np.ndarray, byte: np.ndarray) -> None:
    values = {"single": single, "whole": whole, "byte": byte}
    mesh = Cloud(np.zeros((5, 3)), attributes=values)
    assert_same_mesh(loaded(saved(mesh, "ply", encoding="ascii"), "ply"), mesh)


@given(meshes())
def test_obj(mesh: Cloud) -> None:
    assert_same_mesh(loaded(saved(mesh, "obj"), "obj"), mesh)


@given(meshes(attributes=True))
def test_numpy_files(mesh: Cloud) -> None:
    assert_same_mesh(loaded(saved(mesh, "npz"), "npz"), mesh)


@pytest.mark.slow
@given(meshes().filter(lambda mesh: mesh.faces is not None and np.isfinite(mesh.points).all()))
def test_off(mesh: Cloud) -> None:
    shape = Cloud(mesh.points, faces=mesh.faces)
    assert_same_mesh(loaded(saved(shape, "off"), "off"), shape)


@given(hnp.arrays(np.float64, st.tuples(st.integers(1, 9), st.just(3)), elements=DOUBLES))
def test_text(points: np.ndarray) -> None:
    text = "".join(",".join(map(repr, row)) + "\n" for row in points.tolist())
    # Some doubles are marks of missing values, unless the caller says that there are none.
    back = liftmesh.read(io.BytesIO(text.encode()), format="csv", columns="x,y,z", nodata="none")
    assert_same_bits(back.points, points)


@given(hnp.arrays(np.float64, (4, 3), elements=UNITS))
def test_colours_of_any_value_come_back_from_obj(colors: np.ndarray) -> None:
    back = loaded(saved(Cloud(np.zeros((4, 3)), colors=colors), "obj"), "obj").colors
    assert back is not None
    if back.dtype == np.uint8:
        np.testing.assert_allclose(back / 255, colors, rtol=0, atol=1e-6)
    else:
        assert_same_bits(back, colors)


@pytest.mark.parametrize("encoding", ["binary", "ascii"])
@given(hnp.arrays(np.float64, (3, 3), elements=st.floats(width=64, allow_nan=True)))
def test_every_kind_of_float(encoding: str, points: np.ndarray) -> None:
    back = loaded(saved(Cloud(points), "ply", encoding=encoding), "ply").points
    if encoding == "binary":
        assert_same_bits(back, points)
    else:
        np.testing.assert_array_equal(back, points)
