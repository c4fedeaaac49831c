"""Scratch space given back: rows are removed once their tiles are on the disk.

No record says that a group of tiles was released: the records of its tiles do, which are sealed and
name the SHA-256 of what was written. So whenever a run is stopped, before, while or after files are
removed, the next one needs the rows of those groups of which a tile is not done, or is damaged,
and no others. Rows that are missing then are sorted again from the source (`chunks.partition`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from liftmesh.tiles.groups import of_rows
from liftmesh.tiles.runs import stem_of
from liftmesh.tiles.stages import earlier, label
from liftmesh.tiles.store import names_to_disk

if TYPE_CHECKING:
    from liftmesh.tiles.schedule import Runner
    from liftmesh.tiles.stages import Done, Folders


def release(folders: Folders, group: int, done: Sequence[Done]) -> None:
    """Remove the rows of a group from all chunks."""
    if {~each.name for each in done} != {*folders.groups.tiles_of(group)}:
        raise RuntimeError(f"the rows of group {group} are still needed, which is a bug")
    names_to_disk(folders.scratch)  # the records of the tiles
    for number in range(folders.runs):
        for end in of_rows(group, with_values=bool(folders.policy)):
            Path(f"{stem_of(folders, number)}{end}.npy").unlink(missing_ok=True)


def released(runner: Runner, folders: Folders) -> frozenset[int]:
    """Find the groups whose rows are not needed."""
    groups = folders.groups
    begun = [
        group
        for group in range(groups.count)
        if all((folders.scratch / f"{label(~t)}.json").exists() for t in groups.tiles_of(group))
    ]
    if not begun:
        return frozenset()
    found = runner.each("check", is_done, [(folders, group) for group in begun])
    return frozenset(group for group, done in zip(begun, found, strict=True) if done)


def is_done(folders: Folders, group: int) -> bool:
    """Whether all tiles of a group are done, and their files sound."""
    return all(earlier(folders, ~tile) is not None for tile in folders.groups.tiles_of(group))
