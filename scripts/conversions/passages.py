"""The ways a cloud can go: into a file and back, or into another library's object and back.

The formats come from the registry, with every combination of the options of their writers, so that
a new one is tested from its first day; `read_only` writes the files of formats that liftmesh only
reads, `write_only` reads those that it only writes, by other libraries or by hand. Of objects, each
adapter of the registry has at least one way (`objects`).
"""

from __future__ import annotations

import gzip
import inspect
import io
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product
from typing import Any, Literal, get_args, get_origin

import laspy
import numpy as np
from conversions.write_only import READERS

from liftmesh import Cloud, Format, FormatError, read, read_chunks, write
from liftmesh.io.columns import faces_of
from liftmesh.io.registry import FORMATS
from liftmesh.io.tags import regions_of

_DELIMITERS = (" ", ",", ";", "\t")
OF_LAS = frozenset(each for k in range(11) for each in laspy.PointFormat(k).dimension_names)
"""The values that every point of a LAS file has, of one format or another."""

OF_FILES = frozenset({each.name for each in FORMATS} | {"las_records", "holes"})
"""Entries of metadata that say how a file holds its points, or which faces are missing."""


@dataclass(frozen=True)
class Arrival:
    """What came back of the cloud that was sent, and the losses that were named.

    ``named`` is None where nothing names them, ``data`` the file.
    """

    cloud: Cloud
    sent: Cloud
    named: Collection[str] | None = None
    data: bytes = b""


@dataclass(frozen=True, eq=False, repr=False)
class Passage:
    """A way there and back; ``place`` is the format or object, ``options`` those of the writer."""

    place: str
    send: Callable[[Cloud], Arrival]
    options: Mapping[str, Any] = field(default_factory=dict)
    needs_faces: bool = False

    def __repr__(self) -> str:
        given = (f"{name}={value!r}" for name, value in self.options.items())
        return " ".join([self.place, *given])


def files() -> Iterator[Passage]:
    """Every format that is written, with every combination of options."""
    for each in FORMATS:
        if each.write is not None and each.name != "su2":  # which holds all of the boundary
            for options in _combinations(each):
                send = partial(_through_file, each, options)
                yield Passage(each.name, send, options, "faces" in each.needs)
            if each.gzip:
                yield Passage(f"{each.name}.gz", partial(_through_gzip, each))


def _combinations(found: Format) -> Iterator[dict[str, Any]]:
    """Every combination of the values of the options of a writer, but for comments."""
    options = [*inspect.signature(found.write).parameters.values()][2:]  # type: ignore[arg-type]
    values = {each.name: _values(found, each) for each in options if each.name != "comments"}
    for chosen in product(*values.values()):
        yield dict(zip(values, chosen, strict=True))


def _values(found: Format, option: inspect.Parameter) -> tuple[Any, ...]:
    """The values of an option whose type lists them, or is a switch."""
    kind = option.annotation
    if isinstance(kind, str):
        kind = getattr(sys.modules[inspect.unwrap(found.write).__module__], kind, kind)
    if get_origin(kind) is Literal:
        return get_args(kind)
    if kind in ("bool", bool):
        return False, True
    if option.name == "delimiter":
        return _DELIMITERS
    is_free = option.default is None or isinstance(option.default, str)
    assert is_free, f"{found.name}: which values does {option.name} have?"
    return (option.default,)


def _through_file(found: Format, options: Mapping[str, Any], cloud: Cloud) -> Arrival:
    stream = io.BytesIO()
    written = write(stream, cloud, format=found.name, **options)
    data = stream.getvalue()
    back = without_others(_read(data, found.name), cloud)
    sent = _by_region(cloud) if found.name == "msh" else cloud
    return Arrival(back, sent, written.dropped, data)


def _by_region(cloud: Cloud) -> Cloud:
    """Put the faces in the order of their regions, which are groups of MSH."""
    return replace(cloud, faces=faces_of(cloud)[np.argsort(regions_of(cloud), kind="stable")])


def without_others(back: Cloud, cloud: Cloud) -> Cloud:
    """Leave out what such files have besides: layout, values of every point, and holes."""
    added = OF_LAS - cloud.attributes.keys() if "las" in back.metadata else frozenset()
    kept = {name: each for name, each in back.attributes.items() if name not in added}
    left_out = {*OF_FILES, *{"markers"} - cloud.metadata.keys()}  # 2DM numbers all nodestrings
    entries = {key: each for key, each in back.metadata.items() if key not in left_out}
    return replace(back, attributes=kept, metadata=entries)


def _through_gzip(found: Format, cloud: Cloud) -> Arrival:
    stream = io.BytesIO()
    written = write(stream, cloud, format=found.name)
    data = gzip.compress(stream.getvalue(), 1)
    back = without_others(_read(data, f"{found.name}.gz"), cloud)
    return Arrival(back, cloud, written.dropped, data)


def _read(data: bytes, kind: str) -> Cloud:
    """Read a file; a table whose values leave something open, as its message says."""
    if kind in READERS:
        return READERS[kind](data)
    try:
        return read(io.BytesIO(data), format=kind)
    except FormatError as error:
        if "nodata=" not in str(error):
            raise AssertionError(f"a file that was written cannot be read: {error}") from error
        return read(io.BytesIO(data), format=kind, nodata="none")


def chunks(data: bytes, kind: str, rows: int) -> list[Cloud]:
    """Read a file in chunks, like `_read`."""
    try:
        return [*read_chunks(io.BytesIO(data), format=kind, rows=rows)]
    except FormatError as error:
        if "nodata=" not in str(error):
            raise
        return [*read_chunks(io.BytesIO(data), format=kind, rows=rows, nodata="none")]
