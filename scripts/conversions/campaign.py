"""A longer hunt: clouds that hypothesis draws, through every pair of ways."""

from __future__ import annotations

import random
import time
from typing import TYPE_CHECKING

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings, strategies as st

from conversions.checking import check_chunks, check_pairs, went_through
from conversions.drawn import clouds
from conversions.objects import objects
from conversions.passages import files
from conversions.read_only import read_only

if TYPE_CHECKING:
    from liftmesh import Cloud

WAYS = (*files(), *read_only(), *objects())
BY_NAME = {str(way): way for way in WAYS}
# A stream does not tell what .ele files and compressed ones need: a name.
IN_CHUNKS = tuple(
    way for way in (*files(), *read_only()) if way.place != "node" and ".gz" not in way.place
)

_ROUND = 20  # examples of one seed
_SETTINGS = {
    "max_examples": _ROUND,
    "deadline": None,
    "database": None,
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


@settings(**_SETTINGS)  # type: ignore[arg-type]
@given(clouds(), st.lists(st.sampled_from([*BY_NAME]), min_size=3, max_size=3, unique=True))
def _property(cloud: Cloud, first: list[str]) -> None:
    for way in WAYS:
        went_through(way, cloud)
    for way in IN_CHUNKS:
        check_chunks(way, cloud)
    check_pairs(cloud, [BY_NAME[name] for name in first], WAYS)


def any_seed() -> int:
    """Draw a seed."""
    return random.SystemRandom().randrange(1 << 31)
