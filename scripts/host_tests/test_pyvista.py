"""PyVista with liftmesh: its documented examples, its results, what its users stumbled on."""

from __future__ import annotations

import doctest
import importlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
import shapely
from conversions.comparing import DEEP, ROUNDED, losses
from conversions.drawn import clouds
from hypothesis import HealthCheck, assume, given, settings

import liftmesh
from liftmesh import Cloud, InputError
from liftmesh.plugins.pyvista import wrap

RNG = np.random.default_rng(39)
SCATTERED = np.column_stack([RNG.random((400, 2)) * 9, RNG.random(400)])
FLAT = SCATTERED * [1, 1, 0]
SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])


def dataset_of(points: np.ndarray) -> pyvista.PolyData:
    made = pyvista.PolyData(points)
    made.point_data["class"] = np.arange(len(points), dtype=np.int16)
    made.point_data["shift"] = RNG.random((len(points), 3), dtype=np.float32)
    made.field_data["crs"] = ["EPSG:25832"]
    made.cell_data["of a cell"] = np.arange(made.n_cells)
    return made


def cells_of(mesh: Any) -> set[frozenset[int]]:
    found = mesh.cells_dict[10] if hasattr(mesh, "cells_dict") else mesh.regular_faces
    return {*map(frozenset, found.tolist())}


def moved(points: np.ndarray, by: float) -> np.ndarray:
    return points + np.array([by, 0, 0])


def ring_data(*rings: np.ndarray) -> pyvista.PolyData:
    """Polygons as a dataset."""
    starts = np.cumsum([0, *map(len, rings)])
    faces = [
        [len(each), *range(start, start + len(each))]
        for each, start in zip(rings, starts, strict=False)
    ]
    return pyvista.PolyData(np.concatenate(rings), faces=np.concatenate(faces))


@pytest.mark.parametrize("name", ["liftmesh.plugins.pyvista", "liftmesh.io.objects.pyvista"])
def test_docstrings(name: str) -> None:
    told = doctest.testmod(importlib.import_module(name))
    assert (told.failed, told.attempted > 2) == (0, True)


class TestDelaunay2d:
    def test_documented_circle(self) -> None:
        circle = pyvista.PolyData(pyvista.Polygon(n_sides=30).points)
        filled = circle.liftmesh.delaunay_2d()
        assert (filled.n_cells, filled.n_points) == (28, 30)
        assert filled.area == pytest.approx(circle.delaunay_2d().area)

    def test_documented_constraints(self) -> None:
        square = pyvista.Polygon(n_sides=4, radius=8, fill=False).rotate_z(45, inplace=False)
        rings = [
            pyvista.Polygon(center=at, n_sides=30, radius=1) for at in ((2, 3, 0), (-2, -3, 0))
        ]
        whole = rings[0].append_polydata(rings[1], square)
        ours, theirs = (
            f(edge_source=whole) for f in (whole.liftmesh.delaunay_2d, whole.delaunay_2d)
        )
        assert ours.area == pytest.approx(theirs.area, rel=1e-12)
        assert ours.n_points == theirs.n_points == whole.n_points
        assert ours.points.dtype == whole.points.dtype == np.float32

    @pytest.mark.parametrize("turn", [None, (20, "x"), (90, "x"), (90, "y"), (-70, "y")])
    def test_triangles_are_those_of_pyvista(self, turn: Any) -> None:
        dataset = pyvista.PolyData(FLAT)
        if turn is not None:
            dataset = getattr(dataset, f"rotate_{turn[1]}")(turn[0], inplace=False)
        ours = dataset.liftmesh.delaunay_2d()
        assert cells_of(ours) == cells_of(dataset.delaunay_2d(tol=0, offset=1000))
        theirs = cells_of(dataset.delaunay_2d(tol=0))
        assert theirs < cells_of(ours)  # it is not convex by default

    def test_triangles_face_the_side_of_the_normal(self) -> None:
        for plane, normal in (("fit", [0, 0, 1]), ("xy", [0, 0, 1])):
            mesh = pyvista.PolyData(FLAT).liftmesh.delaunay_2d(plane=plane)
            assert (mesh.face_normals == np.array(normal, dtype=np.float32)).all()

    @pytest.mark.parametrize("alpha", [0.1, 0.3, 0.45, 2.0])
    def test_alpha(self, alpha: float) -> None:
        dataset = pyvista.PolyData(FLAT)
        ours = dataset.liftmesh.delaunay_2d(alpha=alpha)
        assert cells_of(ours) == cells_of(dataset.delaunay_2d(alpha=alpha, tol=0))

    def test_data_are_kept(self) -> None:
        dataset = dataset_of(SCATTERED.astype(np.float32))
        dataset.set_active_scalars("class")
        before = dataset.copy()
        mesh = dataset.liftmesh.delaunay_2d()
        assert np.array_equal(mesh.points, dataset.points)
        assert mesh.points.dtype == np.float32
        assert [*mesh.point_data] == ["class", "shift"]
        assert mesh.point_data["class"].dtype == np.int16
        assert mesh.active_scalars_name == "class"
        assert mesh.field_data["crs"].tolist() == ["EPSG:25832"]
        assert [*mesh.cell_data] == []
        mesh.points[:], mesh.point_data["class"][:] = 0, 0
        assert dataset == before

    def test_in_place(self) -> None:
        dataset = dataset_of(SCATTERED)
        expected = dataset.liftmesh.delaunay_2d()
        assert dataset.liftmesh.delaunay_2d(inplace=True) is dataset
        assert dataset == expected
        grid = pyvista.ImageData(dimensions=(4, 4, 1))
        assert grid.liftmesh.delaunay_2d().n_cells == 18
        with pytest.raises(InputError, match="a ImageData cannot become a PolyData: leave out"):
            grid.liftmesh.delaunay_2d(inplace=True)

    def test_tolerance(self) -> None:
        dataset = pyvista.PolyData(FLAT)
        mesh = dataset.liftmesh.delaunay_2d(tol=0.02)
        used = np.unique(mesh.regular_faces)
        near = liftmesh.delaunay(FLAT[used, :2])
        sides = FLAT[used][near.edges]
        assert 50 < len(used) < 400 == mesh.n_points
        assert np.hypot(*(sides[:, 0] - sides[:, 1]).T[:2]).min() >= 0.02 * dataset.length

    def test_points_at_one_position(self) -> None:
        twice = np.concatenate([FLAT, FLAT[:50]])
        mesh = pyvista.PolyData(twice).liftmesh.delaunay_2d()
        assert mesh.n_points == 450
        assert cells_of(mesh) == cells_of(pyvista.PolyData(FLAT).liftmesh.delaunay_2d())

    def test_offset_and_bound_change_nothing(self) -> None:
        dataset = pyvista.PolyData(FLAT)
        assert dataset.liftmesh.delaunay_2d() == dataset.liftmesh.delaunay_2d(offset=3, bound=True)

    def test_progress(self, capsys: pytest.CaptureFixture[str]) -> None:
        pyvista.PolyData(FLAT).liftmesh.delaunay_2d(progress_bar=True)
        pyvista.PolyData(SCATTERED).liftmesh.delaunay_3d(progress_bar=True)
        told = capsys.readouterr().out
        assert "2D triangulation" in told
        assert "3D triangulation" in told

    @pytest.mark.parametrize(
        ("rings", "area"),
        [
            ([SQUARE * 3], 36),
            ([SQUARE * 3, SQUARE[::-1]], 32),
            ([SQUARE * 3, moved(SQUARE[::-1], 1.5), moved(SQUARE[::-1] / 2, -1.5)], 31),
            ([SQUARE, moved(SQUARE, 4)], 8),
        ],
    )
    def test_polygons(self, rings: list[np.ndarray], area: float) -> None:
        source = ring_data(*rings)
        mesh = source.liftmesh.delaunay_2d(edge_source=source)
        assert mesh.area == area
        assert mesh.liftmesh.verify(edge_source=source).valid

    @pytest.mark.parametrize("step", [1, -1])
    def test_a_star_given_either_way_round(self, step: int) -> None:
        """Its inside one way, as a hole the other: pyvista#4623 saw neither."""
        turns = np.arange(8) * np.pi / 4
        radius = np.where(np.arange(8) % 2, 1.0, 5.0)
        star = np.column_stack([radius * np.cos(turns), radius * np.sin(turns), 0 * turns])[::step]
        source = ring_data(star)
        mesh = pyvista.PolyData(star).liftmesh.delaunay_2d(edge_source=source)
        whole = pyvista.PolyData(star).liftmesh.delaunay_2d().area
        inside = 10 * 2**0.5
        assert mesh.area == pytest.approx(inside if step == 1 else whole - inside)

    def test_lines_and_polygons_of_two_points(self) -> None:
        kite = np.array([[0.0, 0, 0], [4, -1, 0], [8, 0, 0], [4, 1, 0]])
        plain = pyvista.PolyData(kite)
        given = [
            pyvista.PolyData(kite, lines=[2, 0, 2]),
            pyvista.PolyData(kite, lines=[3, 0, 2, 3]),
            pyvista.PolyData(kite, faces=[2, 0, 2]),
            pyvista.PolyData(kite, faces=[3, 0, 2, 0]),
        ]
        for source in given:
            mesh = plain.liftmesh.delaunay_2d(edge_source=source)
            assert cells_of(mesh) == {frozenset({0, 1, 2}), frozenset({0, 2, 3})}
        assert cells_of(plain.liftmesh.delaunay_2d()) == {
            frozenset({0, 1, 3}),
            frozenset({1, 2, 3}),
        }

    def test_a_ring_of_many_corners(self) -> None:
        turn = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
        radius = 5 + RNG.random(len(turn))
        ring = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 0 * turn])
        source = ring_data(ring)
        mesh = source.liftmesh.delaunay_2d(edge_source=source)
        assert mesh.n_cells == 2998
        assert mesh.liftmesh.verify(edge_source=source).valid

    def test_many_points(self) -> None:
        """PyVista's filter ended the process from 300,000 on: pyvista#4898."""
        points = np.column_stack([RNG.random((300_000, 2)), np.zeros(300_000)])
        mesh = pyvista.PolyData(points).liftmesh.delaunay_2d()
        assert mesh.liftmesh.verify().canonical

    def test_far_from_the_origin(self) -> None:
        grid = np.stack(np.meshgrid(np.arange(30.0), np.arange(30.0), [0]), axis=-1).reshape(-1, 3)
        far = pyvista.PolyData(grid / 1024 + [4.5e6, 5.2e6, 0])
        assert far.liftmesh.delaunay_2d().n_cells == 2 * 29 * 29

    @pytest.mark.parametrize(
        ("points", "options", "message"),
        [
            (SQUARE[:2], {}, "2 finite rows: it needs three"),
            (SQUARE * [1, 0, 0], {}, "line"),
            (moved(SQUARE, np.nan), {}, "row 0"),
            (SQUARE, {"alpha": -1}, "alpha is -1"),
            (SQUARE, {"tol": "a"}, "tol is 'a'"),
            (SQUARE, {"inplace": 3}, "inplace is 3"),
            (SQUARE, {"progress_bar": None}, "progress_bar is None"),
            (SQUARE, {"edge_source": 3}, "edge_source is a int: give a PolyData that has"),
            (SQUARE, {"edge_source": pyvista.PolyData(FLAT)}, "400 points for 4 of the dataset"),
            (SQUARE, {"edge_source": ring_data(SQUARE), "tol": 0.1}, "could leave out ends"),
            (SQUARE, {"edge_source": pyvista.PolyData(SQUARE, lines=[2, 0, 2, 2, 1, 3])}, "cross"),
            (SQUARE, {"plane": "zz"}, "plane 'zz' is unknown"),
        ],
    )  # fmt: skip
    def test_errors(self, points: np.ndarray, options: dict[str, Any], message: str) -> None:
        with pytest.raises(InputError, match=message):
            pyvista.PolyData(points).liftmesh.delaunay_2d(**options)


class TestDelaunay3d:
    def test_tetrahedra_are_those_of_pyvista(self) -> None:
        dataset = dataset_of(RNG.random((200, 3)))
        ours, theirs = dataset.liftmesh.delaunay_3d(), dataset.delaunay_3d(tol=0, offset=1e5)
        assert cells_of(ours) == cells_of(theirs)
        assert ours.compute_cell_sizes()["Volume"].min() > 0
        assert [*ours.point_data] == ["class", "shift"]
        assert ours.liftmesh.verify().canonical

    def test_lattices_and_their_outer_surface(self) -> None:
        """Tetrahedra on grids are flat or overlap elsewhere; pyvista#632 asks for the surface."""
        grid = pyvista.ImageData(dimensions=(6, 6, 6)).liftmesh.delaunay_3d()
        assert grid.compute_cell_sizes()["Volume"].min() > 0
        assert grid.volume == pytest.approx(125)
        surface = grid.extract_surface(algorithm=None)
        assert (surface.n_open_edges, surface.is_manifold) == (0, True)
        assert surface.volume == pytest.approx(125)

    @pytest.mark.parametrize("alpha", [0.1, 0.15, 0.3])
    def test_alpha(self, alpha: float) -> None:
        dataset = pyvista.PolyData(RNG.random((200, 3)))
        ours = dataset.liftmesh.delaunay_3d(alpha=alpha)
        assert cells_of(ours) == cells_of(dataset.delaunay_3d(alpha=alpha, tol=0, offset=1e5))
        found = liftmesh.tetrahedralize(dataset.points).alpha_complex(alpha)
        sides = {frozenset(c - {k}) for c in cells_of(ours) for k in c}
        alone = {*map(frozenset, ours.cells_dict.get(5, np.empty((0, 3), int)).tolist())}
        assert alone.isdisjoint(sides)
        assert alone <= {*map(frozenset, found.triangles.tolist())} <= alone | sides
        lines = {*map(frozenset, ours.cells_dict.get(3, np.empty((0, 2), int)).tolist())}
        covered = {frozenset(t - {k}) for t in alone | sides for k in t}
        assert {*map(frozenset, found.edges.tolist())} == lines | (
            covered & {*map(frozenset, found.edges.tolist())}
        )
        assert lines.isdisjoint(covered)

    def test_errors(self) -> None:
        for options, message in (({"tol": 0.1}, "tol is 0.1"), ({"alpha": -1}, "alpha is -1")):
            with pytest.raises(InputError, match=message):
                pyvista.PolyData(SCATTERED).liftmesh.delaunay_3d(**options)
        with pytest.raises(liftmesh.DegenerateInputError):
            pyvista.PolyData(FLAT).liftmesh.delaunay_3d()


class TestTerrain:
    def test_is_the_surface_of_liftmesh(self) -> None:
        dataset = dataset_of(SCATTERED)
        mesh = dataset.liftmesh.terrain(max_edge=1, boundary_only=True)
        surface = liftmesh.triangulate(SCATTERED).trim(max_edge=1, boundary_only=True)
        assert np.array_equal(mesh.regular_faces, surface.faces)
        assert np.array_equal(mesh.points, SCATTERED)
        assert np.array_equal(mesh["shift"], dataset["shift"])
        assert mesh.field_data["crs"].tolist() == ["EPSG:25832"]
        assert liftmesh.triangulate(dataset).crs == "EPSG:25832"
        assert mesh.liftmesh.verify().n_rows == 400

    def test_breaklines(self) -> None:
        line = [[0, 4, 5], [9, 4, 5]]
        mesh = dataset_of(SCATTERED).liftmesh.terrain(breaklines=line)
        assert mesh.n_points > 400
        assert mesh.liftmesh.sample([[4, 4]])["height"].tolist() == [5.0]
        with pytest.raises(InputError, match="nothing is asked for: give max_edge"):
            dataset_of(SCATTERED).liftmesh.terrain(boundary_only=True)

    def test_sample(self) -> None:
        dataset = dataset_of(SCATTERED)
        dataset["steep"] = 2 * SCATTERED[:, 0] + 1
        mesh = dataset.liftmesh.terrain()
        asked = pyvista.PolyData(np.array([[4.0, 5, 77], [-3, 0, 0]]))
        asked["name"] = ["inside", "outside"]
        asked["class"] = [7, 8]
        found = mesh.liftmesh.sample(asked)
        assert np.array_equal(found.points, asked.points)
        assert found["name"].tolist() == ["inside", "outside"]
        assert found["steep"][0] == pytest.approx(9)
        assert found["height"][0] == liftmesh.triangulate(SCATTERED).sample([4, 5])
        assert found["shift"].shape == (2, 3)
        assert np.isnan([found["height"][1], found["steep"][1]]).all()
        near = mesh.liftmesh.sample([[-3, 0]], "nearest", extrapolate="nearest")
        assert near["class"][0] in range(400)
        assert [*asked.point_data] == ["name", "class"]
        of_points = dataset.liftmesh.sample([[4.0, 5.0]])
        assert of_points["height"][0] == found["height"][0]

    def test_contours(self) -> None:
        mesh = dataset_of(SCATTERED).liftmesh.terrain()
        lines = mesh.liftmesh.contours(interval=0.25)
        expected = liftmesh.triangulate(SCATTERED).contours(interval=0.25)
        assert lines.n_cells == len(expected) == lines.n_lines
        assert np.array_equal(lines["level"], expected.levels)
        sizes = lines.compute_cell_sizes(length=True)["Length"]
        assert np.allclose(sizes, expected.lengths)
        assert [*np.unique(lines.points[:, 2])] == [*np.unique(expected.levels)]
        assert mesh.liftmesh.contours([99]).n_cells == 0

    def test_voronoi(self) -> None:
        dataset = dataset_of(np.concatenate([SCATTERED, SCATTERED[:3]]))
        cells = dataset.liftmesh.voronoi((0, 0, 9, 9))
        assert cells.n_cells == 400
        assert cells.area == pytest.approx(81)
        assert np.array_equal(cells["height"], SCATTERED[:, 2])
        assert np.array_equal(cells["class"], cells["row"])
        pond = {
            "type": "Polygon",
            "coordinates": [
                [[0, 0], [9, 0], [9, 9], [0, 9], [0, 0]], [[4, 4], [4, 5], [5, 5], [5, 4], [4, 4]]
            ],
        }  # fmt: skip
        two = pyvista.PolyData(np.array([[1.0, 1, 0], [4.4, 4.4, 0]]))
        for points in (dataset, two):
            cells = points.liftmesh.voronoi(pond)
            shapes = [
                shapely.Polygon(cells.get_cell(k).points[:, :2]) for k in range(cells.n_cells)
            ]
            assert shapely.is_valid(shapes).all()
            assert shapely.area(shapes).sum() == pytest.approx(80)
            assert shapely.union_all(shapes).area == pytest.approx(80)

    def test_verify(self) -> None:
        mesh = pyvista.PolyData(np.array([[0.0, 0, 0], [4, -1, 0], [8, 0, 0], [4, 1, 0]]))
        with pytest.raises(InputError, match="has no triangles to verify"):
            mesh.liftmesh.verify()
        mesh.faces = [3, 0, 1, 2, 3, 0, 2, 3]
        assert mesh.liftmesh.verify().flaws[0].kind == "not_delaunay"
        upright = mesh.rotate_x(90, inplace=False)
        assert not upright.liftmesh.verify(plane="fit").valid
        assert upright.liftmesh.delaunay_2d().liftmesh.verify(plane="fit").valid


class TestObjects:
    @settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow], deadline=None)
    @given(clouds())
    def test_clouds_come_back(self, cloud: Cloud) -> None:
        held = {k: v for k, v in cloud.attributes.items() if v.size and v.ndim < 3}
        cloud = replace(cloud, attributes=held, metadata={})
        assume(len(cloud))  # PyVista has no arrays without values
        try:
            made = wrap(cloud)
        except InputError as error:
            if "PyVista" not in str(error):
                raise
            return
        lost = losses(cloud, liftmesh.as_cloud(made))
        assert lost <= {f"type of {name}" for name in held} | {DEEP, ROUNDED}

    def test_normals_that_are_none(self) -> None:
        dataset = pyvista.PolyData(SQUARE)
        dataset["Normals"], dataset["RGB"] = np.arange(4), np.zeros((4, 3))
        cloud = liftmesh.as_cloud(dataset)
        assert (cloud.normals, cloud.colors, [*cloud.attributes]) == (
            None,
            None,
            ["Normals", "RGB"],
        )

    def test_no_points(self) -> None:
        cloud = Cloud(np.empty((0, 3)), normals=np.empty((0, 3)), attributes={"a": np.empty(0)})
        assert wrap(cloud).n_points == 0

    def test_other_cells(self) -> None:
        quads = pyvista.Plane(i_resolution=3, j_resolution=2)
        assert len(liftmesh.as_cloud(quads).faces) == 12
        strip = pyvista.PolyData(SQUARE[[0, 1, 3, 2]], strips=[4, 0, 1, 2, 3])
        assert len(liftmesh.as_cloud(strip).faces) == 2
        assert liftmesh.as_cloud(pyvista.ImageData(dimensions=(3, 3, 1))).faces is None
        grid = pyvista.PolyData(FLAT).liftmesh.delaunay_2d().cast_to_unstructured_grid()
        assert len(liftmesh.as_surface(grid).faces) == len(grid.cells_dict[5])
        assert liftmesh.as_cloud(dataset_of(FLAT)).metadata["not_read"] == ("cell data of a cell",)

    def test_values_that_pyvista_does_not_hold(self) -> None:
        for values in (np.zeros(4, "M8[D]"), np.zeros(4, "c16")):
            with pytest.raises(InputError, match=r"'day' are of .* which PyVista holds"):
                wrap(Cloud(SQUARE, attributes={"day": values}))
        for name in ("", "a\0b", "\ud800"):
            with pytest.raises(InputError, match="as none can be in PyVista: rename them"):
                wrap(Cloud(SQUARE, attributes={name: np.zeros(4)}))
        for name in ("Normals", "RGB"):
            cloud = Cloud(
                SQUARE, attributes={name: np.zeros(4)}, normals=SQUARE,
                colors=np.zeros((4, 3), np.uint8),
            )  # fmt: skip
            with pytest.raises(InputError, match=f"named '{name}', as PyVista's own: rename it"):
                wrap(cloud)


class TestFiles:
    @pytest.mark.parametrize("suffix", ["liftmesh-ply", "landxml", "npz", "2dm", "dxf"])
    def test_every_bit_comes_back(self, suffix: str, tmp_path: Path) -> None:
        mesh = dataset_of(SCATTERED * 1e5 + 0.1).liftmesh.terrain()
        mesh.save(path := tmp_path / f"mesh.{suffix}")
        back = pyvista.read(path)
        used = (back.regular_faces, mesh.regular_faces)
        assert np.array_equal(back.points[used[0]], mesh.points[used[1]])
        if suffix in {"liftmesh-ply", "npz"}:
            assert np.array_equal(back["class"], mesh["class"])
            assert back.liftmesh.verify().points_sha256 == mesh.liftmesh.verify().points_sha256

    def test_ply_by_its_own_suffix(self, tmp_path: Path) -> None:
        mesh = dataset_of(SCATTERED + 1e6).liftmesh.terrain()
        mesh.liftmesh.save(path := tmp_path / "mesh.ply")
        exact = pyvista.read(path, force_ext=".liftmesh-ply")
        assert np.array_equal(exact.points, mesh.points)
        assert np.array_equal(exact["class"], mesh["class"])
        own = pyvista.read(path)
        assert own.points.dtype == np.float32
        assert "class" not in own.point_data

    def test_lidar(self, tmp_path: Path) -> None:
        points = pyvista.PolyData(np.round(SCATTERED, 3))
        points["classification"] = np.repeat([2, 5], 200).astype(np.uint8)
        points.save(path := tmp_path / "cloud.laz")
        assert pyvista.read(path).n_points == 400
        assert pyvista.read(path, classes=[2]).n_points == 200
