"""Time the variants, and count what they do, on the same points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from printed_port.build import Counts, Run, build, read_facets, run
from printed_port.inputs import ORDERS, uniform, vertex, write

if TYPE_CHECKING:
    from printed_port.variants import Variant

CASES = (1, 2)


@dataclass(frozen=True)
class Measurement:
    """A variant on one set of points, with the vertex q of one case."""

    variant: Variant
    case: int
    n: int
    seed: int
    facets: int
    agree: bool
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
                write(ORDERS[variant.order](points, q), file)
                runs = run(timed, file, q, repeat)
                counted = run(counting, file, q, facets=folder / "facets")
                agree = same_facets(folder / "facets", counted)
                yield Measurement(
                    variant,
                    case,
                    n,
                    seed,
                    counted[0].facets,
                    agree,
                    {name: quickest(runs, name) for name in ("LF", "LFRes")},
                    {item.procedure: item.counts for item in counted},
                )


def quickest(runs: list[Run], procedure: str) -> float:
    """Give the least seconds of a procedure: what disturbs a run only adds to it."""
    return min(item.seconds for item in runs if item.procedure == procedure)


def same_facets(file: Path, runs: list[Run]) -> bool:
    """Say whether both procedures came to an end with one set of facets."""
    first, second = read_facets(file, runs)
    return all(item.complete for item in runs) and np.array_equal(first, second)
