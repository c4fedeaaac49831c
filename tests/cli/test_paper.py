"""``liftmesh paper``: a run, a run that is interrupted, a run that may not be."""

from __future__ import annotations

import csv
import json
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from commands import (
    COMMAND,
    PLAIN,
    computed,
    failed,
    liftmesh,
    on_terminal,
    process,
    without_escapes,
)

from liftmesh.cli import exit_codes

TINY = ("--n", 20, "--n", 30, "--seeds", 1, "--no-figures", "--machine", "a desk")
SLOW = ("--n", 200, "--n", 300, "--seeds", 2, "--no-figures")


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def paper(folder, *words):
    return liftmesh("paper", *(words or TINY), "--out", folder)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A whole tiny run in a process of its own."""
    folder = tmp_path_factory.mktemp("paper") / "deep" / "down"
    return folder, process("paper", *TINY, "--out", folder)


@pytest.mark.slow
def test_a_run_tells_and_writes_everything(made):
    folder, done = made
    assert (done.returncode, done.stderr) == (0, "")
    assert re.match(
        r"4 sets of points, four methods on each: about \d+ seconds\. It may be interrupted",
        done.stdout,
    )
    assert names_in(folder) == [
        "measurements.csv", "paper.json", "table_5_1.csv", "table_5_2.csv", "tables.md"
    ]  # fmt: skip
    told = json.loads((folder / "paper.json").read_text())
    assert told["machine"] == "a desk"
    assert told["command"] == ("liftmesh paper --seeds 1 --n 20 --n 30 --machine 'a desk'")
    assert "Measured on: a desk." in done.stdout
    for q, table in (("origin", "5.1"), ("median", "5.2")):
        assert f"Table {table}, q = {q}: seconds, the paper's and ours (one seed)" in done.stdout
        for row in told["tables"][table]:
            assert re.search(
                rf"^{row['n']} +- +- +- .* {row['ratio']:.2f} ", done.stdout, re.MULTILINE
            )
            share = f"{100 * row['rejected 4.3 (i)']:.1f}%"
            assert re.search(
                rf"^{row['n']} .* {row['dot_product_ratio']:.1f} .* {share} ",
                done.stdout,
                re.MULTILINE,
            )


@pytest.mark.slow
def test_what_is_counted_is_the_same_in_every_run(made, tmp_path):
    folder, _ = made
    again = paper(tmp_path / "again")
    assert again.returncode == 0
    one, other = (
        json.loads((made_in / "paper.json").read_text())["tables"]
        for made_in in (folder, tmp_path / "again")
    )
    for table, rows in one.items():
        for row, twin in zip(rows, other[table], strict=True):
            counted = [name for name in row if re.search(r"dot_product|planes|4\.|facets", name)]
            assert len(counted) == 14
            assert [row[name] for name in counted] == [twin[name] for name in counted]


def test_the_same_again_measures_nothing(made):
    folder, _ = made
    before = (folder / "measurements.csv").read_bytes()
    done = paper(folder)
    assert done.stdout.startswith(
        f"{folder}/measurements.csv holds 4 of 4 sets of points with these settings: "
        "nothing is left to measure."
    )
    assert "Table 5.2" in done.stdout
    assert (folder / "measurements.csv").read_bytes() == before


@pytest.mark.slow
def test_one_table_after_the_other(tmp_path):
    assert paper(tmp_path, *TINY, "--table", "5.2").returncode == 0
    assert names_in(tmp_path) == ["measurements.csv", "paper.json", "table_5_2.csv", "tables.md"]
    done = paper(tmp_path)
    assert "holds 2 of 4 sets of points with these settings: continuing" in done.stdout
    assert "Table 5.1" in done.stdout
    assert "table_5_1.csv" in names_in(tmp_path)


@pytest.mark.slow
def test_the_command_told_makes_all_tables_of_the_folder(tmp_path):
    for table, words in (("5.1", " --table 5.1"), ("5.2", ""), ("5.1", "")):
        done = paper(tmp_path, "--n", 20, "--seeds", 1, "--no-figures", "--table", table)
        assert done.returncode == 0
        command = f"liftmesh paper --seeds 1{words} --n 20"
        assert json.loads((tmp_path / "paper.json").read_text())["command"] == command
        assert f"Remade by `{command}`" in (tmp_path / "tables.md").read_text()


@pytest.mark.slow
def test_a_printed_size_stands_beside_the_printed_numbers(tmp_path):
    done = paper(tmp_path, "--n", 1000, "--seeds", 1, "--table", "5.2", "--no-figures")
    assert done.returncode == 0
    assert re.search(r"^1,000 +0\.088 +0\.052 +1\.70 ", done.stdout, re.MULTILINE)
    assert "where the paper prints 1.70" in done.stdout
    with (tmp_path / "table_5_2.csv").open() as stream:
        (row,) = csv.DictReader(stream)
    assert float(row["lf_dot_products"]) > 10 * float(row["lfres_dot_products"])


def killed(folder, number):
    """Start a run and send it a signal once the first set of points is on the disk."""
    path = folder / "measurements.csv"
    run = subprocess.Popen(
        [*COMMAND, "paper", *map(str, SLOW), "--out", folder],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=PLAIN,
        text=True,
    )
    while not path.exists() or path.read_bytes().count(b"\n") < 6:
        assert run.poll() is None, run.communicate()
        time.sleep(0.005)
    run.send_signal(number)
    out, err = run.communicate(timeout=300)
    return run.returncode, out, err


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_run_that_was_stopped_goes_on(number, tmp_path):
    code, out, err = killed(tmp_path, number)
    expected = {signal.SIGKILL: (-9, ""), signal.SIGINT: (130, "liftmesh: error: interrupted\n")}
    assert (code, err) == expected[number]
    assert out.startswith("8 sets of points")
    path = tmp_path / "measurements.csv"
    assert names_in(tmp_path) == ["measurements.csv"]
    before = path.read_text()
    sets = (before.count("\n") - 2) // 4
    assert 1 <= sets < 8
    again = paper(tmp_path, *SLOW)
    assert again.returncode == 0
    assert f"holds {sets} of 8 sets of points with these settings: continuing" in again.stdout
    assert path.read_text().startswith(before)
    assert path.read_text().count("\n") == 2 + 8 * 4


@pytest.mark.slow
def test_ctrl_c_is_heard_amid_a_long_measurement(tmp_path):
    """Ten times the largest size of the paper: the first method alone would take half an hour."""
    words = ("paper", "--n", 200_000, "--no-figures", "--out", tmp_path)
    run = subprocess.Popen(
        [*COMMAND, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=PLAIN,
        text=True,
    )
    assert run.stdout.readline().startswith("6 sets of points")  # the estimate is made by now
    path = tmp_path / "measurements.csv"
    while not path.exists() or path.read_bytes().count(b"\n") < 2:
        time.sleep(0.005)
    end = computed(run) + 0.5
    while computed(run) < end:
        time.sleep(0.005)
    run.send_signal(signal.SIGINT)
    out, err = run.communicate(timeout=300)
    assert (run.returncode, out) == (exit_codes.INTERRUPTED, "")
    assert err == "liftmesh: error: interrupted\n"
    assert path.read_text().count("\n") == 2


@pytest.mark.slow
def test_an_unfinished_end_is_measured_again(made, tmp_path):
    text = (made[0] / "measurements.csv").read_text()
    path = tmp_path / "measurements.csv"
    path.write_text(text[:-30])
    done = paper(tmp_path)
    assert done.returncode == 0
    assert f"{path}: its end is incomplete; 4 lines are removed" in done.stdout
    assert "holds 3 of 4 sets of points" in done.stdout
    assert path.read_text().startswith("\n".join(text.split("\n")[:-5]))
    assert path.read_text().count("\n") == text.count("\n")


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (("--seeds", 2), "seeds 1, now 2"),
        (("--n", 40), "sizes [20, 30], now [20, 30, 40]"),
        (("--machine", "a shelf"), "machine a desk, now a shelf"),
    ],
)
def test_other_settings_are_refused(words, part, made):
    before = {path.name: path.read_bytes() for path in made[0].iterdir()}
    failed(paper(made[0], *TINY, *words), exit_codes.BAD_INPUT, part, "another folder")
    assert {path.name: path.read_bytes() for path in made[0].iterdir()} == before


def test_a_damaged_file_is_refused(made, tmp_path):
    text = (made[0] / "measurements.csv").read_text()
    heading, rest = text.split("\n", 1)
    damaged = f"{heading}\n{rest.replace('lfres-indexed', 'lfres', 1)}"
    (tmp_path / "measurements.csv").write_text(damaged)
    failed(
        paper(tmp_path), exit_codes.BAD_INPUT, "measurements.csv: line 5: method 'lfres' instead"
    )
    assert names_in(tmp_path) == ["measurements.csv"]


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "taken").write_text("")
    failed(paper(tmp_path / "taken"), exit_codes.BAD_INPUT, "taken", "exists")
    failed(paper(tmp_path / "taken" / "inside"), exit_codes.BAD_INPUT, "taken", "directory")


# The first run, with all rights, loads what the second, without them, could not read from the disk.
READ_ONLY = """
import os, sys
from liftmesh.cli import main
*words, writable, out = sys.argv[1:]
assert main([*words, "--out", writable]) == 0
if os.getuid() == 0:
    os.setgid(65534)
    os.setuid(65534)
sys.exit(main([*words, "--out", out]))
"""


@pytest.mark.slow
def test_a_read_only_folder(made):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "measurements.csv").write_bytes((made[0] / "measurements.csv").read_bytes())
        folder.chmod(0o555)
        for out, reason in ((folder, "read-only"), (folder / "new", "Permission denied")):
            words = ["paper", *map(str, TINY), str(made[0]), str(out)]
            command = [sys.executable, "-c", READ_ONLY, *words]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == exit_codes.BAD_INPUT, done.stderr
            assert done.stderr.count("\n") == 1
            assert str(out) in done.stderr
            assert reason in done.stderr
        assert names_in(folder) == ["measurements.csv"]
        folder.chmod(0o755)


@pytest.mark.parametrize(
    "words", [("--seeds", 0), ("--n", 2), ("--table", "6.1"), ("--seeds", "many"), ("extra",)]
)
def test_wrong_usage(words, tmp_path):
    done = paper(tmp_path / "new", *words)
    failed(done, exit_codes.USAGE, "liftmesh paper --help")
    assert not (tmp_path / "new").exists()


@pytest.mark.slow
def test_quick_is_one_seed(tmp_path):
    assert paper(tmp_path, "--quick", "--n", 20, "--no-figures").returncode == 0
    told = json.loads((tmp_path / "paper.json").read_text())
    assert (told["settings"]["seeds"], told["settings"]["sizes"]) == (1, [20])
    assert told["command"] == "liftmesh paper --quick --n 20"


@pytest.mark.slow
def test_quick_and_whole_runs_keep_to_folders_of_their_own(tmp_path):
    words = ("--n", 20, "--seeds", 1, "--no-figures")
    for quick, folder in (("--quick",), "paper-quick"), ((), "paper"):
        done = liftmesh("paper", *quick, *words, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
        assert f"out/{folder}: 4 files written next to measurements.csv." in done.stdout
        assert "tables.md" in names_in(tmp_path / "out" / folder)
    assert names_in(tmp_path / "out") == ["paper", "paper-quick"]


WITHOUT_MATPLOTLIB = """
import sys
sys.modules["matplotlib"] = None
from liftmesh.cli import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
def test_without_matplotlib_the_tables_can_be_made_alone(tmp_path):
    command = [sys.executable, "-c", WITHOUT_MATPLOTLIB, "paper", "--n", "20", "--seeds", "1"]
    command += ["--out", str(tmp_path / "new")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    remedy = "pip install 'liftmesh[plot]', or pass --no-figures\n"
    failed(done, exit_codes.BAD_INPUT, "this needs matplotlib", remedy)
    assert not (tmp_path / "new").exists()
    done = subprocess.run([*command, "--no-figures"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_a_terminal_shows_a_bar_and_the_table_on_one_line(tmp_path):
    words = ("--n", 1000, "--table", "5.2", "--seeds", 2, "--no-figures", "--out", tmp_path)
    shown, code = on_terminal("paper", *words)
    assert code == 0
    told = without_escapes(shown)
    assert "left: " in told
    assert "Table 5.2, 1,000 points, seed 1: lf" in told
    ours = r"\d\.\d+ ±\d+%"
    row = rf"^1,000 +0\.088 +0\.052 +1\.70 +{ours} +{ours} +\d\.\d\d +\d\.\d+ +\d\.\d+ +\d+"
    assert re.search(row, told, re.MULTILINE)


@pytest.mark.campaign
def test_figures_are_drawn_beside_the_tables(tmp_path, monkeypatch):
    monkeypatch.setattr("liftmesh.paper.figures.DOTS_PER_INCH", 20)  # which takes less time
    done = paper(tmp_path, "--n", 20, "--n", 30, "--seeds", 1)
    assert (done.returncode, done.stderr) == (0, "")
    figures = names_in(tmp_path / "figures")
    assert {Path(name).suffix for name in figures} == {".png", ".svg"}
    written = 4 + len(figures)
    assert f"{tmp_path}: {written} files written next to measurements.csv." in done.stdout
    done = paper(tmp_path, "--n", 20, "--n", 30, "--seeds", 1, "--no-figures")
    assert f"{tmp_path}: 4 files written next to measurements.csv." in done.stdout
