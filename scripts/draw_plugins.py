"""Draw the picture of PyVista in plugins.md, by PyVista: ``python scripts/draw_plugins.py``.

It needs PyVista, which the environment of the tests lacks: ``pip install 'liftmesh[pyvista]'``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / "data" / "pyvista.png"
PAPER, INK = "#f5f1e8", "#2b2a27"
ROWS = 20_000  # of the terrain


def terrain() -> pyvista.PolyData:
    """A surface of some of the points of a survey, without long faces at the rim."""
    whole = pyvista.read(ROOT / "data" / "jacksboro.ply", force_ext=".liftmesh-ply")
    rows = np.random.default_rng(1).choice(whole.n_points, ROWS, replace=False)
    points = pyvista.PolyData(whole.points[rows])
    return points.liftmesh.terrain(max_edge=whole.length / 25, boundary_only=True)


def main() -> None:
    """Draw the terrain with its contours, and beside it the cells of some of its points."""
    surface = terrain()
    surface["height"] = surface.points[:, 2]
    lines = surface.liftmesh.contours(interval=150)
    raised = lines.translate((0, 0, 10), inplace=False)  # above the faces that they are in
    look = {"scalars": "height", "cmap": "YlOrBr_r", "show_scalar_bar": False}
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 2), window_size=(1200, 525), border=False)
    plotter.background_color = PAPER
    plotter.add_mesh(surface, **look)
    plotter.add_mesh(raised, color=INK, line_width=2)
    plotter.camera_position = [(1, -1.1, 0.9), (0, 0, 0), (0, 0, 1)]
    plotter.reset_camera()
    plotter.camera.zoom(1.2)
    plotter.subplot(0, 1)
    cells = pyvista.PolyData(surface.points[::50]).liftmesh.voronoi()
    plotter.add_mesh(cells, show_edges=True, edge_color=INK, lighting=False, **look)
    plotter.view_xy()
    plotter.camera.zoom(1.35)
    plotter.screenshot(TARGET)


if __name__ == "__main__":
    main()
