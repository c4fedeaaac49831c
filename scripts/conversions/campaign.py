"""A longer hunt: clouds that hypothesis draws, through every pair of ways."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial

import hypothesis
from conversions.checking import check_chunks, check_pairs, went_through
from conversions.drawn import clouds
from conversions.objects import objects
from conversions.passages import files
from conversions.read_only import read_only
from conversions.tetrahedra import TRIPS
from conversions.write_only import READERS
from hypothesis import HealthCheck, Phase, given, settings, strategies as st

from liftmesh import Cloud

WAYS = (*files(), *read_only(), *objects())
BY_NAME = {str(way): way for way in WAYS}
# A stream does not tell what .ele files, shapefiles and compressed ones need: a name.
IN_CHUNKS = tuple(
    way
    for way in (*files(), *read_only())
    if way.place not in {"ele", "shapefile", *READERS} and ".gz" not in way.place
)

_ROUND = 20  # examples of one seed
_SETTINGS = {
    "max_examples": _ROUND,
    "deadline": None,
    "database": None,
    "report_multiple_bugs": False,
    "phases": [Phase.generate, Phase.shrink],
    "suppress_health_check": [*HealthCheck],
}


def hunt(seconds: float, seed: int) -> int:
    """Draw clouds for some seconds; return how many there were.

    Raises
    ------
    ChangedError
        One of them changed unsaid, in its smallest form.
    """
    end, count = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        hypothesis.seed(seed + count)(_property)()
        count += _ROUND
    return count


Trip = Callable[[Cloud], object]

_suspects: list[Trip] = []  # after a find the trip that shows it, so that shrinking makes no other


@settings(**_SETTINGS)  # type: ignore[arg-type]
@given(clouds(), st.lists(st.sampled_from([*BY_NAME]), min_size=3, max_size=3, unique=True))
def _property(cloud: Cloud, first: list[str]) -> None:
    for trip in _suspects or _trips(first):
        _make(trip, cloud)


def _make(trip: Trip, cloud: Cloud) -> None:
    try:
        trip(cloud)
    except Exception:
        _suspects[:] = [trip]
        raise


def _trips(first: list[str]) -> Iterator[Trip]:
    yield from TRIPS
    for way in WAYS:
        yield partial(went_through, way)
    for way in IN_CHUNKS:
        yield partial(check_chunks, way)
    for name in first:
        for way in WAYS:
            yield partial(check_pairs, first=[BY_NAME[name]], second=[way])
