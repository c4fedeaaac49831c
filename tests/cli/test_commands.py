"""The options of all commands together."""

from __future__ import annotations

from collections import Counter

import pytest
import typer

from liftmesh.cli.application import COMMANDS, application


@pytest.mark.parametrize("name", COMMANDS)
def test_a_name_is_that_of_one_option(name: str) -> None:
    command = typer.main.get_command(application([])).commands[name]  # type: ignore[attr-defined]
    names = Counter(each for option in command.params for each in option.opts)
    assert {each: count for each, count in names.items() if count > 1} == {}
