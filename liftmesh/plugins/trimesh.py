"""Files and polygons of liftmesh for trimesh, where its own functions look for them.

>>> import trimesh
>>> import liftmesh.plugins.trimesh as plugin
>>> plugin.register()
>>> trimesh.load("data/jacksboro.ply").vertices.shape
(138632, 3)
>>> plugin.unregister()

Until `unregister` is called, ``trimesh.load`` reads LAS, LAZ, NPZ, XYZ and PLY by `liftmesh.read`,
whose options it takes (``classes=[2]``), and ``trimesh.creation.triangulate_polygon``, with all
functions of trimesh that call it, triangulates by `liftmesh.triangulate_polygon` unless another
engine is named. What differs from trimesh's own:

- PLY keeps float64 and the attributes of vertices, and rows are neither merged nor reordered; what
  is not read, such as colours of faces and textures, is listed in ``metadata["not_read"]``.
- Triangles of polygons are constrained Delaunay, also where holes touch, and each position is one
  vertex.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, BinaryIO

from liftmesh.io.objects.trimesh import arguments_of
from liftmesh.io.options import ReadOptions
from liftmesh.io.read import read
from liftmesh.optional import load
from liftmesh.planar.polygon import triangulate_polygon

if TYPE_CHECKING:
    from trimesh import creation
    from trimesh.exchange import load as loading
else:
    creation = load("trimesh.creation", extra="trimesh")
    loading = load("trimesh.exchange.load", extra="trimesh")

SUFFIXES = ("las", "laz", "npz", "xyz", "ply")

_replaced: dict[str, Any] = {}  # what unregister puts back


def register() -> None:
    """Let trimesh read files and triangulate polygons by liftmesh, until `unregister`.

    Calling it again changes nothing.

    See Also
    --------
    unregister : Undoes it.
    liftmesh.read : The options that ``trimesh.load`` then takes.
    liftmesh.triangulate_polygon : The triangles of polygons.

    Examples
    --------
    >>> import trimesh
    >>> from shapely import box
    >>> from liftmesh.plugins.trimesh import register, unregister
    >>> register()
    >>> float(trimesh.creation.extrude_polygon(box(0, 0, 1, 2), height=3).volume)
    6.0
    >>> unregister()
    """
    if _replaced:
        return
    loaders: dict[str, Any] = loading.mesh_loaders
    _replaced["loaders"] = {suffix: loaders.get(suffix) for suffix in SUFFIXES}
    _replaced["engine"] = creation.triangulate_polygon
    loaders.update(dict.fromkeys(SUFFIXES, _load))
    creation.triangulate_polygon = _engine(creation.triangulate_polygon)


def unregister() -> None:
    """Give trimesh back what it had before `register`.

    See Also
    --------
    register : What is undone.

    Examples
    --------
    >>> from liftmesh.plugins.trimesh import unregister
    >>> unregister()  # where nothing is registered, nothing happens
    """
    if not _replaced:
        return
    creation.triangulate_polygon = _replaced.pop("engine")
    for suffix, former in _replaced.pop("loaders").items():
        loading.mesh_loaders.pop(suffix)
        if former is not None:
            loading.mesh_loaders[suffix] = former


def _load(
    file_obj: BinaryIO,
    file_type: str,
    resolver: Any = None,  # noqa: ARG001 - part of trimesh's signature
    **options: Any,
) -> dict[str, Any]:
    """Read a file as trimesh's loaders do; what the caller gives to `Trimesh` stays as it is."""
    ours = {name: each for name, each in options.items() if name in ReadOptions.__annotations__}
    made = arguments_of(read(file_obj, format=file_type, **ours))
    return {name: each for name, each in made.items() if options.get(name) is None}


def _engine(former: Callable[..., Any]) -> Callable[..., Any]:
    def triangulate(
        polygon: Any,
        triangle_args: str | None = None,
        engine: str | None = None,
        force_vertices: bool = False,
        **options: Any,
    ) -> Any:
        """Triangulate by liftmesh, or by the engine of trimesh that is named."""
        chosen = triangulate_polygon if engine in (None, "liftmesh") else former
        return chosen(polygon, triangle_args, engine, force_vertices, **options)

    return triangulate
