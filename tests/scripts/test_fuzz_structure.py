"""Files made of their parts, with lies about some: some thousands here, as always the same.

A longer campaign is `python scripts/fuzz structure --seconds N`.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh  # noqa: F401 - or its import is measured with the first file that needs it
from fuzz.structure.campaign import hunt
from fuzz.structure.case import Case, in_order
from fuzz.structure.checks import check
from fuzz.structure.generators import GENERATORS, generated
from fuzz.structure.parts import Chance, Liar, Part, encoded
from lies import npy

from liftmesh.io.registry import FORMATS, find_format
from liftmesh.io.tetrahedra import FORMATS as CELLS

TESTS = Path(__file__).resolve().parents[1]
SCRIPTS = TESTS.parent / "scripts"
CASES = 60
FEW = ("e57",)
"""Generators of files whose readers start a process."""


@pytest.mark.campaign
def test_thousands_of_lies_find_nothing(tmp_path: Path) -> None:
    names = [each for each in GENERATORS if each not in FEW]
    found = hunt(tmp_path, seconds=600, seed=0, jobs=2, cases=CASES, names=names)
    assert found.faults == []
    assert found.cases == dict.fromkeys(names, 2 * CASES)
    found = hunt(tmp_path, seconds=600, seed=0, cases=10, names=FEW)
    assert found.faults == []
    assert found.cases == dict.fromkeys(FEW, 10)


FILES = [
    path
    for path in sorted((TESTS / "regressions").iterdir()) + sorted((TESTS / "corpus").rglob("*"))
    if path.is_file() and path.suffix not in {".md", ".bin"} and path.parent.name != "kernel"
]


@pytest.mark.campaign
def test_no_known_file_does_harm(tmp_path: Path) -> None:
    assert len(FILES) > 150
    with (tmp_path / "printed").open("ab+") as stream:
        for path in FILES:
            case = Case(path.suffix[1:] or path.parent.name, path.read_bytes())
            assert check(case, stream.fileno()).fault == "", path


def test_every_format_has_a_generator() -> None:
    kinds = {generated(name, number).kind for name in GENERATORS for number in range(20)}
    made = {find_format(kind, "a file").name for kind in kinds - {*CELLS}}
    assert kinds > {*CELLS}
    assert made == {each.name for each in FORMATS if each.read is not None}


@pytest.mark.slow
@pytest.mark.parametrize("name", GENERATORS)
def test_a_number_makes_one_file_and_many_of_them_are_true(name: str) -> None:
    cases = [generated(name, number) for number in range(60)]
    assert [generated(name, number).data for number in range(60)] == [each.data for each in cases]
    assert len({each.data for each in cases}) >= len(cases) - 3  # some are cut off at once
    assert 3 < sum(each.points is not None for each in cases) < 40


def test_parts_keep_their_form() -> None:
    parts = [
        Part(3, "<H"),
        Part(-1, ">i"),
        Part(1e300, "<f"),
        Part(7),
        Part(b"a"),
        Part(2**70, "B"),
    ]
    text = b"\x03\x00" + b"\xff" * 4 + b"\x00\x00\x80\x7f" + b"7" + b"a" + b"\x00"
    assert encoded(parts) == text
    assert encoded(Liar(parts[:], [b"b"], Chance(1)).lie(0)) == text


TRIANGLE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
CORNERS = in_order(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]))


def test_what_is_wrong_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with (tmp_path / "printed").open("ab+") as stream:
        printed = stream.fileno()
        assert check(Case("obj", TRIANGLE, CORNERS), printed).fault == ""
        assert "other points" in check(Case("obj", TRIANGLE, CORNERS + 1.0), printed).fault
        assert "whole file is refused" in check(Case("obj", b"v 1", CORNERS), printed).fault
        stream.write(b"Traceback")
        stream.flush()
        assert check(Case("obj", TRIANGLE), printed).fault == "printed: Traceback"
        assert check(Case("obj", TRIANGLE), printed).fault == ""
        monkeypatch.setattr("fuzz.structure.checks.MEMORY", -(1 << 40))
        assert check(Case("obj", TRIANGLE), printed).fault.startswith("memory")
        monkeypatch.setattr("fuzz.structure.checks.SECONDS", -1.0)
        assert check(Case("obj", TRIANGLE), printed).fault.startswith("time")


def test_an_exception_that_escapes_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*args: object) -> None:
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr("liftmesh.io.formats.numpy_arrays.Layout.read", broken)
    with (tmp_path / "printed").open("ab+") as stream:
        found = check(Case("npy", npy("<f8", (4, 3))), stream.fileno())
    assert re.fullmatch(r"ZeroDivisionError.*: of all things", found.fault)


def run(*words: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "fuzz", "structure", *map(str, words)]
    return subprocess.run(command, cwd=SCRIPTS, capture_output=True, text=True, check=False)


@pytest.mark.campaign
def test_the_command_sums_up_and_reads_files_again(tmp_path: Path) -> None:
    done = run("--cases", 3, "--formats", "npy", "off", "--seed", 5, "--folder", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.fullmatch(
        r"structure: 6 cases, 0 faults, slowest .* s \(.*\), fattest .* MB \(.*\), seed 5\n",
        done.stdout,
    )
    (tmp_path / "cloud.obj").write_bytes(TRIANGLE)
    done = run("--run", tmp_path / "cloud.obj")
    assert (done.returncode, done.stdout) == (0, f"{tmp_path}/cloud.obj: passes\n")
