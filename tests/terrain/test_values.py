"""Values of vertices in place of heights, and what there is beyond the faces."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from clouds import FAMILIES
from hypothesis import given, strategies as st
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import cKDTree
from surfaces import family_surface

import liftmesh
from liftmesh import InputError
from liftmesh.terrain.boundary import masked
from liftmesh.terrain.hull_places import HullPlaces


def surface_of(count: int = 500, seed: int = 1) -> liftmesh.Surface:
    rng = np.random.default_rng(seed)
    points = rng.random((count, 3))
    values = {"intensity": rng.integers(0, 4096, count), "flow": rng.random((count, 2))}
    return liftmesh.triangulate(points, attributes=values, colors=rng.random((count, 3)))


@pytest.mark.parametrize("interpolation", ["linear", "nearest", "laplace", "sibson"])
@pytest.mark.parametrize("family", FAMILIES)
def test_values_are_sampled_as_heights_are(family: str, interpolation: str) -> None:
    """The heights themselves, given as values, come back bit for bit."""
    surface, queries = family_surface(family)
    heights = surface.sample(queries, interpolation)
    values = surface.vertices[:, 2]
    found = surface.sample(queries, interpolation, values=np.column_stack([values, -values]))
    np.testing.assert_array_equal(found[:, 0], heights)
    np.testing.assert_array_equal(found[:, 1], -heights)


def test_values_have_names_and_any_shape() -> None:
    surface = surface_of()
    queries = np.random.default_rng(2).random((7, 5, 2))
    flow, tensor = surface.attributes["flow"], np.arange(3000.0).reshape(500, 3, 2)
    oracle = LinearNDInterpolator(surface.vertices[:, :2], flow)
    np.testing.assert_allclose(surface.sample(queries, values="flow"), oracle(queries), atol=1e-12)
    assert surface.sample(queries, values="colors").shape == (7, 5, 3)
    assert surface.sample(queries, values=tensor).shape == (7, 5, 3, 2)
    assert surface.sample([0.5, 0.5], values="intensity").shape == ()
    assert surface.sample(np.empty((0, 2)), values="flow").shape == (0, 2)


def test_rasters_contours_and_profiles_of_values() -> None:
    surface = surface_of()
    depth = 10 - 2 * surface.vertices[:, 2]
    line = [[0.1, 0.2], [0.9, 0.7], [0.3, 0.9]]
    raised = surface.replace(vertices=np.column_stack([surface.vertices[:, :2], depth]))
    raster = surface.raster(0.05, values=depth)
    np.testing.assert_array_equal(raster.values, raised.raster(0.05).values)
    assert (raster.quantity, raster.unit) == ("values", None)
    assert surface.raster(0.1, values="intensity").quantity == "intensity"
    for found, expected in (
        (surface.profile(line, values=depth), raised.profile(line)),
        (surface.contours(interval=0.5, values=depth), raised.contours(interval=0.5)),
    ):
        np.testing.assert_array_equal(found.points, expected.points)
        np.testing.assert_array_equal(found.starts, expected.starts)


def test_a_raster_of_values_says_no_unit_of_heights() -> None:
    points = np.array([[0.0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 1, 9]])
    cloud = liftmesh.Cloud(points, crs="EPSG:7415", attributes={"rain": np.arange(4)})
    surface = liftmesh.triangulate(cloud)
    assert surface.raster(0.5).unit == "metre"
    assert surface.raster(0.5, values="rain").unit is None


def test_values_of_a_surface_over_another_plane() -> None:
    rng = np.random.default_rng(5)
    points, values = rng.random((200, 3)), rng.random(200)
    upright = liftmesh.triangulate(points, plane="xz")
    flat = liftmesh.triangulate(np.column_stack([points[:, [0, 2]], values]))
    queries = rng.random((100, 2))
    np.testing.assert_array_equal(upright.sample(queries, values=values), flat.sample(queries))


def test_values_that_are_none() -> None:
    """A vertex without a value leaves its faces without one, and these are not beyond."""
    surface = surface_of(20)
    values = surface.vertices[:, 2].copy()
    values[7] = np.nan
    queries = surface.vertices[surface.faces, :2].mean(axis=1)
    found = surface.sample(queries, values=values, extrapolate="nearest")
    np.testing.assert_array_equal(np.isnan(found), (surface.faces == 7).any(axis=1))
    assert not np.isnan(surface.sample([-1, -1], values=values, extrapolate="nearest"))


@pytest.mark.parametrize("none", [np.nan, np.inf, -np.inf])
def test_contours_end_at_faces_with_a_corner_without_a_value(none: float) -> None:
    surface = surface_of()
    values = surface.vertices[:, 2].copy()
    values[7] = none
    without = masked(surface, (surface.triangulation.simplices == 7).any(axis=1))
    for smooth in (None, 0.05):
        found, expected = (
            each.contours(interval=0.2, smooth=smooth, **given)
            for each, given in ((surface, {"values": values}), (without, {}))
        )
        np.testing.assert_array_equal(found.points, expected.points)
    bands = surface.filled_contours(interval=0.2, values=values)
    assert bands.areas.sum() == pytest.approx(without.area(planar=True))
    np.testing.assert_array_equal(bands.points, without.filled_contours(interval=0.2).points)
    with pytest.raises(InputError, match=r"^values are not finite at a corner of each face: give"):
        surface.contours([1], values=np.full(500, none))


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ("depth", "no values 'depth', but 'colors', 'flow', 'intensity': give the name"),
        (np.ones(499), r"values have the shape \(499,\), and there are 500 vertices"),
        (3.0, r"values have the shape \(\), and there are 500"),
        (["a"] * 500, "values"),
        ([1.0] * 7 + [None] * 493, "values hold None in row 7: give NaN"),
        (np.empty((500, 0)), r"values have the shape \(500, 0\), so none"),
    ],
)
def test_values_that_fit_no_vertices(values: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        surface_of().sample([0.5, 0.5], values=values)


def test_values_for_which_a_raster_has_no_room() -> None:
    surface = surface_of()
    with pytest.raises(InputError, match=r"values='flow' has 2 numbers .* there are 'intensity'"):
        surface.raster(0.1, values="flow")
    with pytest.raises(InputError, match=r"shape \(500, 2\): give one of each vertex"):
        surface.raster(0.1, values=surface.attributes["flow"])
    with pytest.raises(InputError, match="give quantity or values, not both"):
        surface.raster(0.1, values="intensity", quantity="slope")
    with pytest.raises(InputError, match="the surface has no values 'flow', but none at all"):
        liftmesh.triangulate(np.random.default_rng(1).random((9, 3))).contours([1], values="flow")
    with pytest.raises(InputError, match="no values 'depth', but 'intensity': give"):
        surface.raster(0.1, values="depth")


def test_beyond_the_hull_is_the_nearest_vertex() -> None:
    surface = surface_of()
    queries = np.random.default_rng(3).uniform(-3, 4, (2000, 2))
    inside = ~np.isnan(surface.sample(queries))
    found = surface.sample(queries, extrapolate="nearest")
    oracle = NearestNDInterpolator(surface.vertices[:, :2], surface.vertices[:, 2])
    np.testing.assert_array_equal(found[~inside], oracle(queries[~inside]))
    np.testing.assert_array_equal(found[inside], surface.sample(queries[inside]))


def test_of_vertices_as_near_the_least_counts_whatever_the_order() -> None:
    square = np.array([[0.0, 0, 5], [2, 0, 6], [0, 2, 7], [2, 2, 8]])
    queries = [[1, -1], [-1, 1], [3, 1], [1, 3]]
    for order in ([0, 1, 2, 3], [3, 1, 2, 0], [2, 3, 0, 1]):
        surface = liftmesh.triangulate(square[order])
        assert surface.sample(queries, extrapolate="nearest").tolist() == [5, 5, 6, 7]


@given(st.integers(0, 2**32 - 1))
def test_beyond_the_hull_is_the_nearest_place_on_it(seed: int) -> None:
    """Found anew among many places on all sides."""
    rng = np.random.default_rng(seed)
    surface = liftmesh.triangulate(rng.random((int(rng.integers(3, 30)), 3)))
    queries = rng.uniform(-2, 3, (20, 2))
    beyond = np.isnan(surface.sample(queries))
    found = surface.sample(queries, extrapolate="hull")
    ends = surface.vertices[surface.triangulation.convex_hull]
    share = np.linspace(0, 1, 4001)[:, None, None]
    places = (ends + share * (np.roll(ends, -1, axis=0) - ends)).reshape(-1, 3)
    distance, at = cKDTree(places[:, :2]).query(queries[beyond])
    step = 2 / 4000
    steep = np.abs(np.diff(places[:, 2].reshape(4001, -1), axis=0)).max() * 4000
    assert (np.abs(found[beyond] - places[at, 2]) <= steep * step * (1 + distance) + 1e-9).all()


def test_the_hull_continues_the_surface() -> None:
    surface = surface_of()
    corner = surface.vertices[surface.triangulation.convex_hull[0]]
    away = corner[:2] - [1e-9, 0]
    assert surface.sample(away, extrapolate="hull") == pytest.approx(corner[2], abs=1e-6)


def test_in_a_gap_there_is_the_nearest_vertex_and_no_hull() -> None:
    far = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [9, 9, 4], [9, 8, 4], [8, 9, 4]]
    surface = liftmesh.triangulate(far).trim(max_edge=2)
    assert np.isnan(surface.sample([4, 4], extrapolate="hull"))
    assert surface.sample([4, 4], extrapolate="nearest") == 1
    assert surface.sample([20, 20], extrapolate="hull") == 4


TRIANGLE = [[0, 0, 5], [4, 0, 9], [0, 4, 1]]


@pytest.mark.parametrize(
    ("place", "height"),
    [
        ([1e200, 1], 9),
        ([-1e8, 1], 4),
        ([1, 1e17], 1),
        ([2 + 1e17, 2 + 1e17], 5),
        ([3 + 1e200, 1 + 1e200], 5),
        ([1.5e308, -1.5e308], 9),
        ([2, -1e-200], 7),
        ([2, -1e300], 7),
        ([5e-324, -5e-324], 5),
    ],
)
def test_the_nearest_place_on_the_hull_at_any_distance(place: list[float], height: float) -> None:
    assert liftmesh.triangulate(TRIANGLE).sample(place, extrapolate="hull") == height


@pytest.mark.parametrize("scale", [-664, 0, 600, 1020])
def test_the_nearest_place_on_the_hull_at_any_scale(scale: int) -> None:
    points = np.array(TRIANGLE) * [2.0**scale, 2.0**scale, 1]
    queries = np.array([[-1, 1], [-1, -2], [2, -3], [6, 1], [3, 3], [-2, 5]]) * 2.0**scale
    found = liftmesh.triangulate(points).sample(queries, extrapolate="hull")
    assert found.tolist() == [4, 5, 7, 9, 5, 1]
    assert liftmesh.triangulate(points).sample([-1e-200, 0], extrapolate="hull") == 5


def exact_place(corners: np.ndarray, query: np.ndarray) -> list[Fraction] | None:
    """Find the nearest place on a hull by rational distances; None inside."""
    ring = [[*map(Fraction, each)] for each in corners.tolist()]
    x, y = map(Fraction, query.tolist())
    places, is_beyond = [], False
    for (a, b), (c, d) in zip(ring, ring[1:] + ring[:1], strict=True):
        u, v = c - a, d - b
        is_beyond |= u * (y - b) - v * (x - a) < 0
        share = min(max((u * (x - a) + v * (y - b)) / (u * u + v * v), Fraction(0)), Fraction(1))
        places.append([a + share * u, b + share * v])
    return min(places, key=lambda p: (p[0] - x) ** 2 + (p[1] - y) ** 2) if is_beyond else None


@given(st.integers(0, 2**32 - 1), st.sampled_from([-660, -30, 0, 30, 660]), st.booleans())
def test_nearest_places_are_those_of_rational_distances(seed: int, scale: int, grid: bool) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 6, (20, 2)) + 0.0 if grid else rng.random((20, 2))
    points *= [2.0**scale, 2.0 ** (scale - int(rng.integers(0, 40)))]
    corners = points[liftmesh.delaunay(points).convex_hull]
    size = np.ptp(corners, axis=0).max()
    far = 10.0 ** rng.integers(0, 17, (6, 1))
    queries = np.concatenate([
        corners.mean(axis=0) + size * rng.uniform(-2, 2, (6, 2)),
        corners[rng.integers(len(corners), size=6)] + size * rng.integers(-2, 3, (6, 2)) * far,
        rng.uniform(-1, 1, (4, 2)) * [[1e17], [1e200], [1e-200], [1e300]],
    ])  # fmt: skip
    side, share = HullPlaces(corners).nearest(queries)
    ends = np.roll(corners, -1, axis=0)
    for query, k, part in zip(queries, side, share, strict=True):
        expected = exact_place(corners, query)
        assert (expected is None) == (k < 0)
        for a, b, exact in zip(corners[k], ends[k], expected or (), strict=False):
            place = Fraction(a) + Fraction(part) * (Fraction(b) - Fraction(a))
            assert abs(place - exact) <= Fraction(size) / 2**50


def test_a_vertex_without_a_value_spoils_no_other_corner() -> None:
    for value in (np.nan, np.inf):
        surface = liftmesh.triangulate(TRIANGLE)
        found = surface.sample(
            [[9, -1], [-1, 9], [-1, -1]], values=[value, 2, 3], extrapolate="hull"
        )
        np.testing.assert_array_equal(found, [2, 3, value])


def test_vertices_in_no_face_are_not_extrapolated() -> None:
    square = [[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1], [9, 1, 777]]
    ring = [[0, 0], [2, 0], [2, 2], [0, 2]]
    carved = liftmesh.triangulate(square, boundary=ring)
    trimmed = liftmesh.triangulate(square).trim(max_edge=3)
    for surface in (carved, trimmed):
        assert 4 not in surface.faces
        for way in ("nearest", "hull"):
            assert surface.sample([8, 1], extrapolate=way) == 1


def test_what_cannot_be_extrapolated() -> None:
    surface = surface_of()
    with pytest.raises(InputError, match="extrapolate"):
        surface.sample([2, 2], extrapolate="cubic")  # type: ignore[arg-type]
    weighted = liftmesh.triangulate(np.random.default_rng(1).random((9, 3)), weights=np.zeros(9))
    with pytest.raises(InputError, match=r"extrapolate 'nearest' .* extrapolate 'hull'"):
        weighted.sample([2, 2], extrapolate="nearest")
    assert not np.isnan(weighted.sample([2, 2], extrapolate="hull"))
    assert np.isnan(surface.sample([np.nan, 2], extrapolate="nearest"))
    assert np.isnan(surface.sample([np.nan, 2], extrapolate="hull"))


def test_an_interpolator_is_called_as_that_of_scipy() -> None:
    surface = surface_of()
    x, y = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 4))
    theirs = LinearNDInterpolator(surface.vertices[:, :2], surface.attributes["flow"])
    ours = surface.interpolator("flow")
    np.testing.assert_allclose(ours(x, y), theirs(x, y), atol=1e-12)
    np.testing.assert_array_equal(ours(np.stack([x, y], axis=-1)), ours(x, y))
    assert not np.isnan(surface.interpolator(extrapolate="hull")(x, y)).any()
    np.testing.assert_array_equal(
        surface.interpolator(interpolation="sibson")(x, y, threads=1),
        surface.sample(np.stack([x, y], axis=-1), "sibson"),
    )


def test_an_interpolator_is_checked_and_prepared_when_it_is_made() -> None:
    surface, values = surface_of(), np.ones(500)
    for options, said in (
        ({"values": "depth"}, "no values 'depth'"),
        ({"interpolation": "cubic"}, "interpolation"),
        ({"extrapolate": "yes"}, "extrapolate"),
    ):
        with pytest.raises(InputError, match=said):
            surface.interpolator(**options)
    made = surface.interpolator(values)
    values[:] = 2
    assert made(0.5, 0.5) == pytest.approx(1)
    with pytest.raises(InputError, match="0 arrays are given: give one of points, or x and y"):
        made()
    with pytest.raises(InputError, match=r"x has the shape \(2,\), and y \(3,\): give two"):
        made([1, 2], [1, 2, 3])
