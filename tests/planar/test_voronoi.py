"""`Voronoi`: exact corners, exact topology, and SciPy's attributes."""

from __future__ import annotations

import copy
import doctest
import pickle
from collections import defaultdict
from fractions import Fraction
from itertools import pairwise

import matplotlib as mpl
import numpy as np
import pytest
from hypothesis import given
from numpy.typing import NDArray
from oracles.cells import exact_point, power_centre, rounded
from oracles.planar import cells, exact
from scipy import spatial
from strategies import COCIRCULAR_CLOUDS, clouds

import liftmesh
from liftmesh import _kernel
from liftmesh.planar.diagram import diagram_of

mpl.use("Agg")
RNG = np.random.default_rng(1801)
LATTICE = np.stack(np.meshgrid(np.arange(9.0), np.arange(7.0)), axis=-1).reshape(-1, 2)
Points = NDArray[np.float64]


def made(points: Points) -> liftmesh.scipy.Voronoi | None:
    try:
        return liftmesh.scipy.Voronoi(points)
    except liftmesh.DegenerateInputError:
        return None


def check_vertices(diagram: liftmesh.scipy.Voronoi) -> None:
    centres = [
        power_centre([exact_point(diagram.points[row]) for row in corners])
        for corners in diagram.simplices.tolist()
    ]
    expected = [(rounded(x), rounded(y)) for x, y in centres]
    found = diagram.vertices[diagram.simplex_to_vertex].tolist()
    assert [*map(tuple, found)] == expected
    beyond = {centre for centre, at in zip(centres, expected, strict=True) if np.isinf(at).any()}
    assert diagram.overflowed == len(beyond)
    assert len(diagram.vertices) == len({*centres})


@pytest.mark.slow
@given(clouds(most=14))
def test_each_coordinate_is_the_nearest_double(points: Points) -> None:
    if diagram := made(points):
        check_vertices(diagram)


def test_ridges_of_a_site_one_ulp_off_a_line() -> None:
    """SciPy's own test asks a tree here, whose squares of distances, near 10^31, are rounded."""
    points = np.stack(np.meshgrid([-1.0, 0, 1], [-1.0, 0, 1], indexing="ij"), -1).reshape(-1, 2)
    points[6, 1] -= 2.0**-52
    diagram = liftmesh.scipy.Voronoi(points)
    assert np.abs(diagram.vertices).max() == 4503599627370497.0

    def nearest(place: Points) -> int:
        x, y = exact_point(place)
        squares = [(x - a) ** 2 + (y - b) ** 2 for a, b in map(exact_point, points)]
        return squares.index(min(squares))

    for rows, corners in diagram.ridge_dict.items():
        if min(corners) < 0:
            continue
        middle = diagram.vertices[corners].mean(axis=0)
        step = 1e-6 * (points[rows[0]] - middle)
        assert [nearest(middle + step), nearest(middle - step)] == [*rows]


@given(COCIRCULAR_CLOUDS)
def test_sites_on_one_circle_share_a_vertex(points: Points) -> None:
    diagram = made(points)
    if diagram is None:
        return
    expected = cells(exact(points.tolist()))
    assert len(diagram.vertices) == len(expected)
    around = defaultdict(set)
    for corners, vertex in zip(diagram.simplices, diagram.simplex_to_vertex, strict=True):
        around[vertex] |= {*corners.tolist()}
    assert sorted(map(len, around.values())) == sorted(map(len, expected))


def check_duality(diagram: liftmesh.scipy.Voronoi, neighbors: NDArray[np.int32]) -> None:
    """Ridges are the edges between different vertices; regions are what they enclose."""
    vertex_of = diagram.simplex_to_vertex
    expected = {}
    for triangle, (corners, beside) in enumerate(zip(diagram.simplices, neighbors, strict=True)):
        for k in range(3):
            other = -1 if beside[k] < 0 else vertex_of[beside[k]]
            if other != vertex_of[triangle]:
                pair = frozenset((int(corners[k - 1]), int(corners[k - 2])))
                expected[pair] = sorted((int(other), int(vertex_of[triangle])))
    found = {frozenset(rows): ends for rows, ends in diagram.ridge_dict.items()}
    assert found == expected
    assert len(diagram.ridge_points) == len(expected)
    beside = defaultdict(list)
    for rows, ends in expected.items():
        for row in rows:
            beside[row].append(ends)
    for row, ridges in beside.items():
        region = diagram.regions[diagram.point_region[row]]
        assert len(region) == len(ridges)
        if len(region) > 2:
            sides = [sorted(side) for side in pairwise([*region, region[0]])]
            assert sorted(sides) == sorted(ridges)


FAMILIES = {
    "uniform": RNG.random((200, 2)),
    "lattice": LATTICE,
    "map": np.round(RNG.random((200, 2)) * 4096) / 64 + (450_000, 5_200_000),
    "tilted": LATTICE @ [[3, 1], [-1, 3]] + 1e8,
    "small": RNG.integers(-4, 5, (60, 2)).astype(float),
    "large": RNG.uniform(-1, 1, (100, 2)) * 1.7e308,
    "denormal": RNG.integers(-40, 40, (100, 2)) * 5e-324,
    "thin": np.c_[np.arange(100.0), RNG.random(100) * 1e-200],
}


@pytest.mark.parametrize("family", FAMILIES)
def test_a_diagram_is_dual_to_the_triangulation(family: str) -> None:
    points = FAMILIES[family]
    diagram = liftmesh.scipy.Voronoi(points)
    check_vertices(diagram)
    tri = liftmesh.delaunay(points)
    np.testing.assert_array_equal(tri.simplices, diagram.simplices)
    check_duality(diagram, tri.neighbors)


@given(COCIRCULAR_CLOUDS)
def test_duality_where_vertices_are_shared(points: Points) -> None:
    if diagram := made(points):
        check_duality(diagram, liftmesh.delaunay(points).neighbors)


@pytest.mark.parametrize("family", ["uniform", "lattice", "tilted"])
def test_regions_turn_counter_clockwise(family: str) -> None:
    diagram = liftmesh.scipy.Voronoi(FAMILIES[family])
    open_ones = [region for region in diagram.regions[1:] if -1 in region]
    assert open_ones == [region for region in diagram.regions[1:] if region[0] == -1]
    assert diagram.regions[1 : 1 + len(open_ones)] == open_ones
    for row, name in enumerate(diagram.point_region):
        corners = diagram.vertices[[corner for corner in diagram.regions[name] if corner >= 0]]
        site = np.broadcast_to(diagram.points[row], corners[1:].shape)
        assert (liftmesh.orient2d(corners[:-1], corners[1:], site) >= 0).all()


@pytest.mark.parametrize("offset", [1e6, 1e8])
def test_offsets_change_nothing(offset: float) -> None:
    points = np.round(RNG.random((2000, 2)) * 2**20) / 2**20
    near, far = liftmesh.scipy.Voronoi(points), liftmesh.scipy.Voronoi(points + offset)
    assert near.regions == far.regions
    np.testing.assert_array_equal(near.point_region, far.point_region)
    assert len({*map(tuple, far.regions[1:])}) == 2000
    inside = np.abs(near.vertices).max(axis=1) < 2
    error = np.abs(near.vertices[inside] + offset - far.vertices[inside])
    assert error.max() <= np.spacing(offset)
    assert len({*map(tuple, spatial.Voronoi(points + 1e8).regions)}) < 100


def test_the_regions_are_scipys() -> None:
    points = RNG.random((500, 2)) * (3, 2) + (10, -4)
    ours, theirs = liftmesh.scipy.Voronoi(points), spatial.Voronoi(points)
    distance, same = spatial.cKDTree(theirs.vertices).query(ours.vertices)
    assert (distance < 1e-6 * (1 + np.abs(ours.vertices).max(axis=1))).all()
    assert len({*same.tolist()}) == len(theirs.vertices)
    for row in range(500):
        found = ours.regions[ours.point_region[row]]
        expected = theirs.regions[theirs.point_region[row]]
        assert {-1 if v < 0 else int(same[v]) for v in found} == {*expected}
    rays = {frozenset(rows) for rows, ends in theirs.ridge_dict.items() if -1 in ends}
    assert {frozenset(rows) for rows, ends in ours.ridge_dict.items() if -1 in ends} == rays
    for name in ("min_bound", "max_bound", "npoints", "ndim", "furthest_site"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
    assert {*vars(theirs)} - {"_qhull", "_ridge_dict"} <= {*dir(ours)}


def test_the_farthest_diagram_is_scipys() -> None:
    points = RNG.random((300, 2))
    ours = liftmesh.scipy.Voronoi(points, furthest_site=True)
    theirs = spatial.Voronoi(points, furthest_site=True)
    assert len(ours.vertices) == len(theirs.vertices)
    _, same = spatial.cKDTree(theirs.vertices).query(ours.vertices)
    for row in range(300):
        found = ours.regions[ours.point_region[row]]
        expected = theirs.regions[theirs.point_region[row]]
        assert {-1 if v < 0 else int(same[v]) for v in found} == {*expected}


def ray_direction(diagram: liftmesh.scipy.Voronoi, ridge: int) -> Points:
    start, end = diagram.points[diagram.ridge_points[ridge]]
    x, y = end - start
    return np.array([y, -x]) * (-1 if diagram.furthest_site else 1)


@pytest.mark.parametrize("furthest_site", [False, True])
def test_rays_run_to_the_side_that_is_said(furthest_site: bool) -> None:
    diagram = liftmesh.scipy.Voronoi(RNG.random((40, 2)), furthest_site=furthest_site)
    rays = np.flatnonzero(diagram.ridge_ends[:, 0] < 0)
    for ridge in rays:
        direction = ray_direction(diagram, ridge)
        far = diagram.vertices[diagram.ridge_ends[ridge, 1]] + 1e6 * direction
        distance = np.hypot(*(diagram.points - far).T)
        order = np.argsort(-distance if furthest_site else distance)
        assert {*order[:2].tolist()} == {*diagram.ridge_points[ridge].tolist()}


def test_scipys_documented_examples_and_plot() -> None:
    names: dict = {}
    text = spatial.Voronoi.__doc__ + spatial.voronoi_plot_2d.__doc__
    for example in doctest.DocTestParser().get_examples(text):
        source = example.source.replace("import Voronoi", "import voronoi_plot_2d")
        source = source.replace("Voronoi(", "liftmesh.scipy.Voronoi(").replace("plt.show()", "pass")
        exec(compile(source, "<documentation>", "exec"), {"liftmesh": liftmesh}, names)
    assert isinstance(names["vor"], spatial.Voronoi)
    for diagram in (names["vor"], liftmesh.scipy.Voronoi(LATTICE)):
        figure = spatial.voronoi_plot_2d(diagram)
        segments = sum(len(part.get_segments()) for part in figure.axes[0].collections)
        assert segments == len(diagram.ridge_points)
    mpl.pyplot.close("all")


def test_the_documented_lattice() -> None:
    points = np.array([[x, y] for x in range(3) for y in range(3)], dtype=float)
    ours, theirs = liftmesh.scipy.Voronoi(points), spatial.Voronoi(points)
    assert sorted(ours.vertices.tolist()) == sorted(theirs.vertices.tolist())
    assert len(ours.regions) == len(theirs.regions) == 10
    assert ours.regions[0] == []
    assert sorted(map(len, ours.regions)) == sorted(map(len, theirs.regions))


def test_duplicates_share_a_region() -> None:
    diagram = liftmesh.scipy.Voronoi([[0, 0], [2, 0], [0, 2], [2, 2], [1, 1], [1, 1], [-0.0, 0]])
    assert diagram.point_region[5] == diagram.point_region[4]
    assert diagram.point_region[6] == diagram.point_region[0]
    assert len(diagram.regions) == 1 + 5
    assert diagram.duplicates.tolist() == [[5, 4], [6, 0]]


def test_vertices_beyond_the_doubles_are_counted() -> None:
    diagram = liftmesh.scipy.Voronoi([[-1e200, 0], [1e200, 0], [0, 5e-324], [0, 1e200]])
    assert diagram.overflowed == 1
    assert np.isneginf(diagram.vertices).sum() == 1
    check_vertices(diagram)


def test_the_empty_region_is_there_as_the_options_say() -> None:
    points = [[0, 0], [2, 0], [0, 2], [0.5, 0.5]]
    assert liftmesh.scipy.Voronoi(points).regions[0] == []
    assert [] not in liftmesh.scipy.Voronoi(points, qhull_options="Qbb Qc").regions
    assert [] not in liftmesh.scipy.Voronoi(points, incremental=True).regions
    assert liftmesh.scipy.Voronoi(points, furthest_site=True).point_region[3] == 0
    without = liftmesh.scipy.Voronoi(points, furthest_site=True, qhull_options="Qbb")
    assert without.point_region[3] == -1
    with pytest.raises(liftmesh.InputError, match="QJ"):
        liftmesh.scipy.Voronoi(points, qhull_options="QJ")


def test_points_can_be_added() -> None:
    points = RNG.random((60, 2))
    diagram = liftmesh.scipy.Voronoi(points[:30], incremental=True)
    assert diagram.regions
    assert diagram.ridge_dict
    diagram.add_points(points[30:])
    whole = liftmesh.scipy.Voronoi(points, qhull_options="Qc")
    assert diagram.regions == whole.regions
    assert diagram.ridge_dict == whole.ridge_dict
    np.testing.assert_array_equal(diagram.vertices, whole.vertices)
    with pytest.raises(liftmesh.NonFiniteError, match="row 0"):
        diagram.add_points([[np.nan, 1]])
    diagram.close()
    with pytest.raises(RuntimeError, match="incremental=True"):
        diagram.add_points([[0, 0]])


def test_what_scipys_users_write_to() -> None:
    points = RNG.random((20, 2))
    diagram, same = liftmesh.scipy.Voronoi(points), liftmesh.scipy.Voronoi(points)
    offset = np.array([5e5, 5.6e6])
    diagram.vertices += offset
    diagram.ridge_points.sort()
    assert (diagram.regions, diagram.ridge_vertices) == (same.regions, same.ridge_vertices)
    np.testing.assert_array_equal(diagram.vertices, same.vertices + offset)
    diagram.ridge_points = same.ridge_points[:3]
    assert diagram.ridge_points.shape == (3, 2)


def test_errors_are_named() -> None:
    with pytest.raises(spatial.QhullError, match="all 3 distinct points lie on one line"):
        liftmesh.scipy.Voronoi([[0, 0], [1, 1], [2, 2]])
    with pytest.raises(liftmesh.DegenerateInputError, match="2 distinct"):
        liftmesh.scipy.Voronoi([[0, 0], [1, 1]])
    with pytest.raises(liftmesh.NonFiniteError, match="row 1 is not finite"):
        liftmesh.scipy.Voronoi([[0, 0], [1, np.inf], [2, 5]])
    with pytest.raises(liftmesh.DegenerateInputError, match="1 distinct"):
        liftmesh.scipy.Voronoi(np.zeros((5, 3)))


def pickled(diagram: liftmesh.scipy.Voronoi) -> liftmesh.scipy.Voronoi:
    return pickle.loads(pickle.dumps(diagram))


@pytest.mark.parametrize("clone", [copy.copy, copy.deepcopy, pickled])
def test_copies_hold_the_same(clone) -> None:
    diagram = liftmesh.scipy.Voronoi(LATTICE)
    other = clone(diagram)
    assert other.regions == diagram.regions
    assert other.ridge_dict == diagram.ridge_dict
    np.testing.assert_array_equal(other.points, diagram.points)


def test_the_number_of_threads_changes_nothing() -> None:
    points = RNG.random((50_000, 2))
    tri = liftmesh.delaunay(points)
    runs = [
        _kernel.vertices(points, np.empty(0), "plain", tri.simplices, tri.neighbors, threads, False)
        for threads in (1, 2, 5)
    ]
    for run in runs[1:]:
        for one, other in zip(runs[0][:-1], run[:-1], strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("kind", ["weights", "radii"])
@pytest.mark.parametrize("family", ["uniform", "lattice", "map", "small", "thin"])
def test_vertices_by_weights_are_the_nearest_doubles(kind: str, family: str) -> None:
    points = FAMILIES[family]
    size = np.ptp(points, axis=0).min() ** (2 if kind == "weights" else 1)
    values = np.round(RNG.random(len(points)) * 8) / 8 * size / len(points)
    tri = liftmesh.regular(points, **{kind: values})
    found = diagram_of(tri.points, tri.simplices, tri.neighbors, values, kind)
    lowering = [Fraction(float(value)) ** (1 if kind == "weights" else 2) for value in values]
    at = found.vertices[found.simplex_to_vertex].tolist()
    exactly = []
    for corners, (x, y) in zip(tri.simplices.tolist(), at, strict=True):
        sites = [exact_point(points[row]) for row in corners]
        exactly.append(power_centre(sites, [lowering[row] for row in corners]))
        assert (rounded(exactly[-1][0]), rounded(exactly[-1][1])) == (x, y)
    assert len({*exactly}) == len(found.vertices)
