"""A run of all tests fails if one is left out; in either a test draws the same numbers."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from commands import ROOT

THIS = "tests/test_whole_run.py"
SEED = 5
RNG = np.random.default_rng(SEED)
SOME = ["--deselect", f"{THIS}::test_nested"]


def collected(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "--co", "-q", "-p", "no:cacheprovider", *words, THIS]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.slow
@pytest.mark.parametrize("words", [SOME, ["--whole", *SOME], ["--whole", "-k", "nested"]])
def test_only_a_whole_run_has_to_be_whole(words: list[str]) -> None:
    done = collected(*words)
    is_whole = "--whole" in words
    assert done.returncode == int(is_whole), done.stdout + done.stderr
    assert ("no test may be left out" in done.stdout) == is_whole


def test_nested() -> None:
    """Something to choose."""


@pytest.mark.slow
@pytest.mark.parametrize(("words", "is_there"), [([], True), (["--whole"], False)])
def test_a_whole_run_is_all_but_campaigns(words: list[str], is_there: bool) -> None:
    done = collected("-k", "test_nested or test_of_a_campaign", *words)
    assert ("::test_of_a_campaign" in done.stdout) == is_there
    assert "::test_nested" in done.stdout


@pytest.mark.campaign
def test_of_a_campaign() -> None:
    """Something that a whole run need not have."""


@pytest.mark.parametrize("turn", range(2))
def test_a_test_draws_the_same_numbers_after_any_other(turn: int) -> None:
    assert RNG.random(turn + 3)[0] == np.random.default_rng(SEED).random()
