"""refine: angles, sizes, what is proved of the result, and what is refused."""

from __future__ import annotations

import copy
import pickle
import warnings
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from stopped import LONG_RUN, seconds_to_stop

import liftmesh
from liftmesh import ConstrainedTriangulation, RefineResult, constrained_delaunay, refine
from liftmesh.planar.refined import below_angle

STRIP = [[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 1.0]]
SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
L_SHAPE = [[0.0, 0.0], [6.0, 0.0], [6.0, 2.0], [2.0, 2.0], [2.0, 6.0], [0.0, 6.0]]
HOLE = [[0.5, 0.5], [1.0, 0.75], [0.75, 1.5]]
HALVES = constrained_delaunay(SQUARE, [[0, 2]])

Array = np.ndarray[Any, Any]


def corners(tri: liftmesh.Triangulation) -> Array:
    return tri.points[tri.simplices]


def areas(tri: liftmesh.Triangulation) -> Array:
    a, b, c = corners(tri).transpose(1, 0, 2)
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return (ux * vy - uy * vx) / 2


def sides(tri: liftmesh.Triangulation) -> Array:
    """Lengths of the sides."""
    places = corners(tri)
    return np.hypot(*(places - np.roll(places, 1, axis=1)).transpose(2, 0, 1))


def smallest_angles(tri: liftmesh.Triangulation) -> Array:
    """By the law of cosines."""
    c, b, a = np.sort(sides(tri), axis=1).T
    cosine = (a**2 + b**2 - c**2) / (2 * a * b)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def as_set(result: RefineResult) -> set[Any]:
    """The triangles by the positions of their corners."""
    return {tuple(sorted(map(tuple, places))) for places in corners(result.triangulation).tolist()}


def check(result: RefineResult, before: Array, angle: float = 30.0) -> None:
    """Hold a result against what is promised."""
    tri = result.triangulation
    certificate = result.verify()
    assert certificate.canonical, str(certificate)
    np.testing.assert_array_equal(tri.points[: len(before)], before)
    assert result.steiner.tolist() == list(range(len(before), tri.npoints))
    angles = smallest_angles(tri)
    assert set(np.flatnonzero(angles < angle - 1e-6)) <= set(result.below.tolist())
    assert (angles[result.below] < angle + 1e-6).all()
    np.testing.assert_allclose(result.angles.min(axis=1), angles, atol=1e-4)
    assert result.min_angle == pytest.approx(angles.min(), abs=1e-4)
    for row, edge in zip(result.steiner, result.steiner_edges, strict=True):
        if edge >= 0:
            ends = tri.points[tri.input_edges[edge]]
            assert distance(*ends, tri.points[row]) <= result.displacement * (1 + 1e-9)


def distance(start: Array, end: Array, place: Array) -> float:
    """In rationals but for the root."""
    (ax, ay), (bx, by), (px, py) = ([Fraction(each) for each in p] for p in (start, end, place))
    cross = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    return float(abs(cross)) / float((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5


def check_conforming(result: RefineResult) -> None:
    """All are Delaunay; others are beside the boundary, whose rows are rounded."""
    plain = liftmesh.delaunay(result.triangulation.points)
    places = corners(plain)
    all_of_them = {tuple(sorted(map(tuple, each))) for each in places.tolist()}
    assert as_set(result) <= all_of_them
    is_left = result.triangulation.find_simplex(places.mean(axis=1)) >= 0
    assert areas(plain)[~is_left].sum() <= 1e-12 * areas(plain).sum()


def test_a_strip() -> None:
    result = refine(STRIP)
    check(result, np.array(STRIP))
    assert (len(result.below), result.capped, result.displacement) == (0, False, 0.0)
    assert areas(result.triangulation).sum() == pytest.approx(9)
    assert repr(result).startswith("<RefineResult: ")
    assert repr(result).endswith(" rows added, 0 below 30 degrees>")
    counts, edges = result.histogram(6)
    assert (counts.sum(), counts[0], edges[1]) == (3 * result.triangulation.nsimplex, 0, 30)


def test_an_l_with_a_hole() -> None:
    result = refine([[L_SHAPE, HOLE]], max_area=0.25)
    check(result, np.array([*L_SHAPE, *HOLE]))
    tri = result.triangulation
    assert isinstance(tri, ConstrainedTriangulation)
    assert areas(tri).max() <= 0.25
    assert tri.find_simplex([[0.75, 0.9], [5, 5], [1.5, 1]]).tolist()[:2] == [-1, -1]
    assert (tri.added.tolist(), tri.input_polygons.max()) == (list(range(9)), 0)
    whole = constrained_delaunay([], polygons=[[L_SHAPE, HOLE]], carve="holes")
    assert areas(tri).sum() == pytest.approx(areas(whole).sum())
    assert as_set(refine(whole, max_area=0.25)) == as_set(result)


def test_points_alone_and_what_bounds_them() -> None:
    points = np.random.default_rng(1).random((60, 2))
    tri = liftmesh.delaunay(np.vstack([points, points[:3]]))
    result = refine(tri)
    check(result, tri.points)
    hull = {tuple(sorted(each)) for each in zip(tri.convex_hull, np.roll(tri.convex_hull, 1))}  # noqa: B905
    made = result.triangulation
    assert {tuple(each) for each in made.input_edges.tolist()} == hull
    assert (made.input_polylines.max(), len(made.duplicates)) == (-1, 3)
    assert refine(made).triangulation.nsimplex == made.nsimplex


def test_small_input_angles_are_listed() -> None:
    fan = [[0.0, 0.0], [8.0, 0.0], [8.0, 0.5], [8.0, 1.0]]
    result = refine(constrained_delaunay(fan, [[0, 1], [0, 2], [0, 3]]))
    check(result, np.array(fan))
    assert len(result.below)
    assert set(result.causes) == {"input angle"}
    assert result.min_angle == pytest.approx(np.degrees(np.arctan2(0.5, 8)), abs=0.1)


@pytest.mark.parametrize("is_conforming", [False, True])
def test_both_sides_of_a_needle_are_divided_alike(is_conforming: bool) -> None:
    """Rows on one side that match none on the other would take thousands."""
    needle = [[0.0, 0.0], [3.0, 0.0], [2.9, 1e-4]]
    result = refine(needle, min_angle=28, conforming=is_conforming, max_points=1000)
    assert len(result.steiner) < 200
    assert set(result.causes) == {"input angle"}
    assert result.verify().valid


@pytest.mark.parametrize("scale", [2.0**-1000, 2.0**-500, 2.0**500, 2.0**1019])
def test_coordinates_of_any_size(scale: float) -> None:
    result = refine((np.array(STRIP) * scale).tolist())
    plain = refine(STRIP)
    np.testing.assert_array_equal(result.triangulation.points / scale, plain.triangulation.points)
    np.testing.assert_array_equal(result.angles, plain.angles)
    assert result.verify().valid


def test_sizes_that_vary() -> None:
    def wanted(places: Array) -> Array:
        return 0.05 + 0.2 * places[:, 0]

    result = refine(SQUARE, size=wanted)
    check(result, np.array(SQUARE))
    tri = result.triangulation
    longest = np.sqrt(2) * wanted(corners(tri).mean(axis=1)) * (1 + 1e-9)
    assert (sides(tri).max(axis=1) <= longest).all()
    rows = liftmesh.delaunay(SQUARE)
    by_rows = refine(rows, size=wanted(rows.points))
    assert (sides(by_rows.triangulation).max(axis=1) <= np.sqrt(2) * 0.851).all()
    ratio = by_rows.triangulation.nsimplex / tri.nsimplex
    assert 0.95 < ratio < 1.05
    even = refine(SQUARE, size=0.25).triangulation
    assert sides(even).max() <= 0.25 * np.sqrt(2) * (1 + 1e-9)


def test_areas_by_region() -> None:
    result = refine(HALVES, max_area=[0.05, np.inf])
    check(result, np.array(SQUARE))
    tri = result.triangulation
    lower = corners(tri).mean(axis=1) @ [1, -1] > 0
    first = corners(HALVES)[0].mean(axis=0) @ [1, -1] > 0
    assert areas(tri)[lower == first].max() <= 0.05
    assert areas(tri)[lower != first].max() > 0.05
    assert areas(refine(HALVES, max_area=0.1).triangulation).max() <= 0.1
    assert tri.regions.max() == 1


def test_no_angle_asked_for() -> None:
    for angle in (0, None):
        result = refine(STRIP, min_angle=angle)
        assert (len(result.steiner), len(result.below), result.asked_angle) == (0, 0, 0)
        assert result.verify().canonical
    assert areas(refine(STRIP, min_angle=None, max_area=1).triangulation).max() <= 1


def check_sizes(result: RefineResult, size: float | None, area: float | None) -> None:
    made = result.triangulation
    assert sides(made).max() <= 2**0.5 * (size or np.inf) * (1 + 1e-12)
    assert areas(made).max() <= (area or np.inf) * (1 + 1e-12)
    assert (result.capped, result.too_large.tolist()) == (False, [])
    assert result.verify().valid


@pytest.mark.parametrize("high", [0.5, 0.0872, 1e-3, 1e-9, 1e-15])
def test_sizes_in_a_wedge(high: float) -> None:
    """Triangles between edges that meet in a small angle are left for their angle alone."""
    for bounds in ((0.03, None), (None, 1e-4), (0.1, 1e-3)):
        for rounds in (0, 2):
            result = refine(
                [[0, 0], [1, 0], [0.9962, high]], size=bounds[0], max_area=bounds[1], smooth=rounds
            )
            check_sizes(result, *bounds)


def test_sizes_at_a_notch() -> None:
    """Of a small angle outside, which bounds no triangle."""
    notch = [[0.0, 0], [4, 0], [4, 4], [2.01, 4], [2, 1], [1.99, 4], [0, 4]]
    check_sizes(refine(notch, size=0.1), 0.1, None)


def spokes(rng: np.random.Generator) -> ConstrainedTriangulation:
    """Edges from one corner, in a box or without one."""
    count = int(rng.integers(2, 20))
    turns = rng.uniform(0, rng.choice([0.01, 1, 2 * np.pi]), count)
    ends = rng.uniform(0.2, 1, (count, 1)) * np.column_stack([np.cos(turns), np.sin(turns)])
    box = [[-2, -2], [2, -2], [2, 2], [-2, 2]] if rng.random() < 0.5 else np.empty((0, 2))
    edges = [[0, row + 1] for row in range(count)]
    return constrained_delaunay(np.vstack([[[0, 0]], ends, box]), edges)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0, 20, 33]), st.integers(0, 2), st.booleans())
def test_sizes_between_spokes(seed: int, angle: int, rounds: int, is_conforming: bool) -> None:
    rng = np.random.default_rng(seed)
    options: Any = {"min_angle": angle, "smooth": rounds, "conforming": is_conforming}
    tri, size = spokes(rng), float(rng.uniform(0.03, 0.3))
    check_sizes(refine(tri, size=size, **options), size, None)
    check_sizes(refine(tri, max_area=size**2, **options), None, size**2)


@pytest.mark.parametrize("angle", [20, 33.5, 34])
def test_other_angles(angle: float) -> None:
    check(refine([[L_SHAPE, HOLE]], min_angle=angle), np.array([*L_SHAPE, *HOLE]), angle)


def test_a_cap() -> None:
    with pytest.warns(liftmesh.DataWarning, match=r"\d+ rows .*under 30 degrees and \d+ too large"):
        result = refine(SQUARE, max_area=1e-4, max_points=20)
    assert len(result.steiner) == 20
    assert areas(result.triangulation)[result.too_large].min() > 1e-4
    assert result.capped
    assert repr(result).endswith(", capped>")
    with pytest.warns(liftmesh.DataWarning, match=r"[1-9]\d* triangles? under 30 degrees and 0"):
        result = refine(STRIP, max_points=3)
    assert set(result.causes) == {"cap"}
    assert result.verify().valid
    with pytest.warns(liftmesh.DataWarning, match=r"0 triangles under 0 degrees and 2 too large"):
        result = refine(SQUARE, min_angle=0, size=0.5, max_points=0)
    assert result.triangulation.nsimplex == 2
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        refine(STRIP, max_points=1000)


def test_conforming_triangles_are_those_of_delaunay() -> None:
    rng = np.random.default_rng(3)
    points = rng.random((40, 2))
    tri = constrained_delaunay([*SQUARE, *points], [[0, 4], [2, 4], [0, 1], [1, 2], [2, 3], [3, 0]])
    result = refine(tri, min_angle=20, conforming=True)
    check(result, tri.points, 20)
    check_conforming(result)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.sampled_from([15, 25, 30, 33]), st.booleans())
def test_random_edges(seed: int, angle: float, is_conforming: bool) -> None:
    """What is promised holds, and neither the order of rows nor that of edges counts."""
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 40, (15, 2)).astype(float) if seed % 2 else rng.random((15, 2))
    edges = rng.integers(0, 15, (5, 2))
    try:
        tri = constrained_delaunay(points, edges, crossing="split")
    except liftmesh.DegenerateInputError:
        return
    options: dict[str, Any] = {"min_angle": angle, "conforming": is_conforming}
    result = refine(tri, **options)
    check(result, tri.points, angle)
    assert set(result.causes) <= {"input angle", "precision"}
    rows = rng.permutation(tri.npoints)
    moved = np.argsort(rows)[tri.constraints][:, ::-1][rng.permutation(len(tri.constraints))]
    other = refine(constrained_delaunay(tri.points[rows], moved), **options)
    assert as_set(other) == as_set(result)
    if is_conforming:
        check_conforming(result)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_random_polygons(seed: int) -> None:
    """Stars around a hole, of spikes that may be thin."""
    rng = np.random.default_rng(seed)
    turn = np.sort(rng.random(9)) * 2 * np.pi
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1) * rng.uniform(2, 9, (9, 1))
    hole = np.array([[0.1, 0.0], [-0.1, 0.1], [-0.1, -0.1]]) * rng.random()
    try:
        tri = constrained_delaunay([], polygons=[[ring, hole]], carve="holes")
    except (liftmesh.CrossingError, liftmesh.InputError):
        return
    most = areas(tri).sum() / 50
    result = refine(tri, min_angle=25, max_area=most)
    check(result, tri.points, 25)
    is_free = np.setdiff1d(np.arange(result.triangulation.nsimplex), result.below)
    assert areas(result.triangulation)[is_free].max() <= most * (1 + 1e-12)
    assert areas(result.triangulation).sum() == pytest.approx(areas(tri).sum())
    assert result.triangulation.convex_hull.max() < result.triangulation.npoints


def test_symmetric_needles_depend_on_no_order() -> None:
    """A row is as far from both corners of the edge that it encroaches upon."""
    rng = np.random.default_rng(1)
    x = [24, 72, 78, 82, 88, 96, 96, 96, 120]
    y = [90, 24, 102, 89, 72, 48, 96, 144, 144]
    points, edges = np.column_stack([x, y]), np.array([[6, 5], [5, 4], [4, 6]])
    found = set()
    for order in [rng.permutation(9) for _ in range(40)]:
        tri = constrained_delaunay(points[order], rng.permutation(np.argsort(order)[edges]))
        found.add(frozenset(as_set(refine(tri, min_angle=33))))
    assert len(found) == 1


def test_parts_know_their_edges() -> None:
    points = [[0.0, 0.0], [1.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]]
    tri = constrained_delaunay(points, [[0, 2], [1, 2], [2, 2], [0, 3]])
    result = refine(tri, max_area=0.5)
    made = result.triangulation
    assert made.input_edges[:4].tolist() == [[0, 2], [1, 2], [2, 2], [0, 3]]
    assert made.zero_length.tolist() == [2]
    for edge in (0, 1, 3, 4):
        parts = [k for k in range(len(made.constraints)) if edge in made.inputs_of(k)]
        lengths = np.hypot(*np.diff(made.points[made.constraints[parts]], axis=1)[:, 0].T)
        ends = made.points[made.input_edges[edge]]
        assert lengths.sum() == pytest.approx(np.hypot(*(ends[1] - ends[0])))
    on_first = result.steiner[result.steiner_edges == 0]
    assert len(on_first)
    assert (made.points[on_first][:, 1] == 0).all()
    inside = result.steiner[result.steiner_edges == -1]
    assert (made.points[inside] > 0).all()
    again = refine(made, max_area=0.25)
    assert again.verify().valid
    assert len(again.triangulation.added) == len(again.triangulation.crossing_rows) == 0


def test_rows_of_crossings_keep_their_place() -> None:
    tri = constrained_delaunay(
        SQUARE, [[0, 2]], polylines=[[[4.0, 0.5], [0.0, 4.0]]], crossing="split"
    )
    made = refine(tri).triangulation
    np.testing.assert_array_equal(made.added, tri.added)
    np.testing.assert_array_equal(made.crossing_rows, tri.crossing_rows)
    assert made.displacement == tri.displacement


def test_what_is_wrong_is_found() -> None:
    result = refine([[0.0, 0.0], [8.0, 0.0], [8.0, 1.0]])
    assert len(result.below)
    flaws = replace(result, below=result.below[:0]).verify().flaws
    assert flaws[0].kind == "small_angles"
    assert "an angle under 30 degrees and" in flaws[0].text
    assert flaws[0].first[0].triangles == (result.below[0],)
    tri = copy.copy(result.triangulation)
    tri.input_edges = np.array([[0, 1], [1, 2], [2, 0]], dtype=np.int32)[[0, 2, 1]]
    found = replace(result, triangulation=tri).verify()
    assert [flaw.kind for flaw in found.flaws] == ["uncovered_edges"]
    assert "2 input edges have no constraints along it" in str(found)
    assert found.flaws[0].first[0].rows == (2, 0)
    assert not found.valid


def test_doubtful_angles_are_decided_in_integers() -> None:
    """An angle of 45 degrees has a cosine between two doubles."""
    result = refine(SQUARE, min_angle=45)
    assert (len(result.steiner), len(result.below)) == (0, 0)
    root = np.sqrt(0.5)
    made = result.triangulation
    every = np.arange(2)
    roots = np.nextafter(root, 0), root
    assert [len(below_angle(made, c, every)) for c in roots] == [2, 0]


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))]
)
def test_copies(again: Callable[[Any], Any]) -> None:
    result = refine([[L_SHAPE, HOLE]])
    twin = again(result)
    for name in ("steiner", "steiner_edges", "below", "causes"):
        np.testing.assert_array_equal(getattr(twin, name), getattr(result, name))
        with pytest.raises(ValueError, match="read-only"):
            getattr(twin, name)[...] = 0
    assert twin.verify().valid
    with pytest.raises(AttributeError):
        twin.capped = True


@pytest.mark.parametrize("name", ["steiner", "steiner_edges", "below"])
def test_damaged_pickles_are_refused(name: str) -> None:
    result = refine(STRIP)
    wrong = replace(result, **{name: np.array([10**6], dtype=np.int32)})
    with pytest.raises(liftmesh.InputError, match="the copy is damaged"):
        pickle.loads(pickle.dumps(wrong))


def test_sizes_by_region() -> None:
    by_region = refine(HALVES, size=[0.3, 9])
    x, y = HALVES.points[HALVES.simplices[HALVES.regions == 0]].mean(axis=(0, 1))
    same = refine(HALVES, size=lambda p: np.where((p[:, 0] > p[:, 1]) == (x > y), 0.3, 9))
    assert len(by_region.steiner) > 50
    assert as_set(by_region) == as_set(same)
    assert as_set(refine(STRIP, size=[0.5])) == as_set(refine(STRIP, size=0.5))


def test_infinity_is_no_bound() -> None:
    expected = as_set(refine(HALVES))
    for options in ({"max_area": np.inf}, {"size": np.inf}, {"size": [np.inf] * 2}):
        assert as_set(refine(HALVES, **options)) == expected


def test_a_result_is_refined_further() -> None:
    once = refine(STRIP)
    further = refine(once, max_area=0.2)
    assert as_set(further) == as_set(refine(once.triangulation, max_area=0.2))
    surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    twice = refine(refine(surface, max_area=2), max_area=0.5).surface
    assert twice.attributes["steiner"].sum() == len(twice.vertices) - 3


def test_skipped_rows_stay() -> None:
    points = [*SQUARE, [np.nan, 0.0]]
    result = refine(liftmesh.delaunay(points, nonfinite="skip"), max_area=1)
    assert result.triangulation.skipped.tolist() == [4]
    assert result.verify().valid
    assert result.steiner[0] == 5


def test_scipys_class_and_single_precision() -> None:
    points = np.random.default_rng(2).random((30, 2)).astype(np.float32)
    plain = as_set(refine(liftmesh.delaunay(points)))
    assert as_set(refine(liftmesh.scipy.Delaunay(points.astype(float)))) == plain


def test_progress() -> None:
    for options in ({"max_area": 1e-4}, {"size": 0.01}, {"max_area": 1e-9, "max_points": 10**5}):
        told: list[float] = []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            refine(SQUARE, **options, progress=told.append)
        assert told == sorted(told)
        assert (told[0] >= 0, told[-1], told.count(1.0)) == (True, 1.0, 1)


@pytest.mark.slow
def test_ctrl_c() -> None:
    program = LONG_RUN.format(
        points="rng.random((1000, 2))",
        prepare="tri = liftmesh.delaunay(points)",
        call="liftmesh.refine(tri, max_area=1e-7)",
    )
    assert seconds_to_stop(program, 0.3) < 0.5
