"""Families of STL files, binary and text.

Equal vertices are merged, so work grows where very many are equal, and where text is not laid out
as most programs do it.
"""

from __future__ import annotations

import struct

import numpy as np
from growth.families import families_in, random
from growth.files.text import positions


def binary(corners: np.ndarray) -> bytes:
    """Write triangles as binary STL."""
    rows = np.zeros(len(corners), dtype=[("n", "<f4", (3,)), ("c", "<f4", (3, 3)), ("a", "<u2")])
    rows["c"] = corners
    return bytes(80) + struct.pack("<I", len(rows)) + rows.tobytes()


def facet(corners: list[str]) -> str:
    """Write one facet as text."""
    loop = "".join(f"vertex {corner}\n" for corner in corners)
    return f"facet normal 0 0 1\nouter loop\n{loop}endloop\nendfacet\n"


def grid(n: int) -> bytes:
    """The ordinary mesh: each vertex in several triangles."""
    return binary(random().integers(0, max(int((n / 2) ** 0.5), 2), (n, 3, 3)))


def soup(n: int) -> bytes:
    """Triangles that share nothing."""
    return binary(random().random((n, 3, 3)))


def one_point(n: int) -> bytes:
    """All corners are one position."""
    return binary(np.ones((n, 3, 3)))


def signed_zeros(n: int) -> bytes:
    """Zeros of both signs, which are equal and differ in their bytes."""
    return binary(random().choice([0.0, -0.0], (n, 3, 3)))


def one_axis(n: int) -> bytes:
    """Positions that differ along one axis only."""
    corners = np.zeros((n, 3, 3))
    corners[..., 2] = np.arange(3 * n).reshape(n, 3)
    return binary(corners)


def solid_in_binary(n: int) -> bytes:
    """A binary file that begins like a text."""
    return b"solid" + soup(n)[5:]


def facets_as_text(n: int) -> bytes:
    """The ordinary text."""
    rows = positions(3 * n).splitlines()
    facets = "".join(facet(rows[k : k + 3]) for k in range(0, 3 * n, 3))
    return f"solid s\n{facets}endsolid s\n".encode()


def solids(n: int) -> bytes:
    """A solid for each facet, with names of their own."""
    body = facet(["0 0 0", "1 0 0", "0 1 0"])
    return "".join(f"solid s{k}\n{body}endsolid s{k}\n" for k in range(n)).encode()


def one_line(n: int) -> bytes:
    """Facets without the ends of lines."""
    return facets_as_text(n).replace(b"\n", b" ")


STL = families_in(globals(), "bytes")
