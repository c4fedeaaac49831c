"""tile(): triangulate in tiles, in bounded memory, what one call would return."""

from __future__ import annotations

import os
from functools import partial
from typing import TYPE_CHECKING, Literal

from liftmesh._typing import Progress
from liftmesh.base.options import NonFinite, ShardFormat, check_progress
from liftmesh.base.threads import as_threads
from liftmesh.tiles.run import Options, triangulated
from liftmesh.tiles.schedule import Serial
from liftmesh.tiles.sources import parts_of

if TYPE_CHECKING:
    from liftmesh.tiles.tiled import Tiled

_MANY = 1 << 30  # rows: enough for any number of threads


def tile(  # noqa: PLR0913 - options are keywords
    source: object,
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
    source : path, list of paths, array_like, or iterator of arrays
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
    >>> {*map(tuple, tiled.compute().tolist())} == {*map(tuple, expected.tolist())}
    True
    """
    check_progress(progress)
    count, _ = as_threads(threads, _MANY)
    options = Options.checked(out, tile_rows, scratch, nonfinite, resume, shards, neighbors)
    runner = Serial(count, progress)
    found = triangulated(source, options, runner, cut=partial(parts_of, show=runner.copied))
    if progress is not None:
        progress(1.0)
    return found
