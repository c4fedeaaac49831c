"""The site of documentation, without its pictures: `nox -s docs` builds these, too."""

from __future__ import annotations

import importlib
import re
import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import matplotlib.pyplot as plt
import pytest
from commands import ROOT
from public_names import NAMES

import liftmesh
from liftmesh.cli.application import COMMANDS, Command

API = ROOT / "docs" / "api"
SCRIPTS = sorted((ROOT / "docs" / "gallery").glob("*.py"))
QUICK = (  # of a fifth of a second at most; `nox -s docs` runs all
    "plot_alpha_shape", "plot_apollonius", "plot_constrained", "plot_convex_hull", "plot_lift",
    "plot_power", "plot_refine", "plot_sphere", "plot_tetrahedra",
)  # fmt: skip


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(ROOT / "scripts" / "docs")
    before = {*sys.modules}

    def loaded(name: str) -> ModuleType:
        return importlib.import_module(name)

    yield loaded
    for name in {*sys.modules} - before:
        if str(ROOT / "scripts" / "docs") in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def test_every_public_name_is_in_one_topic() -> None:
    listed = [
        name
        for page in API.glob("*.rst")
        for name in re.findall(r"^   ([\w.]+)$", page.read_text("utf-8"), flags=re.MULTILINE)
    ]
    topics = {page.stem for page in API.glob("*.rst")}
    names = [name for name in listed if name not in topics and not name.startswith("plugins.")]
    errors = {name for name in liftmesh.__all__ if name not in NAMES and name != "__version__"}
    assert sorted(names) == sorted({*NAMES} | errors)


def test_every_command_has_a_page_with_all_of_its_options(load: Any) -> None:
    pages = load("command_pages")
    for name in COMMANDS:
        command = Command(name)
        text = pages.page(command)
        options = [each.opts[-1] for each in command.params if each.param_type_name == "option"]
        assert [each for each in options if each not in text] == []
        assert text.startswith(f"# liftmesh {name}\n")
        assert "## Examples\n\n```sh\nliftmesh " in text


def test_links_become_those_of_another_place(load: Any) -> None:
    page = (
        "[a](b.md#c) ![d](e.png) [f](https://g.org) [h](#i) [`j` [k]](../l.md)\n"
        "```sh\n[m](n.md)\n```\n~~~\n[o](p.md)\n~~~\n[q](r.md)\n"
    )
    relinked = load("links").relinked
    expected = page.replace("b.md#c", "/x/b.md#c").replace("e.png", "/x/e.png")
    expected = expected.replace("../l.md", "/l.md").replace("r.md", "/x/r.md")
    assert relinked(page, "x", lambda path, _: f"/{path}") == expected
    assert relinked(page, "x", lambda _path, _: None) == (
        "a  [f](https://g.org) [h](#i) `j` [k]\n```sh\n[m](n.md)\n```\n~~~\n[o](p.md)\n~~~\nq\n"
    )


@pytest.mark.parametrize(
    ("urls", "kinds"),
    [
        ({}, set()),
        ({"Source": "https://r.org/l/"}, {"https://r.org/l/raw", "https://r.org/l/blob"}),
        ({"Source": "https://r.org/l", "Documentation": "https://d.org"},
         {"https://r.org/l/raw", "https://d.org/guide", "https://d.org/project"}),
    ],
)  # fmt: skip
def test_the_readme_of_an_index_has_no_relative_link(
    load: Any, monkeypatch: pytest.MonkeyPatch, urls: dict[str, str], kinds: set[str]
) -> None:
    readme = load("readme")
    for module in (readme, load("links")):
        monkeypatch.setattr(module, "address", lambda kind: urls.get(kind, "").rstrip("/") or None)
    targets = re.findall(r"\]\(([^)]+)\)", readme.readme())
    assert all(each.startswith(("https://", "#")) for each in targets)
    found = [re.match(r"\w+://[\w.]+(?:/l)?(?:/\w+)?", each) for each in targets]
    assert kinds <= {each[0] for each in found if each}
    assert bool(targets) == bool(urls)


def test_what_is_wrong_with_pages_is_told(load: Any, tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        '<h1 id="top"><a href="b.html#x">1</a><a href="b.html#y">2</a><a href="c.html">3</a>'
        '<a href="#top">4</a><a href="https://e.org">5</a><script src="https://f.org/g.js">'
        '<img src="h.png"><iframe srcdoc="<a href=\'i\'>"></iframe>'
    )
    (tmp_path / "b.html").write_text('<p id="x">')
    assert sorted(load("checking").broken(tmp_path)) == [
        "a.html: b.html#y leads nowhere",
        "a.html: c.html leads nowhere",
        "a.html: h.png is missing",
        "a.html: https://f.org/g.js is loaded from elsewhere",
    ]


def test_pages_of_the_root_and_pictures_are_staged_and_old_ones_go(
    load: Any, tmp_path: Path
) -> None:
    staging = load("staging")
    (tmp_path / "guide").mkdir()
    (tmp_path / "guide" / "old.md").write_text("gone")
    staging.stage(tmp_path)
    assert not (tmp_path / "guide" / "old.md").exists()
    assert (tmp_path / "project" / "architecture.md").is_file()
    assert (tmp_path / "data" / "cells" / "schools.png").is_file()
    first = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.md")}
    staging.stage(tmp_path)
    assert first == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.md")}


def test_the_version_to_cite_is_that_of_the_package() -> None:
    page = (ROOT / "docs" / "project" / "citing.md").read_text("utf-8")
    assert f"liftmesh, version {liftmesh.__version__}: " in page


def test_scripts_of_the_gallery_are_short() -> None:
    assert len(SCRIPTS) >= 25
    for path in SCRIPTS:
        assert re.match(r'"""\n.+\n=+\n\n.+', path.read_text("utf-8")), path
        assert 15 <= len(path.read_text("utf-8").splitlines()) <= 50, path


@pytest.mark.parametrize("name", QUICK)
@pytest.mark.filterwarnings("ignore:FigureCanvasAgg is non-interactive")
def test_some_scripts_of_the_gallery_draw(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT / "docs" / "gallery")
    runpy.run_path(f"{name}.py")
    assert len(plt.get_fignums()) == 1
    plt.close("all")


@pytest.mark.slow
def test_the_site_is_built_without_a_warning_or_a_broken_link(tmp_path: Path) -> None:
    words = [sys.executable, "scripts/docs", "--no-pictures", "--out", str(tmp_path)]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "html" / "index.html").is_file()
    assert len([*(tmp_path / "html" / "cli").glob("*.html")]) > len(COMMANDS)
