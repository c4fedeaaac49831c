"""Voronoi diagrams in space: exact topology, vertices rounded once, SciPy's form."""

from __future__ import annotations

import copy
import pickle
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from oracles.alpha import smallest_sphere
from oracles.cells import rounded
from scipy import spatial

import liftmesh
from liftmesh import _kernel

RNG = np.random.default_rng(41)
CLOUD = RNG.random((60, 3))
GRID = np.indices((4, 4, 4)).reshape(3, -1).T * 0.1


NUMBERS = st.one_of(
    st.integers(-3, 3).map(float),
    st.floats(-1, 1),
    st.integers(-2, 2).map(lambda steps: 1 + steps * 2.0**-52),
    st.builds(
        np.ldexp, st.integers(-9, 9).map(float), st.sampled_from([-1074, -600, 0, 600, 1020])
    ).map(float),
)
NEAR = st.integers(-9, 9).map(float)
CORNERS = st.one_of(
    *(
        st.lists(st.tuples(each, each, each), min_size=4, max_size=4, unique=True)
        for each in (NUMBERS, NEAR)
    )
)


def exact_center(corners: np.ndarray) -> list[float]:
    """Solve for the point at equal distance of four in fractions, and round."""
    return [rounded(x) for x in smallest_sphere(np.vectorize(Fraction)(corners).tolist())[0]]


def centers_of(corners: np.ndarray) -> list[list[float]]:
    found = np.full((len(corners) // 4, 3), np.nan)
    _kernel.circumcentres(corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 4), found)
    return found.tolist()


@given(CORNERS)
def test_centers_are_the_exact_ones_rounded(corners: list[tuple[float, ...]]) -> None:
    points = np.array(corners)
    assume(liftmesh.orient3d(*points) != 0)
    (found,) = centers_of(points)
    assert found == exact_center(points)
    assert not any(np.signbit(x) for x in found if x == 0)


def test_centers_in_the_middle_of_two_doubles() -> None:
    """A tie goes to the even double, and a sum beyond the greatest double to infinity."""
    edges = np.vstack([np.zeros(3), np.eye(3)])
    for scale, shift in ((1.0, 2.0**52), (2.0**-1074, 0.0), (3 * 2.0**-1074, 0.0), (1.5e308, 0.0)):
        points = edges * scale + shift
        expected = exact_center(points)
        assert centers_of(points) == [expected]
        assert centers_of(-points) == [[0.0 - x for x in expected]]
    beyond = np.array([[9, 0, 0], [-9, 0, 0], [0, 9, 0], [9, 9, 9 * 2.0**-52]]) * 1e307
    assert centers_of(beyond) == [exact_center(beyond)]


def test_it_is_scipys_in_general_position() -> None:
    ours, theirs = liftmesh.scipy.Voronoi(CLOUD), spatial.Voronoi(CLOUD)
    for kind in (liftmesh.scipy.Voronoi, liftmesh.scipy.SpaceVoronoi, spatial.Voronoi):
        assert isinstance(ours, kind)
    assert len(ours.vertices) == len(theirs.vertices)
    distance, place = spatial.KDTree(theirs.vertices).query(ours.vertices)
    assert distance.max() < 1e-9
    name = {-1: -1, **dict(enumerate(place.tolist()))}
    for row in range(60):
        found = {name[v] for v in ours.regions[ours.point_region[row]]}
        assert found == {*theirs.regions[theirs.point_region[row]]}
    expected = {tuple(sorted(rows)): {*corners} for rows, corners in theirs.ridge_dict.items()}
    found = {rows: {name[v] for v in corners} for rows, corners in ours.ridge_dict.items()}
    assert {rows: found[rows] for rows in expected} == expected
    # SciPy leaves out wedges between two rays from one vertex.
    assert all(len(found[rows]) == 2 and -1 in found[rows] for rows in {*found} - {*expected})
    assert {*found} == {tuple(edge) for edge in edges_of(ours.simplices)}


def edges_of(simplices: np.ndarray) -> list[list[int]]:
    pairs = [(i, j) for j in range(4) for i in range(j)]
    ends = np.concatenate([np.sort(simplices[:, pair], axis=1) for pair in pairs])
    return np.unique(ends, axis=0).tolist()


def test_corners_are_in_order_around_ridges() -> None:
    diagram = liftmesh.scipy.Voronoi(CLOUD)
    for (one, other), corners in diagram.ridge_dict.items():
        assert (corners[0] == -1) == (-1 in corners)
        if -1 in corners:
            continue
        places = diagram.vertices[corners] - diagram.vertices[corners].mean(axis=0)
        turns = np.cross(places, np.roll(places, -1, axis=0)) @ (CLOUD[other] - CLOUD[one])
        assert (turns > 0).all()


@pytest.mark.parametrize("scale", [1.0, 2.0**-900, 1e290])
def test_vertices_are_rounded_once(scale: float) -> None:
    points = CLOUD[:12] * scale
    diagram = liftmesh.scipy.Voronoi(points)
    for cell, vertex in zip(diagram.simplices, diagram.simplex_to_vertex, strict=True):
        assert diagram.vertices[vertex].tolist() == exact_center(points[cell])


def test_a_site_whose_ridges_are_those_of_all_others() -> None:
    around = np.random.default_rng(7).standard_normal((90, 3))
    around /= np.linalg.norm(around, axis=1)[:, None]
    diagram = liftmesh.scipy.Voronoi(np.vstack([[[0, 0, 0]], around]))
    assert {pair for pair in diagram.ridge_dict if 0 in pair} == {(0, k) for k in range(1, 91)}
    inner = [corners for pair, corners in diagram.ridge_dict.items() if 0 in pair]
    assert {v for corners in inner for v in corners} == {*range(len(diagram.vertices))}
    assert all(corners[0] == -1 for pair, corners in diagram.ridge_dict.items() if 0 not in pair)


def test_every_region_of_a_lattice_is_a_cube() -> None:
    diagram = liftmesh.scipy.Voronoi(np.vstack([GRID, GRID[:2]]))
    assert len(diagram.vertices) == 27
    assert len(diagram.ridge_points) == 3 * 4 * 4 * 3  # none between sites that touch at an edge
    inner = ((GRID > 0.05) & (GRID < 0.25)).all(axis=1)
    counts = [len(diagram.regions[region]) for region in diagram.point_region[:64][inner]]
    assert counts == [8] * 8
    assert diagram.point_region[64:].tolist() == diagram.point_region[:2].tolist()
    assert diagram.regions[0] == []  # of Qz
    assert [] not in liftmesh.scipy.Voronoi(GRID, qhull_options="Qbb").regions


def test_beyond_the_greatest_double() -> None:
    points = np.array([[0, 0, 0], [1e300, 0, 0], [0, 1e300, 0], [1e299, 1e299, 1e-300]])
    diagram = liftmesh.scipy.Voronoi(points)
    assert diagram.overflowed == 1
    assert diagram.vertices[0].tolist() == [5e299, 5e299, -np.inf]


def test_writes_copies_and_growth() -> None:
    whole = liftmesh.scipy.Voronoi(CLOUD, qhull_options="Qc")
    diagram = liftmesh.scipy.Voronoi(CLOUD[:30], incremental=True)
    first = diagram.regions
    diagram.add_points(CLOUD[30:])
    assert diagram.regions == whole.regions != first
    assert diagram.ridge_dict == whole.ridge_dict
    diagram.vertices += 1
    for clone in (copy.copy(diagram), pickle.loads(pickle.dumps(diagram))):
        assert clone.regions == whole.regions
        assert clone.ridge_vertices == whole.ridge_vertices


def test_refusals() -> None:
    with pytest.raises(spatial.QhullError, match="lie on one plane"):
        liftmesh.scipy.Voronoi(GRID * (1, 1, 0))
    with pytest.raises(liftmesh.InputError, match="furthest_site=True is for planar points"):
        liftmesh.scipy.Voronoi(CLOUD, furthest_site=True)
    with pytest.raises(liftmesh.InputError, match=r"4 columns .* which nothing proves"):
        liftmesh.scipy.Voronoi(np.zeros((9, 4)))
    with pytest.raises(liftmesh.NonFiniteError, match="row 3"):
        liftmesh.scipy.Voronoi(np.where(np.arange(30).reshape(10, 3) == 9, np.inf, GRID[:10]))
