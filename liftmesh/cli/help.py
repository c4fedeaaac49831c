"""The text of ``--help``: usage, what a command does, and boxes of its arguments and options.

typer draws such boxes with rich, whose import takes longer than typer's. Here a name that leaves
too little room for its description has a line of its own.
"""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterable, Iterator
from textwrap import wrap
from typing import Any, TypeAlias

import typer

from liftmesh.cli import terminal

Row: TypeAlias = tuple[str, str]  # a name, and what it means

_WIDEST = 120  # longer lines are hard to read
_LONGEST_NAME = 26
_ROUND, _PLAIN = ("╭─╮", "│", "╰─╯"), ("+-+", "|", "+-+")
_REMARK = re.compile(r"\[[^\[\]]*\]$")  # [default: xy]
_FIXED = "\N{NO-BREAK SPACE}"
_OPTION = re.compile(r"(?<![\w-])--?[a-z][\w-]*")


def write_help(command: Any, context: Any, formatter: Any) -> None:
    """Write the help of a command, in colour on a terminal.

    Parameters
    ----------
    command : typer's command or group
        The command.
    context : typer's context
        Its context.
    formatter : typer's formatter
        Gets the text.
    """
    context.color = terminal.is_colored(sys.stdout)
    page = _Page(min(shutil.get_terminal_size().columns, _WIDEST), in_color=context.color)
    usage = " ".join(command.collect_usage_pieces(context))
    page.add_usage(f"{context.command_path} {usage}")
    page.add_text(command.help or "")
    for title, rows in _boxes(command, context):
        page.add_box(title, rows)
    page.lines.append("")
    for paragraph in (command.epilog or "").split("\n\n"):
        page.add_list(paragraph)
    formatter.write("\n".join(page.lines) + "\n")


def _boxes(command: Any, context: Any) -> Iterator[tuple[str, list[Row]]]:
    """Yield the arguments, options and commands that there are."""
    parameters = command.get_params(context)
    for kind in ("argument", "option"):
        of_kind = (each for each in parameters if each.param_type_name == kind)
        rows = [record for each in of_kind if (record := each.get_help_record(context))]
        if rows:
            yield f"{kind.capitalize()}s", rows
    names = command.list_commands(context) if hasattr(command, "list_commands") else ()
    commands = [(name, command.get_command(context, name).short_help) for name in names]
    if commands:
        yield "Commands", commands


class _Page:
    """Lines of text, each as wide as the terminal at most."""

    def __init__(self, width: int, *, in_color: bool) -> None:
        self.lines: list[str] = [""]
        self._width = max(width, 2 * _LONGEST_NAME)
        self._in_color = in_color
        self._frame = _ROUND if _can_print("".join(_ROUND)) else _PLAIN

    def add_usage(self, words: str) -> None:
        self.lines += [f" {self._in('Usage:', fg='yellow', bold=True)} {words}", ""]

    def add_text(self, text: str) -> None:
        self.lines += [*(f" {line}" for line in _wrapped(text, self._width - 2)), ""]

    def add_list(self, text: str) -> None:
        """Add a title and the indented lines below it, or a sentence."""
        first, *rest = text.split("\n")
        title = self._in(first, bold=True) if rest else self._marked(first)
        self.lines += [f" {title}", *(f" {line}" for line in rest), ""]

    def add_box(self, title: str, rows: Iterable[Row]) -> None:
        above, edge, below = self._frame
        line, side = above[1], self._in(edge, dim=True)
        rest = line * (self._width - len(title) - 5)
        self.lines.append(self._in(f"{above[0]}{line} {title} {rest}{above[2]}", dim=True))
        self.lines += [f"{side} {content} {side}" for content in self._contents(list(rows))]
        self.lines.append(self._in(f"{below[0]}{line * (self._width - 2)}{below[2]}", dim=True))

    def _contents(self, rows: list[Row]) -> Iterator[str]:
        """Yield the lines of a box: names, and descriptions beside or below them."""
        room = max((len(name) for name, _ in rows if len(name) <= _LONGEST_NAME), default=0)
        width = self._width - 4
        for name, text in rows:
            described = _wrapped(text, width - room - 2)
            beside = name
            if len(name) > room:
                yield from (self._name(line, width) for line in wrap(name, width))
                beside = ""
            for line in described:
                yield f"{self._name(beside, room)}  {line.ljust(width - room - 2)}"
                beside = ""

    def _name(self, name: str, width: int) -> str:
        return self._in(name.ljust(width), fg="cyan", bold=True)

    def _marked(self, text: str) -> str:
        return _OPTION.sub(lambda found: self._in(found[0], fg="cyan", bold=True), text)

    def _in(self, text: str, **style: Any) -> str:
        return typer.style(text, **style) if self._in_color and text.strip() else text


def _wrapped(text: str, width: int) -> list[str]:
    """Wrap a description, but neither its options nor what follows it in brackets."""
    fixed = _REMARK.sub(lambda found: found[0].replace(" ", _FIXED), text)
    return [line.replace(_FIXED, " ") for line in wrap(fixed, width, break_on_hyphens=False)]


def _can_print(text: str) -> bool:
    try:
        text.encode(sys.stdout.encoding or "ascii")
    except UnicodeEncodeError:
        return False
    return True
