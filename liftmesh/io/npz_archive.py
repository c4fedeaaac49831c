"""The arrays of an NPZ file: the members of a ZIP archive, each in NumPy's NPY layout.

zipfile reads the directory of the archive, `zip_member` the members.
"""

from __future__ import annotations

import errno
import lzma
import sys
import zipfile
import zlib
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from typing import BinaryIO

from liftmesh._typing import Array
from liftmesh.caching import cached_property
from liftmesh.errors import FormatError
from liftmesh.io.limits import check_expanded, limit_of
from liftmesh.io.npy_array import Layout, array_of, array_parts, split
from liftmesh.io.streams import remaining
from liftmesh.io.text_tables import shortened
from liftmesh.io.zip_member import Content

# Deflate compresses at most 1,032-fold. bz2 and LZMA have no such bound.
_DENSEST = 1100
_BOUNDED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)

_HEADER = 1 << 17  # bytes of an array's header, at most

# Bytes of content that take no more memory than what decompresses them: bz2 alone makes room for
# 900,000 symbols of four bytes, however short the data.
_SMALL = 1 << 16
_SMALL_BZIP2 = 1 << 22

# Exceptions of zipfile and of the decompressors for files that are damaged.
_BROKEN = (
    zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, ValueError, OSError,
    NotImplementedError, RuntimeError, OverflowError,
)  # fmt: skip


@contextmanager
def opened(stream: BinaryIO, name: str) -> Iterator[dict[str, Member]]:
    """Open an archive: its arrays by name; whatever is wrong with it becomes a `FormatError`."""
    with _complained(f"{name}: not a valid NPZ file"):
        size = remaining(stream)
        infos = [each for each in _directory(stream) if each.filename.endswith(".npy")]
        _check_sizes(infos, size, name)
        yield {each.filename.removesuffix(".npy"): Member(stream, each, name) for each in infos}


@contextmanager
def _complained(what: str) -> Iterator[None]:
    try:
        yield
    except FormatError:
        raise
    except _BROKEN as error:
        if _is_of_the_stream(error):
            raise
        raise FormatError(f"{what}: {error}") from error


def _is_of_the_stream(error: BaseException | None) -> bool:
    """Whether reading failed. bz2's errors have no number, and invalid positions have EINVAL."""
    return isinstance(error, OSError) and error.errno not in (None, errno.EINVAL)


def _directory(stream: BinaryIO) -> list[zipfile.ZipInfo]:
    """Read the directory; zipfile calls an archive whose end is unreadable invalid."""
    handled = sys.exc_info()[1]
    try:
        with zipfile.ZipFile(stream) as archive:
            return archive.infolist()
    except zipfile.BadZipFile as error:
        cause = error.__context__
        if cause is None or cause is handled or not _is_of_the_stream(cause):
            raise
        raise cause from None


def _check_sizes(members: list[zipfile.ZipInfo], size: int, name: str) -> None:
    """Raise for impossible sizes, and for members that share bytes (decompression bombs)."""
    names: set[str] = set()
    for each in members:
        where = f"{name}: {shortened(each.filename)}"
        dense = each.file_size > _DENSEST * (each.compress_size + 1)
        if dense and each.compress_type in _BOUNDED:
            raise FormatError(
                f"{where}: {each.compress_size} bytes cannot decompress to {each.file_size}"
            )
        size -= each.compress_size
        if size < 0:
            raise FormatError(f"{where}: the members are larger than the file")
        if each.filename in names:
            raise FormatError(f"{where}: two arrays have this name")
        names.add(each.filename)


class Member:
    """One array of an archive, read on demand."""

    def __init__(self, stream: BinaryIO, info: zipfile.ZipInfo, name: str) -> None:
        self.size = info.file_size
        self.packed = info.compress_size
        self._stream = stream
        self._info = info
        self._where = f"{name}: {shortened(info.filename)}"

    @cached_property
    def layout(self) -> Layout:
        """Shape, order and type of the array."""
        with _complained(self._where):
            return Layout.read(Content(self._stream, self._info, _HEADER), self._where)

    def whole(self) -> Array:
        """Read the array."""
        with _complained(self._where):
            content, layout = self._begun()
            array = array_of(content, layout, self._where)
            content.finish()
            return array

    def parts(self, rows: int) -> Iterator[Array]:
        """Read the array some rows at a time, or whole at once if it is small."""
        small = _SMALL_BZIP2 if self._info.compress_type == zipfile.ZIP_BZIP2 else _SMALL
        return split(self.whole(), rows) if self.size <= small else self._streamed(rows)

    def _streamed(self, rows: int) -> Iterator[Array]:
        with _complained(self._where):
            content, layout = self._begun()
            yield from array_parts(content, layout, self._where, rows)
            content.finish()

    def _begun(self) -> tuple[Content, Layout]:
        """Read the header; the size that it promises must agree with the directory."""
        content = Content(self._stream, self._info)
        layout = Layout.read(content, self._where)
        layout.check_size(content.left, self._where)
        return content, layout


def check_content(members: Collection[Member], max_bytes: int | None, name: str) -> None:
    """Raise if arrays take more than the limit."""
    limit = limit_of(max_bytes, _DENSEST * sum(each.packed for each in members))
    check_expanded(sum(each.size for each in members), limit, name, "its content")
