"""What a command imports: each library that it does not need would delay its start."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import json, sys
from liftmesh.cli import main
code = main(sys.argv[1:])
print("imported", json.dumps([code, *sys.modules]))
"""
DEAR = {"pydantic", "rich", "scipy", "trimesh", "matplotlib", "numpy.ma", "importlib.metadata"}
CODECS = {"liftmesh.io.stl", "liftmesh.io.numpy_files", "liftmesh.io.gltf.formats", "zipfile"}


def imported(*words: str | Path) -> set[str]:
    """Run a command with its output in a pipe; return the modules that are loaded afterwards."""
    program = [sys.executable, "-c", PROGRAM, *map(str, words)]
    done = subprocess.run(program, capture_output=True, text=True, check=True)
    code, *modules = json.loads(done.stdout.rpartition("imported ")[2])
    assert code == 0, done.stderr
    return set(modules)


@pytest.fixture
def cloud(tmp_path: Path) -> Path:
    path = tmp_path / "cloud.xyz"
    path.write_text("0 0 1\n1 0 2\n0 1 3\n1 1 5\n")
    return path


@pytest.mark.parametrize("suffix", [".ply", ".obj"])
def test_a_command_imports_what_it_needs(cloud: Path, suffix: str) -> None:
    mesh = cloud.with_suffix(suffix)
    assert imported("triangulate", cloud, mesh) & (DEAR | CODECS) == set()
    assert imported("info", mesh) & (DEAR | CODECS) == set()
    assert imported("verify", mesh) & (DEAR | CODECS) == set()


def test_the_version_needs_neither_typer_nor_numpy() -> None:
    assert imported("--version") & {"typer", "click", "numpy", "pydantic", "rich"} == set()


@pytest.mark.parametrize("command", [(), ("triangulate",), ("paper",)])
def test_help_is_written_without_rich(command: tuple[str, ...]) -> None:
    assert imported(*command, "--help") & (DEAR | CODECS | {"numpy"}) == set()


@pytest.mark.parametrize("columns", [40, 80, 120])
def test_help_is_as_wide_as_the_terminal_and_complete(columns: int) -> None:
    words = [sys.executable, "-m", "liftmesh", "triangulate", "--help"]
    width = {"COLUMNS": str(columns), "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        words, capture_output=True, encoding="utf-8", env=os.environ | width, check=True
    )
    boxes = [line for line in done.stdout.splitlines() if line[:1] in "╭│╰" and line]
    assert {len(line) for line in boxes} == {max(columns, 52)}
    text = " ".join(line.strip("│╭╰╮╯─ ") for line in done.stdout.splitlines())
    for said in ("--duplicates <first|last|lowest|highest|mean|error>", "[default: first]"):
        assert said in text or columns == 40
    assert "Which of several rows at one planar position is used" in " ".join(text.split())


def test_help_has_colours_on_terminals_and_frames_that_the_encoding_has() -> None:
    words = [sys.executable, "-m", "liftmesh", "--help"]
    plain = subprocess.run(
        words, capture_output=True, env=os.environ | {"PYTHONIOENCODING": "ascii"}, check=True
    )
    assert plain.stdout.isascii()
    assert b"\x1b" not in plain.stdout
    forced = os.environ | {"FORCE_COLOR": "1", "NO_COLOR": ""}
    colored = subprocess.run(words, capture_output=True, env=forced, check=True)
    assert b"\x1b[36m" in colored.stdout
    without = subprocess.run(words, capture_output=True, env=forced | {"NO_COLOR": "1"}, check=True)
    assert b"\x1b" not in without.stdout


def test_values_are_converted_and_refused_as_before(cloud: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "liftmesh", "triangulate", cloud, tmp_path / "mesh.ply"]
    for option, told in (
        (("--method", "fast"), "--method 'fast' is unknown: give auto, "),
        (("--skip-rows", "x"), "--skip-rows is 'x': give a whole number from 0"),
    ):
        done = subprocess.run([*words, *option], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert told in done.stderr
    assert subprocess.run([*words, "--skip-rows", "1"], check=False).returncode == 0
