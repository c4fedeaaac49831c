"""`Cloud`, the type that the rooms exchange: points with per-row values, and faces if any."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

from liftmesh._typing import Array, Floats, Rows
from liftmesh.color_depth import judged, with_depth
from liftmesh.errors import InputError


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """Points in space with values per row; with ``faces``, a mesh.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        Coordinates, one row per point.
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
        written if the format supports it, but not interpreted.
    color_depth : int, optional
        Bits per channel that the numbers of integer colours mean: 8, 16, 32 or 64. By default the
        values decide, and this field says what they decided: None if there was nothing to decide.
        Parts of a cloud keep the depth of the whole.

    Raises
    ------
    InputError
        An array does not have one row per point, ``crs`` is not a string, or a colour is too large
        for ``color_depth``.

    Examples
    --------
    >>> import numpy as np
    >>> cloud = Cloud(np.zeros((4, 3)), attributes={"intensity": np.arange(4)})
    >>> len(cloud), sorted(cloud.attributes)
    (4, ['intensity'])
    """

    points: Floats
    colors: Array | None = None
    normals: Array | None = None
    attributes: Mapping[str, Array] = field(default_factory=dict)
    faces: Rows | None = None
    metadata: Mapping[str, Any] = field(default_factory=dict)
    crs: str | None = None
    color_depth: int | None = None

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 3:
            raise InputError(f"a cloud needs points of shape (n, 3), not {self.points.shape}")
        for name, values in self._per_row():
            if len(values) != len(self.points):
                raise InputError(
                    f"{name} has {len(values)} rows for {len(self.points)} points: "
                    "give one row per point"
                )
        if self.crs is not None and not is_crs(self.crs):
            raise InputError(f"crs is {self.crs!r}: give WKT or 'EPSG:n' as a string, or None")
        self._decide_depth()
        object.__setattr__(self, "attributes", MappingProxyType(dict(self.attributes)))
        object.__setattr__(self, "metadata", MappingProxyType(dict(self.metadata)))

    def __reduce__(self) -> tuple[Any, ...]:
        return constructed_from(self)

    def __len__(self) -> int:
        return len(self.points)

    def _decide_depth(self) -> None:
        """Convert integer colours to the type of their depth; 8-bit ones have it already."""
        colors, depth = self.colors, self.color_depth
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
        """Select rows with all their values, without the faces.

        Parameters
        ----------
        which : slice or ndarray
            Rows, or a mask of them, as in NumPy indexing.

        Returns
        -------
        Cloud
            The selected rows in the given order; slices share memory with this cloud.

        Examples
        --------
        >>> import numpy as np
        >>> Cloud(np.eye(3)).select(slice(1, None)).points
        array([[0., 1., 0.],
               [0., 0., 1.]])
        """
        return replace(
            self,
            points=self.points[which],
            colors=None if self.colors is None else self.colors[which],
            normals=None if self.normals is None else self.normals[which],
            attributes={name: values[which] for name, values in self.attributes.items()},
            faces=None,
        )

    def _per_row(self) -> list[tuple[str, Array]]:
        named = [("colors", self.colors), ("normals", self.normals), *self.attributes.items()]
        return [(name, values) for name, values in named if values is not None]


def is_crs(value: object) -> bool:
    """Whether a value can be a `Cloud.crs`: a text that is not empty and holds no NUL.

    >>> is_crs("EPSG:25832"), is_crs(25832)
    (True, False)
    """
    return isinstance(value, str) and bool(value) and "\0" not in value


def constructed_from(result: Any) -> tuple[Any, ...]:
    """Pickle a frozen dataclass by its class and fields, read-only mappings as dictionaries.

    Parameters
    ----------
    result : dataclass instance
        All its fields are arguments of its constructor.

    Returns
    -------
    tuple
        The value for ``__reduce__`` to return.

    Examples
    --------
    >>> import copy
    >>> import numpy as np
    >>> copy.deepcopy(Cloud(np.zeros((1, 3)), metadata={"epsg": 25832})).metadata["epsg"]
    25832
    """
    values = (getattr(result, each.name) for each in fields(result))
    return type(result), tuple(
        dict(value) if isinstance(value, MappingProxyType) else value for value in values
    )
