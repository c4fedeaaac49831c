"""Rows that no face uses: of shared planar positions, and rows that are not finite."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from surfaces import POLICIES, assert_accounted, layered, planar_groups, terrain, triangles_of

import liftmesh
from liftmesh import triangulate
from liftmesh.errors import DuplicateHeightError, InputError, NonFiniteError


def eighth_turn():
    """A rotation by 45 degrees about the z axis."""
    return trimesh.transformations.rotation_matrix(np.pi / 4, (0, 0, 1))


class TestDuplicates:
    @pytest.mark.parametrize("policy", POLICIES)
    def test_the_policy_chooses_the_row_at_every_position(self, policy):
        points = layered()
        surface = triangulate(points, on_duplicate=policy)
        assert_accounted(surface)
        used = set(np.unique(surface.faces).tolist())
        choose = {
            "last": lambda rows: rows[-1],
            "lowest": lambda rows: min(rows, key=lambda row: (points[row, 2], row)),
            "highest": lambda rows: min(rows, key=lambda row: (-points[row, 2], row)),
        }.get(policy, lambda rows: rows[0])
        chosen = {position: choose(rows) for position, rows in planar_groups(points).items()}
        assert used == set(chosen.values())
        report = surface.report
        for row, representative in zip(report.left_out, report.representatives, strict=True):
            assert representative == chosen[tuple(points[row, :2].tolist())]
        same = points[report.left_out, 2] == points[report.representatives, 2]
        assert (report.n_duplicates, report.n_overhangs) == (same.sum(), (~same).sum())

    @pytest.mark.parametrize("policy", POLICIES)
    def test_the_planar_triangles_are_the_same_for_every_policy(self, policy):
        points = layered()
        surface = triangulate(points, on_duplicate=policy)
        flat = liftmesh.delaunay(points[:, :2])
        assert triangles_of(points[:, :2], surface.faces) == triangles_of(
            points[:, :2], flat.simplices
        )

    def test_the_mean_changes_one_height_and_nothing_else(self):
        points = np.array(
            [
                [-0.0, 0, 1.0],
                [1, 0, 2],
                [0, 1, 3],
                [0, 0, 4],
                [0, -0.0, 4],
                [1, 0, 2],
                [5e-324, 0, 9],
            ]
        )
        before = points.tobytes()
        surface = triangulate(points, on_duplicate="mean")
        assert points.tobytes() == before
        expected = points.copy()
        expected[0, 2] = 2.5
        assert surface.vertices.tobytes() == expected.tobytes()
        assert surface.report.left_out.tolist() == [3, 4, 5]
        assert surface.report.representatives.tolist() == [0, 0, 1]
        assert (surface.report.n_duplicates, surface.report.n_overhangs) == (1, 2)

    def test_the_mean_copies_only_where_a_height_changes(self):
        points = np.vstack([terrain(), terrain()[:5]])
        assert np.shares_memory(triangulate(points, on_duplicate="mean").vertices, points)

    def test_the_mean_moves_along_the_normal_of_the_plane(self):
        base = terrain(50, offset=(0, 0, 0))
        points = np.vstack([base, base[7] + (8.0, 0.0, 0.0)])
        surface = triangulate(points, plane=(1, 0, 0), on_duplicate="mean")
        expected = base[7] + (4.0, 0.0, 0.0)
        assert np.allclose(surface.vertices[7], expected, rtol=1e-15)
        assert surface.report.n_overhangs == 1
        rest = np.delete(np.arange(51), 7)
        assert surface.vertices[rest].tobytes() == points[rest].tobytes()

    def test_the_error_names_both_rows(self):
        points = np.vstack([terrain(), terrain()[:2] + np.array([0, 0, 1])])
        with pytest.raises(DuplicateHeightError, match="rows 0 and 300 share") as caught:
            triangulate(points, on_duplicate="error")
        assert caught.value.rows == (0, 300)

    def test_plain_duplicates_are_no_error(self):
        points = np.vstack([terrain(), terrain()[[7, 7, 3]]])
        report = triangulate(points, on_duplicate="error").report
        assert (report.n_duplicates, report.n_overhangs) == (3, 0)
        assert report.left_out.tolist() == [300, 301, 302]
        assert report.representatives.tolist() == [7, 7, 3]

    def test_a_million_rows_at_one_position(self):
        corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        points = np.zeros((1_000_003, 3))
        points[:, 2] = np.arange(1_000_003) % 1000
        points[-3:] = corners
        report = triangulate(points, on_duplicate="highest").report
        assert (report.n_used, report.n_triangles) == (3, 1)
        assert report.representatives[0] == 999


class TestNonFinite:
    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    @pytest.mark.parametrize("column", [0, 1, 2])
    @pytest.mark.parametrize("plane", ["xy", "fit", (1, 2, 3), np.eye(4)])
    def test_rows_are_named_or_skipped(self, bad, column, plane):
        points = terrain()
        points[[41, 7], column] = bad
        with pytest.raises(NonFiniteError, match=r"row 7 is not finite: \(.*nonfinite='skip'") as e:
            triangulate(points, plane=plane)
        assert e.value.row == 7
        before = points.tobytes()
        surface = triangulate(points, plane=plane, nonfinite="skip")
        assert points.tobytes() == before
        assert surface.vertices.tobytes() == before
        assert_accounted(surface)
        assert surface.report.n_skipped == 2
        assert surface.report.left_out.tolist() == [7, 41]
        assert surface.report.representatives.tolist() == [-1, -1]

    def test_the_first_row_is_named_whatever_is_wrong_with_it(self):
        points = terrain()
        points[9, 2] = np.nan
        points[4, 0] = np.inf
        with pytest.raises(NonFiniteError, match="row 4 is not finite"):
            triangulate(points)

    def test_skipped_rows_change_no_triangle(self):
        points = terrain()
        holed = np.insert(points, [100, 100, 250], np.nan, axis=0)
        holed[100, :2] = points[5, :2]
        surface = triangulate(holed, nonfinite="skip")
        assert triangles_of(holed, surface.faces) == triangles_of(points, triangulate(points).faces)
        assert surface.report.n_skipped == 3
        assert surface.report.n_overhangs == 0

    def test_rows_left_out_for_different_reasons_are_listed_in_order(self):
        points = np.vstack([[[np.nan] * 3], terrain(), [[0, 0, np.inf]], terrain()[[8, 3]]])
        surface = triangulate(points, nonfinite="skip", on_duplicate="last")
        assert_accounted(surface)
        assert surface.report.left_out.tolist() == [0, 4, 9, 301]
        assert surface.report.representatives.tolist() == [-1, 303, 302, -1]

    def test_masked_rows_are_not_finite(self):
        points = np.ma.masked_array(terrain(), mask=False)
        points[12, 2] = np.ma.masked
        with pytest.raises(NonFiniteError, match="row 12"):
            triangulate(points)
        assert triangulate(points, nonfinite="skip").report.left_out.tolist() == [12]

    @pytest.mark.parametrize("nonfinite", ["error", "skip"])
    def test_finite_rows_whose_planar_coordinates_overflow_are_never_skipped(self, nonfinite):
        points = terrain(offset=(0, 0, 0))
        points[3] = (1.7e308, 1.7e308, 0)
        assert triangulate(points).report.n_used == 300
        with pytest.raises(InputError, match=r"row 3, \(1\.7e\+308, .*overflows.*scale"):
            triangulate(points, plane=eighth_turn(), nonfinite=nonfinite)


def test_a_fit_does_not_pass_over_a_row_that_is_not_finite() -> None:
    line = np.array([[0.0, 0, 0], [1, 1, 1], [2, 2, 2], [np.nan, 0, 0]])
    with pytest.raises(NonFiniteError, match="row 3 is not finite"):
        triangulate(line, plane="fit")
