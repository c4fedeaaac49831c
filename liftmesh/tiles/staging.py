"""Folders of tiles: files are written to a hidden folder, and put in place when all are there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from liftmesh.io.atomic import check_writable, working_folder


@contextmanager
def staged(root: Path, last: str) -> Iterator[Path]:
    """Make a folder whose files are put in their places in the end; one file is the last."""
    is_new = not root.exists()
    root.mkdir(parents=True, exist_ok=True)
    try:
        check_writable(root / last)
        with working_folder(root, "tileset") as stage:
            yield stage
            (root / last).unlink(missing_ok=True)
            for path in sorted(stage.glob("*/*/*.*")):
                target = root / path.relative_to(stage)
                target.parent.mkdir(parents=True, exist_ok=True)
                path.replace(target)
            (stage / last).replace(root / last)
    except BaseException:
        if is_new:
            with suppress(OSError):  # it is not empty
                root.rmdir()
        raise
