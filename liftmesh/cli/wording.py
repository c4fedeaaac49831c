"""Help and messages about wrong usage in words of our own.

Those of typer, and of the libraries that it uses, change from version to version: here, the type of
an exception and what it concerns decide; its text serves only to find what was typed.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any

from typer.core import TyperCommand, TyperGroup

from liftmesh.cli.values import convert_simply


class Command(TyperCommand):
    """A command whose help shows no type for flags, which take no value."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the parameters, flags without a placeholder for a value."""
        return convert_simply(_without_types(super().get_params(ctx)))


class Group(TyperGroup):
    """The same of the program."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the parameters, flags without a placeholder for a value."""
        return convert_simply(_without_types(super().get_params(ctx)))


def _without_types(parameters: list[Any]) -> list[Any]:
    for each in parameters:
        if getattr(each, "is_flag", False) and each.metavar is None:
            each.metavar = ""
    return parameters


def usage_message(error: Any) -> str:
    """Describe wrong usage."""
    kinds = {kind.__name__ for kind in type(error).__mro__}
    context = getattr(error, "ctx", None)
    where = f" (see {context.command_path} --help)" if context else ""
    return f"{_described(error, kinds, context)}{where}"


def _described(error: Any, kinds: set[str], context: Any) -> str:
    known = {
        "NoSuchOption": _about_option,
        "MissingParameter": _about_missing,
        "BadOptionUsage": _about_usage,
        "BadParameter": _about_value,
    }
    for kind, describe in known.items():
        if kind in kinds:
            return describe(error)
    return _about_words(error.message, context) if context else str(error.message)


def _about_option(error: Any) -> str:
    typed, known = error.option_name.strip("-"), error.possibilities or ()  # all begin alike
    near = [each for each in known if get_close_matches(typed, [each.strip("-")])]
    return f"there is no option {error.option_name}{_similar(near)}"


def _about_missing(error: Any) -> str:
    arguments = _arguments(error.ctx)
    is_one_of = error.param in arguments and any(each.nargs < 0 for each in arguments)
    missing = " or ".join(map(_name, arguments)) if is_one_of else _name(error.param)
    return f"{missing} is missing: {_usage(error.ctx)}"


def _about_usage(error: Any) -> str:
    takes_none = "not take" in error.message
    return f"{error.option_name} {'takes no' if takes_none else 'needs a'} value"


def _about_words(text: str, context: Any) -> str:
    """Describe a word that is no command, or one too many."""
    extra = re.search(r"argument.*? \((.*)\)", text)
    if extra:
        return f"unexpected {extra[1]!r}: {_usage(context)}"
    typed, known = _quoted(text), getattr(context.command, "commands", None)
    if typed is None or known is None:
        return text
    return f"there is no command {typed!r}{_similar(get_close_matches(typed, known), [*known])}"


def _about_value(error: Any) -> str:
    """Describe a value that an option does not have."""
    if error.param is None:  # ours
        return str(error.message)
    typed = _typed(error)
    name, choices = _name(error.param), _choices(error.param)
    given = name if typed is None else f"{name} {typed!r}"
    if choices:
        listed = " or ".join(filter(None, (", ".join(choices[:-1]), choices[-1])))
        return f"{given} is unknown: give {listed}"
    return f"{given} is not a value that it takes"


def _typed(error: Any) -> str | None:
    """Find the value that was typed: in the cause, or else between quotation marks."""
    listed: list[Any] = getattr(error.__cause__, "errors", list)()
    found = listed[0].get("input") if listed else None
    return found if isinstance(found, str) else _quoted(error.message)


def _quoted(text: str) -> str | None:
    found = re.search(r"'(.*?)'", text)
    return found[1] if found else None


def _choices(param: Any) -> Sequence[str]:
    holder = getattr(param, "type_descriptor", None) or getattr(param, "type", None)
    return [str(each) for each in getattr(holder, "choices", None) or ()]


def _name(param: Any) -> str:
    """Name an option by its longest form, an argument by its placeholder."""
    longest: str = max(param.opts, key=len)
    if longest.startswith("-"):
        return longest
    return str(param.metavar or longest.upper()).removesuffix("...")


def _usage(context: Any) -> str:
    """Show the command with its arguments, and the options that it needs."""
    names = [_name(each) + "..." * (each.nargs < 0) for each in _arguments(context)]
    others = [each for each in context.command.params if each not in _arguments(context)]
    needed = [f"{_name(each)} {each.metavar}" for each in others if each.required]
    return " ".join(["give", context.command_path, *names, *needed])


def _arguments(context: Any) -> list[Any]:
    return [each for each in context.command.params if each.param_type_name == "argument"]


def _similar(names: Sequence[str], known: Sequence[str] = ()) -> str:
    if names:
        return f": did you mean {' or '.join(names)}?"
    return f": give one of {', '.join(known)}" if known else ""
