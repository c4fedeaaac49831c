"""Tables 5.1 and 5.2 as the paper prints them.

Each row times Algorithm 2 twice on one random set of n points in [0, 200] x [0, 200]: with LF and
with LFRes, in seconds, "in C [...] on PC Core i5 1.8 GHz 3M with 8 GB RAM". The two tables differ
in the vertex q of the paraboloid. The numbers are copied unchanged. Every printed ratio agrees with
the printed seconds to within their rounding; the text's "from 1.70" for Table 5.2 does not agree
with its row of 3,000 points, which prints 1.60.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, TypeAlias

TableName: TypeAlias = Literal["5.1", "5.2"]
Vertex: TypeAlias = Literal["origin", "median"]

SQUARE = 200.0
"""Side length of the square of the points, which has one corner at the origin."""


@dataclass(frozen=True, slots=True)
class PrintedRow:
    """One line of a printed table."""

    n: int
    median: tuple[float, float] | None
    lf: float
    lfres: float
    ratio: float


@dataclass(frozen=True, slots=True)
class PrintedTable:
    """A printed table."""

    name: TableName
    q: Vertex
    rows: tuple[PrintedRow, ...]

    def row(self, n: int) -> PrintedRow | None:
        """Return the line for a number of points."""
        return next((row for row in self.rows if row.n == n), None)


TABLES: Mapping[TableName, PrintedTable] = MappingProxyType(
    {
        "5.1": PrintedTable(
            "5.1",
            "origin",
            (
                PrintedRow(1_000, None, 0.162, 0.078, 2.09),
                PrintedRow(2_000, None, 0.672, 0.301, 2.23),
                PrintedRow(3_000, None, 1.525, 0.666, 2.29),
                PrintedRow(5_000, None, 4.534, 1.790, 2.53),
                PrintedRow(7_000, None, 10.843, 3.014, 3.60),
                PrintedRow(8_000, None, 13.110, 5.100, 2.57),
                PrintedRow(10_000, None, 22.560, 9.740, 2.32),
                PrintedRow(15_000, None, 70.237, 34.567, 2.03),
                PrintedRow(20_000, None, 102.257, 49.339, 2.07),
            ),
        ),
        "5.2": PrintedTable(
            "5.2",
            "median",
            (
                PrintedRow(1_000, (100.82, 98.73), 0.088, 0.052, 1.70),
                PrintedRow(2_000, (99.58, 98.58), 0.368, 0.210, 1.75),
                PrintedRow(3_000, (99.59, 97.56), 0.376, 0.235, 1.60),
                PrintedRow(5_000, (98.30, 100.60), 2.341, 1.067, 2.19),
                PrintedRow(7_000, (98.65, 99.88), 4.611, 2.144, 2.15),
                PrintedRow(8_000, (100.24, 101.09), 6.287, 3.023, 2.08),
                PrintedRow(10_000, (101.39, 98.41), 11.789, 6.015, 1.96),
                PrintedRow(15_000, (98.63, 100.53), 29.132, 15.513, 1.88),
                PrintedRow(20_000, (100.07, 99.86), 53.417, 31.183, 1.71),
            ),
        ),
    }
)

SIZES = tuple(row.n for row in TABLES["5.1"].rows)
"""The numbers of points of both tables."""
