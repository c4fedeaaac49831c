"""Copies of what can only be read from its beginning to its end, in the scratch folder.

They are the source for as long as rows are sorted by tile. A run that goes on makes them again.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import accumulate
from operator import length_hint
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from liftmesh._typing import Array, Progress
from liftmesh.io import streams
from liftmesh.tiles.store import concatenated

if TYPE_CHECKING:
    from liftmesh.tiles.sources import Origin, Part

Kind = TypeVar("Kind", bound="Part")
Item = TypeVar("Item")


def unheard(_: float) -> None:
    """Take no notice of progress."""


def nth(show: Progress, number: int, count: int) -> Progress:
    """Return what hears the share of one of several files."""
    return lambda share: show((number + share) / count)


def stage_of(files: Sequence[Origin], by_ranges: Collection[str]) -> str:
    """Say what it is to cut files: to copy some of them, or just to open all."""
    suffixes = {Path(each.source).suffix.lower() for each in files}
    return "spool" if suffixes - {*by_ranges} else "open"


def of_file(chunks: Iterable[Item], show: Progress) -> Iterator[Item]:
    """Report which share of the bytes of a file has been read."""
    show(0.0)
    for chunk in chunks:
        yield chunk
        at, size = streams.progress() or (0, 1)  # a pipe has no size
        show(at / max(1, size))
    show(1.0)


def of_iterator(chunks: Iterator[Item], show: Progress) -> Iterator[Item]:
    """Report which share of its items has come from an iterator."""
    show(0.0)
    count = length_hint(chunks)
    for number, chunk in enumerate(chunks, 1):
        yield chunk
        if count:
            show(min(1.0, number / count))
    show(1.0)


def written(
    arrays: Iterable[Array],
    rows: int,
    scratch: Path,
    origin: Origin,
    write: Callable[[Array, Path, Origin], Kind],
) -> list[Kind]:
    """Write arrays, which come once, to files of so many rows."""
    found: list[Kind] = []
    for held in _regrouped(arrays, rows):
        path = scratch / f"points-{origin.number:05d}-{len(found):05d}.npy"
        first = found[-1].origin.row + found[-1].rows if found else 0
        found.append(write(held, path, replace(origin, row=first)))
    return found


def _regrouped(arrays: Iterable[Array], rows: int) -> Iterator[Array]:
    held: list[Array] = []
    for array in arrays:
        held.append(array)
        if sum(map(len, held)) >= rows:
            whole = concatenated(held)
            full = len(whole) // rows * rows
            yield from (whole[i : i + rows] for i in range(0, full, rows))
            held = [whole[full:].copy()]
    if sum(map(len, held)):
        yield concatenated(held)


def in_files(parts: Sequence[Kind], folder: Path) -> list[Kind]:
    """Write the parts that are in memory to files, for other processes."""
    return [
        cast("Any", part).saved(folder / f"points-{number:05d}.npy") if part.place is None else part
        for number, part in enumerate(parts)
    ]


def numbered(parts: Sequence[Kind]) -> list[Kind]:
    """Tell each part which row of all is its first."""
    firsts = [0, *accumulate(part.rows for part in parts)]
    found: list[Any] = [*parts]
    return [
        replace(part, origin=replace(part.origin, row=first))
        for part, first in zip(found, firsts, strict=False)
    ]
