"""Exact planar predicates for arrays of points: orientation and in-circle tests.

They are exact for all finite doubles: a floating-point filter decides where it can, and
fixed-width integers decide the rest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_pairs, check_finite
from liftmesh.base.options import as_switch

__all__ = ["incircle", "orient2d"]


def orient2d(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> NDArray[np.int8]:
    """Compute the orientation of three points a, b, c.

    Parameters
    ----------
    a, b, c : array_like of shape (..., 2)
        Finite planar points; their leading shapes are broadcast against each other.

    Returns
    -------
    ndarray of int8
        1 for a counter-clockwise turn, -1 for a clockwise turn, 0 for collinear points, in the
        broadcast leading shape.

    Raises
    ------
    InputError
        The last axis is not of length two, or a value is not finite.

    See Also
    --------
    incircle : The test of four points.

    Notes
    -----
    The sign of the determinant of (a - c, b - c). The filter is that of J. R. Shewchuk, "Adaptive
    Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates" (1997).

    Examples
    --------
    >>> orient2d((0, 0), (1, 0), [(0, 1), (2, 0), (0, -5e-324)])
    array([ 1,  0, -1], dtype=int8)
    """
    (a, b, c), signs = _prepare(a, b, c)
    _kernel.orient2d(a, b, c, signs.reshape(-1))
    return signs


def incircle(
    a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike, *, canonical: bool = False
) -> NDArray[np.int8]:
    """Test whether a point d lies inside the circle through a, b, c.

    Equivalently, whether the lift of d to the paraboloid lies below the plane through the lifts of
    the other three.

    Parameters
    ----------
    a, b, c : array_like of shape (..., 2)
        Finite planar points in counter-clockwise order (the sign flips if they are clockwise).
    d : array_like of shape (..., 2)
        Finite planar points. All leading shapes are broadcast against each other.
    canonical : bool, default False
        Decide points on the circle too, by lifting lexicographically larger points infinitesimally
        more: the rule that makes the triangulation unique.

    Returns
    -------
    ndarray of int8
        1 inside, -1 outside, 0 exactly on the circle (with `canonical` only if points coincide or
        are collinear), in the broadcast leading shape.

    Raises
    ------
    InputError
        The last axis is not of length two, a value is not finite, or `canonical` is not a bool.

    See Also
    --------
    orient2d : The orientation of three points.

    Examples
    --------
    >>> square = (0, 0), (1, 0), (1, 1)
    >>> incircle(*square, [(0.5, 0.5), (0, 1), (2, 2)])
    array([ 1,  0, -1], dtype=int8)
    >>> incircle(*square, (0, 1), canonical=True)
    array(1, dtype=int8)
    """
    ties = as_switch("canonical", canonical)
    (a, b, c, d), signs = _prepare(a, b, c, d)
    _kernel.incircle(a, b, c, d, signs.reshape(-1), ties)
    return signs


def _prepare(*points: ArrayLike) -> tuple[list[Floats], Array]:
    pairs = np.broadcast_arrays(*(as_pairs(p) for p in points))
    flat = [np.ascontiguousarray(p).reshape(-1, 2) for p in pairs]
    for rows in flat:
        check_finite(rows)
    return flat, np.empty(pairs[0].shape[:-1], dtype=np.int8)
