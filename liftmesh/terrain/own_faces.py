"""Triangulations that have given faces, of any planar triangulation (`planar/planarity.py`).

A triangle of a Delaunay triangulation is one of every subset of the points that holds its corners,
and of a regular one, too, by whose weights the metadata of a file say that it was made. So the
corners of a mesh that was triangulated, and perhaps trimmed, have a triangulation with all its
faces: it is made again, and what the mesh does not have is masked.

Other meshes, as those that follow lines or were smoothed, have faces of their own. It is enough to
constrain the sides that the Delaunay triangulation of the corners lacks: a side that is Delaunay is
in every constrained triangulation whose edges it does not cross. The edges that the mesh states are
tried alone first. If they do not suffice, the sides that are lacking are added, and the rim, along
which `verify` takes the faces as carved. Triangles that are masked fill what lies between the faces
and around them, up to the convex hull: so location, overlays and rims need no other code.

Faces are turned counter-clockwise, whatever the order of their corners: many programs write any.
Rows at one position and height are one vertex, as in files whose triangles share none.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Integers, Mask, Rows
from liftmesh.base.arrays import pair_keys, pairs_of_keys, triangles_of_faces, used_rows
from liftmesh.base.options import OwnFaces
from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.io.columns import checked_edges, checked_faces, edges_of
from liftmesh.io.metadata import Provenance
from liftmesh.io.registry import known_formats
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.kinds import named_values
from liftmesh.planar.planarity import Conflict, first_conflict, turned
from liftmesh.planar.regular import regular
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.lifting import without_former
from liftmesh.terrain.report import Report, report_on

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.triangulation import Triangulation


class Found(NamedTuple):
    """A triangulation, and its triangles that are no faces; None if all are."""

    solved: Triangulation
    mask: Mask | None

    @property
    def faces(self) -> Rows:
        """Its other triangles."""
        simplices = self.solved.simplices
        return simplices if self.mask is None else simplices[~self.mask]


def found_in(solved: Triangulation, faces: Rows) -> Found | None:
    """Find faces in a triangulation; None if one is not there, or is there twice."""
    place = triangles_of_faces(solved.simplices, faces, solved.npoints)
    absent = np.ones(solved.nsimplex, dtype=np.bool_)
    absent[place[place >= 0]] = False
    if np.count_nonzero(~absent) < len(faces):
        return None
    return Found(solved, absent if absent.any() else None)


def with_faces(
    solved: Triangulation,  # the Delaunay triangulation of the corners; other rows are skipped
    faces: Rows,
    heights: Floats,
    edges: Rows,  # those that are sides of faces become constraints
    remedy: str,
    threads: int | None = None,
) -> Found:
    """Find faces, or make a constrained triangulation that has them; raise if there is none."""
    found = found_in(solved, faces)
    if found is None:
        faces = _checked(solved, faces, heights, remedy, threads)
        found = found_in(solved, faces)
    if found is not None and not len(edges):
        return found
    for asked in _sides(solved, faces, edges):
        if len(asked):
            ends = np.stack(pairs_of_keys(asked), axis=1).astype(np.int32)
            options = {"nonfinite": "skip", "order": "canonical", "threads": threads}
            lined = constrained_delaunay(solved.points, ends, **options)  # type: ignore[arg-type]
            found = found_in(lined, faces)
        if found is not None:
            return found
    raise AssertionError("no triangulation has the faces: a bug of liftmesh")


def _sides(solved: Triangulation, faces: Rows, edges: Rows) -> tuple[Integers, Integers]:
    """Return the sides that are edges, and these with those on the rim or in no triangle."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    sides, counts = np.unique(pair_keys(*ends.T), return_counts=True)
    is_stated = np.isin(sides, pair_keys(*np.sort(kept_rows(solved)[edges], axis=1).T))
    is_there = np.isin(sides, pair_keys(*solved.edges.T), assume_unique=True)
    return sides[is_stated], sides[is_stated | ~is_there | (counts == 1)]


def kept_rows(solved: Triangulation) -> Rows:
    """Return for each row the one that stands for its position."""
    names = np.arange(solved.npoints, dtype=np.int32)
    row, kept = solved.duplicates.T
    names[row] = kept
    return names


def check_faces(points: Floats, faces: Rows, remedy: str) -> Rows:
    """Return faces counter-clockwise; raise if one has no area."""
    corners, is_flat = turned(points, faces)
    if is_flat.any():
        face = int(is_flat.argmax())
        raise InputError(
            f"{_face(faces, face)}, has no area seen from above: it is vertical, or its corners "
            f"are on a line: leave it out, or {remedy}"
        )
    return corners


def _checked(
    solved: Triangulation, faces: Rows, heights: Floats, remedy: str, threads: int | None
) -> Rows:
    """Return faces counter-clockwise, with one row for each position; raise if they conflict."""
    corners = check_faces(solved.points, faces, remedy)
    row, kept = solved.duplicates.T
    if (is_apart := heights[row] != heights[kept]).any():
        low, high = int(kept[is_apart.argmax()]), int(row[is_apart.argmax()])
        raise InputError(
            f"rows {low} and {high} of faces are at one planar position, with the heights "
            f"{float(heights[low])!r} and {float(heights[high])!r}: a surface has one; {remedy}"
        )
    corners = kept_rows(solved).take(corners, axis=0)
    if (conflict := first_conflict(solved.points, corners, threads)) is not None:
        raise InputError(f"{_told(conflict, faces, solved.points)}{remedy}")
    return corners


def _told(conflict: Conflict, faces: Rows, points: Floats) -> str:
    """Say which two faces no surface has both of."""
    one, other = (_face(faces, each) for each in (conflict.earlier, conflict.later))
    if conflict.row is None:
        place = tuple(points[faces[conflict.later, 0]].tolist())
        return (
            f"{one}, and {other}, overlap seen from above, near {place}, and a surface has one "
            "height at each place: leave one out, or "
        )
    place = tuple(points[conflict.row].tolist())
    return (
        f"{one}, and {other}, do not fit together: row {conflict.row}, {place}, is inside a side "
        "of one of them: divide that face there, or "
    )


def _face(faces: Rows, number: int) -> str:
    return f"face {number}, of the rows {faces[number].tolist()}"


def fields_of(
    cloud: Cloud,
    plane: str | ArrayLike = "xy",
    triangulation: OwnFaces | None = None,
    threads: int | None = None,
) -> dict[str, Any]:
    """Return the fields of the surface that has the faces of a mesh."""
    if cloud.faces is None or not len(cloud.faces):
        raise InputError("there are no faces: triangulate the points")
    faces = checked_faces(cloud.faces, len(cloud), "the mesh")
    frame = resolve_plane(plane, cloud.points)
    planar = frame.planar(cloud.points).copy()
    used = used_rows(len(cloud), faces)
    _check(cloud, planar, used)
    planar[np.delete(np.arange(len(cloud)), used)] = np.nan
    remedy = _remedy(cloud)
    lifted = None
    if triangulation != "own":
        with suppress(DegenerateInputError):  # of weights that are not finite
            lifted = _lifted(cloud, planar, threads)
    found = None if lifted is None else found_in(lifted, faces)
    if found is None:
        cloud = without_former(cloud)
        edges = checked_edges(edges_of(cloud), len(cloud), "the mesh")
        solved = _solved(planar, faces, remedy, threads)
        found = with_faces(solved, faces, frame.heights(cloud.points), edges, remedy, threads)
    return {
        "vertices": cloud.points,
        "faces": found.faces,
        "triangulation": found.solved,
        "frame": frame,
        "report": _report(found, cloud),
        "colors": cloud.colors,
        "normals": cloud.normals,
        "attributes": cloud.attributes,
        "metadata": cloud.metadata,
        "crs": cloud.crs,
        "mask": found.mask,
    }


def _solved(planar: Floats, faces: Rows, remedy: str, threads: int | None) -> Triangulation:
    """Triangulate the corners, which are on a line only if no face has an area."""
    try:
        return delaunay(planar, nonfinite="skip", order="canonical", threads=threads)
    except DegenerateInputError:
        check_faces(planar, faces, remedy)
        raise


def _lifted(cloud: Cloud, planar: Floats, threads: int | None) -> Triangulation | None:
    """Triangulate the corners by what the mesh says that it was triangulated by, if anything."""
    said = Provenance(cloud.metadata).lifted_by
    if not said or "spherical" in said:
        return None
    if "metric" in said:
        form = said["metric"]
        return delaunay(planar, nonfinite="skip", order="canonical", threads=threads, metric=form)
    ((kind, name),) = said.items()
    values: dict[str, Any] = {kind: named_values(cloud, kind, name)}
    return regular(planar, **values, nonfinite="skip", order="canonical", threads=threads)


def _check(cloud: Cloud, planar: Floats, used: Rows) -> None:
    """Raise for corners that are not finite."""
    finite = np.isfinite(planar[used]).all(axis=1) & np.isfinite(cloud.points[used]).all(axis=1)
    if not finite.all():
        row = int(used[np.argmin(finite)])
        raise InputError(f"row {row} of a face is not finite: {cloud.points[row].tolist()}")


def _remedy(cloud: Cloud) -> str:
    """Say what to do about faces; of a format that rounds, what may have moved them."""
    is_read = Provenance(cloud.metadata).is_read
    origin = known_formats().get(cloud.metadata["format"]) if is_read else None
    if origin is None or "float64" in origin.keeps:
        return "triangulate the vertices"
    return (
        "triangulate the vertices; the file holds single precision, which has moved them: write "
        "PLY for faces that are found again"
    )


def _report(found: Found, cloud: Cloud) -> Report:
    row, kept = found.solved.duplicates.T
    unused = len(found.solved.skipped)
    left_out = np.sort(np.concatenate([found.solved.skipped, row]))
    representatives = np.full(len(left_out), -1, dtype=np.int32)
    representatives[np.searchsorted(left_out, row)] = kept
    return report_on(
        cloud,
        n_used=len(cloud) - len(left_out),
        n_duplicates=len(row),
        n_overhangs=0,
        n_skipped=0,
        n_triangles=len(found.faces),
        policy="error",
        seconds={},
        left_out=left_out,
        representatives=representatives,
        n_unused=unused,
    )
