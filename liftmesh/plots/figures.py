"""The figures of results, as cards in notebooks have them: a name and a text each, with units.

What has none of its own here has its plain fields.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import singledispatch
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import planar_bounds
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import counted
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.voronoi import Unclipped
from liftmesh.crs.description import crs_name
from liftmesh.crs.units import planar_unit
from liftmesh.io.write import WriteResult
from liftmesh.planar.certificate import Certificate
from liftmesh.planar.triangulation import Triangulation
from liftmesh.raster.raster import Raster
from liftmesh.space.tetrahedralization import Tetrahedralization
from liftmesh.terrain.accuracy import Accuracy, table
from liftmesh.terrain.contours import Contours
from liftmesh.terrain.profile import Profile
from liftmesh.terrain.report import Report
from liftmesh.terrain.surface import Surface
from liftmesh.terrain.surface_data import unit_names
from liftmesh.tiles.tiled_data import TiledData, TiledSurfaceData, box_of

USES = ("used", "duplicates", "overhangs", "skipped", "hidden", "unused")
"""What becomes of rows: counts of a report."""


@singledispatch
def figures_of(result: Any) -> dict[str, str]:
    """Return the fields that are numbers or words, and the shapes of arrays."""
    if hasattr(result, "ridge_ends"):  # of liftmesh.scipy, which loads SciPy
        return _of_diagram(result)
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


@figures_of.register
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


@figures_of.register
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


@figures_of.register
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


@figures_of.register
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


@figures_of.register
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


@figures_of.register
def _(result: Unclipped) -> dict[str, str]:
    return {
        "cells": _number(len(result.region_vertices[0]) - 1),
        **_of_diagram(result),
    }


def _of_diagram(result: Any) -> dict[str, str]:
    return {
        "rows": _number(len(result.points)),
        "vertices": _number(len(result.vertices)),
        "ridges": _number(len(result.ridge_points)),
        **_spans(result.points, None),
    }


@figures_of.register
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


@figures_of.register
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


@figures_of.register
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


@figures_of.register
def _(result: Report) -> dict[str, str]:
    uses = {use: getattr(result, f"n_{use}") for use in USES}
    return {
        "rows": _number(result.n_rows),
        "triangles": _number(result.n_triangles),
        **{use: _number(count) for use, count in uses.items() if count or use == "used"},
        "policy": result.policy,
        "seconds": _number(sum(result.seconds.values())) if result.seconds else "",
    }


@figures_of.register
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


@figures_of.register
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


@figures_of.register
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


@figures_of.register
def _(result: Accuracy) -> dict[str, str]:
    return dict(table(result))
