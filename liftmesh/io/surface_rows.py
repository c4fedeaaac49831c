"""Which rows of files a surface takes: one rule for the library, the commands and tiles.

Of files of lidar (LAS, LAZ, COPC) a surface takes the ground and no withheld rows, unless the
caller says otherwise. Whether there is ground is decided over all files of a surface: trees of the
one tile without classes would stand among the ground of the others.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import InputError, Option
from liftmesh.io.columns import POSITION
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import read, read_chunks
from liftmesh.io.registry import as_cloud, find_format
from liftmesh.io.selection import (
    GROUND,
    MOST_CLASSES,
    Selection,
    Selector,
    class_column,
    validate_selection,
)
from liftmesh.io.streams import suffix_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.io.options import ReadOptions

_BLOCK = 1 << 20  # rows: NumPy counts bytes as words of 64 bits
_NAMED = 3  # files in a message
_CONDITIONS = [each.name for each in fields(Selection)]
_UNSAID = {"flat": False}  # and None of all others
_SYSTEMS = ("src_crs", "dst_crs", "color_depth")  # of what is read, not of which rows are


def for_surface(
    name: str | os.PathLike[str], choices: Mapping[str, Any], file_format: str | None = None
) -> dict[str, Any]:
    """Return the conditions on the rows of a file that a surface is made of."""
    name = os.fspath(name)
    kind = file_format or suffix_of(name)
    if not kind or find_format(kind, name).name != "las":
        return {**choices}
    return {"classes": "ground", "withheld": False, **choices}


def read_rows(source: object, **options: Unpack[ReadOptions]) -> Cloud:
    """Read the rows of a surface, or convert an object, of which all rows count."""
    given: dict[str, Any] = {**options}  # but for what says nothing, which all objects take
    given = {key: each for key, each in given.items() if each is not _UNSAID.get(key)}
    if isinstance(source, str | os.PathLike):
        chosen = for_surface(source, given, options.get("format"))
        return check_some(read(source, **chosen), source)
    if "classes" in given:
        raise InputError(
            f"{Option('classes', ...)} is for files: select the rows of a cloud, as "
            'cloud.select(cloud.attributes["classification"] == 2)'
        )
    return as_cloud(source, **given)


def for_chunks(
    names: Sequence[str | os.PathLike[str]], choices: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Return the conditions on the rows of files that are read in chunks."""
    conditions = [for_surface(name, choices) for name in names]
    asked = {k: each for k, each in enumerate(conditions) if each.get("classes") == "ground"}
    counts = {k: _ground_of(os.fspath(names[k]), each) for k, each in asked.items()}
    check_grounds((os.fspath(names[k]), each) for k, each in counts.items())
    for k, each in asked.items():
        each["classes"] = GROUND if counts[k]["ground"] else "all"
    return conditions


def _ground_of(name: str, choices: Mapping[str, Any]) -> dict[str, int]:
    """Say whether a file has ground, and whether rows would be selected without."""
    conditions = {key: each for key, each in choices.items() if key in _CONDITIONS}
    others = {key: each for key, each in choices.items() if key not in (*_CONDITIONS, *_SYSTEMS)}
    selector = Selector(validate_selection(**conditions) or Selection(), name)
    for cloud in read_chunks(name, **others):
        places = dict(zip(POSITION, cloud.points.T, strict=True))
        selector.rows(len(cloud), {**cloud.attributes, **places})
        if selector.counts()["ground"]:
            break
    return selector.counts()


def check_grounds(files: Iterable[tuple[str, Mapping[str, int]]]) -> None:
    """Raise if some files have ground and others have none, of which all rows would be taken."""
    asked = [(name, counts) for name, counts in files if "ground" in counts]
    lacking = [name for name, each in asked if each["selected"] and not each["ground"]]
    if not lacking or not any(each["ground"] for _, each in asked):
        return
    rest = f" and {len(lacking) - _NAMED} more" if len(lacking) > _NAMED else ""
    raise InputError(
        f"{', '.join(lacking[:_NAMED])}{rest}: no ground (class 2), while other files have some: "
        f"give {Option('classes', 'all')} for all rows of each file, {Option('classes', 2)} for "
        f"none of these, or find the ground with {Option('classify_ground')}"
    )


def check_some(cloud: Cloud, name: str | os.PathLike[str]) -> Cloud:
    """Return a cloud; raise if conditions on rows have left none."""
    rows = Provenance(cloud.metadata).selection.get("rows")
    if rows and not len(cloud):
        raise InputError(f"{os.fspath(name)}: none of {rows:,} rows meets the conditions")
    return cloud


def classes_of(attributes: Mapping[str, Array]) -> dict[int, int]:
    """Count the rows of each class."""
    name = class_column(attributes)
    return {} if name is None else bytes_of(attributes[name])


def bytes_of(values: Array) -> dict[int, int]:
    """Count whole numbers from 0 to 255; empty if there are others."""
    total = np.zeros(MOST_CLASSES, np.int64)
    if values.ndim != 1 or values.dtype.kind not in "iuf":
        return {}
    for first in range(0, len(values), _BLOCK):
        block = values[first : first + _BLOCK]
        if block.dtype != np.uint8:
            if not ((block >= 0) & (block < MOST_CLASSES) & (block % 1 == 0)).all():
                return {}
            block = block.astype(np.uint8)
        total += np.bincount(block, minlength=MOST_CLASSES)
    return {number: int(total[number]) for number in np.flatnonzero(total).tolist()}
