"""`plot`: results drawn in axes of matplotlib, each kind in its own way."""

from __future__ import annotations

from functools import singledispatch
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import edges_of_faces, planar_bounds, used_rows
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.domain import following_corners
from liftmesh.cells.voronoi import Unclipped
from liftmesh.crs.units import DEGREE
from liftmesh.errors import InputError, Option
from liftmesh.io.registry import as_cloud
from liftmesh.io.streams import check_suffix
from liftmesh.planar.certificate import Certificate
from liftmesh.planar.triangulation import Triangulation
from liftmesh.plots.drawing import (
    ACCENT,
    INK,
    LINE,
    colormap,
    is_geographic,
    lines,
    new_axes,
    nice,
    planar,
    relief,
    segments,
    styled,
)
from liftmesh.raster.raster import Raster
from liftmesh.terrain.contours import Contours
from liftmesh.terrain.profile import Profile
from liftmesh.terrain.surface import Surface
from liftmesh.tiles.options import node_of
from liftmesh.tiles.tiled_data import (
    TiledData,
    TiledSurfaceData,
    cuts_of,
    shard_faces,
    shard_vertices,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes

PIXELS = 1200  # of the longer side of a surface
_LEVELS = 12  # contours, about so many
_MOST_SEAMS = 1_000_000  # triangles across cuts that are drawn


def plot(result: Any, ax: Axes | None = None, **style: Any) -> Axes:
    """Draw a result in axes of matplotlib.

    A surface is drawn as shaded relief, by way of a raster of 1,200 pixels along its longer side,
    so that a million triangles take seconds, with its contours; a raster as relief or as values;
    contours with index lines; a profile as heights along its line; triangulations and cells by
    their sides; a certificate by the places of its flaws.

    Parameters
    ----------
    result : Surface, TiledSurface, Raster, Contours, Profile, Triangulation, Cells or Certificate
        What is drawn; also `Cells.unclipped`, a planar `liftmesh.scipy.Voronoi`, and a `Tiled` by
        the cuts between its tiles. Clouds are drawn as points, coloured by height.
    ax : matplotlib.axes.Axes, optional
        Where; by default the axes of a new figure, which no window shows: ``ax.figure.savefig``.
    **style
        Of surfaces and rasters ``cmap`` (the name of a colour map) and ``colorbar`` (default True);
        of surfaces ``contours`` (an interval, False, or True, the default: a round one), ``edges``
        (default False) and ``values`` (a name, in place of heights); of surfaces in tiles ``tiles``
        (default True: the cuts, and the triangles across them); of all others keywords of
        matplotlib's lines, as ``color`` and ``linewidth``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, with units where a coordinate system says them.

    Raises
    ------
    InputError
        There is no colour map of this name; the surface has no area, or is in tiles, of which edges
        are not drawn; or the raster is turned.
    UnsupportedTypeError
        The result is of no known type.
    MissingDependencyError
        matplotlib is not installed.

    See Also
    --------
    view : A page to turn and zoom.
    Surface.raster : The values that are drawn.

    Examples
    --------
    >>> import liftmesh
    >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]])
    >>> ax = liftmesh.plot(hill, contours=2)
    >>> ax.get_xlim(), ax.get_xlabel()
    ((np.float64(0.0), np.float64(4.0)), 'x')
    """
    return _plot(result, ax, **style)


@singledispatch
def _plot(result: Any, ax: Axes | None, **style: Any) -> Axes:
    if hasattr(result, "ridge_ends"):  # of liftmesh.scipy, which loads SciPy
        return _diagram(result, ax, **style)
    cloud = as_cloud(result)
    points = cloud.points[np.isfinite(cloud.points).all(axis=1)]
    ax = new_axes(ax)
    style = {"s": 2, "cmap": colormap(None), **style}
    ax.scatter(points[:, 0], points[:, 1], c=points[:, 2], **style)
    return planar(ax, _wide(planar_bounds(points[:, :2])), cloud.crs)


@_plot.register(Surface)
def _(result: Surface, ax: Axes | None, **style: Any) -> Axes:
    return _surface(result, result.bounds, ax, **style)


@_plot.register(TiledData)
def _(result: TiledData, ax: Axes | None, **style: Any) -> Axes:
    cuts, bounds = cuts_of(result)
    if not len(cuts):
        raise InputError("there is one tile, and no coordinates of its triangles to plot")
    return planar(_cuts(cuts, new_axes(ax), **style), bounds, None)


@_plot.register(TiledSurfaceData)
def _(result: TiledSurfaceData, ax: Axes | None, *, tiles: bool = True, **style: Any) -> Axes:
    ax = _surface(result, result.bounds, ax, **style)
    if tiles:
        for ends in _seams(result):
            segments(ax, ends, color=ACCENT, linewidth=0.4, alpha=0.7)
        _cuts(cuts_of(result)[0], ax)
    return ax


def _seams(tiled: TiledSurfaceData) -> Iterator[Floats]:
    """Yield the sides of the triangles that cross cuts, shard by shard, as far as they are few."""
    left = _MOST_SEAMS
    for shard in tiled.manifest["shards"]:
        if shard["triangles"] and node_of(Path(shard["file"]).stem) >= 0:
            left -= shard["triangles"]
            if left >= 0:
                vertices, faces = shard_vertices(tiled, shard), shard_faces(tiled, shard)
                places = np.column_stack([vertices["x"], vertices["y"]])
                yield places[edges_of_faces(np.asarray(faces))]


def _cuts(cuts: Floats, ax: Axes, **style: Any) -> Axes:
    """Draw the cuts between tiles, the first ones thick: what is merged last."""
    for level in range(len(cuts).bit_length()):
        width = max(0.6, 2.4 - 0.5 * level)
        part = cuts[2**level - 1 : 2 ** (level + 1) - 1]
        segments(ax, part, style, color=ACCENT, linewidth=width)
    return ax


def _surface(
    surface: Any,
    bounds: tuple[float, ...],
    ax: Axes | None,
    *,
    contours: float | bool = True,
    edges: bool = False,
    values: str | None = None,
    **style: Any,
) -> Axes:
    left, low, right, high = bounds
    step = max(right - left, high - low) / PIXELS
    if not step > 0:
        raise InputError("the surface has no face to plot")
    if edges and isinstance(surface, TiledSurfaceData):
        raise InputError(f"{Option('edges')} are drawn of surfaces in memory: leave it out")
    of = {} if values is None else {"values": values}
    heights = surface.raster(step, **of)
    shades = None if values is not None else _shades(surface, step)
    ax = _pixels(heights, shades, new_axes(ax), **style)
    known = heights.values[np.isfinite(heights.values)]
    interval = nice(float(np.ptp(known)) / _LEVELS) if contours is True and len(known) else contours
    if interval and len(known):
        _contours(surface.contours(interval=interval, **of), ax)
    if edges:
        _sides(surface.triangulation.points, surface.faces, ax)
    return planar(ax, bounds, surface.crs)


def _shades(surface: Any, step: float) -> Array:
    """Return the light on a surface; a degree is as long as on the equator."""
    scale = {"z_factor": 1 / DEGREE} if is_geographic(surface.crs) else {}
    shades: Array = surface.raster(step, quantity="hillshade", **scale).values / 255
    return shades


@_plot.register(Raster)
def _(result: Raster, ax: Axes | None, **style: Any) -> Axes:
    a, _, c, _, e, f = result.transform
    rows, columns = result.values.shape
    x, y = sorted((c, c + a * columns)), sorted((f, f + e * rows))
    return planar(
        _pixels(result, None, new_axes(ax), **style), (x[0], y[0], x[1], y[1]), result.crs
    )


def _pixels(
    raster: Raster, shades: Any, ax: Axes, *, cmap: str | None = None, colorbar: bool = True
) -> Axes:
    a, b, c, d, e, f = raster.transform
    if b or d:
        raise InputError("the raster is turned: only those with rows along x are drawn")
    rows, columns = raster.values.shape
    pixels, scale = relief(np.asarray(raster.values, float), shades, colormap(cmap))
    extent = (c, c + a * columns, f + e * rows, f)
    ax.imshow(pixels, extent=extent, origin="upper", interpolation="nearest")
    if colorbar:
        unit = f" ({raster.unit})" if raster.unit else ""
        bar = ax.figure.colorbar(scale, ax=ax, shrink=0.8)
        bar.set_label(f"{raster.quantity}{unit}", parse_math=False)
    return ax


@_plot.register(Contours)
def _(result: Contours, ax: Axes | None, **style: Any) -> Axes:
    ax = _contours(result, new_axes(ax), **style)
    return planar(ax, _wide(planar_bounds(result.points)), result.crs)


def _contours(contours: Contours, ax: Axes, **style: Any) -> Axes:
    for is_index, width in ((False, 0.4), (True, 0.9)):
        which = np.flatnonzero(contours.is_index == is_index)
        chosen = contours._selected(which)  # noqa: SLF001 - which a mask does not
        lines(ax, chosen.points, chosen.starts, style, color=LINE, linewidth=width, alpha=0.8)
    return ax


@_plot.register(Profile)
def _(result: Profile, ax: Axes | None, **style: Any) -> Axes:
    ax = new_axes(ax)
    pairs = np.column_stack([result.distances, result.points[:, 2]])
    for line, (begin, end) in zip(result.lines, pairwise(result.starts), strict=True):
        usual = {"color": f"C{line % 10}", "linewidth": 1.2}
        ax.plot(*pairs[begin:end].T, **styled(style, **usual))
    ax.set_xlabel("distance" if result.stations is None else "offset")
    ax.set_ylabel("height")
    ax.grid(alpha=0.3)
    return ax


@_plot.register(Triangulation)
def _(result: Triangulation, ax: Axes | None, **style: Any) -> Axes:
    ax = _sides(result.points, result.simplices, new_axes(ax), **style)
    forced = getattr(result, "constraints", None)
    if forced is not None and len(forced):
        segments(ax, result.points[forced], color=ACCENT, linewidth=1.2)
    used = used_rows(result.npoints, result.simplices)
    return planar(ax, _wide(planar_bounds(result.points[used])), None)


def _sides(points: Floats, faces: Rows, ax: Axes, **style: Any) -> Axes:
    segments(ax, points[edges_of_faces(faces)], style, color=INK, linewidth=0.4, alpha=0.7)
    return ax


@_plot.register(ClippedCells)
def _(result: ClippedCells, ax: Axes | None, **style: Any) -> Axes:
    ax = new_axes(ax)
    starts = result.ring_corners
    ends = np.stack([result.corners, result.corners[following_corners(starts)]], axis=1)
    segments(ax, ends, style, color=INK, linewidth=0.7)
    return planar(_sites(result.points, ax), _wide(result.domain.bounds), result.crs)


@_plot.register(Unclipped)
def _(result: Unclipped, ax: Axes | None, **style: Any) -> Axes:
    return _diagram(result, ax, **style)


def _diagram(result: Any, ax: Axes | None, **style: Any) -> Axes:
    """Draw a diagram in the whole plane, its rays and lines as far as they are seen."""
    ax = new_axes(ax)
    bounds = _wide(planar_bounds(result.points), 0.15)
    is_ray = result.ridge_ends[:, 0] < 0
    one, other = result.points[result.ridge_points[is_ray]].transpose(1, 0, 2)
    x, y = (one - other if result.furthest_site else other - one).T
    reach = np.hypot(bounds[2] - bounds[0], bounds[3] - bounds[1]) / np.hypot(x, y)
    ways, middles = np.column_stack([y, -x]) * reach[:, None], (one + other) / 2
    last = result.ridge_ends[is_ray, 1]
    is_line = (last < 0)[:, None]
    begins = result.vertices[last] if len(result.vertices) else middles
    rays = np.stack(
        [np.where(is_line, middles - ways, begins), np.where(is_line, middles, begins) + ways], 1
    )
    ends = np.concatenate([result.vertices[result.ridge_ends[~is_ray]], rays])
    segments(ax, ends, style, color=INK, linewidth=0.7)
    return planar(_sites(result.points, ax), bounds, None)


def _sites(points: Floats, ax: Axes) -> Axes:
    ax.plot(*points.T, ".", color=ACCENT, markersize=min(4, 400 / len(points) ** 0.5))
    return ax


@_plot.register(Certificate)
def _(result: Certificate, ax: Axes | None, **style: Any) -> Axes:
    ax = new_axes(ax)
    for number, flaw in enumerate(result.flaws):
        places = np.array([point[:2] for each in flaw.first for point in each.points])
        name = f"{flaw.count:,} {flaw.kind}"
        usual = {"color": f"C{number % 10}", "label": name, "marker": "o", "linestyle": ""}
        ax.plot(*places.reshape(-1, 2).T, **styled(style, **usual))
    ax.set_title("; ".join(flaw.text for flaw in result.flaws) or "nothing wrong", wrap=True)
    if result.flaws:
        ax.legend()
    ax.ticklabel_format(style="plain", useOffset=False)
    ax.set_xlabel("x")
    ax.set_ylabel("y")
    return ax


def _wide(bounds: Any, share: float = 0.03) -> tuple[float, float, float, float]:
    """Leave a margin around what is drawn up to its border."""
    left, low, right, high = (float(each) for each in bounds)
    margin = share * max(right - left, high - low) or 1.0
    return left - margin, low - margin, right + margin, high + margin


def check_picture(path: Any) -> None:
    """Raise if the name of a file is none of a picture."""
    check_suffix(path, (".png", ".svg", ".pdf"), "pictures")
