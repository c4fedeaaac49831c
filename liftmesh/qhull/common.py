"""What the classes that stand in for SciPy's share: growing, options of Qhull, rows, errors.

Most options of Qhull control how it deals with its rounding errors, or what it prints. An exact
triangulation needs none of them, so they have no effect. The others move, scale, rotate or leave
out points, or choose other triangles.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_coordinates, check_finite, non_finite
from liftmesh.base.options import as_switch
from liftmesh.errors import DegenerateInputError, InputError, NonFiniteError
from liftmesh.optional import load

if TYPE_CHECKING:
    from scipy import spatial
else:
    spatial = load("scipy.spatial", extra="scipy")


class DegenerateQhullError(DegenerateInputError, spatial.QhullError):  # type: ignore[misc]
    """No triangle exists: a `DegenerateInputError` for code that expects SciPy's QhullError."""


class NotIncrementalError(InputError, RuntimeError):
    """Points were added to a result that is finished: a RuntimeError in SciPy."""


class OfAnyDimension(type):
    """Of classes whose instances in space are of another class, which is one of theirs, too."""

    @property
    def __signature__(cls) -> inspect.Signature:
        """That of __init__: older versions of inspect show that of an inherited __new__."""
        _, *rest = inspect.signature(cls.__init__).parameters.values()  # type: ignore[misc]
        return inspect.Signature(rest)

    def __instancecheck__(cls, instance: object) -> bool:
        in_space = cls.__dict__.get("_in_space", ())
        return super().__instancecheck__(instance) or isinstance(instance, in_space)


class Growing(metaclass=OfAnyDimension):
    """The incremental mode: points can be added until it is closed."""

    def __new__(cls, points: Any = None, *given: Any, **named: Any) -> Any:
        """Make an instance of the class for points of these columns."""
        in_space = cls.__dict__.get("_in_space")  # not of classes that users derive
        if in_space is not None and are_in_space(points):
            return in_space(points, *given, **named)
        return super().__new__(cls)

    _kind = "result"  # what is computed, for messages
    _peer = "Delaunay"  # SciPy's class
    _can_grow = False

    if TYPE_CHECKING:  # what the classes have

        @property
        def points(self) -> Floats:
            """The points, (n, d) float64."""

        def _as_rows(self, points: ArrayLike) -> Floats: ...

        def _compute(self, rows: Floats, *, copy: bool) -> None: ...

    def __init__(
        self,
        points: ArrayLike,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        copy: bool = False,
    ) -> None:
        rows = self._as_rows(points)  # first: of columns x and y, the second is no option
        self.furthest_site = as_switch("furthest_site", furthest_site)
        check_qhull_options(qhull_options, self._peer)
        is_growing = as_switch("incremental", incremental)
        self._heed(qhull_options, is_growing=is_growing)
        self._compute(rows, copy=as_switch("copy", copy) or is_growing)
        self._can_grow = is_growing

    def _heed(self, options: str | None, *, is_growing: bool) -> None:
        """Note what options of Qhull change."""

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
        points : array_like of shape (k, d)
            Points of as many columns as those that are there.
        restart : bool, default False
            Accepted for compatibility with SciPy, without effect.

        Raises
        ------
        InputError
            The result was made without ``incremental=True``, or has been closed (the error is a
            RuntimeError too); or `points` have another shape.
        NonFiniteError
            A point is not finite: row 0 is the first of `points`.

        See Also
        --------
        DynamicTriangulation : Triangulates what changes alone.

        Notes
        -----
        All points are triangulated anew, in O(n log n) for n points in all, however few are added:
        0.2 s for a million in the plane. So add points in large groups.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.scipy.Delaunay([[0, 0], [2, 0], [0, 2]], incremental=True)
        >>> tri.add_points([[2, 2], [1, 1]])
        >>> tri.npoints, tri.nsimplex
        (5, 4)
        """
        if not self._can_grow:
            raise NotIncrementalError(
                f"points can be added only to a {self._kind} made with incremental=True, until it "
                "is closed"
            )
        added = self._as_rows(points)
        check_finite(added, skippable=False)
        if len(added):
            self._compute(np.concatenate([self.points, added]), copy=False)

    def close(self) -> None:
        """End the incremental mode: afterwards no points can be added.

        See Also
        --------
        liftmesh.scipy.Delaunay.add_points : What it ends.

        Examples
        --------
        >>> import liftmesh
        >>> diagram = liftmesh.scipy.Voronoi([[0, 0], [2, 0], [0, 2]], incremental=True)
        >>> diagram.close()
        """
        self._can_grow = False


def are_in_space(points: Any) -> bool:
    """Whether points have more than two columns, unless rows and columns seem exchanged."""
    shape = getattr(points, "shape", None)
    if shape is None:
        with suppress(TypeError, IndexError, KeyError):  # others are named when they are converted
            shape = len(points), len(points[0])
    if not isinstance(shape, tuple) or len(shape) != 2:
        return False
    rows, columns = shape
    return bool(columns == 3 or (columns > 3 and rows > 3))


def planar_rows(points: ArrayLike, kind: str = "Delaunay") -> Floats:
    """Convert points to contiguous rows of float64, which SciPy's compiled code reads."""
    with suppress(ValueError):  # of rows that differ in length, which the conversion names
        array = np.asanyarray(points)
        points = array if array.ndim else points  # what is no array, the conversion names, too
    if isinstance(points, np.ndarray) and are_in_space(points):
        raise InputError(
            f"points have {points.shape[1]} columns where planar ones are needed: give "
            f"points[:, :2] to take their first two, or use liftmesh.scipy.Space{kind}"
        )
    return np.ascontiguousarray(as_coordinates(points), dtype=np.float64)


@contextmanager
def scipys_errors(rows: Floats) -> Iterator[None]:
    """Raise the errors that SciPy's callers expect."""
    try:
        yield
    except DegenerateInputError as error:
        raise DegenerateQhullError(*error.args) from None
    except NonFiniteError as error:  # whose remedy is an option that SciPy's class has not
        raise non_finite(error.row, rows[error.row], skippable=False) from None


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
