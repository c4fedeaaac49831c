"""Which member of the family a triangulation is said to be: by what its points are lifted.

Delaunay triangulations are the lower hull of z = x^2 + y^2. Weights or radii lower the rows, a
metric is another quadratic form, and the farthest-point triangulation is the upper hull, or the
lower hull of z = -x^2 - y^2.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats
from liftmesh.base.options import as_switch
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.planar.metric import as_metric
from liftmesh.planar.weights import ONE_EACH, Weights, as_weights, named_values
from liftmesh.predicates import incircle

_NONE = np.empty(0)


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """A member of the family, and what it needs to be known."""

    kind: str = "delaunay"
    values: Floats = field(default_factory=lambda: _NONE)

    @property
    def has_values(self) -> bool:
        """Whether each row has one."""
        return self.kind in ("weights", "radii")

    @property
    def may_hide(self) -> bool:
        """Whether rows may be hidden: strictly above the lower hull."""
        return self.has_values or self.kind == "farthest"

    @property
    def metric(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """The matrix, if it is a metric."""
        if self.kind != "metric":
            return None
        a, b, c = self.values.tolist()
        return (a, b), (b, c)

    @property
    def values_sha256(self) -> str | None:
        """The SHA-256 sum of the values as little-endian float64, if each row has one."""
        if not self.has_values:
            return None
        return hashlib.sha256(np.ascontiguousarray(self.values, dtype="<f8").data).hexdigest()

    def non_finite(self, row: int) -> NonFiniteError | None:
        """Return the error for a row whose value is not finite; None if it is."""
        if not self.has_values or np.isfinite(self.values[row]):
            return None
        return NonFiniteError(
            f"row {row} has the {ONE_EACH[self.kind]} {float(self.values[row])!r}: remove such "
            "rows, or skip them with nonfinite='skip'",
            row=row,
        )

    def side(self, rows: tuple[int, ...], points: tuple[tuple[float, float], ...]) -> int:
        """Return the exact side of a lifted row: positive below the plane of three others."""
        if self.kind in ("delaunay", "farthest"):
            sign = int(incircle(*points))
            return -sign if self.kind == "farthest" else sign
        values = self.values[list(rows)] if self.has_values else self.values
        a, b, c, d = (np.array([point], dtype=np.float64) for point in points)
        signs = np.empty(1, dtype=np.int8)
        _kernel.lifted_side(a, b, c, d, values.reshape(1, -1), self.kind, signs, canonical=False)
        return int(signs[0])


def as_member(
    rows: int,
    weights: ArrayLike | None,
    radii: ArrayLike | None,
    metric: ArrayLike | None,
    furthest_site: bool,
) -> Member:
    """Validate the options of `verify` that tell by what points are lifted."""
    given = {"weights": weights, "radii": radii, "metric": metric}
    named = [name for name, value in given.items() if value is not None]
    is_farthest = as_switch("furthest_site", furthest_site)
    named += ["furthest_site"] if is_farthest else []
    if len(named) > 1:
        raise InputError(f"{' and '.join(named)} are given: give one of them")
    if is_farthest:
        return Member("farthest")
    readers: dict[str, Callable[[Any], Floats]] = {
        "metric": lambda form: as_metric(form).reshape(-1)[[0, 1, 3]],
        "weights": lambda values: _finite_or_nan(as_weights("weights", values, rows)),
        "radii": lambda values: _finite_or_nan(as_weights("radii", values, rows)),
    }
    return Member(named[0], readers[named[0]](given[named[0]])) if named else Member()


def _finite_or_nan(weights: Weights) -> Floats:
    weights.finite(skipping=True)  # raises for negative radii
    return np.ascontiguousarray(weights.values, dtype=np.float64)


def options_of(triangulation: Any) -> dict[str, Any]:
    """Return what a triangulation says about itself, as options of `verify`."""
    metadata = getattr(triangulation, "metadata", None)
    if isinstance(metadata, Mapping) and metadata:
        return _stated(triangulation, metadata)
    if not hasattr(triangulation, "simplices"):
        return {}
    held = {name: getattr(triangulation, name, None) for name in ("weights", "radii", "metric")}
    found = {name: value for name, value in held.items() if value is not None}
    if getattr(triangulation, "furthest_site", False):
        found["furthest_site"] = True
    return found


def _stated(cloud: Any, metadata: Mapping[str, Any]) -> dict[str, Any]:
    """What the metadata of a mesh say, which files keep."""
    from liftmesh.io.metadata import lifted_by  # noqa: PLC0415 - a first triangulation does without

    return {
        kind: value if kind == "metric" else _held(cloud, kind, value)
        for kind, value in lifted_by(metadata).items()
    }


def _held(cloud: Any, kind: str, name: str) -> Any:
    """The values that the metadata name, which some formats leave out."""
    if name not in cloud.attributes:
        raise InputError(
            f"the mesh says that it was triangulated by the {kind} {name!r}, and does not hold "
            f"them: give {kind}, or keep them with it in a format that holds named values, as PLY"
        )
    return named_values(cloud, kind, name)
