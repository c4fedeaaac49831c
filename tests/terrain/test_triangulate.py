"""triangulate(): any cloud in, all of its rows out, every one accounted for."""

from __future__ import annotations

import hypothesis.extra.numpy as hnp
import numpy as np
import open3d as o3d
import pytest
import trimesh
from hypothesis import assume, given, settings, strategies as st
from surfaces import POLICIES, assert_accounted, layered, terrain, triangles_of

import liftmesh
from liftmesh import triangulate
from liftmesh.errors import (
    DegenerateInputError,
    FormatError,
    InputError,
    UnsupportedTypeError,
)


class TestRows:
    def test_vertices_are_the_callers_rows(self):
        points = terrain()
        surface = triangulate(points)
        assert np.shares_memory(surface.vertices, points)
        assert surface.vertices.tobytes() == points.tobytes()
        assert surface.faces.dtype == np.int32
        assert_accounted(surface)

    @given(
        hnp.arrays(
            np.float64,
            st.tuples(st.integers(3, 30), st.just(3)),
            elements=st.floats(allow_nan=False, allow_infinity=False) | st.integers(-3, 3),
        ),
        st.sampled_from(POLICIES[:-1]),
    )
    @settings(deadline=None)
    def test_every_coordinate_stays_bit_for_bit(self, points, policy):
        before = points.tobytes()
        try:
            surface = triangulate(points, on_duplicate=policy)
        except DegenerateInputError:
            assume(False)
        assert points.tobytes() == before
        assert surface.vertices.tobytes() == before
        assert_accounted(surface)

    def test_faces_are_the_planar_triangles(self):
        points = terrain()
        planar = liftmesh.delaunay(points[:, :2])
        surface = triangulate(points)
        assert np.array_equal(surface.faces, planar.simplices)
        assert np.array_equal(surface.triangulation.points, points[:, :2])

    def test_the_order_of_the_rows_does_not_change_the_triangles(self):
        points = layered()
        shuffled = np.random.default_rng(3).permutation(points)
        one = triangulate(points, on_duplicate="highest")
        other = triangulate(shuffled, on_duplicate="highest")
        assert triangles_of(points, one.faces) == triangles_of(shuffled, other.faces)

    def test_read_only_and_strided_rows(self):
        points = np.zeros((300, 6))[:, ::2]
        points[:] = terrain()
        points.flags.writeable = False
        assert np.array_equal(triangulate(points).faces, triangulate(terrain()).faces)
        assert np.shares_memory(triangulate(points).vertices, points)

    def test_planar_rows_lie_at_zero(self):
        surface = triangulate(terrain()[:, :2])
        assert np.array_equal(surface.vertices[:, :2], terrain()[:, :2])
        assert not surface.vertices[:, 2].any()

    def test_single_precision_and_integers_keep_their_values(self):
        for points in (terrain(offset=(0, 0, 0)).astype(np.float32), layered().astype(np.int64)):
            assert np.array_equal(triangulate(points).vertices, points)


class TestClouds:
    points = terrain()
    colors = np.random.default_rng(5).integers(0, 256, (300, 4), dtype=np.uint8)
    normals = np.random.default_rng(6).normal(size=(300, 3))
    intensity = np.arange(300, dtype=np.uint16)

    def check(self, source, *, colors=None, normals=None, attributes=()):
        surface = triangulate(source)
        assert surface.vertices.tobytes() == self.points.tobytes()
        assert np.array_equal(surface.faces, triangulate(self.points).faces)
        assert (surface.colors is None) == (colors is None)
        assert colors is None or np.array_equal(surface.colors, colors)
        assert (surface.normals is None) == (normals is None)
        assert normals is None or np.array_equal(surface.normals, normals)
        assert set(surface.attributes) == set(attributes)
        for name in attributes:
            assert np.array_equal(surface.attributes[name], self.intensity)

    def test_lists(self):
        self.check(self.points.tolist())

    def test_clouds(self):
        cloud = liftmesh.Cloud(
            self.points,
            colors=self.colors,
            normals=self.normals,
            attributes={"intensity": self.intensity},
            metadata={"crs": "EPSG:32614"},
        )
        self.check(cloud, colors=self.colors, normals=self.normals, attributes=["intensity"])
        assert triangulate(cloud).metadata["crs"] == "EPSG:32614"

    def test_trimesh_point_clouds(self):
        source = trimesh.PointCloud(self.points, colors=self.colors)
        self.check(source, colors=self.colors)

    def test_trimesh_meshes_are_their_vertices(self):
        source = trimesh.Trimesh(
            self.points,
            [[0, 1, 2]],
            vertex_normals=self.normals.copy(),
            vertex_attributes={"intensity": self.intensity},
            process=False,
        )
        self.check(source, normals=self.normals, attributes=["intensity"])

    def test_legacy_open3d_clouds(self):
        source = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(self.points))
        source.normals = o3d.utility.Vector3dVector(self.normals)
        self.check(source, normals=self.normals)

    def test_tensor_open3d_clouds(self):
        source = o3d.t.geometry.PointCloud(o3d.core.Tensor(self.points))
        source.point["colors"] = o3d.core.Tensor(self.colors[:, :3])
        source.point["intensity"] = o3d.core.Tensor(self.intensity[:, None])
        self.check(source, colors=self.colors[:, :3], attributes=["intensity"])

    @pytest.mark.parametrize("name", ["cloud.ply", "cloud.npz"])
    def test_paths(self, tmp_path, name):
        cloud = liftmesh.Cloud(
            self.points, colors=self.colors, attributes={"intensity": self.intensity}
        )
        liftmesh.write(tmp_path / name, cloud)
        self.check(tmp_path / name, colors=self.colors, attributes=["intensity"])
        self.check(str(tmp_path / name), colors=self.colors, attributes=["intensity"])

    def test_a_missing_file_is_named(self, tmp_path):
        with pytest.raises((FormatError, FileNotFoundError), match=r"nowhere\.ply"):
            triangulate(tmp_path / "nowhere.ply")

    @pytest.mark.parametrize("source", [None, 7, object()])
    def test_other_objects_are_refused(self, source):
        with pytest.raises(UnsupportedTypeError, match="is not a point cloud: give an array"):
            triangulate(source)


class TestPlanes:
    @pytest.mark.parametrize("seed", range(6))
    def test_faces_turn_counter_clockwise_seen_from_above(self, seed):
        rng = np.random.default_rng(seed)
        points = terrain(seed=seed, offset=(1e4, 2e4, 0)) @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
        matrix = trimesh.geometry.plane_transform(points[0], trimesh.unitize(rng.normal(size=3)))
        for plane in ("xy", "fit", rng.normal(size=3), matrix):
            surface = triangulate(points, plane=plane)
            a, b, c = surface.vertices[surface.faces.T]
            normals = np.cross(b - a, c - a)
            assert (normals @ surface.frame.normal > 0).all()
            assert_accounted(surface)

    def test_a_normal_from_below_turns_the_faces(self):
        points = terrain()
        up, down = triangulate(points, plane=(0, 0, 1)), triangulate(points, plane=(0, 0, -1))
        assert triangles_of(points, up.faces) == triangles_of(points, triangulate(points).faces)
        assert triangles_of(points, up.faces) == triangles_of(points, down.faces)
        a, b, c = points[down.faces.T]
        assert (np.cross(b - a, c - a)[:, 2] < 0).all()

    def test_a_wall_needs_another_plane(self):
        wall = np.column_stack([np.full(200, 3.0), terrain(200, offset=(0, 0, 0))[:, :2]])
        with pytest.raises(DegenerateInputError, match="on one line"):
            triangulate(wall)
        for plane in ("fit", (2, 0, 0)):
            surface = triangulate(wall, plane=plane)
            assert surface.frame.normal.tolist() == [1, 0, 0]
            assert surface.report.n_used == 200
            assert triangles_of(wall[:, 1:], surface.faces) == triangles_of(
                wall[:, 1:], triangulate(wall[:, 1:]).faces
            )

    def test_planar_points_are_those_of_the_frame(self):
        points = terrain()
        surface = triangulate(points, plane="fit")
        planar = surface.frame.planar(points)
        assert surface.triangulation.points.tobytes() == planar.tobytes()

    def test_equal_rows_are_duplicates_on_every_plane(self):
        points = np.vstack([terrain(), terrain()[:50]])
        for plane in ("fit", (1, 2, 3), np.eye(4)):
            report = triangulate(points, plane=plane, on_duplicate="error").report
            assert (report.n_duplicates, report.n_overhangs) == (50, 0)

    def test_a_line_in_space_has_no_surface(self):
        line = np.outer(np.arange(20.0), (1, 2, 3))
        with pytest.raises(DegenerateInputError, match="on one line"):
            triangulate(line)
        with pytest.raises(DegenerateInputError, match="on one line"):
            triangulate(line, plane="fit")


class TestInput:
    @pytest.mark.parametrize("plane", ["xy", "fit", (0, 0, 1)])
    @pytest.mark.parametrize(
        "points",
        [
            np.zeros((0, 3)),
            np.zeros((1, 3)),
            np.eye(3)[:2],
            np.zeros((9, 3)),
            np.full((9, 3), 1e300),
            np.outer(np.arange(5), (1.0, 1.0, 0.0)),
        ],
        ids=["none", "one", "two", "equal", "equal and far", "line"],
    )
    def test_no_triangle_is_an_error(self, points, plane):
        with pytest.raises(DegenerateInputError):
            triangulate(points, plane=plane)

    def test_nothing_left_after_skipping_is_an_error(self):
        with pytest.raises(DegenerateInputError):
            triangulate(np.full((5, 3), np.nan), nonfinite="skip")

    @pytest.mark.parametrize(
        "points",
        [
            np.zeros((3, 1)),
            np.zeros((3, 4)),
            np.zeros(3),
            np.zeros((2, 2, 3)),
            np.zeros((3, 3), dtype=complex),
            [["a", "b", "c"]] * 3,
            [[0, 0, 0], [1, 1], [0, 1, 0]],
            [[2**53 + 1, 0, 0], [1, 0, 0], [0, 1, 0]],
            np.broadcast_to(np.zeros((1, 3)), (2**30, 3)),
        ],
    )
    def test_other_arrays_are_refused(self, points):
        with pytest.raises(InputError):
            triangulate(points)

    @pytest.mark.parametrize(
        ("option", "message"),
        [
            ({"on_duplicate": "median"}, "on_duplicate is 'median': give one of 'first', 'last'"),
            ({"nonfinite": "drop"}, "nonfinite is 'drop': give one of 'error', 'skip'"),
            ({"plane": "zy"}, "plane 'zy' is unknown"),
            ({"algorithm": "magic"}, "algorithm is 'magic': give one of 'auto'"),
            ({"threads": 0}, "threads is 0: give a whole number from 1 to 1024"),
            ({"on_duplicate": np.array("first")}, "on_duplicate is array"),
            ({"on_duplicate": []}, r"on_duplicate is \[\]: give one of 'first'"),
            ({"algorithm": np.array(["auto", "lf"])}, "algorithm is array"),
            ({"nonfinite": None}, "nonfinite is None"),
        ],
    )
    def test_other_options_are_refused(self, option, message):
        with pytest.raises(InputError, match=message):
            triangulate(terrain(), **option)


class TestReport:
    def test_stages_are_timed(self):
        seconds = triangulate(terrain()).report.seconds
        assert list(seconds) == ["read", "plane", "triangulation", "heights"]
        assert all(value >= 0 for value in seconds.values())

    def test_it_reads_as_a_sentence(self):
        points = np.vstack(
            [terrain(), terrain()[:1], terrain()[:2] + np.array([0, 0, 1]), [[np.nan] * 3]]
        )
        report = triangulate(points, nonfinite="skip").report
        assert str(report).startswith(
            f"304 rows, 300 of them used in {report.n_triangles} triangles. Left out: 1 duplicate, "
            "2 overhangs (policy 'first'), 1 row skipped. "
        )
        assert str(report).endswith(f"heights {report.seconds['heights']:.3f}.")

    def test_nothing_left_out(self):
        text = str(triangulate(np.eye(3)).report)
        assert "3 rows, 3 of them used in 1 triangle. Left out: none. " in text
