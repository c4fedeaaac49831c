"""`Comparison`, the result of `compare`: counts, rows, proofs, and their text form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from liftmesh._typing import Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.frozen import FrozenResult
from liftmesh.planar.lifting import LowerHull, lift

if TYPE_CHECKING:
    from liftmesh.comparison.proofs import Proof
    from liftmesh.planar.triangulation import Triangulation

Verdict = Literal["identical", "cocircular", "different", "failed"]

_CONCLUSIONS: dict[Verdict, str] = {
    "identical": "Both results are correct: all triangles are identical.",
    "cocircular": (
        "Both results are correct: they differ only in the triangulation of exactly cocircular "
        "cells ({cells} of them)."
    ),
    "different": (
        "trimesh's hull of the lifted points, whose heights are rounded, is wrong: {faults}."
    ),
    "failed": "trimesh finds no hull of these points: {error}.",
}
_FAULT = "liftmesh's triangulation is wrong at {violations} edges: please report these points."


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(FrozenResult):
    r"""liftmesh's triangles compared with the lower facets of trimesh's hull.

    ``n_triangles = n_identical + n_cocircular + len(missing)`` and
    ``len(lower) = n_identical + n_cocircular + len(wrong)``.

    Parameters
    ----------
    triangulation : Triangulation
        liftmesh's triangulation.
    apex : tuple of float
        Apex of the paraboloid.
    hull : (h, 3) ndarray of int32
        All facets of trimesh's hull in the caller's rows, oriented outward.
    lower : (l, 3) ndarray of int32
        Its lower facets (Proposition 3.1), counter-clockwise seen from above.
    n_vertical : int
        Facets of the hull whose planar points are collinear: neither lower nor upper.
    n_identical : int
        Triangles that both results have.
    n_cocircular : int
        Triangles of liftmesh that trimesh's facets replace by others in the same exactly
        cocircular cell: both are correct.
    n_cells : int
        Number of such cells.
    missing : (k, 3) ndarray of int32
        Triangles of liftmesh that are really missing in trimesh's hull.
    wrong : (w, 3) ndarray of int32
        Lower facets of trimesh's hull that are really different.
    lost : (j,) ndarray of int32
        Rows that are vertices of liftmesh's lower hull, but of no lower facet of trimesh's.
    n_coincident : int
        Rows that coincide with another row when centred and lifted in float64.
    n_violations : int
        Edges of liftmesh's triangulation that fail the exact local Delaunay test: 0.
    proofs : tuple of Proof
        Exact proofs for the first really different triangles.
    seconds : mapping
        ``"liftmesh"``: the triangulation; ``"trimesh"``: its hull.
    error : str, optional
        Why trimesh finds no hull.

    See Also
    --------
    compare : Makes comparisons.

    Examples
    --------
    With the apex at the origin, the heights of points far away lose digits, and Qhull fails:

    >>> import liftmesh
    >>> result = liftmesh.compare(
    ...     [[9e9, 0], [9e9 + 4, 0], [9e9, 4], [9e9 + 3, 3], [9e9 + 1, 1]], apex="origin"
    ... )
    >>> result
    <Comparison: different, 4 triangles of liftmesh, 2 lower facets of trimesh>
    >>> print(result.conclusion().replace(": ", ":\n"))
    trimesh's hull of the lifted points, whose heights are rounded, is wrong:
    4 lower facets missing, 2 that do not fit, 1 point lost.
    >>> print(str(result.proofs[0]).replace(": ", ":\n"))
    trimesh's facet (0, 1, 3) is wrong:
    row 4 lies strictly inside its circle, in-circle determinant 48 > 0
    """

    triangulation: Triangulation
    apex: tuple[float, float]
    hull: Rows
    lower: Rows
    n_vertical: int
    n_identical: int
    n_cocircular: int
    n_cells: int
    missing: Rows
    wrong: Rows
    lost: Rows
    n_coincident: int
    n_violations: int
    proofs: tuple[Proof, ...]
    seconds: Mapping[str, float]
    error: str | None = None

    def __repr__(self) -> str:
        return (
            f"<Comparison: {self.verdict}, {self.n_triangles:,} triangles of liftmesh, "
            f"{len(self.lower):,} lower facets of trimesh>"
        )

    @property
    def n_triangles(self) -> int:
        """Number of liftmesh's triangles."""
        return len(self.triangulation.simplices)

    @property
    def verdict(self) -> Verdict:
        """``"identical"``, ``"cocircular"`` (both correct), ``"different"`` or ``"failed"``.

        ``"failed"``: trimesh finds no hull, see ``error``.
        """
        if self.error is not None:
            return "failed"
        if len(self.missing) or len(self.wrong) or self.n_violations:
            return "different"
        return "cocircular" if self.n_cocircular else "identical"

    @property
    def agrees(self) -> bool:
        """Whether both results are correct: no difference outside exactly cocircular cells."""
        return self.verdict in {"identical", "cocircular"}

    def lower_hull(self) -> LowerHull:
        """Return liftmesh's lower hull of the lifted points as a mesh.

        Returns
        -------
        LowerHull
            Vertices are the caller's rows on the paraboloid.

        See Also
        --------
        Comparison.trimesh_hull : The other side.
        Triangulation.lifted : The same of a triangulation.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.compare([[0, 0], [2, 0], [0, 2], [3, 3]], apex=(0, 0)).lower_hull().vertices[3]
        array([ 3.,  3., 18.])
        """
        return self.triangulation.lifted(apex=self.apex)

    def trimesh_hull(self) -> Cloud:
        """Return trimesh's whole hull on the vertices of :meth:`lower_hull`.

        Returns
        -------
        Cloud
            With faces in the caller's rows, oriented outward; without faces if there is no hull.

        See Also
        --------
        Comparison.trimesh_lower_facets : Its lower facets alone.

        Examples
        --------
        >>> import liftmesh
        >>> len(liftmesh.compare([[0, 0], [2, 0], [0, 2], [3, 3]]).trimesh_hull().faces)
        4
        """
        return Cloud(lift(self.triangulation.points, apex=self.apex), faces=self.hull)

    def trimesh_lower_facets(self) -> Cloud:
        """Return the lower facets of trimesh's hull on the vertices of :meth:`lower_hull`.

        Returns
        -------
        Cloud
            With faces in the caller's rows, counter-clockwise seen from above.

        See Also
        --------
        Comparison.trimesh_hull : The whole hull.

        Examples
        --------
        >>> import liftmesh
        >>> len(liftmesh.compare([[0, 0], [2, 0], [0, 2], [3, 3]]).trimesh_lower_facets().faces)
        2
        """
        return Cloud(lift(self.triangulation.points, apex=self.apex), faces=self.lower)

    def conclusion(self) -> str:
        """Summarise the verdict in a sentence.

        Returns
        -------
        str
            Which result is correct, and the errors of the other.

        See Also
        --------
        Comparison.table : The counts.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.compare([[0, 0], [2, 0], [0, 2], [3, 3]]).conclusion()
        'Both results are correct: all triangles are identical.'
        """
        sentence = _FAULT if self.n_violations else _CONCLUSIONS[self.verdict]
        return sentence.format(
            cells=f"{self.n_cells:,}",
            faults=self._faults(),
            error=self.error,
            violations=f"{self.n_violations:,}",
        )

    def _faults(self) -> str:
        lost = "point lost" if len(self.lost) == 1 else "points lost"
        counts = {
            "lower facets missing": len(self.missing),
            "that do not fit": len(self.wrong),
            lost: len(self.lost),
        }
        return ", ".join(f"{count:,} {what}" for what, count in counts.items() if count)

    def __str__(self) -> str:
        name_width = max(len(name) for name, _, _ in self.table())
        lines = [f"{'':{name_width}}  {'liftmesh':>12}  {'trimesh':>12}"]
        lines += [f"{name:{name_width}}  {a:>12}  {b:>12}" for name, a, b in self.table()]
        proofs = [f"- {proof}" for proof in self.proofs]
        return "\n".join([*lines, "", self.conclusion(), *proofs])

    def table(self) -> list[tuple[str, str, str]]:
        """List the counts as text.

        Returns
        -------
        list of tuple of str
            Name, liftmesh's value, trimesh's value.

        See Also
        --------
        Comparison.conclusion : The verdict in a sentence.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.compare([[0, 0], [2, 0], [0, 2], [3, 3]]).table()[1]
        ('lower facets', '2', '2')
        """
        lifted = len(used_rows(self.triangulation.npoints, self.triangulation.simplices))
        ours, theirs = (f"{self.seconds[side]:.3f}" for side in ("liftmesh", "trimesh"))
        if self.error is not None:
            counts = {"points on the lower hull": lifted, "lower facets": self.n_triangles}
            rows = [(name, f"{count:,}", "-") for name, count in counts.items()]
            return [*rows, ("seconds", ours, "-")]
        pairs = {
            "points on the lower hull": (lifted, lifted - len(self.lost)),
            "lower facets": (self.n_triangles, len(self.lower)),
            "identical": (self.n_identical, self.n_identical),
            "cocircular, triangulated differently": (self.n_cocircular, self.n_cocircular),
            "really different": (len(self.missing), len(self.wrong)),
        }
        rows = [(name, f"{left:,}", f"{right:,}") for name, (left, right) in pairs.items()]
        if self.n_coincident:
            rows.append(("equal once lifted in float64", "-", f"{self.n_coincident:,}"))
        return [*rows, ("seconds", ours, theirs)]
