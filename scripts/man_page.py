"""Write the manual page of the command, made of its help: ``python scripts/man_page.py FILE``.

Packages for systems install it as ``share/man/man1/liftmesh.1``; ``man -l FILE`` shows it. Shells
complete by what ``liftmesh --show-completion SHELL`` prints.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from liftmesh import __version__
from liftmesh.cli.application import COMMANDS, HELP, Program


class Roff(click.HelpFormatter):
    """What click shows of a command, in the language of manual pages."""

    def write_usage(self, prog: str, args: str = "", prefix: str | None = None) -> None:
        """Write how the command is called."""
        del prefix
        self.write(f".PP\n\\fB{escaped(prog)}\\fR {escaped(args)}\n")

    def write_heading(self, heading: str) -> None:
        """Write the name of a panel of options."""
        self.write(f".SS {escaped(heading)}\n")

    def write_paragraph(self) -> None:
        """Write nothing: paragraphs begin with what they hold."""

    def write_text(self, text: str) -> None:
        """Write paragraphs, and as they stand those that click does not wrap."""
        for paragraph in text.split("\n\n"):
            if paragraph.startswith("\b\n"):
                self.write(f".PP\n.nf\n{escaped(paragraph[2:])}\n.fi\n")
            elif paragraph.strip():
                self.write(f".PP\n{escaped(' '.join(paragraph.split()))}\n")

    def write_dl(self, rows: Sequence[tuple[str, str]], *_: int) -> None:
        """Write options, or commands, each with its text."""
        for name, text in rows:
            self.write(f".TP\n\\fB{escaped(name)}\\fR\n{escaped(' '.join(text.split()))}\n")


def escaped(text: str) -> str:
    """Return a text without what roff takes for its own."""
    plain = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^(?=[.'])", r"\\&", plain, flags=re.MULTILINE)


def manual() -> str:
    """Return the page: the program, then each command."""
    program, roff = Program(), Roff()
    summary = HELP.partition(":")[0]
    roff.write(f'.TH LIFTMESH 1 "" "liftmesh {__version__}" "User Commands"\n')
    roff.write(f".SH NAME\nliftmesh \\- {escaped(summary)}\n.SH SYNOPSIS\n")
    context = click.Context(program, info_name="liftmesh")
    program.format_help(context, roff)
    for name in COMMANDS:
        command = program.get_command(context, name)
        assert command is not None
        roff.write(f'.SH "LIFTMESH {escaped(name.upper())}"\n')
        command.format_help(click.Context(command, info_name=name, parent=context), roff)
    return roff.getvalue()


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(manual(), "utf-8")
