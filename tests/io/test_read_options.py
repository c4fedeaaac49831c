"""The typed options of `read`: complete, and found by type checkers."""

import inspect
import sys
from pathlib import Path

import pytest
from mypy import api

import liftmesh
from liftmesh.io.axes import validate_axes
from liftmesh.io.formats.landxml import validate_landxml_options
from liftmesh.io.options import ChunkOptions, FormatOptions, ReadOptions, validate_table_options
from liftmesh.raster.reader import validate_raster_options
from liftmesh.vector.clouds import validate_feature_options

ROOT = Path(__file__).parents[2]
CACHE = ROOT / ".mypy_cache"  # that of the checks before the tests: without it, half a minute
CALLS = """
import liftmesh
from liftmesh.dask import triangulate

liftmesh.read("a.las", clases=2)
next(liftmesh.read_chunks("a.csv", skiprows=2))
liftmesh.tile_surface("a.las", "out", copc_spacing=2)
triangulate("a.las", "out", collumns="x,y,z")
liftmesh.as_cloud([[1, 2, 3]], column="x,y,z")
liftmesh.read("a.csv", skip_rows="2")

liftmesh.read("a.las", classes=2, columns="x,y,z")
next(liftmesh.read_chunks("a.csv", rows=2, skip_rows=2))
liftmesh.tile_surface("a.las", "out", every=2, skip_rows=2)
liftmesh.as_cloud([[1, 2, 3]], columns="x,y,z")
"""


def keywords(function: object) -> dict[str, str]:
    parameters = inspect.signature(function).parameters.values()
    return {each.name: each.annotation for each in parameters if each.kind == each.KEYWORD_ONLY}


def types(options: type) -> dict[str, str]:
    return {name: each.__forward_arg__ for name, each in options.__annotations__.items()}


def test_typed_options_are_those_of_read_and_of_its_formats() -> None:
    checks = (
        validate_raster_options,
        validate_table_options,
        validate_landxml_options,
        validate_axes,
        validate_feature_options,
    )
    of_formats = {name: kind for check in checks for name, kind in keywords(check).items()}
    of_formats["transform"] = "Sequence[float] | None"  # of arrays
    assert types(FormatOptions) == of_formats
    assert types(ReadOptions) == {**of_formats, **keywords(liftmesh.read)}
    of_chunks = {**of_formats, **keywords(liftmesh.read_chunks)}
    assert of_chunks.pop("rows") == "int"
    assert types(ChunkOptions) == of_chunks


@pytest.mark.slow
def test_type_checkers_find_misspelt_options(tmp_path: Path) -> None:
    snippet = tmp_path / "calls.py"
    snippet.write_text(CALLS)
    settings = ["--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(CACHE)]
    told, failures, _ = api.run([*settings, "--python-executable", sys.executable, str(snippet)])
    lines = [line.removeprefix(f"{snippet}:") for line in told.splitlines() if " error: " in line]
    assert [int(line.partition(":")[0]) for line in lines] == [5, 6, 7, 8, 9, 10], told + failures
