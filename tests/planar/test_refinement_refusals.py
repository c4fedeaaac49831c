"""refine: options and domains that are refused, each named with its value."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import constrained_delaunay, refine

STRIP = [[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 1.0]]
SQUARE = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
HALVES = constrained_delaunay(SQUARE, [[0, 2]])

Array = np.ndarray[Any, Any]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"min_angle": 46}, "min_angle is 46: give degrees from 0 to 45"),
        ({"min_angle": -1}, "min_angle is -1"),
        ({"min_angle": np.nan}, "min_angle is nan"),
        ({"min_angle": "30"}, "min_angle is '30'"),
        (
            {"max_area": 0},
            "max_area is 0: give a positive number, or one for each of the 2 regions",
        ),
        ({"max_area": np.nan}, "max_area is nan"),
        ({"max_area": "x"}, "max_area is 'x'"),
        ({"max_area": [1, 2, 3]}, r"max_area is \[1, 2, 3\]: .* each of the 2 regions"),
        ({"max_area": [1, -2]}, "max_area is .*each of the 2 regions"),
        ({"max_area": [1, np.nan]}, "max_area is"),
        ({"size": 0}, "size is 0: give a positive number, one for each row"),
        ({"max_area": -np.inf}, "max_area is -inf: give a positive number, or one"),
        ({"size": [1, 2, 3]}, r"size has the shape \(3,\), and there are 4 rows and 2 regions"),
        ({"size": [1, -2]}, r"size is \[1, -2\]: give a positive number, one for each row or each"),
        ({"size": -np.inf}, "size is -inf: give"),
        ({"size": lambda _: None}, "size returned None: give a positive number"),
        ({"size": lambda _: 0.5}, "size returned 0.5: give"),
        ({"threads": "x"}, "threads is 'x': give a whole number"),
        ({"threads": -5}, "threads is -5: give a whole number"),
        ({"size": [1, 2, -3, 4]}, r"size is -3.0 at \(4.0, 4.0\): give"),
        ({"size": ["a"]}, "size is"),
        ({"size": lambda p: p}, r"size returned the shape \(\d+, 2\) of points"),
        ({"size": lambda p: p[:, 0] * np.nan}, r"size is nan at \("),
        ({"size": lambda p: p[:, 0] * 0}, r"size is 0.0 at \("),
        ({"size": lambda _: "long"}, "size returned 'long': give"),
        ({"conforming": "yes"}, "conforming is 'yes'"),
        ({"max_points": -1}, "max_points is -1"),
        ({"progress": 3}, "progress is 3"),
    ],
)
def test_wrong_options_are_named(options: dict[str, Any], said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        refine(HALVES, **options)


def test_wrong_domains_are_named() -> None:
    with pytest.raises(liftmesh.UnsupportedTypeError, match="is a DynamicTriangulation: give"):
        refine(liftmesh.DynamicTriangulation(SQUARE))
    with pytest.raises(liftmesh.InputError, match="a triangulation with metric, and only Delaunay"):
        refine(liftmesh.delaunay(SQUARE, metric=[[1, 0], [0, 2]]))
    with pytest.raises(liftmesh.InputError, match="a triangulation with weights"):
        refine(liftmesh.regular(SQUARE, weights=[0, 1, 2, 3]))
    with pytest.raises(liftmesh.InputError, match="polygons are 3"):
        refine(3)
    with pytest.raises(liftmesh.UnsupportedTypeError, match="the domain is None: give"):
        refine(None)
    with pytest.raises(liftmesh.InputError, match=r"max_area is 0: give a positive number$"):
        refine(STRIP, max_area=0)
    with pytest.raises(liftmesh.DegenerateInputError, match="on one line"):
        refine([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])
    with pytest.raises(liftmesh.InputError, match="threads is 0"):
        refine(STRIP, threads=0)


def test_sizes_by_rows_or_regions_are_refused() -> None:
    rows = [*SQUARE[:3], [2.0, 1.0], [3.0, 2.0]]
    faces = liftmesh.delaunay(rows).simplices.tolist()
    pairs = {tuple(sorted(pair)) for face in faces for pair in combinations(face, 2)}
    with pytest.raises(liftmesh.InputError, match="there are 5 rows and 5 regions"):
        refine(constrained_delaunay(rows, sorted(pairs)), size=[1, 2, 3, 4, 5])


def test_what_a_size_function_raises_is_raised() -> None:
    def broken(_: Array) -> Array:
        raise ZeroDivisionError("of the caller")

    with pytest.raises(ZeroDivisionError, match="of the caller"):
        refine(STRIP, size=broken)
