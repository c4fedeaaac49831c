"""Our measurements and the printed numbers: one row for each table and number of points.

A row has three parts. Seconds: the paper's and ours, with their ratio. Operations: the dot products
per facet of LF and LFRes, which do not depend on the machine. And the reason for the difference:
the share of the points that each proposition rejects by comparing coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

from liftmesh.paper.experiments import METHODS, Measurement, Trial
from liftmesh.paper.printed import TABLES, TableName, Vertex
from liftmesh.planar.lifting import REJECTIONS, resolve_q

LF, LFRES, INDEXED, ENGINE = METHODS


@dataclass(frozen=True, slots=True)
class Row:
    """One line of a table: the printed numbers, and the medians of our measurements."""

    table: TableName
    q: Vertex
    n: int
    seeds: int
    printed_median: tuple[float, float] | None
    printed_lf: float | None
    printed_lfres: float | None
    printed_ratio: float | None
    median: tuple[float, float] | None
    seconds: Mapping[str, float]
    spread: Mapping[str, tuple[float, float]]
    facets: float
    dot_products: Mapping[str, float]
    planes: Mapping[str, float]
    rejected: Mapping[str, float]

    @property
    def ratio(self) -> float:
        """Our seconds of LF over those of LFRes: above one, LFRes is faster."""
        return self.seconds[LF] / self.seconds[LFRES]

    @property
    def work_ratio(self) -> float:
        """Dot products of LF over those of LFRes."""
        return self.dot_products[LF] / self.dot_products[LFRES]

    @property
    def indexed_ratio(self) -> float:
        """Our seconds of LF over those of the indexed region."""
        return self.seconds[LF] / self.seconds[INDEXED]


def summarise(measurements: Iterable[Measurement]) -> list[Row]:
    """Convert measurements to the rows of the tables."""
    groups: dict[tuple[TableName, int], list[Measurement]] = {}
    for measurement in measurements:
        key = (measurement.trial.table, measurement.trial.n)
        groups.setdefault(key, []).append(measurement)
    return [_row(table, n, groups[table, n]) for table, n in sorted(groups)]


def _row(table: TableName, n: int, group: Sequence[Measurement]) -> Row:
    by_method: dict[str, list[Measurement]] = {
        method: [m for m in group if m.method == method] for method in METHODS
    }
    seconds = {method: [m.seconds for m in found] for method, found in by_method.items()}
    printed = TABLES[table].row(n)
    return Row(
        table=table,
        q=TABLES[table].q,
        n=n,
        seeds=len(by_method[LF]),
        printed_median=printed.median if printed else None,
        printed_lf=printed.lf if printed else None,
        printed_lfres=printed.lfres if printed else None,
        printed_ratio=printed.ratio if printed else None,
        median=_median_point(min(m.trial for m in group)),
        seconds={method: median(values) for method, values in seconds.items()},
        spread={method: (min(values), max(values)) for method, values in seconds.items()},
        facets=median(m.facets for m in by_method[ENGINE]),
        dot_products=_per_facet(by_method, lambda m: m.evaluations),
        planes=_per_facet(by_method, lambda m: m.planes),
        rejected=_shares(by_method[LFRES]),
    )


def _median_point(trial: Trial) -> tuple[float, float] | None:
    return resolve_q(trial.q, trial.points()) if trial.q == "median" else None


def _per_facet(
    by_method: Mapping[str, Sequence[Measurement]], count: Callable[[Measurement], int]
) -> dict[str, float]:
    return {
        method: median(count(m) / m.facets for m in by_method[method])
        for method in (LF, LFRES, INDEXED)
    }


def _shares(found: Sequence[Measurement]) -> dict[str, float]:
    """Return the share of each proposition, over all seeds together so that the shares add up."""
    points = sum(m.evaluations + sum(m.rejected.values()) for m in found)
    return {name: sum(m.rejected[name] for m in found) / points for name in REJECTIONS}
