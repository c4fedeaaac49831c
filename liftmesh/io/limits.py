"""The limit of what a file may expand to in memory.

A compressed or instanced file can hold far more than its bytes. What it would take is computed from
what the file states, and compared with the limit before anything is built.
"""

from __future__ import annotations

from liftmesh.errors import FormatError


def check_expanded(needed: int, limit: int | None, name: str, what: str) -> None:
    """Raise if a part of a file needs more memory than the limit; None is no limit.

    Parameters
    ----------
    needed : int
        Number of bytes in memory.
    limit : int, optional
        The number allowed: ``max_bytes``, or the format's own.
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
    if limit is not None and needed > limit:
        raise FormatError(
            f"{name}: {what} expands to {needed:,} bytes, more than the limit of {limit:,}: "
            "if you trust the file, raise it with max_bytes="
        )
