"""A stream that remembers why it failed: lazrs tells errors of a stream as damage of its own."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO


class ErrorRecordingStream:
    """A stream that is read, and the first error of reading it."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self.failure: OSError | None = None
        if hasattr(stream, "readinto"):  # which laspy asks for, as it spares a copy
            self.readinto = self._readinto

    def seek(self, place: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place."""
        with self._remembered():
            return self._stream.seek(place, whence)

    def tell(self) -> int:
        """Return the place."""
        with self._remembered():
            return self._stream.tell()

    def read(self, size: int = -1) -> bytes:
        """Read bytes."""
        with self._remembered():
            return self._stream.read(size)

    def _readinto(self, memory: Any) -> int:
        with self._remembered():
            count: int = self._stream.readinto(memory)  # type: ignore[attr-defined]
            return count

    @contextmanager
    def _remembered(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.failure = self.failure or error
            raise
