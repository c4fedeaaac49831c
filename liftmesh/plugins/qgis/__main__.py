"""Makes the zip that QGIS installs: ``python -m liftmesh.plugins.qgis liftmesh_qgis.zip``."""

from __future__ import annotations

import sys
from argparse import ArgumentParser

from liftmesh.plugins.qgis import PLUGIN, write_zip

if __name__ == "__main__":
    parser = ArgumentParser(description="Make the zip that QGIS installs, with liftmesh in it.")
    parser.add_argument("path", nargs="?", default=f"{PLUGIN}.zip", help="where to write it")
    path = write_zip(parser.parse_args().path)
    print(f"{path}: for a QGIS with Python {sys.version_info[0]}.{sys.version_info[1]}")  # noqa: T201 - a command
