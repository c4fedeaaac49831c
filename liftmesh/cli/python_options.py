"""Messages of the library in the words of the command line: ``--band`` for ``band=``.

The library names its own options in what it raises. A name counts where it begins a word, so that
folders such as ``tiles/band=2`` stay as they are.
"""

from __future__ import annotations

import re
import shlex

_NAMES = (
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
_NAME = rf"(?P<name>{'|'.join(_NAMES)})="
_QUOTED = re.compile(rf"(?<![^\s(]){_NAME}'(?P<value>[^']*)'")
_NUMBER = re.compile(rf"(?<=[\s(]){_NAME}(?P<value>[-+.\w]*\w)(?![-+.\w/])")
_BARE = re.compile(rf"(?<![^\s(]){_NAME}(?=[\s,;:)]|$)")
_SUBJECT = re.compile(rf"(?:^|(?<=: ))(?P<subject>{'|'.join(_SUBJECTS)}) (is|are) ")


def of_reading(name: str) -> str:
    """Return the option of the command line for one of `liftmesh.read`.

    Parameters
    ----------
    name : str
        The option of `liftmesh.read`.

    Returns
    -------
    str
        With its dashes.

    Examples
    --------
    >>> of_reading("skip_rows"), of_reading("crs"), of_reading("header")
    ('--skip-rows', '--from-crs', '--no-header')
    """
    return _option(_OF_READING.get(name, name))


def as_on_command_line(message: str) -> str:
    """Replace Python options in a message by those of the command line.

    Parameters
    ----------
    message : str
        A message of the library.

    Returns
    -------
    str
        The message for people who gave options to a command.

    Examples
    --------
    >>> as_on_command_line("coordinates are degrees: transform them with to_crs=")
    'coordinates are degrees: transform them with --to-crs'
    >>> as_on_command_line("more than 32 bits in steps of scale=1e-09: give a larger one")
    'more than 32 bits in steps of --scale 1e-09: give a larger one'
    """
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
