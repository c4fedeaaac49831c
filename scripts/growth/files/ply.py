"""Families of PLY files.

Work grows where an element, a property or a comment is looked for among all others, where each list
element reads what is left of the file, and where rows of unlike lists are handled one by one.
"""

from __future__ import annotations

import numpy as np
from growth.families import families_in, random

POINT = ("property double x", "property double y", "property double z")
LISTS = "property list uchar int vertex_indices"


def ply(encoding: str, lines: list[str], body: bytes = b"") -> bytes:
    """Put a file together."""
    kind = "ascii" if encoding == "ascii" else f"binary_{encoding}_endian"
    return "\n".join(["ply", f"format {kind} 1.0", *lines, "end_header", ""]).encode() + body


def vertices(n: int) -> tuple[list[str], bytes, bytes]:
    """Make n vertices: the lines of their header, their rows in binary and as text."""
    points = np.round(random().random((n, 3)) * 1000, 2)
    text = "".join(f"{x} {y} {z}\n" for x, y, z in points.tolist()).encode()
    return [f"element vertex {n}", *POINT], points.tobytes(), text


def mesh(n: int, polygons: list[list[int]], encoding: str, lists: str = LISTS) -> bytes:
    """Make a file of n vertices and the given faces; lengths are uchar, corners int."""
    lines, binary, text = vertices(n)
    lines += [f"element face {len(polygons)}", lists]
    if encoding == "ascii":
        rows = "".join(f"{len(each)} {' '.join(map(str, each))}\n" for each in polygons)
        return ply(encoding, lines, text + rows.encode())
    faces = b"".join(
        bytes([len(each)]) + np.array(each, dtype="<i4").tobytes() for each in polygons
    )
    return ply(encoding, lines, binary + faces)


def unlike(n: int) -> list[list[int]]:
    """Triangles and quadrilaterals in turn."""
    return [[k % n, (k + 1) % n, (k + 2) % n, (k + 3) % n][: 3 + k % 2] for k in range(n)]


def points_in_binary(n: int) -> bytes:
    """The ordinary file of points."""
    lines, binary, _ = vertices(n)
    return ply("little", lines, binary)


def points_as_text(n: int) -> bytes:
    """The ordinary file of points as text."""
    lines, _, text = vertices(n)
    return ply("ascii", lines, text)


def triangles_in_binary(n: int) -> bytes:
    """The ordinary mesh."""
    return mesh(n, [[k, (k + 1) % n, (k + 2) % n] for k in range(n)], "little")


def triangles_as_text(n: int) -> bytes:
    """The ordinary mesh as text."""
    return mesh(n, [[k, (k + 1) % n, (k + 2) % n] for k in range(n)], "ascii")


def polygons_in_binary(n: int) -> bytes:
    """Triangles and quadrilaterals in turn: no two rows that follow each other have one layout."""
    return mesh(n, unlike(n), "little")


def polygons_as_text(n: int) -> bytes:
    """Triangles and quadrilaterals in turn, as text: no block of lines has one width."""
    return mesh(n, unlike(n), "ascii")


def empty_lists_in_binary(n: int) -> bytes:
    """Faces without corners: what is kept for a row outweighs its one byte."""
    return mesh(3, [*([[]] * n), [0, 1, 2]], "little")


def empty_lists_as_text(n: int) -> bytes:
    """Faces without corners, two bytes each."""
    return mesh(3, [*([[]] * n), [0, 1, 2]], "ascii")


def one_polygon_in_binary(n: int) -> bytes:
    """One face with all vertices for corners."""
    lines, binary, _ = vertices(n)
    lines += ["element face 1", "property list uint int vertex_indices"]
    return ply("little", lines, binary + np.array([n, *range(n)], dtype="<i4").tobytes())


def one_polygon_as_text(n: int) -> bytes:
    """One face with all vertices for corners: a line as long as the file."""
    return mesh(n, [[*range(n)]], "ascii", "property list uint int vertex_indices")


def list_elements(n: int) -> bytes:
    """Elements of one list each before a large one: each may read all that remains."""
    lines = [line for k in range(n) for line in (f"element e{k} 1", "property list uchar uchar a")]
    rows = 128 * n
    lines += [f"element vertex {rows}", *POINT]
    return ply("little", lines, bytes(n) + bytes(24 * rows))


def scalar_elements(n: int) -> bytes:
    """Elements of one value each: an element must not be compared with all before it."""
    lines = [line for k in range(n) for line in (f"element e{k} 1", "property uchar a")]
    return ply("little", [*lines, "element vertex 1", *POINT], bytes(n + 24))


def text_elements(n: int) -> bytes:
    """Elements of one line each: each may split the lines that remain anew."""
    lines = [line for k in range(n) for line in (f"element e{k} 1", "property list uchar int a")]
    return ply("ascii", [*lines, "element vertex 1", *POINT], b"1 7\n" * n + b"0 0 0\n")


def empty_elements(n: int) -> bytes:
    """Elements without rows."""
    lines = [line for k in range(n) for line in (f"element e{k} 0", "property list uchar int a")]
    return ply("little", [*lines, "element vertex 1", *POINT], bytes(24))


def properties(n: int) -> bytes:
    """A vertex of many properties: a property must not be compared with all before it."""
    lines = ["element vertex 4", *POINT, *(f"property double p{k}" for k in range(n))]
    return ply("little", lines, bytes(4 * (24 + 8 * n)))


def list_properties(n: int) -> bytes:
    """A face of many lists, in rows of unlike layouts."""
    lines, binary, _ = vertices(4)
    lines += ["element face 3", LISTS, *(f"property list uchar uchar p{k}" for k in range(n))]
    rows = b"".join(bytes([3]) + bytes(12) + bytes([k % 2] + [0] * (k % 2)) * n for k in range(3))
    return ply("little", lines, binary + rows)


def comments(n: int) -> bytes:
    """A header of comments."""
    lines, binary, _ = vertices(4)
    return ply("little", [*(f"comment {k}" for k in range(n)), *lines], binary)


def vertices_with_lists(n: int) -> bytes:
    """Vertices that have lists, and so cannot be read in chunks."""
    lines = [f"element vertex {n}", *POINT, "property list uchar uchar tags"]
    return ply(
        "little", lines, b"".join(bytes(24) + bytes([k % 3]) * (k % 3 + 1) for k in range(n))
    )


def blank_lines(n: int) -> bytes:
    """Lines of nothing between the rows."""
    lines, _, text = vertices(n)
    return ply("ascii", lines, text.replace(b"\n", b"\n\n\n\n"))


def triangles_then_quads(n: int) -> bytes:
    """Triangles, then quadrilaterals: the second half has another layout than the first row."""
    return mesh(n, [[0, 1, 2]] * n + [[0, 1, 2, 3]] * n, "little")


def triangles_then_quads_as_text(n: int) -> bytes:
    """The same as text."""
    return mesh(n, [[0, 1, 2]] * n + [[0, 1, 2, 3]] * n, "ascii")


def growing_lists(n: int) -> bytes:
    """Every row one corner longer than the row before it: as many layouts as there are rows."""
    sides = range(int((2 * n) ** 0.5) + 1)
    return mesh(3, [[0] * k for k in sides], "ascii", "property list uint int vertex_indices")


def longest_uniform_lists(n: int) -> bytes:
    """Polygons of 255 corners, the longest that a length of one byte allows."""
    return mesh(3, [[0] * 255] * max(n // 4, 1), "little")


def rows_of_nothing(n: int) -> bytes:
    """Elements of a billion rows that have no properties."""
    lines, binary, _ = vertices(4)
    return ply("little", [*lines, *(f"element e{k} 1000000000" for k in range(n))], binary)


def two_byte_rows(n: int) -> bytes:
    """Coordinates of one byte."""
    lines = [f"element vertex {n}", "property uchar x", "property uchar y"]
    return ply("little", lines, bytes(2 * n))


def blank_lines_first(n: int) -> bytes:
    """Lines of nothing before the first row."""
    lines = ["element vertex 1", "property uchar x", "property uchar y"]
    return ply("ascii", lines, b"\n" * n + b"0 0\n")


def metadata_comments(n: int) -> bytes:
    """Comments that state metadata, as nested as they may be, and more of them than are read."""
    entry = "{" + f'"k": [{"[],{}," * 100}0]' + "}"
    lines = [f"comment metadata {entry}"] * (n // 32 + 1)
    return ply(
        "ascii", [*lines, "element vertex 1", "property uchar x", "property uchar y"], b"0 0\n"
    )


def renamed_properties(n: int) -> bytes:
    """Very many properties, each with a comment that states another name for it."""
    names = [f'comment property p{k} "p {k % (n // 2 + 1)}"' for k in range(n)]
    lines = ["element vertex 1", "property uchar x", "property uchar y"]
    lines += [f"property uchar p{k}" for k in range(n)]
    return ply("little", [*names, *lines], bytes(n + 2))


PLY = families_in(globals(), "bytes")
