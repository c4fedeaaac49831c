"""The limit of what a file may expand to in memory: ``max_bytes``, or the format's own.

A compressed or instanced file can hold far more than its bytes, and each column of a table takes
memory for its name and its array, however short the table. What a file would take is computed from
what it states, and compared with the limit before anything is built.

What JSON takes once it is parsed is counted from the marks of its text: each brace begins an
object, each bracket a list, and each comma an entry of one of them, perhaps with a number. Strings
are cheap if they are keys that come again, because Python holds equal keys once, and dear if they
are keys that do not. To tell them apart takes about as long as parsing, so all are taken for new
keys first, which suffices for most files.
"""

from __future__ import annotations

import re

from liftmesh.errors import FormatError, Option

LEAST = 1 << 28  # bytes that the content of any file may take

# What a column of one row took at most: a scalar property of a PLY file 2,100 bytes if there are
# lists beside it, else 1,200; a list 1,500; an element 400; a column of text 500. In these are its
# bytes in the file, 20 to 40, for each of which 20 are allowed.
COLUMN_BYTES = 2000
MOST_COLUMNS = 10_000

# Bytes at most, with their share of growing tables: CPython 3.10 to 3.14, 64 bits.
_OBJECT, _LIST, _ENTRY = 210, 90, 40
_KEY, _STRING = 170, 60

# What the text takes itself, for each of its bytes: it is held as bytes, and as characters of up
# to four bytes if one of them needs as many.
_ASCII, _OTHER = 2, 5

_STRINGS = re.compile(rb'"([^"]*)"([ \t\r\n]*:)?')


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


def bytes_of_text(text: bytes) -> int:
    """Return what a text takes as long as it is parsed, without what is made of it."""
    return (_ASCII if text.isascii() else _OTHER) * len(text)


def bytes_of_tree(text: bytes, enough: int) -> int:
    """Return what the objects take that a text describes."""
    marks = _OBJECT * text.count(b"{") + _LIST * text.count(b"[") + _ENTRY * text.count(b",")
    needed = marks + _KEY * (text.count(b'"') // 2)
    return needed if needed <= enough else marks + _bytes_of_strings(text, enough)


def _bytes_of_strings(text: bytes, enough: int) -> int:
    """Look at each string: distinct keys, other strings; keys that came before are free."""
    plain = text.replace(rb"\\", b"\0").replace(rb"\"", b"\1")  # neither is in valid JSON
    keys: set[bytes] = set()
    others = 0
    for string in _STRINGS.finditer(plain):
        if string[2] is None:
            others += 1
        else:
            keys.add(string[1])
        if _KEY * len(keys) > enough:
            break
    return _KEY * len(keys) + _STRING * others
