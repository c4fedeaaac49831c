"""What runs where NumPy and lazy_loader are all that is installed, and what says what it lacks."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from types import SimpleNamespace

import pytest
from commands import ROOT, TERRAIN, liftmesh

from liftmesh.cli import exit_codes
from liftmesh.cli.doctor import findings

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ALONE = """
import os, sys
class Alone:
    KNOWN = {"numpy", "lazy_loader", "liftmesh", "coverage", *sys.stdlib_module_names}
    finders = [*sys.meta_path]
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in self.KNOWN:
            found = (each.find_spec(name, path, target) for each in self.finders)
            return next(filter(None, found), None)
    def find_distributions(self, *context):
        return self.finders[-1].find_distributions(*context)
sys.meta_path[:] = [Alone()]
os.environ["FORCE_COLOR"] = "1"
import numpy as np
import liftmesh as lm
"""
LIBRARY = """
rows = np.random.default_rng(0).random((200, 3))
tri, surface = lm.delaunay(rows[:, :2]), lm.triangulate(rows)
assert tri.verify().valid and surface.verify().valid
assert (tri.find_simplex(rows[:, :2]) >= 0).all()
for suffix in ("ply", "obj", "npz", "xyz", "csv", "off", "stl"):
    lm.write(f"mesh.{suffix}", surface)
    assert len(lm.read(f"mesh.{suffix}")) == 200 or suffix == "stl"
    assert lm.triangulate(f"mesh.{suffix}").verify().valid or suffix == "stl"
place = [[0.5, 0.5]]
surface.sample(place), surface.weights(place), surface.volume(0.0), surface.area
surface.contours(interval=0.2).save("lines.geojson")
surface.raster(resolution=0.1, fill=0.3), surface.trim(max_edge=0.2)
lm.write("few.ply", lm.simplify(surface, max_points=50))
lm.write("block.stl", surface.solid(thickness=1.0))
lm.difference(surface, lm.triangulate(rows * [1, 1, 2])), surface.profile(rows[:2, :2])
lm.thin(rows, cell=0.1), lm.voronoi(rows[:, :2]), lm.regular(rows[:, :2], weights=rows[:, 2])
lm.constrained_delaunay(rows[:, :2], [[0, 1]], crossing="split"), lm.tetrahedralize(rows).verify()
lm.tile(rows[:, :2], "tiles").verify(rows[:, :2]), surface.view().save("page.html")
del tri, surface  # before the end, where nanobind would miss them under coverage
"""
LACKING = {  # extra: what needs it
    "scipy": ["lm.delaunay(rows).graph()", "lm.scipy.Delaunay", "lm.delaunay(rows).to_scipy()",
              "lm.triangulate(terrain).weights([[0, 0]]).to_scipy()",
              "lm.triangulate(lm.Cloud(terrain, normals=terrain), breaklines=[terrain / 2])"],
    "trimesh": ["lm.triangulate(terrain).to_trimesh()", "lm.compare(rows)",
                "lm.write('mesh.glb', lm.triangulate(terrain))"],
    "las": ["lm.write('rows.las', terrain)"],
    "plot": ["lm.plot(lm.triangulate(terrain))"],
    "shapes": ["lm.voronoi(rows, domain=rows[:3])"],
    "open3d": ["lm.triangulate(terrain).to_open3d()"],
}  # fmt: skip


def run(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-c", ALONE + code]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_the_library_runs_with_numpy_alone(tmp_path: Path) -> None:
    done = run(LIBRARY, tmp_path)
    assert (done.stderr, done.returncode) == ("", 0)


@pytest.mark.slow
def test_what_lacks_a_package_names_its_extra(tmp_path: Path) -> None:
    tries = [(extra, line) for extra, lines in LACKING.items() for line in lines]
    code = f"""
terrain = np.array([[0, 0, 1.0], [1, 0, 2], [0, 1, 3], [1, 1, 5]])
rows = terrain[:, :2]
for extra, line in {tries}:
    try:
        eval(line)
        print(line, "needs nothing")
    except lm.MissingDependencyError as error:
        message = str(error)
        if not message.endswith(f": pip install 'liftmesh[{{extra}}]'") or chr(10) in message:
            print(line, message)
"""
    done = run(code, tmp_path)
    assert done.stdout + done.stderr == ""


@pytest.mark.slow
def test_the_command_without_click_says_what_to_install_and_what_is_there(tmp_path: Path) -> None:
    tries = [[], ["info", str(TERRAIN)], ["--show-completion", "bash"]]
    code = f"from liftmesh.cli import main\nprint([main(words) for words in {tries}])\n"
    broken = "sys.modules['liftmesh._kernel'] = None\nsys.exit(main(['doctor', '--json']))"
    done = run(f"{code}\nmain(['doctor'])\n{broken}", tmp_path)
    codes, _, said = done.stdout.partition("\n")
    assert (done.returncode, codes) == (0, str([int(exit_codes.BAD_INPUT)] * len(tries)))
    told = "this needs click, which cannot be imported (No module named 'click')"
    assert done.stderr == len(tries) * (f"liftmesh: error: {told}: pip install 'liftmesh[cli]'\n")
    assert re.search(r"^kernel +\d\S+, by \w+ \d\S+.*, for \w", said, re.MULTILINE)
    assert re.search(r"^numpy +\d", said, re.MULTILINE)
    assert re.search(r'^  "kernel": "cannot be imported: ', said, re.MULTILINE)


def test_the_doctor_names_what_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    required = ['scipy>=1.11; extra == "scipy"', 'no-such<2; extra == "geo"', "numpy>=1.26"]
    required += ['liftmesh[scipy]; extra == "geo"', 'liftmesh[scipy,geo]; extra == "all"']
    monkeypatch.setattr(metadata, "requires", lambda _: required)
    found, scipy = findings(), f"scipy {metadata.version('scipy')}"
    assert json.loads(liftmesh("doctor", "--json").stdout) == found
    assert {key: text for key, text in found.items() if key[0] == "["} == {
        "[scipy]": scipy,
        "[geo]": f"no no-such, {scipy}: pip install 'liftmesh[geo]'",
    }


def test_the_doctor_runs_on_what_is_broken(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(name: str) -> list[str]:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "requires", unknown)
    monkeypatch.setitem(sys.modules, "liftmesh._kernel", SimpleNamespace(VERSION="0.0.1"))
    monkeypatch.setitem(sys.modules, "numpy", None)
    found = findings()
    assert not [key for key in found if key[0] == "["]
    assert found["kernel"] == "0.0.1 (of another version than the rest), by unknown, for unknown"
    assert found["numpy"].startswith("cannot be imported: ")


def test_extras_are_those_of_everything() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    base = {re.split(r"[^\w-]", each)[0] for each in project["dependencies"]}
    assert base == {"numpy", "lazy-loader"}
    extras = project["optional-dependencies"]
    everything = set(re.findall(r"\w+", extras["all"][0])) - {"liftmesh"}
    assert {*extras} - everything - {"las", "e57"} == {
        *("all", "coverage", "test", "bench", "callers", "docs", "dev")
    }
    named = re.compile(r'load\([^()]*extra="(\w+)"|pip install \'liftmesh\[(\w+)\]\'')
    for path in (ROOT / "liftmesh").rglob("*.py"):
        for one, other in named.findall(path.read_text("utf-8")):
            assert (one or other) in extras, path
