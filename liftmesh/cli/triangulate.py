"""``liftmesh triangulate``: triangulates a point cloud and writes a mesh file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import click

from liftmesh.base.options import Algorithm, Crossing, GroundAlgorithm, refused
from liftmesh.cli import inputs, notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, option, positive
from liftmesh.cli.thin import Thinning, thinned
from liftmesh.cli.wording import worded
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult
    from liftmesh.terrain.report import Report
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Triangulate a point cloud and write a mesh file."
HELP = "Every row becomes a vertex, in its order; faces are counter-clockwise seen from above."
EXAMPLES = [
    "liftmesh triangulate cloud.ply mesh.ply",
    "liftmesh triangulate lidar.csv mesh.obj --on-duplicate highest",
    "liftmesh triangulate survey.csv mesh.ply --columns x=East,y=North,z=GroundZ",
    "liftmesh triangulate *.laz tin.ply --cell 0.5",
    "liftmesh triangulate facade.ply mesh.ply --plane 0,-1,0",
    "liftmesh triangulate trees.csv mesh.ply --radii crown_radius",
    "liftmesh triangulate ground.laz tin.ply --max-edge 5 --boundary-only",
    "liftmesh triangulate ground.laz tin.ply --breaklines kerbs.gpkg --holes lakes.geojson",
    "liftmesh triangulate - - --input-format xyz --output-format ply < points.xyz > mesh.ply",
]


_LINES = {  # of the report
    "rows": "of lines", "rows_from_around": "height from around", "rows_at_crossings": "crossings",
    "rows_at_other_heights": "rows of lines at other heights", "lines_beyond": "lines beyond",
    "edges": "edges of lines", "flat_triangles": "flat triangles",
}  # fmt: skip
_GROUND = 2  # not "ground", which takes all rows where there is none
_NO_UNIT = "; the unit is not known, and taken to be metres"
_UNITS = {  # what is said where that of the plane and that of heights are known
    (True, True): "", (False, True): _NO_UNIT, (False, False): _NO_UNIT,
    (True, False): "; the unit of z is not stated, and taken to be that of x",
}  # fmt: skip


def _rigidness(text: str) -> int:
    if text not in {"1", "2", "3"}:
        raise refused("cloth_rigidness", text, "give 1, 2 or 3")
    return int(text)


def _ground(
    ground: Annotated[
        GroundAlgorithm | None,
        flag(
            "Find the ground of an unclassified cloud, by the cloth simulation CSF, or by a "
            "triangulation that grows from the lowest rows."
        ),
    ] = None,
    cloth_resolution: Annotated[
        float | None,
        option("METRES", "Of --ground: between the nodes of the cloth; default: 0.5.", positive),
    ] = None,
    cloth_rigidness: Annotated[
        int | None,
        option(
            "N",
            "Of --ground: 1 for steep slopes, 2, or 3 for flat terrain; default: 2.",
            _rigidness,
        ),
    ] = None,
    cloth_threshold: Annotated[
        float | None,
        option(
            "METRES", "Of --ground: rows nearer to the cloth are ground; default: 0.5.", positive
        ),
    ] = None,
    tin_cell: Annotated[
        float | None,
        option("METRES", "Of --ground tin: more than the largest building; default: 40.", positive),
    ] = None,
    tin_distance: Annotated[
        float | None,
        option(
            "METRES", "Of --ground tin: from a facet to rows that join; default: 1.4.", positive
        ),
    ] = None,
    tin_angle: Annotated[
        float | None,
        option(
            "DEGREES", "Of --ground tin: at which such rows see corners; default: 15.", positive
        ),
    ] = None,
    tin_threshold: Annotated[
        float | None,
        option("METRES", "Of --ground tin: rows nearer to it are ground; default: 0.25.", positive),
    ] = None,
    noise_depth: Annotated[
        float | None,
        option(
            "METRES",
            "Of --ground: rows that are lower than nearly all around by this are noise, class 7.",
            positive,
        ),
    ] = None,
) -> dict[str, Any]:
    """Check the options, and return those given, as `liftmesh.classify_ground` has them."""
    choices = options.given(cloth_resolution=cloth_resolution, cloth_threshold=cloth_threshold)
    choices |= options.given(cloth_rigidness=cloth_rigidness)
    choices |= options.given(tin_cell=tin_cell, tin_distance=tin_distance, tin_angle=tin_angle)
    choices |= options.given(tin_threshold=tin_threshold, noise_depth=noise_depth)
    for each in choices:
        kind = {"cloth": "csf", "tin": "tin"}.get(each.partition("_")[0], ground or "tin")
        if kind != ground:
            raise click.BadParameter(f"--{each.replace('_', '-')} is an option of --ground {kind}")
    return {} if ground is None else {"algorithm": ground, **choices}


def _lines(
    breaklines: Annotated[
        Path | None,
        option(
            "FILE",
            "Lines that faces do not cross, with their heights (GeoJSON, GeoPackage, shapefile, "
            "DXF); without, with those around.",
        ),
    ] = None,
    soft_breaklines: Annotated[
        Path | None, option("FILE", "Lines draped over the surface, in which they are edges.")
    ] = None,
    boundary: Annotated[
        Path | None, option("FILE", "Polygons: leave out faces outside, cut at the rings.")
    ] = None,
    holes: Annotated[
        Path | None, option("FILE", "Polygons that hide faces inside; their holes show islands.")
    ] = None,
    densify: Annotated[
        float | None, option("LENGTH", "Corners of these lines no farther apart.", positive)
    ] = None,
    crossing: Annotated[
        Crossing | None,
        option("POLICY", "Of breaklines that cross: error, or split, by the first one's height."),
    ] = None,
) -> dict[str, Any]:
    """Check the options of lines, and return those given, as `liftmesh.triangulate` has them."""
    files = options.given(
        breaklines=breaklines, soft_breaklines=soft_breaklines, boundary=boundary, holes=holes
    )
    for path in files.values():
        path.open("rb").close()
    choices = options.given(densify=densify, crossing=crossing)
    if choices and not files:
        raise click.BadParameter(
            f"--{next(iter(choices))} is for lines: give --breaklines, --soft-breaklines, "
            "--boundary or --holes"
        )
    return files | choices


Lines: TypeAlias = Annotated[dict[str, Any], options.Group(_lines, "Lines")]
Ground: TypeAlias = Annotated[dict[str, Any], options.Group(_ground, "Selection")]
Target: TypeAlias = Annotated[outputs.Target, outputs.target("Mesh file; - writes stdout.")]


@outputs.guards("target")
def run(
    sources: Annotated[
        list[Path], argument("IN", "Clouds or meshes, merged; - reads stdin (see --input-format).")
    ],
    target: Target,
    plane: options.Plane = "xy",
    on_duplicate: options.OnDuplicate = "first",
    algorithm: Annotated[
        Algorithm,
        option(
            "ALGORITHM",
            "auto, divide-and-conquer, lf, lfres or lfres-indexed; all give the same "
            "triangles, lf and lfres are slow.",
            panel="Advanced",
        ),
    ] = "auto",
    apex: options.Apex = "median",
    weights: options.Weights = None,
    radii: options.Radii = None,
    metric: options.Metric = None,
    *,
    reading: inputs.ColoredReading,
    nonfinite: options.SkipNonFinite = "error",
    ground: Ground,
    thin: Thinning,
    lines: Lines,
    trimming: surfaces.Trimming,
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, triangulate it, write the mesh, and print a report."""
    lifted_by = options.lifting(weights, radii, metric)
    inputs.check_once(sources)
    target.check()
    start = perf_counter()
    if ground:  # classes count only once there are some
        cloud = inputs.read_rows(sources, reading | {"classes": "all"})
        cloud = _classified(cloud, ground, reading.get("classes", _GROUND))
    else:
        cloud = inputs.read_rows(sources, reading)
    cloud = thinned(cloud, thin)
    seconds = {"read": perf_counter() - start}
    with inputs.about_rows(sources, cloud), inputs.about_lines(lines):
        target.check_content(cloud)
        surface, told = _triangulate(
            cloud,
            plane=plane.value,
            on_duplicate=on_duplicate,
            nonfinite=nonfinite,
            algorithm=algorithm,
            apex=apex,
            threads=threads,
            **lifted_by,
            **lines,
        )
        surface = surfaces.trimmed(surface, trimming)
    seconds["triangulate"] = sum(surface.report.seconds.values())
    start = perf_counter()
    written = target.write(surface)
    seconds["write"] = perf_counter() - start
    with outputs.report_after(target.path):
        replaced = _replaced(cloud, surface)
        _print_report(written, surface, seconds, replaced, told, as_json=json)


def _classified(cloud: Cloud, ground: Mapping[str, Any], classes: Any) -> Cloud:
    """Classify a cloud and select the ground; say on stderr what was found."""
    from liftmesh.io.selection import Selector, selected, validate_selection
    from liftmesh.terrain.ground import bare_warning, classify_ground

    stage = terminal.stage(f"finding the ground among {len(cloud):,} rows")
    with stage, inputs.without_warnings():
        classified = classify_ground(cloud, **ground)
    counts = notes.provenance_of(classified).ground
    if not counts["ground"]:
        raise InputError(f"{counts['algorithm']} finds no ground among {counts['rows']:,} rows")
    unit = _UNITS[counts["unit_known"], counts["z_unit_known"]]
    terminal.note(
        f"ground by {counts['algorithm']}: {counts['ground']:,} of {counts['rows']:,} rows "
        f"({_how(counts)}{unit}); where ground is sparse, it may hold low vegetation and roofs"
    )
    if lost := bare_warning(counts):
        terminal.note(worded(lost))
    chosen = validate_selection(classes=classes)
    classified = (
        classified if chosen is None else selected(classified, Selector(chosen, "the cloud"))
    )
    if not len(classified):
        raise InputError(f"none of {counts['rows']:,} rows has one of these classes")
    return classified


def _how(counts: Mapping[str, Any]) -> str:
    """Say how the ground was found."""
    noise = f", {counts['noise']:,} of low noise" if "noise" in counts else ""
    if counts["algorithm"] == "csf":
        cloth = f"cloth of {counts['cloth_resolution']:g} m"
        return f"{cloth}, rigidness {counts['cloth_rigidness']}{noise}"
    return f"cells of {counts['tin_cell']:g} m, {counts['tin_angle']:g} degrees{noise}"


def _replaced(cloud: Cloud, surface: Surface) -> list[str]:
    """What to say of values of the cloud that those of the surface have replaced."""
    from liftmesh.terrain.lifting import replaced_flags

    said = replaced_flags(cloud) if hasattr(surface.triangulation, "hidden") else ""
    return [said] if said else []


def _triangulate(cloud: Cloud, **choices: Any) -> tuple[Surface, list[str]]:
    """Return the surface, and the notes about edges and lines that were printed."""
    import liftmesh

    text = f"triangulating {len(cloud):,} rows"
    with terminal.share_bar(text, len(cloud)) as progress, inputs.without_warnings() as told:
        return liftmesh.triangulate(cloud, progress=progress, **choices), told


def _print_report(
    written: WriteResult,
    surface: Surface,
    seconds: dict[str, float],
    replaced: list[str],
    told: list[str],
    *,
    as_json: bool,
) -> None:
    report = surface.report
    if as_json:
        cloud = surface.to_cloud()
        known = notes.provenance_of(cloud)
        about = {
            "notes": [*notes.cloud_notes(cloud), *told, *replaced],
            "not_read": list(notes.parts_not_read(cloud)),
            "triangulated_by": known.lifted_by or None,
            "selection": notes.counts_of(cloud),
            "merged": known.merged or None,
            "ground": known.ground or None,
            "thinning": known.thinning or None,
            **notes.provenance(cloud),
            "n_trimmed": 0 if surface.mask is None else int(surface.mask.sum()),
        }
        terminal.as_json(_values(written, report, seconds) | about)
        return
    for each in replaced:
        terminal.note(each)
    terminal.sentence(_headline(written, report, len(surface.faces)), "good")
    counts = _counts(report)
    if not hasattr(surface.triangulation, "hidden"):
        del counts["n_hidden"]
    if surface.mask is not None:
        counts["n_trimmed"] = int(surface.mask.sum())
    rows = [(name[2:], f"{count:,}") for name, count in counts.items()]
    rows += [(_LINES[name], f"{count:,}") for name, count in report.lines.items() if count]
    rows += notes.lidar_lines({"classes": report.classes})
    rows += [("seconds", "  ".join(f"{name} {value:.2f}" for name, value in seconds.items()))]
    terminal.table(rows)


def _headline(written: WriteResult, report: Report, faces: int) -> str:
    triangles = f"{faces:,} triangle{'s' if faces > 1 else ''}"
    return outputs.headline(written, f"{report.n_rows:,} vertices, {triangles}")


def _counts(report: Report) -> dict[str, int]:
    return {
        "n_rows": report.n_rows,
        "n_used": report.n_used,
        "n_duplicates": report.n_duplicates,
        "n_overhangs": report.n_overhangs,
        "n_skipped": report.n_skipped,
        "n_hidden": report.n_hidden,
        "n_triangles": report.n_triangles,
    }


def _values(written: WriteResult, report: Report, seconds: dict[str, float]) -> dict[str, Any]:
    return {
        **outputs.as_values(written),
        **_counts(report),
        "policy": report.policy,
        "left_out": report.left_out.tolist(),
        "columns": dict(report.columns),
        "lines": dict(report.lines) or None,
        "color_depth": report.color_depth,
        "seconds": seconds,
    }
