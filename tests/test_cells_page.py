"""CELLS.md does what it says: its examples are run."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
from pathlib import Path

import draw_cells
import pytest

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / "CELLS.md").read_text("utf-8")
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def blocks(language: str) -> str:
    found = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL)
    return "\n".join(found)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_python_examples() -> None:
    examples = doctest.DocTestParser().get_doctest(blocks("pycon"), {}, "CELLS.md", "CELLS.md", 0)
    assert len(examples.examples) > 20
    told: list[str] = []
    result = doctest.DocTestRunner(optionflags=FLAGS).run(examples, out=told.append)
    assert result.failed == 0, "".join(told)


@pytest.mark.slow
def test_console_examples(folder: Path) -> None:
    parts = re.split(r"^\$ (.*)\n", blocks("console"), flags=re.MULTILINE)
    assert len(parts) >= 5
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for command, expected in zip(parts[1::2], parts[2::2], strict=True):
        done = subprocess.run(
            ["bash", "-c", command], cwd=folder, env={**os.environ, "PATH": path},
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        assert doctest.OutputChecker().check_output(expected.rstrip() + "\n", done.stdout, FLAGS), (
            done.stdout
        )


def test_pictures_are_there_and_drawn_by_the_script() -> None:
    shown = re.findall(r"\]\(data/cells/(\w+)\.png\)", PAGE)
    assert sorted(shown) == sorted(draw_cells.PICTURES)
    assert all((ROOT / "data" / "cells" / f"{name}.png").stat().st_size < 300_000 for name in shown)
    draw_cells.PICTURES["disks"]().savefig("disks.png")
