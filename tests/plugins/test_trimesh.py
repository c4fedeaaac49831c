"""trimesh with the files and polygons of liftmesh, and without them again."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import laspy
import numpy as np
import pytest
import trimesh
from shapely import Point, Polygon, affinity, box
from trimesh.exchange.load import mesh_loaders

import liftmesh
from liftmesh.plugins.trimesh import register, unregister

RNG = np.random.default_rng(3)
ROWS = np.column_stack([RNG.random((60, 2)) * 1e6 + 0.1, RNG.random(60)])


@pytest.fixture(autouse=True)
def registered() -> Iterator[None]:
    before = {**mesh_loaders}, trimesh.creation.triangulate_polygon
    register()
    register()
    yield
    unregister()
    unregister()
    assert (mesh_loaders, trimesh.creation.triangulate_polygon) == before


@pytest.mark.parametrize("suffix", ["npz", "xyz", "ply"])
def test_files_keep_every_bit(suffix: str, tmp_path: Path) -> None:
    surface = liftmesh.triangulate(liftmesh.Cloud(ROWS, attributes={"intensity": ROWS[:, 2] * 2}))
    cloud = surface.to_cloud() if suffix == "ply" else liftmesh.Cloud(ROWS)
    liftmesh.write(tmp_path / f"hill.{suffix}", cloud)
    loaded = trimesh.load(tmp_path / f"hill.{suffix}")
    assert np.array_equal(loaded.vertices, ROWS)
    if suffix == "ply":
        assert np.array_equal(loaded.faces, surface.faces)
        assert np.array_equal(loaded.vertex_attributes["intensity"], ROWS[:, 2] * 2)
        assert isinstance(loaded, trimesh.Trimesh)
        merged = trimesh.load(tmp_path / "hill.ply", process=True)
        assert len(merged.vertices) == len(ROWS)
        return
    assert isinstance(loaded, trimesh.PointCloud)


def test_lidar_to_surface(tmp_path: Path) -> None:
    las = laspy.create(point_format=3)
    las.x, las.y, las.z = ROWS.T
    las.classification = [2] * 40 + [5] * 20
    las.write(path := tmp_path / "hill.las")
    ground = trimesh.load(path, classes=[2])
    assert len(ground.vertices) == 40
    surface = liftmesh.triangulate(ground)
    mesh = surface.to_trimesh()
    section = mesh.section(plane_origin=[5e5, 0, 0], plane_normal=[1, 0, 0])
    line = surface.profile([[5e5, -1e6], [5e5, 2e6]]).points
    assert section.length == pytest.approx(np.hypot.reduce(np.diff(line, axis=0), axis=1).sum())


def test_polygons_of_all_functions() -> None:
    ring = Point(0, 0).buffer(2).difference(Point(0, 0).buffer(1))
    solid = trimesh.creation.extrude_polygon(ring, height=3)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(3 * ring.area)
    half = trimesh.creation.box().slice_plane([0, 0, 0.1], [0, 0, 1], cap=True)
    assert half.is_watertight
    assert half.volume == pytest.approx(0.4)
    vertices, faces = trimesh.creation.triangulate_polygon(ring)
    check_delaunay(ring, vertices, faces)
    named = trimesh.creation.triangulate_polygon(ring, engine="liftmesh")
    assert all(map(np.array_equal, named, (vertices, faces)))
    with pytest.raises(ValueError, match="No available triangulation engine"):
        trimesh.creation.triangulate_polygon(ring, engine="none of them")


def check_delaunay(shape: Polygon, vertices: np.ndarray, faces: np.ndarray) -> None:
    """The triangles fill a polygon, and are constrained Delaunay."""
    row = {tuple(each): number for number, each in enumerate(vertices.tolist())}
    edges = []
    for ring in (shape.exterior, *shape.interiors):
        rows = [row[corner] for corner in ring.coords]
        edges += pairwise(rows)
    assert liftmesh.verify(vertices, faces, constraints=edges, carved=True).valid
    a, b, c = vertices[faces].transpose(1, 0, 2)
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert doubled.sum() / 2 == pytest.approx(shape.area)


class TestTriangulatePolygon:
    SHAPE = Polygon([(0, 0), (6, 0), (6, 6), (0, 6)], [[(0, 3), (2, 2), (2, 4)]])

    def test_corners_once_and_counter_clockwise(self) -> None:
        vertices, faces = liftmesh.triangulate_polygon(self.SHAPE)
        assert (vertices.dtype, faces.dtype) == (np.float64, np.int64)
        assert {*map(tuple, vertices.tolist())} == {
            *self.SHAPE.exterior.coords, *self.SHAPE.interiors[0].coords
        }  # fmt: skip
        assert len(vertices) == 7
        a, b, c = vertices[faces].transpose(1, 0, 2)
        doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        assert (doubled > 0).all()
        assert doubled.sum() / 2 == self.SHAPE.area

    def test_quality_and_area(self) -> None:
        for options in ({"quality": 30, "max_area": 0.5}, {"triangle_args": "pq30a0.5"}):
            vertices, faces = liftmesh.triangulate_polygon(self.SHAPE, **options)
            mesh = trimesh.Trimesh(np.column_stack([vertices, 0 * vertices[:, 0]]), faces)
            assert mesh.area_faces.max() <= 0.5
            assert mesh.area == pytest.approx(self.SHAPE.area)
            assert np.degrees(mesh.face_angles.min()) > 25  # but where the polygon has less
        few, more = (
            len(liftmesh.triangulate_polygon(self.SHAPE, switches)[0]) for switches in ("p", "pqD")
        )
        assert few == 7 < more

    def test_points_inside(self) -> None:
        inside = [(1, 1), (4, 3), (1, 1), (6, 3)]
        vertices, faces = liftmesh.triangulate_polygon(self.SHAPE, steiner=inside)
        assert vertices[:3].tolist() == [[1, 1], [4, 3], [6, 3]]
        assert len(vertices) == 10
        assert np.unique(faces).tolist() == [*range(10)]
        with pytest.raises(liftmesh.InputError, match=r"steiner: row 1, \(1\.0, 3\.0\), is out"):
            liftmesh.triangulate_polygon(self.SHAPE, steiner=[(1, 1), (1, 3)])

    def test_nothing(self) -> None:
        for nothing in (None, Polygon()):
            vertices, faces = liftmesh.triangulate_polygon(nothing)
            assert (vertices.shape, faces.shape) == ((0, 2), (0, 3))

    def test_a_large_ring(self) -> None:
        turn = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
        radius = 5 + RNG.random(len(turn))
        ring = Polygon(np.column_stack([radius * np.cos(turn), radius * np.sin(turn)]))
        vertices, faces = liftmesh.triangulate_polygon(ring)
        assert len(faces) == len(vertices) - 2
        check_delaunay(ring, vertices, faces)

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"engine": "earcut"}, "engine is 'earcut': not liftmesh: call trimesh"),
            ({"triangle_args": "pY"}, "triangle_args is 'pY': none of p, q, a and D"),
            ({"quality": 30, "force_vertices": True}, "force_vertices allows no vertices"),
            ({"steiner": [(1, 1)], "force_vertices": True}, "force_vertices allows no vertices"),
            ({"max_area": -1.0}, "max_area"),
        ],
    )
    def test_errors(self, options: dict, message: str) -> None:
        with pytest.raises(liftmesh.InputError, match=message):
            liftmesh.triangulate_polygon(self.SHAPE, **options)
        with pytest.raises(liftmesh.CrossingError, match="crosses"):
            liftmesh.triangulate_polygon(Polygon([(0, 0), (2, 2), (2, 0), (0, 2)]))
        with pytest.raises(liftmesh.InputError, match="polygons are 3"):
            liftmesh.triangulate_polygon(3)

    def test_quarter_turns(self) -> None:
        shape = self.SHAPE.union(affinity.rotate(box(8, 8, 9, 9), 45))
        _, faces = liftmesh.triangulate_polygon(shape)
        assert len(faces) == 8
