"""The options of `read`: their types, their checks, and limits on what files may expand to.

*Tables.* What the names of a table say is used; what only its values suggest needs an option, so
that nothing is applied by a guess. ``columns`` has one form as text, on the command line and in
messages (``x=East,y=North,z=H``, or the names of all columns in order), and mappings and sequences
in Python.

*Missing values.* In tables and rasters that do not say which mark stands for one, a value counts as
such a mark if programs use it as one (-9999, -32768, the ends of single precision), and if it
stands apart from all others: by more than an eighth of their range, or because there are none. It
is not left out by a guess, but refused with both readings.

*Limits.* A compressed or instanced file can hold far more than its bytes, and each column of a
table takes memory for its name and its array, however short the table. What a file would take is
computed from what it states, and compared with ``max_bytes``, or the limit of its format, before
anything is built.
"""

from __future__ import annotations

import codecs
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, TypeAlias, TypedDict

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.options import ClassChoice, Returns, Up, as_count, as_switch, refused
from liftmesh.errors import FormatError, InputError, Option


class ObjectOptions(TypedDict, total=False):
    """Options of tables, grids and arrays, in memory and in files."""

    columns: ColumnChoice
    flat: bool | None
    nodata: Missing
    transform: Sequence[float] | None


class FormatOptions(ObjectOptions, total=False):
    """Options of single formats: tables as text, rasters, LandXML, shapes, and models."""

    delimiter: str | None
    decimal: str | None
    skip_rows: int
    header: bool
    end: str | None
    encoding: str | None
    band: int
    landxml_surface: str | None
    layer: str | None
    up: Up | None
    origin: Sequence[float] | None


class ChunkOptions(FormatOptions, total=False):
    """The options of `read_chunks`."""

    format: str | None
    max_bytes: int | None
    color_depth: int | None
    classes: ClassChoice
    returns: Returns | None
    bounds: Iterable[float] | None
    z_range: Iterable[float] | None
    every: int
    withheld: bool
    src_crs: Any
    dst_crs: Any


class ReadOptions(ChunkOptions, total=False):
    """The options of `read`."""

    copc_resolution: float | None


Missing: TypeAlias = float | str | None

_LOW, _HIGH = -999.0, 1e19  # all of the following are beyond
_SENTINELS = (
    *(-999.0, -999.9, -9999.0, -9999.9, -9999.99, -9999.999, -99999.0, -999999.0),
    *(-32767.0, -32768.0, -2147483648.0, 1e20, 1e30, 1e38, 1.70141e38),
    *(-3.4028234663852886e38, -3.40282346638529e38, -3.402823466e38, -3.4028235e38),
    *(-3.402823e38, -3.40282e38, 3.4028234663852886e38, 3.4028235e38, -1.7976931348623157e308),
)
_APART = 8  # parts of the range of the other values


class Outliers:
    """The known marks of missing values in a column, and the range of its other values."""

    def __init__(self, column: int) -> None:
        self.counts: dict[float, int] = {}
        self.rows = 0
        self._column = column
        self._low, self._high = np.inf, -np.inf

    def examine(self, table: Floats) -> None:
        """Examine further rows."""
        column = table[:, self._column]
        self.rows += len(column)
        low, high = column.min(initial=np.inf), column.max(initial=-np.inf)
        if not (low > _LOW and high < _HIGH):  # as most are, and no NaN among them
            self._count(column)
            column = column[np.isfinite(column) & ~np.isin(column, _SENTINELS)]
            low, high = column.min(initial=np.inf), column.max(initial=-np.inf)
        self._low, self._high = min(self._low, float(low)), max(self._high, float(high))

    def _count(self, column: Floats) -> None:
        values, counts = np.unique(column[np.isin(column, _SENTINELS)], return_counts=True)
        for value, count in zip(values.tolist(), counts.tolist(), strict=True):
            self.counts[value] = self.counts.get(value, 0) + count

    @property
    def has_others(self) -> bool:
        """Whether the column holds other values than marks."""
        return self._low <= self._high

    def check(self, what: str, rows: str) -> None:
        """Raise for a mark that stands apart from all other values, once all are examined."""
        if (value := self._found()) is None:
            return
        shown = f"{value:.0f}" if value == int(value) and abs(value) < 1e15 else repr(value)
        apart = "far from all others, " if self.has_others else ""
        raise FormatError(
            f"{what} is {shown} in {self.counts[value]:,} of {self.rows:,} {rows}, {apart}a value "
            f"or the mark of a missing one: read it with {Option('nodata', shown)} if it is "
            f"missing there, or with {Option('nodata', 'none')}"
        )

    def _found(self) -> float | None:
        """Return the mark that stands apart from all other values; None if there is none."""
        spread = (self._high - self._low) / _APART
        gaps = {each: max(self._low - each, each - self._high) for each in self.counts}
        return next((each for each, gap in gaps.items() if gap > spread), None)


def as_missing(value: Any) -> tuple[float | str, ...] | None:
    """Return what stands for missing values: as a number if it is one, in any notation."""
    if value is None or value == "none":
        return None if value is None else ()
    try:
        number = math.nan if isinstance(value, bool | bytes) else float(value)
    except (TypeError, ValueError):
        if isinstance(value, str) and value.strip():
            return (value.strip(),)
        number = math.nan
    if math.isnan(number):
        remedy = "give the number or the text that stands for a missing value, or 'none' if there"
        raise refused("nodata", value, f"{remedy} is none")
    return (number,)


ColumnChoice: TypeAlias = str | Mapping[str, str] | Sequence[str] | None

LEFT_OUT = "-"  # the name of a column that is left out
MOST_LISTED = 12  # columns in a message

_DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": " ", "blank": " ", "pipe": "|"}


@dataclass(frozen=True, slots=True)
class TableOptions:
    """Checked options; `validate_table_options` makes them of what a caller gives."""

    # names of columns, by parts of a point
    chosen: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    names: tuple[str, ...] | None = None  # of all columns in order
    flat: bool | None = False  # None: heights are read where a column is known as them
    delimiter: str | None = None
    decimal: str | None = None
    skip_rows: int = 0
    header: bool = True
    missing: tuple[float | str, ...] | None = None  # (): none; None: the caller says neither
    end: str | None = None
    encoding: str | None = None

    @property
    def names_all(self) -> bool:
        """Whether the caller does not miss heights, or names every column."""
        return self.flat is not False or self.names is not None


def validate_table_options(  # noqa: PLR0913 - one for each option
    *,
    columns: ColumnChoice = None,
    flat: bool | None = False,
    delimiter: str | None = None,
    decimal: str | None = None,
    skip_rows: int = 0,
    header: bool = True,
    nodata: Missing = None,
    end: str | None = None,
    encoding: str | None = None,
) -> TableOptions:
    """Check the options of a table."""
    chosen, names = _columns(columns)
    if flat is not None:
        as_switch("flat", flat)
    options = TableOptions(
        chosen=MappingProxyType(chosen),
        names=names,
        flat=flat,
        delimiter=_delimiter(delimiter),
        decimal=_decimal(decimal),
        skip_rows=as_count("skip_rows", skip_rows, 0),
        header=as_switch("header", header),
        missing=as_missing(nodata),
        end=_text("end", end),
        encoding=_encoding(encoding),
    )
    if options.decimal is not None and options.decimal == options.delimiter:
        raise InputError(
            f"{Option('delimiter')} and {Option('decimal')} are both {decimal!r}: give two "
            "different ones"
        )
    if flat and "z" in (*chosen, *(names or ())):
        raise InputError(
            f"{Option('columns', ...)} names a column z, and {Option('flat', True)} says that "
            "there is none"
        )
    return options


def _columns(columns: ColumnChoice) -> tuple[dict[str, str], tuple[str, ...] | None]:
    """Return the columns chosen by name, and the names of all columns."""
    if columns is None:
        return {}, None
    if isinstance(columns, str):
        columns = _parsed(columns)
    if isinstance(columns, Mapping):
        chosen = {**columns}
        if not all(isinstance(each, str) and each for pair in chosen.items() for each in pair):
            raise _invalid(columns)
        return chosen, None
    if not isinstance(columns, Sequence) or not all(
        each is None or (isinstance(each, str) and each) for each in columns
    ):
        raise _invalid(columns)
    return {}, tuple(each or LEFT_OUT for each in columns)


def spelled(names: Sequence[str]) -> str:
    """Return the option that names all columns, for a message; "" if it cannot be typed."""
    if len(names) > MOST_LISTED or not all(map(is_plain, names)):
        return ""
    return f"{Option('columns', ','.join(names))}"


def is_plain(name: str) -> bool:
    """Whether a name can stand in the text form of columns=, and in quotes."""
    return bool(name) and len(name) <= 40 and not {*name} & {*",='\""} and name.isprintable()


def _parsed(text: str) -> dict[str, str] | list[str]:
    """Parse the form of the command line."""
    words = [word.strip() for word in text.split(",")]
    if "=" not in text:
        return words
    pairs = [word.partition("=") for word in words]
    if not all(name and mark and source for name, mark, source in pairs):
        raise _invalid(text)
    return {name.strip(): source.strip() for name, _, source in pairs}


def _invalid(columns: object) -> InputError:
    return refused(
        "columns",
        columns,
        f"give {Option('columns', 'x=..,y=..,z=..')} with the names of the table's columns, or the "
        f"names of all columns in order, as {Option('columns', 'id,x,y,z')}",
    )


def _text(name: str, value: object) -> str | None:
    if value is not None and (not isinstance(value, str) or not value.strip()):
        raise refused(name, value, "give a text")
    return None if value is None else value.strip()


def _encoding(value: object) -> str | None:
    """Check the name of an encoding of text: Python has others, of bytes, too."""
    if value is None:
        return None
    try:
        name = value if isinstance(value, str) else ""
        "0".encode(name)
        codecs.getincrementaldecoder(name)
    except (LookupError, UnicodeError, ValueError):
        raise refused("encoding", value, "give a name, as 'cp1252' or 'latin-1'") from None
    return name


def _delimiter(value: object) -> str | None:
    if value is None:
        return None
    mark = _DELIMITERS.get(value, value) if isinstance(value, str) else ""
    mark = "\t" if mark == "\\t" else mark  # as shells pass it on
    if len(mark) != 1 or mark.isalnum() or mark in "+-.\"'\r\n_#":
        remedy = "give one character, as ';', or tab, or space for blanks"
        raise refused("delimiter", value, remedy)
    return mark


def _decimal(value: object) -> str | None:
    if value is not None and value not in (".", ","):
        raise refused("decimal", value, "give '.' or ','")
    return None if value is None else str(value)


LEAST = 1 << 28  # bytes that the content of any file may take

# What a column of one row took at most: a scalar property of a PLY file 2,100 bytes if there are
# lists beside it, else 1,200; a list 1,500; an element 400; a column of text 500. In these are its
# bytes in the file, 20 to 40, for each of which 20 are allowed.
COLUMN_BYTES = 2000
MOST_COLUMNS = 10_000


def limit_of(max_bytes: int | None, usual: int, least: int = LEAST) -> int:
    """Return the limit: ``max_bytes`` if it is given, else ``usual``, but ``least`` at least."""
    return max(usual, least) if max_bytes is None else max_bytes


def most_columns(max_bytes: int | None) -> int:
    """Return how many columns the limit allows."""
    return limit_of(max_bytes, COLUMN_BYTES * MOST_COLUMNS, 0) // COLUMN_BYTES


def check_columns(count: int, max_bytes: int | None, where: str, what: str) -> None:
    """Raise if a table has more columns than the limit allows."""
    limit = limit_of(max_bytes, COLUMN_BYTES * MOST_COLUMNS, 0)
    check_expanded(count * COLUMN_BYTES, limit, where, what, "save only the columns you need, or ")


def check_expanded(needed: int, limit: int, name: str, what: str, remedy: str = "") -> None:
    """Raise if a part of a file needs more memory than the limit."""
    if needed > limit:
        raise FormatError(
            f"{name}: {what} expands to {needed:,} bytes, more than the limit of {limit:,}: "
            f"{remedy}if you trust the file, raise it with {Option('max_bytes', ...)}"
        )
