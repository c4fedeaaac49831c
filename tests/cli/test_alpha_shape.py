"""``liftmesh alpha-shape``: meshes of alpha shapes, and what is said of them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh as command

import liftmesh

RNG = np.random.default_rng(38)
TWO = np.vstack([RNG.random((60, 3)), RNG.random((60, 3)) + 9, [[np.nan, 0, 0]]])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    liftmesh.write(tmp_path / "cloud.ply", TWO)
    return tmp_path


def told(folder: Path, *words: str) -> dict[str, float]:
    done = command("alpha-shape", "cloud.ply", *words, "--nonfinite", "skip", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


@pytest.mark.parametrize("words", [("--alpha", "0.3"), ("--components", "2"), ()])
def test_in_space_the_surface_is_written(words: tuple[str, ...], folder: Path) -> None:
    found = told(folder, "shape.ply", "--space", *words)
    tetra = liftmesh.tetrahedralize(TWO, nonfinite="skip")
    alpha = 0.3 if "--alpha" in words else tetra.optimal_alpha(len(words) or 1)
    shape = tetra.alpha_shape(alpha)
    assert (found["alpha"], found["n_rows"]) == (alpha, 121)
    assert (found["n_tetrahedra"], found["n_faces"]) == (len(shape.simplices), len(shape.faces))
    assert found["n_singular_faces"] == len(shape.singular)
    assert found["n_nonmanifold_edges"] == len(shape.nonmanifold)
    mesh = liftmesh.read(folder / "shape.ply")
    np.testing.assert_array_equal(mesh.points[mesh.faces], TWO[shape.faces])


def test_in_the_plane_triangles_have_the_heights_of_the_points(folder: Path) -> None:
    found = told(folder, "shape.obj", "--alpha", "0.2")
    shape = liftmesh.alpha_shape(TWO[:, :2], 0.2, nonfinite="skip")
    assert found["n_triangles"] == len(shape.simplices)
    assert found["n_boundary_edges"] == len(shape.faces)
    assert found["n_nonmanifold_vertices"] == len(shape.nonmanifold)
    mesh = liftmesh.read(folder / "shape.obj")
    np.testing.assert_array_equal(mesh.points[mesh.faces], TWO[shape.simplices])


def test_people_get_a_line_and_the_counts(folder: Path) -> None:
    words = ("--space", "--alpha", "0.25", "--nonfinite", "skip")
    done = command("alpha-shape", "cloud.ply", "a.stl", *words, cwd=folder)
    shape = liftmesh.alpha_shape(TWO, 0.25, nonfinite="skip")
    inside = f"{len(shape.simplices)} tetrahedra inside {len(shape.faces)} triangles"
    assert f"a.stl: {inside}, at alpha 0.25" in done.stdout
    assert f"singular faces     {len(shape.singular)}" in done.stdout


def test_wrong_usage_and_input(folder: Path) -> None:
    words = ("alpha-shape", "cloud.ply", "a.ply")
    failed(command(*words, "--alpha", "1", "--components", "2", cwd=folder), 2, "give one of them")
    failed(command(*words, "--alpha", "-1", cwd=folder), 2, "--alpha")
    failed(command(*words, "--components", "0", cwd=folder), 2, "--components")
    failed(command(*words, "--space", cwd=folder), 3, "row 120", "--nonfinite skip")
    (folder / "flat.csv").write_text("0,0,0\n1,0,0\n0,1,0\n1,1,0\n")
    failed(command("alpha-shape", "flat.csv", "a.ply", "--space", cwd=folder), 3, "on one plane")
    assert not (folder / "a.ply").exists()
