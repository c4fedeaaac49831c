"""Both signals at random moments of every command, with every format: the short form."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from commands import ROOT

pytestmark = pytest.mark.campaign


def sweep(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "scripts" / "sweep"), *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=1200, check=False)


def test_no_signal_is_lost_in_a_hundred_runs() -> None:
    done = sweep(
        "--rows", "500", "--runs", "100", "--most", "60", "--second", "60"
    )  # others run, too
    assert done.returncode == 0, done.stdout + done.stderr
    counts = re.search(
        r"^100 runs, signals (\d+) before .+, (\d+) during .+, (\d+) after", done.stdout
    )
    assert counts
    before, during, after = map(int, counts.groups())
    assert before + during + after == 100
    assert during > 0  # how many depends on what runs beside it
    assert "; 0 faults, in " in done.stdout


def test_long_commands_end_in_every_phase() -> None:
    words = ("--long", "--rows", "100000", "--runs", "6", "--most", "60", "--second", "60")
    done = sweep(*words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "6 runs, signals " in done.stdout


def test_a_sweep_fails_where_a_command_is_late() -> None:
    commands = ("--commands", "volume", "profile", "thin")
    done = sweep("--rows", "500", "--runs", "20", "--most", "0", "--second", "0", *commands)
    assert done.returncode == 1, done.stdout + done.stderr
    late = re.findall(r"^run \d+: (\w+) .+: it took ", done.stdout, re.MULTILINE)
    assert late
    assert {*late} <= {*commands}
    assert "; 0 faults" not in done.stdout
