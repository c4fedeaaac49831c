"""The package as a whole: what an import loads, what its names mean, where its version stands."""

from __future__ import annotations

import ast
import importlib
import importlib.metadata
import json
import pkgutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import liftmesh

ROOT = Path(__file__).resolve().parent.parent
HEAVY = (
    *("trimesh", "scipy", "open3d", "matplotlib", "click", "rich", "pandas"),
    *("dask", "distributed", "pyarrow"),
)


def run(*command: str, cwd: Path) -> str:
    """Run a command away from the repository and return what it prints."""
    done = subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True)
    return done.stdout


def python(code: str, cwd: Path) -> str:
    return run(sys.executable, "-c", code, cwd=cwd)


def loaded_after(code: str, cwd: Path) -> set[str]:
    names = python(f"{code}\nimport json, sys\nprint(json.dumps(sorted(sys.modules)))", cwd)
    return {name.partition(".")[0] for name in json.loads(names)}


def test_import_loads_no_library_but_the_loader(tmp_path: Path) -> None:
    bare = loaded_after("", tmp_path)
    loaded = loaded_after("import liftmesh", tmp_path) - bare
    third_party = {name for name in loaded if name not in sys.stdlib_module_names}
    assert third_party == {"liftmesh", "lazy_loader"}


def test_planar_triangulation_loads_no_library_but_numpy(tmp_path: Path) -> None:
    code = "import liftmesh; liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).find_simplex([[0, 0]])"
    loaded = loaded_after(code, tmp_path)
    assert "numpy" in loaded
    assert loaded.isdisjoint(HEAVY)


def test_surface_from_an_array_loads_no_library_but_numpy(tmp_path: Path) -> None:
    code = "import liftmesh; liftmesh.triangulate([[0, 0, 1], [1, 0, 2], [0, 1, 3]])"
    seldom_needed = {"http", "sqlite3", "ssl", "xml"}
    assert loaded_after(code, tmp_path).isdisjoint(seldom_needed.union(HEAVY))


def test_tiles_load_no_library_but_numpy(tmp_path: Path) -> None:
    code = "import liftmesh; liftmesh.tile([[0, 0], [1, 0], [0, 1]], 'tiles').to_array()"
    assert loaded_after(code, tmp_path).isdisjoint(HEAVY)


def test_every_public_name_stays_what_it_was() -> None:
    for name in liftmesh.__all__:
        first = getattr(liftmesh, name)
        assert getattr(liftmesh, name) is first
        assert not isinstance(first, ModuleType), f"liftmesh.{name} is a module"


@pytest.mark.slow
def test_no_name_is_both_a_module_and_something_else_after_all_are_loaded(tmp_path: Path) -> None:
    """Names of a room, and public ones, stay when a module of that name is imported."""
    code = """
import importlib, pkgutil, sys, types, liftmesh
found = [m for m in pkgutil.walk_packages(liftmesh.__path__, "liftmesh.")]
rooms = ["liftmesh", *(module.name for module in found if module.ispkg)]
before = {room: dict(vars(importlib.import_module(room))) for room in rooms}
for module in found:
    if not module.name.endswith(("__main__", "plugins.pyvista")):  # which the tests lack
        importlib.import_module(module.name)
        room, _, name = module.name.rpartition(".")
        own = before[room].get(name)
        assert own is None or isinstance(own, types.ModuleType), module.name
        assert getattr(sys.modules[room], name) is sys.modules[module.name], module.name
public = [getattr(liftmesh, name) for name in liftmesh.__all__]
print(len(found), len(rooms), sum(isinstance(each, types.ModuleType) for each in public))
"""
    modules, rooms, hidden = map(int, python(code, tmp_path).split())
    assert (modules > 90, rooms >= 10, hidden) == (True, True, 0)


def test_modules_of_public_names_list_them() -> None:
    names = {**vars(importlib.import_module("liftmesh.predicates"))}
    assert names["__all__"] == ["incircle", "insphere", "orient2d", "orient3d"]
    assert all(getattr(liftmesh, name) is names[name] for name in names["__all__"])
    assert liftmesh.scipy.__all__ == ["Delaunay", "SpaceDelaunay", "SpaceVoronoi", "Voronoi"]


def test_no_module_bears_the_name_of_a_public_name() -> None:
    modules = {module.name for module in pkgutil.iter_modules(liftmesh.__path__)}
    assert len(modules) > 10
    assert modules.isdisjoint(liftmesh.__all__)


@pytest.mark.slow
def test_all_public_names_load_at_once_where_that_is_asked_for(tmp_path: Path) -> None:
    code = "import os; os.environ['EAGER_IMPORT'] = '1'; import liftmesh; print(*vars(liftmesh))"
    assert set(liftmesh.__all__) - {"__version__"} <= set(python(code, tmp_path).split())


def test_the_stub_names_what_is_there() -> None:
    """Type checkers read the stub, and so does the loader: its modules hold its names."""
    tree = ast.parse((ROOT / "liftmesh" / "__init__.pyi").read_text("utf-8"))
    stated = [
        (node.module, alias.name)
        for node in tree.body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    ]
    assert {name for _, name in stated} | {"__version__"} == set(liftmesh.__all__)
    for module, name in stated:
        home = importlib.import_module(f"liftmesh.{module}")
        assert getattr(home, name).__module__ == home.__name__, name


def test_public_names_are_listed_and_unique() -> None:
    assert dir(liftmesh) == sorted([*liftmesh.__all__, "scipy"])
    assert len(set(liftmesh.__all__)) == len(liftmesh.__all__)


def test_classes_for_scipy_are_reached_by_attribute(tmp_path: Path) -> None:
    code = "import liftmesh; print(liftmesh.scipy.Delaunay([[0, 0], [1, 0], [0, 1]]).nsimplex)"
    assert python(code, tmp_path).strip() == "1"
    found = python("from liftmesh import *; import scipy; print(scipy.__name__)", tmp_path)
    assert found.strip() == "scipy"


def test_star_import_brings_the_public_names(tmp_path: Path) -> None:
    code = "from liftmesh import *\nimport json; print(json.dumps(sorted(globals())))"
    assert set(liftmesh.__all__) <= set(json.loads(python(code, tmp_path)))


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'delauney'"):
        liftmesh.delauney  # noqa: B018 - the access is the test


def test_the_version_stands_in_one_place(tmp_path: Path) -> None:
    version = importlib.metadata.version("liftmesh")
    assert liftmesh.__version__ == version
    assert f'version = "{version}"' in (ROOT / "pyproject.toml").read_text("utf-8")
    assert f"[{version}]" in (ROOT / "CHANGELOG.md").read_text("utf-8")
    for source in (ROOT / "liftmesh").rglob("*.[ch]pp"):
        assert version not in source.read_text("utf-8"), source
    for source in (ROOT / "liftmesh").rglob("*.py"):
        assert version not in source.read_text("utf-8"), source


@pytest.mark.parametrize(
    "command", [["-m", "liftmesh"], [str(Path(sys.executable).parent / "liftmesh")]]
)
def test_the_command_line_tells_the_version(command: list[str], tmp_path: Path) -> None:
    words = [sys.executable, *command] if command[0] == "-m" else command
    assert run(*words, "--version", cwd=tmp_path).split() == ["liftmesh", liftmesh.__version__]


def test_the_main_module_runs_only_when_it_is_asked_to(tmp_path: Path) -> None:
    assert python("import liftmesh.__main__ as it; print(it.program.__module__)", tmp_path) == (
        "liftmesh.cli\n"
    )


def test_type_information_is_shipped() -> None:
    shipped = {path.name for folder in liftmesh.__path__ for path in Path(folder).iterdir()}
    assert {"py.typed", "_kernel.pyi"} <= shipped
