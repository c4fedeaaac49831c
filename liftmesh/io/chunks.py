"""Readers of chunks: of formats that are read whole, and of colours whose depth all rows decide."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.format import ChunkReader, Reader


def split(reader: Reader) -> ChunkReader:
    """Make a chunk reader from a reader of whole files."""

    def chunks(stream: BinaryIO, name: str, rows: int) -> Iterator[Cloud]:
        cloud = reader(stream, name)
        for start in range(0, len(cloud), rows):
            yield cloud.select(slice(start, start + rows))

    return chunks


def of_one_depth(chunks: ChunkReader, known: int | None) -> ChunkReader:
    """Make a chunk reader that decides the depth of colours once, from all chunks of a file."""

    def uniform(stream: BinaryIO, name: str, rows: int) -> Iterator[Cloud]:
        begin = stream.tell()
        pieces = chunks(stream, name, rows)
        first = next(pieces, None)
        if first is None:
            return
        if known is not None or first.color_depth is None:
            yield first
            yield from pieces
            return
        depths = [first.color_depth, *map(_depth, pieces)]
        depth = None if None in depths else max(filter(None, depths))
        stream.seek(begin)
        for piece in chunks(stream, name, rows):
            yield piece if depth is None else piece.with_color_depth(depth)

    return uniform


def _depth(piece: Cloud) -> int | None:
    is_narrow = piece.colors is not None and piece.colors.dtype == np.uint8
    return 8 if is_narrow else piece.color_depth
