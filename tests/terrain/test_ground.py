"""`classify_ground`: CSF in metres, silently, the same in every run; and what it is not given."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh as command
from files.las import encoded, records
from scipy.interpolate import LinearNDInterpolator

import liftmesh
from liftmesh import Cloud, InputError, MissingDependencyError

FEET = 'PROJCS["a",GEOGCS["b",UNIT["degree",0.0174532925199433]],UNIT["foot",0.3048]]'


def scene(scale: float = 1.0, **options: Any) -> tuple[Cloud, np.ndarray]:
    """Make a slope with trees and a flat roof, and say what is ground."""
    rng = np.random.default_rng(3)
    plane = rng.random((6000, 2)) * 60
    heights = 0.1 * plane[:, 0] + 0.5 * np.sin(plane[:, 1] / 10)
    is_ground = np.ones(6000, bool)
    for place in rng.random((12, 2)) * 50 + 5:
        tree = (np.hypot(*(plane - place).T) < 2) & (rng.random(6000) < 0.6)
        heights[tree] += 3 + 4 * rng.random(int(tree.sum()))
        is_ground &= ~tree
    roof = (np.abs(plane - 30) < 5).all(axis=1) & is_ground
    heights[roof] = 9
    points = np.column_stack([plane, heights]) / scale + (500000, 5400000, 100)
    return Cloud(points, **options), is_ground & ~roof


def kappa(found: np.ndarray, truth: np.ndarray) -> float:
    agree = float((found == truth).mean())
    chance = found.mean() * truth.mean() + (1 - found.mean()) * (1 - truth.mean())
    return float((agree - chance) / (1 - chance))


def test_ground_is_found_and_the_same_in_every_run(
    capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "CSF.py").write_text("raise SystemExit('of the current folder')")
    cloud, truth = scene()
    found = liftmesh.classify_ground(cloud)
    ground = found.attributes["classification"] == 2
    assert kappa(ground, truth) > 0.9
    again = liftmesh.classify_ground(cloud).attributes["classification"]
    assert np.array_equal(again, found.attributes["classification"])
    assert found.metadata["ground"] == {
        "rows": 6000, "ground": int(ground.sum()), "algorithm": "csf", "cloth_resolution": 0.5,
        "cloth_rigidness": 2, "cloth_threshold": 0.5, "unit_known": False, "z_unit_known": False,
        "cells": 561, "bare_cells": found.metadata["ground"]["bare_cells"],
    }  # fmt: skip
    assert 0 < found.metadata["ground"]["bare_cells"] < 40  # below the roof
    assert capfd.readouterr() == ("", "")
    assert [each.name for each in tmp_path.iterdir()] == ["CSF.py"]


def test_feet_are_converted() -> None:
    metres, truth = scene()
    feet, _ = scene(0.3048, crs=FEET)
    one, two = (liftmesh.classify_ground(each) for each in (metres, feet))
    classes = [each.attributes["classification"] for each in (one, two)]
    assert (classes[0] == classes[1]).mean() > 0.999
    assert kappa(classes[1] == 2, truth) > 0.9
    assert two.metadata["ground"]["unit_known"]


def test_heights_in_feet_over_metres_are_converted() -> None:
    metres, truth = scene()
    high = replace(metres, points=metres.points / (1, 1, 0.3048), crs="EPSG:25832+8228")
    one, two = (liftmesh.classify_ground(each) for each in (metres, high))
    classes = [each.attributes["classification"] for each in (one, two)]
    assert (classes[0] == classes[1]).mean() > 0.999
    assert kappa(classes[1] == 2, truth) > 0.9
    assert two.metadata["ground"]["z_unit_known"]


def steep(slope: float) -> Cloud:
    """Make an even slope of one point a square metre."""
    plane = np.random.default_rng(5).random((6400, 2)) * 80
    return Cloud(np.column_stack([plane, np.tan(np.radians(slope)) * plane[:, 0]]))


def test_a_cloth_that_loses_the_ground_of_slopes_is_said(tmp_path: Path) -> None:
    with pytest.warns(liftmesh.DataWarning, match=r"of 64 cells of 10 m have no ground: on slopes"):
        lost = liftmesh.classify_ground(steep(20), cloth_resolution=2)
    assert lost.metadata["ground"]["ground"] < 3200
    for slope, resolution in ((20, 0.5), (0, 2)):
        counts = liftmesh.classify_ground(steep(slope), cloth_resolution=resolution).metadata[
            "ground"
        ]
        assert counts["ground"] > 6000
    las = records(np.round(steep(20).points, 2), classification=np.ones(6400, np.uint8))
    (tmp_path / "raw.las").write_bytes(encoded(las))
    words = ("triangulate", "raw.las", "tin.ply", "--ground", "csf", "--cloth-resolution", "2")
    done = command(*words, cwd=tmp_path)
    assert "give a smaller --cloth-resolution, or --cloth-rigidness 1" in done.stderr


def test_degrees_are_refused() -> None:
    cloud, _ = scene(crs="EPSG:4326")
    with pytest.raises(InputError, match=r"geographic .*, but the ground is found in metres: tra"):
        liftmesh.classify_ground(cloud)


def test_other_classes_stay_and_noise_is_kept_from_the_cloth() -> None:
    cloud, truth = scene()
    classes = np.where(truth, 1, 6).astype(np.uint8)
    classes[:20] = 2
    low = cloud.points.copy()
    low[100:110, 2] -= 500
    classes[100:110] = 7
    low[200, 2] -= 500
    flags = np.zeros(6000, np.uint8)
    flags[200] = 1
    values = {"classification": classes, "withheld": flags}
    found = liftmesh.classify_ground(replace(cloud, points=low, attributes=values))
    after = found.attributes["classification"]
    assert after.dtype == np.uint8
    assert (after[100:110] == 7).all()
    assert after[200] == classes[200]
    assert kappa((after == 2)[300:], truth[300:]) > 0.9
    assert {*np.unique(after[(classes == 6)])} <= {2, 6}


def test_rows_that_are_not_finite_have_no_ground() -> None:
    found = liftmesh.classify_ground([[np.nan, 0, 0], [0, 0, np.inf]])
    assert found.attributes["classification"].tolist() == [1, 1]
    assert len(liftmesh.classify_ground(np.zeros((0, 3)))) == 0


@pytest.mark.parametrize(
    ("options", "cause"),
    [
        ({"algorithm": "smrf"}, "algorithm is 'smrf': give one of 'csf', 'tin'"),
        ({"cloth_resolution": 0}, "cloth_resolution is 0: give a positive number of metres"),
        ({"cloth_threshold": -1.0}, "cloth_threshold is -1.0"),
        ({"cloth_rigidness": 4}, "cloth_rigidness is 4: give 1, 2 or 3"),
        ({"algorithm": "tin", "tin_cell": 0}, "tin_cell is 0: give a positive number of metres"),
        ({"algorithm": "tin", "tin_angle": 90}, "tin_angle is 90: give less than 90 degrees"),
        ({"algorithm": "tin", "tin_distance": np.nan}, "tin_distance is nan"),
        ({"tin_angle": 9.0}, "tin_angle is 9.0: it belongs to algorithm='tin'"),
        ({"algorithm": "tin", "cloth_rigidness": 1}, "it belongs to algorithm='csf'"),
        ({"noise_depth": -1}, "noise_depth is -1: give a positive number of metres"),
        ({"cloth_resolution": 0.001}, "60 by 60 m, for which the cloth has 3.6e[+]09 nodes"),
    ],
)
def test_options_are_checked(options: dict[str, Any], cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        liftmesh.classify_ground(scene()[0], **options)


def test_a_cloth_of_far_more_nodes_than_rows_has_to_be_asked_for() -> None:
    sparse = np.random.default_rng(0).random((200, 3)) * [1000, 1000, 2]
    told = (
        r"200 rows in a box of 985 by 987 m are some 70 m apart, and a cloth of 0.5 m has "
        r"3.9e[+]06 nodes: give cloth_resolution=70.0, or cloth_resolution=0.5 for this one"
    )
    with pytest.raises(InputError, match=told):
        liftmesh.classify_ground(sparse)
    given = liftmesh.classify_ground(sparse, cloth_resolution=70.0)
    assert given.metadata["ground"]["cloth_resolution"] == 70


def test_without_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [])
    monkeypatch.delitem(sys.modules, "CSF", raising=False)
    with pytest.raises(MissingDependencyError, match=r"pip install 'liftmesh\[terrain\]'"):
        liftmesh.classify_ground(scene()[0])


def test_a_program_that_embeds_python_is_not_started(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    program, started = tmp_path / "qgis", tmp_path / "started"
    program.write_text(f"#!/bin/sh\ntouch {started}\n")
    program.chmod(0o755)
    cloud, _ = scene()
    expected = liftmesh.classify_ground(cloud).metadata["ground"]
    monkeypatch.setattr(sys, "executable", str(program))
    assert liftmesh.classify_ground(cloud).metadata["ground"] == expected
    assert not started.exists()
    monkeypatch.setattr(sys, "_base_executable", str(program))
    for name in ("prefix", "base_prefix"):
        monkeypatch.setattr(sys, name, str(tmp_path))
    with pytest.raises(liftmesh.LiftmeshError, match=r"none is found beside .*qgis"):
        liftmesh.classify_ground(cloud)


def test_the_command_takes_the_ground_that_it_found(tmp_path: Path) -> None:
    cloud, truth = scene()
    las = records(np.round(cloud.points, 2), classification=np.ones(6000, np.uint8))
    (tmp_path / "raw.las").write_bytes(encoded(las))
    words = ("triangulate", "raw.las", "tin.ply", "--overwrite", "--ground", "csf")
    done = command(*words, "--json", cwd=tmp_path)
    assert done.returncode == 0
    mesh, report = liftmesh.read(tmp_path / "tin.ply"), json.loads(done.stdout)
    assert report["ground"]["ground"] == len(mesh)
    assert 0.9 * truth.sum() < len(mesh) < 1.1 * truth.sum()
    assert (mesh.attributes["classification"] == 2).all()
    assert f"ground by csf: {len(mesh):,} of 6,000 rows (cloth of 0.5 m, rigidness 2; the" in (
        done.stderr
    )
    done = command(*words, "--all-classes", cwd=tmp_path)
    whole = liftmesh.read(tmp_path / "tin.ply").attributes["classification"]
    assert np.count_nonzero(whole == 2) == len(mesh)
    assert len(whole) == 6000


@pytest.mark.parametrize("name", ["class", "Classification", "CLASS"])
def test_a_column_of_classes_in_any_spelling(name: str, tmp_path: Path) -> None:
    cloud, truth = scene()
    classes = np.where(np.arange(6000) % 500 == 7, 7, 1)
    low = cloud.points.copy()
    low[classes == 7, 2] -= 500
    raw = replace(cloud, points=low, attributes={name: classes})
    found = liftmesh.classify_ground(raw)
    assert [*found.attributes] == [name]
    assert (found.attributes[name][classes == 7] == 7).all()
    ground = found.attributes[name] == 2
    assert kappa(ground[classes == 1], truth[classes == 1]) > 0.9
    liftmesh.write(tmp_path / "raw.csv", raw)
    done = command("triangulate", "raw.csv", "tin.ply", "--ground", "csf", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["n_rows"] == int(ground.sum())
    info = command("info", "raw.csv", "--json", cwd=tmp_path)
    assert json.loads(info.stdout)["lidar"]["classes"] == {"1": 5988, "7": 12}


def test_names_of_classes_stay_beside_the_classes() -> None:
    cloud, _ = scene(attributes={"class": np.array(["grass"] * 6000)})
    found = liftmesh.classify_ground(cloud)
    assert (found.attributes["class"] == "grass").all()
    assert found.attributes["classification"].dtype == np.uint8


def test_a_unit_of_heights_that_is_not_stated_is_said(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "raw.ply", scene(0.3048, crs=FEET)[0])
    done = command("triangulate", "raw.ply", "tin.ply", "--ground", "csf", cwd=tmp_path)
    assert "the unit of z is not stated, and taken to be that of x" in done.stderr


def test_options_of_the_cloth(tmp_path: Path) -> None:
    cloud, _ = scene()
    liftmesh.write(tmp_path / "a.las", cloud)
    words = ("--ground", "csf", "--cloth-resolution", "2", "--cloth-rigidness", "3", "--json")
    done = command(
        "triangulate", "a.las", "a.ply", *words, "--cloth-threshold", "0.2", cwd=tmp_path
    )
    cloud = liftmesh.read(tmp_path / "a.las")
    with pytest.warns(liftmesh.DataWarning, match="have no ground"):
        expected = liftmesh.classify_ground(
            cloud, cloth_resolution=2, cloth_rigidness=3, cloth_threshold=0.2
        )
    assert json.loads(done.stdout)["ground"] == expected.metadata["ground"]
    for wrong in (("resolution", "0"), ("rigidness", "4"), ("threshold", "no")):
        option = f"--cloth-{wrong[0]}"
        done = command("triangulate", "a.las", "b.ply", *words[:2], option, wrong[1], cwd=tmp_path)
        assert done.returncode == 2
        assert f"{option} is " in done.stderr
    done = command("triangulate", "a.las", "b.ply", *words[2:4], cwd=tmp_path)
    assert "--cloth-resolution is an option of --ground csf" in done.stderr
    done = command(
        "triangulate", "a.las", "b.ply", *words[:2], "--cloth-resolution", "0.001", cwd=tmp_path
    )
    assert "remove rows that are far away, or give a larger --cloth-resolution" in done.stderr


def test_a_method_that_is_unknown(tmp_path: Path) -> None:
    done = command("triangulate", "raw.las", "tin.ply", "--ground", "smrf", cwd=tmp_path)
    assert done.returncode == 2
    assert "--ground 'smrf' is unknown: give csf or tin (" in done.stderr


def tin(cloud: Any, **options: Any) -> np.ndarray:
    found = liftmesh.classify_ground(cloud, algorithm="tin", **options)
    return np.asarray(found.attributes["classification"])


def test_the_triangulation_finds_the_ground() -> None:
    cloud, truth = scene()
    found = liftmesh.classify_ground(cloud, algorithm="tin")
    ground = found.attributes["classification"] == 2
    assert kappa(ground, truth) > 0.97
    counts = dict(found.metadata["ground"])
    assert 0 < counts.pop("bare_cells") < counts.pop("cells") == 144
    assert counts == {
        "rows": 6000, "ground": int(ground.sum()), "algorithm": "tin", "tin_cell": 40.0,
        "tin_distance": 1.4, "tin_angle": 15.0, "tin_threshold": 0.25, "unit_known": False,
        "z_unit_known": False,
    }  # fmt: skip


def test_the_order_of_rows_does_not_change_what_the_triangulation_finds() -> None:
    cloud, _ = scene()
    rounded = np.round(cloud.points, 0)  # positions, facets and heights that are equal
    for points in (cloud.points, rounded):
        order = np.random.default_rng(1).permutation(len(points))
        np.testing.assert_array_equal(tin(points)[order], tin(points[order]))


def test_the_triangulation_follows_slopes_and_hills() -> None:
    x, y = (np.random.default_rng(2).random((2, 5000)) * 120).round(2)
    for heights in (0.6 * x, 8 * np.sin(x / 30) * np.cos(y / 40)):
        ground = tin(np.column_stack([x, y, heights])) == 2
        assert ground.mean() > 0.98


def test_every_row_that_is_ground_is_near_a_triangulation_of_ground() -> None:
    """Against SciPy: rows above the ground that was found by more than all thresholds are none."""
    cloud, truth = scene()
    ground = tin(cloud) == 2
    points = cloud.points - cloud.points.min(axis=0)
    surface = LinearNDInterpolator(points[ground & truth, :2], points[ground & truth, 2])
    above = points[:, 2] - surface(points[:, :2])
    assert not ground[above > 1].any()
    assert ground[truth & (np.abs(above) < 0.01)].mean() > 0.99


def test_feet_are_converted_for_the_triangulation() -> None:
    metres, feet = scene()[0], scene(0.3048, crs=FEET)[0]
    assert (tin(metres) == tin(feet)).mean() > 0.999


@pytest.mark.parametrize("algorithm", ["csf", "tin"])
def test_low_noise_is_found_first(algorithm: Any) -> None:
    cloud, truth = scene()
    points = cloud.points.copy()
    places = np.stack(np.meshgrid([8, 24, 40, 54], [8, 24, 40, 54]), axis=2).reshape(-1, 2)
    apart = np.linalg.norm(points[truth][:, None, :2] - (500000, 5400000) - places, axis=2)
    low = np.flatnonzero(truth)[apart.argmin(axis=0)]
    points[low, 2] -= 6
    points[low[1]] = points[low[0]] + (0.5, 0, 0.1)  # two beside each other
    found = liftmesh.classify_ground(points, algorithm=algorithm, noise_depth=2)
    classes = found.attributes["classification"]
    assert (np.flatnonzero(classes == 7) == np.sort(low)).all()
    assert found.metadata["ground"]["noise"] == 16
    rest = np.delete(np.arange(6000), low)
    assert kappa(classes[rest] == 2, truth[rest]) > 0.9
    order = np.random.default_rng(1).permutation(6000)
    again = liftmesh.classify_ground(points[order], algorithm="tin", noise_depth=2)
    assert ((again.attributes["classification"] == 7) == (classes[order] == 7)).all()


def test_low_noise_is_what_the_rule_says() -> None:
    points = np.random.default_rng(5).random((400, 3)) * [60, 60, 4]
    classes = liftmesh.classify_ground(points, algorithm="tin", noise_depth=0.4).attributes[
        "classification"
    ]
    moved = points - points.min(axis=0)
    cells = np.floor(moved[:, :2] / 5)
    is_near = (np.abs(cells[:, None] - cells) <= 1).all(axis=2)
    is_low = moved[:, 2] <= moved[:, 2, None] + 0.4
    is_noise = ((is_near & is_low).sum(axis=1) <= 3) & (is_near.sum(axis=1) > 3)
    assert 5 < is_noise.sum() < 200
    assert ((classes == 7) == is_noise).all()


@pytest.mark.filterwarnings("ignore:.* have no ground")
@pytest.mark.parametrize("scale", [1e-200, 1e-3, 1e150, 1e300])
def test_clouds_of_any_size_have_an_answer(scale: float) -> None:
    points = np.random.default_rng(0).random((50, 3)) * scale
    assert {*tin(points, noise_depth=1)} <= {1, 2, 7}
    assert tin([[1, 2, 3]]).tolist() == tin([[1, 2, 3]] * 3)[:1].tolist() == [1]
    assert len(tin(np.zeros((0, 3)), noise_depth=1)) == 0
    assert (tin(np.column_stack([np.arange(9.0)] * 3)) == 1).all()  # on a line there is no facet


def test_the_command_grows_a_triangulation(tmp_path: Path) -> None:
    cloud, _ = scene()
    liftmesh.write(tmp_path / "raw.las", cloud)
    words = ("triangulate", "raw.las", "tin.ply", "--ground", "tin", "--noise-depth", "3")
    done = command(*words, "--tin-angle", "12", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    expected = liftmesh.classify_ground(
        tmp_path / "raw.las", algorithm="tin", tin_angle=12, noise_depth=3
    )
    assert json.loads(done.stdout)["ground"] == expected.metadata["ground"]
    assert "rows (cells of 40 m, 12 degrees, 0 of low noise; the unit" in done.stderr
    done = command(*words, "--overwrite", "--cloth-resolution", "2", cwd=tmp_path)
    assert "--cloth-resolution is an option of --ground csf" in done.stderr
    for option, value in (("--tin-cell", "2"), ("--noise-depth", "2")):
        done = command("triangulate", "raw.las", "b.ply", option, value, cwd=tmp_path)
        assert f"{option} is an option of --ground tin" in done.stderr
