"""The paper's figures, drawn from computed data, all of them into a folder or individually.

Figures 2.1 to 5.2 show results of the other modules of this room: exact planes and cross-sections,
real triangulations and hulls, random points. Figures 6.1 and 6.2 show the printed running times,
and ours if measured. Two additional figures show the effect of the restricted region, four what the
last section names (a power diagram, another metric, a metric for each point, and disks), and one
the upper hull. Each function returns a matplotlib ``Figure`` that is not attached to a window. The
bytes of the files depend on the figures alone.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from liftmesh.io.atomic import replacing
from liftmesh.optional import load
from liftmesh.paper.pictures.anisotropic import figure_adaptive, figure_metric, figure_stars
from liftmesh.paper.pictures.cross_section import figure_4_1, figure_4_2
from liftmesh.paper.pictures.farthest import figure_farthest
from liftmesh.paper.pictures.first_edge import figure_3_1
from liftmesh.paper.pictures.lifting import figure_2_1, figure_2_2, figure_5_1, figure_5_2
from liftmesh.paper.pictures.region import figure_4_3
from liftmesh.paper.pictures.running_times import (
    figure_6_1,
    figure_6_2,
    figure_dot_products,
    figure_rejections,
)
from liftmesh.paper.pictures.style import styled
from liftmesh.paper.pictures.weighted import figure_disks, figure_power

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from liftmesh.paper.tables import Row

Drawer: TypeAlias = "Callable[[], Figure]"

FIXED: Mapping[str, Drawer] = {
    "figure_2_1": figure_2_1,
    "figure_2_2": figure_2_2,
    "figure_3_1": figure_3_1,
    "figure_4_1": figure_4_1,
    "figure_4_2": figure_4_2,
    "figure_4_3": figure_4_3,
    "figure_5_1": figure_5_1,
    "figure_5_2": figure_5_2,
    "power_diagram": figure_power,
    "metric": figure_metric,
    "farthest": figure_farthest,
    "stars": figure_stars,
    "disks": figure_disks,
    "adaptive_thinning": figure_adaptive,
}
"""The figures that do not need measurements: the paper's, and what its last section names."""

TIMED: Mapping[str, Callable[[Sequence[Row]], Figure]] = {
    "figure_6_1": figure_6_1,
    "figure_6_2": figure_6_2,
}
"""The figures of running times: printed ones, and measured ones if there are any."""

MEASURED: Mapping[str, Callable[[Sequence[Row]], Figure]] = {
    "rejections": figure_rejections,
    "dot_products": figure_dot_products,
}
"""The figures that show measurements only."""

DOTS_PER_INCH = 180


def draw_all(
    directory: Path,
    *,
    results: Sequence[Row] | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Draw all figures into a folder, each as PNG and as SVG."""
    directory.mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    for name, draw in _drawers(results or ()):
        if progress is not None:
            progress(name)
        files += save(draw(), directory, name)
    return files


def _drawers(results: Sequence[Row]) -> Iterator[tuple[str, Drawer]]:
    yield from FIXED.items()
    for name, draw in {**TIMED, **(MEASURED if results else {})}.items():
        yield name, partial(draw, results)


@styled
def save(figure: Figure, directory: Path, name: str) -> list[Path]:
    """Write a figure as ``name.png`` and ``name.svg``."""
    return [_write(directory / f"{name}.{kind}", figure, kind) for kind in ("png", "svg")]


def _write(path: Path, figure: Figure, kind: str) -> Path:
    # No date, no version: the bytes depend on the figure alone. The salt fixes SVG's random names.
    nothing: dict[str, Any] = (
        {"Software": None} if kind == "png" else {"Date": None, "Creator": None}
    )
    drawn = io.BytesIO()
    with load("matplotlib", extra="plot").rc_context({"svg.hashsalt": path.stem}):
        figure.savefig(drawn, format=kind, dpi=DOTS_PER_INCH, metadata=nothing)
    with replacing(path, follow_links=False) as stream:
        stream.write(drawn.getvalue())
    return path
