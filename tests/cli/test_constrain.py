"""``liftmesh constrain``: points and edges of files become a mesh that contains the edges."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh as command

import liftmesh
from liftmesh import Cloud

SQUARE = np.array([[0, 0], [8, 0], [8, 8], [0, 8], [3, 2], [5, 2], [5, 5], [3, 5]], np.float64)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    np.savetxt(tmp_path / "points.xy", np.c_[SQUARE, np.zeros(8)])
    (tmp_path / "points.xy").rename(tmp_path / "points.xyz")
    (tmp_path / "pairs.txt").write_text("# rows\n0 6\n4 1  # twice\n")
    rings = [[*SQUARE[:4].tolist(), [0, 0]], [*SQUARE[4:].tolist(), [3, 2]]]
    for name, kind, parts in (("land", "Polygon", rings), ("lines", "MultiLineString", rings)):
        tree = {"type": kind, "coordinates": parts}
        (tmp_path / f"{name}.geojson").write_text(json.dumps(tree))
    return tmp_path


def test_edges_of_rows(folder: Path) -> None:
    done = command("constrain", "points.xyz", "a.obj", "--edges", "pairs.txt", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    expected = liftmesh.constrained_delaunay(SQUARE, [[0, 6], [4, 1]])
    assert (told["n_constraints"], told["n_rows"]) == (len(expected.constraints), 8)
    mesh = liftmesh.read(folder / "a.obj")
    assert mesh.edges is not None
    assert mesh.edges.tolist() == expected.constraints.tolist()
    found = liftmesh.verify(SQUARE, mesh.faces, constraints=mesh.edges)
    assert found.valid
    again = command("constrain", "a.obj", "b.ply", cwd=folder)
    assert again.returncode == 0, again.stderr
    assert "8 vertices" in again.stdout
    assert np.array_equal(liftmesh.read(folder / "b.ply").edges, mesh.edges)
    copied = command("constrain", "a.obj", "a.poly", cwd=folder)
    assert copied.returncode == 0, copied.stderr
    for name in ("a.obj", "a.poly"):
        words = ("c.npz", "--edges", name, "--overwrite")
        same = command("constrain", "points.xyz", *words, cwd=folder)
        assert same.returncode == 0, same.stderr
        assert np.array_equal(liftmesh.read(folder / "c.npz").edges, mesh.edges)


def test_polygons_are_carved(folder: Path) -> None:
    words = ("--polygons", "land.geojson", "--carve", "holes", "--json")
    (folder / "points.csv").write_text("x,y\n" + "".join(f"{x},{y}\n" for x, y in SQUARE))
    done = command("constrain", "points.csv", "a.ply", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["n_triangles"], told["n_added"]) == (8, 0)


@pytest.mark.parametrize("kind", ["ply", "npz", "obj"])
def test_a_carved_mesh_says_so_in_its_file(kind: str, folder: Path) -> None:
    words = ("--polygons", "land.geojson")
    for target, carve in (("a", ("--carve", "holes")), ("b", ())):
        name = f"{target}.{kind}"
        done = command("constrain", "points.xyz", name, *words, *carve, cwd=folder)
        assert done.returncode == 0, done.stderr
        mesh = liftmesh.read(folder / name)
        assert mesh.metadata.get("carved") == (True if carve else None)
        found = liftmesh.verify(mesh)
        assert (found.valid, found.carved) == (True, bool(carve))
        assert command("verify", name, cwd=folder).returncode == 0
    again = command("constrain", f"a.{kind}", "c.ply", "--overwrite", cwd=folder)
    assert again.returncode == 0, again.stderr
    assert "carved" not in liftmesh.read(folder / "c.ply").metadata


def test_crossings_are_an_error_or_split(folder: Path) -> None:
    (folder / "cross.txt").write_text("0 6\n4 2\n7 5\n1 3\n")
    words = ("constrain", "points.xyz", "a.ply", "--edges", "cross.txt")
    error = "error: cross.txt: 4 pairs of edges cross where no row is"
    failed(command(*words, cwd=folder), 3, error, "--crossing split")
    crossed = liftmesh.Cloud(np.c_[SQUARE, np.zeros(8)], edges=np.array([[0, 2], [1, 3]], np.int32))
    liftmesh.write(folder / "crossed.ply", crossed)
    done = command("constrain", "crossed.ply", "b.ply", cwd=folder)
    failed(done, 3, "crossed.ply: 1 pair of edges crosses where no row is")
    done = command(*words, "--crossing", "split", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "displacement" in done.stdout
    assert len(liftmesh.read(folder / "a.ply")) > 8


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("0 1\n1 2 3\n", "pairs.txt: line 2: expected 2 values, found 3"),
        ("0 1\n\n1 2.5\n", "pairs.txt: line 3: the number of a row is 2.5"),
        ("0 x\n", "pairs.txt: line 1, value 2: 'x' is not a number"),
        ("0 1\n4 8\n", "error: pairs.txt: edge 1, [4, 8], has the row 8, where 0 to 7"),
        ("0,1\n4, 8\n", "error: pairs.txt: edge 1, [4, 8], has the row 8"),
        ("# none\n", "error: pairs.txt has no edges: give two rows in each line"),
    ],
)
def test_pairs_that_cannot_be_used(text: str, cause: str, folder: Path) -> None:
    (folder / "pairs.txt").write_text(text)
    words = ("constrain", "points.xyz", "a.ply", "--edges", "pairs.txt")
    failed(command(*words, cwd=folder), 3, cause)
    assert not (folder / "a.ply").exists()


def test_edges_that_other_commands_do_not_take_are_told(folder: Path) -> None:
    points, edges = np.c_[SQUARE, np.zeros(8)], np.array([[0, 2]], np.int32)
    liftmesh.write(folder / "a.ply", Cloud(points, edges=edges))
    told = "the points have 1 edge, not used here: {} takes edges, and triangulate takes lines, as "
    for name, *options in (["triangulate"], ["simplify", "--max-error", "1"]):
        done = command(name, "a.ply", f"{name}.ply", *options, cwd=folder)
        assert (done.returncode, done.stderr.count("not used")) == (0, 1)
        assert f"{told.format('liftmesh constrain')}--breaklines" in done.stderr
        done = command(name, "a.ply", f"{name}.obj", *options, "--json", cwd=folder)
        notes = json.loads(done.stdout)["notes"]
        assert f"{told.format('liftmesh constrain')}--breaklines" in notes
    with pytest.warns(liftmesh.DataWarning, match=told.format("constrained_delaunay")):
        liftmesh.triangulate(folder / "a.ply")
    words = ("triangulate", "points.xyz", "b.ply", "--breaklines", "lines.geojson")
    mesh = command(*words, cwd=folder)
    assert mesh.returncode == 0, mesh.stderr
    kept = command("simplify", "b.ply", "c.ply", "--max-error", "1", cwd=folder)
    assert (kept.returncode, "edge" in kept.stderr) == (0, False), kept.stderr


def test_what_is_missing(folder: Path) -> None:
    failed(command("constrain", "points.xyz", "a.ply", cwd=folder), 2, "has no edges", "--edges")
    words = ("constrain", "points.xyz", "a.ply", "--edges")
    failed(command(*words, "none.txt", cwd=folder), 3, "none.txt")
    liftmesh.write(folder / "bare.ply", np.eye(3))
    failed(command(*words, "bare.ply", cwd=folder), 3, "bare.ply has no edges")


def test_new_rows_have_no_heights_and_no_values(folder: Path) -> None:
    heights = Cloud(np.c_[SQUARE[:4], np.arange(4.0)])
    liftmesh.write(folder / "high.ply", heights)
    words = ("--polylines", "lines.geojson")
    done = command("constrain", "high.ply", "a.ply", *words, cwd=folder)
    failed(done, 3, "4 corners or crossings of lines are at no row", "--breaklines")
    flat = Cloud(np.c_[SQUARE[:4], np.zeros(4)], attributes={"a": np.arange(4)})
    liftmesh.write(folder / "flat.ply", flat)
    done = command("constrain", "flat.ply", "a.ply", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "4 rows are new" in done.stderr
    assert len(liftmesh.read(folder / "a.ply")) == 8


def poly(first: int, points: str) -> str:
    """Make a square with a square hole, whose numbers begin with 0 or 1."""
    sides = [(k, (k + 1) % 4) for k in range(4)] + [(4 + k, 4 + (k + 1) % 4) for k in range(4)]
    lines = [f"{k + first} {a + first} {b + first}" for k, (a, b) in enumerate(sides)]
    return points + "# segments\n8 0\n" + "\n".join(lines) + f"\n1\n{first} 4 3 # in it\n"


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("beside", [False, True])
def test_a_poly_file_of_triangle(first: int, beside: bool, folder: Path) -> None:
    rows = "".join(f"{k + first} {x} {y}\n" for k, (x, y) in enumerate(SQUARE))
    points = f"8 2 0 0\n{rows}"
    if beside:
        (folder / "plate.node").write_text(points)
        points = "0 2 0 0\n"
    (folder / "plate.poly").write_text(poly(first, points))
    done = command("constrain", "plate.poly", "a.ply", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["n_triangles"], told["n_constraints"]) == (8, 8)
    assert told["dropped"] == []
    assert liftmesh.read(folder / "a.ply").metadata["carved"]
    copied = command("constrain", "plate.poly", "b.poly", "--json", cwd=folder)
    assert json.loads(copied.stdout)["dropped"] == ["faces"]  # holes say what is carved
    assert len(liftmesh.read(folder / "b.poly").metadata["holes"]) == 1
    others = command("constrain", "plate.poly", "d.poly", "--edges", "pairs.txt", cwd=folder)
    assert "plate.poly: 8 edges and holes of its own not taken" in others.stderr
    assert "holes" not in liftmesh.read(folder / "d.poly").metadata
    assert command("constrain", "d.poly", "e.ply", cwd=folder).returncode == 0
    again = command("constrain", "b.poly", "c.ply", cwd=folder)
    assert again.returncode == 0, again.stderr
    assert np.array_equal(
        liftmesh.read(folder / "c.ply").faces, liftmesh.read(folder / "a.ply").faces
    )


@pytest.mark.parametrize(
    ("old", "new", "cause"),
    [
        ("8 0\n0", "9 0\n0", "promises 9 segments|expected 3 values"),
        ("0 0 1\n", "0 0 9\n", "edge 0 refers to vertex 9"),
        ("1\n0 4 3", "one\n0 4 3", "expected the numbers of holes, found 'one'"),
    ],
)
def test_a_poly_file_that_is_wrong(old: str, new: str, cause: str, folder: Path) -> None:
    rows = "".join(f"{k} {x} {y}\n" for k, (x, y) in enumerate(SQUARE))
    text = poly(0, f"8 2 0 0\n{rows}")
    assert old in text
    (folder / "plate.poly").write_text(text.replace(old, new, 1))
    done = command("constrain", "plate.poly", "a.ply", cwd=folder)
    assert done.returncode == 3
    assert re.search(cause, " ".join(done.stderr.split())), done.stderr
