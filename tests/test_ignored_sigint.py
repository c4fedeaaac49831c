"""The tests are started where SIGINT is ignored: those of Ctrl-C pass, and no program runs on."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest
from commands import ROOT
from process_state import descendants


@pytest.mark.slow
@pytest.mark.parametrize(
    "test",
    [
        "tests/cli/test_all_commands.py::test_ctrl_c_stops_at_once_and_leaves_nothing_behind[triangulate]",
        "tests/core/test_concurrency.py::test_ctrl_c_stops_long_walks_within_a_second",
    ],
)
def test_tests_of_ctrl_c_pass_where_it_is_ignored(test: str) -> None:
    pytest_ = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", test]
    done = subprocess.run(
        ["sh", "-c", 'trap "" INT; exec "$@"', "sh", *pytest_],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout


def test_programs_of_a_test_that_takes_too_long_are_killed(
    pytestconfig: pytest.Config,
) -> None:
    (conftest,) = [
        each
        for each in pytestconfig.pluginmanager.get_plugins()
        if getattr(each, "end_children", None)
    ]
    child = subprocess.Popen(["sh", "-c", "sh -c 'sleep 600; true' & sleep 600; wait; exit 3"])
    end = time.monotonic() + 300
    while len([*descendants(child.pid)]) < 3:
        assert time.monotonic() < end
    conftest.end_children(child.pid)  # not of this process: a library may need those it has started
    assert child.wait(timeout=300) == 3
    assert [*descendants(child.pid)] == []
