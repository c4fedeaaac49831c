"""``liftmesh compare``: who is right, in the exit code, in words, in files and in JSON."""

from __future__ import annotations

import json
import re
from fractions import Fraction

import numpy as np
import pytest
import trimesh
from commands import ROOT, TERRAIN, failed, liftmesh, on_terminal, process, without_escapes

import liftmesh as lm
from liftmesh.cli import exit_codes

HILL = ROOT / "data" / "hill.csv"


def column(done):
    """What the table says: name to (liftmesh, trimesh)."""
    rows = re.findall(r"^(\S.*?)  +(\S+)  +(\S+)$", done.stdout, flags=re.MULTILINE)
    return {name: (ours, theirs) for name, ours, theirs in rows}


@pytest.fixture
def far(tmp_path):
    """A tenth of a metre of scattered points at UTM coordinates."""
    path = tmp_path / "far.npy"
    np.save(path, np.random.default_rng(0).random((500, 3)) * 0.1 + (450_000, 5_200_000, 0))
    return path


@pytest.mark.campaign
def test_the_terrain_is_right_on_both_sides(tmp_path):
    words = ("--lower", tmp_path / "lower.ply", "--hull", tmp_path / "hull.ply")
    done = process("compare", TERRAIN, *words)
    assert (done.returncode, done.stderr) == (0, "")
    told = column(done)
    assert told["lower facets"] == ("275,772", "275,772")
    assert told["really different"] == ("0", "0")
    same, cut = (
        int(told[name][0].replace(",", ""))
        for name in ("identical", "cocircular, triangulated differently")
    )
    assert same + cut == 275_772
    assert cut > 1000
    assert "Both results are correct: they differ only in the triangulation of" in done.stdout
    assert all(float(each) > 0 for each in told["seconds"])
    lower, hull = lm.read(tmp_path / "lower.ply"), lm.read(tmp_path / "hull.ply")
    planar = lm.read(TERRAIN).points[:, :2]
    assert np.array_equal(lower.points, lm.lift(planar, "median"))
    assert np.array_equal(hull.points, lower.points)
    assert (len(lower.faces), len(hull.faces)) == (275_772, 2 * 138_632 - 4)


def test_a_wrong_hull_is_exit_code_1_with_proofs(far):
    done = liftmesh("compare", far, "--apex", "origin", "--proofs", "3")
    assert (done.returncode, done.stderr) == (exit_codes.DIFFERENT, "")
    assert "whose heights are rounded, is wrong: " in done.stdout
    assert "points lost" in done.stdout
    proofs = [line for line in done.stdout.splitlines() if line.startswith("- ")]
    assert len(proofs) == 3
    assert any("lies strictly inside its circle" in line for line in proofs)
    assert liftmesh("compare", far).returncode == 0


def test_the_whole_difference_in_json(far):
    done = liftmesh("compare", far, "--apex", "origin", "--json")
    assert done.returncode == exit_codes.DIFFERENT
    told = json.loads(done.stdout)
    result = lm.compare(far, apex="origin", max_proofs=4)
    assert told["verdict"] == "different"
    assert told["lost_rows"] == result.lost.tolist()
    for name in ("missing", "wrong", "lost"):
        assert told[f"n_{name}"] == len(getattr(result, name)) > 0
    assert told["n_triangles"] == told["n_identical"] + told["n_cocircular"] + told["n_missing"]
    assert told["n_lower_facets"] == told["n_identical"] + told["n_cocircular"] + told["n_wrong"]
    for proof, expected in zip(told["proofs"], result.proofs, strict=True):
        assert tuple(proof["rows"]) == expected.rows
        values = [(row, Fraction(value)) for row, value in proof["determinants"]]
        assert values == list(expected.determinants)


def test_no_hull_is_exit_code_1_too(tmp_path):
    (tmp_path / "three.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n")
    done = liftmesh(
        "compare", "three.xyz", "--lower", "lower.ply", "--hull", "hull.ply", cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (exit_codes.DIFFERENT, "")
    assert "trimesh finds no hull of these points: " in done.stdout
    assert "not enough points" in done.stdout
    assert (tmp_path / "lower.ply").exists()
    assert not (tmp_path / "hull.ply").exists()
    assert "hull.ply was not written" in done.stdout


@pytest.mark.parametrize("apex", ["median", "origin", "-3.5,1e2"])
def test_vertices_of_the_paraboloid(apex, tmp_path):
    done = liftmesh("compare", HILL, "--apex", apex, "--lower", tmp_path / "lower.ply", "--json")
    told = json.loads(done.stdout)
    assert (done.returncode, told["verdict"]) == (0, "identical")
    planar = lm.read(HILL).points[:, :2]
    assert np.array_equal(lm.read(tmp_path / "lower.ply").points, lm.lift(planar, told["apex"]))


def test_a_hull_that_other_programs_open(tmp_path):
    liftmesh("compare", HILL, "--hull", "hull.ply", cwd=tmp_path)
    assert trimesh.load(tmp_path / "hull.ply", process=False).is_watertight


@pytest.mark.parametrize("option", ["--lower", "--hull"])
def test_files_are_checked_before_the_work(option, tmp_path):
    (tmp_path / "broken.ply").write_bytes(b"")
    done = liftmesh("compare", "broken.ply", option, "mesh.xyzzy", cwd=tmp_path)
    failed(done, exit_codes.BAD_INPUT, "mesh.xyzzy")


def test_a_plane(tmp_path):
    rng = np.random.default_rng(1)
    np.save(tmp_path / "wall.npy", np.column_stack([rng.random(50), np.zeros(50), rng.random(50)]))
    failed(liftmesh("compare", "wall.npy", cwd=tmp_path), exit_codes.BAD_INPUT, "--plane fit")
    assert liftmesh("compare", "wall.npy", "--plane", "fit", cwd=tmp_path).returncode == 0


@pytest.mark.slow
def test_a_terminal_shows_the_table_in_colour(far):
    shown, code = on_terminal("compare", far, "--apex", "origin", "--proofs", "2")
    assert code == exit_codes.DIFFERENT
    told = without_escapes(shown)
    assert "comparing 500 rows with trimesh's convex hull" in told
    assert re.search(r"really different +\d", told)
    assert "\x1b[1;31m" in shown
    assert told.count("• ") == 2
    assert max(map(len, told.splitlines()[-12:])) <= 100
