"""verify() for regular triangulations, metrics and farthest points, against exact integers."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from regular_oracle import Site, regular, sites
from sites import (
    FORM,
    MEMBERS,
    circle,
    cluster_and_far_point,
    columns,
    denormals,
    exponents,
    far_away,
    giants,
    lattice,
    line_and_point,
    nearly_on_a_line_and_one_heavy,
    nearly_on_one_plane,
    options,
    under_a_few,
    uniform,
    wide_lattice,
)

import liftmesh
from liftmesh import InputError, NonFiniteError, _kernel, verify
from liftmesh._typing import Floats

FAMILIES = [
    *(uniform, lattice, wide_lattice, line_and_point, columns, circle, under_a_few, far_away),
    *(denormals, exponents, giants),
    *(nearly_on_one_plane, nearly_on_a_line_and_one_heavy, cluster_and_far_point),
]


def heights(points: Floats, values: Floats, member: str) -> list[Site]:
    if member in ("weights", "radii"):
        return sites(points.tolist(), values.tolist(), member)
    rows = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
    (a, b), (_, c) = ([Fraction(entry) for entry in row] for row in FORM)
    if member == "farthest":
        return [(x, y, -x * x - y * y) for x, y in rows]
    return [(x, y, a * x * x + 2 * b * x * y + c * y * y) for x, y in rows]


def oriented(points: Floats, triangles: set[frozenset[int]]) -> list[list[int]]:
    """Counter-clockwise, exactly."""
    found = []
    for a, b, c in map(sorted, triangles):
        corners = points[a], points[b], points[c]
        found.append([a, b, c] if liftmesh.orient2d(*corners) > 0 else [a, c, b])
    return found


def some_set(family: Callable[..., Any], member: str, number: int) -> tuple[Floats, Floats]:
    rng = np.random.default_rng([41, number])
    points, values = family(rng, int(rng.integers(4, 12)))
    return points, np.abs(values) if member == "radii" else values


@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize("family", FAMILIES)
def test_the_oracles_triangles_are_valid_and_canonical(family: Any, member: str) -> None:
    for number in range(3 if family in (exponents, giants) else 20):
        points, values = some_set(family, member, number)
        lifted = heights(points, values, member)
        expected, left_out = regular(lifted)
        if not expected:
            continue
        found = verify(points, oriented(points, expected), **options(values, member))
        assert found.valid, found
        assert found.canonical, found
        assert found.member == member
        vertices = {lifted[row] for triangle in expected for row in triangle}
        hidden = [row for row in left_out if lifted[row] not in vertices]
        assert (found.n_hidden, found.n_duplicates) == (len(hidden), len(left_out) - len(hidden))


@pytest.mark.parametrize("member", MEMBERS)
def test_triangles_of_another_member_are_not_valid(member: str) -> None:
    rng = np.random.default_rng(42)
    points, values = rng.random((400, 2)), rng.random(400) * 0.2
    made = {
        "weights": liftmesh.regular(points, weights=values).simplices,
        "radii": liftmesh.regular(points, radii=values).simplices,
        "metric": liftmesh.delaunay(points, metric=FORM).simplices,
        "farthest": _kernel.farthest(points, False, 1, False, None)[0][3],
    }
    for other, simplices in made.items():
        found = verify(points, simplices, **options(values, member))
        assert found.valid == found.canonical == (other == member), (member, other)
        assert not verify(points, simplices)


def test_triangulations_say_what_they_are() -> None:
    rng = np.random.default_rng(42)
    points, values = rng.random((400, 2)), rng.random(400) * 0.2
    cloud = liftmesh.Cloud(np.c_[points, values], attributes={"size": values})
    for made in (
        liftmesh.regular(points, weights=values),
        liftmesh.regular(points, radii=values.astype(np.float32)),
        liftmesh.delaunay(points, metric=FORM),
        liftmesh.triangulate(cloud, radii="size"),
        liftmesh.triangulate(cloud, metric=FORM),
    ):
        assert verify(made).canonical
        assert verify(made).member != "delaunay"
        if hasattr(made, "verify"):
            assert made.verify() == verify(made)


def test_a_row_below_the_triangles_is_named() -> None:
    points = np.array([(0, 0), (4, 0), (4, 4), (0, 4), (1, 2)], dtype=float)
    triangles = [[0, 1, 2], [0, 2, 3]]
    for weight, sign in ((-7.0, 0), (-6.0, 1)):  # the height of the triangle is 12 there
        found = verify(points, triangles, weights=[0, -6, 0, 0, weight])
        (flaw,) = (flaw for flaw in found.flaws if flaw.kind == "missing_vertices")
        assert flaw.text == "1 row has no vertex, and is not hidden"
        (violation,) = flaw.first
        assert violation.rows == (0, 2, 3, 4)
        assert (violation.triangles, violation.sign) == ((1,), sign)
        assert f"its lift is {'below' if sign else 'on'} the plane of triangle 1" in violation.text
    found = verify(points, triangles, weights=[0, -6, 0, 0, -8])
    assert found.canonical
    assert (found.n_hidden, found.n_duplicates, found.n_vertices) == (1, 0, 4)


def test_rows_at_one_position() -> None:
    points = np.array([(0, 0), (4, 0), (0, 4), (0, 0), (0, 0), (4, 0), (9, 9)], dtype=float)
    good = verify(points[:6], [[0, 1, 2]], weights=[1, 0, 0, 0, 1, 0])
    assert good.canonical
    assert (good.n_hidden, good.n_duplicates) == (1, 2)
    heavier = verify(points[:6], [[0, 1, 2]], weights=[1, 0, 0, 3, 1, 0])
    assert [(flaw.kind, flaw.count) for flaw in heavier.flaws] == [("missing_vertices", 1)]
    assert heavier.flaws[0].first[0].rows[3] == 3
    outside = verify(points, [[0, 1, 2]], weights=[1, 0, 0, 0, 1, 0, 0])
    assert [flaw.first[0].rows for flaw in outside.flaws] == [(6,)]


def test_corners_that_share_no_vertex_are_merged_if_they_weigh_the_same() -> None:
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)
    points = square[[0, 1, 2, 0, 2, 3]]
    soup = [[0, 1, 2], [3, 4, 5]]
    found = verify(points, soup, weights=[1, 0, 0, 1, 0, 0])
    assert found.valid
    assert found.n_merged == 2
    assert not verify(points, soup, weights=[1, 0, 0, 0.5, 0, 0])


def test_ties_are_valid_and_not_canonical() -> None:
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for member in ({"weights": np.ones(4)}, {"furthest_site": True}, {"metric": [[2, 0], [0, 2]]}):
        both = [
            verify(square, t, **member) for t in ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]])
        ]
        assert [found.valid for found in both] == [True, True]
        assert [found.canonical for found in both] == [False, True]


@pytest.mark.parametrize("threads", [2, 5])
def test_the_certificate_is_the_same_for_any_number_of_threads(threads: int) -> None:
    rng = np.random.default_rng(43)
    points, weights = rng.random((120_000, 2)), rng.random(120_000) * 5e-5
    simplices = rng.permutation(liftmesh.regular(points, weights=weights).simplices)
    for values in (weights, weights[::-1]):
        once = verify(points, simplices, weights=values, threads=1)
        assert once == verify(points, simplices, weights=values, threads=threads)


def test_rows_that_are_not_finite_and_bad_options() -> None:
    points = np.random.default_rng(44).random((50, 2))
    weights = np.linspace(0, 0.01, 50)
    weights[[7, 30]] = np.nan, np.inf
    made = liftmesh.regular(points, weights=weights, nonfinite="skip")
    assert made.verify().canonical
    assert made.verify().n_skipped == 2
    with pytest.raises(NonFiniteError, match="row 7 has the weight nan"):
        verify(points, made.simplices, weights=weights)
    triangle = [(0, 0), (1, 0), (0, 1)], [[0, 1, 2]]
    for given, said in (
        ({"weights": [1, 2, 3], "radii": [1, 2, 3]}, "weights and radii are given"),
        ({"weights": [1, 2]}, "2 numbers for 3 rows"),
        ({"radii": [1, -1, 0]}, "row 1 has the radius -1.0"),
        ({"metric": [[1, 2], [2, 1]]}, "not positive definite"),
        ({"metric": FORM, "furthest_site": True}, "metric and furthest_site are given"),
        ({"furthest_site": "yes"}, "furthest_site"),
    ):
        with pytest.raises(InputError, match=said):
            verify(*triangle, **given)


def test_a_certificate_says_of_which_member_it_speaks() -> None:
    points, values = [(0, 0), (3, 0), (0, 3)], [1.0, 0.0, 0.5]
    said = [
        json.loads(verify(points, [[0, 1, 2]], **options(np.array(values), member)).to_json())
        for member in MEMBERS
    ]
    assert [(each["format_version"], each["member"]) for each in said] == [(2, m) for m in MEMBERS]
    assert said[2]["metric"] == FORM
    assert said[0]["values_sha256"] == said[1]["values_sha256"] != None  # noqa: E711
    assert all(each["counts"]["n_hidden"] == 0 for each in said)
    plain = json.loads(verify(points, [[0, 1, 2]]).to_json())
    assert plain["format_version"] == 1
    assert not {"member", "metric", "values_sha256"} & plain.keys()
    assert "n_hidden" not in plain["counts"]


def test_a_comparison_with_the_paraboloid_is_refused() -> None:
    points = np.random.default_rng(45).random((30, 2))
    for made, name in (
        (liftmesh.regular(points, weights=points[:, 0]), "weights"),
        (liftmesh.regular(points, radii=points[:, 0]), "radii"),
        (liftmesh.delaunay(points, metric=FORM), "metric"),
        (liftmesh.triangulate(points, metric=FORM), "metric"),
        (liftmesh.scipy.Delaunay(points, furthest_site=True), "furthest_site"),
    ):
        with pytest.raises(InputError, match=f"a triangulation by {name} has no counterpart here"):
            liftmesh.compare(made)
