"""Arrays in NumPy's NPY layout: alone in a file, or as members of an NPZ archive.

``numpy.load`` allocates the memory that a header asks for before it reads the file. Here the
header is compared with the size of the file first. NumPy parses the header itself, a short text:
so memory that its parser runs out of is the file's fault, not the machine's. While the stream is
read, it is not, and neither is a failing disk: these errors are passed on.

An NPZ file is a ZIP archive. zipfile reads its directory, which states the size of every member,
but the compressed data may go on: a few kilobytes can decompress to megabytes. So a `Member` is
decompressed here: `Content` asks for the bytes that are still due, and for one more at the end,
which must not come. Members are stored or deflated, as NumPy writes them; bzip2 and LZMA, which
compress without bound, are refused. The layout of a member, with its header in front of the data,
is that of PKWARE's APPNOTE.TXT, sections 4.3.7 to 4.4.
"""

from __future__ import annotations

import errno
import io
import math
import re
import struct
import sys
import zlib
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import BinaryIO
from zipfile import ZIP_BZIP2, ZIP_DEFLATED, ZIP_LZMA, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from numpy.lib import format as npy

from liftmesh._typing import Array
from liftmesh.base.frozen import cached_property
from liftmesh.errors import FormatError
from liftmesh.io.options import check_expanded, limit_of
from liftmesh.io.streams import Source, read_into, read_most, remaining
from liftmesh.io.text_tables import shortened

_LONGEST_HEADER = 10_000  # what NumPy takes from a file that is not trusted

# A header as NumPy writes it of an array of numbers.
_USUAL = re.compile(
    r"\{'descr': '[^'\\]*', 'fortran_order': (?:True|False), 'shape': \([\d, ]*\), \}\s*"
)

# What any header consists of: strings, whole numbers, truth values and brackets. Python 2 wrote
# some numbers with an L.
_TOKEN = re.compile(
    r"""\s*("(?:[^"\\]|\\[\\'"nrtxuU])*"|'(?:[^'\\]|\\[\\'"nrtxuU])*'|"""
    r"""-?\d+(?!\w)|-?\d+(?=L\b)|True|False|[][(){},:])(?:(?<=\d)L)?"""
)

# The length of the header, and what parses both.
_VERSIONS = {
    (1, 0): (struct.Struct("<H"), npy.read_array_header_1_0),
    (2, 0): (struct.Struct("<I"), npy.read_array_header_2_0),
}

_DENSEST = 1100  # Deflate compresses at most 1,032-fold
_BOUNDED = (ZIP_STORED, ZIP_DEFLATED)
_REFUSED = {ZIP_BZIP2: "bzip2", ZIP_LZMA: "LZMA"}

_HEADER = 1 << 17  # bytes of an array's header, at most

_SMALL = 1 << 16  # bytes of content that take no more memory than what decompresses them

# Exceptions of zipfile and of the decompressors for files that are damaged.
_BROKEN = (
    BadZipFile, zlib.error, EOFError, ValueError, OSError,
    NotImplementedError, RuntimeError, OverflowError,
)  # fmt: skip

_LOCAL_HEADER = struct.Struct("<4s5H3L2H")
_ZIP64 = struct.Struct("<2Q")
_IN_EXTRA = 0xFFFFFFFF  # as a size: it stands in the extra field

_ENCRYPTED, _SIZES_FOLLOW, _PATCH, _UTF8 = (1 << bit for bit in (0, 3, 5, 11))

_PIECE = 1 << 16  # compressed bytes at a time
_MOST = 1 << 20  # bytes decompressed at a time
_NO_MEMORY = "Error -4 "  # begins what zlib says if it cannot allocate memory


def read_array(stream: BinaryIO, name: str) -> Array:
    """Read one array from a file; its values are never unpickled."""
    layout = Layout.read(stream, name)
    layout.check_size(remaining(stream), name)
    return array_of(stream, layout, name)


def array_of(stream: Source, layout: Layout, name: str) -> Array:
    """Read the values of an array, once their size has been checked."""
    return layout.array(_read_values(stream, layout.size, name, layout.what), layout.shape, name)


def array_parts(stream: Source, layout: Layout, name: str, rows: int) -> Iterator[Array]:
    """Read an array some rows at a time; read it whole, then split it, if not stored by rows."""
    if not layout.is_by_rows:
        yield from split(array_of(stream, layout, name), rows)
        return
    total, *rest = layout.shape
    row = math.prod(rest) * layout.dtype.itemsize
    for start in range(0, total, rows):
        count = min(rows, total - start)
        data = _read_values(stream, count * row, name, layout.what)
        yield layout.array(data, (count, *rest), name)


def split(array: Array, rows: int) -> Iterator[Array]:
    """Split an array into parts of some rows."""
    return (array[start : start + rows] for start in range(0, len(array), rows))


@dataclass(frozen=True, slots=True)
class Layout:
    """Shape, order and type of an array, from the header of an NPY file."""

    shape: tuple[int, ...]
    by_columns: bool
    dtype: np.dtype

    @classmethod
    def read(cls, stream: Source, name: str) -> Layout:
        """Read the header and leave the stream at the first value."""
        try:
            layout = cls(*_header(stream))
        except (OSError, MemoryError):  # of the stream
            raise
        except SystemError as error:  # pragma: no cover - how Python tells that memory ended
            raise MemoryError from error
        except Exception as error:  # the header is a Python literal: its parser raises many kinds
            raise FormatError(
                f"{name}: not an NPY file, or its header is invalid: {error}"
            ) from error
        if layout.dtype.hasobject:
            raise FormatError(f"{name}: the array holds Python objects: save it as numbers")
        lengths = all(type(length) is int and length >= 0 for length in layout.shape)
        if not lengths or not layout.dtype.itemsize:
            raise FormatError(
                f"{name}: the header says shape {shortened(str(layout.shape))} of {layout.dtype}"
            )
        return layout

    @property
    def size(self) -> int:
        """Size of the values in bytes."""
        return math.prod(self.shape) * self.dtype.itemsize

    @property
    def what(self) -> str:
        """Description of the array for messages."""
        return f"{self.dtype} array of shape {shortened(str(self.shape))}"

    def check_size(self, left: int, name: str) -> None:
        """Raise if fewer bytes are left than the values take, before memory is allocated."""
        if self.size > left:
            raise FormatError(
                f"{name}: {self.what} should take {self.size} bytes, but {left} are left: the file "
                "is truncated, or its header is wrong"
            )

    @property
    def is_by_rows(self) -> bool:
        """Whether the values of a row are contiguous, so that rows can be read in parts."""
        return len(self.shape) > 0 and (len(self.shape) == 1 or not self.by_columns)

    def array(self, data: Array, shape: tuple[int, ...], name: str) -> Array:
        """Build an array of the given shape on its bytes."""
        count = math.prod(shape)
        flat = np.frombuffer(data, self.dtype, count) if len(data) else np.empty(count, self.dtype)
        try:
            return flat.reshape(shape, order="F" if self.by_columns else "C")
        except ValueError as error:  # more axes than NumPy allows, or an empty and a huge one
            raise FormatError(
                f"{name}: the header says shape {shortened(str(shape))}: {error}"
            ) from error


def _header(stream: Source) -> tuple[tuple[int, ...], bool, np.dtype]:
    version = npy.read_magic(io.BytesIO(read_most(stream, npy.MAGIC_LEN)))
    if version not in _VERSIONS:
        raise ValueError(f"version {version} of the layout is not supported")
    length, parse = _VERSIONS[version]
    begin = read_most(stream, length.size)
    size = length.unpack(begin)[0] if len(begin) == length.size else 0
    if size > _LONGEST_HEADER:
        raise ValueError(
            f"the header takes {size:,} bytes, more than {_LONGEST_HEADER:,}: save only the fields "
            "you need"
        )
    given = read_most(stream, size).decode("latin-1")
    text = _plain_text(given).encode("latin-1")
    try:
        return parse(io.BytesIO(length.pack(len(text)) + text), max_header_size=len(text))
    except MemoryError as error:  # the parser's own limit: its message, if any, is about stacks
        if _USUAL.fullmatch(given):  # which nest nothing
            raise
        raise ValueError("nested too deeply") from error


def _plain_text(text: str) -> str:
    """Return the header without what Python and NumPy warn of, such as the L of Python 2."""
    if _USUAL.fullmatch(text):
        return text
    at, parts = 0, []
    while (token := _TOKEN.match(text, at)) is not None:
        parts.append(token[1])
        at = token.end()
    if text[at:].strip():
        raise ValueError(f"unexpected {shortened(text[at:])!r}")
    return " ".join(parts)


def _read_values(stream: Source, size: int, name: str, what: str) -> Array:
    """Read bytes into memory that the array will own: there is no second copy of the values."""
    values = np.empty(size, np.uint8)
    view, start = values.data, 0
    while start < size:
        count = read_into(stream, view[start:])
        if not count:
            raise FormatError(f"{name}: {what}: the values end too early: the file is truncated")
        start += count
    return values


@contextmanager
def open_archive(stream: BinaryIO, name: str) -> Iterator[dict[str, Member]]:
    """Open an archive: its arrays by name; whatever is wrong with it becomes a `FormatError`."""
    with _complained(f"{name}: not a valid NPZ file"):
        size = remaining(stream)
        infos = [each for each in _directory(stream) if each.filename.endswith(".npy")]
        _check_members(infos, size, name)
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
    """Whether reading failed; invalid positions have the number EINVAL."""
    return isinstance(error, OSError) and error.errno not in (None, errno.EINVAL)


def _directory(stream: BinaryIO) -> list[ZipInfo]:
    """Read the directory; zipfile calls an archive whose end is unreadable invalid."""
    handled = sys.exc_info()[1]
    try:
        with ZipFile(stream) as archive:
            return archive.infolist()
    except BadZipFile as error:
        cause = error.__context__
        if cause is None or cause is handled or not _is_of_the_stream(cause):
            raise
        raise cause from None


def _check_members(members: list[ZipInfo], size: int, name: str) -> None:
    """Raise for impossible sizes, and for members that share bytes (decompression bombs)."""
    names: set[str] = set()
    for each in members:
        where = f"{name}: {shortened(each.filename)}"
        if each.compress_type in _REFUSED:
            raise FormatError(
                f"{where}: it is compressed with {_REFUSED[each.compress_type]}, which is not "
                "read: save the arrays with numpy.savez_compressed"
            )
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

    def __init__(self, stream: BinaryIO, info: ZipInfo, name: str) -> None:
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
        return split(self.whole(), rows) if self.size <= _SMALL else self._streamed(rows)

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


class Content:
    """The bytes of one member, from its start; ``left`` are still to come."""

    def __init__(self, stream: BinaryIO, info: ZipInfo, most: int | None = None) -> None:
        self.left = info.file_size if most is None else min(most, info.file_size)
        self._info = info
        self._stream = stream
        self._position = _start_of_data(stream, info)
        self._packed = info.compress_size
        self._sum = 0
        self._input = b""
        self._decoder = self._decoder_of(info)

    def read(self, size: int = -1) -> bytes:
        """Read ``size`` bytes, or those that are left if they are fewer."""
        wanted = self.left if size < 0 else min(size, self.left)
        memory = memoryview(bytearray(wanted))
        start = 0
        while start < wanted:
            start += self.readinto(memory[start:])
        return bytes(memory)

    def readinto(self, memory: memoryview) -> int:
        """Read some of the bytes that are left into memory; return their number."""
        memory = memory[: min(self.left, _MOST)]
        count = self._fill(memory) if memory else 0
        if not count and self.left:
            raise BadZipFile(f"its data end {self.left} bytes before the size stated for it")
        self.left -= count
        self._sum = zlib.crc32(memory[:count], self._sum)
        return count

    def finish(self) -> None:
        """Read what is left, and check the end of the data and the checksum."""
        while self.left:
            self.read(_MOST)
        if self._goes_on():
            raise BadZipFile(f"its data go on after the {self._info.file_size} bytes stated for it")
        if self._sum != self._info.CRC:
            raise BadZipFile("its checksum (CRC-32) is wrong: it is damaged")

    def _goes_on(self) -> bool:
        """Whether data follow those that make up the content."""
        if self._decoder is None:
            return self._packed > 0
        more = self._some(self._decoder, 1) or self._decoder.unused_data
        return bool(more) or self._packed > 0

    def _fill(self, memory: memoryview) -> int:
        """Put some bytes of the content into memory, none only at the end."""
        if self._decoder is None:
            return self._raw_into(memory)
        part = self._some(self._decoder, len(memory))
        memory[: len(part)] = part
        return len(part)

    def _some(self, decoder: zlib._Decompress, most: int) -> bytes:
        """Decompress at most ``most`` bytes, none only at the end."""
        while not decoder.eof:
            part = _decompressed(decoder, self._input, most)
            self._input = decoder.unconsumed_tail
            if part:
                return part
            if not self._input:
                self._input = self._raw(_PIECE)
                if not self._input:
                    break
        return b""

    def _raw(self, size: int) -> bytes:
        """Read compressed bytes."""
        self._stream.seek(self._position)
        data = self._stream.read(min(size, self._packed))
        self._advance(len(data))
        return data

    def _raw_into(self, memory: memoryview) -> int:
        self._stream.seek(self._position)
        count = read_into(self._stream, memory[: self._packed])
        self._advance(count)
        return count

    def _advance(self, count: int) -> None:
        self._position += count
        self._packed -= count

    def _decoder_of(self, info: ZipInfo) -> zlib._Decompress | None:
        """Make the decompressor of a member; None if it is stored as it is."""
        if info.flag_bits & _ENCRYPTED:
            raise BadZipFile("it is encrypted")
        if info.compress_type not in _BOUNDED or info.flag_bits & _PATCH:
            raise BadZipFile(f"its compression method, {info.compress_type}, is not supported")
        return None if info.compress_type == ZIP_STORED else zlib.decompressobj(-15)


def _decompressed(decoder: zlib._Decompress, data: bytes, most: int) -> bytes:
    """Decompress at most ``most`` bytes; raise a MemoryError where zlib lacks memory."""
    try:
        return decoder.decompress(data, most)
    except zlib.error as error:
        if str(error).startswith(_NO_MEMORY):
            raise MemoryError from error
        raise


def _start_of_data(stream: BinaryIO, info: ZipInfo) -> int:
    """Compare the header in front of the data with the directory; return where the data begin."""
    stream.seek(info.header_offset)
    head = stream.read(_LOCAL_HEADER.size)
    if len(head) < _LOCAL_HEADER.size or not head.startswith(b"PK\3\4"):
        raise BadZipFile("there is no header in front of its data")
    _, _, flags, method, _, _, crc, packed, size, name_length, extra_length = _LOCAL_HEADER.unpack(
        head
    )
    name = stream.read(name_length).decode("utf-8" if flags & _UTF8 else "cp437", "replace")
    extra = stream.read(extra_length)
    if _IN_EXTRA in (packed, size):
        size, packed = _zip64_sizes(extra)
    stated = (info.CRC, info.compress_size, info.file_size)
    pairs = zip((crc, packed, size), stated, strict=True)
    sizes_agree = all(a == b or (a == 0 and flags & _SIZES_FOLLOW) for a, b in pairs)
    if name != info.orig_filename or method != info.compress_type or not sizes_agree:
        raise BadZipFile("the header in front of its data contradicts the directory")
    return stream.tell()


def _zip64_sizes(extra: bytes) -> tuple[int, int]:
    """Find the size and the compressed size of a large member in its extra field."""
    at = 0
    while at + 4 <= len(extra):
        kind, length = struct.unpack_from("<2H", extra, at)
        if kind == 1 and length >= _ZIP64.size and at + 4 + _ZIP64.size <= len(extra):
            size, packed = _ZIP64.unpack_from(extra, at + 4)
            return size, packed
        at += 4 + length
    raise BadZipFile("its ZIP64 sizes are missing")
