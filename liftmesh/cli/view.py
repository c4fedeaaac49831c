"""``liftmesh view``: a page to look at meshes and clouds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import click

from liftmesh.base.options import counted
from liftmesh.cli import inputs, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, is_stream, option
from liftmesh.errors import InputError

SHORT_HELP = "Write a page that shows meshes and clouds: one HTML file, no network."
HELP = (
    "A cloud is triangulated first, unless --points. Of two surfaces the page shows how much the "
    "second is higher. Tetrahedra (VTU, VTK, MSH) are cut by a plane. "
    "Turn, move and zoom by mouse or touch; ? lists the keys."
)
EXAMPLES = [
    "liftmesh view tin.ply",
    "liftmesh view survey.laz -o survey.html --classes 2",
    "liftmesh view before.ply after.ply -o change.html --title 'The pit in May'",
    "liftmesh view scan.ply --points --browser",
]


@outputs.guards("output", prints=True)
def run(
    sources: Annotated[list[Path], argument("FILE", "Meshes, clouds, or files of tetrahedra.")],
    output: Annotated[
        Path | None, option("FILE", "Page to write; default: the first name, as .html.")
    ] = None,
    title: Annotated[str | None, option("TEXT", "Heading; default: names of the files.")] = None,
    *,
    points: Annotated[bool, flag("Show the rows of clouds as points.")] = False,
    reading: surfaces.Reading,
    browser: Annotated[bool, flag("Open the page in the browser.")] = False,
    json: options.Json = False,
) -> None:
    """Read what is shown, write the page, and say where it is."""
    import liftmesh
    from liftmesh.pages.page import check_page

    if output is None:
        if is_stream(sources[0]):
            raise click.BadParameter("stdin has no name: give --output")
        output = Path(sources[0].stem + ".html")
    check_page(output)
    outputs.check_place(output)
    shown = [_read(source, reading, points=points) for source in sources]
    with terminal.stage(f"writing {output.name}"):
        page = liftmesh.view(*shown, names=[source.name for source in sources], title=title)
        page.save(output)
    size = output.stat().st_size
    if json:
        layers = [layer.name for layer in page.layers]
        terminal.as_json({"path": str(output), "bytes": size, "layers": layers})
    else:
        said = counted(len(page.layers), "layer")
        terminal.sentence(f"{output}: {said}, {size / 1e6:,.1f} MB", "good")
    if browser:
        click.launch(str(output))


def _read(source: Path, reading: surfaces.SurfaceOptions, *, points: bool) -> Any:
    """Read tetrahedra, a surface, or a mesh or cloud as it is."""
    from liftmesh.io.tetrahedra import is_of_tetrahedra, read_tetrahedra
    from liftmesh.viewer.layers import Mesh

    if is_of_tetrahedra(source, reading.rows.get("format")):
        return Mesh(*read_tetrahedra(source, reading.rows.get("format")))
    cloud = inputs.read_rows([source], reading.rows)
    has_faces = cloud.faces is not None and len(cloud.faces) > 0
    if points and not has_faces:
        return cloud
    choices = {"plane": reading.plane, "threads": reading.threads}
    try:
        surface = surfaces.of_cloud(cloud, source, nonfinite=reading.nonfinite, **choices)
    except InputError as error:
        if not has_faces or reading.trimming:
            raise
        terminal.note(f"{source}: shown as it is, since it is no surface over a plane: {error}")
        return cloud
    return surfaces.trimmed(surface, reading.trimming)
