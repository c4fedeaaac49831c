"""What results have so that they show themselves: a card in notebooks, and `plot`.

Both are made by the room `plots`, above all results; so it is asked for when it is needed.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import liftmesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def card_of(result: Any) -> str:
    """Return what notebooks show of a result: HTML with a small picture and its figures."""
    card: str = import_module("liftmesh.plots.card").card(result)
    return card


class Plotted:
    """Base of results that are drawn."""

    __slots__ = ()
    _repr_html_ = card_of

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draw it in axes of matplotlib, and return them.

        In full: `liftmesh.plot`.

        Parameters
        ----------
        ax, **style : as for `liftmesh.plot`
        """
        return liftmesh.plot(self, ax, **style)
