"""The option ``metric``: the matrix of a quadratic form, which must be positive definite, exactly.

In a metric M the square of a vector's length is v^T M v. An affine map turns it into the ordinary
one, and the triangulation in it is that of the mapped points; but such a map rounds. Lifted to
z = p^T M p, the points need no map: the coordinates stay, and every sign is exact.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_floats, unmasked
from liftmesh.errors import InputError

_REMEDY = "give [[a, b], [b, c]] with a > 0 and a c > b^2"


def as_metric(metric: ArrayLike) -> Floats:
    """Validate the option ``metric``."""
    matrix = _as_matrix(metric)
    shown = matrix.tolist()
    if not np.isfinite(matrix).all():
        raise InputError(f"metric {shown} is not finite: {_REMEDY}")
    (a, b), (other, c) = shown
    if b != other:
        raise InputError(f"metric {shown} is not symmetric: {_REMEDY}")
    if not (a > 0 and Fraction(a) * Fraction(c) > Fraction(b) ** 2):
        raise InputError(f"metric {shown} is not positive definite: {_REMEDY}")
    return matrix


def _as_matrix(metric: Any) -> Floats:
    try:
        given = np.asanyarray(metric)
    except ValueError as error:
        raise InputError(f"metric cannot be read as numbers ({error}): {_REMEDY}") from error
    if given.shape != (2, 2):
        raise InputError(f"metric has the shape {given.shape}, not (2, 2): {_REMEDY}")
    return np.array(as_floats(unmasked(given, "the metric"), "the metric"), dtype=np.float64)
