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
SCIPY = (
    "import types, scipy.spatial, scipy.interpolate._interpnd as interpolators\n"
    "from liftmesh.scipy import Delaunay, Voronoi\n"
    "ours = types.ModuleType('ours')\n"
    "vars(ours).update(vars(scipy.spatial._qhull), Delaunay=Delaunay, Voronoi=Voronoi)\n"
    "scipy.spatial._qhull = interpolators.qhull = ours\n"
    "scipy.spatial.Voronoi = Voronoi\n"
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
OTHER_IN_SCIPY = {
    # the order of triangles, hull edges and vertices, where a corner of a triangle comes first
    "test_2d_square",
    "test_find_simplex",
    "test_convex_hull",
    "test_furthest_site",
    "test_simple",
    # QJ, which moves the points at random, is refused
    "test_joggle",
    *(f"test_incremental[some-points-chunk-{size}]" for size in (1, 4, 16)),
    # what is 2e-16 beside a line is not on it: a vertex 4e15 away, and two vertices 1e-16 apart
    "test_ridges[pathological-2]",
    *(f"test_incremental[pathological-2-chunk-{size}]" for size in (1, 4, 16)),
    # slivers stay: 31 triangles are too thin for a transform, where the test takes 22
    "test_degenerate_barycentric_transforms",
    # Voronoi diagrams are of the plane and of space
    *(f"test_ridges[random-{columns}d]" for columns in (4, 5, 6, 7, 8)),
    # other words about a wrong shape; it is a ValueError, not an IndexError
    "test_gh_20623[Voronoi]",
    "test_gh_20623[Delaunay]",
    "test_gh_21286",
}


def failed_of(files: list[str], chosen: str, patch: str, folder: Path) -> tuple[set[str], int]:
    """Run copies of test files; return the names of those that fail, and how many pass."""
    (folder / "in_place.py").write_text(patch)
    for number, file in enumerate(files):
        shutil.copy(file, folder / f"test_{number}_{Path(file).name}")
        if (data := Path(file).parent / "data").is_dir():
            shutil.copytree(data, folder / "data", dirs_exist_ok=True)
    words = ["-p", "in_place", "-p", "no:cacheprovider", "-q", "-rf", "-k", chosen, "."]
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *words],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    passed = re.search(r"(\d+) passed", ended.stdout)
    assert passed, ended.stdout + ended.stderr
    failed = re.findall(
        r"^FAILED \S+?::(?:\w+::)?(\w+(?:\[\S+\])?)", ended.stdout, flags=re.MULTILINE
    )
    return {*failed}, int(passed[1])


def folder_of(package: str) -> Path:
    """Return the folder of the tests that a package has with it."""
    return Path(find_spec(package).origin).parent / "tests"


def test_of_shapely(tmp_path: Path) -> None:
    names = ("legacy/test_delaunay.py", "legacy/test_voronoi_diagram.py", "test_constructive.py")
    files = [str(folder_of("shapely") / name) for name in names]
    failed, passed = failed_of(files, "delaunay or voronoi", SHAPELY, tmp_path)
    assert {name.partition("[")[0] for name in failed} == OTHER_IN_SHAPELY
    assert passed > 100


def test_of_matplotlib(tmp_path: Path) -> None:
    file = str(folder_of("matplotlib") / "test_triangulation.py")
    images = "not tripcolor1 and not no_modify and not gradient and not smooth and not refine"
    failed, passed = failed_of([file], images, MATPLOTLIB, tmp_path)
    assert {name.partition("[")[0] for name in failed} == OTHER_IN_MATPLOTLIB
    assert passed > 20


def test_of_scipy(tmp_path: Path) -> None:
    names = {"spatial": ["qhull"], "interpolate": ["interpnd", "ndgriddata"]}
    files = [
        str(folder_of(f"scipy.{room}") / f"test_{name}.py")
        for room, each in names.items()
        for name in each
    ]
    failed, passed = failed_of(files, "test", SCIPY, tmp_path)
    assert failed == OTHER_IN_SCIPY
    assert passed > 200
