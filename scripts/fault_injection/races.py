"""What others may do to a file, or to its folder, while liftmesh works on it."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

OTHER = b"what another writer wrote, in full\n"


def _another_writer(target: Path) -> None:
    part = target.with_name(".other")
    part.write_bytes(OTHER)
    part.replace(target)


def _removed(target: Path) -> None:
    target.unlink(missing_ok=True)


def _a_folder(target: Path) -> None:
    target.unlink(missing_ok=True)
    target.mkdir()


def _a_loop(target: Path) -> None:
    target.unlink(missing_ok=True)
    target.symlink_to(target.name)


def _cut(target: Path) -> None:
    if target.exists():
        with target.open("r+b") as stream:
            stream.truncate(target.stat().st_size // 2)


def _moved(target: Path) -> None:
    target.parent.rename(aside(target.parent))


def _moved_and_made_anew(target: Path) -> None:
    _moved(target)
    target.parent.mkdir()


def _folder_removed(target: Path) -> None:
    shutil.rmtree(target.parent)


def aside(folder: Path) -> Path:
    """Return the name under which a folder is moved out of the way."""
    return folder.with_name("moved")


RACES: dict[str, Callable[[Path], None]] = {
    "another writer": _another_writer,
    "target removed": _removed,
    "target becomes a folder": _a_folder,
    "target becomes a loop": _a_loop,
    "folder moved": _moved,
    "folder moved and made anew": _moved_and_made_anew,
    "folder removed": _folder_removed,
}
READ_RACES = {**RACES, "file cut": _cut}
