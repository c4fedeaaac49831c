"""Every sign in space against exact integers: plain determinants, and for ties the printed rule."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.random import Generator
from numpy.typing import NDArray
from oracles import planar, space as oracle

import liftmesh

Doubles = NDArray[np.float64]
Corners = list[oracle.Point]

FINITE = st.floats(allow_nan=False, allow_infinity=False)
SMALL = st.integers(-2, 2).map(float)
STEPS = st.integers(-3, 3).map(lambda steps: steps * 2.0**-1074)
ULPS = st.integers(-3, 3).map(lambda steps: 1 + steps * 2.0**-52)
HUGE = st.integers(-3, 3).map(lambda steps: steps * 2.0**1021)
POINT = st.tuples(*[st.one_of(FINITE, SMALL, STEPS, ULPS, HUGE)] * 3)
LATTICE_POINT = st.tuples(*[SMALL] * 3)


def sign(value: int) -> int:
    return (value > 0) - (value < 0)


def in_sphere(*corners: oracle.Point) -> int:
    """The sum of the heights above the last point, each times the volume of the others."""
    *four, e = corners
    total = 0
    for i, p in enumerate(four):
        height = sum((u - v) ** 2 for u, v in zip(p, e, strict=True))
        total += height * oracle.volume(*(e if k == i else q for k, q in enumerate(four)))
    return total


def tie(*corners: oracle.Point) -> int:
    """The first of the five, from the largest down, that decides a zero."""
    *four, e = corners
    for largest in sorted(corners, reverse=True):
        if largest == e:
            return -1
        volume = oracle.volume(*(e if p == largest else p for p in four))
        if volume:
            return sign(volume)
    return 0


def expected_sign(corners: Corners) -> int:
    return sign((oracle.volume if len(corners) == 4 else in_sphere)(*corners))


def signs_of(points: Doubles, **options: bool) -> NDArray[np.int8]:
    decide = liftmesh.orient3d if points.shape[1] == 4 else liftmesh.insphere
    return decide(*np.moveaxis(points, 1, 0), **options)


def assert_signs(points: Doubles) -> None:
    expected = [expected_sign(planar.exact(rows)) for rows in points.tolist()]
    wrong = np.flatnonzero(signs_of(points) != expected)
    assert not len(wrong), f"{len(wrong)} wrong signs, such as {points[wrong[0]].tolist()}"


def any_doubles(shape: tuple[int, ...], rng: Generator) -> Doubles:
    mantissa = rng.uniform(0.5, 1, shape) * rng.choice([-1.0, 1.0], shape)
    return np.ldexp(mantissa, rng.integers(-1074, 1025, shape))


def one_exponent(shape: tuple[int, ...], rng: Generator) -> Doubles:
    return np.ldexp(rng.uniform(-1, 1, shape), rng.integers(-1080, 1020, (shape[0], 1, 1)))


def nearly_flat(shape: tuple[int, ...], rng: Generator) -> Doubles:
    """Within an ulp of a plane through the origin, at any scale."""
    points = rng.uniform(-1, 1, shape)
    points[..., 2] = points[..., :2] @ [0.25, -1 / 3]
    points += rng.integers(-1, 2, shape) * np.spacing(points)
    return np.ldexp(points, rng.integers(-1000, 1000, (shape[0], 1, 1)))


def nearly_cospherical(shape: tuple[int, ...], rng: Generator) -> Doubles:
    """On the unit sphere, rounded: some around a centre far away."""
    points = rng.normal(size=shape)
    points /= np.linalg.norm(points, axis=-1, keepdims=True)
    points += rng.choice([0.0, 1.0, 1e6], (shape[0], 1, 1))
    return np.ldexp(points, rng.integers(-900, 900, (shape[0], 1, 1)))


def small_steps(shape: tuple[int, ...], rng: Generator) -> Doubles:
    """Small integers, scaled and moved: on the lattice of the last bit, ends of the range too."""
    scales = [2.0**-1074, 2.0**-540, 2.0**-52, 1.0, 2.0**500, 2.0**1020]
    scale = rng.choice(scales, (shape[0], 1, 1))
    return rng.integers(-3, 4, shape) * scale + rng.choice([0.0, 1.0, 0.1], (shape[0], 1, 1))


def decimals(shape: tuple[int, ...], rng: Generator) -> Doubles:
    """Of wildly mixed decimal magnitudes, as published files of predicates hold them."""
    points = rng.choice([-1.0, 1.0], shape) * 10.0 ** rng.uniform(0, 34, shape)
    return np.array([float(f"{value:.16e}") for value in points.flat]).reshape(shape)


FAMILIES = [any_doubles, one_exponent, nearly_flat, nearly_cospherical, small_steps, decimals]


@pytest.mark.parametrize("corners", [4, 5], ids=["orient3d", "insphere"])
@pytest.mark.parametrize("draw", FAMILIES)
def test_signs_of_every_family(draw, corners: int) -> None:
    assert_signs(draw((400, corners, 3), np.random.default_rng(corners)))


@pytest.mark.parametrize("corners", [4, 5], ids=["orient3d", "insphere"])
def test_lattices_of_every_width(corners: int) -> None:
    """Integers of two to 130 bits, tied and nearly tied: each rung up to its border."""
    rng = np.random.default_rng(7)
    points = np.ldexp(rng.integers(-(2**15), 2**15, (800, corners, 3)).astype(float), 30)
    bits = rng.integers(2, 131, (800, 1, 1))
    points = np.floor(np.ldexp(points, np.minimum(bits, 53) - 45))
    points[::2, -1] = points[::2, :3].sum(axis=1) - 2 * points[::2, 1]  # coplanar
    moved = points[::2, -1] + rng.integers(-1, 2, (400, 3))
    points[::2, -1] = np.where(rng.random((400, 1)) < 0.5, moved, points[::2, -1])
    points[:, 0] = np.ldexp(points[:, 0], np.maximum(bits[:, 0] - 53, 0))
    assert_signs(np.ldexp(points, rng.integers(-1000, 800, (800, 1, 1))))


def test_orientation_continues_that_of_the_plane() -> None:
    rng = np.random.default_rng(3)
    flat = np.concatenate((rng.normal(size=(50, 3, 2)), np.zeros((50, 3, 1))), axis=2)
    above = flat.mean(axis=1) + np.array([0, 0, 1])
    a, b, c = np.moveaxis(flat, 1, 0)
    np.testing.assert_array_equal(
        liftmesh.orient3d(a, b, c, above), liftmesh.orient2d(a[:, :2], b[:, :2], c[:, :2])
    )


@settings(max_examples=150)
@given(POINT, POINT, POINT, POINT, POINT)
def test_any_doubles_and_any_order(a, b, c, d, e) -> None:
    a_, b_, c_, d_, e_ = planar.exact((a, b, c, d, e))
    volume, side = expected_sign([a_, b_, c_, d_]), expected_sign([a_, b_, c_, d_, e_])
    assert liftmesh.orient3d(a, b, c, d) == volume
    assert liftmesh.orient3d(b, c, a, d) == volume
    assert liftmesh.orient3d(a, b, d, c) == -volume
    assert liftmesh.insphere(a, b, c, d, e) == side
    assert liftmesh.insphere(b, a, d, c, e) == side
    assert liftmesh.insphere(a, c, b, d, e) == -side


@settings(max_examples=300)
@given(*[st.one_of(LATTICE_POINT, POINT)] * 5)
def test_ties_follow_the_rule(a, b, c, d, e) -> None:
    corners = planar.exact((a, b, c, d, e))
    volume = oracle.volume(*corners[:4])
    found = int(liftmesh.insphere(a, b, c, d, e, canonical=True))
    if volume == 0 or corners[4] in corners[:4]:
        assert found == 0 or in_sphere(*corners)
    else:
        if volume < 0:
            corners[:2] = corners[1::-1]
        assert found == sign(volume) * (sign(in_sphere(*corners)) or tie(*corners))
        assert found != 0


def test_every_sign_of_an_ulp_grid_around_a_sphere_and_a_plane() -> None:
    steps = np.indices((12, 12, 12)).reshape(3, -1).T - 6.0
    on_sphere = np.array([2 / 3, 2 / 3, 1 / 3]) + steps * 2.0**-53
    corners = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0], [-1.0, 0, 0]]
    sphere = np.broadcast_to(corners, (len(steps), 4, 3))
    assert_signs(np.concatenate((sphere, on_sphere[:, None]), axis=1))
    on_plane = np.array([0.2, 0.3, 0.5]) + steps * 2.0**-54
    assert_signs(np.concatenate((sphere[:, :3], on_plane[:, None]), axis=1))


class TestShapes:
    @pytest.mark.parametrize("shape", [(), (0,), (5,), (2, 3)])
    def test_signs_have_the_shape_of_the_questions(self, shape: tuple[int, ...]) -> None:
        points = np.random.default_rng(0).random((5, *shape, 3))
        for signs in (liftmesh.orient3d(*points[:4]), liftmesh.insphere(*points)):
            assert signs.shape == shape
            assert signs.dtype == np.int8

    @pytest.mark.parametrize("bad", [[1.0, 2.0], 1.0, [np.nan, 0.0, 1.0], [0.0, np.inf, 0], "abc"])
    def test_what_is_no_point_in_space_is_refused(self, bad) -> None:
        corner = (0, 0, 0), (1, 0, 0), (0, 1, 0)
        with pytest.raises(liftmesh.LiftmeshError):
            liftmesh.orient3d(*corner, bad)
        with pytest.raises(liftmesh.LiftmeshError):
            liftmesh.insphere(*corner, (0, 0, 1), bad)
