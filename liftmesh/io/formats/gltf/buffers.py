"""The buffers of a glTF file: bytes inside it, as base64, or files in its folder.

The author of a file is not trusted to choose among all files of the machine, nor to use its
network: only buffers in the file's own folder are read. Names that lead out of it, by ``..``, from
the root, through a link or to a server, are rejected.

Many buffers may have one address, which may be megabytes long, and many addresses may lead to one
file. So addresses are compared once: from then on each buffer is known by the number of the first
with the same content, which is read once, and of a file no more than the buffers state.

The first buffer of a GLB file may be its binary chunk, which can be longer than the buffer. Other
buffers without an address have no data: they stand for what a compression leaves out.
"""

from __future__ import annotations

import base64
import errno
import os
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO
from urllib.parse import unquote

from liftmesh.errors import FormatError
from liftmesh.io.streams import read_exactly, read_most

_PACKED = ";base64,"

# Some programs break base64 into lines.
_BREAKS = "\n\r\t "

# Longer names are of no file; to look for one takes time in proportion to the square of its length.
_LONGEST_NAME = 4096
# How the system says that a name is that of no file.
_ABSENT = (errno.ENOENT, errno.ENOTDIR, errno.ELOOP, errno.ENAMETOOLONG)


@dataclass(frozen=True, slots=True)
class Chunk:
    """The place of the binary chunk of a GLB file."""

    stream: BinaryIO
    begin: int
    size: int


@dataclass(frozen=True, slots=True)
class StatedBuffer:
    """What a file says of a buffer."""

    uri: str | None  # None: the binary chunk
    size: int | None  # bytes; None: all that there are
    is_fallback: bool  # for readers that cannot decompress: without data


@dataclass(slots=True)
class _File:
    """A file beside: its bytes, and how many of them its buffers state at most."""

    path: Path
    there: int
    size: int = 0


class Buffers:
    """The buffers of a file by number, each read when it is first asked for."""

    def __init__(self, stated: Sequence[StatedBuffer], chunk: Chunk | None, name: str) -> None:
        self._stated = stated
        self._chunk = chunk
        self._name = name
        self._files: dict[int, _File] = {}
        self._firsts = self._numbered()
        self._contents: dict[int, bytes] = {}

    def __getitem__(self, number: int) -> memoryview:
        stated, what = self._stated[number], f"buffers[{number}]"
        if stated.uri is None and (number or stated.is_fallback):
            raise self._without_data(what)
        first = self._firsts[number]
        if first not in self._contents:
            self._contents[first] = self._read(first, what)
        content = memoryview(self._contents[first])
        if stated.size is not None and stated.size > len(content):
            raise FormatError(
                f"{self._name}: not a valid file: {what}: byteLength is {stated.size}, but its "
                f"data have {len(content)} bytes: the file is truncated, or its counts are wrong"
            )
        return content[: stated.size]

    def __len__(self) -> int:
        return len(self._stated)

    def beside(self) -> int:
        """Return how many bytes of the files beside this one are stated, without reading them."""
        return sum(each.size for each in self._files.values())

    def used_beside(self) -> int:
        """Return how many bytes of the files beside this one have been asked for."""
        return sum(each.size for first, each in self._files.items() if first in self._contents)

    def _numbered(self) -> list[int]:
        """Find the files, and return for each buffer the first with the same content."""
        of_uri: dict[str | None, int] = {}
        of_path: dict[Path, int] = {}
        for number, each in enumerate(self._stated):
            if each.uri not in of_uri:
                of_uri[each.uri] = number
                if each.uri is not None and not each.uri.startswith("data:"):
                    of_uri[each.uri] = of_path.setdefault(self._path(each.uri), number)
        firsts = [of_uri[each.uri] for each in self._stated]
        self._files = {first: _File(path, path.stat().st_size) for path, first in of_path.items()}
        for first, each in zip(firsts, self._stated, strict=True):
            if first in self._files:
                file = self._files[first]
                stated = file.there if each.size is None else min(each.size, file.there)
                file.size = max(file.size, stated)
        return firsts

    def _without_data(self, what: str) -> FormatError:
        return FormatError(
            f"{self._name}: not a valid file: {what} is without data: save the file without "
            "compression"
        )

    def _read(self, first: int, what: str) -> bytes:
        uri = self._stated[first].uri
        if uri is None:
            return self._binary(what)
        return self._file(first) if first in self._files else self._unpacked(uri, what)

    def _binary(self, what: str) -> bytes:
        if self._chunk is None:
            raise self._without_data(what)
        self._chunk.stream.seek(self._chunk.begin)
        return read_exactly(self._chunk.stream, self._chunk.size, self._name, "the binary chunk")

    def _unpacked(self, uri: str, what: str) -> bytes:
        _, mark, text = uri.partition(_PACKED)
        try:
            if mark:
                return base64.b64decode(_unbroken(text), validate=True)
        except ValueError as error:
            raise FormatError(f"{self._name}: {what} is not valid base64: {error}") from error
        raise FormatError(f"{self._name}: not a valid file: {what} is text, but not base64")

    def _file(self, first: int) -> bytes:
        file = self._files[first]
        with file.path.open("rb") as stream:
            return read_most(stream, file.size)

    def _path(self, wanted: str) -> Path:
        if not _is_file(self._name):
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is a separate file in the same folder, "
                "which is unknown for a stream: give a path"
            )
        folder = Path(self._name).absolute().parent.resolve()
        try:
            is_short = len(wanted) <= _LONGEST_NAME
            path = (folder / unquote(wanted)).resolve() if is_short else folder
        except (OSError, ValueError, RuntimeError):  # no name of a file, or links in a circle
            path = folder
        if "://" in wanted or not path.is_relative_to(folder):
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is outside its folder: move it there"
            )
        if not _is_file(path):
            raise FormatError(f"{self._name}: its buffer {wanted[:60]!r} does not exist")
        return path


def _is_file(path: str | Path) -> bool:
    """Whether there is such a file; that nobody can tell, as on a broken disk, is an error."""
    try:
        return stat.S_ISREG(os.stat(path).st_mode)  # noqa: PTH116 - a stream's name has any bytes
    except ValueError:
        return False
    except OSError as error:
        if error.errno in _ABSENT:
            return False
        raise


def _unbroken(text: str) -> str:
    """Join the lines of a text; without a copy if it is one line."""
    if not any(mark in text for mark in _BREAKS):
        return text
    return text.translate(dict.fromkeys(map(ord, _BREAKS)))
