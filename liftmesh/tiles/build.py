"""tile() and tile_surface(): in tiles, in bounded memory, what one call would return."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Literal, cast

from liftmesh._typing import Progress
from liftmesh.base.options import NonFinite, OnDuplicate, ShardFormat, as_threads, check_progress
from liftmesh.tiles.options import Options, SurfaceOptions
from liftmesh.tiles.pipeline import triangulated
from liftmesh.tiles.schedule import Serial
from liftmesh.tiles.tiled import open_tiled

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.io.options import ChunkOptions
    from liftmesh.tiles.tiled import Tiled, TiledSurface


_MANY = 1 << 30  # rows: enough for any number of threads


def tile(  # noqa: PLR0913 - options are keywords
    points: object,
    out: str | os.PathLike[str],
    *,
    tile_rows: int | Literal["auto"] = "auto",
    scratch: str | os.PathLike[str] | None = None,
    nonfinite: NonFinite = "error",
    resume: bool = True,
    shards: ShardFormat = "npy",
    neighbors: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Tiled:
    """Triangulate more points than fit in memory, tile by tile, into files.

    The triangles of all files together are exactly those of `delaunay` for all points: no seam, no
    overlap, and the same choice among points on one circle. They do not depend on the tiles.

    Parameters
    ----------
    points : path, list of paths, array_like, or iterator of arrays
        Planar points; a third column is ignored. NPY files, mapped arrays, LAS files and
        Parquet files with columns x and y are read by ranges, other files that `read_chunks` reads,
        LAZ among them, and iterators, once. Rows are numbered through all files.
    out : str or path
        The folder to write to; it is made if it is missing. Files in it that no run has made stay
        as they are, and stand in the way if they have the names of shards.
    tile_rows : int or "auto", default "auto"
        How many rows a tile has, about. A tile takes some 200 bytes a row; "auto" means 1,500,000
        rows, or as many as in the run that is resumed.
    scratch : str or path, optional
        Where to make a folder for 24 bytes a row; by default `out`. It shrinks as tiles are
        finished, and is removed at the end.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity raise an error, or are listed in ``skipped``.
    resume : bool, default True
        Whether to continue a run that was interrupted, with its finished parts; the source is read
        again and must be the same. False begins anew, and replaces what a former run has written.
    shards : {"npy", "parquet", "ply"}, default "npy"
        The format of the triangles. NPY holds rows of the source. Parquet holds them as columns a,
        b and c, in half the bytes, and needs pyarrow (``liftmesh[dask]``). PLY holds meshes that
        viewers open: each shard has the vertices of its triangles, with z = 0 and their ``row``;
        it is refused beyond 2**31 rows, because it has no 64-bit integers.
    neighbors : bool, default False
        Whether to write which triangles share an edge, within and across shards, for
        `Tiled.neighbors`: 12 bytes a triangle.
    threads : int, optional
        As for `delaunay`; one tile is triangulated at a time.
    progress : callable, optional
        Called with the fraction of the work done. If it has a method ``begin``, this is called with
        the number of rows, first of all, or when a source that is read once has been read. An
        exception that it raises ends the run, which can be resumed.

    Returns
    -------
    Tiled
        The triangles in shards, with the rows of the whole source as 64-bit numbers.

    Raises
    ------
    InputError
        The points or an option are invalid; the source has changed since the run began; `out` holds
        the triangles of another one, or files that no run has made, or another run writes to it.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    FormatError
        A file is damaged, or has no points.
    MissingDependencyError
        Parquet is read or written, and pyarrow is not installed.
    OSError
        A file cannot be read or written; after a full disk, the run can be resumed.

    Notes
    -----
    Each tile is triangulated by itself, without overlap. Triangles whose circumcircle is clear of
    all other tiles are written; the corners of the others, a per cent or two of the points, are
    merged from tile to tile up a tree. If nearly nothing is settled in the tiles, as for points on
    one circle, the last merge takes all points, and as much memory as `delaunay`; the large arrays
    of merges that are larger than two tiles are in files of the scratch folder.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> points = np.random.default_rng(0).random((1000, 2))
    >>> tiled = tile(points, tempfile.mkdtemp(), tile_rows=300)
    >>> from liftmesh import delaunay
    >>> expected = delaunay(points, order="canonical").simplices
    >>> {*map(tuple, tiled.to_array().tolist())} == {*map(tuple, expected.tolist())}
    True
    """
    check_progress(progress)
    count, _ = as_threads(threads, _MANY)
    options = Options.validated(out, tile_rows, scratch, nonfinite, resume, shards, neighbors)
    tiled = open_tiled(triangulated(points, options, Serial(count, progress)))
    if progress is not None:
        progress(1.0)
    return tiled


def tile_surface(  # noqa: PLR0913 - options are keywords
    cloud: object,
    out: str | os.PathLike[str],
    *,
    crs: str | None = None,
    plane: Literal["xy"] = "xy",
    on_duplicate: OnDuplicate = "first",
    nonfinite: NonFinite = "error",
    tile_rows: int | Literal["auto"] = "auto",
    scratch: str | os.PathLike[str] | None = None,
    resume: bool = True,
    shards: Literal["npy"] = "npy",
    neighbors: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    **reading: Unpack[ChunkOptions],
) -> TiledSurface:
    """Make a surface of more points than fit in memory, tile by tile, in files.

    The triangles are those of `triangulate` for all rows, and so are the vertices with heights,
    colours, normals and named values, bit for bit, and the use of every row.

    Parameters
    ----------
    cloud : path, list of paths, array_like, cloud, table, or iterator of these
        Points in space, as for `triangulate`; also Parquet. Rows are numbered through all files,
        which must have the same values and coordinate system. NPY files and mapped arrays are read
        by ranges; what else is read is written to the scratch folder first.
    out : str or path
        The folder to write to, as for `tile`.
    crs : str, optional
        The coordinate system, in place of that of the source: WKT or ``EPSG:n``.
    plane : "xy"
        The projection plane; tiles know no other.
    on_duplicate : {"first", "last", "lowest", "highest", "mean", "error"}
        As for `triangulate`. An error names two rows of the first tile that has any.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows whose x, y or z is NaN or infinity raise an error, or are listed in
        ``skipped``.
    tile_rows : int or "auto", default "auto"
        How many rows a tile has, about. A tile takes some 250 bytes a row, and a few times what the
        values of the row take; "auto" means 1,500,000, or as many as in the run that is resumed.
    scratch : str or path, optional
        Where to make a folder for 48 bytes a row and its values, twice where the source cannot be
        read by ranges, until its rows are sorted by tile; by default `out`. It shrinks as tiles are
        finished, and is removed at the end.
    resume
        As for `tile`.
    shards : "npy"
        The format of the triangles; surfaces know no other, as vertices and faces stand beside
        them. `TiledSurface.iter_meshes` gives each shard for a file of any format.
    neighbors, threads, progress
        As for `tile`.
    **reading
        Which rows of files are read, and how, as for `read_chunks`: ``classes``, ``bounds``,
        ``dst_crs``, ``columns`` and so on. Rows are numbered as they are read. Of LAS, LAZ and
        COPC, the ground (class 2) is taken, or all rows if no file has any, and no withheld rows,
        as by `triangulate`; ``classes="all"`` takes all. `TiledSurface.report` says which were
        taken.

    Returns
    -------
    TiledSurface
        Triangles and vertices in shards.

    Raises
    ------
    InputError
        As for `tile`; `plane` is another; the rows of several files have not the same values; or
        weights, a metric or trimming are asked for, which only `triangulate` knows.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DuplicateHeightError
        Rows at one planar position have different heights and `on_duplicate` is "error".
    DegenerateInputError
        There are fewer than three distinct planar positions, or all lie on one line.
    UnsupportedTypeError, FormatError, MissingDependencyError, OSError
        As for `triangulate` and `tile`.

    Warns
    -----
    DataWarning
        The coordinate system has degrees, or units that differ.

    Notes
    -----
    Equal positions share a tile, which therefore chooses among all rows at a position. Of a
    position with very many rows it is given only those that the policy needs: one or two of each
    chunk, but for "mean" and "error" one for each different height.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from liftmesh import triangulate
    >>> points = np.random.default_rng(0).integers(0, 30, (1000, 3))
    >>> tiled = tile_surface(points, tempfile.mkdtemp(), on_duplicate="highest", tile_rows=300)
    >>> faces = triangulate(points, on_duplicate="highest").faces
    >>> {frozenset(face) for face in tiled.to_array().tolist()} == {*map(frozenset, faces.tolist())}
    True
    >>> print(tiled.report)
    1,000 rows, 602 of them used in 1,127 triangles. Left out: 11 duplicates, 387 overhangs ...
    """
    check_progress(progress)
    count, _ = as_threads(threads, _MANY)
    surface = SurfaceOptions.validated(on_duplicate, plane, crs, reading)
    options = Options.validated(
        out, tile_rows, scratch, nonfinite, resume, shards, neighbors, surface
    )
    tiled = open_tiled(triangulated(cloud, options, Serial(count, progress)))
    if progress is not None:
        progress(1.0)
    return cast("TiledSurface", tiled)
