"""Write the surfaces that `check.py` opens: argument 1 is the folder.

A grey roof over 10 m by 20 m whose ridge is 5 m high, in metres of UTM.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import liftmesh

CORNER = (412_000.0, 5_655_000.0, 100.0)
ROOF = np.array([[0, 0, 0], [10, 0, 0], [0, 20, 0], [10, 20, 0], [5, 0, 5], [5, 20, 5]], float)


def main(folder: Path) -> None:
    grey = np.full((len(ROOF), 3), 128, dtype=np.uint8)
    cloud = liftmesh.Cloud(ROOF + CORNER, colors=grey, crs="EPSG:25832")
    surface = liftmesh.triangulate(cloud)
    surface.save(folder / "at its centre.glb", origin="center")
    surface.save(folder / "at a place.glb", origin=CORNER)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
