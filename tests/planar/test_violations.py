"""Places where triangles or graphs of disks are wrong, in words."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import liftmesh
from liftmesh.disks import verification as disks
from liftmesh.disks.verification import DiskViolations
from liftmesh.planar import space_verification, violations
from liftmesh.planar.kinds import TriangulationKind
from liftmesh.planar.violations import TriangleViolations
from liftmesh.tiles import proof

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def test_a_flaw_counts_its_places() -> None:
    violations = TriangleViolations(CORNERS, np.array([[0, 2, 1]]), TriangulationKind())
    flaw = violations.flaw("clockwise", 1, [(0, 0)])
    assert flaw.text == "1 triangle is clockwise"
    assert (flaw.first[0].rows, flaw.first[0].triangles, flaw.first[0].sign) == (
        (0, 2, 1),
        (0,),
        -1,
    )
    assert violations.flaw("degenerate", 2000, []).text == "2,000 triangles are degenerate"


@pytest.mark.parametrize(
    ("name", "text"),
    [("delaunay", "1 row has no vertex"), ("weights", "1 row has no vertex, and is not hidden")],
)
def test_what_a_kind_calls_a_flaw(name: str, text: str) -> None:
    violations = TriangleViolations(
        CORNERS, np.array([[0, 1, 2]]), TriangulationKind(name, np.zeros(3))
    )
    flaw = violations.flaw("missing_vertices", 1, [(1, 0)])
    assert flaw.text == text
    assert flaw.first[0].text.startswith("row 1 (1.0, 0.0) is not a vertex")


def test_several_rows_are_listed() -> None:
    violations = DiskViolations(np.array([[0.0, 1.0], [2.0, 0.5]]), {})
    flaw = violations.flaw("wrong_duplicates", 1, [(0, 1)])
    assert flaw.first[0].text.startswith("rows 0 (0.0, 1.0) and 1 (2.0, 0.5) are not the same disk")
    flaw = violations.flaw("missing_vertices", 1, [(0, 0)])
    assert flaw.first[0].text == "row 0 (0.0, 1.0) is in no triangle, not hidden, and no duplicate"
    assert violations.flaw("wrong_hidden", 1, [(0, 2)]).text == "1 row is not hidden"


ROOT = Path(liftmesh.__file__).parent
KERNELS = {
    "flaws.hpp": violations.MEANINGS,
    "disks.hpp": disks.MEANINGS,
    "simplices.hpp": space_verification._MEANINGS,
}


@pytest.mark.parametrize("header", KERNELS)
def test_flaws_have_the_names_and_the_order_of_the_kernel(header: str) -> None:
    text = (ROOT / "_core" / "verify" / header).read_text("utf-8")
    body = re.search(r"enum class \w*Flaw : std::uint8_t \{(.*?)kinds\n", text, re.DOTALL)
    assert body
    assert re.findall(r"^ +(\w+),", body[1], re.MULTILINE) == [*KERNELS[header]]


def test_every_kind_of_flaw_is_documented() -> None:
    code = "".join(path.read_text("utf-8") for path in ROOT.rglob("*.py"))
    made = re.findall(r'[Ff]law\(\s*"(\w+)"', code)
    of_tiles = proof._MEANINGS
    documented = re.search(r"kind : str(.*?)count : int", liftmesh.Flaw.__doc__ or "", re.DOTALL)
    assert documented
    of_space = {f"no_{several}" for _, several in space_verification._SIMPLICES.values()}
    known = of_space.union(made, of_tiles, *KERNELS.values())
    assert {*re.findall(r'"(\w+)"', documented[1])} == known
