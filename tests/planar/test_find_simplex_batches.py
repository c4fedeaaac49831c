"""Point location of many queries: whatever their order, their number and the threads."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from counted_calls import MANY, instructions
from growth.functions import centroids, near_the_middle
from growth.planar import PLANAR, THIN
from numpy.typing import NDArray

import liftmesh

FANS = ("circle and centre", "polar scan", "column and apex")
HARD = (*FANS, *THIN, "facing arcs", "nested clusters")
WIDE = ("mixed exponents", "wide line", "tiny and far", "wide spiral", "huge by denormal")


def queries_of(tri: liftmesh.Triangulation) -> NDArray[np.float64]:
    """Rows, middles of edges, points inside, outside and nowhere, in no order."""
    rng = np.random.default_rng(3)
    ends = tri.points[tri.edges]
    around = rng.uniform(-1.2, 1.2, (2000, 2)) * np.abs(tri.points).max()
    all_kinds = [tri.points, ends.mean(axis=1), centroids(tri), near_the_middle(tri), around]
    asked = np.vstack([*all_kinds, np.full((3, 2), np.nan), np.full((3, 2), np.inf)])
    return rng.permutation(asked[rng.integers(0, len(asked), 30_000)])


def contains(tri: liftmesh.Triangulation, found: NDArray[np.int32], p: NDArray[np.float64]) -> bool:
    corners = tri.points[tri.simplices[found]]
    sides = [liftmesh.orient2d(corners[:, k], corners[:, (k + 1) % 3], p) for k in range(3)]
    return bool((np.array(sides) >= 0).all())


@pytest.mark.parametrize("family", [*HARD, *WIDE, "lattice", "uniform"])
def test_answers_do_not_depend_on_order_number_or_threads(
    family: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with np.errstate(over="ignore"):
        tri = liftmesh.delaunay(PLANAR[family](3000))
        asked = queries_of(tri)
    found = tri.find_simplex(asked)
    inside = found >= 0
    assert contains(tri, found[inside], asked[inside])
    assert not inside[~np.isfinite(asked).all(axis=1)].any()
    by_place = np.lexsort((asked[:, 1], found))
    monkeypatch.setenv("LIFTMESH_NUM_THREADS", "3")
    np.testing.assert_array_equal(tri.find_simplex(asked[by_place]), found[by_place])
    again = liftmesh.delaunay(tri.points)
    one_by_one = [int(again.find_simplex(p)) for p in asked[:500]]
    assert one_by_one == found[:500].tolist()


@pytest.mark.parametrize("family", HARD)
def test_the_first_of_the_triangles_at_a_row_is_found(family: str) -> None:
    tri = liftmesh.delaunay(PLANAR[family](20_000))
    np.testing.assert_array_equal(tri.find_simplex(tri.points), tri.vertex_to_simplex)


@pytest.mark.campaign
def test_no_query_takes_much_however_it_lies() -> None:
    thin = [["inside_of_thin", 50_000, family] for family in ("oblique line", "noisy cross")]
    fans = [["around_the_middle", 24_000, family] for family in FANS[:2]]
    found = instructions(*thin, *fans, ["around_the_middle", 24_000, "facing arcs"])
    assert max(found[:2]) < 20_000 * MANY
    assert max(found[2:]) < 10_000 * MANY  # going around the centre: 24,000 triangles each


def test_rows_that_were_overwritten_are_not_walked_through_for_ever() -> None:
    points = PLANAR["uniform"](20_000)
    tri = liftmesh.delaunay(points)
    asked = near_the_middle(tri)
    points[::3] = np.nan
    found = tri.find_simplex(asked)
    assert found.min() >= -1
    assert found.max() < tri.nsimplex


@pytest.mark.campaign
def test_the_first_raster_makes_no_index_of_edges() -> None:
    first, second = instructions(["first_raster", 40_000], ["second_raster", 40_000])
    assert first < 2 * second  # the index takes several times as much as the raster


def test_an_index_is_shared_by_threads_that_need_it_at_once() -> None:
    tri = liftmesh.delaunay(PLANAR["circle and centre"](50_000))
    asked = near_the_middle(tri)
    expected = liftmesh.delaunay(tri.points).find_simplex(asked)
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(lambda _: tri.find_simplex(asked), range(8)):
            np.testing.assert_array_equal(found, expected)


@pytest.mark.campaign
def test_queries_of_one_trapezoid_start_from_each_other() -> None:
    at_once, apart = instructions(["in_parts", 20_000, 1], ["in_parts", 20_000, 100])
    assert at_once < 0.4 * apart  # as much as they would take from an edge of the sample: 0.57
