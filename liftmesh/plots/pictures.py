"""Small pictures for notebooks: SVG and PNG as text of HTML, made without matplotlib.

Lines and dots are SVG in the colour of the text around them, so that they are seen on light and on
dark; heights are PNG, transparent where there are none. A picture of many things shows a part of
them, and says so. So each has a bounded size, and takes a few passes over the data at most. Whoever
calls lets NumPy compute with what is too large, or no number.
"""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import planar_bounds
from liftmesh.plots.drawing import ACCENT, TERRAIN

SIDE = 200  # pixels of the longer side
_SHORT = 40  # of the shorter one, at least
_MOST_BYTES = 60_000  # of a PNG: noise is drawn with fewer pixels
MOST = 400  # faces or cells; of more those in the middle
_MOST_DOTS = 800
_MOST_SAMPLED = 100_000  # rows of a cloud
_MOST_PLACES = 6_000  # of lines, which are drawn by as coarse pixels as they need
_COARSE = (1, 2, 4)
_MARGIN = 4  # pixels around lines
GREEN = "#2f8f76"
_TURN, _TILT = np.radians([-30.0, 25.0])  # how solids are seen
_COLORS = np.array([[int(x[k : k + 2], 16) for k in (1, 3, 5)] for x in TERRAIN[:-1]])  # no white
_GREY = np.array([143, 143, 143], np.uint8)
_INK = {"fill": "none", "stroke": "currentColor"}
THIN: dict[str, Any] = {**_INK, "stroke-width": 0.6, "stroke-opacity": 0.75}
PALE: dict[str, Any] = {**THIN, "fill": "currentColor", "fill-opacity": 0.06}
STRONG: dict[str, Any] = {"fill": "none", "stroke": ACCENT, "stroke-width": 1.6}
DOT: dict[str, Any] = {"stroke": ACCENT, "stroke-width": 3, "stroke-linecap": "round"}


class Picture(NamedTuple):
    """HTML, and what part of the result it shows, if it is a part."""

    html: str
    note: str = ""


class UnseenError(Exception):
    """There is nothing to see: no place is finite, or they are farther apart than the doubles."""


class Box:
    """Where places are on a picture: to scale, unless they are much wider than high."""

    def __init__(self, bounds: Sequence[float], *, to_scale: bool = True, margin: int = 0) -> None:
        left, low, right, high = bounds
        size = np.maximum([right - left, high - low], 0)
        least = max(abs(left), abs(low), 1.0) * 1e-9
        step = np.maximum(size / (SIDE - 2 * margin), least if size.max() <= 0 else 0)
        step = np.full(2, step.max()) if to_scale else np.where(step > 0, step, 1)
        inner = size / step
        if not np.isfinite(inner).all():
            raise UnseenError
        shape = np.maximum(inner + 2 * margin, [_SHORT, _SHORT])
        self.shape = shape if to_scale else np.array([SIDE, SIDE * 0.6])
        self.step = step if to_scale else step * [1, 1 / 0.55]
        self._middle = np.array([left + size[0] / 2, low + size[1] / 2])

    def pixels(self, places: Floats) -> Floats:
        """Return x from the left and y from the top."""
        away = (places - self._middle) / self.step
        placed: Floats = away * [1, -1] + self.shape / 2
        return placed

    def grid(self) -> Floats:
        """Return the places at the middles of pixels, (rows, columns, 2)."""
        columns, rows = np.ceil(self.shape).astype(int)
        x = self._middle[0] + (np.arange(columns) + 0.5 - self.shape[0] / 2) * self.step[0]
        y = self._middle[1] - (np.arange(rows) + 0.5 - self.shape[1] / 2) * self.step[1]
        return np.stack(np.meshgrid(x, y), axis=-1)


def svg(box: Box, *shapes: str) -> str:
    """Put shapes into a picture."""
    width, height = np.ceil(box.shape).astype(int).tolist()
    size = f'width="{width}" height="{height}" viewBox="0 0 {width} {height}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(shapes)}</svg>'


def path(box: Box, parts: Iterable[Floats], *, closed: bool = False, **style: Any) -> str:
    """Draw polylines, or polygons; those of one place are dots."""
    end = "z" if closed else ""
    words = []
    for part in parts:
        places = np.round(box.pixels(part), 1)
        if np.isfinite(places).all() and len(places):
            (x, y), *others = np.clip(places, -9999, 9999).tolist()
            line = "".join(f"L{x:g} {y:g}" for x, y in others) or "h0"
            words.append(f"M{x:g} {y:g}{line}{end}")
    return element("path", d="".join(words), **style) if words else ""


def element(name: str, **attributes: Any) -> str:
    """Write an element without content; underscores in names of attributes are hyphens."""
    said = " ".join(f'{key.replace("_", "-")}="{value}"' for key, value in attributes.items())
    return f"<{name} {said}/>"


def image(pixels: Array, *, coarse: bool = False) -> str:
    """Put pixels of red, green, blue and opacity into a picture."""
    height, width = pixels.shape[:2]
    pixels = pixels & np.array([0xF8] * 3 + [0xFF], np.uint8)  # without bits that nobody sees
    grown = max(1.0, SIDE / max(height, width)) if coarse else 1.0
    while len(data := png(pixels)) > _MOST_BYTES:
        pixels = pixels[::2, ::2]
    source = f"data:image/png;base64,{base64.b64encode(data).decode()}"
    size = f'width="{grown * width:.0f}" height="{grown * height:.0f}"'
    style = "image-rendering:pixelated;max-width:none"
    return f'<img alt="" src="{source}" {size} style="{style}"/>'


def png(pixels: Array) -> bytes:
    """Write a PNG of 8 bits a channel, each pixel as its difference from the one to the left."""
    height, width, channels = pixels.shape
    steps = np.diff(pixels, axis=1, prepend=np.zeros((height, 1, channels), np.uint8))
    lines = np.ones((height, 1 + width * channels), np.uint8)  # 1: such differences
    lines[:, 1:] = steps.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines.tobytes(), 6)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks
    )


def relief(heights: Array, *, shaded: bool = True) -> Array:
    """Return heights as pixels, by colour and, as slopes, by light; without any, transparent."""
    is_known = np.isfinite(heights)
    values = np.where(is_known, heights, np.nan).astype(float)
    low, high = (np.nanmin(values), np.nanmax(values)) if is_known.any() else (0.0, 0.0)
    shares = np.nan_to_num((values - low) / (high - low), nan=0.5)
    pixels = colors_of(shares)
    if shaded and min(values.shape) > 1:
        pixels = np.minimum(pixels * _light(shares, is_known)[..., None], 255)
    return np.dstack([pixels, 255.0 * is_known]).astype(np.uint8)


def colors_of(shares: Array) -> Floats:
    """Return the colours of shares of the whole height, from 0 to 1."""
    stops = np.linspace(0, 1, len(_COLORS))
    return np.stack([np.interp(shares, stops, each) for each in _COLORS.T], axis=-1)


def _light(shares: Floats, is_known: Array) -> Floats:
    """Return the light from the north-west on slopes that are made as steep as can be seen."""
    down, across = np.gradient(np.where(is_known, shares, np.nan))
    steep = np.hypot(down, across)
    known = steep[np.isfinite(steep)]
    usual = np.percentile(known, 90) if len(known) else 0.0
    factor = 0.7 / usual if usual > 0 else 0.0
    light = 0.5 * factor * (across + down) + np.sqrt(0.5)
    light /= np.sqrt(1 + (factor * steep) ** 2)
    shades: Floats = np.nan_to_num(0.5 + 0.5 * np.clip(light, 0, 1) / np.sqrt(0.5), nan=1.0)
    return shades


def dots(points: Floats, heights: Floats, colors: Array | None = None) -> Picture:
    """Draw points, few as dots and many as pixels, by height or in their own colours."""
    every = max(1, -(-len(points) // _MOST_SAMPLED))
    shown = np.flatnonzero(np.isfinite(points[::every]).all(axis=1)) * every
    places, note = points[shown], f"one in {every} of {len(points):,} rows" if every > 1 else ""
    box = Box(planar_bounds(places), margin=_MARGIN)
    if colors is None and not np.isfinite(heights[shown]).any():
        colors = np.broadcast_to(_GREY, (len(points), 3))
    if len(places) <= _MOST_DOTS:
        return Picture(svg(box, path(box, places[:, None], **{**DOT, "stroke": GREEN})), note)
    share = np.clip(np.sqrt(len(places)) / 150, 0.2, 1.0)
    columns, rows = np.ceil(box.shape * share).astype(int).tolist()
    column, row = (box.pixels(places) * share).astype(int).T
    pixel = np.clip(row, 0, rows - 1) * columns + np.clip(column, 0, columns - 1)
    count = np.bincount(pixel, minlength=rows * columns)
    if colors is None:
        pixels = relief(_means(pixel, heights[shown], count).reshape(rows, columns), shaded=False)
    else:
        means = [_means(pixel, each, count) for each in colors[shown, :3].T]
        pixels = np.stack([*means, 255.0 * (count > 0)], axis=1).reshape(rows, columns, 4)
    return Picture(image(np.nan_to_num(pixels).astype(np.uint8), coarse=True), note)


def _means(pixel: Array, values: Array, count: Array) -> Floats:
    sums: Floats = np.bincount(pixel, values, minlength=len(count)) / count
    return sums


def nearest(points: Floats, count: int = MOST) -> Array:
    """Return the numbers of the points nearest to their middle, all if there are so few."""
    if len(points) <= count:
        return np.arange(len(points))
    sample = points[:: max(1, len(points) // 10_000)]
    sample = sample[np.isfinite(sample).all(axis=1)]
    middle = np.median(sample, axis=0) if len(sample) else np.zeros(2)
    away = np.maximum(*(np.abs(points[:, k] - middle[k]) for k in range(2)))
    return np.sort(np.argpartition(away, count)[:count])


def mesh(points: Floats, faces: Rows, forced: Rows | None = None) -> Picture:
    """Draw triangles, of many those in the middle, and edges that are forced."""
    shown = faces[nearest(points.take(faces[:, 0], axis=0))]
    used = np.unique(shown)
    box = Box(planar_bounds(points[used]), margin=_MARGIN)
    shapes = [path(box, points[shown], closed=True, **PALE)]
    if forced is not None and len(forced):
        is_used = np.zeros(len(points), np.bool_)
        is_used[used] = True
        inside = forced[is_used.take(forced).all(axis=1)][: 3 * MOST]
        shapes.append(path(box, points[inside], **STRONG))
    return Picture(svg(box, *shapes), part_of(len(shown), len(faces), "triangles"))


def part_of(shown: int, count: int, what: str) -> str:
    """Say how much of the whole a picture shows."""
    return "" if shown == count else f"{shown:,} of {count:,} {what}, in the middle"


def solid(points: Floats, faces: Rows) -> Picture:
    """Draw faces in space, seen from the south-west, or the points of very many."""
    used = np.unique(faces)
    x, y, z = points[used].T
    across, away = x * np.cos(_TURN) - y * np.sin(_TURN), x * np.sin(_TURN) + y * np.cos(_TURN)
    seen = np.column_stack([across, z * np.cos(_TILT) + away * np.sin(_TILT)])
    depth = away * np.cos(_TILT) - z * np.sin(_TILT)
    if len(faces) > MOST:
        return dots(seen, -depth)
    box = Box(planar_bounds(seen), margin=_MARGIN)
    corners = np.searchsorted(used, faces)
    order = np.argsort(-depth[corners].mean(axis=1))
    first, second, third = (points[faces[:, k]] for k in range(3))
    normals = np.cross(second - first, third - first)
    steep = np.abs(normals @ [-0.4, -0.3, 0.87]) / np.linalg.norm(normals, axis=1)
    shades = colors_of(0.15 + 0.6 * np.nan_to_num(steep)).astype(int)
    shapes = [
        path(box, [seen[corners[k]]], closed=True, fill="rgb({},{},{})".format(*shades[k]),
             stroke="currentColor", stroke_width=0.4)
        for k in order.tolist()
    ]  # fmt: skip
    return Picture(svg(box, *shapes))


def polylines(
    points: Floats, starts: Array, strong: Array | None = None, *, to_scale: bool = True
) -> Picture:
    """Draw lines by the pixels that they go through: the longest of very many."""
    box = Box(planar_bounds(points), margin=_MARGIN, to_scale=to_scale)
    pixels = box.pixels(points)
    for size in _COARSE:
        kept, counts = _thinned(pixels / size, starts)
        every = np.maximum(1, -(-counts // _MOST_PLACES))
        sizes = -(-counts // every)
        if sizes.sum() <= _MOST_PLACES:
            break
    order = np.argsort(-sizes, kind="stable")[:_MOST_PLACES]
    most = max(1, np.searchsorted(np.cumsum(sizes[order]), _MOST_PLACES, "right"))
    shown, ends = np.sort(order[:most]).tolist(), np.cumsum(counts)
    lines = {k: points[kept[ends[k] - counts[k] : ends[k] : every[k]]] for k in shown}
    is_strong = np.zeros(len(counts), np.bool_) if strong is None else strong
    thin = [lines[k] for k in shown if not is_strong[k]]
    thick = [lines[k] for k in shown if is_strong[k]]
    color: dict[str, Any] = {} if to_scale else {"stroke": GREEN, "stroke-width": 1.4}
    shapes = path(box, thin, **{**THIN, **color}), path(box, thick, **{**THIN, "stroke-width": 1.3})
    note = "" if len(shown) == len(counts) else f"the longest of {len(counts):,} lines"
    return Picture(svg(box, *shapes), note)


def _thinned(pixels: Floats, starts: Array) -> tuple[Array, Array]:
    """Leave out points in the pixel of the one before; return the others, and how many a line."""
    at, line = np.round(pixels), np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    moves = np.ones(len(pixels), np.bool_)
    moves[1:] = (at[1:] != at[:-1]).any(axis=1) | (line[1:] != line[:-1])
    kept = np.flatnonzero(moves & np.isfinite(at).all(axis=1))
    return kept, np.bincount(line[kept], minlength=len(starts) - 1)


def bars(shares: Sequence[float], colors: Sequence[str], height: int = 14) -> str:
    """Draw shares of a whole side by side."""
    whole, at, shapes = sum(shares) or 1.0, 0.0, []
    for share, color in zip(shares, colors, strict=True):
        width = SIDE * share / whole
        shapes.append(
            element("rect", x=f"{at:.1f}", width=f"{width:.1f}", height=height, fill=color)
        )
        at += width
    size = f'width="{SIDE}" height="{height}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(shapes)}</svg>'
