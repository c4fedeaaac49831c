"""Atomic writing: a temporary file, then renamed over the target; and hidden folders to work in.

A reader of the target sees the old file or the new one, never a part, and an error while writing
leaves the old file as it was and no other file. On systems that support it, the temporary file has
no name, so that not even a killed process leaves a part behind; elsewhere it is a hidden file in
the same folder until it is complete. The new file has the permissions of any new file, or those of
the file it replaces. If the target is a symbolic link that the user has named, the file it points
to is replaced; a target that is not a regular file (a pipe, ``/dev/stdout``) cannot be replaced and
is written at the end. What has a name that liftmesh chose is replaced itself, be it a link or not.

A working folder outlives neither its block nor, for long, its process. `remove_unfinished` removes
those of a process that is ended in the middle. What a killed process leaves is removed when the
next folder of its kind is made in the same place: each folder holds a file that is locked for as
long as its process lives. A folder without that file, or with another name, is somebody else's.
"""

from __future__ import annotations

import errno
import io
import os
import re
import shutil
import stat
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from liftmesh.base.interruption import check, held, opened
from liftmesh.base.platform import NAMELESS, OPEN_FILES, REGULAR, Folder, lock, set_mode
from liftmesh.io.streams import add_name, check_links

_NOT_NAMELESS = {errno.EOPNOTSUPP, errno.EISDIR, errno.EINVAL}  # of file systems without such files

# The folders and names of temporary files that may exist at the moment.
_unfinished: set[tuple[Folder, str]] = set()

# The folders of `working_folder` that may exist at the moment.
unfinished_folders: set[Path] = set()
_ATTEMPTS = 3  # at removing a folder in which another thread may still make files

LOCK = "in-use"


@contextmanager
def replacing(
    path: str | os.PathLike[str], *, overwrite: bool = True, follow_links: bool = True
) -> Iterator[BinaryIO]:
    """Open a binary stream whose bytes become the file at ``path`` if the block succeeds."""
    if follow_links or not Path(path).is_symlink():
        check_writable(path)
    folder, name = os.path.split(os.path.realpath(path) if follow_links else path)
    target = Path(os.path.realpath(folder)) / name
    is_special = follow_links and target.exists() and not target.is_file()
    _check_free(target, overwrite=overwrite)
    with _named(target), _held(target) if is_special else _new_file(target) as stream:
        yield stream
        _check_free(target, overwrite=overwrite)


def holds_data(path: str | os.PathLike[str]) -> bool:
    """Whether a regular file with content is here, which would be lost."""
    return os.path.isfile(path) and os.path.getsize(path) > 0  # noqa: PTH113, PTH202


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise if `replacing` could not write here; the error does not mention a temporary file."""
    check_links(path)
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(
            errno.EISDIR, "cannot write a file here: it is a folder", str(target)
        )
    if target.parent.exists() and not target.parent.is_dir():
        reason = "cannot write here: this is a file, not a folder"
        raise NotADirectoryError(errno.ENOTDIR, reason, str(target.parent))
    if not target.parent.is_dir():
        reason = "cannot write here: the folder does not exist"
        raise FileNotFoundError(errno.ENOENT, reason, str(target.parent))
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(
            errno.EACCES, "cannot replace this file: it is read-only", str(target)
        )
    if not target.exists() and not os.access(target.parent, os.W_OK):
        reason = "cannot write here: the folder is read-only"
        raise PermissionError(errno.EACCES, reason, str(target.parent))


@contextmanager
def working_folder(place: str | os.PathLike[str], kind: str) -> Iterator[Path]:
    """Make a folder, and remove it with all that it holds in the end."""
    here = Path(place).absolute()
    _remove_abandoned(here, kind)
    folder = here / f".liftmesh-{kind}-{os.urandom(8).hex()}"
    unfinished_folders.add(folder)
    try:
        folder.mkdir(mode=0o700)
        with _in_use(folder):
            yield folder
    finally:
        if folder.exists():
            shutil.rmtree(folder)
        unfinished_folders.discard(folder)


def remove_unfinished() -> None:
    """Remove the temporary files and folders of this process, which is about to end at once."""
    for folder, temporary in tuple(_unfinished):
        with suppress(OSError):
            folder.remove(temporary)
    for place in tuple(unfinished_folders) * _ATTEMPTS:
        shutil.rmtree(place, ignore_errors=True)


def _check_free(target: Path, *, overwrite: bool) -> None:
    if not overwrite and holds_data(target):
        reason = "this file exists, and is replaced with overwrite=True only"
        raise FileExistsError(errno.EEXIST, reason, str(target))


@contextmanager
def _named(target: Path) -> Iterator[None]:
    """Add the file's name to an error: streams do not know it."""
    try:
        yield
    except OSError as error:
        add_name(error, str(target))
        raise


@contextmanager
def _held(target: Path) -> Iterator[BinaryIO]:
    """Hold what is written to a pipe or a device, in which formats cannot go back."""
    with target.open("wb") as stream:
        held = io.BytesIO()
        yield held
        stream.write(held.getbuffer())


@contextmanager
def _new_file(target: Path) -> Iterator[BinaryIO]:
    """Write a new file and rename it over the target."""
    with held(target.parent) as folder:
        temporary = f".liftmesh-{os.urandom(8).hex()}"
        _unfinished.add((folder, temporary))
        try:
            with _created(temporary, folder) as stream:
                yield stream
                stream.flush()
                _check_place(target, folder)
                _keep_permissions(target.name, folder, stream)
                check()
                _give_name(stream, temporary, folder)
            check()
            _put_in_place(temporary, target, folder)
        except BaseException:
            with suppress(OSError):
                folder.remove(temporary)
            raise
        finally:
            _unfinished.discard((folder, temporary))


@contextmanager
def _created(temporary: str, folder: Folder) -> Iterator[BinaryIO]:
    with ExitStack() as stack:
        new = _open_new(temporary, folder, stack)
        yield stack.enter_context(os.fdopen(new, "w+b", closefd=False))


def _open_new(temporary: str, folder: Folder, stack: ExitStack) -> int:
    """Open a file without a name, or one of the temporary name where the system cannot."""
    # Mode 0o666 minus the process's umask, as open() does; tempfile would give 0o600.
    if NAMELESS and Path(OPEN_FILES).is_dir():
        try:
            flags = NAMELESS | os.O_RDWR
            return stack.enter_context(opened(".", flags, 0o666, folder=folder.descriptor))
        except OSError as error:  # pragma: no cover - other file systems
            if error.errno not in _NOT_NAMELESS:
                raise
    flags = os.O_CREAT | os.O_EXCL | os.O_RDWR
    place = folder.place(temporary)
    return stack.enter_context(opened(place, flags, 0o666, folder=folder.descriptor))


def _check_place(target: Path, folder: Folder) -> None:
    """Raise if the folder was moved: the file would end up elsewhere."""
    if not folder.is_at(target.parent):
        reason = "cannot write here: the folder was moved or removed in the meantime"
        raise FileNotFoundError(errno.ENOENT, reason, str(target.parent))


def _keep_permissions(name: str, folder: Folder, stream: BinaryIO) -> None:
    with suppress(FileNotFoundError):
        before = folder.status(name)
        if stat.S_ISREG(before.st_mode):
            set_mode(stream.fileno(), stat.S_IMODE(before.st_mode))


def _give_name(stream: BinaryIO, temporary: str, folder: Folder) -> None:
    """Give the file a name in the folder, if it has none."""
    if os.fstat(stream.fileno()).st_nlink == 0:
        folder.give_name(stream.fileno(), temporary)


def _put_in_place(temporary: str, target: Path, folder: Folder) -> None:
    """Rename over the target; an error names the target, not the temporary file."""
    try:
        folder.replace(temporary, target.name)
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(target)) from error


@contextmanager
def _in_use(folder: Path) -> Iterator[None]:
    """Mark a folder as in use; its mark has its name only once it is locked."""
    new = folder / f"{LOCK}-new"
    with opened(new, os.O_RDWR | os.O_CREAT | os.O_EXCL) as mark:
        lock(mark)  # without locks, abandoned folders stay
        new.rename(folder / LOCK)
        yield


def _remove_abandoned(place: Path, kind: str) -> None:
    """Remove the folders of processes that have ended."""
    with suppress(OSError):  # a folder that one may write to, but not read
        for name in os.listdir(place):  # noqa: PTH208 - it is as long as the folder
            if re.fullmatch(rf"\.liftmesh-{re.escape(kind)}-[0-9a-f]{{16}}", name):
                _remove_if_abandoned(place / name)


def _remove_if_abandoned(folder: Path) -> None:
    # It may be locked, removed by another process, or another user's.
    with suppress(OSError), opened(folder / LOCK, os.O_RDWR | REGULAR) as mark:
        if lock(mark):
            shutil.rmtree(folder)
