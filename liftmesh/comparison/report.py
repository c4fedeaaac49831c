"""The result of a comparison: counts, rows, proofs, and how they read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from liftmesh.cloud import Cloud
from liftmesh.comparison.matching import used_rows
from liftmesh.lifting import LowerHull, lift

if TYPE_CHECKING:
    from liftmesh.comparison.proofs import Proof
    from liftmesh.triangulation import Triangulation

Rows = NDArray[np.int32]
Verdict = Literal["identical", "cocircular", "different", "failed"]

_CONCLUSIONS: dict[Verdict, str] = {
    "identical": "Both sides are right: every triangle is identical.",
    "cocircular": (
        "Both sides are right: they differ only in how they cut exactly cocircular cells, {cells} "
        "of them."
    ),
    "different": "trimesh's hull is wrong: {faults}.",
    "failed": "trimesh has no hull of these points: {error}.",
}
_FAULT = "liftmesh's triangulation is wrong at {violations} edges: please report these points."


@dataclass(frozen=True, eq=False)
class Comparison:
    """liftmesh's triangles held against the lower facets of trimesh's hull.

    ``triangles = identical + cocircular + len(missing)`` and
    ``len(lower) = identical + cocircular + len(wrong)``.

    Parameters
    ----------
    triangulation : Triangulation
        liftmesh's side.
    q : (qx, qy)
        Vertex of the paraboloid.
    hull : (h, 3) ndarray of int32
        All facets of trimesh's hull in rows of the caller, wound outward.
    lower : (l, 3) ndarray of int32
        Its lower facets (Proposition 3.1), counter-clockwise seen from above.
    vertical : int
        Facets of the hull whose planar points are collinear: neither lower nor upper.
    identical : int
        Triangles that both sides have.
    cocircular : int
        Triangles of liftmesh that trimesh's facets replace by others of the same exactly
        cocircular cell: both are right.
    cells : int
        Number of such cells.
    missing : (k, 3) ndarray of int32
        Triangles of liftmesh that trimesh's hull really lacks.
    wrong : (w, 3) ndarray of int32
        Lower facets of trimesh's hull that are really different.
    lost : (j,) ndarray of int32
        Rows that are vertices of liftmesh's lower hull and of no lower facet of trimesh's.
    coincident : int
        Rows that fall onto another one when they are centred and lifted in float64.
    violations : int
        Edges of liftmesh's triangulation that fail the exact local Delaunay test: 0.
    proofs : tuple of Proof
        Exact proofs for the first really different triangles.
    seconds : mapping
        ``"liftmesh"``: the triangulation; ``"trimesh"``: its hull.
    error : str, optional
        Why trimesh has no hull.
    """

    triangulation: Triangulation
    q: tuple[float, float]
    hull: Rows
    lower: Rows
    vertical: int
    identical: int
    cocircular: int
    cells: int
    missing: Rows
    wrong: Rows
    lost: Rows
    coincident: int
    violations: int
    proofs: tuple[Proof, ...]
    seconds: Mapping[str, float]
    error: str | None = None

    @property
    def triangles(self) -> int:
        """Number of liftmesh's triangles."""
        return len(self.triangulation.simplices)

    @property
    def verdict(self) -> Verdict:
        """``"identical"``, ``"cocircular"`` (both right), ``"different"`` or ``"failed"``.

        ``"failed"``: trimesh has no hull, see ``error``.
        """
        if self.error is not None:
            return "failed"
        if len(self.missing) or len(self.wrong) or self.violations:
            return "different"
        return "cocircular" if self.cocircular else "identical"

    @property
    def agrees(self) -> bool:
        """Whether both sides are right: no difference outside of exactly cocircular cells."""
        return self.verdict in {"identical", "cocircular"}

    def lower_hull(self) -> LowerHull:
        """Give liftmesh's lower hull of the lifted points, as a mesh.

        Returns
        -------
        LowerHull
            Vertices are the caller's rows on z = |p - q|^2.
        """
        return self.triangulation.lifted(q=self.q)

    def trimesh_hull(self) -> Cloud:
        """Give trimesh's whole hull on the vertices of :meth:`lower_hull`.

        Returns
        -------
        Cloud
            With faces in rows of the caller, wound outward; none when there is no hull.
        """
        return Cloud(lift(self.triangulation.points, q=self.q), faces=self.hull)

    def trimesh_lower_facets(self) -> Cloud:
        """Give the lower facets of trimesh's hull on the vertices of :meth:`lower_hull`.

        Returns
        -------
        Cloud
            With faces in rows of the caller, counter-clockwise seen from above.
        """
        return Cloud(lift(self.triangulation.points, q=self.q), faces=self.lower)

    def conclusion(self) -> str:
        """Say the verdict in a sentence."""
        sentence = _FAULT if self.violations else _CONCLUSIONS[self.verdict]
        return sentence.format(
            cells=f"{self.cells:,}",
            faults=self._faults(),
            error=self.error,
            violations=f"{self.violations:,}",
        )

    def _faults(self) -> str:
        counts = {
            "it lacks {} lower facets": len(self.missing),
            "has {} that do not belong there": len(self.wrong),
            "lost {} points": len(self.lost),
        }
        return ", ".join(text.format(f"{count:,}") for text, count in counts.items() if count)

    def __str__(self) -> str:
        name_width = max(len(name) for name, _, _ in self.table())
        lines = [f"{'':{name_width}}  {'liftmesh':>12}  {'trimesh':>12}"]
        lines += [f"{name:{name_width}}  {a:>12}  {b:>12}" for name, a, b in self.table()]
        proofs = [f"- {proof}" for proof in self.proofs]
        return "\n".join([*lines, "", self.conclusion(), *proofs])

    def table(self) -> list[tuple[str, str, str]]:
        """Rows of (what, liftmesh's value, trimesh's value) for people to read."""
        lifted = len(used_rows(self.triangulation.npoints, self.triangulation.simplices))
        ours, theirs = (f"{self.seconds[side]:.3f}" for side in ("liftmesh", "trimesh"))
        if self.error is not None:
            counts = {"points on the lower hull": lifted, "lower facets": self.triangles}
            rows = [(name, f"{count:,}", "-") for name, count in counts.items()]
            return [*rows, ("seconds", ours, "-")]
        pairs = {
            "points on the lower hull": (lifted, lifted - len(self.lost)),
            "lower facets": (self.triangles, len(self.lower)),
            "identical": (self.identical, self.identical),
            "cocircular, cut otherwise": (self.cocircular, self.cocircular),
            "really different": (len(self.missing), len(self.wrong)),
        }
        rows = [(name, f"{left:,}", f"{right:,}") for name, (left, right) in pairs.items()]
        return [*rows, ("seconds", ours, theirs)]
