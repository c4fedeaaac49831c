"""Formats handed to trimesh: STL, GLB and glTF.

They hold single precision, so large coordinates are written relative to an origin (see
``origin.py``), which the file states: an STL file in its header, ``liftmesh origin x y z``, a GLB
or glTF file in the ``extras`` of its scene. Reading such a file here adds the origin again.
"""

from __future__ import annotations

import warnings
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.beside import Beside
from liftmesh.io.file_colors import eight_bit
from liftmesh.io.format import Format, Origin
from liftmesh.io.gltf_validation import checked_gltf
from liftmesh.io.needs import check_finite, check_points, needed_faces
from liftmesh.io.origin import needed_origin
from liftmesh.io.scene import scene_cloud
from liftmesh.optional import load

_HEADER_SIZE = 80
_GLTF_KINDS = ("glb", "gltf")
_STATED = "liftmesh origin"


def read_with_trimesh(stream: BinaryIO, name: str, kind: str) -> Cloud:
    """Read what trimesh reads; every geometry of a scene in its place.

    Raises
    ------
    FormatError
        trimesh cannot read the file, or it holds no vertices.
    """
    options: dict[str, Any] = {"file_type": kind, "process": False, "resolver": Beside(name)}
    if kind in _GLTF_KINDS:
        # Without materials no image is opened, and colours of vertices stay what they are.
        options |= {"resolver": checked_gltf(stream, name, kind), "skip_materials": True}
    trimesh = load("trimesh")
    try:
        with warnings.catch_warnings():
            # NumPy only warns where text stops being numbers, and trimesh takes what came before.
            warnings.simplefilter("error", DeprecationWarning)
            scene = trimesh.load_scene(stream, **options)
        cloud = scene_cloud(scene, name)
    except (FormatError, MemoryError):
        raise
    except Exception as error:
        cause = f"{type(error).__name__}: {error}"
        raise FormatError(f"{name}: not a whole {kind} file: {cause[:300]}") from error
    return cloud


def read_stl(stream: BinaryIO, name: str) -> Cloud:
    """Read an STL file, binary or text.

    Parameters
    ----------
    stream : binary stream
        Seekable, at the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        STL repeats a vertex for each triangle: equal ones are one row again, in the order of their
        first appearance, and ``metadata["repeated_vertices"]`` counts the others.

    Raises
    ------
    FormatError
        The file is broken.
    """
    begin = stream.tell()
    header = stream.read(_HEADER_SIZE)
    stream.seek(begin)
    cloud = _welded(read_with_trimesh(stream, name, "stl"))
    return _moved_back(cloud, _stated_origin(header, name))


def write_stl(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write triangles as binary STL.

    Parameters
    ----------
    stream : binary stream
        Where to write.
    cloud : Cloud
        A mesh; STL has no place for anything but its triangles.

    Returns
    -------
    tuple of float, or None
        The origin that was subtracted, as stated in the file's header.

    Raises
    ------
    FormatError
        There are no faces, or the coordinates do not fit single precision.
    """
    faces = needed_faces(cloud, "STL")
    used = np.unique(faces)
    check_finite(cloud.points, used, "stl")
    origin = needed_origin(cloud.points[used], "stl")
    shown = "liftmesh" if origin is None else f"{_STATED} {' '.join(map(repr, origin))}"
    if len(shown) > _HEADER_SIZE:
        raise FormatError(f"the origin {origin} does not fit the header of STL: write PLY or OBJ")
    mesh = load("trimesh").Trimesh(_shifted(cloud.points, origin), faces, process=False)
    data: bytes = mesh.export(file_type="stl")
    stream.write(shown.encode("ascii").ljust(_HEADER_SIZE, b"\0"))
    stream.write(memoryview(data)[_HEADER_SIZE:])
    return origin


def read_glb(stream: BinaryIO, name: str) -> Cloud:
    """Read a GLB file: the triangles and points of all its meshes in their places.

    Parameters
    ----------
    stream : binary stream
        Seekable, at the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        Vertices with their colours; a scene of several meshes as one.

    Raises
    ------
    FormatError
        The file is broken.
    """
    return _read_scene(stream, name, "glb")


def read_gltf(stream: BinaryIO, name: str) -> Cloud:
    """Read a glTF file, its buffers inside or beside it; see :func:`read_glb`."""
    return _read_scene(stream, name, "gltf")


def write_glb(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as GLB with eight-bit colours.

    Parameters
    ----------
    stream : binary stream
        Where to write.
    cloud : Cloud
        What to write; attributes have no place.

    Returns
    -------
    tuple of float, or None
        The origin that was subtracted, as stated in the extras of the scene.

    Raises
    ------
    FormatError
        There are no points, a coordinate is not finite, or they do not fit single precision.
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


def _read_scene(stream: BinaryIO, name: str, kind: str) -> Cloud:
    cloud = read_with_trimesh(stream, name, kind)
    origin = cloud.metadata.get("origin")
    try:
        stated = None if origin is None else np.array(origin, dtype=np.float64).reshape(3)
    except (TypeError, ValueError):
        return cloud
    return _moved_back(cloud, stated)


def _scene(cloud: Cloud, kind: str) -> tuple[Any, Origin | None]:
    trimesh = load("trimesh")
    check_points(cloud, kind.upper())
    check_finite(cloud.points, np.arange(len(cloud)), kind)
    origin = needed_origin(cloud.points, kind)
    points = _shifted(cloud.points, origin)
    colors = None if cloud.colors is None else eight_bit(cloud.colors)
    if cloud.faces is None or not len(cloud.faces):
        geometry = trimesh.PointCloud(points, colors=colors)
    else:
        geometry = trimesh.Trimesh(
            points, cloud.faces, vertex_colors=colors, vertex_normals=cloud.normals, process=False
        )
    metadata = {} if origin is None else {"origin": list(origin)}
    return trimesh.Scene(geometry, metadata=metadata), origin


def _shifted(points: Array, origin: Origin | None) -> Array:
    return points if origin is None else points - np.array(origin)


def _moved_back(cloud: Cloud, origin: Array | None) -> Cloud:
    if origin is None:
        return cloud
    return Cloud(
        cloud.points + origin,
        colors=cloud.colors,
        faces=cloud.faces,
        metadata={**cloud.metadata, "origin": tuple(origin.tolist())},
    )


def _stated_origin(header: bytes, name: str) -> Array | None:
    text = header.rstrip(b"\0 ").decode("latin-1")
    if not text.startswith(_STATED):
        return None
    try:
        return np.array(text[len(_STATED) :].split(), dtype=np.float64).reshape(3)
    except ValueError as error:
        raise FormatError(f"{name}: the origin in the header is broken: {text!r}") from error


def _welded(cloud: Cloud) -> Cloud:
    """Make equal vertices one, in the order of their first appearance."""
    if cloud.faces is None:
        return cloud
    _, first, row = np.unique(cloud.points, axis=0, return_index=True, return_inverse=True)
    kept = np.sort(first)
    place = np.searchsorted(kept, first)
    faces = place[row.reshape(-1)][cloud.faces].astype(np.int32)
    repeated = {"repeated_vertices": len(cloud) - len(kept)}
    return Cloud(cloud.points[kept], faces=faces, metadata={**cloud.metadata, **repeated})


_GLTF = ("colors", "normals")

FORMATS = (
    Format("stl", (".stl",), read_stl, write_stl, "STL: triangles in single precision", ()),
    Format("glb", (".glb",), read_glb, write_glb, "binary glTF: single precision, colours", _GLTF),
    Format("gltf", (".gltf",), read_gltf, write_gltf, "glTF: single precision, colours", _GLTF),
)
