"""trimesh's convex hull of points in space beside the exact one: facets that are none, with proofs.

A facet of trimesh is one if its plane has no point beyond it. The points around a corner of the
exact hull decide that: the hull lies in the cone that its edges at the corner span. So a facet
takes as many exact orientations as its first corner has neighbours, and a corner that is not on the
hull one for each vertex. Points outside trimesh's hull are beyond such a facet.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats, Mask, Rows
from liftmesh.base.arrays import distinct
from liftmesh.base.frozen import FrozenResult
from liftmesh.comparison.hull import convex_facets
from liftmesh.comparison.proofs import as_short
from liftmesh.predicates import orient2d, orient3d
from liftmesh.space.tetrahedra import tetrahedralize

if TYPE_CHECKING:
    from liftmesh.space.convex_hull import ConvexHull


@dataclass(frozen=True, slots=True)
class BeyondProof:
    """A row that lies strictly outside a facet of trimesh's hull."""

    rows: tuple[int, ...]
    row: int
    determinant: Fraction

    def __str__(self) -> str:
        value = as_short(self.determinant)
        return (
            f"trimesh's facet {self.rows} is none of the hull: row {self.row} lies strictly "
            f"outside it, determinant {value} > 0"
        )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class HullComparison(FrozenResult):
    """trimesh's convex hull of points in space compared with liftmesh's.

    Parameters
    ----------
    hull : ConvexHull
        liftmesh's hull.
    facets : (h, 3) ndarray of int32
        The facets of trimesh's hull in the caller's rows.
    n_identical : int
        Facets that both have.
    n_coplanar : int
        Further facets of trimesh that lie on the hull: others on the same planes, both right.
    wrong : (w, 3) ndarray of int32
        Facets of trimesh that are none: points lie outside them, or they are flat.
    outside : (k,) ndarray of int32
        Vertices of liftmesh's hull that lie strictly outside a wrong facet, as trimesh orients it,
        and are no corners of trimesh's.
    watertight : bool
        Whether each edge of trimesh's hull joins two facets.
    proofs : tuple
        Exact proofs for the first wrong facets; each has a text form.
    seconds : mapping
        ``"liftmesh"``, of the tetrahedra of which the hull is a part, and ``"trimesh"``.
    error : str, optional
        Why trimesh finds no hull.

    See Also
    --------
    compare : Makes comparisons.
    convex_hull : Exact hulls.

    Examples
    --------
    >>> import liftmesh
    >>> hull = liftmesh.convex_hull([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [1, 1, 1]])
    >>> liftmesh.compare(hull)
    <HullComparison: identical, 4 facets of liftmesh, 4 of trimesh>
    """

    hull: ConvexHull
    facets: Rows
    n_identical: int
    n_coplanar: int
    wrong: Rows
    outside: Rows
    watertight: bool
    proofs: tuple[BeyondProof, ...]
    seconds: dict[str, float]
    error: str | None = None

    def __repr__(self) -> str:
        ours, theirs = len(self.hull.faces), len(self.facets)
        return (
            f"<HullComparison: {self.verdict}, {ours:,} facets of liftmesh, {theirs:,} of trimesh>"
        )

    @property
    def verdict(self) -> str:
        """What was found.

        Returns
        -------
        str
            "identical"; "coplanar" if the hulls differ only within planes, where both are right;
            "different" if trimesh's is wrong, or open; "failed" if it has none.

        Examples
        --------
        >>> import liftmesh
        >>> cube = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        >>> liftmesh.compare(liftmesh.convex_hull(cube)).verdict in ("identical", "coplanar")
        True
        """
        if self.error is not None:
            return "failed"
        if len(self.wrong) or not self.watertight:
            return "different"
        same = self.n_identical == len(self.facets) == len(self.hull.faces)
        return "identical" if same else "coplanar"

    @property
    def agrees(self) -> bool:
        """Whether trimesh's hull is right.

        Returns
        -------
        bool
            True for "identical" and "coplanar".

        Examples
        --------
        >>> import liftmesh
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> liftmesh.compare(liftmesh.convex_hull(corners)).agrees
        True
        """
        return self.verdict in ("identical", "coplanar")


def compare_hulls(hull: ConvexHull, max_proofs: int) -> HullComparison:
    """Compare trimesh's convex hull of the points with the exact one."""
    rows = np.flatnonzero(np.isfinite(hull.points).all(axis=1)).astype(np.int32)
    start = perf_counter()
    tetrahedralize(hull.points, nonfinite="skip")
    seconds = {"liftmesh": perf_counter() - start}
    facets, watertight, seconds["trimesh"], error = convex_facets(hull.points, rows)
    judge = _Judge(hull)
    own = {*map(tuple, np.sort(hull.faces, axis=1).tolist())}
    others = np.array(
        [tuple(sorted(facet)) not in own for facet in facets.tolist()], dtype=np.bool_
    )
    beyond = np.full(len(facets), -1, np.int32)
    for index in np.flatnonzero(others):
        beyond[index] = judge.row_beyond(facets[index])
    is_wrong = others & ((beyond >= 0) | _are_flat(hull.points, facets))
    proved = (judge.proof(facets[k], beyond[k]) for k in np.flatnonzero(beyond >= 0))
    return HullComparison(
        hull=hull,
        facets=facets,
        n_identical=int((~others).sum()),
        n_coplanar=int((others & ~is_wrong).sum()),
        wrong=facets[is_wrong],
        outside=np.setdiff1d(judge.rows_beyond(facets[beyond >= 0]), facets),
        watertight=watertight,
        proofs=tuple(islice(proved, max_proofs)),
        seconds=seconds,
        error=error,
    )


def _are_flat(points: Floats, facets: Rows) -> Mask:
    """Whether the corners of facets are collinear: in all three projections."""
    flat = np.ones(len(facets), np.bool_)
    for axes in ([0, 1], [1, 2], [0, 2]):
        flat &= orient2d(*points[:, axes][facets.T]) == 0
    return flat


class _Judge:
    """The exact hull, asked what lies beyond facets."""

    def __init__(self, hull: ConvexHull) -> None:
        self._points, self._vertices = hull.points, hull.vertices
        ends = np.concatenate([hull.faces[:, [k, k - 1]] for k in range(3)])
        self._ends = ends[np.argsort(ends[:, 0], kind="stable")]

    def _sides(self, facet: Rows, rows: Rows) -> Rows:
        """Return on which side of a facet rows lie."""
        a, b, c = self._points[facet]
        sides: Rows = orient3d(a, b, c, self._points[rows]).astype(np.int32)
        return sides

    def _outside(self, facet: Rows) -> Rows:
        """Return the vertices strictly outside a facet: from where it is counter-clockwise."""
        rows: Rows = self._vertices[self._sides(facet, self._vertices) > 0]
        return rows

    def row_beyond(self, facet: Rows) -> int:
        """Return a row strictly outside a facet, or -1."""
        first, end = np.searchsorted(self._ends[:, 0], [facet[0], facet[0] + 1])
        near = self._ends[first:end, 1] if end > first else self._vertices
        sides = self._sides(facet, near)
        if not ((sides > 0).any() and (sides < 0).any()):
            return -1
        return int(self._outside(facet)[0])

    def rows_beyond(self, facets: Rows) -> Rows:
        """Return the vertices that are strictly outside any of these facets."""
        outside = [self._vertices[:0], *map(self._outside, facets)]
        found: Rows = distinct(np.concatenate(outside))
        return found

    def proof(self, facet: Rows, row: int) -> BeyondProof:
        """Compute the determinant in fractions."""
        a, b, c, d = ([Fraction(x) for x in self._points[k].tolist()] for k in (*facet, row))
        u, v, w = ([x - y for x, y in zip(p, a, strict=True)] for p in (b, c, d))
        cross = [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]
        value = sum((x * y for x, y in zip(cross, w, strict=True)), Fraction(0))
        return BeyondProof(tuple(facet.tolist()), int(row), value)
