"""What the classes that stand in for SciPy's take."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh import InputError
from liftmesh.qhull.common import check_qhull_options, planar_rows


@pytest.mark.parametrize("options", [None, "", "Qbb Qc Qz Q12", "Qt d Pp FA"])
def test_options_that_change_nothing(options: str | None) -> None:
    check_qhull_options(options)


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ("Qt QbB", "Delaunay", "'QbB' may give another triangulation .* scipy.spatial.Delaunay"),
        ("QbB", "Voronoi", "'QbB' may give another diagram .* scipy.spatial.Voronoi"),
        ("QJ", "Delaunay", "'QJ' moves the points at random, .* listed in `coplanar`"),
        ("Qu", "Voronoi", "'Qu' is furthest_site=True here"),
    ],
)
def test_options_that_change_the_result(options: str, kind: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_qhull_options(options, kind)


def test_rows_that_fit_are_taken_as_they_are() -> None:
    rows = np.zeros((3, 2))
    assert planar_rows(rows) is rows
    assert planar_rows([[0, 1]]).tolist() == [[0.0, 1.0]]
    with pytest.raises(InputError, match="points have 3 columns where planar ones are needed"):
        planar_rows(np.zeros((5, 3)))
