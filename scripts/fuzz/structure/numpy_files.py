"""NPY and NPZ files: headers of NumPy, and archives whose directories and streams disagree."""

from __future__ import annotations

import functools
import zlib
from dataclasses import dataclass

import numpy as np
from fuzz.structure.case import Case, Points, in_order, quarters
from fuzz.structure.parts import Chance, Liar, Part, encoded

NPY_WORDS = [b"<f8", b"|O", b"|V0", b"<U0", b">c16", b"|b1", b"<M8[s]", b"(4, 3)", b"'descr'",
             b"[('x', '<f8'), ('y', '<f8')]", b"('<f8', (3,))", b"__import__('os')", b"-1", b"True",
             b"(" * 300, b"-" * 9000, b"None", b"{}", b"\x01\x00", b"\x03\x00"]  # fmt: skip
ZIP_WORDS = [b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06", b"PK\x06\x06", b"PK\x06\x07",
             b"faces.npy", b"points.npy", b"colors.npy", b"../a.npy", b"/a.npy",
             b"crs.npy"]  # fmt: skip
STORED, DEFLATED = 0, 8
SURPLUS = (0, 0, 0, 0, 0, 0, 1, 100, 1 << 16, 1 << 24)


def npy(chance: Chance) -> Case:
    """Make an NPY file."""
    parts, points = _points(chance)
    if chance.one_in(4):
        return Case("npy", encoded(parts), in_order(points))
    return Case("npy", encoded(Liar(parts, NPY_WORDS, chance).lie(chance.choice((1, 1, 2, 4)))))


def _points(chance: Chance) -> tuple[list[Part], Points]:
    """Make an array of points: rows of two or three numbers, or a structured array."""
    points = quarters(chance, chance.randint(1, 6), chance.choice((2, 3)))
    code = chance.choice(("<f8", ">f8", "<f4", "<f2", "<i4", "|i1", ">i8"))
    if code[1] == "i":
        points = np.rint(points)
    whole = np.zeros((len(points), 3))
    whole[:, : points.shape[1]] = points
    if chance.one_in(4):
        names = [*"xyz"[: points.shape[1]], *chance.some(("nx", "red", "green", "blue", "class"))]
        rows = np.zeros(len(points), [(name, code) for name in names])
        for k in range(points.shape[1]):
            rows["xyz"[k]] = points[:, k]
        return array_parts(rows, chance), whole
    values = points.astype(code)
    return array_parts(np.asfortranarray(values) if chance.one_in(4) else values, chance), whole


def array_parts(values: np.ndarray, chance: Chance) -> list[Part]:
    """Split the NPY file of an array into parts."""
    by_columns = values.flags.f_contiguous and not values.flags.c_contiguous
    shape = [piece for n in values.shape for piece in (Part(n), Part(b", "))]
    descr = values.dtype.descr if values.dtype.names else values.dtype.str
    header = [
        Part(b"{"), Part(b"'descr'"), Part(b": "), Part(repr(descr).encode()), Part(b", "),
        Part(b"'fortran_order'"), Part(b": "), Part(str(by_columns).encode()), Part(b", "),
        Part(b"'shape'"), Part(b": ("), *shape, Part(b")"), Part(b"}"), Part(b"\n"),
    ]  # fmt: skip
    version, form = chance.choice(((1, "<H"), (2, "<I")))
    head = [Part(b"\x93NUMPY"), Part(version, "<B"), Part(0, "<B")]
    body = values.tobytes("F" if by_columns else "C")
    rows = [Part(body[k : k + 24]) for k in range(0, len(body), 24)]
    return [*head, Part(len(encoded(header)), form), *header, *rows]


@dataclass(frozen=True, slots=True)
class Member:
    """A member of an archive, whose stream goes on past its size by ``surplus`` zeros."""

    name: bytes
    content: bytes
    method: int
    surplus: int = 0

    def packed(self) -> bytes:
        """Return the compressed stream."""
        return _packed(self.content, self.surplus, self.method)


@functools.lru_cache(maxsize=64)
def _packed(content: bytes, surplus: int, method: int) -> bytes:
    data = content + bytes(surplus)
    if method == DEFLATED:
        return zlib.compress(data, wbits=-15)
    return data


def npz(chance: Chance) -> Case:
    """Make an NPZ file."""
    members, points = _members(chance)
    is_honest = chance.one_in(4)
    if not is_honest and chance.one_in(2):
        at = chance.randrange(len(members))
        parts = Liar(array_parts(points, chance), NPY_WORDS, chance).lie(1)
        surplus = chance.choice(SURPLUS)
        old = members[at]
        content = encoded(parts) if chance.one_in(2) else old.content
        surplus = surplus if old.method != STORED else min(surplus, 1 << 16)
        members[at] = Member(old.name, content, old.method, surplus)
    parts = archive(members, chance)
    content = sum(len(each.content) for each in members)
    if is_honest:
        return Case("npz", encoded(parts), in_order(points), content)
    return Case("npz", encoded(Liar(parts, ZIP_WORDS, chance).lie(chance.choice((0, 1, 2)))),
                content=content)  # fmt: skip


def _members(chance: Chance) -> tuple[list[Member], Points]:
    """Make the arrays of a cloud."""
    points = quarters(chance, chance.randint(1, 6))
    rows = len(points)
    arrays: dict[bytes, np.ndarray] = {b"points": points}
    others = {
        b"faces": np.zeros((2, 3), np.int32), b"colors": np.zeros((rows, 3), np.uint8),
        b"normals": np.ones((rows, 3)), b"crs": np.array("EPSG:25832"), b"class": np.zeros(rows),
        b"a b": np.zeros((rows, 2), ">i4"), b"flag": np.zeros(rows, bool), b"c": np.zeros(7),
    }  # fmt: skip
    arrays |= {key: others[key] for key in chance.some([*others])}
    method = chance.choice((STORED, DEFLATED))
    members = [
        Member(key + b".npy", encoded(array_parts(values, chance)), method)
        for key, values in arrays.items()
    ]
    chance.shuffle(members)
    return members, points


def archive(members: list[Member], chance: Chance) -> list[Part]:
    """Write an archive part by part, in the layout of PKWARE's APPNOTE.TXT."""
    parts: list[Part] = []
    directory: list[Part] = []
    for each in members:
        packed = each.packed()
        shared = [
            Part(20, "<H"), Part(0, "<H"), Part(each.method, "<H"),
            Part(0, "<H"), Part(33, "<H"), Part(zlib.crc32(each.content), "<I"),
            Part(len(packed), "<I"), Part(len(each.content), "<I"), Part(len(each.name), "<H"),
            Part(0, "<H"),
        ]  # fmt: skip
        at = len(encoded(parts))
        local = [Part(b"PK\x03\x04"), *shared, Part(each.name)]
        parts += [*local, *(Part(packed[k : k + 64]) for k in range(0, len(packed), 64))]
        directory += [Part(b"PK\x01\x02"), Part(20, "<H"), *shared, Part(0, "<H"), Part(0, "<H"),
                      Part(0, "<H"), Part(0, "<I"), Part(at, "<I"), Part(each.name)]  # fmt: skip
    comment = chance.choice((b"", b"", b"a"))
    end = [Part(b"PK\x05\x06"), Part(0, "<H"), Part(0, "<H"), Part(len(members), "<H"),
           Part(len(members), "<H"), Part(len(encoded(directory)), "<I"),
           Part(len(encoded(parts)), "<I"), Part(len(comment), "<H"), Part(comment)]  # fmt: skip
    return [*parts, *directory, *end]
