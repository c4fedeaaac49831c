"""Time the variants and count their operations on the same points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from paper_port.build import PROCEDURES, Counts, Run, build, canonical, read_facets, run
from paper_port.inputs import ORDERS, uniform, vertex, write
from scipy.spatial import Delaunay

if TYPE_CHECKING:
    from paper_port.inputs import Points
    from paper_port.variants import Variant

CASES = (1, 2)


@dataclass(frozen=True)
class Measurement:
    """A variant on one set of points, with the vertex q of one case."""

    variant: Variant
    case: int
    n: int
    seed: int
    facets: int
    right: bool
    seconds: dict[str, float]
    counts: dict[str, Counts]

    @property
    def ratio(self) -> float:
        """The ratio of seconds, LF / LFRes."""
        return self.seconds["LF"] / self.seconds["LFRes"]

    @property
    def work_ratio(self) -> float:
        """The ratio of dot products, LF / LFRes."""
        return self.counts["LF"].evaluations / self.counts["LFRes"].evaluations


def measure(
    variant: Variant, sizes: list[int], seeds: list[int], repeat: int, folder: Path
) -> Iterator[Measurement | str]:
    """Measure a variant on every set of points, or yield the compiler's refusal."""
    timed, counting = folder / "timed", folder / "counting"
    refusal = build(timed, variant.flags) or build(counting, (*variant.flags, "-DCOUNT"))
    if refusal:
        yield refusal
        return
    for n in sizes:
        for seed in seeds:
            for case in CASES:
                points = uniform(n, seed)
                q = vertex(case, points)
                file = folder / "points"
                ordered = ORDERS[variant.order](points, q)
                write(ordered, file)
                runs = run(timed, file, q, repeat)
                counted = run(counting, file, q, facets=folder / "facets")
                yield Measurement(
                    variant,
                    case,
                    n,
                    seed,
                    counted[0].facets,
                    facets_are_delaunay(folder / "facets", counted, ordered),
                    {name: quickest(runs, name) for name in PROCEDURES},
                    {item.procedure: item.counts for item in counted},
                )


def quickest(runs: list[Run], procedure: str) -> float:
    """Return the minimum of a procedure's times: disturbances only add to them."""
    return min(item.seconds for item in runs if item.procedure == procedure)


def facets_are_delaunay(file: Path, runs: list[Run], points: Points) -> bool:
    """Whether both procedures terminated with the triangles of SciPy's Delaunay triangulation."""
    expected = canonical(Delaunay(points).simplices)
    found = read_facets(file, runs)
    return all(item.complete for item in runs) and all(
        len(facets) == item.facets and np.array_equal(facets, expected)
        for item, facets in zip(runs, found, strict=True)
    )
