"""The options of all commands together."""

from __future__ import annotations

import ast
import inspect
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import click
import pytest

import liftmesh
from liftmesh.cli.application import COMMANDS, Command
from liftmesh.cli.wording import spelled
from liftmesh.errors import Option


@cache
def options_of(name: str) -> list[str]:
    return [each for option in Command(name).params for each in option.opts]


@pytest.mark.parametrize("name", COMMANDS)
def test_a_name_is_that_of_one_option(name: str) -> None:
    names = Counter(options_of(name))
    assert {each: count for each, count in names.items() if count > 1} == {}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_commands_has_one_spelling_and_the_default_of_its_classes(name: str) -> None:
    command = Command(name)
    texts = {
        each.name: each.help or "" for each in command.params if isinstance(each, click.Option)
    }
    assert not re.search(r"centre|\bThin: ", " ".join([command.help or "", *texts.values()]))
    if "classes" in texts:
        default = (
            "By default all."
            if name
            in {"info", "thin", "constrain", "height", "tetrahedralize", "hull", "alpha-shape"}
            else "as by default of LAS and LAZ."
        )
        assert texts["classes"].endswith(default)


IN_THE_LIBRARY_ALONE = {
    "constrained_delaunay",
    "a", "ax", "b", "bins", "canonical", "carved", "clouds", "coincident", "colors", "constraints",
    "coplanar", "copy", "data", "degrees", "density", "dimension", "dtype", "edge_source", "engine",
    "folder", "force_vertices", "furthest_site", "gradients", "heights", "i", "incremental",
    "inplace", "kind", "light", "markers", "masses", "max_iter", "max_proofs", "method", "names",
    "offsets", "order", "planar", "progress", "progress_bar", "quality", "row", "rows", "shape",
    "steiner", "strict", "tol", "tolerance", "transform", "triangle_args", "triangulation",
    "vertices",
}  # fmt: skip
NAMING = {
    "Option", "refused", "as_count", "as_number", "as_numbers", "as_positive", "as_distance",
    "as_switch", "as_folder", "check_option",
}  # fmt: skip
NOT_READ = {  # meshes have no table, and rows of cells are not selected
    "verify": {"classes", "returns", "bounds", "z_range", "every", "withheld", "copc_resolution",
               "src_crs", "dst_crs", "columns", "skip_rows"},
    "voronoi": {"classes", "returns", "bounds", "z_range", "every", "withheld", "copc_resolution",
                "src_crs", "dst_crs"},
}  # fmt: skip


def test_options_that_messages_name_are_those_of_a_command() -> None:
    known = {each for name in COMMANDS for each in options_of(name)}
    alone = {name for name in names_in_messages() if spelled(Option(name)) not in known}
    assert alone == IN_THE_LIBRARY_ALONE


def trees() -> Iterator[tuple[Path, ast.Module]]:
    """The sources of the library."""
    folder = Path(liftmesh.__file__).parent
    for path in folder.rglob("*.py"):
        if path.relative_to(folder).parts[0] not in {"cli", "paper"}:
            yield path, ast.parse(path.read_text(encoding="utf-8"))


def names_in_messages() -> Iterator[str]:
    """The options that errors of the library name."""
    for _, tree in trees():
        for call in ast.walk(tree):
            if (
                isinstance(call, ast.Call)
                and getattr(call.func, "id", "") in NAMING
                and isinstance(call.args[0], ast.Constant)
                and call.args[0].value != "classify_ground"
            ):
                yield call.args[0].value


def test_messages_name_options_by_their_fields() -> None:
    names = {each[2:].replace("-", "_") for name in COMMANDS for each in options_of(name)}
    assigned = re.compile(rf"(?<![\w.(])({'|'.join(sorted(filter(None, names)))})=(?!=)")
    for path, tree in trees():
        documents = {id(each.value) for each in ast.walk(tree) if isinstance(each, ast.Expr)}
        for each in ast.walk(tree):
            if isinstance(each, ast.Constant) and id(each) not in documents:
                text = str(each.value)
                of_python = re.search(r"[<>]|delaunay\(|(overwrite|origin)=", text)
                found = assigned.search(text) and not of_python
                assert not found, f"{path}:{each.lineno}: {text!r}: give an Option"


@pytest.mark.parametrize("name", sorted({*COMMANDS} - {"paper", "tile", "doctor"}))
def test_commands_have_the_options_that_errors_of_reading_name(name: str) -> None:
    reading = {*inspect.signature(liftmesh.read).parameters} - {"source", "options", "color_depth"}
    reading |= {"columns", "skip_rows"}
    lacking = {each for each in reading if spelled(Option(each)) not in options_of(name)}
    assert lacking == NOT_READ.get(name, set())
