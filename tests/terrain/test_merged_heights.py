"""Heights at positions that several rows share: those of the surface, by every route."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.tri import CubicTriInterpolator, LinearTriInterpolator
from numpy.typing import NDArray
from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator

import liftmesh

DATA = Path(__file__).resolve().parents[2] / "data"
POLICIES = pytest.mark.parametrize("policy", ["first", "last", "lowest", "highest", "mean"])
CHOICES = {
    "first": lambda group: group[0],
    "last": lambda group: group[-1],
    "lowest": min,
    "highest": max,
    "mean": lambda group: sum(set(group)) / len(set(group)),
}


def walls() -> NDArray[np.float64]:
    """Draw a terrain in which half the positions have several heights, in random order."""
    rng = np.random.default_rng(163)
    ground = np.column_stack([rng.random((200, 2)) * 50, rng.random(200)])
    repeated = ground[rng.integers(0, 100, 300)] + np.outer(rng.integers(-3, 4, 300), (0, 0, 1))
    return rng.permutation(np.concatenate([ground, repeated]))


CLOUDS = pytest.mark.parametrize(
    "cloud", [walls(), liftmesh.read(DATA / "overhang.ply").points], ids=["walls", "overhang"]
)


def expected_heights(cloud: NDArray[np.float64], policy: str) -> dict[tuple[float, ...], float]:
    """Group rows by position, in plain Python."""
    groups: dict[tuple[float, ...], list[float]] = {}
    for x, y, z in cloud.tolist():
        groups.setdefault((x, y), []).append(z)
    return {position: CHOICES[policy](group) for position, group in groups.items()}


def by_weights(tri: liftmesh.Triangulation, values, asked):
    """Interpolate with the triangle found and its transform, as SciPy's documentation does."""
    found = tri.find_simplex(asked)
    offsets = asked - tri.transform[found, 2]
    first = np.einsum("mij,mj->mi", tri.transform[found, :2], offsets)
    weights = np.c_[first, 1 - first.sum(axis=1)]
    return (values[tri.simplices[found]] * weights).sum(axis=1)


def by_row(tri: liftmesh.Triangulation, values, asked):
    """Look up the triangle at each row, and in it the corner at the position of the row."""
    heights = {}
    for row, triangle in enumerate(tri.vertex_to_simplex.tolist()):
        for corner in tri.simplices[triangle].tolist():
            if (tri.points[corner] == tri.points[row]).all():
                heights[tuple(tri.points[row].tolist())] = values[corner]
    return np.array([heights[position] for position in map(tuple, asked.tolist())])


ROUTES = {
    "linear": lambda s, z, asked: LinearNDInterpolator(s.triangulation.to_scipy(), z)(asked),
    "cubic": lambda s, z, asked: CloughTocher2DInterpolator(s.triangulation.to_scipy(), z)(asked),
    "weights": lambda s, z, asked: by_weights(s.triangulation, z, asked),
    "rows": lambda s, z, asked: by_row(s.triangulation, z, asked),
    "matplotlib": lambda s, z, asked: LinearTriInterpolator(s.to_matplotlib(), z)(*asked.T),
    "matplotlib, cubic": lambda s, z, asked: CubicTriInterpolator(s.to_matplotlib(), z.copy())(
        *asked.T
    ),
}


@POLICIES
@CLOUDS
@pytest.mark.parametrize("route", ROUTES)
def test_every_route_gives_the_heights_of_the_surface(cloud, policy: str, route: str) -> None:
    surface = liftmesh.triangulate(cloud, on_duplicate=policy)
    expected = expected_heights(cloud, policy)
    asked = np.array([*expected])
    found = ROUTES[route](surface, surface.vertices[:, 2], asked)
    np.testing.assert_allclose(found, [*expected.values()], rtol=1e-9, atol=1e-9)


@POLICIES
@CLOUDS
def test_the_triangulation_has_the_rows_of_the_faces(cloud, policy: str) -> None:
    surface = liftmesh.triangulate(cloud, on_duplicate=policy)
    tri, report = surface.triangulation, surface.report
    np.testing.assert_array_equal(tri.simplices, surface.faces)
    np.testing.assert_array_equal(tri.duplicates[:, 0], report.left_out)
    np.testing.assert_array_equal(tri.duplicates[:, 1], report.representatives)
    assert np.isin(tri.convex_hull, surface.faces).all()
    assert (tri.vertex_to_simplex >= 0).all()
    starts, neighbors = tri.vertex_neighbor_vertices
    assert (np.diff(starts)[report.left_out] == 0).all()
    assert np.isin(neighbors, surface.faces).all()
    assert tri.verify().canonical


def test_rows_that_are_left_out_for_two_reasons() -> None:
    cloud = [[0, 0, 1], [np.nan, 0, 0], [4, 0, 2], [0, 4, 3], [4, 0, 9], [0, 4, 3]]
    surface = liftmesh.triangulate(cloud, on_duplicate="last", nonfinite="skip")
    assert surface.triangulation.duplicates.tolist() == [[2, 4], [3, 5]]
    assert surface.triangulation.skipped.tolist() == [1]
    assert surface.triangulation.vertex_to_simplex.tolist() == [0, -1, 0, 0, 0, 0]
    assert surface.report.left_out.tolist() == [1, 2, 3]
