"""Symbolic links that lead in a circle, so that no file is at their end."""

from __future__ import annotations

import errno
import os

from liftmesh.errors import FormatError


def check_links(path: str | os.PathLike[str]) -> None:
    """Raise if the links on the way to a file lead in a circle."""
    try:
        os.stat(path)  # noqa: PTH116 - Path has no other way to tell this error from others
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise FormatError(
                f"{os.fspath(path)}: its symbolic links lead in a circle, and to no file: "
                "give another name, or remove them"
            ) from error
        if error.errno is None:  # not the system's: a time limit that a handler raises
            raise
    except ValueError:  # no name that a file can have, which opening it reports
        return
