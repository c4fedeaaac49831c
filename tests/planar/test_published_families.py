"""Point sets that others published because programs failed on them: here each result is exact.

Every family names its source: a paper, or the report of a failure in another library, by its
repository and number. The points are made as they are described there.
"""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest
import twin
from clouds import on_radius_325
from distributions import circle, lattice
from meshes import assert_delaunay, assert_oracle_agrees
from numpy.typing import NDArray

import liftmesh

Points = NDArray[np.float64]

FEW = 500
ULP_BELOW_ONE = 2.0**-53


def assert_exact(points: Points, result: liftmesh.Triangulation | None = None) -> None:
    """Check the whole result exactly against nothing but the points; few also in whole numbers."""
    result = liftmesh.delaunay(points) if result is None else result
    certificate = liftmesh.verify(points, result.simplices)
    assert certificate, certificate
    assert certificate.canonical
    if len(points) <= FEW:
        assert_delaunay(points, result.simplices)


def turned_grid(columns: int, lines: int, degrees: float) -> Points:
    angle = np.deg2rad(degrees)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.indices((columns, lines)).reshape(2, -1).T @ rotation.T


class TestRotatedUnitGrids:
    """mapbox/delaunator #61 and abellgithub/delaunator-cpp #8: large triangles across the grid.

    J. R. Shewchuk, "Triangle: Engineering a 2D Quality Mesh Generator and Delaunay Triangulator"
    (1996), times a tilted grid among its three distributions.
    """

    @pytest.mark.parametrize("tens", range(0, 90, 10))
    def test_in_steps_of_half_a_degree(self, tens):
        for degrees in np.arange(tens, tens + 10.25, 0.5):
            assert_exact(turned_grid(6, 8, degrees))
            assert_exact(turned_grid(40, 30, degrees))

    @pytest.mark.parametrize("degrees", [0, 1e-9, 8.207, 30, 45, 60, 89.999999, 90])
    def test_at_a_few_angles_point_by_point(self, degrees):
        assert_exact(turned_grid(12, 9, degrees))

    def test_the_one_that_was_reported(self):
        assert_exact(turned_grid(300, 300, 302.328))


class TestOrientationGrids:
    """L. Kettner, K. Mehlhorn, S. Pion, S. Schirra, C. Yap, "Classroom examples of robustness
    problems in geometric computations" (2008): a grid of 256 x 256 doubles side by side, and two
    points far off, on a line with its corner or nearly so. `test_predicates` asks for the signs.
    """

    @pytest.mark.parametrize(
        ("corner", "second", "third"),
        [
            ((0.5, 0.5), (12.0, 12.0), (24.0, 24.0)),
            (
                (0.50000000000002531, 0.5000000000000171),
                (17.300000000000001, 17.300000000000001),
                (24.00000000000005, 24.0000000000000517765),
            ),
            ((0.5, 0.5), (8.8000000000000007, 8.8000000000000007), (12.1, 12.1)),
        ],
    )
    def test_the_grid_and_both_points(self, corner, second, third):
        grid = np.indices((256, 256)).reshape(2, -1).T * ULP_BELOW_ONE + corner
        points = np.vstack((grid, second, third))
        result = liftmesh.delaunay(points)
        assert len(result.duplicates) == 0
        assert_exact(points, result)


class TestOneIntegerCircle:
    """The sixty integer points at distance 325 = 5^2 13 from the origin.

    Their number is that of the theorem on sums of two squares: 4 (4 + 1) (2 + 1). G. H. Hardy and
    E. M. Wright, "An Introduction to the Theory of Numbers", theorem 278.
    """

    @pytest.mark.parametrize("scale", [1.0, 2.0**-1074, 2.0**-500, 2.0**1015])
    @pytest.mark.parametrize("centre", [0, 1])
    def test_all_of_them_with_their_centre_and_without(self, scale, centre):
        points = np.vstack((on_radius_325(), np.zeros((centre, 2)))) * scale
        assert len(points) == 60 + centre
        assert_exact(points)

    def test_any_few_of_them(self):
        rng = np.random.default_rng(325)
        for size in range(3, 61):
            points = rng.choice(on_radius_325(), size, replace=False)
            assert_oracle_agrees(points, liftmesh.delaunay(points).simplices)


class TestTwoDenseColumns:
    """The longest seam: every edge from one column to the other crosses the cut between them, in
    the merge of D. T. Lee and B. J. Schachter, "Two algorithms for constructing a Delaunay
    triangulation" (1980). libgeos/geos #1286: a column that is none by 10^-14, and a point beside.
    """

    N = 100_000

    def test_at_random_heights(self):
        rng = np.random.default_rng(2)
        assert_exact(np.column_stack((np.repeat([0.0, 1.0], self.N), rng.random(2 * self.N))))

    def test_at_equal_heights(self):
        """Every cell is a rectangle."""
        heights = np.tile(np.arange(self.N) * 0.001, 2)
        assert_exact(np.column_stack((np.repeat([0.0, 1e-3], self.N), heights)))

    def test_columns_that_are_no_lines(self):
        rng = np.random.default_rng(3)
        x = np.repeat([-1.389e-10, 1.0], 2000) + rng.uniform(-1e-14, 1e-14, 4000)
        assert_exact(np.column_stack((x, rng.uniform(-15, 5, 4000))))

    def test_the_four_points_that_were_reported(self):
        points = [
            (-1.3890020986020145e-10, 4.860466764224401),
            (-1.3889120965221466e-10, -5.531838081766228),
            (-1.388852095135568e-10, -12.460041312426647),
            (0.9999999999166641, -3.799787274101123),
        ]
        assert_exact(np.array(points))


def test_a_million_points_on_a_circle() -> None:
    """J. R. Shewchuk, "Triangle" (1996): random points, cocircular but for rounding."""
    assert_exact(circle(1_000_000, np.random.default_rng(10)))


@pytest.mark.campaign
def test_six_million_points_of_a_grid_in_the_unit_box() -> None:
    """abellgithub/delaunator-cpp #19: 3017 x 2018, each range divided by its greatest value."""
    columns, lines = 3017, 2018
    points = np.empty((columns * lines, 2))
    points[:, 0] = np.repeat(np.arange(columns) / (columns - 1), lines)
    points[:, 1] = np.tile(np.arange(lines) / (lines - 1), columns)
    result = liftmesh.delaunay(points)
    assert len(result.simplices) == 2 * (columns - 1) * (lines - 1)
    assert_exact(points, result)


class TestTenCoincidentClusters:
    """d3/d3-delaunay #118 and andreesteve/voronoice #11: points that coincide, or nearly so."""

    N = 20_000

    @pytest.fixture
    def centres(self) -> Points:
        return np.random.default_rng(118).uniform(-100, 100, (10, 2))

    def test_of_equal_points(self, centres):
        rows = np.random.default_rng(11).permutation(np.repeat(np.arange(10), self.N))
        points = centres[rows]
        result = liftmesh.delaunay(points)
        assert len(result.duplicates) == 10 * self.N - 10
        assert_oracle_agrees(
            points[(used := np.unique(result.simplices))], np.searchsorted(used, result.simplices)
        )

    def test_of_points_within_a_few_ulps(self, centres):
        rng = np.random.default_rng(12)
        steps = rng.integers(-3, 4, (10, 2000, 2))
        points = (centres[:, None] + steps * np.spacing(centres)[:, None]).reshape(-1, 2)
        result = liftmesh.delaunay(points)
        assert len(np.unique(result.simplices)) == 10 * 49
        assert_exact(points, result)


class TestPointsAt1em16FromOneAnother:
    """mourner/delaunator-rs #18: five points, of which a triangulation lost one."""

    def test_the_five_that_were_reported(self):
        steps = [(0, 0), (1, 1), (2, 1), (-2, 1), (-2.5, 2)]
        assert_exact(np.array(steps) * 2.220446049250313e-16)

    @pytest.mark.parametrize("near", [0.0, 1e-16, 0.25, 0.5, 1.0])
    def test_a_lattice_of_them(self, near):
        assert_exact(lattice(484, np.random.default_rng(16)) * 1e-16 + near)


class TestDenormals:
    """qhull/qhull #166: crashes that a fuzzer found, most with denormal coordinates."""

    def test_every_triangle_of_a_lattice(self):
        rows = np.array([*product(range(-2, 3), repeat=2)]) * 2.0**-1074
        corners = rows[np.array([*combinations(range(len(rows)), 3)])]
        turns = twin.turns(twin.rational(corners))
        for points, turn in zip(corners, turns, strict=True):
            if turn:
                (row,) = liftmesh.delaunay(points).simplices.tolist()
                assert row in ([0, 1, 2], [1, 2, 0], [2, 0, 1]) if turn > 0 else row[::-1]
            else:
                with pytest.raises(liftmesh.DegenerateInputError):
                    liftmesh.delaunay(points)

    @pytest.mark.parametrize("bits", [2, 10, 40, 52])
    def test_many_at_once(self, bits):
        steps = np.random.default_rng(bits).integers(-(2**bits), 2**bits, (500, 2))
        assert_exact(steps * 2.0**-1074)

    def test_the_six_that_were_reported(self):
        x = [6.08907e-310, 1.70091e-313, 1.34563e-284, 2.17292e-311, -1.99372e81, 5.59505e141]
        y = [5.59505e141, 5.59505e141, 5.59505e141, 32.502, 32.502, 32.502]
        assert_exact(np.column_stack((x, y)))


class TestHugeWithTiny:
    """Squares of 1e200 overflow and those of 1e-200 vanish: no filter in doubles holds both. Spade
    (Rust) refuses what is below 2^-142 or above 2^201; artem-ogre/CDT #154 never ended on 1e38.
    """

    def test_every_pair_of_magnitudes(self):
        values = [-1e200, -1e-200, 0.0, 1e-200, 1e200]
        assert_exact(np.array([*product(values, values)]))

    def test_a_few_hundred_at_random(self):
        rng = np.random.default_rng(200)
        assert_exact(rng.uniform(-1, 1, (400, 2)) * rng.choice([1e200, 1e-200], (400, 2)))

    def test_the_two_that_were_reported_and_a_third(self):
        assert_exact(np.array([[0.0, 1e38], [1.0, 1e38], [0.5, -1e-38]]))
