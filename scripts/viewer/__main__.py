"""Open tilesets in CesiumJS, and look for cracks: ``python scripts/viewer``.

Tiles of ``data/jacksboro.ply``, placed in UTM zone 16, as 3D Tiles and as quantized-mesh, are
served on this machine and opened in headless Chromium, without a network: before a bright
background, from above and from beside the borders of tiles, at an accuracy that shows tiles of
several levels side by side. Background within the outline of the terrain is a crack. As a control,
one tile is lowered by 30 m: then there has to be one. Khronos's validator reads every GLB file.

It needs ``apt-get install chromium nodejs npm``; the packages cesium, puppeteer-core and
gltf-validator of npm are installed into the folder of ``--modules``.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import threading
from collections import Counter
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import numpy as np
from campaign import parser_of
from PIL import Image
from pyproj import Transformer
from scipy import ndimage

import liftmesh

HERE = Path(__file__).resolve().parent
DATA = HERE.parent.parent / "data" / "jacksboro.ply"
SYSTEM, CORNER = "EPSG:26916", np.array([740_000.0, 4_010_000.0, 0.0])
PACKAGES = ("cesium", "puppeteer-core", "gltf-validator")
WIDTH, HEIGHT = 1000, 640
LOWERED = 30.0
VALIDATE = """
const {readFileSync} = require("node:fs");
const validator = require("gltf-validator");
(async () => {
  let errors = 0, warnings = 0;
  for (const path of process.argv.slice(1)) {
    const {issues} = await validator.validateBytes(new Uint8Array(readFileSync(path)));
    errors += issues.numErrors; warnings += issues.numWarnings;
    if (issues.numErrors + issues.numWarnings) console.error(path, JSON.stringify(issues.messages));
  }
  console.log(JSON.stringify({errors, warnings}));
})();
"""


class Handler(SimpleHTTPRequestHandler):
    """Serves the page, CesiumJS and the tiles."""

    def __init__(self, *given: Any, places: dict[str, Path], **options: Any) -> None:
        self._places = places
        super().__init__(*given, **options)

    def translate_path(self, path: str) -> str:
        """Find the file of a path."""
        first, _, rest = path.split("?", maxsplit=1)[0].lstrip("/").partition("/")
        return str(self._places[first] / rest) if first in self._places else str(HERE / "page.html")

    def log_message(self, format: str, *given: Any) -> None:  # noqa: A002 - the name of the base
        """Say nothing."""


def main() -> None:
    """Make the tiles, look at them, and say what was seen."""
    parser = parser_of(__doc__ or "")
    parser.add_argument("--modules", type=Path, default=Path("out/viewer/modules"))
    parser.add_argument("--out", type=Path, default=Path("out/viewer"))
    parser.add_argument("--browser", default=shutil.which("chromium"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    modules = installed(options.modules.resolve())
    surface = placed()
    tiles, lowered = options.out / "tiles", options.out / "lowered"
    found = liftmesh.write_tileset(surface, tiles, max_error=5.0, levels=5, extrapolate="hull")
    print(f"errors by level {', '.join(f'{each:.1f}' for each in found.errors)} m")
    validated(modules, sorted(tiles.glob("*/*/*.glb")))
    shutil.copytree(tiles, lowered, dirs_exist_ok=True)
    lower(lowered)
    look = partial(seen, modules, options.browser, options.out, places_of(surface))
    cracks, control = look("tiles", tiles), look("lowered", lowered)
    globe = options.out / "globe"
    found_there = liftmesh.write_quantized_mesh(surface, globe, max_error=20.0)
    print(f"of the globe {', '.join(f'{each:.1f}' for each in found_there.errors)} m")
    cracks += look("globe", globe, kind="terrain")
    if any(cracks) or not any(control):
        raise SystemExit(f"cracks in the views: {cracks}; in those of the control: {control}")


def placed() -> liftmesh.Surface:
    """Return the terrain on the map, coloured by height."""
    points = liftmesh.read(DATA).points + CORNER
    share = np.interp(points[:, 2], [230, 1080], [0, 1])[:, None]
    colors = (np.array([60, 110, 50]) * (1 - share) + np.array([230, 225, 210]) * share).astype(
        "u1"
    )
    return liftmesh.triangulate(liftmesh.Cloud(points, colors=colors, crs=SYSTEM))


def places_of(surface: liftmesh.Surface) -> list[dict[str, Any]]:
    """Return where the camera looks, and from where."""
    west, south, east, north = surface.bounds
    degrees = Transformer.from_crs(SYSTEM, 4326, always_xy=True)

    def at(x: float, y: float) -> list[float]:
        place = west + x * (east - west), south + y * (north - south)
        return [*degrees.transform(*place), float(surface.sample(place, extrapolate="nearest"))]

    views = [("whole", 0.5, 0.5, 60_000, 20, -50), ("crossing", 0.5, 0.5, 4_000, 45, -15)]
    views += [("along", 0.5, 0.25, 2_500, 0, -8), ("quarter", 0.25, 0.75, 3_000, 200, -25)]
    return [
        {"name": name, "place": at(x, y), "away": away, "heading": heading, "pitch": pitch}
        for name, x, y, away, heading, pitch in views
    ]


def lower(folder: Path) -> None:
    """Lower the tile of the finest level beside the middle, and those above that hold it."""
    for level in range(2, 5):
        at = 2**level // 2
        path = folder / str(level) / str(at) / f"{at}.glb"
        mesh = liftmesh.read(path)
        mesh.points[:, 2] -= LOWERED
        liftmesh.write(path, mesh, origin=mesh_origin(folder))


def mesh_origin(folder: Path) -> tuple[float, float, float]:
    """Return the origin of the tiles of a folder."""
    data = next(folder.glob("*/*/*.glb")).read_bytes()
    tree = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    x, y, z = tree["scenes"][0]["extras"]["liftmesh"]["zero"]
    return x, y, z


def installed(modules: Path) -> Path:
    """Install what npm has, if it is not there."""
    modules.mkdir(parents=True, exist_ok=True)
    missing = [each for each in PACKAGES if not (modules / "node_modules" / each).is_dir()]
    if missing:
        words = ["npm", "install", "--ignore-scripts", "--no-save", "--prefix", str(modules)]
        subprocess.run([*words, *missing], check=True)
    return modules


def validated(modules: Path, paths: list[Path]) -> None:
    """Let Khronos's validator read GLB files."""
    words = ["node", "-e", VALIDATE, *(str(path.resolve()) for path in paths)]
    told = subprocess.run(words, cwd=modules, check=True, capture_output=True, text=True)
    found = json.loads(told.stdout)
    print(f"gltf-validator: {len(paths)} files, {found}\n{told.stderr[:2000]}")
    if found["errors"]:
        raise SystemExit("a file is not valid")


def seen(
    modules: Path,
    browser: str,
    out: Path,
    views: list[dict[str, Any]],
    name: str,
    tiles: Path,
    kind: str = "tileset",
) -> list[int]:
    """Look at tiles, and count for each view the pixels of background inside the terrain."""
    cesium = modules / "node_modules" / "cesium" / "Build" / "Cesium"
    handler = partial(Handler, places={"cesium": cesium, "tiles": tiles.resolve()})
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        origin = f"http://127.0.0.1:{server.server_port}"
        views = [{**each, "picture": str(out / f"{name}-{each['name']}.png")} for each in views]
        job = {
            "modules": str(modules), "browser": browser, "origin": origin, "views": views,
            "url": f"{origin}/page.html?pixels=6&kind={kind}", "width": WIDTH, "height": HEIGHT,
            "result": str(out / f"{name}.json"),
        }  # fmt: skip
        (out / f"{name}-job.json").write_text(json.dumps(job))
        subprocess.run(["node", HERE / "look.mjs", out / f"{name}-job.json"], check=True)
        server.shutdown()
    result = json.loads((out / f"{name}.json").read_text())
    for text in dict.fromkeys(result["said"]):
        print(f"  {name}: the page says {text[:200]}")
    if any(text.startswith("outside") for text in result["said"]):
        raise SystemExit("the page asked for something that is not on this machine")
    return [judged(view, shown) for view, shown in zip(views, result["views"], strict=True)]


def judged(view: dict[str, Any], shown: list[str]) -> int:
    """Count the pixels of background that terrain surrounds; say what is to be seen."""
    pixels = np.asarray(Image.open(view["picture"]).convert("RGB")).astype(int)
    background = (pixels[..., 0] > 200) & (pixels[..., 1] < 60) & (pixels[..., 2] > 200)
    labels, _ = ndimage.label(background)
    around = {*labels[0], *labels[-1], *labels[:, 0], *labels[:, -1]} - {0}
    inside = background & ~np.isin(labels, [*around])
    levels = Counter(name.split("/")[0] for name in shown)
    told = ", ".join(f"{count} of level {level}" for level, count in sorted(levels.items()))
    terrain = 1 - background.mean()
    print(
        f"  {Path(view['picture']).name}: {terrain:.0%} terrain, tiles {told}; "
        f"{inside.sum()} pixels of background inside",
        flush=True,
    )
    return int(inside.sum())


if __name__ == "__main__":
    main()
