"""Exact predicates for arrays of points: orientation, in-circle and in-sphere tests.

They are exact for all finite doubles: a floating-point filter decides where it can, and
fixed-width integers decide the rest.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_pairs, as_triples, check_finite
from liftmesh.base.options import as_switch

__all__ = ["incircle", "insphere", "orient2d", "orient3d"]


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
    (a, b, c), signs = _prepare(as_pairs, a, b, c)
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
    (a, b, c, d), signs = _prepare(as_pairs, a, b, c, d)
    _kernel.incircle(a, b, c, d, signs.reshape(-1), ties)
    return signs


def orient3d(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> NDArray[np.int8]:
    """Compute the orientation of four points in space: the sign of their tetrahedron's volume.

    Parameters
    ----------
    a, b, c, d : array_like of shape (..., 3)
        Finite points in space; their leading shapes are broadcast against each other.

    Returns
    -------
    ndarray of int8
        1 where a, b, c turn counter-clockwise seen from d, -1 where they turn clockwise, 0 for
        coplanar points, in the broadcast leading shape.

    Raises
    ------
    InputError
        The last axis is not of length three, or a value is not finite.

    See Also
    --------
    insphere : The test of five points.
    orient2d : The same in the plane.

    Notes
    -----
    The sign of the determinant of (b - a, c - a, d - a), which continues `orient2d`. Shewchuk's
    function of this name has the opposite sign.

    Examples
    --------
    >>> orient3d((0, 0, 0), (1, 0, 0), (0, 1, 0), [(0, 0, 1), (3, 4, 0), (0, 0, -5e-324)])
    array([ 1,  0, -1], dtype=int8)
    """
    (a, b, c, d), signs = _prepare(as_triples, a, b, c, d)
    _kernel.orient3d(a, b, c, d, signs.reshape(-1))
    return signs


def insphere(
    a: ArrayLike,
    b: ArrayLike,
    c: ArrayLike,
    d: ArrayLike,
    e: ArrayLike,
    *,
    canonical: bool = False,
) -> NDArray[np.int8]:
    """Test whether a point e lies inside the sphere through a, b, c, d.

    Parameters
    ----------
    a, b, c, d : array_like of shape (..., 3)
        Finite points in space whose `orient3d` is 1 (the sign flips if it is -1).
    e : array_like of shape (..., 3)
        Finite points in space. All leading shapes are broadcast against each other.
    canonical : bool, default False
        Decide points on the sphere too, by lifting lexicographically larger points (by x, then y,
        then z) infinitesimally more: the rule that makes the triangulation unique.

    Returns
    -------
    ndarray of int8
        1 inside, -1 outside, 0 exactly on the sphere (with `canonical` only if points coincide or
        a, b, c, d are coplanar), in the broadcast leading shape.

    Raises
    ------
    InputError
        The last axis is not of length three, a value is not finite, or `canonical` is not a bool.

    See Also
    --------
    orient3d : The orientation of four points.
    incircle : The same in the plane.

    Examples
    --------
    >>> corner = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
    >>> insphere(*corner, [(0.5, 0.5, 0.5), (1, 1, 1), (2, 2, 2)])
    array([ 1,  0, -1], dtype=int8)
    >>> insphere(*corner, (1, 1, 1), canonical=True)
    array(-1, dtype=int8)
    """
    ties = as_switch("canonical", canonical)
    (a, b, c, d, e), signs = _prepare(as_triples, a, b, c, d, e)
    _kernel.insphere(a, b, c, d, e, signs.reshape(-1), ties)
    return signs


def _prepare(
    converted: Callable[[ArrayLike], Floats], *points: ArrayLike
) -> tuple[list[Floats], Array]:
    tuples = np.broadcast_arrays(*map(converted, points))
    flat = [np.ascontiguousarray(p).reshape(-1, p.shape[-1]) for p in tuples]
    for rows in flat:
        check_finite(rows)
    return flat, np.empty(tuples[0].shape[:-1], dtype=np.int8)
