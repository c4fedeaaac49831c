"""`simplify`: few triangles, none of the points further away than asked, whatever the order."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, reject, settings, strategies as st
from surfaces import distances

import liftmesh
from liftmesh._typing import Floats

Generator = np.random.Generator


def grid(rng: Generator) -> Floats:
    x, y = (each.ravel() for each in np.meshgrid(np.arange(10.0), np.arange(8.0)))
    return np.column_stack([x, y, np.rint(3 * np.sin(x / 3) + y / 4 + rng.integers(0, 2, len(x)))])


def scattered(rng: Generator) -> Floats:
    plane = rng.random((90, 2)) * (30, 1e-3) + (450000, 5200000)
    return np.column_stack([plane, np.sin(plane[:, 0]) + rng.random(90) / 4])


def far_scales(rng: Generator) -> Floats:
    return rng.random((45, 3)) * np.ldexp(1.0, rng.integers(-900, 900, (45, 3)))


def tiny(rng: Generator) -> Floats:
    return rng.integers(0, 12, (80, 3)) * 5e-324


@pytest.mark.parametrize(
    ("made", "bound"),
    [(grid, 1), (grid, 2), (grid, 0), (scattered, 0.3), (far_scales, 1e200), (tiny, 5e-324)],
)
@pytest.mark.parametrize("prune", [False, True])
def test_no_point_is_beyond_the_bound(made: object, bound: float, prune: bool) -> None:
    points = made(np.random.default_rng(4))  # type: ignore[operator]
    found = liftmesh.simplify(points, max_error=bound, prune=prune, on_duplicate="highest")
    used = np.setdiff1d(
        np.arange(len(points)), liftmesh.triangulate(points, on_duplicate="highest").report.left_out
    )
    worst = max(distances(found, points[used]))
    summary = found.metadata["simplification"]
    assert worst <= Fraction(bound)
    assert worst <= summary["error"]
    assert summary["within"]
    assert (summary["n_positions"], summary["n_kept"]) == (len(used), len(found.vertices))
    assert found.triangulation.verify().canonical


def test_the_order_of_rows_does_not_count() -> None:
    rng = np.random.default_rng(8)
    points = np.concatenate([grid(rng), grid(rng) + np.array([0, 8, 0])])
    ways = [points, points[rng.permutation(len(points))], points[::-1]]
    found = [liftmesh.simplify(each, max_error=1, on_duplicate="lowest") for each in ways]
    sets = [{*map(tuple, each.vertices.tolist())} for each in found]
    assert sets[0] == sets[1] == sets[2]
    assert len(sets[0]) < len(points) / 2


def test_fewer_points_and_a_surface() -> None:
    points = grid(np.random.default_rng(1))
    surface = liftmesh.triangulate(points, attributes={"row": np.arange(len(points))})
    found = liftmesh.simplify(surface, max_points=20)
    assert len(found.vertices) == 20
    np.testing.assert_array_equal(points[found.attributes["row"]], found.vertices)
    summary = found.metadata["simplification"]
    assert not summary["within"]
    assert summary["max_error"] is None
    assert max(distances(found, points)) == pytest.approx(summary["error"])
    both = liftmesh.simplify(surface, max_points=20, max_error=5)
    assert both.metadata["simplification"]["within"]
    assert len(both.vertices) < 20


def lattice(columns: Floats, rows: Floats, z: Floats) -> Floats:
    x, y = (each.ravel() for each in np.meshgrid(columns, rows))
    return np.column_stack([x, y, z])


@pytest.mark.parametrize(
    ("start", "step"),
    [(0.0, 1.0), (5200000.25, 30.1), (45.3, 1 / 3600), (0.0, 5e-324), (1e3, -1e-9)],
)
@pytest.mark.parametrize("missing", [0, 40, 150])
@pytest.mark.parametrize("narrow", [False, True])
def test_grids_exact_or_rounded_full_or_not(
    start: float, step: float, missing: int, narrow: bool
) -> None:
    rng = np.random.default_rng(12)
    size = (12, 20) if not narrow else (3, 80)
    columns, rows = (start + step * np.arange(count) for count in size)
    z = np.rint(4 * np.sin(np.arange(240) / 9)) + rng.integers(0, 2, 240)
    points = np.delete(lattice(columns, rows, z), rng.permutation(240)[:missing], axis=0)
    for prune in (False, True):
        found = liftmesh.simplify(points, max_error=1.5, prune=prune)
        assert max(distances(found, points[::30])) <= 1.5
        assert found.metadata["simplification"]["within"]  # of all, by the check of simplify
        again = liftmesh.simplify(rng.permutation(points), max_error=1.5, prune=prune)
        assert {*map(tuple, again.vertices)} == {*map(tuple, found.vertices)}
        assert len(found.vertices) < 0.9 * len(points)


def test_a_grid_of_uneven_lines_and_its_even_twin() -> None:
    rng = np.random.default_rng(13)
    z = np.rint(5 * np.sin(np.arange(400) / 17)) + rng.integers(0, 2, 400)
    uneven = np.sort(rng.random(20)) * 20
    for columns in (uneven, np.arange(20.0), np.arange(20.0) + 1e-5 * rng.random(20)):
        found = liftmesh.simplify(lattice(columns, np.arange(20.0), z), max_error=2)
        assert found.metadata["simplification"]["error"] <= 2
        assert len(found.vertices) < 200


def test_the_last_pass_exchanges_vertices() -> None:
    """A cone of many more vertices than a pass needs that only removes."""
    x, y = (each.ravel() for each in np.meshgrid(np.arange(60.0), np.arange(60.0)))
    points = np.column_stack([x, y, np.hypot(x - 31, y - 27)])
    whole, pruned = (liftmesh.simplify(points, max_error=0.2, prune=p) for p in (False, True))
    assert len(pruned.vertices) < 0.7 * len(whole.vertices)
    assert pruned.metadata["simplification"]["error"] <= 0.2
    cloud = rotated(points)
    whole, pruned = (liftmesh.simplify(cloud, max_error=0.2, prune=p) for p in (False, True))
    assert len(pruned.vertices) < 0.65 * len(whole.vertices)
    assert pruned.metadata["simplification"]["error"] <= 0.2


def rotated(points: Floats) -> Floats:
    cos, sin = np.cos(0.4), np.sin(0.4)
    x, y, z = points.T
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, z])


def test_vertices_that_are_not_needed_go_again() -> None:
    points = grid(np.random.default_rng(2))
    whole, pruned = (liftmesh.simplify(points, max_error=1, prune=p) for p in (False, True))
    assert len(pruned.faces) < len(whole.faces)


def test_samples_on_edges_may_change_sides() -> None:
    """The last pass puts vertices back: a sample on an edge may come to the other side of it."""
    rows = [[2, 6, 4], [3, 19, 1], [10, 10, 1], [9, 12, 4], [7, 16, 2], [11, 13, 1], [14, 12, 2]]
    points = np.array(rows, float)
    assert max(distances(liftmesh.simplify(points, max_error=1.0), points)) <= 1
    for seed in range(60):
        rng = np.random.default_rng(seed)
        planar = np.unique(rng.integers(0, 9, (14, 2)), axis=0) @ [[2.0, 1.0], [-1.0, 2.0]]
        points = np.column_stack([planar, rng.integers(0, 5, len(planar))])
        surface = liftmesh.simplify(points, max_error=1.0)
        assert max(distances(surface, points)) <= 1


@st.composite
def turned_lattices(draw: st.DrawFn) -> Floats:
    """Points of a small lattice turned by the ratio 1 : 2, middles of two of them, few heights."""
    lattice = st.tuples(st.integers(0, 8), st.integers(0, 8))
    planar = np.array(draw(st.lists(lattice, min_size=4, max_size=12, unique=True)))
    planar = planar @ [[2.0, 1.0], [-1.0, 2.0]]
    row = st.integers(0, len(planar) - 1)
    ends = np.array(draw(st.lists(st.tuples(row, row), max_size=16)), int).reshape(-1, 2)
    planar = np.unique(np.concatenate([planar, planar[ends].mean(axis=1)]), axis=0)
    few = st.integers(0, draw(st.integers(1, 5)))
    z = draw(st.lists(few, min_size=len(planar), max_size=len(planar)))
    return np.column_stack([planar, np.array(z, float)])


@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(turned_lattices(), st.sampled_from([0.0, 0.5, 1.0, 2.0]), st.booleans(), st.randoms())
def test_samples_in_the_middle_of_edges(
    points: Floats, bound: float, prune: bool, random: Random
) -> None:
    try:
        liftmesh.delaunay(points[:, :2])
    except liftmesh.DegenerateInputError:
        reject()
    found = liftmesh.simplify(points, max_error=bound, prune=prune)
    assert max(distances(found, points)) <= bound
    order = random.sample(range(len(points)), len(points))
    again = liftmesh.simplify(points[order], max_error=bound, prune=prune)
    assert {*map(tuple, again.vertices)} == {*map(tuple, found.vertices)}


@pytest.mark.slow
def test_the_largest_distance_is_told_where_faces_are_slivers() -> None:
    x, y = (each.ravel() for each in np.meshgrid(np.arange(12.0), np.arange(12.0)))
    rng = np.random.default_rng(3)
    for angle in rng.uniform(0, 6, 3):
        c, s = np.cos(angle), np.sin(angle)
        points = np.column_stack([c * x - s * y, s * x + c * y, rng.random(len(x))])
        surface = liftmesh.simplify(points, max_error=0.45, prune=False)
        largest = max(distances(surface, points))
        error = surface.metadata["simplification"]["error"]
        assert largest <= error <= largest * (1 + Fraction(1, 10**9))


def test_merged_rows_are_told_apart() -> None:
    points = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [0, 0, 7], [2, 2, 0.0]])
    summary = liftmesh.simplify(points, max_error=0).metadata["simplification"]
    assert (summary["merged"], summary["error"], summary["n_kept"]) == (7.0, 0.0, 4)
    up = liftmesh.simplify(points, max_error=0, on_duplicate="mean")
    assert up.vertices[:, 2].max() == 3.5
    assert up.metadata["simplification"]["merged"] == 3.5


def test_what_is_asked_wrongly() -> None:
    points = grid(np.random.default_rng(3))
    for options in ({}, {"max_error": -1}, {"max_error": np.nan}, {"max_error": "2"}):
        with pytest.raises(liftmesh.InputError, match="max_error"):
            liftmesh.simplify(points, **options)  # type: ignore[arg-type]
    ring = np.column_stack([np.cos(np.arange(40)), np.sin(np.arange(40)), np.zeros(40)])
    with pytest.raises(liftmesh.InputError, match="the hull has 40 corners"):
        liftmesh.simplify(ring, max_points=9)
    weighted = liftmesh.triangulate(points, weights=np.ones(len(points)))
    with pytest.raises(liftmesh.InputError, match="weights"):
        liftmesh.simplify(weighted, max_error=1)


def test_faces_that_are_whole_or_of_another_kind_do_not_count() -> None:
    points = grid(np.random.default_rng(3))
    expected = liftmesh.simplify(points, max_error=1)
    whole = liftmesh.triangulate(points)
    others = liftmesh.Cloud(points, faces=np.array([[0, 1, 79], [0, 79, 70]], np.int32))
    for mesh in (whole, whole.to_cloud(), others):
        np.testing.assert_array_equal(liftmesh.simplify(mesh, max_error=1).faces, expected.faces)


@pytest.mark.slow
def test_progress_rises_and_can_end_the_run() -> None:
    points = np.random.default_rng(0).random((60000, 3))
    seen: list[float] = []
    liftmesh.simplify(points, max_error=0.4, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1

    def stop(done: float) -> None:
        if done > 0.15:
            raise TimeoutError

    with pytest.raises(TimeoutError):
        liftmesh.simplify(points, max_error=0, progress=stop)


@pytest.mark.parametrize("exponent", [-822, -400, 400, 822])
def test_products_of_steps_may_leave_the_doubles(exponent: int) -> None:
    rng = np.random.default_rng(0)
    places = np.unique(rng.integers(0, 16, (60, 2)), axis=0)
    heights = rng.integers(-100, 100, len(places))
    points = np.column_stack([np.ldexp(places.astype(float), exponent), heights])
    summary = liftmesh.simplify(points, max_error=0).metadata["simplification"]
    expected = liftmesh.simplify(np.column_stack([places, heights]), max_error=0)
    assert summary["n_kept"] == expected.metadata["simplification"]["n_kept"]


def test_slopes_may_be_less_than_any_double() -> None:
    huge = np.array([[0, 0, 0], [2.0**537, 0, 3.4e-237], [0, 2.0**433, 0], [0, 7.7e14, 8.3e-235]])
    inner = np.array([[1e-251, 1.8e82, 2.2e-289]])
    summary = liftmesh.simplify(np.concatenate([huge, inner]), max_error=2.3e-287)
    assert summary.metadata["simplification"]["error"] <= 2.3e-287


def test_threads_and_options_of_files(tmp_path: Path) -> None:
    points = np.random.default_rng(2).random((500, 3))
    alone, shared = (
        liftmesh.simplify(points, max_error=0.4, threads=threads) for threads in (1, 3)
    )
    np.testing.assert_array_equal(alone.vertices, shared.vertices)
    np.testing.assert_array_equal(alone.faces, shared.faces)
    np.savetxt(tmp_path / "a.txt", points[:, ::-1], "%.17g", ";", header="z;y;x", comments="")
    box = (0.2, 0.2, 0.9, 0.9)
    few = liftmesh.simplify(tmp_path / "a.txt", max_error=0.4, delimiter=";", bounds=box)
    inside = (np.abs(points[:, :2] - 0.55) <= 0.35).all(axis=1)
    expected = liftmesh.simplify(points[inside], max_error=0.4)
    np.testing.assert_array_equal(few.vertices, expected.vertices)
    with pytest.raises(liftmesh.InputError, match="bounds= is for files"):
        liftmesh.simplify(alone, max_error=1, bounds=box)
