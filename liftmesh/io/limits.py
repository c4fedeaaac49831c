"""The limit of what a file may expand to in memory: ``max_bytes``, or the format's own.

A compressed or instanced file can hold far more than its bytes, and each column of a table takes
memory for its name and its array, however short the table. What a file would take is computed from
what it states, and compared with the limit before anything is built.
"""

from __future__ import annotations

from liftmesh.errors import FormatError

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
            f"{remedy}if you trust the file, raise it with max_bytes="
        )
