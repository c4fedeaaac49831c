"""`simplify` of surfaces that follow lines: every edge stays, and no point is beyond the bound."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, reject, settings, strategies as st
from oracles.constrained import Constrained, judge
from surfaces import distances

import liftmesh
from liftmesh import InputError, Surface
from liftmesh._typing import Floats
from liftmesh.terrain.boundary import masked

SIZE = 12
WALL = np.array([[1, 2, 9], [11, 10, 9], [11, 1, 5]], dtype=float)
LAKE = np.array([[3, 6], [6, 7], [5, 10], [2, 9]], dtype=float)
COAST = np.array([[-3, 6], [6, -7], [15, 10], [8, 19]], dtype=float)
ISLAND = [LAKE, [[4, 7.5], [4.5, 8.5], [3.5, 8.5]]]


def hills(count: int = 140, seed: int = 8) -> Floats:
    rng = np.random.default_rng(seed)
    planar = rng.integers(0, 64 * SIZE, (count, 2)) / 64
    planar[:4] = [[0, 0], [SIZE, 0], [0, SIZE], [SIZE, SIZE]]
    rough = rng.integers(0, 16, count) / 16
    return np.column_stack([planar, 3 * np.sin(planar[:, 0] / 2) + planar[:, 1] / 4 + rough])


def exact_area(surface: Surface) -> Fraction:
    corners = surface.triangulation.points[surface.faces].tolist()
    rational = [[[*map(Fraction, each)] for each in triangle] for triangle in corners]
    return sum(
        ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) for (ax, ay), (bx, by), (cx, cy) in rational
    )


def lines_of(surface: Surface) -> set[frozenset[Any]]:
    """The edges that are constraints, by the places of their ends in space."""
    rows = getattr(surface.triangulation, "constraints", np.empty((0, 2), int)).tolist()
    places = [*map(tuple, surface.vertices.tolist())]
    return {frozenset((places[a], places[b])) for a, b in rows}


def check(whole: Surface, few: Surface, bound: float) -> None:
    """Assert what is promised of a simplified surface."""
    assert lines_of(whole) <= lines_of(few)
    assert few.verify().canonical
    tri = few.triangulation
    again = liftmesh.constrained_delaunay(tri.points, tri.constraints)
    assert {*map(frozenset, again.simplices.tolist())} == {*map(frozenset, tri.simplices.tolist())}
    assert exact_area(few) == exact_area(whole)
    used = np.unique(whole.faces)
    assert max(distances(few, whole.vertices[used])) <= bound
    summary = few.metadata["simplification"]
    assert summary["within"]
    assert summary["error"] <= bound
    assert summary["n_kept"] == len(few.vertices)
    assert few.report.n_triangles == len(few.faces)


@pytest.mark.parametrize(
    "lines",
    [
        {"breaklines": WALL},
        {"breaklines": WALL, "holes": [ISLAND], "crossing": "split"},
        {"soft_breaklines": [WALL[:, :2]], "boundary": COAST},
        {"boundary": [LAKE], "breaklines": WALL},
    ],
)
@pytest.mark.parametrize("prune", [False, True])
def test_lines_stay_and_carved_faces_stay_out(lines: Any, prune: bool) -> None:
    whole = liftmesh.triangulate(hills(), **lines)
    few = liftmesh.simplify(whole, max_error=0.75, prune=prune)
    check(whole, few, 0.75)
    assert len(few.vertices) < len(whole.vertices)
    assert (few.mask is None) == (whole.mask is None)
    counts, before = few.report.lines, whole.report.lines
    assert counts["edges"] == before["edges"] == len(lines_of(whole))
    assert counts["rows_at_crossings"] == before["rows_at_crossings"]
    assert 0 < counts["rows"] <= before["rows"]


def test_a_road_over_rough_ground() -> None:
    """The cross sections of the road are what its kerbs say; the ground is within the bound."""
    points = hills(600)
    across = points[:, 1] - points[:, 0] / 2 - 3
    points = points[(across < 0) | (across > 1)]
    kerbs = [[[0, 3, 2], [12, 9, 8]], [[0, 4, 2], [12, 10, 8]]]
    whole = liftmesh.triangulate(points, breaklines=kerbs)
    few = liftmesh.simplify(whole, max_error=0.5)
    check(whole, few, 0.5)
    assert len(few.vertices) < len(whole.vertices) / 2
    x = np.arange(1, 12) * 1.0
    for share in (0.25, 0.5, 0.75):
        np.testing.assert_array_equal(
            few.sample(np.column_stack([x, 3 + x / 2 + share])), 2 + x / 2
        )
    # Without the lines the road would be as rough as the ground.
    alone = liftmesh.simplify(whole.vertices, max_error=0.5)
    assert np.abs(alone.sample(np.column_stack([x, 3.5 + x / 2])) - 2 - x / 2).max() > 0.1


@pytest.mark.parametrize("limits", [{"max_edge": 2.0}, {"polygon": LAKE}])
def test_what_was_trimmed_keeps_its_rim(limits: Any) -> None:
    for whole in (liftmesh.triangulate(hills()), liftmesh.triangulate(hills(), breaklines=WALL)):
        trimmed = whole.trim(**limits)
        few = liftmesh.simplify(trimmed, max_error=0.75)
        check(trimmed, few, 0.75)
        assert len(few.faces) < len(trimmed.faces)


@pytest.mark.parametrize("step", [1.0, 30.1])
def test_lines_between_pixels_of_a_raster(step: float) -> None:
    """Corners at pixels leave a grid a grid, and others do not; heights meet the bound exactly."""
    rng = np.random.default_rng(3)
    x, y = (each.ravel() * step for each in np.meshgrid(np.arange(14.0), np.arange(11.0)))
    points = np.column_stack([x, y, np.rint(3 * np.sin(x / 3 / step)) + rng.integers(0, 2, 154)])
    hole = np.array([[2, 2], [4, 2], [4, 5], [2, 5]]) * step
    at_pixels = np.array([[0, 7, 1], [5, 7, 9], [12, 10, 9]]) * (step, step, 1)
    for shift in (0.0, step / 4):
        line = at_pixels + np.array([shift, 0, 0])
        whole = liftmesh.triangulate(points, breaklines=line, holes=hole)
        for prune in (False, True):
            check(whole, liftmesh.simplify(whole, max_error=1.0, prune=prune), 1.0)


@st.composite
def lattices_with_edges(draw: st.DrawFn) -> tuple[Floats, list[tuple[int, int]]]:
    """Few places of a lattice, edges between them that do not cross, and few heights."""
    place = st.tuples(st.integers(0, 7), st.integers(0, 7))
    places = draw(st.lists(place, min_size=5, max_size=16, unique=True))
    row = st.integers(0, len(places) - 1)
    edges: list[tuple[int, int]] = []
    for edge in draw(st.lists(st.tuples(row, row), max_size=8)):
        if edge[0] != edge[1] and not Constrained(places, [*edges, edge]).crossings:
            edges.append(edge)
    z = draw(st.lists(st.integers(0, 5), min_size=len(places), max_size=len(places)))
    return np.column_stack([np.array(places), np.array(z)]).astype(float), edges


def followed(points: Floats, edges: list[tuple[int, int]]) -> Surface:
    lines = [points[[*edge]] for edge in edges]
    return liftmesh.triangulate(points, breaklines=lines or None)


@pytest.mark.slow
@settings(max_examples=150, suppress_health_check=[HealthCheck.too_slow])
@given(lattices_with_edges(), st.sampled_from([0.0, 0.5, 1.0, 2.0]), st.booleans(), st.randoms())
def test_edges_between_points_of_a_lattice(given_: Any, bound: float, prune: bool, random) -> None:
    points, edges = given_
    try:
        whole = followed(points, edges)
    except liftmesh.DegenerateInputError:
        reject()
    few = liftmesh.simplify(whole, max_error=bound, prune=prune)
    assert lines_of(few) == lines_of(whole)
    used = np.unique(whole.faces)
    assert max(distances(few, whole.vertices[used])) <= bound
    planar = [(int(x), int(y)) for x, y in few.triangulation.points.tolist()]
    pieces = getattr(few.triangulation, "constraints", np.empty((0, 2), int)).tolist()
    triangles = [tuple(planar[row] for row in face) for face in few.faces.tolist()]
    judge(triangles, planar, [(planar[a], planar[b]) for a, b in pieces])
    order = random.sample(range(len(points)), len(points))
    turned = [(order.index(b), order.index(a)) for a, b in edges]
    again = liftmesh.simplify(followed(points[order], turned[::-1]), max_error=bound, prune=prune)
    assert {*map(tuple, again.vertices)} == {*map(tuple, few.vertices)}


@pytest.mark.slow
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(lattices_with_edges(), st.lists(st.booleans(), min_size=30, max_size=30), st.booleans())
def test_any_faces_may_be_left_out(given_: Any, flags: list[bool], prune: bool) -> None:
    try:
        surface = followed(*given_)
    except liftmesh.DegenerateInputError:
        reject()
    left_out = np.resize(flags, len(surface.faces))
    if left_out.all() or not left_out.any():
        reject()
    whole = masked(surface, left_out)
    check(whole, liftmesh.simplify(whole, max_error=1.0, prune=prune), 1.0)


@pytest.mark.parametrize("suffix", ["ply", "npz", "obj"])
def test_meshes_keep_the_edges_that_they_state(suffix: str, tmp_path: Path) -> None:
    surface = liftmesh.triangulate(hills(), breaklines=WALL, holes=LAKE)
    surface.save(tmp_path / f"tin.{suffix}")
    few = liftmesh.simplify(tmp_path / f"tin.{suffix}", max_error=0.75)
    check(surface, few, 0.75)
    expected = liftmesh.simplify(surface, max_error=0.75)
    assert {*map(tuple, few.vertices)} == {*map(tuple, expected.vertices)}
    few.save(tmp_path / f"few.{suffix}")
    again = liftmesh.as_surface(tmp_path / f"few.{suffix}")
    assert lines_of(again) == lines_of(few)
    assert len(again.faces) == len(few.faces)


def test_meshes_of_a_part(tmp_path: Path) -> None:
    trimmed = liftmesh.triangulate(hills()).trim(max_edge=2)
    trimmed.save(tmp_path / "part.ply")
    expected = liftmesh.simplify(trimmed, max_error=0.75)
    for part in (trimmed.to_cloud(), tmp_path / "part.ply"):
        few = liftmesh.simplify(part, max_error=0.75)
        np.testing.assert_array_equal(few.vertices, expected.vertices)
        assert {*map(frozenset, few.faces.tolist())} == {*map(frozenset, expected.faces.tolist())}


@pytest.mark.slow
def test_progress_goes_on_after_the_edges_are_in() -> None:
    points = np.random.default_rng(0).random((60000, 3))
    line = points[np.argsort(points[:6000, 0])]
    seen: list[float] = []
    surface = liftmesh.triangulate(points, breaklines=line)
    liftmesh.simplify(surface, max_error=0.4, progress=seen.append)
    assert seen == sorted(seen)
    assert any(0.1 < done < 0.7 for done in seen)


def test_the_most_points_count_what_stays() -> None:
    whole = liftmesh.triangulate(hills(), breaklines=WALL)
    with pytest.raises(InputError, match="is 6, and the hull and edges have 8 vertices, which"):
        liftmesh.simplify(whole, max_points=6)
    for most in (8, 30):
        few = liftmesh.simplify(whole, max_points=most)
        assert len(few.vertices) == most
        assert lines_of(few) == lines_of(whole)


def test_edges_without_a_surface_are_refused() -> None:
    points = hills()
    over_each_other = np.array([[0, 1, 2], [0, 1, 3]], dtype=np.int32)
    mesh = liftmesh.Cloud(points, faces=over_each_other, edges=np.array([[1, 2]], dtype=np.int32))
    with pytest.raises(InputError, match="overlap seen from above"):
        liftmesh.simplify(mesh, max_error=1)


def test_other_planes_values_and_threads() -> None:
    points = hills()[:, [0, 2, 1]]
    values = {"row": np.arange(len(points))}
    lines = {"breaklines": WALL[:, [0, 2, 1]], "plane": "xz"}
    whole = liftmesh.triangulate(points, attributes=values, **lines)
    one, two = (liftmesh.simplify(whole, max_error=0.75, threads=threads) for threads in (1, 2))
    np.testing.assert_array_equal(one.vertices, two.vertices)
    np.testing.assert_array_equal(one.faces, two.faces)
    is_own = one.attributes["breakline"] == 0
    np.testing.assert_array_equal(one.vertices[is_own], points[one.attributes["row"][is_own]])
    assert len(is_own) - is_own.sum() == len(WALL)
    assert lines_of(one) == lines_of(whole)
