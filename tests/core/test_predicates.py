"""Every sign against exact arithmetic: the whole exponent range, grids of ulps, cocircular points.

The exact signs come from integers on the inputs' common lattice, by plain determinants, and for
ties by the rule as it is printed: from the largest point down.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from clouds import nearly_cocircular
from hypothesis import given, settings, strategies as st
from numpy.random import Generator
from numpy.typing import NDArray
from oracles import planar as oracle

import liftmesh

FINITE = st.floats(allow_nan=False, allow_infinity=False)
COINCIDENT = st.one_of(
    st.integers(-3, 3).map(float),
    st.integers(-3, 3).map(lambda steps: steps * 2.0**-1074),
    st.integers(-3, 3).map(lambda steps: 1 + steps * 2.0**-52),
    st.integers(-3, 3).map(lambda steps: steps * 2.0**1021),
)
COORDINATE = st.one_of(FINITE, COINCIDENT)
POINT = st.tuples(COORDINATE, COORDINATE)
INTEGER_POINT = st.tuples(st.integers(-3, 3).map(float), st.integers(-3, 3).map(float))

orientation = oracle.cross


def in_circle(a: oracle.Point, b: oracle.Point, c: oracle.Point, d: oracle.Point) -> int:
    """Determinant of the three differences to d and their squares: positive inside a ccw circle."""
    (ax, ay), (bx, by), (cx, cy) = ((p[0] - d[0], p[1] - d[1]) for p in (a, b, c))
    return (
        (ax * ax + ay * ay) * (bx * cy - cx * by)
        + (bx * bx + by * by) * (cx * ay - ax * cy)
        + (cx * cx + cy * cy) * (ax * by - bx * ay)
    )


def tie(a: oracle.Point, b: oracle.Point, c: oracle.Point, d: oracle.Point) -> int:
    """The rule for a zero: the first of the four, from the largest down, that decides."""
    for largest in sorted((a, b, c, d), reverse=True):
        if largest == d:
            return -1
        turn = orientation(*(d if corner == largest else corner for corner in (a, b, c)))
        if turn:
            return turn
    return 0


def sign(value: int) -> int:
    return (value > 0) - (value < 0)


def exact_signs(points: NDArray[np.float64]) -> list[int]:
    """Signs for an array of (k, 3, 2) orientations or (k, 4, 2) in-circle questions."""
    decide = orientation if points.shape[1] == 3 else in_circle
    return [sign(decide(*oracle.exact(rows))) for rows in points.tolist()]


def assert_signs(points: NDArray[np.float64]) -> None:
    """Compare all signs of the kernel at once with the exact ones."""
    decide = liftmesh.orient2d if points.shape[1] == 3 else liftmesh.incircle
    signs = decide(*np.moveaxis(points, 1, 0))
    wrong = np.flatnonzero(signs != exact_signs(points))
    assert not len(wrong), f"{len(wrong)} wrong signs, such as {points[wrong[0]].tolist()}"


def any_doubles(shape: tuple[int, ...], rng: Generator) -> NDArray[np.float64]:
    """Draw sign, exponent and mantissa apart: the whole range of finite doubles."""
    mantissa = rng.uniform(0.5, 1, shape) * rng.choice([-1.0, 1.0], shape)
    return np.ldexp(mantissa, rng.integers(-1074, 1025, shape))


def one_exponent(shape: tuple[int, ...], rng: Generator) -> NDArray[np.float64]:
    """Questions of ordinary numbers, each scaled by its own power of two."""
    exponent = rng.integers(-1080, 1020, (shape[0],) + (1,) * (len(shape) - 1))
    return np.ldexp(rng.uniform(-1, 1, shape), exponent)


def nearly_collinear(shape: tuple[int, ...], rng: Generator) -> NDArray[np.float64]:
    """All points within an ulp of one line through the origin, at any scale."""
    along = one_exponent((*shape[:-1], 1), rng)
    direction = rng.uniform(-1, 1, (shape[0],) + (1,) * (len(shape) - 2) + (2,))
    points = along * direction
    return points + rng.integers(-1, 2, shape) * np.spacing(points)


def small_steps(shape: tuple[int, ...], rng: Generator) -> NDArray[np.float64]:
    """Small integers, scaled and moved: on the lattice of the last bit, ends of the range too."""
    per_question = (shape[0],) + (1,) * (len(shape) - 1)
    scale = rng.choice([2.0**-1074, 2.0**-540, 2.0**-52, 1.0, 2.0**500, 2.0**1020], per_question)
    return rng.integers(-4, 5, shape) * scale + rng.choice([0.0, 1.0, 0.1], per_question)


@pytest.mark.parametrize("corners", [3, 4], ids=["orient2d", "incircle"])
@pytest.mark.parametrize(
    "draw", [any_doubles, one_exponent, nearly_collinear, nearly_cocircular, small_steps]
)
def test_thousands_of_signs(draw, corners: int) -> None:
    assert_signs(draw((3000, corners, 2), np.random.default_rng(corners)))


@pytest.mark.parametrize("corners", [3, 4], ids=["orient2d", "incircle"])
def test_lattices_of_every_width(corners: int) -> None:
    """Integers of two to sixty bits at many scales: every fixed-width rung, up to its border."""
    rng = np.random.default_rng(5)
    bits = rng.integers(2, 61, (6000, 1, 1))
    mantissa = np.floor(rng.uniform(-1, 1, (6000, corners, 2)) * 2.0**53) / 2.0**53
    points = np.floor(np.ldexp(mantissa, bits))
    points[::2, -1] = points[::2, 0] + points[::2, 1] - points[::2, 2]
    assert_signs(np.ldexp(points, rng.integers(-1074, 960, (6000, 1, 1))))


@pytest.mark.parametrize("corners", [3, 4], ids=["orient2d", "incircle"])
def test_coordinates_that_just_fit_a_word(corners: int) -> None:
    """Reflections, some moved by an ulp along an axis: coordinates that span 53 to 69 bits."""
    rng = np.random.default_rng(6)
    x = rng.uniform(0.5, 1, 6000)
    y = np.ldexp(rng.uniform(0.5, 1, 6000), -rng.integers(0, 17, 6000))
    circle = np.array([(x, y), (y, x), (-x, y), (y, -x), (-y, x), (x, -y), (-x, -y), (-y, -x)])
    line = np.array([(x, y), (-x, -y), (2 * x, 2 * y), (-4 * x, -4 * y)])
    some = np.moveaxis(circle if corners == 4 else line, 2, 0)
    chosen = rng.permuted(np.tile(np.arange(some.shape[1]), (6000, 1)), axis=1)[:, :corners]
    points = np.take_along_axis(some, chosen[:, :, None], axis=1)
    points[:, -1] += rng.integers(0, 2, (6000, 2)) * np.spacing(points[:, -1])
    assert_signs(np.ldexp(points, rng.integers(-1000, 1020, (6000, 1, 1))))


@settings(max_examples=500)
@given(POINT, POINT, POINT)
def test_orientation_of_any_doubles(a, b, c) -> None:
    expected = sign(orientation(*oracle.exact((a, b, c))))
    assert liftmesh.orient2d(a, b, c) == expected
    assert liftmesh.orient2d(b, c, a) == expected
    assert liftmesh.orient2d(b, a, c) == -expected


@pytest.mark.slow
@settings(max_examples=500)
@given(POINT, POINT, POINT, POINT)
def test_in_circle_of_any_doubles(a, b, c, d) -> None:
    expected = sign(in_circle(*oracle.exact((a, b, c, d))))
    assert liftmesh.incircle(a, b, c, d) == expected
    assert liftmesh.incircle(c, a, b, d) == expected
    assert liftmesh.incircle(b, a, c, d) == -expected


@pytest.mark.slow
@settings(max_examples=800)
@given(*[st.one_of(INTEGER_POINT, POINT)] * 4)
def test_ties_follow_the_rule(a, b, c, d) -> None:
    corners = oracle.exact((a, b, c, d))
    if orientation(*corners[:3]) < 0:
        a, b, corners = b, a, [corners[1], corners[0], *corners[2:]]
    if orientation(*corners[:3]) > 0 and corners[3] not in corners[:3]:
        expected = sign(in_circle(*corners) or tie(*corners))
        assert expected != 0
        assert liftmesh.incircle(a, b, c, d, canonical=True) == expected


def test_every_tie_of_an_exact_circle() -> None:
    x, y = (np.indices((51, 51)) - 25).astype(np.float64)
    on_circle = np.column_stack((x[x * x + y * y == 625], y[x * x + y * y == 625]))
    rng = np.random.default_rng(8)
    questions = np.array([rng.choice(on_circle, 4, replace=False) for _ in range(2000)])
    a, b, c, d = np.moveaxis(questions, 1, 0)
    swap = liftmesh.orient2d(a, b, c) < 0
    a, b = np.where(swap[:, None], b, a), np.where(swap[:, None], a, b)
    assert (liftmesh.incircle(a, b, c, d) == 0).all()
    rows = np.stack((a, b, c, d), axis=1).tolist()
    expected = [sign(tie(*(tuple(map(int, p)) for p in row))) for row in rows]
    np.testing.assert_array_equal(liftmesh.incircle(a, b, c, d, canonical=True), expected)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("origin", "first", "second"),
    [
        ((0.5, 0.5), (12.0, 12.0), (24.0, 24.0)),
        ((0.5, 0.5), (17.3, 17.3), (24.0, 24.0)),
        ((0.5, 0.5), (8.8000000000000007, 8.8000000000000007), (12.1, 12.1)),
        (
            (0.50000000000002531, 0.5000000000000171),
            (17.300000000000001, 17.300000000000001),
            (24.00000000000005, 24.0000000000000517765),
        ),
        ((1.0, 1.0), (3.0, 5.0), (-7.0, -15.0)),
        ((450000.1, 5200000.1), (450000.2, 5200000.2), (450001.1, 5200001.1)),
        ((0.0, 0.0), (2.0**-1060, 2.0**-1061), (2.0**-1050, 2.0**-1051)),
    ],
)
def test_every_sign_of_an_ulp_grid_around_a_line(origin, first, second) -> None:
    steps = np.indices((128, 128)).reshape(2, -1).T - 64.0
    grid = np.array(origin) + steps * np.spacing(np.array(origin))
    scale = 2**1074
    (ax, ay), (bx, by) = (
        tuple(int(Fraction(value) * scale) for value in point) for point in (first, second)
    )
    xs, ys = ([int(Fraction(value) * scale) for value in column] for column in grid.T.tolist())
    expected = [
        sign((ax - x) * (by - y) - (bx - x) * (ay - y)) for x, y in zip(xs, ys, strict=True)
    ]
    signs = liftmesh.orient2d(grid, first, second)
    assert np.count_nonzero(signs != expected) == 0
    assert len(np.unique(signs)) > 1


def test_in_circle_on_an_ulp_grid_around_a_circle() -> None:
    steps = np.indices((64, 64)).reshape(2, -1).T - 32.0
    d = np.array([0.6, 0.8]) + steps * 2.0**-53
    corners = np.broadcast_to([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]], (len(d), 3, 2))
    assert_signs(np.concatenate((corners, d[:, None]), axis=1))


def decimal_fixtures(corners: int) -> NDArray[np.float64]:
    """Questions of wildly mixed decimal magnitudes, as text files of predicates hold them."""
    rng = np.random.default_rng(1000 + corners)
    magnitude = rng.uniform(0, 34, (1000, corners, 2))
    points = rng.choice([-1.0, 1.0], magnitude.shape) * 10.0**magnitude
    return np.array([float(f"{value:.16e}") for value in points.flat]).reshape(points.shape)


@pytest.mark.parametrize("corners", [3, 4], ids=["orient2d", "incircle"])
def test_a_thousand_fixtures(corners: int) -> None:
    assert_signs(decimal_fixtures(corners))


class TestShapes:
    def test_one_question_gives_one_sign(self) -> None:
        assert liftmesh.orient2d((0, 0), (1, 0), (0, 1)) == 1
        assert np.ndim(liftmesh.orient2d((0, 0), (1, 0), (0, 1))) == 0

    @pytest.mark.parametrize("shape", [(0,), (5,), (2, 3)])
    def test_signs_have_the_shape_of_the_questions(self, shape: tuple[int, ...]) -> None:
        a, b, c, d = np.random.default_rng(0).random((4, *shape, 2))
        for signs in (
            liftmesh.orient2d(a, b, c),
            liftmesh.incircle(a, b, c, d),
            liftmesh.incircle(a, b, c, d, canonical=True),
        ):
            assert signs.shape == shape
            assert signs.dtype == np.int8

    def test_corners_broadcast(self) -> None:
        queries = np.random.default_rng(0).random((7, 2)) + 1
        np.testing.assert_array_equal(liftmesh.incircle((0, 0), (1, 0), (0, 1), queries), -1)

    @pytest.mark.parametrize("bad", [[1.0, 2.0, 3.0], 1.0, [np.nan, 0.0], [0.0, np.inf], "ab"])
    def test_what_is_no_planar_point_is_refused(self, bad) -> None:
        with pytest.raises(liftmesh.LiftmeshError):
            liftmesh.orient2d((0, 0), (1, 0), bad)
        with pytest.raises(liftmesh.LiftmeshError):
            liftmesh.incircle((0, 0), (1, 0), (0, 1), bad)


@given(INTEGER_POINT, INTEGER_POINT, INTEGER_POINT, INTEGER_POINT)
def test_the_canonical_side_has_the_signs_of_a_determinant(
    a: oracle.Point, b: oracle.Point, c: oracle.Point, d: oracle.Point
) -> None:
    side = int(liftmesh.incircle(a, b, c, d, canonical=True))
    assert int(liftmesh.incircle(b, a, c, d, canonical=True)) == -side
    assert int(liftmesh.incircle(b, c, a, d, canonical=True)) == side
    on_a_line = orientation(a, b, c) == orientation(a, b, d) == orientation(b, c, d) == 0
    assert (side == 0) == (len({a, b, c, d}) < 4 or on_a_line)
