"""What systems do differently: locks, folders that are held, files without a name, pipes, forks.

What follows is written for POSIX, and does on Windows what comes nearest. Nothing else names a
module or a function that one of the systems lacks (`tests/test_codebase.py`). What is there is
found out by looking, not by the name of the system.

On Windows a file that is open can be neither renamed nor removed, unless it was opened so that it
can: `open_file` does that. Folders cannot be opened, so they are reached by their paths, and their
names are on the disk when Windows sees fit. Locks hold a byte that others then cannot read: one far
beyond the end. `select` takes sockets alone, so signals are told through these.
"""

from __future__ import annotations

import errno
import os
import select
import signal
from collections.abc import Callable
from importlib import import_module
from io import FileIO, RawIOBase
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path  # which takes as long to import as all that is here


def _module(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        return None


_fcntl = _module("fcntl")
_winapi: Any = None if _fcntl else _module("_winapi")

SIGNALS: tuple[int, ...] = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGALRM") if hasattr(signal, name)
)
"""Those whose handlers are known to raise: Ctrl-C, an end that was asked for, a time limit."""

HOLDS_FOLDERS = os.open in os.supports_dir_fd
FOLDER: int = getattr(os, "O_PATH", os.O_RDONLY)  # a writable folder need not be readable
NAMELESS: int = getattr(os, "O_TMPFILE", 0)  # Linux's flag to open a file without a name
OPEN_FILES = "/proc/self/fd"  # through which to name it later
REGULAR: int = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # no link, no waiting

_WITHOUT_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}
_BEYOND = 1 << 30  # the place of the byte that is locked
_READ, _WRITE = 0x80000000, 0x40000000  # GENERIC_READ, GENERIC_WRITE
_SHARED = 7  # for reading, writing and removing
_CREATE_NEW, _OPEN_EXISTING, _OPEN_ALWAYS = 1, 3, 4
_NORMAL = 0x80  # FILE_ATTRIBUTE_NORMAL


def processors() -> int:
    """Return how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def after_fork(function: Callable[[], object]) -> None:
    """Call a function in every process that is forked from this one."""
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=function)


# --- files --------------------------------------------------------------------------------------


def _open_shared(
    path: str | os.PathLike[str], flags: int, mode: int = 0o777, *, dir_fd: int | None = None
) -> int:
    """Open a file of Windows so that it can be renamed and removed meanwhile."""
    del mode, dir_fd  # Windows has neither
    if flags & (os.O_TRUNC | os.O_APPEND):
        raise ValueError("files are neither cut off nor appended to")
    access = {os.O_RDONLY: _READ, os.O_WRONLY: _WRITE, os.O_RDWR: _READ | _WRITE}
    way = _OPEN_EXISTING
    if flags & os.O_CREAT:
        way = _CREATE_NEW if flags & os.O_EXCL else _OPEN_ALWAYS
    kind = access[flags & (os.O_RDONLY | os.O_WRONLY | os.O_RDWR)]
    try:
        handle = _winapi.CreateFile(os.fspath(path), kind, _SHARED, 0, way, _NORMAL, 0)
    except OSError as error:
        error.filename = os.fspath(path)
        raise
    try:
        binary: int = flags | getattr(os, "O_BINARY", 0)
        descriptor: int = _module("msvcrt").open_osfhandle(handle, binary)
    except OSError:
        _winapi.CloseHandle(handle)
        raise
    return descriptor


open_file: Callable[..., int] = os.open if _winapi is None else _open_shared


def set_mode(descriptor: int, mode: int) -> None:
    """Set the permissions of an open file, where files have some."""
    if hasattr(os, "fchmod"):
        os.fchmod(descriptor, mode)


def lock(descriptor: int) -> bool:
    """Lock an open file; BlockingIOError if another process has; False where nothing can."""
    try:
        if _fcntl is not None:
            _fcntl.flock(descriptor, _fcntl.LOCK_EX | _fcntl.LOCK_NB)
        else:
            _lock_beyond(descriptor)
    except OSError as error:
        if error.errno not in _WITHOUT_LOCKS:
            raise
        return False
    return True


def _lock_beyond(descriptor: int) -> None:
    os.lseek(descriptor, _BEYOND, os.SEEK_SET)
    try:
        msvcrt = _module("msvcrt")
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
    except PermissionError as error:
        raise BlockingIOError(errno.EAGAIN, "locked by another process") from error
    finally:
        os.lseek(descriptor, 0, os.SEEK_SET)


class Folder:
    """A folder by its descriptor, which stays right if it is renamed, or else by its path."""

    def __init__(self, path: Path, descriptor: int | None) -> None:
        self.path, self.descriptor = path, descriptor

    def place(self, name: str) -> str:
        """Return the name of a file for what takes the descriptor, too."""
        return name if self.descriptor is not None else os.path.join(self.path, name)  # noqa: PTH118

    def is_at(self, path: Path) -> bool:
        """Whether it is what a path leads to."""
        if self.descriptor is None or not path.is_dir():
            return path.is_dir()
        return os.path.samestat(path.stat(), os.fstat(self.descriptor))

    def status(self, name: str) -> os.stat_result:
        """Return what is known of a file, or of a link."""
        return os.stat(self.place(name), dir_fd=self.descriptor, follow_symlinks=False)

    def remove(self, name: str) -> None:
        """Remove a file."""
        os.unlink(self.place(name), dir_fd=self.descriptor)

    def replace(self, name: str, new: str) -> None:
        """Rename a file, over another if there is one."""
        here = self.descriptor
        os.replace(self.place(name), self.place(new), src_dir_fd=here, dst_dir_fd=here)

    def give_name(self, nameless: int, name: str) -> None:
        """Name an open file that has no name."""
        # Python follows the link to the file itself only if folder descriptors are given.
        source, here = f"{OPEN_FILES}/{nameless}", self.descriptor
        os.link(source, name, src_dir_fd=here, dst_dir_fd=here, follow_symlinks=True)


# --- pipes --------------------------------------------------------------------------------------


def signal_pipe() -> tuple[RawIOBase, RawIOBase]:
    """Open a pipe for signals, if the process may open another file besides: a command has to."""
    if _fcntl is None:
        from socket import socketpair  # noqa: PLC0415 - Windows alone

        one, other = socketpair()
        with one, other:  # they are closed with their files
            other.setblocking(False)
            return one.makefile("rb", buffering=0), other.makefile("wb", buffering=0)
    ends = os.pipe()
    try:
        os.close(os.dup(ends[0]))
        os.set_blocking(ends[1], False)
    except OSError:
        for end in ends:
            os.close(end)
        raise
    return FileIO(ends[0], "rb"), FileIO(ends[1], "wb")


def may_read(pipe: RawIOBase, seconds: float | None) -> bool:
    """Wait until a pipe for signals can be read from, for a time at most."""
    return bool(select.select([pipe], [], [], seconds)[0])


def may_write(descriptor: int, seconds: float) -> bool:
    """Wait until a stream takes more, for a time at most, where that can be known."""
    return _fcntl is None or bool(select.select([], [descriptor], [], seconds)[1])
