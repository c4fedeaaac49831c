"""The cases: a case is one input and its contestants, a profile a list of cases."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from distributions import DISTRIBUTIONS

from benchmark.contestants import Contestant, line_up
from benchmark.peers import BEFORE, CGAL, OURS, RIVALS, SORT

MILLION = 10**6
FIELD = (OURS, *RIVALS)
"""The peers that take part by default."""

DEMANDING = (
    "gaussian",
    "kuzmin",
    "clusters",
    "lattice",
    "utm-lattice",
    "tilted-lattice",
    "circle",
    "line-singularity",
    "two-columns",
    "jacksboro",
)
"""Distributions on each of which a target is set."""


@dataclass(frozen=True)
class Case:
    """An input, its contestants and limits; `calls` is calls a round, 0 as many as fill it."""

    distribution: str
    size: int
    peers: tuple[str, ...] = FIELD
    threads: tuple[int, ...] = (1, 2)
    rounds: int = 5
    patience: float = 20.0
    calls: int = 0

    def contestants(self) -> Iterator[Contestant]:
        """Return the contestants in the order of a round."""
        return line_up(self.peers, self.threads)


def ourselves(case: Case) -> tuple[str, ...]:
    """Return liftmesh, and its former version if that takes part."""
    return tuple(peer for peer in case.peers if peer in {OURS, BEFORE})


def grid(case: Case, distributions: Iterable[str], sizes: Iterable[int]) -> list[Case]:
    """Vary a case over distributions and sizes, small sizes first."""
    found = [
        replace(case, distribution=name, size=size)
        for size in sorted(sizes)
        for name in distributions
    ]
    return [with_sort(case) if case.distribution == "uniform" else case for case in found]


def with_sort(case: Case) -> Case:
    """Add the sort of one coordinate as a yardstick."""
    return replace(case, peers=tuple(dict.fromkeys((*case.peers, SORT))))


def full(case: Case, million: int) -> list[Case]:
    """Uniform points in every size, then every other distribution with a million rows."""
    growth = grid(case, ["uniform"], [max(3, million * 10**k // 1000) for k in range(5)])
    others = [name for name in DISTRIBUTIONS if name != "uniform"]
    return [*growth, *grid(case, others, [million]), hundred_million(case, million)]


def hundred_million(case: Case, million: int) -> Case:
    return replace(case, size=100 * million, peers=(OURS,), rounds=2, patience=300.0)


def quick(case: Case, million: int) -> list[Case]:
    """Few rows, few inputs, three rounds."""
    case = replace(case, rounds=3, patience=3.0)
    some = ["lattice", "utm-lattice", "clusters", "circle", "jacksboro"]
    growth = grid(case, ["uniform"], [max(3, million // k) for k in (1000, 100, 10)])
    return [*growth, *grid(case, some, [million // 10])]


def targeted(case: Case, million: int) -> list[Case]:
    """The inputs on which targets are set, with the peers that the targets name."""
    some = grid(replace(case, patience=5.0), DEMANDING, [million])
    large = replace(case, size=10 * million, peers=(*ourselves(case), CGAL), patience=60.0)
    patient = replace(case, patience=30.0)
    return [
        *grid(patient, ["uniform"], [max(3, million // k) for k in (1000, 100, 10, 1)]),
        *some,
        large,
        hundred_million(case, million),
    ]


def small(case: Case, million: int) -> list[Case]:
    """Arrays of ten, a hundred and a thousand rows, in a loop."""
    calls = max(1, million // 100)
    return grid(replace(case, rounds=3, calls=calls), ["uniform"], [10, 100, 1000])


def progress(case: Case, million: int) -> list[Case]:
    """With and without a callback."""
    case = replace(case, size=million, peers=(OURS, "liftmesh progress"))
    return [replace(case, rounds=31, patience=120.0)]


PROFILES = {
    "full": full,
    "quick": quick,
    "targets": targeted,
    "small": small,
    "progress": progress,
}
