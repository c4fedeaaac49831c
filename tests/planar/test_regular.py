"""Regular triangulations through the public interface, held against exact integers."""

from __future__ import annotations

import copy
import pickle
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import pytest
import regular_oracle
from array_forms import in_a_table
from hypothesis import given, settings, strategies as st
from regular_oracle import Site
from scipy.interpolate import LinearNDInterpolator
from strategies import concentric_circles, lattices, small_integers

import liftmesh
from liftmesh import RegularTriangulation

RNG = np.random.default_rng(7)
POINTS = np.r_[RNG.random((300, 2)), RNG.integers(0, 9, (200, 2)) / 8]
WEIGHTS = np.r_[RNG.random(300) * 5e-3, RNG.integers(0, 4, 200) / 64]
KINDS = pytest.mark.parametrize("kind", ["weights", "radii"])

MOTIFS = st.one_of(
    small_integers(),
    lattices(),
    concentric_circles(),
).filter(lambda rows: 1e-100 < np.abs(rows).max() < 1e100)


@st.composite
def weighted(draw: st.DrawFn) -> tuple[list[tuple[float, float]], list[float]]:
    """A few points, with weights that tie or hide at the scale of the points."""
    rows = draw(MOTIFS)[:8]
    rows += draw(st.lists(st.sampled_from(rows), max_size=2))  # positions of several rows
    scale = float(np.abs(rows).max()) ** draw(st.sampled_from([1, 2]))
    each = st.one_of(st.integers(0, 8).map(lambda k: k / 8), st.floats(0, 4))
    values = draw(st.lists(each, min_size=len(rows), max_size=len(rows)))
    return rows, [value * scale for value in values]


def triangles(found: liftmesh.Triangulation) -> set[frozenset[int]]:
    return {frozenset(rows) for rows in found.simplices.tolist()}


def height_of_others(sites: list[Site], row: int) -> Fraction | None:
    """The lower hull of the other sites at a site, by every segment and triangle around it."""
    x, y, _ = sites[row]
    others = [site for k, site in enumerate(sites) if k != row]
    found = [z for u, v, z in others if (u, v) == (x, y)]
    for (ax, ay, az), (bx, by, bz) in combinations(others, 2):
        along = (bx - ax) ** 2 + (by - ay) ** 2
        dot = (x - ax) * (bx - ax) + (y - ay) * (by - ay)
        if along and (x - ax) * (by - ay) == (y - ay) * (bx - ax) and 0 <= dot <= along:
            found.append(az + (bz - az) * dot / along)
    for (ax, ay, az), (bx, by, bz), (cx, cy, cz) in combinations(others, 3):
        parts = [
            (bx - x) * (cy - y) - (by - y) * (cx - x),
            (cx - x) * (ay - y) - (cy - y) * (ax - x),
            (ax - x) * (by - y) - (ay - y) * (bx - x),
        ]
        if sum(parts) and (min(parts) >= 0 or max(parts) <= 0):
            found.append(sum(p * z for p, z in zip(parts, (az, bz, cz), strict=True)) / sum(parts))
    return min(found, default=None)


@pytest.mark.slow
@settings(max_examples=150)
@given(weighted(), st.sampled_from(["weights", "radii"]))
def test_small_sets_are_the_oracles(
    drawn: tuple[list[tuple[float, float]], list[float]], kind: str
) -> None:
    rows, values = drawn
    sites = regular_oracle.sites(rows, values, kind)
    wanted, left_out = regular_oracle.regular(sites)
    if not wanted:
        with pytest.raises(liftmesh.DegenerateInputError):
            liftmesh.regular(rows, **{kind: values})
        return
    found = liftmesh.regular(rows, **{kind: values})
    assert triangles(found) == wanted
    assert {*found.hidden.tolist(), *found.duplicates[:, 0].tolist()} == left_out
    vertices = set(range(len(rows))) - left_out
    copies = {row for row in left_out if sites[row] in {sites[vertex] for vertex in vertices}}
    assert set(found.duplicates[:, 0].tolist()) == copies
    heaviest = list(dict.fromkeys(sites))
    places = {site: k for k, site in enumerate(heaviest)}
    others = {row: height_of_others(heaviest, places[sites[row]]) for row in vertices}
    assert found.degenerate.tolist() == sorted(r for r in vertices if others[r] == sites[r][2])
    for row, triangle in zip(found.hidden, found.simplices[found.hidden_to_simplex], strict=True):
        below = height_of_others([sites[row], *(sites[corner] for corner in triangle)], 0)
        assert below is not None
        assert below < sites[row][2]


@KINDS
def test_every_row_is_a_vertex_or_listed_once(kind: str) -> None:
    points = np.r_[POINTS, POINTS[:40], [[np.nan, 0], [0, 0]]]
    values = np.r_[WEIGHTS, WEIGHTS[:20], WEIGHTS[20:40] / 2, [1, np.inf]]
    found = liftmesh.regular(points, **{kind: values}, nonfinite="skip")
    vertices = np.unique(found.simplices)
    listed = [vertices, found.hidden, found.duplicates[:, 0], found.skipped]
    assert np.sort(np.concatenate(listed)).tolist() == list(range(len(points)))
    assert found.skipped.tolist() == [540, 541]
    assert len(found.hidden) > 100
    assert (np.diff(found.hidden) > 0).all()


@KINDS
def test_at_one_position_the_heavier_wins_and_equals_are_duplicates(kind: str) -> None:
    points = [(0, 0), (4, 0), (0, 4), (0, 0), (4, 0), (0, 4), (0, 0), (1, 1), (1, 1)]
    values = [0, 3, 1, 2, 3, 5, 2, *([-9, -9] if kind == "weights" else [0, 0])]
    found = liftmesh.regular(points, **{kind: values})
    assert triangles(found) == {frozenset({3, 1, 5})}
    assert found.duplicates.tolist() == [[4, 1], [6, 3]]
    assert found.hidden.tolist() == [0, 2, 7, 8]
    assert found.hidden_to_simplex.tolist() == [0, 0, 0, 0]
    assert found.coplanar.tolist() == [[4, 0, 1], [6, 0, 3]]


@KINDS
def test_copies_of_hidden_rows_are_hidden_wherever_what_hides_them_is(kind: str) -> None:
    corners = [(0, 0), (8, 0), (0, 8), (0, 0), (0, 0), (2, 2), (2, 2)]
    values = [9, 3, 3, 1, 1, *([-90, -90] if kind == "weights" else [0, 0])]
    found = liftmesh.regular(corners, **{kind: values})
    certificate = found.verify()
    assert certificate.canonical
    assert found.hidden.tolist() == [3, 4, 5, 6]
    assert (certificate.n_hidden, certificate.n_duplicates) == (4, len(found.duplicates)) == (4, 0)


def test_equal_weights_give_delaunays_triangles() -> None:
    plain = liftmesh.delaunay(POINTS, order="canonical")
    for options in ({"weights": np.full(500, -3)}, {"radii": np.full(500, 0.1)}):
        found = liftmesh.regular(POINTS, **options, order="canonical")
        for name in ("simplices", "neighbors", "duplicates", "convex_hull"):
            np.testing.assert_array_equal(getattr(found, name), getattr(plain, name))
        assert len(found.hidden) == len(found.degenerate) == 0


def test_a_site_on_a_facet_or_an_edge_is_a_vertex_and_degenerate() -> None:
    square = [(0, 0), (4, 0), (0, 4), (4, 4)]
    on_facet = liftmesh.regular([*square, (2, 2)], weights=[0, 0, 0, 0, -8])
    assert on_facet.degenerate.tolist() == [4]
    assert on_facet.hidden.tolist() == []
    on_hull_edge = liftmesh.regular([*square, (2, 0)], weights=[0, 0, 0, 0, -4])
    assert on_hull_edge.degenerate.tolist() == [4]
    on_crease = liftmesh.regular(  # the diagonal from row 0 to 3 is lower than the other corners
        [*square, (1, 1)], weights=[8, 0, 0, 8, -6 + 8]
    )
    assert on_crease.degenerate.tolist() == [4]
    for beside in (-8 + 2.0**-49, np.nextafter(-8, 0)):
        assert liftmesh.regular([*square, (2, 2)], weights=[0] * 4 + [beside]).degenerate.size == 0
    assert liftmesh.regular([*square, (2, 2)], weights=[0] * 4 + [np.nextafter(-8, -9)]).hidden == 4


def test_the_square_of_a_radius_is_never_rounded() -> None:
    # At (1, 1), on an edge of corners of radius R, a row is hidden if r^2 < R^2 - 2.
    corners = [(0, 0), (2, 0), (0, 2)]
    needed = 4**2 - 2
    root = float(np.sqrt(needed))
    assert root * root == needed > Fraction(root) ** 2
    exact = liftmesh.regular([*corners, (1, 1)], radii=[4.0] * 3 + [root])
    assert exact.hidden.tolist() == [3]
    squared = liftmesh.regular([*corners, (1, 1)], weights=[16.0] * 3 + [root * root])
    assert squared.degenerate.tolist() == [3]
    above = liftmesh.regular([*corners, (1, 1)], radii=[4.0] * 3 + [np.nextafter(root, 99)])
    assert above.hidden.tolist() == above.degenerate.tolist() == []


@KINDS
def test_the_order_of_rows_and_the_number_of_threads_change_nothing(kind: str) -> None:
    points, values = np.tile(POINTS, (80, 1)), np.tile(WEIGHTS, 80)
    points = points + np.repeat(np.arange(80) * 2, 500)[:, None]
    once = liftmesh.regular(points, **{kind: values}, threads=1)
    assert len(once.hidden) > 5000
    for threads in (2, 3):
        again = liftmesh.regular(points, **{kind: values}, threads=threads)
        for name in ("simplices", "neighbors", "hidden", "duplicates", "convex_hull"):
            np.testing.assert_array_equal(getattr(again, name), getattr(once, name))
    order = np.random.default_rng(1).permutation(len(points))
    turned = liftmesh.regular(points[order], **{kind: values[order]}, order="canonical")
    there = liftmesh.regular(points, **{kind: values}, order="canonical")
    corners = points[there.simplices]
    np.testing.assert_array_equal(points[order][turned.simplices], corners)


FORMS: dict[str, Any] = {
    "float32": np.float32,
    "int32": np.int32,
    "uint8": np.uint8,
    "int64": np.int64,
    "big endian": lambda values: values.astype(">f8"),
    "float16": np.float16,
    "longdouble": np.longdouble,
    "list": list,
    "column": lambda values: values[:, None],
    "strided": lambda values: np.repeat(values, 3)[::3],
    "reversed": lambda values: values[::-1].copy()[::-1],
    "of a table": lambda values: in_a_table(np.c_[values, values])[:, 1],
    "unaligned": lambda values: np.frombuffer(b" " + values.tobytes(), np.uint8)[1:].view(float),
    "fractions": lambda values: [Fraction(value) for value in values.tolist()],
    "masked": np.ma.array,
    "broadcast": lambda values: np.broadcast_to(values[:1], values.shape),
}


@KINDS
@pytest.mark.parametrize("form", FORMS)
def test_any_form_of_weights_is_the_same(form: str, kind: str) -> None:
    rng = np.random.default_rng(2)
    points, values = rng.integers(0, 40, (400, 2)), rng.integers(0, 25, 400).astype(float)
    values[:] = values[0] if form == "broadcast" else values
    plain = liftmesh.regular(points, **{kind: values})
    given_form = FORMS[form](values)
    found = liftmesh.regular(points, **{kind: given_form})
    np.testing.assert_array_equal(found.simplices, plain.simplices)
    np.testing.assert_array_equal(found.hidden, plain.hidden)
    np.testing.assert_array_equal(getattr(found, kind), values)
    assert getattr(found, kind).dtype == np.float64
    assert getattr(found, {"weights": "radii", "radii": "weights"}[kind]) is None


def test_the_arrays_are_views_unless_a_copy_is_asked_for() -> None:
    weights = WEIGHTS.copy()
    shared, copied = (liftmesh.regular(POINTS, weights=weights, copy=c) for c in (False, True))
    assert np.shares_memory(shared.weights, weights)
    assert not np.shares_memory(copied.weights, weights)
    assert not np.shares_memory(copied.points, POINTS)
    for name in ("weights", "hidden", "hidden_to_simplex", "degenerate", "equations"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(shared, name)[...] = 0
    assert weights.flags.writeable


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda tri: pickle.loads(pickle.dumps(tri))]
)
def test_copies_have_what_the_weights_add(again: Any) -> None:
    made = liftmesh.regular(POINTS, radii=WEIGHTS)
    _ = made.hidden_to_simplex
    found = again(made)
    for name in ("hidden", "radii", "hidden_to_simplex", "degenerate", "points", "simplices"):
        np.testing.assert_array_equal(getattr(found, name), getattr(made, name))
        with pytest.raises(ValueError, match="read-only"):
            getattr(found, name)[...] = 0
    assert found.weights is None


def test_scipys_interpolators_take_what_is_not_hidden() -> None:
    found = liftmesh.regular(POINTS, weights=WEIGHTS)
    plane = LinearNDInterpolator(found.to_scipy(), POINTS @ (2.0, -1.0))
    inside = RNG.random((200, 2)) * 0.9 + 0.05
    np.testing.assert_allclose(plane(inside), inside @ (2.0, -1.0))


def test_what_is_lifted_is_lowered_by_the_weights() -> None:
    heights = (POINTS**2).sum(axis=1) - WEIGHTS
    by_weight = liftmesh.regular(POINTS, weights=WEIGHTS)
    by_radius = liftmesh.regular(POINTS, radii=np.sqrt(WEIGHTS))
    for found in (by_weight, by_radius):
        np.testing.assert_allclose(found.lifted("origin").vertices[:, 2], heights, atol=1e-15)
        left = np.union1d(found.hidden, found.duplicates[:, 0])
        np.testing.assert_array_equal(found.lifted().above, left)
        # A point of weight w is lower by w than a point without weight.
        drop = found.equations[:, 2] * -WEIGHTS[:, None]
        distances = found.plane_distance(POINTS) + drop
        assert distances.max() < 1e-15 * 8
        corners = distances[found.simplices.T, np.arange(found.nsimplex)]
        np.testing.assert_allclose(corners, 0, atol=1e-15 * 8)
    np.testing.assert_array_equal(by_weight.lift_points(POINTS), liftmesh.lift(POINTS, "origin"))
    away = by_weight.lifted(apex="median")
    x, y = away.apex
    np.testing.assert_allclose(
        away.vertices[:, 2], ((POINTS - (x, y)) ** 2).sum(axis=1) - WEIGHTS, atol=1e-15
    )


def test_hidden_rows_have_the_triangle_below() -> None:
    found = liftmesh.regular(POINTS, weights=WEIGHTS)
    assert (found.hidden_to_simplex >= 0).all()
    assert (found.vertex_to_simplex[found.hidden] == -1).all()
    planes = found.equations[found.hidden_to_simplex]
    lifted = found.lifted("origin").vertices[found.hidden]
    above = (planes[:, :3] * lifted).sum(axis=1) + planes[:, 3]
    assert (above < 0).all()
    assert f"{len(found.hidden)} hidden" in repr(found)
    assert isinstance(found, liftmesh.Triangulation)


def test_lines_through_their_power_cells_are_where_powers_are_equal() -> None:
    """The slopes of the lifted triangles are twice the corners of the power diagram."""
    found = liftmesh.regular(POINTS[:300], weights=WEIGHTS[:300])
    slopes = -found.equations[:, :2] / found.equations[:, 2:3]
    for corners, slope in zip(found.simplices[:50], slopes, strict=False):
        powers = ((slope / 2 - POINTS[corners]) ** 2).sum(axis=1) - WEIGHTS[corners]
        everywhere = ((slope / 2 - POINTS[:300]) ** 2).sum(axis=1) - WEIGHTS[:300]
        np.testing.assert_allclose(powers, everywhere.min(), atol=1e-9 * (1 + abs(slope).max()))


def test_values_that_clouds_and_tables_name() -> None:
    cloud = liftmesh.Cloud(np.c_[POINTS, POINTS[:, 0]], attributes={"size": WEIGHTS})
    table = np.rec.fromarrays([*POINTS.T, WEIGHTS, WEIGHTS], names="x,y,z,size")
    plain = liftmesh.regular(POINTS, radii=WEIGHTS)
    for source in (cloud, table):
        found = liftmesh.regular(source, radii="size")  # type: ignore[arg-type]
        np.testing.assert_array_equal(found.simplices, plain.simplices)
    surface = liftmesh.triangulate(cloud)
    assert isinstance(liftmesh.regular(surface, weights="size"), RegularTriangulation)  # type: ignore[arg-type]
