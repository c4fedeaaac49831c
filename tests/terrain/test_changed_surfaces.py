"""Results stay as they are; copies of a surface with other values are right or refused."""

from __future__ import annotations

import copy
import dataclasses
import json
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import Cloud, InputError, NonFiniteError

ROWS = np.random.default_rng(6).random((60, 3)) * 100
COLORS = np.arange(180, dtype=np.uint8).reshape(60, 3)
WAYS = [
    lambda it: it,
    copy.copy,
    copy.deepcopy,
    lambda it: pickle.loads(pickle.dumps(it)),
    dataclasses.replace,
]


def full() -> Cloud:
    values = {"intensity": np.arange(60)}
    return Cloud(ROWS.copy(), colors=COLORS.copy(), normals=ROWS.copy(), attributes=values)


def arrays(result: Any) -> dict[str, np.ndarray]:
    found = {each.name: getattr(result, each.name) for each in dataclasses.fields(result)}
    found |= found.get("attributes") or {}
    return {name: value for name, value in found.items() if isinstance(value, np.ndarray)}


RESULTS: dict[str, Callable[[], Any]] = {
    "surface": lambda: liftmesh.triangulate(full()),
    "report": lambda: liftmesh.triangulate(np.vstack([ROWS, ROWS])).report,
    "lower hull": lambda: liftmesh.lower_hull(ROWS.copy()),
    "lifted": lambda: liftmesh.delaunay(ROWS).lifted(),
    "frame": lambda: liftmesh.triangulate(ROWS, plane=(1, 2, 3)).frame,
    "comparison": lambda: liftmesh.compare(ROWS),
    "cloud of an array": lambda: liftmesh.as_cloud(ROWS.copy()),
    "cloud of a surface": lambda: liftmesh.triangulate(full()).to_cloud(),
}


@pytest.mark.parametrize("what", RESULTS)
@pytest.mark.parametrize("again", WAYS, ids=["itself", "copy", "deepcopy", "pickle", "replace"])
def test_arrays_of_results_are_read_only(what: str, again: Callable[[Any], Any]) -> None:
    result = RESULTS[what]()
    if what.startswith("cloud") and again is not WAYS[0]:
        return  # clouds are anyone's: copies of them are writable
    found = arrays(again(result))
    assert found
    assert {name for name, values in found.items() if values.flags.writeable} == set()


COMPUTED = ["transform", "equations", "vertex_to_simplex", "min_bound", "max_bound", "edges"]


@pytest.mark.parametrize(
    "again", [lambda it: it, WAYS[2], WAYS[3]], ids=["itself", "copy", "pickle"]
)
def test_what_a_triangulation_computes_is_read_only(again: Callable[[Any], Any]) -> None:
    tri = liftmesh.delaunay(ROWS)
    for name in COMPUTED:
        assert not getattr(tri, name).flags.writeable
    assert not any(array.flags.writeable for array in tri.vertex_neighbor_vertices)
    assert not any(getattr(again(tri), name).flags.writeable for name in COMPUTED)


def test_writing_to_a_result_does_not_reach_the_caller() -> None:
    source = full()
    for result in (liftmesh.triangulate(source), liftmesh.as_cloud(source.points)):
        for values in arrays(result).values():
            with pytest.raises(ValueError, match="read-only"):
                values[...] *= 10
    assert np.array_equal(source.points, ROWS)
    source.points[0] = 0  # it stays the caller's
    assert source.colors is not None
    source.colors[0] = 0


def test_columns_of_the_callers_rows_are_read_only() -> None:
    rows = ROWS.copy()
    frame = liftmesh.triangulate(rows).frame
    for columns in liftmesh.project(rows), frame.planar(rows), frame.heights(rows):
        assert np.shares_memory(columns, rows)
        with pytest.raises(ValueError, match="read-only"):
            columns[...] = 0
    assert rows.flags.writeable


def test_results_become_dictionaries() -> None:
    report = liftmesh.triangulate(ROWS).report
    values = dataclasses.asdict(report)
    assert values["n_rows"] == 60
    assert json.loads(json.dumps(values["seconds"])).keys() == report.seconds.keys()
    assert dataclasses.asdict(full())["attributes"]["intensity"].tolist() == list(range(60))


@pytest.mark.parametrize(
    "change",
    [
        lambda it: it.update(a=1),
        lambda it: it.pop("read"),
        lambda it: it.clear(),
        lambda it: it.setdefault("a", 1),
        lambda it: it.__ior__({"a": 1}),
        lambda it: it.__delitem__("read"),
        lambda it: it.popitem(),
    ],
)
def test_mappings_of_results_are_read_only(change: Callable[[Any], object]) -> None:
    report = liftmesh.triangulate(ROWS).report
    with pytest.raises(TypeError, match="read-only"):
        change(report.seconds)
    assert pickle.loads(pickle.dumps(report.seconds)) == report.seconds


def test_heights_are_scaled_in_a_copy() -> None:
    surface = liftmesh.triangulate(full())
    steep = surface.replace(vertices=surface.vertices * (1, 1, 10))
    assert np.array_equal(steep.vertices[:, 2], ROWS[:, 2] * 10)
    assert np.array_equal(surface.vertices, ROWS)
    assert steep.triangulation is surface.triangulation
    assert steep.faces is surface.faces
    assert dict(steep.attributes).keys() == {"intensity"}


def test_shifted_vertices_have_a_triangulation_of_their_own() -> None:
    surface = liftmesh.triangulate(np.vstack([ROWS, ROWS[:3]]))
    moved = surface.replace(vertices=surface.vertices - (16, 32, 0))
    fresh = liftmesh.triangulate(moved.vertices)
    assert moved.triangulation.verify().canonical
    assert np.array_equal(moved.triangulation.points, moved.vertices[:, :2])
    assert np.array_equal(moved.triangulation.convex_hull, fresh.triangulation.convex_hull)
    assert np.array_equal(moved.to_matplotlib().x, moved.vertices[:, 0])
    assert moved.triangulation.find_simplex(moved.vertices[:, :2]).min() >= 0


def test_a_quarter_turn_keeps_the_triangles_and_begins_the_hull_elsewhere() -> None:
    surface = liftmesh.triangulate(ROWS)
    x, y, z = ROWS.T
    turned = surface.replace(vertices=np.column_stack([-y, x, z]))
    fresh = liftmesh.delaunay(turned.vertices)
    assert np.array_equal(turned.triangulation.convex_hull, fresh.convex_hull)


@pytest.mark.parametrize(
    "move",
    [
        (lambda rows: rows[np.r_[59:-1:-1, 59:56:-1]], "overlap seen from"),
        (
            lambda rows: np.where(np.arange(63)[:, None] == 61, rows + 1, rows),
            "another triangulation than the surface: triangulate",
        ),
        (lambda rows: rows * (0, 1, 1), "face 0, .* has no area seen from above.*triangulate"),
    ],
    ids=["reversed", "a duplicate apart", "flattened"],
)
def test_vertices_whose_faces_overlap_are_refused(move) -> None:
    moved, said = move
    surface = liftmesh.triangulate(np.vstack([ROWS, ROWS[:3]]))
    with pytest.raises(InputError, match=said):
        surface.replace(vertices=moved(surface.vertices))


@pytest.mark.parametrize("scale", [(1, 5, 1), (-1, 1, 2), (-3, 8, 1)])
@pytest.mark.parametrize("longest", [None, 40])
def test_faces_that_are_no_longer_delaunay_stay(scale, longest: float | None) -> None:
    surface = liftmesh.triangulate(np.vstack([ROWS, ROWS[:3]]))
    surface = surface if longest is None else surface.trim(max_edge=longest)
    places = surface.vertices[surface.faces].mean(axis=1)[:, :2]
    moved = surface.replace(vertices=surface.vertices * scale)
    named = [set(map(frozenset, each.faces.tolist())) for each in (surface, moved)]
    assert named[0] == named[1]
    assert moved.verify()
    assert moved.report.n_duplicates == 3
    given = surface.sample(places) * scale[2]
    np.testing.assert_allclose(moved.sample(places * scale[:2]), given)
    assert moved.area(planar=True) == pytest.approx(
        surface.area(planar=True) * abs(scale[0] * scale[1])
    )
    if scale[1] > 1:
        with pytest.raises(InputError, match="'sibson' needs a Delaunay triangulation"):
            moved.sample(places, "sibson")
    back = moved.replace(vertices=surface.vertices)
    assert set(map(frozenset, back.faces.tolist())) == named[0]


def accounted(surface: liftmesh.Surface) -> liftmesh.Report:
    """Every row is counted once, and is a corner, a duplicate or skipped."""
    report, solved = surface.report, surface.triangulation
    parts = ("used", "duplicates", "overhangs", "skipped", "hidden", "unused")
    assert sum(getattr(report, f"n_{part}") for part in parts) == report.n_rows
    rows = [surface.faces.ravel(), solved.duplicates[:, 0], solved.skipped]
    assert np.unique(np.concatenate(rows)).tolist() == [*range(report.n_rows)]
    return report


def test_duplicates_of_vertices_that_were_trimmed_off_are_counted_once() -> None:
    surface = liftmesh.triangulate(np.vstack([ROWS, ROWS])).trim(max_edge=20)
    used = len(np.unique(surface.faces))
    assert used < 60
    report = accounted(surface.replace(vertices=surface.vertices * [1, 5, 1]))
    assert (report.n_used, report.n_duplicates, report.n_unused) == (used, 60, 60 - used)
    assert len(report.left_out) == 120 - used


def test_vertices_that_meet_are_merged() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    other = square + np.array([5, 5, 0])
    rows = np.vstack([square, other, square[:1], other[:1]])
    surface = liftmesh.triangulate(rows).trim(max_edge=2)
    vertices = surface.vertices - [[4, 4, 0]] * (np.arange(10) > 3)[:, None]
    vertices[8] = 0
    moved = surface.replace(vertices=vertices)  # rows 4 and 9 are where row 3 is
    report = accounted(moved)
    assert moved.triangulation.duplicates.tolist() == [[4, 3], [8, 0], [9, 3]]
    assert (report.n_used, report.n_duplicates, report.n_unused) == (7, 3, 0)
    assert report.representatives.tolist() == [3, 0, 3]
    assert moved.triangulation.verify()


def test_a_duplicate_that_moves_to_another_vertex_is_refused() -> None:
    surface = liftmesh.triangulate(np.vstack([ROWS, ROWS[:1]]))
    rows = surface.vertices + np.array([16, 0, 0])
    rows[60] = rows[7]
    with pytest.raises(InputError, match="another triangulation"):
        surface.replace(vertices=rows)


def test_skipped_rows_stay_skipped() -> None:
    rows = np.vstack([ROWS, [[1, np.nan, 2], [1, 2, np.inf]]])
    surface = liftmesh.triangulate(rows, nonfinite="skip")
    moved = surface.replace(vertices=surface.vertices + np.array([16, 0, 0]))
    assert moved.triangulation.skipped.tolist() == [60, 61]
    with pytest.raises(NonFiniteError, match="row 5 is not finite"):
        surface.replace(vertices=np.where(np.arange(62)[:, None] == 5, np.nan, surface.vertices))


def test_a_surface_over_another_plane_moves_too() -> None:
    surface = liftmesh.triangulate(ROWS, plane=(0, -1, 0))
    moved = surface.replace(vertices=ROWS * (1, 3, 1))
    assert moved.triangulation is surface.triangulation


def test_values_are_replaced_and_removed() -> None:
    surface = liftmesh.triangulate(full())
    changed = surface.replace(
        colors=None, normals=ROWS.tolist(), crs="EPSG:25832", metadata={"a": 1}
    )
    assert changed.colors is None
    assert changed.normals is not None
    assert changed.normals.tolist() == ROWS.tolist()
    assert (changed.crs, changed.metadata) == ("EPSG:25832", {"a": 1})
    assert surface.colors is not None
    assert changed.vertices is surface.vertices


def test_named_values_are_added() -> None:
    surface = liftmesh.triangulate(full())
    more = surface.with_attributes({"a b": range(60)}, intensity=np.ones(60), slope=[0.5] * 60)
    assert [*more.attributes] == ["intensity", "a b", "slope"]
    assert more.attributes["intensity"].tolist() == [1] * 60
    assert [*surface.attributes] == ["intensity"]
    assert not more.attributes["slope"].flags.writeable
    assert [*surface.with_attributes().attributes] == ["intensity"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"colors": [[1, 2, 3]]}, "colors has 1 row for 60 points"),
        ({"attributes": {"a": 5}}, "attribute 'a' is 5: give an array with one row per point"),
        ({"attributes": [1]}, "attributes are a list: give a dict"),
        ({"attributes": {"a": [[1], [2, 3]]}}, "attribute 'a' cannot be converted to an array"),
        ({"vertices": ROWS[:, :2]}, r"vertices need the shape \(60, 3\), not \(60, 2\)"),
        ({"vertices": ROWS[:5]}, r"vertices need the shape \(60, 3\)"),
        ({"crs": 1.5}, "crs is 1.5"),
    ],
)
def test_what_does_not_fit_is_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        liftmesh.triangulate(full()).replace(**changes)
    with pytest.raises(InputError, match="attributes are a list"):
        liftmesh.triangulate(full()).with_attributes([1])  # type: ignore[arg-type]


@given(st.integers(0, 2**32), st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
@settings(max_examples=40, deadline=None)
def test_any_shift_is_right_or_refused(seed: int, east: float, north: float) -> None:
    rows = np.random.default_rng(seed).integers(0, 6, (20, 3)) * 0.1
    try:
        surface = liftmesh.triangulate(rows)
    except liftmesh.DegenerateInputError:
        return
    shifted = rows + np.array([east, north, 0])
    try:
        moved = surface.replace(vertices=shifted)
    except InputError:
        return
    assert np.array_equal(moved.triangulation.duplicates, liftmesh.delaunay(shifted).duplicates)
    assert moved.triangulation.verify().canonical
