"""`view`: which layers a page has of results."""

from __future__ import annotations

import json

import numpy as np
import pytest
from commands import liftmesh as command
from page_reader import read

import liftmesh
from liftmesh import InputError, UnsupportedTypeError
from liftmesh.viewer import layers

SQUARE = np.array([[0, 0, 5], [4, 0, 6], [0, 4, 7], [4, 4, 8], [2, 1, 9.0]])
RNG = np.random.default_rng(40)


def layers_of(*shown, **options):
    return liftmesh.view(*shown, **options).layers


def test_a_surface_shows_faces_heights_colours_and_values():
    cloud = liftmesh.Cloud(
        SQUARE,
        colors=np.arange(15, dtype=np.uint8).reshape(5, 3),
        attributes={"intensity": np.arange(5), "name": np.array([*"abcde"])},
        crs="EPSG:25832",
    )
    page = liftmesh.triangulate(cloud).view(title="Square")
    (layer,) = page.layers
    assert layer.kind == "faces"
    assert np.array_equal(layer.points, SQUARE)
    assert [each.name for each in layer.values] == ["height", "intensity"]
    assert layer.colors.tolist() == cloud.colors.tolist()
    header = read(page)
    assert header["title"] == "Square"
    assert header["unit"] == "metre"
    assert header["notes"] == ["4 faces", "ETRS89 / UTM zone 32N"]


def test_rows_that_no_face_uses_are_left_out_and_others_keep_their_number():
    rows = np.vstack([[np.nan] * 3, SQUARE, SQUARE[:1]])
    surface = liftmesh.triangulate(rows, nonfinite="skip")
    (layer,) = layers_of(surface)
    assert layer.rows.tolist() == [1, 2, 3, 4, 5]
    assert np.array_equal(rows[layer.rows], layer.points)
    assert np.array_equal(layer.rows[layer.cells], surface.faces)


def test_large_surfaces_are_simplified_within_a_bound_that_is_told(monkeypatch):
    monkeypatch.setattr(layers, "MOST_FACES", 200)
    rows = np.column_stack([RNG.random((2000, 2)) * 100, RNG.random(2000)])
    surface = liftmesh.triangulate(rows)
    (layer,) = layers_of(surface)
    assert len(layer.cells) <= 200
    assert np.array_equal(rows[layer.rows], layer.points)
    assert layer.note.startswith("simplified from 2,000 points")
    bound = float(layer.note.rsplit(maxsplit=1)[1])
    shown = liftmesh.as_surface(liftmesh.Cloud(layer.points, faces=layer.cells.astype(np.int32)))
    assert 0.99 * bound <= np.nanmax(abs(shown.sample(rows[:, :2]) - rows[:, 2])) <= 1.01 * bound
    assert [each.name for each in layer.values] == ["height"]


def test_of_many_points_some_are_shown(monkeypatch):
    monkeypatch.setattr(layers, "MOST_POINTS", 100)
    rows = RNG.random((250, 3))
    rows[7] = np.inf
    (layer,) = layers_of(liftmesh.Cloud(rows))
    assert layer.kind == "points"
    assert len(layer.points) == 83
    assert np.array_equal(rows[layer.rows], layer.points)
    assert layer.note == "one in 3 of 249 points"


def test_two_surfaces_show_how_much_the_second_is_higher():
    before, after = SQUARE, np.add(SQUARE, [0, 0, 2])
    after[4, 2] = 6
    surfaces = [liftmesh.triangulate(each) for each in (before, after)]
    rise, *both = layers_of(*surfaces, names=["before", "after"])
    assert [each.name for each in both] == ["before", "after"]
    assert not any(each.style["visible"] for each in both)
    (amounts,) = rise.values
    differences = liftmesh.difference(surfaces[1], surfaces[0]).sample(rise.points[:, :2])
    assert np.allclose(amounts.numbers, differences)
    assert np.allclose(rise.points[:, 2], surfaces[1].sample(rise.points[:, :2]))
    assert min(np.round(amounts.numbers[:], 6)) == -3


def test_two_surfaces_apart_are_shown_beside_each_other():
    one, other = (liftmesh.triangulate(np.add(SQUARE, [shift, 0, 0])) for shift in (0, 100))
    assert [each.style for each in layers_of(one, other)] == [{}, {}]


def test_surfaces_without_a_difference_say_why() -> None:
    surface = liftmesh.triangulate(SQUARE)
    first, _ = layers_of(surface, liftmesh.triangulate(np.add(SQUARE, [100, 0, 0])))
    assert first.note == "the surfaces have no area in common"


def test_objects_have_one_system() -> None:
    one, other = (liftmesh.Cloud(SQUARE, crs=f"EPSG:{n}") for n in (25832, 25833))
    assert read(liftmesh.view(SQUARE, one, names=["a", "b"]))["unit"] == "metre"
    with pytest.raises(InputError, match=r"first are in .*32N', and second in .*33N"):
        liftmesh.view(one, other, names=["first", "second"])


def test_cells_at_points_that_are_not_finite_are_left_out_and_counted() -> None:
    rows = np.vstack([SQUARE, [[np.nan, 0, 0]]])
    faces = np.array([[0, 1, 4], [0, 4, 5], [1, 3, 4]], np.int32)
    edges = np.array([[0, 5], [0, 1]], np.int32)
    page = liftmesh.view(liftmesh.Cloud(rows, faces=faces, edges=edges))
    mesh, lines = page.layers
    assert mesh.rows[mesh.cells].tolist() == [[0, 1, 4], [1, 3, 4]]
    assert mesh.note == "without 1 cell at points that are not finite"
    assert len(lines.cells) == 1
    assert np.isfinite(read(page)["origin"]).all()


def test_what_is_too_large_for_a_browser_is_refused(monkeypatch) -> None:
    monkeypatch.setattr(layers, "MOST_CELLS", 2)
    with pytest.raises(InputError, match="Triangulation has 4 faces, and a page holds 2: give a"):
        liftmesh.view(liftmesh.delaunay(SQUARE[:, :2]))


def test_breaklines_are_lines():
    surface = liftmesh.triangulate(SQUARE, breaklines=[[[0, 0, 5], [4, 4, 8]]])
    faces, edges = layers_of(surface)
    assert (faces.kind, edges.kind) == ("faces", "lines")
    constrained = liftmesh.constrained_delaunay(SQUARE[:, :2], edges=[[0, 3]])
    triangles, forced = layers_of(constrained)
    assert (triangles.kind, forced.kind) == ("faces", "lines")
    assert len(forced.points) == 2


def test_the_lift_stands_on_its_paraboloid_above_its_shadow():
    points = RNG.random((30, 2))
    tri = liftmesh.delaunay(points)
    hull, edges, shadow, below, lifted, paraboloid, circles, falls = layers_of(tri.lifted())
    x, y, z = paraboloid.points.T
    apex = tri.lifted().apex
    assert np.allclose(z, (x - apex[0]) ** 2 + (y - apex[1]) ** 2)
    assert np.array_equal(shadow.points[:, :2], edges.points[:, :2])
    assert len(np.unique(shadow.points[:, 2])) == 1
    assert shadow.points[0, 2] < hull.points[:, 2].min()
    assert {*map(tuple, np.sort(edges.cells))} == {*map(tuple, np.sort(tri.edges))}
    assert len(falls.cells) == len(below.points) == len(lifted.points) == 30
    assert len(circles.cells)


def test_a_lower_hull_of_other_points_is_a_mesh():
    (layer,) = layers_of(liftmesh.lower_hull(SQUARE))
    assert layer.kind == "faces"


def test_cells_are_rings_and_sites():
    cells = liftmesh.voronoi(SQUARE[:, :2], domain=(-1, -1, 5, 5))
    rings, sites = layers_of(cells)
    assert len(rings.cells) == len(cells.corners)
    lengths = np.linalg.norm(np.diff(rings.points[rings.cells], axis=1), axis=2).sum()
    each = liftmesh.voronoi(SQUARE[:, :2], domain=(-1, -1, 5, 5)).to_shapely()
    assert np.isclose(lengths, sum(polygon.length for polygon in each))
    assert np.array_equal(sites.points[:, :2], cells.points)


def test_tetrahedra_know_their_neighbours_also_those_of_files(tmp_path):
    tetra = liftmesh.tetrahedralize(RNG.random((60, 3)))
    (layer,) = layers_of(tetra)
    assert layer.kind == "tetrahedra"
    assert np.array_equal(layer.neighbors, tetra.neighbors)
    (of_file,) = layers_of(layers.Mesh(tetra.points, tetra.simplices))
    assert np.array_equal(of_file.neighbors, tetra.neighbors)


def test_hulls_and_meshes_of_other_libraries_are_shown():
    hull = liftmesh.convex_hull(RNG.random((40, 3)))
    (own,) = layers_of(hull)
    (other,) = layers_of(hull.to_trimesh())
    assert own.kind == other.kind == "faces"
    assert len(own.cells) == len(other.cells)


def test_what_cannot_be_shown_is_told():
    with pytest.raises(InputError, match="nothing to show: give"):
        liftmesh.view()
    with pytest.raises(InputError, match="nothing to show: no row is finite"):
        liftmesh.view(liftmesh.Cloud(np.full((2, 3), np.nan)))
    with pytest.raises(InputError, match="names has 1 name for 2 objects"):
        liftmesh.view(SQUARE, SQUARE, names=["one"])
    with pytest.raises(UnsupportedTypeError):
        liftmesh.view(object())


def test_the_command_writes_a_page(tmp_path):
    liftmesh.write(tmp_path / "a.ply", liftmesh.triangulate(SQUARE))
    liftmesh.write(tmp_path / "b.ply", liftmesh.triangulate(np.add(SQUARE, [0, 0, 1])))
    done = command("view", "a.ply", "b.ply", "-o", "page.html", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["layers"] == ["how much the second is higher", "a.ply", "b.ply"]
    again = command("view", "a.ply", "-o", "page.html", cwd=tmp_path)
    assert "--overwrite" in again.stderr
    assert command("view", "a.ply", cwd=tmp_path).stdout.startswith("a.html: 1 layer")


def test_the_command_shows_meshes_that_are_no_surface_and_points(tmp_path):
    hull = liftmesh.convex_hull(RNG.random((40, 3)))
    hull.save(tmp_path / "hull.ply")
    done = command("view", "hull.ply", cwd=tmp_path)
    assert "shown as it is" in done.stderr
    assert done.stdout.startswith("hull.html: 1 layer")
    liftmesh.write(tmp_path / "cloud.ply", liftmesh.Cloud(SQUARE))
    assert command("view", "cloud.ply", "--points", cwd=tmp_path).returncode == 0
    liftmesh.tetrahedralize(RNG.random((20, 3))).save(tmp_path / "t.vtu")
    assert command("view", "t.vtu", cwd=tmp_path).stdout.startswith("t.html: 1 layer")
    refused = command("view", "-", cwd=tmp_path)
    assert "--output" in refused.stderr
