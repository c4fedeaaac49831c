"""Files that a file names: only those in its own folder are read.

A glTF file may keep its numbers in other files. Whoever made it is not to be trusted with a choice
among all the files of this machine, nor with its network: names that lead out of the folder, by
``..``, from the root, through a link or to a server, are refused.
"""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path
from urllib.parse import unquote

from liftmesh.errors import FormatError


class Beside:
    """Reads files in the folder of ``name``, each once, and only those that were ``announced``."""

    def __init__(self, name: str, announced: Collection[str] = ()) -> None:
        self._name = name
        self._announced = announced
        self._contents: dict[str, bytes] = {}

    def __getitem__(self, wanted: str) -> bytes:
        if wanted not in self._announced:
            raise FormatError(f"{self._name}: {wanted[:60]!r} is none of its buffers")
        if wanted not in self._contents:
            self._contents[wanted] = self._path(wanted).read_bytes()
        return self._contents[wanted]

    def size(self, wanted: str) -> int:
        """Count the bytes of a file without reading it."""
        return self._path(wanted).stat().st_size

    def _path(self, wanted: str) -> Path:
        if not os.path.isfile(self._name):  # noqa: PTH113 - a name of a stream may hold any bytes
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is another file, and only a file has "
                "others beside it: give its path"
            )
        folder = Path(self._name).absolute().parent.resolve()
        try:
            path = (folder / unquote(wanted)).resolve()
            is_there = path.is_file()
        except (OSError, ValueError):  # no name that a file can have
            path, is_there = folder, False
        if "://" in wanted or not path.is_relative_to(folder):
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is not in its folder: put it there"
            )
        if not is_there:
            raise FormatError(f"{self._name}: its buffer {wanted[:60]!r} is not there")
        return path
