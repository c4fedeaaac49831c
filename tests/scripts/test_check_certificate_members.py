"""The checker without liftmesh, on certificates of weights, radii, metrics and farthest points."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import check_certificate as checker
import numpy as np
import pytest
from sites import FORM, MEMBERS, options

import liftmesh
from liftmesh import _kernel
from liftmesh._typing import Floats, Rows


def some_set(number: int) -> tuple[Floats, Floats]:
    """On a lattice with ties, rows at one position and rows that are not finite; or at random."""
    rng = np.random.default_rng([61, number])
    n = int(rng.integers(6, 40))
    if number % 2:
        return rng.random((n, 2)), rng.random(n) * 0.3
    points = rng.integers(0, 6, (n, 2)).astype(float)
    points[:4] = (0, 0), (6, 0), (0, 6), (np.nan, 1)
    return points, rng.integers(0, 4, n).astype(float)


def made(points: Floats, values: Floats, member: str) -> Rows:
    if member == "farthest":
        return _kernel.farthest(points, True, 1, False, None)[0][3]
    if member == "metric":
        return liftmesh.delaunay(points, metric=FORM, nonfinite="skip").simplices
    return liftmesh.regular(points, **{member: values}, nonfinite="skip").simplices


def held(said: dict[str, Any], points: Floats, simplices: Any, values: Floats) -> int:
    rows = [(x, y) for x, y in points.tolist()]
    corners = [(int(a), int(b), int(c)) for a, b, c in simplices]
    return checker.check(said, rows, corners, [tuple(values.tolist())])


@pytest.mark.parametrize("member", MEMBERS)
def test_it_agrees_with_verify(member: str) -> None:
    for number in range(24):
        points, values = some_set(number)
        right = options(values, member)
        simplices = made(points, values, member)
        certificate = liftmesh.verify(points, simplices, nonfinite="skip", **right)
        assert certificate.canonical
        assert held(certificate.as_dict(), points, simplices, values) == 0
        other = made(points, values, MEMBERS[MEMBERS.index(member) - 1])
        judged = liftmesh.verify(points, other, nonfinite="skip", **right).as_dict()
        assert held(judged, points, other, values) == 0
        flipped = np.roll(simplices[:, ::-1], number, axis=0)
        judged = liftmesh.verify(points, flipped, nonfinite="skip", **right).as_dict()
        assert held(judged, points, flipped, values) == 0


@pytest.mark.parametrize("member", ["weights", "radii"])
def test_rows_on_and_below_the_triangles_are_found(member: str) -> None:
    points = np.array([(0, 0), (4, 0), (4, 4), (0, 4), (1, 2), (0, 0)], dtype=float)
    triangles = [[0, 1, 3], [1, 2, 3]]
    for weight, valid in ((9.0, False), (16.0, False), (25.0, True)):  # below, on, above
        weights = np.array([weight] * 4 + [9.0, 0.0])
        values = np.sqrt(weights) if member == "radii" else weights
        certificate = liftmesh.verify(points, triangles, **{member: values})
        assert certificate.valid is valid
        assert held(certificate.as_dict(), points, triangles, values) == 0


@pytest.mark.parametrize("member", MEMBERS)
def test_it_finds_false_certificates(member: str) -> None:
    points, values = some_set(1)
    simplices = made(points, values, member)
    said = liftmesh.verify(points, simplices, **options(values, member)).as_dict()
    for lie in (
        {"canonical": False},
        {"counts": said["counts"] | {"n_hidden": said["counts"]["n_hidden"] + 1}},
        {"valid": False},
    ):
        assert held(said | lie, points, simplices, values) == 1, lie
    del said["member"]
    said.pop("metric", None)
    for other in {*MEMBERS} - {member}:
        more = {"metric": FORM} if other == "metric" else {}
        lie = {"member": other, **more, "values_sha256": sha256(values.tobytes()).hexdigest()}
        assert held(said | lie, points, simplices, values) == 1, lie


@pytest.mark.parametrize("member", ["delaunay", *MEMBERS])
def test_it_says_which_triangulation_holds(member: str, capsys: pytest.CaptureFixture[str]) -> None:
    points, values = some_set(1)
    plain = member == "delaunay"
    simplices = liftmesh.delaunay(points).simplices if plain else made(points, values, member)
    said = liftmesh.verify(points, simplices, **({} if plain else options(values, member)))
    assert held(said.as_dict(), points, simplices, values) == 0
    named = {
        "delaunay": "Delaunay",
        "weights": "regular by weights",
        "radii": "regular by radii",
        "metric": f"Delaunay in the metric {said.as_dict().get('metric')}",
        "farthest": "farthest-point",
    }
    out = capsys.readouterr().out
    assert (
        out == f"The certificate holds: {len(simplices)} triangles, {named[member]}, canonical.\n"
    )


@pytest.mark.parametrize("member", ["delaunay", "weights", "radii", "farthest"])
def test_a_metric_belongs_to_its_member_alone(member: str) -> None:
    points, values = some_set(1)
    other = made(points, values, "metric")
    said = liftmesh.verify(points, other, metric=FORM).as_dict()
    said |= {"member": member, "values_sha256": sha256(values.tobytes()).hexdigest()}
    with pytest.raises(ValueError, match="it holds a metric, and its member is another"):
        held(said, points, other, values)


def test_a_graph_of_disks_is_beyond_it(tmp_path: Path) -> None:
    graph = liftmesh.apollonius([[0, 0], [5, 0], [0, 5]], [1, 1, 1])
    path = tmp_path / "disks.json"
    path.write_text(graph.verify().to_json())
    with pytest.raises(ValueError, match="it is of a graph of disks, which no mesh file holds"):
        checker.read_certificate(str(path))


MATRIX = "its metric is no matrix of two rows of two numbers"


@pytest.mark.parametrize(
    ("metric", "wrong"),
    [
        ([[2, 1], [7, 3]], "its metric is not symmetric"),
        ([[1, 0], [0, -1]], "its metric is not positive definite"),
        ([[0, 0], [0, 0]], "its metric is not positive definite"),
        ([[1, 2], [2, 1]], "its metric is not positive definite"),
        ([[-2, 0], [0, -2]], "its metric is not positive definite"),
        ([["2.0", 1], [1, 3]], MATRIX),
        ([[True, 0], [0, True]], MATRIX),
        ([[2, 1], [1]], MATRIX),
        ([[2, 1, 1], [3]], MATRIX),
        ([[float("nan"), 1], [1, 3]], MATRIX),
        ([[float("inf"), 1], [1, 3]], MATRIX),
        (5, MATRIX),
        (None, MATRIX),
    ],
)
def test_what_is_no_metric_is_refused(metric: Any, wrong: str) -> None:
    points, values = some_set(1)
    simplices = made(points, values, "metric")
    said = liftmesh.verify(points, simplices, metric=FORM).as_dict()
    with pytest.raises(ValueError, match=wrong):
        held(said | {"metric": metric}, points, simplices, values)
    del said["metric"]
    with pytest.raises(ValueError, match=MATRIX):
        held(said, points, simplices, values)


def test_negative_radii_are_refused() -> None:
    points, values = some_set(1)
    simplices = made(points, values, "radii")
    said = liftmesh.verify(points, simplices, radii=values).as_dict()
    values = -values
    said["values_sha256"] = sha256(values.tobytes()).hexdigest()
    with pytest.raises(ValueError, match="a radius is negative"):
        held(said, points, simplices, values)


def test_weights_come_from_a_column_or_a_file(tmp_path: Path) -> None:
    points, values = some_set(3)
    cloud = liftmesh.Cloud(np.c_[points, values], attributes={"size": values})
    surface = liftmesh.triangulate(cloud, weights="size")
    for name in ("mesh.ply", "mesh.obj"):
        surface.save(tmp_path / name)
    certificate = liftmesh.verify(tmp_path / "mesh.ply").to_json()
    (tmp_path / "said.json").write_text(certificate)
    (tmp_path / "size.txt").write_text("\n".join(map(repr, values.tolist())))
    said, ply, obj, size = (
        str(tmp_path / n) for n in ("said.json", "mesh.ply", "mesh.obj", "size.txt")
    )
    assert json.loads(certificate)["member"] == "weights"
    assert checker.main(said, ply) == 0
    assert checker.main(said, obj, size) == 0
    assert checker.main(said, obj) == 2
    (tmp_path / "size.txt").write_text("1\n2\n")
    assert checker.main(said, obj, size) == 2
