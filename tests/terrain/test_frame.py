"""The plane option: views for xy, rigid right-handed frames for all else."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.terrain.frame import resolve_plane

NONE = np.zeros((0, 3))

components = st.floats(-1e3, 1e3).filter(lambda value: value == 0 or abs(value) > 1e-9)
normals = st.tuples(components, components, components).filter(any)


def rows(n=200, *, seed=1, offset=(0.0, 0.0, 0.0), scale=100.0):
    return np.random.default_rng(seed).random((n, 3)) * scale + np.asarray(offset)


def tilted(normal, *, n=200, noise=0.0, offset=(0.0, 0.0, 0.0), seed=2):
    """Rows on, or near, a plane through an offset."""
    rng = np.random.default_rng(seed)
    normal = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
    flat = rng.random((n, 3)) * 100
    flat -= np.outer(flat @ normal, normal)
    return flat + np.outer(rng.normal(0, noise, n), normal) + np.asarray(offset)


def assert_rigid(frame):
    assert np.abs(frame.axes @ frame.axes.T - np.eye(3)).max() < 1e-15 * 4
    assert np.allclose(np.cross(frame.axes[0], frame.axes[1]), frame.axes[2], atol=1e-15)


class TestXY:
    def test_coordinates_are_views(self):
        points = rows()
        frame = resolve_plane("xy", points)
        planar, heights = frame.planar(points), frame.heights(points)
        assert planar.base is points
        assert heights.base is points
        assert planar.tobytes() == points[:, :2].tobytes()

    def test_nothing_is_computed(self):
        points = np.array([[np.nan, -0.0, np.inf], [5e-324, 1.7e308, -np.inf]])
        frame = resolve_plane("xy", points)
        assert frame.planar(points).tobytes() == points[:, :2].tobytes()
        assert frame.heights(points).tobytes() == points[:, 2].tobytes()

    def test_raising_a_row_changes_z_only(self):
        points = np.array([[-0.0, 5e-324, 7.0], [1e300, -0.0, 8.0]])
        raised = resolve_plane("xy", points).raised(points, points[:, 2], np.array([0.1, 0.2]))
        assert raised[:, :2].tobytes() == points[:, :2].tobytes()
        assert raised[:, 2].tolist() == [0.1, 0.2]


class TestNormal:
    @given(normals)
    @settings(deadline=None)
    def test_frames_are_rigid_and_right_handed(self, normal):
        frame = resolve_plane(normal, rows(5))
        assert_rigid(frame)
        assert np.dot(frame.normal, normal) > 0

    @given(normals, st.integers(-800, 900))
    @settings(deadline=None)
    def test_the_length_does_not_matter(self, normal, exponent):
        points = rows(5)
        scaled = np.ldexp(normal, exponent)
        one, other = resolve_plane(normal, points), resolve_plane(scaled, points)
        assert one.axes.tobytes() == other.axes.tobytes()

    @pytest.mark.parametrize("length", [5e-324, 1e-310, 1e300, 1.7e308])
    def test_extreme_lengths(self, length):
        frame = resolve_plane((length, length, length), rows(5))
        assert np.allclose(frame.normal, np.sqrt([1 / 3] * 3), rtol=1e-15)

    @given(normals)
    @settings(deadline=None)
    def test_distances_are_kept(self, normal):
        points = rows(20, offset=(4.5e5, 5.2e6, 200.0))
        frame = resolve_plane(normal, points)
        flat = np.column_stack([frame.planar(points), frame.heights(points)])
        expected = np.linalg.norm(points[1:] - points[:-1], axis=1)
        assert np.allclose(np.linalg.norm(flat[1:] - flat[:-1], axis=1), expected, rtol=1e-12)

    def test_the_z_axis_gives_the_coordinates_of_xy(self):
        points = rows(offset=(4.5e5, 5.2e6, 0.0))
        frame = resolve_plane((0, 0, 2), points)
        assert np.array_equal(frame.planar(points), points[:, :2])
        assert np.array_equal(frame.heights(points), points[:, 2])

    @pytest.mark.parametrize("axis", [0, 1, 2])
    @pytest.mark.parametrize("sign", [-3.0, 3.0])
    def test_normals_along_an_axis_lose_no_bit(self, axis, sign):
        points = rows(offset=(4.5e5, 5.2e6, 0.1))
        frame = resolve_plane(np.eye(3)[axis] * sign, points)
        assert_rigid(frame)
        columns = [np.abs(column) for column in frame.planar(points).T]
        others = [points[:, k] for k in range(3) if k != axis]
        assert any(np.array_equal(columns, pair) for pair in (others, others[::-1]))
        assert np.array_equal(frame.heights(points), np.copysign(1, sign) * points[:, axis])

    def test_minus_zero_does_not_turn_the_axes(self):
        plus, minus = resolve_plane((1, 0.0, 0.0), NONE), resolve_plane((1, -0.0, -0.0), NONE)
        assert np.array_equal(plus.axes, minus.axes)

    @pytest.mark.parametrize("count", [1, 2, 3, 7, 16, 17, 64, 1001])
    def test_equal_rows_have_equal_coordinates_wherever_they_stand(self, count):
        points = np.repeat(rows(3, offset=(4.5e5, 5.2e6, 0.0)), count, axis=0)
        frame = resolve_plane((1, 2, 3), points)
        planar = frame.planar(points)
        assert len(np.unique(planar, axis=0)) == 3
        assert frame.planar(points[-1:]).tobytes() == planar[-1:].tobytes()

    def test_the_order_of_the_rows_does_not_matter(self):
        points = rows(offset=(4.5e5, 5.2e6, 0.0))
        frame, other = resolve_plane((1, 2, 3), points), resolve_plane((1, 2, 3), points[::-1])
        assert frame.planar(points).tobytes() == other.planar(points).tobytes()

    def test_nonfinite_rows_do_not_shift_the_origin(self):
        points = rows(50)
        holed = np.vstack([points, [[np.nan, 0, 0], [0, np.inf, 0]]])
        frame, other = resolve_plane((1, 2, 3), points), resolve_plane((1, 2, 3), holed)
        assert frame.origin.tobytes() == other.origin.tobytes()
        assert not np.isfinite(other.planar(holed)[50:]).all(axis=1).any()

    def test_no_finite_row_at_all(self):
        points = np.full((2, 3), np.nan)
        assert np.isnan(resolve_plane((1, 2, 3), points).planar(points)).all()


class TestFit:
    @given(normals)
    @settings(deadline=None)
    def test_the_plane_that_made_the_rows_is_found(self, normal):
        unit = np.array(normal) / np.linalg.norm(normal)
        frame = resolve_plane("fit", tilted(normal))
        assert_rigid(frame)
        assert abs(frame.normal @ unit) > 1 - 1e-12

    @pytest.mark.parametrize("offset", [0.0, 5e6, 1e12])
    def test_offsets_cost_no_digits(self, offset):
        step = np.float64(2.0**-8)
        grid = np.indices((20, 30)).reshape(2, -1).T * step
        points = np.column_stack([grid, grid @ [3.0, -2.0]]) + offset
        expected = np.array([-3.0, 2.0, 1.0]) / np.sqrt(14)
        assert np.allclose(resolve_plane("fit", points).normal, expected, atol=1e-13)

    def test_no_other_normal_fits_better(self):
        points = tilted((1, 2, 3), noise=5.0)
        frame = resolve_plane("fit", points)
        centred = points - points.mean(axis=0)
        best = ((centred @ frame.normal) ** 2).sum()
        for other in np.random.default_rng(3).normal(0, 0.01, (100, 3)):
            turned = frame.normal + other
            turned /= np.linalg.norm(turned)
            assert ((centred @ turned) ** 2).sum() >= best

    def test_heights_are_measured_from_the_plane(self):
        points = tilted((1, 2, 3), noise=5.0, offset=(1e3, 2e3, 3e3))
        assert abs(resolve_plane("fit", points).heights(points).mean()) < 1e-10

    @pytest.mark.parametrize(
        ("normal", "expected"),
        [
            ((1, 2, -3), (-1, -2, 3)),
            ((-1, -2, 0), (1, 2, 0)),
            ((3, -2, 0), (-3, 2, 0)),
            ((-4, 0, 0), (4, 0, 0)),
            ((0, -1, 0), (0, 1, 0)),
            ((0, 0, -1), (0, 0, 1)),
        ],
    )
    def test_the_sign_is_fixed(self, normal, expected):
        for seed in range(5):
            fitted = resolve_plane("fit", tilted(normal, seed=seed)).normal
            assert np.allclose(fitted, expected / np.linalg.norm(expected), atol=1e-13)

    def test_a_level_cloud_keeps_its_own_coordinates(self):
        points = rows(offset=(4.5e5, 5.2e6, 0.0))
        points[:, 2] = 7.25
        frame = resolve_plane("fit", points)
        assert frame.normal.tolist() == [0, 0, 1]
        assert np.array_equal(frame.planar(points), points[:, :2])

    @pytest.mark.parametrize("exponent", [-1000, -300, 300, 1010])
    def test_scale_does_not_matter(self, exponent):
        points = tilted((1, 2, 3), noise=1.0)
        normal = resolve_plane("fit", points).normal
        scaled = resolve_plane("fit", np.ldexp(points, exponent)).normal
        assert np.allclose(normal, scaled, atol=1e-14)

    def test_nonfinite_rows_are_left_out(self):
        points = tilted((1, 2, 3), noise=1.0)
        holed = np.vstack([points, [[np.nan, 1e9, 1e9], [1e9, 1e9, -np.inf]]])
        frame, other = resolve_plane("fit", points), resolve_plane("fit", holed)
        assert frame.axes.tobytes() == other.axes.tobytes()
        assert frame.origin.tobytes() == other.origin.tobytes()

    def test_the_same_rows_give_the_same_frame(self):
        points = tilted((1, 2, 3), n=5000, noise=1.0)
        frame, other = resolve_plane("fit", points), resolve_plane("fit", points.copy())
        assert frame.axes.tobytes() == other.axes.tobytes()

    @pytest.mark.parametrize("count", [0, 1, 2])
    def test_fewer_than_three_finite_rows_are_refused(self, count):
        points = np.vstack([rows(count), [[np.nan, 0, 0]]])
        with pytest.raises(DegenerateInputError, match=f"{count} finite rows: it needs three"):
            resolve_plane("fit", points)

    @pytest.mark.parametrize("direction", [(0, 0, 1), (1, 2, 3), (5, -7, 11), (1e-3, 1, 0)])
    @pytest.mark.parametrize("offset", [0, 1000])
    def test_rows_on_one_line_are_refused(self, direction, offset):
        points = np.outer(np.arange(50.0), direction) + offset
        with pytest.raises(DegenerateInputError, match="on one line"):
            resolve_plane("fit", points)

    def test_equal_rows_are_refused(self):
        with pytest.raises(DegenerateInputError, match="equal or on one line"):
            resolve_plane("fit", np.full((10, 3), 0.1))


class TestMatrix:
    @given(normals)
    @settings(deadline=None)
    def test_the_frame_does_what_trimesh_does(self, normal):
        points = rows(20)
        unit = np.array(normal) / np.linalg.norm(normal)
        matrix = trimesh.geometry.plane_transform(origin=points[3], normal=unit)
        frame = resolve_plane(matrix, points)
        expected = trimesh.transform_points(points, matrix)
        assert np.allclose(frame.planar(points), expected[:, :2], atol=1e-11)
        assert np.allclose(frame.heights(points), expected[:, 2], atol=1e-11)
        assert np.allclose(frame.normal, unit, atol=1e-12)

    @pytest.mark.parametrize("plane", ["xy", "fit", (1, 2, 3)])
    def test_the_matrix_of_a_frame_leads_back_to_it(self, plane):
        points = tilted((1, 2, 3), noise=1.0, offset=(1e3, 2e3, 0))
        frame = resolve_plane(plane, points)
        again = resolve_plane(frame.matrix, points)
        assert np.allclose(frame.planar(points), again.planar(points), atol=1e-9)
        assert np.allclose(frame.heights(points), again.heights(points), atol=1e-9)

    def test_a_translation_is_exact(self):
        points = np.round(rows(offset=(4.5e5, 5.2e6, 0.0)))
        matrix = np.eye(4)
        matrix[:3, 3] = (-450000, -5200000, 7)
        frame = resolve_plane(matrix, points)
        assert np.array_equal(frame.planar(points), points[:, :2] - (450000, 5200000))
        assert np.array_equal(frame.heights(points), points[:, 2] + 7)

    def test_the_matrix_is_not_kept(self):
        matrix = np.eye(4)
        frame = resolve_plane(matrix, NONE)
        matrix[:] = 7
        assert np.array_equal(frame.axes, np.eye(3))

    def test_a_rotation_off_by_a_little_is_allowed(self):
        matrix = np.eye(4)
        matrix[0, 1] = 5e-10
        assert resolve_plane(matrix, NONE).name == "matrix"

    @pytest.mark.parametrize(
        ("at", "value", "message"),
        [
            ((0, 0), 1.00001, "not rigid, its rotation is off by 2e-05"),
            ((0, 1), 0.5, "not rigid"),
            ((2, 2), 1e200, "not rigid"),
            ((2, 2), -1.0, "is a reflection"),
            ((3, 0), 5.0, r"last row \[5.0, 0.0, 0.0, 1.0\].*transpose"),
            ((3, 3), 2.0, "last row"),
            ((1, 3), np.inf, "not finite"),
        ],
    )
    def test_other_matrices_are_refused(self, at, value, message):
        matrix = np.eye(4)
        matrix[at] = value
        with pytest.raises(InputError, match=message):
            resolve_plane(matrix, NONE)


class TestNamedPlanes:
    @pytest.mark.parametrize(
        ("plane", "columns", "normal"), [("xz", [0, 2], (0, -1, 0)), ("yz", [1, 2], (1, 0, 0))]
    )
    def test_two_columns_are_the_coordinates(self, plane, columns, normal):
        points = rows(50)
        points[3] = 0.0, -0.0, 5e-324
        frame = resolve_plane(plane, points)
        assert np.shares_memory(frame.planar(points), points)
        assert frame.planar(points).tobytes() == points[:, columns].tobytes()
        assert np.array_equal(frame.heights(points), points @ normal)
        assert frame.normal.tolist() == [*normal]
        assert np.linalg.det(frame.axes) == 1
        same = resolve_plane(normal, points)
        assert np.array_equal(np.abs(same.heights(points)), np.abs(frame.heights(points)))

    @pytest.mark.parametrize("plane", ["xy", "xz", "yz", (0, 0, -1), (1, 0, 0)])
    def test_rows_are_raised_to_the_height_itself(self, plane):
        points = rows(5)
        frame = resolve_plane(plane, points)
        new = np.array([0.1, 1e17, -3.0, 5e-324, 0.0])
        moved = frame.raised(points, frame.heights(points), new)
        assert np.array_equal(frame.heights(moved), new)
        assert np.array_equal(frame.planar(moved), frame.planar(points))

    def test_they_are_triangulated_without_a_copy(self):
        points = rows(500)
        surface = liftmesh.triangulate(points, plane="xz")
        alone = liftmesh.delaunay(points[:, [0, 2]])
        assert np.array_equal(surface.triangulation.simplices, alone.simplices)
        assert np.shares_memory(surface.triangulation.points, points)

    def test_rows_of_two_columns_are_not_projected(self):
        frame = resolve_plane("xy", NONE)
        with pytest.raises(InputError, match="points have two columns: a projection needs x, y"):
            frame.planar(np.zeros((4, 2)))

    def test_rows_are_raised_along_a_tilted_normal(self):
        points = rows(5)
        frame = resolve_plane((1, 2, 3), points)
        moved = frame.raised(points, frame.heights(points), np.full(5, 7.0))
        assert np.allclose(frame.heights(moved), 7)
        assert np.allclose(frame.planar(moved), frame.planar(points))


class TestEquations:
    def test_what_plane_fit_returns_is_a_plane(self):
        points = tilted((1, 2, 3))
        point, normal = trimesh.points.plane_fit(points)
        for plane in ((point, normal), [list(point), list(normal)], np.array([point, normal])):
            frame = resolve_plane(plane, points)
            assert np.allclose(frame.normal, normal, atol=1e-15)
            assert frame.origin.tolist() == point.tolist()
        fitted = resolve_plane("fit", points)
        assert np.allclose(np.abs(frame.heights(points)), np.abs(fitted.heights(points)), atol=1e-7)
        assert liftmesh.triangulate(points, plane=(point, normal)).triangulation.verify().canonical

    @pytest.mark.parametrize("scale", [1, -2.5, 1e200, 1e-200])
    @pytest.mark.parametrize("normal", [(1, 2, 3), (0, 0, 1), (0, -4, 0), (1e-3, 5, 2)])
    def test_heights_are_distances_from_the_plane_of_an_equation(self, normal, scale):
        points = rows(20)
        a, b, c = np.array(normal) * scale
        d = -7.0 * scale
        frame = resolve_plane((a, b, c, d), points)
        expected = (points @ normal - 7) / np.linalg.norm(normal) * np.sign(scale)
        assert np.allclose(frame.heights(points), expected, rtol=1e-12, atol=1e-9)

    def test_an_equation_along_an_axis_keeps_the_other_coordinates(self):
        points = rows(20) + 5e6
        frame = resolve_plane((0, 0, 2, -10), points)
        assert frame.planar(points).tolist() == points[:, :2].tolist()
        assert frame.heights(points).tolist() == (points[:, 2] - 5).tolist()
        frame = resolve_plane(((1, 2, 3), (0, 0, 1)), points)
        assert frame.planar(points).tolist() == points[:, :2].tolist()

    def test_far_from_zero_the_origin_is_near_the_rows(self):
        points = rows(20) + 5e6
        frame = resolve_plane((1, 2, 3, -4), points)
        assert np.abs(frame.planar(points)).max() < np.ptp(points, axis=0).max() * 2

    @pytest.mark.parametrize(
        ("plane", "message"),
        [
            ((0, 0, 0, 1), r"normal is \(0, 0, 0\)"),
            (((1, 2, 3), (0, 0, 0)), r"normal is \(0, 0, 0\)"),
            ((1e-300, 0, 0, 1e300), "overflows"),
        ],
    )
    def test_equations_of_no_plane_are_refused(self, plane, message):
        with pytest.raises(InputError, match=message):
            resolve_plane(plane, rows(5))


@pytest.mark.parametrize(
    ("plane", "message"),
    [
        ("zx", "plane 'zx' is unknown: give 'xy', 'xz'"),
        ((0, 0, 0), r"normal is \(0, 0, 0\)"),
        ((0, np.nan, 1), "not finite"),
        ((1, 2), r"shape \(2,\)"),
        (np.eye(3), r"shape \(3, 3\)"),
        (5, r"shape \(\)"),
        (None, "plane"),
        (("a", "b", "c"), "cannot be read as numbers"),
        ([[1, 2], [3]], "cannot be read as numbers"),
        ({}, "cannot be read as numbers"),
        ((1j, 0, 0), "cannot be read as numbers"),
    ],
)
def test_other_planes_are_refused(plane, message):
    with pytest.raises(InputError, match=message):
        resolve_plane(plane, rows(5))
