"""The lemmas and propositions of the paper, each as a function in exact rationals.

Each function takes the hypotheses of a statement and returns the condition that holds, or the
conclusion, so that it can be compared with the paper. If a statement is wrong as printed, the
docstring says so and the function includes the correction.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from liftmesh.errors import InputError
from liftmesh.paper.geometry import Plane, Point, Position, exact

if TYPE_CHECKING:
    from liftmesh.paper.region import Circle, Ellipse, Surd


def outward(plane: Plane, points: Iterable[Point]) -> Plane:
    """Orient the normal of a facet's plane away from P.

    Parameters
    ----------
    plane : Plane
        A plane with all of P on one side.
    points : iterable of points
        P.

    Returns
    -------
    Plane
        The same plane, with n . v <= d for all v in P.

    Raises
    ------
    InputError
        P lies on both sides: the plane contains no facet of CH(P).

    Examples
    --------
    >>> floor = Plane.through((0, 0, 0), (1, 0, 0), (0, 1, 0))
    >>> int(floor.n[2]), int(outward(floor, [(0, 0, 1)]).n[2])
    (1, -1)
    """
    excesses = [plane.dot(v) - plane.d for v in points]
    if max(excesses, default=0) <= 0:
        return plane
    if min(excesses) < 0:
        raise InputError("P lies on both sides of the plane: it contains no facet of CH(P)")
    nx, ny, nz = plane.n
    return Plane((-nx, -ny, -nz), -plane.d)


def proposition_3_1(plane: Plane) -> Literal["(i)", "(ii)"]:
    """Proposition 3.1: a facet of CH(P) is a lower facet iff n_z < 0.

    It is printed for n = ab x ap, whose sign depends on the order of the vertices: so it is true of
    `Plane.through(a, b, p)` only if a, b, p are ordered such that n points out of CH(P). The
    intended plane is ``outward(Plane.through(a, b, p), points)``.

    Parameters
    ----------
    plane : Plane
        The plane of a facet of CH(P).

    Returns
    -------
    {"(i)", "(ii)"}
        (i) n_z < 0: a lower facet; (ii) n_z >= 0: not a lower facet.

    Examples
    --------
    >>> P = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    >>> printed = Plane.through(*P[:3])
    >>> proposition_3_1(printed), proposition_3_1(outward(printed, P))
    ('(ii)', '(i)')
    """
    return "(i)" if plane.n[2] < 0 else "(ii)"


def proposition_3_2(
    plane: Plane, v: Point, *, printed: bool = False
) -> Literal["(i)", "(ii)"] | None:
    """Proposition 3.2: what a point v implies for the facet (e, p), where n_z < 0 is required.

    Parameters
    ----------
    plane : Plane
        The plane (e, p).
    v : sequence of three numbers
        A point of P.
    printed : bool, default False
        Treat "on" as (ii), as the paper prints it. This is wrong: a, b and p themselves are on it.

    Returns
    -------
    {"(i)", "(ii)"} or None
        (i) v is above; (ii) (e, p) is not a lower facet on this side of e, because n_z >= 0 or v
        is below; None if v is on the plane.

    Examples
    --------
    >>> plane = Plane.through((0, 0, 0), (0, 1, 0), (1, 0, 0))
    >>> [proposition_3_2(plane, (1, 1, z)) for z in (1, 0, -1)]
    ['(i)', None, '(ii)']
    >>> proposition_3_2(plane, (0, 0, 0), printed=True)
    '(ii)'
    """
    x, y, z = exact(v)
    nx, ny, nz = plane.n
    left, right = nz * z, plane.d - x * nx - y * ny
    if nz < 0 and left < right:
        return "(i)"
    return "(ii)" if nz >= 0 or left > right or printed else None


def lemma_4_1(ellipse: Ellipse) -> tuple[Surd, Surd]:
    """Lemma 4.1: the least and the greatest z on (E).

    Parameters
    ----------
    ellipse : Ellipse
        (E).

    Returns
    -------
    tuple of two Surd
        (L_cq - r)^2 and (L_cq + r)^2.

    Examples
    --------
    >>> from liftmesh.paper.region import Ellipse
    >>> least, greatest = lemma_4_1(Ellipse(Plane.through((1, 0, 1), (0, 1, 1), (3, 0, 9)), (0, 0)))
    >>> round(float(least), 3), round(float(greatest), 3)
    (0.351, 25.649)
    """
    return ellipse.min_z, ellipse.max_z


def lemma_4_2(circle: Circle, t: Point) -> Position:
    """Lemma 4.2: a point of the paraboloid is above (a, b, p) iff t' is outside (C), and so on.

    Parameters
    ----------
    circle : Circle
        (C).
    t : sequence of two or three numbers
        A point of P, or its projection.

    Returns
    -------
    {"above", "on", "below"}
        The position of t relative to the plane (a, b, p).

    Examples
    --------
    >>> from liftmesh.paper.region import Circle
    >>> triangle = Plane.through((0, 0, 0), (2, 0, 4), (0, 2, 4))
    >>> [lemma_4_2(Circle.of(triangle, q=(0, 0)), t) for t in [(3, 3), (2, 2), (1, 1)]]
    ['above', 'on', 'below']
    """
    positions: dict[str, Position] = {"outside": "above", "on": "on", "inside": "below"}
    return positions[circle.position(t)]


def proposition_4_3(ellipse: Ellipse, t: Point) -> tuple[str, ...]:
    """Proposition 4.3: conditions on coordinates, each sufficient for t to be above (a, b, p).

    Parameters
    ----------
    ellipse : Ellipse
        (E).
    t : sequence of three numbers
        A point of P, which lies on the paraboloid.

    Returns
    -------
    tuple of str
        Those of "4.3 (i)" to "4.3 (v)" that hold. None is necessary for a point above.

    Examples
    --------
    >>> from liftmesh.paper.region import Ellipse
    >>> ellipse = Ellipse(Plane.through((3, 4, 25), (5, 0, 25), (4, 3, 25)), (0, 0))
    >>> proposition_4_3(ellipse, (6, -6, 72))
    ('4.3 (ii)', '4.3 (iii)', '4.3 (v)')
    """
    x, y, z = exact(t)
    conditions = {
        "4.3 (i)": x < ellipse.min_x,
        "4.3 (ii)": x > ellipse.max_x,
        "4.3 (iii)": y < ellipse.min_y,
        "4.3 (iv)": y > ellipse.max_y,
        "4.3 (v)": z > ellipse.max_z,
    }
    return tuple(name for name, holds in conditions.items() if holds)


def proposition_4_4(ellipse: Ellipse, t: Point) -> bool:
    """Proposition 4.4: t_z < minz_E and L_cq < r imply that t is below (a, b, p).

    Parameters
    ----------
    ellipse : Ellipse
        (E).
    t : sequence of three numbers
        A point of P, which lies on the paraboloid.

    Returns
    -------
    bool
        Whether both hold. They are not necessary for a point below.

    Notes
    -----
    If t_z < minz_E and L_cq > r, q lies outside (C), and t is above: t' is closer to q than (C)
    is. The paper omits this case.

    Examples
    --------
    >>> from liftmesh.paper.region import Ellipse
    >>> ellipse = Ellipse(Plane.through((3, 4, 25), (5, 0, 25), (4, 3, 25)), (0, 0))
    >>> proposition_4_4(ellipse, (1, 1, 2)), proposition_4_4(ellipse, (5, 0, 25))
    (True, False)
    """
    q_inside = ellipse.squared_distance < ellipse.circle.squared_radius
    return q_inside and exact(t)[2] < ellipse.min_z
