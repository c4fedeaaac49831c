"""Files in memory, as streams that readers take: an .ele file needs a .node file beside it.

A stream of triangles has the name of a file in this folder, where the points are.
"""

from __future__ import annotations

import io
from pathlib import Path

PLACE = Path(__file__).with_name("points.ele")


class _Named(io.BytesIO):
    name = str(PLACE)


def stream_of(data: bytes, kind: str) -> io.BytesIO:
    """Make the stream of a file of a format."""
    return _Named(data) if kind == "ele" else io.BytesIO(data)
