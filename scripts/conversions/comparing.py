"""What a cloud lost between two forms, value by value.

Values are the same if their bits are: a NaN is the same whatever its payload, and a zero has its
sign. Losses have the words of `WriteResult.dropped`; what these do not tell has words of its own,
such as ``type of class``, and what must never happen is a `ChangedError`.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh.base.colors import as_float, as_uint8
from liftmesh.io.columns import edges_of
from liftmesh.io.format import CONTENT, TOLERANCE
from liftmesh.io.metadata import user_entries

if TYPE_CHECKING:
    from liftmesh import Cloud

Array = np.ndarray[Any, np.dtype[Any]]

ROWS, FACES, EDGES, COLORS, ALPHA, DEEP, NORMALS, CRS, PRECISION = (
    CONTENT[word]
    for word in (
        "points", "faces", "edges", "colors", "alpha", "deep_colors", "normals", "crs", "float64",
    )
)  # fmt: skip

ORDER = "order of rows"  # of a format that keeps triangles alone
ROUNDED = "alpha beyond 8 bits"


class ChangedError(AssertionError):
    """A value is another than before, or is new."""


def losses(before: Cloud, after: Cloud) -> set[str]:
    """Say what a cloud lost.

    Raises
    ------
    ChangedError
        Something is new or different in a way that has no name.
    """
    found = {*_of_points(before, after), *_of_colors(before.colors, after.colors)}
    found |= {*_of_normals(before.normals, after.normals), *_of_attributes(before, after)}
    if after.crs != before.crs:
        _demand(after.crs is None, f"another crs: {after.crs!r}")
        found.add(CRS)
    return found | {*_of_metadata(before, after)}


def _demand(condition: bool, what: str) -> None:
    if not condition:
        raise ChangedError(what)


def same(a: Array, b: Array) -> bool:
    """Whether two arrays hold the same values in any types, with the signs of zeros."""
    if a.shape != b.shape:
        return False
    if a.dtype.kind == b.dtype.kind == "c":
        return same(a.real, b.real) and same(a.imag, b.imag)
    if a.dtype.kind not in "biuf" or b.dtype.kind not in "biuf":
        return a.dtype.kind == b.dtype.kind and a.tolist() == b.tolist()
    if a.dtype.kind in "iu" and b.dtype.kind in "iu":
        return a.tolist() == b.tolist()
    if "f" not in (a.dtype.kind, b.dtype.kind):
        return bool(np.array_equal(a, b))
    return all(map(_same_number, a.ravel(), b.ravel()))


def _same_number(a: Any, b: Any) -> bool:
    if a != a or b != b:  # noqa: PLR0124 - NaN
        return bool(a != a and b != b)  # noqa: PLR0124
    if isinstance(a, np.integer | np.bool_):
        return bool(np.isfinite(b)) and int(a) == int(b) and float(b).is_integer()
    if isinstance(b, np.integer | np.bool_):
        return bool(np.isfinite(a)) and int(a) == int(b) and not (a == 0 and np.signbit(a))
    return bool(a == b and np.signbit(a) == np.signbit(b))


def near(a: Array, b: Array) -> bool:
    """Whether positions are the same as far as single precision tells."""
    if a.shape != b.shape:
        return False
    size = float(np.ptp(a, axis=0).max()) if len(a) else 0.0
    with np.errstate(all="ignore"):
        return bool(np.all((np.abs(a - b) <= 2 * TOLERANCE * size) | (a == b)))


def _ends(cloud: Cloud) -> list[list[bytes]]:
    """The positions of both ends of each edge, in any order: some files have their own."""
    ends = np.where(np.isnan(cloud.points), np.nan, cloud.points + 0.0)[edges_of(cloud)]
    return sorted(sorted(end.tobytes() for end in edge) for edge in ends)


def _of_points(before: Cloud, after: Cloud) -> Iterator[str]:
    if len(edges_of(before)) and not len(edges_of(after)):
        yield EDGES
    else:
        _demand(_ends(before) == _ends(after), "other edges")
    has_faces = before.faces is not None and len(before.faces) > 0
    if has_faces and (after.faces is None or not len(after.faces)):
        yield FACES
    _demand(has_faces or after.faces is None or not len(after.faces), "new faces")
    are_there = same(before.points, after.points) or near(before.points, after.points)
    is_row_by_row = are_there and np.array_equal(before.faces, after.faces)
    if not has_faces or after.faces is None or is_row_by_row:
        _demand(len(after) == len(before), f"{len(after)} rows of {len(before)}")
        if not same(before.points, after.points):
            _demand(near(before.points, after.points), "other positions")
            yield PRECISION
        return
    yield from _of_triangles(before, after)


def _of_triangles(before: Cloud, after: Cloud) -> Iterator[str]:
    """Compare meshes whose rows are others: corner by corner, and zeros of either sign are equal.

    Formats without rows make one row of equal corners, so that all have the zeros of the first.
    """
    ours, theirs = before.points[before.faces] + 0.0, after.points[after.faces] + 0.0
    _demand(ours.shape == theirs.shape, f"{len(theirs)} faces of {len(ours)}")
    used = [before.faces, edges_of(before if len(edges_of(after)) else after)]
    yield ROWS if len(np.unique(np.concatenate([*map(np.ravel, used)]))) < len(before) else ORDER
    if not same(ours, theirs):
        _demand(near(ours.reshape(-1, 3), theirs.reshape(-1, 3)), "other corners")
        yield PRECISION


def _of_colors(ours: Array | None, theirs: Array | None) -> Iterator[str]:
    if ours is None or theirs is None:
        _demand(ours is not None or theirs is None, "new colours")
        if ours is not None and len(ours):
            yield COLORS
        return
    _demand(len(ours) == len(theirs), "colours of other rows")
    if not _same_shades(ours[:, :3], theirs[:, :3]):
        _demand(np.array_equal(as_uint8(ours[:, :3]), as_uint8(theirs[:, :3])), "other colours")
        yield DEEP
    ours, theirs = _opacity(ours), _opacity(theirs)
    if not _same_shades(ours, theirs):
        alike = np.array_equal(as_uint8(_rgb(ours)), as_uint8(_rgb(theirs)))
        yield ROUNDED if alike else ALPHA
        _demand(alike or bool(np.all(as_float(_rgb(theirs)) == 1)), "another alpha")


def _opacity(colors: Array) -> Array:
    if colors.shape[1] > 3:
        return colors[:, 3:]
    return np.full((len(colors), 1), 255, np.uint8)


def _rgb(values: Array) -> Array:
    return np.repeat(values, 3, axis=1)


def _same_shades(ours: Array, theirs: Array) -> bool:
    """Whether colours of any two types are the same in the coarser of both."""
    if ours.shape[1] == 1:
        ours, theirs = _rgb(ours), _rgb(theirs)
    a, b = as_float(ours), as_float(theirs)
    if ours.dtype.kind == "f":
        return np.array_equal(a.astype(ours.dtype), b.astype(ours.dtype))
    if ours.dtype.itemsize > 2 or theirs.dtype == np.float16:
        return np.array_equal(a, b)
    return np.array_equal(a.astype(np.float32), b.astype(np.float32))


def _of_normals(ours: Array | None, theirs: Array | None) -> Iterator[str]:
    if ours is None or theirs is None:
        _demand(ours is not None or theirs is None, "new normals")
        if ours is not None and len(ours):
            yield NORMALS
        return
    _demand(ours.shape == theirs.shape, "normals of other rows")
    if not same(ours, theirs.astype(ours.dtype)):  # text has the digits of single precision
        with np.errstate(all="ignore"):
            single = same(ours.astype(np.float32), theirs.astype(np.float32))
        yield "rounded normals" if single else NORMALS


def _of_attributes(before: Cloud, after: Cloud) -> Iterator[str]:
    held = dict(after.attributes)
    for name, values in before.attributes.items():
        found = held.pop(name, None)
        if found is None:
            found = _joined(held, name, values)
        if found is not None and {*values.shape[1:], *found.shape[1:]} <= {1}:
            found = found.reshape(
                values.shape
            )  # one value a row, with or without an axis of its own
        if found is None:
            yield f"attribute {name}"
        elif not same(values, found):
            _demand(_same_rounded(values, found), f"other values of {name!r}: {values} {found}")
            yield f"rounded {name}"
        elif found.dtype.newbyteorder("=") != values.dtype.newbyteorder("="):
            yield f"type of {name}"
    _demand(not held, f"new attributes: {[*held]}")


def _joined(held: dict[str, Array], name: str, values: Array) -> Array | None:
    """Remove and return the columns that an (n, k) attribute was split into."""
    flat = values.reshape(len(values), int(np.prod(values.shape[1:])))
    names = [f"{name}_{k}" for k in range(flat.shape[1])]
    if values.ndim == 1 or not names or not all(each in held for each in names):
        return None
    columns = [held.pop(each) for each in names]
    kinds = {each.dtype for each in columns}
    dtype = kinds.pop() if len(kinds) == 1 else np.dtype(np.float64)
    return np.stack([each.astype(dtype) for each in columns], axis=1).reshape(values.shape)


def _same_rounded(ours: Array, theirs: Array) -> bool:
    """Whether values differ as single precision, or as doubles for whole numbers, makes them."""
    if ours.size == theirs.size == 0:
        return True  # tables may have no type where they have no value
    if ours.shape != theirs.shape or not {ours.dtype.kind, theirs.dtype.kind} <= {*"biuf"}:
        return False
    with np.errstate(all="ignore"):
        return bool(np.array_equal(ours.astype(np.float32), theirs.astype(np.float32)))


def _of_metadata(before: Cloud, after: Cloud) -> Iterator[str]:
    ours, theirs = user_entries(before.metadata), user_entries(after.metadata)
    for key, value in ours.items():
        if key not in theirs:
            yield f"metadata {key}"
        else:
            _demand(_plain(value) == _plain(theirs[key]), f"other metadata {key!r}")
    new = theirs.keys() - ours.keys()
    _demand(not new, f"new metadata: {new}")


def _plain(value: Any) -> str:
    """A value as JSON, in which tuples are lists, and numbers those of Python."""
    return json.dumps(value, sort_keys=True, default=_default)


def _default(value: Any) -> Any:
    return (
        value.item()
        if isinstance(value, np.generic)
        else dict(value)
        if isinstance(value, Mapping)
        else repr(value)
    )


def unnamed(lost: Collection[str], dropped: Collection[str]) -> set[str]:
    """Return the losses that `WriteResult.dropped` does not name."""
    return {each for each in lost if not any(_means(text, each) for text in dropped)}


def untrue(lost: Collection[str], dropped: Collection[str]) -> set[str]:
    """Return what `WriteResult.dropped` names and was not lost."""
    return {text for text in dropped if not any(_means(text, each) for each in lost)}


def _means(text: str, loss: str) -> bool:
    """Whether a text of `WriteResult.dropped` tells a loss."""
    kind, _, name = loss.partition(" ")
    if kind == "attribute" and (text == name or text.startswith(f"{name} (")):
        return True
    if kind == "rounded":
        return text in (f"double precision of {name}", f"whole numbers of {name} beyond 2**53")
    if loss == PRECISION and text.startswith("last bits of coordinates"):
        return True
    return text == loss or (loss == ROUNDED and text in (ALPHA, DEEP))
