"""Counters of the paper's procedures: planes tried, points evaluated, points rejected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from liftmesh import _kernel

REJECTIONS = ("4.3 (i)", "4.3 (ii)", "4.3 (iii)", "4.3 (iv)", "4.3 (v)", "4.4")


@dataclass(frozen=True, slots=True)
class Counters:
    """The work of a gift wrapping run, in the paper's terms.

    Parameters
    ----------
    calls : int
        Calls of the procedure, one for each edge processed.
    candidate_planes : int
        Planes (a, b, p) with a downward normal that were tried.
    evaluations : int
        Points compared with a plane by a dot product, not counting a, b and p themselves; for
        "lfres-indexed" every point of the grid cells searched.
    rejected : dict of str to int
        Points classified by comparing coordinates alone, by proposition: above the plane for
        ``"4.3 (i)"`` to ``"4.3 (v)"``, below it for ``"4.4"``.
    undecided : int
        Evaluations whose sign was uncertain due to rounding, decided by the exact predicate.

    Examples
    --------
    >>> import liftmesh
    >>> counters = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], method="lf").counters
    >>> counters.candidate_planes
    1
    """

    calls: int
    candidate_planes: int
    evaluations: int
    rejected: dict[str, int]
    undecided: int

    @classmethod
    def from_kernel(cls, counts: _kernel.Counts) -> Counters:
        """Convert the numbers that the kernel returns.

        Parameters
        ----------
        counts : tuple
            Calls, candidate planes, evaluations, the six rejections, undecided.

        Returns
        -------
        Counters
            The same numbers by name.

        Examples
        --------
        >>> Counters.from_kernel((1, 1, 9, (4, 0, 0, 0, 0, 2), 0)).rejected["4.4"]
        2
        """
        calls, planes, evaluations, rejected, undecided = counts
        by_name = dict(zip(REJECTIONS, rejected, strict=True))
        return cls(calls, planes, evaluations, by_name, undecided)

    @property
    def points(self) -> int:
        """Number of points examined, by a dot product or by their coordinates alone.

        Returns
        -------
        int
            The sum of evaluations and rejections.

        Examples
        --------
        >>> Counters(1, 1, 5, {"4.3 (i)": 3}, 0).points
        8
        """
        return self.evaluations + sum(self.rejected.values())
