"""`Format`: a file format's names, reader and writer, what it needs, and what its files preserve.

A format declares what a cloud must have to be written (`Format.needs`) and which parts of a cloud
the file preserves (`Format.keeps`). `liftmesh.write` raises for a cloud that does not meet the
needs, and lists in `WriteResult.dropped` what the cloud has and the file does not keep.

What is known of a format stands in a table, and its code in a module of its own, which is imported
at the first call (`LazyFunction`): a command that reads a PLY file loads no other reader.

*Single precision.* A float has 24 bits: at 5,200,000 m its steps are half a metre. If rounding the
coordinates along an axis would move a vertex by more than a millionth of the model's size, an
origin near the smallest coordinate is subtracted first: a round number, a multiple of one unit, or
of a power of ten for models smaller than one unit. x and y get it together: both are of one map,
where a small easting next to a large northing would else be rounded far more than the northing. The
file records the origin, and its reader adds it again.

*Whole numbers.* Whether doubles hold them exactly is decided in whole numbers: converting there and
back does not tell, since 2**63 - 1 becomes the double 2**63, which is beyond the type, and what
that becomes depends on the machine.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from importlib import import_module
from typing import Any, TypeAlias, TypeVar

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import check_colors, fits_eight_bits, is_opaque
from liftmesh.base.interruption import defer_signals
from liftmesh.base.options import shown
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io import metadata
from liftmesh.io.markup import finite_numbers, shown_json
from liftmesh.io.metadata import noted

Reader: TypeAlias = Callable[..., Cloud]  # (stream, name), and max_bytes= if the format expands
ChunkReader: TypeAlias = Callable[..., Iterator[Cloud]]  # (stream, name, rows), and the same
Origin: TypeAlias = tuple[float, float, float]
Found: TypeAlias = Origin | frozenset[str] | None  # by a writer
Writer: TypeAlias = Callable[..., Found]
Losses: TypeAlias = Callable[[Cloud, Mapping[str, Any]], Collection[str]]

Read = TypeVar("Read")

NEEDS = ("points", "faces", "finite")

# The parts of a cloud that a file may keep, and the name of each in `WriteResult.dropped`.
CONTENT = {
    "points": "rows in no face",
    "faces": "faces",
    "edges": "edges",
    "colors": "colors",
    "alpha": "alpha",
    "deep_colors": "colors beyond 8 bits",
    "normals": "normals",
    "attributes": "attributes",
    "crs": "crs",
    "metadata": "metadata",
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
        (x, y, z) that was subtracted from every vertex, or a frozenset of what `loses` would have
        to find out again. None if the format cannot be written.
    description : str
        One line for people.
    keeps : tuple of str
        The parts of a cloud that the file preserves: "points" (every row in its place, including
        rows in no face), "faces", "edges", "colors" (with 8 bits per channel), "alpha",
        "deep_colors" (colours of more than 8 bits), "normals" (directions, in single precision at
        least),
        "attributes" (named values; the format may split an (n, k) attribute into k columns),
        "crs", "metadata" (every entry that JSON holds, but none that a reader noted of its file),
        "float64" (every coordinate bit for bit). By default all of them.
    needs : tuple of str
        The requirements on a cloud: "points" (at least one row), "faces" (at least one), "finite"
        (no NaN or infinity in a row that the file holds). By default none.
    loses : callable, optional
        ``loses(cloud, options)`` returns the parts in ``keeps`` that are nevertheless lost when
        this cloud is written with these options, and any other text to add to
        `WriteResult.dropped`.
    read_chunks : callable, optional
        ``read_chunks(stream, name, rows)`` yields clouds of at most ``rows`` consecutive rows each,
        without faces; together they are the rows that ``read`` returns. Formats without it are read
        whole, then split.
    expands : bool
        Whether a file can take far more memory than its bytes: compressed, by repetition, or for
        many columns. Then ``read`` and ``read_chunks`` take ``max_bytes=``: the limit in bytes of
        what it may expand to, or None for the format's own.
    options : callable, optional
        Checks the options that callers give to :func:`liftmesh.read` besides: ``options(**given)``
        returns what ``read`` and ``read_chunks`` then take as ``options=``. By default the format
        has none.
    renames : callable, optional
        ``renames(cloud)`` returns the names that the file gives to attributes whose own names it
        cannot hold.
    check : callable, optional
        ``check(cloud)`` raises for a cloud that the format cannot hold, as `write` would: the
        command line calls it before the faces are made.
    gzip : bool
        Whether files may be compressed with gzip, and ``.gz`` follow the suffix: the reader gets
        the text, and should read it from the beginning on.
    selects : bool
        Whether ``read`` takes ``selection=``, and leaves out rows as it reads them; of other
        formats they are left out afterwards.
    entries : tuple of str
        Entries of the metadata that the file holds in its own way, also if it keeps no others; its
        writer raises for what it cannot hold.
    suffix_options : mapping, optional
        Options for ``write`` that a suffix stands for, by suffix; those of the caller come first.
    write_chunks : callable, optional
        ``write_chunks(stream, chunks, **options)`` writes the consecutive chunks of a cloud, as
        ``read_chunks`` yields them of one file, and at least one: the bytes of ``write`` for all.

    Raises
    ------
    InputError
        ``keeps`` or ``needs`` holds an unknown word.

    See Also
    --------
    Adapter : The same for objects.
    read : Reads by formats.
    write : Writes by formats.

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
    options: Callable[..., Any] | None = None
    renames: Callable[[Cloud], Mapping[str, str]] | None = None
    check: Callable[[Cloud], None] | None = None
    gzip: bool = False
    selects: bool = False
    entries: tuple[str, ...] = ()
    suffix_options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    write_chunks: Callable[..., None] | None = None

    def __post_init__(self) -> None:
        for name, words, known in (
            ("keeps", self.keeps, tuple(CONTENT)),
            ("needs", self.needs, NEEDS),
        ):
            is_listed = isinstance(words, tuple | list | set | frozenset)
            unknown = [word for word in words if word not in known] if is_listed else [words]
            if unknown:
                raise InputError(
                    f"{name} of the format {self.name!r} holds {shown(unknown[0])}: "
                    f"known are {', '.join(known)}"
                )


class LazyFunction:
    """A function of a module, which is imported at the first call."""

    def __init__(self, module: str, name: str) -> None:
        self.module = module
        self.name = self.__name__ = name
        self._function: Callable[..., Any] | None = None

    def __call__(self, *values: Any, **options: Any) -> Any:
        """Call the function."""
        return self._imported()(*values, **options)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.module, self.name)

    def __eq__(self, other: object) -> bool:
        """Whether the other one stands for the same function."""
        return isinstance(other, LazyFunction) and repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        """Name the function in full."""
        return f"{self.module}.{self.name}"

    @property
    def __wrapped__(self) -> Callable[..., Any]:
        """The function itself: what `inspect.signature` and `inspect.unwrap` look at."""
        return self._imported()

    def _imported(self) -> Callable[..., Any]:
        if self._function is None:
            with defer_signals():
                self._function = getattr(import_module(self.module), self.name)
        return self._function


def configured(
    reader: Callable[..., Read], file_format: Format, name: str, options: Mapping[str, Any]
) -> Callable[..., Read]:
    """Set the options of a reader, once they are checked."""
    if not options:
        return reader
    known = inspect.signature(file_format.options).parameters if file_format.options else {}
    if file_format.options is None or not options.keys() <= known.keys():
        wrong = ", ".join(f"{Option(each, ...)}" for each in options if each not in known)
        others = f"take {', '.join(known)}" if known else "are read without options"
        raise FormatError(f"{name}: {wrong} cannot be given: {file_format.name} files {others}")
    return partial(reader, options=file_format.options(**options))


def check_needs(file_format: Format, cloud: Cloud) -> None:
    """Raise if a cloud lacks what the format needs."""
    kind = file_format.name.upper()
    if "points" in file_format.needs and not len(cloud):
        raise FormatError(f"a cloud without points cannot be written as {kind}: write PLY or NPZ")
    if "faces" in file_format.needs and (cloud.faces is None or not len(cloud.faces)):
        raise FormatError(f"a cloud without faces cannot be written as {kind}: write PLY")
    if "finite" in file_format.needs:
        _check_finite(file_format, cloud)


def check_before(file_format: Format, cloud: Cloud) -> None:
    """Raise for rows that cannot be written, before there are faces."""
    if "finite" in file_format.needs and "points" in file_format.keeps:
        _check_finite(file_format, replace(cloud, faces=None))
    if "colors" in file_format.keeps and cloud.colors is not None:
        check_colors(cloud.colors)
    if file_format.check is not None:
        file_format.check(cloud)


def _check_finite(file_format: Format, cloud: Cloud) -> None:
    held = _held(file_format, cloud)
    bad = ~np.isfinite(held).all(axis=1)
    if bad.any():
        row = int(np.argmax(bad))
        if cloud.faces is not None and len(held) < len(cloud):
            row = int(_used(file_format, cloud)[row])
        raise FormatError(
            f"vertex {row} is {cloud.points[row].tolist()}: {file_format.name} holds finite "
            "coordinates only: remove such rows, or write PLY or OBJ"
        )


def dropped(
    file_format: Format, cloud: Cloud, options: Mapping[str, Any], found: Found
) -> tuple[str, ...]:
    """List what a cloud has and its file does not keep, attributes and metadata by name."""
    losses = () if file_format.loses is None else file_format.loses(cloud, options)
    if isinstance(found, frozenset):
        losses, origin = (*losses, *sorted(found)), None
    else:
        origin = found
    kept = set(file_format.keeps) - set(losses)
    if "colors" not in kept:
        kept |= {"alpha", "deep_colors"}  # covered by "colors"
    lost = [word for word in CONTENT if word not in kept and _has(file_format, cloud, word)]
    if {"alpha", "deep_colors"} <= {*lost} and fits_eight_bits(cloud.colors[:, :3]):  # type: ignore[index]
        lost.remove("deep_colors")  # only alpha has more than eight bits
    is_said = "float64" in losses
    if "float64" not in kept and (is_said or not fits_single(_held(file_format, cloud), origin)):
        lost.append("float64")
    names = [name for word in lost for name in _names(cloud, word)]
    if "metadata" in kept:
        names += metadata.dropped_entries(cloud.metadata)
    known, entries = metadata.Provenance(cloud.metadata), file_format.entries
    if known.carved and "metadata" not in file_format.keeps:
        entries = (*entries, metadata.CARVED)  # the triangles that are left are all that counts
    names = [name for name in names if name not in metadata.named(entries)]
    named = (each for each in losses if each not in CONTENT and each not in names)
    return (*names, *named, *known.lost)


def _has(file_format: Format, cloud: Cloud, word: str) -> bool:
    """Whether a cloud has a part that could be lost."""
    colors = cloud.colors
    if word == "points":
        return cloud.faces is None or len(_used(file_format, cloud)) < len(cloud)
    if word == "float64":
        return False  # its coordinates decide, relative to the origin of the file
    if word == "alpha":
        return colors is not None and not is_opaque(colors)
    if word == "deep_colors":
        return colors is not None and not fits_eight_bits(colors)
    if word == "metadata":
        return bool(metadata.user_entries(cloud.metadata))
    part = getattr(cloud, word)
    return part is not None and len(part) > 0


def _used(file_format: Format, cloud: Cloud) -> Rows:
    """List the rows of faces, and those of edges if the format keeps these."""
    parts = [cloud.faces, cloud.edges if "edges" in file_format.keeps else None]
    corners = [each.reshape(-1) for each in parts if each is not None]
    return used_rows(len(cloud), corners[0] if len(corners) == 1 else np.concatenate(corners))


def _names(cloud: Cloud, word: str) -> list[str]:
    """Name a part of a cloud: attributes and metadata one by one."""
    if word == "attributes":
        return sorted(cloud.attributes)
    if word == "metadata":
        return metadata.named(metadata.user_entries(cloud.metadata))
    return [CONTENT[word]]


def dropped_values(name: str) -> str:
    """Name values that a format does not keep, for `Format.loses`."""
    return f"{name} (values)" if name in CONTENT else name


def renamed(file_format: Format, cloud: Cloud) -> tuple[tuple[str, str], ...]:
    """List the attributes that a file holds under other names, with these."""
    return () if file_format.renames is None else tuple(file_format.renames(cloud).items())


def _held(file_format: Format, cloud: Cloud) -> Floats:
    """The points that a file holds: all, or those in use."""
    if "points" in file_format.keeps or cloud.faces is None:
        return cloud.points
    return cloud.points.take(_used(file_format, cloud), axis=0)


TOLERANCE = 1e-6  # of the size of a model, by which rounding may move a vertex


def needed_origin(points: Floats, what: str) -> Origin | None:
    """Compute the origin to subtract before coordinates are rounded to single precision."""
    if not len(points):
        return None
    # Column by column: reductions along axis 0 take ten times as long.
    low = np.array([column.min() for column in points.T])
    with np.errstate(over="ignore"):
        size = float((np.array([column.max() for column in points.T]) - low).max())
    needed = _moved(points) > TOLERANCE * size
    if np.isfinite(size) and not needed.any():
        return None
    needed[:2] = needed[:2].any()
    origin = np.where(needed, round_below(low, size), 0.0)
    fits = np.isfinite(size) and bool(np.all(_moved(points - origin) <= TOLERANCE * size))
    if not fits:
        raise FormatError(
            f"the coordinates do not fit the single precision of {what}: write PLY or OBJ"
        )
    return (float(origin[0]), float(origin[1]), float(origin[2]))


def _moved(points: Floats) -> Floats:
    """Compute for each axis how far rounding to single precision moves coordinates at most."""
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        return np.array([np.abs(each - each.astype(np.float32)).max() for each in points.T])


def round_below(low: Floats, size: float) -> Floats:
    """Round coordinates down, to units or to a power of ten that suits a smaller model."""
    step = 10.0 ** min(np.floor(np.log10(size)), 0.0) if size else 0.0
    if step == 0:  # of the least denormals, too
        return low
    rounded: Floats = np.floor(low / step) * step
    return rounded


def without_origin(points: Floats, origin: Origin | None) -> Floats:
    """Subtract an origin, if there is one."""
    return points if origin is None else points - np.array(origin)


def with_origin(cloud: Cloud, origin: Origin | None) -> Cloud:
    """Add the origin that a file states, if it does, and record it in the metadata."""
    if origin is None:
        return cloud
    return replace(
        cloud,
        points=cloud.points + np.array(origin),
        metadata=noted(cloud.metadata, origin=origin),
    )


def fits_single(points: Floats, origin: Origin | None) -> bool:
    """Whether all coordinates, relative to an origin, round-trip through single precision."""
    shift = np.zeros(3) if origin is None else np.array(origin)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        again = (points - shift).astype(np.float32).astype(np.float64) + shift
    return np.array_equal(again, points, equal_nan=True)


def checked_origin(values: object, name: str) -> Origin:
    """Check an origin that a file states."""
    numbers = finite_numbers(values, 3)
    if numbers is None:
        raise FormatError(
            f"{name}: the origin is {shown_json(values)}: expected three finite numbers"
        )
    return (numbers[0], numbers[1], numbers[2])


SINGLE, DOUBLE = 24, 53  # bits of a significand


def fits_whole(values: Array, bits: int) -> bool:
    """Whether significands of so many bits hold all values of an array of integers."""
    if not values.size or max(-int(values.min()), int(values.max())) <= 1 << bits:
        return True
    sizes = np.abs(values.astype(np.int64)) if values.dtype.kind == "i" else values
    sizes = sizes.astype(np.uint64)  # -2**63 has no opposite, but the right bits
    lowest = sizes & (~sizes + np.uint64(1))
    return bool((sizes // np.maximum(lowest, 1) < np.uint64(1 << bits)).all())
