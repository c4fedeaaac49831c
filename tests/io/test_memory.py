"""What is read is handed on, and what is written is not made a second time."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh.terrain.frame import resolve_plane

ROWS = 200_000
BLOCKS = 1_000_000  # bytes that what is worked on at a time may take
RANDOM = np.random.default_rng(11)
POINTS = RANDOM.random((ROWS, 3))
COLORS = RANDOM.integers(0, 256, (ROWS, 3)).astype(np.uint8)


def most_held(call: Callable[[], object]) -> int:
    """The peak of what Python and NumPy allocate; the kernel's own memory is not in it."""
    call()
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.fixture(scope="module")
def surface() -> liftmesh.Surface:
    return liftmesh.triangulate(liftmesh.Cloud(POINTS, colors=COLORS))


def test_a_mesh_is_written_block_by_block(surface: liftmesh.Surface, tmp_path: Path) -> None:
    assert most_held(lambda: surface.save(tmp_path / "mesh.ply")) < BLOCKS


def test_a_cloud_is_read_into_the_arrays_that_are_handed_on(tmp_path: Path) -> None:
    cloud = liftmesh.Cloud(POINTS, colors=COLORS, attributes={"time": POINTS[:, 0]})
    liftmesh.write(tmp_path / "cloud.ply", cloud)
    held = POINTS.nbytes + COLORS.nbytes + 8 * ROWS
    assert most_held(lambda: liftmesh.read(tmp_path / "cloud.ply")) < held + BLOCKS


def test_faces_are_read_once_and_copied_once(surface: liftmesh.Surface, tmp_path: Path) -> None:
    surface.save(tmp_path / "mesh.ply")
    in_the_file = 13 * len(surface.faces)
    held = POINTS.nbytes + COLORS.nbytes + surface.faces.nbytes + in_the_file
    masks = 2 * len(surface.faces)
    assert most_held(lambda: liftmesh.read(tmp_path / "mesh.ply")) < held + masks + BLOCKS


def test_triangulating_takes_a_byte_a_row_beside_the_kernel() -> None:
    cloud = liftmesh.Cloud(POINTS, colors=COLORS)
    judged = 700_000  # for the rows that say whether the cloud is a height field
    assert most_held(lambda: liftmesh.triangulate(cloud)) < ROWS + 50_000 + judged


@pytest.mark.parametrize("plane", ["xy", (1, 2, 3)])
def test_planes_take_no_more_than_their_coordinates(plane: Any) -> None:
    frame = resolve_plane(plane, POINTS)
    result = 0 if plane == "xy" else 16 * ROWS
    assert most_held(lambda: frame.planar(POINTS)) < result + BLOCKS
    assert most_held(lambda: frame.heights(POINTS)) < result / 2 + BLOCKS


PEAK = """
import numpy as np
import liftmesh

def status(field):
    with open("/proc/self/status") as lines:
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith(field))

points = np.random.default_rng(0).random((1_000_000, 2))
weights = np.random.default_rng(1).random(1_000_000) * 2e-6
liftmesh.regular(points[:1000], weights=weights[:1000])
before = status("VmRSS")
triangulation = {call}
print((status("VmHWM") - before) / len(points))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("call", "most"),  # bytes a point; the result is 48
    [
        ("liftmesh.delaunay(points, threads=2)", 80),
        ("liftmesh.delaunay(points, threads=2, metric=[[2, 1], [1, 2]])", 80),
        ("liftmesh.regular(points, weights=weights, threads=2)", 95),
    ],
)
def test_the_kernel_takes_little_more_than_its_result(call: str, most: float) -> None:
    code = PEAK.format(call=call)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert float(done.stdout) < most


INDEX = """
import ctypes
import numpy as np
import liftmesh

def resident():
    ctypes.CDLL(None).malloc_trim(0)  # what was freed is no part of it
    with open("/proc/self/status") as lines:
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmRSS"))

angle = 2 * np.pi * np.arange(2_000_000) / 1_999_999
points = np.column_stack([np.cos(angle), np.sin(angle)])
points[-1] = {last}
liftmesh.delaunay(points[:1000]).find_simplex(points[:10])
triangulation = liftmesh.delaunay(points)
asked = np.random.default_rng(0).uniform(-0.5, 0.5, (1000, 2))  # far from the vertices
before = resident()
triangulation.find_simplex(asked)
print((resident() - before) / len(points))
"""


@pytest.mark.slow
@pytest.mark.parametrize("last", ["0", "1"])
def test_the_index_of_point_location_takes_at_most_8_bytes_a_row(last: str) -> None:
    program = INDEX.format(last=last)
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert 1 < float(done.stdout) < 8


FIRST_CALLS = """
import threading
import numpy as np
import liftmesh

def peak():
    with open("/proc/self/status") as lines:
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))

angle = 2 * np.pi * np.arange(2_000_000) / 1_999_999
points = np.column_stack([np.cos(angle), np.sin(angle)])
points[-1] = 0
triangulation = liftmesh.delaunay(points)
triangulation.find_simplex(points[:10])
asked = np.random.default_rng(0).uniform(-0.5, 0.5, (100, 2))  # far from the vertices
calls = [threading.Thread(target=triangulation.find_simplex, args=(asked,)) for _ in range(16)]
with open("/proc/self/clear_refs", "w") as file:
    file.write("5")  # the peak counts from here
before = peak()
for call in calls:
    call.start()
for call in calls:
    call.join()
print((peak() - before) / len(points))
"""


@pytest.mark.slow
def test_first_calls_at_once_make_one_index() -> None:
    done = subprocess.run(
        [sys.executable, "-c", FIRST_CALLS], capture_output=True, text=True, check=True
    )
    assert float(done.stdout) < 8  # one each: 50
