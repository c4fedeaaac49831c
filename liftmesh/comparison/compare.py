"""`compare`: liftmesh's lower hull and trimesh's convex hull of the same lifted points.

The planar coordinates passed to Qhull are centred, which makes them as small as possible; z is
|p - a|^2 of the caller's own coordinates. `trimesh.convex.convex_hull` then drops points that are
not a vertex, merges vertices closer than 1e-8 and renumbers the rest, but never changes a
coordinate: so its vertices are identified by exact equality of all three coordinates. Centring
rounds, and rows may coincide: such rows are counted, and the first represents them all.

Lower facets are identified by Proposition 3.1: n_z < 0 for the outward normal n of the facet. The
sign of n_z is the planar orientation of the facet's three points, and is computed exactly from the
caller's coordinates. A facet whose planar points are collinear is vertical.

Qhull lets other threads run but never checks for Ctrl-C, and takes minutes for a million points. It
runs in its own thread; an interrupted caller continues at once, and the thread, a daemon, ends with
Qhull or with the process. A process that goes down in order while the thread runs compiled code may
end by SIGABRT: the command line ends at once instead (`cli.signals`).
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from threading import Thread
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Apex, Floats, Indices, Rows
from liftmesh.base.arrays import starts_of_runs, used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import NonFinite, as_count, check_option
from liftmesh.comparison.differences import Evidence, find_cells, find_differences
from liftmesh.errors import InputError
from liftmesh.io.read import read_for_surface
from liftmesh.optional import load
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.kinds import options_of
from liftmesh.planar.lifting import LowerHull, lift, resolve_apex
from liftmesh.planar.triangulation import Triangulation
from liftmesh.predicates import orient2d
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.surface import Surface

if TYPE_CHECKING:
    from liftmesh.comparison.differences import Proof

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


def compare(
    cloud: object,
    *,
    apex: Apex = "median",
    plane: Literal["xy", "xz", "yz", "fit"] | ArrayLike = "xy",
    nonfinite: NonFinite = "error",
    max_proofs: int = 10,
) -> Comparison:
    """Compare liftmesh's triangles with the lower facets of trimesh's convex hull.

    Parameters
    ----------
    cloud : array, Cloud, trimesh or Open3D object, path, Triangulation or Surface
        The points, or their triangulation; of a file, the rows that `triangulate` takes.
    apex : {"median", "origin"} or (2,) array_like, default "median"
        Apex of the paraboloid, as for `lift`. With the median, heights are small wherever the
        points lie, which is the best case for Qhull, which rounds; with the origin, the heights of
        points far away lose digits. liftmesh's triangles do not depend on the apex.
    plane : str, normal or matrix, default "xy"
        Projection plane for 3-D points, as for `triangulate`. Not used for a Triangulation or a
        Surface.
    nonfinite : {"error", "skip"}, default "error"
        Policy for rows that hold NaN or infinity.
    max_proofs : int, default 10
        Maximum number of exact proofs for really different triangles. Counts are always complete.

    Returns
    -------
    Comparison
        Counts, rows, proofs and times, with a text form for ``print``.

    Raises
    ------
    InputError
        Points, `apex` or an option are invalid, or the triangulation is one by weights, radii, a
        metric or the farthest site.
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    FormatError
        `cloud` is the path to a file that cannot be read.

    See Also
    --------
    verify : An exact check of any triangulation.
    lower_hull : The lower hull of points in space.

    Notes
    -----
    trimesh merges vertices closer than 1e-8, and Qhull rounds: points missing from its hull are
    listed in ``lost``; if it finds no hull at all, ``error`` gives the reason.

    Examples
    --------
    >>> from liftmesh import compare
    >>> result = compare([[0, 0], [4, 0], [0, 4], [3, 3], [1, 1]])
    >>> result.verdict, result.n_identical
    ('identical', 4)
    """
    most = min(as_count("max_proofs", max_proofs, 0), sys.maxsize)
    triangulation, seconds = _triangulate(cloud, plane, nonfinite)
    triangles = triangulation.simplices
    rows = used_rows(triangulation.npoints, triangles)
    place = resolve_apex(apex, triangulation.points[rows])
    hull = trimesh_hull(triangulation.points, rows, place)
    cells = find_cells(triangulation.points, triangles, triangulation.neighbors)
    differences = find_differences(triangles, cells, hull.lower)
    evidence = Evidence(triangulation, rows, hull.lower, cells, differences)
    return Comparison(
        triangulation=triangulation,
        apex=place,
        hull=hull.facets,
        lower=hull.lower,
        n_vertical=hull.vertical,
        n_identical=differences.identical,
        n_cocircular=differences.cocircular,
        n_cells=differences.cells,
        missing=triangles[differences.missing],
        wrong=hull.lower[differences.wrong],
        lost=np.setdiff1d(rows, used_rows(triangulation.npoints, hull.lower), assume_unique=True),
        n_coincident=hull.coincident,
        n_violations=len(cells.violations),
        proofs=() if hull.error else tuple(evidence.proofs(most)),
        seconds={"liftmesh": seconds, "trimesh": hull.seconds},
        error=hull.error,
    )


def _triangulate(
    source: object, plane: ArrayLike, nonfinite: NonFinite
) -> tuple[Triangulation, float]:
    """Return the triangulation and its time; a given one is recomputed to measure the time."""
    # The new one stands for a given one to whose triangles the caller may have written.
    check_option("nonfinite", nonfinite, NonFinite)
    if isinstance(source, Surface):
        source = source.triangulation
    if isinstance(source, Triangulation):
        _refuse_members(source)
        again, seconds = _timed(source.points, "skip")
        return again if source.simplices.flags.writeable else source, seconds
    cloud = read_for_surface(source)
    return _timed(resolve_plane(plane, cloud.points).planar(cloud.points), nonfinite)


def _refuse_members(source: Triangulation) -> None:
    """Raise for triangulations that are not the lower hull of the paraboloid."""
    for name in options_of(source):
        raise InputError(
            f"a triangulation by {name} has no counterpart here: compare takes Delaunay "
            "triangulations; verify judges others exactly"
        )


def _timed(points: Floats, nonfinite: NonFinite) -> tuple[Triangulation, float]:
    start = perf_counter()
    triangulation = delaunay(points, nonfinite=nonfinite)
    return triangulation, perf_counter() - start


Result = TypeVar("Result")
_NO_FACETS = np.empty((0, 3), dtype=np.int32)


@dataclass(frozen=True, slots=True, eq=False)
class HullFacets:
    """The facets of trimesh's hull in the caller's rows."""

    facets: Rows  # outward
    lower: Rows  # counter-clockwise seen from above
    vertical: int
    coincident: int  # rows equal to another once centred and lifted
    seconds: float
    error: str | None = None  # why there is no hull


def trimesh_hull(points: Floats, rows: Rows, apex: tuple[float, float]) -> HullFacets:
    """Build trimesh's convex hull of the lifted rows."""
    lifted = _lifted(points, rows, apex)
    mesh, seconds, error = _convex_hull(lifted)
    if mesh is None:
        return HullFacets(_NO_FACETS, _NO_FACETS, 0, 0, seconds, error)
    match, coincident = _match(lifted, np.asarray(mesh.vertices))
    facets = rows[match[np.asarray(mesh.faces)]].reshape(-1, 3)
    n_z = orient2d(*points[facets.T])
    lower = np.ascontiguousarray(facets[n_z < 0][:, ::-1])
    return HullFacets(facets, lower, int((n_z == 0).sum()), coincident, seconds)


def _lifted(points: Floats, rows: Rows, apex: tuple[float, float]) -> Floats:
    """Return centred x and y with z = |p - a|^2, without negative zeros."""
    centre = resolve_apex("median", points[rows])
    with np.errstate(over="ignore", invalid="ignore"):
        z = lift(points[rows], apex=apex)[:, 2]
        lifted = np.column_stack([points[rows] - np.asarray(centre), z])
    return lifted + 0.0


def _convex_hull(lifted: Floats) -> tuple[Any, float, str | None]:
    """Build trimesh's hull; return it (or None), the seconds it took, and the error if any."""
    if not np.isfinite(lifted).all():
        return None, 0.0, "the lifted coordinates exceed float64"
    convex, qhull = load("trimesh.convex"), load("scipy.spatial")

    def build() -> Any:
        with np.errstate(all="ignore"):
            return convex.convex_hull(lifted)

    start = perf_counter()
    try:
        mesh = interruptible(build)
    except qhull.QhullError as error:
        return None, perf_counter() - start, _first_line(error)
    seconds = perf_counter() - start
    if len(mesh.faces) == 0:
        return None, seconds, "trimesh drops all its facets: they are smaller than its tolerances"
    return mesh, seconds, None


def interruptible(work: Callable[[], Result]) -> Result:
    """Run a function in another thread and wait for it."""
    future: Future[Result] = Future()
    Thread(target=_run, args=(work, future), daemon=True).start()
    return future.result()


def _run(work: Callable[[], Result], future: Future[Result]) -> None:
    try:
        future.set_result(work())
    except BaseException as error:  # noqa: BLE001 - the waiting thread raises it
        future.set_exception(error)


def _first_line(error: Exception) -> str:
    """Return Qhull's message without the error number and the long explanation."""
    line = str(error).strip().splitlines()[0]
    return re.sub(r"^QH\d+ ", "", line).rstrip(". ")


def _match(lifted: Floats, vertices: Floats) -> tuple[Indices, int]:
    """Return the first row of ``lifted`` equal to each vertex, and the number of repeated rows."""
    # A stable sort of both together makes equal triples adjacent, rows first.
    both = np.concatenate([lifted, vertices])
    order = np.lexsort((both[:, 2], both[:, 1], both[:, 0]))
    is_new = starts_of_runs(both[order])
    first = order[is_new]
    group = np.empty(len(both), dtype=np.intp)
    group[order] = np.cumsum(is_new) - 1
    return first[group[len(lifted) :]], len(lifted) - len(first)
