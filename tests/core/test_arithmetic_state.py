"""Threads whose arithmetic is not IEEE's: libraries built with -ffast-math switch denormals off."""

from __future__ import annotations

import ctypes
import platform
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from distributions import denormal, uniform

import liftmesh

LIBM = ctypes.CDLL("libm.so.6")
IS_X86 = platform.machine() == "x86_64"
# In glibc's fenv_t: where the control word is, and its bits.
CONTROL_AT = 28 if IS_X86 else 0
UPWARD, WITHOUT_DENORMALS = (0x4000, 0x8040) if IS_X86 else (0x400000, 0x1000000)
STICKY = 0x3F if IS_X86 else 0


def control_word() -> int:
    environment = (ctypes.c_uint32 * 16)()
    LIBM.fegetenv(environment)
    return int(environment[CONTROL_AT // 4]) & ~STICKY


@contextmanager
def arithmetic(bits: int) -> Iterator[None]:
    """Set bits of the control word of this thread."""
    environment, former = (ctypes.c_uint32 * 16)(), (ctypes.c_uint32 * 16)()
    LIBM.fegetenv(environment)
    LIBM.fegetenv(former)
    environment[CONTROL_AT // 4] |= bits
    LIBM.fesetenv(environment)
    try:
        yield
    finally:
        LIBM.fesetenv(former)


@pytest.mark.parametrize("bits", [UPWARD, WITHOUT_DENORMALS], ids=["upward", "no denormals"])
@pytest.mark.parametrize("draw", [denormal, uniform])
def test_results_do_not_depend_on_the_state_of_the_thread(draw, bits: int) -> None:
    points = draw(10_000, np.random.default_rng(1))
    expected = liftmesh.delaunay(points).simplices
    with arithmetic(bits):
        found = liftmesh.delaunay(points).simplices
        after = control_word()
    assert after == control_word() | bits
    assert np.array_equal(found, expected)
