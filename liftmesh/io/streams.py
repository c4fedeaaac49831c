"""Paths and binary streams to read from and write to, with names and exact reads.

A path is opened, a stream is used as it is, or taken into memory if it is a pipe. Files of text may
be compressed with gzip, and are decompressed as they are read. Readers go back a little, to the end
of the last whole line, and a few times to the beginning: the last megabytes are held for the one,
and the other begins anew. So memory is bounded, whatever the file expands to. What it does expand
to is counted once, before anything is read, and limited.
"""

from __future__ import annotations

import errno
import io
import os
import zlib
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, BinaryIO, Protocol, TypeAlias, TypeVar, cast, overload

from liftmesh.base.platform import OPEN_FILES
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.options import limit_of

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer


_PIECE = 1 << 16  # bytes read at a time from a stream that cannot fill memory

_open: list[BinaryIO] = []  # files that are being read
_written: list[BinaryIO] = []  # files that are being written

PathOrStream: TypeAlias = str | os.PathLike[str] | BinaryIO
Found = TypeVar("Found")

_MAGIC = b"\x1f\x8b"
_GROWTH = 20  # by default text may take so many times the file

_BLOCK = 1 << 16
_COMPRESSED = 1 << 13  # bytes of the file at a time, which every member in them copies
_HELD = 40  # blocks: more than readers take at a time, and the buffer before them
_GZIP = 31  # zlib's windowBits for gzip


@contextmanager
def opened(
    source: PathOrStream, name: str, limit: int | None, *, may_be_compressed: bool
) -> Iterator[BinaryIO]:
    """Open a path, or use a stream; yield it as a seekable stream that is not empty."""
    if not isinstance(source, str | os.PathLike):
        check_stream(source, "read")
        yield _filled(seekable(source), name, limit, may_be_compressed)
        return
    try:
        with open(source, "rb") as stream:  # noqa: PTH123
            _open.append(stream)
            try:
                yield _filled(seekable(stream), name, limit, may_be_compressed)
            finally:
                _open.remove(stream)
    except IsADirectoryError as error:
        raise folder(name) from error
    except OSError as error:  # of the stream, which knows no name
        check_links(source)
        add_name(error, name)
        raise


def format_of(
    place: object, wanted: str | None, name: str, find: Callable[[str, str], Found]
) -> Found:
    """Find the format of a path or stream: the one that is wanted, or that of its suffix."""
    if wanted is None and isinstance(place, str | os.PathLike) and os.path.isdir(place):  # noqa: PTH112
        raise folder(name)
    return find(suffix_of(name) if wanted is None else wanted, name)


def _filled(stream: BinaryIO, name: str, limit: int | None, may_be_compressed: bool) -> BinaryIO:
    content = decompressed(stream, name, limit) if may_be_compressed else stream
    if not remaining(content):
        raise FormatError(f"{name}: the file is empty (0 bytes)")
    return content


def folder(name: str) -> FormatError:
    """The error that a folder is no file."""
    return FormatError(f"{name}: this is a folder, not a file")


@overload
def at_home(place: str | os.PathLike[str]) -> str: ...
@overload
def at_home(place: PathOrStream) -> PathOrStream: ...
def at_home(place: PathOrStream) -> PathOrStream:
    """Replace ``~`` at the beginning of a path by the home folder; streams stay."""
    if not isinstance(place, str | os.PathLike):
        return place
    path = os.path.expanduser(os.fsdecode(place))  # noqa: PTH111 - Path raises if there is no home
    if "\0" in path:
        raise InputError(f"the path {path!r} holds NUL, which no path can")
    return path


def name_of(place: object) -> str:
    """Return the name of a path or a stream for messages."""
    if isinstance(place, str | os.PathLike):
        return os.fspath(place)
    name = getattr(place, "name", None)
    return name if isinstance(name, str) else "<stream>"


def suffix_of(name: str) -> str:
    """Return the suffix of a file's name, and the one before ``.gz`` with it."""
    path = PurePath(name)
    is_compressed = path.suffix.lower() == ".gz"
    return "".join(path.suffixes[-2:]) if is_compressed else path.suffix


def check_suffix(place: str | os.PathLike[str], suffixes: tuple[str, ...], kind: str) -> None:
    """Raise if the name of a file promises another format than the only one it can have."""
    name = os.fspath(place)
    if not name.lower().endswith(suffixes):
        raise FormatError(f"{name}: {kind}: name it *{suffixes[0]}")


def check_stream(stream: object, method: str) -> None:
    """Raise unless an object is a binary stream that can be read or written."""
    if not hasattr(stream, method) or isinstance(stream, io.TextIOBase):
        raise FormatError(
            f"a {type(stream).__name__} is neither a path nor a binary stream: "
            "open files with mode 'rb' or 'wb'"
        )


def check_links(path: str | os.PathLike[str]) -> None:
    """Raise if the links on the way to a file lead in a circle."""
    try:
        os.stat(path)  # noqa: PTH116 - Path has no other way to tell this error from others
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise FormatError(
                f"{os.fspath(path)}: its symbolic links lead in a circle, and to no file: "
                "give another name, or remove them"
            ) from error
        if error.errno is None:  # not the system's: a time limit that a handler raises
            raise
    except ValueError:  # no name that a file can have, which opening it reports
        return


def add_name(error: OSError, name: str) -> None:
    """Name the file in an error of a stream, which knows no name, or only a temporary one."""
    known = error.filename
    is_temporary = os.path.basename(str(known)).startswith(".liftmesh-")  # noqa: PTH119
    is_temporary |= str(known).startswith(OPEN_FILES)
    is_in_folder = known in {".", os.path.basename(name)}  # noqa: PTH119 - of a folder that is open
    if error.errno is not None and (not isinstance(known, str) or is_temporary or is_in_folder):
        error.filename = name
        del error.filename2  # of a link or a renaming


def progress() -> tuple[int, int] | None:
    """Return how far the file is read that was opened last: its place and size, in bytes."""
    try:
        number = _open[-1].fileno()
        return os.lseek(number, 0, os.SEEK_CUR), os.fstat(number).st_size
    except (IndexError, OSError, ValueError):  # closed meanwhile
        return None


@contextmanager
def watched(stream: BinaryIO) -> Iterator[BinaryIO]:
    """Let `written` know of a file while it is being written."""
    _written.append(stream)
    try:
        yield stream
    finally:
        _written.remove(stream)


def written() -> tuple[int, None] | None:
    """Return how many bytes there are of the file whose writing began last."""
    try:
        return os.fstat(_written[-1].fileno()).st_size, None
    except (IndexError, OSError, ValueError):  # closed meanwhile
        return None


def seekable(stream: BinaryIO) -> BinaryIO:
    """Return the stream, or its content in memory if it is a pipe."""
    return stream if stream.seekable() else io.BytesIO(stream.read())


@contextmanager
def kept_place(stream: BinaryIO) -> Iterator[int]:
    """Let a seekable stream go back to where it is, and yield that place."""
    here = stream.tell()
    try:
        yield here
    finally:
        stream.seek(here)


def remaining(stream: BinaryIO) -> int:
    """Count the bytes between the position of a seekable stream and its end."""
    with kept_place(stream) as here:
        return max(stream.seek(0, os.SEEK_END) - here, 0)


def is_file(stream: BinaryIO, name: str) -> bool:
    """Whether a stream is the file that has its name."""
    try:
        return os.path.samestat(os.fstat(stream.fileno()), os.stat(name))  # noqa: PTH116
    except (AttributeError, OSError, ValueError):
        return False


class Source(Protocol):
    """What bytes are read from: a file, or a member of an archive."""

    def read(self, size: int = -1, /) -> bytes:
        """Read at most ``size`` bytes."""


def read_most(stream: Source, size: int) -> bytes:
    """Read ``size`` bytes, fewer only at the end: a stream without a buffer may return a part."""
    data = stream.read(size)
    if len(data) >= size or not (more := stream.read(size - len(data))):
        return data
    parts = [data, more]
    left = size - len(data) - len(more)
    while left > 0 and parts[-1]:
        parts.append(stream.read(left))
        left -= len(parts[-1])
    return b"".join(parts)


def read_into(stream: Source, memory: memoryview) -> int:
    """Read as much into memory as the stream gives at a time; return the number of bytes."""
    if hasattr(stream, "readinto"):
        return int(stream.readinto(memory))
    piece = stream.read(min(_PIECE, len(memory)))
    memory[: len(piece)] = piece
    return len(piece)


def read_exactly(stream: BinaryIO, size: int, name: str, what: str) -> bytes:
    """Read ``size`` bytes or raise; never ask for more than the stream holds."""
    here, left = stream.tell(), remaining(stream)
    data = read_most(stream, size) if size <= left else b""
    if len(data) != size:
        raise FormatError(
            f"{name}: byte {here}: {what} should take {size} bytes, but the file ends after "
            f"{left}: it is truncated, or its header is wrong"
        )
    return data


def written_whole(raw: io.RawIOBase) -> BinaryIO:
    """Return a stream that writes all that it is given: one without a buffer may write a part."""
    return cast("BinaryIO", _WholeWriter(raw))


class _WholeWriter:
    """A stream without a buffer, apart from what writes."""

    def __init__(self, raw: io.RawIOBase) -> None:
        self._raw = raw

    def __getattr__(self, name: str) -> Any:
        return getattr(self._raw, name)

    def write(self, data: bytes | memoryview) -> int:
        """Write all bytes, or raise."""
        left = memoryview(data).cast("B")
        size = len(left)
        while left:
            written = self._raw.write(left)
            if not written:
                raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
            left = left[written:]
        return size

    def writelines(self, parts: Iterable[bytes | memoryview]) -> None:
        """Write all bytes of each, or raise."""
        for part in parts:
            self.write(part)


def is_compressed(stream: BinaryIO) -> bool:
    """Whether a seekable stream begins like a gzip file, as no text does."""
    with kept_place(stream):
        return stream.read(2) == _MAGIC


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
                    f"bytes: if you trust the file, raise it with {Option('max_bytes', ...)}"
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
