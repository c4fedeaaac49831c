"""Files of tetrahedra: VTU, as `formats/vtu.py` writes it, VTK and MSH by meshio, which reads all.

A cloud has triangles alone, so these are no formats of the registry. Every row of the points is
written, in its place and with every bit, also rows in no tetrahedron. meshio takes paths only, and
ends the process at some files: so files are copied, and that becomes an error.
"""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import tempfile
from pathlib import Path
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.errors import FormatError
from liftmesh.io.atomic import replacing
from liftmesh.io.formats.vtu import write_tetrahedra as write_vtu
from liftmesh.io.streams import suffix_of
from liftmesh.io.write import WriteResult, written_file
from liftmesh.optional import load

FORMATS = {"vtu": "vtu", "vtk": "vtk", "msh": "gmsh"}  # with the names that meshio has
_CELLS = "tetra"
_LARGE = 1 << 26  # bytes of a file that may take more memory than there is; a smaller one lies


def is_of_tetrahedra(path: str | os.PathLike[str], file_format: str | None = None) -> bool:
    """Whether files of this name or format are read for their tetrahedra alone."""
    return _key(Path(path), file_format) in FORMATS


def _key(path: Path, file_format: str | None) -> str:
    return (file_format or suffix_of(path.name)).lower().removeprefix(".")


def checked_format(path: Path, file_format: str | None = None) -> str:
    """Return the format of a file of tetrahedra, or raise."""
    key = _key(path, file_format)
    if key not in FORMATS:
        known = ", ".join(f".{each}" for each in FORMATS)
        raise FormatError(f"{path}: {key!r} is no format of tetrahedra, which are {known}")
    return key


def write_tetrahedra(
    path: str | os.PathLike[str],
    points: Floats,
    simplices: Rows,
    file_format: str | None = None,
    *,
    overwrite: bool = True,
) -> WriteResult:
    """Write tetrahedra as a whole or not at all."""
    place = Path(path).expanduser()
    key = checked_format(place, file_format)
    with replacing(place, overwrite=overwrite) as stream:
        if key == "vtu":
            write_vtu(stream, points, simplices)
        else:
            _write_by_meshio(stream, FORMATS[key], points, simplices)
    return written_file(place, key)


def _write_by_meshio(stream: BinaryIO, kind: str, points: Floats, simplices: Rows) -> None:
    mesh = load("meshio", extra="solvers").Mesh(np.ascontiguousarray(points), [(_CELLS, simplices)])
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "mesh")
        mesh.write(copy, file_format=kind)
        with copy.open("rb") as written:
            shutil.copyfileobj(written, stream)


def read_tetrahedra(
    path: str | os.PathLike[str], file_format: str | None = None
) -> tuple[Floats, Array]:
    """Read points in space and the tetrahedra among the cells of a file."""
    place = Path(path).expanduser()
    key = checked_format(place, file_format)
    meshio = load("meshio", extra="solvers")
    place.open("rb").close()  # whose errors say more
    try:
        with (
            contextlib.redirect_stdout(io.StringIO()),
            contextlib.redirect_stderr(io.StringIO()),
            np.errstate(all="ignore"),
        ):
            mesh = meshio.read(place, file_format=FORMATS[key])
    except (Exception, SystemExit) as error:
        if isinstance(error, MemoryError) and place.stat().st_size > _LARGE:
            raise
        why = error.__context__ if isinstance(error, SystemExit) else error
        raise FormatError(f"{place}: meshio cannot read it: {str(why) or repr(why)}") from error
    cells = [block.data for block in mesh.cells if block.type == _CELLS]
    if not cells:
        raise FormatError(f"{place}: holds no tetrahedra: make some with liftmesh tetrahedralize")
    if mesh.points.ndim != 2 or mesh.points.shape[1] != 3:
        raise FormatError(f"{place}: its points have the shape {mesh.points.shape}, not (n, 3)")
    return np.asarray(mesh.points, dtype=np.float64), np.concatenate(cells)
