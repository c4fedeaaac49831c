"""The layers of pages: what is drawn of surfaces, triangulations, cells, tetrahedra and clouds."""

from __future__ import annotations

from dataclasses import replace
from functools import singledispatch
from typing import Any, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import edges_of_faces, used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import as_uint8
from liftmesh.base.options import counted
from liftmesh.cells.clipped import ClippedCells
from liftmesh.errors import InputError
from liftmesh.io.registry import as_cloud
from liftmesh.pages.page import Kind, Layer, Palette, Values
from liftmesh.planar.lifting import HullMesh, LowerHull
from liftmesh.planar.triangulation import Triangulation
from liftmesh.space.tetrahedralization import Tetrahedralization
from liftmesh.terrain.difference import difference
from liftmesh.terrain.simplification import simplify
from liftmesh.terrain.surface import Surface

MOST_FACES = 1_000_000  # of a surface
MOST_CELLS = 4_000_000  # of anything else, as are lines of it: a page of some 100 MB
MOST_POINTS = 2_000_000  # of a cloud: a page of some 40 MB
_MOST_VALUES = 12
_ROW = "row of the surface"
_TURNS = 128  # of the paraboloid
_SHARES = np.linspace(0, 1, 65)  # of its height
_CIRCLES = slice(8, None, 8)
_MARGIN = 0.04  # of its radius beyond the points
_MOST_FALLS = 4000  # lines between points and their lifts


@singledispatch
def layers_of(shown: Any, name: str) -> list[Layer]:
    """Return the layers of a result, or of what `as_cloud` takes."""
    return _of_cloud(as_cloud(shown), name)


@layers_of.register
def _(shown: Surface, name: str) -> list[Layer]:
    rows = shown.attributes.get(_ROW)
    if rows is None:
        return _of_cloud(shown.to_cloud(), name)
    done = shown.metadata["simplification"]
    note = f"simplified from {done['n_positions']:,} points: heights within {done['error']:.3g}"
    first, *others = _of_cloud(shown.to_cloud(), name, note=note)
    values = [each for each in first.values if each.name != _ROW]
    return [
        replace(first, rows=rows if first.rows is None else rows[first.rows], values=values),
        *others,
    ]


@layers_of.register
def _(shown: HullMesh, name: str) -> list[Layer]:
    return _of_cloud(shown.to_cloud(), name, "values")


@layers_of.register
def _(shown: LowerHull, name: str) -> list[Layer]:
    if shown.apex is None or not len(shown.faces):
        return _of_cloud(shown.to_cloud(), name, "values")
    return _lift(shown.vertices, shown.faces, shown.apex, name)


class Mesh(NamedTuple):
    """Tetrahedra of a file."""

    points: Floats
    simplices: Rows


@layers_of.register
def _(shown: Mesh, name: str) -> list[Layer]:
    layer = _tetrahedra(*shown, name)
    return [replace(layer, neighbors=_neighbors(np.asarray(layer.cells)))]


@layers_of.register
def _(shown: Tetrahedralization, name: str) -> list[Layer]:
    layer = _tetrahedra(shown.points, shown.simplices, name)
    return [replace(layer, neighbors=shown.neighbors)]


def _tetrahedra(points: Floats, simplices: Rows, name: str) -> Layer:
    return _part(Cloud(points), name, "tetrahedra", simplices, style={"wires": True, "shade": 0.6})


@layers_of.register
def _(shown: Triangulation, name: str) -> list[Layer]:
    points = _flat(shown.points)
    style = {"shade": 0, "value": "plain", "wires": True, "color": "#dfe6d8", "above": True}
    forced = getattr(shown, "constraints", None)
    lines = [] if forced is None else [_lines(points, forced, "constraints", "#b3261e")]
    edges = [replace(each, style={**each.style, "above": True}) for each in lines]
    return [_part(Cloud(points), name, "faces", shown.simplices, style=style), *edges]


@layers_of.register
def _(shown: ClippedCells, name: str) -> list[Layer]:
    rings, corner = shown.ring_corners, np.arange(len(shown.corners))
    following = corner + 1
    following[rings[1:] - 1] = rings[:-1]
    rows = np.flatnonzero(np.isfinite(shown.points).all(axis=1)).astype(np.int32)
    style = {"color": "#c2410c", "size": 5, "above": True}
    sides = _lines(_flat(shown.corners), np.column_stack([corner, following]), name, "#3b7dbd")
    return [
        replace(sides, style={**sides.style, "above": True}),
        Layer(f"sites of {name}", "points", _flat(shown.points[rows]), rows=rows, style=style),
    ]


def with_change(layers: list[Layer], before: Any, after: Any) -> list[Layer]:
    """Show, in place of two surfaces that overlap, how much the second is higher."""
    if not (isinstance(before, Surface) and isinstance(after, Surface)):
        return layers
    try:
        rises = difference(after, before)
    except InputError as error:  # they do not overlap, or stand on other planes
        return [replace(layers[0], note=f"{layers[0].note} {error}".strip()), *layers[1:]]
    amounts = rises.frame.heights(rises.vertices)
    heights = after.sample(rises.triangulation.points, extrapolate="nearest")
    placed = Cloud(rises.frame.raised(rises.vertices, amounts, heights))
    layer = _part(placed, "how much the second is higher", "faces", rises.faces)
    numbers = amounts if layer.rows is None else amounts[layer.rows]
    rise = replace(layer, values=[Values("rise", numbers, palette="difference")])
    return [rise, *(replace(each, style={**each.style, "visible": False}) for each in layers)]


def bounded(shown: Any) -> Any:
    """Return a surface of no more faces than a page can show, with the rows that it has."""
    if not isinstance(shown, Surface) or len(shown.faces) <= MOST_FACES:
        return shown
    rows = np.arange(len(shown.vertices), dtype=np.int32)
    return simplify(shown.with_attributes({_ROW: rows}), max_points=MOST_FACES // 2)


def check_size(layers: list[Layer]) -> None:
    """Raise if a page of these would be too large for a browser."""
    for layer in layers:
        count = len(layer.points if layer.cells is None else layer.cells)
        if count > MOST_CELLS:
            raise InputError(
                f"{layer.name} has {count:,} {layer.kind}, and a page holds {MOST_CELLS:,}: give a "
                "part of it, or a surface, which is simplified"
            )


def _of_cloud(cloud: Cloud, name: str, palette: Palette = "terrain", **more: Any) -> list[Layer]:
    """Return the layers of a mesh, or of points: what is not finite is left out."""
    ends = cloud.edges
    edges = [] if ends is None else [_lines(cloud.points, ends, "edges", "#b3261e")]
    if cloud.faces is not None:
        return [_part(cloud, name, "faces", cloud.faces, palette, **more), *edges]
    shown = np.flatnonzero(np.isfinite(cloud.points).all(axis=1))
    every = -(-len(shown) // MOST_POINTS)
    if every > 1:
        more["note"] = f"one in {every} of {len(shown):,} points"
        shown = shown[::every]
    return [_layer(cloud, name, "points", shown, palette, style={"size": 3}, **more), *edges]


def _part(
    cloud: Cloud, name: str, kind: Kind, cells: Array, palette: Palette = "values", **more: Any
) -> Layer:
    """Return the layer of some cells of a cloud, with the points that they use."""
    is_known = np.isfinite(cloud.points).all(axis=1).take(cells).all(axis=1)
    if not is_known.all():
        left_out = counted(int(np.count_nonzero(~is_known)), "cell")
        more["note"] = f"without {left_out} at points that are not finite"
    used, own = _used(cells[is_known], len(cloud.points))
    return _layer(cloud, name, kind, used, palette, cells=own, **more)


def _used(cells: Array, count: int) -> tuple[Array, Array]:
    """Return the points that cells use, and the cells as rows of these."""
    used = used_rows(count, cells)
    place = np.zeros(count, np.int32)
    place[used] = np.arange(len(used), dtype=np.int32)
    return used, place[cells]


def _lines(points: Floats, ends: Array, name: str, color: str, opacity: float = 1.0) -> Layer:
    """Return a layer of lines between points."""
    used, own = _used(ends[np.isfinite(points).all(axis=1).take(ends).all(axis=1)], len(points))
    return Layer(name, "lines", points[used], own, style={"color": color, "opacity": opacity})


def _layer(
    cloud: Cloud, name: str, kind: Kind, used: Array, palette: Palette, **more: Any
) -> Layer:
    """Return the layer of some points of a cloud."""
    colors = None if cloud.colors is None else as_uint8(cloud.colors[used, :3])
    rows = None if len(used) == len(cloud.points) else used
    values = [Values("height", palette=palette), *_values(cloud, used)]
    return Layer(name, kind, cloud.points[used], rows=rows, colors=colors, values=values, **more)


def _values(cloud: Cloud, used: Array) -> list[Values]:
    """Those with one number for each point."""
    named = cloud.attributes.items()
    numbers = [(name, each) for name, each in named if each.ndim == 1 and each.dtype.kind in "biuf"]
    return [Values(name, each[used]) for name, each in numbers[:_MOST_VALUES]]


def _flat(points: Floats, height: float = 0.0) -> Floats:
    """Put points of the plane into space."""
    return np.column_stack([points[:, :2], np.full(len(points), height)])


def _lift(vertices: Floats, faces: Rows, apex: tuple[float, float], name: str) -> list[Layer]:
    """Return the hull of lifted points on its paraboloid, and its shadow."""
    used, faces = _used(faces, len(vertices))
    lifted = vertices[used]
    edges, rows = edges_of_faces(faces), np.arange(len(used), dtype=np.int32)
    height, width = np.ptp(lifted[:, 2]), np.ptp(lifted[:, :2], axis=0).max()
    shadow = _flat(lifted, lifted[:, 2].min() - 0.45 * height)
    hull = {
        "stretch": float(0.55 * width / height) if height else 1.0,
        "rises": True,
        "shade": 0.35,
    }
    layers = [
        Layer(name, "faces", lifted, faces, rows=used, values=[Values("height")], style=hull),
        _lines(lifted, edges, "edges of the hull", "#14232b", 0.7),
        _lines(shadow, edges, "its shadow: the Delaunay triangulation", "#b4471b"),
        Layer("points", "points", shadow, rows=used, style={"color": "#7c2d12", "size": 6}),
        Layer("lifted points", "points", lifted, rows=used, style={"color": "#14232b", "size": 6}),
        *_paraboloid(lifted, apex),
    ]
    if len(used) <= _MOST_FALLS:
        both, falls = np.concatenate([lifted, shadow]), np.column_stack([rows, rows + len(used)])
        layers.append(_lines(both, falls, "from points to their lifts", "#64748b", 0.4))
    return layers


def _neighbors(simplices: Array) -> Rows:
    """Find the tetrahedron beyond each facet; -1 where there is none, or more than one."""
    facets = np.stack([np.delete(simplices, k, axis=1) for k in range(4)], axis=1).reshape(-1, 3)
    facets = np.sort(facets, axis=1)
    order = np.lexsort(facets.T)
    is_same = (facets[order[1:]] == facets[order[:-1]]).all(axis=1)
    runs = np.concatenate([[False], is_same, [False]])
    is_pair = is_same & ~runs[:-2] & ~runs[2:]
    found = np.full(len(facets), -1, np.int32)
    first, second = order[:-1][is_pair], order[1:][is_pair]
    found[first], found[second] = second // 4, first // 4
    return found.reshape(-1, 4)


def _paraboloid(lifted: Floats, apex: tuple[float, float]) -> list[Layer]:
    """Return a patch around the apex that reaches beyond all points, and circles on it."""
    radius = (1 + _MARGIN) * float(np.hypot(*(lifted[:, :2] - apex).T).max())
    turn, r = np.meshgrid(np.linspace(0, 2 * np.pi, _TURNS + 1)[:-1], radius * np.sqrt(_SHARES))
    place = [apex[0] + r * np.cos(turn), apex[1] + r * np.sin(turn), r * r]
    points = np.column_stack([each.ravel() for each in place])
    number = np.arange(points.shape[0]).reshape(r.shape)
    beside = np.roll(number, -1, axis=1)
    corners = number[:-1], number[1:], beside[:-1], beside[1:]
    low, high, low_beside, high_beside = (each.ravel() for each in corners)
    faces = np.concatenate(
        [np.column_stack([low, high, low_beside]), np.column_stack([low_beside, high, high_beside])]
    )
    circles = np.column_stack([number[_CIRCLES].ravel(), beside[_CIRCLES].ravel()])
    style = {"color": "#8fb8de", "opacity": 0.16, "pick": False, "shade": 0, "wires": False}
    return [
        Layer("paraboloid", "faces", points, faces.astype(np.int32), style=style),
        _lines(points, circles, "circles on it", "#6d9cc7", 0.55),
    ]
