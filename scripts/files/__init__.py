"""Files in memory, as streams that readers take: .ele and .poly may need a .node file beside them.

A stream of these has the name of a file in this folder, where the points are.
"""

from __future__ import annotations

import io
from pathlib import Path

PLACE = Path(__file__).with_name("points.ele")
BESIDE = ("ele", "poly")  # formats


class _Named(io.BytesIO):
    name = str(PLACE)


def stream_of(data: bytes, kind: str) -> io.BytesIO:
    """Make the stream of a file of a format."""
    return _Named(data) if kind in BESIDE else io.BytesIO(data)
