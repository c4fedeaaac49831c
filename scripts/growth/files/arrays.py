"""Families of NumPy's files.

An NPY file is one header and its values. An NPZ file is an archive: work grows with its directory,
and memory with what its members expand to, which its directory states.
"""

from __future__ import annotations

import io
import struct
import zipfile
from functools import cache

import numpy as np
from files.archives import zipped
from growth.families import named, random


def npy(array: np.ndarray) -> bytes:
    """Write one array."""
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def rows(n: int) -> bytes:
    """The ordinary array."""
    return npy(random().random((n, 3)))


def columns_first(n: int) -> bytes:
    """An array in column-major order: no row stands in one place."""
    return npy(np.asfortranarray(random().random((n, 3))))


def bytes_of_rows(n: int) -> bytes:
    """Coordinates of one byte: eight times as much once they are read."""
    return npy(random().integers(0, 100, (n, 2)).astype(np.uint8))


def half_floats(n: int) -> bytes:
    """Coordinates of two bytes, in the other order of bytes."""
    return npy(random().random((n, 2)).astype(">f2"))


def structured(n: int) -> bytes:
    """Rows of named values."""
    return npy(np.zeros(n, dtype=[("x", "<f4"), ("y", "<f4"), ("class", "u1")]))


def fields(n: int) -> bytes:
    """As many named values as NumPy's limit on headers allows."""
    names = [("x", "<f8"), ("y", "<f8"), *((f"f{k}", "u1") for k in range(min(n, 512)))]
    return npy(np.zeros(max(n // 512, 1), dtype=names))


def flags(n: int) -> bytes:
    """Structured rows of one-byte values."""
    return npy(np.zeros(n, dtype=[("x", "u1"), ("y", "u1"), ("f", "?"), ("g", "?")]))


def whole_numbers(n: int) -> bytes:
    """Whole numbers of eight bytes, each of which must fit a double."""
    return npy(random().integers(0, 1 << 50, (n, 2)))


def bytes_columns_first(n: int) -> bytes:
    """Coordinates of one byte in column-major order."""
    return npy(np.asfortranarray(np.zeros((n, 2), np.uint8)))


def long_header(n: int) -> bytes:
    """A header of blanks as long as the file."""
    return b"\x93NUMPY\x02\x00" + struct.pack("<I", n) + b" " * n


NPY = named(
    rows,
    columns_first,
    bytes_of_rows,
    half_floats,
    structured,
    fields,
    flags,
    whole_numbers,
    bytes_columns_first,
    long_header,
)


def npz(members: dict[str, bytes], method: int = zipfile.ZIP_STORED) -> bytes:
    """Write an archive of arrays."""
    return zipped({f"{name}.npy": content for name, content in members.items()}, method)


def mesh(n: int) -> dict[str, bytes]:
    """Make the members of a mesh."""
    rng = random()
    faces = rng.integers(0, n, (2 * n, 3)).astype(np.int32)
    points = np.round(rng.random((n, 3)) * 1000, 2)
    colors = rng.integers(0, 256, (n, 3)).astype(np.uint8)
    return {"points": npy(points), "faces": npy(faces), "colors": npy(colors)}


def stored(n: int) -> bytes:
    """The ordinary archive."""
    return npz(mesh(n))


def deflated(n: int) -> bytes:
    """The ordinary archive, compressed."""
    return npz(mesh(n), zipfile.ZIP_DEFLATED)


def zeros(n: int) -> bytes:
    """Zeros, which a thousandth of their size describes."""
    return npz({"points": npy(np.zeros((n, 3)))}, zipfile.ZIP_DEFLATED)


def members(n: int) -> bytes:
    """Very many members: a name must not be compared with all before it."""
    column = npy(np.zeros(2))
    return npz({"points": npy(np.eye(2)), **{f"a{k}": column for k in range(n)}})


def alike(n: int, method: int) -> bytes:
    """Write an archive of n members that are compressed once."""
    one = npz({"0000000": npy(np.zeros(2))}, method)
    points = npz({"points": npy(np.eye(2))}, method)
    (body, entries, end), (again, entry, _) = map(parts_of, (points, one))
    numbers = [b"%07d" % k for k in range(n)]
    places = [struct.pack("<L", len(body) + k * len(again)) for k in range(n)]
    body += b"".join(again.replace(b"0000000", each) for each in numbers)
    pairs = zip(numbers, places, strict=True)
    entries += b"".join(entry[:42] + place + each + entry[53:] for each, place in pairs)
    sizes = struct.pack("<2H2L", n + 1, n + 1, len(entries), len(body))
    return body + entries + end[:8] + sizes + end[20:]


def parts_of(archive: bytes) -> tuple[bytes, bytes, bytes]:
    """Split an archive of one member: what it holds, its directory, and the end."""
    directory, end = (archive.index(mark) for mark in (b"PK\1\2", b"PK\5\6"))
    return archive[:directory], archive[directory:end], archive[end:]


def members_deflated(n: int) -> bytes:
    """Very many compressed members: each decompressor takes more than what it reads."""
    return alike(min(n, 65_000), zipfile.ZIP_DEFLATED)


def skipped_members(n: int) -> bytes:
    """Members that fit no row, each of which is named."""
    lonely = npy(np.zeros(3))
    return npz({"points": npy(np.eye(2)), **{f"a{k}": lonely for k in range(n)}})


def foreign_members(n: int) -> bytes:
    """Members that are no arrays."""
    stream = io.BytesIO(npz({"points": npy(np.eye(2))}))
    with zipfile.ZipFile(stream, "a") as archive:
        for k in range(n):
            archive.writestr(f"note{k}.txt", b"")
    return stream.getvalue()


@cache  # it is the same for every number of notes, and takes a second or two to compress
def going_on(method: int) -> bytes:
    """Change an archive of a method so that its member states fewer bytes than its stream has."""
    whole, more = npy(np.eye(3)), bytes(1 << 26)
    data = npz({"points": whole + more}, method)
    stated = struct.pack("<L", len(whole))
    return data.replace(struct.pack("<L", len(whole) + len(more)), stated)


def deflate_that_goes_on(n: int) -> bytes:
    """A stream of 64 MB behind a member that states some hundred bytes, and n bytes of notes."""
    return going_on(zipfile.ZIP_DEFLATED) + bytes(n)


def long_names(n: int) -> bytes:
    """Members with names of sixty thousand letters."""
    tiny = npy(np.zeros(3))
    names = {f"{'a' * 60_000}{k}": tiny for k in range(max(n // 64, 1))}
    return npz({"points": npy(np.eye(2)), **names})


def bytes_in_members(n: int) -> bytes:
    """Coordinates of one byte, compressed."""
    return npz({"points": npy(np.zeros((n, 2), np.uint8))}, zipfile.ZIP_DEFLATED)


NPZ = named(
    stored,
    deflated,
    zeros,
    members,
    members_deflated,
    skipped_members,
    foreign_members,
    long_names,
    bytes_in_members,
)

LIES = named(deflate_that_goes_on)
"""Their size is not what they expand to, so they are for the memory tests alone."""
