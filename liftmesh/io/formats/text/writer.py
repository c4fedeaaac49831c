"""Writer for points as text: XYZ, CSV and TSV.

A line for each point: x, y, z, then normals, colours and named values, in digits that round-trip.
The first line of CSV and TSV names the columns. XYZ has no such line: it gets one as a comment, if
there are columns beyond x, y and z, or if x or z could be ids. Names are written only if
`reader` reads them as they are.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.colors import as_float, as_uint8, fits_eight_bits, recognized
from liftmesh.base.options import refused
from liftmesh.errors import FormatError
from liftmesh.io.columns import (
    ALPHA,
    COLOR,
    NORMAL,
    POSITION,
    attribute_columns,
    exact_doubles,
)
from liftmesh.io.format import DOUBLE, fits_whole
from liftmesh.io.formats.text import reader
from liftmesh.io.formats.text.column_ambiguity import ColumnAmbiguity
from liftmesh.io.formats.text.columns import unnamed
from liftmesh.io.options import COLUMN_BYTES, TableOptions
from liftmesh.io.text_tables import quoted, write_rows

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_DELIMITERS = (" ", ",", ";", "\t")


def write_text(stream: BinaryIO, cloud: Cloud, *, delimiter: str = " ") -> None:
    """Write the points of a cloud as text, one per line."""
    if delimiter not in _DELIMITERS:
        raise refused("delimiter", delimiter, f"known are {', '.join(map(repr, _DELIMITERS))}")
    columns, attributes = _columns(cloud)
    is_wide = len(columns) + len(attributes) > len(POSITION)
    if delimiter != " " or is_wide or _could_be_ids(cloud.points):
        _check_names([*columns], [*attributes], delimiter)
        stream.write(_header([*columns, *attributes], delimiter))
    columns |= attributes
    write_rows(stream, [*columns.values()], between=delimiter)


def _columns(cloud: Cloud) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return the columns of the points, colours and normals, and those of the attributes."""
    attributes = attribute_columns(cloud.attributes)
    columns = _own_columns(cloud)
    taken = columns.keys() & attributes.keys()
    if taken:
        raise FormatError(f"attribute {min(taken)!r} has the name of a column of text: rename it")
    return columns, attributes


def check(cloud: Cloud) -> None:
    """Raise for what no table can hold; names that depend on the delimiter are checked later."""
    _columns(cloud)


def _could_be_ids(points: Floats) -> bool:
    """Whether `reader` would doubt that x or z are coordinates, if no line named them."""
    options = TableOptions(missing=())
    doubts = ColumnAmbiguity("", unnamed(len(POSITION), options, ""), options)
    doubts.examine(points)
    try:
        doubts.check()
    except FormatError:
        return True
    return False


def _own_columns(cloud: Cloud) -> dict[str, Array]:
    columns = dict(zip(POSITION, cloud.points.T, strict=True))
    if cloud.normals is not None:
        columns |= zip(NORMAL, exact_doubles(cloud.normals).T, strict=True)
    if cloud.colors is not None:
        columns |= zip((*COLOR, ALPHA), _plain_colors(cloud.colors).T, strict=False)
    return columns


def _plain_colors(colors: Array) -> Array:
    """Colours as numbers from which readers tell their type: all below 2 would be floats."""
    if fits_eight_bits(colors):
        levels = as_uint8(colors)
        return as_float(levels) if levels.max(initial=0) == 1 else levels
    if colors.dtype == np.uint16 and colors.max() > 255:
        return colors
    return as_float(colors)


def _header(names: list[str], delimiter: str) -> bytes:
    mark = "# " if delimiter == " " else ""
    return f"{mark}{delimiter.join(names)}\n".encode()


def _check_names(own: list[str], attributes: list[str], delimiter: str) -> None:
    """Raise if the header would be read as anything else than these columns and attributes."""
    if _comes_back(own, attributes, delimiter):
        return
    wrong = (each for each in attributes if not _comes_back(own, [each], delimiter))
    raise FormatError(
        f"attribute {quoted(next(wrong, attributes[0]))} cannot name a column of text: "
        f"between {delimiter!r} it would be read as something else: rename it"
    )


def _comes_back(own: list[str], attributes: list[str], delimiter: str) -> bool:
    names = [*own, *attributes]
    limit = COLUMN_BYTES * (len(names) + 1)
    try:
        lines = _header(names, delimiter) + delimiter.join("0" * len(names)).encode()
        back = reader.read_text(io.BytesIO(lines), "", max_bytes=limit)
    except (FormatError, UnicodeEncodeError):
        return False
    channels = 0 if back.colors is None else back.colors.shape[1]
    return (
        [*back.attributes] == attributes
        and channels == len({*own} & {*COLOR, ALPHA})
        and (back.normals is not None) == (NORMAL[0] in own)
    )


def dropped_parts(cloud: Cloud, options: Mapping[str, Any]) -> tuple[str, ...]:
    """Numbers are read as doubles, and colours close to those of 8 bits as these."""
    return (*dropped_digits(cloud, options), *_lost_colors(cloud))


def dropped_digits(cloud: Cloud, _options: Mapping[str, Any]) -> tuple[str, ...]:
    """Numbers are read as doubles."""
    whole = {k: each for k, each in sorted(cloud.attributes.items()) if each.dtype.kind in "iu"}
    wide = [name for name, values in whole.items() if not fits_whole(values, DOUBLE)]
    return tuple(f"whole numbers of {name} beyond 2**53" for name in wide)


def _lost_colors(cloud: Cloud) -> tuple[str, ...]:
    if cloud.colors is None or fits_eight_bits(cloud.colors):
        return ()
    back = recognized(_plain_colors(cloud.colors).astype(np.float64))
    if back is not None and np.array_equal(as_float(back), as_float(cloud.colors)):
        return ()
    return ("deep_colors", "alpha")[: cloud.colors.shape[1] - 2]
