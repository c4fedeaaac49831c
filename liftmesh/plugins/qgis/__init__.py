"""liftmesh in the toolbox of QGIS: surfaces, contours, volumes and Voronoi cells of its layers.

::

    python -m liftmesh.plugins.qgis liftmesh_qgis.zip
    qgis_process plugins enable liftmesh_qgis
    qgis_process run liftmesh:tin --INPUT=points.gpkg --OUTPUT=triangles.gpkg

The first line makes the zip that QGIS installs (Plugins, Manage and Install Plugins, Install from
ZIP). It holds the plugin and liftmesh itself, with the kernel of the Python that makes it, which
has to be of the same version as that of QGIS. Nothing else is needed there: QGIS brings NumPy, and
none of its own packages is replaced or hidden.

The folder ``plugin`` is what QGIS loads from the zip, and is no part of this package, as it runs in
QGIS alone; `geometries` has what it does with arrays.
"""

from __future__ import annotations

import importlib.metadata
import os
import zipfile
from collections.abc import Iterator
from pathlib import Path

import lazy_loader

import liftmesh
from liftmesh.io.atomic import replacing

PLUGIN = "liftmesh_qgis"
_PLUGIN = Path(__file__).parent / "plugin"
_LEFT_OUT = {"__pycache__", "_core", "plugin"}


def write_zip(path: str | os.PathLike[str]) -> Path:
    """Write the zip that QGIS installs.

    Parameters
    ----------
    path : path
        Where to write it; a file there is replaced.

    Returns
    -------
    Path
        The same path.

    Raises
    ------
    OSError
        The file cannot be written.

    See Also
    --------
    liftmesh.plugins.xarray : Grids in Python.

    Examples
    --------
    >>> import zipfile
    >>> from liftmesh.plugins.qgis import write_zip
    >>> target = getfixture("tmp_path") / "liftmesh_qgis.zip"
    >>> sorted(zipfile.ZipFile(write_zip(target)).namelist())[:3]
    ['liftmesh_qgis/__init__.py', 'liftmesh_qgis/algorithms.py', 'liftmesh_qgis/icon.svg']
    """
    path = Path(path)
    with (
        replacing(path) as stream,
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as made,
    ):
        for name, content in _files():
            made.writestr(f"{PLUGIN}/{name}", content)
    return path


def _files() -> Iterator[tuple[str, bytes]]:
    """Yield what is in the zip: the plugin as QGIS looks for it, and the packages that it needs."""
    about = importlib.metadata.distribution("liftmesh")
    for each in sorted(_PLUGIN.iterdir()):
        if each.is_file():
            name = "__init__.py" if each.name == "start.py" else each.name
            stated = f"version={about.version}\n" if each.name == "metadata.txt" else ""
            yield name, each.read_bytes() + stated.encode()
    yield f"packages/liftmesh-{about.version}.dist-info/METADATA", _stated(about)
    packed: dict[str, bytes] = {}
    for package in (liftmesh, lazy_loader):
        for folder in map(Path, package.__path__):  # of an editable installation there are two
            packed |= dict(_packed(folder, package.__name__))
    yield from packed.items()


def _stated(about: importlib.metadata.Distribution) -> bytes:
    return f"Metadata-Version: 2.1\nName: liftmesh\nVersion: {about.version}\n".encode()


def _packed(folder: Path, package: str) -> Iterator[tuple[str, bytes]]:
    for each in sorted(folder.rglob("*")):
        parts = each.relative_to(folder).parts
        if each.is_file() and _LEFT_OUT.isdisjoint(parts):
            yield "/".join(("packages", package, *parts)), each.read_bytes()
