"""Conversion of measurements to lines of text and back, one for each method and set of points.

The methods of a set follow one another in order, and no set occurs twice; lines that violate this,
or that hold impossible values, are rejected.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import get_args

from liftmesh.paper.experiments import METHODS, Measurement, Trial
from liftmesh.paper.printed import TableName
from liftmesh.planar.lifting import REJECTIONS

_TIMES = ("seconds", "fastest", "slowest")
_COUNTS = ("runs", "facets", "calls", "planes", "evaluations", "undecided")
_REJECTED = {name: f"rejected {name}" for name in REJECTIONS}

COLUMNS = ("table", "n", "seed", "method", *_TIMES, *_COUNTS, *_REJECTED.values())
"""The names of the columns."""


def to_line(measurement: Measurement) -> str:
    """Convert a measurement to a line without losing digits."""
    trial, values = measurement.trial, asdict(measurement)
    cells = [trial.table, trial.n, trial.seed, measurement.method]
    cells += [repr(values[name]) for name in (*_TIMES, *_COUNTS)]
    return ",".join(map(str, [*cells, *(measurement.rejected[name] for name in REJECTIONS)]))


def from_lines(lines: Sequence[str], *, first: int) -> list[Measurement]:
    """Parse lines of measurements."""
    found: list[Measurement] = []
    seen: set[Trial] = set()
    for k, line in enumerate(lines):
        try:
            measurement = _measurement(line.split(","))
            _check_place(measurement, found, seen)
        except ValueError as error:
            raise ValueError(f"line {first + k}: {error}") from error
        found.append(measurement)
    return found


def _measurement(cells: Sequence[str]) -> Measurement:
    if len(cells) != len(COLUMNS):
        raise ValueError(f"{len(cells)} columns instead of {len(COLUMNS)}")
    values = dict(zip(COLUMNS, cells, strict=True))
    seconds, fastest, slowest = _times(values)
    counts = _counts(values)
    return Measurement(
        _trial(values),
        values["method"],
        seconds=seconds,
        fastest=fastest,
        slowest=slowest,
        runs=counts["runs"],
        facets=counts["facets"],
        calls=counts["calls"],
        planes=counts["planes"],
        evaluations=counts["evaluations"],
        undecided=counts["undecided"],
        rejected={name: counts[column] for name, column in _REJECTED.items()},
    )


def _trial(values: Mapping[str, str]) -> Trial:
    for table in get_args(TableName):
        if table == values["table"]:
            return Trial(table, int(values["n"]), int(values["seed"]))
    raise ValueError(f"there is no table {values['table']!r}")


def _times(values: Mapping[str, str]) -> tuple[float, float, float]:
    seconds, fastest, slowest = (float(values[name]) for name in _TIMES)
    if not 0 < fastest <= seconds <= slowest < float("inf"):
        raise ValueError("the seconds are out of order")
    return seconds, fastest, slowest


def _counts(values: Mapping[str, str]) -> dict[str, int]:
    counts = {name: int(values[name]) for name in (*_COUNTS, *_REJECTED.values())}
    if min(counts.values()) < 0 or counts["runs"] == 0 or counts["facets"] == 0:
        raise ValueError("a count is too small")
    return counts


def _check_place(measurement: Measurement, found: Sequence[Measurement], seen: set[Trial]) -> None:
    expected = METHODS[len(found) % len(METHODS)]
    if measurement.method != expected:
        raise ValueError(f"method {measurement.method!r} instead of {expected!r}")
    if expected == METHODS[0]:
        if measurement.trial in seen:
            raise ValueError(f"{measurement.trial} occurs twice")
        seen.add(measurement.trial)
    elif measurement.trial != found[-1].trial:
        raise ValueError("its set of points is not that of the previous line")
