"""A file on a disk of which some bytes cannot be read."""

from __future__ import annotations

import io
from typing import Any


class Failing(io.BytesIO):
    """Raises an error when bytes of a range are read."""

    def __init__(self, data: bytes, bad: range, error: BaseException) -> None:
        super().__init__(data)
        self._bad = bad
        self._error = error

    def read(self, size: int | None = -1) -> bytes:
        start = self.tell()
        data = super().read(size)
        self._check(start)
        return data

    def readinto(self, memory: Any) -> int:
        start = self.tell()
        count = super().readinto(memory)
        self._check(start)
        return count

    def _check(self, start: int) -> None:
        if start < self._bad.stop and self.tell() > self._bad.start:
            raise self._error
