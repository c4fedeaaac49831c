"""Meshes made or edited elsewhere as surfaces: what these are asked, beside matplotlib and shapely.

One is smoothed by trimesh, one is subdivided, one is trimmed, with a gap, and one is a list of
triangles that share no vertices and turn either way.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib.tri
import numpy as np
import pytest
import shapely
import trimesh
from commands import liftmesh as run

import liftmesh
from liftmesh import Cloud, InputError


def waves(count: int = 14) -> liftmesh.Surface:
    rng = np.random.default_rng(4)
    x, y = (each.ravel() for each in np.mgrid[:count, :count].astype(float))
    places = np.column_stack([x, y]) + rng.uniform(-0.3, 0.3, (count**2, 2))
    heights = np.sin(places[:, 0] / 2) * 3 + np.cos(places[:, 1] / 3) * 2
    surface = liftmesh.triangulate(np.column_stack([places, heights]))
    return surface.trim(max_edge=3, boundary_only=True)


def smoothed() -> trimesh.Trimesh:
    """Smooth the inside by trimesh, and stretch it, which leaves few sides Delaunay."""
    surface = waves()
    mesh = trimesh.Trimesh(surface.vertices, surface.faces, process=False)
    rim = np.concatenate(surface.boundary()).tolist()
    operator = trimesh.smoothing.laplacian_calculation(mesh, pinned_vertices=rim)
    trimesh.smoothing.filter_laplacian(mesh, 0.4, iterations=3, laplacian_operator=operator)
    mesh.vertices *= (3, 1, 1)
    return mesh


def gapped() -> Cloud:
    mesh = smoothed()
    centres = mesh.triangles_center[:, :2]
    gap = (np.abs(centres - [20, 6]) < [6, 2]).all(axis=1)
    islands = (np.abs(centres - [20, 6]) < [2, 1]).all(axis=1)
    return Cloud(np.array(mesh.vertices), faces=np.array(mesh.faces)[~gap | islands])


def soup() -> Cloud:
    mesh = smoothed()
    corners = np.array(mesh.triangles)
    corners[::3] = corners[::3, ::-1]
    count = len(corners) * 3
    values = {"part": np.arange(count) // 3}
    return Cloud(corners.reshape(-1, 3), faces=np.arange(count).reshape(-1, 3), attributes=values)


MESHES = {
    "smoothed": lambda: Cloud(np.array(smoothed().vertices), faces=np.array(smoothed().faces)),
    "subdivided": lambda: liftmesh.as_cloud(smoothed().subdivide()),
    "gapped": gapped,
    "soup": soup,
}


@pytest.fixture(params=MESHES)
def mesh(request) -> Cloud:
    return MESHES[request.param]()


def polygons(cloud: Cloud) -> np.ndarray:
    return shapely.polygons(cloud.points[cloud.faces][..., :2])


def corners_of(points: np.ndarray, faces: np.ndarray) -> set[frozenset[tuple[float, ...]]]:
    return {frozenset(map(tuple, points[face].tolist())) for face in faces}


def places_over(mesh: Cloud) -> np.ndarray:
    low, high = mesh.points[:, :2].min(axis=0), mesh.points[:, :2].max(axis=0)
    return np.random.default_rng(9).uniform(low, high, (400, 2))


def test_the_faces_are_those_of_the_mesh(mesh: Cloud) -> None:
    surface = liftmesh.as_surface(mesh, triangulation="own")
    assert corners_of(surface.vertices, surface.faces) == corners_of(mesh.points, mesh.faces)
    certificate = surface.verify()
    assert (certificate.valid, certificate.planar, certificate.delaunay) == (True, True, False)
    assert "not Delaunay along constraints" in str(certificate)
    of_mesh = liftmesh.verify(mesh)
    assert (of_mesh.valid, of_mesh.planar, of_mesh.delaunay) == (False, True, False)
    report = surface.report
    used = np.setdiff1d(np.arange(len(mesh)), report.left_out)
    assert report.n_used == len(used) == len(np.unique(surface.faces))
    stood_for = report.representatives >= 0
    np.testing.assert_array_equal(
        mesh.points[report.left_out[stood_for]], mesh.points[report.representatives[stood_for]]
    )
    assert report.n_duplicates == np.count_nonzero(stood_for)


def test_heights_are_those_of_the_faces(mesh: Cloud) -> None:
    surface = liftmesh.as_surface(mesh)
    places = places_over(mesh)
    x, y, z = mesh.points.T
    theirs = matplotlib.tri.Triangulation(x, y, mesh.faces)
    expected = matplotlib.tri.LinearTriInterpolator(
        theirs, z, trifinder=_ByPolygons(theirs, polygons(mesh))
    )(*places.T).filled(np.nan)
    np.testing.assert_allclose(surface.sample(places), expected, atol=1e-9)
    assert 100 < np.isfinite(expected).sum() < 400
    above = surface.height_above(np.column_stack([places, np.zeros(400)]))
    np.testing.assert_allclose(above, -expected, atol=1e-9)
    raster = surface.raster(0.5)
    rows, columns = np.nonzero(np.isfinite(raster.values))
    width, _, left, _, height, top = raster.transform[:6]
    centres = np.column_stack([left + (columns + 0.5) * width, top + (rows + 0.5) * height])
    covered = shapely.union_all(polygons(mesh))
    assert shapely.contains_xy(covered.buffer(1e-9), *centres.T).all()
    np.testing.assert_array_equal(raster.values[rows, columns], surface.sample(centres))


class _ByPolygons(matplotlib.tri.TriFinder):
    """Find triangles by shapely: those of matplotlib take no triangles that turn clockwise."""

    def __init__(self, triangulation, polygons: np.ndarray) -> None:
        super().__init__(triangulation)
        self._tree = shapely.STRtree(polygons)

    def __call__(self, x, y):
        found = np.full(len(x), -1)
        point, face = self._tree.query(shapely.points(x, y), predicate="intersects")
        found[point] = face
        return found


def test_measures_rings_and_lines(mesh: Cloud) -> None:
    surface = liftmesh.as_surface(mesh)
    corners = mesh.points[mesh.faces]
    covered = shapely.union_all(polygons(mesh))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    prisms = np.abs(normals[:, 2]) / 2 * (corners[..., 2].mean(axis=1) + 50)
    assert surface.area(planar=True) == pytest.approx(covered.area)
    assert surface.area() == pytest.approx(np.linalg.norm(normals, axis=1).sum() / 2)
    assert surface.volume(-50).net == pytest.approx(prisms.sum())
    rings = [surface.vertices[ring, :2] for ring in surface.boundary()]
    signed = sum(shapely.Polygon(each).area * (1 if _is_left(each) else -1) for each in rings)
    assert signed == pytest.approx(covered.area)
    lines = surface.contours([0.25])
    on_lines = np.concatenate([each.points[:, :2] for each in lines])
    found = surface.sample(on_lines)  # their ends are on the rim, but for rounding
    assert np.isfinite(found).mean() > 0.9
    np.testing.assert_allclose(found[np.isfinite(found)], 0.25, atol=1e-6)
    drape = surface.profile([[0, 1], [38, 12]])
    line = shapely.LineString([[0, 1], [38, 12]])
    known = np.isfinite(drape.points).all(axis=1)
    assert known.sum() > 10
    assert line.intersection(covered).length <= line.length
    block = surface.solid(base_height=-20)
    closed = trimesh.Trimesh(block.points, block.faces, process=False)
    assert closed.is_watertight
    assert closed.volume == pytest.approx(surface.volume(-20).net)


def _is_left(ring: np.ndarray) -> bool:
    return shapely.LinearRing(ring).is_ccw


def test_what_needs_a_delaunay_triangulation_says_so(mesh: Cloud) -> None:
    surface = liftmesh.as_surface(mesh)
    for each in ("sibson", "laplace"):
        with pytest.raises(InputError, match=f"{each}.* needs a Delaunay .* faces of its own"):
            surface.sample([[1.0, 1.0]], each)
    assert np.isfinite(surface.sample([[20.0, 1.0]], "nearest")).all()


def test_changed_copies_and_further_triangulations(mesh: Cloud) -> None:
    surface = liftmesh.as_surface(mesh)
    trimmed = surface.trim(max_edge=np.median(_sides_of(mesh)))
    assert 0 < len(trimmed.faces) < len(surface.faces)
    steep = surface.replace(vertices=surface.vertices * (1, 1, 10))
    assert steep.triangulation is surface.triangulation
    turned = surface.replace(vertices=surface.vertices * (-0.5, 0.75, 1))
    named = [set(map(frozenset, each.faces.tolist())) for each in (surface, turned)]
    assert named[0] == named[1]
    assert turned.report.n_duplicates == surface.report.n_duplicates
    cut = surface.cut_and_fill(steep)
    assert cut.net == pytest.approx(steep.volume().net - surface.volume().net)
    few = liftmesh.simplify(surface, max_error=0.5)
    assert few.area(planar=True) == pytest.approx(surface.area(planar=True))
    assert few.metadata["simplification"]["error"] <= 0.5
    finer = liftmesh.refine(surface, min_angle=15)
    assert finer.surface.area(planar=True) == pytest.approx(surface.area(planar=True))


def _sides_of(mesh: Cloud) -> np.ndarray:
    corners = mesh.points[mesh.faces][..., :2]
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)


@pytest.mark.parametrize("suffix", ["ply", "obj", "npz", "off"])
def test_files_give_the_surface_again(mesh: Cloud, suffix: str, tmp_path: Path) -> None:
    surface = liftmesh.as_surface(mesh)
    surface.save(tmp_path / f"own.{suffix}")
    again = liftmesh.as_surface(tmp_path / f"own.{suffix}")
    assert corners_of(again.vertices, again.faces) == corners_of(mesh.points, mesh.faces)
    places = places_over(mesh)
    np.testing.assert_allclose(again.sample(places), surface.sample(places), atol=1e-9)


def test_faces_are_sought_by_weights_first_unless_they_are_its_own(tmp_path: Path) -> None:
    points = waves().vertices
    sizes = np.random.default_rng(3).uniform(0, 1, len(points))
    surface = liftmesh.triangulate(points, weights=sizes)
    cloud = surface.to_cloud()
    assert liftmesh.as_surface(cloud).triangulation.weights is not None
    own = liftmesh.as_surface(cloud, triangulation="own")
    assert not hasattr(own.triangulation, "weights")
    assert not own.metadata.get("triangulated_by")
    assert set(map(frozenset, own.faces.tolist())) == set(map(frozenset, surface.faces.tolist()))
    moved = Cloud(
        cloud.points * (5, 1, 1),
        faces=cloud.faces,
        attributes=cloud.attributes,
        metadata=cloud.metadata,
    )
    assert liftmesh.as_surface(moved).verify()
    lost = {name: np.full(len(cloud), np.nan) for name in cloud.attributes}
    again = liftmesh.as_surface(replace(cloud, attributes=lost))
    assert len(again.faces) == len(cloud.faces)
    with pytest.raises(InputError, match="triangulation is 'other': give one of 'own'"):
        liftmesh.as_surface(cloud, triangulation="other")  # type: ignore[arg-type]


@pytest.mark.parametrize("scale", [1.0, 1e-310, 1e300])
@pytest.mark.parametrize(
    ("faces", "said"),
    [
        ([[0, 1, 2], [0, 1, 3]], r"face 0, .* and face 1, .* overlap seen from above, near"),
        ([[0, 1, 2], [2, 0, 1]], r"face 0, .* and face 1, .* overlap seen from above"),
        ([[5, 6, 7], [0, 1, 2], [0, 2, 3], [6, 7, 5]], "face 0, .* and face 3, .* overlap"),
        ([[0, 1, 2], [0, 2, 3], [4, 1, 2]], r"face 0, .* and face 2, .* overlap"),
        ([[0, 1, 2], [0, 4, 3], [4, 2, 3]], r"face 0.* face 1.* not fit together: row 4, .* side"),
        ([[0, 1, 2], [0, 4, 2]], r"face 1, of the rows \[0, 4, 2\], has no area .*: leave it out"),
        ([[0, 1, 2], [0, 8, 1]], r"face 1, of the rows \[0, 8, 1\], has no area .* is vertical"),
        ([[0, 8, 1]], r"face 0, of the rows \[0, 8, 1\], has no area .* is vertical"),
        ([[0, 4, 2], [2, 4, 0]], r"face 0, of the rows \[0, 4, 2\], has no area .* on a line"),
        ([[0, 1, 2], [8, 2, 3]], r"rows 0 and 8 .* one planar position, with the heights 0.0 and"),
    ],
)
def test_what_is_no_surface_is_refused(faces, said: str, scale: float) -> None:
    points = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 0], [5, 5, 0], [6, 5, 0]]
    points = np.array([*points, [5, 7, 0], [0, 0, 9]], dtype=float) * scale
    mesh = Cloud(points, faces=np.array(faces, dtype=np.int32))
    with pytest.raises(InputError, match=said):
        liftmesh.as_surface(mesh, triangulation="own")


def test_a_closed_scan_is_refused() -> None:
    with pytest.raises(InputError, match=r"face \d+, .* (overlap|has no area) seen from above"):
        liftmesh.as_surface(trimesh.creation.icosphere(3))


def test_commands_take_such_meshes(tmp_path: Path) -> None:
    smoothed().export(tmp_path / "own.ply")
    (tmp_path / "at.csv").write_text("x,y\n20,6\n-50,0\n")
    done = run("verify", "own.ply", cwd=tmp_path)
    assert done.returncode == 1
    assert "note: a surface all the same: no two of the 361 triangles overlap" in done.stderr
    for command in (
        ["sample", "own.ply", "out.csv", "--at", "at.csv"],
        ["raster", "own.ply", "out.tif", "--resolution", "1"],
        ["contour", "own.ply", "out.geojson", "--interval", "1"],
        ["solid", "own.ply", "out.stl", "--base-height", "-9"],
    ):
        done = run(*command, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    done = run("sample", "own.ply", "o.csv", "--at", "at.csv", *SIBSON, cwd=tmp_path)
    assert done.returncode != 0
    assert "faces of its own: give --interpolation" in done.stderr


SIBSON = ["--interpolation", "sibson"]
