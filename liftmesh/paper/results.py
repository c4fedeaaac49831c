"""Measurements on disk, so that an interrupted run continues where it stopped.

``measurements.csv`` begins with a comment that holds the settings as JSON and a line of column
names, followed by one line for each method on each set of points. The lines of a set are appended
together and reach the disk before the next set begins. A crash can leave only the end of the file
incomplete: it is removed, and measured again. Any other damage is an error: the methods of a set
follow one another in order, no set occurs twice, and no value is impossible. So are different
settings: a table never mixes numbers of different machines or builds.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, get_args

from liftmesh.errors import FormatError, InputError
from liftmesh.io.atomic import replacing
from liftmesh.paper.experiments import (
    BURST,
    METHODS,
    PATIENCE,
    ROUNDS,
    Measurement,
    Trial,
    versions,
)
from liftmesh.paper.printed import TABLES, TableName
from liftmesh.planar.lifting import REJECTIONS

FILE = "measurements.csv"
_HEADING = "# liftmesh paper "
_TIMES = ("seconds", "fastest", "slowest")
_COUNTS = ("runs", "facets", "calls", "planes", "evaluations", "undecided")
_REJECTED = {name: f"rejected {name}" for name in REJECTIONS}

COLUMNS = ("table", "n", "seed", "method", *_TIMES, *_COUNTS, *_REJECTED.values())
"""The names of the columns."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings that all measurements of a table have in common."""

    sizes: tuple[int, ...]
    seeds: int
    machine: str

    def trials(self, tables: Sequence[TableName]) -> list[Trial]:
        """List the sets of points, small ones first."""
        seeds = range(1, self.seeds + 1)
        return [Trial(t, n, seed) for n in sorted(self.sizes) for seed in seeds for t in tables]

    def record(self) -> dict[str, Any]:
        """Return the settings, the versions and the repetition of runs as JSON values."""
        timing = {"rounds": ROUNDS, "patience": PATIENCE, "burst": BURST}
        own = {"sizes": sorted(self.sizes), "seeds": self.seeds, "machine": self.machine}
        return {**own, "methods": [*METHODS], **timing, **versions()}


class Results:
    """The measurements in a folder: those there already, and those added."""

    def __init__(self, folder: Path, settings: Settings) -> None:
        self.path = folder / FILE
        self._settings = settings
        self._heading = _HEADING + json.dumps(settings.record())
        self.measurements: list[Measurement] = []
        self.cut = 0
        if self.path.exists():
            self._load()
        else:
            self._write([])

    @property
    def done(self) -> set[Trial]:
        """The sets of points that have been measured."""
        return {measurement.trial for measurement in self.measurements}

    def add(self, measurements: Sequence[Measurement]) -> None:
        """Append the measurements of a set of points; they are on disk when this returns."""
        text = "".join(f"{to_line(measurement)}\n" for measurement in measurements)
        with self.path.open("ab") as stream:
            stream.write(text.encode())
            stream.flush()
            os.fsync(stream.fileno())
        self.measurements.extend(measurements)

    def _load(self) -> None:
        """Read the file, and remove its end if it is incomplete."""
        text = self._text()
        whole, _, torn = text.rpartition("\n")
        heading, _, rest = whole.partition("\n")
        _check_heading(self.path, heading, self._heading)
        names, *lines = rest.split("\n")
        if names != ",".join(COLUMNS):
            raise self._damaged("line 2 does not name the columns")
        complete = lines[: len(lines) // len(METHODS) * len(METHODS)]
        self.cut = len(lines) - len(complete) + bool(torn)
        try:
            self.measurements = from_lines(complete, first=3)
        except ValueError as error:
            raise self._damaged(str(error)) from error
        if strange := self.done.difference(self._settings.trials([*TABLES])):
            raise self._damaged(f"{min(strange)} is not part of its settings")
        if self.cut:
            self._write(complete)

    def _text(self) -> str:
        try:
            return self.path.read_text("utf-8")
        except UnicodeDecodeError as error:
            raise self._damaged(f"it is not text ({error})") from error

    def _damaged(self, reason: str) -> FormatError:
        return FormatError(f"{self.path}: {reason}: {_remedy(self.path)}")

    def _write(self, lines: Sequence[str]) -> None:
        with replacing(self.path, follow_links=False) as stream:
            text = "\n".join([self._heading, ",".join(COLUMNS), *lines])
            stream.write(f"{text}\n".encode())


def _remedy(path: Path) -> str:
    return f"delete {path.name} to measure again, or choose another folder"


def _check_heading(path: Path, heading: str, expected: str) -> None:
    """Raise for a file with different settings, and list them."""
    held, wanted = _settings(path, heading), _settings(path, expected)
    names = [name for name in {**held, **wanted} if held.get(name) != wanted.get(name)]
    if names:
        differ = "; ".join(f"{name} {held.get(name)}, now {wanted.get(name)}" for name in names)
        raise InputError(f"{path} has different settings ({differ}): {_remedy(path)}")


def _settings(path: Path, heading: str) -> dict[str, Any]:
    try:
        return dict(json.loads(heading.removeprefix(_HEADING)))
    except (ValueError, TypeError) as error:
        raise FormatError(f"{path}: line 1 holds no settings: {_remedy(path)}") from error


def to_line(measurement: Measurement) -> str:
    """Convert a measurement to a line without losing digits."""
    trial, values = measurement.trial, asdict(measurement)
    cells = [trial.table, trial.n, trial.seed, measurement.method]
    cells += [repr(values[name]) for name in (*_TIMES, *_COUNTS)]
    return ",".join(map(str, [*cells, *(measurement.rejected[name] for name in REJECTIONS)]))


def from_lines(lines: Sequence[str], *, first: int) -> list[Measurement]:
    """Parse lines of measurements."""
    measurements: list[Measurement] = []
    seen: set[Trial] = set()
    for k, line in enumerate(lines):
        try:
            measurement = _measurement(line.split(","))
            _check_place(measurement, measurements, seen)
        except ValueError as error:
            raise ValueError(f"line {first + k}: {error}") from error
        measurements.append(measurement)
    return measurements


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


def _check_place(measurement: Measurement, before: Sequence[Measurement], seen: set[Trial]) -> None:
    expected = METHODS[len(before) % len(METHODS)]
    if measurement.method != expected:
        raise ValueError(f"method {measurement.method!r} instead of {expected!r}")
    if expected == METHODS[0]:
        if measurement.trial in seen:
            raise ValueError(f"{measurement.trial} occurs twice")
        seen.add(measurement.trial)
    elif measurement.trial != before[-1].trial:
        raise ValueError("its set of points is not that of the previous line")
