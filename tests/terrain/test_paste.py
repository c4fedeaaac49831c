"""One surface pasted into another: heights of both, without a gap."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings, strategies as st
from surfaces import meadow

import liftmesh

SQUARE = np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [9, 9, 0]])
FAR = (4.5e5, 5.2e6, 100)


def star(rng: np.random.Generator, corners: int) -> np.ndarray:
    angles = (np.arange(corners) + rng.uniform(0.1, 0.9, corners)) * 2 * np.pi / corners
    return np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(5, 30, (corners, 1)) + 45


def random_surface(rng: np.random.Generator, n: int, offset) -> liftmesh.Surface:
    """Over a square as a whole."""
    points = rng.random((n, 3)) * (90, 90, 9)
    corners = np.array([[0, 0, 1], [90, 0, 2], [0, 90, 3], [90, 90, 4]])
    return liftmesh.triangulate(np.concatenate([corners, points]) + offset)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 12), st.sampled_from([(0, 0, 0), FAR]))
def test_inside_are_the_heights_of_one_and_outside_of_the_other(seed, corners, offset) -> None:
    rng = np.random.default_rng(seed)
    one, two = random_surface(rng, 60, offset), random_surface(rng, 50, offset)
    shape = shapely.Polygon(star(rng, corners) + offset[:2])
    pasted = liftmesh.paste(one, two, shape)
    assert pasted.verify().valid
    assert pasted.area(planar=True) == pytest.approx(8100, rel=1e-9)
    assert len(pasted.boundary()) == 1
    places = rng.uniform(0, 90, (300, 2)) + offset[:2]
    inside = shapely.contains_xy(shape.buffer(-1e-6), places)
    heights = pasted.sample(places)
    assert heights[inside] == pytest.approx(two.sample(places[inside]), abs=1e-6)
    touched = [
        shapely.Polygon(each).intersects(shape) for each in one.triangulation.points[one.faces]
    ]
    away = ~np.array(touched)[one.triangulation.find_simplex(places)]
    assert np.array_equal(heights[away], one.sample(places[away]))
    inner = pasted.clip(shape)
    assert inner.volume(offset[2]).above == pytest.approx(
        two.volume(offset[2], within=shape).above, rel=1e-6
    )


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 9))
def test_a_surface_pasted_into_itself_stays(seed: int, corners: int) -> None:
    rng = np.random.default_rng(seed)
    surface = random_surface(rng, 60, (0, 0, 0))
    pasted = liftmesh.paste(surface, surface, star(rng, corners))
    places = rng.uniform(0, 90, (300, 2))
    assert pasted.sample(places) == pytest.approx(surface.sample(places), abs=1e-9)
    assert pasted.volume(4).above == pytest.approx(surface.volume(4).above)


def test_a_hole_of_the_polygon_stays() -> None:
    rng = np.random.default_rng(7)
    one, two = random_surface(rng, 2000, (0, 0, 0)), random_surface(rng, 80, (0, 0, 20))
    shape = shapely.Polygon(star(rng, 8)).buffer(10)
    ring = shape.difference(shapely.Point(45, 45).buffer(8, quad_segs=2))
    pasted = liftmesh.paste(one, two, ring)
    assert pasted.area(planar=True) == pytest.approx(8100)
    assert pasted.sample([45, 45]) == pytest.approx(one.sample([45, 45]))
    assert pasted.sample([45, 55]) > 20


def test_where_the_first_surface_ends_the_other_goes_on() -> None:
    site = liftmesh.triangulate(SQUARE)
    pad = liftmesh.triangulate(SQUARE + np.array([4.5, 0, 1]))
    pasted = liftmesh.paste(site, pad, [[5, 0], [13, 0], [13, 9], [5, 9]])
    assert pasted.area(planar=True) == pytest.approx(13 * 9)
    assert pasted.sample([[12, 4], [1, 1]]) == pytest.approx([1, 0.2], abs=1)
    around = liftmesh.paste(site, liftmesh.triangulate(SQUARE * 3 - 9), shapely.box(-1, -1, 10, 10))
    assert around.area(planar=True) == pytest.approx(121)


def beside_a_side(seed: int) -> tuple[liftmesh.Surface, liftmesh.Surface, np.ndarray]:
    """Two surfaces, and a polygon along a side of a face of one, but for rounding."""
    rng = np.random.default_rng(seed)
    both = [random_surface(rng, 60, (0, 0, 0)) for _ in range(2)]
    solved = both[seed % 2].triangulation
    tail, head = solved.points[solved.edges[rng.integers(len(solved.edges))]]
    shares = np.sort(rng.random(2))[:, None]
    ends = tail + shares * (head - tail)
    across = (ends[1] - ends[0])[::-1] * (-1, 1) * rng.random()
    return *both, np.vstack([ends, (ends + across)[::-1]])


@pytest.mark.slow
def test_borders_along_sides_but_for_rounding() -> None:
    pasted, refused = 0, list[str]()
    for seed in range(60):
        one, two, ring = beside_a_side(seed)
        if not ((ring > 0) & (ring < 90)).all():
            continue
        try:
            found = liftmesh.paste(one, two, ring)
        except liftmesh.InputError as error:
            refused.append(str(error))
            continue
        assert found.verify().valid
        assert found.area(planar=True) == pytest.approx(8100)
        inside = ring.mean(axis=0)
        assert found.sample(inside) == pytest.approx(two.sample(inside))
        pasted += 1
    assert pasted > 30
    assert len(refused) < 3
    assert all("nearer to them than float64 can tell" in each for each in refused)


def test_values_stay_that_both_have() -> None:
    one = liftmesh.triangulate(meadow()).with_attributes(code=np.arange(len(meadow())))
    two = one.with_attributes(code=-np.arange(len(meadow())), other=np.arange(len(meadow())))
    pasted = liftmesh.paste(one, two, [[20, 20], [60, 25], [40, 70]])
    assert "other" not in pasted.attributes
    codes = pasted.attributes["code"]
    assert (codes[pasted.attributes["steiner"] == 0] != 0).sum() > 100
    assert (codes < 0).any()


def test_what_does_not_reach_far_enough_is_refused() -> None:
    site, pad = liftmesh.triangulate(SQUARE), liftmesh.triangulate(SQUARE / 9 + 3)
    with pytest.raises(liftmesh.InputError, match=r"has no face at \(.*on the border, where"):
        liftmesh.paste(site, pad, [[2, 2], [6, 2], [6, 6], [2, 6]])
    with pytest.raises(liftmesh.InputError, match="no face is left"):
        liftmesh.paste(site, pad, [[7, 7], [8, 7], [8, 8]])
    with pytest.raises(liftmesh.InputError, match="is no surface"):
        liftmesh.paste(site, SQUARE, [[7, 7], [8, 7], [8, 8]])
    with pytest.raises(liftmesh.InputError, match="is not valid"):
        liftmesh.paste(site, pad, [[0, 0], [4, 4], [4, 0], [0, 4]])
