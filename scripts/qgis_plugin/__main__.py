"""Run the plugin in QGIS and compare what comes out: ``scripts/check_qgis.sh``.

Layers are drawn, sent through each algorithm by ``qgis_process``, read by GeoPandas, and compared
with what shapely, SciPy and Rasterio make of the same layers. Wrong layers have to give a sentence.
Then the window of QGIS runs some algorithms, one of which is cancelled, and shows the rest.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import geopandas
import numpy as np
import rasterio
import shapely
from rasterio.transform import from_origin
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

from liftmesh.plugins.qgis import PLUGIN, write_zip

HERE = Path(__file__).resolve().parent
PICTURE = HERE.parent.parent / "out" / "qgis.png"
PROFILE = Path(".local/share/QGIS/QGIS3/profiles/default/python/plugins")
PROCESS = shutil.which("qgis_process.bin") or "qgis_process"  # Debian's qgis_process is a wrapper
NAMES = {"constrainedtin", "contours", "tin", "tinfromdem", "volume", "voronoi"}
SYSTEM = "EPSG:25832"
EAST, NORTH = 451_000.3, 5_410_000.7
BREAKLINE = [(EAST + 100.5, NORTH + 100.5, 350.0), (EAST + 800.25, NORTH + 500.5, 250.0)]
FLAT_LINE = shapely.LineString([(EAST + 200, NORTH + 700), (EAST + 900, NORTH + 150)])
BOUNDARY = shapely.Polygon(
    [(EAST + x, NORTH + y) for x, y in ((50, 50), (950, 50), (950, 750), (50, 750))],
    [[(EAST + x, NORTH + y) for x, y in ((400, 300), (500, 300), (500, 400))]],
)
LOT = shapely.box(EAST + 100, NORTH + 100, EAST + 200, NORTH + 300)
FAR = shapely.box(EAST + 5000, NORTH, EAST + 5100, NORTH + 100)


class Qgis:
    """QGIS with the plugin, in a home of its own, and layers in a folder."""

    def __init__(self, home: Path) -> None:
        self.home, self.folder = home, home / "layers"
        self.folder.mkdir()
        (home / PROFILE).mkdir(parents=True)
        with zipfile.ZipFile(write_zip(home / f"{PLUGIN}.zip")) as made:
            made.extractall(home / PROFILE)  # as the window does
        kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        runtime = home / "runtime"
        runtime.mkdir(mode=0o700)
        self.environment = {**kept, "HOME": str(home), "XDG_RUNTIME_DIR": str(runtime)}
        told = self.process("plugins", "enable", PLUGIN)
        require(f"Enabled {PLUGIN}" in told, told)

    def process(self, *words: str) -> str:
        """Run qgis_process, and return all that it says."""
        ended = subprocess.run(
            [PROCESS, *words], cwd=self.folder, check=False, text=True,
            env={**self.environment, "QT_QPA_PLATFORM": "offscreen"},
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        return ended.stdout

    def run(self, name: str, **given: Any) -> Any:
        """Run an algorithm, and return its layer."""
        target = self.folder / f"{name}.gpkg"
        target.unlink(missing_ok=True)
        told = self.process("run", f"liftmesh:{name}", *words_of(given), f"--OUTPUT={target}")
        require(target.exists(), told)
        return geopandas.read_file(target)

    def error(self, name: str, **given: Any) -> str:
        """Run an algorithm that has to fail, and return what it says."""
        target = self.folder / "none.gpkg"
        told = self.process("run", f"liftmesh:{name}", *words_of(given), f"--OUTPUT={target}")
        require("ERROR" in told and "Traceback" not in told, told)
        return told

    def write(self, layer: str, shapes: Any, **columns: Any) -> Any:
        """Write a layer, and return it."""
        table = geopandas.GeoDataFrame(columns, geometry=shapes, crs=SYSTEM)
        table.to_file(self.folder / f"{layer}.gpkg")
        return table


def words_of(given: dict[str, Any]) -> list[str]:
    """Return the words of parameters."""
    return [f"--{name}={value}" for name, value in given.items()]


def require(holds: bool, what: str) -> None:
    """Raise if something does not hold."""
    if not holds:
        raise SystemExit(f"failed: {what}")


def draw(qgis: Qgis, count: int = 3000) -> np.ndarray:
    """Write the layers; return the points."""
    rng = np.random.default_rng(1)
    places = rng.random((count, 2)) * (1000, 800)
    x, y = places.T
    heights = 50 * np.sin(x / 150) * np.cos(y / 170) + 300
    points = np.column_stack([x + EAST, y + NORTH, heights])
    names = [f"p{row}" for row in range(count)]
    qgis.write("points", shapely.points(points), name=names)
    qgis.write("flat", shapely.points(points[:, :2]), height=heights + 1)
    line = geopandas.GeoSeries([shapely.LineString(BREAKLINE)], crs=SYSTEM)
    geopandas.GeoDataFrame(geometry=line.to_crs(4326)).to_file(qgis.folder / "lines.gpkg")
    qgis.write("flatlines", [FLAT_LINE])
    qgis.write("boundary", [BOUNDARY])
    qgis.write("zones", [BOUNDARY, LOT, FAR], lot=["all", "one", "far"])
    y, x = np.mgrid[:60, :80]
    values = (20 * np.sin(x / 11) * np.cos(y / 9) + 100).astype(np.float32)
    values[10:14, 20:30] = -9999
    with rasterio.open(
        qgis.folder / "dem.tif", "w", driver="GTiff", width=80, height=60, count=1, dtype="float32",
        crs=SYSTEM, transform=from_origin(EAST, NORTH, 10, 10), nodata=-9999,
    ) as file:  # fmt: skip
        file.write(values, 1)
    return points


def corners_of(table: Any) -> np.ndarray:
    """Return the corners of a layer of triangles, (m, 3, 3)."""
    corners = shapely.get_coordinates(table.geometry.to_numpy(), include_z=True)
    return corners.reshape(-1, 4, 3)[:, :3]


def heights_at(corners: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Interpolate in triangles, found by shapely; NaN where there are none."""
    tree = shapely.STRtree([shapely.Polygon(each[:, :2]).buffer(1e-7) for each in corners])
    point, triangle = tree.query(shapely.points(places), predicate="intersects")
    a, b, c = corners[triangle].transpose(1, 0, 2)
    edges = np.stack([b - a, c - a], axis=2)[:, :2]
    shares = np.linalg.solve(edges, (places[point] - a[:, :2])[..., None])[..., 0]
    found = np.full(len(places), np.nan)
    found[point] = a[:, 2] + ((np.stack([b, c], axis=1) - a[:, None])[:, :, 2] * shares).sum(axis=1)
    return found


def volume_in(corners: np.ndarray, level: float, shape: Any) -> tuple[float, float]:
    """Return the net volume in a polygon, and the area; by the centroids of what shapely cuts."""
    triangles = shapely.polygons(corners[:, [0, 1, 2, 0], :2])
    parts = shapely.intersection(triangles, shape)
    there = shapely.area(parts) > 0
    areas, at = shapely.area(parts[there]), shapely.get_coordinates(shapely.centroid(parts[there]))
    a, b, c = corners[there].transpose(1, 0, 2)
    edges = np.stack([b - a, c - a], axis=2)[:, :2]
    shares = np.linalg.solve(edges, (at - a[:, :2])[..., None])[..., 0]
    heights = a[:, 2] + (b - a)[:, 2] * shares[:, 0] + (c - a)[:, 2] * shares[:, 1]
    return float((areas * (heights - level)).sum()), float(areas.sum())


def check_tin(qgis: Qgis, points: np.ndarray) -> str:
    """SciPy has the same triangles."""
    found = qgis.run("tin", INPUT="points.gpkg")
    require(found.crs == SYSTEM, f"the system is {found.crs}")
    row = {tuple(point): number for number, point in enumerate(points.tolist())}
    ours = {frozenset(row[tuple(each)] for each in three) for three in corners_of(found).tolist()}
    moved = Delaunay(points[:, :2] - (EAST, NORTH))
    theirs = {frozenset(three) for three in moved.simplices.tolist()}
    require(ours == theirs, f"triangles differ: {len(ours)} and {len(theirs)}")
    flat = qgis.run("tin", INPUT="flat.gpkg", HEIGHT="height", MAX_EDGE=60)
    corners = corners_of(flat)
    raised = {(x, y): z + 1 for x, y, z in points.tolist()}
    require(
        all(raised[x, y] == z for three in corners.tolist() for x, y, z in three),
        "heights of the field",
    )
    return f"{len(ours):,} triangles as SciPy's; {len(flat):,} with a longest side of 60"


def check_constrained(qgis: Qgis) -> str:
    """No triangle crosses the breakline, and all are in the boundary."""
    found = qgis.run(
        "constrainedtin", INPUT="points.gpkg", BREAKLINES="lines.gpkg", BOUNDARY="boundary.gpkg"
    )
    require(found.crs == SYSTEM, f"the system is {found.crs}")
    corners = corners_of(found)
    area = found.area.sum()
    require(abs(area / BOUNDARY.area - 1) < 1e-9, f"area {area}, not {BOUNDARY.area}")
    line = shapely.LineString(BREAKLINE)
    flat = qgis.run("constrainedtin", INPUT="points.gpkg", BREAKLINES="flatlines.gpkg")
    for table, kept in ((found, line), (flat, FLAT_LINE)):
        inside = shapely.length(shapely.intersection(shapely.buffer(table.geometry, -1e-3), kept))
        require(inside.max() < 1e-2, f"a triangle is crossed for {inside.max()}")
    places = shapely.get_coordinates(shapely.segmentize(line, 7.0))
    there = shapely.contains_xy(BOUNDARY, places)  # not in its hole
    expected = np.linspace(350, 250, len(places))[there]
    off = np.abs(heights_at(corners, places[there]) - expected).max()
    require(off < 1e-3, f"heights along the breakline are off by {off}")  # it came in degrees
    return f"{len(found):,} triangles within the boundary, none across the breakline"


def check_raster(qgis: Qgis) -> str:
    """No pixel is farther away than allowed."""
    found = qgis.run("tinfromdem", INPUT="dem.tif", MAX_ERROR=1)
    require(found.crs == SYSTEM, f"the system is {found.crs}")
    with rasterio.open(qgis.folder / "dem.tif") as file:
        values = file.read(1, masked=True)
        row, column = np.nonzero(~values.mask)
        places = np.column_stack(file.xy(row, column))
    heights = heights_at(corners_of(found), places)
    off = np.abs(heights - values.data[row, column]).max()
    require(off <= 1 + 1e-6, f"a pixel is off by {off}")
    require(len(found) < len(places) / 5, f"{len(found)} triangles are many")
    return f"{len(found):,} triangles of {len(places):,} pixels, off by at most {off:.3f}"


def check_contours(qgis: Qgis, points: np.ndarray) -> str:
    """Along each line the surface has its height."""
    found = qgis.run("contours", INPUT="points.gpkg", INTERVAL=5)
    require(found.crs == SYSTEM, f"the system is {found.crs}")
    shift = np.array([EAST, NORTH])
    at = LinearNDInterpolator(Delaunay(points[:, :2] - shift), points[:, 2])
    corners, line = shapely.get_coordinates(
        found.geometry.to_numpy(), include_z=True, return_index=True
    )
    level = found["elevation"].to_numpy()[line]
    off = np.nanmax(np.abs(at(corners[:, :2] - shift) - level))
    require(off < 1e-6 and (corners[:, 2] == level).all(), f"lines are off by {off}")
    levels = np.unique(level)
    expected = np.arange(np.ceil(points[:, 2].min() / 5), points[:, 2].max() // 5 + 1) * 5
    require(np.array_equal(levels, expected), f"levels {levels}, not {expected}")
    qgis.run("tin", INPUT="points.gpkg")
    again = qgis.run("contours", INPUT="tin.gpkg", INTERVAL=5)
    lengths = found.length.sum(), again.length.sum()
    require(abs(lengths[0] / lengths[1] - 1) < 1e-12, f"of triangles lines have {lengths}")
    return f"{len(found)} lines at {len(levels)} levels, the same of points and of triangles"


def check_volume(qgis: Qgis) -> str:
    """Volumes in zones, and between surfaces, are those of what shapely cuts."""
    corners = corners_of(qgis.run("tin", INPUT="points.gpkg"))
    found = qgis.run("volume", INPUT="tin.gpkg", LEVEL=290, ZONES="zones.gpkg")
    require(found["lot"].tolist() == ["all", "one", "far"], "zones keep their fields")
    for zone, shape in zip(found.itertuples(), (BOUNDARY, LOT, FAR), strict=True):
        net, area = volume_in(corners, 290, shape)
        require(abs(zone.net - net) <= 1e-6 * abs(net), f"{zone.lot}: net {zone.net}, not {net}")
        require(abs(zone.area - area) <= 1e-6 * area, f"{zone.lot}: area {zone.area}, not {area}")
        require(abs(zone.above - zone.below - zone.net) <= 1e-6 * abs(net), "net is a difference")
    other = corners_of(qgis.run("constrainedtin", INPUT="points.gpkg", BREAKLINES="lines.gpkg"))
    between = qgis.run("volume", INPUT="tin.gpkg", OTHER="constrainedtin.gpkg", ZONES="zones.gpkg")
    for zone, shape in zip(between.itertuples(), (BOUNDARY, LOT), strict=False):
        net = volume_in(corners, 0, shape)[0] - volume_in(other, 0, shape)[0]
        require(abs(zone.net - net) < 1e-6 * zone.area, f"{zone.lot}: net {zone.net}, not {net}")
    return f"net volumes {found['net'].round(1).tolist()}, and between two surfaces"


def check_voronoi(qgis: Qgis, points: np.ndarray) -> str:
    """GEOS has the same cells."""
    box = shapely.box(EAST, NORTH, EAST + 1000, NORTH + 800)
    extent = f"{EAST},{EAST + 1000},{NORTH},{NORTH + 800} [{SYSTEM}]"
    found = qgis.run("voronoi", INPUT="points.gpkg", EXTENT=extent)
    require(found.crs == SYSTEM, f"the system is {found.crs}")
    require(found["name"].tolist() == [f"p{row}" for row in range(len(points))], "fields stay")
    moved = shapely.multipoints(points[:, :2] - (EAST, NORTH))
    cells = shapely.get_parts(shapely.voronoi_polygons(moved, ordered=True))
    inside = shapely.intersection(cells, shapely.box(0, 0, 1000, 800))
    off = np.abs(shapely.area(inside) - found.area).max()
    require(off < 1e-5, f"areas are off by {off}")
    require(abs(found.area.sum() - box.area) < 1e-3, "the cells fill the rectangle")
    return f"{len(found):,} cells with the areas of GEOS's, off by at most {off:.1e}"


def check_errors(qgis: Qgis) -> str:
    """Wrong layers and values give a sentence."""
    qgis.write("line", [shapely.LineString([(0, 0), (1, 1)])])
    qgis.write("row", shapely.points([[0, 0, 1], [1, 1, 1], [2, 2, 1.0]]))
    qgis.write("crossing", [shapely.Polygon([(0, 0), (2, 2), (2, 0), (0, 2)])])
    expected = {
        "has no points, but is of the type Polygon": ("tin", {"INPUT": "zones.gpkg"}),
        "choose a field that has heights": ("tin", {"INPUT": "flat.gpkg"}),
        "has no field 'depth'": ("tin", {"INPUT": "points.gpkg", "HEIGHT": "depth"}),
        "has no number in the field 'name'": ("tin", {"INPUT": "points.gpkg", "HEIGHT": "name"}),
        "3 distinct points lie on one line": ("tin", {"INPUT": "row.gpkg"}),
        '"Longest side" is -2.0: give': ("tin", {"INPUT": "points.gpkg", "MAX_EDGE": -2}),
        '"Interval" is -3.0: give': ("contours", {"INPUT": "points.gpkg", "INTERVAL": -3}),
        "is no triangle with heights": ("contours", {"INPUT": "zones.gpkg"}),
        '"Largest error" is -1.0: give': ("tinfromdem", {"INPUT": "dem.tif", "MAX_ERROR": -1}),
        "has no lines, but is of": (
            "constrainedtin", {"INPUT": "points.gpkg", "BREAKLINES": "zones.gpkg"},
        ),
        "crosses where no row is": ("volume", {"INPUT": "points.gpkg", "ZONES": "crossing.gpkg"}),
        "has no points": ("voronoi", {"INPUT": "line.gpkg"}),
    }  # fmt: skip
    for sentence, (name, given) in expected.items():
        told = qgis.error(name, **given)
        require(sentence in told, f"{name} {given}: {told}")
    return f"{len(expected)} wrong layers and values have their sentences"


def check_window(qgis: Qgis) -> str:
    """The program itself installs the zip, runs algorithms, cancels one, and is photographed."""
    PICTURE.parent.mkdir(exist_ok=True)
    report = qgis.home / "report.json"
    words = ["xvfb-run", "--auto-servernum", "--server-args=-screen 0 1400x900x24"]
    words += [shutil.which("qgis.bin") or "qgis", "--nologo", "--noversioncheck"]
    home = qgis.home / "window"  # where nothing is installed yet
    home.mkdir()
    places = {"HOME": home, "ZIP": qgis.home / f"{PLUGIN}.zip", "LAYERS": qgis.folder}
    places |= {"PICTURE": PICTURE, "REPORT": report}
    told = {name: str(each) for name, each in places.items()}
    ended = subprocess.run(
        [*words, "--code", str(HERE / "window.py")], check=False, timeout=240, text=True,
        env={**qgis.environment, **told}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    require(report.exists(), ended.stdout)
    found = json.loads(report.read_text())
    require("error" not in found, found.get("error", ""))
    require({*found["algorithms"]} == NAMES, f"the toolbox has {found['algorithms']}")
    require(found["cancelled"], "a cancelled run ends early")
    require(found["triangles"] == 5976, f"in another thread: {found['triangles']} triangles")
    return f"QGIS {found['version']}, whose picture is {PICTURE}"


def main() -> None:
    """Run all checks."""
    with TemporaryDirectory(prefix="liftmesh-qgis-") as home:
        qgis = Qgis(Path(home))
        listed = {
            line.split()[0] for line in qgis.process("list").splitlines() if "liftmesh:" in line
        }
        require(listed == {f"liftmesh:{name}" for name in NAMES}, f"algorithms {listed}")
        points = draw(qgis)
        print("tin:", check_tin(qgis, points), flush=True)
        print("constrainedtin:", check_constrained(qgis), flush=True)
        print("tinfromdem:", check_raster(qgis), flush=True)
        print("contours:", check_contours(qgis, points), flush=True)
        print("volume:", check_volume(qgis), flush=True)
        print("voronoi:", check_voronoi(qgis, points), flush=True)
        print("errors:", check_errors(qgis), flush=True)
        print("window:", check_window(qgis), flush=True)


if __name__ == "__main__":
    sys.exit(main())
