"""Formats read and written through trimesh: STL, GLB and glTF.

These formats hold single precision. A float has 24 bits: at 5,200,000 m its steps are half a metre.
If rounding the coordinates along an axis would move a vertex by more than a millionth of the
model's size, an origin near the smallest coordinate is subtracted first: a round number, a multiple
of one unit, or of a power of ten for models smaller than one unit. The file records it: an STL file
in its header as ``liftmesh origin x y z``, a GLB or glTF file in the ``extras`` of its scene. The
readers add it again.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.arrays import used_rows
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.format import Format, Origin
from liftmesh.io.gltf_validation import Resolver, checked_gltf
from liftmesh.io.objects.trimesh import from_scene, to_mesh, to_points
from liftmesh.optional import load

TOLERANCE = 1e-6

_HEADER_SIZE = 80
_GLTF_KINDS = ("glb", "gltf")
_STATED = "liftmesh origin"


def read_stl(stream: BinaryIO, name: str) -> Cloud:
    """Read an STL file, binary or text.

    Returns
    -------
    Cloud
        STL repeats a vertex for each triangle: equal vertices are merged, in the order of first
        appearance, and ``metadata["repeated_vertices"]`` counts the repetitions.

    Raises
    ------
    FormatError
        The file is invalid.
    """
    begin = stream.tell()
    header = stream.read(_HEADER_SIZE)
    stream.seek(begin)
    cloud = _welded(_read(stream, name, "stl"))
    return _moved_back(cloud, _stated_origin(header, name))


def write_stl(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write triangles as binary STL.

    Parameters
    ----------
    cloud : Cloud
        A mesh; STL holds its triangles only.

    Returns
    -------
    tuple of float, or None
        The origin that was subtracted, as recorded in the file's header.

    Raises
    ------
    FormatError
        The coordinates do not fit single precision.
    """
    faces = np.zeros((0, 3), dtype=np.int32) if cloud.faces is None else cloud.faces
    origin = needed_origin(cloud.points[used_rows(len(cloud), faces)], "stl")
    shown = "liftmesh" if origin is None else f"{_STATED} {' '.join(map(repr, origin))}"
    if len(shown) > _HEADER_SIZE:
        raise FormatError(f"the origin {origin} does not fit the header of STL: write PLY or OBJ")
    mesh = to_mesh(Cloud(_shifted(cloud.points, origin), faces=faces))
    data: Any = mesh.export(file_type="stl")
    stream.write(shown.encode("ascii").ljust(_HEADER_SIZE, b"\0"))
    stream.write(memoryview(data)[_HEADER_SIZE:])
    return origin


def read_glb(stream: BinaryIO, name: str) -> Cloud:
    """Read a GLB file: the triangles and points of all its meshes, transformed into the scene.

    Returns
    -------
    Cloud
        Vertices, with colours and normals if every mesh has them; several meshes are combined.

    Raises
    ------
    FormatError
        The file is invalid.
    """
    return _read_gltf(stream, name, "glb")


def read_gltf(stream: BinaryIO, name: str) -> Cloud:
    """Read a glTF file with buffers inside it or in the same folder; see :func:`read_glb`."""
    return _read_gltf(stream, name, "gltf")


def write_glb(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as GLB with 8-bit colours.

    Parameters
    ----------
    cloud : Cloud
        The mesh or points; attributes are not written.

    Returns
    -------
    tuple of float, or None
        The origin that was subtracted, as recorded in the extras of the scene.

    Raises
    ------
    FormatError
        The coordinates do not fit single precision.
    """
    scene, origin = _scene(cloud, "glb")
    stream.write(scene.export(file_type="glb"))
    return origin


def write_gltf(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as a glTF file that contains its buffers; see :func:`write_glb`."""
    scene, origin = _scene(cloud, "gltf")
    parts = scene.export(file_type="gltf", merge_buffers=True, embed_buffers=True)
    stream.write(parts["model.gltf"])
    return origin


def _read(stream: BinaryIO, name: str, kind: str) -> Cloud:
    """Read a file with trimesh; combine all geometries of the scene."""
    options: dict[str, Any] = {"file_type": kind, "process": False, "resolver": Resolver(name)}
    if kind in _GLTF_KINDS:
        # Without materials no image is opened, and vertex colours are kept unchanged.
        options |= {"resolver": checked_gltf(stream, name, kind), "skip_materials": True}
    trimesh = load("trimesh")
    try:
        with warnings.catch_warnings():
            # At text that is not a number NumPy only warns, and trimesh uses what came before.
            warnings.simplefilter("error", DeprecationWarning)
            scene = trimesh.load_scene(stream, **options)
        cloud = from_scene(scene, name)
    except (FormatError, MemoryError):
        raise
    except Exception as error:
        cause = f"{type(error).__name__}: {error}"
        raise FormatError(f"{name}: not a valid {kind} file: {cause[:300]}") from error
    if not len(cloud):
        raise FormatError(f"{name}: the file holds no vertices")
    return cloud


def _read_gltf(stream: BinaryIO, name: str, kind: str) -> Cloud:
    cloud = _read(stream, name, kind)
    origin = cloud.metadata.get("origin")
    try:
        stated = None if origin is None else np.array(origin, dtype=np.float64).reshape(3)
    except (TypeError, ValueError):
        return cloud
    return _moved_back(cloud, stated)


def _scene(cloud: Cloud, kind: str) -> tuple[Any, Origin | None]:
    origin = needed_origin(cloud.points, kind)
    shown = Cloud(
        _shifted(cloud.points, origin),
        colors=cloud.colors,
        normals=_squarable(cloud.normals),
        faces=cloud.faces,
    )
    geometry = to_mesh(shown) if _has_faces(cloud) else to_points(shown)
    metadata: dict[str, Any] = {} if origin is None else {"origin": list(origin)}
    if cloud.crs is not None:
        metadata["crs"] = cloud.crs
    return load("trimesh").Scene(geometry, metadata=metadata), origin


def _has_faces(cloud: Cloud) -> bool:
    return cloud.faces is not None and len(cloud.faces) > 0


def _shifted(points: Array, origin: Origin | None) -> Array:
    return points if origin is None else points - np.array(origin)


def _moved_back(cloud: Cloud, origin: Array | None) -> Cloud:
    if origin is None:
        return cloud
    return replace(
        cloud,
        points=cloud.points + origin,
        metadata={**cloud.metadata, "origin": tuple(origin.tolist())},
    )


def _stated_origin(header: bytes, name: str) -> Array | None:
    text = header.rstrip(b"\0 ").decode("latin-1")
    if not text.startswith(_STATED):
        return None
    try:
        return np.array(text[len(_STATED) :].split(), dtype=np.float64).reshape(3)
    except ValueError as error:
        raise FormatError(f"{name}: the origin in the header is invalid: {text!r}") from error


def _welded(cloud: Cloud) -> Cloud:
    """Merge equal vertices, in the order of first appearance."""
    if cloud.faces is None:
        return cloud
    _, first, row = np.unique(cloud.points, axis=0, return_index=True, return_inverse=True)
    kept = np.sort(first)
    place = np.searchsorted(kept, first)
    faces = place[row.reshape(-1)][cloud.faces].astype(np.int32)
    repeated = {"repeated_vertices": len(cloud) - len(kept)}
    return Cloud(cloud.points[kept], faces=faces, metadata={**cloud.metadata, **repeated})


def needed_origin(points: Floats, what: str) -> Origin | None:
    """Compute the origin to subtract before coordinates are rounded to single precision.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        Finite coordinates.
    what : str
        The format's name for messages.

    Returns
    -------
    tuple of float, or None
        x, y and z of the origin, 0 along axes that need none; None if no axis needs one.

    Raises
    ------
    FormatError
        Even with an origin the coordinates do not fit single precision.

    Examples
    --------
    >>> needed_origin(np.array([[450000.1, 5200000.2, 3.0], [450100.0, 5200100.0, 4.0]]), "stl")
    (450000.0, 5200000.0, 0.0)
    >>> needed_origin(np.array([[0.1, 0.2, 3.0], [100.0, 100.0, 4.0]]), "stl") is None
    True
    """
    if not len(points):
        return None
    low = points.min(axis=0)
    with np.errstate(over="ignore"):
        size = float((points.max(axis=0) - low).max())
    needed = _moved(points) > TOLERANCE * size
    origin = np.where(needed, _round_below(low, size), 0.0)
    fits = np.isfinite(size) and bool(np.all(_moved(points - origin) <= TOLERANCE * size))
    if not fits:
        raise FormatError(
            f"the coordinates do not fit the single precision of {what}: write PLY or OBJ"
        )
    return (float(origin[0]), float(origin[1]), float(origin[2])) if needed.any() else None


def _moved(points: Floats) -> Floats:
    """Compute for each axis how far rounding to single precision moves coordinates at most."""
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        moved: Floats = np.abs(points - points.astype(np.float32)).max(axis=0)
    return moved


def _round_below(low: Floats, size: float) -> Floats:
    if size == 0:
        return low
    step = 10.0 ** min(np.floor(np.log10(size)), 0.0)
    rounded: Floats = np.floor(low / step) * step
    return rounded


def _lost_in_gltf(cloud: Cloud, _options: Mapping[str, Any]) -> tuple[str, ...]:
    """Points are written without normals, and normals of meshes with unit length."""
    kept = cloud.normals is None or (_has_faces(cloud) and _are_unit(cloud.normals))
    return () if kept else ("normals",)


def _squarable(normals: Array | None) -> Array | None:
    """Shorten or lengthen normals whose squares overflow or vanish; None if one is not finite."""
    if normals is None or not np.isfinite(normals).all():
        return None
    largest = np.abs(normals).max(axis=1, keepdims=True).astype(np.float64)
    is_extreme = (largest > 1e100) | ((largest > 0) & (largest < 1e-100))
    return normals / np.where(is_extreme, largest, 1.0) if is_extreme.any() else normals


def _are_unit(normals: Array) -> bool:
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.sqrt((normals.astype(np.float64) ** 2).sum(axis=1))
    return bool((np.abs(lengths - 1.0) <= TOLERANCE).all())


_GLTF: dict[str, Any] = {
    "keeps": ("points", "faces", "colors", "alpha", "normals", "crs"),
    "needs": ("points", "finite"),
    "loses": _lost_in_gltf,
}

FORMATS = (
    Format(
        "stl",
        (".stl",),
        read_stl,
        write_stl,
        "STL: triangles in single precision",
        keeps=("faces",),
        needs=("faces", "finite"),
    ),
    Format(
        "glb", (".glb",), read_glb, write_glb, "binary glTF: single precision, colours", **_GLTF
    ),
    Format("gltf", (".gltf",), read_gltf, write_gltf, "glTF: single precision, colours", **_GLTF),
)
