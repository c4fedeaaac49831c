"""What the pictures of the gallery have in common."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl

STYLE = {
    "axes.edgecolor": "#888888",
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 10,
    "figure.constrained_layout.use": True,
    "font.size": 9,
}


def style(_gallery: dict[str, Any], _script: str) -> None:
    """Set matplotlib up for a script."""
    mpl.rcParams.update(STYLE)
