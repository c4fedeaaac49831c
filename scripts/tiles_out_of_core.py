"""Triangulate generated points twice, in different tiles, without keeping the triangles.

    python scripts/tiles_out_of_core.py --n 100000000
    python scripts/tiles_out_of_core.py --n 1000000000      24 GB of disk, under an hour

The points are uniform, and made again whenever a chunk of them is read, so they take no disk. Each
shard is hashed when it would be written, and an empty file written instead; so the disk holds the
scratch folder alone, 24 bytes a point. The sum of the hashes does not depend on the tiles: it has
to be equal for both. Shown are the seconds of the processor and of the clock, and the peak memory.
"""

from __future__ import annotations

from argparse import ArgumentParser, RawDescriptionHelpFormatter
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any
from unittest.mock import patch

import numpy as np
from benchmark.contest import SEED
from benchmark.measuring import load
from benchmark.tasks.tiles import MIXERS, mark_of
from distributions import Points
from process_state import memory

from liftmesh.tiles.build import triangulated
from liftmesh.tiles.options import Options
from liftmesh.tiles.schedule import Serial
from liftmesh.tiles.schema import PLANAR, Schema, records_of_points
from liftmesh.tiles.source_chunks import Origin
from liftmesh.tiles.store import save_array
from liftmesh.tiles.tiled import open_tiled

_CHUNK = 1_000_000


@dataclass(frozen=True)
class Generated:
    """Rows that are made when they are read."""

    number: int
    rows: int
    place: None = None
    schema: Schema = PLANAR

    @property
    def origin(self) -> Origin:
        """The first row."""
        return Origin("generated", row=self.number * _CHUNK)

    def points(self) -> Points:
        """Make the rows: the same each time, whatever chunks came before."""
        return np.random.default_rng((SEED, self.number)).random((self.rows, 2))

    def records(self) -> Any:
        """Return them as tiles read them."""
        return records_of_points(self.points(), PLANAR, "generated")


class Generator(Serial):
    """Works on generated chunks, whatever the source."""

    def chunks(self, source: Any, *_: Any) -> list[Any]:
        """Cut the number of rows into chunks."""
        begins = range(0, source, _CHUNK)
        return [Generated(k, min(_CHUNK, source - begin)) for k, begin in enumerate(begins)]


def main() -> None:
    """Print a line for each size of tiles, and whether the hashes are equal."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=100_000_000, metavar="ROWS")
    sizes = (1_500_000, 1_000_000)
    parser.add_argument("--tile-rows", type=int, nargs="+", default=sizes, metavar="ROWS")
    parser.add_argument("--folder", metavar="FOLDER", help="where the scratch folder is made")
    options = parser.parse_args()
    marks = [hashed(options.n, rows, options.folder) for rows in options.tile_rows]
    print("equal" if len(set(marks)) == 1 else "DIFFERENT")


def hashed(n: int, tile_rows: int, folder: str | None) -> str:
    """Triangulate, say what it took, and return the hash."""
    sums = np.zeros(len(MIXERS), np.uint64)

    def hash_shard(path: Path, triangles: Any, _: Any) -> str:
        nonlocal sums
        sums = sums + mark_of(triangles)
        return save_array(path, triangles[:0])

    begin, before = perf_counter(), process_time()
    with (
        TemporaryDirectory(dir=folder) as place,
        patch("liftmesh.tiles.schedule.save_shard", hash_shard),
    ):
        options = Options.validated(place, tile_rows, None, "error", True, "npy", False)
        found = open_tiled(triangulated(n, options, Generator(1)))
    mark = "".join(f"{each:016x}" for each in sums)
    print(
        f"{n:,} rows in {found.manifest['merges']['tiles']:,} tiles: {found.nsimplex:,} triangles, "
        f"{process_time() - before:.0f} s of the processor, {perf_counter() - begin:.0f} s, "
        f"{memory('VmHWM') / 1e6:.0f} MB, {load()}, {mark}",
        flush=True,
    )
    return mark


if __name__ == "__main__":
    main()
