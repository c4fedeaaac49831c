"""Runs in QGIS's window: algorithms by way of the toolbox's own calls, and a picture."""

from __future__ import annotations

import json
import os
import traceback
from pathlib import Path

import processing
import pyplugin_installer
from processing.gui.ProcessingToolbox import ProcessingToolbox
from qgis.core import (
    Qgis,
    QgsApplication,
    QgsProcessingAlgRunnerTask,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProject,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import Qt, QTimer
from qgis.PyQt.QtGui import QColor, QGuiApplication
from qgis.utils import iface

started: list[Background] = []
LAYERS, REPORT = Path(os.environ["LAYERS"]), Path(os.environ["REPORT"])


class Impatient(QgsProcessingFeedback):
    """A user who cancels as soon as there is progress."""

    def setProgress(self, progress: float) -> None:  # noqa: ARG002, N802 - QGIS's name
        """Cancel."""
        self.cancel()


def show() -> dict[str, object]:
    """Install the plugin, run algorithms, show their results and the toolbox."""
    pyplugin_installer.instance().installFromZipFile(os.environ["ZIP"])
    points = QgsVectorLayer(str(LAYERS / "points.gpkg"), "points")
    QgsProject.instance().addMapLayer(points, False)
    started.append(Background(points))
    cancelled = processing.run(
        "liftmesh:tin", {"INPUT": points, "OUTPUT": "memory:"}, feedback=Impatient()
    )
    for name, color, more in (("tin", "#dfe7ea", {"MAX_EDGE": 60}), ("contours", "#b34700", {})):
        given = {"INPUT": points, "OUTPUT": "memory:", **more}
        made = processing.run(f"liftmesh:{name}", given)["OUTPUT"]
        made.setName(f"liftmesh: {name}")
        made.renderer().symbol().setColor(QColor(color))
        QgsProject.instance().addMapLayer(made)
    made.renderer().symbol().setWidth(0.6)
    iface.mapCanvas().zoomToFullExtent()
    iface.mainWindow().showNormal()
    iface.mainWindow().setGeometry(0, 0, 1400, 900)
    toolbox = iface.mainWindow().findChild(ProcessingToolbox)
    toolbox.show()
    iface.mainWindow().resizeDocks([toolbox], [330], Qt.Horizontal)
    toolbox.searchBox.setText("liftmesh")
    toolbox.algorithmTree.expandAll()
    provider = QgsApplication.processingRegistry().providerById("liftmesh")
    return {
        "version": Qgis.QGIS_VERSION,
        "algorithms": [each.name() for each in provider.algorithms()],
        "cancelled": not cancelled,
    }


class Background:
    """A run in another thread, as the toolbox starts it."""

    def __init__(self, points: QgsVectorLayer) -> None:
        self.done: object = None
        self.context, self.feedback = QgsProcessingContext(), QgsProcessingFeedback()
        self.context.setProject(QgsProject.instance())
        algorithm = QgsApplication.processingRegistry().algorithmById("liftmesh:tin")
        given = {"INPUT": points, "OUTPUT": str(LAYERS / "background.gpkg")}
        self.task = QgsProcessingAlgRunnerTask(algorithm, given, self.context, self.feedback)
        self.task.executed.connect(self.end)
        QgsApplication.taskManager().addTask(self.task)

    def end(self, succeeded: bool, results: dict[str, object]) -> None:
        """Keep what came out."""
        self.done = succeeded and QgsVectorLayer(str(results["OUTPUT"])).featureCount()


def photograph(told: dict[str, object]) -> None:
    """Take the picture, once the map is drawn, and leave."""
    told["triangles"] = started[0].done
    QGuiApplication.primaryScreen().grabWindow(0).save(os.environ["PICTURE"])
    finish(told)


def finish(told: dict[str, object]) -> None:
    """Say what was found, and end QGIS."""
    REPORT.write_text(json.dumps(told))
    os._exit(0)


def begin() -> None:
    """Start when the window is there."""
    try:
        told = show()
    except Exception:  # noqa: BLE001 - it is reported
        finish({"error": traceback.format_exc()})
    QTimer.singleShot(6000, lambda: photograph(told))


QTimer.singleShot(4000, begin)
