"""README.md and the pages of docs/ do what they say: their examples are run, with the clouds."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import draw_cells
import pytest

from liftmesh.cli import exit_codes
from liftmesh.cli.application import COMMANDS, Command

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text("utf-8")
ELSEWHERE = re.compile(r"^## PyVista\n.*?(?=^## )", re.MULTILINE | re.DOTALL)  # check_hosts.sh
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def blocks(language: str, page: str) -> str:
    """Return the blocks of a language of a page, one after the other."""
    found = re.findall(rf"^```{language}\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)
    return "\n".join(found)


def pages_with(language: str) -> dict[str, str]:
    """Return those blocks of all pages that have any."""
    paths = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    texts = {path: path.read_text("utf-8") for path in paths}
    whole = {path: ELSEWHERE.sub("", texts[path]) for path in paths}
    found = {p.relative_to(ROOT).as_posix(): blocks(language, whole[p]) for p in paths}
    return {name: text for name, text in found.items() if text}


PYTHON, CONSOLE = pages_with("pycon"), pages_with("console")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))  # in memory, where tests are
    return tmp_path


@pytest.mark.slow
@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("name", PYTHON)
def test_python_examples(name: str) -> None:
    examples = doctest.DocTestParser().get_doctest(PYTHON[name], {}, name, str(ROOT / name), 0)
    assert examples.examples
    told: list[str] = []
    result = doctest.DocTestRunner(optionflags=FLAGS).run(examples, out=told.append)
    assert result.failed == 0, "".join(told)


@pytest.mark.slow
@pytest.mark.parametrize("name", CONSOLE)
def test_console_examples(name: str, folder: Path) -> None:
    parts = re.split(r"^\$ (.*)\n", CONSOLE[name], flags=re.MULTILINE)
    assert len(parts) > 2
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for command, expected in zip(parts[1::2], parts[2::2], strict=True):
        done = subprocess.run(
            ["bash", "-c", command], cwd=folder, env={**os.environ, "PATH": path}, check=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        same = doctest.OutputChecker().check_output(f"{expected.rstrip()}\n", done.stdout, FLAGS)
        assert same, f"$ {command}\nexpected:\n{expected}\ngot:\n{done.stdout}"


def test_exit_codes_are_those_of_the_command_line() -> None:
    page = (ROOT / "docs/guide/errors.md").read_text("utf-8")
    rows = re.findall(r"^\| (\d+) \| (.+) \|$", page, flags=re.MULTILINE)
    assert {int(code): meaning.replace("`", "") for code, meaning in rows} == exit_codes.MEANINGS


def test_commands_on_pages_have_the_options_that_they_show() -> None:
    for page in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]:
        for name, rest in re.findall(r"liftmesh ([a-z-]+)([^`\n|]*)", page.read_text("utf-8")):
            if name in COMMANDS:
                known = {word for each in Command(name).params for word in each.opts} | {"--help"}
                assert {*re.findall(r"(?<![\w-])--[a-z-]+", rest)} <= known, (page, name, rest)


def test_two_commands_set_everything_up() -> None:
    commands = re.findall(r"^\| `(scripts/\w+\.sh)` \|", README, flags=re.MULTILINE)
    assert commands == ["scripts/demo.sh", "scripts/test.sh"]
    assert all(os.access(ROOT / command, os.X_OK) for command in commands)


def anchors(page: Path) -> set[str]:
    """Return the anchors of the headings of a page, as GitHub and MyST make them."""
    headings = re.findall(r"^#+ (.+)$", page.read_text("utf-8"), flags=re.MULTILINE)
    return {re.sub(r"[^\w -]", "", each).lower().replace(" ", "-") for each in headings}


def test_every_page_and_heading_that_is_linked_exists() -> None:
    """Also those of the pages at the root, on GitHub; the site's own check is of the site."""
    for page in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]:
        text = re.sub(r"```.*?```", "", page.read_text("utf-8"), flags=re.DOTALL)
        for target, anchor in re.findall(r"\]\((?!\w+:)([^)#\s]*)#?([^)\s]*)\)", text):
            there = page.parent / target if target else page
            assert there.exists(), (page, target)
            assert not anchor or anchor in anchors(there), (page, target, anchor)


def test_the_pictures_of_cells_are_there_and_drawn_by_the_script(folder: Path) -> None:
    page = (ROOT / "docs/guide/cells.md").read_text("utf-8")
    shown = re.findall(r"/data/cells/(\w+)\.png\)", page)
    assert sorted(shown) == sorted(draw_cells.PICTURES)
    assert all((ROOT / "data" / "cells" / f"{name}.png").stat().st_size < 300_000 for name in shown)
    draw_cells.PICTURES["disks"]().savefig(folder / "disks.png")
