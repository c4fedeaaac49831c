"""Wrong usage and help in words of our own; completion for shells; ``~`` in values."""

from __future__ import annotations

import os
import re
from pathlib import Path
from types import SimpleNamespace

import click
import numpy as np
import pytest
from commands import failed, liftmesh, process

from liftmesh import Cloud, triangulate, write
from liftmesh.cli import exit_codes
from liftmesh.cli.application import COMMANDS
from liftmesh.cli.wording import usage_message

FOREIGN = re.compile(
    r"input should|valid integer|value error|invalid value|no such|missing argument|"
    r"got unexpected|does not take|requires an argument|possible options|click",
    re.IGNORECASE,
)
TRIANGULATE = ["triangulate", "a.ply", "b.ply"]
WRONG = [
    (["triangulate"], "IN or OUT is missing: give liftmesh triangulate IN... OUT (see liftmesh"),
    (["triangulate", "a.ply"], "IN or OUT is missing: give liftmesh triangulate IN... OUT"),
    (["tile"], "IN or OUT is missing: give liftmesh tile IN... OUT (see liftmesh tile"),
    (["sample", "a", "b"], "--at is missing: give liftmesh sample IN OUT --at FILE (see liftmesh"),
    (
        ["raster", "a", "b.tif"],
        "give either --resolution or --size (see liftmesh raster --help)",
    ),
    (["profile"], "IN is missing: give liftmesh profile IN OUT --along FILE|X,Y (see liftmesh"),
    (["info", "a.ply", "b.ply"], "unexpected 'b.ply': give liftmesh info FILE"),
    ([*TRIANGULATE, "--threads", "two"], "--threads is 'two': give a whole number from 1 to 1024"),
    ([*TRIANGULATE, "--threads", "1.5"], "--threads is '1.5': give a whole number from 1"),
    ([*TRIANGULATE, "--threads", "-1"], "--threads is -1: give a whole number from 1"),
    ([*TRIANGULATE, "--on-duplicate"], "--on-duplicate needs a value"),
    (
        [*TRIANGULATE, "--on-duplicate", "some"],
        "--on-duplicate 'some' is unknown: give first, last, lowest, highest, mean or error (see",
    ),
    ([*TRIANGULATE, "--nonfinite", "x"], "--nonfinite 'x' is unknown: give error or skip"),
    ([*TRIANGULATE, "--plane", "up"], "--plane is 'up', neither a known name nor a file: give xy"),
    ([*TRIANGULATE, "--plane", ""], "--plane is '', neither a known name nor a file: give xy"),
    ([*TRIANGULATE, "--skip-rows", "two"], "--skip-rows is 'two': give a whole number from 0"),
    ([*TRIANGULATE, "--skip-rows", "-2"], "--skip-rows is -2: give a whole number from 0"),
    (["info"], "FILE is missing: give liftmesh info FILE (see liftmesh info --help)"),
    (["info", "a.ply", "--json=5"], "--json takes no value"),
    (["info", "a.ply", "--js"], "there is no option --js: did you mean --json?"),
    (["info", "a.ply", "--colour"], "there is no option --colour"),
    (["info", "a.ply", "--max-bytes", "big"], "--max-bytes is 'big': give a size, as 500M"),
    (["raster", "--step", "1"], "there is no option --step (see"),
    (["raster", "--hel"], "there is no option --hel: did you mean --help?"),
    (["verify"], "FILE is missing: give liftmesh verify FILE"),
    (["compare", "a.ply", "--proofs", "x"], "--proofs is 'x': give a whole number from 0"),
    (["compare", "a.ply", "--proofs", "-1"], "--proofs is -1: give a whole number from 0"),
    (
        ["compare", "a.ply", "--apex", "1,2,3"],
        "--apex is '1,2,3': give median, origin or a",
    ),
    (["paper", "--n", "2"], "--n is 2: give a whole number from 3"),
    (["paper", "--seeds", "some"], "--seeds is 'some': give a whole number from 1"),
    (["paper", "--table", "6"], "--table '6' is unknown: give 5.1, 5.2 or both"),
    (["paper", "all"], "unexpected 'all': give liftmesh paper (see"),
    (["nonsense"], "there is no command 'nonsense': give one of triangulate, tile, simplify,"),
    (["triangulat"], "there is no command 'triangulat': did you mean triangulate?"),
    (["--nonsense"], "there is no option --nonsense"),
]


@pytest.mark.parametrize(
    ("words", "said"), WRONG, ids=lambda value: " ".join(value) if isinstance(value, list) else ""
)
def test_wrong_usage_is_told_in_our_words(words: list[str], said: str) -> None:
    done = liftmesh(*words)
    failed(done, exit_codes.USAGE, said)
    assert not FOREIGN.search(done.stderr)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("triangulate a.ply b.ply --band 2", "a.ply: --band cannot be given: ply files"),
        ("triangulate a.ply b.las --point-format 11", "--point-format is 11: give a whole"),
        ("triangulate a.ply b.las --scale 1e-9", "in steps of --scale 1e-09: give a larger"),
        ("triangulate a.ply b.ply --cell 1e-300", "--cell is 1e-300, too small"),
        ("triangulate a.ply b.ply --min-distance 1e-300", "--min-distance is 1e-300, too small"),
        ("simplify a.ply b.ply --max-points 3", "--max-points is 3, and the hull has"),
        ("tile a.ply feet.ply out --surface", "in None: give --dst-crs or --src-crs"),
        ("triangulate feet.ply b.3mf", "but 3MF has metre, foot: give --unit"),
        (
            "triangulate wall.xyz b.ply",
            "a point off it (for a cloud in a vertical plane: triangulate it with --plane fit)",
        ),
    ],
)
def test_commands_name_their_own_options(line: str, said: str, tmp_path: Path) -> None:
    points = np.random.default_rng(0).random((60, 3)) * 80
    mesh = triangulate(points).to_cloud()
    write(tmp_path / "a.ply", mesh)
    write(tmp_path / "feet.ply", Cloud(points, faces=mesh.faces, crs="EPSG:6576"))
    write(tmp_path / "wall.xyz", Cloud(points * (1, 0, 1)))
    before = sorted(tmp_path.iterdir())
    done = liftmesh(*line.split(), cwd=tmp_path)
    failed(done, exit_codes.BAD_INPUT, said)
    assert sorted(tmp_path.iterdir()) == before


def test_what_is_unforeseen_keeps_its_text() -> None:
    option = SimpleNamespace(opts=["-n", "--number"], metavar=None)
    error = click.BadParameter("a reason", param=option)  # type: ignore[arg-type]
    assert usage_message(error) == "--number is not a value that it takes"
    context = SimpleNamespace(command_path="liftmesh info", command=SimpleNamespace(params=[]))
    unknown = SimpleNamespace(message="something else", ctx=context)
    assert usage_message(unknown) == "something else (see liftmesh info --help)"


@pytest.mark.parametrize("command", [[], *([name] for name in COMMANDS)])
def test_help_shows_no_type_for_flags(command: list[str]) -> None:
    done = liftmesh(*command, "--help")
    assert done.returncode == 0
    assert "--help" in done.stdout
    assert "bool" not in done.stdout.lower()


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_but_paper_prints_json(command: str) -> None:
    assert ("--json" in liftmesh(command, "--help").stdout) == (command != "paper")


def test_without_words_comes_the_help_alone() -> None:
    bare, asked = liftmesh(), liftmesh("--help")
    assert bare.stdout == asked.stdout
    assert (bare.returncode, bare.stderr) == (exit_codes.USAGE, "")


def completed(shell: str, words: str, **variables: str) -> list[str]:
    env = {"_LIFTMESH_COMPLETE": f"{shell}_complete", "COMP_WORDS": words, **variables}
    done = process(env=env)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.split()


@pytest.mark.slow
def test_shells_complete_commands_options_and_values() -> None:
    assert completed("bash", "liftmesh tri", COMP_CWORD="1") == ["plain,triangulate"]
    options = completed("bash", "liftmesh triangulate --on-d", COMP_CWORD="2")
    assert options == ["plain,--on-duplicate"]
    values = completed("bash", "liftmesh triangulate a b --on-duplicate l", COMP_CWORD="5")
    assert values == ["plain,last", "plain,lowest"]
    files = completed("bash", "liftmesh info clo", COMP_CWORD="2")
    assert files == ["file,clo"]
    zsh = completed("zsh", "liftmesh tri", COMP_CWORD="1")
    assert zsh[:3] == ["plain", "triangulate", "Triangulate"]


def test_the_script_for_a_shell_is_shown() -> None:
    done = process(env={"_LIFTMESH_COMPLETE": "bash_source"})
    assert done.returncode == 0
    assert "complete -o nosort -F _liftmesh_completion liftmesh" in done.stdout
    assert "--show-completion" in liftmesh("--help").stdout


@pytest.mark.parametrize(
    ("shell", "first"),
    [
        ("bash", "_liftmesh_completion() {"),
        ("zsh", "#compdef liftmesh"),
        ("fish", "function _liftmesh"),
        ("pwsh", "Register-ArgumentCompleter"),
    ],
)
def test_a_shell_can_be_named(shell: str, first: str) -> None:
    done = liftmesh("--show-completion", shell)
    assert (done.returncode, done.stderr) == (exit_codes.DONE, "")
    assert done.stdout.startswith(first)


@pytest.mark.parametrize(
    ("shell", "place", "profile", "line"),
    [
        ("fish", ".config/fish/completions/liftmesh.fish", None, ""),
        ("bash", ".bash_completions/liftmesh.sh", ".bashrc", "source ~/.bash_completions/liftm"),
        ("zsh", ".zfunc/_liftmesh", ".zshrc", "fpath+=~/.zfunc"),
        ("pwsh", "Documents/liftmesh.ps1", "Documents/profile.ps1", ". '"),
    ],
)
def test_completion_is_installed_for_the_shell_that_is_named(
    shell: str,
    place: str,
    profile: str | None,
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    (tmp_path / "pwsh").write_text(f"#!/bin/sh\necho {tmp_path}/Documents/profile.ps1\n")
    (tmp_path / "pwsh").chmod(0o755)
    if profile is not None:
        (tmp_path / profile).parent.mkdir(exist_ok=True)
        (tmp_path / profile).write_text("alias ll='ls -l'\n")
    for _ in range(2):
        done = liftmesh("--install-completion", shell)
        assert done.stdout.startswith(f"{tmp_path / place}: completion for {shell}, in terminals")
    assert "_LIFTMESH_COMPLETE" in (tmp_path / place).read_text()
    if profile is not None:
        own, added = (tmp_path / profile).read_text().splitlines()
        assert (own, added[: len(line)]) == ("alias ll='ls -l'", line)


@pytest.mark.parametrize("option", ["--show-completion", "--install-completion"])
def test_a_shell_without_completion_is_wrong_usage(option: str) -> None:
    for words in ["tcsh"], ["zsh", "fish"]:
        said = f"there is no completion for {' '.join(words)}: give liftmesh {option} SHELL"
        failed(liftmesh(option, *words), exit_codes.USAGE, said)


def test_the_shell_at_hand_is_that_of_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SHELL", "/bin/zsh")
    assert liftmesh("--show-completion").stdout.startswith("#compdef liftmesh")
    monkeypatch.setenv("SHELL", "/bin/dash")
    failed(liftmesh("--show-completion"), exit_codes.USAGE, "no completion for dash: give")
    monkeypatch.delenv("SHELL")
    said = "no completion for a shell that is not known: give"
    failed(liftmesh("--show-completion"), exit_codes.USAGE, said)


def test_a_tilde_in_words_is_the_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    np.save(tmp_path / "cloud.npy", np.random.default_rng(0).random((20, 3)))
    assert liftmesh("triangulate", "~/cloud.npy", "~/mesh.ply").returncode == 0
    done = liftmesh("verify", "~/mesh.ply", "--certificate=~/mesh.json")
    assert done.returncode == 0
    assert {path.name for path in tmp_path.iterdir()} == {"cloud.npy", "mesh.ply", "mesh.json"}
    assert liftmesh("info", f"~{os.sep}nowhere.ply").returncode == exit_codes.BAD_INPUT
