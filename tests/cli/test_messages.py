"""What is said of files, rows and errors, in words that no test of a command has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from liftmesh import Cloud
from liftmesh.cli import exit_codes, inputs, notes, outputs, surfaces, terminal, wording
from liftmesh.cli.info import _decimals
from liftmesh.errors import InputError, Option
from liftmesh.io.write import WriteResult


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ImportError("a.so: failed to map segment from shared object"), "not enough memory"),
        (RuntimeError("std::bad_alloc"), "not enough memory"),
        (SystemError("error return without exception set"), "not enough memory"),
        (OSError(28, "No space left", "a.ply"), "a.ply: No space left"),
        (InputError(f"give {Option('unit', ...)}"), "give --unit"),
    ],
)
def test_errors_of_input(error: Exception, said: str) -> None:
    assert exit_codes.explain(error) == (exit_codes.BAD_INPUT, said)


def test_what_caused_an_error_decides() -> None:
    error = RuntimeError("a module")
    error.__cause__ = KeyboardInterrupt()
    assert exit_codes.explain(error) == (exit_codes.INTERRUPTED, "interrupted")
    assert exit_codes.explain(ValueError("x"))[0] == exit_codes.BUG


@pytest.mark.parametrize(
    ("option", "said"),
    [
        (Option("skip_rows"), "--skip-rows"),
        (Option("src_crs", ...), "--src-crs"),
        (Option("header"), "--no-header"),
        (Option("resume", False), "--restart"),
        (Option("classes", "all"), "--all-classes"),
        (Option("columns", "x y"), "--columns 'x y'"),
        (Option("flat", True), "--flat"),
    ],
)
def test_options_of_the_library_are_told_as_those_of_commands(option: Option, said: str) -> None:
    assert wording.spelled(option) == said
    assert wording.worded(f"a: {option} is") == f"a: {said} is"


def test_rows_of_several_files_are_counted_in_their_own() -> None:
    points = np.eye(3)
    cloud = Cloud(points)
    with pytest.raises(InputError, match=r"^a\.csv: row 3 is"), inputs.about(Path("a.csv")):
        raise InputError("row 3 is [nan, 0, 0]")
    with pytest.raises(InputError, match=r"^band is"), inputs.about(Path("a.csv")):
        raise InputError(f"{Option('band')} is 3")
    with pytest.raises(InputError, match=r"^stdin: row 1"), inputs.about_rows([Path("-")], cloud):
        raise InputError("row 1 is no row")


@pytest.mark.parametrize(
    ("name", "is_shapes", "is_table"),
    [
        ("points.csv", False, True),
        ("points.ply", False, False),
        ("points.geojson", True, None),
        ("points.gpkg", True, None),
        ("points", True, False),
    ],
)
def test_files_of_places(name: str, is_shapes: bool, is_table: bool | None) -> None:
    assert surfaces.is_shapes(Path(name)) == is_shapes
    if is_table is not None:
        assert surfaces.is_table(Path(name)) == is_table


def test_rows_without_classes_have_none() -> None:
    assert notes.provenance(Cloud(np.eye(3))) == {"classes": {}, "transformation": None}


def test_the_headline_says_how_a_file_differs_from_the_mesh() -> None:
    written = WriteResult(None, "stl", 684, origin=(450000.0, 5200000.0, 0.0))
    moved = "float32, so the origin (450000, 5200000, 0) was subtracted"
    assert outputs.headline(written, "12 triangles") == f"-: 12 triangles, 684 B; {moved}"


def test_decimals_of_a_scale() -> None:
    scales = 0.001, 0.25, 1.0000000000000002e-06, 100.0
    assert [*map(_decimals, scales)] == [3, 2, 6, 0]


def test_text_of_files_does_not_control_the_terminal() -> None:
    assert terminal.printable("\x1b[31mred") == "\\x1b[31mred"


def test_rates_have_three_digits() -> None:
    rates = 1_234_567.8, 98_700.0, 9.0, 0.0
    assert [*map(terminal.rate_text, rates)] == ["1.23 M/s", "98.7 k/s", "9 /s", ""]


@pytest.mark.parametrize("words", [3, 30])
def test_notes_that_differ_in_numbers_are_counted(
    words: int, capsys: pytest.CaptureFixture[str]
) -> None:
    said = "rows " + "and more " * words
    with terminal.few_of_a_kind():
        for k in range(9):
            terminal.note(f"{k}.las: {k} {said}")
        terminal.note("0.las: other words")
    *lines, other, last = capsys.readouterr().err.splitlines()
    assert [line.split()[2] for line in lines] == [f"{k}.las:" for k in range(len(lines))]
    assert other.endswith("0.las: other words")
    name = len(lines) - 1
    start = f"liftmesh: note: {9 - len(lines)} more files, as {name}.las: {name} rows and more"
    assert last.startswith(start)
    assert last.endswith("...") == (words == 30)
