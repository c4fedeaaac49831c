"""Changed copies: clouds and surfaces with other values, and surfaces whose vertices were moved.

A surface whose vertices move keeps its faces. If the planar coordinates stay bit for bit, as when
heights are scaled, it keeps its triangulation too. If they change, but the triangles are those that
`delaunay` would make of the new ones, which is verified exactly, the triangulation of the copy has
the new coordinates. Else, as after smoothing, the faces become its own (`own_faces.py`), unless
they overlap. With weights or in a metric, which stay as they are, the triangles must be right, so
points that are scaled seldom keep them; those that are shifted may.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import as_coordinates, non_finite, used_rows
from liftmesh.base.colors import judged, with_depth
from liftmesh.base.options import refused
from liftmesh.crs.comparison import given_text
from liftmesh.errors import InputError
from liftmesh.io.columns import edges_of, with_used_rows
from liftmesh.io.metadata import Provenance
from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation, with_rows
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.regular import RegularTriangulation, regular
from liftmesh.planar.triangulation import Triangulation
from liftmesh.terrain.own_faces import check_faces, kept_rows, with_faces
from liftmesh.terrain.surface_data import HIDDEN, AnySurface, SurfaceData, as_cloud

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_WIDTHS = {"colors": (3, 4), "normals": (3,)}


def replaced(surface: AnySurface, *, color_depth: int | None = None, **given: Any) -> AnySurface:
    """Make a changed copy; what is not given stays.

    Parameters
    ----------
    surface : Surface
        The surface to copy.
    color_depth : int, optional
        Bits per channel that integer colours mean; by default new values decide, see `Cloud`.
    **given
        The parts that change, by name:

        - ``vertices``: (n, 3) array_like. Moved vertices, one for each row. Faces, frame and
          report stay. If the planar coordinates change, the triangles are verified exactly: if
          they are not the canonical ones of the new coordinates, as after smoothing, the faces
          are kept all the same, perhaps in another order, their sides become constraints where
          they are not Delaunay, and faces that overlap are refused, as by `as_surface`.
          Weights, radii and a metric stay as they are, and the triangles have to be canonical.
        - ``colors``: (n, 3) or (n, 4) array_like or None. New colours; None removes them.
        - ``normals``: (n, 3) array_like or None. New normals; None removes them.
        - ``attributes``: mapping of str to (n, ...) array_like. The named values, in place of
          the present ones; `with_attributes` adds to them. Those by which the surface was
          triangulated may be left out, but not changed: a file without them can be verified
          only if they are given to `verify`. What says which rows are ``hidden`` is not changed
          either.
        - ``metadata``: mapping. Information about the surface as a whole.
        - ``crs``: str, int, CRS or None. The coordinate reference system: WKT, ``EPSG:n``, or
          whatever ``pyproj.CRS.from_user_input`` takes, but texts that may name files.

    Returns
    -------
    Surface
        Shares the arrays that stay with this surface, and those given with the caller.

    Raises
    ------
    InputError
        An array does not have one row per vertex; faces of the moved vertices overlap, or rows
        that were at one position are apart, or with weights, radii or a metric the vertices have
        another triangulation: triangulate them; or weights or radii are other ones; or `crs` is
        unknown.

    See Also
    --------
    Surface.with_attributes : Further named values.
    Surface.trim : Fewer faces.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
    >>> raised = surface.vertices * (1, 1, 10)
    >>> surface.replace(vertices=raised).vertices[:, 2], surface.vertices[:, 2]
    (array([50., 60., 70.]), array([5., 6., 7.]))
    """
    parts = as_parts({name: value for name, value in given.items() if value is not ...})
    if "vertices" in parts:
        parts["vertices"] = _vertices(parts["vertices"], surface)
    if "crs" in parts:
        parts["crs"] = given_text(parts["crs"])
    if color_depth is not None:
        parts.setdefault("colors", surface.colors)
    if parts.get("colors") is not None:
        parts["colors"] = _colors(parts["colors"], surface.colors, color_depth)
    _check_lifting(surface, parts.get("attributes", {}))
    changed = replace(surface, **parts)
    as_cloud(changed)  # which checks that the parts belong together
    if "vertices" not in parts:
        return changed
    return replace(changed, **_moved(surface, changed.vertices))


def with_attributes(
    surface: AnySurface,
    attributes: Mapping[str, ArrayLike] | None,
    named: Mapping[str, ArrayLike],
) -> AnySurface:
    """Make a copy with further named values, or with others of the same names.

    Parameters
    ----------
    surface : Surface
        The surface to copy.
    attributes : mapping of str to (n, ...) array_like, or None
        Values by name, for names that are no keywords.
    named : mapping of str to (n, ...) array_like
        Further ones, one value for each vertex.

    Returns
    -------
    Surface
        As from `replaced`.

    Raises
    ------
    InputError
        An array does not have one row per vertex.

    See Also
    --------
    Surface.replace : Other vertices, colours or metadata.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
    >>> surface.with_attributes(depth=-surface.vertices[:, 2]).attributes["depth"]
    array([-5., -6., -7.])
    """
    added = as_parts({"attributes": {} if attributes is None else attributes})["attributes"]
    return replaced(surface, attributes={**surface.attributes, **added, **named})


def compacted(surface: AnySurface) -> AnySurface:
    """Make a copy without the vertices that are in no face.

    Parameters
    ----------
    surface : Surface
        The surface to copy, such as one that was trimmed.

    Returns
    -------
    Surface
        The same faces over fewer rows, in the same order; the surface itself if all are in faces.
        The values ``row`` say which row of the surface each was; if it has values of this name, as
        after a first time, these stay. Duplicates, overhangs, skipped and hidden rows are among
        those left out, so the report has none. The triangulation is that of the rows that are left.

    See Also
    --------
    Surface.trim : Leaves out faces, and keeps all vertices.
    write : Leaves them out of a file, with ``compact=True``.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[9, 2, 1], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]]
    >>> trimmed = liftmesh.triangulate(points).trim(max_edge=2)
    >>> few = trimmed.compact()
    >>> few, few.attributes["row"]
    (<Surface of 2 triangles over 4 vertices>, array([1, 2, 3, 4], dtype=int32))
    """
    cloud, used = with_used_rows(as_cloud(surface))
    if len(used) == len(surface.vertices):
        return surface
    solved = _solved_again(surface.triangulation, used)
    heights, faces = surface.frame.heights(cloud.points), np.asarray(cloud.faces)
    found = with_faces(solved, faces, heights, edges_of(cloud), "triangulate the vertices")
    report, nothing, lines = surface.report, np.empty(0, np.int32), surface.report.lines
    if lines:
        first = len(surface.vertices) - lines["rows"]
        lines = {**lines, "rows": int(np.count_nonzero(used >= first))}
    return replace(
        surface,
        vertices=cloud.points,
        faces=found.faces,
        triangulation=found.solved,
        mask=found.mask,
        colors=cloud.colors,
        normals=cloud.normals,
        attributes={"row": used, **cloud.attributes},
        report=replace(
            report,
            n_rows=len(used),
            n_used=len(used),
            n_duplicates=0,
            n_overhangs=0,
            n_skipped=0,
            n_hidden=0,
            n_unused=0,
            left_out=nothing,
            representatives=nothing,
            lines=lines,
        ),
    )


def _solved_again(old: Triangulation, rows: Rows) -> Triangulation:
    """Triangulate some rows by what all of them were triangulated by."""
    points = old.points[rows]
    if isinstance(old, RegularTriangulation):
        kind = "weights" if old.radii is None else "radii"
        values: dict[str, Any] = {kind: getattr(old, kind)[rows]}
        return regular(points, **values, order="canonical")
    return delaunay(points, order="canonical", metric=old.metric)


def _check_lifting(surface: SurfaceData, given: Mapping[str, Array]) -> None:
    """Raise for other values under the name of those by which the surface was triangulated."""
    for kind, name in Provenance(surface.metadata).lifted_by.items():
        held = getattr(surface.triangulation, kind, None)
        if kind == "metric" or held is None:
            continue
        _check_flags(surface, given)
        if name not in given:
            continue
        array = np.asarray(given[name])
        if array.dtype.kind not in "biuf" or not np.array_equal(
            array.ravel(), held, equal_nan=True
        ):
            raise InputError(
                f"the values {name!r} are the {kind} by which the surface was triangulated: "
                "triangulate it with the new ones, or give them another name"
            )


def _check_flags(surface: SurfaceData, given: Mapping[str, Array]) -> None:
    """Raise for other values under the name of those that say which rows are hidden."""
    present = surface.attributes.get(HIDDEN)
    if present is None or HIDDEN not in given or np.array_equal(given[HIDDEN], present):
        return
    raise InputError(
        f"the values {HIDDEN!r} say which rows the surface does not use: give others another name"
    )


def _colors(given: Array, present: Array | None, depth: int | None) -> Array:
    """Decide the depth of colours, unless it is given, or they are the present ones."""
    if depth is not None:
        return with_depth(given, depth)
    is_decided = present is not None and np.may_share_memory(given, present)
    return given if is_decided else judged(given)[0]


def _vertices(given: ArrayLike, surface: SurfaceData) -> Floats:
    """Check moved vertices: one for each row, finite unless the row is in no face."""
    rows = as_coordinates(given)
    if rows.shape != surface.vertices.shape:
        raise InputError(f"vertices need the shape {surface.vertices.shape}, not {rows.shape}")
    broken = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    broken = np.setdiff1d(broken, surface.triangulation.skipped)
    if len(broken):
        row = int(broken[0])
        raise non_finite(row, rows[row], skippable=False)
    return rows.astype(np.float64, copy=False)


def _moved(surface: SurfaceData, vertices: Floats) -> dict[str, Any]:
    """Return the triangulation of moved vertices: the same triangles, or one with the faces."""
    old = surface.triangulation
    planar = surface.frame.planar(vertices)
    used = np.setdiff1d(np.arange(len(vertices)), old.skipped)
    if np.array_equal(planar[used], old.points[used]):
        return {"triangulation": old}
    if len(old.skipped):
        planar = planar.copy()
        planar[old.skipped] = np.nan
    triangulation = _at(planar, old)
    row, kept = old.duplicates.T
    is_merged = np.array_equal(planar[row], planar[kept])
    if is_merged and _is_canonical(triangulation):
        return {"triangulation": triangulation}
    if not is_merged or old.metric is not None or isinstance(old, RegularTriangulation):
        raise InputError(
            "the moved vertices have another triangulation than the surface: triangulate them, "
            "or move them along the normal of the plane only"
        )
    return _with_own_faces(surface, planar, surface.frame.heights(vertices))


def _with_own_faces(surface: SurfaceData, planar: Floats, heights: Floats) -> dict[str, Any]:
    """Keep the faces, which may not overlap; rows in none of them are skipped."""
    used = used_rows(len(planar), surface.faces)
    places = np.full_like(planar, np.nan, dtype=np.float64)
    places[used] = planar[used]
    remedy = "triangulate the moved vertices"
    edges = getattr(surface.triangulation, "constraints", np.empty((0, 2), np.int32))
    check_faces(places, surface.faces, remedy)
    solved = delaunay(places, nonfinite="skip", order="canonical")
    found = with_faces(solved, surface.faces, heights, edges, remedy)
    solved = _with_merged(found.solved, planar, surface.triangulation.duplicates)
    report, merged = surface.report, len(found.solved.duplicates)  # vertices that met
    row, kept = solved.duplicates.T
    stands_for = np.full(len(planar), -1, np.int32)
    stands_for[report.left_out] = report.representatives
    stands_for[row] = kept
    left_out = np.sort(np.concatenate([solved.skipped, row]))
    return {
        "triangulation": solved,
        "faces": found.faces,
        "mask": found.mask,
        "report": replace(
            report,
            n_used=len(used) - merged,
            n_duplicates=report.n_duplicates + merged,
            n_unused=report.n_unused + report.n_used - len(used),
            left_out=left_out,
            representatives=stands_for[left_out],
        ),
    }


def _with_merged(solved: Triangulation, planar: Floats, duplicates: Rows) -> Triangulation:
    """Add the rows at the positions of vertices, as they were."""
    row, kept = duplicates[~np.isin(duplicates[:, 1], solved.skipped)].T
    if not len(row):
        return solved
    points = solved.points.copy()
    points[row] = planar[row]
    skipped = np.setdiff1d(solved.skipped, row)
    added = np.column_stack([row, kept_rows(solved)[kept]])
    duplicates = np.concatenate([solved.duplicates, added])
    duplicates = duplicates[np.argsort(duplicates[:, 0])]
    hull, names = solved.convex_hull, np.arange(len(points), dtype=np.int32)
    if isinstance(solved, ConstrainedTriangulation):
        return with_rows(solved, points, names, duplicates, hull, skipped)
    return Triangulation(points, solved.simplices, solved.neighbors, hull, duplicates, skipped)


def _at(planar: Floats, old: Triangulation) -> Triangulation:
    """The same triangulation of other points."""
    hull = _from_least(old.convex_hull, planar)
    same = (planar, old.simplices, old.neighbors, hull, old.duplicates, old.skipped)
    if isinstance(old, RegularTriangulation):
        return RegularTriangulation(*same, old.hidden, weights=old.weights, radii=old.radii)
    if isinstance(old, ConstrainedTriangulation):
        return with_rows(old, planar, np.arange(len(planar), dtype=np.int32), old.duplicates, hull)
    return Triangulation(*same, metric=old.metric)


def _is_canonical(triangulation: Triangulation) -> bool:
    """Whether the triangles are right, and the same rows hidden as before."""
    certificate = triangulation.verify()
    hidden = triangulation.hidden if isinstance(triangulation, RegularTriangulation) else ()
    return certificate.canonical and certificate.n_hidden == len(hidden)


def _from_least(hull: Rows, planar: Floats) -> Rows:
    """Let the rows of a hull begin at the lexicographically least point."""
    x, y = planar[hull].T
    return np.roll(hull, -int(np.lexsort((y, x))[0]))


def with_parts(cloud: Cloud, given: Mapping[str, Any]) -> Cloud:
    """Make a copy of a cloud with what a caller gave besides it."""
    parts = as_parts({name: value for name, value in given.items() if value is not None})
    if "colors" in parts:
        parts["color_depth"] = None  # these are decided anew
    if "attributes" in parts:
        parts["attributes"] = {**cloud.attributes, **parts["attributes"]}
    return replace(cloud, **parts) if parts else cloud


def as_parts(given: Mapping[str, Any]) -> dict[str, Any]:
    """Convert colours, normals and named values to arrays; `Cloud` checks their rows."""
    parts = dict(given)
    for name, widths in _WIDTHS.items():
        if parts.get(name) is not None:
            parts[name] = _rows(name, parts[name], widths)
    if parts.get("attributes") is not None:
        parts["attributes"] = _arrays(parts["attributes"])
    return parts


def _rows(name: str, values: Any, widths: tuple[int, ...]) -> Array:
    """Convert colours or normals: numbers in as many columns as they have."""
    array = _array(name, values)
    if array.ndim != 2 or array.shape[1] not in widths or array.dtype.kind not in "uif":
        wanted = " or ".join(f"(n, {width})" for width in widths)
        raise InputError(
            f"{name} need the shape {wanted} and numbers, not {array.shape} of {array.dtype}"
        )
    return array


def _arrays(attributes: object) -> dict[str, Array]:
    if not isinstance(attributes, Mapping):
        raise InputError(
            f"attributes are a {type(attributes).__name__}: give a dict of names and arrays"
        )
    return {name: _array(f"attribute {name!r}", each) for name, each in attributes.items()}


def _array(name: str, values: Any) -> Array:
    try:
        array: Array = np.asanyarray(values)
    except ValueError as error:
        raise InputError(f"{name} cannot be converted to an array: {error}") from error
    if array.ndim == 0:
        raise refused(name, values, "give an array with one row per point")
    return array
