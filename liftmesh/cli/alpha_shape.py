"""``liftmesh alpha-shape``: what triangles or tetrahedra with small circles or spheres fill."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import click

from liftmesh.cli import inputs, options, outputs, terminal
from liftmesh.cli.options import distance, flag, option, whole

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.alpha import AlphaMethods, AlphaShape

SHORT_HELP = "The alpha shape of points, exact: its triangles, or in space its surface."
HELP = (
    "The shape is made of the triangles of the Delaunay triangulation of x and y, or with --space "
    "of the tetrahedra, whose circle or sphere has at most the radius. OUT holds its triangles, "
    "with the heights of the points, or in space its surface, seen counter-clockwise from outside. "
    "Edges in which more than two faces of the surface meet are counted."
)
EXAMPLES = [
    "liftmesh alpha-shape scan.ply surface.stl --space --alpha 0.05",
    "liftmesh alpha-shape scan.ply parts.ply --space --components 3",
    "liftmesh alpha-shape trees.csv area.ply --alpha 25 --json",
]


@outputs.guards("target")
def run(
    source: options.Source,
    target: Annotated[outputs.Target, outputs.target("Mesh; the suffix determines the format.")],
    alpha: Annotated[
        float | None, option("RADIUS", "The largest radius, in units of the coordinates.", distance)
    ] = None,
    components: Annotated[
        int | None,
        option(
            "N",
            "The least radius whose shape holds all points in N parts; 1 if neither is given.",
            whole(1),
        ),
    ] = None,
    space: Annotated[bool, flag("Points in space: tetrahedra and their surface.")] = False,
    *,
    reading: inputs.AllRows,
    nonfinite: options.SkipNonFinite = "error",
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, find its alpha shape, write the mesh, and print a report."""
    if alpha is not None and components is not None:
        raise click.BadParameter("--alpha and --components are given: give one of them")
    target.check()
    cloud = inputs.read_rows([source], reading, of_surface=False)
    with inputs.about(source):
        target.check_content(cloud)
        choices = {"nonfinite": nonfinite, "threads": threads}
        shape = _shape(cloud, alpha, components or 1, space=space, **choices)
    made = shape.to_cloud()
    points = made.points if space else cloud.points[shape.vertices]
    written = target.write(replace(made, points=points, crs=cloud.crs))
    counts = _counts(shape)
    told = {**outputs.as_named(counts), "alpha": shape.alpha}
    outputs.report(written, _line(shape), told, outputs.as_rows(counts), as_json=json)


def _shape(
    cloud: Cloud, alpha: float | None, components: int, *, space: bool, **choices: Any
) -> AlphaShape:
    import liftmesh

    triangulate: Any = liftmesh.tetrahedralize if space else liftmesh.delaunay
    points = cloud.points if space else cloud.points[:, :2]
    with terminal.share_bar("triangulating", len(cloud)) as progress:
        whole: AlphaMethods = triangulate(points, progress=progress, **choices)
    with terminal.stage("finding the shape"):
        radius = whole.optimal_alpha(components) if alpha is None else alpha
        return whole.alpha_shape(radius)


def _line(shape: AlphaShape) -> str:
    text = repr(shape).strip("<>").partition(": ")[2]
    return f"{text}, at alpha {shape.alpha:.6g}"


def _counts(shape: AlphaShape) -> dict[str, int]:
    inside, faces, pinched = ("tetrahedra", "faces", "nonmanifold edges")
    if shape.points.shape[1] == 2:
        inside, faces, pinched = ("triangles", "boundary edges", "nonmanifold vertices")
    return {
        "rows": len(shape.points),
        "vertices": len(shape.vertices),
        inside: len(shape.simplices),
        faces: len(shape.faces),
        f"singular {faces.split()[-1]}": len(shape.singular),
        pinched: len(shape.nonmanifold),
    }
