"""A triangulation costs the same in every form of the points: instructions are counted."""

from __future__ import annotations

from pathlib import Path

import pytest
from array_forms import FORMS
from growth.counting import count


@pytest.mark.campaign
def test_no_form_of_the_points_costs_a_tenth_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1] / "support"))
    plain, *others = (each.instructions for each in count("array_forms:prepare", [*FORMS]))
    shares = {form: n / plain for form, n in zip([*FORMS][1:], others, strict=True)}
    assert {form: share for form, share in shares.items() if share > 1.1} == {}
