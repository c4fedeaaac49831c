"""`verify`: right results pass, each kind of damage is named where it is, nothing wrong gets by."""

from __future__ import annotations

import json
import subprocess
import sys
from hashlib import sha256
from random import Random

import numpy as np
import pytest
from clouds import FAMILIES
from damage import POINTS, Rows, flipped, without_a_point
from hypothesis import given, settings, strategies as st
from meshes import oracle_triangles
from numpy.typing import NDArray
from oracles.planar import counter_clockwise, exact
from oracles.second_opinion import flaw as second_opinion
from scipy.spatial import Delaunay

import liftmesh
from liftmesh import Certificate, InputError, NonFiniteError

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
THREADS = range(1, 9)


def kinds(certificate: Certificate) -> dict[str, int]:
    return {flaw.kind: flaw.count for flaw in certificate.flaws}


@pytest.mark.parametrize("family", FAMILIES)
def test_what_delaunay_makes_is_valid_and_canonical(family: str) -> None:
    points = FAMILIES[family](3000, np.random.default_rng(1))
    triangulation = liftmesh.delaunay(points)
    certificate = triangulation.verify()
    assert certificate
    assert certificate.canonical, str(certificate)
    assert certificate.n_rows == len(points)
    assert certificate.n_duplicates == len(triangulation.duplicates)
    assert certificate.n_vertices == len(points) - len(triangulation.duplicates)
    assert certificate.n_hull_edges == len(triangulation.convex_hull)
    assert certificate.n_edges == certificate.n_vertices + certificate.n_triangles - 1
    assert certificate.euler_characteristic == 1


def test_the_order_of_triangles_and_corners_does_not_matter() -> None:
    points = np.random.default_rng(3).random((60_000, 2))
    random = np.random.default_rng(4)
    simplices = random.permutation(liftmesh.delaunay(points).simplices)
    turn = (random.integers(0, 3, len(simplices))[:, None] + np.arange(3)) % 3
    assert liftmesh.verify(points, np.take_along_axis(simplices, turn, axis=1)).canonical


@pytest.mark.parametrize(
    "kind", ["clockwise", "degenerate", "not_delaunay", "non_finite", "non_manifold_edges"]
)
def test_offenders_are_named_as_given_however_triangles_are_listed(kind: str) -> None:
    points = np.random.default_rng(3).random((50_000, 2))
    simplices = liftmesh.delaunay(points).simplices.copy()
    random = np.random.default_rng(5)
    rows = random.choice(len(simplices), 2, replace=False)
    if kind == "clockwise":
        simplices[rows] = simplices[rows, ::-1]
    elif kind == "degenerate":
        simplices[rows, 1] = simplices[rows, 0]
    elif kind == "not_delaunay":
        points[simplices[rows, 0]] = points[simplices[rows]].mean(axis=1)
    elif kind == "non_manifold_edges":
        simplices = np.vstack((simplices, simplices[rows]))
    else:
        points[simplices[rows, 0]] = np.nan
    listed = random.permutation(len(simplices))
    as_built = liftmesh.verify(points, simplices, nonfinite="skip")
    shuffled = liftmesh.verify(points, simplices[listed], nonfinite="skip")
    assert kinds(shuffled) == kinds(as_built)
    assert violations(shuffled, kind, listed) == violations(as_built, kind, np.arange(len(listed)))


@pytest.mark.parametrize("family", FAMILIES)
def test_a_mesh_made_to_be_seen_from_below_has_one_flaw(family: str) -> None:
    points = FAMILIES[family](3000, np.random.default_rng(1))
    simplices = liftmesh.delaunay(points).simplices
    certificate = liftmesh.verify(points, simplices[:, ::-1])
    assert kinds(certificate) == {"clockwise": len(simplices)}
    assert certificate.euler_characteristic == 1


@pytest.mark.parametrize("kind", ["not_delaunay", "non_manifold_edges"])
def test_what_else_is_wrong_with_it_is_what_is_wrong_seen_from_above(kind: str) -> None:
    points = np.random.default_rng(3).random((50_000, 2))
    simplices = liftmesh.delaunay(points).simplices
    random = np.random.default_rng(5)
    rows = random.choice(len(simplices), 2, replace=False)
    if kind == "not_delaunay":
        points[simplices[rows, 0]] = points[simplices[rows]].mean(axis=1)
    else:
        simplices = np.vstack((simplices, simplices[rows]))
    listed = random.permutation(len(simplices))
    above = liftmesh.verify(points, simplices)
    for mesh, numbers in ((simplices, np.arange(len(listed))), (simplices[listed], listed)):
        for turned in (mesh[:, ::-1], mesh[:, [0, 2, 1]]):
            below = liftmesh.verify(points, turned)
            assert kinds(below) == kinds(above) | {"clockwise": len(mesh)}
            assert violations(below, kind, numbers) == violations(above, kind, np.arange(len(mesh)))


def test_in_circle_tests_skip_clockwise_triangles() -> None:
    simplices = flipped(liftmesh.delaunay(POINTS).simplices)
    one = liftmesh.verify(POINTS, simplices)
    assert kinds(one)["not_delaunay"] == 1
    turned = simplices.copy()
    turned[:-1] = turned[:-1, ::-1]  # all but one of the two that should not be there
    found = kinds(liftmesh.verify(POINTS, turned))
    assert found["clockwise"] == len(simplices) - 1
    assert found.keys() & {"not_delaunay", "not_canonical"} == set()


def violations(certificate: Certificate, kind: str, listed: Rows) -> set[tuple[object, ...]]:
    """All of one kind, triangles by the numbers they had before they were listed otherwise."""
    (flaw,) = (flaw for flaw in certificate.flaws if flaw.kind == kind)
    assert flaw.count == len(flaw.first) > 0
    return {
        (frozenset(int(listed[t]) for t in place.triangles), frozenset(place.rows), place.sign)
        for place in flaw.first
    }


def test_other_choices_on_a_circle_are_valid_but_not_canonical() -> None:
    certificate = liftmesh.verify(SQUARE, [[0, 1, 2], [0, 2, 3]])
    assert certificate
    assert not certificate.canonical
    (flaw,) = certificate.flaws
    assert (flaw.kind, flaw.count) == ("not_canonical", 1)
    assert flaw.first[0].rows == (0, 1, 2, 3)
    assert flaw.first[0].sign == 0
    assert liftmesh.verify(SQUARE, [[0, 1, 3], [1, 2, 3]]).canonical


def test_scipys_triangles_are_judged() -> None:
    assert liftmesh.verify(POINTS, Delaunay(POINTS).simplices).canonical
    grid = np.indices((8, 8)).reshape(2, -1).T.astype(float)
    certificate = liftmesh.verify(grid, Delaunay(grid).simplices)
    assert certificate.valid
    assert not certificate.canonical


def inner_triangle(simplices: Rows) -> int:
    hull = liftmesh.delaunay(POINTS).convex_hull
    return int(np.flatnonzero(~np.isin(simplices, hull).any(axis=1))[0])


def hull_triangle_gone(simplices: Rows) -> Rows:
    """Remove a triangle with one edge on the boundary: the boundary turns right at its apex."""
    neighbors = liftmesh.delaunay(POINTS).neighbors
    hull = set(liftmesh.delaunay(POINTS).convex_hull.tolist())
    for row in np.flatnonzero((neighbors < 0).sum(axis=1) == 1):
        apex = simplices[row, np.argmin(neighbors[row])]
        if apex not in hull:
            return np.delete(simplices, row, axis=0)
    raise AssertionError("no such triangle")


DAMAGE = {
    "an edge flipped": (flipped, "not_delaunay"),
    "a clockwise triangle": (lambda t: np.vstack((t[:-1], t[-1:, ::-1])), "clockwise"),
    "a degenerate triangle": (lambda t: np.vstack((t, [[0, 0, 1]])), "degenerate"),
    "an inner triangle gone": (lambda t: np.delete(t, inner_triangle(t), axis=0), "boundary_loops"),
    "a boundary triangle gone": (hull_triangle_gone, "not_convex"),
    "a triangle twice": (lambda t: np.vstack((t, t[:1])), "non_manifold_edges"),
    "all twice": (lambda t: np.vstack((t, t)), "non_manifold_edges"),
    "a point left out": (lambda t: without_a_point(), "missing_vertices"),
    "a row that is none": (lambda t: np.vstack((t[1:], [[0, 1, 40]])), "invalid_index"),
    "a negative row": (lambda t: np.vstack((t[1:], [[0, -1, 2]])), "invalid_index"),
    "no triangles": (lambda t: t[:0], "no_triangles"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_named(damage: str) -> None:
    spoil, kind = DAMAGE[damage]
    rows = spoil(liftmesh.delaunay(POINTS).simplices)
    certificate = liftmesh.verify(POINTS, rows)
    assert not certificate
    assert not certificate.canonical
    assert kind in kinds(certificate), str(certificate)
    assert str(certificate).startswith("not valid: ")
    assert second_opinion(POINTS, rows) != ""


def test_offenders_have_rows_coordinates_and_exact_signs() -> None:
    rows = flipped(liftmesh.delaunay(POINTS).simplices)
    (flaw,) = (f for f in liftmesh.verify(POINTS, rows).flaws if f.kind == "not_delaunay")
    assert flaw.count >= 1
    for place in flaw.first:
        assert place.points == tuple(map(tuple, POINTS[list(place.rows)].tolist()))
        assert place.sign == liftmesh.incircle(*place.points) == 1
        one, other = place.triangles
        assert tuple(rows[one]) == place.rows[:3]
        assert place.rows[3] in rows[other]


def test_a_boundary_that_winds_around_twice_is_found() -> None:
    """Ten triangles around one vertex, through twice the full turn: all turn the right way."""
    angle = np.arange(10) * 4 * np.pi / 10
    rim = np.column_stack((np.cos(angle), np.sin(angle))) * (1 + np.arange(10) / 1e9)[:, None]
    points = np.vstack(([[0, 0]], rim))
    fan = [[0, 1 + i, 1 + (i + 1) % 10] for i in range(10)]
    certificate = liftmesh.verify(points, fan)
    assert not certificate
    assert {"boundary_winding", "not_convex"} & kinds(certificate).keys(), str(certificate)
    star = np.vstack(([[0, 0]], [[4, 0], [-3, 3], [0, -4], [3, 3], [-4, 0], [1, -9]]))
    assert not liftmesh.verify(star, [[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)])


def test_a_mesh_whose_triangles_share_no_vertices() -> None:
    triangulation = liftmesh.delaunay(POINTS)
    corners = POINTS[triangulation.simplices].reshape(-1, 2)
    certificate = liftmesh.verify(corners, np.arange(len(corners)).reshape(-1, 3))
    assert certificate.canonical
    assert certificate.n_vertices == len(POINTS)
    assert certificate.n_merged == certificate.n_duplicates == len(corners) - len(POINTS)
    corners[5] += 1e-9
    assert not liftmesh.verify(corners, np.arange(len(corners)).reshape(-1, 3))


def apart(points: NDArray[np.floating], simplices: Rows) -> tuple[NDArray[np.floating], Rows]:
    """Give each triangle rows of its own, before all there were."""
    rows = np.vstack((points[simplices.ravel()], points))
    return rows, np.arange(simplices.size, dtype=np.int32).reshape(-1, 3)


@pytest.mark.parametrize("family", FAMILIES)
def test_triangles_apart_are_as_good_as_those_that_share_rows(family: str) -> None:
    points = FAMILIES[family](3000, np.random.default_rng(1))
    shared = liftmesh.delaunay(points)
    simplices = np.random.default_rng(2).permutation(shared.simplices)
    rows, own = apart(points, simplices)
    found = {str(liftmesh.verify(rows, own, threads=threads).to_json()) for threads in THREADS}
    assert len(found) == 1
    certificate = liftmesh.verify(rows, own)
    assert certificate.canonical, str(certificate)
    assert certificate.n_vertices == len(points) - len(shared.duplicates)
    assert certificate.n_merged == 3 * len(simplices) - certificate.n_vertices


@pytest.mark.parametrize(
    "damage", [name for name, (_, kind) in DAMAGE.items() if kind != "invalid_index"]
)
def test_damage_to_triangles_apart_is_named_as_to_those_that_share_rows(damage: str) -> None:
    simplices = DAMAGE[damage][0](liftmesh.delaunay(POINTS).simplices)
    certificate = liftmesh.verify(*apart(POINTS, simplices))
    expected = kinds(liftmesh.verify(POINTS, simplices))
    assert kinds(certificate) == expected
    named = certificate.flaws[0].first
    assert [place.triangles for place in named] == [
        place.triangles for place in liftmesh.verify(POINTS, simplices).flaws[0].first
    ]


@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=3, max_size=7),
    st.lists(st.tuples(*[st.integers(0, 6)] * 3), min_size=1, max_size=8),
    st.randoms(use_true_random=False),
)
def test_what_is_told_depends_on_no_order_and_on_no_naming(
    cloud: list[tuple[int, int]], triangles: list[tuple[int, int, int]], random: Random
) -> None:
    points = np.array(cloud, dtype=np.float64)
    simplices = np.array(triangles, dtype=np.int32) % len(cloud)
    told = [liftmesh.verify(points, simplices)]
    told += [liftmesh.verify(points, random.sample(simplices.tolist(), len(simplices)))]
    told += [liftmesh.verify(*apart(points, simplices))]
    assert len({tuple(kinds(each).items()) for each in told}) == 1
    assert len({(each.n_vertices, each.n_edges, each.n_hull_edges) for each in told}) == 1


def test_corners_beyond_one_for_each_position_are_counted() -> None:
    points = [[0, 0], [0, 0], [1, 0], [0, 1]]
    assert liftmesh.verify(points, [[1, 2, 3]]).n_merged == 0
    assert liftmesh.verify(points, [[1, 2, 3], [0, 2, 3]]).n_merged == 1


def test_a_row_that_the_boundary_visits_often_is_named_once() -> None:
    (flaw,) = (
        f for f in liftmesh.verify([[0, 0]], [[0, 0, 0]]).flaws if f.kind == "non_manifold_vertices"
    )
    assert flaw.count == 1
    corners = liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]] * 4)
    (flaw,) = (f for f in corners.flaws if f.kind == "non_manifold_vertices")
    assert [place.rows for place in flaw.first] == [(0,), (1,), (2,)]


def test_rows_that_are_not_finite() -> None:
    points = np.vstack((POINTS, [[np.nan, 0], [0, np.inf]]))
    simplices = liftmesh.delaunay(POINTS).simplices
    with pytest.raises(NonFiniteError, match="row 40 is not finite"):
        liftmesh.verify(points, simplices)
    certificate = liftmesh.verify(points, simplices, nonfinite="skip")
    assert certificate.canonical
    assert certificate.n_skipped == 2
    assert liftmesh.delaunay(points, nonfinite="skip").verify().canonical
    spoilt = np.vstack((simplices, [[0, 1, 41]]))
    certificate = liftmesh.verify(points, spoilt, nonfinite="skip")
    assert kinds(certificate) == {"non_finite": 1}
    assert "row 41 (0.0, inf)" in certificate.flaws[0].first[0].text
    assert json.loads(certificate.to_json())["flaws"][0]["first"][0]["points"][2][1] == "inf"


def test_duplicates_need_no_vertex_of_their_own_and_others_do() -> None:
    points = np.vstack((POINTS, POINTS[:7], [[-0.0, 0.5], [0.0, 0.5]]))
    simplices = liftmesh.delaunay(points).simplices
    assert liftmesh.verify(points, simplices).n_duplicates == 8
    certificate = liftmesh.verify(np.vstack((points, [[0.5, 0.5]])), simplices)
    assert kinds(certificate) == {"missing_vertices": 1}
    assert certificate.flaws[0].first[0].rows == (49,)
    named_by_others = np.where(simplices < 7, simplices + 40, simplices)
    assert liftmesh.verify(points, named_by_others).canonical


@pytest.mark.parametrize("dtype", [np.int16, np.uint32, np.int64, np.uint64, ">i4"])
def test_whole_numbers_of_any_kind(dtype: str) -> None:
    simplices = liftmesh.delaunay(POINTS).simplices
    certificate = liftmesh.verify(POINTS, simplices.astype(dtype))
    assert certificate == liftmesh.verify(POINTS, simplices)
    assert certificate.simplices_sha256 == sha256(simplices.astype("<i4").tobytes()).hexdigest()
    assert certificate.points_sha256 == sha256(POINTS.astype("<f8").tobytes()).hexdigest()


def test_rows_beyond_what_the_kernel_counts() -> None:
    certificate = liftmesh.verify(POINTS, [[0, 1, 2**32 + 2]])
    assert kinds(certificate) == {"invalid_index": 1}
    assert "refers to row 4294967298" in certificate.flaws[0].first[0].text


@pytest.mark.parametrize(
    "points", [POINTS.astype(np.float32), np.asfortranarray(POINTS), np.repeat(POINTS, 3, 0)[::3]]
)
def test_points_of_other_layouts(points: NDArray[np.floating]) -> None:
    assert liftmesh.delaunay(points).verify().canonical
    assert liftmesh.verify(np.c_[points, points[:, 0]], liftmesh.delaunay(points).simplices)


@pytest.mark.parametrize("simplices", [[0, 1, 2], [[0, 1]], [[0, 1, 2, 3, 4]], [[0.0, 1.0, 2.0]]])
def test_other_shapes_are_refused(simplices: object) -> None:
    with pytest.raises(InputError, match=r"simplices need the shape \(m, 3\)"):
        liftmesh.verify(POINTS, simplices)


def test_unknown_options_are_refused() -> None:
    with pytest.raises(InputError, match="nonfinite is 'drop'"):
        liftmesh.verify(POINTS, [[0, 1, 2]], nonfinite="drop")
    with pytest.raises(InputError, match="threads"):
        liftmesh.verify(POINTS, [[0, 1, 2]], threads=0)


@settings(max_examples=200)
@given(
    st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=3, max_size=9),
    st.lists(
        st.tuples(st.integers(0, 8), st.integers(0, 8), st.integers(0, 8)), min_size=1, max_size=9
    ),
    st.booleans(),
)
def test_what_it_accepts_is_right(
    places: list[tuple[int, int]], triples: list[tuple[int, int, int]], start_right: bool
) -> None:
    """Canonical exactly where the set of triangles is the oracle's, each one once."""
    points = np.array(places, dtype=float)
    try:
        right = liftmesh.delaunay(points).simplices
    except liftmesh.DegenerateInputError:
        right = np.empty((0, 3), dtype=np.int32)
    triangles = np.array([t for t in triples if max(t) < len(points)], dtype=np.int32)
    tried = np.vstack((right, triangles.reshape(-1, 3)[:1] if start_right else right[:0]))
    for rows in (right, tried, triangles.reshape(-1, 3)):
        corners = [tuple(exact(places)[i] for i in row) for row in rows.tolist()]
        named = [counter_clockwise(*c) for c in corners if len({*c}) == 3]
        whole = len({*named}) == len(rows) and {*named} == oracle_triangles(points)
        turned = all((liftmesh.orient2d(*points[row]) > 0) for row in rows)
        assert liftmesh.verify(points, rows).canonical == (whole and turned and len(rows) > 0)


@pytest.mark.slow
@pytest.mark.parametrize("family", ["uniform", "lattice", "duplicates", "circle"])
def test_certificates_are_the_same_for_any_number_of_threads(family: str) -> None:
    points = FAMILIES[family](70_000, np.random.default_rng(2))
    right = liftmesh.delaunay(points).simplices
    shuffled = np.random.default_rng(3).permutation(right)
    for rows in (right, shuffled, shuffled[1:], np.vstack((right, shuffled[:40, ::-1]))):
        found = [liftmesh.verify(points, rows, threads=threads) for threads in THREADS]
        assert all(one == found[0] for one in found)


def test_a_stranger_to_the_same_position_hash_is_no_duplicate() -> None:
    """Positions whose products of bits collide meet, and are told apart."""
    x = np.arange(1, 3000).astype(float)
    points = np.column_stack((x, np.zeros_like(x)))
    points = np.vstack((points, points[:, ::-1]))
    assert liftmesh.delaunay(points).verify().canonical


def test_progress_is_told_and_can_end_the_run() -> None:
    points = np.random.default_rng(6).random((400_000, 2))
    simplices = liftmesh.delaunay(points).simplices
    told: list[float] = []
    assert liftmesh.verify(points, simplices, progress=told.append)
    assert told[-1] == 1.0
    assert told == sorted(told)

    def end(share: float) -> None:
        raise RuntimeError(share)

    with pytest.raises(RuntimeError):
        liftmesh.verify(points, simplices, progress=end)


@pytest.mark.slow
def test_ctrl_c_ends_a_run() -> None:
    program = """
import os, signal, threading
import numpy as np, liftmesh
points = np.random.default_rng(0).random((3_000_000, 2))
simplices = liftmesh.delaunay(points).simplices
try:
    threading.Timer(0.15, os.kill, (os.getpid(), signal.SIGINT)).start()
    while True:
        liftmesh.verify(points, simplices, threads=2)
except KeyboardInterrupt:
    print("interrupted", bool(liftmesh.delaunay(points[:100]).verify()))
"""
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=300
    )
    assert found.stdout == "interrupted True\n"


def test_a_certificate_travels_as_json() -> None:
    certificate = liftmesh.delaunay(POINTS).verify()
    values = json.loads(certificate.to_json())
    assert values == json.loads(json.dumps(certificate.as_dict()))
    assert values["valid"] is values["canonical"] is True
    assert values["counts"]["n_triangles"] == certificate.n_triangles
    assert values["liftmesh"] == liftmesh.__version__
