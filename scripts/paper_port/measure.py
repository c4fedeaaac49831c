"""Time the variants, and count what they do, on the same points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import Delaunay

from paper_port.build import Counts, Run, build, canonical, read_facets, run
from paper_port.inputs import ORDERS, uniform, vertex, write

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
        """LF / LFRes in seconds."""
        return self.seconds["LF"] / self.seconds["LFRes"]

    @property
    def operations(self) -> float:
        """LF / LFRes in dot products."""
        return self.counts["LF"].evaluations / self.counts["LFRes"].evaluations


def measure(
    variant: Variant, sizes: list[int], seeds: list[int], repeat: int, folder: Path
) -> Iterator[Measurement | str]:
    """Measure a variant on every set of points, or say why it cannot be built here."""
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
                    right_facets(folder / "facets", counted, ordered),
                    {name: quickest(runs, name) for name in ("LF", "LFRes")},
                    {item.procedure: item.counts for item in counted},
                )


def quickest(runs: list[Run], procedure: str) -> float:
    """Give the least seconds of a procedure: what disturbs a run only adds to it."""
    return min(item.seconds for item in runs if item.procedure == procedure)


def right_facets(file: Path, runs: list[Run], points: Points) -> bool:
    """Say whether both procedures came to an end with the facets of the Delaunay triangulation."""
    expected = canonical(Delaunay(points).simplices)
    found = read_facets(file, runs)
    return all(item.complete for item in runs) and all(
        len(facets) == item.facets and np.array_equal(facets, expected)
        for item, facets in zip(runs, found, strict=True)
    )
