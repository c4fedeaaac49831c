"""``liftmesh verify``: whether a mesh is the Delaunay triangulation of its vertices."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from liftmesh.cli import exit_codes, inputs, options, outputs, terminal
from liftmesh.cli.options import argument, flag, is_stream, option
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.certificate import Certificate

SHORT_HELP = "Verify that a mesh is the Delaunay triangulation of its vertices."
HELP = (
    "Checks a mesh from any program, seen from above, exactly: every triangle counter-clockwise, "
    "every edge shared or on the boundary, the boundary convex, every row a vertex, every "
    "circumcircle empty. The exit code is 1 if anything is wrong, and the first places are listed. "
    "A file that liftmesh wrote says itself whether it was triangulated by weights, by radii or in "
    "a metric, or on the sphere; of others an option says it. Of VTU, VTK and MSH the tetrahedra "
    "are checked, in space, by facets in place of edges."
)
EXAMPLES = [
    "liftmesh verify mesh.ply",
    "liftmesh verify mesh.obj --certificate mesh.json",
    "liftmesh verify mesh.ply --json",
    "liftmesh verify molecule.ply --radii radius",
    "liftmesh verify globe.obj --spherical",
    "liftmesh verify cells.vtu",
    "liftmesh verify tiles/",
]
SHOWN = 3  # violations of a flaw
_IN_SPACE = {"triangles": "tetrahedra", "edges": "facets", "hull_edges": "hull_facets"}


@outputs.guards("certificate", prints=True)
def run(
    source: Annotated[
        Path,
        argument("FILE", "Mesh, - reads stdin (see --input-format); or a folder of tiles."),
    ],
    certificate: Annotated[
        Path | None,
        option("FILE", "Write what was found as JSON, with SHA-256 sums; - for stdout."),
    ] = None,
    plane: options.Plane = "xy",
    threads: options.Threads = None,
    weights: Annotated[
        str | None, option("COLUMN", "Values of FILE: is it regular by these weights?")
    ] = None,
    radii: Annotated[str | None, option("COLUMN", "The same with radii, not squared.")] = None,
    metric: Annotated[
        Any, option("A,B,C", "Is it Delaunay in the metric a x^2 + 2 b xy + c y^2?", options.metric)
    ] = None,
    spherical: Annotated[
        bool, flag("Is it Delaunay on the sphere, by the directions of its vertices?")
    ] = False,
    points: Annotated[
        list[Path] | None, option("FILE", "The points of a folder, if its source has moved.")
    ] = None,
    *,
    file: inputs.File,
    nonfinite: options.SkipNonFinite = "error",
    json: options.Json = False,
) -> None:
    """Read a mesh, verify it, write the certificate that was asked for, and say what was found."""
    from liftmesh.io.tetrahedra import is_of_tetrahedra

    lifting = options.lifting(weights, radii, metric, spherical or None)
    outputs.check_place(certificate)
    if points is not None and not source.is_dir():
        raise click.BadParameter(f"--points is for folders of tiles, and {source} is none")
    if source.is_dir():
        certified = _verify_tiles(source, points, threads, certificate)
    elif is_of_tetrahedra(source, file.get("format")):
        _refuse_planar(plane, lifting, file)
        with inputs.about(source):
            certified = _verify_tetrahedra(source, file, nonfinite=nonfinite, threads=threads)
    else:
        _check_format(source, file.get("format"))
        cloud = inputs.read(source, file)
        _note_polygons(cloud)
        with inputs.about(source):
            choices = {"nonfinite": nonfinite, "threads": threads}
            certified = _verify_file(cloud, source, plane.value, lifting, **choices)
    if certificate is not None:
        _write(certificate, certified)
    with outputs.report_after(certificate):
        if json:
            sys.stdout.write(certified.to_json())
        else:
            _say(certified)
    if not certified.valid:
        raise click.exceptions.Exit(exit_codes.DIFFERENT)


def _verify_tiles(
    source: Path, points: list[Path] | None, threads: int | None, certificate: Path | None
) -> Certificate:
    from liftmesh.tiles.tiled import open_tiled

    tiled = open_tiled(source)
    tiled_files = [tiled.folder / each.get("path", "") for each in tiled.manifest["source"]]
    outputs.check_lost([] if certificate is None else [certificate], tiled_files)
    with terminal.share_bar(f"verifying {tiled.nsimplex:,} triangles") as progress:
        return tiled.verify(points, threads=threads, progress=progress)


def _refuse_planar(plane: Any, lifting: dict[str, Any], file: dict[str, Any]) -> None:
    if lifting or plane.value != "xy":
        raise click.BadParameter(
            "files of tetrahedra have no --plane, --weights, --radii, --metric or --spherical: "
            "leave them out"
        )
    if file.keys() - {"format"}:
        raise click.BadParameter(
            "files of tetrahedra are read by meshio, whole and as they are: leave --max-bytes and "
            "--input-up out"
        )


def _verify_tetrahedra(source: Path, file: dict[str, Any], **choices: Any) -> Certificate:
    from liftmesh.io.tetrahedra import read_tetrahedra
    from liftmesh.planar.verification import verify

    if is_stream(source):
        raise click.BadParameter("tetrahedra are not read from stdin: name a file")
    points, simplices = read_tetrahedra(source, file.get("format"))
    with terminal.share_bar(f"verifying {len(simplices):,} tetrahedra") as progress:
        return verify(points, simplices, progress=progress, **choices)


def _verify_file(
    cloud: Cloud, source: Path, plane: Any, lifting: dict[str, Any], **choices: Any
) -> Certificate:
    from liftmesh.planar.verification import verify
    from liftmesh.terrain.frame import resolve_plane

    if cloud.faces is None or not len(cloud.faces):
        raise _no_triangles(source, "triangulate" if cloud.edges is None else "constrain")
    lifted_by = _lifted_by(cloud, lifting)
    with terminal.stage(f"verifying {len(cloud.faces):,} triangles over {len(cloud):,} rows"):
        points = cloud.points
        if "spherical" not in lifted_by:
            points = resolve_plane(plane, points).planar(points)
        elif plane != "xy":
            raise click.BadParameter("triangles on the sphere have no --plane: leave it out")
        certified = verify(points, cloud.faces, **choices, **lifted_by)
    if certified.planar and not certified.valid:
        _note_own_faces(cloud, plane, choices["threads"])
    return certified


def _note_own_faces(cloud: Cloud, plane: Any, threads: int | None) -> None:
    """Report a mesh that is a surface all the same, as a trimmed one, or one with other sides."""
    from liftmesh.errors import LiftmeshError
    from liftmesh.terrain.triangulate import as_surface

    try:
        with inputs.without_warnings():
            surface = as_surface(cloud, plane=plane, threads=threads)
    except LiftmeshError as error:
        terminal.note(f"no two triangles overlap, but it is no surface: {error}")
        return
    solved, count = surface.triangulation, len(surface.faces)
    if hasattr(solved, "constraints"):
        terminal.note(
            f"a surface all the same: no two of the {count:,} triangles overlap, so that other "
            "commands take them as they are, not Delaunay"
        )
    elif surface.mask is not None:
        whole = solved.nsimplex
        terminal.note(
            f"all {count:,} triangles are among the {whole:,} of the triangulation of "
            f"their corners, and {whole - count:,} are left out: this is a trimmed "
            "surface, and a surface is verified before it is trimmed"
        )


def _check_format(source: Path, file_format: str | None) -> None:
    """Raise for a file of points before it is read: options of tables would not help."""
    from liftmesh.io.registry import find_format
    from liftmesh.io.streams import suffix_of

    if file_format is None and not source.is_file():
        return
    kind = find_format(file_format or suffix_of(source.name), str(source))
    if "faces" not in kind.keeps:
        command = "constrain" if "edges" in kind.keeps else "triangulate"
        raise _no_triangles(source, command).within(source)


def _no_triangles(source: Path, command: str) -> InputError:
    return InputError(f"holds no triangles: make some with liftmesh {command} {source} OUT")


def _lifted_by(cloud: Cloud, lifting: dict[str, Any]) -> dict[str, Any]:
    """What the options say the mesh was triangulated by, or the file."""
    from liftmesh.planar.kinds import named_values, options_of

    if not lifting:
        return options_of(cloud)
    return {
        kind: value if kind in ("metric", "spherical") else named_values(cloud, kind, value)
        for kind, value in lifting.items()
    }


def _note_polygons(cloud: Cloud) -> None:
    """Report faces of the file that are not among the triangles verified, on stderr."""
    counts = map(cloud.metadata.get, ("polygons", "degenerate_faces"))
    cut, left_out = (
        each if isinstance(each, int) else 0 for each in counts
    )  # glTF holds any names
    notes = [f"{cut:,} of more than three corners cut into triangles"] if cut else []
    notes += [f"{left_out:,} of fewer than three corners left out"] if left_out else []
    if notes:
        terminal.note(f"faces of the file: {', '.join(notes)}")


def _write(path: Path, certified: Certificate) -> None:
    from liftmesh.io.atomic import replacing

    if is_stream(path):
        sys.stdout.write(certified.to_json())
        return
    with replacing(path) as stream:
        stream.write(certified.to_json().encode())


def _say(certified: Certificate) -> None:
    terminal.sentence(_verdict(certified), "good" if certified.valid else "bad")
    for flaw in certified.flaws:
        terminal.item(flaw.text)
        for place in flaw.first[:SHOWN]:
            terminal.item(f"such as: {place.text}")
    terminal.blank()
    counts = ["rows", "vertices", "duplicates", "skipped", "triangles", "edges", "hull_edges"]
    counts[2:2] = [] if certified.member in ("delaunay", "metric", "spherical") else ["hidden"]
    in_space = _IN_SPACE if certified.dimension == 3 else {}
    lines = [
        (in_space.get(name, name).replace("_", " "), _number(getattr(certified, f"n_{name}")))
        for name in counts
    ]
    simplices = in_space.get("triangles", "triangles")
    sums = [("points", certified.points_sha256), (simplices, certified.simplices_sha256)]
    sums += [] if certified.values_sha256 is None else [(certified.member, certified.values_sha256)]
    terminal.table([*lines, *((f"SHA-256 of {name}", value) for name, value in sums)])


def _number(count: int | None) -> str:
    return "not counted" if count is None else f"{count:,}"


def _verdict(certified: Certificate) -> str:
    if certified.canonical:
        which = "" if certified.member == "delaunay" else f", the {certified.name}"
        made = "triangles" if certified.dimension == 2 else "tetrahedra"
        return f"Valid, and canonical: these are the {made} that liftmesh makes{which}."
    if certified.valid:
        tied = "cocircular" if certified.member in ("delaunay", "farthest") else "tied"
        tied = "cospherical" if certified.dimension == 3 else tied
        return f"Valid: a {certified.name}, with other choices among {tied} points."
    return f"Not valid: this is not the {certified.name} of these points."
