"""`card`: what notebooks show of a result: a small picture, and its figures in a table.

`_picture_of` has the picture of each type, and `figures_of` its figures. Colours are those of the
text around, but for accents that are seen on light and on dark; there is no script and no style
sheet, and all text is escaped.
"""

from __future__ import annotations

from functools import singledispatch
from html import escape
from typing import Any

import numpy as np

from liftmesh.base.arrays import planar_bounds
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import as_uint8
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.voronoi import Unclipped
from liftmesh.errors import LiftmeshError
from liftmesh.io.columns import places
from liftmesh.planar.alpha import AlphaShape
from liftmesh.planar.certificate import Certificate
from liftmesh.planar.lifting import HullMesh, LowerHull
from liftmesh.planar.many import Triangulations
from liftmesh.planar.refined import RefineResult
from liftmesh.planar.triangulation import Triangulation
from liftmesh.plots import pictures
from liftmesh.plots.drawing import ACCENT
from liftmesh.plots.figures import USES, figures_of
from liftmesh.plots.pictures import Box, Picture, UnseenError
from liftmesh.raster.raster import Raster
from liftmesh.space.tetrahedralization import Tetrahedralization
from liftmesh.terrain.contours import Contours
from liftmesh.terrain.filled import FilledContours
from liftmesh.terrain.profile import Profile
from liftmesh.terrain.report import Report
from liftmesh.terrain.surface import Surface
from liftmesh.tiles.tiled_data import TiledData, cuts_of

_MOST_ROWS, _MOST_TEXT = 16, 100
_CELL = 'style="text-align:left;padding:1px 12px 1px 0;border:0;vertical-align:top"'
_AROUND = (
    "display:flex;flex-wrap:wrap;gap:16px;align-items:flex-start;margin:4px 0;"
    "font:13px/1.45 system-ui,sans-serif"
)
_USE_COLORS = (pictures.GREEN, "#cdbb79", "#d68c45", ACCENT, "#8a7fb5", "#8f8f8f")


def card(result: Any) -> str:
    """Return HTML of less than 100 kB, in which no name or value is markup."""
    try:
        with np.errstate(all="ignore"):
            picture = _picture_of(result)
    except (UnseenError, LiftmeshError, OSError):  # or the folder of tiles is gone
        picture = None
    figures = {name: text for name, text in figures_of(result).items() if text}
    rows = "".join(
        f"<tr><td {_CELL}>{escape(_short(name))}</td><td {_CELL}>{escape(_short(text))}</td></tr>"
        for name, text in [*figures.items()][:_MOST_ROWS]
    )
    drawn, note = ("", "") if picture is None else picture
    small = f'<div style="max-width:{pictures.SIDE}px">{escape(note)}</div>' if note else ""
    left = f"<div>{drawn}{small}</div>" if drawn else ""
    name = f"<b>{escape(type(result).__name__)}</b>"
    table = f'<table style="border-collapse:collapse;margin:0;font:inherit">{rows}</table>'
    html = f'<div style="{_AROUND}">{left}<div>{name}{table}</div></div>'
    return html.encode(errors="replace").decode()  # names of files may be no text


def _short(text: str) -> str:
    return text if len(text) <= _MOST_TEXT else text[: _MOST_TEXT - 1] + "…"


@singledispatch
def _picture_of(result: Any) -> Picture | None:
    """Return a picture of what has cells, or triangles in the plane; of others none."""
    if isinstance(cells := getattr(result, "cells", None), ClippedCells):
        return _picture_of(cells)
    if hasattr(result, "ridge_ends"):  # of liftmesh.scipy, which loads SciPy
        return _diagram(result)
    points, faces = getattr(result, "points", None), getattr(result, "simplices", None)
    if not (isinstance(points, np.ndarray) and points.ndim == 2 and isinstance(faces, np.ndarray)):
        return None
    is_planar = points.shape[1] == 2 and faces.ndim == 2 and faces.shape[1] == 3
    return pictures.mesh(points, faces) if is_planar else None


@_picture_of.register
def _(result: Cloud) -> Picture | None:
    if result.faces is not None and 0 < len(result.faces) <= pictures.MOST:
        return pictures.solid(result.points, result.faces)
    colors = None if result.colors is None else as_uint8(result.colors)
    return pictures.dots(result.points[:, :2], result.points[:, 2], colors)


@_picture_of.register
def _(result: Surface) -> Picture | None:
    box = Box(result.bounds)
    return Picture(pictures.image(pictures.relief(result.sample(box.grid()))))


@_picture_of.register
def _(result: Raster) -> Picture | None:
    every = max(1, -(-max(result.values.shape) // pictures.SIDE))
    values = result.values[::every, ::every]
    if not values.size:
        return None
    pixels = pictures.relief(values, shaded=result.quantity == "height")
    note = f"one pixel in {every} x {every}" if every > 1 else ""
    return Picture(pictures.image(pixels, coarse=True), note)


@_picture_of.register
def _(result: Triangulation) -> Picture | None:
    return pictures.mesh(result.points, result.simplices, getattr(result, "constraints", None))


@_picture_of.register
def _(result: RefineResult) -> Picture | None:
    return _picture_of(result.triangulation)


@_picture_of.register
def _(result: ClippedCells) -> Picture | None:
    rows = pictures.nearest(result.points)
    parts, rings, starts = result.parts, result.rings, result.ring_corners
    part = places(parts[rows], parts[rows + 1] - parts[rows])
    ring = places(rings[part], rings[part + 1] - rings[part])[: 2 * pictures.MOST]
    shapes = [result.corners[starts[k] : starts[k + 1]] for k in ring.tolist()]
    box = Box(planar_bounds(np.concatenate([*shapes, np.empty((0, 2))])), margin=4)
    sites = pictures.path(box, result.points[rows][:, None], **pictures.DOT)
    drawn = pictures.path(box, shapes, closed=True, **pictures.PALE)
    note = pictures.part_of(len(rows), len(result.points), "cells")
    return Picture(pictures.svg(box, drawn, sites), note)


@_picture_of.register
def _(result: Unclipped) -> Picture | None:
    return _diagram(result)


def _diagram(result: Any) -> Picture:
    rows = pictures.nearest(result.points)
    box = Box(planar_bounds(result.points[rows]), margin=16)
    is_near = np.zeros(len(result.points), np.bool_)
    is_near[rows] = True
    ridges = (result.ridge_ends >= 0).all(axis=1) & is_near[result.ridge_points].any(axis=1)
    ends = result.vertices[result.ridge_ends[ridges][: 4 * pictures.MOST]]
    sites = pictures.path(box, result.points[rows][:, None], **pictures.DOT)
    note = pictures.part_of(len(rows), len(result.points), "cells")
    return Picture(pictures.svg(box, pictures.path(box, ends, **pictures.THIN), sites), note)


@_picture_of.register
def _(result: Tetrahedralization) -> Picture | None:
    return pictures.solid(result.points, result.convex_hull)


@_picture_of.register
def _(result: HullMesh) -> Picture | None:
    mesh = result.to_cloud()
    points = np.array(mesh.points)
    if isinstance(result, LowerHull):  # squares of lengths, as high as half of their width
        points[:, 2] *= 0.5 * np.ptp(points[:, :2]) / np.ptp(points[:, 2])
    return None if mesh.faces is None else pictures.solid(points, mesh.faces)


@_picture_of.register
def _(result: Contours) -> Picture | None:
    return pictures.polylines(result.points, result.starts, result.is_index)


@_picture_of.register
def _(result: FilledContours) -> Picture | None:
    return pictures.polylines(result.points, result.rings)


@_picture_of.register
def _(result: Triangulations) -> Picture | None:
    """Sets overlap."""


@_picture_of.register
def _(result: AlphaShape) -> Picture | None:
    if result.points.shape[1] == 2:
        return pictures.mesh(result.points, result.simplices)
    return pictures.solid(result.points, result.faces)


@_picture_of.register
def _(result: Profile) -> Picture | None:
    places = np.column_stack([result.distances, result.points[:, 2]])
    return pictures.polylines(places, result.starts, to_scale=False)


@_picture_of.register
def _(result: Report) -> Picture | None:
    return Picture(pictures.bars([getattr(result, f"n_{use}") for use in USES], _USE_COLORS))


@_picture_of.register
def _(result: Certificate) -> Picture | None:
    """Mark where flaws are, or say by a sign that there are none."""
    found = [point[:2] for flaw in result.flaws for each in flaw.first for point in each.points]
    marks = np.array(found, float).reshape(-1, 2)
    if len(marks := marks[np.isfinite(marks).all(axis=1)]):
        box = Box(planar_bounds(marks), margin=12)
        cross = {**pictures.DOT, "stroke-width": 8}
        return Picture(pictures.svg(box, pictures.path(box, marks[:, None], **cross)), "flaws")
    sign, color = (
        ("M14 25l8 8 15-17", "#3a9274") if result.valid else ("M16 16l18 18m0-18L16 34", ACCENT)
    )
    around = pictures.element(
        "circle", cx=25, cy=25, r=22, fill="none", stroke=color, stroke_width=3
    )
    drawn = pictures.element("path", d=sign, fill="none", stroke=color, stroke_width=4)
    size = 'width="50" height="50"'
    return Picture(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{around}{drawn}</svg>')


@_picture_of.register
def _(result: TiledData) -> Picture | None:
    cuts, bounds = cuts_of(result)
    box = Box(bounds, margin=2)
    left, low, right, high = bounds
    frame = np.array([[left, low], [right, low], [right, high], [left, high]])
    shown = cuts[: 2 * pictures.MOST]
    lines = pictures.path(box, shown, **pictures.STRONG)
    return Picture(
        pictures.svg(box, pictures.path(box, [frame], closed=True, **pictures.PALE), lines)
    )
