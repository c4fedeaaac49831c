"""The depth of colours in a PLY header: a comment, where their values would tell another.

Colours of 16 bits that are all dark would be read as colours of 8 bits.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.colors import stated_depth

_STATED_DEPTHS = {f"color_depth {depth}": depth for depth in (16, 32, 64)}


def depth_statement(colors: Array | None) -> list[str]:
    """Comments that state the depth of colours as they are written: one, or none."""
    depth = stated_depth(colors)
    return [] if depth is None else [f"color_depth {depth}"]


def depth_of_comments(
    comments: Iterable[str], color: np.dtype | None
) -> tuple[int | None, list[str]]:
    """Return the depth that comments state of colours of a type, and the other comments."""
    depth: int | None = None
    others: list[str] = []
    for comment in comments:
        found = _STATED_DEPTHS.get(comment)
        is_of_type = color is not None and color.kind == "u" and found == 8 * color.itemsize
        if found is None or not is_of_type:
            others.append(comment)
        else:
            depth = found
    return depth, others
