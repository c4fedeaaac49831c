"""Whether arrays are the Delaunay graph of disks: what `verify` does with an `ApolloniusGraph`.

The kernel checks triangles, edges, the hull and the rows; the proof that this suffices stands at
the top of `verify/disks.cpp`.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Indices, Mask, Progress, Rows
from liftmesh.base.options import check_progress, counted
from liftmesh.base.threads import as_threads
from liftmesh.disks.apollonius import are_finite, as_disks
from liftmesh.disks.violations import BEYOND, MEANINGS, DiskEvidence, Place
from liftmesh.errors import InputError
from liftmesh.planar.certificate import Certificate, Flaw

if TYPE_CHECKING:
    from liftmesh.disks.graph import ApolloniusGraph

_SHAPES = {"simplices": (3,), "neighbors": (3,), "convex_hull": (2,), "hidden": ()}
_SHAPES |= {"duplicates": (2,), "skipped": ()}
_OF_ROWS = ("missing_vertices", "wrong_hidden", "wrong_duplicates")


def verify_graph(
    graph: ApolloniusGraph, *, threads: int | None = None, progress: Progress | None = None
) -> Certificate:
    """Verify exactly that a graph, from any source, is the Delaunay graph of its disks."""
    check_progress(progress)
    disks = as_disks(graph.centers, graph.radii, "skip" if len(graph.skipped) else "error")
    lists = {name: _whole(name, getattr(graph, name), shape) for name, shape in _SHAPES.items()}
    circles = _as_circles(graph.circles, len(lists["simplices"]))
    if len(lists["neighbors"]) != len(lists["simplices"]):
        raise InputError(
            f"neighbors have {counted(len(lists['neighbors']), 'row')} for "
            f"{counted(len(lists['simplices']), 'triangle')}: give one for each"
        )
    skipped = lists.pop("skipped")
    finite = are_finite(disks)
    rows = np.flatnonzero(finite)
    flat = {name: _among(finite, name, values) for name, values in lists.items()}
    vertices, places = _kernel.verify_apollonius(
        disks[rows],
        *(flat["simplices"], flat["neighbors"], circles.reshape(-1)),
        *(flat["convex_hull"], flat["hidden"], flat["duplicates"]),
        *as_threads(threads, len(disks)),
        progress,
    )
    evidence = DiskEvidence(disks[:, :2], lists)
    found = zip(MEANINGS, places, strict=True)
    flaws = [
        evidence.flaw(kind, count, _in_all_rows(rows, kind, first))
        for kind, (count, first) in found
        if count
    ]
    if skipped.tolist() != np.flatnonzero(~finite).tolist():
        text = "the rows that are said to be skipped are others than those that are not finite"
        flaws.append(Flaw("other_skipped", 1, text))
    certificate = _certify(disks, lists, vertices, flaws)
    if progress is not None:
        progress(1.0)
    return certificate


def _among(finite: Mask, name: str, values: Rows) -> Rows:
    """Count rows without those that are not finite, which become none."""
    flat = values.reshape(-1)
    if name == "neighbors" or finite.all():
        return flat
    places = np.where(finite, np.cumsum(finite) - 1, BEYOND)
    is_row = (flat >= 0) & (flat < len(finite))
    return np.where(is_row, places[np.where(is_row, flat, 0)], BEYOND).astype(np.int32)


def _in_all_rows(rows: Indices, kind: str, places: list[Place]) -> list[Place]:
    """Count rows with all others again, where places are rows."""
    if kind not in _OF_ROWS:
        return places
    is_pair = kind == "wrong_duplicates"
    return [(int(rows[at]), int(rows[other]) if is_pair else other) for at, other in places]


def _certify(
    disks: Floats, lists: dict[str, Rows], vertices: int, flaws: list[Flaw]
) -> Certificate:
    is_counted = not any(flaw.kind == "invalid_index" for flaw in flaws)
    triangles, hull = len(lists["simplices"]), len(lists["convex_hull"])
    return Certificate(
        rows=len(disks),
        skipped=int((~are_finite(disks)).sum()),
        vertices=vertices if is_counted else None,
        duplicates=len(lists["duplicates"]) if is_counted else None,
        merged=0 if is_counted else None,
        triangles=triangles,
        edges=(3 * triangles + hull) // 2 if is_counted else None,
        hull_edges=hull if is_counted else None,
        flaws=tuple(sorted(flaws, key=_comes_last)),
        points_sha256=_sha256(disks[:, :2], "<f8"),
        simplices_sha256=_sha256(lists["simplices"], "<i4"),
        version=_kernel.VERSION,
        member="apollonius",
        hidden=len(lists["hidden"]) if is_counted else None,
        values_sha256=_sha256(disks[:, 2], "<f8"),
    )


def _comes_last(flaw: Flaw) -> bool:
    return flaw.kind == "not_canonical"


def _whole(name: str, given: ArrayLike, columns: tuple[int, ...]) -> Rows:
    """Convert a list of rows or triangles to int32."""
    array: Any = np.asarray(given)
    if array.size == 0:
        return np.empty((0, *columns), dtype=np.int32)
    if array.ndim != 1 + len(columns) or array.shape[1:] != columns or array.dtype.kind not in "iu":
        shape = f"(k, {columns[0]})" if columns else "(k,)"
        raise InputError(
            f"{name} have the shape {array.shape} and the type {array.dtype}: give whole numbers "
            f"of the shape {shape}"
        )
    fits = (array > BEYOND) & (array < -BEYOND)
    return np.ascontiguousarray(np.where(fits, array, BEYOND), dtype=np.int32)


def _as_circles(given: ArrayLike, triangles: int) -> Floats:
    array: Any = np.asarray(given)
    if array.size == 0 and triangles == 0:
        return np.empty((0, 3))
    if array.shape != (triangles, 3) or array.dtype.kind not in "fiu":
        raise InputError(
            f"circles have the shape {array.shape} and the type {array.dtype}: give three numbers "
            f"for each of {triangles:,} triangles"
        )
    return np.ascontiguousarray(array, dtype=np.float64)


def _sha256(values: Floats | Rows, dtype: str) -> str:
    return hashlib.sha256(np.ascontiguousarray(values, dtype=dtype).data).hexdigest()
