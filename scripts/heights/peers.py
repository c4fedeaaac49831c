"""Programs that heights and rasters are compared with: CGAL's heights, PDAL's loop, gdal_grid.

Each is given files of a folder, which are written once, and says its own seconds of the processor
or is timed by its caller.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from benchmark import cgal
from benchmark.cgal.beside import PROGRAMS
from numpy.typing import NDArray

if TYPE_CHECKING:
    import liftmesh

Floats: TypeAlias = NDArray[np.float64]
Method: TypeAlias = Literal["linear", "sibson"]

HEIGHTS = Path(__file__).with_name("cgal_heights.cpp")
FACERASTER = Path(__file__).with_name("faceraster.cpp")

_POINTS = """<OGRVRTDataSource><OGRVRTLayer name="rows">
<SrcDataSource relativeToVRT="1">rows.csv</SrcDataSource>
<GeometryType>wkbPoint25D</GeometryType>
<GeometryField encoding="PointFromColumns" x="x" y="y" z="z"/>
</OGRVRTLayer></OGRVRTDataSource>
"""


@dataclass(frozen=True)
class CgalHeights:
    """CGAL's heights at points, on a triangulation of its own."""

    program: Path
    folder: Path

    @classmethod
    def built(cls, folder: Path, rows: Floats) -> CgalHeights:
        """Build the program; raise `cgal.UnavailableError` where it cannot be."""
        program = cgal.build(PROGRAMS, HEIGHTS)
        np.ascontiguousarray(rows).tofile(folder / "vertices")
        return cls(program, folder)

    def sample(self, asked: Floats, method: Method) -> tuple[Floats, float]:
        """Return heights, NaN outside of the hull, and the seconds that they took."""
        points, heights = self.folder / "asked", self.folder / "heights"
        np.ascontiguousarray(asked).tofile(points)
        seconds = _said([self.program, method, self.folder / "vertices", points, heights])
        return np.fromfile(heights), seconds


@dataclass(frozen=True)
class Faceraster:
    """The loop of PDAL's filter over the faces of a surface."""

    program: Path
    folder: Path

    @classmethod
    def built(cls, folder: Path, surface: liftmesh.Surface) -> Faceraster:
        """Build the program; raise `cgal.UnavailableError` without a compiler or CGAL."""
        program = cgal.build(PROGRAMS, FACERASTER)
        np.ascontiguousarray(surface.vertices).tofile(folder / "rows")
        np.ascontiguousarray(surface.faces).tofile(folder / "triangles")
        return cls(program, folder)

    def seconds(self, side: float, count: int, target: Path | None = None) -> float:
        """Make count x count pixels of a square at the origin; write them if asked to."""
        files = [self.folder / "rows", self.folder / "triangles"]
        numbers = ["0", "0", repr(side / count), str(count), str(count)]
        return _said([self.program, *files, *numbers, target or "-"])


@dataclass(frozen=True)
class GdalGrid:
    """The programs of GDAL, and a file of points that they read."""

    folder: Path

    @classmethod
    def found(cls, folder: Path, rows: Floats) -> GdalGrid | None:
        """Write the points; None without GDAL's programs."""
        if not (shutil.which("gdal_grid") and shutil.which("gdal_create")):
            return None
        np.savetxt(folder / "rows.csv", rows, "%.17g", ",", header="x,y,z", comments="")
        (folder / "rows.vrt").write_text(_POINTS)
        return cls(folder)

    def make(self, side: float, count: int, target: str = "grid.tif") -> None:
        """Interpolate on GDAL's triangulation, and write count x count pixels of a square."""
        self._grid("linear:radius=0", side, count, target)

    def only_read(self, side: float) -> None:
        """Read the points alone: count them at one pixel."""
        self._grid("count", side, 1, "one.tif")

    def only_write(self, count: int) -> None:
        """Write as many pixels, all of one value."""
        size = [str(count), str(count)]
        words = ["-of", "GTiff", "-ot", "Float32", "-outsize", *size, "-bands", "1", "-burn", "1"]
        self._run(["gdal_create", "-q", *words, self.folder / "written.tif"])

    def _grid(self, algorithm: str, side: float, count: int, target: str) -> None:
        words = ["-q", "-a", algorithm, "-ot", "Float32", "-txe", "0", str(side)]
        words += ["-tye", str(side), "0", "-outsize", str(count), str(count)]
        self._run(["gdal_grid", *words, self.folder / "rows.vrt", self.folder / target])

    @staticmethod
    def _run(command: list[str | Path]) -> None:
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def _said(command: list[str | Path]) -> float:
    """Run a program; return the seconds that it says."""
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(json.loads(done.stdout)["seconds"])
