"""File formats: names, reader and writer, requirements, and what a file preserves.

A format declares what a cloud must have to be written (`Format.needs`) and which parts of a cloud
the file preserves (`Format.keeps`). `liftmesh.write` raises for a cloud that does not meet the
needs, and lists in `Written.dropped` what the cloud has and the file does not keep.

PLY and OBJ have no place for a coordinate system but comments: there it is ``crs`` and a JSON
string.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from liftmesh._typing import Floats
from liftmesh.arrays import used_rows
from liftmesh.cloud import Cloud, is_crs
from liftmesh.errors import FormatError, InputError
from liftmesh.io.colors import fits_eight_bits, is_opaque

Origin: TypeAlias = tuple[float, float, float]
Reader: TypeAlias = Callable[..., Cloud]  # (stream, name), and max_bytes= if the format expands
ChunkReader: TypeAlias = Callable[..., Iterator[Cloud]]  # (stream, name, rows), and the same
Writer: TypeAlias = Callable[..., Origin | None]
Losses: TypeAlias = Callable[[Cloud, Mapping[str, Any]], Collection[str]]

_CRS = "crs "  # begins the comment that states a coordinate system

NEEDS = ("points", "faces", "finite")

# The parts of a cloud that a file may keep, and the name of each in `Written.dropped`.
CONTENT = {
    "points": "rows in no face",
    "faces": "faces",
    "colors": "colors",
    "alpha": "alpha",
    "deep_colors": "colors beyond 8 bits",
    "normals": "normals",
    "attributes": "attributes",
    "crs": "crs",
    "float64": "double precision",
}


@dataclass(frozen=True, slots=True)
class Format:
    """A file format; packages register one to add a format.

    Parameters
    ----------
    name : str
        Short name, as accepted by ``format=`` in :func:`liftmesh.read` and :func:`liftmesh.write`.
    suffixes : tuple of str
        Suffixes in lower case with their dot, the usual one first.
    read : callable or None
        ``read(stream, name) -> Cloud``: ``stream`` is binary and seekable, ``name`` is the file's
        name for messages. None if the format cannot be read.
    write : callable or None
        ``write(stream, cloud, **options)``: ``stream`` is binary. It returns None, or the origin
        (x, y, z) that was subtracted from every vertex. None if the format cannot be written.
    description : str
        One line for people.
    keeps : tuple of str
        The parts of a cloud that the file preserves: "points" (every row in its place, including
        rows in no face), "faces", "colors" (with 8 bits per channel), "alpha", "deep_colors"
        (colours of more than 8 bits), "normals" (directions, in single precision at least),
        "attributes" (named values; the format may split an (n, k) attribute into k columns),
        "crs", "float64" (every coordinate bit for bit). By default all of them.
    needs : tuple of str
        The requirements on a cloud: "points" (at least one row), "faces" (at least one), "finite"
        (no NaN or infinity in a row that the file holds). By default none.
    loses : callable, optional
        ``loses(cloud, options)`` returns the parts in ``keeps`` that are nevertheless lost when
        this cloud is written with these options.
    read_chunks : callable, optional
        ``read_chunks(stream, name, rows)`` yields clouds of at most ``rows`` consecutive rows each,
        without faces; together they are the rows that ``read`` returns. Formats without it are read
        whole, then split.
    expands : bool
        Whether a file can take far more memory than its bytes: compressed, by repetition, or for
        many columns. Then ``read`` and ``read_chunks`` take ``max_bytes=``: the limit in bytes of
        what it may expand to, or None for the format's own.
    suffix_options : mapping, optional
        Options for ``write`` that a suffix stands for, by suffix; those of the caller come first.

    Raises
    ------
    InputError
        ``keeps`` or ``needs`` holds an unknown word.

    Examples
    --------
    >>> import numpy as np
    >>> def read_pairs(stream, name):
    ...     return Cloud(np.loadtxt(stream, ndmin=2))
    >>> pairs = Format("pairs", (".pairs",), read_pairs, None, "three numbers a line")
    >>> pairs.write is None
    True
    """

    name: str
    suffixes: tuple[str, ...]
    read: Reader | None
    write: Writer | None
    description: str
    keeps: tuple[str, ...] = tuple(CONTENT)
    needs: tuple[str, ...] = ()
    loses: Losses | None = None
    read_chunks: ChunkReader | None = None
    expands: bool = False
    suffix_options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, words, known in (
            ("keeps", self.keeps, tuple(CONTENT)),
            ("needs", self.needs, NEEDS),
        ):
            unknown = [word for word in words if word not in known]
            if unknown:
                raise InputError(
                    f"{name} of the format {self.name!r} holds {unknown[0]!r}: "
                    f"known are {', '.join(known)}"
                )


def check_needs(found: Format, cloud: Cloud) -> None:
    """Raise if a cloud does not meet the format's needs: the file would be incomplete or invalid.

    Raises
    ------
    FormatError
        There are no points, no faces, or a coordinate is not finite; the message names the row.
    """
    if "points" in found.needs and not len(cloud):
        raise FormatError(
            f"a cloud without points cannot be written as {found.name.upper()}: write PLY or NPZ"
        )
    if "faces" in found.needs and (cloud.faces is None or not len(cloud.faces)):
        raise FormatError(
            f"a cloud without faces cannot be written as {found.name.upper()}: write PLY"
        )
    if "finite" in found.needs:
        _check_finite(found, cloud)


def dropped(
    found: Format, cloud: Cloud, options: Mapping[str, Any], origin: Origin | None
) -> tuple[str, ...]:
    """List what a cloud has and its file does not keep, attributes by name."""
    kept = set(found.keeps)
    if found.loses is not None:
        kept -= set(found.loses(cloud, options))
    if "colors" not in kept:
        kept |= {"alpha", "deep_colors"}  # covered by "colors"
    missing = [name for word, name in CONTENT.items() if word not in kept and _has(cloud, word)]
    if "float64" not in kept and not _fits_single(_held(found, cloud), origin):
        missing.append(CONTENT["float64"])
    if "attributes" in missing:
        at = missing.index("attributes")
        missing[at : at + 1] = sorted(cloud.attributes)
    return tuple(missing)


def _has(cloud: Cloud, word: str) -> bool:
    """Whether a cloud has a part that could be lost."""
    colors = cloud.colors
    if word == "points":
        return _has_unused_rows(cloud)
    if word == "float64":
        return False  # its coordinates decide, relative to the origin of the file
    if word == "alpha":
        return colors is not None and not is_opaque(colors)
    if word == "deep_colors":
        return colors is not None and not fits_eight_bits(colors)
    if word == "attributes":
        return len(cloud.attributes) > 0
    return getattr(cloud, word) is not None


def _held(found: Format, cloud: Cloud) -> Floats:
    """The points that a file holds: all, or those of the faces."""
    if "points" in found.keeps or cloud.faces is None:
        return cloud.points
    return cloud.points.take(used_rows(len(cloud), cloud.faces), axis=0)


def _has_unused_rows(cloud: Cloud) -> bool:
    return cloud.faces is None or len(used_rows(len(cloud), cloud.faces)) < len(cloud)


def _fits_single(points: Floats, origin: Origin | None) -> bool:
    """Whether all coordinates, relative to an origin, round-trip through single precision."""
    shift = np.zeros(3) if origin is None else np.array(origin)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        again = (points - shift).astype(np.float32).astype(np.float64) + shift
    return np.array_equal(again, points, equal_nan=True)


def _check_finite(found: Format, cloud: Cloud) -> None:
    held = _held(found, cloud)
    bad = ~np.isfinite(held).all(axis=1)
    if bad.any():
        row = int(np.argmax(bad))
        if cloud.faces is not None and len(held) < len(cloud):
            row = int(used_rows(len(cloud), cloud.faces)[row])
        raise FormatError(
            f"vertex {row} is {cloud.points[row].tolist()}: {found.name} holds finite coordinates "
            "only: remove such rows, or write PLY or OBJ"
        )


def crs_comment(crs: str | None) -> list[str]:
    """Comments that state a coordinate system: one, in ASCII whatever the text holds, or none.

    >>> crs_comment("EPSG:25832")
    ['crs "EPSG:25832"']
    """
    return [] if crs is None else [_CRS + json.dumps(crs)]


def stated_crs(comments: Iterable[str]) -> str | None:
    """The coordinate system that comments state; None for comments that only look alike.

    >>> stated_crs(["liftmesh", 'crs "EPSG:25832"'])
    'EPSG:25832'
    """
    found = (_crs(comment) for comment in comments if comment.startswith(_CRS))
    return next((crs for crs in found if crs is not None), None)


def _crs(comment: str) -> str | None:
    try:
        crs = json.loads(comment.removeprefix(_CRS))
    except (ValueError, RecursionError):
        return None
    return crs if is_crs(crs) else None
