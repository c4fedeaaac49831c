"""Compare a variant's times with the printed ones, up to the speed of the processor.

On a processor that is s times slower than this one, the paper's program takes s times the seconds
measured here. So the slowdown s is estimated as the geometric mean of printed / measured over LF
and LFRes in both cases; the scatter, the standard deviation of the logarithms of these ratios,
tells how far the variant is from the paper's program. A variant with s < 1 would need the paper's
laptop to be faster than this machine.
"""

from __future__ import annotations

from collections import defaultdict
from statistics import median
from typing import TYPE_CHECKING

import numpy as np
from paper_port.inputs import TABLE_OF_CASE

from liftmesh.paper.printed import TABLES

if TYPE_CHECKING:
    from paper_port.measure import Measurement


def printed_seconds(n: int, case: int) -> dict[str, float]:
    """Return the printed seconds by procedure; empty if the paper has no such row."""
    row = TABLES[TABLE_OF_CASE[case]].row(n)
    return {} if row is None else {"LF": row.lf, "LFRes": row.lfres}


def slowdown_and_scatter(found: list[Measurement]) -> tuple[float, float] | None:
    """Return the slowdown of a variant and the scatter (0.1 is about 10 %)."""
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
