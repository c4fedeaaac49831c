"""Clouds on which other programs stumble: grids, spheres, coplanar clusters, flat ones, copies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import liftmesh

Points = NDArray[np.float64]
RNG = np.random.default_rng(61)


def around(count: int) -> Points:
    """Points of a UV sphere: many on one circle, poles repeated, all on one sphere."""
    angle = np.arange(count) * 2 * np.pi / count
    height = np.linspace(-1, 1, 9)[:, None]
    radius = np.sqrt(1 - height**2)
    rings = np.stack([radius * np.cos(angle), radius * np.sin(angle), height + 0 * angle], axis=-1)
    return rings.reshape(-1, 3)


def clusters() -> Points:
    """Clusters on the planes of a box, some of their points equal."""
    places = RNG.random((240, 3)).round(1)
    places[np.arange(240), np.arange(240) % 3] = np.arange(240) % 2
    return places


CLOUDS: dict[str, Callable[[], Points]] = {
    "grid": lambda: np.indices((5, 4, 3)).reshape(3, -1).T * 0.1,
    "body-centred grid": lambda: np.vstack(
        [np.indices((3, 3, 3)).reshape(3, -1).T, np.indices((2, 2, 2)).reshape(3, -1).T + 0.5]
    ),
    "sphere": lambda: around(12),
    "cylinder": lambda: around(16) * (1, 1, 0) + np.repeat(np.arange(9), 16)[:, None] * (0, 0, 1),
    "voxels": lambda: (RNG.normal(size=(200, 3)) * 4).round() / 4,
    "clusters on planes": clusters,
    "two planes": lambda: np.column_stack([RNG.random((80, 2)), np.arange(80) % 2]),
    "far": lambda: np.indices((3, 3, 3)).reshape(3, -1).T * 0.1 + (512_000, 5_403_000, 300),
}


@pytest.mark.parametrize("name", CLOUDS)
def test_cells_are_solid_and_fill_the_hull(name: str) -> None:
    points = CLOUDS[name]()
    tetra = liftmesh.tetrahedralize(points)
    assert tetra.verify().canonical
    cells = tetra.points[tetra.simplices]
    assert (liftmesh.orient3d(*np.moveaxis(cells, 1, 0)) == 1).all()
    volumes = np.linalg.det(cells[:, 1:] - cells[:, :1])
    hull = tetra.points[tetra.convex_hull] - tetra.points.mean(axis=0)
    assert volumes.sum() == pytest.approx(np.linalg.det(hull).sum(), rel=1e-6)


@pytest.mark.parametrize("name", CLOUDS)
def test_hulls_are_closed_and_rows_are_the_callers(name: str) -> None:
    points = CLOUDS[name]()
    hull = liftmesh.convex_hull(points)
    a, b, c = np.moveaxis(hull.points[hull.faces], 1, 0)[:, :, None]
    assert (liftmesh.orient3d(a, b, c, points) <= 0).all()
    ends = np.concatenate([hull.faces[:, [k, (k + 1) % 3]] for k in range(3)])
    assert {*map(tuple, ends.tolist())} == {*map(tuple, ends[:, ::-1].tolist())}
    assert len(hull.vertices) - len(hull.faces) // 2 == 2
    np.testing.assert_array_equal(hull.to_cloud().points, points[hull.vertices])
    order = RNG.permutation(len(points))
    shuffled = liftmesh.convex_hull(points[order])
    assert corners(shuffled) == corners(hull)


def corners(hull: liftmesh.ConvexHull) -> set[frozenset[tuple[float, ...]]]:
    return {frozenset(map(tuple, face)) for face in hull.points[hull.faces].tolist()}


def test_copies_of_rows_are_named_and_the_first_stays() -> None:
    points = CLOUDS["grid"]()
    tetra = liftmesh.tetrahedralize(np.vstack([points, points[::-1]]))
    assert tetra.simplices.max() < len(points)
    expected = np.column_stack([np.arange(60, 120), np.arange(60)[::-1]])
    np.testing.assert_array_equal(tetra.duplicates, expected)


@pytest.mark.parametrize("plane", [(0, 0, 1), (1, 2, 3)])
def test_the_hull_of_a_flat_cloud_is_that_in_its_plane(plane: tuple[int, int, int]) -> None:
    grid = np.indices((4, 4)).reshape(2, -1).T
    u = np.array([plane[1], -plane[0], 0]) if plane[:2] != (0, 0) else np.array([1, 0, 0])
    points = grid[:, :1] * u + grid[:, 1:] * np.cross(plane, u)
    with pytest.raises(
        liftmesh.DegenerateInputError, match=r"whose boundary is the hull of a flat"
    ):
        liftmesh.convex_hull(points)
    flat = liftmesh.triangulate(points, plane="fit")
    assert {0, 3, 12, 15} <= {*flat.triangulation.convex_hull.tolist()}
    with pytest.raises(liftmesh.DegenerateInputError, match="lie on one line"):
        liftmesh.convex_hull(points[:4])
