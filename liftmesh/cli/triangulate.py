"""``liftmesh triangulate``: triangulates a point cloud and writes a mesh file."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.base.options import Duplicates, Method
from liftmesh.cli import (
    classifying,
    files,
    inputs,
    lidar,
    options,
    outputs,
    overwriting,
    rows,
    standard_streams,
    tables,
    terminal,
    thinning,
)
from liftmesh.cli.trimming import trimmed, with_options as with_trimming

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.writing import Written
    from liftmesh.terrain.report import Report
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Triangulate a point cloud and write a mesh file."
HELP = "Every row becomes a vertex, in its order; faces are counter-clockwise seen from above."
EXAMPLES = [
    "liftmesh triangulate cloud.ply mesh.ply",
    "liftmesh triangulate lidar.csv mesh.obj --duplicates highest",
    "liftmesh triangulate survey.csv mesh.ply --columns x=East,y=North,z=GroundZ",
    "liftmesh triangulate *.laz tin.ply --cell 0.5",
    "liftmesh triangulate facade.ply mesh.ply --plane 0,-1,0",
    "liftmesh triangulate trees.csv mesh.ply --radii crown_radius",
    "liftmesh triangulate ground.laz tin.ply --max-edge 5 --boundary-only",
    "liftmesh triangulate - - --from xyz --format ply < points.xyz > mesh.ply",
]


@overwriting.guards("target")
@tables.with_options
@rows.with_options
@classifying.with_options
@thinning.with_thinning
@outputs.with_options
@with_trimming
def run(
    sources: Annotated[
        list[Path],
        typer.Argument(metavar="IN", help="Clouds or meshes, merged; - reads stdin (see --from)."),
    ],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="Mesh file; - writes stdout.")],
    plane: options.Plane = "xy",
    duplicates: Annotated[
        Duplicates,
        typer.Option(help="Which of several rows at one planar position is used as the vertex."),
    ] = "first",
    nonfinite: options.SkipNonFinite = "error",
    method: Annotated[
        Method,
        typer.Option(help="Algorithm; all give the same triangles, lf and lfres are slow."),
    ] = "auto",
    q: Annotated[
        str,
        typer.Option(
            "--q",
            metavar="Q",
            help="Vertex of the paraboloid for lf and lfres: origin, median or QX,QY.",
        ),
    ] = "origin",
    source_format: options.SourceFormat = None,
    weights: options.Weights = None,
    radii: options.Radii = None,
    metric: options.Metric = None,
    trimming: Any = None,
    target_format: options.TargetFormat = None,
    threads: options.Threads = None,
    table: Any = None,
    selection: Any = None,
    ground: Any = None,
    thin: Any = None,
    writing: Any = None,
    max_bytes: options.MaxBytes = None,
    color_depth: options.ColorDepth = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, triangulate it, write the mesh, and print a report."""
    frame, vertex = options.parse_plane(plane), options.parse_q(q)
    lifted_by = options.parse_member(weights, radii, metric)
    if json:
        standard_streams.check_stdout()
    count = options.parse_threads(threads)
    depth = options.parse_color_depth(color_depth)
    limit = options.parse_size(max_bytes)
    inputs.check_once(sources)
    files.check_target(target, target_format)
    outputs.check_options(target, target_format, writing)
    start = perf_counter()
    first, later = (selection, {}) if not ground else classifying.parted(selection)
    read = partial(files.read_ground, file_format=source_format, max_bytes=limit, table=table)
    cloud = inputs.merged(sources, partial(read, color_depth=depth), first)
    cloud = cloud if not ground else classifying.classified(cloud, ground, later)
    cloud = thinning.thinned(cloud, thin)
    seconds = {"read": perf_counter() - start}
    with inputs.about(sources, cloud):
        files.check_content(target, target_format, cloud, writing)
        surface = _triangulate(
            cloud,
            plane=frame,
            duplicates=duplicates,
            nonfinite=nonfinite,
            method=method,
            q=vertex,
            threads=count,
            **lifted_by,
        )
        surface = trimmed(surface, trimming)
    seconds["triangulate"] = sum(surface.report.seconds.values())
    start = perf_counter()
    written = outputs.write(target, surface, target_format, writing)
    seconds["write"] = perf_counter() - start
    # If the mesh itself goes to stdout, the report goes to stderr.
    is_stdout = files.is_stream(target)
    place = redirect_stdout(sys.stderr) if is_stdout else standard_streams.dispensable_stdout()
    with place, standard_streams.after_writing(written.path):
        _print_report(written, surface, seconds, _replaced(cloud, surface), as_json=json)


def _replaced(cloud: Cloud, surface: Surface) -> list[str]:
    """What to say of values of the cloud that those of the surface have replaced."""
    from liftmesh.terrain.lifting import replaced_flags  # noqa: PLC0415 - help does without

    said = replaced_flags(cloud) if hasattr(surface.triangulation, "hidden") else ""
    return [said] if said else []


def _triangulate(cloud: Cloud, **choices: Any) -> Surface:
    import liftmesh  # noqa: PLC0415 - help and --version do without

    with terminal.bar(1.0, len(cloud)) as bar:
        advance = bar_steps(bar, f"triangulating {len(cloud):,} rows")
        with files.without_warnings():  # the notes say it
            return liftmesh.triangulate(cloud, progress=advance, **choices)


def bar_steps(bar: Callable[[str, float], None], text: str) -> Callable[[float], None]:
    """Return a `progress` callback that converts fractions done to steps of a bar."""
    done = 0.0

    def advance(fraction: float) -> None:
        nonlocal done
        bar(text, fraction - done)
        done = fraction

    advance(done)
    return advance


def _print_report(
    written: Written,
    surface: Surface,
    seconds: dict[str, float],
    replaced: list[str],
    *,
    as_json: bool,
) -> None:
    report = surface.report
    if as_json:
        cloud = surface.to_cloud()
        notes = {
            "notes": [*files.notes(cloud), *replaced],
            "not_read": list(files.parts_not_read(cloud)),
            "triangulated_by": cloud.metadata.get("triangulated_by"),
            "selection": files.counts_of(cloud),
            "merged": cloud.metadata.get("merged"),
            "ground": cloud.metadata.get("ground"),
            "thinning": cloud.metadata.get("thinning"),
            **lidar.provenance(cloud),
            "trimmed": 0 if surface.mask is None else int(surface.mask.sum()),
        }
        terminal.as_json(_values(written, report, seconds) | notes)
        return
    for each in replaced:
        terminal.note(each)
    terminal.sentence(_headline(written, report, len(surface.faces)), "good")
    counts = _counts(report)
    if not hasattr(surface.triangulation, "hidden"):
        del counts["hidden"]
    if surface.mask is not None:
        counts["trimmed"] = int(surface.mask.sum())
    rows = [(name, f"{count:,}") for name, count in counts.items()]
    rows += lidar.lines({"classes": report.classes})
    rows += [("seconds", "  ".join(f"{name} {value:.2f}" for name, value in seconds.items()))]
    terminal.table(rows)


def _headline(written: Written, report: Report, faces: int) -> str:
    triangles = f"{faces:,} triangle{'s' if faces > 1 else ''}"
    return outputs.headline(written, f"{report.rows:,} vertices, {triangles}")


def _counts(report: Report) -> dict[str, int]:
    return {
        "rows": report.rows,
        "used": report.used,
        "duplicates": report.duplicates,
        "overhangs": report.overhangs,
        "not finite": report.skipped,
        "hidden": report.hidden,
        "triangles": report.triangles,
    }


def _values(written: Written, report: Report, seconds: dict[str, float]) -> dict[str, Any]:
    return {
        **outputs.values(written),
        **{name.replace(" ", "_"): count for name, count in _counts(report).items()},
        "policy": report.policy,
        "left_out": report.left_out.tolist(),
        "columns": dict(report.columns),
        "color_depth": report.color_depth,
        "seconds": seconds,
    }
