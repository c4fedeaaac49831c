"""Compare the printed seconds with the operation counts of Algorithm 2 at the same sizes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from paper_port.build import Counts, build, run
from paper_port.inputs import TABLE_OF_CASE, uniform, vertex, write
from paper_port.slowdown import printed_seconds
from scipy.optimize import nnls

from liftmesh.paper.printed import TABLES


@dataclass(frozen=True)
class Line:
    """A printed row: seconds and counts of both procedures, by their names."""

    case: int
    n: int
    ratio: float
    printed: dict[str, float]
    counts: dict[str, Counts]

    def nanoseconds(self, procedure: str) -> float:
        """Return the printed nanoseconds for each point that the procedure tests."""
        return self.printed[procedure] / self.counts[procedure].points * 1e9


def lines(largest: int, seed: int, folder: Path) -> Iterator[Line]:
    """Count the operations on a random set of each printed size."""
    program, file = folder / "counting", folder / "points"
    refusal = build(program, ("-O2", "-DCOUNT"))
    if refusal:
        raise SystemExit(refusal)
    for case, name in TABLE_OF_CASE.items():
        for row in TABLES[name].rows:
            if row.n <= largest:
                points = uniform(row.n, seed)
                write(points, file)
                runs = run(program, file, vertex(case, points))
                counts = {item.procedure: item.counts for item in runs}
                yield Line(case, row.n, row.ratio, printed_seconds(row.n, case), counts)


def exponent(sizes: list[int], values: list[float]) -> float:
    """Fit values ~ n^exponent by least squares of logarithms."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def two_costs(found: list[Line], procedure: str) -> tuple[NDArray[np.float64], float]:
    """Fit printed seconds = A planes + B points, A and B >= 0, least squares of relative errors.

    Returns A and B in nanoseconds, and the root mean square relative error.
    """
    seconds = np.array([line.printed[procedure] for line in found])
    counts = [line.counts[procedure] for line in found]
    matrix = np.array([[item.planes, item.points] for item in counts]) / seconds[:, None]
    costs, residual = nnls(matrix, np.ones(len(found)))
    return costs * 1e9, float(residual / np.sqrt(len(found)))
