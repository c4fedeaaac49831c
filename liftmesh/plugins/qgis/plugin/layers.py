"""What the algorithms share: layers as arrays and back, progress, cancelling and errors."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from qgis.core import (
    QgsFeature,
    QgsFeatureRequest,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterNumber,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QVariant
from qgis.PyQt.QtGui import QIcon

import liftmesh
from liftmesh.plugins.qgis import geometries

OUTPUT = "OUTPUT"
POINTS, LINES, POLYGONS = "points", "lines", "polygons"
_TYPES = {
    POINTS: (QgsProcessing.TypeVectorPoint, QgsWkbTypes.PointGeometry),
    LINES: (QgsProcessing.TypeVectorLine, QgsWkbTypes.LineGeometry),
    POLYGONS: (QgsProcessing.TypeVectorPolygon, QgsWkbTypes.PolygonGeometry),
}
ICON = str(Path(__file__).parent / "icon.svg")
_READ, _COMPUTED = 0.2, 0.7  # of the progress
_BATCH = 1000  # features between two looks at whether the user has cancelled


class Cancelled(Exception):  # noqa: N818 - no error
    """The user has cancelled."""


class Algorithm(QgsProcessingAlgorithm):  # type: ignore[misc]
    """An algorithm of the toolbox: `parameters` are what it asks for, `compute` does it."""

    NAME: str
    LABEL: str
    HELP: str

    def createInstance(self) -> Algorithm:
        """Make another one, as QGIS does for each run."""
        return type(self)()

    def name(self) -> str:
        """Return the name in commands."""
        return self.NAME

    def displayName(self) -> str:
        """Return the name in the toolbox."""
        return self.LABEL

    def icon(self) -> QIcon:
        """Return the picture in the toolbox."""
        return QIcon(ICON)

    def shortHelpString(self) -> str:
        """Return what is shown beside the parameters."""
        return self.HELP

    def initAlgorithm(self, configuration: Any = None) -> None:  # noqa: ARG002 - of QGIS
        """State the parameters."""
        for each in self.parameters():
            self.addParameter(each)

    def parameters(self) -> Iterable[Any]:
        """Return the parameters."""
        raise NotImplementedError

    def compute(self, run: Run) -> dict[str, Any]:
        """Do the work."""
        raise NotImplementedError

    def processAlgorithm(self, parameters: Any, context: Any, feedback: Any) -> dict[str, Any]:
        """Run, with errors and warnings as QGIS shows them."""
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", liftmesh.DataWarning)
            try:
                return self.compute(Run(self, parameters, context, feedback))
            except Cancelled:
                return {}
            except liftmesh.LiftmeshError as error:
                raise QgsProcessingException(geometries.worded(error.message)) from error
            finally:
                for each in told:
                    message: Any = each.message
                    feedback.pushWarning(geometries.worded(message.args[0]))


class Run:
    """One run of an algorithm: its values, its layers, and where its progress goes."""

    def __init__(self, algorithm: Algorithm, parameters: Any, context: Any, feedback: Any) -> None:
        self._algorithm, self._parameters, self._context = algorithm, parameters, context
        self.feedback = feedback
        self.crs: Any = None  # of the first layer, and of all results

    # --- values ---

    def _value(self, kind: str, name: str, *options: Any) -> Any:
        read = getattr(self._algorithm, f"parameterAs{kind}")
        return read(self._parameters, name, self._context, *options)

    def has(self, name: str) -> bool:
        """Whether a parameter is given."""
        return self._parameters.get(name) not in (None, "")

    def number(self, name: str) -> Any:
        """Return a number, None if it is left out without a default."""
        default = self._algorithm.parameterDefinition(name).defaultValue()
        return self._value("Double", name) if self.has(name) or default is not None else None

    def whole(self, name: str) -> int:
        """Return a whole number."""
        return int(self._value("Int", name))

    def word(self, name: str) -> Any:
        """Return the chosen one of some words."""
        chosen = self._value("Enum", name)
        return self._algorithm.parameterDefinition(name).options()[chosen]

    def text(self, name: str) -> str:
        """Return a text, such as the name of a field."""
        return str(self._value("String", name))

    def extent(self, name: str) -> tuple[float, ...] | None:
        """Return a rectangle in the coordinate system of the first layer."""
        box = self._value("Extent", name, self.crs)
        if box.isNull():
            return None
        return box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum()

    def wkt(self) -> str | None:
        """Return the coordinate system for liftmesh, which warns of degrees."""
        return self.crs.toWkt() or None

    # --- progress ---

    def computed(self, done: float) -> None:
        """Tell how much is computed, as liftmesh calls it."""
        self._tell(_READ + (_COMPUTED - _READ) * done)

    def _tell(self, done: float) -> None:
        if self.feedback.isCanceled():
            raise Cancelled
        self.feedback.setProgress(100 * done)

    # --- layers in ---

    def layer(self, name: str, *kinds: str) -> Any:
        """Open a layer; the first one gives its coordinate system to all others."""
        source = self._value("Source", name)
        if source is None:
            raise QgsProcessingException(self._algorithm.invalidSourceError(self._parameters, name))
        found = QgsWkbTypes.geometryType(source.wkbType())
        if found not in [_TYPES[kind][1] for kind in kinds]:
            raise QgsProcessingException(
                f"the layer {source.sourceName()!r} has no {' or '.join(kinds)}, but is of the "
                f"type {QgsWkbTypes.displayString(source.wkbType())}: choose another layer"
            )
        self.crs = self.crs or source.sourceCrs()
        return source

    def features(self, source: Any) -> Iterator[Any]:
        """Yield the features of a layer, in the coordinate system of the first one."""
        request = QgsFeatureRequest()
        request.setDestinationCrs(self.crs, self._context.transformContext())
        count = max(source.featureCount(), 1)
        for number, each in enumerate(source.getFeatures(request)):
            if number % _BATCH == 0:
                self._tell(_READ * min(number / count, 1))
            yield each

    def points(self, source: Any) -> tuple[np.ndarray, list[Any]]:
        """Return the points of a layer, (n, 3), and the feature of each."""
        corners, owners = [np.empty((0, 3))], []
        for feature in self.features(source):
            corners.append(_corners(feature.geometry()))
            owners += [feature] * len(corners[-1])
        return np.concatenate(corners), owners

    def cloud(self, source: Any, field: str) -> liftmesh.Cloud:
        """Read points with heights, of a field if one is named."""
        name = source.sourceName()
        if field and source.fields().lookupField(field) < 0:
            raise QgsProcessingException(f"the layer {name!r} has no field {field!r}: choose one")
        points, owners = self.points(source)
        if field:
            points[:, 2] = [_number(each[field]) for each in owners]
        missing = np.flatnonzero(np.isnan(points[:, 2]))
        if len(missing):
            what = f"no number in the field {field!r}" if field else "a geometry without heights"
            raise QgsProcessingException(
                f"feature {owners[missing[0]].id()} of the layer {name!r} has {what}: choose a "
                "field that has heights, or select features that have them"
            )
        return liftmesh.Cloud(points, crs=self.wkt())

    def surface(self, name: str, field: str) -> liftmesh.Surface:
        """Make a surface of a layer: of points, or of triangles with heights."""
        source = self.layer(name, POINTS, POLYGONS)
        if QgsWkbTypes.geometryType(source.wkbType()) == QgsWkbTypes.PointGeometry:
            cloud = self.cloud(source, self.text(field))
            return liftmesh.triangulate(cloud, progress=self.computed)
        return geometries.surface_of_triangles(self._triangles(source), self.wkt())

    def _triangles(self, source: Any) -> np.ndarray:
        triangles = [np.empty((0, 4, 3))]
        for feature in self.features(source):
            for rings in polygons_of(feature):
                if len(rings) != 1 or len(rings[0]) != 4 or np.isnan(rings[0]).any():
                    raise QgsProcessingException(
                        f"feature {feature.id()} of the layer {source.sourceName()!r} is no "
                        "triangle with heights: choose a layer of points, or of triangles that "
                        "another algorithm has made"
                    )
                triangles.append(rings[0][None])
        return np.concatenate(triangles)[:, :3]

    def lines(self, name: str) -> list[np.ndarray] | None:
        """Return the lines of a layer; heights that they do not have are NaN."""
        if not self.has(name):
            return None
        features = self.features(self.layer(name, LINES))
        return [_corners(part) for each in features for part in _parts(each)]

    def polygons(self, name: str) -> list[list[np.ndarray]] | None:
        """Return the polygons of a layer, each as its rings."""
        if not self.has(name):
            return None
        features = self.features(self.layer(name, POLYGONS))
        return [polygon for each in features for polygon in polygons_of(each)]

    # --- layers out ---

    def write(self, fields: QgsFields, kind: Any, rows: Iterable[Any], count: int) -> str:
        """Write geometries, each with its values; return what QGIS names the layer."""
        flags = QgsFeatureSink.RegeneratePrimaryKey  # a point may have several cells
        sink, layer = self._value("Sink", OUTPUT, fields, kind, self.crs, flags)
        if sink is None:
            raise QgsProcessingException(self._algorithm.invalidSinkError(self._parameters, OUTPUT))
        for number, (shape, values) in enumerate(rows):
            if number % _BATCH == 0:
                self._tell(_COMPUTED + (1 - _COMPUTED) * number / count)
            feature = QgsFeature(fields)
            feature.setAttributes(values)
            if shape is not None:
                feature.setGeometry(shape)
            if not sink.addFeature(feature, QgsFeatureSink.FastInsert):
                raise QgsProcessingException(f"{layer} cannot be written: {sink.lastError()}")
        return str(layer)

    def write_triangles(self, surface: liftmesh.Surface) -> dict[str, Any]:
        """Write the faces of a surface."""
        shapes = geometries.triangles(surface)
        rows = ((geometry(shape), [number]) for number, shape in enumerate(shapes))
        fields = fields_of(triangle=QVariant.Int)
        return {OUTPUT: self.write(fields, QgsWkbTypes.PolygonZ, rows, len(surface.faces))}


def geometry(binary: bytes) -> QgsGeometry:
    """Make a geometry of well-known binary."""
    made = QgsGeometry()
    made.fromWkb(binary)
    return made


def polygons_of(feature: Any) -> Iterator[list[np.ndarray]]:
    """Yield the polygons of a feature, each as its rings."""
    for part in _parts(feature):
        holes = (part.interiorRing(number) for number in range(part.numInteriorRings()))
        yield [_corners(ring) for ring in (part.exteriorRing(), *holes)]


def _parts(feature: Any) -> Iterator[Any]:
    """Yield the parts of a feature, without curves."""
    shape = feature.geometry()
    if not shape.isNull():
        straight = QgsGeometry(shape.constGet().segmentize())
        yield from straight.constParts()


def _corners(shape: Any) -> np.ndarray:
    corners = [(each.x(), each.y(), each.z()) for each in shape.vertices()]
    return np.array(corners, dtype=np.float64).reshape(-1, 3)


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")


def fields_of(before: Any = (), **named: Any) -> QgsFields:
    """Return fields of the given types, after others."""
    fields = QgsFields()
    for each in (*before, *(QgsField(name, kind) for name, kind in named.items())):
        fields.append(each)
    return fields


# --- parameters ---


def layer(name: str, label: str, *kinds: str, optional: bool = False) -> Any:
    """Return a parameter for a layer."""
    types = [_TYPES[kind][0] for kind in kinds]
    return QgsProcessingParameterFeatureSource(name, label, types, None, optional)


def field(name: str, layer: str) -> Any:
    """Return a parameter for the field of heights of a layer."""
    label = "Field of heights (by default z of the geometries)"
    numeric = QgsProcessingParameterField.Numeric
    return QgsProcessingParameterField(name, label, None, layer, numeric, False, True)


def number(name: str, default: float | None = None) -> Any:
    """Return a parameter for a number, which may be left out if there is no default."""
    label, kind = geometries.LABELS[name.lower()], QgsProcessingParameterNumber.Double
    return QgsProcessingParameterNumber(name, label, kind, default, default is None)


def choice(name: str, words: Iterable[str]) -> Any:
    """Return a parameter for one of some words, the first by default."""
    label = geometries.LABELS[name.lower()]
    return QgsProcessingParameterEnum(name, label, [*words], False, 0)
