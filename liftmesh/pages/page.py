"""`Page`: layers of faces, lines, points or tetrahedra in one HTML file that needs no network.

What the page carries is a header as JSON and arrays as deflated bytes; its script draws them by
three.js. The script is `page.js`, which ``python scripts/page`` makes of its sources there. Names
and values of the data stand in the header alone, where no character can end it, and the page's
policy lets no other script run and nothing be loaded.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from html import escape
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.io.atomic import replacing
from liftmesh.io.streams import check_suffix

Palette: TypeAlias = Literal["terrain", "values", "difference"]
Kind: TypeAlias = Literal["faces", "lines", "points", "tetrahedra"]
HERE = Path(__file__).parent
SUFFIXES = (".html", ".htm")
_LEVEL = 6  # of zlib: higher ones take three times as long for a hundredth


@dataclass(frozen=True)
class Values:
    """What colours a layer: numbers of its points, or their heights where there are none."""

    name: str
    numbers: Array | None = None
    unit: str | None = None
    palette: Palette = "values"


@dataclass(frozen=True)
class Layer:
    """Cells over points, with what may colour them."""

    name: str
    kind: Kind
    points: Floats
    cells: Array | None = None
    neighbors: Array | None = None  # of tetrahedra
    rows: Array | None = None  # of points in the caller's data, if they are others
    colors: Array | None = None  # (n, 3) of uint8
    values: Sequence[Values] = ()
    style: Mapping[str, Any] = field(default_factory=dict)
    note: str = ""


class Page:
    """What `view` makes: a page to save, or for a notebook, which shows it.

    Parameters
    ----------
    layers : sequence of Layer
        What is drawn.
    title : str
        Heading of the page.
    notes : sequence of str, optional
        Lines below it.
    unit : str, optional
        Of lengths.

    See Also
    --------
    view : Makes pages of surfaces and other results.

    Examples
    --------
    >>> import liftmesh
    >>> page = liftmesh.view(liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]))
    >>> page
    <Page "Surface": 1 layer>
    """

    def __init__(
        self,
        layers: Sequence[Layer],
        title: str,
        *,
        notes: Sequence[str] = (),
        unit: str | None = None,
    ) -> None:
        self.layers = tuple(layers)
        self.title = title
        self._about = {"title": title, "notes": [*notes], "unit": unit}

    def __repr__(self) -> str:
        count = len(self.layers)
        return f'<Page "{self.title}": {count} layer{"s" * (count != 1)}>'

    def to_html(self) -> str:
        """Return the whole page as text.

        Returns
        -------
        str
            HTML, in which all characters outside ASCII are of the title or the script.

        See Also
        --------
        Page.save : Writes it to a file.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
        >>> liftmesh.view(surface).to_html()[:15]
        '<!doctype html>'
        """
        header, arrays = self._packed()
        script = _file("page.js")
        parts = {
            "hash": "sha256-" + base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
            "title": escape(self.title),
            "header": header,
            "arrays": arrays,
            "script": script,
        }
        first, *rest = _file("page.html").split("{{")
        return first + "".join(parts[name] + text for name, text in (x.split("}}") for x in rest))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page to a file, as a whole or not at all.

        Parameters
        ----------
        path : path
            Ends with ``.html`` or ``.htm``; a file that is there is replaced.

        Raises
        ------
        FormatError
            The name ends otherwise.
        OSError
            The file cannot be written.

        See Also
        --------
        Page.to_html : The same as text.

        Examples
        --------
        >>> import liftmesh, os, tempfile
        >>> page = liftmesh.view(liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     page.save(os.path.join(folder, "page.html"))
        ...     os.listdir(folder)
        ['page.html']
        """
        check_page(path)
        text = self.to_html().encode()
        with replacing(path) as stream:
            stream.write(text)

    def _repr_html_(self) -> str:
        """Show it in a notebook."""
        frame = 'style="width: 100%; height: 560px; border: 0"'
        # What other programs put into pages of theirs they may indent, and widen its tabs: then
        # the script is not the one that the page allows.
        text = escape(self.to_html()).replace("\t", "&#9;").replace("\n", "&#10;")
        return f'<iframe {frame} sandbox="allow-scripts" srcdoc="{text}"></iframe>'

    def _packed(self) -> tuple[str, str]:
        """The header, and the arrays that it names."""
        packed = _Arrays()
        origin = _origin([layer.points for layer in self.layers])
        layers = [packed.layer(each) for each in self.layers]
        about = {**self._about, "origin": origin, "layers": layers, "arrays": packed.known}
        # As JSON in HTML: "</script" and "<!--" would end or change what the script reads.
        text = json.dumps(about, allow_nan=False).replace("<", "\\u003c")
        return text, base64.b64encode(b"".join(packed.parts)).decode()


def check_page(path: str | os.PathLike[str]) -> None:
    """Raise if the name of a file is none of a page."""
    check_suffix(path, SUFFIXES, "pages")


class _Arrays:
    """Arrays of a page, deflated one after the other."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.known: list[dict[str, Any]] = []
        self._size = 0

    def layer(self, layer: Layer) -> dict[str, Any]:
        """Add those of a layer; what is told of it."""
        about: dict[str, Any] = {
            "name": layer.name,
            "kind": layer.kind,
            "style": dict(layer.style),
            "note": layer.note,
            "points": self.add(layer.points, "f8"),
            "values": [self._values(layer, each) for each in layer.values],
        }
        whole = {"cells": layer.cells, "neighbors": layer.neighbors, "rows": layer.rows}
        about |= {name: self.add(a, "i4") for name, a in whole.items() if a is not None}
        if layer.colors is not None:
            about["colors"] = self.add(layer.colors, "u1")
        return about

    def _values(self, layer: Layer, values: Values) -> dict[str, Any]:
        numbers = layer.points[:, 2] if values.numbers is None else values.numbers
        about: dict[str, Any] = {
            "name": values.name,
            "unit": values.unit,
            "palette": values.palette,
            "range": _range(numbers, is_signed=values.palette == "difference"),
        }
        if values.numbers is not None:
            about["array"] = self.add(values.numbers, "f4")
        return about

    def add(self, array: Array, kind: str) -> int:
        """Add an array; its number."""
        flat = np.ascontiguousarray(array, f"<{kind}").reshape(-1)
        if kind == "i4":  # steps, which are small
            flat = np.diff(flat, prepend=flat[:0].dtype.type(0))
        planes = flat.view(np.uint8).reshape(-1, flat.itemsize).T
        part = zlib.compress(planes.tobytes(), _LEVEL)
        first, self._size = self._size, self._size + len(part)
        self.known.append({"type": kind, "length": len(flat), "first": first, "last": self._size})
        self.parts.append(part)
        return len(self.known) - 1


def _origin(clouds: Sequence[Floats]) -> list[float]:
    """The middle of all points, as a round number: coordinates relative to it are small."""
    clouds = [each for each in clouds if len(each)]
    if not clouds:
        return [0.0, 0.0, 0.0]
    low = np.min([each.min(axis=0) for each in clouds], axis=0)
    high = np.max([each.max(axis=0) for each in clouds], axis=0)
    middle = low / 2 + high / 2
    size = float(np.max(high / 2 - low / 2))
    step = 2.0 ** math.floor(math.log2(size)) if size > 0 else 0.0
    return (np.round(middle / step) * step if step else middle).tolist()  # type: ignore[no-any-return]


def _range(numbers: Array, *, is_signed: bool) -> list[float]:
    """Where colours begin and end: all but the outermost hundredths."""
    finite = np.asarray(numbers, float)[np.isfinite(numbers)]
    if len(finite) == 0:
        return [0.0, 1.0]
    low, high = np.percentile(finite, [0.5, 99.5]).tolist()
    if is_signed:
        high = max(-low, high)
        low = -high
    return [low, high] if high > low else [low - 0.5, low + 0.5]


@cache
def _file(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")
