"""Slopes, aspects, shades and the layout of pixels."""

from __future__ import annotations

import numpy as np

from liftmesh.raster.pixels import centres_of
from liftmesh.terrain.ground import bare_warning
from liftmesh.terrain.rasters import shade_of
from liftmesh.terrain.sampling import aspect_degrees, slope_degrees
from liftmesh.terrain.simplification import merged_deviation


def test_aspects_are_where_faces_descend() -> None:
    gradients = np.array([[0.0, -1.0], [-1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [0.0, 0.0]])
    aspects = aspect_degrees(gradients)
    assert aspects[:4].tolist() == [0, 90, 180, 270]
    assert np.isnan(aspects[4])


def test_slopes_are_degrees() -> None:
    assert slope_degrees(np.array([[0.0, -1.0], [0.0, 0.0]])).round(9).tolist() == [45, 0]


def test_shades_are_brightest_towards_the_light() -> None:
    gradients = np.array([[0.0, 0.0], [-1.0, 0.0]])
    assert shade_of(gradients, np.array([0.0, 0.0, 1.0])).round().tolist() == [255, 180]
    assert shade_of(gradients, np.array([-1.0, 0.0, 0.0])).round().tolist() == [0, 0]


def test_centres_are_half_a_pixel_from_the_corner() -> None:
    centres = centres_of((1.0, 0.0, 0.0, 0.0, -1.0, 2.0), range(1), 2)
    assert centres.tolist() == [[[0.5, 1.5], [1.5, 1.5]]]


def test_merged_rows_deviate_by_their_heights() -> None:
    heights = np.array([1.0, 4.0, 9.0])
    assert merged_deviation(heights, np.array([1, 2]), np.array([0, -1])) == 3
    assert merged_deviation(heights, np.array([], int), np.array([], int)) == 0


def test_a_cloth_that_lost_few_cells_is_no_warning() -> None:
    counts = {"algorithm": "csf", "cells": 400, "bare_cells": 12, "cloth_resolution": 2.0}
    assert bare_warning(counts) == ""
    assert "12 of 40 cells of 10 m have no ground" in bare_warning({**counts, "cells": 40})
