"""Whether the cost of a row or a byte grows with the size of the input.

The cost is taken at three sizes s, 8 s and 64 s. The share that does not depend on the size drops
out of the differences: what a row costs between s and 8 s, and what it costs between 8 s and 64 s,
are the slopes of the cost at sizes that differ by 8. Linear work has a ratio of 1, sorting about
1.3, quadratic work 8. More than 3 is too much; of what reads and writes files, more than 1.6: it
sorts nothing, and a quadratic part with a small constant shows as little more than 1 at first.

`ORDERS` holds the cases that are known to grow faster, each with its reason and the ratio that it
may reach, which is that of quadratic work with some room. One that no longer grows must be taken
off that list. `LIKEWISE` holds subjects that may reach the same ratio on any family, for the same
reason. `LARGE` holds cases of which it takes sizes to see that are measured in seconds alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from growth.counting import Count, Work, count
from growth.subjects import Subject, subjects

MOST = 3.0
LINEAR = 1.6
QUADRATIC = 16.0
NOISE = 0.1
"""A slope below this share of the cost of a unit is taken for noise in the fixed costs."""

Case = tuple[str, str]

_FACETS = "the paper's procedure: each facet looks at every point"

ORDERS: dict[Case, str] = {
    ("delaunay by lf", "uniform"): _FACETS,
    ("delaunay by lfres", "uniform"): _FACETS,
    ("lower_hull by lf", "lifted points"): _FACETS,
}
_ACROSS = "thin faces lie across each other: as many parts overlap as there are pairs"
_CROWDED = "linear, but from some size on crossings come together, and sides are split: 20 times"
_WIDE = "linear, but from some size on exponents are so far apart that crossings are Python's"
_ERROR = "sides of faces as thin as rounding cross almost all others: it ends in an error"
_NO_AREA = "two fans with their apexes in common, none of whose faces overlap beyond rounding"
_LEVELS = "linear from 2,098 rows on: each asks all powers of two that radii have"

LARGE: dict[Case, str] = {
    ("Surface.cut_and_fill", "facing arcs"): _ACROSS,
    ("Surface.cut_and_fill", "polar scan"): _ACROSS,
    **{("difference", f): _CROWDED for f in ("parabola", "nested clusters", "two scales")},
    ("difference", "off the sample"): _CROWDED,
    ("difference", "oblique line"): _ERROR,
    ("difference", "wide line"): _NO_AREA,
    ("paste", "colliding hashes"): _WIDE,
    ("Triangulation.graph sphere_of_influence", "powers of two"): _LEVELS,
}
FILES = ("read ", "read_chunks ", "write ")
LIKEWISE = ("delaunay by ", "lower_hull by ")


@dataclass(frozen=True, slots=True)
class Growth:
    """The costs of one case at sizes that differ by eight, and their growth."""

    case: Case
    counts: tuple[Count, ...]

    @property
    def ratio(self) -> float:
        """Cost of a unit between the last two sizes, divided by that between the first two."""
        slopes = [
            (large.instructions - small.instructions) / max(large.units - small.units, 1)
            for small, large in zip(self.counts, self.counts[1:], strict=False)
        ]
        middle = self.counts[1]
        return slopes[1] / max(slopes[0], NOISE * middle.instructions / middle.units)

    @property
    def fault(self) -> str:
        """What is wrong, in words; an empty string if nothing is."""
        shown = [f"{each.instructions / each.units:,.1f}" for each in self.counts]
        if self.ratio > most_of(self.case):
            return f"{' on '.join(self.case)}: {' '.join(shown)} a unit, x {self.ratio:.1f}"
        if self.case in ORDERS and self.ratio < MOST / 2:
            return f"{' on '.join(self.case)}: no longer grows: take it off ORDERS"
        return ""


def most_of(case: Case) -> float:
    """Return the ratio that a case may reach."""
    if case in ORDERS or case in LARGE or case[0].startswith(LIKEWISE):
        return QUADRATIC
    return LINEAR if case[0].startswith(FILES) else MOST


def cases(found: Mapping[str, Subject] | None = None) -> Iterator[Case]:
    """List what the tests count."""
    for name, subject in (found or subjects()).items():
        chosen = subject.families if subject.counted is None else subject.counted
        yield from ((name, family) for family in chosen)


def grown(chosen: list[Case], *, prepare: str = "growth.growing:prepare") -> list[Growth]:
    """Count cases at all their sizes, in one child process."""
    jobs = [[name, family, k] for name, family in chosen for k in range(3)]
    counts = count(prepare, jobs)
    return [Growth(case, tuple(counts[3 * k : 3 * k + 3])) for k, case in enumerate(chosen)]


def prepare(job: list[str | int]) -> Work:
    """Make the call of a job: a subject, a family, and which of the sizes."""
    name, family, number = job
    subject = subjects()[str(name)]
    size = subject.sizes(str(family))[int(number)]
    return replace(subject.prepare(subject.families[str(family)](size)), warm=number == 0)
