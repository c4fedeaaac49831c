"""UGRID 1.0: what the conventions ask for, as xarray reads it without their help."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
import pytest
import xarray
from commands import liftmesh as command
from surfaces import meadow

import liftmesh
from liftmesh import Cloud, FormatError
from liftmesh.io.formats import ugrid


def opened(data: bytes, *, decode_cf: bool = False) -> xarray.Dataset:
    return xarray.open_dataset(io.BytesIO(data), engine="scipy", decode_cf=decode_cf)


def written(mesh: object) -> tuple[xarray.Dataset, liftmesh.WriteResult]:
    stream = io.BytesIO()
    told = liftmesh.write(stream, mesh, format="ugrid")
    return opened(stream.getvalue()), told


def test_the_conventions_are_met(tmp_path: Path) -> None:
    """Every attribute that UGRID 1.0 requires of a 2-D flexible mesh, and what they name."""
    surface = liftmesh.triangulate(meadow(50), crs="EPSG:7415")
    surface = surface.with_attributes(depth=-surface.vertices[:, 2])
    path = surface.save(tmp_path / "a.nc").path
    file = opened(path.read_bytes())
    assert file.attrs["Conventions"] == "CF-1.8 UGRID-1.0"
    (mesh,) = (each for each in file.values() if each.attrs.get("cf_role") == "mesh_topology")
    about = mesh.attrs
    assert (mesh.dims, mesh.dtype.kind, about["topology_dimension"]) == ((), "i", 2)
    x, y = (file[each] for each in about["node_coordinates"].split())
    assert x.dims == y.dims == (about["node_dimension"],)
    assert x.attrs["standard_name"] == "projection_x_coordinate"
    assert (y.attrs["units"], file["mesh2d_node_z"].attrs["units"]) == ("m", "m")
    faces = file[about["face_node_connectivity"]]
    assert faces.attrs["cf_role"] == "face_node_connectivity"
    assert (faces.attrs["start_index"], faces.dtype.kind, faces.shape[1]) == (0, "i", 3)
    assert faces.dims[0] == about["face_dimension"]
    np.testing.assert_array_equal(faces, surface.faces)
    np.testing.assert_array_equal(np.stack([x, y], axis=1), surface.vertices[:, :2])
    assert (liftmesh.orient2d(*np.stack([x, y], axis=1)[faces].transpose(1, 0, 2)) > 0).all()
    for name, values in (
        ("mesh2d_node_z", surface.vertices[:, 2]),
        ("depth", -surface.vertices[:, 2]),
    ):
        held = file[name]
        np.testing.assert_array_equal(held, values)
        assert held.attrs["mesh"] == mesh.name
        assert held.attrs["location"] == "node"
        assert held.attrs["coordinates"].split() == [x.name, y.name]
        system = file[held.attrs["grid_mapping"]].attrs
        assert pyproj.CRS.from_cf(system) == pyproj.CRS("EPSG:7415")


def test_degrees_and_meshes_without_a_system() -> None:
    points = [[8, 49, 100], [9, 49, 120], [8, 50, 90]]
    file, _ = written(Cloud(np.array(points, float), faces=np.array([[0, 1, 2]]), crs="EPSG:4326"))
    assert file["mesh2d_node_x"].attrs["units"] == "degrees_east"
    assert file["mesh2d_node_y"].attrs["standard_name"] == "latitude"
    assert file["crs"].attrs["grid_mapping_name"] == "latitude_longitude"
    file, told = written(Cloud(np.array(points, float), faces=np.array([[0, 1, 2]])))
    assert "crs" not in file
    assert "units" not in file["mesh2d_node_x"].attrs
    assert told.dropped == ()
    file, told = written(Cloud(np.array(points, float), faces=np.array([[0, 1, 2]]), crs="Ort Ü"))
    assert file["crs"].attrs["crs_wkt"] == "Ort Ü"


def test_values_that_have_a_type_and_those_that_have_none() -> None:
    values: dict[str, Any] = {
        "small": np.array([1, -2, 3], np.int8),
        "byte": np.array([1, 200, 3], np.uint8),
        "flag": np.array([True, False, True]),
        "long": np.array([1, 2**53, -3]),
        "longer": np.array([1, 2**53 + 1, 3]),
        "words": np.array(["a", "b", "c"]),
        "pairs": np.zeros((3, 2)),
        "crs": np.zeros(3),
        "not a name": np.zeros(3),
        "nan": np.array([np.nan, np.inf, -0.0]),
    }
    points = np.array([[0, 0, 1.0], [1, 0, 2], [0, 1, 3]])
    file, told = written(Cloud(points, attributes=values, faces=np.array([[0, 1, 2]])))
    lost = {"longer", "words", "pairs", "crs", "not a name"}
    assert {*told.dropped} == lost - {"crs"} | {"crs (values)"}
    for name in values.keys() - lost:
        assert np.array_equal(file[name].values, values[name], equal_nan=name == "nan")
    assert np.signbit(file["nan"].values[2])


def test_the_command_and_what_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    np.savetxt(tmp_path / "a.xyz", meadow(30))
    done = command("triangulate", "a.xyz", "a.nc", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = command("info", "a.nc", cwd=tmp_path)
    assert "ugrid files are written, not read" in done.stderr
    with pytest.raises(FormatError, match="without faces"):
        liftmesh.write(tmp_path / "b.nc", meadow(30))
    monkeypatch.setattr(ugrid, "_MOST", 100)
    with pytest.raises(FormatError, match="no arrays of 2 GiB"):
        liftmesh.triangulate(meadow(30)).save(tmp_path / "b.nc")
    assert not (tmp_path / "b.nc").exists()
