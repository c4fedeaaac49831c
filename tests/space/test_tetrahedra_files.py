"""Tetrahedra in files and of commands: written, read back by other programs, verified, checked."""

from __future__ import annotations

import copy
import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import check_certificate as checker
import meshio
import numpy as np
import pytest
from commands import failed, liftmesh as command
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

import liftmesh
from liftmesh.io.tetrahedra import read_tetrahedra, write_tetrahedra

RNG = np.random.default_rng(31)
POINTS = np.vstack([RNG.random((30, 3)), [[np.nan, 0, 0]], RNG.integers(0, 2, (9, 3)) * 1.0])
TETRA = liftmesh.tetrahedralize(POINTS, nonfinite="skip")
KINDS = ["vtu", "vtk", "msh"]


class TestFiles:
    @pytest.mark.parametrize("kind", KINDS)
    def test_every_bit_comes_back_and_is_verified(self, kind: str, tmp_path: Path) -> None:
        path = tmp_path / f"cells.{kind}"
        written = TETRA.save(path)
        assert (written.format, written.bytes) == (kind, path.stat().st_size)
        points, simplices = read_tetrahedra(path)
        assert points.tobytes() == POINTS.tobytes()
        np.testing.assert_array_equal(simplices, TETRA.simplices)
        assert liftmesh.verify(path, nonfinite="skip") == TETRA.verify()
        with pytest.raises(liftmesh.NonFiniteError, match="row 30"):
            liftmesh.verify(path)
        with pytest.raises(FileExistsError):
            TETRA.save(path, overwrite=False)

    def test_other_cells_are_left_out(self, tmp_path: Path) -> None:
        blocks = [("tetra", TETRA.simplices[:9]), ("triangle", [[0, 1, 2]])]
        meshio.Mesh(POINTS, [*blocks, ("tetra", TETRA.simplices[9:])]).write(tmp_path / "a.vtu")
        np.testing.assert_array_equal(read_tetrahedra(tmp_path / "a.vtu")[1], TETRA.simplices)

    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("content", [b"", b"<VTKFile>", b"$MeshFormat\n4.1 0 8\n", b"\0" * 99])
    def test_broken_files(self, kind: str, content: bytes, tmp_path: Path, capfd: Any) -> None:
        path = tmp_path / f"broken.{kind}"
        path.write_bytes(content)
        with pytest.raises(liftmesh.FormatError, match=f"broken.{kind}: meshio cannot read it"):
            liftmesh.verify(path)
        assert capfd.readouterr() == ("", "")

    def test_a_small_file_that_takes_all_memory_lies(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def read(*_: Any, **__: Any) -> None:
            raise MemoryError

        path = tmp_path / "a.vtk"
        TETRA.save(path)
        monkeypatch.setattr(meshio, "read", read)
        with pytest.raises(liftmesh.FormatError, match=r"a.vtk: meshio cannot read it: MemoryErr"):
            liftmesh.verify(path)
        monkeypatch.setattr("liftmesh.io.tetrahedra._LARGE", 0)
        with pytest.raises(MemoryError):
            liftmesh.verify(path)

    def test_refusals(self, tmp_path: Path) -> None:
        with pytest.raises(liftmesh.FormatError, match=r"'ply' is no format of tetrahedra"):
            TETRA.save(tmp_path / "cells.ply")
        with pytest.raises(FileNotFoundError):
            liftmesh.verify(tmp_path / "nowhere.vtu")
        liftmesh.write(tmp_path / "flat.vtu", [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        with pytest.raises(liftmesh.FormatError, match="holds no tetrahedra: make some"):
            liftmesh.verify(tmp_path / "flat.vtu")

    def test_pyvistas_grid(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """PyVista takes cells by their kind, and then the points."""
        made: list[Any] = []
        grid = SimpleNamespace(
            CellType=SimpleNamespace(TETRA=10), UnstructuredGrid=lambda *a: made.append(a)
        )
        monkeypatch.setitem(sys.modules, "pyvista", grid)
        TETRA.to_pyvista()
        ((cells, points),) = made
        np.testing.assert_array_equal(cells[10], TETRA.simplices)
        assert points.tobytes() == POINTS.tobytes()


class TestCommands:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        liftmesh.write(tmp_path / "cloud.ply", POINTS)
        return tmp_path

    @pytest.mark.parametrize("kind", KINDS)
    def test_tetrahedra(self, kind: str, folder: Path) -> None:
        words = ("tetrahedralize", "cloud.ply", f"cells.{kind}")
        failed(command(*words, cwd=folder), 3, "row 30", "--nonfinite skip")
        done = command(*words, "--nonfinite", "skip", "--json", cwd=folder)
        assert done.returncode == 0, done.stderr
        told = json.loads(done.stdout)
        assert (told["n_rows"], told["n_tetrahedra"]) == (40, len(TETRA.simplices))
        assert (told["n_skipped"], told["format"]) == (1, kind)
        words = ("verify", f"cells.{kind}", "--nonfinite", "skip", "--certificate", "c.json")
        done = command(*words, cwd=folder)
        assert done.returncode == 0, done.stderr
        assert "these are the tetrahedra that liftmesh makes" in done.stdout
        assert f"tetrahedra             {len(TETRA.simplices)}" in done.stdout
        said = json.loads((folder / "c.json").read_text())
        assert said == TETRA.verify().as_dict()

    def test_what_is_wrong_is_told(self, folder: Path) -> None:
        write_tetrahedra(folder / "a.vtk", TETRA.points, TETRA.simplices[1:])
        done = command("verify", "a.vtk", "--nonfinite", "skip", cwd=folder)
        assert done.returncode == 1
        assert "Not valid" in done.stdout
        failed(command("verify", "a.vtk", "--plane", "fit", cwd=folder), 2, "have no --plane")
        failed(command("verify", "a.vtk", "--max-bytes", "1", cwd=folder), 2, "leave --max-bytes")
        failed(
            command("verify", "-", "--input-format", "vtk", cwd=folder), 2, "not read from stdin"
        )
        failed(command("tetrahedralize", "cloud.ply", "-", cwd=folder), 2, "not written to stdout")
        failed(command("tetrahedralize", "cloud.ply", "a.stl", cwd=folder), 3, "no format of tetra")
        failed(command("tetrahedralize", "cloud.ply", "a.vtk", cwd=folder), 2, "--overwrite")

    def test_hulls(self, folder: Path) -> None:
        hull = liftmesh.convex_hull(POINTS, nonfinite="skip")
        done = command("hull", "cloud.ply", "hull.ply", "--nonfinite", "skip", "--json", cwd=folder)
        told = json.loads(done.stdout)
        assert (told["n_vertices"], told["n_facets"]) == (len(hull.vertices), len(hull.faces))
        mesh = liftmesh.read(folder / "hull.ply")
        np.testing.assert_array_equal(mesh.points[mesh.faces], hull.points[hull.faces])
        done = command("hull", "cloud.ply", "hull.stl", "--nonfinite", "skip", cwd=folder)
        assert f"{len(hull.faces)} facets on" in done.stdout
        (folder / "flat.csv").write_text("0,0,0\n1,0,0\n0,1,0\n1,1,0\n")
        failed(command("hull", "flat.csv", "a.ply", cwd=folder), 3, "lie on one plane")

    def test_all_rows_of_a_lidar_file_count_not_the_ground_alone(self, folder: Path) -> None:
        rows = RNG.random((20, 3))
        classes = np.resize([2, 5], 20).astype(np.uint8)
        liftmesh.write(
            folder / "scan.las", liftmesh.Cloud(rows, attributes={"classification": classes})
        )
        for name, out in (("hull", "scan.ply"), ("tetrahedralize", "scan.vtu")):
            done = command(name, "scan.las", out, "--json", cwd=folder)
            assert json.loads(done.stdout)["n_rows"] == 20


def held(said: dict[str, Any], points: NDArray[np.float64], simplices: NDArray[np.int32]) -> int:
    rows, cells = ([*map(tuple, each.tolist())] for each in (points, simplices))
    return checker.check_in_space(said, rows, cells)


class TestChecker:
    """The checker that does without liftmesh decides on its own."""

    @settings(max_examples=40)
    @given(st.lists(st.tuples(*[st.integers(0, 2)] * 3), min_size=4, max_size=12), st.data())
    def test_it_agrees_with_verify(self, corners: Any, data: st.DataObject) -> None:
        points = np.array(corners, dtype=np.float64)
        try:
            simplices = liftmesh.tetrahedralize(points).simplices
        except liftmesh.DegenerateInputError:
            return
        kept = data.draw(st.sets(st.sampled_from([*range(len(simplices))])))
        row = data.draw(st.integers(0, len(points) - 1))
        other = simplices.copy()
        other[data.draw(st.integers(0, len(simplices) - 1)), data.draw(st.integers(0, 3))] = row
        for each in (simplices, simplices[[*kept]].reshape(-1, 4), other):
            assert held(liftmesh.verify(points, each).as_dict(), points, each) == 0

    def test_lies_are_found(self, capsys: pytest.CaptureFixture[str]) -> None:
        points = POINTS[:9]
        tetra = liftmesh.tetrahedralize(points)
        honest = tetra.verify().as_dict()
        assert held(honest, points, tetra.simplices) == 0
        for name in ("valid", "canonical"):
            assert held(honest | {name: False}, points, tetra.simplices) == 1
        for name in honest["counts"]:
            lie = copy.deepcopy(honest)
            lie["counts"][name] += 1
            assert held(lie, points, tetra.simplices) == 1
        assert held(honest, points[::-1], tetra.simplices) == 1
        outer = np.flatnonzero((tetra.neighbors < 0).sum(axis=1) == 1)[0]
        fewer = np.delete(tetra.simplices, outer, axis=0)
        sums = {"simplices_sha256": liftmesh.verify(points, fewer).simplices_sha256}
        capsys.readouterr()
        assert held(honest | sums, points, fewer) == 1
        assert "the boundary is not convex" in capsys.readouterr().out

    def test_other_choices_on_a_sphere_are_valid(self, capsys: pytest.CaptureFixture[str]) -> None:
        cube = np.indices((2, 2, 2)).reshape(3, -1).T * 1.0
        five = np.array([[0, 3, 5, 6], [0, 1, 3, 5], [0, 2, 6, 3], [0, 4, 5, 6], [7, 3, 6, 5]])
        negative = liftmesh.orient3d(*np.moveaxis(cube[five], 1, 0)) < 0
        five[negative] = five[negative][:, [1, 0, 2, 3]]
        said = liftmesh.verify(cube, five).as_dict()
        assert (said["valid"], said["canonical"]) == (True, False)
        assert held(said, cube, five) == 0
        assert "valid, not canonical" in capsys.readouterr().out
        turn = np.arange(5) * 4 * np.pi / 5
        ring = np.column_stack([np.zeros(5), np.cos(turn), np.sin(turn)])
        points = np.vstack([[[-1.0, 0, 0], [1.0, 0, 0]], ring])
        around = np.array([[0, 1, 2 + (i + 1) % 5, 2 + i] for i in range(5)])
        negative = liftmesh.orient3d(*np.moveaxis(points[around], 1, 0)) < 0
        around[negative] = around[negative][:, [1, 0, 2, 3]]
        assert held(liftmesh.verify(points, around).as_dict(), points, around) == 0
        assert "winds around more than once" in capsys.readouterr().out

    @pytest.mark.parametrize("options", [None, {}, {"compression": None}, {"binary": False}])
    def test_files(self, options: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path, said = tmp_path / "cells.vtu", tmp_path / "said.json"
        said.write_text(TETRA.verify().to_json())
        if options is None:
            TETRA.save(path)
        else:
            meshio.Mesh(POINTS, [("tetra", TETRA.simplices)]).write(path, **options)
        is_text = options == {"binary": False}
        assert checker.main(str(said), str(path)) == (2 if is_text else 0)
        assert "numbers as text" in capsys.readouterr().err or not is_text
        path.write_text("v 0 0\n")
        assert checker.main(str(said), str(path)) == 2
        assert "tetrahedra are read from VTU files alone" in capsys.readouterr().err
