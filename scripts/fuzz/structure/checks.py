"""Read a generated file under measurement, and hold it to what must be true of every file.

Besides the properties of `round_trip.py`: time and memory in proportion to the file, no warning,
and nothing printed. A file without lies is read, and has the points that it was made of. A file
that is refused whole is refused in chunks as well, unless only what chunks do not read is wrong.
"""

from __future__ import annotations

import io
import os
import tempfile
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from files import stream_of
from fuzz.round_trip import READ_BACK, FindError, demand, outcome
from fuzz.structure.case import Case, in_order
from process_state import memory

from liftmesh import Cloud, DataWarning, FormatError, InputError, read, read_chunks, write
from liftmesh.io.registry import find_format
from liftmesh.io.tetrahedra import FORMATS as CELLS, read_tetrahedra

# CPU seconds of reading, and bytes of resident memory, for each byte and beside it.
SECONDS, SECONDS_A_BYTE = 2.0, 20e-6
MEMORY, MEMORY_A_BYTE = 16 << 20, 20

OWN = ("npz", "off", "stl", "glb", "gltf", "las")
"""Formats that a cloud is written to, and read back."""


@dataclass(frozen=True, slots=True)
class Measured:
    """How long reading took, how much memory it needed, and what is wrong, if anything."""

    seconds: float
    memory: int
    fault: str


def check(case: Case, printed: int) -> Measured:
    """Read a file twice: measured, and with all properties; ``printed`` is the file of stdout."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", DataWarning)  # of what a table says of its units
        seconds, memory, fault = _measured(case)
        fault = fault or _broken(case)
    if not fault and told:
        fault = f"{told[0].category.__name__}: {told[0].message}"
    said = _taken(printed)
    if not fault and said and not _is_panic(case, said):
        fault = f"printed: {said.decode('utf-8', 'replace').strip()[-300:]}"
    if not fault and seconds > SECONDS + SECONDS_A_BYTE * case.size:
        fault = f"time: {seconds:.1f} s for {case.size} bytes"
    # meshio makes a table up to the largest number of a node, which files of Gmsh may choose.
    is_bounded = case.kind != "msh"
    if not fault and is_bounded and memory > MEMORY + MEMORY_A_BYTE * case.size:
        fault = f"memory: {memory >> 20} MB for {case.size} bytes"
    return Measured(seconds, memory, fault)


def _measured(case: Case) -> tuple[float, int, str]:
    """Read a file; return the CPU seconds, the growth of resident memory, and what escaped."""
    stream = stream_of(case.data, case.kind)
    before = _start_of_peak()
    began = time.process_time()
    fault = ""
    try:
        if case.kind in CELLS:
            _cells(case)
        elif case.options:
            read(stream, format=case.kind, **case.options)
            stream.seek(0)
        if case.kind not in CELLS:
            read(stream, format=case.kind)
    except FormatError:
        pass
    except Exception as error:  # noqa: BLE001 - this is what is looked for
        fault = _described(error)
    return time.process_time() - began, max(memory("VmHWM") - before, 0), fault


def _broken(case: Case) -> str:
    """Describe the property that does not hold; "" if all do."""
    try:
        if case.kind in CELLS:
            _check_cells(case)
            return ""
        found = outcome(case.data, case.kind)
        if isinstance(found, str):
            demand(case.points is None, f"a whole file is refused: {found}")
            _check_refused(case)
        else:
            _check_own(found)
            _check_points(found, case)
    except Exception as error:  # noqa: BLE001 - this is what is looked for
        return _described(error)
    return ""


def _cells(case: Case) -> Cloud:
    """Read a file of tetrahedra, which are no part of a cloud: its points."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"a.{case.kind}")
        path.write_bytes(case.data)
        points, tetrahedra = read_tetrahedra(path)
    demand(tetrahedra.ndim == 2 and tetrahedra.shape[1] == 4, "tetrahedra of other corners")
    return Cloud(points)


def _check_cells(case: Case) -> None:
    try:
        found = _cells(case)
    except FormatError as error:
        demand(case.points is None, f"a whole file is refused: {error}")
    else:
        _check_points(found, case)


def _described(error: BaseException) -> str:
    """Name an exception, and the function of liftmesh that it came out of."""
    at = error.__traceback__
    place = ""
    while at is not None:
        path = Path(at.tb_frame.f_code.co_filename)
        if "liftmesh" in path.parts:
            place = f" in {path.name}:{at.tb_frame.f_code.co_name}"
        at = at.tb_next
    return f"{type(error).__name__}{place}: {str(error)[:300]}"


def _check_refused(case: Case) -> None:
    """Read a file in chunks that cannot be read whole: nothing but a `FormatError` may escape."""
    try:
        for _ in read_chunks(stream_of(case.data, case.kind), rows=2, format=case.kind):
            pass
    except FormatError:
        return
    in_chunks = find_format(case.kind, "a file").read_chunks is not None
    demand(in_chunks, "refused whole, but read in chunks")


def _check_points(cloud: Cloud, case: Case) -> None:
    """Compare with the points that the file was made of, as a set."""
    if case.points is None:
        return
    found, made = (np.unique(np.rint(rows * 4096), axis=0) for rows in (cloud.points, case.points))
    if case.others:  # rows of lines may be there as well
        missing = {*map(tuple, made.tolist())} - {*map(tuple, found.tolist())}
        is_more = len(found) > len(made)
        demand(is_more or "not_read" in cloud.metadata, "a mesh is neither read nor named")
        demand(not missing, f"{len(missing)} points of {len(made)} are missing")
    else:
        same = found.shape == made.shape and np.array_equal(found, made)
        demand(same, f"other points: {len(found)}, where {len(made)} were written")
    if case.kind not in ("stl", "glb", "gltf"):
        demand(np.array_equal(in_order(cloud.points), case.points), "other points: not bit for bit")


def _check_own(cloud: Cloud) -> None:
    """Write a cloud in the other formats: whole files, or a `LiftmeshError`."""
    for kind in OWN:
        stream = io.BytesIO()
        try:
            write(stream, cloud, format=kind)
        except (FormatError, InputError):  # InputError: colours outside their range
            continue
        stream.seek(0)
        try:
            back = read(stream, format=kind, **READ_BACK.get(kind, {}))
        except FormatError as error:
            raise FindError(f"{kind} that was written cannot be read: {error}") from error
        if kind == "npz":
            demand(_same(back.points, cloud.points), "NPZ changes points")
            demand(
                back.attributes.keys() == cloud.attributes.keys(), "NPZ loses or invents attributes"
            )


def _same(a: np.ndarray[Any, Any], b: np.ndarray[Any, Any]) -> bool:
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def _is_panic(case: Case, said: bytes) -> bool:
    """Whether lazrs told of damage that it did not foresee: Rust prints what is then caught."""
    return case.kind == "laz" and b"panicked at" in said


def _taken(printed: int) -> bytes:
    """Return what was printed so far, and forget it."""
    size = os.fstat(printed).st_size
    said = os.pread(printed, size, 0)
    os.ftruncate(printed, 0)
    return said


def _start_of_peak() -> int:
    """Let the peak of resident memory begin anew; return the present value."""
    with open("/proc/self/clear_refs", "w") as file:  # noqa: PTH123 - not a file
        file.write("5")
    return memory("VmRSS")
