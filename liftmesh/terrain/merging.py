"""`merge`: several clouds as one, as the tiles of a survey are, and where they overlap.

Rows follow one another. What every cloud has is kept; what only some have is named in
``metadata["not_read"]``. Coordinate systems must be the same: coordinates are never mixed.

Strips flown obliquely overlap in little of the boxes around them. So the plane is divided into
square cells, twice as wide as rows are apart, and a row overlaps if its cell holds rows of another
part. Cells of a border count though files only touch.
"""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats, Indices
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import as_float, kept_depth, with_alpha
from liftmesh.base.options import refused, shown
from liftmesh.crs.comparison import are_different, is_same
from liftmesh.crs.description import parse_crs
from liftmesh.crs.transformation import common_transformation
from liftmesh.crs.units import band_unit
from liftmesh.errors import DataWarning, InputError, Option
from liftmesh.io.metadata import TRANSFORMATION, Label, Provenance, Unread, user_entries
from liftmesh.io.objects.plain import is_table
from liftmesh.io.read import check_grounds, read_cloud

_LAYOUT = "las"  # the entry of lidar's scales
_FLOWN = "flight_lines"
_LINE = "point_source_id"  # the flight line
_POINTS, _NORMALS = 0, 1  # keys beside the names of attributes
_OF_A_FILE = (
    "source",
    "format",
    "not_read",
    "selection",
    "merged",
    "las_records",
    "stated_crs",
    TRANSFORMATION,
)


def merge(clouds: Iterable[object]) -> Cloud:
    """Merge clouds into one: the rows of the first, then those of the second, and so on.

    Parameters
    ----------
    clouds : iterable of path, Cloud or object
        One or more of anything that `triangulate` takes. Clouds that an iterator makes one by one
        are given back column by column: memory grows by the largest one, not to twice the clouds.

    Returns
    -------
    Cloud
        All rows, without faces, with the colours, normals and named values that every cloud has.
        ``metadata["merged"]`` has an entry for each: "source", "rows", and "overlap", its rows in
        square cells of the plane, twice as wide as rows are apart, where an earlier one has rows,
        too; and "distance" from the earlier ones if none states a coordinate system, and it is more
        than ten times as far as the boxes of all in the plane are long. If rows have a
        ``point_source_id``, ``metadata["flight_lines"]`` has the number of "lines", and "overlap",
        the rows in cells of several. ``metadata["not_read"]`` names what is left out.

    Warns
    -----
    DataWarning
        Only some state a coordinate system: it is taken to be that of all. Or none does, and one is
        far from those before it.

    Raises
    ------
    InputError
        There is no cloud, two have different coordinate systems, or ``classes="ground"`` was asked
        of files, and only some have any: the others would be merged with all their rows.
    FormatError, UnsupportedTypeError
        As for `read` and `as_cloud`.

    See Also
    --------
    read : Reads one cloud.
    thin : Fewer rows.
    TiledSurface : Of clouds larger than memory.

    Examples
    --------
    >>> found = merge([[[0, 0, 1], [4, 4, 1]], [[4, 4, 1], [9, 0, 1]]])
    >>> len(found), [each["overlap"] for each in found.metadata["merged"]]
    (4, [0, 1])
    """
    parts = [read_cloud(each) for each in _listed(clouds)]
    if not parts:
        raise InputError("there is no cloud to merge: give one or more")
    names = [_name(each, k) for k, each in enumerate(parts)]
    sizes = [len(each) for each in parts]
    check_grounds(zip(names, map(_selection, parts), strict=True))
    crs = _common_system(parts, names)
    left_out: list[str] = []
    colors = _colors(parts, names, left_out)
    depth = kept_depth(colors)
    keys = dict.fromkeys(key for each in parts for key in each.attributes)
    columns = [_columns_of(each) for each in parts]
    unit = _common_unit(parts, names)
    entries, notes = _entries(parts, left_out), len(left_out)
    if unit is not None:
        entries.setdefault("raster", {"unit": unit})
    has_faces = any(each.faces is not None for each in parts)
    has_edges = any(each.edges is not None for each in parts)
    del parts  # so that each column of the parts can be given back once it is merged
    points = np.concatenate(_taken(columns, _POINTS))
    normals = _stacked(_taken(columns, _NORMALS), names, "normals", left_out)
    values = {key: _stacked(_taken(columns, key), names, key, left_out) for key in keys}
    left_out += ["faces"] * has_faces + ["edges"] * has_edges
    if new := left_out[notes:]:
        entries |= _not_read([*entries.get("not_read", ()), *new])
    entries |= _account(points, sizes, names, values.get(_LINE))
    if crs is None:
        _note_distances(entries["merged"], distances_of(points, sizes))
    return Cloud(
        points,
        colors=colors,
        normals=normals,
        attributes={key: each for key, each in values.items() if each is not None},
        metadata=entries,
        crs=crs,
        color_depth=depth,
    )


def _columns_of(cloud: Cloud) -> dict[object, Array | None]:
    """Return the arrays of a cloud but colours: attributes by name, the others by numbers."""
    columns: dict[object, Array | None] = {_POINTS: cloud.points, _NORMALS: cloud.normals}
    return columns | {name: each for name, each in cloud.attributes.items()}  # noqa: C416 - types


def _taken(columns: Sequence[dict[object, Array | None]], key: object) -> list[Any]:
    """Take a column out of all parts."""
    return [each.pop(key, None) for each in columns]


def _listed(clouds: object) -> Iterable[Any]:
    """Return what there is to merge, one by one if it is made so."""
    is_one = isinstance(clouds, str | bytes | os.PathLike | Cloud)
    if is_table(clouds) and not isinstance(clouds, list):
        kind = type(clouds).__name__
        raise InputError(f"{Option('clouds')} is one {kind}: give a list of clouds or paths")
    try:
        return [] if is_one else iter(clouds)  # type: ignore[call-overload]
    except TypeError:
        raise refused("clouds", clouds, "give a list of clouds or paths") from None


def _name(cloud: Cloud, number: int) -> str:
    source = Provenance(cloud.metadata).source
    return f"cloud {number}" if source is None else source


def _first_of(names: Sequence[str]) -> str:
    return f"{names[0]} and {len(names) - 1} more" if len(names) > 1 else names[0]


def _common_system(parts: Sequence[Cloud], names: Sequence[str]) -> str | None:
    """Return the coordinate system of all; those that state none are taken to have it."""
    stated = [(each.crs, name) for each, name in zip(parts, names, strict=True) if each.crs]
    if not stated:
        return None
    if len(stated) < len(parts):
        without = [name for each, name in zip(parts, names, strict=True) if not each.crs]
        message = "without a coordinate system: taken to be that of the others"
        warnings.warn(f"{_first_of(without)} {message}", DataWarning, stacklevel=3)
    crs, first = stated[0]
    for other, name in stated[1:]:
        if is_same(crs, other):
            continue
        if (
            not are_different(crs, other)
            and len({_states_heights(each) for each in (crs, other)}) > 1
        ):
            raise InputError(
                f"{first} and {name} have coordinate systems that are the same in the plane, but "
                f"only {first if _states_heights(crs) else name} states what heights are: say it "
                f"of the other with {Option('src_crs', ...)}, such as EPSG:7415"
            )
        raise InputError(
            f"{first} and {name} have different coordinate systems, {_titled(crs)} and "
            f"{_titled(other)}: give {Option('dst_crs', ...)}, which transforms both"
        )
    return crs


def _note_distances(merged: list[dict[str, Any]], distances: Sequence[float]) -> None:
    """Say how far clouds are from those before them, if that is far, here and in a warning."""
    for each, distance in zip(merged, distances, strict=True):
        if distance:
            each["distance"] = distance
            message = (
                f"{each['source']} is {distance:.4g} away from {merged[0]['source']}, and neither "
                "states a coordinate system: they may be in different ones; say which with "
                f"{Option('src_crs', ...)}"
            )
            warnings.warn(message, DataWarning, stacklevel=3)


def _states_heights(crs: str | None) -> bool:
    system = parse_crs(crs)
    return system is not None and system.units[2] is not None


def _titled(crs: str | None) -> str:
    """Name a coordinate system for a message, with the units of its axes."""
    system = parse_crs(crs)
    if system is None:
        return shown(crs)
    units = dict.fromkeys(each.name for each in system.units if each is not None)
    return f"{system.name} ({', '.join(units)})" if units else system.name


def _colors(parts: Sequence[Cloud], names: Sequence[str], left_out: list[str]) -> Array | None:
    """Stack colours; those of different types as floats, opaque where only some have alpha."""
    colors = [each.colors for each in _of_one_depth(parts)]
    present = [each for each in colors if each is not None]
    if len(present) == len(colors) and len({each.dtype for each in present}) > 1:
        colors = [as_float(each) for each in present]
    if len({each.shape[1] for each in present}) > 1:
        colors = [None if each is None else with_alpha(each) for each in colors]
    return _stacked(colors, names, "colors", left_out)


def _of_one_depth(parts: Sequence[Cloud]) -> Sequence[Cloud]:
    """Take dark tiles of LAS for 16-bit ones where others are: their numbers mean the same."""
    layouts = _layouts(parts)
    types = {each.colors.dtype for each in parts if each.colors is not None}
    if not layouts or types != {np.dtype(np.uint8), np.dtype(np.uint16)}:
        return parts
    return [
        each.with_color_depth(16) if layout.get("color_depth") == 8 else each
        for each, layout in zip(parts, layouts, strict=True)
    ]


def _layouts(parts: Sequence[Cloud]) -> list[dict[str, Any]]:
    """Return what lidar says of its scales for each part; nothing if one is no lidar."""
    layouts = [Provenance(each.metadata).las for each in parts]
    return layouts if all(layouts) else []


def _stacked(
    arrays: Sequence[Array | None], names: Sequence[str], what: str, left_out: list[str]
) -> Array | None:
    """Put arrays below one another, if all are there and a type holds the values of each."""
    lacking = [name for name, each in zip(names, arrays, strict=True) if each is None]
    present = [each for each in arrays if each is not None]
    if len(lacking) == len(names):
        return None
    if lacking:
        left_out.append(f"{what} (not in {_first_of(lacking)})")
        return None
    if len({each.shape[1:] for each in present}) > 1 or not _have_common_type(present):
        left_out.append(f"{what} (of different types)")
        return None
    return np.concatenate(present)


def _have_common_type(arrays: Sequence[Array]) -> bool:
    """Whether the type that NumPy chooses holds every value of every array."""
    kinds = {each.dtype for each in arrays}
    if len(kinds) == 1:
        return True
    if not all(each.kind in "biuf" for each in kinds):
        return False
    common = np.result_type(*kinds)
    return all(np.can_cast(each, common, "safe") and _is_exact(each, common) for each in kinds)


def _is_exact(kind: np.dtype, common: np.dtype) -> bool:
    """Whether a float holds all integers of a type: NumPy calls that safe for 64 bits as well."""
    return not (common.kind == "f" and kind.kind in "iu" and kind.itemsize >= common.itemsize)


def _entries(parts: Sequence[Cloud], left_out: list[str]) -> dict[str, Any]:
    """Merge metadata: what all say alike, the counts of selections, the scales of lidar."""
    first = parts[0].metadata
    keys = dict.fromkeys(key for each in parts for key in _lasting(each.metadata))
    entries: dict[str, Any] = {}
    for key in keys:
        if all(key in each.metadata and _alike(each.metadata[key], first[key]) for each in parts):
            entries[key] = first[key]
        elif any(key in user_entries(each.metadata) for each in parts):
            left_out.append(f"metadata {key}")
    for key in ("source", "format"):
        labels = [each.metadata[key] for each in parts if Provenance(each.metadata).is_read]
        entries |= {key: Label(", ".join(dict.fromkeys(labels)))} if labels else {}
    if layouts := _layouts(parts):
        entries[_LAYOUT] = _common_layout(layouts)
    told = common_transformation([Provenance(each.metadata).transformation for each in parts])
    entries |= {TRANSFORMATION: told} if told else {}
    if any(map(_selection, parts)):
        entries["selection"] = _counts(parts)
    unread = [word for each in parts for word in Provenance(each.metadata).not_read]
    return entries | _not_read(unread + left_out)


def _not_read(names: Sequence[str]) -> dict[str, Any]:
    return {"not_read": Unread(dict.fromkeys(names))} if names else {}


def _lasting(metadata: Mapping[str, Any]) -> list[str]:
    """Return the keys of entries that are no notes about a file, nor about a former merge."""
    own = user_entries(metadata)
    notes = [key for key in (_LAYOUT, _FLOWN) if isinstance(metadata.get(key), Mapping)]
    return [key for key in metadata if key not in notes and (key not in _OF_A_FILE or key in own)]


def _common_unit(parts: Sequence[Cloud], names: Sequence[str]) -> str | None:
    """Return the unit that the bands of all rasters say; raise if two say different ones."""
    units = [band_unit(each) for each in parts]
    stated = [(unit, name) for unit, name in zip(units, names, strict=True) if unit is not None]
    for unit, name in stated:
        first, before = stated[0]
        if unit != first:
            raise InputError(
                f"the band of {name} says that heights are in {shown(unit.name)}, that of {before} "
                f"in {shown(first.name)}: convert one, or read both with {Option('dst_crs', ...)} "
                "of a system that names a unit"
            )
    if stated and len(stated) < len(parts):
        unit, name = stated[0]
        message = (
            f"the band of {name} says that heights are in {shown(unit.name)}, others say nothing: "
            "heights are taken as they are, and the unit is not kept"
        )
        warnings.warn(message, DataWarning, stacklevel=3)
    return stated[0][0].name if len(stated) == len(parts) else None


def _alike(one: object, other: object) -> bool:
    try:
        return bool(one == other)
    except ValueError:  # arrays
        return False


def _common_layout(layouts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    first = layouts[0]
    return {
        key: value
        for key, value in first.items()
        if all(_alike(each.get(key), value) for each in layouts)
    }


def _selection(cloud: Cloud) -> dict[str, int]:
    return Provenance(cloud.metadata).selection


def _counts(parts: Sequence[Cloud]) -> dict[str, int]:
    """Add the counts of the rows that were selected; "ground" holds if it does for all rows."""
    counts = [_selection(each) or {"rows": len(each), "selected": len(each)} for each in parts]
    keys = dict.fromkeys(key for each in counts for key in each if key != "ground")
    total = {key: sum(each.get(key, 0) for each in counts) for key in keys}
    grounds = {each.get("ground", -1) for each in counts if each["selected"]}
    return total | ({"ground": grounds.pop()} if len(grounds) == 1 and -1 not in grounds else {})


def _account(
    points: Array, sizes: Sequence[int], names: Sequence[str], lines: Array | None
) -> dict[str, Any]:
    """Say of each cloud how many rows it has, and how many where earlier ones have some."""
    is_number = lines is not None and lines.ndim == 1 and lines.dtype.kind in "iu"
    shared = overlap_of(points, sizes, lines if is_number else None)
    each = zip(names, sizes, shared.rows, strict=True)
    merged = [{"source": name, "rows": rows, "overlap": count} for name, rows, count in each]
    if not is_number:
        return {"merged": merged}
    flown = {"lines": shared.lines, "overlap": shared.between, "cell": shared.cell}
    return {"merged": merged, _FLOWN: flown}


_BLOCK = 1 << 18  # rows at a time
_DENSE = 4  # cells for each row that a table may have
_FAR = 10  # times the longest side of a box: what is unlikely of tiles of one survey


@dataclass(frozen=True, slots=True)
class Overlap:
    """Rows in cells that others have, too."""

    cell: float  # the width of a cell
    rows: list[int]  # of each part, rows in cells of earlier parts
    lines: int  # flight lines
    between: int  # rows in cells of several flight lines


def overlap_of(points: Floats, sizes: Sequence[int], lines: Array | None) -> Overlap:
    """Count where parts of a cloud, and flight lines, overlap."""
    ends = np.cumsum(sizes, dtype=np.intp).tolist()
    parts = [slice(end - size, end) for end, size in zip(ends, sizes, strict=True)]
    cell = _width(points, parts)
    grid = _Grid(points, cell)
    seen, rows = np.zeros(grid.count, np.bool_), []
    for part in parts:
        rows.append(sum(int(np.count_nonzero(seen[each])) for each, _ in grid.cells(part)))
        for each, _ in grid.cells(part):
            seen[each] = True
    count, between = (0, 0) if lines is None else _between(grid, lines)
    return Overlap(cell, rows, count, between)


def distances_of(points: Floats, sizes: Sequence[int]) -> list[float]:
    """Return how far each part of a cloud is from those before it; 0 where that is not far."""
    ends = np.cumsum(sizes, dtype=np.intp).tolist()
    parts = [points[end - size : end, :2] for end, size in zip(ends, sizes, strict=True)]
    boxes = {k: _box(each) for k, each in enumerate(parts) if np.isfinite(each).all(axis=1).any()}
    far, least, most = [0.0] * len(parts), np.full(2, np.inf), np.full(2, -np.inf)
    with np.errstate(over="ignore"):
        longest = max((float((high - low).max()) for low, high in boxes.values()), default=0.0)
        for k, (low, high) in boxes.items():
            step = np.maximum(np.maximum(low - most, least - high), 0)
            distance = math.hypot(*step.tolist()) if least[0] <= most[0] else 0.0
            far[k] = distance if distance > _FAR * longest > 0 else 0.0
            least, most = np.minimum(least, low), np.maximum(most, high)
    return far


def _between(grid: _Grid, lines: Array) -> tuple[int, int]:
    """Count the flight lines, and the rows in cells of several."""
    values, numbers = np.unique(lines, return_inverse=True)
    if len(values) < 2:
        return len(values), 0
    owner, mixed = np.zeros(grid.count, np.int32), np.zeros(grid.count, np.bool_)
    everything = slice(0, len(lines))
    for cells, rows in grid.cells(everything):
        owner[cells] = numbers[rows]
    for cells, rows in grid.cells(everything):
        mixed[cells[owner[cells] != numbers[rows]]] = True
    between = sum(int(np.count_nonzero(mixed[cells])) for cells, _ in grid.cells(everything))
    return len(values), between


class _Grid:
    """Numbers the cells of rows: by place, or if these are too many, those that hold any."""

    def __init__(self, points: Floats, cell: float) -> None:
        self._points = points
        self._cell = cell
        low, high = _box(points)
        self._low = low
        with np.errstate(over="ignore", invalid="ignore"):
            across, down = np.floor((high - low) / cell) + 1
        self._width = across
        self._known: Array | None = None
        self.count = 1
        if across * down <= _DENSE * len(points) + _BLOCK:
            self.count = max(int(across * down), 1)
        else:
            self._known = np.unique(np.concatenate([k for k, _ in self._keys(slice(None))]))
            self.count = max(len(self._known), 1)

    def cells(self, part: slice) -> Iterator[tuple[Indices, Indices]]:
        """Yield the cells of finite rows of a part, and these rows, in blocks."""
        for keys, rows in self._keys(part):
            if self._known is None:
                yield keys.astype(np.intp), rows
            else:
                yield np.searchsorted(self._known, keys), rows

    def _keys(self, part: slice) -> Iterator[tuple[Floats, Indices]]:
        begin, end, _ = part.indices(len(self._points))
        for start in range(begin, end, _BLOCK):
            plane = self._points[start : min(start + _BLOCK, end), :2]
            rows = np.flatnonzero(np.isfinite(plane).all(axis=1))
            places = np.floor((plane[rows] - self._low) / self._cell)
            yield places[:, 1] * self._width + places[:, 0], rows + start


def _blocks(points: Floats) -> Iterator[Floats]:
    yield from (points[k : k + _BLOCK, :2] for k in range(0, len(points), _BLOCK))


def _box(points: Floats) -> tuple[Floats, Floats]:
    """Return the least and the largest finite coordinates."""
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for plane in _blocks(points):
        rows = np.isfinite(plane).all(axis=1)
        if rows.any():
            low = np.minimum(low, plane[rows].min(axis=0))
            high = np.maximum(high, plane[rows].max(axis=0))
    return (low, high) if low[0] <= high[0] else (np.zeros(2), np.zeros(2))


def _width(points: Floats, parts: Sequence[slice]) -> float:
    """Return twice the distance of rows that fill the boxes of their parts evenly."""
    area = longest = 0.0
    for each in parts:
        plane = points[each]
        low, high = _box(plane)
        with np.errstate(over="ignore"):
            width, height = high - low
            area += float(width * height)
        longest = max(longest, float(width), float(height))
    count = max(len(points), 1)
    cell = 2 * math.sqrt(area / count) or 2 * longest / count
    return cell if 0 < cell < math.inf else 1.0
