"""Tags of a mesh, as files for solvers have them: markers of its edges, regions of its faces.

Markers are those that the metadata state, one for each edge; edges without one (0) get the next
number. Where none are stated, the closed lines of the boundary are numbered from 1, then the lines
inside, each kind in the order of their lexicographically least points. Regions are what edges
separate, numbered in the order of their first faces, as `ConstrainedTriangulation.regions` are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Rows
from liftmesh.base.arrays import ends_of, pair_keys
from liftmesh.errors import FormatError
from liftmesh.io.columns import edges_of, faces_of
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

MARKERS = "markers"
"""The entry of the metadata with a whole number for each edge."""


def stated_markers(cloud: Cloud) -> Rows | None:
    """Return the markers that the metadata state, if they do."""
    given: Any = cloud.metadata.get(MARKERS)
    if given is None:
        return None
    count = len(edges_of(cloud))
    numbers = whole_numbers(given)
    if numbers is None or numbers.shape != (count,):
        raise FormatError(
            f"metadata {MARKERS} are no whole numbers of 32 bits, one for each of the {count:,} "
            "edges: correct or leave them out"
        )
    return numbers


def whole_numbers(given: Any) -> Rows | None:
    """Return numbers as int32; None if they are others."""
    try:
        values: Array = np.asarray(given)
    except ValueError:  # rows of several lengths
        return None
    if not values.size:
        return np.empty(values.shape, np.int32)
    is_whole = values.dtype.kind in "iu" and np.array_equal(values.astype(np.int32), values)
    return values.astype(np.int32) if is_whole else None


def positive_markers(
    cloud: Cloud, beyond: Rows, what: str, boundary: Boundary | None = None
) -> Rows:
    """Return markers as `markers_of`; raise for those that a format does not have."""
    markers = markers_of(cloud, beyond, boundary)
    if (markers < 0).any():
        raise FormatError(
            f"the marker of edge {int(markers.argmin())} is {markers.min()}, but markers of {what} "
            "are numbered from 1: give others"
        )
    return markers


def grouped(rows: Rows, tags: Rows) -> Iterator[tuple[int, Rows]]:
    """Yield each tag in ascending order, with the rows that have it."""
    order = np.argsort(tags, kind="stable")
    found, starts = np.unique(tags[order], return_index=True)
    yield from zip(found.tolist(), np.split(rows[order], starts[1:]), strict=False)


def markers_of(cloud: Cloud, beyond: Rows, boundary: Boundary | None = None) -> Rows:
    """Return a marker for each edge, and for each of some sides beyond them."""
    stated = stated_markers(cloud)
    if stated is not None:
        markers = np.concatenate([stated, np.zeros(len(beyond), np.int32)])
        markers[markers == 0] = max(int(stated.max(initial=0)), 0) + 1
        return markers
    lines = np.concatenate([edges_of(cloud), beyond])
    is_outer = (boundary or Boundary.of(cloud)).has(lines)
    markers = np.empty(len(lines), np.int32)
    markers[is_outer] = _numbered(cloud.points, lines[is_outer]) + 1
    first = int(markers[is_outer].max(initial=0)) + 1
    markers[~is_outer] = _numbered(cloud.points, lines[~is_outer]) + first
    return markers


@dataclass(frozen=True, slots=True)
class Boundary:
    """The sides that only one face has, in the order of the faces."""

    sides: Rows

    @classmethod
    def of(cls, cloud: Cloud) -> Boundary:
        """Find the boundary of a mesh."""
        faces = faces_of(cloud)
        each = np.repeat(np.arange(len(faces)), 3), np.tile(np.arange(3), len(faces))
        sides = ends_of(faces, *each)
        _, first, count = np.unique(_keys(sides), return_index=True, return_counts=True)
        return cls(sides[np.sort(first[count == 1])])

    def beyond(self, edges: Rows) -> Rows:
        """Return the sides that are no edges."""
        sides: Rows = self.sides[~np.isin(_keys(self.sides), _keys(edges))]
        return sides

    def has(self, lines: Rows) -> Mask:
        """Tell which lines are among the sides."""
        return np.isin(_keys(lines), _keys(self.sides))


def regions_of(cloud: Cloud) -> Rows:
    """Return the region of each face."""
    faces = faces_of(cloud)
    face = np.repeat(np.arange(len(faces)), 3)
    keys = _keys(ends_of(faces, face, np.tile(np.arange(3), len(faces))))
    order = np.argsort(keys, kind="stable")
    keys, face = keys[order], face[order]
    is_open = (keys[1:] == keys[:-1]) & ~np.isin(keys[1:], _keys(edges_of(cloud)))
    labels = _components(len(faces), face[:-1][is_open], face[1:][is_open])
    _, first, found = np.unique(labels, return_index=True, return_inverse=True)
    number = np.empty(len(first), np.int32)
    number[np.argsort(first)] = np.arange(len(first))
    regions: Rows = number[found]
    return regions


def _keys(lines: Rows) -> Integers:
    return pair_keys(*np.sort(lines, axis=1).T)


def _components(count: int, tails: Integers, heads: Integers) -> Integers:
    sparse = load("scipy.sparse", extra="scipy")
    graphs = load("scipy.sparse.csgraph", extra="scipy")
    graph = sparse.coo_array((np.ones(len(tails), np.bool_), (tails, heads)), (count, count))
    labels: Integers = graphs.connected_components(graph, directed=False)[1]
    return labels


def _numbered(points: Floats, lines: Rows) -> Integers:
    """Number connected lines in the order of their least points."""
    labels = _components(len(points), *lines.T)
    order, least = np.lexsort((points[:, 1], points[:, 0])), np.empty(len(points), np.intp)
    least[labels[order[::-1]]] = np.arange(len(points))[::-1]  # the last one counts
    return np.unique(least[labels[lines[:, 0]]], return_inverse=True)[1]
