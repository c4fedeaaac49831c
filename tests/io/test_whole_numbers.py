"""Whether floating-point numbers hold whole ones: the same as Python's own integers say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, strategies as st

from liftmesh.io.format import DOUBLE, SINGLE, fits_whole

FLOATS = {SINGLE: np.float32, DOUBLE: np.float64}
SIGNED = st.integers(-(2**63), 2**63 - 1)
ROUND = st.integers(0, 63).flatmap(lambda k: st.integers(0, 3).map(lambda more: (1 << k) + more))


@pytest.mark.parametrize("bits", FLOATS)
@given(value=SIGNED)
@example(-(2**63))
@example(2**63 - 1)
@example(2**24 + 1)
@example(2**53 + 1)
def test_signed(bits: int, value: int) -> None:
    for each in (value, value >> 12, value >> 40):
        assert fits_whole(np.array([0, each]), bits) == (int(FLOATS[bits](each)) == each)


@pytest.mark.parametrize("bits", FLOATS)
@given(value=ROUND)
@example(2**64 - 1)
def test_unsigned(bits: int, value: int) -> None:
    held = np.array([value], dtype=np.uint64)
    assert fits_whole(held, bits) == (int(FLOATS[bits](value)) == value)


def test_nothing_and_small_types() -> None:
    assert fits_whole(np.zeros(0, dtype=np.int64), SINGLE)
    assert fits_whole(np.array([-128, 127], dtype=np.int8), SINGLE)
    assert not fits_whole(np.array([-(2**31) + 1], dtype=np.int32), SINGLE)
