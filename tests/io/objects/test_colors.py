"""Colours between integers and floats."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh.base.colors import as_float, as_uint8, with_alpha
from liftmesh.errors import InputError

ALL_BYTES = np.arange(256, dtype=np.uint8).repeat(3).reshape(-1, 3)


def test_every_byte_survives_the_way_to_floats_and_back():
    floats = as_float(ALL_BYTES)
    assert floats.min() == 0
    assert floats.max() == 1
    assert np.array_equal(as_uint8(floats), ALL_BYTES)
    assert np.array_equal(as_uint8(floats.astype(np.float32)), ALL_BYTES)


def test_every_16_bit_value_survives_single_precision():
    wide = np.arange(65536, dtype=np.uint16).reshape(-1, 4)
    single = as_float(wide).astype(np.float32)
    assert np.array_equal(np.rint(single.astype(np.float64) * 65535).astype(np.uint16), wide)


def test_16_bit_colours_are_scaled_not_truncated():
    wide = np.array([[0, 257, 65535], [128, 129, 65407]], dtype=np.uint16)
    assert as_uint8(wide).tolist() == [[0, 1, 255], [0, 1, 255]]


def test_signed_integers_are_bytes():
    plain = np.array([[0, 51, 255]])
    assert as_uint8(plain).tolist() == [[0, 51, 255]]
    assert as_float(plain).tolist() == [[0.0, 0.2, 1.0]]


def test_bytes_are_not_copied():
    assert as_uint8(ALL_BYTES) is ALL_BYTES


def test_floats_stay_as_they_are():
    colors = np.random.default_rng(1).random((50, 3))
    assert as_float(colors).tobytes() == colors.tobytes()


@pytest.mark.parametrize("convert", [as_uint8, as_float])
@pytest.mark.parametrize("bad", [1.5, -0.25, np.nan, np.inf])
def test_floats_outside_the_range_name_their_row(convert, bad):
    colors = np.zeros((4, 3))
    colors[2, 1] = bad
    with pytest.raises(InputError, match=r"row 2 has the colour .* outside 0\.\.1"):
        convert(colors)


@pytest.mark.parametrize("bad", [-1, 256])
def test_signed_integers_outside_a_byte_name_their_row(bad):
    with pytest.raises(InputError, match=r"row 1 .* outside 0\.\.255"):
        as_uint8(np.array([[0, 0, 0], [0, 0, bad]]))


@pytest.mark.parametrize("colors", [np.zeros(3), np.zeros((3, 2)), np.zeros((2, 3), dtype=complex)])
def test_other_shapes_and_types_are_refused(colors):
    with pytest.raises(InputError, match="colours need shape"):
        as_float(colors)


@pytest.mark.parametrize(
    ("dtype", "opaque"), [("u1", 255), ("u2", 65535), ("i8", 255), ("f4", 1), ("f8", 1)]
)
def test_alpha_is_opaque_in_every_type(dtype, opaque):
    rgba = with_alpha(np.zeros((2, 3), dtype=dtype))
    assert rgba.dtype == dtype
    assert rgba[:, 3].tolist() == [opaque, opaque]


def test_alpha_is_kept_where_it_exists():
    rgba = np.array([[1, 2, 3, 4]], dtype=np.uint8)
    assert with_alpha(rgba) is rgba
