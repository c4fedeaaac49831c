"""A part of a stream as if it began there: lazrs states places from the beginning of a file."""

from __future__ import annotations

import io
from typing import BinaryIO


class OffsetStream:
    """A stream whose places count from another one's ``begin``."""

    def __init__(self, stream: BinaryIO, begin: int) -> None:
        self._stream = stream
        self._begin = begin

    def seek(self, place: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place."""
        place += self._begin if whence == io.SEEK_SET else 0
        return self._stream.seek(place, whence) - self._begin

    def tell(self) -> int:
        """Return the place."""
        return self._stream.tell() - self._begin

    def read(self, size: int = -1) -> bytes:
        """Read bytes."""
        return self._stream.read(size)
