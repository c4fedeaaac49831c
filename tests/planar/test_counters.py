"""What the paper's procedures count: calls, planes, dot products, and points rejected unseen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from clouds import FAMILIES
from numpy.typing import ArrayLike

import liftmesh

METHODS = ["lf", "lfres", "lfres-indexed"]
VERTICES: list[Any] = [
    "origin",
    "median",
    (0.25, 0.5),
    (1e8, 1e8),
    (1e300, -1e300),
    (5e-324, 0.0),
    (-np.finfo(np.float64).max, 1.0),
]


def counters(points: ArrayLike, algorithm: str, apex: Any = "origin") -> liftmesh.Counters:
    found = liftmesh.delaunay(points, algorithm=algorithm, apex=apex).counters
    assert found is not None
    return found


@pytest.mark.parametrize("algorithm", ["auto", "divide-and-conquer"])
def test_divide_and_conquer_counts_nothing(algorithm: str) -> None:
    assert liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], algorithm=algorithm).counters is None


@pytest.mark.parametrize("family", ["uniform", "tenth-lattice", "integer-circles", "duplicates"])
@pytest.mark.parametrize("apex", VERTICES, ids=str)
def test_lfres_tries_the_planes_of_lf_and_looks_at_the_same_points(family: str, apex: Any) -> None:
    points = FAMILIES[family](150, np.random.default_rng(2))
    lf, lfres = counters(points, "lf", apex), counters(points, "lfres", apex)
    assert (lfres.calls, lfres.candidate_planes) == (lf.calls, lf.candidate_planes)
    assert lfres.points == lf.evaluations == lf.points
    assert not any(lf.rejected.values())


@pytest.mark.parametrize("apex", ["origin", "median", (50.0, 300.0)], ids=str)
def test_the_region_spares_most_dot_products(apex: Any) -> None:
    points = FAMILIES["uniform"](1000, np.random.default_rng(3)) * 200
    lf, lfres = counters(points, "lf", apex), counters(points, "lfres", apex)
    assert lfres.evaluations < lf.evaluations / 4
    assert min(lfres.rejected[f"4.3 ({k})"] for k in ("i", "ii", "iii", "iv", "v")) > 0
    assert 0 < lfres.rejected["4.4"] < lf.candidate_planes


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("family", ["uniform", "lattice", "circle", "duplicates"])
def test_each_facet_and_each_rim_edge_takes_one_call(algorithm: str, family: str) -> None:
    points = FAMILIES[family](200, np.random.default_rng(5))
    result = liftmesh.delaunay(points, algorithm=algorithm, apex="median")
    assert result.counters is not None
    assert result.counters.calls == len(result.simplices) + len(result.convex_hull)
    assert result.counters.candidate_planes >= len(result.simplices)
    assert 0 <= result.counters.undecided <= result.counters.evaluations


@pytest.mark.parametrize("algorithm", METHODS)
def test_only_what_is_nearly_cocircular_is_left_to_the_exact_predicate(algorithm: str) -> None:
    even = FAMILIES["uniform"](400, np.random.default_rng(6))
    square = FAMILIES["lattice"](400, np.random.default_rng(6))
    assert counters(even, algorithm).undecided == 0
    assert counters(square, algorithm).undecided > 200


def test_lf_counts_by_hand() -> None:
    triangle = [[0, 0], [4, 0], [0, 4]]
    assert counters(triangle, "lf") == liftmesh.Counters(
        4, 1, 0, dict.fromkeys(counters(triangle, "lf").rejected, 0), 0
    )
    # One point inside: three facets, three rim edges.
    found = counters([*triangle, [1, 1]], "lf")
    assert found.calls == 6
    assert 3 <= found.candidate_planes == found.evaluations <= 12


@pytest.mark.parametrize("family", ["uniform", "denormal", "huge", "lattice"])
def test_the_indexed_procedure_looks_at_a_bounded_number_of_points_a_facet(family: str) -> None:
    for n in (2000, 50_000):
        points = FAMILIES[family](n, np.random.default_rng(7))
        found = counters(points, "lfres-indexed")
        assert found.evaluations == found.points
        assert found.evaluations < 30 * found.calls, f"{n} points"
        assert found.candidate_planes < 5 * found.calls, f"{n} points"


def test_the_indexed_procedure_looks_at_far_fewer_points() -> None:
    points = FAMILIES["uniform"](1000, np.random.default_rng(9))
    indexed, lfres = counters(points, "lfres-indexed"), counters(points, "lfres")
    assert indexed.points < lfres.points / 50
    assert indexed.evaluations < lfres.evaluations / 2
