"""delaunay(scratch=): large arrays in files, and the same triangles."""

from __future__ import annotations

import gc
import hashlib
from pathlib import Path

import numpy as np
import pytest
from children import output

import liftmesh
from liftmesh.errors import InputError

PROGRAM = """
import sys, hashlib
import numpy as np
import liftmesh
liftmesh.delaunay(np.random.default_rng(1).random((1000, 2)), threads=1)
points = np.load(sys.argv[1], mmap_mode="r")
# Private memory only: maps of files can be written back to the disk.
resource.setrlimit(resource.RLIMIT_DATA, (status("VmData") + 20_000_000, resource.RLIM_INFINITY))
for scratch in (None, sys.argv[2]):
    try:
        found = liftmesh.delaunay(points, scratch=scratch, threads=1)
    except MemoryError:
        print("no memory")
        continue
    told = hashlib.sha256(found.simplices.data)
    told.update(found.neighbors.data)
    print(told.hexdigest())
"""


@pytest.mark.parametrize("kind", ["uniform", "circle"])
def test_the_same_triangles_in_a_quarter_of_the_memory(kind: str, tmp_path: Path) -> None:
    points = np.random.default_rng(2).random((600_000, 2))
    if kind == "circle":
        points = np.column_stack((np.cos(6 * points[:, 0]), np.sin(6 * points[:, 0])))
    np.save(tmp_path / "points.npy", points)
    told = output(PROGRAM, tmp_path / "points.npy", tmp_path).split("\n")
    assert told[:2] == ["no memory", digest(liftmesh.delaunay(points, threads=1))]
    assert [path.name for path in tmp_path.iterdir()] == ["points.npy"]


def digest(found: liftmesh.Triangulation) -> str:
    told = hashlib.sha256(found.simplices.data)
    told.update(found.neighbors.data)
    return told.hexdigest()


def deleted_maps() -> int:
    return Path("/proc/self/maps").read_text().count("(deleted)")


@pytest.mark.slow
def test_files_are_gone_with_the_result(tmp_path: Path) -> None:
    gc.collect()
    before = deleted_maps()
    points = np.random.default_rng(2).random((300_000, 2))
    found = liftmesh.delaunay(points, scratch=tmp_path)
    assert deleted_maps() > before
    kept = found.simplices
    del found
    gc.collect()
    assert deleted_maps() == before + 1
    assert kept.max() == 299_999
    del kept
    gc.collect()
    assert deleted_maps() == before
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scratch": 3}, "scratch is a int: give the path of a folder"),
        ({"scratch": "missing"}, "scratch 'missing' is no folder: make it first"),
        ({"scratch": "\0"}, "is no folder"),
        ({"scratch": ".", "order": "canonical"}, "scratch and order='canonical' exclude each"),
        ({"scratch": ".", "algorithm": "lf"}, "scratch and algorithm='lf' exclude each other"),
        ({"scratch": ".", "metric": [[1, 0], [0, 2]]}, "scratch and metric exclude each other"),
    ],
)
def test_options_that_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], **options)  # type: ignore[call-overload]


def test_a_full_disk_is_an_error_of_the_system(tmp_path: Path) -> None:
    """A limit on the size of files stands for it."""
    program = """
    import signal, sys
    import numpy as np
    import liftmesh
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4_500_000, resource.RLIM_INFINITY))
    try:
        liftmesh.delaunay(np.random.default_rng(2).random((300_000, 2)), scratch=sys.argv[1])
    except OSError as error:
        print(type(error).__name__, error.filename)
    """
    assert output(program, tmp_path).strip() == f"OSError {tmp_path}"
