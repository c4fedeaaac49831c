"""Cells as a picture: SVG, a path for each row with an area."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats

if TYPE_CHECKING:
    from liftmesh.cells.clipped import ClippedCells

_WIDTH = 1000  # of the longer side


def write_svg(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Draw the outlines of cells: a writer of `files.write_cells`."""
    for line in _lines(cells):  # noqa: FURB122 - streams may only `write`
        stream.write(f"{line}\n".encode())
    return (*columns, *(["crs"] if crs else []))


def _lines(cells: ClippedCells) -> Iterator[str]:
    low, high = cells.domain.corners.min(axis=0), cells.domain.corners.max(axis=0)
    scale = _WIDTH / float((high - low).max())
    width, height = ((high - low) * scale).tolist()
    yield (
        '<svg xmlns="http://www.w3.org/2000/svg" '
        f'viewBox="-1 -1 {width + 2:.3f} {height + 2:.3f}" '
        'fill="none" stroke="#333" stroke-width="0.7" stroke-linejoin="round">'
    )
    placed = (cells.corners - (low[0], high[1])) * (scale, -scale)
    for row in np.flatnonzero(np.diff(cells.parts)).tolist():
        first, last = cells.rings[cells.parts[row : row + 2]].tolist()
        rings = [placed[slice(*cells.ring_corners[r : r + 2].tolist())] for r in range(first, last)]
        yield f'<path id="row{row}" d="{"".join(map(_outline, rings))}"/>'
    yield "</svg>"


def _outline(ring: Floats) -> str:
    return f"M{'L'.join(f'{x:.3f} {y:.3f}' for x, y in ring.tolist())}Z"
