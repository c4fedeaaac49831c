"""Options of tables: what the caller says about their layout and the meaning of their columns.

What the names of a table say is used; what only its values suggest needs one of these options, so
that nothing is applied by a guess. ``columns`` has one form as text, on the command line and in
messages (``x=East,y=North,z=H``, or the names of all columns in order), and mappings and sequences
in Python.
"""

from __future__ import annotations

import codecs
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

from liftmesh.base.options import as_count, as_switch, refused
from liftmesh.errors import InputError, Option
from liftmesh.io.missing import Missing, as_missing

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
