"""The limit of what a file may expand to in memory: ``max_bytes``, or the format's own.

A compressed or instanced file can hold far more than its bytes. What it would take is computed from
what the file states, and compared with the limit before anything is built.
"""

from __future__ import annotations

from liftmesh.errors import FormatError

LEAST = 1 << 28  # bytes that the content of any file may take


def limit_of(max_bytes: int | None, usual: int, least: int = LEAST) -> int:
    """Return the limit: ``max_bytes`` if it is given, else ``usual``, but ``least`` at least.

    Examples
    --------
    >>> limit_of(None, 7), limit_of(None, 10**9), limit_of(9, 10**9)
    (268435456, 1000000000, 9)
    """
    return max(usual, least) if max_bytes is None else max_bytes


def check_expanded(needed: int, limit: int, name: str, what: str) -> None:
    """Raise if a part of a file needs more memory than the limit.

    Parameters
    ----------
    needed : int
        Number of bytes in memory.
    limit : int
        The number allowed.
    name, what : str
        The file and its part for messages.

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
            "if you trust the file, raise it with max_bytes="
        )
