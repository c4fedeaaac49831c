"""Helpers for binary streams: seekable, of known size, and exact reads."""

from __future__ import annotations

import io
import os
from typing import BinaryIO

from liftmesh.errors import FormatError


def seekable(stream: BinaryIO) -> BinaryIO:
    """Return the stream, or its content in memory if it is a pipe."""
    return stream if stream.seekable() else io.BytesIO(stream.read())


def remaining(stream: BinaryIO) -> int:
    """Count the bytes between the position of a seekable stream and its end."""
    here = stream.tell()
    end = stream.seek(0, os.SEEK_END)
    stream.seek(here)
    return max(end - here, 0)


def read_exactly(stream: BinaryIO, size: int, name: str, what: str) -> bytes:
    """Read ``size`` bytes or raise; never ask for more than the stream holds."""
    here, left = stream.tell(), remaining(stream)
    data = stream.read(size) if size <= left else b""
    if len(data) != size:
        raise FormatError(
            f"{name}: byte {here}: {what} should take {size} bytes, but the file ends after "
            f"{left}: it is truncated, or its header is wrong"
        )
    return data
