"""Registry of file formats and of adapters for objects, built in or from plugins.

Another package adds a file format by an entry point in the group ``liftmesh.formats``: its name is
the suffix without the dot, its object a `Format`. It adds a cloud type by an entry point in the
group ``liftmesh.adapters``, whose object is an `Adapter`. Built-in entries come first, then plugins
sorted by name, then the adapters for objects of unknown types. A plugin that cannot be loaded is
reported when its suffix is requested, or when no adapter accepts an object, and has no effect
otherwise.

Objects of other libraries as output are no entries of these tables: the functions stand in
`io.objects`, and `Surface`, `LowerHull` and `Triangulation` offer them as methods.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeVar

from liftmesh.base.cloud import Cloud
from liftmesh.base.frozen import freeze
from liftmesh.base.interruption import defer_signals, preserve_signals
from liftmesh.base.options import shown
from liftmesh.errors import FormatError, Option, UnsupportedTypeError
from liftmesh.io.format import Format, LazyFunction
from liftmesh.io.formats import FORMATS
from liftmesh.io.objects import plain
from liftmesh.io.objects.plain import is_of, is_other_table, is_table, qualified_name

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from typing_extensions import Unpack

    from liftmesh.io.options import ObjectOptions


Entry = TypeVar("Entry")

FORMAT_GROUP = "liftmesh.formats"
ADAPTER_GROUP = "liftmesh.adapters"
_OF_MESHIO = frozenset({"vtk", "med", "mesh", "inp", "bdf", "exo", "cgns"})
_OF_GEOPANDAS = frozenset({"fgb", "gml", "kml", "geojsonl", "parquet"})


@dataclass(frozen=True, slots=True)
class Adapter:
    """Conversion of one type of object to a cloud; packages register one to add a type.

    Parameters
    ----------
    name : str
        Name of the adapter in messages.
    accepts : callable
        Whether an object is of this type. It is called with objects of every type, so it must
        decide by the type alone and import no library.
    to_cloud : callable
        Converts an accepted object to a `Cloud`, one row per point, in the object's own order.

    See Also
    --------
    Format : The same for files.
    as_cloud : Uses adapters.

    Examples
    --------
    >>> import numpy as np
    >>> from liftmesh import Cloud
    >>> adapter = Adapter(
    ...     name="complex plane",
    ...     accepts=lambda source: isinstance(source, complex),
    ...     to_cloud=lambda source: Cloud(np.array([[source.real, source.imag, 0.0]])),
    ... )
    >>> adapter.accepts(1 + 2j), adapter.to_cloud(1 + 2j).points.tolist()
    (True, [[1.0, 2.0, 0.0]])
    """

    name: str
    accepts: Callable[[Any], bool]
    to_cloud: Callable[[Any], Cloud]


def _refuse_path(path: object) -> Cloud:
    raise UnsupportedTypeError(f"{path!r} is a path, not a cloud: liftmesh.read it first")


def _objects(module: str, name: str) -> LazyFunction:
    return LazyFunction(f"liftmesh.io.objects.{module}", name)


ADAPTERS = (
    Adapter("cloud", lambda source: isinstance(source, Cloud), lambda source: source),
    Adapter("table", is_table, _objects("tables", "to_cloud")),
    Adapter("array", plain.is_array, plain.from_array),
    Adapter("grid", plain.is_grid, LazyFunction("liftmesh.raster.raster", "to_cloud")),
    Adapter("own mesh", is_of("liftmesh", {"Surface", "LowerHull"}), plain.converted),
    Adapter("path", lambda source: isinstance(source, str | os.PathLike), _refuse_path),
    Adapter(
        "trimesh", is_of("trimesh", {"PointCloud", "Trimesh"}), _objects("trimesh", "to_cloud")
    ),
    Adapter("trimesh scene", is_of("trimesh", {"Scene"}), _objects("trimesh", "scene_to_cloud")),
    Adapter(
        "open3d",
        is_of("open3d", {"PointCloud", "TriangleMesh", "Tensor"}),
        _objects("open3d", "to_cloud"),
    ),
    Adapter("pyvista", is_of("pyvista", {"DataSet"}), _objects("pyvista", "to_cloud")),
)

# Tried after the adapters of other packages.
FALLBACKS = (
    Adapter("object with to_cloud()", plain.has_to_cloud, plain.converted),
    Adapter("object with vertices and faces", plain.is_mesh_like, plain.from_mesh_like),
    Adapter("another table", is_other_table, _objects("tables", "refuse")),
    Adapter("array-like", plain.is_array_like, plain.from_array),
)

_with_options = _objects("tables", "with_options")
_with_transform = LazyFunction("liftmesh.raster.raster", "with_options")


def known_formats() -> dict[str, Format]:
    """List all formats by name, including those of other packages."""
    plugins = {entry.name.lower(): _listed(entry) for entry in reversed(_entries(FORMAT_GROUP))}
    return plugins | {each.name: each for each in FORMATS}


def find_format(wanted: str, name: str) -> Format:
    """Find a format by its name or suffix, with or without the dot, in upper or lower case."""
    if not isinstance(wanted, str):
        raise FormatError(
            f"{Option('format')} is {shown(wanted)}: give a name or suffix, such as 'ply'"
        )
    key = wanted.lower().removeprefix(".")
    if key.endswith(".gz"):
        return _compressed(find_format(key.removesuffix(".gz"), name), name)
    for each in FORMATS:
        if key == each.name or f".{key}" in each.suffixes:
            return each
    for entry in _entries(FORMAT_GROUP):
        if entry.name.lower() == key:
            return _format(entry)
    raise FormatError(f"{name}: {_unknown(key)}; known suffixes are {', '.join(_suffixes())}")


def find_written(wanted: str, name: str) -> Format:
    """Find the format of a file to be written, as `find_format`; none is compressed with gzip."""
    file_format = find_format(wanted, name)
    if wanted.lower().endswith(".gz"):
        raise FormatError(f"{name}: gzip is read only: leave out .gz, and compress the file")
    return file_format


def _compressed(file_format: Format, name: str) -> Format:
    if not file_format.gzip:
        raise FormatError(
            f"{name}: {file_format.name} files are not read compressed with gzip: "
            "decompress it first"
        )
    return file_format


def as_cloud(source: Any, **options: Unpack[ObjectOptions]) -> Cloud:
    """Convert any object that holds points to a cloud.

    Parameters
    ----------
    source : object
        A `Cloud`; an array-like of shape (n, 2) or (n, 3), or of any width with ``columns``; a
        pandas or polars DataFrame, a structured array or points of laspy, whose columns are known
        by their names like those of a CSV file; a GeoDataFrame or GeoSeries of points; a grid: a
        `Raster`, a DataArray of xarray, or an array with ``transform``; a ``trimesh.PointCloud``,
        ``trimesh.Trimesh`` or ``trimesh.Scene``; an Open3D point cloud or mesh, legacy or tensor
        based, or a tensor; a dataset of PyVista; an object that an installed adapter accepts; an
        object with a method ``to_cloud()``, such as a `Surface`; or an object with ``vertices``,
        ``faces`` and optionally ``colors``, ``normals`` and ``attributes``.
    **options
        For tables and arrays: ``columns``, ``flat`` and ``nodata``, as for `read`. For an array of
        heights (rows, columns) ``transform``: a, b, c, d, e and f as those of a `Raster`, or of
        rasterio; values that are NaN, or ``nodata``, are left out.

    Returns
    -------
    Cloud
        One row per point, in the order of ``source``; rows of two coordinates get z = 0. Float64
        coordinates are shared with ``source`` where that is safe; the arrays are read-only, unless
        ``source`` is a `Cloud`, which is returned itself.

    Raises
    ------
    InputError
        An array has the wrong shape or type, colours or attributes do not fit the points, the
        columns of a table cannot be told, or an option is invalid or for no such object.
    FormatError
        A face of a trimesh scene refers to a vertex that does not exist.
    UnsupportedTypeError
        No adapter accepts the object, or it is a path.

    See Also
    --------
    read : Read a file.
    triangulate : Takes the same objects.

    Examples
    --------
    >>> as_cloud([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0], [0.0, 1.0, 7.0]]).points.shape
    (3, 3)
    """
    if options:
        make = _with_transform if "transform" in options else _with_options
        made: Cloud = make(source, options)
        return made
    with preserve_signals():
        adapter = next((each for each in _adapters() if each.accepts(source)), None)
        cloud = None if adapter is None else adapter.to_cloud(source)
    if adapter is None:
        raise _unsupported(source)
    return _checked(cloud, adapter, source)


def rows_of(source: Any, *, has_heights: bool = True) -> Any:
    """Return the points of a cloud or mesh; what NumPy makes an array of is returned as it is."""
    with preserve_signals():
        adapter = next((each for each in _adapters() if each.accepts(source)), None)
    if adapter is None or adapter.to_cloud is plain.from_array:
        return source
    cloud = as_cloud(source) if has_heights or not is_table(source) else as_cloud(source, flat=None)
    return cloud.points


def _checked(cloud: object, adapter: Adapter, source: object) -> Cloud:
    if isinstance(cloud, Cloud):
        if cloud is not source:
            cloud = replace(cloud)
            freeze(cloud)  # its arrays may be those of the source
        return cloud
    raise UnsupportedTypeError(
        f"the adapter {adapter.name!r} makes a {qualified_name(cloud)} of a "
        f"{qualified_name(source)}: it must make a liftmesh.Cloud"
    )


def _adapters() -> Iterator[Adapter]:
    yield from ADAPTERS
    yield from _installed_adapters()[0]
    yield from FALLBACKS


def _unsupported(source: object) -> UnsupportedTypeError:
    message = (
        f"a {qualified_name(source)} is not a point cloud: give an array of shape (n, 2) or "
        "(n, 3), a trimesh or Open3D point cloud or mesh, or an object with vertices and faces"
    )
    if isinstance(source, Iterator):
        message += "; what has no length becomes a list first: list(rows)"
    broken = _installed_adapters()[1]
    if broken:
        message += f"; adapters that cannot be loaded: {'; '.join(broken)}"
    return UnsupportedTypeError(message)


def _unknown(key: str) -> str:
    if not key:
        return f"the name has no suffix: give the format with {Option('format', ...)}"
    unknown = f"no format has the suffix or name {key!r}"
    if key in _OF_MESHIO:
        return f"{unknown}, but `meshio convert` makes such files of .vtu, and .ply of them"
    if key in _OF_GEOPANDAS:
        return f"{unknown}, but points that geopandas.read_file() returns are taken as clouds"
    return unknown


def _suffixes() -> list[str]:
    own = {suffix for each in FORMATS for suffix in each.suffixes}
    return sorted(own | {f".{entry.name.lower()}" for entry in _entries(FORMAT_GROUP)})


def _format(entry: EntryPoint) -> Format:
    try:
        return _loaded(entry, Format)
    except _NotLoadedError as error:
        raise FormatError(
            f"the plugin {entry.value!r} for {entry.name!r} files {error}: "
            "repair or uninstall its package"
        ) from error.__cause__


def _listed(entry: EntryPoint) -> Format:
    try:
        return _format(entry)
    except FormatError as error:
        return Format(entry.name, (f".{entry.name.lower()}",), None, None, str(error))


@lru_cache(maxsize=1)
def _installed_adapters() -> tuple[tuple[Adapter, ...], tuple[str, ...]]:
    """Load the adapters of other packages, and describe those that cannot be loaded."""
    loaded = [_adapter(entry) for entry in _entries(ADAPTER_GROUP)]
    good = tuple(each for each in loaded if isinstance(each, Adapter))
    return good, tuple(each for each in loaded if isinstance(each, str))


def _adapter(entry: EntryPoint) -> Adapter | str:
    """Load an adapter, or return the reason why it cannot be loaded."""
    try:
        return _loaded(entry, Adapter)
    except _NotLoadedError as error:
        return f"{entry.name} ({entry.value}) {error}"


class _NotLoadedError(Exception):
    """An entry point cannot be used; the message completes "the plugin ..."."""


def _entries(group: str) -> list[EntryPoint]:
    """Sort the plugins, so that of two with one name the same one wins everywhere."""
    from importlib.metadata import entry_points  # noqa: PLC0415 - slow, and rarely needed

    return sorted(entry_points(group=group), key=lambda entry: (entry.name, entry.value))


def _loaded(entry: EntryPoint, kind: type[Entry]) -> Entry:
    """Load the object of an entry point and check its type."""
    with defer_signals():  # around the clause: a time limit is no fault of the plugin
        try:
            loaded = entry.load()
        except (Exception, SystemExit) as error:
            raise _NotLoadedError(f"cannot be loaded ({type(error).__name__}: {error})") from error
    if not isinstance(loaded, kind):
        raise _NotLoadedError(f"is a {qualified_name(loaded)}, not a liftmesh.{kind.__name__}")
    return loaded
