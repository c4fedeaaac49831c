"""Some seconds of fuzzing for every target, and the parallel paths under ThreadSanitizer.

A longer campaign is `python scripts/fuzz TARGET --seconds N`. That finds are noticed, shrunk and
told is tested with a target that fails.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from fuzz.campaign import fuzz, reason
from fuzz.distill import distill
from fuzz.round_trip import outcome
from fuzz.shrink import shrink, shrunk
from fuzz.targets import PARTS, TARGETS, Target

from liftmesh import Cloud

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
SUMMARY = re.compile(r"([\d,]+) executions .* ([\d,]+) branches, .* (\d+) finds")

# Branches that the seeds alone reach: fewer mean that nothing is counted, or seeds are gone.
BRANCHES = {"kernel": 1800, "ply": 300, "obj": 300, "xyz": 250, "numbers": 50}
BRANCHES |= {
    "changing": 600,
    "constraints": 700,
    "refinement": 900,
    "surface": 900,
    "overlay": 1200,
    "simplification": 900,
    "space": 400,
}


def script(*words: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *map(str, words)]
    return subprocess.run(command, cwd=SCRIPTS, capture_output=True, text=True, check=False)


@pytest.mark.campaign
@pytest.mark.parametrize("name", TARGETS)
def test_some_seconds_find_nothing(name: str, tmp_path: Path) -> None:
    seconds = 2 if name in PARTS else 5
    done = script("fuzz", name, "--seconds", seconds, "--seed", 20, "--folder", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    told = SUMMARY.search(done.stdout)
    assert told is not None
    executions, branches, finds = (int(number.replace(",", "")) for number in told.groups())
    assert executions > len([*TARGETS[name].seeds.iterdir()])
    assert branches > BRANCHES[name]
    assert finds == 0


@pytest.mark.campaign
def test_parallel_paths_without_a_data_race() -> None:
    done = script("sanitize", "thread", "--rows", 36_000)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(re.findall(r"36000 rows", done.stdout)) == 7  # six sets of points, and text


REFUSES_AB = """
import sys
import atheris

@atheris.instrument_func
def check(data):
    if data[:1] == b"a" and data[1:2] == b"b":
        raise ValueError(f"ab stands before {len(data)} bytes")

atheris.Setup(sys.argv, check)
atheris.Fuzz()
"""


@dataclass(frozen=True)
class Small(Target):
    """A Python program, and seeds of its own."""

    program: str

    def command(self) -> list[str]:
        return [sys.executable, "-c", self.program]


@pytest.fixture
def seeds(tmp_path: Path) -> Path:
    folder = tmp_path / "seeds"
    folder.mkdir()
    (folder / "one").write_bytes(b"axyz")
    return folder


@pytest.mark.slow
def test_finds_are_noticed_and_shrunk(seeds: Path, tmp_path: Path) -> None:
    target = Small("small", ".txt", ("-max_len=20",), seeds, REFUSES_AB)
    found = fuzz(target, tmp_path, seconds=20, jobs=2, seed=1)
    assert found.executions > 2
    assert found.branches > 1
    assert len(found.finds) == 2
    assert found.failed == ()
    for find in found.finds:
        small, why = shrink(target, find)
        assert why.startswith("ValueError: ab stands before")
        assert small.read_bytes() == b"ab"
        assert reason(target, small) == "ValueError: ab stands before 2 bytes"
    assert reason(target, seeds / "one") is None


def test_a_target_that_does_not_start_is_no_success(seeds: Path, tmp_path: Path) -> None:
    target = Small("small", ".txt", (), seeds, "raise SystemExit('not today')")
    found = fuzz(target, tmp_path, seconds=1, jobs=1, seed=1)
    assert found.finds == ()
    assert found.failed == ("not today\n",)


def test_a_corpus_is_distilled(seeds: Path, tmp_path: Path) -> None:
    passes = REFUSES_AB.replace("raise ValueError", "str")
    words = shlex.join([sys.executable, "-c", passes])
    again = f"import sys; sys.argv[0] = {words!r}\n{passes}"  # as libFuzzer starts it
    target = Small("small", ".txt", (), seeds, again)
    corpus = tmp_path / "corpus"
    corpus.mkdir()
    for name, data in {"no": b"x", "long": b"abcdefgh", "short": b"ab", "again": b"ab"}.items():
        (corpus / name).write_bytes(data)
    kept = distill(target, tmp_path)
    assert sorted(path.read_bytes() for path in kept) == [b"ab", b"axyz", b"x"]
    assert sorted(seeds.iterdir()) == kept


def test_shrinking_keeps_what_is_needed() -> None:
    data = bytes(range(200))
    assert shrunk(data, lambda piece: b"\x07" in piece and b"\xa0" in piece, 1e18) == b"\x07\xa0"
    assert shrunk(data, lambda piece: False, 1e18) == data


def test_what_a_reader_gives_is_held_against_its_files() -> None:
    cloud = outcome(
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
        b"property float y\nend_header\n1 2\n",
        "ply",
    )
    assert isinstance(cloud, Cloud)
    assert outcome(b"v 1 2", "obj").startswith("<stream>: line 1")
