"""What plots share: axes with units, shaded relief, lines, a scale bar, an arrow to the north."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.options import refused
from liftmesh.crs.description import parse_crs
from liftmesh.crs.units import planar_unit
from liftmesh.optional import load

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes

INK, LINE, ACCENT = "#1b2327", "#5a4632", "#c0392b"
TERRAIN = ("#1d4e58", "#2f7262", "#5c9160", "#99a962", "#cdbb79", "#e3cfa3", "#f1e6d3", "#ffffff")
_SHADE = 0.5  # what is left in full shadow


def new_axes(ax: Axes | None) -> Axes:
    """Return the axes that are given, or those of a new figure, which no window shows."""
    if ax is not None:
        kind: type[Axes] = load("matplotlib.axes", extra="plot").Axes
        if not isinstance(ax, kind):
            raise refused("ax", ax, "give axes of matplotlib, or None")
        return ax
    figure = load("matplotlib.figure", extra="plot").Figure(figsize=(8, 6), layout="constrained")
    load("matplotlib.backends.backend_agg", extra="plot").FigureCanvasAgg(figure)
    made: Axes = figure.add_subplot()
    return made


def colormap(name: str | None) -> Any:
    """Return a map of colours; by default one of terrain, whose lightness ascends."""
    if name is None:
        colors = load("matplotlib.colors", extra="plot")
        return colors.LinearSegmentedColormap.from_list("liftmesh terrain", TERRAIN)
    known = load("matplotlib", extra="plot").colormaps
    if name not in known:
        raise refused("cmap", name, "give a name of matplotlib.colormaps, such as 'viridis'")
    return known[name]


def planar(ax: Axes, bounds: Sequence[float], crs: str | None) -> Axes:
    """Set axes of a map: equal scales, units, a scale bar, and where north is."""
    left, low, right, high = bounds
    ax.set_aspect("equal")
    unit = planar_unit(crs)
    ax.set_xlabel(f"x ({unit})" if unit else "x", parse_math=False)
    ax.set_ylabel(f"y ({unit})" if unit else "y", parse_math=False)
    if not np.isfinite([left, low, right, high]).all():  # nothing is drawn
        return ax
    ax.set_xlim(left, right)
    ax.set_ylim(low, high)
    ax.ticklabel_format(style="plain", useOffset=False)
    ax.locator_params(axis="x", nbins=5)
    if not is_geographic(crs):
        _scale_bar(ax, right - left, unit)
        if unit:
            _north(ax)
    return ax


def is_geographic(crs: str | None) -> bool:
    """Whether x and y are angles, which are no lengths."""
    system = None if crs is None else parse_crs(crs)
    return system is not None and system.units[0] is not None and system.units[0].metres is None


def _scale_bar(ax: Axes, width: float, unit: str | None) -> None:
    bars = load("mpl_toolkits.axes_grid1.anchored_artists", extra="plot")
    length = nice(width / 5)
    text = f"{length:g} {unit}" if unit else f"{length:g}"
    bar = bars.AnchoredSizeBar(
        ax.transData, length, text, "lower left", pad=0.4, color=INK, size_vertical=length / 40
    )
    bar.patch.set(alpha=0.8, edgecolor="none")
    ax.add_artist(bar)


def _north(ax: Axes) -> None:
    arrow = {"arrowstyle": "-|>", "color": INK, "lw": 1.4}
    style: dict[str, Any] = {"ha": "center", "xycoords": "axes fraction", "arrowprops": arrow}
    ax.annotate("N", (0.965, 0.97), (0.965, 0.86), color=INK, **style)


def nice(size: float) -> float:
    """Return 1, 2 or 5 times a power of ten, near a size and not above it."""
    if not (size > 0 and math.isfinite(size)):
        return 1.0
    power = 10.0 ** math.floor(math.log10(size))
    return max((each * power for each in (1, 2, 5) if each * power <= size), default=power)


def relief(heights: Array, shades: Array | None, colors: Any) -> tuple[Array, Any]:
    """Return heights as colours, darker where the sun does not shine; and their scale."""
    normalize = load("matplotlib.colors", extra="plot").Normalize
    known = heights[np.isfinite(heights)]
    low, high = (known.min(), known.max()) if len(known) else (0.0, 1.0)
    scale = normalize(low, high if high > low else low + 1)
    pixels = colors(scale(np.nan_to_num(heights, nan=low)))
    if shades is not None:
        pixels[..., :3] *= (_SHADE + (1 - _SHADE) * np.nan_to_num(shades, nan=1.0))[..., None]
    pixels[..., 3] = np.isfinite(heights)
    return pixels, load("matplotlib.cm", extra="plot").ScalarMappable(scale, colors)


def lines(
    ax: Axes, points: Floats, starts: Array, style: Mapping[str, Any] | None = None, **usual: Any
) -> None:
    """Draw polylines that lie one after the other: as one line with gaps, since many are slow."""
    gaps = np.asarray(starts)[1:-1]
    x, y = np.insert(points[:, :2].astype(float), gaps, np.nan, axis=0).T
    ax.plot(x, y, **styled(style, **usual))


def styled(style: Mapping[str, Any] | None, **usual: Any) -> dict[str, Any]:
    """Return what callers want, whichever names of matplotlib they use, and the usual otherwise."""
    kind = load("matplotlib.lines", extra="plot").Line2D
    return {**usual, **load("matplotlib.cbook", extra="plot").normalize_kwargs(style, kind)}


def segments(ax: Axes, ends: Floats, style: Mapping[str, Any] | None = None, **usual: Any) -> None:
    """Draw lines between two points each, (n, 2, 2)."""
    lines(ax, ends.reshape(-1, 2), np.arange(0, 2 * len(ends) + 1, 2), style, **usual)
