"""`Cloud`, the type that the rooms exchange: points with per-row values, and faces if any."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import as_rows3, planar_bounds
from liftmesh.base.colors import check_depth, judged, with_depth
from liftmesh.base.frozen import FrozenDict, FrozenResult
from liftmesh.base.options import counted, refused, shown
from liftmesh.errors import InputError

_MOST_NAMED = 8  # in a short form


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Cloud(FrozenResult):
    """Points in space with values per row; with ``faces``, a mesh.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        Coordinates, one row per point. Integers are converted if float64 holds them exactly.
    colors : (n, 3) or (n, 4) ndarray, optional
        RGB or RGBA: integers of any type, or floats in [0, 1]. Integers wider than 8 bits, such as
        those of LAS files, are 8-bit colours if none exceeds 255, 16-bit colours if none exceeds
        65,535, and else use the full range of their type.
    normals : (n, 3) ndarray of float, optional
        Normal vectors.
    attributes : mapping of str to (n, ...) ndarray
        Further named values, one row per point: intensity, classification and so on.
    faces : (m, 3) ndarray of int32, optional
        Triangles as rows of ``points``.
    metadata : mapping
        Information about the cloud as a whole: comments of a file, its path.
    crs : str, optional
        The coordinate reference system of the points, as WKT or ``EPSG:n``: passed along, and
        written if the format supports it.
    color_depth : int, optional
        Bits per channel that the numbers of integer colours mean: 8, 16, 32 or 64. By default the
        values decide, and this field says what they decided: None if there was nothing to decide,
        as for unsigned 8-bit integers, whatever is given. Parts of a cloud keep the depth of the
        whole.
    edges : (k, 2) ndarray of int32, optional
        Edges between rows of ``points``, such as the breaklines that faces follow.

    Raises
    ------
    InputError
        An array does not have one row per point, a part has another shape or type, or a colour is
        too large for ``color_depth``.

    See Also
    --------
    as_cloud : Convert objects of other libraries.
    read : Read a file.
    Surface : A cloud that is triangulated.

    Examples
    --------
    >>> import numpy as np
    >>> cloud = Cloud(np.zeros((4, 3)), attributes={"intensity": np.arange(4)})
    >>> cloud
    <Cloud of 4 points, intensity>
    """

    points: Floats
    colors: Array | None = None
    normals: Array | None = None
    attributes: Mapping[str, Array] = field(default_factory=dict)
    faces: Rows | None = None
    metadata: Mapping[str, Any] = field(default_factory=dict)
    crs: str | None = None
    color_depth: int | None = None
    edges: Rows | None = None

    def __post_init__(self) -> None:
        self._take_points()
        self._check_parts()
        if self.crs is not None and not is_crs(self.crs):
            raise refused("crs", self.crs, "give WKT or 'EPSG:n' as a string, or None")
        self._decide_depth()
        object.__setattr__(self, "attributes", FrozenDict(self.attributes))
        object.__setattr__(self, "metadata", FrozenDict(self.metadata))

    def _take_points(self) -> None:
        """Check the points, and convert numbers other than float64 and float32."""
        points = self.points
        _check_array("points", points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise InputError(f"a cloud needs points of shape (n, 3), not {points.shape}")
        if points.dtype.kind not in "fiu":
            raise InputError(f"a cloud needs points of float64, not of {points.dtype}")
        if points.dtype not in (np.float64, np.float32):
            object.__setattr__(self, "points", as_rows3(points))

    def _check_parts(self) -> None:
        """Check types, shapes and names; the values are for those who use them."""
        _check_mapping("metadata", self.metadata)
        _check_mapping("attributes", self.attributes)
        _check_names(self.attributes)
        _check_columns("colors", self.colors, (3, 4))
        _check_columns("normals", self.normals, (3,))
        if self.faces is not None:
            _check_array("faces", self.faces)
        _check_columns("edges", self.edges, (2,))
        for name, values in self._per_row():
            _check_array(name, values)
            if len(values) != len(self.points):
                raise InputError(
                    f"{name} has {counted(len(values), 'row')} for "
                    f"{counted(len(self.points), 'point')}: "
                    "give one row per point"
                )

    def __repr__(self) -> str:
        return f"<Cloud of {', '.join(self._contents())}>"

    def _contents(self) -> list[str]:
        """Say in words what there is, of many named values the first."""
        count = len(self)
        words = [f"{count:,} point" if count == 1 else f"{count:,} points"]
        if self.faces is not None:
            words.append(f"{len(self.faces):,} face" + ("s" if len(self.faces) != 1 else ""))
        if self.edges is not None and len(self.edges):
            words.append(counted(len(self.edges), "edge"))
        names = [name for name, _ in self._per_row()]
        words += names[:_MOST_NAMED]
        if len(names) > _MOST_NAMED:
            words.append(f"{len(names) - _MOST_NAMED} more named values")
        return words if self.crs is None else [*words, f"crs {shown(self.crs)}"]

    def __len__(self) -> int:
        return len(self.points)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest rectangle of all rows whose x and y are finite: xmin, ymin, xmax, ymax.

        Four NaN if there is no such row.
        """
        return planar_bounds(self.points[:, :2])

    def _decide_depth(self) -> None:
        """Convert integer colours to the type of their depth; 8-bit ones have it already."""
        colors, depth = self.colors, self.color_depth
        check_depth(depth)
        if colors is None or colors.dtype.kind not in "iu":
            depth = None
        elif depth is None:
            colors, depth = judged(colors)
        elif colors.dtype.itemsize == 1 and colors.dtype.kind == "u":
            depth = 8 if depth == 8 else None  # colours that replaced those of another depth
        else:
            colors = with_depth(colors, depth)
        object.__setattr__(self, "colors", colors)
        object.__setattr__(self, "color_depth", depth)

    def with_color_depth(self, depth: int) -> Cloud:
        """Take the numbers of integer colours as those of another depth.

        Parameters
        ----------
        depth : int
            Bits per channel: 8, 16, 32 or 64.

        Returns
        -------
        Cloud
            The same cloud; its colours are the same numbers as unsigned integers of that depth.
            Colours that are floats stay as they are.

        Raises
        ------
        InputError
            The depth is another, or a colour is too large for it; the message gives the row.

        See Also
        --------
        read : Takes `color_depth`, too.

        Examples
        --------
        >>> import numpy as np
        >>> dark = Cloud(np.zeros((1, 3)), colors=np.array([[0, 51, 255]], dtype=np.uint16))
        >>> dark.colors, dark.color_depth
        (array([[  0,  51, 255]], dtype=uint8), 8)
        >>> dark.with_color_depth(16).colors
        array([[  0,  51, 255]], dtype=uint16)
        """
        colors = None if self.colors is None else with_depth(self.colors, depth)
        return replace(self, colors=colors, color_depth=depth)

    def select(self, which: slice | Array) -> Cloud:
        """Select rows with all their values, without faces.

        Edges stay if both of their ends do.

        Parameters
        ----------
        which : slice or ndarray
            Rows, or a mask of them, as in NumPy indexing.

        Returns
        -------
        Cloud
            The selected rows in the given order; slices share memory with this cloud.

        Raises
        ------
        InputError
            There are no such rows, or an edge has an end that is no row.

        See Also
        --------
        thin : Keep few rows of a cloud.
        read : Read rows that are selected.

        Examples
        --------
        >>> import numpy as np
        >>> Cloud(np.eye(3)).select(slice(1, None)).points
        array([[0., 1., 0.],
               [0., 0., 1.]])
        """
        try:
            points = self.points[which]
            edges = None if self.edges is None else self._edges_among(which)
        except (IndexError, TypeError, ValueError) as error:
            raise InputError(
                f"rows {shown(which)} cannot be selected of {len(self)}: {error}"
            ) from error
        return replace(
            self,
            points=points,
            colors=None if self.colors is None else self.colors[which],
            normals=None if self.normals is None else self.normals[which],
            attributes={name: values[which] for name, values in self.attributes.items()},
            faces=None,
            edges=edges,
        )

    def _edges_among(self, which: slice | Array) -> Rows:
        """Return the edges of which both ends are selected; of a row selected twice, the first."""
        rows = np.atleast_1d(np.arange(len(self))[which])
        place = np.full(len(self), -1, np.int32)
        place[rows[::-1]] = np.arange(len(rows), dtype=np.int32)[::-1]
        edges = np.asarray(self.edges)
        if len(wrong := np.flatnonzero(((edges < 0) | (edges >= len(self))).any(axis=1))):
            raise InputError(
                f"edge {wrong[0]} of the cloud is {edges[wrong[0]].tolist()}: "
                f"give rows from 0 to {len(self) - 1}"
            )
        ends = place.take(edges, axis=0)
        found: Rows = ends[(ends >= 0).all(axis=1)]
        return found

    def _per_row(self) -> list[tuple[str, Array]]:
        named = [("colors", self.colors), ("normals", self.normals), *self.attributes.items()]
        return [(name, values) for name, values in named if values is not None]


def _check_array(name: str, values: object) -> None:
    if not isinstance(values, np.ndarray):
        raise InputError(
            f"{name} of a cloud are a {type(values).__name__}: give a NumPy array; "
            "liftmesh.as_cloud takes lists and other objects of points"
        )
    if values.ndim == 0:
        raise InputError(f"{name} of a cloud are one value: give an array of one row per point")


def _check_columns(name: str, values: Array | None, widths: tuple[int, ...]) -> None:
    """Check an array of numbers in columns."""
    if values is None:
        return
    _check_array(name, values)
    if values.ndim != 2 or values.shape[1] not in widths or values.dtype.kind not in "uif":
        shapes = " or ".join(f"(n, {width})" for width in widths)
        raise InputError(
            f"{name} of a cloud need the shape {shapes} and numbers, not {values.shape} of "
            f"{values.dtype}"
        )


def _check_mapping(name: str, values: object) -> None:
    if not isinstance(values, Mapping):
        raise InputError(
            f"{name} of a cloud are a {type(values).__name__}: give a dict of names and values"
        )


def _check_names(attributes: Mapping[Any, Array]) -> None:
    for name in attributes:
        if not isinstance(name, str):
            raise InputError(f"an attribute of a cloud is named {shown(name)}: give a string")


def is_crs(value: object) -> bool:
    """Whether a value can be a `Cloud.crs`: a text that is not empty and holds no NUL."""
    return isinstance(value, str) and bool(value) and "\0" not in value
