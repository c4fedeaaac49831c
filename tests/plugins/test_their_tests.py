"""The tests of the libraries themselves, with our functions in place of theirs.

What differs is listed with its reason: each of these tests has to fail, the others have to pass.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

pytestmark = pytest.mark.campaign

SHAPELY = (
    "import shapely, shapely.constructive\n"
    "from liftmesh.plugins import shapely as ours\n"
    "for name in 'delaunay_triangles', 'voronoi_polygons', 'constrained_delaunay_triangles':\n"
    "    for library in shapely, shapely.constructive:\n"
    "        setattr(library, name, getattr(ours, name))\n"
)
MATPLOTLIB = (
    "import matplotlib.tri\n"
    "from liftmesh.plugins.matplotlib import Triangulation\n"
    "matplotlib.tri.Triangulation = Triangulation\n"
)
OTHER_IN_SHAPELY = {
    # the order of cells that are not ordered
    "test_voronoi_polygons_ordered",
    # warnings of positional arguments
    "test_voronoi_polygons_deprecate_positional",
    # a tolerance works, which GEOS refuses or answers with cells of points that it left out
    "test_from_polygon_with_enough_tolerance",
    "test_from_polygon_without_enough_tolerance",
    "test_from_polygon_without_floating_point_coordinates",
    "test_from_multipoint_without_floating_point_coordinates",
    "test_from_multipoint_with_tolerace_without_floating_point_coordinates",
}
OTHER_IN_MATPLOTLIB = {
    # points on a line are a ValueError, as too few are, not a RuntimeError
    "test_delaunay_points_in_line",
    # triangles that are flat are an error: a finder can find nothing in them
    "test_trifinder",
    "test_triinterp_colinear",
    # of cocircular points the triangles are others, so the same line begins elsewhere
    "test_tricontour_path",
    "test_tricontourf_path",
    # compares with a picture that is not installed
    "test_tripcolor",
}


def failed_of(files: list[str], chosen: str, patch: str, folder: Path) -> tuple[set[str], int]:
    """Run copies of test files; return the names of those that fail, and how many pass."""
    (folder / "in_place.py").write_text(patch)
    for number, file in enumerate(files):
        shutil.copy(file, folder / f"test_{number}_{Path(file).name}")
    words = ["-p", "in_place", "-p", "no:cacheprovider", "-q", "-rf", "-k", chosen, "."]
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *words],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    passed = re.search(r"(\d+) passed", ended.stdout)
    assert passed, ended.stdout + ended.stderr
    failed = re.findall(r"^FAILED \S+?::(?:\w+::)?(\w+)", ended.stdout, flags=re.MULTILINE)
    return {*failed}, int(passed[1])


def folder_of(package: str) -> Path:
    """Return the folder of the tests that a package has with it."""
    return Path(find_spec(package).origin).parent / "tests"


def test_of_shapely(tmp_path: Path) -> None:
    names = ("legacy/test_delaunay.py", "legacy/test_voronoi_diagram.py", "test_constructive.py")
    files = [str(folder_of("shapely") / name) for name in names]
    failed, passed = failed_of(files, "delaunay or voronoi", SHAPELY, tmp_path)
    assert failed == OTHER_IN_SHAPELY
    assert passed > 100


def test_of_matplotlib(tmp_path: Path) -> None:
    file = str(folder_of("matplotlib") / "test_triangulation.py")
    images = "not tripcolor1 and not no_modify and not gradient and not smooth and not refine"
    failed, passed = failed_of([file], images, MATPLOTLIB, tmp_path)
    assert failed == OTHER_IN_MATPLOTLIB
    assert passed > 20
