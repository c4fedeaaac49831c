"""Files whose rows are as short, as long or as unlike as can be: little memory for each byte."""

from __future__ import annotations

import json
from typing import Any

import pytest
from children import output

# What a file of these many bytes may take: 20 times its size, and what blocks and masks need.
SIZE = 3_000_000
MOST = 20 * SIZE + 16_000_000

PROGRAM = """
    import io, json, os, sys
    import liftmesh

    tiny = {
        "ply": b"ply\\nformat ascii 1.0\\nelement vertex 1\\nproperty float x\\n"
        b"property float y\\nproperty list uchar uchar a\\nend_header\\n0 0 1 2\\n",
        "obj": b"v 0 0 0\\nf 1 1 1 1\\n",
        "off": b"OFF\\n1 1 0\\n0 0 0\\n4 0 0 0 0\\n",
        "xyz": b"1 1\\n",
        "npy": b"nothing",
    }

    def read(kind, data):
        try:
            cloud = liftmesh.read(io.BytesIO(data), format=kind)
        except liftmesh.FormatError as error:
            return str(error)
        return [len(cloud), 0 if cloud.faces is None else len(cloud.faces)]

    for kind, data in tiny.items():  # what they import is no part of it
        read(kind, data)
    for kind, head, row, count, tail in json.loads(sys.argv[1]):
        if child := os.fork():  # its peak begins with what is in use now
            assert os.waitpid(child, 0)[1] == 0
            continue
        parts = [head.encode("latin-1"), row.encode("latin-1") * count, tail.encode("latin-1")]
        data = b"".join(parts)
        del parts
        before = status("VmHWM")
        told = read(kind, data)
        print(json.dumps([len(data), told, status("VmHWM") - before]), flush=True)
        os._exit(0)
"""


def ply(encoding: str, count: int, length: str, index: str, body: str = "") -> str:
    """The head of a file of four vertices and ``count`` faces."""
    rows = "\0" * 12 if "binary" in encoding else "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    kind = "uchar" if "binary" in encoding else "float"
    lines = ("ply", f"format {encoding} 1.0", "element vertex 4", f"property {kind} x",
             f"property {kind} y", f"property {kind} z", f"element face {count}",
             f"property list {length} {index} vertex_indices", "end_header", "")  # fmt: skip
    return "\n".join(lines) + rows + body


N, LE = SIZE, "binary_little_endian"
TWO_BYTES = "\x93NUMPY\1\0\x76\0{'descr': '|u1', 'fortran_order': False, 'shape': (%d, 2)}"
LONG = (N).to_bytes(4, "little").decode("latin-1")
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n"


def wide(columns: int) -> str:
    """What is told of a first line of very many values."""
    return f"line 1: a row of {columns:,} values expands to {columns * 2000:,} bytes"


FAT = {
    "binary empty lists": ("ply", ply(LE, N, "uchar", "int"), "\0", N, "", [4, 0]),
    "binary small faces": (
        "ply", ply(LE, N // 9 * 2, "uchar", "uchar"), "\3\0\1\2\4\0\1\2\3", N // 9, "",
        [4, N // 9 * 3],
    ),
    "binary polygon": ("ply", ply(LE, 1, "uint", "uchar", LONG), "\0", N, "", [4, N - 2]),
    "text empty lists": ("ply", ply("ascii", N // 2, "uchar", "int"), "0\n", N // 2, "", [4, 0]),
    "text mixed faces": (
        "ply", ply("ascii", N // 18 * 2, "uchar", "int"), "3 0 1 2\n4 0 1 2 3\n", N // 18, "",
        [4, N // 18 * 3],
    ),
    "text polygon": ("ply", ply("ascii", 1, "uint", "int", str(N // 2)), " 1", N // 2, "\n",
                     [4, N // 2 - 2]),
    "off polygon": ("off", f"OFF\n1 1 0\n0 0 0\n{N // 2}", " 0", N // 2, "\n", [1, N // 2 - 2]),
    "obj polygon": ("obj", SQUARE + "f", " 1", N // 2, "\n", [4, N // 2 - 2]),
    "obj corners": ("obj", SQUARE + "f", " 1/1/1", N // 6, "\n", [4, N // 6 - 2]),
    "obj comments": ("obj", "", "# crs \n", N // 7, SQUARE, [4, 0]),
    "obj continued": ("obj", SQUARE + "f 1", " 1\\\n", N // 4, " 1\n", [4, N // 4]),
    "text comments": ("xyz", "", "#ab\n", N // 4, "1 1\n", [1, 0]),
    "text of CR": ("xyz", "", "1 1\r", N // 4, "", [N // 4, 0]),
    "one long line": ("xyz", "", "1 ", N // 2, "\n", wide(N // 2)),
    "a long header": ("xyz", "", "ab,", N // 3, "\n1,1\n", wide(N // 3 + 1)),
    "a long comment": ("xyz", "#", " a", N // 2, "\n1 1\n", [1, 0]),
    "a long line later": ("xyz", "1 1\n", "1 ", N // 2, "\n",
                          f"line 2: expected 2 values, found {N // 2:,}"),
    "missing values": ("csv", "x,y,z\n", "1,,\n", N // 4, "", [N // 4, 0]),
    "missing values between tabs": ("csv", "x\ty\tz\n", "\t\t\n", N // 3, "", [N // 3, 0]),
    "a long quote": ("csv", "x,y,z\n1,2,3,\"", "a,", N // 2, "\n",
                     f"line 2: expected 3 values, found {N // 2 + 4:,}"),
    "npy bytes": ("npy", (TWO_BYTES % (N // 2)).ljust(128), "\1", N, "", [N // 2, 0]),
}  # fmt: skip


@pytest.fixture(scope="module")
def measured() -> dict[str, list[Any]]:
    """Read all files, each in a process of its own."""
    told = output(PROGRAM, json.dumps([case for *case, _ in FAT.values()]))
    return {name: json.loads(line) for name, line in zip(FAT, told.splitlines(), strict=True)}


@pytest.mark.campaign
@pytest.mark.parametrize("name", FAT)
def test_a_byte_takes_twenty_at_most(name: str, measured: dict[str, list[Any]]) -> None:
    size, told, grown = measured[name]
    expected = FAT[name][-1]
    assert 0.9 * SIZE < size < 1.4 * SIZE
    assert told == expected or (isinstance(told, str) and str(expected) in told), told
    assert grown < MOST, grown / size
