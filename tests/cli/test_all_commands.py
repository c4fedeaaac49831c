"""What all commands share: help, version, errors in one line, exit codes, pipes, Ctrl-C."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from importlib import import_module
from importlib.metadata import version

import numpy as np
import pytest
from commands import (
    COMMAND,
    PLAIN,
    ROOT,
    failed,
    interrupted,
    liftmesh,
    on_terminal,
    process,
    without_escapes,
)

from liftmesh.cli import exit_codes, main
from liftmesh.cli.application import COMMANDS, Command
from liftmesh.cli.terminal import bytes_text


@pytest.mark.parametrize("after", [[], ["triangulate"]])
def test_version(after):
    done = process("--version", *after)
    assert (done.returncode, done.stdout) == (0, f"liftmesh {version('liftmesh')}\n")


@pytest.mark.parametrize("word", ["--version", "--help"])
def test_help_and_version_load_no_arrays(word):
    script = (
        "import sys\nfrom liftmesh.cli import main\n"
        f"main([{word!r}])\n"
        "print(*{'numpy', 'scipy', 'trimesh', 'open3d'} & set(sys.modules), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stderr == "\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_examples_that_parse(command):
    done = process(command, "--help", env={"COLUMNS": "120"})
    assert done.returncode == 0
    assert "Examples" in done.stdout
    examples = [line.strip() for line in done.stdout.splitlines() if line.strip().startswith("$ ")]
    assert len(examples) >= 2
    assert all(line.startswith(f"$ liftmesh {command} ") for line in examples)


def test_pages_and_campaigns_name_every_command():
    pages = "".join(p.read_text("utf-8") for p in (ROOT / "docs").rglob("*.md"))
    ground, jobs = (
        (ROOT / path).read_text("utf-8") for path in ("docs/guide/ground.md", "scripts/jobs.py")
    )
    assert [name for name in COMMANDS if not re.search(rf"liftmesh {name}\b", pages)] == []
    assert {*re.findall(r'yield f?"([\w-]+) ', jobs)} == {*COMMANDS}
    reads_lidar = [
        name
        for name in COMMANDS
        if any("--all-classes" in each.opts for each in Command(name).params)
    ]
    told = next(line for line in ground.splitlines() if "the ground of a LAS or LAZ file" in line)
    assert [name for name in reads_lidar if f"`{name}`" not in told] == []


def test_a_hyphen_in_the_name_of_a_command_is_an_underscore_in_its_module(monkeypatch):
    monkeypatch.setitem(sys.modules, "liftmesh.cli.some_name", import_module("liftmesh.cli.info"))
    assert Command("some-name").name == "some-name"


def test_help_tells_the_exit_codes():
    done = process("--help", env={"COLUMNS": "120"})
    for code, meaning in exit_codes.MEANINGS.items():
        assert f"{code}  {meaning}" in done.stdout
    for command in COMMANDS:
        assert f"\n  {command} " in done.stdout
    assert "--debug" in done.stdout


def test_without_a_command_comes_the_help():
    done = process()
    assert "Usage: liftmesh" in done.stdout + done.stderr
    assert done.returncode == exit_codes.USAGE


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["nonsense"], ["nonsense", "(see liftmesh --help)"]),
        (["triangulate"], ["IN", "(see liftmesh triangulate --help)"]),
        (["triangulate", "a.ply"], ["OUT"]),
        (["info", "a.ply", "--colour"], ["--colour"]),
        (["triangulate", "a.ply", "b.ply", "--on-duplicate", "some"], ["some", "first", "mean"]),
        (
            ["triangulate", "a.ply", "b.ply", "--plane", "up"],
            ["'up'", "fit, NX,NY,NZ, A,B,C,D"],
        ),
        (["triangulate", "a.ply", "b.ply", "--threads", "0"], ["--threads is 0", "from 1 to 1024"]),
        (["triangulate", "a.ply", "b.ply", "--threads", "9999"], ["--threads is 9999"]),
        (["triangulate", "a.ply", "b.ply", "--threads", "two"], ["--threads", "whole number"]),
        (["compare", "a.ply", "--apex", "1,2,3"], ["'1,2,3'", "median, origin or a finite X,Y"]),
        (["compare", "a.ply", "--proofs", "-1"], ["--proofs"]),
        (["info", "-"], ["stdin", "--input-format"]),
    ],
)
def test_wrong_usage(words, parts):
    failed(liftmesh(*words), exit_codes.USAGE, *parts)


def test_python_options_in_messages_become_options_of_the_command(tmp_path):
    (tmp_path / "cloud.csv").write_text("0,0,0\n1,0,0\nnan,1,0\n")
    done = liftmesh("triangulate", tmp_path / "cloud.csv", tmp_path / "mesh.ply")
    failed(done, exit_codes.BAD_INPUT, "row 2", "--nonfinite skip")
    (tmp_path / "cloud").write_text("0 0 0\n")
    failed(
        liftmesh("info", tmp_path / "cloud"),
        exit_codes.BAD_INPUT,
        "give the format with --input-format",
    )


@pytest.mark.parametrize("place", ["first", "last"])
def test_debug_shows_the_traceback(place, tmp_path):
    words = ["info", tmp_path / "nowhere.ply"]
    done = liftmesh(*(["--debug", *words] if place == "first" else [*words, "--debug"]))
    assert done.returncode == exit_codes.BAD_INPUT
    assert "Traceback (most recent call last)" in done.stderr
    assert done.stderr.splitlines()[-1].startswith("liftmesh: error: ")


def test_an_unexpected_exception_is_called_a_bug(monkeypatch, capsys, tmp_path):
    np.save(tmp_path / "cloud.npy", np.eye(3))

    def broken(*_args, **_options):
        raise ZeroDivisionError("something\nunforeseen")

    monkeypatch.setattr("liftmesh.io.read.read", broken)
    assert main(["info", str(tmp_path / "cloud.npy")]) == exit_codes.BUG
    error = capsys.readouterr().err
    assert error.startswith("liftmesh: error: unexpected ZeroDivisionError: something unforeseen")
    assert error.count("\n") == 1


def test_ctrl_c_amid_an_import_is_no_bug(monkeypatch, capsys, tmp_path):
    np.save(tmp_path / "cloud.npy", np.eye(3))

    def broken(*_args, **_options):
        raise ImportError("a compiled module could not begin") from KeyboardInterrupt()

    monkeypatch.setattr("liftmesh.io.read.read", broken)
    assert main(["info", str(tmp_path / "cloud.npy")]) == exit_codes.INTERRUPTED
    assert capsys.readouterr().err == "liftmesh: error: interrupted\n"


def test_an_error_is_told_without_colours_where_there_is_no_room_to_load_them(monkeypatch, capsys):
    assert main(["--version"]) == exit_codes.DONE
    monkeypatch.setitem(sys.modules, "liftmesh.cli.terminal", None)  # its import fails
    capsys.readouterr()
    assert main(["info", "nowhere.ply"]) == exit_codes.BAD_INPUT
    assert capsys.readouterr().err == "liftmesh: error: nowhere.ply: No such file or directory\n"


INTERRUPTED_AMID_A_TEXT = """
import builtins, sys

run = builtins.exec

def interrupted(text, *names):
    if isinstance(text, str) and "liftmesh.io.format" in sys.modules:
        builtins.exec, text = run, "raise KeyboardInterrupt"
    run(text, *names)

builtins.exec = interrupted
"""


def test_ctrl_c_amid_the_making_of_a_dataclass_has_the_exit_code_of_any_other(tmp_path):
    (tmp_path / "sitecustomize.py").write_text(INTERRUPTED_AMID_A_TEXT)
    done = process("info", ROOT / "data" / "hill.csv", env={"PYTHONPATH": str(tmp_path)})
    failed(done, exit_codes.INTERRUPTED, "interrupted")


def test_main_runs_in_a_process_too(capsys):
    assert main(["info", str(ROOT / "data" / "hill.csv")]) == exit_codes.DONE
    assert "spacing" in capsys.readouterr().out


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "words",
    [
        ["info", "data/hill.csv"],
        ["info", "data/hill.csv", "--json"],
        ["triangulate", "data/jacksboro.ply", "-", "--output-format", "obj"],
        ["--help"],
    ],
)
def test_a_closed_pipe_is_no_error(words, unbuffered):
    reader, writer = os.pipe()
    os.close(reader)
    env = {**PLAIN, "PYTHONUNBUFFERED": unbuffered}
    done = subprocess.run(
        [*COMMAND, *words],
        stdout=writer,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env=env,
        check=False,
    )
    os.close(writer)
    assert (done.returncode, done.stderr) == (exit_codes.PIPE_CLOSED, "")


@pytest.mark.slow
@pytest.mark.parametrize("command", ["triangulate", "compare", "info"])
def test_ctrl_c_stops_at_once_and_leaves_nothing_behind(command, tmp_path):
    rng = np.random.default_rng(0)
    np.save(tmp_path / "cloud.npy", rng.random((1_500_000, 3)))
    words = {"triangulate": ["mesh.obj"], "compare": ["--hull", "hull.ply"], "info": []}[command]
    code, out, err = interrupted(command, "cloud.npy", *words, cwd=tmp_path)
    assert code == exit_codes.INTERRUPTED
    assert out == ""
    assert err == "liftmesh: error: interrupted\n"
    assert [path.name for path in tmp_path.iterdir()] == ["cloud.npy"]


def test_pipes_get_plain_text_and_no_progress():
    done = process("info", "data/hill.csv", cwd=ROOT)
    assert done.stderr == ""
    assert "\x1b" not in done.stdout


def test_a_terminal_gets_colour_and_the_same_words():
    shown, code = on_terminal("info", "data/hill.csv", cwd=ROOT)
    assert code == 0
    assert "\x1b[36m" in shown
    told = without_escapes(shown)
    for line in liftmesh("info", "data/hill.csv", cwd=ROOT).stdout.splitlines():
        assert line.split()[-1] in told


@pytest.mark.slow
@pytest.mark.parametrize("env", [{"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_colour_can_be_refused(env):
    shown, code = on_terminal("compare", "data/hill.csv", cwd=ROOT, env=env)
    assert code == 0
    assert "\x1b[3" not in shown
    assert "Both results are correct" in shown


def test_errors_on_a_terminal_are_one_line_too():
    shown, code = on_terminal("info", "nowhere.ply", cwd=ROOT, env={"COLUMNS": "30"})
    assert code == exit_codes.BAD_INPUT
    text = without_escapes(shown).splitlines()[-1]
    assert text == "liftmesh: error: nowhere.ply: No such file or directory"


@pytest.mark.parametrize(
    ("count", "text"),
    [
        (0, "0 B"),
        (999, "999 B"),
        (1000, "1 kB"),
        (999_600, "1 MB"),
        (6_912_403, "6.91 MB"),
        (3e15, "3e+03 TB"),
    ],
)
def test_bytes(count, text):
    assert bytes_text(count) == text
