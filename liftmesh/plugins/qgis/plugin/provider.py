"""The plugin, and the provider that it adds to the Processing toolbox."""

from __future__ import annotations

from qgis.core import QgsApplication, QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

import liftmesh

from .algorithms import ALGORITHMS
from .layers import ICON


class Provider(QgsProcessingProvider):  # type: ignore[misc]
    """Everything under "liftmesh" in the toolbox."""

    def id(self) -> str:
        """Return the first part of the algorithms' names."""
        return "liftmesh"

    def name(self) -> str:
        """Return the name in the toolbox."""
        return "liftmesh"

    def longName(self) -> str:
        """Return the name with the version."""
        return f"liftmesh {liftmesh.__version__}"

    def icon(self) -> QIcon:
        """Return the picture in the toolbox."""
        return QIcon(ICON)

    def loadAlgorithms(self) -> None:
        """Add the algorithms."""
        for each in ALGORITHMS:
            self.addAlgorithm(each())


class Plugin:
    """What QGIS loads: the toolbox of its window, or `qgis_process`, which has no window."""

    def __init__(self) -> None:
        self._provider: Provider | None = None

    def initProcessing(self) -> None:
        """Add the provider."""
        self._provider = Provider()
        QgsApplication.processingRegistry().addProvider(self._provider)

    def initGui(self) -> None:
        """Do the same in the window."""
        self.initProcessing()

    def unload(self) -> None:
        """Take the provider away."""
        QgsApplication.processingRegistry().removeProvider(self._provider)
