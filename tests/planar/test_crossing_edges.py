"""Edges that cross: named, or split, against exact rationals."""

from __future__ import annotations

import pickle
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import _kernel, constrained_delaunay
from liftmesh.planar import crossing_edges

SQUARE = [[0, 0], [3, 0], [3, 3], [0, 3]]


def test_all_crossings_are_named() -> None:
    with pytest.raises(liftmesh.CrossingError) as caught:
        constrained_delaunay(SQUARE, [[2, 0], [3, 1], [0, 2]])
    error = caught.value
    assert "2 pairs of edges cross where no row is: edge 0 from row 0 (0.0, 0.0) to row 2" in (
        str(error)
    )
    assert "row 3 (0.0, 3.0), at (1.5, 1.5). Add" in str(error)
    assert str(error).endswith("or give crossing='split'")
    assert error.crossings.tolist() == [[0, 1], [2, 1]]
    assert error.rows.tolist() == [[0, 2, 1, 3], [0, 2, 1, 3]]
    assert error.places.tolist() == [[1.5, 1.5], [1.5, 1.5]]
    twin = pickle.loads(pickle.dumps(error))
    np.testing.assert_array_equal(twin.crossings, error.crossings)
    assert str(twin) == str(error)


def test_crossings_of_lines_and_polygons_name_these() -> None:
    with pytest.raises(liftmesh.CrossingError, match=r"edge 1 \(of polyline 0\)") as caught:
        constrained_delaunay(
            SQUARE, [[0, 1]], polylines=[[0, 2]], polygons=[[[1, 0], [1, 3], [2, 3]]]
        )
    assert "(of polygon 0)" in str(caught.value)


def test_one_pair_crosses() -> None:
    with pytest.raises(liftmesh.CrossingError, match=r"^1 pair of edges crosses where no row is: "):
        constrained_delaunay(SQUARE, [[2, 0], [3, 1]])


def comb(teeth: int) -> tuple[list[list[float]], list[list[int]]]:
    points = [[-1.0, 0.5], [float(teeth), 0.5]]
    for k in range(teeth):
        points += [[float(k), 0.0], [float(k), 1.0]]
    return points, [[0, 1], *([2 * k + 2, 2 * k + 3] for k in range(teeth))]


def test_only_some_of_many_are_in_words() -> None:
    points, edges = comb(13)
    with pytest.raises(liftmesh.CrossingError, match=r"13 pairs .*; and 3 more. Add") as caught:
        constrained_delaunay(points, edges)
    assert len(caught.value.crossings) == len(caught.value.places) == 13


@pytest.mark.parametrize("first", [0, 1])
def test_all_spokes_of_a_star_cross_a_line(first: int) -> None:
    """Of one star, or of two at the ends of the same spokes."""
    spokes = 50
    points = [[0.0, 0.0], [-1.0, 1.0], [1.0 + spokes, 1.0], [float(spokes), 5.0]]
    points += [[k + 0.5, 2.0] for k in range(spokes)]
    edges = [[1, 2], *([0, 4 + k] for k in range(spokes)), *([3, 4 + k] for k in range(spokes))]
    with pytest.raises(liftmesh.CrossingError) as caught:
        constrained_delaunay(points, edges[::-1] if first else edges)
    pairs = caught.value.crossings.tolist()
    line = len(edges) - 1 if first else 0
    of_star = [len(edges) - 1 - k if first else k for k in range(1, spokes + 1)]
    assert {sum(pair) - line for pair in pairs} == set(of_star)
    assert len(pairs) == spokes


def test_the_order_of_edges_changes_nothing() -> None:
    rng = np.random.default_rng(3)
    points, edges = rng.random((20, 2)), rng.permutation(20).reshape(-1, 2)
    with pytest.raises(liftmesh.CrossingError) as one:
        constrained_delaunay(points, edges)
    turn = rng.permutation(10)
    with pytest.raises(liftmesh.CrossingError) as other:
        constrained_delaunay(points, edges[turn][:, ::-1])
    np.testing.assert_array_equal(one.value.rows, other.value.rows)
    np.testing.assert_array_equal(one.value.crossings, turn[other.value.crossings])
    np.testing.assert_array_equal(one.value.places, other.value.places)


def test_a_crossing_at_a_row_is_none() -> None:
    tri = constrained_delaunay([*SQUARE, [1.5, 1.5]], [[0, 2], [1, 3]])
    assert len(tri.constraints) == 4


def test_crossings_become_rows() -> None:
    points, edges = comb(4)
    tri = constrained_delaunay(points, edges, crossing="split")
    assert tri.crossing_rows.tolist() == [10, 11, 12, 13]
    assert sorted(tri.points[tri.crossing_rows].tolist()) == [[float(k), 0.5] for k in range(4)]
    assert (tri.displacement, len(tri.constraints), len(tri.input_edges)) == (0.0, 13, 5)
    along = [k for k in range(13) if 0 in tri.inputs_of(k)]
    assert len(along) == 5
    assert len(tri.added) == 0


@pytest.mark.parametrize("scale", [1e-290, 1e-30, 1.0, 1e300])
def test_displacement_is_the_largest_distance(scale: float) -> None:
    points = np.array([[0, 0], [10, 3], [0, 3], [10, 1]]) * scale
    tri = constrained_delaunay(points, [[0, 1], [2, 3]], crossing="split")
    (x, y), (a, b) = ([Fraction(c) for c in points[1]], [Fraction(c) for c in tri.points[4]])
    first = abs(x * b - y * a) ** 2 / (x * x + y * y)
    (p, q), (r, s) = ([Fraction(c) for c in points[2]], [Fraction(c) for c in points[3]])
    second = ((r - p) * (b - q) - (s - q) * (a - p)) ** 2 / ((r - p) ** 2 + (s - q) ** 2)
    exact = max(first, second)
    found = Fraction(tri.displacement) ** 2
    assert abs(found - exact) <= exact * Fraction(1, 10**12)
    assert len(tri.constraints) == 4


def exact_place(ends: list[float]) -> tuple[float, float]:
    a, b, c, d, p, q, r, s = map(Fraction, ends)
    along, across = (r - p) * (b - q) - (s - q) * (a - p), (r - p) * (d - b) - (s - q) * (c - a)
    return float(a - along / across * (c - a)), float(b - along / across * (d - b))


@settings(deadline=None, max_examples=60)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(["unit", "lattice", "far", "thin", "mixed", "tiny", "huge"]),
)
def test_places_of_crossings_are_rounded_once(seed: int, kind: str) -> None:
    rng = np.random.default_rng(seed)
    ends = rng.random((40, 8))
    if kind == "lattice":
        ends = rng.integers(-9, 10, (40, 8)) / 8
    ends *= {"thin": np.tile([1, 1e-14], 4), "tiny": 1e-310, "huge": 1e307}.get(kind, 1)
    ends += {"far": 5e6}.get(kind, 0)
    if kind == "mixed":
        ends = np.ldexp(ends, rng.integers(-80, 80, ends.shape))
    points = ends.reshape(-1, 2)
    turn = liftmesh.orient2d
    a, b, c, d = np.moveaxis(ends.reshape(-1, 4, 2), 1, 0)
    crosses = (turn(a, b, c) * turn(a, b, d) < 0) & (turn(c, d, a) * turn(c, d, b) < 0)
    rows = np.arange(160, dtype=np.int32).reshape(-1, 4)[crosses]
    found = crossing_edges._places(points, rows)
    assert found.tolist() == [[*exact_place(each)] for each in ends[crosses].tolist()]


@pytest.mark.parametrize(
    "ends",
    [
        [1497.1, -51.5, 1504.1, -57.8, 1494.9, -53.7, 1500.9, -54.7],  # halfway between doubles
        [2.2, 1.5, 2.6, 1.9, 1.7, 1.3, 2.9, 1.9],
        [1296.3, -0.3, 1297, 0.1, 1296.6, 0.3, 1297.5, -0.9],  # y is about 1e-17
        [1.1, 0.3, -1.1, -0.3, 3.3, 0.1, -3.3, -0.1],  # at zero
    ],
)
def test_places_beyond_double_words_are_rounded_once(ends: list[float]) -> None:
    place = np.empty((1, 2))
    _kernel.crossing_places(np.array([ends]), place)
    assert place.tolist() == [[*exact_place(ends)]]


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["unit", "thin", "lattice", "far"]))
def test_edges_are_chains_from_end_to_end(seed: int, kind: str) -> None:
    """With two rows of odd degree, and near their edges; nothing crosses any more."""
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 5, (14, 2)).astype(float) if kind == "lattice" else rng.random((14, 2))
    points *= [1, 1e-12] if kind == "thin" else 1
    points += 1e6 if kind == "far" else 0
    edges = rng.integers(0, 14, (7, 2))
    try:
        tri = constrained_delaunay(points, edges, crossing="split")
    except liftmesh.DegenerateInputError:
        return
    assert tri.displacement <= 2.0**-52 * np.abs(points).max() * 4
    kept = np.arange(tri.npoints)
    kept[tri.duplicates[:, 0]] = tri.duplicates[:, 1]
    indptr, members = tri.constraint_inputs
    piece = np.repeat(np.arange(len(tri.constraints)), np.diff(indptr))
    for k, (a, b) in enumerate(kept[edges].tolist()):
        degree = np.bincount(tri.constraints[piece[members == k]].ravel(), minlength=tri.npoints)
        assert np.flatnonzero(degree % 2).tolist() == ([] if a == b else sorted((a, b)))
        assert (k in tri.zero_length) == (a == b) == (not degree.any())
    i, j = np.triu_indices(len(tri.constraints), 1)
    (a, b), (c, d) = (tri.points[tri.constraints[each]].transpose(1, 0, 2) for each in (i, j))
    turn = liftmesh.orient2d
    crosses = (turn(a, b, c) * turn(a, b, d) < 0) & (turn(c, d, a) * turn(c, d, b) < 0)
    assert not crosses.any()


def turned_parcels(offset: tuple[float, float], seed: int) -> list[np.ndarray]:
    """Squares side by side, turned, with corners of their own on shared sides, and roads."""
    rng = np.random.default_rng(seed)
    turn = np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])
    lines = []
    for square in np.argwhere(np.ones((12, 12))):
        corners = (square + np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])) * 25.0 @ turn
        middle = corners[:-1] + rng.random((4, 1)) * np.diff(corners, axis=0)
        lines.append(np.insert(corners, [1, 2, 3, 4], middle, axis=0) + offset)
    return [*lines, *(rng.random((10, 2, 2)) * 300 @ turn + offset)]


ALONG_ONE_LINE = [
    np.array([[6.0, 0], [3, 7]]),
    np.array([[3.9000000000000004, 4.9], [5.1000000000000005, 2.0999999999999996]]),
    np.array([[7.0, 1], [1.4482758620689655, 5.758620689655173]]),
]


@pytest.mark.parametrize(
    "lines",
    [
        ALONG_ONE_LINE,
        turned_parcels((0, 0), 2),
        turned_parcels((500000, 5400000), 0),
        turned_parcels((500000, 5400000), 5),
    ],
)
def test_lines_that_are_the_same_but_for_rounding_are_split(lines: list[np.ndarray]) -> None:
    tri = constrained_delaunay([], polylines=lines, crossing="split")
    assert tri.displacement <= 4 * np.spacing(np.abs(tri.points).max())
    liftmesh.verify(tri)
    order = np.random.default_rng(1).permutation(len(lines))
    again = constrained_delaunay([], polylines=[lines[k][::-1] for k in order], crossing="split")
    assert sides(again) == sides(tri)


def sides(tri: liftmesh.ConstrainedTriangulation) -> set[frozenset[tuple[float, float]]]:
    return {frozenset(map(tuple, side)) for side in tri.points[tri.constraints].tolist()}


@pytest.mark.parametrize("bounds", [{"_MOST_ROUNDS": 0}, {"_GROWTH": 0, "_ALLOWANCE": 0}])
def test_rounds_are_bounded(bounds: dict[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in bounds.items():
        monkeypatch.setattr(crossing_edges, name, value)
    with pytest.raises(
        liftmesh.CrossingError,
        match=r"after 0 rounds .*edge 0 from row 0 .* and edge 1 .*, at \(1.5",
    ) as caught:
        constrained_delaunay(SQUARE, [[0, 2], [1, 3]], crossing="split")
    assert caught.value.crossings.tolist() == [[0, 1]]
    assert caught.value.rows.tolist() == [[0, 2, 1, 3]]
    assert caught.value.places.tolist() == [[1.5, 1.5]]


def test_bundles_nearer_than_rounding_are_named_by_their_rows() -> None:
    ends = np.repeat([[0.25, 0.125], [901.5, 981.25]], 20, axis=0)
    ends += np.random.default_rng(0).integers(-3, 4, ends.shape) * np.spacing(ends)
    pairs = np.arange(40).reshape(2, 20).T
    said = r"edge \d+ from row \d+ \(0.2.* to row .*, at \(.*nearer to each other .*; move them, or"
    with pytest.raises(liftmesh.CrossingError, match=said):
        constrained_delaunay(ends, pairs, crossing="split")
