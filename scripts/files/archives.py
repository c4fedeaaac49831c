"""Archives: as zipfile writes them, and made byte by byte, so that directory and data disagree."""

from __future__ import annotations

import bz2
import io
import lzma
import struct
import zipfile
import zlib

STORED, DEFLATED = zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED
BZIP2, LZMA = zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA
METHODS = (STORED, DEFLATED)

LZMA_MODEL = {"id": lzma.FILTER_LZMA1, "lc": 3, "lp": 0, "pb": 2, "dict_size": 1 << 20}


def packed(method: int, content: bytes) -> bytes:
    """Compress the content of a member; LZMA's properties precede it."""
    if method == DEFLATED:
        deflate = zlib.compressobj(9, zlib.DEFLATED, -15)
        return deflate.compress(content) + deflate.flush()
    if method == BZIP2:
        return bz2.compress(content)
    if method == LZMA:
        head = struct.pack("<2BHBL", 9, 4, 5, 93, LZMA_MODEL["dict_size"])
        return head + lzma.compress(content, lzma.FORMAT_RAW, filters=[LZMA_MODEL])
    return content


def archive(
    data: bytes,
    stated: bytes,
    *,
    method: int = STORED,
    name: bytes = b"points.npy",
    flags: int = 0,
    local: tuple[int, int, int, int] | None = None,
    extra: bytes = b"",
    size: int | None = None,
) -> bytes:
    """Make an archive of one member; size (if it is not given) and checksum are of ``stated``.

    ``local`` replaces method, checksum and sizes in the header in front of the data, ``extra`` is
    the extra field there.
    """
    sums = (zlib.crc32(stated), len(data), len(stated) if size is None else size)
    there, *its_sums = local or (method, *sums)
    head = struct.pack(
        "<4s5H3L2H", b"PK\3\4", 63, flags, there, 0, 33, *its_sums, len(name), len(extra)
    )
    entry = struct.pack(
        "<4s6H3L5H2L", b"PK\1\2", 63, 63, flags, method, 0, 33, *sums, len(name), *[0] * 6
    )
    body = head + name + extra + data
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 1, 1, len(entry + name), len(body), 0)
    return body + entry + name + end


def zipped(members: dict[str, bytes], method: int = DEFLATED) -> bytes:
    """Write an archive of members by their names."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return stream.getvalue()
