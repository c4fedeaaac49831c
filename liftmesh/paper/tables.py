"""Our measurements beside the printed numbers: as CSV for programs, as Markdown, and as JSON.

There is a row for each table and number of points, in three parts. Seconds: the paper's and ours,
with their ratio. Operations: the dot products per facet of LF and LFRes, which do not depend on the
machine. And the reason for the difference: the share of the points that each proposition rejects by
comparing coordinates.

`COLUMNS` describes the columns of the CSV files. Seconds are medians over the seeds, ratios those
of the medians; a cell is empty if the paper has no number.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from liftmesh.io.atomic import replacing
from liftmesh.paper.experiments import METHODS, Measurement, Trial, versions
from liftmesh.paper.printed import TABLES, TableName, Vertex
from liftmesh.planar.lifting import REJECTIONS, resolve_apex

if TYPE_CHECKING:
    from liftmesh.paper.results import Results, Settings

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
    median: tuple[float, float] | None  # of our set with the lowest seed; None for the origin
    seconds: Mapping[str, float]  # by method, the median over the seeds
    spread: Mapping[str, tuple[float, float]]  # the fastest seed and the slowest
    facets: float
    dot_products: Mapping[str, float]  # a facet, by gift wrapping method
    planes: Mapping[str, float]  # candidates a facet
    rejected: Mapping[str, float]  # by proposition, the share of the points that LFRes looks at

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
    seconds = {method: [m.seconds for m in runs] for method, runs in by_method.items()}
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
    return resolve_apex(trial.q, trial.points()) if trial.q == "median" else None


def _per_facet(
    by_method: Mapping[str, Sequence[Measurement]], count: Callable[[Measurement], int]
) -> dict[str, float]:
    return {
        method: median(count(m) / m.facets for m in by_method[method])
        for method in (LF, LFRES, INDEXED)
    }


def _shares(measurements: Sequence[Measurement]) -> dict[str, float]:
    """Return the share of each proposition, over all seeds together so that the shares add up."""
    points = sum(m.evaluations + sum(m.rejected.values()) for m in measurements)
    return {name: sum(m.rejected[name] for m in measurements) / points for name in REJECTIONS}


_TIMED = {"lf": LF, "lfres": LFRES, "indexed": INDEXED, "engine": ENGINE}

COLUMNS: Mapping[str, str] = MappingProxyType(
    {
        "n": "points, uniform in [0, 200] x [0, 200]",
        "seeds": "random sets of n points that were measured",
        "printed_median_x": "median point of the paper's set, as the paper prints it",
        "printed_median_y": "the same point",
        "printed_lf": "seconds of Algorithm 2 using LF, as the paper prints them",
        "printed_lfres": "seconds using LFRes, as the paper prints them",
        "printed_ratio": "LF over LFRes, as the paper prints it",
        "median_x": "coordinate-wise median of our n points, seed 1; empty where q is the origin",
        "median_y": "the same point",
        "lf": "our seconds of LF: median over the seeds",
        "lf_min": "the quickest seed",
        "lf_max": "the slowest seed",
        "lfres": "our seconds of LFRes: median over the seeds",
        "lfres_min": "the quickest seed",
        "lfres_max": "the slowest seed",
        "ratio": "our seconds: LF over LFRes",
        "indexed": "our seconds of LFRes by a spatial index, which does not depend on q",
        "indexed_min": "the quickest seed",
        "indexed_max": "the slowest seed",
        "engine": "our seconds of the default engine, divide and conquer; q plays no part",
        "engine_min": "the quickest seed",
        "engine_max": "the slowest seed",
        "lf_over_indexed": "our seconds: LF over LFRes by a spatial index",
        "facets": "lower facets",
        "lf_dot_products": "dot products per facet: LF",
        "lfres_dot_products": "dot products per facet: LFRes",
        "dot_product_ratio": "dot products: LF over LFRes",
        "indexed_dot_products": "dot products per facet: LFRes by a spatial index",
        "lf_planes": "candidate planes per facet: LF",
        "lfres_planes": "candidate planes per facet: LFRes",
        "indexed_planes": "candidate planes per facet: LFRes by a spatial index",
        **{
            f"rejected {name}": f"share of the points LFRes looks at that {name} rejects"
            for name in REJECTIONS
        },
    }
)
"""The columns of the CSV files with their descriptions."""


def values(row: Row) -> dict[str, float | int | None]:
    """Return the values of a row by the names of `COLUMNS`."""
    cells: dict[str, float | int | None] = {
        "n": row.n,
        "seeds": row.seeds,
        "printed_lf": row.printed_lf,
        "printed_lfres": row.printed_lfres,
        "printed_ratio": row.printed_ratio,
        "ratio": row.ratio,
        "lf_over_indexed": row.indexed_ratio,
        "facets": row.facets,
        "dot_product_ratio": row.work_ratio,
    }
    for name, method in _TIMED.items():
        cells[name] = row.seconds[method]
        cells[f"{name}_min"], cells[f"{name}_max"] = row.spread[method]
        if method in row.planes:
            cells[f"{name}_dot_products"] = row.dot_products[method]
            cells[f"{name}_planes"] = row.planes[method]
    for name, point in (("printed_median", row.printed_median), ("median", row.median)):
        cells[f"{name}_x"], cells[f"{name}_y"] = point or (None, None)
    cells.update({f"rejected {name}": share for name, share in row.rejected.items()})
    return {name: cells[name] for name in COLUMNS}


def to_csv(rows: Sequence[Row]) -> str:
    """Format the rows of one table as CSV with a header of column names."""
    lines = [
        ",".join("" if v is None else f"{v:.6g}" for v in values(row).values()) for row in rows
    ]
    return "\n".join([",".join(COLUMNS), *lines]) + "\n"


_ABOVE_SECONDS = (
    "Seconds, as printed and as measured (median over the seeds; half the spread between them):"
)

_ABOVE_WORK = (
    "Dot products per facet, and of the points that LFRes looks at the share that each proposition "
    "rejects:"
)

MARKDOWN_SECONDS_HEADER = (
    *("n", "printed LF", "printed LFRes", "printed ratio", "LF", "LFRes", "ratio"),
    *("indexed", "default engine", "LF / indexed"),
)

WORK_HEADER = ("n", "LF", "LFRes", "LF / LFRes", "indexed", *REJECTIONS)


def seconds_cells(row: Row) -> tuple[str, ...]:
    """Format the seconds of a row: the paper's, and ours with their spread over the seeds."""
    printed = (row.printed_lf, row.printed_lfres)
    return (
        f"{row.n:,}",
        *("-" if value is None else f"{value:.3f}" for value in printed),
        "-" if row.printed_ratio is None else f"{row.printed_ratio:.2f}",
        _spread(row, LF),
        _spread(row, LFRES),
        f"{row.ratio:.2f}",
        _seconds(row, INDEXED),
        _seconds(row, ENGINE),
        f"{row.indexed_ratio:,.0f}",
    )


def work_cells(row: Row) -> tuple[str, ...]:
    """Format the dot products per facet, and the share of points that each proposition rejects."""
    return (
        f"{row.n:,}",
        f"{row.dot_products[LF]:,.0f}",
        f"{row.dot_products[LFRES]:,.0f}",
        f"{row.work_ratio:.1f}",
        f"{row.dot_products[INDEXED]:,.1f}",
        *(f"{100 * row.rejected[name]:.1f}%" for name in REJECTIONS),
    )


def to_markdown(rows: Sequence[Row]) -> str:
    """Format the rows of one table as two Markdown tables: seconds, then operations."""
    seconds = _markdown(MARKDOWN_SECONDS_HEADER, [seconds_cells(row) for row in rows])
    work = _markdown(WORK_HEADER, [work_cells(row) for row in rows])
    return "\n".join([_ABOVE_SECONDS, "", *seconds, "", _ABOVE_WORK, "", *work, ""])


def write_all(folder: Path, results: Results, settings: Settings, command: str) -> list[Path]:
    """Write the CSV file of every complete table, ``tables.md`` and ``paper.json``."""
    tables = complete_tables(results, settings)
    texts = {f"table_{name.replace('.', '_')}.csv": to_csv(rows) for name, rows in tables.items()}
    texts["tables.md"] = _page(tables, settings, command)
    texts["paper.json"] = json.dumps(_record(tables, results, settings, command), indent=1) + "\n"
    for name, text in texts.items():
        with replacing(folder / name, follow_links=False) as stream:
            stream.write(text.encode())
    return [folder / name for name in texts]


def complete_tables(results: Results, settings: Settings) -> dict[TableName, list[Row]]:
    """Return the rows of each table for which every set of points was measured."""
    names: list[TableName] = ["5.1", "5.2"]
    complete = [name for name in names if results.done.issuperset(settings.trials([name]))]
    rows = summarise(results.measurements)
    return {name: [row for row in rows if row.table == name] for name in complete}


def _spread(row: Row, method: str) -> str:
    """Format seconds with half the range from the fastest to the slowest seed in percent."""
    text, (low, high) = _seconds(row, method), row.spread[method]
    return text if row.seeds == 1 else f"{text} ±{50 * (high - low) / row.seconds[method]:.0f}%"


def _seconds(row: Row, method: str) -> str:
    """Format seconds with three digits, at most six decimals."""
    seconds = row.seconds[method]
    if seconds >= 100:
        return f"{seconds:,.0f}"
    return f"{seconds:#.3g}" if seconds >= 1e-3 else f"{seconds:.6f}"


def _markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    rule = ["---:"] * len(header)
    return [f"| {' | '.join(cells)} |" for cells in (header, rule, *rows)]


def _page(tables: Mapping[TableName, Sequence[Row]], settings: Settings, command: str) -> str:
    made = f"Measured on: {settings.machine}. Remade by `{command}`.\n"
    parts = [f"## Table {name}\n\n{to_markdown(rows)}" for name, rows in tables.items()]
    return "\n".join([made, *parts])


def _record(
    tables: Mapping[TableName, Sequence[Row]], results: Results, settings: Settings, command: str
) -> dict[str, Any]:
    return {
        "command": command,
        "machine": settings.machine,
        "versions": versions(),
        "settings": settings.record(),
        "columns": dict(COLUMNS),
        "tables": {name: [values(row) for row in rows] for name, rows in tables.items()},
        "measurements": [asdict(measurement) for measurement in results.measurements],
    }
