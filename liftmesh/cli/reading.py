"""The options by which commands about surfaces read and trim them, as one group."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftmesh.base.options import NonFinite
from liftmesh.cli import groups, options, rows, surfaces, tables
from liftmesh.cli.trimming import trimmed, with_options as with_trimming

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


@dataclass(frozen=True)
class Reading:
    """How surfaces are read."""

    file_format: str | None
    plane: Any
    nonfinite: NonFinite
    threads: int | None
    max_bytes: int | None
    trimming: dict[str, Any]
    table: dict[str, Any]
    selection: dict[str, Any]

    @property
    def polygon(self) -> Path | None:
        """The file of a polygon to trim by."""
        return self.trimming.get("polygon")

    def untrimmed(self, path: Path) -> Surface:
        """Read a file as a surface."""
        return surfaces.read(
            path,
            self.file_format,
            self.plane,
            nonfinite=self.nonfinite,
            threads=self.threads,
            max_bytes=self.max_bytes,
            table=self.table,
            selection=self.selection,
        )

    def surface(self, path: Path) -> Surface:
        """Read a file as a surface and trim it."""
        return trimmed(self.untrimmed(path), self.trimming)


@tables.with_options
@rows.with_options
@with_trimming
def parse(
    source_format: options.SourceFormat = None,
    plane: options.Plane = "xy",
    nonfinite: options.SkipNonFinite = "error",
    trimming: Any = None,
    threads: options.Threads = None,
    table: Any = None,
    selection: Any = None,
    max_bytes: options.MaxBytes = None,
) -> Reading:
    """Check the options."""
    frame, count = options.parse_plane(plane), options.parse_threads(threads)
    limit = options.parse_size(max_bytes)
    return Reading(source_format, frame, nonfinite, count, limit, trimming, table, selection)


with_options = groups.taking("reading", parse)
