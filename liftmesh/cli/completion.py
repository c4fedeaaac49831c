"""``--show-completion`` and ``--install-completion``, for the shell that is named or runs liftmesh.

typer has these options, and their help. But its own take no name: ``--show-completion zsh`` would
print the script of the shell at hand, and a shell that has none gets another exit code.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import typer

SHELLS = ("bash", "zsh", "fish", "powershell", "pwsh")
_PROGRAM = {"prog_name": "liftmesh", "complete_var": "_LIFTMESH_COMPLETE"}


def complete(option: str, names: Sequence[str]) -> None:
    """Print the script that completes commands in a shell, or install it."""
    shell = names[0] if names else _detected()
    if len(names) > 1 or shell not in SHELLS:
        said = " ".join(names) or shell or "a shell that is not known"
        raise typer.BadParameter(
            f"there is no completion for {said}: give liftmesh {option} SHELL, with one of "
            f"{', '.join(SHELLS)}"
        )
    scripts: Any = import_module("typer.completion")
    if option == "--show-completion":
        typer.echo(scripts.get_completion_script(shell=shell, **_PROGRAM))
    else:
        _, path = scripts.install(shell=shell, **_PROGRAM)
        typer.echo(f"{path}: completion for {shell}, in terminals that are opened from now on")


def _detected() -> str | None:
    """Return the name of the shell that runs the program."""
    shells: Any = import_module("shellingham")
    try:
        name: str = shells.detect_shell()[0]
    except shells.ShellDetectionFailure:
        return None
    return name
