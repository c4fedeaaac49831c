"""What a command imports: each library that it does not need would delay its start."""

from __future__ import annotations

import json
import os
import re
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
DEAR = {"rich", "scipy", "trimesh", "matplotlib", "numpy.ma", "importlib.metadata"}
CODECS = {
    "liftmesh.io.formats.stl",
    "liftmesh.io.formats.numpy_files",
    "liftmesh.io.formats.gltf.writer",
    "zipfile",
}


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


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".ply", ".obj"])
def test_a_command_imports_what_it_needs(cloud: Path, suffix: str) -> None:
    mesh = cloud.with_suffix(suffix)
    assert imported("triangulate", cloud, mesh) & (DEAR | CODECS) == set()
    assert imported("info", mesh) & (DEAR | CODECS) == set()
    assert imported("verify", mesh) & (DEAR | CODECS) == set()


def test_the_version_needs_neither_click_nor_numpy() -> None:
    assert imported("--version") & {"click", "numpy", "rich"} == set()


@pytest.mark.parametrize("command", [(), ("triangulate",), ("paper",)])
def test_help_is_written_without_rich(command: tuple[str, ...]) -> None:
    assert imported(*command, "--help") & (DEAR | CODECS | {"numpy"}) == set()


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_help_is_as_wide_as_the_terminal_and_complete(columns: int) -> None:
    words = [sys.executable, "-m", "liftmesh", "triangulate", "--help"]
    width = {"COLUMNS": str(columns)}
    done = subprocess.run(words, capture_output=True, text=True, env=os.environ | width, check=True)
    options, _, examples = done.stdout.partition("Examples:")
    widest = max(len(line) for line in options.splitlines())
    assert columns - 12 < widest < columns
    said = " ".join(options.split())
    policies = "first|last|lowest|highest|mean|error"
    assert re.search(rf"--on-duplicate \W{re.escape(policies)}\W Which of several rows", said)
    assert "[default: first]" in said
    assert "\n    $ liftmesh triangulate cloud.ply mesh.ply\n    $ liftmesh tri" in examples


def test_values_are_converted_and_refused_as_before(cloud: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "liftmesh", "triangulate", cloud, tmp_path / "mesh.ply"]
    for option, told in (
        (("--algorithm", "fast"), "--algorithm 'fast' is unknown: give auto, "),
        (("--skip-rows", "x"), "--skip-rows is 'x': give a whole number from 0"),
    ):
        done = subprocess.run([*words, *option], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert told in done.stderr
    assert subprocess.run([*words, "--skip-rows", "1"], check=False).returncode == 0
