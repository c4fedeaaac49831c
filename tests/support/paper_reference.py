"""The paper's procedures in fractions: as liftmesh means them, and as the paper prints them.

Nothing is fast here and nothing is filtered; each loop is the paper's. It shows what the printed
text does on inputs that the paper does not think of, and what the compiled procedures must find.

A facet (a, b, p) has n_z < 0: it lies to the right of its edges a b, b p and p a, seen from above.
So an edge is directed, and LF looks to its right; across an edge of a facet one looks along the
reversed edge. Points are rows of a list; ties are broken as `liftmesh.paper.propositions` does.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from liftmesh.paper.geometry import Exact, Plane, Point, orient
from liftmesh.paper.propositions import (
    Edge,
    Ellipse,
    first_edge,
    proposition_4_3,
    proposition_4_4,
    tie_sign,
)

Facet = tuple[int, int, int]
Procedure = Callable[[Edge], "Facet | None"]


@dataclass
class Tally:
    """What `liftmesh.Triangulation.counters` counts."""

    calls: int = 0
    candidate_planes: int = 0
    evaluations: int = 0
    rejected: Counter[str] = field(default_factory=Counter)


def is_below(p: Exact, a: Exact, b: Exact, p_l: Exact, plane: Plane) -> bool:
    """Whether p is below the plane (a, b, p_l), which has n_z < 0, after the perturbation."""
    rises = [
        (p, orient(a, b, p_l)),
        (p_l, -orient(a, b, p)),
        (b, orient(a, p_l, p)),
        (a, -orient(b, p_l, p)),
    ]
    return tie_sign(plane.dot(p) - plane.d, rises) > 0


def lf(points: Sequence[Exact], tally: Tally | None = None, q: Point | None = None) -> Procedure:
    """Procedure 1 for these points, or with q Procedure 3, LFRes. It gives None to "return e"."""
    tally = Tally() if tally is None else tally

    def call(edge: Edge) -> Facet | None:
        tally.calls += 1
        a, b = edge
        for i, p_l in enumerate(points):
            plane = Plane.through(points[a], points[b], p_l)
            if plane.n[2] >= 0:
                continue
            tally.candidate_planes += 1
            region = Ellipse(plane, q) if q is not None else None
            others = [p for k, p in enumerate(points) if k not in (a, b, i)]
            if not any(below(p, points[a], points[b], p_l, plane, region) for p in others):
                return a, b, i
        return None

    def below(
        p: Exact, a: Exact, b: Exact, p_l: Exact, plane: Plane, region: Ellipse | None
    ) -> bool:
        if region is not None and proposition_4_4(region, p):
            tally.rejected["4.4"] += 1
            return True
        for condition in proposition_4_3(region, p)[:1] if region is not None else ():
            tally.rejected[condition] += 1
            return False
        tally.evaluations += 1
        return is_below(p, a, b, p_l, plane)

    return call


def lower_facets(points: Sequence[Exact], procedure: Procedure) -> list[Facet]:
    """Algorithm 2 as liftmesh means it: e1 is looked along both ways, and a used edge is closed."""
    e1 = first_edge(points).edges[0]
    opened, closed, facets = set[frozenset[int]](), {frozenset(e1)}, []
    queue = deque(facet for facet in (procedure(e1), procedure(e1[::-1])) if facet)
    for facet in queue:
        opened |= {frozenset(e) for e in across(facet)} - closed
    while queue:
        facet = queue.popleft()
        for e in across(facet):
            if frozenset(e) in closed:
                continue
            opened.discard(frozenset(e))
            closed.add(frozenset(e))
            found = procedure(e)
            if found:
                new = {frozenset(f) for f in across(found)} - {frozenset(e)}
                closed |= new & opened
                opened = opened ^ new
                queue.append(found)
        facets.append(facet)
    return facets


def across(facet: Facet) -> list[Edge]:
    """The edges of a facet, reversed: along them, the neighbours lie to the right."""
    a, b, p = facet
    return [(b, a), (p, b), (a, p)]


def printed_lf(points: Sequence[Exact]) -> Procedure:
    """Procedure 1 with the lines of the paper: no tie is broken, l runs as it is told to."""

    def call(edge: Edge) -> Facet | None:
        a, b = edge
        n, l = len(points), 1  # noqa: E741 - the paper's letter
        while True:
            while points[l - 1] in (points[a], points[b]):  # lines 2 and 3
                l += 1  # noqa: E741
            plane = Plane.through(points[a], points[b], points[l - 1])
            others = (p for k, p in enumerate(points) if k not in (a, b, l - 1))
            if plane.n[2] < 0 and not any(plane.dot(p) > plane.d for p in others):
                return a, b, l - 1
            l += 1  # noqa: E741
            if l > n:
                return None

    return call


def printed_algorithm_2(
    e1: Edge, procedure: Procedure, *, moves_e: bool, limit: int
) -> list[Facet]:
    """Algorithm 2 with the lines of the paper, as far as `limit` facets in Q.

    `moves_e` adds what the paper does not say: that e goes to E'_L when a facet F' is found.
    """
    first = procedure(e1)
    if first is None:
        return []
    e_l = {frozenset(e) for e in across(first)} - {frozenset(e1)}
    e_l_done = {frozenset(e1)}
    waiting, found = deque([first]), []
    while waiting and len(found) < limit:
        facet = waiting.popleft()
        for e in across(facet):
            if frozenset(e) in e_l_done:
                continue
            other = procedure(e)
            if other:
                rest = {frozenset(f) for f in across(other)} - {frozenset(e)}
                e_l_done |= rest & e_l
                e_l = e_l ^ rest
                waiting.append(other)
            if moves_e or not other:
                e_l.discard(frozenset(e))
                e_l_done.add(frozenset(e))
        found.append(facet)
    return found
