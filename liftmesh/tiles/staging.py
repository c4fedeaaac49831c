"""Folders of tiles: files are written to a hidden folder, and put in place when all are there.

Then the file that names the tiles is moved away first, with the tiles of an earlier writing, and
the new one is put in place last: nothing ever names tiles of two writings. If a file cannot be
moved, all are moved back. A process that is killed meanwhile, and a disk on which that fails, leave
tiles without the file that names them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from liftmesh.base.interruption import check, defer_signals
from liftmesh.io.atomic import check_writable, working_folder


@contextmanager
def staged(root: Path, last: str, suffix: str) -> Iterator[Path]:
    """Make a folder whose tiles are put in their places in the end; one file is the last."""
    is_new = not root.exists()
    root.mkdir(parents=True, exist_ok=True)
    try:
        check_writable(root / last)
        with working_folder(root, "tileset") as stage:
            new, old = stage / "new", stage / "old"
            new.mkdir()
            yield new
            check()
            with defer_signals():
                _exchange(root, new, old, last, suffix)
    except BaseException:
        if is_new:
            with suppress(OSError):  # it is not empty
                root.rmdir()
        raise


def _exchange(root: Path, new: Path, old: Path, last: str, suffix: str) -> None:
    """Move files away that there are, and new ones in; at an error move all back."""
    tiles = _tiles(new, suffix)
    there = _tiles(root, suffix) if (root / last).is_file() else tiles
    before = [each for each in (Path(last), *there) if (root / each).is_file()]
    moves = [(root / each, old / each) for each in before]
    moves += [(new / each, root / each) for each in (*tiles, Path(last))]
    done: list[tuple[Path, Path]] = []
    try:
        for source, target in moves:
            target.parent.mkdir(parents=True, exist_ok=True)
            source.rename(target)
            done.append((source, target))
    except BaseException as error:
        _undo(done, root / last, error)
        raise
    finally:
        _remove_empty(root, {*before, *tiles})


def _undo(done: list[tuple[Path, Path]], last: Path, error: BaseException) -> None:
    """Move files back; the first one, which names the others, only if all others are there."""
    try:
        for source, target in reversed(done):
            source.parent.mkdir(parents=True, exist_ok=True)
            target.rename(source)
    except OSError as worse:
        reason = (
            f"{worse.strerror}: tiles of two writings are in the folder, so this file that names "
            "them was removed: write them again"
        )
        raise OSError(worse.errno, reason, str(last)) from error


def _tiles(folder: Path, suffix: str) -> list[Path]:
    """List the files of tiles, level/column/row, relative to the folder."""
    found = (each.relative_to(folder) for each in folder.glob(f"[0-9]*/[0-9]*/[0-9]*{suffix}"))
    return sorted(each for each in found if all(map(str.isdecimal, each.with_suffix("").parts)))


def _remove_empty(root: Path, files: set[Path]) -> None:
    """Remove folders of tiles in which nothing is left."""
    for depth in (2, 1):
        for place in {each.parts[:depth] for each in files if len(each.parts) > depth}:
            with suppress(OSError):  # it is not empty, or not there
                root.joinpath(*place).rmdir()
