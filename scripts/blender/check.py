"""Open in Blender what `make.py` has written into a folder, argument 1, and tell what is there.

Exits with 1 unless the roof is 10 m by 20 m by 5 m with its ridge upwards, its faces to above, its
vertices grey as 128 of 255 is shown, and near the origin, as its name says.
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np

SIZE, GREY = (10.0, 20.0, 5.0), 128 / 255
CORNERS = {"at its centre": (-5.0, -10.0, 0.0), "at a place": (0.0, 0.0, 0.0)}


def main(folder: Path) -> int:
    faults = []
    for name, corner in CORNERS.items():
        found = opened(folder / f"{name}.glb")
        print(f"{name}: {found}")
        faults += [f"{name}: {key}" for key in wrong(found, corner)]
    print("\n".join(f"wrong: {each}" for each in faults) or "Blender shows what was written")
    return int(bool(faults))


def opened(path: Path) -> dict[str, list[float]]:
    """Import a file into an empty scene; return what is measured of its one mesh."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    (thing,) = [each for each in bpy.context.scene.objects if each.type == "MESH"]
    turned = np.array(thing.matrix_world)
    places = np.array([each.co for each in thing.data.vertices]) @ turned[:3, :3].T + turned[:3, 3]
    upright = [(turned[:3, :3] @ np.array(each.normal))[2] for each in thing.data.polygons]
    colors = np.array([each.color_srgb[:3] for each in thing.data.color_attributes[0].data])
    ridge = places[places[:, 2] > places[:, 2].max() - 1e-3]
    return {
        "corner": places.min(axis=0).round(6).tolist(),
        "size": np.ptp(places, axis=0).round(6).tolist(),
        "ridge": np.ptp(ridge, axis=0).round(6).tolist(),
        "least upright": [round(min(upright), 6)],
        "shade": [round(float(colors.min()), 4), round(float(colors.max()), 4)],
    }


def wrong(found: dict[str, list[float]], corner: tuple[float, ...]) -> list[str]:
    """Name what is not as it was written."""
    expected = {
        "corner": corner,
        "size": SIZE,
        "ridge": (0.0, SIZE[1], 0.0),
        "least upright": (0.5**0.5,),
        "shade": (GREY, GREY),
    }
    return [k for k, v in expected.items() if not np.allclose(found[k], v, rtol=0, atol=2e-3)]


if __name__ == "__main__":
    raise SystemExit(main(Path(sys.argv[1])))
