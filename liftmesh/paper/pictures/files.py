"""Writing of figures as PNG and SVG: reproducible bytes, atomic replacement."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftmesh.io.atomic import replacing
from liftmesh.optional import load
from liftmesh.paper.pictures.style import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS_PER_INCH = 180


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
