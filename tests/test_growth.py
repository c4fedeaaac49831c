"""No function, reader or writer takes more for a row or a byte of a large input than of a small.

The inputs are the worst known of their kind (`scripts/growth`). What they cost is counted in
instructions, so that other programs on the machine do not matter; `python scripts/growth` measures
seconds at larger sizes.
"""

from __future__ import annotations

import inspect
from functools import cached_property
from pathlib import Path

import pytest
from growth.counting import Count
from growth.growing import ORDERS, Growth, cases, grown
from growth.subjects import FILES, WITHOUT_DATA, subjects
from test_codebase import METHODS, NAMES

from liftmesh.io.registry import FORMATS

GROUPS = 4
SUBJECTS = subjects()
CASES = sorted(cases())
PROPERTIES = {
    f"{name}.{key}": member
    for name, kind in NAMES.items()
    if inspect.isclass(kind)
    for key, member in vars(kind).items()
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
    assert [name for name in WITHOUT_DATA if name not in NAMES] == []


def test_every_format_has_its_worst_files() -> None:
    assert {each.name for each in FORMATS} == FILES.keys()
    for each in FORMATS:
        assert len(FILES[each.name]) > 1, each.name


def test_every_family_says_why_it_is_one() -> None:
    for subject in SUBJECTS.values():
        assert subject.families
        for family in subject.families.values():
            assert (family.__doc__ or "").strip().endswith(".")
        assert {*(subject.counted or ())} <= subject.families.keys()


def test_known_orders_are_counted() -> None:
    assert [case for case in ORDERS if case not in CASES] == []


@pytest.mark.parametrize("group", range(GROUPS))
def test_cost_grows_no_faster_than_the_input(group: int) -> None:
    found = grown(CASES[group::GROUPS])
    assert len(found) > 10
    assert [each.fault for each in found if each.fault] == []


def test_quadratic_work_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
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
