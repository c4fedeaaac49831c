"""Messages in the words of the command line: of wrong usage, and of what the library raises.

*Wrong usage.* The words of click change from version to version: here, the type of an exception
and what it concerns decide; its text serves only to find what was typed.

*Options.* The library names its own options in what it raises: ``band=`` becomes ``--band``. A name
counts where it begins a word, so that folders such as ``tiles/band=2`` stay as they are.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any

_OPTION_NAMES = (
    "algorithm", "band", "by", "cell", "classes", "color_depth", "columns", "decimal", "delimiter",
    "dst_crs", "encoding", "end", "flat", "interpolation", "nodata", "nonfinite",
    "on_duplicate", "plane", "point_format", "scale", "skip_rows", "src_crs", "unit",
    "z_factor",
)  # fmt: skip
_PHRASES = {
    "liftmesh.triangulate(cloud, plane='fit')": "--plane fit",
    "with format='raster'": "with --input-format raster",
    "with format=": "with --input-format FORMAT",
    "with crs=": "with --src-crs",
    "with max_bytes=": "with --max-bytes SIZE",
    "neighbors=True, resume=False": "--neighbors --restart",
    "resume=False": "--restart",
    "with neighbors ": "with --neighbors ",
    "with nonfinite '": "with --nonfinite '",
    "with on_duplicate '": "with --on-duplicate '",
    "with shard_format '": "with --shards '",
    "with tile_rows ": "with --tile-rows ",
    "fewer tile_rows": "fewer --tile-rows",
    "dtype='float64'": "--double",
    "find the ground with classify_ground": "find the ground with triangulate --ground csf",
    "flat=True": "--flat",
    "read one with dst_crs= that of the other, or replace(crs=None) if they are the same": (
        "give --dst-crs, which transforms both"
    ),
    "give one of None, ": "give one of none, ",
    "classes='all'": "--all-classes",
}
_SUBJECTS = (
    "adaptive", "cell", "compress", "interval", "length", "max_deviation", "max_points",
    "min_distance", "point_format", "raster_bounds", "resolution",
)  # fmt: skip
_OF_READING = {"format": "input_format", "header": "no_header", "polygon": "trim_polygon"}
_OTHER_NAMES = {"length": "min_length"}
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
    typed = _quoted(text)
    if typed is None or not hasattr(context.command, "list_commands"):
        return text
    known = context.command.list_commands(context)
    return f"there is no command {typed!r}{_similar(get_close_matches(typed, known), known)}"


def _about_value(error: Any) -> str:
    """Describe a value that an option does not have."""
    if error.param is None:  # of several options
        return str(error.message)
    if type(error).__name__ == "WrongValue":  # ours
        return f"{error.param_hint or _name(error.param)} {error.message}"
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


def of_reading(name: str) -> str:
    """Return the option of the command line for one of `liftmesh.read`."""
    return f"--{_OF_READING.get(name, _OTHER_NAMES.get(name, name)).replace('_', '-')}"


def as_on_command_line(message: str) -> str:
    """Replace Python options in a message by those of the command line."""
    for phrase, words in _PHRASES.items():
        message = message.replace(phrase, words)
    message = re.sub(r"\bdst_crs=(?=['\"])", "--dst-crs ", message)  # quotes are the shell's too
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
