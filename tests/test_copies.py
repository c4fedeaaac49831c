"""Results and exceptions survive pickling and copying."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import liftmesh

CLOUD = np.random.default_rng(3).random((40, 3))
WAYS = pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))]
)


@WAYS
def test_results(again: Callable[[Any], Any]) -> None:
    surface = liftmesh.triangulate(CLOUD)
    surface.triangulation.find_simplex([0.5, 0.5])
    twin = again(surface)
    np.testing.assert_array_equal(twin.faces, surface.faces)
    assert dict(twin.report.seconds) == dict(surface.report.seconds)
    found = twin.triangulation.find_simplex([0.5, 0.5])
    assert found == surface.triangulation.find_simplex([0.5, 0.5])
    comparison = liftmesh.compare(surface)
    assert again(comparison).verdict == comparison.verdict
    cloud = liftmesh.Cloud(CLOUD, attributes={"class": np.arange(40)}, metadata={"epsg": 25832})
    assert again(cloud).metadata == cloud.metadata
    np.testing.assert_array_equal(again(cloud).attributes["class"], np.arange(40))


@pytest.mark.parametrize(
    "wanted",
    [
        {},
        {"interpolation": "sibson", "values": CLOUD[:, :2]},
        {"interpolation": "c1", "gradients": CLOUD[:, :2] - 0.5, "extrapolate": "hull"},
    ],
)
@WAYS
def test_interpolators(again: Callable[[Any], Any], wanted: dict[str, Any]) -> None:
    asked = np.random.default_rng(5).uniform(-0.2, 1.2, (500, 2))
    called = liftmesh.triangulate(CLOUD).interpolator(**wanted)
    assert again(called)(asked).tobytes() == called(asked).tobytes()


@WAYS
def test_exceptions(again: Callable[[Any], Any]) -> None:
    twin = again(liftmesh.NonFiniteError("row 3 is not finite", row=3))
    assert (str(twin), twin.row) == ("row 3 is not finite", 3)
    twin = again(liftmesh.DuplicateHeightError("rows 1 and 2", rows=(1, 2)))
    assert (str(twin), twin.rows) == ("rows 1 and 2", (1, 2))
    assert str(again(liftmesh.FormatError("a.ply: line 3"))) == "a.ply: line 3"


ARRAYS = ("points", "simplices", "neighbors", "duplicates", "skipped")
MADE = [liftmesh.delaunay, liftmesh.scipy.Delaunay]


@pytest.mark.parametrize("again", [lambda it: it, *WAYS.args[1]])
@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_what_point_location_rests_on_cannot_be_changed(
    again: Callable[[Any], Any], kind: type
) -> None:
    given = CLOUD.astype(kind)
    tri = again(liftmesh.delaunay(given))
    for name in ARRAYS:
        with pytest.raises(ValueError, match="read-only"):
            getattr(tri, name)[...] = 0
    given[0] = 0  # the caller's own array is not touched


@pytest.mark.parametrize("made", MADE)
def test_a_copy_does_not_see_what_the_caller_writes(made: Callable[..., Any]) -> None:
    points = np.random.default_rng(4).random((2000, 2))
    shared, own = made(points), made(points, copy=True)
    assert np.shares_memory(shared.points, points)
    assert not np.shares_memory(own.points, points)
    queries = np.random.default_rng(5).random((100, 2))
    expected = own.find_simplex(queries)
    points[:] = points[::-1].copy()
    assert own.verify().valid
    assert not shared.verify().valid
    np.testing.assert_array_equal(own.find_simplex(queries), expected)
    np.testing.assert_array_equal(own.points[::-1], points)


def test_vertices_that_may_be_the_callers_cannot_be_changed() -> None:
    cloud = CLOUD.copy()
    for vertices in (liftmesh.triangulate(cloud).vertices, liftmesh.lower_hull(cloud).vertices):
        assert np.shares_memory(vertices, cloud)
        with pytest.raises(ValueError, match="read-only"):
            vertices[0] = 0
    cloud[0] = 0


@pytest.mark.parametrize("asked_before", [True, False])
@pytest.mark.parametrize("value", [None, 0.0, np.nan, np.inf, -1e308, 5e-324, "some"])
def test_point_location_ends_even_where_the_points_were_changed(
    value: Any, asked_before: bool
) -> None:
    points = np.random.default_rng(4).random((2000, 2))
    tri = liftmesh.delaunay(points)
    if asked_before:
        tri.find_simplex([0.5, 0.5])
    if value is None:
        points[:] = points[::-1].copy()
    elif value == "some":
        points[::3], points[1::3, 0], points[2::7] = np.nan, np.inf, 1e308
    else:
        points[:] = value
    found = tri.find_simplex(np.random.default_rng(5).random((3000, 2)))
    assert found.min() >= -1
    assert found.max() < tri.nsimplex
    for kind in ("gabriel", "minimum_spanning_tree", "sphere_of_influence"):
        assert tri.graph(kind, "binary").shape == (2000, 2000)  # type: ignore[arg-type]


DAMAGE = [("simplices", 10**8), ("simplices", -1), ("neighbors", 10**8), ("neighbors", -2)]


@pytest.mark.parametrize(("name", "number"), [*DAMAGE, ("_hull", 41), ("duplicates", -1)])
@pytest.mark.parametrize("make", MADE)
def test_damaged_pickles_are_refused(make: Callable[..., Any], name: str, number: int) -> None:
    tri = make(np.concatenate([CLOUD[:, :2], CLOUD[:1, :2]]))
    state = dict(tri.__getstate__())
    names = "simplices", "neighbors"
    exact = {each: array.copy() for each, array in zip(names, tri._given(), strict=False)}
    others = {each: state[each].copy() for each in ("_hull", "duplicates")}
    (exact | others)[name][0] = number
    state |= {**exact, **others, "_exact": tuple(exact.values())}
    with pytest.raises(liftmesh.InputError, match=f"damaged: it has the number {number} where"):
        object.__new__(type(tri)).__setstate__(state)


def test_a_pickle_with_missing_triangles_is_refused() -> None:
    tri = liftmesh.delaunay(CLOUD)
    state = dict(tri.__getstate__()) | {"neighbors": tri.neighbors[1:]}
    with pytest.raises(liftmesh.InputError, match="damaged: simplices are"):
        object.__new__(liftmesh.Triangulation).__setstate__(state)


@pytest.mark.parametrize("number", [-2, 4])
@pytest.mark.parametrize("name", ["simplices", "neighbors", "convex_hull", "duplicates", "offsets"])
def test_damaged_sets_are_refused(name: str, number: int) -> None:
    """Set 1 has four rows and three triangles."""
    rows = [[0, 0], [1, 0], [0, 1], [0, 0], [0, 0], [3, 0], [0, 3], [1, 1], [0, 0]]
    made = liftmesh.delaunay_many(rows, [0, 4, 9])
    arrays = {each.name: getattr(made, each.name).copy() for each in fields(made)}
    arrays[name].reshape(-1)[-1 if name == "offsets" else 0] = number
    damaged = pickle.dumps(replace(made, **arrays))
    with pytest.raises(liftmesh.InputError, match="damaged: it"):
        pickle.loads(damaged)


RADII = np.full(40, 0.02)
RADII[::2] = 0.01
CELLS: list[Callable[[], Any]] = [
    lambda: liftmesh.voronoi(CLOUD),
    lambda: liftmesh.power_diagram(CLOUD, radii=RADII),
    lambda: liftmesh.apollonius_diagram(CLOUD[:, :2], RADII),
]


@pytest.mark.parametrize("number", [10**8, -2, 1])
@pytest.mark.parametrize("name", ["parts", "rings", "ring_corners"])
@pytest.mark.parametrize("make", CELLS)
def test_damaged_offsets_of_cells_are_refused(
    make: Callable[[], Any], name: str, number: int
) -> None:
    state = dict(make().__dict__)
    state[name] = state[name].copy()
    state[name][-2 if number == 1 else -1] = number
    with pytest.raises(liftmesh.InputError, match="damaged: its starts do not divide"):
        object.__new__(type(make())).__setstate__(state)


@pytest.mark.parametrize(("name", "number"), [*DAMAGE, ("simplex_to_vertex", -1)])
@pytest.mark.parametrize("make", [*CELLS[:2], lambda: liftmesh.scipy.Voronoi(CLOUD[:, :2])])
def test_damaged_triangles_of_diagrams_are_refused(
    make: Callable[[], Any], name: str, number: int
) -> None:
    made = make()
    state = dict(made.__dict__)
    dual = state.get("_dual")
    key = "_neighbors" if name == "neighbors" and dual is None else name
    array = np.array(state[key] if dual is None else getattr(dual, name))
    array[0] = number
    state |= {key: array} if dual is None else {"_dual": replace(dual, **{name: array})}
    with pytest.raises(liftmesh.InputError, match=f"damaged: it has the number {number} where"):
        object.__new__(type(made)).__setstate__(state)


@pytest.mark.parametrize("make", [CELLS[0], lambda: liftmesh.scipy.Voronoi(CLOUD[:, :2])])
def test_neighbors_that_share_no_side_are_refused(make: Callable[[], Any]) -> None:
    made = make()
    state = dict(made.__dict__)
    if "_dual" in state:
        state["_dual"] = replace(made._dual, neighbors=made._dual.neighbors[::-1])
    else:
        state["_neighbors"] = made._neighbors[::-1]
    with pytest.raises(liftmesh.InputError, match="share no side"):
        object.__new__(type(made)).__setstate__(state)


@pytest.mark.parametrize(
    ("made", "name"),
    [
        (liftmesh.apollonius(CLOUD[:, :2], RADII), "simplices"),
        (liftmesh.apollonius(CLOUD[:, :2], RADII), "neighbors"),
        (liftmesh.apollonius(CLOUD[:, :2], RADII), "convex_hull"),
        (liftmesh.lower_hull(CLOUD), "faces"),
        (liftmesh.lower_hull(CLOUD), "neighbors"),
    ],
)
def test_damaged_graphs_and_hulls_are_refused(made: Any, name: str) -> None:
    pickled = pickle.dumps(replace(made, **{name: getattr(made, name) + 1000}))
    with pytest.raises(liftmesh.InputError, match="damaged: it has the number"):
        pickle.loads(pickled)


@WAYS
@pytest.mark.parametrize(
    "make", [*CELLS, lambda: liftmesh.voronoi([[0, 0]], domain=(9, 9, 10, 10))]
)
def test_copies_of_cells(make: Callable[[], Any], again: Callable[[Any], Any]) -> None:
    made = make()
    np.testing.assert_array_equal(again(made).corners, made.corners)
    assert repr(again(made)) == repr(made)
