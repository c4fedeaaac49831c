"""The algorithms: each reads its layers, calls one function of liftmesh, and writes a layer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, get_args

import numpy as np
from qgis.core import (
    Qgis,
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterBand,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterRasterLayer,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QVariant

import liftmesh
from liftmesh.base.options import Crossing, OnDuplicate, counted
from liftmesh.plugins.qgis import geometries

from .layers import (
    LINES,
    OUTPUT,
    POINTS,
    POLYGONS,
    Algorithm,
    Run,
    choice,
    field,
    fields_of,
    geometry,
    layer,
    number,
    polygons_of,
)

NUMBERS = ("above", "below", "net", "area")


def _output(label: str, kind: Any = QgsProcessing.TypeVectorPolygon) -> Any:
    return QgsProcessingParameterFeatureSink(OUTPUT, label, kind)


class Tin(Algorithm):
    """Triangles of points."""

    NAME, LABEL = "tin", "TIN from points"
    HELP = (
        "The Delaunay triangles of points with heights, as polygons with heights. Which triangles "
        "there are is exact, and does not depend on the order of the features.\n\n"
        "With a longest side, triangles with longer sides are left out from outside inwards: they "
        "bridge what the points do not cover."
    )

    def parameters(self) -> Iterator[Any]:
        """Return the parameters."""
        yield layer("INPUT", "Points", POINTS)
        yield field("HEIGHT", "INPUT")
        yield choice("ON_DUPLICATE", get_args(OnDuplicate))
        yield number("MAX_EDGE")
        yield _output("Triangles")

    def compute(self, run: Run) -> dict[str, Any]:
        """Triangulate."""
        cloud = run.cloud(run.layer("INPUT", POINTS), run.text("HEIGHT"))
        surface = liftmesh.triangulate(
            cloud,
            on_duplicate=run.word("ON_DUPLICATE"),
            progress=run.computed,
            **self.lines(run),
        )
        longest = run.number("MAX_EDGE")
        if longest is not None:
            surface = surface.trim(max_edge=longest, boundary_only=True)
        return run.write_triangles(surface)

    def lines(self, run: Run) -> dict[str, Any]:  # noqa: ARG002 - of those that have some
        """Return the options of `triangulate` that name lines."""
        return {}


class ConstrainedTin(Tin):
    """Triangles of points that follow lines."""

    NAME, LABEL = "constrainedtin", "Constrained TIN with breaklines"
    HELP = (
        "Triangles of points with heights that do not cross breaklines, and end at a boundary.\n\n"
        "The corners of breaklines become corners of triangles, with their heights. Lines without "
        "heights take those of the surface without them. Where two lines with heights cross, and "
        'neither has a corner, there is an error; with "split", a corner is inserted with the '
        "height of the first of them.\n\n"
        "Outside of the boundary, and in its holes, there are no triangles."
    )

    def parameters(self) -> Iterator[Any]:
        """Return the parameters."""
        yield layer("BREAKLINES", "Breaklines", LINES, optional=True)
        yield layer("BOUNDARY", "Boundary", POLYGONS, optional=True)
        yield choice("CROSSING", get_args(Crossing))
        yield from super().parameters()

    def lines(self, run: Run) -> dict[str, Any]:
        """Return the lines."""
        return {
            "breaklines": run.lines("BREAKLINES"),
            "boundary": run.polygons("BOUNDARY"),
            "crossing": run.word("CROSSING"),
        }


class TinFromRaster(Algorithm):
    """Few triangles of a raster, within an error."""

    NAME, LABEL = "tinfromdem", "TIN from DEM, within an error"
    HELP = (
        "Few triangles that are nowhere farther from the heights of a raster than the largest "
        "error, in the vertical and exactly. Pixels without data are left out."
    )

    def parameters(self) -> Iterator[Any]:
        """Return the parameters."""
        yield QgsProcessingParameterRasterLayer("INPUT", "Elevation model")
        yield QgsProcessingParameterBand("BAND", "Band (by default the first)", 1, "INPUT", True)
        yield number("MAX_ERROR", 1.0)
        yield _output("Triangles")

    def prepareAlgorithm(self, parameters: Any, context: Any, feedback: Any) -> bool:  # noqa: ARG002
        """Copy what reads the raster, for the thread in which the algorithm runs."""
        raster = self.parameterAsRasterLayer(parameters, "INPUT", context)
        if raster is None:
            raise QgsProcessingException(self.invalidRasterError(parameters, "INPUT"))
        self._raster, self._crs = raster.dataProvider().clone(), raster.crs()
        return True

    def compute(self, run: Run) -> dict[str, Any]:
        """Simplify."""
        run.crs = self._crs
        grid = liftmesh.Raster(*self._read(run.whole("BAND") or 1), run.wkt())
        error = run.number("MAX_ERROR")
        return run.write_triangles(liftmesh.simplify(grid, max_error=error, progress=run.computed))

    def _read(self, band: int) -> tuple[np.ndarray, Any]:
        """Return the values, NaN where there are none, and where the pixels are."""
        box, rows, columns = self._raster.extent(), self._raster.ySize(), self._raster.xSize()
        block = self._raster.block(band, box, columns, rows)
        missing = _missing(block, rows * columns)
        if not block.convert(Qgis.Float64):
            raise QgsProcessingException(f"band {band} has no numbers: choose another one")
        values = np.frombuffer(bytes(block.data()), dtype=np.float64).copy()
        values[missing] = np.nan
        width, height = box.width() / columns, box.height() / rows
        return values.reshape(rows, columns), (
            width, 0.0, box.xMinimum(), 0.0, -height, box.yMaximum()
        )  # fmt: skip


def _missing(block: Any, count: int) -> Any:
    if not block.hasNoData():
        return slice(0)
    return np.fromiter((block.isNoData(place) for place in range(count)), dtype=bool, count=count)


class Contours(Algorithm):
    """Lines of equal height."""

    NAME, LABEL = "contours", "Contours of a TIN"
    HELP = (
        "Lines of equal height over points with heights, or over the triangles that another "
        "algorithm has made. What is above is on the left of a line.\n\n"
        "Smooth lines never cross, and are nowhere farther from their height than is allowed."
    )

    def parameters(self) -> Iterator[Any]:
        """Return the parameters."""
        yield layer("INPUT", "Points or triangles", POINTS, POLYGONS)
        yield field("HEIGHT", "INPUT")
        yield number("INTERVAL", 10.0)
        yield number("CONTOUR_BASE", 0.0)
        yield number("SMOOTH")
        yield _output("Contours", QgsProcessing.TypeVectorLine)

    def compute(self, run: Run) -> dict[str, Any]:
        """Follow the lines."""
        found = run.surface("INPUT", "HEIGHT").contours(
            interval=run.number("INTERVAL"),
            contour_base=run.number("CONTOUR_BASE"),
            smooth=run.number("SMOOTH"),
        )
        run.computed(1.0)
        rows = (
            (geometry(shape), [float(level), bool(is_index)])
            for shape, level, is_index in zip(
                geometries.lines(found), found.levels, found.is_index, strict=True
            )
        )
        fields = fields_of(elevation=QVariant.Double, is_index=QVariant.Bool)
        return {OUTPUT: run.write(fields, QgsWkbTypes.LineStringZ, rows, len(found))}


class Volume(Algorithm):
    """Volumes above and below a level, or another surface."""

    NAME, LABEL = "volume", "Volume of a TIN"
    HELP = (
        "How much there is between a surface and a level, or another surface: what is above it, "
        "what is below it, and the first less the second. Only where there are surfaces.\n\n"
        "With zones, each of these is measured by itself, and is in the result with its fields."
    )

    def parameters(self) -> Iterator[Any]:
        """Return the parameters."""
        yield layer("INPUT", "Points or triangles", POINTS, POLYGONS)
        yield field("HEIGHT", "INPUT")
        yield number("LEVEL", 0.0)
        yield layer("OTHER", "Other surface, in place of a level", POINTS, POLYGONS, optional=True)
        yield field("OTHER_HEIGHT", "OTHER")
        yield layer("ZONES", "Zones", POLYGONS, optional=True)
        yield _output("Volumes", QgsProcessing.TypeVector)

    def initAlgorithm(self, configuration: Any = None) -> None:
        """State the numbers that come out, too."""
        super().initAlgorithm(configuration)
        for name in NUMBERS:
            self.addOutput(QgsProcessingOutputNumber(name.upper(), f"Sum of {name}"))

    def compute(self, run: Run) -> dict[str, Any]:
        """Measure."""
        surface, level = run.surface("INPUT", "HEIGHT"), run.number("LEVEL")
        if run.has("OTHER"):
            other = run.surface("OTHER", "OTHER_HEIGHT")
            surface, level = liftmesh.difference(surface, other, progress=run.computed), 0.0
        zones = run.layer("ZONES", POLYGONS) if run.has("ZONES") else None
        rows = [
            (shape, [*before, *geometries.volumes(surface, level, polygons)])
            for shape, before, polygons in _zones(run, zones)
        ]
        fields = fields_of(
            zones.fields() if zones else (), **dict.fromkeys(NUMBERS, QVariant.Double)
        )
        kind = zones.wkbType() if zones else QgsWkbTypes.NoGeometry
        columns = zip(*(values[-len(NUMBERS) :] for _, values in rows), strict=True)
        sums = {name.upper(): sum(each) for name, each in zip(NUMBERS, columns, strict=True)}
        return {OUTPUT: run.write(fields, kind, rows, len(rows)), **sums}


def _zones(run: Run, zones: Any) -> Iterable[tuple[Any, list[Any], Any]]:
    """Yield the geometry, the values and the polygons of each zone; or none, for all."""
    if zones is None:
        yield None, [], None
        return
    for feature in run.features(zones):
        run.computed(0.5)
        yield feature.geometry(), feature.attributes(), [*polygons_of(feature)]


class Voronoi(Algorithm):
    """Voronoi cells of points."""

    NAME, LABEL = "voronoi", "Voronoi cells"
    HELP = (
        "What is nearer to each point than to any other, inside of a rectangle: by default that "
        "of the points, widened by a tenth of its longer side. Each cell has the fields of its "
        "point. Cells do not overlap, and leave no gap. Of points at one position the first has "
        "the cell."
    )

    def parameters(self) -> Iterator[Any]:
        """Return the parameters."""
        yield layer("INPUT", "Points", POINTS)
        yield QgsProcessingParameterExtent("EXTENT", "Rectangle", None, True)
        yield _output("Cells")

    def compute(self, run: Run) -> dict[str, Any]:
        """Make the cells."""
        source = run.layer("INPUT", POINTS)
        points, owners = run.points(source)
        domain = run.extent("EXTENT")
        found = liftmesh.voronoi(points[:, :2], domain=domain, progress=run.computed)
        if len(found.duplicates):
            repeated = counted(len(found.duplicates), "point")
            run.feedback.pushWarning(f"{repeated} at a position of others: the first has the cell")
        rows = (
            (geometry(shape), owners[row].attributes()) for row, shape in geometries.cells(found)
        )
        written = run.write(source.fields(), QgsWkbTypes.Polygon, rows, len(points))
        return {OUTPUT: written}


ALGORITHMS = (Tin, ConstrainedTin, TinFromRaster, Contours, Volume, Voronoi)
