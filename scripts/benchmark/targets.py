"""The performance targets: ratios within one run, so that the machine hardly matters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from benchmark.cases import DEMANDING
from benchmark.contestants import Contestant
from benchmark.peers import CGAL
from benchmark.results import Measurement, ours

GIBIBYTE = 2**30
HALVED = ("uniform", "lattice", "line-singularity")  # of which the most is asked
Found = dict[tuple[str, int], Measurement]


@dataclass(frozen=True)
class Target:
    """A bound on a number; `reached` is None if it was not measured."""

    work: str
    what: str
    bound: float
    reached: float | None
    least: bool = False
    unit: str = ""

    @property
    def met(self) -> bool | None:
        if self.reached is None:
            return None
        return self.reached >= self.bound if self.least else self.reached <= self.bound


def targets(measurements: list[Measurement], million: int) -> Iterator[Target]:
    """Compare the measurements with every target."""
    found = {(m.distribution, m.size): m for m in measurements}
    yield from on_a_million(found, million)
    yield from on_demanding_inputs(found, million)
    yield from on_large_inputs(found, million)
    yield from on_threads(found, million)
    yield from against_before(found, million)


def on_a_million(found: Found, million: int) -> Iterator[Target]:
    uniform = found.get(("uniform", million))
    rivals = ((CGAL, 1, 0.14), ("shull", 2, 0.10), ("triangle", 1, 0.07), ("scipy", 1, 0.011))
    for peer, threads, bound in rivals:
        rival = Contestant(peer, threads)
        reached = uniform.ratio(ours(2), rival) if uniform else None
        yield Target(f"{million:,} uniform, 2 threads", f"time / {rival.label}", bound, reached)
    reached = uniform.ratio(ours(1), Contestant(CGAL)) if uniform else None
    yield Target(f"{million:,} uniform, 1 thread", f"time / {CGAL}", 0.24, reached)


def on_demanding_inputs(found: Found, million: int) -> Iterator[Target]:
    for name in DEMANDING:
        measurement = found.get((name, million))
        rival = measurement.best_rival(2) if measurement else None
        best = f"time / best exact peer ({rival.label if rival else 'none'})"
        reached = measurement.against_best(2) if measurement else None
        yield Target(f"{million:,} {name}, 2 threads", best, 0.35, reached)


def on_large_inputs(found: Found, million: int) -> Iterator[Target]:
    large, huge = (found.get(("uniform", factor * million)) for factor in (10, 100))
    work = f"{10 * million:,} uniform, 2 threads"
    reached = large.ratio(ours(2), Contestant(CGAL)) if large else None
    yield Target(work, f"time / {CGAL}", 0.13, reached)
    growth = f"time a point / that at {million:,}"
    yield Target(work, growth, 1.35, grown(found, million, 10))
    work = f"{100 * million:,} uniform, 2 threads"
    timing = huge.timing(ours(2)) if huge else None
    peak = timing.trial.peak / GIBIBYTE if timing else None
    yield Target(work, "resident at peak", 16.0, peak, unit=" GiB")
    yield Target(work, growth, 1.6, grown(found, million, 100))


def grown(found: Found, million: int, factor: int) -> float | None:
    """Return our time per point on a larger input divided by that on a million."""
    pair = [found.get(("uniform", size)) for size in (factor * million, million)]
    costs = [m.seconds_per_row(ours(2)) if m else None for m in pair]
    return costs[0] / costs[1] if costs[0] and costs[1] else None


def on_threads(found: Found, million: int) -> Iterator[Target]:
    for size in (million, 10 * million):
        uniform = found.get(("uniform", size))
        gain = uniform.gain(2) if uniform else None
        yield Target(f"{size:,} uniform", "1 thread / 2 threads", 1.8, gain, least=True)


def against_before(found: Found, million: int) -> Iterator[Target]:
    """Compare with the former version, if that was measured."""
    for size in (million // 1000, million // 100, million // 10):
        measurement = found.get(("uniform", size))
        reached = measurement.against_before(1) if measurement else None
        if reached is not None:
            yield Target(f"{size:,} uniform, 1 thread", "time / before", 0.6, reached)
    for name in ("uniform", *DEMANDING):
        measurement = found.get((name, million))
        reached = measurement.against_before(2) if measurement else None
        if reached is not None:
            bound = 0.55 if name in HALVED else 0.7
            yield Target(f"{million:,} {name}, 2 threads", "time / before", bound, reached)


def small_targets(measurements: list[Measurement], _: int) -> Iterator[Target]:
    """Compare the latency of small calls with its targets."""
    bounds = {10: 15.0, 100: 50.0, 1000: 300.0}
    for measurement in measurements:
        for threads in (1, 2):
            before = measurement.against_before(threads)
            if before is not None:
                yield Target(small_work(measurement, threads), "time / before", 0.7, before)
            timing = measurement.timing(ours(threads))
            reached = timing.median * 1e6 if timing else None
            work = small_work(measurement, threads)
            yield Target(work, "median of a call", bounds[measurement.size], reached, unit=" µs")


def small_work(measurement: Measurement, threads: int) -> str:
    return f"{measurement.rows:,} rows, threads={threads}"


def progress_targets(measurements: list[Measurement], _: int) -> Iterator[Target]:
    """Compare the cost of a callback with its target."""
    for measurement in measurements:
        for threads in (1, 2):
            with_callback = Contestant("liftmesh progress", threads)
            ratio = measurement.ratio(with_callback, ours(threads))
            cost = None if ratio is None else 100 * (ratio - 1)
            work = small_work(measurement, threads)
            yield Target(work, "progress= costs", 1.0, cost, unit=" %")


TARGETS = {"targets": targets, "small": small_targets, "progress": progress_targets}
