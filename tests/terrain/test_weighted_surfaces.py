"""Surfaces of weighted points and in a metric: what is used, what is hidden, and what files say."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import Cloud, InputError, RegularTriangulation

RNG = np.random.default_rng(3)
POINTS = np.c_[RNG.random((200, 2)), RNG.random(200) * 9]
SIZES = np.sqrt(RNG.random(200) * 0.02)
CLOUD = Cloud(POINTS, attributes={"size": SIZES, "class": np.arange(200)})
FORM = [[2.0, 0.5], [0.5, 1.25]]
KINDS = pytest.mark.parametrize("kind", ["weights", "radii"])


def triangles(faces: Any) -> set[frozenset[int]]:
    return {frozenset(face) for face in faces.tolist()}


@KINDS
@pytest.mark.parametrize("values", ["size", SIZES, SIZES.tolist(), SIZES[:, None]], ids=repr)
def test_the_faces_are_those_of_the_regular_triangulation(kind: str, values: Any) -> None:
    surface = liftmesh.triangulate(CLOUD, **{kind: values})
    expected = liftmesh.regular(POINTS, **{kind: SIZES})
    np.testing.assert_array_equal(surface.faces, expected.simplices)
    assert isinstance(surface.triangulation, RegularTriangulation)
    np.testing.assert_array_equal(surface.triangulation.hidden, expected.hidden)
    np.testing.assert_array_equal(np.flatnonzero(surface.attributes["hidden"]), expected.hidden)
    name = "size" if isinstance(values, str) else kind
    np.testing.assert_array_equal(surface.attributes[name], SIZES)
    assert surface.metadata["triangulated_by"] == {kind: name}
    report = surface.report
    assert report.n_hidden == len(expected.hidden) > 20
    assert report.n_rows == report.n_used + report.n_hidden == 200
    np.testing.assert_array_equal(report.left_out, expected.hidden)
    assert set(report.representatives.tolist()) == {-1}
    assert f"{report.n_hidden} rows hidden" in str(report)


def test_a_metric_is_that_of_the_plane_coordinates() -> None:
    surface = liftmesh.triangulate(CLOUD, metric=FORM)
    assert surface.metadata["triangulated_by"] == {"metric": FORM}
    wanted = liftmesh.delaunay(POINTS, metric=FORM)
    np.testing.assert_array_equal(surface.faces, wanted.simplices)
    np.testing.assert_array_equal(surface.triangulation.metric, FORM)
    upright = liftmesh.triangulate(CLOUD, metric=FORM, plane="xz")
    wanted = liftmesh.delaunay(POINTS[:, ::2], metric=FORM)
    assert triangles(upright.faces) == triangles(wanted.simplices)
    assert "hidden" not in surface.attributes


def test_weights_count_in_any_plane() -> None:
    surface = liftmesh.triangulate(CLOUD, weights="size", plane=(1, 2, 3))
    planar = surface.frame.planar(POINTS)
    np.testing.assert_array_equal(surface.faces, liftmesh.regular(planar, weights=SIZES).simplices)


ROWS = [(0, 0, 1), (4, 0, 2), (0, 4, 3), (4, 4, 9), (0, 0, 5), (0, 0, 7), (1, 1, 1), (1, 1, 8)]


@pytest.mark.parametrize(("policy", "used"), [("first", 0), ("last", 5), ("highest", 5)])
def test_the_policy_chooses_among_the_heaviest_rows(policy: Any, used: int) -> None:
    weights = [9, 9, 9, 9, 8, 9, -1, -1]  # rows 0 and 5 alike, 4 lighter, 6 and 7 above a facet
    surface = liftmesh.triangulate(ROWS, weights=weights, on_duplicate=policy)
    report = surface.report
    other = 5 - used
    assert report.left_out.tolist() == sorted([other, 4, 6, 7])
    assert report.representatives.tolist()[report.left_out.tolist().index(other)] == used
    assert (report.n_duplicates, report.n_overhangs, report.n_hidden) == (0, 1, 3)
    assert report.n_rows == report.n_used + report.n_overhangs + report.n_hidden
    assert surface.attributes["hidden"].tolist() == [0, 0, 0, 0, 1, 0, 1, 1]
    assert used in surface.faces
    tri = surface.triangulation
    assert tri.duplicates.tolist() == [[other, used]]
    assert tri.hidden.tolist() == [4, 6, 7]


FEW = st.integers(0, 3)


@settings(max_examples=150)
@given(
    st.lists(st.tuples(FEW, FEW, FEW, FEW), min_size=4, max_size=14),
    st.sampled_from(["first", "last", "lowest", "highest", "mean"]),
    st.booleans(),
)
def test_each_row_is_used_or_accounted_for(
    drawn: list[tuple[int, int, int, int]], policy: Any, skips: bool
) -> None:
    rows = np.array([(0, 0, 0, 3), (3, 0, 0, 3), (0, 3, 0, 3), *drawn], dtype=float)
    points, weights = rows[:, :3], rows[:, 3] * 2
    if skips:
        weights[4], points[3, 2] = np.nan, np.inf
    surface = liftmesh.triangulate(
        points, weights=weights, on_duplicate=policy, nonfinite="skip" if skips else "error"
    )
    report, tri = surface.report, surface.triangulation
    assert isinstance(tri, RegularTriangulation)
    counts = (
        report.n_used,
        report.n_duplicates,
        report.n_overhangs,
        report.n_skipped,
        report.n_hidden,
    )
    assert report.n_rows == len(rows) == sum(counts)
    used = np.unique(surface.faces)
    assert report.n_used == len(used)
    assert sorted([*used, *report.left_out]) == list(range(len(rows)))
    assert report.n_skipped == (2 if skips else 0)
    flagged = np.flatnonzero(surface.attributes["hidden"]).tolist()
    assert flagged == tri.hidden.tolist()
    for row, other in zip(report.left_out, report.representatives, strict=True):
        assert (other < 0) == (row in flagged or row in tri.skipped)
        if other >= 0:  # the same position and weight, and the row that the policy prefers
            assert [*rows[row, :2], weights[row]] == [*rows[other, :2], weights[other]]
            better = {"lowest": points[other, 2] <= points[row, 2], "last": other > row}
            better |= {"highest": points[other, 2] >= points[row, 2]}
            assert better.get(policy, other < row)
    finite = np.where(np.isfinite(points).all(axis=1)[:, None], points, np.nan)
    plain = liftmesh.regular(finite, weights=weights, nonfinite="skip")
    assert {frozenset(map(tuple, points[face, :2])) for face in surface.faces} == {
        frozenset(map(tuple, points[face, :2])) for face in plain.simplices
    }
    assert tri.hidden.tolist() == plain.hidden.tolist()


def test_the_mean_leaves_hidden_rows_where_they_are() -> None:
    surface = liftmesh.triangulate(ROWS, weights=[9, 9, 9, 9, 8, 9, -1, -1], on_duplicate="mean")
    assert surface.vertices[:, 2].tolist() == [4, 2, 3, 9, 5, 7, 1, 8]
    with pytest.raises(liftmesh.DuplicateHeightError, match="rows 0 and 5"):
        liftmesh.triangulate(ROWS, weights=[9, 9, 9, 9, 8, 9, -1, -1], on_duplicate="error")
    liftmesh.triangulate(ROWS, weights=[9, 9, 9, 9, 8, 7, -1, -1], on_duplicate="error")


def test_rows_that_are_not_finite_by_weight_are_skipped() -> None:
    values = SIZES.copy()
    values[7] = np.nan
    with pytest.raises(liftmesh.NonFiniteError, match="row 7 has the radius nan"):
        liftmesh.triangulate(CLOUD, radii=values)
    points = POINTS.copy()
    points[[3, 9], [0, 2]] = np.nan
    with pytest.raises(liftmesh.NonFiniteError, match="row 3 is not finite"):
        liftmesh.triangulate(points, radii=SIZES)
    surface = liftmesh.triangulate(points, radii=values, nonfinite="skip")
    assert surface.triangulation.skipped.tolist() == [3, 7, 9]
    assert surface.report.n_skipped == 3


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"weights": "w"}, "weights='w', .* no values of that name: there are 'size', 'class'"),
        ({"weights": "size", "radii": "size"}, "both weights and radii are given"),
        ({"weights": "size", "metric": FORM}, "both weights and a metric are given"),
        ({"radii": "size", "algorithm": "lf"}, "algorithm 'lf' takes no radii"),
        ({"metric": FORM, "algorithm": "lfres"}, "algorithm 'lfres' has no metric"),
        ({"radii": -SIZES}, "row 0 has the radius -0"),
        ({"weights": SIZES[:9]}, "weights hold 9 numbers for 200 rows"),
        ({"metric": [[0, 0], [0, 1]]}, "not positive definite"),
        ({"weights": "size", "attributes": {"hidden": SIZES}}, "values named 'hidden'"),
    ],
)
def test_what_does_not_go_together_is_refused(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        liftmesh.triangulate(CLOUD, **options)


@KINDS
@pytest.mark.parametrize("name", ["mesh.ply", "mesh.npz"])
def test_files_hold_the_weights_and_what_they_hide(kind: str, name: str, tmp_path: Path) -> None:
    surface = liftmesh.triangulate(CLOUD, **{kind: "size"})
    assert surface.save(tmp_path / name).dropped == ()
    again = liftmesh.read(tmp_path / name)
    np.testing.assert_array_equal(again.attributes["size"], SIZES)
    np.testing.assert_array_equal(again.attributes["hidden"], surface.attributes["hidden"])
    assert again.metadata["triangulated_by"] == {kind: "size"}
    np.testing.assert_array_equal(again.faces, surface.faces)
    anew = liftmesh.triangulate(again, **{kind: "size"})
    np.testing.assert_array_equal(anew.faces, surface.faces)
    found = liftmesh.verify(tmp_path / name)
    assert (found.canonical, found.member) == (True, kind)
    plain = liftmesh.triangulate(tmp_path / name)  # the notes of the former run are gone
    assert set(plain.attributes) == {"size", "class"}
    assert "triangulated_by" not in plain.metadata
    assert liftmesh.verify(plain)


def test_files_hold_the_metric(tmp_path: Path) -> None:
    liftmesh.triangulate(CLOUD, metric=[[1 / 3, 0.1], [0.1, 0.7]]).save(tmp_path / "mesh.ply")
    again = liftmesh.read(tmp_path / "mesh.ply")
    assert again.metadata["triangulated_by"] == {"metric": [[1 / 3, 0.1], [0.1, 0.7]]}
    found = liftmesh.verify(again)
    assert (found.canonical, found.member) == (True, "metric")


def test_other_entries_of_that_name_are_the_users() -> None:
    for entry in ("hand", {"weights": 3}, {"metric": [[1]]}, {"a": 1, "b": 2}):
        cloud = Cloud(POINTS, attributes={"hidden": SIZES}, metadata={"triangulated_by": entry})
        surface = liftmesh.triangulate(cloud)
        assert surface.metadata["triangulated_by"] == entry
        assert "hidden" in surface.attributes
        assert liftmesh.verify(surface)


def test_trimeshs_weights_are_taken_if_asked_for() -> None:
    cloud = trimesh.PointCloud(POINTS)
    assert liftmesh.as_cloud(cloud).attributes == {}
    with pytest.raises(InputError, match="they have none"):
        liftmesh.regular(cloud, weights="weights")
    cloud.weights = SIZES
    expected = liftmesh.regular(POINTS, weights=SIZES)
    found = liftmesh.regular(cloud, weights="weights")
    np.testing.assert_array_equal(found.simplices, expected.simplices)
    surface = liftmesh.triangulate(cloud, weights="weights")
    np.testing.assert_array_equal(surface.faces, expected.simplices)
    mesh = surface.to_trimesh()
    np.testing.assert_array_equal(mesh.vertex_attributes["weights"], SIZES)
    np.testing.assert_array_equal(mesh.vertex_attributes["hidden"], surface.attributes["hidden"])
    plain = liftmesh.triangulate(cloud)
    np.testing.assert_array_equal(plain.faces, liftmesh.delaunay(POINTS).simplices)
    np.testing.assert_array_equal(plain.attributes["weights"], SIZES)


def test_open3ds_tensors_name_their_values() -> None:
    import open3d as o3d

    cloud = o3d.t.geometry.PointCloud(o3d.core.Tensor(POINTS))
    cloud.point["size"] = o3d.core.Tensor(SIZES[:, None])
    expected = liftmesh.regular(POINTS, radii=SIZES)
    np.testing.assert_array_equal(
        liftmesh.regular(cloud, radii="size").simplices, expected.simplices
    )
    mesh = liftmesh.triangulate(cloud, radii="size").to_open3d_t()
    np.testing.assert_array_equal(mesh.vertex["size"].numpy()[:, 0], SIZES)
