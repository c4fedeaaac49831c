"""The campaign of wheels: what it builds for, and the table that it writes.

The campaign itself, `python scripts/wheels`, compiles the kernel ten times.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from native.build import KERNEL, _united as united
from wheels import outcome
from wheels.building import AARCH64, MANYLINUX, MUSLLINUX
from wheels.kernels import SYSTEMS
from wheels.outcome import Outcome


def test_wheels_are_named_after_the_system_that_they_are_for() -> None:
    assert MANYLINUX.suffix("311") == ".cpython-311-x86_64-linux-gnu.so"
    assert AARCH64.suffix("310") == ".cpython-310-aarch64-linux-gnu.so"
    assert MUSLLINUX.suffix("312") == ".cpython-312-x86_64-linux-musl.so"


def test_systems_that_nothing_here_runs_are_not_run() -> None:
    assert {s.name.split()[0] for s in SYSTEMS} == {"Linux", "Windows", "macOS"}
    assert not any(s.runs_here for s in SYSTEMS if s.name.startswith("macOS"))
    assert all("-Werror" in s.build.program.flags for s in SYSTEMS)


def test_a_room_of_the_kernel_is_compiled_at_once(tmp_path: Path) -> None:
    program = SYSTEMS[0].build.program
    sources = united(program, tmp_path)
    told = "".join(p.read_text("utf-8") for p in sources if p.parent == tmp_path)
    for source in program.sources():
        assert (str(source) in told) != (source in sources), source
    assert KERNEL / "base" / "platform.cpp" in sources  # what systems define stays there


def test_a_row_takes_the_place_of_that_of_the_same_platform(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = tmp_path / "platforms.md"
    page.write_text(f"before\n{outcome.BEGIN}\n{outcome.END}\nafter\n", "utf-8")
    monkeypatch.setattr(outcome, "PAGE", page)
    outcome.write_table([Outcome("A", "one", "not run"), Outcome("B", "two", "here")])
    outcome.write_table([Outcome("A", "three", "here", ("it failed",))])
    assert page.read_text("utf-8").splitlines() == [
        "before",
        outcome.BEGIN,
        "| platform | built | run |",
        "| --- | --- | --- |",
        "| B | two | here |",
        "| A | three | here **wrong** |",
        outcome.END,
        "after",
    ]
