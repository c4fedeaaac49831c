"""Draw the README's picture, ``data/jacksboro.png``: ``python scripts/render_readme.py [MESH]``.

It reads the mesh that ``liftmesh triangulate data/jacksboro.ply out/jacksboro.ply`` wrote and draws
its triangles: all of them as a shaded map, and those in a window as a block in oblique view, where
every edge is visible. The picture is drawn at twice its size and scaled down, which smooths it
without seams between the triangles.
"""

from __future__ import annotations

import io
import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import ConnectionPatch, Rectangle
from numpy.typing import NDArray
from PIL import Image

import liftmesh

ROOT = Path(__file__).resolve().parent.parent
MESH = ROOT / "out" / "jacksboro.ply"
PICTURE = ROOT / "data" / "jacksboro.png"
WIDTH, HEIGHT, FINER = 1600, 1000, 2

Array = NDArray[np.float64]

PAPER, INK, SOFT, ACCENT = "#f5f1e8", "#2b2a27", "#7d766a", "#b4432f"
SECTION = "#cfc5b2"
TINTS = LinearSegmentedColormap.from_list(
    "terrain", ["#9aa88a", "#b9ba95", "#d8c9a0", "#d6b48c", "#c99f7f", "#d9bfa6", "#eee0cf"]
)
WINDOW = (15_500.0, 17_350.0, 18_300.0, 19_850.0)  # west, south, east, north in metres
SUN, SKY = (-1.0, 0.75, 1.0), (0.2, -0.6, 1.0)  # directions of the light: east, north, up
EXAGGERATION = 2.0
FLOOR = 120.0  # metres of block under the lowest point


@dataclass(frozen=True)
class Mesh:
    """The corners of every triangle, (m, 3, 3), and the colour of its shaded face, (m, 3)."""

    corners: Array
    colors: Array

    def within(self, window: tuple[float, float, float, float]) -> Mesh:
        """Keep the triangles that lie entirely inside a window."""
        west, south, east, north = window
        x, y = self.corners[..., 0], self.corners[..., 1]
        inside = ((x >= west) & (x <= east) & (y >= south) & (y <= north)).all(axis=1)
        return Mesh(self.corners[inside], self.colors[inside])


def main(path: Path) -> None:
    """Draw the picture from a mesh file."""
    surface = liftmesh.read(path)
    if surface.faces is None:
        raise SystemExit(f"{path} has no faces: run scripts/demo.sh, which writes {MESH}")
    corners = surface.points[surface.faces]
    mesh = Mesh(corners, shaded(corners))
    figure = Figure(figsize=(WIDTH / 100, HEIGHT / 100), facecolor=PAPER)
    above = draw_map(figure, mesh)
    oblique = draw_block(figure, mesh.within(WINDOW))
    join(figure, above, oblique, mesh.within(WINDOW))
    write_words(figure, len(surface), len(corners))
    save(figure)


def shaded(corners: Array) -> Array:
    """Return the colour of each face: a tint by height, times its illumination."""
    raised = corners * (1.0, 1.0, EXAGGERATION)
    normals = np.cross(raised[:, 1] - raised[:, 0], raised[:, 2] - raised[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    light = 0.26 + 0.74 * _towards(normals, SUN) + 0.24 * _towards(normals, SKY)
    heights = corners[..., 2].mean(axis=1)
    low, high = np.quantile(heights, [0.02, 0.995])
    tints = TINTS(np.clip((heights - low) / (high - low), 0, 1))[:, :3]
    return np.clip(tints * light[:, np.newaxis], 0, 1)


def _towards(normals: Array, direction: tuple[float, float, float]) -> Array:
    unit = np.array(direction) / np.linalg.norm(direction)
    return np.clip(normals @ unit, 0, 1)


def draw_map(figure: Figure, mesh: Mesh) -> Axes:
    """Draw all triangles from above, and a frame around the window."""
    axes = _blank_axes(figure, (0.03, 0.048, 0.565, 0.904))
    faces = PolyCollection(mesh.corners[..., :2], facecolors=mesh.colors, antialiased=False, lw=0)
    axes.add_collection(faces)
    axes.set_xlim(0, mesh.corners[..., 0].max())
    axes.set_ylim(0, mesh.corners[..., 1].max())
    axes.set_anchor("W")
    west, south, east, north = WINDOW
    axes.add_patch(
        Rectangle((west, south), east - west, north - south, fill=False, ec=ACCENT, lw=1.4)
    )
    _scale_bar(axes)
    return axes


def _scale_bar(axes: Axes) -> None:
    """Draw five kilometres in the lower right corner."""
    right, bottom = axes.get_xlim()[1] - 900, 900
    axes.plot([right - 5000, right], [bottom, bottom], color=INK, lw=1.6, solid_capstyle="butt")
    axes.text(right - 2500, bottom + 260, "5 km", ha="center", va="bottom", fontsize=10, color=INK)


def draw_block(figure: Figure, mesh: Mesh) -> Axes:
    """Draw the window's triangles in oblique view on a block, from back to front."""
    axes = _blank_axes(figure, (0.6, 0.115, 0.385, 0.60))
    for wall in _walls(mesh):
        axes.add_collection(PolyCollection([_oblique(wall)[:, :2]], fc=SECTION, ec=INK, lw=0.7))
    seen = _oblique(mesh.corners)
    order = np.argsort(-seen[..., 2].mean(axis=1))
    axes.add_collection(
        PolyCollection(
            seen[order][..., :2],
            facecolors=mesh.colors[order],
            edgecolors=(0.17, 0.16, 0.14, 0.6),
            lw=0.35,
            joinstyle="round",
        )
    )
    axes.autoscale_view()
    return axes


def join(figure: Figure, above: Axes, oblique: Axes, block: Mesh) -> None:
    """Connect two corners of the window with the same corners of the block."""
    west, south, east, north = WINDOW
    south_wall, _ = _walls(block)
    points = block.corners.reshape(-1, 3)
    northeast = points[points[:, :2].sum(axis=1).argmax()]
    for corner, point in (((west, south), south_wall[-1]), ((east, north), northeast)):
        end = tuple(_oblique(point)[:2])
        lead = ConnectionPatch(corner, end, "data", axesA=above, axesB=oblique)
        lead.set(color=ACCENT, lw=0.8, alpha=0.8, zorder=0.5)
        figure.add_artist(lead)
    oblique.set_zorder(1)


def _walls(mesh: Mesh) -> list[Array]:
    """Return the two front walls of the block as outlines in space."""
    floor = mesh.corners[..., 2].min() - FLOOR
    points = np.unique(mesh.corners.reshape(-1, 3), axis=0)
    south = points[points[:, 1] == points[:, 1].min()]
    west = points[points[:, 0] == points[:, 0].min()]
    return [
        np.vstack([side, side[::-1] * (1, 1, 0) + (0, 0, floor)])
        for side in (south, west[np.argsort(west[:, 1])])
    ]


def _oblique(points: Array, *, turn: float = 30.0, tilt: float = 40.0) -> Array:
    """Project points to right, up and depth, seen from the south-west and above."""
    turn, tilt = np.radians(turn), np.radians(tilt)
    x, y, z = points[..., 0], points[..., 1], points[..., 2] * EXAGGERATION
    right = x * np.cos(turn) - y * np.sin(turn)
    away = x * np.sin(turn) + y * np.cos(turn)
    return np.stack(
        [
            right,
            away * np.sin(tilt) + z * np.cos(tilt),
            away * np.cos(tilt) - z * np.sin(tilt),
        ],
        axis=-1,
    )


def write_words(figure: Figure, points: int, triangles: int) -> None:
    """Write the title and the captions."""
    left, serif = 0.616, "STIXGeneral"
    figure.text(left, 0.955, "liftmesh", size=40, color=INK, family=serif, va="top")
    figure.text(
        left,
        0.868,
        "Jacksboro fault, Tennessee",
        size=19,
        color=INK,
        family=serif,
        style="italic",
        va="top",
    )
    west, south, east, north = WINDOW
    paragraphs = {
        0.81: f"{points:,} heights of the Shuttle Radar Topography Mission\n"
        f"and the {triangles:,} triangles of their Delaunay triangulation",
        0.105: f"The framed window, {(east - west) / 1000:g} by {(north - south) / 1000:g} km, "
        "from the south-west, heights\ndoubled: every line is an edge of the mesh file",
    }
    for top, text in paragraphs.items():
        figure.text(left, top, text, size=11.5, color=SOFT, va="top", linespacing=1.6)


def _blank_axes(figure: Figure, box: tuple[float, float, float, float]) -> Axes:
    axes = figure.add_axes(box)
    axes.set_axis_off()
    axes.set_aspect("equal")
    return axes


def save(figure: Figure) -> None:
    """Write the picture, scaled down to half its drawn size."""
    large = io.BytesIO()
    with mpl.rc_context({"font.family": "DejaVu Sans"}):
        figure.savefig(large, format="png", dpi=100 * FINER)
    picture = Image.open(large).convert("RGB").resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
    coarser = picture.point(
        lambda value: 4 * round(value / 4)
    )  # invisible, and a third of the file size
    coarser.save(PICTURE, optimize=True)
    print(f"{PICTURE}: {PICTURE.stat().st_size:,} bytes")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else MESH)
