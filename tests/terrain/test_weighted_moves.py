"""Surfaces by weights, radii or a metric whose vertices move, or whose values are replaced."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, InputError, RegularTriangulation, Surface

RNG = np.random.default_rng(8)
POINTS = np.c_[RNG.integers(0, 99, (200, 2)), RNG.random(200) * 9].astype(float)
POINTS[190:] = POINTS[:10]
SIZES = RNG.integers(0, 12, 200).astype(float)
SIZES[195:] = SIZES[5:10]
CLOUD = Cloud(POINTS, attributes={"size": SIZES, "class": np.arange(200)})
FORM = [[2.0, 0.5], [0.5, 1.25]]
KINDS = pytest.mark.parametrize("kind", ["weights", "radii"])
SHIFT = np.array([64.0, -32.0, 1.0])
ELSEWHERE = "have another triangulation than the surface"


def made(kind: str) -> Surface:
    return liftmesh.triangulate(CLOUD, **{kind: FORM if kind == "metric" else "size"})


@pytest.mark.parametrize("kind", ["weights", "radii", "metric"])
def test_heights_may_move_alone(kind: str) -> None:
    surface = made(kind)
    raised = surface.replace(vertices=surface.vertices * (1, 1, 10))
    assert raised.triangulation is surface.triangulation


@pytest.mark.parametrize("kind", ["weights", "radii", "metric"])
def test_positions_may_move_where_the_triangles_stay(kind: str) -> None:
    surface = made(kind)
    shifted = surface.replace(vertices=surface.vertices + SHIFT)
    options = {kind: FORM if kind == "metric" else SIZES}
    again = liftmesh.triangulate(POINTS + SHIFT, **options)
    assert {*map(frozenset, shifted.faces.tolist())} == {*map(frozenset, again.faces.tolist())}
    assert liftmesh.verify(shifted).canonical
    assert type(shifted.triangulation) is type(surface.triangulation)
    found, wanted = shifted.triangulation, again.triangulation
    np.testing.assert_array_equal(found.points, wanted.points)
    np.testing.assert_array_equal(found.convex_hull, wanted.convex_hull)
    np.testing.assert_array_equal(found.duplicates, wanted.duplicates)
    if isinstance(found, RegularTriangulation):
        assert len(found.hidden) > 5
        np.testing.assert_array_equal(found.hidden, wanted.hidden)
        np.testing.assert_array_equal(getattr(found, kind), SIZES)


def test_scaled_points_keep_their_triangles_in_a_metric_and_not_by_weights() -> None:
    stretched = made("metric").replace(vertices=POINTS * 2)
    np.testing.assert_array_equal(stretched.triangulation.metric, FORM)
    assert liftmesh.verify(stretched).canonical
    with pytest.raises(InputError, match=ELSEWHERE):
        made("metric").replace(vertices=POINTS * (1, 3, 1))
    for kind in ("weights", "radii"):
        with pytest.raises(InputError, match=ELSEWHERE):
            made(kind).replace(vertices=POINTS / 4)


def test_a_hidden_row_may_move_while_it_stays_hidden() -> None:
    points = np.array([(0, 0), (8, 0), (8, 8), (0, 8), (2, 1), (6, 1)], dtype=float)
    surface = liftmesh.triangulate(points, weights=[9, 9, 9, 9, -99, -99])
    moved = points.copy()
    for place in ((3, 2), (6, 1)):  # the latter is that of the other hidden row
        moved[4] = place
        kept = surface.replace(vertices=np.c_[moved, np.zeros(6)]).triangulation
        np.testing.assert_array_equal(kept.points[4], place)
        np.testing.assert_array_equal(kept.hidden, (4, 5))
    moved[4] = 9, 9
    with pytest.raises(InputError, match=ELSEWHERE):
        surface.replace(vertices=np.c_[moved, np.zeros(6)])


def test_a_row_that_equals_a_vertex_is_no_longer_hidden() -> None:
    points = np.array([(0, 0), (8, 0), (8, 8), (0, 8), (1, 1)], dtype=float)
    surface = liftmesh.triangulate(points, weights=[-60, 9, 9, 9, -60])
    assert surface.report.n_hidden == 1
    moved = points.copy()
    moved[4] = moved[0]
    with pytest.raises(InputError, match=ELSEWHERE):
        surface.replace(vertices=np.c_[moved, np.zeros(5)])


@KINDS
def test_the_values_that_made_the_faces_are_not_replaced(kind: str, tmp_path: Path) -> None:
    surface = made(kind)
    for other in (SIZES + 1, np.full(200, "heavy"), np.c_[SIZES, SIZES]):
        with pytest.raises(InputError, match=f"'size' are the {kind} by which the surface was"):
            surface.with_attributes(size=other)
    same = surface.with_attributes(size=SIZES.copy(), more=SIZES + 1)
    assert liftmesh.verify(same.save(tmp_path / "same.ply").path).canonical
    bare = surface.replace(attributes={})
    assert liftmesh.verify(bare).canonical
    path = bare.save(tmp_path / "bare.ply").path
    said = f"it was triangulated by the {kind} 'size', and does not hold them: give {kind}"
    with pytest.raises(InputError, match=said):
        liftmesh.verify(path)
    assert liftmesh.verify(path, **{kind: SIZES}).canonical


def test_an_option_of_verify_counts_before_what_a_mesh_says() -> None:
    for mesh in (made("weights"), made("weights").triangulation):
        assert liftmesh.verify(mesh).member == "weights"
        assert not liftmesh.verify(mesh, weights=SIZES * 4)
        assert not liftmesh.verify(mesh, metric=FORM)
        assert liftmesh.verify(mesh, furthest_site=True).member == "farthest"


def test_what_says_which_rows_are_hidden_stays() -> None:
    surface = made("weights")
    flags = surface.attributes["hidden"]
    surface.with_attributes(hidden=flags.copy())
    with pytest.raises(InputError, match="'hidden' say which rows the surface does not use"):
        surface.with_attributes(hidden=1 - flags)


def test_flags_of_another_origin_are_replaced_with_a_warning() -> None:
    points = np.c_[POINTS[:, :2], np.zeros(len(POINTS))]
    cloud = liftmesh.Cloud(points, attributes={"hidden": np.arange(len(points)) % 2})
    said = "the values 'hidden' of the points, 1 in 100 of 200 rows, are replaced"
    with pytest.warns(liftmesh.DataWarning, match=said) as caught:
        liftmesh.triangulate(cloud, weights=SIZES)
    assert caught[0].filename == __file__
