"""How a text file of points is laid out: its delimiter, its header, the meaning of its columns."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass

from liftmesh.errors import FormatError
from liftmesh.io.text_tables import fields, is_number, shown

# What columns are called in the wild, in lower case.
_ALIASES = {
    "x": ("x", "easting", "east", "lon", "longitude", "x_coord", "xcoord", "coord_x"),
    "y": ("y", "northing", "north", "lat", "latitude", "y_coord", "ycoord", "coord_y"),
    "z": ("z", "elevation", "elev", "height", "altitude", "alt", "z_coord", "zcoord", "coord_z"),
    "red": ("red", "r"),
    "green": ("green", "g"),
    "blue": ("blue", "b"),
    "alpha": ("alpha", "a"),
    "nx": ("nx", "normal_x", "normalx"),
    "ny": ("ny", "normal_y", "normaly"),
    "nz": ("nz", "normal_z", "normalz"),
}
_MEANING = {alias: name for name, aliases in _ALIASES.items() for alias in aliases}

_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")


@dataclass(frozen=True, slots=True)
class Layout:
    """How lines are to be split, and what their values are called.

    The delimiter is None for white space, the header None if there is none; ``in_first_line`` tells
    a header that is the first line from one in a comment before it.
    """

    delimiter: str | None
    header: tuple[str, ...] | None
    in_first_line: bool


def sniff(first: str, remark: str, name: str, line: int) -> Layout:
    """Tell the layout from the first line that is no comment, and the comment before it.

    Raises
    ------
    FormatError
        The line is neither a header with x and y nor a row of numbers.
    """
    delimiter = _delimiter(first)
    values = fields(first, delimiter)
    _check(values, name, line)
    if not any(is_number(value) for value in values):
        return Layout(delimiter, columns(values, name, line), in_first_line=True)
    told = [value.lower() for value in fields(remark, _delimiter(remark))]
    meanings = [_MEANING.get(value) for value in told]
    is_header = len(told) == len(values) and {"x", "y"} <= set(meanings)
    header = columns(told, name, line) if is_header else None
    return Layout(delimiter, header, in_first_line=False)


def columns(names: list[str], name: str, line: int) -> tuple[str, ...]:
    """Translate the names of a header; those of other meaning stay as they are.

    Raises
    ------
    FormatError
        Neither x nor y is among them, or a name is there twice.
    """
    found = tuple(
        _MEANING.get(each.lower(), each or f"column_{k}") for k, each in enumerate(names, 1)
    )
    missing = [each for each in ("x", "y") if each not in found]
    if missing:
        raise FormatError(
            f"{name}: line {line}: the header {shown(' '.join(names))} names no column "
            f"{' or '.join(missing)}: call two of its columns x and y"
        )
    twice = next((each for each, count in Counter(found).items() if count > 1), None)
    if twice is not None:
        raise FormatError(f"{name}: line {line}: two columns of the header mean {twice!r}")
    return found


def unnamed(width: int, name: str, line: int) -> tuple[str, ...]:
    """Name the columns of a file without a header: x, y, z, then column_4 and so on.

    Raises
    ------
    FormatError
        There is only one column.
    """
    if width < 2:
        raise FormatError(f"{name}: line {line}: one value a line: a point needs x and y at least")
    return ("x", "y", "z", *(f"column_{k}" for k in range(4, width + 1)))[:width]


def _delimiter(text: str) -> str | None:
    if ";" in text:
        return ";"
    if "\t" in text and all(len(value.split()) == 1 for value in text.split("\t")):
        return "\t"
    words = text.split()
    if len(words) > 1 and all(_DECIMAL_COMMA.fullmatch(word) for word in words):
        return None
    return "," if "," in text else None


def _check(values: list[str], name: str, line: int) -> None:
    if values[0].lower() in ("ncols", "nrows"):
        raise FormatError(f"{name}: this is an Arc/Info ASCII grid, not a list of points")
    for value in values:
        if _DECIMAL_COMMA.fullmatch(value):
            raise FormatError(
                f"{name}: line {line}: {shown(value)} has a decimal comma: "
                "save the file with decimal points"
            )
