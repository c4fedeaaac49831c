"""Values of options, and groups of options in place of one parameter."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from typing import Annotated, Any, TypeAlias, get_args

import click
import pytest

from liftmesh.cli import options
from liftmesh.errors import InputError


@pytest.mark.parametrize(
    ("parse", "text", "value"),
    [
        (options.color_depth, "16", 16),
        (options.threads, "2", 2),
        (options.positive, "0.5", 0.5),
        (options.number, "-2", -2.0),
        (options.distance, "0", 0.0),
        (options.whole(0), "4", 4),
        (options.numbers, "1,2.5", [1.0, 2.5]),
        (options.ends, "-inf,10", [-math.inf, 10.0]),
        (options.classes, "2,9", [2, 9]),
        (options.metric, "2,0.5,1", ((2.0, 0.5), (0.5, 1.0))),
        (options.apex, "1.5,-2", (1.5, -2.0)),
        (options.box, "0,0,2,1", (0.0, 0.0, 2.0, 1.0)),
        (options.box, "city.geojson", None),
        (options.plane, "0,0,1", ((0.0, 0.0, 1.0), None)),
        (options.plane, "fit", ("fit", None)),
    ],
)
def test_values_are_parsed(parse: Callable[[str], Any], text: str, value: object) -> None:
    assert parse(text) == value


@pytest.mark.parametrize(
    ("parse", "text", "reason"),
    [
        (options.positive, "0", "is 0: give a positive number"),
        (options.number, "inf", "is inf: give a finite number"),
        (options.distance, "nan", "is nan: give 0 or a positive number"),
        (options.numbers, "1,x", "is 'x': give a finite number"),
        (options.ends, "1,", "is '': give a number"),
        (options.whole(3), "2", "is 2: give a whole number from 3"),
        (options.whole(3), "2.5", "is '2.5': give a whole number from 3"),
        (options.threads, "0", "is 0: give a whole number from 1 to 1024"),
        (options.metric, "1,5,1", "is [[1.0, 5.0], [5.0, 1.0]], which is not positive definite: "),
    ],
)
def test_what_is_wrong_follows_the_name_of_the_option(
    parse: Callable[[str], Any], text: str, reason: str
) -> None:
    with pytest.raises(InputError) as raised:
        parse(text)
    name, _, said = str(raised.value).partition(" ")
    assert name == raised.value.option
    assert said.startswith(reason)


def test_one_way_to_lift_is_taken() -> None:
    metric = options.metric("2,0.5,1")
    assert options.lifting(None, None, metric) == {"metric": metric}
    assert options.lifting("w", None, None) == {"weights": "w"}
    with pytest.raises(click.BadParameter, match="--weights and --radii are given"):
        options.lifting("w", "r", None)


def test_given_keeps_zero() -> None:
    assert options.given(a=None, b=False, c=0, d=True) == {"c": 0, "d": True}


Words: TypeAlias = Annotated[str, options.option("WORDS", "Words.")]
Count: TypeAlias = Annotated[int, options.option("N", "A count.", panel="Output")]


def _inner(words: Words = "", count: Count = 0) -> dict[str, Any]:
    return {"words": words, "count": count}


Inner: TypeAlias = Annotated[dict[str, Any], options.Group(_inner, "Input")]


def _outer(size: Count = 1, *, inner: Inner, last: Count = 0) -> tuple[int, dict[str, Any], int]:
    return size, inner, last


Outer: TypeAlias = Annotated[Any, options.Group(_outer)]


def test_options_of_groups_stand_where_the_group_stands() -> None:
    def run(path: Words, *, outer: Outer, json: options.Json = False) -> object:
        return path, outer, json

    command = options.with_single_options(run)
    parameters = inspect.signature(command).parameters
    panels = {name: get_args(each.annotation)[1].panel for name, each in parameters.items()}
    assert panels == {
        "path": "", "size": "Output", "words": "Input", "count": "Output", "last": "Output",
        "json": "Output",
    }  # fmt: skip
    given = {"path": "a", "size": 3, "words": "w", "count": 2, "last": 1, "json": True}
    assert command(**given) == ("a", (3, {"words": "w", "count": 2}, 1), True)


def test_a_group_may_describe_its_options_anew() -> None:
    def run(*, outer: Annotated[Any, options.Group(_outer, texts={"words": "None."})]) -> object:
        return outer

    parameters = inspect.signature(options.with_single_options(run)).parameters
    texts = {name: get_args(each.annotation)[1].text for name, each in parameters.items()}
    assert texts == {"size": "A count.", "words": "None.", "count": "A count.", "last": "A count."}


def test_a_function_without_groups_stays_as_it_is() -> None:
    assert options.with_single_options(_inner) is _inner
