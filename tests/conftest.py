"""What holds for every test: the same examples each time, and no test left out."""

from __future__ import annotations

import pytest
from hypothesis import settings

settings.register_profile("liftmesh", derandomize=True, deadline=None, database=None)
settings.load_profile("liftmesh")

LEFT_OUT = ("skipped", "xfailed", "deselected")


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail a whole run in which a test was left out: what is missing must not look like success."""
    if session.config.option.keyword or session.config.option.markexpr:
        return  # someone chose some tests by hand
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    left_out = {name: len(reporter.stats.get(name, ())) for name in LEFT_OUT} if reporter else {}
    if any(left_out.values()) and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
        counts = ", ".join(f"{count} {name}" for name, count in left_out.items() if count)
        reporter.write_line(f"\nno test may be left out: {counts}", red=True)
