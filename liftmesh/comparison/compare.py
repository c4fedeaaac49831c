"""compare(): liftmesh's lower hull and trimesh's convex hull of the same lifted points."""

from __future__ import annotations

import sys
from time import perf_counter
from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Apex, Floats
from liftmesh.base.arrays import used_rows
from liftmesh.base.options import NonFinite, as_count, check_option
from liftmesh.comparison.differences import find_cells, find_differences
from liftmesh.comparison.hull import trimesh_hull
from liftmesh.comparison.proofs import Evidence
from liftmesh.comparison.report import Comparison
from liftmesh.comparison.solid import HullComparison, compare_hulls
from liftmesh.errors import InputError, Option
from liftmesh.io.read import read_for_surface
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.kinds import options_of
from liftmesh.planar.lifting import resolve_apex
from liftmesh.planar.triangulation import Triangulation
from liftmesh.space.convex_hull import ConvexHull
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.surface import Surface


@overload
def compare(  # type: ignore[overload-overlap]
    cloud: ConvexHull, *, max_proofs: int = ...
) -> HullComparison: ...


@overload
def compare(
    cloud: object,
    *,
    apex: Apex = ...,
    plane: Literal["xy", "xz", "yz", "fit"] | ArrayLike = ...,
    nonfinite: NonFinite = ...,
    max_proofs: int = ...,
) -> Comparison: ...


def compare(
    cloud: object,
    *,
    apex: Apex = "median",
    plane: Literal["xy", "xz", "yz", "fit"] | ArrayLike = "xy",
    nonfinite: NonFinite = "error",
    max_proofs: int = 10,
) -> Comparison | HullComparison:
    """Compare liftmesh's triangles with the lower facets of trimesh's convex hull.

    Parameters
    ----------
    cloud : array, Cloud, trimesh or Open3D object, path, Triangulation, Surface or ConvexHull
        The points, or their triangulation; of a file, the rows that `triangulate` takes. A hull of
        points in space is compared with trimesh's convex hull of these points, which are not
        lifted; only `max_proofs` can be given with it.
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
    Comparison or HullComparison
        Counts, rows, proofs and times, with a text form for ``print``; of a hull a
        `HullComparison`, with exact proofs that points lie outside trimesh's facets.

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
    convex_hull : The hull of points in space, which is compared without lifting.

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
    if isinstance(cloud, ConvexHull):
        given = {
            "apex": apex != "median",
            "plane": plane != "xy",
            "nonfinite": nonfinite != "error",
        }
        for name in (name for name, is_given in given.items() if np.any(is_given)):
            raise InputError(f"a convex hull is compared without {Option(name, ...)}: leave it out")
        return compare_hulls(cloud, most)
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
