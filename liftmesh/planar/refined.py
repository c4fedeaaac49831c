"""`RefineResult`: a refined triangulation, and its verification.

Whether an angle is less than the asked one is exact: the sign of d^2 - c^2 e, where d is the dot
product of the sides of a corner, e the product of the squares of their lengths and c the cosine,
in doubles where these are sure, else in integers.

That an input edge is covered means: its parts lead from one end to the other, one after the other,
always onward along both axes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Indices, Integers, Progress, Rows
from liftmesh.base.arrays import pair_keys
from liftmesh.base.frozen import FrozenResult, check_numbers
from liftmesh.base.options import as_count, counted
from liftmesh.planar.certificate import Certificate, Flaw, Violation
from liftmesh.planar.crossing_edges import distances

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation

_PI = Decimal("3.14159265358979323846264338327950288419716939937511")
_TERMS = 20  # the next one is below 10^-50
_AT_ONCE = 1 << 14  # triangles
_LISTED = 16  # violations
_MOST_BINS = 1_000_000
_DOUBT = 2.0**-46  # more than 32 roundings of 2^-53 each
_SCALE = 200  # the exponent of the largest coordinate: no product overflows
_TINY = 2.0**-900  # products of squares that underflow cannot have changed


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class RefineResult(FrozenResult):
    """A refined triangulation, as returned by `refine`, and what was added. Arrays are read-only.

    Parameters
    ----------
    triangulation : ConstrainedTriangulation
        The triangles. Rows of the domain keep their numbers; those that were added come last. Its
        ``constraints`` are the parts of the edges of the domain, and its ``input_edges`` those of
        the domain, then sides of its boundary that were none. It counts as carved where rows on
        the boundary are rounded to beside the hull.
    steiner : (s,) ndarray of int32
        The rows that were added.
    steiner_edges : (s,) ndarray of int32
        The input edge on which each of them lies, the first of several; -1 for rows between edges.
    below : (b,) ndarray of int32
        The triangles with an angle under the one that was asked for.
    causes : (b,) ndarray of str
        Why each of them was left: "input angle" (its shortest side joins two edges that meet in
        less than 60 degrees), "cap" (`max_points` was reached) or "precision" (float64 has no
        better row).
    asked_angle : float
        The least angle that was asked for, in degrees; 0 for none.
    displacement : float
        The largest distance of an added row from the input edge on which it should be, by rounding.
    capped : bool
        Whether `max_points` ended the refinement.
    too_large : (l,) ndarray of int32
        The triangles that are larger than was asked for, by `max_area` or by `size` at their
        centroid, as the cap was reached or float64 has no row that would divide them.
    surface : Surface or None
        Of a surface, the refined one: rows that were added have 1 in the values ``steiner``, the
        height of the surface before, and colours and other values of the nearest row.
    original : Surface or None
        Of a surface, the one before.

    See Also
    --------
    refine : Computes it.
    ConstrainedTriangulation : What is known of the triangles.

    Examples
    --------
    >>> import liftmesh
    >>> wedge = liftmesh.refine([[0.0, 0.0], [8.0, 0.0], [8.0, 1.0]], min_angle=20)
    >>> set(wedge.causes.tolist()), round(wedge.min_angle, 2)
    ({'input angle'}, 7.13)
    """

    triangulation: ConstrainedTriangulation
    steiner: Rows
    steiner_edges: Rows
    below: Rows
    causes: Array
    asked_angle: float
    displacement: float
    capped: bool
    too_large: Rows
    surface: Any = None
    original: Any = None

    def __repr__(self) -> str:
        return (
            f"<RefineResult: {counted(self.triangulation.nsimplex, 'triangle')}, "
            f"{counted(len(self.steiner), 'row')} added, {len(self.below):,} below "
            f"{self.asked_angle:g} degrees{', capped' if self.capped else ''}>"
        )

    def _check_copy(self) -> None:
        tri = self.triangulation
        check_numbers(0, tri.npoints, self.steiner)
        check_numbers(-1, len(tri.input_edges), self.steiner_edges)
        check_numbers(0, tri.nsimplex, self.below)
        check_numbers(0, tri.nsimplex, self.too_large)

    def to_cloud(self) -> Cloud:
        """Convert the surface, or else the triangulation, to a cloud with faces and edges.

        Returns
        -------
        Cloud
            That of `Surface.to_cloud`, or of `ConstrainedTriangulation.to_cloud`, which takes
            markers of edges.

        See Also
        --------
        liftmesh.write : Takes the result itself, too.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.refine([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]).to_cloud()
        <Cloud of 4 points, 2 faces, 4 edges>
        """
        cloud: Cloud = self._made.to_cloud()
        return cloud

    @property
    def _made(self) -> Any:
        return self.triangulation if self.surface is None else self.surface

    @property
    def angles(self) -> Floats:
        """The angles of the triangles at their corners in degrees, (m, 3) float64."""
        found = np.empty(self.triangulation.simplices.shape)
        for part, dot, _, cross in _products(self.triangulation, self.triangulation.simplices):
            found[part] = np.degrees(np.arctan2(cross, dot)).T
        return found

    @property
    def max_deviation(self) -> float:
        """Of a surface, the largest difference of heights from the one before, rounded.

        It is where edges cross, which are found whenever it is asked for.
        """
        return 0.0 if self.surface is None else float(self.surface._deviation(self.original))  # noqa: SLF001

    @property
    def min_angle(self) -> float:
        """The smallest angle of all, in degrees."""
        return float(self.angles.min())

    def histogram(self, bins: int = 18) -> tuple[Integers, Floats]:
        """Count the angles of the triangles.

        Parameters
        ----------
        bins : int, default 18
            Into how many equal parts 180 degrees are divided.

        Returns
        -------
        counts : (bins,) ndarray of int64
            The angles in each part.
        edges : (bins + 1,) ndarray of float64
            The bounds of the parts in degrees.

        Raises
        ------
        InputError
            `bins` is not a whole number from 1 to 1,000,000.

        See Also
        --------
        RefineResult.angles : The angles themselves.

        Examples
        --------
        >>> import liftmesh
        >>> refined = liftmesh.refine([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        >>> refined.histogram(3)
        (array([4, 2, 0]), array([  0.,  60., 120., 180.]))
        """
        return np.histogram(self.angles, as_count("bins", bins, 1, _MOST_BINS), (0.0, 180.0))

    def verify(
        self, *, threads: int | None = None, progress: Progress | None = None
    ) -> Certificate:
        """Verify the result from scratch, exactly.

        Parameters
        ----------
        threads, progress
            As for `verify`.

        Returns
        -------
        Certificate
            That the triangles are constrained Delaunay, with further flaws: "small_angles" where an
            angle is less than was asked for and its triangle is not in `below`, and
            "uncovered_edges" where the constraints of an input edge do not lead from end to end, or
            a row of theirs is farther from it than `displacement`. Sizes are not checked: the
            result does not hold what was asked for.

        Raises
        ------
        InputError
            `threads` is not a valid number, or `progress` cannot be called.

        See Also
        --------
        verify : The check of triangles from any source.

        Examples
        --------
        >>> import liftmesh
        >>> bool(liftmesh.refine([[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 1.0]]).verify())
        True
        """
        tri = self.triangulation
        certificate = tri.verify(threads=threads, progress=progress)
        others = np.delete(np.arange(tri.nsimplex), self.below)
        small = below_angle(tri, cosine_of(self.asked_angle), others)
        far = max(self.displacement, tri.displacement)
        said = f"an angle under {self.asked_angle:g} degrees and {{verb}} not listed"
        found = (
            *self._flaw("small_angles", small, "triangle", tri.simplices, said),
            *self._flaw(
                "uncovered_edges",
                uncovered_edges(tri, far),
                "input edge",
                tri.input_edges,
                "no constraints along it from end to end",
            ),
        )
        return replace(certificate, flaws=(*found, *certificate.flaws))

    def _flaw(self, kind: str, wrong: Array, noun: str, rows: Rows, said: str) -> Iterator[Flaw]:
        if not len(wrong):
            return
        verb, have = ("is", "has") if len(wrong) == 1 else ("are", "have")
        first = []
        for each in wrong[:_LISTED].tolist():
            corners = tuple(rows[each].tolist())
            points = tuple((x, y) for x, y in self.triangulation.points[list(corners)].tolist())
            place = f"{noun} {each}, rows {corners}, at {points[0]}"
            first.append(Violation(place, corners, points, (each,) * (noun == "triangle")))
        text = f"{counted(len(wrong), noun)} {have} {said.format(verb=verb)}"
        yield Flaw(kind, len(wrong), text, tuple(first))


def cosine_of(degrees: float) -> float:
    """Return the float64 nearest to the cosine, on every platform: of libraries it may differ."""
    with localcontext() as context:
        context.prec = 50
        angle = Decimal(degrees) * _PI / 180
        term = total = Decimal(1)
        for k in range(1, _TERMS):
            term *= -angle * angle / (2 * k * (2 * k - 1))
            total += term
        return float(total)


def _products(
    tri: ConstrainedTriangulation, simplices: Rows
) -> Iterator[tuple[slice, Floats, Floats, Floats]]:
    """Return the dot product and that of the squares of the sides at corners, and cross products.

    Of parts of the triangles, (3, k), (3, k) and (k,), scaled by one power of two.
    """
    points = tri.points[: tri.npoints]
    exponent = int(np.frexp(np.abs(points[tri.convex_hull]).max())[1])
    x, y = np.ldexp(points.T, _SCALE - exponent)
    for start in range(0, len(simplices), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        corners = simplices[part].T
        ux, uy = (p - np.roll(p, 1, axis=0) for p in (x[corners], y[corners]))  # from the last one
        vx, vy = np.roll(ux, -1, axis=0), np.roll(uy, -1, axis=0)
        squares = ux * ux + uy * uy
        squares *= np.roll(squares, -1, axis=0)
        yield part, -(ux * vx + uy * vy), squares, ux[0] * vy[0] - uy[0] * vx[0]


def below_angle(tri: ConstrainedTriangulation, cosine: float, among: Array) -> Indices:
    """Return those of some triangles that have an angle whose cosine is larger, exactly."""
    found = [np.empty(0, dtype=np.intp)]
    if cosine >= 1:
        return found[0]
    simplices = tri.simplices[among]
    for part, dot, squares, _ in _products(tri, simplices):
        excess = dot * np.abs(dot) - cosine**2 * squares
        is_below = np.any(excess > 0, axis=0)
        is_sure = (np.abs(excess) > _DOUBT * squares) & (squares > _TINY)
        for k in np.flatnonzero(~is_sure.all(axis=0)).tolist():
            corners = tri.points.take(simplices[part.start + k], axis=0)
            is_below[k] = _is_below(corners.tolist(), Fraction(cosine))
        found.append(among[part][is_below])
    return np.concatenate(found)


def _is_below(corners: list[list[float]], cosine: Fraction) -> bool:
    """Decide for one triangle in integers."""
    ratios = [[each.as_integer_ratio() for each in corner] for corner in corners]
    scale = max(under for corner in ratios for _, under in corner)
    exact = [[over * (scale // under) for over, under in corner] for corner in ratios]
    over, under = cosine.numerator**2, cosine.denominator**2
    for k in range(3):
        (x, y), (ax, ay), (bx, by) = exact[k], exact[k - 2], exact[k - 1]
        ux, uy, vx, vy = ax - x, ay - y, bx - x, by - y
        dot, squares = ux * vx + uy * vy, (ux * ux + uy * uy) * (vx * vx + vy * vy)
        if dot > 0 and dot * dot * under > over * squares:
            return True
    return False


def uncovered_edges(tri: ConstrainedTriangulation, displacement: float) -> Integers:
    """Return input edges whose constraints do not lead from end to end, or away from it."""
    indptr, edge = tri.constraint_inputs
    kept = np.arange(tri.npoints)
    kept[tri.duplicates[:, 0]] = tri.duplicates[:, 1]
    ends, points = kept[tri.input_edges], tri.points
    parts = np.repeat(tri.constraints, np.diff(indptr), axis=0)
    line = points[ends[edge]]
    toward = np.where(line[:, 0] <= line[:, 1], 1, -1)
    (x, y), (u, v) = (points[parts[:, 0]] * toward).T, (points[parts[:, 1]] * toward).T
    is_back = (x > u) | ((x == u) & (y > v))
    tail, head = (np.where(is_back, parts[:, 1 - k], parts[:, k]) for k in (0, 1))
    far = distances(line, points[head]) > displacement
    needed = np.flatnonzero(ends[:, 0] != ends[:, 1])
    leaves = np.sort(np.concatenate([pair_keys(edge, tail), pair_keys(needed, ends[needed, 1])]))
    enters = np.sort(np.concatenate([pair_keys(edge, head), pair_keys(needed, ends[needed, 0])]))
    wrong = np.setxor1d(leaves, enters), leaves[1:][leaves[1:] == leaves[:-1]]
    return np.unique(np.concatenate([*wrong, edge[far].astype(np.int64) << 32]) >> 32)
