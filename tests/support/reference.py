"""CGAL's Delaunay triangulation, which breaks ties by the same canonical rule, as a reference."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from CGAL.CGAL_Kernel import Point_2
from CGAL.CGAL_Triangulation_2 import Delaunay_triangulation_2
from meshes import triangle_rows
from numpy.typing import NDArray

SIGNIFICANT_DIGITS = 17  # enough to name every double
INFINITE_VERTEX = 0


def cgal_triangles(points: NDArray[np.float64], folder: Path) -> NDArray[np.float64]:
    """CGAL's triangles as `triangle_rows` returns them.

    They come by way of CGAL's own text file, because asking its Python objects for each corner
    takes three times as long. Its numbers name every double exactly.
    """
    triangulation = Delaunay_triangulation_2()
    triangulation.insert(list(map(Point_2, *points.T.tolist())))
    path = folder / "cgal.txt"
    triangulation.write_to_file(str(path), SIGNIFICANT_DIGITS)
    return read_triangles(path)


def read_triangles(path: Path) -> NDArray[np.float64]:
    """Parse CGAL's file: three counts, the finite vertices' coordinates, the faces' vertices."""
    words = path.read_text().split()
    vertices, faces = int(words[0]) - 1, int(words[1])
    points = np.array(words[3 : 3 + 2 * vertices], dtype=np.float64).reshape(-1, 2)
    start = 3 + 2 * vertices
    triples = np.array(words[start : start + 3 * faces], dtype=np.int64).reshape(-1, 3)
    return triangle_rows(points, triples[(triples != INFINITE_VERTEX).all(axis=1)] - 1)
