"""Messages in the words of the command line: of wrong usage, and of what the library raises.

*Wrong usage.* The words of click change from version to version: here, the type of an exception
and what it concerns decide; its text serves only to find what was typed.

*Options.* Messages of the library say where they name options: ``band=`` becomes ``--band``. Most
options of commands have the names of the library's; `_OTHERS` has the rest.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any

from liftmesh.base.options import VARIABLE
from liftmesh.errors import InputError, Message, Option

VALUE = "value"
"""The name of any option for the parsers of values: click knows which one it is."""

_OTHERS: dict[str | Option, str] = {
    VARIABLE: VARIABLE,
    "format": "--input-format",
    "header": "--no-header",
    "length": "--min-length",
    "polygon": "--trim-polygon",
    "resume": "--restart",
    "shard_format": "--shards",
    Option("classes", "all"): "--all-classes",
    Option("classify_ground"): "triangulate --ground csf",
    Option("constrained_delaunay"): "liftmesh constrain",
    Option("dtype", "float64"): "--double",
}
"""How the command line names what has another name in the library, or is given in another way."""


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
    typed = _quoted(text)
    if typed is None or not hasattr(context.command, "list_commands"):
        return text
    known = context.command.list_commands(context)
    return f"there is no command {typed!r}{_similar(get_close_matches(typed, known), known)}"


def _about_value(error: Any) -> str:
    """Describe a value that an option does not have."""
    if error.param is None or isinstance(error.__cause__, InputError):  # ours
        named = {} if error.param is None else {VALUE: _name(error.param)}
        return worded(Message(error.message).renamed(named))
    typed = _quoted(error.message)
    name, choices = _name(error.param), _choices(error.param)
    given = name if typed is None else f"{name} {typed!r}"
    if choices:
        listed = " or ".join(filter(None, (", ".join(choices[:-1]), choices[-1])))
        return f"{given} is unknown: give {listed}"
    return f"{given} is not a value that it takes"


def _quoted(text: str) -> str | None:
    quoted = re.search(r"'(.*?)'", text)
    return quoted[1] if quoted else None


def _choices(param: Any) -> Sequence[str]:
    return [str(each) for each in getattr(getattr(param, "type", None), "choices", None) or ()]


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


def worded(message: str) -> str:
    """Name the options in a message as the command line does."""
    parts = Message(message).parts
    return "".join(each if isinstance(each, str) else spelled(each) for each in parts)


def spelled(option: Option) -> str:
    """Write an option as a shell takes it, with its value if it has one."""
    name, value = option
    if option in _OTHERS:
        return _OTHERS[option]
    spelled_name = _OTHERS.get(name) or (
        name if name.startswith("-") else f"--{name.replace('_', '-')}"
    )
    if value is None or value is ... or isinstance(value, bool):
        return spelled_name
    return f"{spelled_name} {shlex.quote(str(value))}"
