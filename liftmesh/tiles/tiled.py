"""`Tiled`: the finished triangles of a tiled triangulation, where they lie on the disk."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.base.frozen import freeze
from liftmesh.base.options import as_folder
from liftmesh.errors import FormatError, InputError
from liftmesh.terrain.report import Report
from liftmesh.tiles.adjacency import as_pairs, neighbors_of
from liftmesh.tiles.dask_collections import Collections
from liftmesh.tiles.manifest import manifest_of
from liftmesh.tiles.shards import open_shard
from liftmesh.tiles.store import damaged, is_sound, mapped, sound, within

if TYPE_CHECKING:
    from liftmesh._typing import Progress
    from liftmesh.planar.certificate import Certificate


@dataclass(frozen=True)
class Tiled(Collections):
    """A triangulation in shards, as returned by `tile` and `open_tiled`.

    Triangles name rows of the whole source, counted through all of its files. Each is in one
    shard; all shards together hold what `delaunay` returns for all points.

    Attributes
    ----------
    directory : pathlib.Path
        The folder with the shards.
    manifest : dict
        What the folder holds: counts, the files of the source with their first rows, the shards
        with their SHA-256, and the SHA-256 of each chunk of the source.

    Examples
    --------
    >>> import tempfile
    >>> import liftmesh
    >>> points = np.random.default_rng(0).random((1000, 2))
    >>> tiled = liftmesh.tile(points, tempfile.mkdtemp(), tile_rows=300)
    >>> len(tiled.shards) > 1, tiled.compute().shape == liftmesh.delaunay(points).simplices.shape
    (True, True)
    """

    directory: Path
    manifest: Mapping[str, Any]

    def __post_init__(self) -> None:
        freeze(self)

    def __repr__(self) -> str:
        return (
            f"<Tiled: {self.nsimplex} triangles over {self.npoints} rows "
            f"in {len(self.shards)} shards>"
        )

    @property
    def npoints(self) -> int:
        """The number of rows of the source."""
        return int(self.manifest["rows"])

    @property
    def nsimplex(self) -> int:
        """The number of triangles."""
        return int(self.manifest["triangles"])

    @property
    def shards(self) -> tuple[Path, ...]:
        """The files of triangles: tiles first, then what crosses their borders."""
        return tuple(self.directory / shard["file"] for shard in self.manifest["shards"])

    @property
    def duplicates(self) -> Integers:
        """Rows at the position of a lower row, and that row: (k, 2) int64, ascending; mapped."""
        return self._mapped("duplicates.npy", np.int64, self.manifest["duplicates"], 2)

    @property
    def skipped(self) -> Integers:
        """Rows skipped because they are not finite: (j,) int64, ascending; mapped."""
        return self._mapped("skipped.npy", np.int64, self.manifest["skipped"])

    @property
    def convex_hull(self) -> Integers:
        """The edges of the convex hull, (h, 2) int64, as of a `Triangulation`."""
        hull = self._mapped("hull.npy", np.int64, self.manifest["hull"])
        return np.stack([hull, np.roll(hull, -1)], axis=1)

    @property
    def report(self) -> Report:
        """What became of every row: a vertex, a duplicate, or skipped; with rows of 64 bits.

        It is as from `triangulate`, and holds 16 bytes for each row that is left out; `duplicates`
        and `skipped` map files.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> points = [[0, 0], [1, 0], [0, 1], [1, 0], [float("nan"), 2]]
        >>> report = liftmesh.tile(points, tempfile.mkdtemp(), nonfinite="skip").report
        >>> print(report)
        5 rows, 3 of them used in 1 triangle. Left out: 1 duplicate, 1 row not finite.
        >>> report.left_out.tolist(), report.representatives.tolist()
        ([3, 4], [1, -1])
        """
        pairs, skipped = self.duplicates, self.skipped
        left_out = np.concatenate([pairs[:, 0], skipped])
        order = np.argsort(left_out, kind="stable")
        representatives = np.concatenate([pairs[:, 1], np.full_like(skipped, -1)])
        return Report(
            rows=self.npoints,
            used=self.npoints - len(left_out),
            duplicates=len(pairs),
            overhangs=0,
            skipped=len(skipped),
            triangles=self.nsimplex,
            policy="first",
            seconds={},
            left_out=left_out[order],
            representatives=representatives[order],
        )

    def blocks(self) -> Iterator[Integers]:
        """Yield the triangles of one shard after the other.

        Yields
        ------
        (m, 3) ndarray of int64
            Counter-clockwise, from the lexicographically least corner; NPY is mapped, not read.

        Raises
        ------
        FormatError
            A file is damaged.
        OSError
            A file cannot be read.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> [block.tolist() for block in tiled.blocks()]
        [[[0, 1, 2]]]
        """
        for path, stated in zip(self.shards, self.manifest["shards"], strict=True):
            yield open_shard(path, stated)

    def compute(self) -> Integers:
        """Read all triangles into memory: 24 bytes each.

        Returns
        -------
        (m, 3) ndarray of int64
            The shards in their order.

        Raises
        ------
        FormatError
            A file is damaged.
        OSError
            A file cannot be read.
        MemoryError
            There are too many.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> tiled.compute()
        array([[0, 1, 2]])
        """
        found = np.empty((self.nsimplex, 3), dtype=np.int64)
        at = 0
        for block in self.blocks():
            found[at : at + len(block)] = block
            at += len(block)
        return found

    def neighbor_blocks(self) -> Iterator[Integers]:
        """Yield which triangles are beyond the edges of one shard after the other.

        Yields
        ------
        (m, 3, 2) ndarray of int64
            The number of the shard, and the row in it, of the triangle across the edge opposite
            vertex k; both are -1 outside.

        Raises
        ------
        InputError
            The folder was made without neighbours.
        FormatError
            A file is damaged.
        OSError
            A file cannot be read.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> square = [[0, 0], [1, 0], [0, 1], [1, 2]]
        >>> tiled = liftmesh.tile(square, tempfile.mkdtemp(), neighbors=True)
        >>> next(tiled.neighbor_blocks())[0].tolist()
        [[-1, -1], [-1, -1], [0, 1]]
        """
        return map(self._pairs, range(len(self.shards)))

    def compute_neighbors(self) -> Integers:
        """Read all neighbours into memory, as rows of `compute`: 24 bytes a triangle.

        Returns
        -------
        (m, 3) ndarray of int64
            The triangle across the edge opposite vertex k; -1 outside.

        Raises
        ------
        InputError, FormatError, OSError
            As for `neighbor_blocks`.
        MemoryError
            There are too many.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> square = [[0, 0], [1, 0], [0, 1], [1, 2]]
        >>> liftmesh.tile(square, tempfile.mkdtemp(), neighbors=True).compute_neighbors()
        array([[-1, -1,  1],
               [ 0, -1, -1]])
        """
        begins = np.cumsum([0, *self._counts[:-1]])
        found = np.empty((self.nsimplex, 3), dtype=np.int64)
        for begin, pairs in zip(begins, self.neighbor_blocks(), strict=True):
            shard, row = pairs[:, :, 0], pairs[:, :, 1]
            found[begin : begin + len(pairs)] = np.where(shard < 0, -1, begins[shard] + row)
        return found

    def _pairs(self, shard: int) -> Integers:
        if not self.manifest["neighbors"]:
            raise InputError(
                f"{self.directory} has no neighbours: tile again with neighbors=True, resume=False"
            )
        names, counts = neighbors_of(self.shards[shard].name), np.array(self._counts)
        rows = self._mapped(names[0], np.int32, self._counts[shard], 3)
        links = self._mapped(names[1], np.int64, None, 3)
        side, beyond, there = links.T
        is_right = (side >= 0) & (side < 3 * len(rows)) & (beyond >= 0) & (beyond < len(counts))
        is_right &= (there >= 0) & (there < counts[np.where(is_right, beyond, 0)])
        if not is_right.all() or not within(rows, -1, len(rows)):
            raise damaged(self.directory / names[0], "neighbours that are not there")
        return as_pairs(shard, rows, links)

    def is_sound(self) -> bool:
        """Whether every file still has the SHA-256 that the manifest states.

        Returns
        -------
        bool
            False if one was changed, truncated or removed.

        Raises
        ------
        OSError
            A file cannot be read.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> _ = tiled.shards[0].write_bytes(b"")
        >>> tiled.is_sound()
        False
        """
        return is_sound(self.directory, self._digests)

    def verify(
        self,
        points: object = None,
        *,
        scratch: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Certificate:
        """Verify exactly, part by part, that the shards are the triangulation of all points.

        The checks are those of `liftmesh.verify`, and so is the certificate, but neither points nor
        triangles are held at once. Also checked are the hull, the duplicates, the skipped rows,
        the neighbours, if there are any, and the SHA-256 of every file; of a surface also which row
        stands for each position, by the policy, and every height and value of a vertex against the
        source.

        Parameters
        ----------
        points : path, list of paths, array_like, or iterator of arrays, optional
            The source, as for `tile`; by default the files that the manifest names.
        scratch : str or path, optional
            Where to make a folder for 24 bytes a row, which is removed; by default `directory`.
        threads : int, optional
            As for `delaunay`.
        progress : callable, optional
            As for `tile`.

        Returns
        -------
        Certificate
            True if all is right. It is ``canonical`` where the triangles are those of liftmesh.

        Raises
        ------
        InputError
            The source is not known, or has changed since, or an option is invalid.
        FormatError
            A file is damaged.
        OSError
            A file cannot be read or written.

        Notes
        -----
        A tile takes as much memory as when it was triangulated. If nearly nothing is settled in
        the tiles, as for points on one circle, the last part holds all points, and takes as much
        memory as `liftmesh.verify`.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> points = np.random.default_rng(0).random((1000, 2))
        >>> tiled = liftmesh.tile(points, tempfile.mkdtemp(), tile_rows=300)
        >>> print(tiled.verify(points))
        valid: these 1,980 triangles are the canonical Delaunay triangulation of 1,000 rows
        """
        from liftmesh.tiles.verification import verified  # noqa: PLC0415 - it needs this class

        return verified(self, points, scratch, threads, progress)

    def _written(self) -> dict[str, Mapping[str, Any]]:
        """Return what the manifest says of each file."""
        shards = {shard["file"]: shard for shard in self.manifest["shards"]}
        return {**shards, **self.manifest["files"]}

    @property
    def _counts(self) -> list[int]:
        return [each["triangles"] for each in self.manifest["shards"]]

    @cached_property
    def _digests(self) -> dict[str, str]:
        return {file: each["sha256"] for file, each in self._written().items()}

    def _mapped(self, name: str, kind: Any, count: int | None, *shape: int) -> Array:
        """Map a file that is as the manifest says."""
        found = mapped(sound(self.directory / name, self._digests[name]))
        counted = found.shape[:1] if count is None else (count,)
        if found.dtype != kind or found.shape != (*counted, *shape):
            raise damaged(self.directory / name, f"{found.shape} of {found.dtype}")
        return found


def open_tiled(directory: str | os.PathLike[str]) -> Tiled:
    """Open what `tile` or `tile_surface` has written.

    Parameters
    ----------
    directory : str or path
        The folder.

    Returns
    -------
    Tiled
        The triangulation; its files are read when they are asked for. A `TiledSurface` if there
        are heights.

    Raises
    ------
    InputError
        `directory` is no path.
    FormatError
        The folder holds no finished triangulation, or files of it are missing or truncated.
    OSError
        It cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> import liftmesh
    >>> folder = tempfile.mkdtemp()
    >>> liftmesh.tile([[0, 0], [1, 0], [0, 1]], folder)
    <Tiled: 1 triangles over 3 rows in 1 shards>
    >>> open_tiled(folder).convex_hull.tolist()
    [[0, 1], [1, 2], [2, 0]]
    """
    folder = Path(as_folder("directory", directory))
    manifest = manifest_of(folder)
    tiled = _surface(folder, manifest) if "surface" in manifest else Tiled(folder, manifest)
    for file, each in tiled._written().items():  # noqa: SLF001 - its other half
        path = folder / file
        size = path.stat().st_size if path.is_file() else 0
        if size != each["bytes"]:
            raise FormatError(
                f"{path}: {size:,} bytes of {each['bytes']:,}: the file is damaged: tile the "
                "source again, into the same folder"
            )
    return tiled


def _surface(folder: Path, manifest: dict[str, Any]) -> Tiled:
    from liftmesh.tiles.tiled_surface import TiledSurface  # noqa: PLC0415 - it is one of these

    return TiledSurface(folder, manifest)
