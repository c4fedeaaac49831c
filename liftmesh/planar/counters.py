"""What the paper's procedures did: planes tried, points evaluated, points rejected unseen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from liftmesh import _kernel

REJECTIONS = ("4.3 (i)", "4.3 (ii)", "4.3 (iii)", "4.3 (iv)", "4.3 (v)", "4.4")


@dataclass(frozen=True, slots=True)
class Counters:
    """How much work gift wrapping took, in the paper's own terms.

    Parameters
    ----------
    calls : int
        Calls of the procedure, one for each edge that was wrapped around.
    candidate_planes : int
        Planes (a, b, p) with a downward normal that were tried.
    evaluations : int
        Points held against a plane by a dot product: without a, b and p themselves, but for
        "lfres-indexed" every point of the cells it looks through.
    rejected : dict of str to int
        Points decided by comparing coordinates alone, by the proposition that did it:
        ``"4.3 (i)"`` to ``"4.3 (v)"`` say above, ``"4.4"`` says below.
    undecided : int
        Evaluations whose sign rounding left open, so that the exact predicate decided.

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
        """Name the numbers that the kernel returns.

        Parameters
        ----------
        counts : tuple
            Calls, candidate planes, evaluations, the six rejections, undecided.

        Returns
        -------
        Counters
            The same.

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
        """Points looked at, by a dot product or by their coordinates alone.

        Returns
        -------
        int
            Evaluations and rejections together.

        Examples
        --------
        >>> Counters(1, 1, 5, {"4.3 (i)": 3}, 0).points
        8
        """
        return self.evaluations + sum(self.rejected.values())
