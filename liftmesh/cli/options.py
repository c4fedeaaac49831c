"""Options shared by several commands: their help, and the parsing of their values."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from liftmesh.base.options import NonFinite, as_count, as_threads
from liftmesh.errors import InputError

Source: TypeAlias = Annotated[
    Path, typer.Argument(metavar="IN", help="Cloud or mesh; - reads stdin (see --from).")
]
SourceFormat: TypeAlias = Annotated[
    str | None,
    typer.Option("--from", metavar="FORMAT", help="Format of the input, instead of its suffix."),
]
Plane: TypeAlias = Annotated[
    str,
    typer.Option(
        metavar="PLANE",
        help="Projection plane: xy, xz, yz, fit (least squares), a normal NX,NY,NZ, A,B,C,D of the "
        "plane ax + by + cz + d = 0, or a file (text or .npy) with the rigid 4x4 matrix from space "
        "to plane coordinates.",
    ),
]
SkipNonFinite: TypeAlias = Annotated[
    NonFinite, typer.Option("--nonfinite", help="Policy for rows with NaN or infinity.")
]
Threads: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--threads",
        metavar="N",
        help="Number of threads; by default LIFTMESH_NUM_THREADS, or one per core.",
    ),
]
TargetFormat: TypeAlias = Annotated[
    str | None,
    typer.Option("--format", metavar="FORMAT", help="Format of OUT, instead of its suffix."),
]
MaxBytes: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--max-bytes",
        metavar="SIZE",
        help="Limit of what a compressed, instanced or very wide file may expand to in memory, as "
        "500M or 4G.",
    ),
]
ColorDepth: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--color-depth",
        metavar="BITS",
        help="Bits per channel of integer colours, 8 or 16; by default their values decide.",
    ),
]
Weights: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--weights",
        metavar="COLUMN",
        help="Values of IN that are weights: makes the regular triangulation, the dual of the "
        "power diagram, which may hide rows.",
    ),
]
Radii: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--radii", metavar="COLUMN", help="The same with radii, whose squares are weights."
    ),
]
Metric: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--metric",
        metavar="A,B,C",
        help="Triangulate in the metric a x^2 + 2 b xy + c y^2 of plane coordinates.",
    ),
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def parse_plane(text: str) -> Any:
    """Parse the value of ``--plane`` to an argument of `liftmesh.triangulate`."""
    if text in {"xy", "xz", "yz", "fit"}:
        return text
    numbers = _numbers(text, 3) or _numbers(text, 4)
    return _matrix(text) if numbers is None else numbers


def parse_box(text: str) -> tuple[float, ...] | None:
    """Parse a box of four numbers separated by commas."""
    return _numbers(text, 4)


def parse_q(text: str) -> Any:
    """Parse the value of ``--q`` to an argument q of `liftmesh`."""
    if text in {"median", "origin"}:
        return text
    numbers = _numbers(text, 2)
    if numbers is None or not all(map(math.isfinite, numbers)):
        raise typer.BadParameter(f"--q {text!r} is unknown: give median, origin or a finite QX,QY")
    return numbers


def parse_member(weights: str | None, radii: str | None, metric: str | None) -> dict[str, Any]:
    """Parse the options that say by what points are lifted."""
    options = {"weights": weights, "radii": radii, "metric": parse_metric(metric)}
    given = {name: each for name, each in options.items() if each is not None}
    if len(given) > 1:
        raise typer.BadParameter(f"--{' and --'.join(given)} are given: give one of them")
    return given


def parse_metric(text: str | None) -> Any:
    """Parse the value of ``--metric``, before the work starts."""
    if text is None:
        return None
    numbers = _numbers(text, 3)
    if numbers is None:
        raise typer.BadParameter(f"--metric {text!r} is not three numbers: give A,B,C")
    from liftmesh.planar.kinds import as_metric  # noqa: PLC0415 - help and --version do without

    a, b, c = numbers
    try:
        as_metric([[a, b], [b, c]])
    except InputError as error:
        raise typer.BadParameter(f"--{error}") from error
    return (a, b), (b, c)


def parse_size(text: str | None, option: str = "--max-bytes") -> int | None:
    """Parse the value of an option that is a size."""
    if text is None:
        return None
    found = re.fullmatch(r"([0-9]{1,18})([kMGT]?)B?", text, re.IGNORECASE)
    size = 0 if found is None else int(found[1]) * 1000 ** " KMGT".index(found[2].upper() or " ")
    if not size:
        raise typer.BadParameter(f"{option} {text!r} is not a size: give one as 500M or 4G")
    return size


def parse_count(option: str, text: str, least: int) -> int:
    """Parse the value of an option that is a whole number."""
    try:
        return as_count(option, _whole(text), least)
    except InputError as error:
        raise typer.BadParameter(str(error)) from error


def parse_length(option: str, text: str) -> float:
    """Parse a positive number, before the work starts."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise typer.BadParameter(f"{option} {text!r} is not a positive number")
    return value


def _whole(text: str) -> int | str:
    """Convert digits, and leave other text."""
    return int(text) if re.fullmatch(r"[+-]?[0-9]{1,18}", text) else text


def parse_threads(text: str | None) -> int | None:
    """Parse the value of ``--threads``, before the work starts."""
    threads: Any = None if text is None else _whole(text)
    from liftmesh.base.arrays import MOST_ROWS  # noqa: PLC0415 - help and --version do without

    try:
        as_threads(threads, MOST_ROWS)
    except InputError as error:
        option = "--" if threads is not None else ""
        raise typer.BadParameter(f"{option}{error}") from error
    return None if text is None else int(text)


def parse_color_depth(text: str | None) -> int | None:
    """Parse the value of ``--color-depth``, before the work starts."""
    from liftmesh.base.colors import DEPTHS  # noqa: PLC0415 - help and --version do without

    depth = None if text is None else _whole(text)
    if depth is not None and depth not in DEPTHS:
        raise typer.BadParameter(f"--color-depth {text} is not a depth: give 8, 16, 32 or 64")
    return None if depth is None else int(depth)


def _numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Parse numbers separated by commas; None if the text is not that many numbers."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        return None
    return numbers if len(numbers) == count else None


def _read_npy(path: Path) -> Any:
    from liftmesh.io.formats.numpy_arrays import read_array  # noqa: PLC0415 - as above

    with path.open("rb") as stream:
        return read_array(stream, path.name)


def _matrix(text: str) -> Any:
    """Read a 4x4 matrix from a text or .npy file."""
    import numpy as np  # noqa: PLC0415 - help and --version do without

    path = Path(text)
    if not path.is_file():
        raise typer.BadParameter(
            f"--plane {text!r} is neither a known name nor a file: "
            "give xy, xz, yz, fit, NX,NY,NZ, A,B,C,D or a file with a 4x4 matrix"
        )
    try:
        matrix = _read_npy(path) if path.suffix == ".npy" else np.loadtxt(path)
    except (ValueError, OSError) as error:
        raise typer.BadParameter(f"--plane {path}: cannot read a matrix: {error}") from error
    if matrix.shape != (4, 4):
        raise typer.BadParameter(f"--plane {path}: the matrix is {matrix.shape}, not 4x4")
    return matrix
