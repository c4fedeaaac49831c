"""The lemmas, propositions and the first edge of the paper, as functions in exact rationals.

Each function takes the hypotheses of a statement and returns the condition that holds, or the
conclusion, so that it can be compared with the paper. If a statement is wrong as printed, a comment
says so and the function includes the correction.

The first edge of the lower hull is found by the projection onto Oyz (Section 3). P' is P seen along
the x-axis, with Oy from right to left. (That is the view from x = -infinity; the paper says
+infinity, from where Oy runs from left to right.) v'_1 is the lowest point of P'; all of P' is on
or to the left of v'_1 v'_2, and on or to the right of v'_1 v'_n. As v'_1 is lowest, all of P' lies
within a half turn around it, from v'_2 to v'_n. So

* if v_2y < v_1y, the points are above the line v'_1 v'_2, and [v_1, v_2] is a lower edge;
* if v_1y < v_ny, the points are above the line v'_1 v'_n, and [v_1, v_n] is a lower edge.

Both hold in the paper's first case, one each in its second and third. Neither holds with equality:
the line is then vertical, and a segment on it need not be an edge.

Ties are decided by the canonical perturbation: every point is lifted by an infinitesimal amount,
infinitely more for a point that is lexicographically larger in (x, y). Then no two points are
equally low and the paper's "rightmost" is not needed, and no three points of different y are
collinear in P'.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cmp_to_key
from typing import TYPE_CHECKING, Literal, TypeAlias

from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.paper.geometry import Exact, Plane, Point, Position, exact

if TYPE_CHECKING:
    from liftmesh.paper.region import Circle, Ellipse, Surd

Edge: TypeAlias = tuple[int, int]


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
    # Printed for n = ab x ap, whose sign depends on the order of the vertices: true of
    # `Plane.through(a, b, p)` only if n points out of CH(P), as that of `outward` does.
    return "(i)" if plane.n[2] < 0 else "(ii)"


def proposition_3_2(
    plane: Plane, v: Point, *, printed: bool = False
) -> Literal["(i)", "(ii)"] | None:
    """Proposition 3.2: what a point v implies for the facet (e, p), where n_z < 0 is required."""
    # (i) v is above; (ii) (e, p) is no lower facet on this side of e. The paper prints (ii) also
    # of v on the plane, which is wrong: a, b and p themselves are on it.
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
    # The paper omits L_cq > r: then q lies outside (C), and t is above, as t' is closer to q.
    q_inside = ellipse.squared_distance < ellipse.circle.squared_radius
    return q_inside and exact(t)[2] < ellipse.min_z


@dataclass(frozen=True, slots=True)
class FirstEdge:
    """Result of finding the first edge by the projection onto Oyz."""

    v1: int
    v2: int
    vn: int
    case: int
    edges: tuple[Edge, ...]


def first_edge(points: Sequence[Point]) -> FirstEdge:
    """Find edges of the lower convex hull by the projection onto Oyz."""
    rows = [exact(p) for p in points]
    v1 = min(range(len(rows)), key=lambda i: (rows[i][2], rows[i][:2]), default=0)
    if len({y for _, y, _ in rows}) < 2:
        raise DegenerateInputError("all points have the same y: there is no lower facet")
    others = [i for i, row in enumerate(rows) if row != rows[v1]]

    def before(i: int, j: int) -> int:
        return _turn(rows[v1], rows[i], rows[j])

    around = cmp_to_key(before)
    return _cases(rows, v1, min(others, key=around), max(others, key=around))


def _cases(rows: Sequence[Exact], v1: int, v2: int, vn: int) -> FirstEdge:
    y1, y2, yn = rows[v1][1], rows[v2][1], rows[vn][1]
    if y2 < y1 < yn:
        return FirstEdge(v1, v2, vn, 1, ((v1, v2), (v1, vn)))
    if y2 < y1:
        return FirstEdge(v1, v2, vn, 2, ((v1, v2),))
    return FirstEdge(v1, v2, vn, 3, ((v1, vn),))


def _turn(v1: Exact, i: Exact, j: Exact) -> int:
    """Return -1 if v'_1 v'_i precedes v'_1 v'_j on the half turn from right to left."""
    yi, yj = i[1] - v1[1], j[1] - v1[1]
    turn = yj * (i[2] - v1[2]) - yi * (j[2] - v1[2])
    return -tie_sign(turn, [(v1, yi - yj), (i, yj), (j, -yi)])


def tie_sign(value: Fraction, rises: Iterable[tuple[Exact, Fraction]]) -> int:
    """The sign of a sum of heights, each times its factor, after the canonical perturbation."""
    totals: dict[Exact, Fraction] = {}
    for point, factor in rises:
        totals[point[:2]] = totals.get(point[:2], Fraction(0)) + factor
    entering = [totals[xy] for xy in sorted(totals, reverse=True) if totals[xy] != 0]
    deciding = value or (entering[0] if entering else 0)
    return (deciding > 0) - (deciding < 0)
