"""Kinds of triangulations: the lifts of their points, and the options that choose them.

Delaunay triangulations are the lower hull of z = x^2 + y^2, and the farthest-point triangulation is
the upper hull, or the lower hull of z = -x^2 - y^2.

Weights lower the lifted rows. A radius does so by its square, which nobody computes: the kernel
decides with the radius itself. So radii stay radii, wherever they go.

In a metric M the square of a vector's length is v^T M v. An affine map turns it into the ordinary
one, and the triangulation in it is that of the mapped points; but such a map rounds. Lifted to
z = p^T M p, the points need no map: the coordinates stay, and every sign is exact.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Mask, Reals
from liftmesh.base.arrays import as_floats, is_readable, unmasked, widened
from liftmesh.base.options import as_switch, counted, refused, shown
from liftmesh.errors import InputError, NonFiniteError, Option
from liftmesh.predicates import incircle

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


_NONE = np.empty(0)
METRIC_REMEDY = "give [[a, b], [b, c]] with a > 0 and a c > b^2"
_ONE_EACH = {"weights": "weight", "radii": "radius"}


@dataclass(frozen=True, slots=True, eq=False)
class TriangulationKind:
    """A kind of triangulation, and the weights, radii or metric by which points are lifted."""

    name: str = "delaunay"  # or "weights", "radii", "metric" or "farthest"
    values: Reals = field(default_factory=lambda: _NONE)  # of rows, or a, b, c of a metric

    @property
    def has_values(self) -> bool:
        """Whether each row has one."""
        return self.name in ("weights", "radii")

    @property
    def may_hide(self) -> bool:
        """Whether rows may be hidden: strictly above the lower hull."""
        return self.has_values or self.name == "farthest"

    @property
    def metric(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """The matrix, if it is a metric."""
        if self.name != "metric":
            return None
        a, b, c = self.values.tolist()
        return (a, b), (b, c)

    def finite(self, *, skipping: bool) -> Mask | None:
        """Check the values; return which rows are not to be skipped, None for all."""
        if self.name == "radii" and len(self.values) and (negative := self.values < 0).any():
            row = int(negative.argmax())
            raise InputError(
                f"row {row} has the radius {float(self.values[row])!r}: radii are not negative; "
                "weights may be"
            )
        finite = np.isfinite(self.values)
        if finite.all():
            return None
        if not skipping:
            raise self.non_finite(int(finite.argmin()))
        return finite

    def non_finite(self, row: int, *, skippable: bool = True) -> NonFiniteError:
        """Return the error for a row whose value is not finite."""
        named = f"row {row} has the {_ONE_EACH[self.name]} {float(self.values[row])!r}"
        advice = f", or skip them with {Option('nonfinite', 'skip')}" if skippable else " first"
        return NonFiniteError(f"{named}: remove such rows{advice}", row=row)

    def side(self, rows: tuple[int, ...], points: tuple[tuple[float, float], ...]) -> int:
        """Return the exact side of the last row: 1 if lifted below the plane of a triangle."""
        if self.name in ("delaunay", "farthest"):
            sign = int(incircle(*points))
            return -sign if self.name == "farthest" else sign
        values = self.values[list(rows)] if self.has_values else self.values
        a, b, c, d = (np.array([point], dtype=np.float64) for point in points)
        signs = np.empty(1, dtype=np.int8)
        _kernel.lifted_side(
            a, b, c, d, widened(values).reshape(1, -1), self.name, signs, canonical=False
        )
        return int(signs[0])


def as_kind(
    rows: int,
    weights: ArrayLike | None,
    radii: ArrayLike | None,
    metric: ArrayLike | None,
    furthest_site: bool,
) -> TriangulationKind:
    """Validate the options of `verify` that tell by what points are lifted."""
    given: dict[str, Any] = {"weights": weights, "radii": radii, "metric": metric}
    named = [name for name, value in given.items() if value is not None]
    is_farthest = as_switch("furthest_site", furthest_site)
    named += ["furthest_site"] if is_farthest else []
    if len(named) > 1:
        raise InputError(
            f"{' and '.join(f'{Option(each)}' for each in named)} are given: give one of them"
        )
    if is_farthest:
        return TriangulationKind("farthest")
    if not named:
        return TriangulationKind()
    (name,) = named
    if name == "metric":
        return TriangulationKind(name, as_metric(given[name]).reshape(-1)[[0, 1, 3]])
    kind = as_weights(name, given[name], rows)
    kind.finite(skipping=True)  # raises for negative radii
    return TriangulationKind(name, np.ascontiguousarray(kind.values, dtype=np.float64))


def options_of(triangulation: Any) -> dict[str, Any]:
    """Return what a triangulation says about itself, as options of `verify`."""
    metadata = getattr(triangulation, "metadata", None)
    if isinstance(metadata, Mapping):
        return _stated(triangulation, metadata)
    if not hasattr(triangulation, "simplices"):
        return {}
    names = ("weights", "radii", "metric", "constraints")
    held = {name: getattr(triangulation, name, None) for name in names}
    options = {name: value for name, value in held.items() if value is not None}
    switches = ("furthest_site", "carved", "spherical")
    told = {name: getattr(triangulation, name, False) for name in switches}
    return options | {name: True for name, value in told.items() if value}


def _stated(cloud: Any, metadata: Mapping[str, Any]) -> dict[str, Any]:
    """What the metadata of a mesh say, which files keep; else its edges are constraints."""
    from liftmesh.io.metadata import Provenance  # noqa: PLC0415 - a first triangulation does without

    known = Provenance(metadata)
    said = {
        kind: value if kind in ("metric", "spherical") else _held(cloud, kind, value)
        for kind, value in known.lifted_by.items()
    }
    edges = getattr(cloud, "edges", None)
    if said or edges is None or not len(edges):
        return said
    return {"constraints": edges} | ({"carved": True} if known.carved else {})


def _held(cloud: Any, kind: str, name: str) -> Any:
    """The values that the metadata name, which some formats leave out."""
    if name not in cloud.attributes:
        raise InputError(
            f"the mesh says that it was triangulated by the {kind} {name!r}, and does not hold "
            f"them: give {Option(kind, ...)}, or keep them with it in a format that holds named "
            "values, as PLY"
        )
    return named_values(cloud, kind, name)


def as_weights(kind: str, given: Any, rows: int) -> TriangulationKind:
    """Convert weights or radii, in place where they are floats; masked ones become NaN."""
    try:
        array = np.asanyarray(given)
    except ValueError as error:
        raise InputError(f"{Option(kind)} cannot be converted to an array: {error}") from error
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    if array.ndim != 1:
        what = f"are {shown(given)}" if array.ndim == 0 else f"have the shape {array.shape}"
        raise InputError(
            f"{Option(kind)} {what}: give an array of one number for each of {counted(rows, 'row')}"
        )
    if len(array) != rows:
        raise InputError(
            f"{Option(kind)} hold {counted(len(array), 'number')} for {counted(rows, 'row')}: "
            "give one for each"
        )
    values = as_floats(unmasked(array, kind), kind)
    return TriangulationKind(kind, values if is_readable(values) else values.copy())


def weights_or_radii(weights: Any, radii: Any) -> tuple[str, Any]:
    """Return the name and the value of the one of the two options that is given."""
    if weights is not None and radii is not None:
        raise InputError(
            f"both {Option('weights')} and {Option('radii')} are given: give one of them"
        )
    if weights is None and radii is None:
        raise InputError(
            f"neither {Option('weights')} nor {Option('radii')} are given: give one of them, or "
            "use delaunay, which needs none"
        )
    return ("weights", weights) if radii is None else ("radii", radii)


def named_values(cloud: Cloud, kind: str, name: str) -> Any:
    """Return the named values of a cloud that are to be weights or radii."""
    if name in cloud.attributes:
        return cloud.attributes[name]
    there = ", ".join(repr(each) for each in list(cloud.attributes)[:8])
    remedy = f"there are {there}" if there else "they have none; give points with such a column"
    raise InputError(f"{Option(kind, name)}, and the points have no values of that name: {remedy}")


def as_metric(metric: ArrayLike) -> Floats:
    """Validate the option ``metric``, the matrix of a quadratic form: no other distance is."""
    matrix = as_matrices("metric", metric, (2, 2), METRIC_REMEDY)
    flaw = ""
    if not np.isfinite(matrix).all():
        flaw = "finite"
    elif matrix[0, 1] != matrix[1, 0]:
        flaw = "symmetric"
    elif not is_positive_definite(matrix):
        flaw = "positive definite"
    if flaw:
        reason = f"which is not {flaw}: {METRIC_REMEDY}"
        raise refused("metric", matrix.tolist(), reason, mark=", ")
    return matrix


def is_positive_definite(matrix: Floats) -> bool:
    """Whether a symmetric matrix is positive definite, exactly."""
    a, b, _, c = (Fraction(value) for value in matrix.ravel().tolist())
    return a > 0 and a * c > b * b


def as_matrices(name: str, given: Any, shape: tuple[int, ...], remedy: str) -> Floats:
    """Convert one matrix, or one for each row, to an array of its own."""
    what, verb = ("the metric", "has") if len(shape) == 2 else (name, "have")
    try:
        array = np.asanyarray(given)
    except ValueError as error:
        raise InputError(f"{name} cannot be read as numbers ({error}): {remedy}") from error
    if array.shape != shape:
        raise InputError(f"{name} {verb} the shape {array.shape}, not {shape}: {remedy}")
    flat = unmasked(array.reshape(shape[0], math.prod(shape[1:])), what)
    return np.array(as_floats(flat, what), dtype=np.float64).reshape(shape)
