"""`card`: what notebooks show of a result: a small picture, and its figures in a table.

Two tables say it all: `_picture_of` has the picture of each type, and `_figures_of` its figures;
what is in neither shows its plain fields. Colours are those of the text around, but for accents
that are seen on light and on dark; there is no script and no style sheet, and all text is escaped.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import singledispatch
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import planar_bounds
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import as_uint8
from liftmesh.base.options import counted
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.voronoi import Unclipped
from liftmesh.crs.description import crs_name
from liftmesh.crs.units import planar_unit
from liftmesh.errors import LiftmeshError
from liftmesh.io.columns import places
from liftmesh.io.write import WriteResult
from liftmesh.planar.alpha import AlphaShape
from liftmesh.planar.certificate import Certificate
from liftmesh.planar.lifting import HullMesh, LowerHull
from liftmesh.planar.many import Triangulations
from liftmesh.planar.refined import RefineResult
from liftmesh.planar.triangulation import Triangulation
from liftmesh.plots import pictures
from liftmesh.plots.drawing import ACCENT
from liftmesh.plots.pictures import Box, Picture
from liftmesh.raster.raster import Raster
from liftmesh.space.convex_hull import ConvexHull
from liftmesh.space.tetrahedralization import Tetrahedralization
from liftmesh.terrain.accuracy import Accuracy, table
from liftmesh.terrain.contours import Contours
from liftmesh.terrain.filled import FilledContours
from liftmesh.terrain.profile import Profile
from liftmesh.terrain.report import Report
from liftmesh.terrain.surface import Surface
from liftmesh.terrain.surface_data import unit_names
from liftmesh.tiles.tiled_data import TiledData, TiledSurfaceData, box_of, cuts_of

_MOST_ROWS, _MOST_TEXT = 16, 100
_CELL = 'style="text-align:left;padding:1px 12px 1px 0;border:0;vertical-align:top"'
_AROUND = (
    "display:flex;flex-wrap:wrap;gap:16px;align-items:flex-start;margin:4px 0;"
    "font:13px/1.45 system-ui,sans-serif"
)
_USES = ("used", "duplicates", "overhangs", "skipped", "hidden", "unused")
_USE_COLORS = (pictures.GREEN, "#cdbb79", "#d68c45", ACCENT, "#8a7fb5", "#8f8f8f")


def card(result: Any) -> str:
    """Return HTML of less than 100 kB, in which no name or value is markup."""
    picture = _picture_of(result)
    figures = {name: text for name, text in _figures_of(result).items() if text}
    rows = "".join(
        f"<tr><td {_CELL}>{escape(name)}</td><td {_CELL}>{escape(_short(text))}</td></tr>"
        for name, text in [*figures.items()][:_MOST_ROWS]
    )
    html, note = ("", "") if picture is None else picture
    small = f'<div style="max-width:{pictures.SIDE}px">{escape(note)}</div>' if note else ""
    left = f"<div>{html}{small}</div>" if html else ""
    name = f"<b>{escape(type(result).__name__)}</b>"
    table = f'<table style="border-collapse:collapse;margin:0;font:inherit">{rows}</table>'
    return f'<div style="{_AROUND}">{left}<div>{name}{table}</div></div>'


def _short(text: str) -> str:
    return text if len(text) <= _MOST_TEXT else text[: _MOST_TEXT - 1] + "…"


@singledispatch
def _picture_of(result: Any) -> Picture | None:
    """Return a picture of what has cells, or triangles in the plane; of others none."""
    if isinstance(cells := getattr(result, "cells", None), ClippedCells):
        return _picture_of(cells)
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
    if not box.is_known:
        return None
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
    if not box.is_known:
        return None
    sites = pictures.path(box, result.points[rows][:, None], **pictures.DOT)
    drawn = pictures.path(box, shapes, closed=True, **pictures.PALE)
    note = pictures.part_of(len(rows), len(result.points), "cells")
    return Picture(pictures.svg(box, drawn, sites), note)


@_picture_of.register
def _(result: Unclipped) -> Picture | None:
    rows = pictures.nearest(result.points)
    box = Box(planar_bounds(result.points[rows]), margin=16)
    if not box.is_known:
        return None
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
def _(result: ConvexHull) -> Picture | None:
    return pictures.solid(result.points, result.faces)


@_picture_of.register
def _(result: HullMesh) -> Picture | None:
    mesh = result.to_cloud()
    points = np.array(mesh.points)
    if isinstance(result, LowerHull):  # squares of lengths, as high as half of their width
        with np.errstate(all="ignore"):
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
    return Picture(pictures.bars([getattr(result, f"n_{use}") for use in _USES], _USE_COLORS))


@_picture_of.register
def _(result: Certificate) -> Picture | None:
    """Mark where flaws are, or say by a sign that there are none."""
    found = [point[:2] for flaw in result.flaws for each in flaw.first for point in each.points]
    marks = np.array(found, float).reshape(-1, 2)
    box = Box(planar_bounds(marks), margin=12)
    if len(marks) and box.is_known:
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
    try:
        cuts, bounds = cuts_of(result)
    except (LiftmeshError, OSError):  # the folder is gone, or was changed
        return None
    box = Box(bounds, margin=2)
    if not box.is_known:
        return None
    left, low, right, high = bounds
    frame = np.array([[left, low], [right, low], [right, high], [left, high]])
    shown = cuts[: 2 * pictures.MOST]
    lines = pictures.path(box, shown, **pictures.STRONG)
    return Picture(
        pictures.svg(box, pictures.path(box, [frame], closed=True, **pictures.PALE), lines)
    )


@singledispatch
def _figures_of(result: Any) -> dict[str, str]:
    """Return the fields that are numbers or words, and the shapes of arrays."""
    if not is_dataclass(result):
        return {"": repr(result).strip("<>")}
    named = {each.name: getattr(result, each.name) for each in fields(result)}
    return {
        name.replace("_", " "): text
        for name, value in named.items()
        if not name.startswith("_") and (text := _plain(value))
    }


def _plain(value: Any) -> str:
    """Say a value in a few words, if it is one of a few kinds."""
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, int | float | np.number):
        return _number(value)
    if isinstance(value, str | Path):
        return str(value)
    if isinstance(value, np.ndarray):
        return f"{' x '.join(f'{each:,}' for each in value.shape)} {value.dtype}"
    if isinstance(value, tuple) and 0 < len(value) <= 4:
        return ", ".join(map(_plain, value))
    return ""


def _number(value: Any) -> str:
    if isinstance(value, int | np.integer):
        return f"{value:,}"
    if not math.isfinite(value):
        return "none" if math.isnan(value) else str(float(value))
    if value and not 1e-3 <= abs(value) < 1e12:
        return f"{value:.6g}"
    return f"{value:,.3f}".rstrip("0").rstrip(".")


def _span(low: Any, high: Any, unit: str | None = None) -> str:
    """Say from where to where, with the unit."""
    if math.isnan(low) or math.isnan(high):
        return ""
    return f"{_number(float(low))} to {_number(float(high))}{f' {unit}' if unit else ''}"


def _spans(points: Floats, unit: str | None) -> dict[str, str]:
    """Say from where to where points are."""
    left, low, right, high = planar_bounds(points)
    return {"x": _span(left, right, unit), "y": _span(low, high, unit)}


def _heights(values: Array, unit: str | None) -> str:
    known = values[np.isfinite(values)]
    return _span(known.min(), known.max(), unit) if known.size else "none"


def _system(crs: str | None) -> dict[str, str]:
    return {} if crs is None else {"coordinate system": crs_name(crs)}


@_figures_of.register
def _(result: Cloud) -> dict[str, str]:
    unit = planar_unit(result.crs)
    named = ", ".join([*result.attributes][:9])
    return {
        "points": _number(len(result)),
        "faces": "" if result.faces is None else _number(len(result.faces)),
        "edges": "" if result.edges is None else _number(len(result.edges)),
        **_spans(result.points[:, :2], unit),
        "z": _heights(result.points[:, 2], None),
        "colors": ""
        if result.colors is None
        else f"{result.colors.shape[1]} x {result.colors.dtype}",
        "values": named,
        **_system(result.crs),
    }


@_figures_of.register
def _(result: Surface) -> dict[str, str]:
    left, low, right, high = result.bounds
    x, z = unit_names(result)
    return {
        "triangles": _number(len(result.faces)),
        "vertices": _number(len(result.vertices)),
        "x": _span(left, right, x),
        "y": _span(low, high, x),
        "height": _heights(result.frame.heights(result.vertices), z),
        "rows in no face": _number(len(result.report.left_out))
        if len(result.report.left_out)
        else "",
        "values": ", ".join([*result.attributes][:9]),
        "plane": "" if result.frame.name == "xy" else result.frame.name,
        **_system(result.crs),
    }


@_figures_of.register
def _(result: Triangulation) -> dict[str, str]:
    forced, hidden = getattr(result, "constraints", None), getattr(result, "hidden", None)
    return {
        "triangles": _number(result.nsimplex),
        "rows": _number(result.npoints),
        "constraints": "" if forced is None else _number(len(forced)),
        "duplicates": _number(len(result.duplicates)),
        "hidden": "" if hidden is None else _number(len(hidden)),
        "skipped": _number(len(result.skipped)),
        **_spans(result.points, None),
    }


@_figures_of.register
def _(result: Tetrahedralization) -> dict[str, str]:
    return {
        "tetrahedra": _number(len(result.simplices)),
        "points": _number(len(result.points)),
        "facets of the hull": _number(len(result.convex_hull)),
        "duplicates": _number(len(result.duplicates)),
        "skipped": _number(len(result.skipped)),
        **_spans(result.points[:, :2], None),
        "z": _heights(result.points[:, 2], None),
    }


@_figures_of.register
def _(result: ClippedCells) -> dict[str, str]:
    return {
        "rows": _number(len(result.points)),
        "with an area": _number(int(np.count_nonzero(np.diff(result.parts)))),
        "duplicates": _number(len(result.duplicates)),
        "hidden": _number(len(result.hidden)),
        "corners": _number(len(result.corners)),
        "domain": result.domain.text,
        **_spans(result.domain.corners, planar_unit(result.crs)),
        **_system(result.crs),
    }


@_figures_of.register
def _(result: Unclipped) -> dict[str, str]:
    return {
        "rows": _number(len(result.points)),
        "cells": _number(len(result.region_vertices[0]) - 1),
        "vertices": _number(len(result.vertices)),
        "ridges": _number(len(result.ridge_points)),
        **_spans(result.points, None),
    }


@_figures_of.register
def _(result: Raster) -> dict[str, str]:
    rows, columns = result.values.shape
    a, b, _, d, e, _ = result.transform
    left, low, right, high = result.bounds
    unit, empty = planar_unit(result.crs), int(np.count_nonzero(~np.isfinite(result.values)))
    size = f"{_number(math.hypot(a, d))} x {_number(math.hypot(b, e))}{f' {unit}' if unit else ''}"
    return {
        "pixels": f"{columns:,} x {rows:,}",
        "size of a pixel": size,
        result.quantity: _heights(result.values, result.unit),
        "without a value": _number(empty) if empty else "",
        "x": _span(left, right, unit),
        "y": _span(low, high, unit),
        **_system(result.crs),
    }


@_figures_of.register
def _(result: Contours) -> dict[str, str]:
    unit = planar_unit(result.crs)
    levels = np.unique(result.levels)
    return {
        "lines": _number(len(result)),
        "closed": _number(int(np.count_nonzero(result.closed))),
        "levels": f"{len(levels):,}, {_heights(levels, None)}" if len(levels) else "0",
        "points": _number(len(result.points)),
        **_spans(result.points, unit),
        **_system(result.crs),
    }


@_figures_of.register
def _(result: Profile) -> dict[str, str]:
    unit = planar_unit(result.crs)
    across = "distance" if result.stations is None else "offset"
    return {
        "lines": _number(len(np.unique(result.lines))),
        "parts": _number(len(result.lines)),
        "points": _number(len(result.points)),
        across: _heights(result.distances, unit),
        "height": _heights(result.points[:, 2], None),
        **_system(result.crs),
    }


@_figures_of.register
def _(result: Report) -> dict[str, str]:
    uses = {use: getattr(result, f"n_{use}") for use in _USES}
    return {
        "rows": _number(result.n_rows),
        "triangles": _number(result.n_triangles),
        **{use: _number(count) for use, count in uses.items() if count or use == "used"},
        "policy": result.policy,
        "seconds": _number(sum(result.seconds.values())) if result.seconds else "",
    }


@_figures_of.register
def _(result: WriteResult) -> dict[str, str]:
    return {
        "file": "" if result.path is None else str(result.path),
        "format": result.format,
        "bytes": _number(result.bytes),
        "origin": "" if result.origin is None else _plain(tuple(result.origin)),
        "not kept": ", ".join(result.dropped),
        "renamed": ", ".join(f"{old} to {new}" for old, new in result.renamed),
        "scale, offset": "" if result.scaling is None else _plain(result.scaling),
    }


@_figures_of.register
def _(result: Certificate) -> dict[str, str]:
    def count(value: int | None) -> str:
        return "" if value is None else _number(value)

    return {
        "valid": _plain(result.valid),
        "canonical": _plain(result.canonical),
        "member": result.member,
        "rows": _number(result.n_rows),
        "vertices": count(result.n_vertices),
        "triangles" if result.dimension == 2 else "tetrahedra": _number(result.n_triangles),
        "duplicates": count(result.n_duplicates),
        "skipped": _number(result.n_skipped),
        **{flaw.kind.replace("_", " "): flaw.text for flaw in result.flaws},
    }


@_figures_of.register
def _(result: TiledData) -> dict[str, str]:
    manifest: Mapping[str, Any] = result.manifest
    said = {
        "triangles": _number(result.nsimplex),
        "rows": _number(result.npoints),
        "shards": _number(len(result.shards)),
        "duplicates": _number(manifest["duplicates"]),
        "skipped": _number(manifest["skipped"]),
        "source": counted(len(manifest["source"]), "file"),
        "folder": str(result.folder),
    }
    if isinstance(result, TiledSurfaceData):
        west, south, bottom, east, north, top = box_of(result)
        x, z = unit_names(result)
        said |= {"x": _span(west, east, x), "y": _span(south, north, x)}
        said |= {"height": _span(bottom, top, z), **_system(result.crs)}
    return said


@_figures_of.register
def _(result: Accuracy) -> dict[str, str]:
    return dict(table(result))
