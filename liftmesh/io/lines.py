"""The lines of a text file, read in blocks.

A block of bytes ends with the last line end in it, whether the file ends its lines with LF, CR LF
or CR: so a block is small, and only a line longer than that makes it larger. Its lines are found,
stripped and numbered together.
"""

from __future__ import annotations

import os
import re
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Integers, Mask
from liftmesh.errors import FormatError

BLOCK = 1 << 17  # lines taken at a time, at most

_BYTES = 1 << 19

_BLANKS_BEHIND = re.compile(rb"\\[ \t\v\f]+(?=\n|\Z)")


@dataclass(frozen=True, slots=True)
class Block:
    """Stripped lines, and the number of each in the file, counted from 1.

    ``long`` tells that a line may be longer than a block is by itself.
    """

    texts: list[str]
    numbers: Integers
    long: bool = False

    def __len__(self) -> int:
        return len(self.texts)

    def __iter__(self) -> Iterator[tuple[str, int]]:
        return zip(self.texts, self.numbers.tolist(), strict=True)

    def __getitem__(self, rows: slice | Mask) -> Block:
        if isinstance(rows, slice):
            return Block(self.texts[rows], self.numbers[rows], self.long)
        texts = [self.texts[k] for k in np.flatnonzero(rows).tolist()]
        return Block(texts, self.numbers[rows], self.long)


class Lines:
    """The non-empty lines of a stream, taken block by block.

    Empty lines are skipped but counted. With ``comments``, so are lines that begin with one of
    them, and a ``#`` and the text after it are removed. With ``continued``, a backslash at the end
    of a line joins it to the next. ``blanks`` are stripped from both ends of a line, by default all
    white space. ``number`` is that of the last line taken.
    """

    def __init__(
        self,
        stream: BinaryIO,
        name: str,
        *,
        encoding: str = "latin-1",
        comments: tuple[str, ...] = (),
        continued: bool = False,
        before: int = 0,
        blanks: str | None = None,
    ) -> None:
        self.number = before
        self._blanks = blanks
        self._stream = stream
        self._name = name
        self._encoding = encoding
        self._comments = comments
        self._continued = continued
        self._read = before
        self._held = Block([], np.empty(0, dtype=np.int64))
        self._taken = 0

    def take(self, count: int) -> Block:
        """Take at most ``count`` lines; fewer if that is faster, none at the end."""
        if not count or not self._fill():
            return self._held[:0]
        block = self._held
        if self._taken or count < len(block):
            block = block[self._taken : self._taken + count]
        self._taken += len(block)
        self.number = int(block.numbers[-1])
        return block

    def next(self) -> str:
        """Take one line; an empty string at the end."""
        if not self._fill():
            return ""
        self.number = int(self._held.numbers[self._taken])
        self._taken += 1
        return self._held.texts[self._taken - 1]

    def _fill(self) -> bool:
        """Hold lines that are not taken; False at the end."""
        while self._taken == len(self._held):
            self._held, self._taken = self._held[:0], 0  # not two blocks at a time
            data = self._chunk()
            if not data:
                return False
            self._held, self._taken = self._block(data), 0
        return True

    def _chunk(self) -> bytes:
        """Read whole lines, and those that continue the last of them."""
        parts: list[bytes] = []
        while data := self._stream.read(_BYTES):
            parts.append(data)
            # CR as the last byte may be half of a line end.
            end = max(data.rfind(b"\n"), data.rfind(b"\r", 0, len(data) - 1)) + 1
            if end and not (self._continued and _continues(data[:end])):
                self._stream.seek(end - len(data), os.SEEK_CUR)
                parts[-1] = data[:end]
                break
        return b"".join(parts)

    def _decoded(self, data: bytes) -> str:
        try:
            return data.decode(self._encoding)
        except UnicodeDecodeError as error:
            begin = data.rfind(b"\n", 0, error.start) + 1
            line = self._read + 1 + data.count(b"\n", 0, error.start)
            raise FormatError(
                f"{self._name}: line {line}: byte {error.start - begin} of the line "
                f"(0x{data[error.start]:02x}) is not UTF-8: save the file as UTF-8 text, or if it "
                "is Windows-1252, read it with encoding='cp1252'"
            ) from error

    def _block(self, data: bytes) -> Block:
        if b"\r" in data:
            data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        data, last = data.removesuffix(b"\n"), None
        if self._continued and b"\\" in data:
            data = _BLANKS_BEHIND.sub(rb"\\", data).removesuffix(b"\\")
            last = _last_of_lines(data)
            data = data.replace(b"\\\n", b"  ")
        text = self._decoded(data)
        texts = [line.strip(self._blanks) for line in text.split("\n")]
        numbers = np.arange(self._read + 1, self._read + 1 + len(texts if last is None else last))
        self._read += len(numbers)
        if any(mark in text for mark in self._comments):
            texts = [self._bare(line) for line in texts]
        block = Block(texts, numbers if last is None else numbers[last], len(data) > _BYTES)
        return block if all(texts) else block[np.fromiter(map(bool, texts), bool, len(texts))]

    def _bare(self, text: str) -> str:
        return (
            "" if text.startswith(self._comments) else text.partition("#")[0].rstrip(self._blanks)
        )


def _continues(data: bytes) -> bool:
    """Whether the next line continues the last of these; also if it begins before them."""
    body = data[:-1].removesuffix(b"\r")
    line = body[max(body.rfind(b"\n"), body.rfind(b"\r")) + 1 :].rstrip()
    return line.endswith(b"\\") or (not line and b"\n" not in body and b"\r" not in body)


def _last_of_lines(data: bytes) -> Mask:
    """Whether each line is the last of those that continuation joins."""
    octets = np.frombuffer(data, np.uint8)
    ends = octets == ord("\n")
    joined = np.zeros(len(octets), dtype=bool)
    joined[1:] = ends[1:] & (octets[:-1] == ord("\\"))
    last = np.ones(np.count_nonzero(ends) + 1, dtype=bool)
    last[:-1] = ~joined[ends]
    return last


def promised(lines: Lines, wanted: int, what: str, name: str) -> Iterator[Block]:
    """Take as many lines as a header promises; raise if there are fewer."""
    left = wanted
    while left:
        block = lines.take(min(left, BLOCK))
        if not len(block):
            raise FormatError(
                f"{name}: line {lines.number}: the header promises {wanted} {what}, but "
                f"{wanted - left} are there: the file is truncated, or its header is wrong"
            )
        yield block
        left -= len(block)


def leading_comments(
    stream: BinaryIO, name: str, *, encoding: str = "latin-1", marks: tuple[str, ...] = ("#",)
) -> Generator[str, None, None]:
    """Yield the comments at the top of a file, and restore the position of the stream."""
    begin = stream.tell()
    lines = Lines(stream, name, encoding=encoding)
    try:
        while (line := lines.next()).startswith(marks):
            yield line.lstrip("".join(marks) + " \t")
    finally:
        stream.seek(begin)
