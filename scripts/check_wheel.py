"""Check a built wheel in an environment of its own: ``check_wheel.py WHEEL CLOUD``.

Install the wheel in an environment outside the repository, and run this with that environment's
Python in a folder outside the repository.
"""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np

import liftmesh

COMMAND = str(Path(sys.executable).parent / ("liftmesh.exe" if os.name == "nt" else "liftmesh"))


def main(wheel: Path, terrain: Path) -> None:
    """Check the wheel's contents, the origin of the package, the command and the library."""
    for check in (check_contents(wheel), check_origin(), check_command(terrain), check_library()):
        print(f"ok: {check}")


def check_contents(wheel: Path) -> str:
    """Compare the files in the wheel with what belongs there."""
    names = zipfile.ZipFile(wheel).namelist()
    suffixes = (".so", ".pyd")
    kernels = [n for n in names if n.startswith("liftmesh/_kernel.") and n.endswith(suffixes)]
    require(len(kernels) == 1, f"one compiled kernel, not {kernels}")
    require({"liftmesh/py.typed", "liftmesh/_kernel.pyi"} <= set(names), "types are shipped")
    licences = {name.rpartition("/")[2] for name in names if "/licenses/" in name}
    require(licences == {"LICENSE", "LICENSE.fast_float"}, f"licences are shipped: {licences}")
    ours = ("liftmesh/", "liftmesh-", "liftmesh.libs/")  # the last of repaired wheels
    stray = [n for n in names if "_core/" in n.split("/licenses/")[0] or not n.startswith(ours)]
    require(not stray, f"neither kernel sources nor other files: {stray}")
    return f"{wheel.name} has {len(names)} files, among them {kernels[0]}, and no kernel sources"


def check_origin() -> str:
    """Check that the imported package is the installed one."""
    home = Path(liftmesh.__file__).resolve()
    require(home.is_relative_to(Path(sys.prefix).resolve()), f"{home} is not in {sys.prefix}")
    return f"liftmesh {liftmesh.__version__} is imported from its environment"


def check_command(terrain: Path) -> str:
    """Run the installed command on the terrain and read the mesh back."""
    version = run(COMMAND, "--version")
    require(version.split() == ["liftmesh", liftmesh.__version__], version)
    run(COMMAND, "triangulate", str(terrain), "mesh.ply")
    cloud, mesh = liftmesh.read(terrain), liftmesh.read("mesh.ply")
    require(np.array_equal(mesh.points, cloud.points), "every coordinate, bit for bit")
    require(mesh.faces is not None and len(mesh.faces) > len(cloud), "a mesh with faces")
    return f"the command made {len(mesh.faces):,} triangles of {len(cloud):,} points"


def check_library() -> str:
    """Triangulate from Python, and check the message about a missing extra."""
    surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 1, 8]])
    require(len(surface.to_trimesh().faces) == 2, "two triangles in trimesh")
    try:
        surface.to_open3d()
    except liftmesh.MissingDependencyError as error:
        require("pip install 'liftmesh[open3d]'" in str(error), str(error))
        return "without the extra open3d, its adapter says how to install it"
    raise SystemExit(
        "Open3D was found: the environment has more than the wheel and its dependencies"
    )


def run(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def require(holds: bool, what: str) -> None:
    if not holds:
        raise SystemExit(f"expected: {what}")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
