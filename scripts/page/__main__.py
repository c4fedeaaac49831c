"""Make the script of pages, ``liftmesh/pages/page.js``, of its sources: ``python scripts/page``.

    python scripts/page            bundle the sources here with three.js, by esbuild
    python scripts/page --check    exit with 1 if that is not what is committed
    python scripts/page --look     open pages of every kind in headless Chromium, and judge them

The packages come from npm, in the versions of ``package.json``; ``apt-get install nodejs npm
chromium``. What ``--look`` does is in ``look.py``; its pictures are in ``out/page``.
three.js and what it holds are under the MIT licence, which is put beside the script.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOM = HERE.parent.parent / "liftmesh" / "pages"
FLAGS = (
    "--bundle", "--minify", "--format=iife", "--target=es2022", "--charset=utf8",
    "--legal-comments=none",
)  # fmt: skip


def main() -> None:
    """Bundle the sources, and write or compare."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/page"))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--look", action="store_true")
    parser.add_argument("--rows", type=int, default=0, help="look at pages of so many rows, too")
    parser.add_argument("--browser", default=shutil.which("chromium"))
    options = parser.parse_args()
    out = options.out.resolve()
    modules = installed(out)
    if options.look:
        from look import look  # noqa: PLC0415 - needs liftmesh

        sys.exit(look(modules, out, options.browser, options.rows) > 0)
    made = {"page.js": bundle(modules), "LICENSE.three.js.txt": licence(modules)}
    for name, text in made.items():
        path = ROOM / name
        if not options.check:
            path.write_text(text, encoding="utf-8")
        elif not path.is_file() or path.read_text(encoding="utf-8") != text:
            sys.exit(f"{path} is not made of its sources: run python scripts/page")
    print(f"page.js: {len(made['page.js'].encode()):,} bytes")


def installed(folder: Path) -> Path:
    """Install the packages in the versions of the package file, if they are not there."""
    package = HERE / "package.json"
    folder.mkdir(parents=True, exist_ok=True)
    copy = folder / package.name
    if not copy.is_file() or copy.read_bytes() != package.read_bytes():
        shutil.copy(package, copy)
        subprocess.run(["npm", "install", "--ignore-scripts", "--no-audit"], cwd=folder, check=True)
    return folder / "node_modules"


def bundle(modules: Path) -> str:
    """Return the script, with whose it is in its first line."""
    version = json.loads((modules / "three" / "package.json").read_text())["version"]
    esbuild = modules / ".bin" / "esbuild"
    environment = {**os.environ, "NODE_PATH": str(modules)}
    command = [str(esbuild), str(HERE / "src" / "main.js"), *FLAGS]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return f"/* liftmesh, with three.js {version} (MIT, see LICENSE.three.js.txt) */\n{done.stdout}"


def licence(modules: Path) -> str:
    """Return the licence of three.js."""
    return (modules / "three" / "LICENSE").read_text(encoding="utf-8")


if __name__ == "__main__":
    main()
