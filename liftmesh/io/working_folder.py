"""Hidden folders to work in, which outlive neither their block nor, for long, their process.

`atomic.remove_unfinished` removes those of a process that is ended in the middle. What a killed
process leaves is removed when the next folder of its kind is made in the same place: each folder
holds a file that is locked for as long as its process lives. A folder without that file, or with
another name, is somebody else's.
"""

from __future__ import annotations

import errno
import fcntl
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from liftmesh.base.interruption import opened
from liftmesh.io.atomic import unfinished_folders

LOCK = "in-use"
_WITHOUT_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}


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


@contextmanager
def _in_use(folder: Path) -> Iterator[None]:
    """Mark a folder as in use; its mark has its name only once it is locked."""
    new = folder / f"{LOCK}-new"
    with opened(new, os.O_RDWR | os.O_CREAT | os.O_EXCL) as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:  # without locks, abandoned folders stay
            if error.errno not in _WITHOUT_LOCKS:
                raise
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
    with suppress(OSError), opened(folder / LOCK, os.O_RDWR | os.O_NOFOLLOW) as lock:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder)
