"""Point location of many queries: whatever their order, their number and the threads."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from growth.counting import count
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


@pytest.mark.parametrize("family", ["circle and centre", "polar scan", "facing arcs"])
def test_many_queries_in_a_fan_take_seconds(family: str) -> None:
    tri = liftmesh.delaunay(PLANAR[family](200_000))
    asked = np.tile(near_the_middle(tri), (2, 1))
    asked[::2] = tri.points[-1]
    began = time.process_time()
    tri.find_simplex(asked)
    assert time.process_time() - began < 10  # going around the centre: hours


@pytest.mark.parametrize("family", ["oblique line", "noisy cross"])
def test_thin_triangles_take_no_longer_among_many(family: str) -> None:
    tri = liftmesh.delaunay(PLANAR[family](400_000))
    asked = centroids(tri)[:20_000]
    tri.find_simplex(asked)
    began = time.process_time()
    tri.find_simplex(asked)
    assert time.process_time() - began < 0.3  # cuts at rounded places: 0.6 and growing


def test_rows_that_were_overwritten_are_not_walked_through_for_ever() -> None:
    points = PLANAR["uniform"](20_000)
    tri = liftmesh.delaunay(points)
    asked = near_the_middle(tri)
    points[::3] = np.nan
    began = time.process_time()
    found = tri.find_simplex(asked)
    assert time.process_time() - began < 5
    assert found.min() >= -1
    assert found.max() < tri.nsimplex


def test_the_first_raster_makes_no_index_of_edges(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    first, second = (c.instructions for c in count("rasters:prepare", ["first", "second"]))
    assert first < 2 * second  # the index takes several times as much as the raster


def test_an_index_is_shared_by_threads_that_need_it_at_once() -> None:
    tri = liftmesh.delaunay(PLANAR["circle and centre"](50_000))
    asked = near_the_middle(tri)
    expected = liftmesh.delaunay(tri.points).find_simplex(asked)
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(lambda _: tri.find_simplex(asked), range(8)):
            np.testing.assert_array_equal(found, expected)


def test_queries_of_one_trapezoid_start_from_each_other() -> None:
    def time_of(asked: NDArray[np.float64]) -> float:
        began = time.process_time()
        tri.find_simplex(asked)
        return time.process_time() - began

    tri = liftmesh.delaunay(PLANAR["circle and centre"](100_000))
    asked = near_the_middle(tri)
    tri.find_simplex(asked)
    apart = sum(time_of(some) for some in np.array_split(asked, 100))
    assert time_of(asked) < 0.4 * apart  # each from an edge of the sample: 0.57
