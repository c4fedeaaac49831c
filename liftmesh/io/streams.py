"""Binary streams as readers need them: seekable, of known size, read exactly or not at all."""

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
    """Read ``size`` bytes, or say where the file ends; never ask for more than is there."""
    here, left = stream.tell(), remaining(stream)
    data = stream.read(size) if size <= left else b""
    if len(data) != size:
        raise FormatError(
            f"{name}: byte {here}: {what} should take {size} bytes, but the file ends after "
            f"{left}: it is cut short, or its header is wrong"
        )
    return data
