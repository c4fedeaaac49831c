"""Which formats exist, and which one a file name or a ``format=`` asks for.

The formats of this package come first; then those that other installed packages register as
entry points of the group ``liftmesh.formats``. The name of such an entry point is the suffix it
serves, without the dot, and its object is a :class:`Format`: a package is imported only when its
suffix is asked for, so that a broken one disturbs nobody else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from liftmesh.errors import FormatError
from liftmesh.io import numpy_files, obj, off, ply, text, trimesh_files
from liftmesh.io.format import Format

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

__all__ = ["Format", "find_format", "known_formats"]

GROUP = "liftmesh.formats"

BUILT_IN: tuple[Format, ...] = (
    ply.FORMAT,
    obj.FORMAT,
    text.FORMAT,
    numpy_files.NPY,
    numpy_files.NPZ,
    off.FORMAT,
    *trimesh_files.FORMATS,
)


def known_formats() -> dict[str, Format]:
    """List every format by name, those of other packages included.

    Returns
    -------
    dict of str to Format
        A plugin that cannot be loaded is listed too: it has neither reader nor writer, and its
        description says why.

    Examples
    --------
    >>> known_formats()["ply"].suffixes
    ('.ply',)
    """
    plugins = {entry.name.lower(): _listed(entry) for entry in reversed(_entries())}
    return plugins | {each.name: each for each in BUILT_IN}


def find_format(wanted: str, name: str) -> Format:
    """Find a format by its name or suffix, with or without the dot, in any case.

    Parameters
    ----------
    wanted : str
        Name or suffix.
    name : str
        The file's name for messages.

    Returns
    -------
    Format
        The format of that name, else the one that serves that suffix.

    Raises
    ------
    FormatError
        No format serves it, or the plugin that does cannot be loaded.

    Examples
    --------
    >>> find_format(".CSV", "points.csv").name
    'text'
    """
    key = wanted.lower().removeprefix(".")
    for built_in in BUILT_IN:
        if key == built_in.name or f".{key}" in built_in.suffixes:
            return built_in
    for entry in _entries():
        if entry.name.lower() == key:
            return _load(entry)
    raise FormatError(f"{name}: {_unknown(key)}; known are {', '.join(_suffixes())}")


def _unknown(key: str) -> str:
    if not key:
        return "the name has no suffix to tell the format by: give format="
    return f"no format is known by the suffix or name {key!r}"


def _suffixes() -> list[str]:
    own = {suffix for each in BUILT_IN for suffix in each.suffixes}
    return sorted(own | {f".{entry.name.lower()}" for entry in _entries()})


def _entries() -> list[EntryPoint]:
    """Sort the plugins, so that of two that serve one suffix the same one wins everywhere."""
    from importlib.metadata import entry_points  # noqa: PLC0415 - slow, and seldom needed

    return sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, entry.value))


def _load(entry: EntryPoint) -> Format:
    try:
        loaded = entry.load()
    except Exception as error:
        raise FormatError(
            f"the plugin {entry.value!r} for {entry.name!r} files cannot be loaded "
            f"({type(error).__name__}: {error}): repair or uninstall its package"
        ) from error
    if not isinstance(loaded, Format):
        raise FormatError(
            f"the plugin {entry.value!r} for {entry.name!r} files is a {type(loaded).__name__}, "
            "not a liftmesh.Format: repair or uninstall its package"
        )
    return loaded


def _listed(entry: EntryPoint) -> Format:
    try:
        return _load(entry)
    except FormatError as error:
        return Format(entry.name, (f".{entry.name.lower()}",), None, None, str(error))
