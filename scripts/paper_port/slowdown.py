"""How well one speed of processor turns a variant's seconds into the printed ones.

A processor that is s times slower than this one would make every printed number s times the number
measured here, for the right program. So s is the geometric mean of printed / measured over LF and
LFRes in both cases, and what is left after dividing by s, as a root mean square of logarithms,
tells how far the variant is from the paper's program. A variant with s < 1 would need the paper's
laptop to be faster than this machine.
"""

from __future__ import annotations

from collections import defaultdict
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from liftmesh.paper.printed import TABLES, TableName

if TYPE_CHECKING:
    from paper_port.measure import Measurement

TABLE_OF_CASE: dict[int, TableName] = {1: "5.1", 2: "5.2"}


def printed_seconds(n: int, case: int) -> dict[str, float]:
    """Give a printed row by the procedures' names; empty where the paper has no such row."""
    row = TABLES[TABLE_OF_CASE[case]].row(n)
    return {} if row is None else {"LF": row.lf, "LFRes": row.lfres}


def likeness(found: list[Measurement]) -> tuple[float, float] | None:
    """Give the slowdown s of one variant, and the scatter that remains (0.1 is about 10 %)."""
    seconds: dict[tuple[int, int, str], list[float]] = defaultdict(list)
    for item in found:
        for name, value in item.seconds.items():
            seconds[item.n, item.case, name].append(value)
    logarithms = [
        np.log(printed[name] / median(values))
        for (n, case, name), values in seconds.items()
        if (printed := printed_seconds(n, case))
    ]
    if not logarithms:
        return None
    return float(np.exp(np.mean(logarithms))), float(np.std(logarithms))
