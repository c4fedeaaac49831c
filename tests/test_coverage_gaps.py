"""The report on coverage: real counts of a toy, gaps and their reasons, and when it fails."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import coverage_gaps
import pytest
from coverage_gaps import Gap, Reason, Share, Source, gaps_of, read_kernel, read_python

PYTHON = """\
def sign(x):
    if x > 0:
        return 1
    if x < 0:
        text = "negative"
        return -len(text) // 8
    return 0

def report(x):
    if sign(x):
        print(x)

sign(1), sign(0), report(2)
"""
KERNEL = """\
template <int N>
int scaled(int x) {
    if (N == 2)
        return N * x;
    return x - N;
}

int main(int count, char**) {
    if (count > 1) {
        count += 3;
        return scaled<1>(count);
    }
    return scaled<2>(count) - scaled<3>(1) - 4;
}
"""


@pytest.fixture(scope="module")
def counted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A toy of both languages that ran under coverage and gcov; their reports beside it."""
    folder = tmp_path_factory.mktemp("toy")
    (folder / "toy.py").write_text(PYTHON)
    (folder / "toy.cpp").write_text(KERNEL)
    (folder / "rc").write_text("[run]\nbranch = true\ninclude = toy.py\n")
    for command in (
        [sys.executable, "-m", "coverage", "run", "--rcfile=rc", "toy.py"],
        [sys.executable, "-m", "coverage", "json", "--rcfile=rc", "-q", "-o", "python.json"],
        ["g++", "-O1", "-fno-early-inlining", "--coverage", "toy.cpp", "-o", "toy"],
        ["./toy"],
        [sys.executable, "-m", "gcovr", "--json", "kernel.json"],
    ):
        env = {n: v for n, v in os.environ.items() if not n.startswith(("COVERAGE", "GCOV"))}
        subprocess.run(command, cwd=folder, env=env, check=True, capture_output=True)
    return folder


def report(folder: Path, name: str) -> object:
    return json.loads((folder / f"{name}.json").read_text("utf-8"))


def test_what_coverage_counts(counted: Path) -> None:
    (source,) = read_python(report(counted, "python"))
    assert source.file == "toy.py"
    assert source.missed == [5, 6]
    assert source.not_taken == ((4, 5), (10, -9))
    gaps = list(gaps_of(source, PYTHON.splitlines()))
    assert [(gap.where, gap.text) for gap in gaps] == [
        ("5-6", 'text = "negative"'),
        ("10 never to the end", "if sign(x):"),
    ]
    lines, branches = coverage_gaps.shares("it", [source])
    assert (lines.of - lines.reached, branches.of, branches.reached) == (2, 6, 4)


def test_what_gcovr_counts(counted: Path) -> None:
    (source,) = read_kernel(report(counted, "kernel"))
    assert source.file == "toy.cpp"
    assert source.missed == [10, 11]
    assert {4, 5} <= source.runs.keys()  # each is reached in one instance of the template only
    (gap,) = gaps_of(source, KERNEL.splitlines())
    assert (gap.where, gap.text) == ("10-11", "count += 3;")


@pytest.mark.parametrize(
    ("runs", "where"),
    [
        ({1: 1, 2: 1}, []),
        ({1: 0}, ["1"]),
        ({1: 0, 3: 0, 5: 1}, ["1-3"]),
        ({1: 1, 2: 0, 3: 1, 4: 0, 5: 0}, ["2", "4-5"]),
    ],
)
def test_lines_in_a_row_are_one_gap(runs: dict[int, int], where: list[str]) -> None:
    text = [f"line {row}" for row in range(1, 6)]
    gaps = list(gaps_of(Source("a.py", runs), text))
    assert [gap.where for gap in gaps] == where
    assert all(gap.text == f"line {gap.first}" for gap in gaps)


def test_a_reason_holds_for_its_file_and_text_alone_and_once() -> None:
    reason = Reason("a.py", "except OSError", "disks do not fail here")
    gap, reasons = Gap("a.py", 7, 9, "except OSError as error:"), [reason]
    assert coverage_gaps.reason_for(gap, reasons) == "disks do not fail here"
    assert coverage_gaps.reason_for(gap, reasons) is None
    assert coverage_gaps.reason_for(Gap("b.py", 7, 9, gap.text), [reason]) is None
    assert coverage_gaps.reason_for(Gap("a.py", 7, 9, "except ValueError:"), [reason]) is None


def test_ninety_five_per_cent_is_the_least() -> None:
    assert Share("of it", 19, 20).enough
    assert not Share("of it", 1899, 2000).enough
    assert Share("of nothing", 0, 0).enough
    assert str(Share("of it", 1899, 2000)) == " 94.95 % of it (1,899 of 2,000)"


def test_every_reason_names_text_of_its_file() -> None:
    for reason in coverage_gaps.read_reasons():
        lines = (coverage_gaps.ROOT / reason.file).read_text("utf-8").splitlines()
        assert reason.why
        assert any(reason.line in line for line in lines), f"{reason.file}: {reason.line}"


REASON = '[[gap]]\nfile = "{}"\nlines = ["{}"]\nwhy = "it is a toy"\n'


def test_the_whole_report(counted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    reasons = counted / "reasons.toml"
    reasons.write_text(REASON.format("toy.py", "if sign") + REASON.format("toy.cpp", "count +="))
    words = [str(counted / "python.json"), str(counted / "kernel.json")]
    assert coverage_gaps.main(words, counted, reasons) == 1
    told = capsys.readouterr().out
    assert '    5-6: text = "negative"\n        NO REASON IS GIVEN\n' in told
    assert "    10-11: count += 3;\n        it is a toy\n" in told
    assert " 66.67 % of the branches of Python (4 of 6)\n" in told
    assert "gaps without a reason: 1\n" in told


@pytest.mark.parametrize(
    ("missed", "explained", "code"), [(0, True, 0), (1, True, 0), (6, True, 1), (1, False, 1)]
)
def test_the_exit_code(tmp_path: Path, missed: int, explained: bool, code: int) -> None:
    (tmp_path / "a.py").write_text("x = 1\n" * 100)
    rows = [*range(1, 101)]
    lines = {"executed_lines": rows[missed:], "missing_lines": rows[:missed]}
    found = {**lines, "executed_branches": [], "missing_branches": []}
    (tmp_path / "python.json").write_text(json.dumps({"files": {"a.py": found}}))
    (tmp_path / "kernel.json").write_text('{"files": []}')
    reasons = tmp_path / "reasons.toml"
    reasons.write_text(REASON.format("a.py", "x =" if explained else "y ="))
    words = [str(tmp_path / "python.json"), str(tmp_path / "kernel.json")]
    assert coverage_gaps.main(words, tmp_path, reasons) == code


def test_sources_that_nobody_measured_are_named(tmp_path: Path) -> None:
    (tmp_path / "liftmesh" / "_core").mkdir(parents=True)
    for name in ("liftmesh/a.py", "liftmesh/b.py", "liftmesh/_core/c.cpp", "liftmesh/_core/d.hpp"):
        (tmp_path / name).write_text("")
    known = [Source("liftmesh/a.py", {})]
    assert coverage_gaps.not_measured(known, tmp_path) == ["liftmesh/_core/c.cpp", "liftmesh/b.py"]
