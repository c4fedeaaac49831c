"""refine of surfaces: heights of the faces before, and how far the surface moves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import Surface, refine

Array = np.ndarray[Any, Any]


def hills(n: int = 200) -> Surface:
    rng = np.random.default_rng(4)
    x, y = rng.random((2, n))
    values = {"id": np.arange(n)}
    points = np.stack([x, y, np.sin(5 * x) + y**2], axis=1)
    return liftmesh.triangulate(liftmesh.Cloud(points, attributes=values))


def middles(surface: Surface) -> Array:
    return surface.triangulation.points[surface.faces].mean(axis=1)


def test_rows_have_the_heights_before() -> None:
    before = hills()
    result = refine(before, max_area=1e-3)
    after = result.surface
    assert after.verify().valid
    assert result.verify().canonical
    np.testing.assert_array_equal(after.vertices[:200], before.vertices)
    assert after.attributes["steiner"].tolist() == [0] * 200 + [1] * len(result.steiner)
    assert after.attributes["id"].max() == 199
    assert (after.report.n_rows, after.report.n_triangles) == (
        len(after.vertices),
        len(after.faces),
    )
    places, heights = after.vertices[200:, :2], after.vertices[200:, 2]
    np.testing.assert_allclose(heights, sample(before, places), atol=1e-12)
    assert result.max_deviation > 0
    for some in (middles(before), middles(after), np.random.default_rng(1).random((5000, 2))):
        differences = np.abs(after.sample(some) - before.sample(some))
        assert np.nanmax(differences) <= result.max_deviation * (1 + 1e-9)


def sample(surface: Surface, places: Array) -> Array:
    """Heights, beside the faces those of places a little inside."""
    middle = surface.vertices[:, :2].mean(axis=0)
    near = surface.sample(places + (middle - places) * 1e-13)
    return np.where(np.isnan(near), surface.sample(places), near)


def test_faces_that_are_left_out_stay_out() -> None:
    before = hills().trim(max_edge=0.15, boundary_only=True)
    result = refine(before, size=0.1)
    after = result.surface
    assert 0 < len(before.faces) < before.triangulation.nsimplex
    assert after.verify().valid
    assert np.isnan(after.sample([0.0, 0.0])) == np.isnan(before.sample([0.0, 0.0]))
    assert area(after) == pytest.approx(area(before))


def area(surface: Surface) -> float:
    a, b, c = surface.triangulation.points[surface.faces].transpose(1, 0, 2)
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    return float((ux * vy - uy * vx).sum()) / 2


def test_breaklines_stay() -> None:
    banks = [[0, 0, 5], [8, 0, 5], [0, 8, 5], [8, 8, 5]]
    ditch, pond = [[0, 4, 1], [8, 4, 1]], [[1, 5], [3, 5], [3, 7], [1, 7]]
    before = liftmesh.triangulate(banks, breaklines=ditch, holes=pond)
    result = refine(before, max_area=0.2)
    after = result.surface
    np.testing.assert_allclose(after.sample([[4, 4], [4, 6], [2, 6]]), [1, 3, np.nan])
    assert result.max_deviation < 1e-12
    assert liftmesh.verify(after).valid
    assert not after.attributes["breakline"][len(before.vertices) :].all()
    numbered = before.replace(metadata={"markers": [3] * len(before.to_cloud().edges), "by": "me"})
    assert refine(numbered).surface.metadata == {"by": "me"}


def test_other_planes_and_what_is_refused() -> None:
    points = hills(30).vertices
    wall = liftmesh.triangulate(points[:, [0, 2, 1]], plane="xz")
    assert refine(wall).surface.verify().valid
    told: list[float] = []
    with pytest.raises(liftmesh.InputError, match="new rows need a plane whose coordinates"):
        refine(liftmesh.triangulate(points, plane="fit"), size=0.01, progress=told.append)
    with pytest.raises(liftmesh.InputError, match="a triangulation with weights"):
        refine(liftmesh.triangulate(points, weights=np.zeros(30)))
    named = hills().with_attributes(steiner=np.arange(200.0))
    with pytest.raises(liftmesh.InputError, match="values named 'steiner'"):
        refine(named, progress=told.append)
    assert not told  # the work has not begun
    with pytest.raises(liftmesh.InputError, match="threads is 0"):
        refine(hills(), threads=0)


def test_progress_ends_with_the_heights() -> None:
    told: list[float] = []
    refine(hills(), max_area=1e-4, progress=told.append)
    assert told == sorted(told)
    assert (told[-2] <= 0.9, told.count(1.0), told[-1]) == (True, 1, 1.0)
