"""Clouds that hypothesis draws: every type, odd names, and values that careless hands change."""

from __future__ import annotations

from typing import Any

import hypothesis.extra.numpy as hnp
import hypothesis.strategies as st
import numpy as np
from hypothesis.strategies import SearchStrategy

from liftmesh import Cloud
from liftmesh.io.metadata import Label, NotedColumns, Unread

Array = np.ndarray[Any, np.dtype[Any]]

NAMES = (
    *("intensity", "class", "Scan Angle", "scalar field #1", "Höhe", "Ho\u0308he", "1st", "🦎"),
    *("x", "X", "y", "POINT_X", "z", "depth", "Easting", "lon", "h", "e", "n", "red", "Red", "r"),
    *("nx", "alpha", "a", "normals", "positions", "colors", "points", "faces", "vertices", "crs"),
    *("metadata", "liftmesh", "a_0", "a_1", "a b", "a_b", "A B", "_ID", "_id", "id", "column_4"),
    *("", " lead", "tab\tname", "line\nname", 'quote"', "comma,name", "semi;colon", "#hash", "//x"),
    *("property", "element", "end_header", "vertex_indices", "nodata", "END", "count", "position"),
    *("../up", "a/b", "a\\b", "nul\0name", "\ud800", "alpha_1", "x_1", "nan", "1.5", "long" * 80),
)
TYPES = ("?", *("i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"), *("f2", "f4", "f8"), ">i4", ">f8")
OTHERS = ("U3", "M8[D]", "c16", "f16", "S2")
KEYS = ("survey", "Höhe", "comments", "obj_info", "metadata", "extras", "crs", "liftmesh", "name",
        "node", "processed", "flight_lines", "simplification", "")  # fmt: skip
# What readers note, and other libraries leave: each key with the values that it has there.
NOTES: dict[str, tuple[Any, ...]] = {
    "source": ("survey 2024", Label("tile.laz")),
    "format": ("paper", Label("las"), "las"),
    "not_read": (("texture",), Unread(["texture"]), ["a"], ("a", 1)),
    "columns": (NotedColumns(x="E", y="N"), {"x": "E", "y": "N"}, "x,y"),
    "notes": (("x is 'E'",), "by hand", 5),
    "origin": ([1.0, 2.0, 0.0], (0, 0, 0)),
    "selection": ({"rows": 9, "selected": 3, "ground": 1}, {"rows": "9"}),
    "merged": ([{"source": "a", "rows": 3, "overlap": 0}], "twice"),
    "ground": ({"rows": 9, "ground": 3}, "clay"),
    "thinning": ({"n_rows": 9, "n_kept": 3}, True),
    "transformation": ({"operation": "noop", "accuracy": None}, "by hand"),
    "stated_crs": ("EPSG:25832",),
    "polygons": (3, "none"),
    "degenerate_faces": (1,),
    "triangulated_by": ({"metric": [[1, 0], [0, 1]]}, {"weights": "w"}, "hand"),
    "file_name": ("a.glb",),
    "file_path": ("folder/a.glb",),
    "gltf_extensions": ({}, {"KHR_x": {}}),
}
SYSTEMS = ("EPSG:25832", 'PROJCRS["ETRS89 / Gauß",\n  "two lines\\and \x07"]', " ", "\ud800")

_SPECIAL = (0.0, -0.0, 1.0, 0.1, -9999.0, 5e-324, 1e-310, 1e308, 450000.123, 5.2e6 + 1 / 3, 2.0**53)
_USUAL = st.integers(-1000, 1000).map(lambda k: k / 8)
_FINITE = st.one_of(_USUAL, st.sampled_from(_SPECIAL), st.floats(-1e6, 1e6))
_ANY = st.one_of(_FINITE, st.floats())

_JSON = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(-(2**70), 2**70), st.floats(), st.text()),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=3), inner, max_size=3)
    ),
    max_leaves=4,
)


def numbers(dtype: str, shape: tuple[int, ...]) -> SearchStrategy[Array]:
    """Values of a type: any, or all of them few."""
    few = {"i": [0, 1, -1, 255], "u": [0, 1, 255], "f": [*_SPECIAL[:6], float("nan")]}
    kind = np.dtype(dtype).kind
    if kind == "M":  # of the years that pandas knows
        return hnp.arrays(np.int16, shape).map(lambda days: days.astype(dtype))
    usual = hnp.arrays(dtype, shape)
    if kind not in few:
        return usual
    held = [each for each in few[kind] if kind != "i" or each < 128]
    with np.errstate(all="ignore"):
        values = np.array(held).astype(dtype)
    return st.one_of(usual, hnp.arrays(dtype, shape, elements=st.sampled_from([*values])))


@st.composite
def clouds(draw: st.DrawFn, *, most: int = 5) -> Cloud:
    """A cloud or a mesh with any of the parts that a cloud can have."""
    rows = draw(st.integers(0, most) if draw(st.integers(0, 9)) == 0 else st.integers(3, most))
    elements = _ANY if draw(st.integers(0, 5)) == 0 else draw(st.sampled_from([_USUAL, _FINITE]))
    colors = draw(st.none() | _colors(rows))
    wide = colors is not None and colors.dtype.kind in "iu" and colors.dtype != np.uint8
    return Cloud(
        draw(hnp.arrays(np.float64, (rows, 3), elements=elements)),
        colors=colors,
        color_depth=draw(_depths(colors)) if wide and colors is not None else None,
        normals=draw(st.none() | _normals(rows)),
        attributes=draw(st.dictionaries(_names(), _attributes(rows), max_size=3)),
        faces=draw(st.none() | _faces(rows)) if rows > 2 else None,
        metadata=draw(_metadata()),
        crs=draw(st.none() | st.sampled_from(SYSTEMS)),
        edges=draw(st.none() | hnp.arrays("i4", (2, 2), elements=st.integers(0, rows - 1)))
        if rows
        else None,
    )


@st.composite
def _metadata(draw: st.DrawFn) -> dict[str, Any]:
    """Entries of a caller, and those of readers and libraries: any, or as `read` leaves them."""
    found = draw(st.dictionaries(st.sampled_from(KEYS), _entries(), max_size=2))
    keys = draw(st.lists(st.sampled_from([*NOTES]), max_size=3))
    found |= {key: draw(st.sampled_from(NOTES[key]) | _entries()) for key in keys}
    if draw(st.integers(0, 3)) == 0:
        found |= {"source": Label("tile.laz"), "format": Label("las")}
    return found


def _names() -> SearchStrategy[str]:
    return st.one_of(st.sampled_from(NAMES), st.sampled_from(NAMES[:10]), st.text(max_size=6))


@st.composite
def _attributes(draw: st.DrawFn, rows: int) -> Array:
    dtype = draw(st.sampled_from(OTHERS if draw(st.integers(0, 7)) == 0 else TYPES))
    shape = draw(st.sampled_from([(rows,)] * 5 + [(rows, 1), (rows, 2), (rows, 5), (rows, 2, 2)]))
    return draw(numbers(dtype, shape))


@st.composite
def _colors(draw: st.DrawFn, rows: int) -> Array:
    dtype = draw(st.sampled_from(["u1", "u1", "u2", "u4", "u8", "i8", "f2", "f4", "f8"]))
    shape = rows, draw(st.sampled_from([3, 3, 4]))
    if dtype[0] != "f":
        top = min(draw(st.sampled_from([1, 2, 255, 65535, 2**64 - 1])), np.iinfo(dtype).max)
        top = min(top, 65535) if dtype == "i8" else top
        return draw(hnp.arrays(dtype, shape, elements=st.integers(0, top)))
    width = 8 * np.dtype(dtype).itemsize
    shades = st.integers(0, 255).map(lambda k: np.dtype(dtype).type(k / 255))
    near = st.integers(1, 254).map(lambda k: np.dtype(dtype).type(k / 255 + 4e-7))
    kind = draw(st.sampled_from([shades, near, st.floats(0, 1, width=width)]))  # type: ignore[call-overload]
    return draw(hnp.arrays(dtype, shape, elements=kind))


@st.composite
def _depths(draw: st.DrawFn, colors: Array) -> int | None:
    """None, or a depth that holds the colours."""
    top = int(colors.max(initial=0))
    fitting = [depth for depth in (8, 16, 32, 64) if top < 2**depth]
    return draw(st.none() | st.sampled_from(fitting))


@st.composite
def _normals(draw: st.DrawFn, rows: int) -> Array:
    dtype = draw(st.sampled_from(["f4", "f8"]))
    if draw(st.booleans()):
        return draw(hnp.arrays(dtype, (rows, 3)))
    unit = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, -0.0], [0, 0.6, 0.8], [1, 1, 1]])
    unit[4] /= np.sqrt(3)
    which = draw(st.lists(st.integers(0, 4), min_size=rows, max_size=rows))
    return unit[which].astype(dtype).reshape(rows, 3)


@st.composite
def _faces(draw: st.DrawFn, rows: int) -> Array:
    row = st.integers(0, rows - 1)
    corners = st.tuples(row, row, row)
    if draw(st.integers(0, 5)):
        corners = corners.filter(lambda face: len({*face}) == 3)
    return np.array(draw(st.lists(corners, max_size=3)), dtype=np.int32).reshape(-1, 3)


def _entries() -> SearchStrategy[Any]:
    lines = st.lists(st.text(max_size=8), max_size=3).map(tuple)
    return st.one_of(st.text(max_size=8), lines, _JSON, st.just({1, 2}), st.just(np.float32(0.1)))
