"""README.md and the pages beside it do what they say: their examples are run, with the clouds."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from liftmesh.cli import exit_codes

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text("utf-8")
EXAMPLES = {
    "README.md": 60,
    "READING.md": 20,
    "TILES.md": 15,
    "CONSTRAINTS.md": 15,
    "PAPER.md": 15,
    "PLUGINS.md": 25,
}  # at least so many
ELSEWHERE = r"^## PyVista\n.*?(?=^## )"  # a section that scripts/check_hosts.sh runs
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def blocks(language: str, page: str = README) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_page_with_examples_is_run() -> None:
    pages = {path.name for path in ROOT.glob("*.md") if blocks("pycon", path.read_text("utf-8"))}
    assert pages == {*EXAMPLES, "CELLS.md"}  # which has a test of its own


@pytest.mark.slow
@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("name", EXAMPLES)
def test_python_examples(name: str) -> None:
    page = re.sub(ELSEWHERE, "", (ROOT / name).read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    text = "\n".join(blocks("pycon", page))
    examples = doctest.DocTestParser().get_doctest(text, {}, name, str(ROOT / name), 0)
    assert len(examples.examples) > EXAMPLES[name]
    told: list[str] = []
    result = doctest.DocTestRunner(optionflags=FLAGS).run(examples, out=told.append)
    assert result.failed == 0, "".join(told)


def console_examples() -> list[tuple[str, str]]:
    """Return pairs of a command and the output that the README shows for it."""
    parts = re.split(r"^\$ (.*)\n", "".join(blocks("console")), flags=re.MULTILINE)
    return list(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.slow
def test_console_examples(folder: Path) -> None:
    examples = console_examples()
    assert len(examples) >= 3
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for command, expected in examples:
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=folder,
            env={**os.environ, "PATH": path},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=True,
        )
        same = doctest.OutputChecker().check_output(expected, done.stdout, FLAGS)
        assert same, f"$ {command}\nexpected:\n{expected}\ngot:\n{done.stdout}"


def test_exit_codes_are_those_of_the_command_line() -> None:
    rows = re.findall(r"^\| (\d+) \| (.+) \|$", README, flags=re.MULTILINE)
    assert {int(code): meaning.replace("`", "") for code, meaning in rows} == exit_codes.MEANINGS


def test_two_commands_set_everything_up() -> None:
    commands = re.findall(r"^\| `(scripts/\w+\.sh)` \|", README, flags=re.MULTILINE)
    assert commands == ["scripts/demo.sh", "scripts/test.sh"]
    assert all(os.access(ROOT / command, os.X_OK) for command in commands)


def test_every_file_that_is_linked_exists() -> None:
    links = re.findall(r"\]\((?!https?:)([^)#]+)[^)]*\)", README)
    assert {"data/jacksboro.png", "READING.md", "TILES.md"} <= {*links}
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_every_heading_that_is_linked_exists() -> None:
    for name in EXAMPLES:
        text = (ROOT / name).read_text("utf-8")
        for page, anchor in re.findall(r"\]\(([\w/]*\.md)?#([^)]+)\)", text):
            there = (ROOT / page).read_text("utf-8") if page else text
            headings = re.findall(r"^#+ (.+)$", there, flags=re.MULTILINE)
            anchors = {re.sub(r"[^\w -]", "", each).lower().replace(" ", "-") for each in headings}
            assert anchor in anchors, (name, page, anchor)
