"""What a plain ``pip install`` of liftmesh and of a library gives, without ``import liftmesh``."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import distribution, entry_points
from pathlib import Path

import numpy as np
import pytest
import pyvista

import liftmesh

DATA = Path(__file__).resolve().parents[2] / "data"
POINTS = np.array([[0.1, 0, 5], [9, 0, 5], [0, 9, 14], [9, 9, 3]])


def run(code: str, folder: Path) -> None:
    """Run code in a fresh interpreter, where warnings are errors, outside of the repository."""
    words = ["-W", "error", "-c", f"import sys, pyvista\n{code}"]
    subprocess.run([sys.executable, *words], check=True, cwd=folder)


def test_liftmesh_is_the_installed_one() -> None:
    assert Path(liftmesh.__file__).is_relative_to(sys.prefix)


def test_pyvista_does_not_load_what_is_not_asked_for(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "mesh.ply", liftmesh.triangulate(POINTS))
    run(
        "mesh = pyvista.read('mesh.ply')\n"
        "mesh.save('other.ply')\n"
        "assert 'liftmesh' in dir(mesh)\n"
        "assert str(mesh.points.dtype) == 'float32'\n"
        "assert not [name for name in sys.modules if name.startswith('liftmesh')]",
        tmp_path,
    )


def test_ply_is_replaced_where_that_is_asked_for(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "mesh.ply", liftmesh.triangulate(POINTS))
    run(
        "import liftmesh.plugins.pyvista as ours\n"
        "pyvista.register_reader('.ply', ours.read, override=True)\n"
        "assert str(pyvista.read('mesh.ply').points.dtype) == 'float64'",
        tmp_path,
    )


def test_the_accessor_is_there(tmp_path: Path) -> None:
    run(
        f"mesh = pyvista.PolyData({POINTS.tolist()}).liftmesh.delaunay_2d()\n"
        "assert mesh.n_cells == 2\n"
        "assert pyvista.ImageData(dimensions=(3, 3, 1)).liftmesh.terrain().n_cells == 8\n"
        "assert 'liftmesh' in [each.name for each in pyvista.registered_accessors()]",
        tmp_path,
    )


def test_readers_and_writers_are_there(tmp_path: Path) -> None:
    code = f"mesh = pyvista.PolyData({POINTS.tolist()}).liftmesh.terrain()\n"
    for suffix in (each.name for each in entry_points(group="pyvista.writers")):
        code += f"mesh.save('mesh{suffix}')\nassert pyvista.read('mesh{suffix}').n_points == 4\n"
    run(code + "pyvista.registered_readers(), pyvista.registered_writers()", tmp_path)


@pytest.mark.parametrize("name", ["jacksboro.ply", "quad.xyz"])
def test_files_of_liftmesh_are_read(name: str, tmp_path: Path) -> None:
    options = ", force_ext='.liftmesh-ply'" if name.endswith("ply") else ""
    count = len(liftmesh.read(DATA / name))
    run(
        f"mesh = pyvista.read({str(DATA / name)!r}{options})\n"
        f"assert mesh.n_points == {count}\n"
        "assert str(mesh.points.dtype) == 'float64'",
        tmp_path,
    )


def test_no_reader_is_one_that_pyvista_has() -> None:
    """It would refuse to read these files at all."""
    names = {each.name for each in entry_points(group="pyvista.readers")}
    assert {".liftmesh-ply", ".landxml", ".laz"} <= names
    assert names.isdisjoint(pyvista.core.utilities.reader.CLASS_READERS)
    assert len(pyvista.registered_readers()) >= len(names)


@pytest.mark.parametrize("library", ["xarray", "meshio", "trimesh", "matplotlib.tri", "shapely"])
def test_other_libraries_have_no_place_for_plugins(library: str, tmp_path: Path) -> None:
    """Their modules are imported, as the page of plugins says; what they have is of other kinds."""
    run(f"import {library}\nassert 'liftmesh' not in sys.modules", tmp_path)
    assert {each.group for each in distribution("liftmesh").entry_points} == {
        "console_scripts", "pyvista.accessors", "pyvista.readers", "pyvista.writers"
    }  # fmt: skip
