"""The sessions of nox: every campaign that a night runs is there."""

from __future__ import annotations

import runpy
import shlex

import pytest
from commands import ROOT

NOXFILE = runpy.run_path(str(ROOT / "noxfile.py"))


@pytest.mark.parametrize("campaign", NOXFILE["CAMPAIGNS"])
def test_campaigns_of_the_night_are_there(campaign: str) -> None:
    place = ROOT / "scripts" / shlex.split(campaign)[0]
    assert place.is_file() if place.suffix else (place / "__main__.py").is_file()
