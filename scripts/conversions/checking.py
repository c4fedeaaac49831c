"""The property: a cloud that comes back is the same bit for bit, or its losses are named.

A format names them in `WriteResult.dropped`, exactly: no loss is unnamed, and nothing is named that
was not lost. Objects, and formats that other programs write, name nothing: there the table of
formats.md, which `table` makes, must show each loss. In it also stand the types that a format gives
to named values. Anything that raises must be a `LiftmeshError` of one line.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

from conversions.comparing import (
    ORDER,
    ROUNDED,
    ChangedError,
    losses,
    same,
    unnamed,
    untrue,
)
from conversions.passages import OF_LAS, Passage, chunks
from conversions.probing import Kept, kept_by

from liftmesh import Cloud, LiftmeshError
from liftmesh.io.metadata import Provenance


def went_through(passage: Passage, cloud: Cloud) -> Cloud | None:
    """Send a cloud there and back; return what came back, or None if it was refused.

    Raises
    ------
    ChangedError
        Something changed unsaid.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            arrival = passage.send(cloud)
    except LiftmeshError as error:
        _demand("\n" not in str(error), passage, f"a message of several lines: {error}")
        return None
    try:
        lost = losses(arrival.sent, arrival.cloud)
    except ChangedError as error:
        raise ChangedError(f"{passage}: {error}") from error
    known = {each for each in lost if _is_documented(each, arrival.sent, kept_by(passage))}
    if passage.place == "las":  # the values of every point have types of their own
        known |= lost & {f"type of {name}" for name in OF_LAS}
    if arrival.named is None:
        _demand(lost == known, passage, f"loses {lost - known}, which formats.md does not say")
        return arrival.cloud
    by_table = {each for each in known if each == ORDER or each.startswith("type of ")}
    missing = unnamed(lost - by_table, arrival.named)
    _demand(not missing, passage, f"loses {missing}, but names {arrival.named}")
    # What the object before had, and the cloud made of it has not, is named once more.
    before = {*Provenance(arrival.sent.metadata).lost, "holes between faces"}  # may have none
    now = [each for each in arrival.named if each not in before]
    false = untrue(lost, now)
    _demand(not false, passage, f"names {false}, but loses {lost}")
    return arrival.cloud


def check_chunks(passage: Passage, cloud: Cloud, rows: int = 2) -> None:
    """Raise if a file that is read in chunks has other rows than the whole."""
    try:
        arrival = passage.send(cloud)
    except LiftmeshError:
        return
    start = 0
    for chunk in chunks(arrival.data, passage.place, rows):
        part = arrival.cloud.select(slice(start, start + len(chunk)))
        what = f"another chunk from row {start} on"
        _demand(same(chunk.points, part.points) and chunk.crs == part.crs, passage, what)
        for ours, theirs in ((chunk.colors, part.colors), (chunk.normals, part.normals)):
            _demand(_same_or_none(ours, theirs), passage, what)
        added = OF_LAS - part.attributes.keys() if passage.place == "las" else frozenset()
        names = [name for name in chunk.attributes if name not in added]
        _demand(names == [*part.attributes], passage, what)
        for name, values in part.attributes.items():
            _demand(_same_or_none(chunk.attributes[name], values), passage, what)
        start += len(chunk)
    _demand(start == len(arrival.cloud), passage, f"{start} rows in chunks")


def check_pairs(cloud: Cloud, first: Iterable[Passage], second: Iterable[Passage]) -> int:
    """Send a cloud through every pair of ways; return how many were not refused."""
    arrived = 0
    for one in first:
        between = went_through(one, cloud)
        if between is not None:
            for other in second:
                arrived += went_through(other, between) is not None
    return arrived


def _same_or_none(ours: Any, theirs: Any) -> bool:
    if ours is None or theirs is None:
        return ours is theirs
    return ours.dtype == theirs.dtype and same(ours, theirs)


def _demand(condition: bool, passage: Passage, what: str) -> None:
    if not condition:
        raise ChangedError(f"{passage}: {what}")


def _is_documented(loss: str, cloud: Cloud, kept: Kept) -> bool:
    """Whether the table shows a loss."""
    kind, _, name = loss.partition(" ")
    name = name.removeprefix("of ") if kind == "type" else name
    if kind in {"attribute", "type", "rounded"} and name in cloud.attributes:
        return kept.loses_attribute(cloud.attributes[name], name, kind)
    if kind == "metadata":
        return kept.loses_entry(name)
    if loss == ROUNDED:
        return not kept.colors >= {"deep", "alpha"}
    return kept.loses(loss)
