"""verify(mesh): meshes of every kind are checked by their own planar points and triangles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import open3d as o3d
import pytest
import scipy.spatial
import trimesh

import liftmesh
from liftmesh import Cloud, FormatError, InputError, NonFiniteError, UnsupportedTypeError

ROWS = np.random.default_rng(8).random((50, 3))
SURFACE = liftmesh.triangulate(ROWS)
MESHES: dict[str, Any] = {
    "surface": SURFACE,
    "triangulation": SURFACE.triangulation,
    "Delaunay": liftmesh.scipy.Delaunay(ROWS[:, :2]),
    "scipy": scipy.spatial.Delaunay(ROWS[:, :2]),
    "matplotlib": SURFACE.to_matplotlib(),
    "cloud": SURFACE.to_cloud(),
    "lower hull": SURFACE.triangulation.lifted(),
    "trimesh": SURFACE.to_trimesh(),
    "scene": trimesh.Scene(SURFACE.to_trimesh()),
    "open3d": SURFACE.to_open3d(),
    "open3d tensor": SURFACE.to_open3d_t(),
}


@pytest.mark.parametrize("what", MESHES)
def test_any_mesh_is_verified(what: str) -> None:
    certificate = liftmesh.verify(MESHES[what])
    assert certificate.valid
    assert (certificate.n_rows, certificate.n_triangles) == (50, len(SURFACE.faces))
    if what != "scipy":
        assert certificate.simplices_sha256 == SURFACE.triangulation.verify().simplices_sha256


def test_a_file_is_verified(tmp_path: Path) -> None:
    SURFACE.save(tmp_path / "mesh.ply")
    assert liftmesh.verify(tmp_path / "mesh.ply").canonical
    with pytest.raises(FileNotFoundError):
        liftmesh.verify(tmp_path / "nowhere.ply")
    (tmp_path / "mesh.obj").write_text("v 1 2\n")
    with pytest.raises(FormatError, match=r"mesh\.obj"):
        liftmesh.verify(str(tmp_path / "mesh.obj"))


def test_a_surface_is_verified_in_its_own_plane() -> None:
    wall = liftmesh.triangulate(ROWS, plane=(0, -1, 0))
    assert liftmesh.verify(wall).canonical
    assert not liftmesh.verify(wall.to_cloud()).valid  # which is seen from above


@pytest.mark.parametrize("policy", ["first", "last", "highest", "mean"])
def test_a_surface_with_overhangs_and_skipped_rows_is_valid(policy: Any) -> None:
    rows = np.vstack([ROWS, ROWS[:9] + np.array([0, 0, 1]), [[0.5, 0.5, np.nan]], [[np.inf, 0, 0]]])
    surface = liftmesh.triangulate(rows, on_duplicate=policy, nonfinite="skip")
    certificate = liftmesh.verify(surface)
    assert certificate.canonical
    assert (certificate.n_skipped, certificate.n_duplicates) == (2, 9)
    assert liftmesh.verify(surface.triangulation).canonical
    with pytest.raises(NonFiniteError):
        liftmesh.verify(surface.to_cloud())


def test_faces_that_are_wrong_are_found() -> None:
    mesh = SURFACE.to_trimesh()
    mesh.faces = mesh.faces[1:]
    assert not liftmesh.verify(mesh).valid
    masked = SURFACE.to_matplotlib()
    masked.set_mask([True] + [False] * (len(SURFACE.faces) - 1))
    assert not liftmesh.verify(masked).valid


@pytest.mark.parametrize(
    ("mesh", "what"),
    [
        (ROWS, "a ndarray"),
        (ROWS.tolist(), "a list"),
        (Cloud(ROWS), "a Cloud"),
        (trimesh.PointCloud(ROWS), "a PointCloud"),
        (o3d.core.Tensor(ROWS), "a Tensor"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_points_alone_are_no_mesh(mesh: Any, what: str) -> None:
    with pytest.raises(InputError, match=f"{what} without triangles cannot be verified: give a"):
        liftmesh.verify(mesh)
    with pytest.raises(UnsupportedTypeError):
        liftmesh.verify(object())


VALUES = {
    "colors": np.arange(150, dtype=np.uint8).reshape(50, 3),
    "normals": ROWS,
    "attributes": {"class": np.arange(50)},
    "crs": "EPSG:25832",
}


def test_values_are_given_with_the_points() -> None:
    surface = liftmesh.triangulate(ROWS, **VALUES)
    assert surface.colors is not None
    assert np.array_equal(surface.colors, VALUES["colors"])
    assert surface.normals is not None
    assert np.array_equal(surface.normals, ROWS)
    assert surface.attributes["class"].tolist() == list(range(50))
    assert surface.crs == "EPSG:25832"


def test_values_given_replace_those_of_the_cloud(tmp_path: Path) -> None:
    liftmesh.triangulate(ROWS, **VALUES).save(tmp_path / "mesh.ply")
    lists = {"colors": [[1, 2, 3]] * 50, "attributes": {"height": ROWS[:, 2].tolist()}}
    surface = liftmesh.triangulate(tmp_path / "mesh.ply", **lists)
    assert surface.colors is not None
    assert surface.colors.tolist() == [[1, 2, 3]] * 50
    assert [*surface.attributes] == ["class", "height"]
    assert surface.crs == "EPSG:25832"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"colors": VALUES["colors"][:3]}, "colors has 3 rows for 50 points"),
        ({"colors": np.zeros(50)}, r"colors need the shape \(n, 3\) or \(n, 4\) and numbers"),
        ({"colors": ["red"] * 50}, r"colors need the shape .* not \(50,\) of <U3"),
        ({"normals": np.zeros((50, 4))}, r"normals need the shape \(n, 3\) and numbers"),
        ({"attributes": {"a": [1]}}, "a has 1 row for 50 points"),
        ({"attributes": np.zeros(50)}, "attributes are a ndarray: give a dict"),
        ({"crs": 2583200}, "crs is 2583200"),
    ],
)
def test_values_that_do_not_fit_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        liftmesh.triangulate(ROWS, **given)
