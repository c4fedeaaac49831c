"""What the classes that stand in for SciPy's share: input, errors, incremental mode, options.

Most options of Qhull control how it deals with its rounding errors, or what it prints. An exact
triangulation needs none of them, so they have no effect. The others move, scale, rotate or leave
out points, or choose other triangles.
"""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_coordinates, check_finite, non_finite
from liftmesh.errors import DegenerateInputError, InputError, NonFiniteError
from liftmesh.optional import load
from liftmesh.planar.delaunay import solve, solve_farthest

if TYPE_CHECKING:
    from scipy import spatial
else:
    spatial = load("scipy.spatial")


class DegenerateQhullError(DegenerateInputError, spatial.QhullError):  # type: ignore[misc]
    """No triangle exists: a `DegenerateInputError` for code that expects SciPy's QhullError."""


class NotIncrementalError(InputError, RuntimeError):
    """Points were added to a result that is finished: a RuntimeError in SciPy."""


class Growing:
    """The incremental mode: points can be added until it is closed."""

    _kind = "result"  # what is computed, for messages
    _can_grow = False

    if TYPE_CHECKING:  # what the classes have

        @property
        def points(self) -> Floats:
            """The points, (n, 2) float64."""

        def _compute(self, rows: Floats, *, copy: bool) -> None: ...

    def add_points(
        self,
        points: ArrayLike,
        restart: bool = False,  # noqa: ARG002 - part of SciPy's signature
    ) -> None:
        """Add points, in the incremental mode.

        Their rows follow those that are there. All attributes are new afterwards; what they were
        before stays with those who hold it. If there is an error, nothing has changed.

        Parameters
        ----------
        points : array_like of shape (k, 2)
            Planar points.
        restart : bool, default False
            Accepted for compatibility with SciPy, without effect.

        Raises
        ------
        InputError
            The result was made without ``incremental=True``, or has been closed (the error is a
            RuntimeError too); or `points` are not planar points.
        NonFiniteError
            A point is not finite: row 0 is the first of `points`.

        Notes
        -----
        All points are triangulated anew, in O(n log n) for n points in all, however few are added:
        0.2 s for a million. So add points in large groups.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.Delaunay([[0, 0], [2, 0], [0, 2]], incremental=True)
        >>> tri.add_points([[2, 2], [1, 1]])
        >>> tri.npoints, tri.nsimplex
        (5, 4)
        """
        if not self._can_grow:
            raise NotIncrementalError(
                f"points can be added only to a {self._kind} made with incremental=True, until it "
                "is closed"
            )
        added = planar_rows(points)
        check_finite(added, skippable=False)
        if len(added):
            self._compute(np.concatenate([self.points, added]), copy=False)

    def close(self) -> None:
        """End the incremental mode: afterwards no points can be added.

        Examples
        --------
        >>> import liftmesh
        >>> diagram = liftmesh.Voronoi([[0, 0], [2, 0], [0, 2]], incremental=True)
        >>> diagram.close()
        """
        self._can_grow = False


def solved(rows: Floats, *, furthest_site: bool, copy: bool) -> dict[str, Any]:
    """Triangulate points, with the errors that SciPy's callers expect."""
    try:
        return (solve_farthest if furthest_site else solve)(rows, copy=copy)
    except DegenerateInputError as error:
        raise DegenerateQhullError(*error.args) from None
    except NonFiniteError as error:  # whose remedy is an option that SciPy's class has not
        raise non_finite(error.row, rows[error.row], skippable=False) from None


def planar_rows(points: ArrayLike, kind: str = "Delaunay") -> Floats:
    """Convert points to contiguous rows of float64, which SciPy's compiled code reads."""
    with suppress(ValueError):  # of rows that differ in length, which the conversion names
        array = np.asanyarray(points)
        points = array if array.ndim else points  # what is no array, the conversion names, too
    if isinstance(points, np.ndarray):
        _refuse_space(points.shape, kind)
    rows = as_coordinates(points)
    return np.ascontiguousarray(rows, dtype=np.float64)


def _refuse_space(shape: tuple[int, ...], kind: str) -> None:
    """Raise for points of more than two columns, unless rows and columns seem exchanged."""
    if len(shape) == 2 and shape[1] > 2 and (shape[0] > 3 or shape[1] == 3):
        raise InputError(
            f"points have {shape[1]} columns, and liftmesh triangulates the plane: give "
            f"points[:, :2] to take their first two, or use scipy.spatial.{kind} for {shape[1]} "
            "dimensions"
        )


_HARMLESS = re.compile(
    r"d|Qt"  # a Delaunay triangulation, in triangles: SciPy's own
    r"|Qbb|Qz|Qs|Qf|Qr|Qa"  # how the hull is built, and the lift scaled for that
    r"|Qc|Qi"  # rows that are no vertex are listed in any case
    r"|Qx|Qv|Q[0-9]|Q1[0-5]|C-0"  # how facets that rounding spoilt are merged
    r"|Qw|Pp|Po|Ts|Tv|Tz|[finopsmx]|F\w"  # warnings, checks and printed output
)
_JOGGLES = re.compile(r"QJ.*|R\d.*")
_OF_RESULT = {  # what there is instead, and where rows at one position are listed
    "Delaunay": ("triangulation", "coplanar"),
    "Voronoi": ("diagram", "duplicates"),
}


def check_qhull_options(options: str | None, kind: str = "Delaunay") -> None:
    """Raise if options of Qhull would change a triangulation."""
    if options is not None and not isinstance(options, str):
        raise InputError(
            f"qhull_options are a {type(options).__name__}: give a string, such as 'Qbb Qc Qz'"
        )
    for option in (options or "").split():
        if not _HARMLESS.fullmatch(option):
            raise InputError(f"qhull_options: {option!r} {_reason(option, kind)}")


def _reason(option: str, kind: str) -> str:
    result, listed = _OF_RESULT[kind]
    if _JOGGLES.fullmatch(option):
        return (
            f"moves the points at random, for which an exact {result} has no need: leave it "
            f"out (rows at one position stay duplicates, listed in `{listed}`)"
        )
    if option == "Qu":
        return "is furthest_site=True here"
    return (
        f"may give another {result} than that of the points: leave it out, or use "
        f"scipy.spatial.{kind}"
    )
