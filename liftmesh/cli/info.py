"""``liftmesh info``: summary of the contents of a file."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from liftmesh.cli import inputs, notes, options, outputs, terminal
from liftmesh.cli.options import argument

if TYPE_CHECKING:
    from liftmesh._typing import Floats, Rows
    from liftmesh.base.cloud import Cloud

_SHORT = 20  # characters beyond the name, of a text that is a number rather than WKT
_MOST_DECIMALS = 12
# Measured: peak memory of reading, triangulating and writing, in addition to the file's arrays.
_BYTES_PER_ROW = 70

SHORT_HELP = "Summarise a cloud or mesh."
HELP = (
    "Prints the number of rows, bounds, spacing, duplicates and overhangs, whether float32 is "
    "accurate enough, whether a triangle exists, and the memory that triangulation needs."
)
EXAMPLES = ["liftmesh info cloud.ply", "liftmesh info lidar.csv --json"]


def run(
    source: Annotated[
        Path,
        argument("FILE", "Cloud or mesh; - reads stdin (see --input-format)."),
    ],
    *,
    reading: inputs.AllRows,
    json: options.Json = False,
) -> None:
    """Read a file and print its summary."""
    outputs.check_stdout()
    cloud = inputs.read(source, reading)
    with terminal.stage(f"summarising {len(cloud):,} rows"):
        summary = summarise(cloud)
    if json:
        derived = ("size", "offset", "float32_is_enough")
        terminal.as_json(asdict(summary) | {name: getattr(summary, name) for name in derived})
    else:
        terminal.table(_lines(summary))


@dataclass(frozen=True, slots=True)
class Summary:
    """Statistics of a cloud."""

    n_rows: int
    n_faces: int
    n_edges: int
    n_not_finite: int
    holds: tuple[str, ...]
    not_read: tuple[str, ...]
    columns: dict[str, str]
    notes: tuple[str, ...]
    lidar: dict[str, Any]
    raster: dict[str, Any]
    crs: str | None
    units: tuple[str | None, ...]
    minimum: tuple[float, ...]
    maximum: tuple[float, ...]
    n_positions: int
    n_duplicates: int
    n_overhangs: int
    collinear: bool
    spacing: float | None
    float32_shift: float
    memory: int

    @property
    def size(self) -> tuple[float, ...]:
        """Size of the bounding box along each axis; infinite if it exceeds float64."""
        return tuple(high - low for low, high in zip(self.minimum, self.maximum, strict=True))

    @property
    def offset(self) -> float:
        """Planar distance from the origin to the center of the bounding box."""
        bounds = zip(self.minimum[:2], self.maximum[:2], strict=True)
        return math.hypot(*(low / 2 + high / 2 for low, high in bounds))

    @property
    def float32_is_enough(self) -> bool:
        """Whether float32 changes no coordinate by more than a hundredth of the spacing."""
        return self.float32_shift <= (self.spacing or 0.0) / 100


def summarise(cloud: Cloud) -> Summary:
    """Compute the statistics of a cloud."""
    from liftmesh.io.columns import edges_of
    from liftmesh.io.metadata import Provenance
    from liftmesh.planar.points import find_positions

    points = _finite_rows(cloud.points)
    positions = find_positions(points)
    overhangs = _overhangs(points, positions.duplicates)
    minimum, maximum = _bounds(points)
    return Summary(
        n_rows=len(cloud),
        n_faces=0 if cloud.faces is None else len(cloud.faces),
        n_edges=len(edges_of(cloud)),
        n_not_finite=len(cloud) - len(points),
        crs=cloud.crs,
        units=_units(cloud),
        holds=_holds(cloud),
        not_read=notes.parts_not_read(cloud),
        columns=Provenance(cloud.metadata).columns,
        notes=notes.cloud_notes(cloud),
        lidar=notes.lidar_counts(cloud),
        raster=_raster(cloud),
        minimum=minimum,
        maximum=maximum,
        n_positions=positions.count,
        n_duplicates=len(positions.duplicates) - overhangs,
        n_overhangs=overhangs,
        collinear=positions.collinear,
        spacing=positions.spacing,
        float32_shift=_float32_shift(points),
        memory=_memory(cloud),
    )


def _raster(cloud: Cloud) -> dict[str, Any]:
    from liftmesh.io.metadata import Provenance

    raster = Provenance(cloud.metadata).raster
    return raster if "transform" in raster else {}


def _units(cloud: Cloud) -> tuple[str | None, ...]:
    from liftmesh.crs.units import system_of

    system = system_of(cloud)
    return () if system is None else tuple(each.name if each else None for each in system.units)


def _finite_rows(points: Floats) -> Floats:
    """Return the rows without NaN or infinity; the same array if that is all of them."""
    import numpy as np

    from liftmesh.planar.points import pieces

    finite = np.ones(len(points), dtype=np.bool_)
    for piece in pieces(len(points)):
        finite[piece] = np.isfinite(points[piece]).all(axis=1)
    return points if finite.all() else points[finite]


def _overhangs(points: Floats, duplicates: Rows) -> int:
    """Count the rows at another height than the first row at their position."""
    import numpy as np

    from liftmesh.planar.points import pieces

    rows, first = duplicates.T
    z = points[:, 2]
    return sum(
        int(np.count_nonzero(z[rows[piece]] != z[first[piece]])) for piece in pieces(len(rows))
    )


def _bounds(points: Floats) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the corners of the bounding box; empty without points."""
    import numpy as np

    from liftmesh.planar.points import pieces

    if len(points) == 0:
        return (), ()
    columns = [points[piece].T for piece in pieces(len(points))]
    # Of each column by itself: across short rows NumPy is twenty times slower.
    lows = [[column.min() for column in part] for part in columns]
    highs = [[column.max() for column in part] for part in columns]
    return tuple(np.min(lows, axis=0).tolist()), tuple(np.max(highs, axis=0).tolist())


def _float32_shift(points: Floats) -> float:
    """Compute the maximum change of a coordinate when it is stored as float32."""
    import numpy as np

    from liftmesh.planar.points import pieces

    most = 0.0
    with np.errstate(over="ignore", under="ignore"):
        for piece in pieces(len(points)):
            part = points[piece]
            most = max(most, float(np.abs(part.astype(np.float32) - part).max()))
    return most


def _holds(cloud: Cloud) -> tuple[str, ...]:
    named = {"colors": cloud.colors, "normals": cloud.normals}
    return (*(name for name, values in named.items() if values is not None), *cloud.attributes)


def _memory(cloud: Cloud) -> int:
    arrays: list[Any] = [cloud.points, cloud.colors, cloud.normals, *cloud.attributes.values()]
    held = sum(array.nbytes for array in arrays if array is not None)
    return int(held + _BYTES_PER_ROW * len(cloud))


def _lines(summary: Summary) -> list[tuple[str, str]]:
    lines = [("rows", f"{summary.n_rows:,}" + _count_note(summary.n_not_finite, "not finite"))]
    parts = (("faces", summary.n_faces), ("edges", summary.n_edges))
    lines += [(name, f"{count:,}") for name, count in parts if count]
    lines.append(("holds", ", ".join(("coordinates", *summary.holds))))
    if summary.columns:
        pairs = (f"{part} = {name}" for part, name in summary.columns.items())
        lines.append(("columns", ", ".join(pairs)))
    lines += notes.lidar_lines(summary.lidar)
    if summary.raster:
        lines.append(("raster", _samples(summary.raster)))
    if summary.crs is not None:
        lines.append(("crs", _system(summary.crs)))
    elif summary.lidar.get("scale") or summary.raster:  # formats that have a place for one
        lines.append(("crs", "not stated"))
    if summary.units:
        axes = zip("xyz", summary.units, strict=True)
        lines.append(("units", ", ".join(f"{axis}: {unit or 'not stated'}" for axis, unit in axes)))
    if summary.n_positions:
        lines += _measures(summary)
    memory = terminal.bytes_text(summary.memory)
    return [*lines, ("memory", f"about {memory} to triangulate")]


def _system(crs: str) -> str:
    """Name a coordinate system that is WKT; --json has the text."""
    from liftmesh.crs.description import parse_crs

    system = parse_crs(crs)
    if system is None:
        return crs
    number = f"{crs}, " if len(crs) < len(system.name) + _SHORT else ""
    return f"{number}{system.name} ({system.kind})"


def _samples(raster: dict[str, Any]) -> str:
    """Say how many samples a raster has, and how far apart they are."""
    a, b, _, d, e, _ = raster["transform"]
    across, down = math.hypot(a, d), math.hypot(b, e)
    turned = ", turned" if b or d else ""
    return (
        f"{raster['width']:,} x {raster['height']:,} samples, "
        f"{across:.6g} x {down:.6g} apart{turned}"
    )


def _measures(summary: Summary) -> list[tuple[str, str]]:
    shown = [f".{each}f" for each in map(_decimals, summary.lidar.get("scale", ()))] or [".10g"] * 3
    axes = zip("xyz", summary.minimum, summary.maximum, summary.size, shown, strict=True)
    return [
        *((k, f"{low:{form}} to {high:{form}}  ({size:.6g})") for k, low, high, size, form in axes),
        ("spacing", _spacing(summary)),
        ("duplicates", f"{summary.n_duplicates:,}"),
        ("overhangs", f"{summary.n_overhangs:,}"),
        ("collinear", _collinear(summary)),
        ("offset", f"{summary.offset:.6g}  (center to origin)"),
        ("float32", _float32(summary)),
    ]


def _decimals(scale: float) -> int:
    """Count the decimals that multiples of a scale have."""
    exponent = Decimal(f"{scale:.6g}").normalize().as_tuple().exponent
    return min(max(0, -int(exponent)), _MOST_DECIMALS)


def _count_note(count: int, what: str) -> str:
    return f", {count:,} {what}" if count else ""


def _spacing(summary: Summary) -> str:
    if summary.spacing is None:
        return "none: one position"
    return f"{summary.spacing:.6g}  (median distance to the nearest neighbour)"


def _float32(summary: Summary) -> str:
    if summary.float32_shift == 0:
        return "enough: holds every coordinate exactly"
    if math.isinf(summary.float32_shift):
        return "not enough: coordinates overflow"
    change = f"changes coordinates by up to {summary.float32_shift:.3g}"
    if summary.spacing:
        change += f", {summary.float32_shift / summary.spacing:.2g} of the spacing"
    return f"enough: {change}" if summary.float32_is_enough else f"not enough: {change}"


def _collinear(summary: Summary) -> str:
    if not summary.collinear:
        return "no"
    reason = "all points are collinear" if summary.n_positions > 2 else "fewer than three positions"
    return f"yes: no triangle exists, {reason}"
