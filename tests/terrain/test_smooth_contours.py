"""Smoothed contours: within the tolerance of height, without a crossing, less bent."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from commands import liftmesh as command
from hypothesis import given, settings, strategies as st
from surfaces import LATTICE, drawn, meadow

import liftmesh
from liftmesh import InputError

HILL = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]]


def waves(n: int = 3000, seed: int = 3) -> liftmesh.Surface:
    rng = np.random.default_rng(seed)
    x, y = rng.random((2, n)) * 100
    return liftmesh.triangulate(
        np.column_stack([x, y, 20 * np.sin(x / 9) * np.cos(y / 13) + rng.normal(size=n)])
    )


def heights_along(surface: liftmesh.Surface, lines: liftmesh.Contours) -> np.ndarray:
    """Return by how much heights along the lines differ from their levels, at most."""
    found = [np.zeros(1)]
    for line in lines:
        for share in np.linspace(0, 1, 5):
            places = line.points[:-1] + share * np.diff(line.points, axis=0)
            found.append(np.abs(surface.sample(places, extrapolate="hull") - line.level))
    return np.concatenate(found)


def bends(lines: liftmesh.Contours) -> float:
    """Return the mean change of direction at points, in degrees."""
    turns = []
    for line in lines:
        ways = np.diff(line.points, axis=0)
        angles = np.degrees(np.arctan2(*ways.T))
        turns.append(np.abs((np.diff(angles) + 180) % 360 - 180))
    return float(np.concatenate(turns).mean())


@pytest.mark.parametrize("tolerance", [0.01, 0.5, 1.24])
def test_lines_stay_within_the_tolerance_and_do_not_cross(tolerance: float) -> None:
    surface = waves()
    plain = surface.contours(interval=2.5)
    lines = surface.contours(interval=2.5, smooth=tolerance)
    assert np.array_equal(lines.starts, plain.starts)
    assert np.array_equal(lines.levels, plain.levels)
    assert not np.array_equal(lines.points, plain.points)
    assert heights_along(surface, lines).max() <= tolerance + 1e-9
    shapes = [shapely.LineString(line.points) for line in lines]
    one, other = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    assert np.array_equal(one, other)
    assert all(map(shapely.is_simple, shapes))


def test_lines_are_shorter_and_less_bent() -> None:
    surface = waves()
    plain = surface.contours(interval=5)
    for tolerance in (0.3, 1.0, 2.4):
        lines = surface.contours(interval=5, smooth=tolerance)
        assert lines.lengths.sum() < 0.92 * plain.lengths.sum()
        assert bends(lines) < 0.6 * bends(plain)


def test_straight_lines_stay() -> None:
    """Whatever the distances of their points."""
    x, y = np.random.default_rng(6).random((2, 2000))
    plane = liftmesh.triangulate(np.column_stack([x, y, 3 * x + y]))
    lines = plane.contours(interval=0.25, smooth=0.12)
    assert np.abs(lines.points - plane.contours(interval=0.25).points).max() < 1e-12


@settings(max_examples=200)
@given(LATTICE, st.lists(st.integers(-9, 9), min_size=1, max_size=4), st.randoms())
def test_flat_ground_and_corners_at_levels(points, levels, rng) -> None:
    surface = drawn(points)
    if surface is None:
        return
    lines = surface.contours(levels, smooth=0.25)
    plain = surface.contours(levels)
    assert len(lines) == len(plain)
    assert heights_along(surface, lines).max() <= 0.25 + 1e-9
    assert all((np.diff(line.points, axis=0) != 0).any(axis=1).all() for line in lines)
    assert all((line.points[0] == line.points[-1]).all() for line in lines if line.closed)
    ends = plain.starts[:-1][~plain.closed]
    assert np.array_equal(lines.points[ends], plain.points[ends])
    rng.shuffle(points)
    again = drawn(points)
    assert again is not None
    assert again.contours(levels, smooth=0.25).points.tobytes() == lines.points.tobytes()


def test_points_at_vertices_stay() -> None:
    ridge = liftmesh.triangulate([[0, 0, 0], [1, 0, 5], [2, 0, 0], [0, 9, 0], [1, 9, 5], [2, 9, 0]])
    assert np.array_equal(ridge.contours([5], smooth=1).points, ridge.contours([5]).points)


@pytest.mark.parametrize("scale", [2.0**-1060, 2.0**1000])
def test_coordinates_of_any_size(scale: float) -> None:
    points = meadow() * scale
    lines = liftmesh.triangulate(points).contours(np.array([3.0, 5]) * scale, smooth=scale / 2)
    plain = liftmesh.triangulate(points).contours(np.array([3.0, 5]) * scale)
    assert np.isfinite(lines.points).all()
    assert lines.points.shape == plain.points.shape


def test_values_in_place_of_heights_and_trimmed_surfaces() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=15)
    values = surface.vertices[:, 0] * 2
    lines = surface.contours([30, 90], values=values, smooth=20)
    x = lines.points[:, 0] * 2
    assert (np.abs(x - np.repeat(lines.levels, np.diff(lines.starts))) <= 20 + 1e-9).all()


@pytest.mark.parametrize(
    ("smooth", "said"),
    [
        (2.0, r"smooth=2\.0 is not below half of 4\.0, the least distance of levels"),
        (0, "smooth is 0: give a positive height"),
        (float("nan"), "smooth is nan: give a positive height"),
        ("a", "smooth is 'a': give a positive height"),
    ],
)
def test_tolerances_with_which_lines_could_cross_are_refused(smooth, said: str) -> None:
    with pytest.raises(InputError, match=said):
        liftmesh.triangulate(HILL).contours(interval=4, smooth=smooth)


def test_no_line_is_smoothed_to_none() -> None:
    assert len(liftmesh.triangulate(HILL).contours([99], smooth=1)) == 0


def test_the_command_smooths(tmp_path) -> None:
    liftmesh.write(tmp_path / "a.ply", waves())
    said = "contour", tmp_path / "a.ply", tmp_path / "a.geojson", "--interval", 2.5
    done = command(*map(str, said), "--smooth", "1")
    assert done.returncode == 0, done.stderr
    waves().contours(interval=2.5, smooth=1).save(tmp_path / "b.geojson")
    assert (tmp_path / "a.geojson").read_bytes() == (tmp_path / "b.geojson").read_bytes()
    for more, reason in {
        ("--smooth", "2"): "--smooth 2.0 is not below half of 2.5",
        ("--smooth", "1", "--filled"): "--smooth is of lines, and --filled is given",
    }.items():
        done = command(*map(str, said), *more, "--overwrite")
        assert done.returncode != 0
        assert reason in done.stderr
