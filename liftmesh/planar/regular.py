"""regular(): planar regular triangulations of weighted points, the duals of power diagrams.

A point p of weight w is lifted to z = |p|^2 - w. The lower hull of the lifted points projects to
the regular triangulation; rows above it are hidden.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Progress, Reals
from liftmesh.base.arrays import as_coordinates, of_one_array
from liftmesh.base.options import NonFinite, RowOrder, as_switch
from liftmesh.base.threads import as_threads
from liftmesh.planar.delaunay import check_options, solution_of
from liftmesh.planar.meshes import rows_of
from liftmesh.planar.regular_triangulation import RegularTriangulation
from liftmesh.planar.weights import Weights, as_weights, chosen, named_values


@of_one_array
def regular(
    points: ArrayLike,
    *,
    weights: ArrayLike | str | None = None,
    radii: ArrayLike | str | None = None,
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
    copy: bool = False,
) -> RegularTriangulation:
    """Compute the regular triangulation of weighted points, exact for every finite double.

    It is the dual of the power diagram: a point x belongs to the row p of least power
    |x - p|^2 - w, and two rows whose cells share a side share an edge. With equal weights, it is
    the Delaunay triangulation. A row whose lifted point is strictly above the lower hull has no
    cell: it is hidden. The result is unique: where four or more lifted points lie in a plane, it is
    that of the symbolic perturbation of `delaunay`.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, as for `delaunay`.
    weights : (n,) array_like or str, optional
        The weight of each row, positive or not: numbers as for `points`, read in place where they
        are floats. Or the name of them: of named values of a `Cloud`, of a tensor cloud of Open3D,
        of a column of a table, or "weights" for those of a ``trimesh.PointCloud``.
    radii : (n,) array_like or str, optional
        Instead of weights, the radius of a circle around each row, not negative: its weight is the
        square of the radius, which is never rounded.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity, in the coordinates or as weight, raise an error, or are
        skipped and listed in ``skipped``.
    order, threads, progress
        As for `delaunay`.
    copy : bool, default False
        Whether to copy points and weights first, as for `delaunay`.

    Returns
    -------
    RegularTriangulation
        Indices are rows of `points`; nothing is reordered or dropped. Of rows at one position the
        heaviest is the vertex, and the others are in ``hidden``; of several that weigh as much it
        is the first, and the others are in ``duplicates``. If it is hidden, so are they all. A row
        that is exactly on a facet of the lower hull is a vertex; ``degenerate`` lists it.

    Raises
    ------
    InputError
        As for `delaunay`; or both or neither of weights and radii are given, there is not one for
        each row, a radius is negative, or the points have no values of that name.
    NonFiniteError
        A coordinate, a weight or a radius is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    UnsupportedTypeError
        `points` is a path, or a column for each axis was given.

    Notes
    -----
    F. Aurenhammer, "Power diagrams: properties, algorithms and applications", SIAM J. Comput. 16
    (1987), for the diagram and the lift. The triangles come from divide and conquer on the lifted
    lower hull, as for `delaunay`, whose merges also remove what becomes hidden (see
    ARCHITECTURE.md): O(n log n) on every input. Peak memory is about 90 bytes per point beyond the
    points and the weights, of which the result is up to 48.

    Examples
    --------
    >>> corners = [[0, 0], [4, 0], [4, 4], [0, 4], [2, 1]]
    >>> tri = regular(corners, weights=[0, 0, 0, 0, 1])
    >>> tri
    <RegularTriangulation: 4 triangles over 5 rows, 0 duplicates, 0 skipped, 0 hidden>
    >>> regular(corners, weights=[9, 0, 0, 0, -9]).hidden
    array([4], dtype=int32)
    >>> regular(corners, radii=[6, 0, 0, 0, 0]).simplices.shape
    (2, 3)
    """
    kind, given = chosen(weights, radii)
    if isinstance(given, str):
        points, given = _named(points, kind, given)
    options = (nonfinite, order, threads, progress, copy)
    return RegularTriangulation(**solve(rows_of(points), kind, given, *options))


def _named(points: Any, kind: str, name: str) -> tuple[ArrayLike, ArrayLike]:
    """Return the points of a cloud or table and its values of a name."""
    from liftmesh.io.registry import as_cloud  # noqa: PLC0415 - arrays do without

    cloud = as_cloud(points)
    return cloud.points, named_values(cloud, kind, name)


def solve(
    points: ArrayLike,
    kind: str,
    given: Any,
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
    copy: bool = False,
) -> dict[str, Any]:
    """Compute what a `RegularTriangulation` is made of."""
    check_options(nonfinite, order, progress)
    is_copied = as_switch("copy", copy)
    rows = as_coordinates(points)
    values = as_weights(kind, given, len(rows))
    planar = rows if rows.shape[1] == 2 else rows[:, :2]
    if is_copied:
        planar, values = planar.copy(), Weights(kind, values.values.copy())
    is_skipping = nonfinite == "skip"
    outcome, hidden = _kernel.regular(
        _without_skipped(planar, values, skipping=is_skipping),
        values.values,
        kind == "radii",
        is_skipping,
        *as_threads(threads, len(rows)),
        progress,
    )
    more = {"hidden": hidden, kind: values.values}
    return solution_of(outcome, rows, planar, order, progress, more)


def _without_skipped(planar: Reals, values: Weights, *, skipping: bool) -> Reals:
    """Return the points, or a copy that marks rows whose weight is not finite."""
    finite = values.finite(skipping=skipping)
    if finite is None:
        return planar
    marked: Reals = planar.copy()
    marked[~finite] = np.nan
    return marked
