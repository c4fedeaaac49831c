"""Which objects become clouds, and how another package adds its own."""

from __future__ import annotations

import copy
import inspect
import os
import pickle
import subprocess
import sys
from array import array

import numpy as np
import pytest

from liftmesh.base.cloud import Cloud
from liftmesh.errors import InputError, UnsupportedTypeError
from liftmesh.io.registry import Adapter, as_cloud, known_formats

ROWS = [[0.0, 0.0, 5.0], [1.0, 0.0, 6.0], [0.0, 1.0, 7.0]]

RING = """
import numpy as np
from liftmesh import Adapter, Cloud

class Ring:
    def __init__(self, count):
        self.count = count
    def __len__(self):
        return self.count

def to_cloud(ring):
    angles = np.linspace(0, 2 * np.pi, len(ring), endpoint=False)
    return Cloud(np.column_stack([np.cos(angles), np.sin(angles), angles]))

ADAPTER = Adapter("ring", lambda source: isinstance(source, Ring), to_cloud)
NO_ADAPTER = 7
"""


def add_package(folder, name, source, target):
    """Put an installed package with one entry point into a folder."""
    (folder / f"{name}.py").write_text(source)
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[liftmesh.adapters]\n{name} = {name}:{target}\n")


def run(folder, script):
    finished = subprocess.run(
        [sys.executable, "-W", "error", "-c", script],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


@pytest.mark.parametrize(
    "source", [ROWS, tuple(map(tuple, ROWS)), np.array(ROWS), Cloud(np.array(ROWS))]
)
def test_array_likes_and_clouds(source):
    assert as_cloud(source).points.tolist() == ROWS


def test_a_cloud_stays_itself_and_an_array_is_shared():
    cloud = Cloud(np.array(ROWS))
    assert as_cloud(cloud) is cloud
    assert np.shares_memory(as_cloud(cloud.points).points, cloud.points)


def test_planar_rows_get_zero_heights():
    assert as_cloud([[1, 2], [3, 4]]).points.tolist() == [[1, 2, 0], [3, 4, 0]]


def test_objects_that_can_be_arrays():
    class Table:
        def __array__(self, dtype=None, copy=None):
            return np.array(ROWS, dtype=dtype)

    assert as_cloud(Table()).points.tolist() == ROWS
    buffer = memoryview(array("d", np.ravel(ROWS))).cast("B").cast("d", (3, 3))
    assert as_cloud(buffer).points.tolist() == ROWS


@pytest.mark.parametrize("source", [None, 3, object(), ROWS.append, Ellipsis])
def test_other_objects_name_their_type_and_what_would_do(source):
    name = type(source).__qualname__
    with pytest.raises(
        UnsupportedTypeError, match=rf"a builtins\.{name} is not a point cloud: give"
    ):
        as_cloud(source)


@pytest.mark.parametrize("source", [{1, 2}, b"abc", [["a", "b"]]])
def test_containers_of_no_rows_are_refused(source):
    with pytest.raises(InputError):
        as_cloud(source)


def test_a_class_that_only_bears_the_name_is_no_trimesh():
    class PointCloud:
        vertices = ROWS

    with pytest.raises(UnsupportedTypeError):
        as_cloud(PointCloud())


def test_nothing_is_imported_for_arrays(tmp_path):
    script = (
        "import sys, numpy as np\n"
        "from liftmesh import Adapter, as_cloud\n"
        "as_cloud(np.zeros((3, 3)))\n"
        "class Other:\n"
        "    def __array__(self, dtype=None, copy=None): return np.zeros((3, 3))\n"
        "as_cloud(Other())\n"
        "print(*({'trimesh', 'open3d', 'matplotlib', 'scipy'} & set(sys.modules)))\n"
    )
    assert run(tmp_path, script).strip() == ""


def test_another_package_adds_its_clouds(tmp_path):
    add_package(tmp_path, "ring_clouds", RING, "ADAPTER")
    script = (
        "from ring_clouds import Ring\n"
        "from liftmesh import as_cloud\n"
        "cloud = as_cloud(Ring(4))\n"
        "print(len(cloud), cloud.points[0].tolist())\n"
    )
    assert run(tmp_path, script) == "4 [1.0, 0.0, 0.0]\n"


def test_a_derived_class_of_its_own_is_found_too(tmp_path):
    add_package(tmp_path, "ring_clouds", RING, "ADAPTER")
    script = (
        "import ring_clouds\n"
        "from liftmesh import as_cloud\n"
        "class Tyre(ring_clouds.Ring): pass\n"
        "print(len(as_cloud(Tyre(7))))\n"
    )
    assert run(tmp_path, script) == "7\n"


def test_a_broken_package_harms_nobody_and_is_named_at_need(tmp_path):
    add_package(tmp_path, "ring_clouds", RING, "ADAPTER")
    add_package(tmp_path, "a_broken", "raise RuntimeError('no licence')", "ADAPTER")
    add_package(tmp_path, "b_wrong", RING, "NO_ADAPTER")
    script = (
        "import numpy as np\n"
        "from ring_clouds import Ring\n"
        "from liftmesh import UnsupportedTypeError, as_cloud\n"
        "print(len(as_cloud(np.zeros((3, 3)))), len(as_cloud(Ring(5))))\n"
        "try:\n"
        "    as_cloud(object())\n"
        "except UnsupportedTypeError as error:\n"
        "    print(error)\n"
    )
    counts, message = run(tmp_path, script).splitlines()
    assert counts == "3 5"
    assert "a_broken (a_broken:ADAPTER) cannot be loaded (RuntimeError: no licence)" in message
    assert "b_wrong (b_wrong:NO_ADAPTER) is a builtins.int, not a liftmesh.Adapter" in message


def test_an_adapter_is_a_frozen_record():
    adapter = Adapter("none", lambda source: False, as_cloud)
    with pytest.raises(AttributeError):
        adapter.name = "other"  # type: ignore[misc]


def test_functions_that_are_imported_when_called_look_like_functions() -> None:
    found = known_formats()["ply"]
    assert found.write.__name__ == "write_ply"
    assert "encoding" in inspect.signature(found.write).parameters
    assert pickle.loads(pickle.dumps(found)) == found
    assert len({found.write, copy.deepcopy(found.write)}) == 1
