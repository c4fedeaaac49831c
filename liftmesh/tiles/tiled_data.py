"""The files of a finished triangulation in tiles, read as its manifest says.

Beside each shard of triangles of a surface, ``tile-00007.npy``, are its vertices,
``tile-00007-vertices.npy``: records of row, x, y, z and the values of the row, by ascending row;
and the same triangles as faces between these, ``tile-00007-faces.npy``. So a shard is a mesh by
itself; a vertex that several shards share is in each of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import planar_bounds
from liftmesh.base.frozen import FrozenResult, cached_property
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.optional import load
from liftmesh.terrain.frame import Frame, resolve_plane
from liftmesh.terrain.report import Report
from liftmesh.tiles.plan import Plan
from liftmesh.tiles.schema import POSITION, ROW, Schema, cloud_from
from liftmesh.tiles.shards import open_shard, read_shard
from liftmesh.tiles.store import (
    PLAN,
    damaged,
    digest_of,
    faces_name,
    is_sound,
    links_name,
    load_json,
    mapped,
    neighbors_name,
    sound,
    vertices_name,
    within,
)

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


@dataclass(frozen=True, repr=False)
class TiledData(FrozenResult):
    """The fields of a `Tiled`, which describes them, and what follows from them directly."""

    folder: Path
    manifest: Mapping[str, Any]

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
        return tuple(self.folder / shard["file"] for shard in self.manifest["shards"])

    @property
    def duplicates(self) -> Integers:
        """Rows at the position of a lower row, and that row: (k, 2) int64, ascending; mapped."""
        return array_of(self, "duplicates.npy", np.int64, self.manifest["duplicates"], 2)

    @property
    def skipped(self) -> Integers:
        """Rows skipped because they are not finite: (j,) int64, ascending; mapped."""
        return array_of(self, "skipped.npy", np.int64, self.manifest["skipped"])

    @property
    def convex_hull(self) -> Integers:
        """The rows on the convex hull, (h,) int64, as of a `Triangulation`; mapped."""
        return array_of(self, "hull.npy", np.int64, self.manifest["hull"])

    @cached_property
    def _digests(self) -> dict[str, str]:
        return {file: each["sha256"] for file, each in stated_files(self).items()}


class UnprovedData(TiledData):
    """A folder whose files may be damaged: that is a finding, and no error."""


@dataclass(frozen=True, repr=False)
class TiledSurfaceData(TiledData):
    """The fields of a `TiledSurface`, and what follows from them directly."""

    @property
    def schema(self) -> Schema:
        """What rows have besides a position: names, types, coordinate system."""
        return Schema.from_dict(self.manifest["surface"])

    @property
    def crs(self) -> str | None:
        """The coordinate system: WKT or ``EPSG:n``."""
        return self.schema.crs

    @property
    def metadata(self) -> dict[str, Any]:
        """The unit of heights, if the band of a raster said one: ``{"raster": {"unit": name}}``."""
        return self.schema.metadata

    @property
    def frame(self) -> Frame:
        """The projection plane, which is that of x and y."""
        return resolve_plane("xy", np.empty((0, 3)))

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest rectangle around all vertices: xmin, ymin, xmax, ymax."""
        west, south, _, east, north, _ = box_of(self)
        return west, south, east, north

    @property
    def classes(self) -> dict[int, int]:
        """The rows of each class of lidar that were taken; empty if the source has no classes."""
        counts: Counter[int] = Counter()
        for chunk in self.manifest["chunks"]:
            counts.update({int(each): rows for each, rows in chunk.get("classes", {}).items()})
        return dict(sorted(counts.items()))


def box_of(tiled: TiledSurfaceData) -> tuple[float, ...]:
    """Return the least and the greatest coordinates: xmin, ymin, zmin, xmax, ymax, zmax."""
    return tuple(tiled.manifest["surface"]["box"])


def plan_of(tiled: TiledData) -> Plan:
    """Read where the tiles are: another plan cannot make wrong triangles right."""
    path = tiled.folder / PLAN
    if digest_of(path) != tiled.manifest["files"][PLAN]["sha256"]:
        raise FormatError(f"{path}: damaged: tile the source again")
    return Plan.from_dict(load_json(path))


def cuts_of(tiled: TiledData) -> tuple[Floats, tuple[float, float, float, float]]:
    """Return the ends of the cuts between tiles, the first cut first, and bounds of all tiles.

    Without heights no file has coordinates: then they reach a quarter beyond the cuts.
    """
    plan = plan_of(tiled)
    if isinstance(tiled, TiledSurfaceData):
        return plan.lines(tiled.bounds), tiled.bounds
    left, low, right, high = planar_bounds(plan.at)
    beyond = max(right - left, high - low) / 4
    bounds = left - beyond, low - beyond, right + beyond, high + beyond
    return plan.lines(bounds), bounds


def stated_files(tiled: TiledData) -> dict[str, Mapping[str, Any]]:
    """Return what the manifest says of each file."""
    shards = {shard["file"]: shard for shard in tiled.manifest["shards"]}
    return {**shards, **tiled.manifest["files"]}


def is_intact(tiled: TiledData) -> bool:
    """Whether every file has the SHA-256 that the manifest states."""
    return is_sound(tiled.folder, tiled._digests)  # noqa: SLF001 - kept for the functions here


def array_of(tiled: TiledData, name: str, kind: Any, count: int | None, *shape: int) -> Array:
    """Map a file, which has to be as the manifest says unless the folder is being proved."""
    path = tiled.folder / name
    if _is_checked(tiled):
        sound(path, tiled._digests[name])  # noqa: SLF001 - as above
    array = mapped(path)
    length = (count,) if count is not None and _is_checked(tiled) else array.shape[:1]
    if array.dtype != kind or array.shape != (*length, *shape):
        raise damaged(path, f"{array.shape} of {array.dtype}")
    return array


def _is_checked(tiled: TiledData) -> bool:
    return not isinstance(tiled, UnprovedData)


def blocks_of(tiled: TiledData) -> Iterator[Integers]:
    """Yield the triangles of one shard after the other."""
    for path, stated in zip(tiled.shards, tiled.manifest["shards"], strict=True):
        yield open_shard(path, stated if _is_checked(tiled) else None)


def all_triangles(tiled: TiledData) -> Integers:
    """Read the triangles of all shards."""
    triangles = np.empty((tiled.nsimplex, 3), dtype=np.int64)
    at = 0
    for block in blocks_of(tiled):
        triangles[at : at + len(block)] = block
        at += len(block)
    return triangles


def neighbor_pairs(tiled: TiledData, shard: int) -> Integers:
    """Read the neighbours of a shard: the shard and the row beyond each edge."""
    if not tiled.manifest["neighbors"]:
        raise InputError(
            f"{tiled.folder} has no neighbours: tile again with {Option('neighbors', True)}, "
            f"{Option('resume', False)}"
        )
    name, counts = tiled.shards[shard].name, np.array(_counts(tiled))
    rows = array_of(tiled, neighbors_name(name), np.int32, counts[shard], 3)
    links = array_of(tiled, links_name(name), np.int64, None, 3)
    side, beyond, there = links.T
    is_right = (side >= 0) & (side < 3 * len(rows)) & (beyond >= 0) & (beyond < len(counts))
    is_right &= (there >= 0) & (there < counts[np.where(is_right, beyond, 0)])
    if not is_right.all() or not within(rows, -1, len(rows)):
        raise damaged(tiled.folder / neighbors_name(name), "neighbours that are not there")
    return as_pairs(shard, rows, links)


def as_pairs(shard: int, neighbors: Array, links: Integers) -> Integers:
    """Put the two files of a shard together."""
    pairs = np.empty((*neighbors.shape, 2), dtype=np.int64)
    pairs[:, :, 0] = np.where(neighbors < 0, -1, shard)
    pairs[:, :, 1] = neighbors
    pairs.reshape(-1, 2)[links[:, 0]] = links[:, 1:]
    return pairs


def all_neighbors(tiled: TiledData) -> Integers:
    """Read the neighbours of all shards, as rows of `all_triangles`."""
    begins = np.cumsum([0, *_counts(tiled)[:-1]])
    neighbors = np.empty((tiled.nsimplex, 3), dtype=np.int64)
    for number, begin in enumerate(begins):
        pairs = neighbor_pairs(tiled, number)
        shard, row = pairs[:, :, 0], pairs[:, :, 1]
        neighbors[begin : begin + len(pairs)] = np.where(shard < 0, -1, begins[shard] + row)
    return neighbors


def _counts(tiled: TiledData) -> list[int]:
    return [shard["triangles"] for shard in tiled.manifest["shards"]]


def report_of(tiled: TiledData) -> Report:
    """Say what became of every row."""
    pairs, skipped = tiled.duplicates, tiled.skipped
    left_out = np.concatenate([pairs[:, 0], skipped])
    order = np.argsort(left_out, kind="stable")
    representatives = np.concatenate([pairs[:, 1], np.full_like(skipped, -1)])
    return Report(
        n_rows=tiled.npoints,
        n_used=tiled.npoints - len(left_out),
        n_duplicates=len(pairs),
        n_overhangs=0,
        n_skipped=len(skipped),
        n_triangles=tiled.nsimplex,
        policy="first",
        seconds={},
        left_out=left_out[order],
        representatives=representatives[order],
    )


def surface_report(tiled: TiledSurfaceData) -> Report:
    """Say what became of every row of a surface."""
    report, said = report_of(tiled), tiled.manifest["surface"]
    overhangs = int(said["overhangs"])
    return replace(
        report,
        n_duplicates=report.n_duplicates - overhangs,
        n_overhangs=overhangs,
        policy=said["on_duplicate"],
        columns=tiled.schema.columns,
        color_depth=tiled.schema.color_depth,
        classes=tiled.classes,
    )


def vertices_of(tiled: TiledSurfaceData) -> Iterator[Array]:
    """Yield the vertices of one shard after the other."""
    return (shard_vertices(tiled, shard) for shard in tiled.manifest["shards"])


def faces_of(tiled: TiledSurfaceData) -> Iterator[Rows]:
    """Yield the faces of one shard after the other."""
    return (shard_faces(tiled, shard) for shard in tiled.manifest["shards"])


def meshes_of(tiled: TiledSurfaceData) -> Iterator[Cloud]:
    """Yield each shard as a mesh of its own."""
    for vertices, faces in zip(vertices_of(tiled), faces_of(tiled), strict=True):
        cloud = cloud_from(vertices, tiled.schema)
        values = {**cloud.attributes, "row": np.ascontiguousarray(vertices["row"])}
        yield replace(cloud, attributes=values, faces=np.array(faces))


def shard_vertices(tiled: TiledSurfaceData, shard: Mapping[str, Any]) -> Array:
    """Map the vertices of a shard."""
    kind = np.dtype([ROW, *POSITION, *tiled.schema.fields])
    return array_of(tiled, vertices_name(shard["file"]), kind, shard["vertices"])


def shard_faces(tiled: TiledSurfaceData, shard: Mapping[str, Any]) -> Rows:
    """Map the faces of a shard."""
    name = faces_name(shard["file"])
    faces: Rows = array_of(tiled, name, np.int32, shard["triangles"], 3)
    if not within(faces, 0, shard["vertices"]):
        raise damaged(tiled.folder / name, "corners that are no vertices")
    return faces


def delayed_shards(tiled: TiledData) -> list[Any]:
    """Return the shards as delayed objects of Dask."""
    delayed = load("dask", extra="dask").delayed
    return [
        delayed(read_shard)(
            path, shard, dask_key_name=f"triangles-{path.stem}-{shard['sha256'][:16]}"
        )
        for path, shard in zip(tiled.shards, tiled.manifest["shards"], strict=True)
    ]


def dask_simplices(tiled: TiledData) -> Any:
    """Return the triangles as an array of Dask."""
    return _dask_array(tiled, delayed_shards(tiled), 3)


def dask_neighbors(tiled: TiledData) -> Any:
    """Return the neighbours as an array of Dask."""
    delayed = load("dask", extra="dask").delayed
    blocks = [
        delayed(partial(neighbor_pairs, tiled))(
            number, dask_key_name=f"neighbors-{shard['sha256'][:16]}-{number}"
        )
        for number, shard in enumerate(tiled.manifest["shards"])
    ]
    return _dask_array(tiled, blocks, 3, 2)


def dask_dataframe(tiled: TiledData) -> Any:
    """Return the triangles as a DataFrame of Dask."""
    frame = load("dask.dataframe", extra="dask")
    return frame.from_dask_array(dask_simplices(tiled), columns=["a", "b", "c"])


def _dask_array(tiled: TiledData, delayed: Sequence[Any], *shape: int) -> Any:
    array = load("dask.array", extra="dask")
    return array.concatenate(
        [
            array.from_delayed(each, (count, *shape), np.int64)
            for each, count in zip(delayed, _counts(tiled), strict=True)
        ]
    )
