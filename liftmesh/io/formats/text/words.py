"""The values of a line of a table as text: split, unquoted, and with a decimal point.

Quotes follow the rules of Python's csv module: a value in quotes may hold the delimiter, and two
quotes stand for one. Between blanks there are no empty values.
"""

from __future__ import annotations

import csv
import re

from liftmesh.errors import FormatError

_REMARK = re.compile(r"(?<!\s)\s+#(?:\s|$)")
_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")
_GROUPED = re.compile(r"[-+]?\d{1,3},\d{3}")  # 1,234 is also how thousands are grouped
_WORDS = re.compile(r'"((?:[^"]|""){0,131072})"(?!\S)|(\S+)')  # as long as csv's field may be


def split(text: str, delimiter: str | None, where: str) -> list[str]:
    """Split a line into its values, without their quotes and the blanks around them."""
    if '"' not in text:
        return [value.strip() for value in text.split(delimiter)]
    if delimiter is None:
        found = (match.groups(default="") for match in _WORDS.finditer(text))
        return [(quoted.replace('""', '"') or bare).strip() for quoted, bare in found]
    try:
        rows = [*csv.reader([text], delimiter=delimiter, skipinitialspace=True, strict=True)]
    except csv.Error as error:
        raise FormatError(
            f"{where}: its quotes are not closed, or text follows them ({error}): a value in "
            "quotes must stand on one line"
        ) from error
    return [value.strip() for value in rows[0]]


def without_remark(text: str) -> str:
    """Cut off a comment behind a row: a # with a blank on each side, outside quotes."""
    found = _REMARK.search(text) if "#" in text else None
    return text if found is None or text.count('"', 0, found.start()) % 2 else text[: found.start()]


def with_point(value: str) -> str:
    """Return a number with a decimal comma as one with a point; "" if it is none."""
    return value.replace(",", ".") if _COMMA.fullmatch(value) else ""


def may_be_grouped(value: str) -> bool:
    """Whether the comma of a number may separate thousands."""
    return _GROUPED.fullmatch(value) is not None
