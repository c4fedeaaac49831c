"""Messages in the words of the command line: of wrong usage, and of what the library raises.

*Wrong usage.* The words of typer, and of the libraries that it uses, change from version to
version: here, the type of an exception and what it concerns decide; its text serves only to find
what was typed.

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
"""The name of any option for the parsers of values: typer knows which one it is."""

_OTHERS: dict[str | Option, str] = {
    VARIABLE: VARIABLE,
    "crs": "--from-crs",
    "distance": "--min-distance",
    "format": "--from",
    "length": "--min-length",
    Option("classify_ground"): "triangulate --ground csf",
    Option("dtype", "float64"): "--double",
    Option("header", False): "--no-header",
    Option("resume", False): "--anew",
}
"""How the command line names what has another name in the library, or is given in another way."""

_OPTION_NAMES = (
    "band", "by", "cell", "classes", "color_depth", "columns", "decimal", "delimiter", "duplicates",
    "encoding", "end", "flat", "method", "nodata", "nonfinite", "plane", "point_format", "scale",
    "skip_rows", "to_crs", "unit", "z_factor",
)  # fmt: skip
_PHRASES = {
    "liftmesh.triangulate(cloud, plane='fit')": "--plane fit",
    "with format='raster'": "with --from raster",
    "with format=": "with --from FORMAT",
    "with max_bytes=": "with --max-bytes SIZE",
    "with crs=": "with --from-crs",
    "to_crs= or crs=": "--to-crs or --from-crs",
    "neighbors=True, resume=False": "--neighbors --anew",
    "resume=False": "--anew",
    "with neighbors ": "with --neighbors ",
    "with nonfinite '": "with --nonfinite '",
    "with shard_format '": "with --shards '",
    "with tile_rows ": "with --tile-rows ",
    "fewer tile_rows": "fewer --tile-rows",
    "dtype='float64'": "--double",
    "find the ground with classify_ground": "find the ground with triangulate --ground csf",
    "flat=True": "--flat",
    "read one with to_crs= that of the other, or replace(crs=None) if they are the same": (
        "give --to-crs, which transforms both"
    ),
    "give one of None, ": "give one of none, ",
}
_SUBJECTS = (
    "adaptive", "bounds", "cell", "compress", "distance", "interval", "length", "max_points",
    "point_format", "resolution",
)  # fmt: skip
_OF_READING = {"crs": "from_crs", "header": "no_header"}
_OTHER_NAMES = {"distance": "min_distance", "length": "min_length"}
_OPTION_NAME = rf"(?P<name>{'|'.join(_OPTION_NAMES)})="
_QUOTED = re.compile(rf"(?<![^\s(]){_OPTION_NAME}'(?P<value>[^']*)'")
_NUMBER = re.compile(rf"(?<=[\s(]){_OPTION_NAME}(?P<value>[-+.\w]*\w)(?![-+.\w/])")
_BARE = re.compile(rf"(?<![^\s(]){_OPTION_NAME}(?=[\s,;:)]|$)")
_SUBJECT = re.compile(rf"(?:^|(?<=: ))(?P<subject>{'|'.join(_SUBJECTS)}) (is|are) ")


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


def worded(message: str) -> str:
    """Name the options in a message as the command line does."""
    parts = Message(message).parts
    return "".join(
        as_on_command_line(each) if isinstance(each, str) else spelled(each) for each in parts
    )


def spelled(option: Option) -> str:
    """Write an option as a shell takes it, with its value if it has one."""
    name, value = option
    if option in _OTHERS:
        return _OTHERS[option]
    spelled_name = _OTHERS.get(name) or (
        name if name.startswith("-") else f"--{name.replace('_', '-')}"
    )
    if value is None or value is ... or value is True:
        return spelled_name
    return f"{spelled_name} {shlex.quote(str(value))}"


def as_on_command_line(message: str) -> str:
    """Replace Python options in a message by those of the command line."""
    for phrase, words in _PHRASES.items():
        message = message.replace(phrase, words)
    message = re.sub(r"\bto_crs=(?=['\"])", "--to-crs ", message)  # the quotes are the shell's too
    for pattern in (_QUOTED, _NUMBER, _BARE):
        message = pattern.sub(_as_option, message)
    return _SUBJECT.sub(lambda found: f"{_option(found['subject'])} {found[2]} ", message)


def _as_option(found: re.Match[str]) -> str:
    """Write an option as a shell takes it, with its value if it has one."""
    value = found.groupdict().get("value")
    option = _option(found["name"])
    return option if value is None else f"{option} {shlex.quote(value)}"


def _option(name: str) -> str:
    return f"--{_OTHER_NAMES.get(name, name).replace('_', '-')}"
