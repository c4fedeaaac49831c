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
    """Return the limit: ``max_bytes`` if it is given, else ``usual``, but ``least`` at least.

    Examples
    --------
    >>> limit_of(None, 7), limit_of(None, 10**9), limit_of(9, 10**9)
    (268435456, 1000000000, 9)
    """
    return max(usual, least) if max_bytes is None else max_bytes


def most_columns(max_bytes: int | None) -> int:
    """Return how many columns the limit allows.

    Examples
    --------
    >>> most_columns(None), most_columns(100_000_000)
    (10000, 50000)
    """
    return limit_of(max_bytes, COLUMN_BYTES * MOST_COLUMNS, 0) // COLUMN_BYTES


def check_columns(count: int, max_bytes: int | None, where: str, what: str) -> None:
    """Raise if a table has more columns than the limit allows.

    Parameters
    ----------
    count : int
        Number of columns, each of `COLUMN_BYTES` bytes.
    max_bytes : int, optional
        The limit; by default what `MOST_COLUMNS` columns take.
    where, what : str
        The file and its part for messages.

    Raises
    ------
    FormatError
        It has more; the message gives the bytes of both, and the option.

    Examples
    --------
    >>> check_columns(10_000, None, "wide.csv: line 1", "a row of 10,000 values")
    >>> check_columns(3, 5999, "wide.csv: line 1", "a row of 3 values")
    Traceback (most recent call last):
    ...
    liftmesh.errors.FormatError: wide.csv: line 1: a row of 3 values expands to 6,000 bytes, more\
 than the limit of 5,999: save only the columns you need, or if you trust the file, raise it with\
 max_bytes=
    """
    limit = limit_of(max_bytes, COLUMN_BYTES * MOST_COLUMNS, 0)
    check_expanded(count * COLUMN_BYTES, limit, where, what, "save only the columns you need, or ")


def check_expanded(needed: int, limit: int, name: str, what: str, remedy: str = "") -> None:
    """Raise if a part of a file needs more memory than the limit.

    Parameters
    ----------
    needed : int
        Number of bytes in memory.
    limit : int
        The number allowed.
    name, what : str
        The file and its part for messages.
    remedy : str
        What to do rather than to raise the limit.

    Raises
    ------
    FormatError
        It needs more; the message gives both figures and the option.

    Examples
    --------
    >>> check_expanded(1000, 1000, "points.npz", "points.npy")
    >>> check_expanded(1001, 1000, "points.npz", "points.npy")
    Traceback (most recent call last):
    ...
    liftmesh.errors.FormatError: points.npz: points.npy expands to 1,001 bytes, more than the limit\
 of 1,000: if you trust the file, raise it with max_bytes=
    """
    if needed > limit:
        raise FormatError(
            f"{name}: {what} expands to {needed:,} bytes, more than the limit of {limit:,}: "
            f"{remedy}if you trust the file, raise it with max_bytes="
        )
