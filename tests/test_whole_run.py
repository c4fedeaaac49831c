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


@pytest.mark.parametrize("words", [SOME, ["--whole", *SOME], ["--whole", "-k", "nested"]])
def test_only_a_whole_run_has_to_be_whole(words: list[str]) -> None:
    command = [sys.executable, "-m", "pytest", "--co", "-p", "no:cacheprovider", *words, THIS]
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False
    )
    is_whole = "--whole" in words
    assert done.returncode == int(is_whole), done.stdout + done.stderr
    assert ("no test may be left out" in done.stdout) == is_whole


def test_nested() -> None:
    """Something to choose."""


@pytest.mark.parametrize("turn", range(2))
def test_a_test_draws_the_same_numbers_after_any_other(turn: int) -> None:
    assert RNG.random(turn + 3)[0] == np.random.default_rng(SEED).random()
