"""What a contributor runs: ``nox -s dev`` once, ``nox -s fast`` while working, others before.

All sessions share the environment `.venv-test`, which the first one makes.
"""

from __future__ import annotations

import random
import shlex

import nox

nox.options.default_venv_backend = "none"
nox.options.sessions = ["fast"]

PYTEST = (".venv-test/bin/python", "-m", "pytest", "-n", "auto", "--dist", "worksteal")
INSTALL = (".venv-test/bin/python", "-m", "pip", "install", "-q")
MUTATION = "cosmic-ray>=8.3"  # no wheel of what it needs: only for this
CAMPAIGNS = (  # each runs for some minutes by itself
    "fuzz kernel --seconds 600",
    "fuzz changing --seconds 300",
    "fuzz constraints --seconds 300",
    "fuzz refinement --seconds 300",
    "fuzz surface --seconds 300",
    "fuzz simplification --seconds 300",
    "fuzz space --seconds 300",
    "fuzz structure --seconds 600",
    "fuzz_tiles.py --seconds 600",
    "conversions --seconds 600",
    "fault_injection",
    "sanitize thread",
    "growth",
    "growth --memory",
    "neighbors.py",
    "domains.py",
    "changes.py",
    "constraints.py",
    "refine.py",
    "earthworks.py",
    "lines.py",
    "interrupt",
    "sweep",
    "sweep --long",
    "soak",
    "mutants.py",
    "docs --fresh",
    "library",
)


@nox.session
def dev(session: nox.Session) -> None:
    """Make the environment, and what it needs of the system, and run nothing."""
    session.run("bash", "-c", "source scripts/setup.sh && make_test_environment", external=True)


@nox.session(requires=["dev"])
def fast(session: nox.Session) -> None:
    """Run all tests of less than half a second of a processor, and those that are given."""
    words = session.posargs or ("tests",)
    session.run(*PYTEST, "-q", "-m", "not slow and not campaign", *words, external=True)


@nox.session
def full(session: nox.Session) -> None:
    """Run every check and test that a change needs: the test command of the README."""
    session.run("bash", "scripts/test.sh", external=True)


@nox.session(requires=["dev"])
def docs(session: nox.Session) -> None:
    """Build the site of documentation, with the pictures of its gallery, in out/docs/html."""
    session.run(".venv-test/bin/python", "scripts/docs", *session.posargs, external=True)


@nox.session(requires=["dev"])
def nightly(session: nox.Session) -> None:
    """Run what takes hours: the tests of campaigns, new examples, and the campaigns of scripts/."""
    seed = random.SystemRandom().randrange(2**32)
    session.run(*INSTALL, MUTATION, external=True)
    session.run(*PYTEST, "-m", "campaign", "tests", external=True)
    new = ("--hypothesis-profile=new", f"--hypothesis-seed={seed}")
    session.run(*PYTEST, "-m", "hypothesis", *new, "tests", external=True)
    for campaign in session.posargs or CAMPAIGNS:
        program, *words = shlex.split(campaign)
        session.run(".venv-test/bin/python", f"scripts/{program}", *words, external=True)
