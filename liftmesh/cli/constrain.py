"""``liftmesh constrain``: triangulates points in the plane with edges that the mesh contains."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import click

from liftmesh.base.options import Carve, Crossing, counted
from liftmesh.cli import inputs, options, outputs, terminal
from liftmesh.cli.options import flag, option
from liftmesh.cli.surfaces import is_table
from liftmesh.errors import FormatError, InputError

if TYPE_CHECKING:
    from liftmesh._typing import Rows
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult
    from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation

SHORT_HELP = "Triangulate points in the plane with edges that the mesh contains."
HELP = (
    "The constrained Delaunay triangulation of x and y. Corners of lines at no row become rows "
    "after those of IN. Without lines, the edges that IN has (OBJ, PLY, NPZ) are taken, and of "
    "Triangle's .poly the segments and holes."
)
EXAMPLES = [
    "liftmesh constrain survey.csv mesh.obj --edges pairs.txt",
    "liftmesh constrain plate.poly plate.ply --carve outside",
    "liftmesh constrain wells.csv land.ply --polygons coast.geojson --carve holes",
    "liftmesh constrain points.csv mesh.vtu --polylines roads.gpkg --crossing split",
]


def _lines(
    edges: Annotated[
        Path | None,
        option(
            "FILE", "Edges: two rows of IN in each line, from 0; or an OBJ, PLY, NPZ or .poly file."
        ),
    ] = None,
    polylines: Annotated[
        Path | None,
        option("FILE", "Lines (GeoJSON, GeoPackage, shapefile, DXF, the l elements of OBJ)."),
    ] = None,
    polygons: Annotated[
        Path | None, option("FILE", "Polygons, whose rings are edges, in the same formats.")
    ] = None,
    crossing: Annotated[
        Crossing, flag("Of edges that cross at no row: an error, or a new row at each crossing.")
    ] = "error",
    carve: Annotated[
        Carve | None, flag("Leave out what is outside of polygons, or in their holes, too.")
    ] = None,
) -> dict[str, Any]:
    """Return the options of lines, as `liftmesh.constrained_delaunay` has them."""
    files = options.given(edges=edges, polylines=polylines, polygons=polygons)
    for path in files.values():
        path.open("rb").close()
    return files | options.given(crossing=crossing, carve=carve)


Lines: TypeAlias = Annotated[dict[str, Any], options.Group(_lines, "Lines")]
Target: TypeAlias = Annotated[outputs.Target, outputs.target("Mesh file; - writes stdout.")]


@outputs.guards("target")
def run(
    source: options.Source,
    target: Target,
    *,
    reading: inputs.AllRows,
    nonfinite: options.SkipNonFinite = "error",
    lines: Lines,
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read points and edges, triangulate, write the mesh, and print a report."""
    target.check()
    cloud = points_of(source, reading)
    cloud, tri = triangulated(cloud, source, target, lines, nonfinite=nonfinite, threads=threads)
    with inputs.about(source):
        mesh = mesh_of(cloud, tri)
    written = target.write(mesh)
    _report(written, tri, as_json=json)


def points_of(source: Path, reading: dict[str, Any]) -> Cloud:
    """Read points, whose heights may be missing."""
    planar = {"flat": None} if is_table(source, reading.get("format")) else {}
    return inputs.read(source, {**planar, **reading})


def triangulated(
    cloud: Cloud,
    source: Path,
    target: outputs.Target,
    lines: dict[str, Any],
    *,
    needs_lines: bool = True,
    **choices: Any,
) -> tuple[Cloud, ConstrainedTriangulation]:
    """Triangulate points with the edges of files, or their own; drop where holes are to be."""
    from liftmesh.io.columns import edges_of
    from liftmesh.io.metadata import Provenance

    files, entries = {**lines}, {**cloud.metadata}
    holes = entries.pop("holes", None)  # which are made, or are of other edges
    markers = entries.pop("markers", None)
    if "edges" in lines:
        lines["edges"] = _edges(lines["edges"])
    if {"edges", "polylines", "polygons"} & lines.keys():
        if count := len(edges_of(cloud)):
            own = counted(count, "edge") + " and holes" * (holes is not None)
            own += " and markers" * (markers is not None)
            terminal.note(f"{source}: {own} of its own not taken, since lines are given")
    else:
        if cloud.edges is None and needs_lines:
            raise click.BadParameter(
                f"{source} has no edges: give --edges, --polylines or --polygons"
            )
        if not needs_lines and Provenance(cloud.metadata).carved:
            lines.setdefault("carve", "holes")
        lines |= {"edges": cloud.edges, "seeds": holes}
        entries |= {} if markers is None else {"markers": markers}
        files["edges"] = source
    cloud = replace(cloud, edges=None, metadata=entries)
    with inputs.about(source):
        target.check_content(cloud)
        with inputs.about_lines(files):
            return cloud, _triangulated(cloud, **choices, **lines)


def _edges(path: Path) -> Rows:
    """Read pairs of rows."""
    import numpy as np

    from liftmesh.io.read import read
    from liftmesh.io.text_tables import BLOCK, HASH, Lines as TextLines, exact_values, number_table

    if path.suffix.lower() in (".obj", ".ply", ".npz", ".poly"):
        edges = read(path).edges
        if edges is None or not len(edges):
            raise FormatError(f"{path} has no edges")
        return edges
    parts = []
    with path.open("rb") as stream:
        text = TextLines(stream, str(path), HASH)
        while len(block := text.take(BLOCK)):
            mark = "," if "," in block.texts[0] else None
            values = number_table(block, str(path), width=2, delimiter=mark).reshape(-1)
            line_of = [int(each) for each in np.repeat(block.numbers, 2)].__getitem__
            kind = np.dtype(np.int32)
            rows = exact_values(values, kind, str(path), "the number of a row", line_of)
            parts.append(rows.reshape(-1, 2))
    if not parts:
        raise FormatError(f"{path} has no edges: give two rows in each line")
    return np.concatenate(parts)


def _triangulated(cloud: Cloud, **choices: Any) -> ConstrainedTriangulation:
    import liftmesh

    text = f"triangulating {len(cloud):,} rows"
    with terminal.share_bar(text, len(cloud)) as progress, inputs.without_warnings():
        return liftmesh.constrained_delaunay(
            cloud.points[:, :2], order="canonical", progress=progress, **choices
        )


def mesh_of(cloud: Cloud, tri: ConstrainedTriangulation) -> Cloud:
    """Make the mesh: rows of lines have no heights, and no values."""
    from liftmesh.io.metadata import with_carved

    mesh, new = tri.to_cloud(markers=cloud.metadata.get("markers")), tri.npoints - len(cloud)
    cloud = replace(cloud, metadata={**with_carved(cloud.metadata, False), **mesh.metadata})
    if not new:
        return replace(cloud, faces=mesh.faces, edges=mesh.edges)
    if cloud.points[:, 2].any():
        raise InputError(
            f"{new:,} corners or crossings of lines are at no row, so that they have no height, "
            "but the rows have: use liftmesh triangulate --breaklines"
        )
    if cloud.attributes or cloud.colors is not None or cloud.normals is not None:
        terminal.note(f"{new:,} rows are new, and have no values: those of the others are left out")
    return replace(mesh, metadata=cloud.metadata, crs=cloud.crs)


def _report(written: WriteResult, tri: ConstrainedTriangulation, *, as_json: bool) -> None:
    counts = {
        "rows": tri.npoints,
        "added": len(tri.added),
        "crossings": len(tri.crossing_rows),
        "duplicates": len(tri.duplicates),
        "skipped": len(tri.skipped),
        "triangles": tri.nsimplex,
        "constraints": len(tri.constraints),
        "zero_length": len(tri.zero_length),
    }
    told = {**outputs.as_named(counts), "displacement": tri.displacement}
    rows = outputs.as_rows(counts)
    if len(tri.crossing_rows):
        rows.append(("displacement", f"{tri.displacement:.3g}"))
    line = f"{tri.npoints:,} vertices, {tri.nsimplex:,} triangles"
    outputs.report(written, line, told, rows, as_json=as_json)
