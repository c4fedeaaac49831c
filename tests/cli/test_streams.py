"""Standard streams that are closed: a command works without them, or says so and writes nothing."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from commands import COMMAND, PLAIN

import liftmesh
from liftmesh.cli import exit_codes

STDOUT = "liftmesh: error: stdout: closed, but this command writes to it: redirect it"
STDIN = "liftmesh: error: stdin: closed, but this command reads from it: redirect it"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    liftmesh.write(tmp_path / "cloud.ply", np.random.default_rng(0).random((20, 3)))
    liftmesh.triangulate(tmp_path / "cloud.ply").save(tmp_path / "mesh.ply")
    return tmp_path


def run(words: str, closed: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command with streams closed by a shell, as in ``liftmesh info cloud.ply >&-``."""
    shell = ["bash", "-c", f'exec "$@" {closed}', "bash", *COMMAND, *words.split()]
    return subprocess.run(
        shell, cwd=folder, capture_output=True, text=True, timeout=300, env=PLAIN, check=False
    )


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@pytest.mark.parametrize(
    "words",
    [
        "info cloud.ply",
        "info cloud.ply --json",
        "verify mesh.ply",
        "verify mesh.ply --json",
        "verify mesh.ply --certificate new.json",
        "verify mesh.ply --certificate -",
        "compare cloud.ply --lower new.ply --hull new.obj",
        "triangulate cloud.ply - --output-format ply",
        "triangulate cloud.ply new.ply --json",
        "--help",
        "--version",
        "info --help",
    ],
)
def test_a_result_without_stdout_is_refused_before_anything_is_written(
    words: str, folder: Path
) -> None:
    before = names(folder)
    done = run(words, ">&-", folder)
    assert (done.returncode, done.stdout) == (exit_codes.BAD_INPUT, "")
    assert done.stderr.startswith(STDOUT)
    assert done.stderr.count("\n") == 1
    assert names(folder) == before


@pytest.mark.parametrize(
    "words", ["info - --input-format ply", "triangulate - new.ply --input-format ply"]
)
def test_input_without_stdin_is_refused(words: str, folder: Path) -> None:
    before = names(folder)
    done = run(words, "<&-", folder)
    assert (done.returncode, done.stdout) == (exit_codes.BAD_INPUT, "")
    assert done.stderr.startswith(STDIN)
    assert done.stderr.count("\n") == 1
    assert names(folder) == before


def test_the_report_is_not_in_a_mesh_on_stdout(folder: Path) -> None:
    done = run("solid mesh.ply - --output-format off --thickness 1", "", folder)
    assert done.stdout.startswith("OFF\n")
    assert (" triangles" in done.stdout, " triangles" in done.stderr) == (False, True)


@pytest.mark.parametrize("closed", [">&-", "<&-", "2>&-", "<&- >&-", "<&- >&- 2>&-"])
def test_a_file_is_written_whole_without_any_stream(closed: str, folder: Path) -> None:
    """No stream is needed, and none is the file: what was printed would be in it."""
    expected = (folder / "mesh.ply").read_bytes()
    done = run("triangulate cloud.ply new.ply", closed, folder)
    assert (done.returncode, done.stderr) == (exit_codes.DONE, "")
    assert ("20 vertices" in done.stdout) == (">&-" not in closed.replace("2>&-", ""))
    assert (folder / "new.ply").read_bytes() == expected


PLACES = """
import os
real = os.link

def link(*words, **options):
    places = [os.readlink(f"/proc/self/fd/{number}") for number in range(3)]
    with open("places.txt", "w") as file:
        file.write(" ".join(places))
    real(*words, **options)

os.link = link
"""


def test_no_file_takes_the_place_of_a_closed_stream(folder: Path) -> None:
    """What a library printed would end up in it."""
    (folder / "sitecustomize.py").write_text(PLACES)
    env = {**PLAIN, "PYTHONPATH": str(folder)}
    command = [*COMMAND, "triangulate", "cloud.ply", "new.ply"]
    shell = ["bash", "-c", 'exec "$@" <&- >&- 2>&-', "bash", *command]
    assert subprocess.run(shell, cwd=folder, timeout=300, env=env, check=False).returncode == 0
    assert (folder / "places.txt").read_text().split() == ["/dev/null"] * 3


def test_an_error_without_stderr_keeps_its_exit_code(folder: Path) -> None:
    done = run("info nowhere.ply", "2>&-", folder)
    assert (done.returncode, done.stdout, done.stderr) == (exit_codes.BAD_INPUT, "", "")


def test_verify_without_stderr_says_what_it_found(folder: Path) -> None:
    done = run("verify mesh.ply", "2>&- <&-", folder)
    assert done.returncode == exit_codes.DONE
    assert done.stdout.startswith("Valid")


@pytest.mark.slow
def test_paper_needs_no_stdout(folder: Path) -> None:
    done = run("paper --n 20 --seeds 1 --no-figures --out made", ">&-", folder)
    assert (done.returncode, done.stderr) == (exit_codes.DONE, "")
    assert os.path.getsize(folder / "made" / "tables.md")  # noqa: PTH202


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("triangulate cloud.ply new.ply", "; new.ply was written"),
        ("triangulate cloud.ply new.ply --json", "; new.ply was written"),
        (
            "compare cloud.ply --lower new.ply --hull new.obj",
            "; new.ply and new.obj were written",
        ),
        ("verify mesh.ply --certificate c.json", "; c.json was written"),
        ("info cloud.ply", ""),
    ],
)
def test_a_full_stdout_says_which_files_were_written(words: str, said: str, folder: Path) -> None:
    done = run(words, ">/dev/full", folder)
    assert done.returncode == exit_codes.BAD_INPUT
    assert done.stderr == f"liftmesh: error: stdout: No space left on device{said}\n"


@pytest.mark.parametrize("most", [5, 6, 7])
def test_a_command_runs_where_few_files_may_be_open(most: int, folder: Path) -> None:
    """There is no pipe for signals then; Python itself needs five."""
    done = subprocess.run(
        ["bash", "-c", f'ulimit -n {most}; exec "$@"', "bash", *COMMAND, "--version"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=300,
        env=PLAIN,
        check=False,
    )
    assert (done.returncode, done.stderr) == (exit_codes.DONE, "")


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ("info nowhere.csv", exit_codes.BAD_INPUT),
        ("info nowhere.csv --debug", exit_codes.BAD_INPUT),
        ("info --nothing", exit_codes.USAGE),
        ("info cloud.ply", exit_codes.DONE),
        ("verify mesh.ply --certificate -", exit_codes.BAD_INPUT),  # its report cannot be told
    ],
)
def test_a_full_stderr_leaves_the_exit_code(words: str, code: int, folder: Path) -> None:
    assert run(words, "2>/dev/full", folder).returncode == code


@pytest.mark.parametrize("words", ["triangulate cloud.ply höhe.ply", "info \udcff.ply"])
def test_a_name_that_the_terminal_cannot_show(words: str, folder: Path) -> None:
    os.link(folder / "cloud.ply", folder / "\udcff.ply")
    done = subprocess.run(
        [*COMMAND, *words.split()],
        cwd=folder,
        capture_output=True,
        env={**PLAIN, "PYTHONIOENCODING": "ascii"},
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["npz", "3mf", "las", "glb"])
def test_a_device_takes_every_format(kind: str, folder: Path) -> None:
    done = run(f"triangulate cloud.ply /dev/null --output-format {kind}", "", folder)
    assert done.returncode == 0, done.stderr
