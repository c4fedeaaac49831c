"""Files that promise more than they hold: an error with its place, soon, and in little memory."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from children import output
from commands import ROOT
from file_samples import loaded
from files.gltf import glb
from gltf_models import TRIANGLE
from lies import all_lies, gltf_tree, overlapping

from liftmesh import FormatError

MOST_MEMORY = 200_000_000
PLACES = ":".join(str(ROOT / each) for each in ("tests/support", "scripts"))

READ_ALL = """
    import io, json, sys, time, warnings
    sys.path[:0] = sys.argv[1].split(":")
    from lies import all_lies
    import laspy, lazrs, liftmesh, trimesh, scipy.spatial
    warnings.simplefilter("ignore")
    lies = all_lies()
    for kind in ("npy", "npz", "ply", "obj", "stl", "gltf"):  # what they import is no part of it
        try:
            liftmesh.read(io.BytesIO(b"0" * 200), format=kind)
        except liftmesh.FormatError:
            pass
    limit(int(sys.argv[2]))
    before = status("VmHWM")
    for kind, data, _ in lies:
        begin = time.process_time()
        try:
            told = len(liftmesh.read(io.BytesIO(data), format=kind))
        except Exception as error:
            told = f"{type(error).__name__}: {error}"
        print(json.dumps([told, time.process_time() - begin]))
    print(status("VmHWM") - before)
"""


@pytest.mark.slow
def test_lies_of_headers_are_told_with_their_place_in_little_memory() -> None:
    lies = all_lies()
    *lines, grown = output(READ_ALL, PLACES, MOST_MEMORY).splitlines()
    assert len(lines) == len(lies) > 150
    wrong = []
    for (kind, data, cause), line in zip(lies, lines, strict=True):
        told, seconds = json.loads(line)
        form = rf"FormatError: <stream>: .*({cause})"
        if not isinstance(told, str) or not re.match(form, told) or seconds > 5:
            wrong.append((kind, data[-120:], told, seconds))
        assert len(str(told)) < 1000
    assert wrong == []
    assert int(grown) < MOST_MEMORY / 2


@pytest.mark.parametrize("kind", ["gltf", "glb"])
def test_the_tree_that_the_lies_change_is_true(kind: str) -> None:
    data = glb(gltf_tree()) if kind == "glb" else json.dumps(gltf_tree()).encode()
    assert (
        loaded(data, kind).points.tolist() == (TRIANGLE[:, [0, 2, 1]] * (1, -1, 1) + 0.0).tolist()
    )


def test_two_arrays_of_one_name_are_not_one() -> None:
    data = overlapping(b"").replace(b"0001.npy", b"0000.npy")
    with pytest.raises(FormatError, match="two arrays have this name"):
        loaded(data, "npz")


# What would take minutes if each name were compared with all before it, or each line were copied
# onto all before it.
MANY = 30_000
LONG = {
    "properties": (
        "ply",
        b"ply\nformat ascii 1.0\nelement vertex 1\n"
        + b"".join(b"property float a%d\n" % k for k in range(MANY))
        + b"end_header\n",
        "header of 30,001 elements and properties expands to 60,002,000 bytes",
    ),
    "elements": (
        "ply",
        b"ply\nformat ascii 1.0\n"
        + b"".join(b"element a%d 0\n" % k for k in range(MANY))
        + b"end_header\n",
        "header of 30,000 elements and properties expands to 60,000,000 bytes",
    ),
    "columns": (
        "csv",
        b"x,y," + b",".join(b"a%d" % k for k in range(MANY)) + b"\n1,2\n",
        "line 1: a row of 30,002 values expands to 60,004,000 bytes",
    ),
    "continued lines": ("obj", b"v 0 0\n" + b"a\\\n" * 10 * MANY, "line 1"),
    "continued lines beyond a block": (
        "obj",
        b"v 0 0\n" + b"#" * (4 << 20) + b"\\\n" + b"a\\\n" * MANY,
        "line 1",
    ),
    "elements with lists": (
        "ply",
        b"ply\nformat binary_little_endian 1.0\n"
        + b"".join(b"element a%d 1\nproperty list uchar uchar a\n" % k for k in range(4990))
        + b"element z 40000000\nproperty uchar q\nend_header\n"
        + bytes(4990 + 40_000_000),
        "no vertex element",
    ),
    "comments": ("obj", b"#ab\n" * 20 * MANY, "no 'v' line"),
    "one long line": ("xyz", b"1 " * MANY + b"\n1\n", "line 1: a row of 30,000 values"),
}


@pytest.mark.slow
def test_no_file_takes_time_beyond_its_size() -> None:
    program = """
        import io, json, sys, time
        sys.path[:0] = sys.argv[1].split(":")
        from test_header_lies import LONG
        import liftmesh
        for name, (kind, data, _) in LONG.items():
            begin = time.thread_time()
            try:
                liftmesh.read(io.BytesIO(data), format=kind)
            except liftmesh.FormatError as error:
                print(json.dumps([name, time.thread_time() - begin, str(error)]))
    """
    lines = output(program, f"{PLACES}:{Path(__file__).parent}").splitlines()
    told = {name: (seconds, message) for name, seconds, message in map(json.loads, lines)}
    assert [*told] == [*LONG]
    for name, (seconds, message) in told.items():
        assert seconds < 5, name
        assert re.search(LONG[name][2], message), name
        assert len(message) < 1000, name
