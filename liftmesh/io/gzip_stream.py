"""Text compressed with gzip, decompressed as it is read.

Readers go back a little, to the end of the last whole line, and a few times to the beginning: the
last megabytes are held for the one, and the other begins anew. So memory is bounded, whatever the
file expands to. What it does expand to is counted once, before anything is read, and limited.
"""

from __future__ import annotations

import io
import os
import zlib
from collections import deque
from typing import TYPE_CHECKING, BinaryIO, cast

from liftmesh.errors import FormatError
from liftmesh.io.limits import limit_of
from liftmesh.io.streams import remaining

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

_MAGIC = b"\x1f\x8b"
_GROWTH = 20  # by default text may take so many times the file

_BLOCK = 1 << 16
_COMPRESSED = 1 << 13  # bytes of the file at a time, which every member in them copies
_HELD = 40  # blocks: more than readers take at a time, and the buffer before them
_GZIP = 31  # zlib's windowBits for gzip


def is_compressed(stream: BinaryIO) -> bool:
    """Whether a seekable stream begins like a gzip file, as no text does."""
    begin = stream.tell()
    magic = stream.read(2)
    stream.seek(begin)
    return magic == _MAGIC


def decompressed(stream: BinaryIO, name: str, max_bytes: int | None) -> BinaryIO:
    """Return the text of a stream if it is compressed, else the stream itself."""
    if not is_compressed(stream):
        return stream
    limit = limit_of(max_bytes, _GROWTH * remaining(stream))
    return cast("BinaryIO", io.BufferedReader(_Text(stream, name, limit), _BLOCK))


class _Text(io.RawIOBase):
    """The text of a gzip file: blocks, of which the last are held."""

    def __init__(self, stream: BinaryIO, name: str, limit: int) -> None:
        self._stream = stream
        self._name = name
        self._limit = limit
        self._begin = stream.tell()
        self._place = 0
        self._restart()
        while self._next():
            pass
        self._size = self._end
        self._restart()

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._place

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size}[whence]
        self._place = max(base + offset, 0)
        return self._place

    def readinto(self, buffer: WriteableBuffer) -> int:
        memory = memoryview(buffer).cast("B")
        if self._place < self._end - sum(map(len, self._blocks)):
            self._restart()
        while self._place >= self._end and self._next():
            pass
        begin = self._end
        for block in reversed(self._blocks):
            begin -= len(block)
            if begin <= self._place:
                part = block[self._place - begin :][: len(memory)]
                memory[: len(part)] = part
                self._place += len(part)
                return len(part)
        return 0

    def _restart(self) -> None:
        self._stream.seek(self._begin)
        self._decoder = zlib.decompressobj(_GZIP)
        self._waiting = b""
        self._blocks: deque[bytes] = deque(maxlen=_HELD)
        self._end = 0  # of the last block, in the text

    def _next(self) -> bool:
        """Decompress a block; False at the end."""
        try:
            block = self._decompressed()
        except zlib.error as error:
            raise self._damaged(str(error)) from error
        if block:
            self._blocks.append(block)
            self._end += len(block)
            if self._end > self._limit:  # nobody knows by how much
                raise FormatError(
                    f"{self._name}: its text expands to more than the limit of {self._limit:,} "
                    "bytes: if you trust the file, raise it with max_bytes="
                )
        return bool(block)

    def _decompressed(self) -> bytes:
        while True:
            if self._decoder.eof and not self._has_member():
                return b""
            data = self._waiting or self._stream.read(_COMPRESSED)
            block = self._decoder.decompress(data, _BLOCK)
            self._waiting = self._decoder.unconsumed_tail
            if block:
                return block
            if not data and not self._decoder.eof:
                raise self._damaged("the file is truncated")

    def _has_member(self) -> bool:
        """Begin with the next member, if there is one; zeros may follow the last."""
        rest = self._decoder.unused_data or self._stream.read(_COMPRESSED)
        while rest and not rest.strip(b"\0"):
            rest = self._stream.read(_COMPRESSED)
        self._waiting = rest.lstrip(b"\0")
        if self._waiting:
            self._decoder = zlib.decompressobj(_GZIP)
        return bool(self._waiting)

    def _damaged(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: not a valid gzip file: {cause}")
