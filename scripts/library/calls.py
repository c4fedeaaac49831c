"""The C interface through ctypes: every array and status compared with the Python package's."""

from __future__ import annotations

import ctypes
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from distributions import Points

import liftmesh

TOO_FEW, COLLINEAR = 2, 3
Mesh = ctypes.c_void_p
Found = tuple[int, dict[str, np.ndarray]]


def compare_calls(path: Path, sets: list[Points]) -> list[str]:
    """Name the sets of which a library and the package differ."""
    library = opened(path)
    spoilt = np.array(sets[0])
    spoilt[7, 1] = np.nan
    asked = [*sets, spoilt]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda points: called(library, points), asked))
    wrong = [
        f"ctypes: set {i}" for i, each in enumerate(asked) if not same(found[i], expected(each))
    ]
    if found[-1][1]["row"].tolist() != [7]:
        wrong.append("ctypes: the row that is not finite")
    if library.lm_delaunay(None, 3, 1, ctypes.byref(Mesh())) != 6:
        wrong.append("ctypes: a null pointer")
    if library.lm_delaunay(spoilt.ctypes, 10**9, 1, ctypes.byref(Mesh())) != 4:
        wrong.append("ctypes: too many rows")
    if called(library, np.zeros((0, 2)))[0] != TOO_FEW or any(lengths_of(library, Mesh()).values()):
        wrong.append("ctypes: no mesh")
    library.lm_free(None)
    if library.lm_version().decode() != liftmesh.__version__:
        wrong.append("ctypes: the version")
    print(f"ctypes: {len(asked)} sets, {len(wrong)} faults")
    return wrong


def opened(path: Path) -> ctypes.CDLL:
    library = ctypes.CDLL(str(path))
    pointer = ctypes.c_void_p
    library.lm_delaunay.argtypes = [pointer, ctypes.c_size_t, ctypes.c_uint, ctypes.POINTER(Mesh)]
    for name in ("triangle_count", "hull_count", "duplicate_count", "row"):
        getattr(library, f"lm_{name}").argtypes = [Mesh]
        getattr(library, f"lm_{name}").restype = ctypes.c_size_t
    for name in ("triangles", "neighbors", "hull", "duplicates"):
        getattr(library, f"lm_{name}").argtypes = [Mesh]
        getattr(library, f"lm_{name}").restype = pointer
    library.lm_free.argtypes = [Mesh]
    library.lm_free.restype = None
    library.lm_version.restype = ctypes.c_char_p
    return library


def called(library: ctypes.CDLL, points: Points) -> Found:
    """Return the status, and all arrays of a mesh where there is one."""
    rows = np.ascontiguousarray(points, dtype=float)
    mesh = Mesh()
    status = library.lm_delaunay(rows.ctypes, len(rows), 2, ctypes.byref(mesh))
    if not mesh:
        return status, {}
    arrays = {
        name: copied(getattr(library, f"lm_{name}")(mesh), length)
        for name, length in lengths_of(library, mesh).items()
    }
    arrays["row"] = np.array([library.lm_row(mesh)])
    library.lm_free(mesh)
    return status, arrays


def lengths_of(library: ctypes.CDLL, mesh: Mesh) -> dict[str, int]:
    triangles = library.lm_triangle_count(mesh)
    return {
        "triangles": 3 * triangles,
        "neighbors": 3 * triangles,
        "hull": library.lm_hull_count(mesh),
        "duplicates": 2 * library.lm_duplicate_count(mesh),
    }


def copied(address: int | None, length: int) -> np.ndarray:
    return np.array(
        (ctypes.c_int32 * length).from_address(address or 0)[:] if length else [], np.int32
    )


def expected(points: Points) -> Found:
    try:
        found = liftmesh.delaunay(points)
    except liftmesh.NonFiniteError:
        return 1, {}
    except liftmesh.DegenerateInputError:
        return TOO_FEW if len(np.unique(points, axis=0)) < 3 else COLLINEAR, {}
    return 0, {
        "triangles": found.simplices,
        "neighbors": found.neighbors,
        "hull": found.convex_hull,
        "duplicates": found.duplicates,
    }


def same(found: Found, wanted: Found) -> bool:
    status, arrays = wanted
    return found[0] == status and all(
        np.array_equal(found[1][name], array.ravel()) for name, array in arrays.items()
    )
