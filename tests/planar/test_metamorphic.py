"""What must not change when the points do, over every cloud that hypothesis can think of.

The clouds are those of `strategies`. Few points are held against the exact oracle; for the rest a
result is held against another one, of the same points in another form:

* in another order, or at another place or scale where that loses no bit: the same triangles, for
  the order by x, then y, which breaks ties, is the same;
* mirrored, turned or transposed: the order is another one, so cells of four or more cocircular
  points may be cut otherwise, and nothing else. How they are cut is known: by their definition,
  the last vertex in the new order is cut off as an ear, and so on. So the mirrored result is
  predicted in full from the cells of the first one;
* with other threads, dtypes, strides and engines: the same bits, or the same triangles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import get_args

import hypothesis.strategies as st
import numpy as np
import pytest
import twin
from hypothesis import assume, given, settings
from meshes import (
    assert_oracle_agrees,
    assert_same_triangles,
    bits,
    oracle_triangles,
    triangle_rows,
)
from numpy.typing import NDArray
from oracles import planar as oracle
from strategies import ANY_MOTIF, COCIRCULAR_CLOUDS, FEW, MOTIFS, OFFSETS, Points, alone, clouds

import liftmesh
from liftmesh import _kernel
from liftmesh.base.options import Algorithm

Triangles = NDArray[np.int32]

SEEDS = st.integers(0, 2**32 - 1)
NO_TRIANGLES = np.empty((0, 3), dtype=np.int32)
SYMMETRIES: dict[str, Callable[[Points], Points]] = {
    "x mirrored": lambda p: p * (-1, 1),
    "y mirrored": lambda p: p * (1, -1),
    "transposed": lambda p: p[:, ::-1],
    "transposed and turned": lambda p: -p[:, ::-1],
    "turned by one right angle": lambda p: p[:, ::-1] * (-1, 1),
    "turned by two": lambda p: -p,
    "turned by three": lambda p: p[:, ::-1] * (1, -1),
}


def triangles(points: NDArray[np.floating], **options) -> Triangles:
    """The triangles; none for points that span no triangle."""
    try:
        return liftmesh.delaunay(points, **options).simplices
    except liftmesh.DegenerateInputError:
        return NO_TRIANGLES


def outcome(points: NDArray[np.floating], **options) -> list[bytes] | str:
    """All bits of the result, or what is said instead."""
    try:
        return bits(liftmesh.delaunay(points, **options))
    except liftmesh.DegenerateInputError as error:
        return str(error)


def assert_same_rows(points: Points, actual: Triangles, about: str = "") -> None:
    """Compare triangles over the same rows in another form with those of the points."""
    expected = triangle_rows(points, triangles(points))
    assert_same_triangles(triangle_rows(points, actual), expected, about)


class TestAgainstTheOracle:
    @pytest.mark.parametrize("motif", MOTIFS)
    def test_motifs(self, motif: str) -> None:
        @settings(max_examples=50)
        @given(alone(MOTIFS[motif]))
        def check(points: Points) -> None:
            assert_oracle_agrees(points, triangles(points), oracle_triangles(points))

        check()

    @settings(max_examples=300)
    @given(clouds())
    def test_clouds_of_several_motifs(self, points: Points) -> None:
        assert_oracle_agrees(points, triangles(points), oracle_triangles(points))


@settings(max_examples=150)
@given(clouds(most=60), SEEDS)
def test_no_order_of_the_rows_matters(points: Points, seed: int) -> None:
    order = np.random.default_rng(seed).permutation(len(points))
    shuffled = points[order]
    assert_same_rows(points, order[triangles(shuffled)])
    canonical = [triangles(rows, order="canonical") for rows in (points, shuffled)]
    np.testing.assert_array_equal(points[canonical[0]], shuffled[canonical[1]])


@st.composite
def moved_clouds(draw: st.DrawFn) -> tuple[Points, Points]:
    """A cloud, and the same at another place, where every sum is exact."""
    points = draw(st.one_of(clouds(most=60), alone(ANY_MOTIF), COCIRCULAR_CLOUDS))
    step = 2.0 ** exponents(points)[0]
    by_steps = st.tuples(st.integers(-(2**20), 2**20), st.integers(-(2**20), 2**20))
    shifts = [
        by_steps.map(lambda by: (by[0] * step, by[1] * step)),
        st.sampled_from((-points).tolist()),
        st.tuples(OFFSETS, OFFSETS),
    ]
    shift = np.array(draw(st.one_of(shifts)))
    with np.errstate(over="ignore"):
        moved = points + shift
    assume(np.isfinite(moved).all())
    assume((twin.rational(points) + twin.rational(shift) == twin.rational(moved)).all())
    return points, moved


@pytest.mark.slow
@settings(max_examples=150)
@given(moved_clouds())
def test_a_shift_without_rounding_changes_nothing(clouds: tuple[Points, Points]) -> None:
    points, moved = clouds
    assert_same_rows(points, triangles(moved))


def exponents(points: Points) -> tuple[int, int]:
    """Of the last bit that any coordinate has, and of the first one; 0 where all are zero."""
    ratios = [abs(value).as_integer_ratio() for value in points.ravel().tolist() if value]
    last = [(top & -top).bit_length() - bottom.bit_length() for top, bottom in ratios]
    first = [top.bit_length() - bottom.bit_length() for top, bottom in ratios]
    return min(last, default=0), max(first, default=0)


@pytest.mark.slow
@settings(max_examples=200)
@given(clouds(most=60), st.data())
def test_a_power_of_two_that_loses_no_bit_changes_nothing(points: Points, data) -> None:
    last, first = exponents(points)
    ends = -1074 - last, 1023 - first
    exponent = data.draw(st.one_of(st.sampled_from(ends), st.integers(*ends)))
    scaled = np.ldexp(points, exponent)
    np.testing.assert_array_equal(np.ldexp(scaled, -exponent), points)
    assert outcome(scaled) == outcome(points)


class TestSymmetries:
    """Mirrored and turned clouds: all that is left to choose is how a cocircular cell is cut."""

    @pytest.mark.parametrize("symmetry", SYMMETRIES)
    def test_the_image_follows_from_the_cells(self, symmetry: str) -> None:
        @settings(max_examples=40)
        @given(st.one_of(COCIRCULAR_CLOUDS, clouds()))
        def check(points: Points) -> None:
            image = np.ascontiguousarray(SYMMETRIES[symmetry](points))
            corners = oracle.exact(image.tolist())
            expected = {
                triangle
                for cell in cells(points)
                for triangle in oracle.cut_ears([corners[row] for row in cell])
            }
            assert_oracle_agrees(image, triangles(image), expected)

        check()

    def test_cells_of_a_lattice_are_its_squares(self) -> None:
        points = np.indices((4, 3)).reshape(2, -1).T.astype(np.float64)
        assert sorted(map(len, cells(points))) == [4] * 6


def cells(points: Points) -> list[list[int]]:
    """The cells of the Delaunay diagram, as rows around them, from the triangles liftmesh found.

    Two triangles are of one cell where their four points are cocircular, in rational numbers.
    """
    rows = triangles(points).tolist()
    sides = {side: number for number, row in enumerate(rows) for side in around(row)}
    inner = [(side, sides[side], sides[side[::-1]]) for side in sides if side[::-1] in sides]
    corners = [[*rows[one], *set(rows[other]) - set(side)] for side, one, other in inner]
    cocircular = twin.sides(twin.rational(points[np.reshape(corners, (-1, 4)).astype(int)])) == 0
    cell = list(range(len(rows)))
    for (_, one, other), joined in zip(inner, cocircular, strict=True):
        if joined:
            old, new = cell[other], cell[one]
            cell = [new if name == old else name for name in cell]
    return [border([rows[i] for i, name in enumerate(cell) if name == n]) for n in set(cell)]


def around(row: list[int]) -> Iterator[tuple[int, int]]:
    return zip(row, row[1:] + row[:1], strict=True)


def border(rows: list[list[int]]) -> list[int]:
    """The rows around some triangles, which lie side by side."""
    sides = {side for row in rows for side in around(row)}
    following = dict(side for side in sides if side[::-1] not in sides)
    cycle = [min(following)]
    while (ahead := following[cycle[-1]]) != cycle[0]:
        cycle.append(ahead)
    assert len(cycle) == len(following) == len(rows) + 2
    return cycle


@st.composite
def large_clouds(draw: st.DrawFn) -> Points:
    """A motif many times over, side by side and in many sizes: enough rows for many threads."""
    motif = np.array(draw(ANY_MOTIF) or [(0.0, 0.0)])
    count = draw(st.integers(1, 8)) * _kernel.ROWS_PER_THREAD + draw(FEW)
    rng = np.random.default_rng(draw(SEEDS))
    copies = -(-count // len(motif))
    places = rng.integers(0, 2 ** draw(st.integers(1, 10)), (copies, 1, 2))
    sizes = 2.0 ** -rng.integers(0, draw(st.integers(1, 20)), (copies, 1, 1))
    with np.errstate(over="ignore", invalid="ignore"):
        rows = (motif * sizes + places * np.ptp(motif, axis=0)).reshape(-1, 2)
    return rng.permutation(np.where(np.isfinite(rows), rows, 0.0)[:count])


@settings(max_examples=12)
@given(large_clouds())
def test_one_to_eight_threads_give_the_same_bits(points: Points) -> None:
    alone = outcome(points, threads=1)
    for threads in range(2, 9):
        assert outcome(points, threads=threads) == alone, threads


@settings(max_examples=100)
@given(clouds(most=60))
def test_single_precision_is_read_as_the_doubles_it_holds(points: Points) -> None:
    with np.errstate(over="ignore"):
        single = points.astype(np.float32)
    single = single[np.isfinite(single).all(axis=1)]
    assert outcome(single) == outcome(single.astype(np.float64))


@settings(max_examples=100)
@given(clouds(most=60), st.sampled_from([1, 2, 3, -1, -2]), st.sampled_from([1, 3, -1, -4]))
def test_strides_do_not_matter(points: Points, row_step: int, column_step: int) -> None:
    shape = len(points) * abs(row_step), 2 * abs(column_step)
    for order in ("C", "F"):
        view = np.full(shape, np.nan, order=order)[::row_step, ::column_step]
        view[...] = points
        assert outcome(view) == outcome(points)


@settings(max_examples=150)
@given(clouds(most=60), st.lists(st.tuples(st.integers(0, 59), st.integers(0, 1)), max_size=9))
def test_every_row_is_a_vertex_a_duplicate_or_skipped(
    points: Points, holes: list[tuple[int, int]]
) -> None:
    for row, column in holes:
        points[row % len(points), column] = np.nan if row % 2 else np.inf
    try:
        result = liftmesh.delaunay(points, nonfinite="skip")
    except liftmesh.DegenerateInputError:
        finite = points[np.isfinite(points).all(axis=1)]
        assert oracle_triangles(finite) == set()
        return
    vertices, (copies, kept) = np.unique(result.simplices), result.duplicates.T
    rows = np.concatenate((vertices, copies, result.skipped))
    np.testing.assert_array_equal(np.sort(rows), np.arange(len(points)))
    np.testing.assert_array_equal(result.skipped, np.nonzero(~np.isfinite(points).all(axis=1))[0])
    np.testing.assert_array_equal(points[copies], points[kept])
    assert np.isin(kept, vertices).all()
    assert (kept < copies).all()


@settings(max_examples=120)
@given(
    clouds(most=16), st.one_of(st.sampled_from(["origin", "median"]), st.tuples(OFFSETS, OFFSETS))
)
def test_every_engine_finds_the_same_triangles(points: Points, apex) -> None:
    for algorithm in get_args(Algorithm):
        assert_same_rows(points, triangles(points, algorithm=algorithm, apex=apex), algorithm)
