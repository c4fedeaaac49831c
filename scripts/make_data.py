"""Reproduce the clouds of ``data/``, byte for byte: ``python scripts/make_data.py [FOLDER]``.

The terrain comes from the elevation model in matplotlib's sample data. The small clouds are
computed with integers and basic arithmetic, so that every machine gets the same digits.
"""

from __future__ import annotations

import hashlib
import math
import sys
from pathlib import Path

import numpy as np
from matplotlib import cbook

import liftmesh

MODEL = "jacksboro_fault_dem.npz"
MODEL_SHA256 = "d493f50a33e82a4420494c54d1fca1539d177bdc27ab190bc5fe6e92f62fb637"
METRES_PER_DEGREE = 111_200.0
DATA = Path(__file__).resolve().parent.parent / "data"


def main(folder: Path) -> None:
    """Write every cloud of ``data/`` into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    liftmesh.write(folder / "jacksboro.ply", jacksboro())
    liftmesh.write(folder / "overhang.ply", overhang())
    (folder / "hill.csv").write_text(hill(), "utf-8")
    (folder / "masts.csv").write_text(masts(), "utf-8")
    (folder / "quad.xyz").write_text(quad(), "utf-8")


def jacksboro() -> liftmesh.Cloud:
    """Return the terrain around the Jacksboro fault in metres east and north of its corner.

    All longitudes are scaled at the middle latitude. So the samples stay a rectangular lattice, in
    which the four points of each cell are cocircular; distances are off by up to 0.2 %.
    Coordinates are rounded to millimetres, so that the last bit of ``cos`` does not matter.
    """
    with np.load(_model()) as model:
        elevation = model["elevation"].astype(np.float64)
        dx, dy = float(model["dx"]), float(model["dy"])
        middle = (float(model["ymin"]) + float(model["ymax"])) / 2
    rows, columns = elevation.shape
    x = METRES_PER_DEGREE * math.cos(math.radians(middle)) * dx * np.arange(columns)
    y = METRES_PER_DEGREE * dy * np.arange(rows)[::-1]  # the model's rows run from north to south
    east, north = np.meshgrid(np.round(x, 3), np.round(y, 3))
    return liftmesh.Cloud(np.column_stack([east.ravel(), north.ravel(), elevation.ravel()]))


def quad() -> str:
    """Return the corners of a square: four cocircular points, the smallest tie."""
    return "0 0 0\n1 0 1\n1 1 0\n0 1 1\n"


def hill() -> str:
    """Return a hill of 80 scattered points, coloured by height."""
    lines = ["x,y,z,red,green,blue"]
    for k in range(80):
        x, y = (618 * k) % 1000 / 10, (757 * k + k * k) % 1000 / 10
        z = 20 / (1 + ((x - 50) ** 2 + (y - 45) ** 2) / 600)
        shade = int(10 * z)
        lines.append(f"{x},{y},{z:.2f},{55 + shade},{105 + shade // 2},{40 + shade}")
    return "\n".join(lines) + "\n"


def masts() -> str:
    """Return six masts with how far they reach, of which one is within another's disk."""
    rows = [
        "2,2,1.5,harbour",
        "7,2,0.2,mill",
        "8,6,1,hill",
        "2.5,2,0.5,pier",
        "4,6.5,0.6,church",
        "5.5,4,0.1,bridge",
    ]
    return "\n".join(["x,y,reach,name", *rows]) + "\n"


def overhang() -> liftmesh.Cloud:
    """Return two terraces joined by a vertical wall, which no planar triangulation can represent.

    The foot and top of the wall have the same planar position; the last row repeats the first.
    """
    low = [(x, y, 0.0) for x in range(3) for y in range(4)]
    high = [(x, y, 8.0) for x in range(2, 5) for y in range(4)]
    classes = np.array([2] * len(low) + [6] * len(high) + [2], dtype=np.uint8)
    points = np.array([*low, *high, low[0]], dtype=np.float64)
    return liftmesh.Cloud(points, attributes={"classification": classes})


def _model() -> Path:
    path = Path(cbook.get_sample_data(MODEL, asfileobj=False))
    if hashlib.sha256(path.read_bytes()).hexdigest() != MODEL_SHA256:
        raise SystemExit(f"{path} is not the elevation model that data/jacksboro.ply was made from")
    return path


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else DATA)
