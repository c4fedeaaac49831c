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
    """Orient the normal of a facet's plane away from P."""
    excesses = [plane.dot(v) - plane.d for v in points]
    if max(excesses, default=0) <= 0:
        return plane
    if min(excesses) < 0:
        raise InputError("P lies on both sides of the plane: it contains no facet of CH(P)")
    nx, ny, nz = plane.n
    return Plane((-nx, -ny, -nz), -plane.d)


def proposition_3_1(plane: Plane) -> Literal["(i)", "(ii)"]:
    """Proposition 3.1: a facet of CH(P) is a lower facet iff n_z < 0."""
    return "(i)" if plane.n[2] < 0 else "(ii)"


def proposition_3_2(
    plane: Plane, v: Point, *, printed: bool = False
) -> Literal["(i)", "(ii)"] | None:
    """Proposition 3.2: what a point v implies for the facet (e, p), where n_z < 0 is required."""
    x, y, z = exact(v)
    nx, ny, nz = plane.n
    left, right = nz * z, plane.d - x * nx - y * ny
    if nz < 0 and left < right:
        return "(i)"
    return "(ii)" if nz >= 0 or left > right or printed else None


def lemma_4_1(ellipse: Ellipse) -> tuple[Surd, Surd]:
    """Lemma 4.1: the least and the greatest z on (E)."""
    return ellipse.min_z, ellipse.max_z


def lemma_4_2(circle: Circle, t: Point) -> Position:
    """Lemma 4.2: a point of the paraboloid is above (a, b, p) iff t' is outside (C), and so on."""
    positions: dict[str, Position] = {"outside": "above", "on": "on", "inside": "below"}
    return positions[circle.position(t)]


def proposition_4_3(ellipse: Ellipse, t: Point) -> tuple[str, ...]:
    """Proposition 4.3: conditions on coordinates, each sufficient for t to be above (a, b, p)."""
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
    """Proposition 4.4: t_z < minz_E and L_cq < r imply that t is below (a, b, p)."""
    q_inside = ellipse.squared_distance < ellipse.circle.squared_radius
    return q_inside and exact(t)[2] < ellipse.min_z
