"""``liftmesh refine``: triangles of good shape and size, from points, edges or polygons."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import click

from liftmesh.cli import constrain, inputs, options, outputs, surfaces, terminal
from liftmesh.cli.options import flag, option, positive, whole
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult
    from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation
    from liftmesh.planar.refined import RefineResult
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Triangles of good shape and size, by points that are added."
HELP = (
    "Points are added until no angle is smaller and no triangle larger than asked for. IN holds "
    "polygons, or points whose edges are kept (OBJ, PLY, NPZ, Triangle's .poly), or lines are "
    "given; or it is a surface, as of liftmesh triangulate, or a cloud with heights, which becomes "
    "one: points that are added have its heights. Triangles that stay below the angle, or "
    "too large, are counted."
)
EXAMPLES = [
    "liftmesh refine coast.geojson mesh.vtu --min-angle 30 --max-area 5",
    "liftmesh refine plate.poly plate.ply --carve outside --size 0.5",
]
_POLYGONS = (".geojson", ".json", ".gpkg", ".shp")


def _wanted(
    min_angle: Annotated[
        float, option("DEGREES", "The smallest angle, up to 45; 0 for none.", options.distance)
    ] = 30.0,
    max_area: Annotated[
        float | None, option("AREA", "The largest area of a triangle.", positive)
    ] = None,
    size: Annotated[float | None, option("LENGTH", "The length of edges.", positive)] = None,
    conforming: Annotated[bool, flag("Triangles are Delaunay also across edges.")] = False,
    max_points: Annotated[
        int | None, option("N", "The most points to be added, by default 10,000,000.", whole(0))
    ] = None,
    smooth: Annotated[
        int, option("ROUNDS", "How often added points move to better places.", whole(0))
    ] = 0,
) -> dict[str, Any]:
    """Return what is asked for, as `liftmesh.refine` has it."""
    bounds = options.given(max_area=max_area, size=size, max_points=max_points)
    return {"min_angle": min_angle, "conforming": conforming, "smooth": smooth, **bounds}


Wanted: TypeAlias = Annotated[dict[str, Any], options.Group(_wanted)]


@outputs.guards("target")
def run(
    source: options.Source,
    target: constrain.Target,
    *,
    wanted: Wanted,
    reading: inputs.Reading,
    nonfinite: options.SkipNonFinite = "error",
    lines: constrain.Lines,
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read points, edges or polygons, refine, write the mesh, and print a report."""
    target.check()
    if source.suffix.lower() in _POLYGONS:
        cloud = _no_points(source, reading)
        lines = {"polygons": source, "carve": "holes", **lines}
    else:
        cloud = _points(source, reading)
    given: dict[str, Any] = {"nonfinite": nonfinite, "threads": threads}
    if cloud.points[:, 2].any():
        surface = _surface(cloud, source, target, lines, **given)
        with inputs.about(source):
            refined = _refined(surface, **wanted)
        mesh: Any = refined.surface
    else:
        cloud, tri = constrain.triangulated(
            cloud, source, target, lines, needs_lines=False, **given
        )
        refined = _refined(tri, **wanted)
        mesh = constrain.mesh_of(cloud, refined.triangulation)
    written = target.write(mesh)
    _report(written, refined, as_json=json)


def _no_points(source: Path, reading: dict[str, Any]) -> Cloud:
    """Return no points at all, for polygons."""
    import numpy as np

    from liftmesh.base.cloud import Cloud

    if reading:
        raise click.BadParameter(f"{source} holds polygons alone: leave options of rows out")
    source.open("rb").close()
    return Cloud(np.empty((0, 3)))


def _points(source: Path, reading: dict[str, Any]) -> Cloud:
    from liftmesh.io.read import for_surface

    return constrain.points_of(source, for_surface(source, reading, reading.get("format")))


def _surface(
    cloud: Cloud, source: Path, target: outputs.Target, lines: dict[str, Any], **choices: Any
) -> Surface:
    """Make the surface of rows with heights, or raise before the work starts."""
    has_faces = cloud.faces is not None and len(cloud.faces) > 0
    if {*lines} - {"crossing"} or not (has_faces or cloud.edges is None or not len(cloud.edges)):
        raise InputError(
            f"{source} has heights, so that --edges, --polylines, --polygons, --carve and edges "
            "without faces are not taken: give points without heights, or the lines to liftmesh "
            "triangulate --breaklines, and refine its mesh"
        )
    if "markers" in cloud.metadata:
        terminal.note(f"{source}: markers of edges are left out, as edges of surfaces are divided")
    with inputs.about(source):
        target.check_content(cloud)
    return surfaces.of_cloud(cloud, source, **choices)


def _refined(domain: ConstrainedTriangulation | Surface, **choices: Any) -> RefineResult:
    import liftmesh

    with terminal.share_bar("refining", 0) as progress, inputs.without_warnings():
        refined = liftmesh.refine(domain, progress=progress, **choices)
    if refined.capped:
        terminal.note("no more points may be added, and triangles are left: see --max-points")
    elif len(refined.too_large):
        terminal.note("triangles stay too large: float64 has no points that would divide them")
    return refined


def _report(written: WriteResult, refined: RefineResult, *, as_json: bool) -> None:
    tri, causes = refined.triangulation, refined.causes.tolist()
    counts = {
        "rows": tri.npoints,
        "added": len(refined.steiner),
        "triangles": tri.nsimplex,
        "constraints": len(tri.constraints),
        "below": len(causes),
        "too_large": len(refined.too_large),
        **{
            f"below_by_{cause.replace(' ', '_')}": causes.count(cause)
            for cause in sorted({*causes})
        },
    }
    told = {"min_angle": refined.min_angle, "capped": refined.capped}
    told |= {"displacement": refined.displacement}
    rows = [*outputs.as_rows(counts), ("smallest angle", f"{refined.min_angle:.4g} degrees")]
    if refined.displacement:
        rows.append(("displacement", f"{refined.displacement:.3g}"))
    if refined.surface is not None:
        told["max_deviation"] = refined.max_deviation
        rows.append(("deviation of heights", f"{refined.max_deviation:.3g}"))
    line = f"{tri.npoints:,} vertices, {tri.nsimplex:,} triangles"
    outputs.report(written, line, outputs.as_named(counts) | told, rows, as_json=as_json)
