"""Pages of the command line, made of what click knows of the commands."""

from __future__ import annotations

import re
from pathlib import Path

import click
from staging import put

from liftmesh.cli import exit_codes
from liftmesh.cli.application import COMMANDS, DEBUG, HELP, Command

MARKUP = re.compile(r"([\\`*_<>\[\]{}|#])")
OPTION = re.compile(r"(?<![\w-])(--?[a-z][a-z-]*)")


def put_commands(folder: Path) -> None:
    """Write a page for each command, and one that lists them."""
    commands = [Command(name) for name in COMMANDS]
    for command in commands:
        put(folder / f"{command.name}.md", page(command).encode())
    rows = [f"| [`{each.name}`]({each.name}.md) | {prose(each.short_help)} |" for each in commands]
    codes = [f"| {code} | {prose(text)} |" for code, text in exit_codes.MEANINGS.items()]
    parts = [
        "# Command line",
        prose(HELP),
        "Each command has a page, made of its help: `liftmesh COMMAND --help` shows the same.",
        "\n".join(["| command | what it does |", "| --- | --- |", *rows]),
        f"## Exit codes\n\n{prose(DEBUG)}",
        "\n".join(["| code | meaning |", "| ---: | --- |", *codes]),
        "\n".join(["```{toctree}", ":hidden:", "", *COMMANDS, "```"]),
    ]
    put(folder / "index.md", ("\n\n".join(parts) + "\n").encode())


def page(command: Command) -> str:
    """Return the page of a command."""
    context = click.Context(command, info_name=f"liftmesh {command.name}")
    usage = command.get_usage(context).removeprefix("Usage: ")
    parts = [f"# liftmesh {command.name}", f"```text\n{usage}\n```", prose(command.help)]
    for title, records in command.panels(context).items():
        parts.append(f"## {title}")
        parts += [f"`{name}`\n: {prose(text)}" for name, text in records]
    examples = "\n".join(re.findall(r"\$ (.*)", command.epilog or ""))
    parts.append(f"## Examples\n\n```sh\n{examples}\n```")
    return "\n\n".join(parts) + "\n"


def prose(text: str | None) -> str:
    """Return a help text as Markdown, with options as code."""
    return OPTION.sub(r"`\1`", MARKUP.sub(r"\\\1", " ".join((text or "").split())))
