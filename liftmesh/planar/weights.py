"""The options ``weights`` and ``radii``: one number for each row, or the name of such numbers.

A weight lowers the lifted row; a radius does so by its square, which nobody computes: the kernel
decides with the radius itself. So radii stay radii, wherever they go.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Mask, Reals
from liftmesh.base.arrays import as_floats, is_readable, unmasked
from liftmesh.base.options import counted, shown
from liftmesh.errors import InputError, NonFiniteError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

ONE_EACH = {"weights": "weight", "radii": "radius"}


@dataclass(frozen=True, slots=True, eq=False)
class Weights:
    """The weights or the radii of rows."""

    kind: str
    values: Reals

    def finite(self, *, skipping: bool) -> Mask | None:
        """Check the values."""
        one = ONE_EACH[self.kind]
        if self.kind == "radii" and len(self.values) and (negative := self.values < 0).any():
            row = int(negative.argmax())
            raise InputError(
                f"row {row} has the radius {float(self.values[row])!r}: radii are not negative; "
                "weights may be"
            )
        finite = np.isfinite(self.values)
        if finite.all():
            return None
        if not skipping:
            row = int(finite.argmin())
            raise NonFiniteError(
                f"row {row} has the {one} {float(self.values[row])!r}: remove such rows, or skip "
                "them with nonfinite='skip'",
                row=row,
            )
        return finite


def as_weights(kind: str, given: Any, rows: int) -> Weights:
    """Convert weights or radii."""
    try:
        array = np.asanyarray(given)
    except ValueError as error:
        raise InputError(f"{kind} cannot be converted to an array: {error}") from error
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    if array.ndim != 1:
        what = f"are {shown(given)}" if array.ndim == 0 else f"have the shape {array.shape}"
        raise InputError(
            f"{kind} {what}: give an array of one number for each of {counted(rows, 'row')}"
        )
    if len(array) != rows:
        raise InputError(
            f"{kind} hold {counted(len(array), 'number')} for {counted(rows, 'row')}: "
            "give one for each"
        )
    values = as_floats(unmasked(array, kind), kind)
    return Weights(kind, values if is_readable(values) else values.copy())


def chosen(weights: Any, radii: Any) -> tuple[str, Any]:
    """Return the name and the value of the one of the two options that is given."""
    if weights is not None and radii is not None:
        raise InputError("both weights and radii are given: give one of them")
    if weights is None and radii is None:
        raise InputError(
            "neither weights nor radii are given: give one of them, or use delaunay, which needs "
            "none"
        )
    return ("weights", weights) if radii is None else ("radii", radii)


def named_values(cloud: Cloud, kind: str, name: str) -> Any:
    """Return the named values of a cloud that are to be weights or radii."""
    if name in cloud.attributes:
        return cloud.attributes[name]
    there = ", ".join(repr(each) for each in list(cloud.attributes)[:8])
    remedy = f"there are {there}" if there else "they have none; give an array"
    raise InputError(
        f"{kind} are {shown(name)}, and the points have no values of that name: {remedy}"
    )
