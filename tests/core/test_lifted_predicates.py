"""Exact signs of lifted points, held against rationals: weights, radii and a metric."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from liftmesh import _kernel
from liftmesh._typing import Floats

LIFTS = ("weights", "radii", "metric")
METRIC = (2.0, 0.5, 1.25)
CASES = 120


def height(lift: str, point: Floats, value: float, metric: tuple[float, ...]) -> Fraction:
    x, y = (Fraction(float(coordinate)) for coordinate in point)
    if lift == "metric":
        a, b, c = map(Fraction, metric)
        return a * x * x + 2 * b * x * y + c * y * y
    lowering = Fraction(value) if lift == "weights" else Fraction(value) ** 2
    return x * x + y * y - lowering


def turn(p: Floats, q: Floats, r: Floats) -> Fraction:
    (px, py), (qx, qy), (rx, ry) = ([Fraction(float(v)) for v in point] for point in (p, q, r))
    return (qx - px) * (ry - py) - (qy - py) * (rx - px)


def side(sites: Floats, heights: list[Fraction], canonical: bool) -> int:
    """The determinant by its definition; ties by an infinitesimal for each place in the order."""
    coefficients = [heights]
    if canonical:
        order = sorted(range(4), key=lambda i: tuple(sites[i]), reverse=True)
        coefficients += [[Fraction(i == j) for j in range(4)] for i in order]
    turns = [turn(*np.delete(sites, i, axis=0)) for i in range(4)]
    for z in coefficients:
        determinant = sum(z[i] * turns[i] * (-1) ** i for i in range(4))
        if determinant:
            return 1 if determinant > 0 else -1
    return 0


def whole_numbers(rng: np.random.Generator, bits: int, *shape: int) -> Floats:
    return rng.integers(0, 2**bits, (CASES, 4, *shape)).astype(float)


def families(rng: np.random.Generator) -> dict[str, tuple[Floats, Floats]]:
    """Four points each, and their values."""
    small = rng.integers(0, 4, (CASES, 4, 2)).astype(float)
    wide = rng.choice([-1.0, 1.0], (CASES, 4, 2)) * 2.0 ** rng.integers(-1074, 1023, (CASES, 4, 2))
    far = 2.0**40 + rng.integers(0, 5, (CASES, 4, 2)) / 1024
    return {
        "uniform": (rng.random((CASES, 4, 2)), rng.random((CASES, 4))),
        "lattice, equal": (small, np.full((CASES, 4), 3.0)),
        "lattice, integers": (small, rng.integers(0, 5, (CASES, 4)).astype(float)),
        "lattice, tiny values": (small, rng.integers(0, 3, (CASES, 4)) * 5e-324),
        "lattice, huge values": (small, rng.integers(0, 3, (CASES, 4)) * 4e307),
        "far": (far, rng.integers(0, 9, (CASES, 4)) / 2.0**20),
        "wide": (wide, 2.0 ** rng.integers(-1074, 1023, (CASES, 4))),
        "largest": (wide.clip(-1, 1) * 1.7e308, rng.choice([0, 1.7e308, 5e-324], (CASES, 4))),
        "denormal": (small * 5e-324, rng.integers(0, 5, (CASES, 4)) * 5e-324),
        "32 bits": (whole_numbers(rng, 32, 2), whole_numbers(rng, 31)),
        "excesses of 63 bits": (
            whole_numbers(rng, 29, 2),
            (2.0**63 - 2.0**11) * whole_numbers(rng, 1),
        ),
        "long mantissas": (rng.random((CASES, 4, 2)) * 1e200, rng.random((CASES, 4)) * 1e-200),
    }


@pytest.mark.parametrize("lift", LIFTS)
@pytest.mark.parametrize("canonical", [False, True])
@pytest.mark.parametrize("family", families(np.random.default_rng(0)))
def test_the_side_of_a_lifted_point(lift: str, canonical: bool, family: str) -> None:
    sites, values = families(np.random.default_rng(171))[family]
    signs = np.empty(CASES, dtype=np.int8)
    given = np.array([METRIC]) if lift == "metric" else values
    a, b, c, d = (np.ascontiguousarray(sites[:, k]) for k in range(4))
    _kernel.lifted_side(a, b, c, d, given, lift, signs, canonical)
    for four, value, sign in zip(sites, values, signs, strict=True):
        distinct = len({tuple(p) for p in four}) == 4
        if canonical and (turn(*four[:3]) == 0 or not distinct):
            continue  # the engine asks of triangles and other points only
        heights = [height(lift, p, v, METRIC) for p, v in zip(four, value, strict=True)]
        # The kernel's sign is for a triangle as it turns: that of the determinant.
        assert sign == side(four, heights, canonical), (four, value)


@pytest.mark.parametrize("lift", LIFTS)
def test_a_metric_and_heights_of_every_exponent(lift: str) -> None:
    rng = np.random.default_rng(172)
    sites = rng.choice([-1.0, 1.0], (CASES, 4, 2)) * rng.random((CASES, 4, 2))
    sites *= 2.0 ** rng.integers(-1022, 1023, (CASES, 4, 2))
    values = rng.random((CASES, 4)) * 2.0 ** rng.integers(-1022, 1023, (CASES, 4))
    metric = (1.7e308, 5e-324, 3e-300)
    signs = np.empty(CASES, dtype=np.int8)
    given = np.array([metric]) if lift == "metric" else values
    a, b, c, d = (np.ascontiguousarray(sites[:, k]) for k in range(4))
    _kernel.lifted_side(a, b, c, d, given, lift, signs, False)
    expected = [
        side(four, [height(lift, p, v, metric) for p, v in zip(four, value, strict=True)], False)
        for four, value in zip(sites, values, strict=True)
    ]
    assert signs.tolist() == expected
    assert set(expected) == {-1, 1}


@pytest.mark.parametrize("lift", LIFTS)
@pytest.mark.parametrize("unit", [1.0, 5e-324, 2.0**500])
@pytest.mark.parametrize("direction", [(1, 0), (0, 1), (2, -3), (-1, 1)])
def test_heights_on_a_line(lift: str, unit: float, direction: tuple[int, int]) -> None:
    rng = np.random.default_rng(173)
    steps = np.sort(np.argsort(rng.random((CASES, 9)), axis=1)[:, :3], axis=1)
    steps = np.where(rng.random((CASES, 1)) < 0.5, steps, steps[:, ::-1])
    sites = steps[:, :, None] * np.array(direction) * unit
    length = unit * np.hypot(*direction)
    root = {"weights": 2 * length**2, "radii": length, "metric": 1.0}[lift]
    values = rng.integers(0, 12, (CASES, 3)) * root
    signs = np.empty(CASES, dtype=np.int8)
    given = np.array([METRIC]) if lift == "metric" else values
    a, b, c = (np.ascontiguousarray(sites[:, k]) for k in range(3))
    _kernel.height_between(a, b, c, given, lift, signs)
    found = set()
    for three, step, value, sign in zip(sites, steps, values, signs, strict=True):
        za, zb, zc = (height(lift, p, v, METRIC) for p, v in zip(three, value, strict=True))
        before, after = (Fraction(int(abs(step[1] - step[k]))) for k in (0, 2))
        above = zb * (before + after) - (za * after + zc * before)
        assert sign == (above > 0) - (above < 0), (three, value)
        found.add(int(sign))
    assert lift == "metric" or unit != 1.0 or found >= {-1, 1}
