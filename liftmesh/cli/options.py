"""Options shared by several commands: their help, and the parsing of their values."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from liftmesh.choices import NonFinite
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
        help="Projection plane: xy, fit (least squares), a normal NX,NY,NZ, or a file (text or "
        ".npy) with the rigid 4x4 matrix from space to plane coordinates.",
    ),
]
SkipNonFinite: TypeAlias = Annotated[
    NonFinite, typer.Option("--nonfinite", help="Policy for rows with NaN or infinity.")
]
Threads: TypeAlias = Annotated[
    int | None,
    typer.Option(
        "--threads",
        metavar="N",
        help="Number of threads; by default LIFTMESH_NUM_THREADS, or one per core.",
    ),
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
    int | None,
    typer.Option(
        "--color-depth",
        metavar="BITS",
        help="Bits per channel of integer colours, 8 or 16; by default their values decide.",
    ),
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def parse_plane(text: str) -> Any:
    """Parse the value of ``--plane`` to an argument of `liftmesh.triangulate`.

    Parameters
    ----------
    text : str
        A name, three numbers separated by commas, or a path.

    Returns
    -------
    str, tuple of float or (4, 4) ndarray
        The plane.

    Raises
    ------
    typer.BadParameter
        The text is not one of these, or the file does not hold a 4x4 matrix.

    Examples
    --------
    >>> parse_plane("0,0,1")
    (0.0, 0.0, 1.0)
    """
    if text in {"xy", "fit"}:
        return text
    numbers = _numbers(text, 3)
    return _matrix(Path(text)) if numbers is None else numbers


def parse_q(text: str) -> Any:
    """Parse the value of ``--q`` to an argument q of `liftmesh`.

    Parameters
    ----------
    text : str
        A name, or two numbers separated by a comma.

    Returns
    -------
    str or tuple of float
        The vertex of the paraboloid.

    Raises
    ------
    typer.BadParameter
        The text is neither.

    Examples
    --------
    >>> parse_q("1.5,-2")
    (1.5, -2.0)
    """
    if text in {"median", "origin"}:
        return text
    numbers = _numbers(text, 2)
    if numbers is None or not all(map(math.isfinite, numbers)):
        raise typer.BadParameter(f"--q {text!r} is unknown: give median, origin or a finite QX,QY")
    return numbers


def parse_size(text: str | None) -> int | None:
    """Parse the value of ``--max-bytes``.

    Parameters
    ----------
    text : str, optional
        A whole number of bytes, or of the unit that follows it: k, M, G or T, decimal as in the
        output of the commands.

    Returns
    -------
    int or None
        Number of bytes; None without an option.

    Raises
    ------
    typer.BadParameter
        The text is not a size from 1 byte.

    Examples
    --------
    >>> parse_size("500M")
    500000000
    """
    if text is None:
        return None
    found = re.fullmatch(r"([0-9]{1,18})([kMGT]?)B?", text, re.IGNORECASE)
    size = 0 if found is None else int(found[1]) * 1000 ** " KMGT".index(found[2].upper() or " ")
    if not size:
        raise typer.BadParameter(f"--max-bytes {text!r} is not a size: give one as 500M or 4G")
    return size


def check_threads(threads: int | None) -> None:
    """Raise before the work starts if the number of threads is invalid.

    Parameters
    ----------
    threads : int, optional
        The number; by default that of the environment or of the cores.

    Raises
    ------
    typer.BadParameter
        The number, or that of the environment, is not between 1 and 1024.
    """
    from liftmesh.arrays import MOST_ROWS  # noqa: PLC0415 - help and --version do without
    from liftmesh.threads import as_threads  # noqa: PLC0415 - as above

    try:
        as_threads(threads, MOST_ROWS)
    except InputError as error:
        option = "--" if threads is not None else ""
        raise typer.BadParameter(f"{option}{error}") from error


def check_color_depth(depth: int | None) -> None:
    """Raise before the work starts if a depth of colours is invalid.

    Parameters
    ----------
    depth : int, optional
        The value of ``--color-depth``.

    Raises
    ------
    typer.BadParameter
        It is not 8, 16, 32 or 64.
    """
    from liftmesh.color_depth import DEPTHS  # noqa: PLC0415 - help and --version do without

    if depth is not None and depth not in DEPTHS:
        raise typer.BadParameter(f"--color-depth {depth} is not a depth: give 8, 16, 32 or 64")


def _numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Parse numbers separated by commas; None if the text is not that many numbers."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        return None
    return numbers if len(numbers) == count else None


def _read_npy(path: Path) -> Any:
    from liftmesh.io.npy_array import read_array  # noqa: PLC0415 - as above

    with path.open("rb") as stream:
        return read_array(stream, path.name)


def _matrix(path: Path) -> Any:
    """Read a 4x4 matrix from a text or .npy file."""
    import numpy as np  # noqa: PLC0415 - help and --version do without

    if not path.is_file():
        raise typer.BadParameter(
            f"--plane {str(path)!r} is neither a known name nor a file: "
            "give xy, fit, NX,NY,NZ or a file with a 4x4 matrix"
        )
    try:
        matrix = _read_npy(path) if path.suffix == ".npy" else np.loadtxt(path)
    except (ValueError, OSError) as error:
        raise typer.BadParameter(f"--plane {path}: cannot read a matrix: {error}") from error
    if matrix.shape != (4, 4):
        raise typer.BadParameter(f"--plane {path}: the matrix is {matrix.shape}, not 4x4")
    return matrix
