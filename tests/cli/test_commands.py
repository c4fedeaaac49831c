"""The options of all commands together."""

from __future__ import annotations

from collections import Counter

import pytest

from liftmesh.cli.application import COMMANDS, Command


@pytest.mark.parametrize("name", COMMANDS)
def test_a_name_is_that_of_one_option(name: str) -> None:
    names = Counter(each for option in Command(name).params for each in option.opts)
    assert {each: count for each, count in names.items() if count > 1} == {}
