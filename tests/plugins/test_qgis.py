"""The plugin for QGIS, as far as it needs no QGIS: `scripts/check_qgis.sh` runs it there."""

from __future__ import annotations

import configparser
import json
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import numpy as np
import pytest
import shapely

import liftmesh
from liftmesh.errors import Option
from liftmesh.plugins.qgis import PLUGIN, geometries

SOURCES = Path(geometries.__file__).parent / "plugin"
NEEDED = [
    *("name", "qgisMinimumVersion", "description", "about", "version", "author", "email"),
    *("repository", "hasProcessingProvider", "icon"),
]
ALONE = """
import sys
sys.path += json.loads(sys.argv[1])
class Nothing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("scipy", "trimesh", "shapely", "pyproj", "click", "rich"):
            raise ImportError(name)
sys.meta_path.insert(0, Nothing())
import liftmesh
from liftmesh.plugins.qgis import geometries
line = [[0.0, 0, 0], [4, 4, 8]]
surface = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 8]], breaklines=[line])
zone = [[[0.0, 0], [2, 0], [2, 4], [0, 4]]]
cells = liftmesh.voronoi(surface.vertices[:, :2], domain=(0, 0, 4, 4))
change = liftmesh.difference(surface, surface.trim(max_edge=9))
few = liftmesh.simplify(liftmesh.Raster(surface.raster(1).values, (1, 0, 0, 0, -1, 4)), max_error=9)
print(json.dumps([
    liftmesh.__file__, liftmesh.__version__, len(surface.faces), len([*geometries.cells(cells)]),
    geometries.volumes(surface, 0, [zone])[0], len(surface.contours([1])), len(change.faces),
    len(few.faces),
]))
"""


@pytest.fixture(scope="module")
def plugin(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The zip, made by the command and unpacked as QGIS does."""
    folder = tmp_path_factory.mktemp("qgis")
    made = folder / "made.zip"
    words = [sys.executable, "-m", "liftmesh.plugins.qgis", str(made)]
    told = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    assert told == f"{made}: for a QGIS with Python {sys.version_info[0]}.{sys.version_info[1]}\n"
    with zipfile.ZipFile(made) as opened:
        assert len({*opened.namelist()}) == len(opened.namelist())
        opened.extractall(folder)
    return folder / PLUGIN


@pytest.mark.slow
def test_what_qgis_asks_of_a_plugin(plugin: Path) -> None:
    found = configparser.ConfigParser()
    found.read(plugin / "metadata.txt", "utf-8")
    general = found["general"]
    assert [name for name in NEEDED if not general.get(name)] == []
    assert (general["version"], general["qgisMinimumVersion"]) == (liftmesh.__version__, "3.22")
    assert general.getboolean("hasProcessingProvider")
    assert ET.parse(plugin / general["icon"]).getroot().tag.endswith("svg")
    for source in plugin.glob("*.py"):
        compile(source.read_text("utf-8"), source, "exec")


@pytest.mark.slow
def test_numpy_is_all_that_it_needs(plugin: Path) -> None:
    paths = [str(plugin / "packages"), str(Path(np.__file__).parents[1])]
    words = [sys.executable, "-I", "-S", "-c", f"import json{ALONE}", json.dumps(paths)]
    done = subprocess.run(words, check=True, capture_output=True, text=True, cwd=plugin)
    place, version, *numbers = json.loads(done.stdout)
    assert Path(place).is_relative_to(plugin)
    assert version == liftmesh.__version__
    assert numbers == pytest.approx([2, 4, 40 / 3, 1, 2, 2])


@pytest.mark.slow
def test_another_python_than_that_of_the_zip(plugin: Path, tmp_path: Path) -> None:
    shutil.copytree(plugin, copy := tmp_path / PLUGIN)
    (kernel,) = copy.glob("packages/liftmesh/_kernel.*.so")
    kernel.rename(kernel.with_name("_kernel.cpython-39-other.so"))
    program = f"import sys; sys.path.append(sys.argv[1]); import {PLUGIN}\n"
    words = [sys.executable, "-I", "-S", "-c", f"{program}{PLUGIN}.classFactory(None)"]
    told = subprocess.run(
        [*words, str(tmp_path)], capture_output=True, text=True, check=False
    ).stderr.splitlines()[-1]
    assert re.fullmatch(
        r"ImportError: this plugin holds _kernel\.cpython-39-other\.so, and this QGIS has Python "
        r"3\.\S+ on \S+: make the zip with such a Python \(.*_kernel.*\)",
        told,
    ), told


def test_what_dialogues_call_an_option() -> None:
    sources = "".join(path.read_text("utf-8") for path in SOURCES.glob("*.py"))
    asked = re.findall(r'(?:number|choice)\(\s*"(\w+)"', sources)
    assert len(asked) >= 8
    assert {name.lower() for name in asked} <= geometries.LABELS.keys()
    with pytest.raises(liftmesh.InputError) as caught:
        liftmesh.triangulate(np.eye(3)).contours(interval=-1)
    assert geometries.worded(caught.value.message) == '"Interval" is -1: give a positive height'
    told = f"give {Option('crossing', 'split')} or {Option('other', ...)}"
    assert geometries.worded(liftmesh.InputError(told).message) == (
        'give "Where lines cross" split or "other"'
    )


CORNER = np.array([4e5, 5e6, 0])
SURFACE = liftmesh.triangulate(np.random.default_rng(4).random((80, 3)) * (100, 100, 9) + CORNER)


def test_triangles_there_and_back() -> None:
    shapes = shapely.from_wkb([*geometries.triangles(SURFACE)])
    assert shapely.is_ccw(shapely.get_exterior_ring(shapes)).all()
    corners = shapely.get_coordinates(shapes, include_z=True).reshape(-1, 4, 3)
    assert np.array_equal(corners[:, :3], SURFACE.vertices[SURFACE.faces])
    again = geometries.surface_of_triangles(corners[:, :3], None)
    assert again.volume(4) == SURFACE.volume(4)
    levels = SURFACE.contours(interval=1), again.contours(interval=1)
    assert [each.lengths.sum() for each in levels] == pytest.approx([levels[0].lengths.sum()] * 2)


def test_lines_and_cells() -> None:
    contours = SURFACE.contours(interval=2)
    shapes = shapely.from_wkb([*geometries.lines(contours)])
    assert np.allclose(shapely.length(shapes), contours.lengths)
    for shape, level in zip(shapes, contours.levels, strict=True):
        assert {z for _, _, z in shape.coords} == {level}
    places = np.concatenate([SURFACE.vertices[:, :2], SURFACE.vertices[:2, :2]])
    cells = liftmesh.voronoi(places)
    rows, shapes = zip(*geometries.cells(cells), strict=True)
    assert [*rows] == [*range(80)]
    assert np.allclose(shapely.area(shapely.from_wkb(shapes)), cells.areas[:80])


def test_volumes_in_zones() -> None:
    ring = np.array([[10, 10, np.nan], [60, 10, np.nan], [60, 70, np.nan], [10, 70, np.nan]])
    hole = np.array([[20, 20, 1], [20, 40, 1], [40, 40, 1.0]])
    zone = [each + CORNER for each in (ring, hole)]
    shape = shapely.Polygon(zone[0][:, :2], [zone[1][:, :2]])
    expected = SURFACE.volume(3, within=shape)
    found = geometries.volumes(SURFACE, 3, [zone])
    assert found == pytest.approx([expected.above, expected.below, expected.net, expected.area])
    assert geometries.volumes(SURFACE, 3, None)[2] == SURFACE.volume(3).net
    assert geometries.volumes(SURFACE, 3, []) == [0] * 4
    assert geometries.volumes(SURFACE, 3, [[each + CORNER for each in zone]]) == [0] * 4
    with pytest.raises(liftmesh.InputError, match="beyond the largest"):
        geometries.volumes(SURFACE.replace(vertices=SURFACE.vertices * (1, 1, 1e307)), 0, [zone])
