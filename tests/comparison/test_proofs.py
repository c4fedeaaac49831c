"""Proofs about single triangles."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from liftmesh.comparison.proofs import broken_cell, confirm, incircle_determinant, refute

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5]])
ROWS = np.arange(4, dtype=np.int32)


def test_a_point_in_the_circle_refutes() -> None:
    assert incircle_determinant(SQUARE, (0, 1, 2, 3)) == Fraction(1, 2)
    proof = refute(SQUARE, ROWS, ROWS[:3])
    assert str(proof) == (
        "trimesh's facet (0, 1, 2) is wrong: row 3 lies strictly inside its circle, in-circle "
        "determinant 1/2 > 0"
    )
    assert confirm(SQUARE, ROWS, ROWS[:3], [3]) is None


def test_an_empty_circle_confirms() -> None:
    triangle = np.array([0, 1, 3], dtype=np.int32)
    assert refute(SQUARE, ROWS, triangle) is None
    proof = confirm(SQUARE, ROWS, triangle, [2])
    assert proof is not None
    assert (proof.claim, proof.determinants[0][0], proof.tested) == ("right triangle", 2, 1)
    assert proof.determinants[0][1] < 0
    assert broken_cell(triangle).claim == "broken cell"
