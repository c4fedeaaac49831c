"""Barycentric transforms of triangles, in the form in which SciPy's interpolators read them.

The transform of a triangle with the corners a, b and c inverts the matrix with the columns a - c
and b - c. An inverse has three digits or more if the reciprocal condition number of its matrix is
at least 1000 eps. SciPy gives NaN below that, and so does this module: the interpolators treat
such slivers apart. SciPy estimates the norm of the inverse, from below; here it is computed, so
what is NaN for SciPy is NaN here.

Each matrix is first scaled by a power of two, which is exact: products of very large or very small
differences would overflow or vanish otherwise.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array, Floats, Rows

_WORST = 2.0**-42  # 1024 eps: what SciPy allows, and a margin for rounding


def barycentric_transforms(points: Floats, simplices: Rows) -> Floats:
    """Compute the barycentric transforms of triangles."""
    origin = points[simplices[:, 2]]
    result = np.empty((len(simplices), 3, 2))
    result[:, 2] = origin
    with np.errstate(all="ignore"):
        sides = np.stack([points[simplices[:, 0]] - origin, points[simplices[:, 1]] - origin])
        exponents = np.frexp(np.abs(sides).max(axis=(0, 2)))[1]
        (ax, ay), (bx, by) = np.moveaxis(np.ldexp(sides, -exponents[:, None]), 2, 1)
        area = ax * by - ay * bx
        result[:, 0] = np.ldexp(np.stack([by, -bx]) / area, -exponents).T
        result[:, 1] = np.ldexp(np.stack([-ay, ax]) / area, -exponents).T
        accurate = np.abs(area) >= _WORST * _norms(ax, ay, bx, by)
        accurate &= np.isfinite(result).all(axis=(1, 2))
    result[~accurate] = np.nan
    return result


def _norms(ax: Array, ay: Array, bx: Array, by: Array) -> Array:
    """Return the product of the matrix's norm and that of its inverse times the determinant."""
    ax, ay, bx, by = np.abs(ax), np.abs(ay), np.abs(bx), np.abs(by)
    norms: Array = np.maximum(ax + bx, ay + by) * np.maximum(ax + ay, bx + by)
    return norms
