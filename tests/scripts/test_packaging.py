"""What packagers take: the manual page, completions, the recipe of conda-forge, classifiers, forms.

The list of requirements stands in pyproject.toml; what repeats a part of it is compared with it.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import yaml
from commands import ROOT

from liftmesh.cli.application import COMMANDS, Command

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CONFIG = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
PROJECT = CONFIG["project"]
EXTRAS = PROJECT["optional-dependencies"]
BY_CONDA = {"matplotlib-base": "matplotlib"}  # names that differ


def needs(requirements: list[str]) -> set[str]:
    """Return requirements without blanks, conda's names as Python's; not Python, nor Windows'."""
    plain = {each.replace(" ", "") for each in requirements if "win32" not in each}
    for name, of_python in BY_CONDA.items():
        plain = {each.replace(name, of_python) for each in plain}
    return plain - {"python", "pip"}


def test_the_recipe_has_the_requirements_of_the_project() -> None:
    recipe: Any = yaml.safe_load((ROOT / "recipe" / "recipe.yaml").read_text("utf-8"))
    assert recipe["context"]["version"] == PROJECT["version"]
    assert recipe["about"]["summary"] == PROJECT["description"]
    assert recipe["about"]["license"] == PROJECT["license"]
    parts = recipe["requirements"]
    base, cli = needs(PROJECT["dependencies"]), needs(EXTRAS["cli"])
    assert needs(parts["run"]) == base | cli
    assert needs(parts["host"]) - base - cli == needs(CONFIG["build-system"]["requires"])
    optional = {each for extra in EXTRAS.values() for each in needs(extra)}
    assert needs(parts["run_constraints"]) <= optional
    assert recipe["about"]["license_file"] == PROJECT["license-files"]
    assert all((ROOT / name).is_file() for name in PROJECT["license-files"])
    assert recipe["build"]["skip"] == ["win"]
    script = str(recipe["build"]["script"])
    assert all((ROOT / name).is_file() for name in re.findall(r"scripts/\S+\.py", script))


def test_the_manual_page_has_every_command_and_option(tmp_path: Path) -> None:
    page = tmp_path / "man1" / "liftmesh.1"
    subprocess.run([sys.executable, ROOT / "scripts" / "man_page.py", page], check=True)
    text = page.read_text("utf-8")
    macros = {line.split()[0] for line in text.splitlines() if line.startswith((".", "'"))}
    assert macros == {".TH", ".SH", ".SS", ".PP", ".TP", ".nf", ".fi"}
    assert not re.search(r"\\(?![-e&]|f[BR])", text)
    sections = re.split(r'^\.SH "LIFTMESH (.+)"$', text.replace("\\-", "-"), flags=re.MULTILINE)
    assert [each.lower() for each in sections[1::2]] == [*COMMANDS]
    for name, section in zip(COMMANDS, sections[2::2], strict=True):
        options = {word for each in Command(name).params for word in each.opts if word[:2] == "--"}
        assert {word for word in options if f"\\fB{word}" not in section} <= {"--output"}, name
        assert f"\n  $ liftmesh {name} " in section


def test_classifiers_name_the_versions_that_wheels_are_made_for() -> None:
    named = [each.rpartition(" :: ")[2] for each in PROJECT["classifiers"] if "3." in each]
    assert named == ["3.10", "3.11", "3.12", "3.13", "3.14"]
    assert PROJECT["requires-python"] == f">={named[0]}"
    fast: Any = yaml.safe_load((ROOT / ".github/workflows/fast.yml").read_text("utf-8"))
    assert {*fast["jobs"]["fast"]["strategy"]["matrix"]["python"]} <= {*named}


def test_forms_for_issues_are_whole() -> None:
    forms = [*(ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")]
    assert len(forms) == 3
    for path in forms:
        form: Any = yaml.safe_load(path.read_text("utf-8"))
        if path.name == "config.yml":
            continue
        assert form["name"]
        assert form["description"]
        ids = [each["id"] for each in form["body"]]
        assert len({*ids}) == len(ids)
        assert all(each["attributes"]["label"] for each in form["body"])
        assert any(
            each["validations"]["required"] for each in form["body"] if "validations" in each
        )
    assert "python -m liftmesh doctor" in (forms[0].parent / "bug.yml").read_text("utf-8")


def test_an_address_stands_in_the_project_alone() -> None:
    """While there is none, no page may lead to one that somebody has made up."""
    if "urls" not in PROJECT:
        for name in ("README.md", "recipe/recipe.yaml", "CONTRIBUTING.md"):
            text = (ROOT / name).read_text("utf-8")
            assert not re.search(r"https?://\S*liftmesh", text), name
