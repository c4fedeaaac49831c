"""Which rows of a file are read: by class, return, box, heights, flag, or every k-th.

Rows are left out as they are read, block by block, so that what is not wanted takes no memory. Each
is counted under the first condition that it does not meet: withheld, class, return, box, heights,
and `every` at last, which counts the rows that meet all others. Nothing is moved or changed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.options import (
    ClassChoice,
    Returns,
    as_count,
    as_positive,
    as_switch,
    check_option,
    counted,
    refused,
)
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.columns import POSITION, edges_of, faces_of
from liftmesh.io.metadata import Provenance, Unread, noted

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

GROUND = 2  # the class of the ground, ASPRS
MOST_CLASSES = 256
_MOST = 1 << 62  # rows, which 64 bits count


_CLASS, _RETURN, _RETURNS = ("classification", "class"), ("returnnumber",), ("numberofreturns",)
_LEFT_OUT = {  # the conditions, and what is said of the rows that do not meet them
    "copc_resolution": "finer than the resolution",
    "withheld": "withheld",
    "classes": "of other classes",
    "returns": "other returns",
    "bounds": "outside the box",
    "z_range": "outside the heights",
    "every": f"by {Option('every', ...)}",
}


@dataclass(frozen=True, slots=True)
class Selection:
    """Checked conditions on rows; `validate_selection` makes them of what a caller gives."""

    # "ground": class 2 if the file has any, else all rows
    classes: frozenset[int] | Literal["ground"] | None = None
    returns: Returns | None = None
    bounds: tuple[float, float, float, float] | None = None
    z_range: tuple[float, float] | None = None
    every: int = 1
    withheld: bool = True  # whether rows of that flag stay
    copc_resolution: float | None = None


def validate_selection(
    *,
    classes: ClassChoice = None,
    returns: Returns | None = None,
    bounds: Iterable[float] | None = None,
    z_range: Iterable[float] | None = None,
    every: int = 1,
    withheld: bool = True,
    copc_resolution: float | None = None,
) -> Selection | None:
    """Check the conditions that a caller gives; None if all rows meet them."""
    if returns is not None:
        check_option("returns", returns, Returns)
    selection = Selection(
        classes=_classes(classes),
        returns=returns,
        bounds=None if bounds is None else _box(bounds),
        z_range=None if z_range is None else _range(z_range),
        every=min(as_count("every", every, 1), _MOST),
        withheld=as_switch("withheld", withheld),
        copc_resolution=None if copc_resolution is None else _length(copc_resolution),
    )
    return None if selection == Selection() else selection


def _classes(value: ClassChoice) -> frozenset[int] | Literal["ground"] | None:
    if value is None or isinstance(value, str):
        if value in (None, "all"):
            return None
        if value == "ground":
            return "ground"
        raise _invalid("classes", value, "numbers from 0 to 255, 'ground' or 'all'")
    try:
        numbers = [value] if isinstance(value, int | np.integer) else [*value]
        found = frozenset(as_count("classes", each, 0) for each in numbers)
    except (TypeError, InputError):
        found = frozenset()
    if not found or max(found) >= MOST_CLASSES:
        raise _invalid("classes", value, "numbers from 0 to 255, 'ground' or 'all'")
    return found


def _box(value: Iterable[float]) -> tuple[float, float, float, float]:
    numbers = _numbers(value)
    if len(numbers) != 4 or numbers[0] > numbers[2] or numbers[1] > numbers[3]:
        raise _invalid("bounds", value, "xmin, ymin, xmax, ymax, each maximum at least its minimum")
    return numbers[0], numbers[1], numbers[2], numbers[3]


def _range(value: Iterable[float]) -> tuple[float, float]:
    numbers = _numbers(value)
    if len(numbers) != 2 or numbers[0] > numbers[1]:
        raise _invalid("z_range", value, "z0, z1 with z0 <= z1")
    return numbers[0], numbers[1]


def _length(value: float) -> float:
    return as_positive("copc_resolution", value, "a positive number, in the units of the file")


def _numbers(value: Any) -> tuple[float, ...]:
    """Convert to floats; nothing if that cannot be."""
    try:
        numbers = tuple(float(each) for each in value)
    except (TypeError, ValueError):
        return ()
    return () if any(map(math.isnan, numbers)) else numbers


def _invalid(name: str, value: object, wanted: str) -> InputError:
    return refused(name, value, f"give {wanted}")


class Selector:
    """Applies conditions to the rows of a file, block by block, and counts what it leaves out."""

    def __init__(self, selection: Selection, name: str, *, has_levels: bool = False) -> None:
        # has_levels: of COPC, whose reader has chosen the resolution
        if selection.copc_resolution is not None and not has_levels:
            raise FormatError(
                f"{name}: rows cannot be selected by {Option('copc_resolution')}, for which the "
                f"file has no index (COPC), or is read in chunks: leave it out, or take every k-th "
                f"row by {Option('every', ...)}"
            )
        self._selection = selection
        self._name = name
        self._counts: dict[str, int] = {}
        self._unread: dict[str, int] = {}  # rows that are not read at all
        self._rows = self._selected = self._met = 0
        self._has_ground = False

    def rows(self, count: int, columns: Mapping[str, Array]) -> tuple[Array, bool]:
        """Find rows of a block, and whether all rows before are left out: ground begins here."""
        chosen = self._selection
        left = np.arange(count)
        self._rows += count
        if not chosen.withheld and (flags := _column(columns, ("withheld",))) is not None:
            left = self._keep("withheld", left, np.asarray(flags[left] == 0))
        is_first = False
        if chosen.classes is not None:
            left, is_first = self._of_classes(left, columns)
        if chosen.returns is not None:
            left = self._keep("returns", left, self._of_returns(columns)[left])
        left = self._inside(left, columns)
        if chosen.every > 1:
            phase = (np.arange(len(left)) + self._met) % chosen.every == 0
            self._met += len(left)
            left = self._keep("every", left, phase)
        self._selected += len(left)
        return left, is_first

    def leave_out(self, counts: Mapping[str, int]) -> None:
        """Count rows that are not read at all, by reason."""
        for reason, count in counts.items():
            self._rows += count
            self._unread[reason] = count
            self._counts[reason] = self._counts.get(reason, 0) + count

    def counts(self) -> dict[str, int]:
        """Return the numbers of rows: of all, of those selected, and those left out by reason."""
        found = {"rows": self._rows, "selected": self._selected}
        if self._selection.classes == "ground":
            found["ground"] = int(self._has_ground)
        return found | {key: self._counts[key] for key in _LEFT_OUT if self._counts.get(key)}

    def _keep(self, reason: str, rows: Array, mask: Array) -> Array:
        kept = rows[mask]
        self._counts[reason] = self._counts.get(reason, 0) + len(rows) - len(kept)
        return kept

    def _of_classes(self, left: Array, columns: Mapping[str, Array]) -> tuple[Array, bool]:
        chosen = self._selection.classes
        values = _column(columns, _CLASS)
        if values is None and chosen != "ground":
            raise self._missing("class", "classification", columns)
        if values is None:
            return left, False
        if chosen != "ground":
            return self._keep("classes", left, _is_among(values[left], chosen or ())), False
        is_ground = np.asarray(values[left] == GROUND)
        is_first = not self._has_ground and bool(is_ground.any())
        if is_first:  # what was selected before is of other classes
            withheld = self._counts.get("withheld", 0)
            others = self._rows - sum(self._unread.values()) - withheld - len(left)
            self._counts = {**self._unread, "withheld": withheld, "classes": others}
            self._selected = self._met = 0
            self._has_ground = True
        return (self._keep("classes", left, is_ground) if self._has_ground else left), is_first

    def _of_returns(self, columns: Mapping[str, Array]) -> Array:
        number, count = _column(columns, _RETURN), _column(columns, _RETURNS)
        if number is None or count is None:
            raise self._missing("return", "return_number and number_of_returns", columns)
        if self._selection.returns == "last":
            return np.asarray(number == count)
        first = np.asarray(number == 1)
        return first if self._selection.returns == "first" else first & (count == 1)

    def _inside(self, left: Array, columns: Mapping[str, Array]) -> Array:
        if self._selection.bounds is not None:
            x, y = columns["x"][left], columns["y"][left]
            low_x, low_y, high_x, high_y = self._selection.bounds
            inside = (x >= low_x) & (x <= high_x) & (y >= low_y) & (y <= high_y)
            left = self._keep("bounds", left, inside)
        if self._selection.z_range is not None:
            z = columns["z"][left]
            low, high = self._selection.z_range
            left = self._keep("z_range", left, (z >= low) & (z <= high))
        return left

    def _missing(self, what: str, column: str, columns: Mapping[str, Array]) -> FormatError:
        there = ", ".join([key for key in columns if key not in POSITION][:8]) or "coordinates only"
        return FormatError(
            f"{self._name}: rows cannot be selected by {what}: there is no {column}, but {there}"
        )


def _is_among(values: Array, classes: Iterable[int]) -> Array:
    """Whether each value is one of the classes."""
    if values.dtype != np.uint8:  # of a table; those of LAS are looked up, ten times as fast
        return np.isin(values, [*classes])
    is_chosen = np.zeros(MOST_CLASSES, np.bool_)
    is_chosen[[*classes]] = True
    return is_chosen[values]


def _column(columns: Mapping[str, Array], names: tuple[str, ...]) -> Array | None:
    """Find a column of numbers by its names, in any spelling."""
    key = _key(columns, names)
    return None if key is None else columns[key]


def _key(columns: Mapping[str, Array], names: tuple[str, ...]) -> str | None:
    for name in names:
        for key in columns:
            if key.replace("_", "").lower() == name and _is_numbers(columns[key]):
                return key
    return None


def _is_numbers(values: Array) -> bool:
    return values.ndim == 1 and values.dtype.kind in "biuf"


def class_column(columns: Mapping[str, Array]) -> str | None:
    """Find the column of classes."""
    return _key(columns, _CLASS)


def selected(cloud: Cloud, selector: Selector) -> Cloud:
    """Select the rows of a cloud that meet the conditions; what they take away is named."""
    places = dict(zip(POSITION, cloud.points.T, strict=True))
    rows, _ = selector.rows(len(cloud), {**cloud.attributes, **places})
    return only(cloud, rows, selection=selector.counts())


def only(cloud: Cloud, rows: Array, **entries: Any) -> Cloud:
    """Return rows of a cloud; name the faces and edges that are left out, and note entries."""
    kept = cloud.select(rows)
    lost = {"face": len(faces_of(cloud)), "edge": len(edges_of(cloud)) - len(edges_of(kept))}
    named = [f"{counted(n, kind)} (rows were selected)" for kind, n in lost.items() if n]
    known = Provenance(cloud.metadata)
    not_read = (*known.not_read, *named) if named else ()
    not_read = not_read if known.is_read else Unread(not_read)
    return replace(kept, metadata=noted(cloud.metadata, not_read=not_read, **entries))


def selection_sentence(counts: Mapping[str, int]) -> str:
    """Say in a sentence which rows were selected."""
    kind = {1: "ground (class 2): ", 0: "no ground (class 2), so all classes: "}
    first = kind.get(counts.get("ground", -1), "")
    line = f"{first}{counts['selected']:,} of {counts['rows']:,} rows"
    left = [f"{counts[key]:,} {words}" for key, words in _LEFT_OUT.items() if counts.get(key)]
    return f"{line}; left out: {', '.join(left)}" if left else line
