"""Where is read from and written to: paths and binary streams, and their names for messages."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import PurePath
from typing import BinaryIO, TypeAlias, TypeVar

from liftmesh.errors import FormatError, InputError
from liftmesh.io.gzip_stream import decompressed
from liftmesh.io.links import check_links
from liftmesh.io.streams import add_name, remaining, seekable

_open: list[BinaryIO] = []  # files that are being read
_written: list[BinaryIO] = []  # files that are being written

PathOrStream: TypeAlias = str | os.PathLike[str] | BinaryIO
Found = TypeVar("Found")


def at_home(place: PathOrStream) -> PathOrStream:
    """Replace ``~`` at the beginning of a path by the home folder; streams stay."""
    if not isinstance(place, str | os.PathLike):
        return place
    path = os.path.expanduser(os.fsdecode(place))  # noqa: PTH111 - Path raises if there is no home
    if "\0" in path:
        raise InputError(f"the path {path!r} holds NUL, which no path can")
    return path


def check_suffix(place: str | os.PathLike[str], suffixes: tuple[str, ...], kind: str) -> None:
    """Raise if the name of a file promises another format than the only one it can have."""
    name = os.fspath(place)
    if not name.lower().endswith(suffixes):
        raise FormatError(f"{name}: {kind}: name it *{suffixes[0]}")


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


def format_of(
    place: object, wanted: str | None, name: str, find: Callable[[str, str], Found]
) -> Found:
    """Find the format of a path or stream: the one that is wanted, or that of its suffix."""
    if wanted is None and isinstance(place, str | os.PathLike) and os.path.isdir(place):  # noqa: PTH112
        raise folder(name)
    return find(suffix_of(name) if wanted is None else wanted, name)


def folder(name: str) -> FormatError:
    """The error that a folder is no file."""
    return FormatError(f"{name}: this is a folder, not a file")


def _filled(stream: BinaryIO, name: str, limit: int | None, may_be_compressed: bool) -> BinaryIO:
    content = decompressed(stream, name, limit) if may_be_compressed else stream
    if not remaining(content):
        raise FormatError(f"{name}: the file is empty (0 bytes)")
    return content


def check_stream(stream: object, method: str) -> None:
    """Raise unless an object is a binary stream that can be read or written."""
    if not hasattr(stream, method) or isinstance(stream, io.TextIOBase):
        raise FormatError(
            f"a {type(stream).__name__} is neither a path nor a binary stream: "
            "open files with mode 'rb' or 'wb'"
        )
