"""Whole files or none: write beside the target, then rename over it.

A reader of the target sees the old file or the new one, never a part, and an error while writing
leaves the old file as it was and nothing beside it. The new file has the permissions that any new
file would have, or those of the file it replaces; of a symbolic link, the file it points to is
replaced. What is no regular file (a pipe, ``/dev/stdout``) cannot be renamed over and is written
directly.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a binary stream whose bytes become the file at ``path`` if the block succeeds.

    Parameters
    ----------
    path : str or path
        The file to create or to replace.

    Yields
    ------
    binary stream
        Writable and seekable, unless ``path`` is a pipe or a device.

    Raises
    ------
    OSError
        The folder does not exist or is not writable, or ``path`` is a folder or a read-only file;
        the message names it.

    Examples
    --------
    >>> import tempfile
    >>> target = Path(tempfile.mkdtemp()) / "greeting.txt"
    >>> with replacing(target) as stream:
    ...     _ = stream.write(b"hello")
    >>> target.read_bytes()
    b'hello'
    """
    target = Path(os.path.realpath(path))
    _check_writable(target)
    if target.exists() and not target.is_file():
        with target.open("wb") as stream:
            yield stream
        return
    beside = target.parent / f".liftmesh-{os.urandom(8).hex()}"
    try:
        with _create(beside) as stream:
            yield stream
        _keep_permissions(target, beside)
        beside.replace(target)
    except BaseException:
        with suppress(OSError):
            beside.unlink(missing_ok=True)
        raise


def _check_writable(target: Path) -> None:
    """Say what is wrong in terms of the caller's path, not of the temporary file."""
    if target.is_dir():
        raise IsADirectoryError(
            errno.EISDIR, "cannot write a file here: it is a folder", str(target)
        )
    if not target.parent.is_dir():
        reason = "cannot write here: there is no such folder"
        raise FileNotFoundError(errno.ENOENT, reason, str(target.parent))
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(
            errno.EACCES, "cannot replace this file: it is read-only", str(target)
        )
    if not target.exists() and not os.access(target.parent, os.W_OK):
        reason = "cannot write here: the folder is read-only"
        raise PermissionError(errno.EACCES, reason, str(target.parent))


def _create(path: Path) -> BinaryIO:
    # Mode 0o666 minus the process's umask, as open() does; tempfile would give 0o600.
    flags = os.O_CREAT | os.O_EXCL | os.O_RDWR | getattr(os, "O_BINARY", 0)
    return os.fdopen(os.open(path, flags, 0o666), "w+b")


def _keep_permissions(target: Path, beside: Path) -> None:
    if target.exists():
        beside.chmod(stat.S_IMODE(target.stat().st_mode))
