"""Look at pages in headless Chromium, for ``python scripts/page --look``.

Pages of every kind are made, opened without a network, and worked with by mouse and keys: the
canvas must not be blank, each control must change the picture, a click on a row must name that row
with all its digits, and nothing may be said on the console or asked of a network. A surface at UTM
coordinates must look as the same at the origin, and a page of hostile names must be harmless.
Pictures at the width of a laptop and of a phone, light and dark, are left in ``out/page``, to be
looked at. At last, pages of more and more triangles: their sizes, how long they take to open, and
frames a second, drawn by the processor. With ``--rows 10000000``, also those of so many rows.
"""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

import liftmesh

if TYPE_CHECKING:
    from liftmesh.pages.page import Page

HERE = Path(__file__).resolve().parent
DATA = HERE.parent.parent / "data" / "jacksboro.ply"
UTM = np.array([500_000.0, 4_649_776.0, 128.0])  # a multiple of the steps in single precision
HOSTILE = "</script><img src=x onerror=alert(1)><script>alert(2)</script>"
SIZES = (10_000, 100_000, 1_000_000)  # triangles
RNG = np.random.default_rng(40)


def look(modules: Path, out: Path, browser: str, rows: int) -> int:
    """Make pages, open them, judge what was seen, and print the table; how much is wrong."""
    jobs = [*kinds(out), *sizes(out), *(many(out, rows) if rows else [])]
    seen = looked(jobs, out, modules, browser)
    faults = [fault for result in seen.values() for fault in faults_of(result)]
    faults += compared(out / "origin.png", out / "utm.png")
    wrong = [each["name"] for each in jobs if "rows" in each and not are_picked(each, seen)]
    faults += [f"{name}: a click does not name its row" for name in wrong]
    for size in SIZES:
        result, weight = seen[str(size)], (out / f"{size}.html").stat().st_size
        print(
            f"{size:>9,} triangles: {weight / 1e6:5.1f} MB, open in {result['seconds']:.1f} s, "
            f"{result['rate']:.1f} frames a second"
        )
    print(f"{len(jobs)} pages in {out}: {'; '.join(faults) or 'nothing wrong'}")
    return len(faults)


def kinds(out: Path) -> list[dict[str, Any]]:
    """Make a page of each kind."""
    surface = hills(0)
    plane = liftmesh.lloyd(RNG.random((70, 2)), domain=(0, 0, 1, 1), max_iter=6).points
    colored = surface.replace(colors=(surface.vertices[:, [0, 1, 0]] * 4).astype(np.uint8))
    named = colored.with_attributes({HOSTILE: surface.vertices[:, 0], "nan": np.full(3600, np.nan)})
    rows = surface.vertices[[1830, 777, 2929]]
    square, radii = (0, 0, 1, 1), RNG.random(70) * 0.06
    cells = liftmesh.voronoi(plane, domain=square)
    power = liftmesh.power_diagram(plane, radii=radii, domain=square)
    disks = liftmesh.apollonius_diagram(plane, radii, domain=square)
    wave = np.column_stack([np.linspace(0, 1, 40), 0.5 + 0.2 * np.sin(np.linspace(0, 9, 40))])
    forced = liftmesh.constrained_delaunay(RNG.random((300, 2)), polylines=[wave])
    pages = {
        "surface": (liftmesh.view(surface), {"rows": rows.tolist(), "work": True}),
        "origin": (liftmesh.view(surface), {"rows": rows.tolist()}),
        "utm": (liftmesh.view(moved(surface)), {"rows": (rows + UTM).tolist()}),
        "change": (liftmesh.view(surface, hills(4.0), names=["before", "after"]), {}),
        "lift": (liftmesh.view(liftmesh.delaunay(plane).lifted(), title="The lift"), {}),
        "cells": (liftmesh.view(liftmesh.delaunay(plane), cells, names=["triangles", "cells"]), {}),
        "power": (liftmesh.view(liftmesh.regular(plane, radii=radii), power), {}),
        "disks": (liftmesh.view(disks), {}),
        "constraints": (liftmesh.view(forced), {}),
        "tetrahedra": (
            liftmesh.view(liftmesh.tetrahedralize(RNG.normal(size=(2000, 3)))),
            {"script": "liftmesh.view.setCut(1, 0.5)"},
        ),
        "hostile": (liftmesh.view(named, names=[HOSTILE], title=HOSTILE), {}),
        "points": (liftmesh.view(colored.to_cloud().points, names=["points"]), {}),
    }
    jobs = [saved(out, name, *each) for name, each in pages.items()]
    others = {"phone": {"width": 390, "height": 800}, "dark": {"scheme": "dark"}}
    return jobs + [
        {**looks(out, job["name"], f"{job['name']}-{name}"), **more}
        for name, more in others.items()
        for job in jobs
    ]


def saved(out: Path, name: str, page: Page, more: dict[str, Any]) -> dict[str, Any]:
    """Save a page, and say what is to be done with it."""
    page.save(out / f"{name}.html")
    return {**looks(out, name, name), **more}


def looks(out: Path, page: str, name: str) -> dict[str, Any]:
    """Say which page to open, and where its picture goes."""
    return {"name": name, "file": str(out / f"{page}.html"), "picture": str(out / f"{name}.png")}


def hills(deep: float) -> liftmesh.Surface:
    """Return hills with a pit."""
    x, y = np.mgrid[:60, :60].reshape(2, -1).astype(float)
    z = 4 * np.sin(x / 7) + 5 * np.cos(y / 9) - deep * np.exp(-((x - 30) ** 2 + (y - 28) ** 2) / 80)
    z += deep / 2 * np.exp(-((x - 45) ** 2 + (y - 15) ** 2) / 50)
    return liftmesh.triangulate(np.column_stack([x, y, np.round(z * 1024) / 1024]))


def moved(surface: liftmesh.Surface) -> liftmesh.Surface:
    """Return the surface at coordinates of UTM, in which it has the same steps."""
    return liftmesh.triangulate(surface.vertices + UTM)


def sizes(out: Path) -> list[dict[str, Any]]:
    """Make pages of more and more triangles."""
    jobs = []
    for count in SIZES:
        plane = RNG.random((count // 2 + 20, 2)) * 1000
        heights = 20 * np.sin(plane[:, 0] / 60) + 30 * np.cos(plane[:, 1] / 90)
        surface = liftmesh.triangulate(np.column_stack([plane, heights]))
        jobs.append(saved(out, str(count), liftmesh.view(surface), {"rate": True}))
    return jobs


def many(out: Path, rows: int) -> list[dict[str, Any]]:
    """Make pages of very many rows, some of them NaN, under a hostile name; say what they take."""
    plane = RNG.random((rows, 2)) * 3000
    heights = 20 * np.sin(plane[:, 0] / 60) + 30 * np.cos(plane[:, 1] / 90)
    points = np.column_stack([plane, heights])
    points[::1000] = np.nan
    cloud = liftmesh.Cloud(points, attributes={HOSTILE: heights})
    surface = liftmesh.triangulate(cloud, nonfinite="skip")
    jobs = []
    for name, each in {"many-points": cloud, "many-triangles": surface}.items():
        began = time.process_time()
        page = liftmesh.view(each, names=[HOSTILE], title=HOSTILE)
        jobs.append(saved(out, name, page, {}))
        seconds, weight = time.process_time() - began, (out / f"{name}.html").stat().st_size
        note = page.layers[0].note
        print(f"{rows:,} rows as {name}: {weight / 1e6:.0f} MB, {seconds:.0f} s of CPU; {note}")
    return jobs


def looked(jobs: list[dict[str, Any]], out: Path, modules: Path, browser: str) -> dict[str, Any]:
    """Let the browser open all pages; what was seen, by name."""
    job = {
        "modules": str(modules),
        "browser": browser,
        "pages": jobs,
        "result": str(out / "seen.json"),
    }
    (out / "job.json").write_text(json.dumps(job))
    subprocess.run(["node", HERE / "look.mjs", out / "job.json"], check=True)
    return {each["name"]: each for each in json.loads((out / "seen.json").read_text())}


def faults_of(result: dict[str, Any]) -> list[str]:
    """List what is wrong with a page."""
    name, faults = result["name"], [f"says {text}" for text in result["said"]]
    if result["coverage"]["share"] < 0.01 or result["coverage"]["colours"] < 3:
        faults.append(f"is blank: {result['coverage']}")
    faults += [
        f"nothing changes by {key}" for key, done in result.get("worked", {}).items() if not done
    ]
    if "worked" in result and not (
        result["distances"]["planar"] > 0 and result["profile"]["shown"]
    ):
        faults.append(f"does not measure: {result['distances']}, {result['profile']}")
    return [f"{name} {each}" for each in faults]


def are_picked(job: dict[str, Any], seen: dict[str, Any]) -> bool:
    """Whether clicks named the rows, with all digits."""
    found = [each and [*map(float, each["exact"])] for each in seen[job["name"]]["picked"]]
    return found == job["rows"]


def compared(one: Path, other: Path) -> list[str]:
    """Say whether two pictures differ beside the numbers in their panels."""
    first, second = (
        np.asarray(Image.open(path).convert("RGB"), int)[:700, :980] for path in (one, other)
    )
    share = float((abs(first - second).max(axis=2) > 8).mean())
    return [f"{other.name} differs from {one.name} in {share:.2%}"] if share > 1e-3 else []
