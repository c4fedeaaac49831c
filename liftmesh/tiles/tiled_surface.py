"""`TiledSurface`: a surface whose triangles and vertices lie in the files of a folder."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Rows
from liftmesh.terrain.frame import resolve_plane
from liftmesh.tiles.schema import POSITION, ROW, Schema, cloud_from
from liftmesh.tiles.store import damaged, within
from liftmesh.tiles.surface_files import faces_name, vertices_name
from liftmesh.tiles.surface_lines import Contouring
from liftmesh.tiles.surface_raster import Rasterizing
from liftmesh.tiles.tiled import Tiled

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.terrain.frame import Frame
    from liftmesh.terrain.report import Report


@dataclass(frozen=True)
class TiledSurface(Rasterizing, Contouring, Tiled):
    """A surface in shards, as returned by `tile_surface` and `open_tiled`.

    Triangles, corners and values are those of `triangulate` for all rows. Triangles name the rows
    that the policy has chosen, as `Surface.faces` does, and `duplicates` the rows that it has not
    chosen, each with the one at its position that it has.

    Attributes
    ----------
    directory : pathlib.Path
        The folder with the shards.
    manifest : dict
        As of a `Tiled`; the entry "surface" says policy, coordinate system, values and extent.

    Examples
    --------
    >>> import tempfile
    >>> import liftmesh
    >>> points = np.random.default_rng(0).random((1000, 3))
    >>> tiled = liftmesh.tile_surface(points, tempfile.mkdtemp(), tile_rows=300)
    >>> tiled
    <TiledSurface: 1976 triangles over 1000 rows in 7 shards>
    >>> np.array_equal(tiled.raster(0.1).values, liftmesh.triangulate(points).raster(0.1).values,
    ...                equal_nan=True)
    True
    """

    def __repr__(self) -> str:
        return super().__repr__().replace("<Tiled:", "<TiledSurface:")

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
    def extent(self) -> tuple[float, ...]:
        """The least and the greatest coordinates: xmin, ymin, zmin, xmax, ymax, zmax."""
        return tuple(self.manifest["surface"]["extent"])

    @property
    def report(self) -> Report:
        """What became of every row, as from `triangulate`, with rows of 64 bits.

        It holds 16 bytes for each row that is left out; `duplicates` and `skipped` map files.
        """
        report = super().report
        said = self.manifest["surface"]
        overhangs = int(said["overhangs"])
        return replace(
            report,
            duplicates=report.duplicates - overhangs,
            overhangs=overhangs,
            policy=said["duplicates"],
            columns=self.schema.columns,
            color_depth=self.schema.color_depth,
            classes=self.classes,
        )

    @property
    def classes(self) -> dict[int, int]:
        """The rows of each class of lidar that were taken; empty if the source has no classes."""
        found: Counter[int] = Counter()
        for chunk in self.manifest["chunks"]:
            found.update({int(each): rows for each, rows in chunk.get("classes", {}).items()})
        return dict(sorted(found.items()))

    def vertices(self) -> Iterator[Array]:
        """Yield the vertices of one shard after the other.

        Yields
        ------
        (v,) structured ndarray
            The corners of its triangles by ascending row: the fields row, x, y and z, then colours,
            normals and named values, of their own types; mapped, not read.

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
        >>> tiled = liftmesh.tile_surface([[0, 0, 5], [1, 0, 6], [0, 1, 7]], tempfile.mkdtemp())
        >>> [each["z"].tolist() for each in tiled.vertices()]
        [[5.0, 6.0, 7.0]]
        """
        yield from map(self._vertices, self.manifest["shards"])

    def faces(self) -> Iterator[Rows]:
        """Yield the triangles of one shard after the other, as numbers of its vertices.

        Yields
        ------
        (m, 3) ndarray of int32
            The triangles that `blocks` yields; mapped, not read.

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
        >>> tiled = liftmesh.tile_surface([[0, 0, 5], [1, 0, 6], [0, 1, 7]], tempfile.mkdtemp())
        >>> [each.tolist() for each in tiled.faces()]
        [[[0, 1, 2]]]
        """
        yield from map(self._faces, self.manifest["shards"])

    def meshes(self) -> Iterator[Cloud]:
        """Yield each shard as a mesh of its own.

        Yields
        ------
        Cloud
            The vertices of the shard with their values, the numbers of their rows among them as
            ``row``, and faces between them.

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
        >>> tiled = liftmesh.tile_surface([[0, 0, 5], [1, 0, 6], [0, 1, 7]], tempfile.mkdtemp())
        >>> [(len(mesh), mesh.faces.tolist()) for mesh in tiled.meshes()]
        [(3, [[0, 1, 2]])]
        """
        for vertices, faces in zip(self.vertices(), self.faces(), strict=True):
            cloud = cloud_from(vertices, self.schema)
            values = {**cloud.attributes, "row": np.ascontiguousarray(vertices["row"])}
            yield replace(cloud, attributes=values, faces=np.array(faces))

    def _vertices(self, shard: Mapping[str, Any]) -> Array:
        kind = np.dtype([ROW, *POSITION, *self.schema.fields])
        return self._mapped(vertices_name(shard["file"]), kind, shard["vertices"])

    def _faces(self, shard: Mapping[str, Any]) -> Rows:
        name = faces_name(shard["file"])
        faces: Rows = self._mapped(name, np.int32, shard["triangles"], 3)
        if not within(faces, 0, shard["vertices"]):
            raise damaged(self.directory / name, "corners that are no vertices")
        return faces
