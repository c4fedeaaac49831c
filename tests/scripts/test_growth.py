"""No function, reader or writer takes more for a row or a byte of a large input than of a small.

The inputs are the worst known of their kind (`scripts/growth`). What they cost is counted in
instructions, so that other programs on the machine do not matter; `python scripts/growth` measures
seconds at larger sizes.
"""

from __future__ import annotations

import inspect
from contextlib import nullcontext
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest
from growth import seconds
from growth.counting import Count, Work
from growth.growing import ORDERS, Growth, cases, grown
from growth.seconds import Timing
from growth.subjects import FILES, WITHOUT_DATA, Subject, subjects
from public_names import METHODS, NAMES

from liftmesh.io.registry import FORMATS

LIBRARIES = (
    "las", "raster", "e57", "glb", "gltf", "trimesh", "matplotlib", "scipy", "Delaunay", "compare",
    "Comparison", "save", "shapely", "geodataframe", "not_simple",
)  # fmt: skip
"""Parts of the names of what imports trimesh, Matplotlib or SciPy: one process imports them all."""
SUBJECTS = subjects()
CASES = sorted(cases())
PROPERTIES = {
    f"{name}.{key}": member
    for name, kind in NAMES.items()
    if inspect.isclass(kind)
    for base in kind.__mro__  # what a base that is not public holds is its own
    if base is kind or (base.__module__.startswith("liftmesh.") and base not in NAMES.values())
    for key, member in vars(base).items()
    if isinstance(member, property | cached_property) and not key.startswith("_")
}


def test_every_public_name_is_watched() -> None:
    watched = {name.split()[0] for name in SUBJECTS}
    assert [n for n in [*NAMES, *METHODS] if n not in watched and n not in WITHOUT_DATA] == []
    assert watched - {*NAMES, *METHODS, *PROPERTIES} == set()


def test_every_property_that_is_computed_once_is_watched() -> None:
    computed = [key for key, member in PROPERTIES.items() if isinstance(member, cached_property)]
    assert computed
    assert [key for key in computed if key not in SUBJECTS] == []


def test_names_without_data_exist() -> None:
    assert [name for name in WITHOUT_DATA if name not in {*NAMES, *METHODS}] == []


def test_every_format_has_its_worst_files() -> None:
    readable = [each.name for each in FORMATS if each.read is not None]
    assert {*readable} == FILES.keys()
    for name in readable:
        assert len(FILES[name]) > 1, name


def test_every_family_says_why_it_is_one() -> None:
    for subject in SUBJECTS.values():
        assert subject.families
        for family in subject.families.values():
            assert (family.__doc__ or "").strip().endswith(".")
        assert {*(subject.counted or ())} <= subject.families.keys()


def test_known_orders_are_counted() -> None:
    assert [case for case in ORDERS if case not in CASES] == []


@pytest.mark.campaign
@pytest.mark.parametrize("libraries", [False, True])
def test_cost_grows_no_faster_than_the_input(libraries: bool) -> None:
    found = grown([case for case in CASES if libraries == any(x in case[0] for x in LIBRARIES)])
    assert len(found) > 10
    assert [each.fault for each in found if each.fault] == []


@pytest.mark.slow
def test_quadratic_work_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1] / "support"))
    some = [("numbers", "each with all"), ("numbers", "each with the next")]
    quadratic, linear = grown(some, prepare="quadratic_work:prepare")
    assert quadratic.ratio > 6
    assert "each with all" in quadratic.fault
    assert 0.5 < linear.ratio < 1.5
    assert linear.fault == ""


def test_a_known_order_has_a_bound_and_an_end() -> None:
    case = next(iter(ORDERS))
    worse, linear = (
        Growth(case, tuple(Count(units**power, units) for units in (1, 8, 64))) for power in (3, 1)
    )
    assert "x 64" in worse.fault
    assert "no longer grows" in linear.fault


def test_what_was_not_measured_is_not_fine() -> None:
    found = Timing("read ply", "points as text")
    assert found.verdict == "not measured"
    found.seconds = {1000: 0.1, 2000: 0.2, 4000: 0.4}
    assert found.verdict == "not measured"
    found.seconds[8000] = 0.8
    assert found.verdict == ""
    found.seconds[16_000] = 8.0
    assert found.verdict == "grows"
    uneven = {900: 0.9, 5_000: 5.0, 40_000: 160.0}  # at 44 times the least, 4 times a unit
    assert Timing("numbers", "all", uneven).ratio == pytest.approx(4)
    del uneven[5_000]
    assert Timing("numbers", "all", uneven).ratio == pytest.approx(
        4 ** (np.log(8) / np.log(400 / 9))
    )


class Clock:
    """Seconds of CPU that calls take as they say."""

    def __init__(self) -> None:
        self.now = 0.0

    def process_time(self) -> float:
        return self.now

    def advance(self, seconds: float) -> None:
        self.now += seconds


@pytest.mark.slow
def test_slow_cases_are_timed_from_smaller_sizes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    monkeypatch.setattr(seconds, "time", clock)
    monkeypatch.setattr(seconds, "limited", lambda _: nullcontext())
    slow = Subject(
        "numbers", {"all": lambda n: n}, lambda n: Work(lambda: clock.advance(1e-5 * n), n)
    )
    found = seconds.timed(slow, "all", 0.1)
    assert min(found.seconds) < seconds.FIRST
    assert found.ratio == pytest.approx(1)


def test_a_reader_may_not_grow_slowly_either() -> None:
    counts = tuple(Count(n * (1000 + n), n) for n in (64, 512, 4096))
    assert Growth(("read ply", "properties"), counts).fault
    sorting = tuple(Count(n * (10 + n.bit_length()), n) for n in (64, 512, 4096))
    assert Growth(("read ply", "properties"), sorting).fault == ""
