"""What a file format is: a name, its suffixes, and how to read and write it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import BinaryIO, TypeAlias

from liftmesh.cloud import Cloud

Origin: TypeAlias = tuple[float, float, float]
Reader: TypeAlias = Callable[[BinaryIO, str], Cloud]
Writer: TypeAlias = Callable[..., Origin | None]


@dataclass(frozen=True, slots=True)
class Format:
    """A file format: what another package registers to add one.

    Parameters
    ----------
    name : str
        Short name, as accepted by ``format=`` in :func:`liftmesh.read` and :func:`liftmesh.write`.
    suffixes : tuple of str
        Suffixes in lower case with their dot, the usual one first.
    read : callable or None
        ``read(stream, name) -> Cloud``: ``stream`` is binary and seekable, ``name`` is the file's
        name for messages. None if the format cannot be read.
    write : callable or None
        ``write(stream, cloud, **options)``: ``stream`` is binary. It returns None, or the origin
        (x, y, z) that was subtracted from every vertex. None if the format cannot be written.
    description : str
        One line for people.
    keeps : tuple of str
        Which of "colors", "normals" and "attributes" the writer has a place for; `write` reports
        what is not kept.

    Examples
    --------
    >>> import numpy as np
    >>> def read_pairs(stream, name):
    ...     return Cloud(np.loadtxt(stream, ndmin=2))
    >>> pairs = Format("pairs", (".pairs",), read_pairs, None, "three numbers a line")
    >>> pairs.write is None
    True
    """

    name: str
    suffixes: tuple[str, ...]
    read: Reader | None
    write: Writer | None
    description: str
    keeps: tuple[str, ...] = ("colors", "normals", "attributes")
