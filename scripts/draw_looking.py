"""Draw the pictures of docs/guide/looking.md: ``python scripts/draw_looking.py``.

Plots are matplotlib's; cards of notebooks and pages are as headless Chromium shows them, on light
and on dark, with WebGL drawn by the processor (``apt-get install chromium``).
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import liftmesh

DATA = Path(__file__).resolve().parent.parent / "data"
FOLDER = DATA / "looking"
RNG = np.random.default_rng(40)
SQUARE = (0, 0, 1, 1)
CHROMIUM = (
    shutil.which("chromium") or "chromium", "--headless", "--no-sandbox", "--hide-scrollbars",
    "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--virtual-time-budget=20000",
)  # fmt: skip


def results(folder: Path) -> dict[str, Any]:
    """Make results of many kinds."""
    surface = liftmesh.triangulate(DATA / "jacksboro.ply")
    few = liftmesh.lloyd(RNG.random((60, 2)), domain=SQUARE, max_iter=3).points
    wave = np.column_stack([np.linspace(0, 1, 40), 0.5 + 0.2 * np.sin(np.linspace(0, 9, 40))])
    tri = liftmesh.delaunay(few)
    return {
        "surface": surface,
        "tiles": liftmesh.tile_surface(surface.vertices[::4], folder / "tiles", tile_rows=4000),
        "contours": surface.contours(interval=100),
        "profile": surface.profile([[1000, 3000], [29000, 28000]]),
        "cells": liftmesh.voronoi(few, domain=SQUARE),
        "disks": liftmesh.apollonius_diagram(few, RNG.random(60) * 0.06, domain=SQUARE),
        "forced": liftmesh.constrained_delaunay(RNG.random((150, 2)), polylines=[wave]),
        "flawed": liftmesh.verify(tri.points, np.delete(tri.simplices, [20, 60, 80], axis=0)),
        "space": liftmesh.tetrahedralize(RNG.normal(size=(200, 3))),
        "report": surface.report,
    }


def draw_plots(made: dict[str, Any]) -> None:
    """Draw what has a method for it."""
    figure = Figure(figsize=(16, 7.6), layout="constrained")
    names = ["surface", "tiles", "contours", "profile", "cells", "disks", "forced", "flawed"]
    for name, ax in zip(names, figure.subplots(2, 4).ravel(), strict=True):
        made[name].plot(ax).set_title(f"{type(made[name]).__name__}.plot()", fontsize=10)
    figure.savefig(FOLDER / "plots.png", dpi=70)
    few_colors(FOLDER / "plots.png")


def draw_cards(made: dict[str, Any], folder: Path) -> None:
    """Draw what notebooks show, on light and on dark."""
    cards = "".join(f"<div>{each._repr_html_()}</div>" for each in made.values())
    for name, colors in {"light": "#fff;color:#111", "dark": "#16191c;color:#ddd"}.items():
        grid = "display:grid;grid-template-columns:repeat(3,1fr);gap:18px;margin:18px"
        page = folder / f"{name}.html"
        page.write_text(f'<meta charset="utf-8"><body style="background:{colors};{grid}">{cards}')
        shoot(page, FOLDER / f"cards-{name}.png", "1380,1330")


def draw_pages(folder: Path) -> None:
    """Draw pages: a surface, and the lift."""
    plane = liftmesh.lloyd(RNG.random((70, 2)), domain=SQUARE, max_iter=6).points
    shown = {"page": DATA / "jacksboro.ply", "lift": liftmesh.delaunay(plane).lifted()}
    for name, each in shown.items():
        surface = liftmesh.triangulate(each) if isinstance(each, Path) else each
        liftmesh.view(surface, title="Jacksboro" if name == "page" else "The lift").save(
            folder / f"{name}.html"
        )
        shoot(folder / f"{name}.html", FOLDER / f"{name}.png", "1100,640")


def shoot(page: Path, target: Path, size: str) -> None:
    """Let the browser open a page, and keep its picture."""
    command = [*CHROMIUM, f"--window-size={size}", f"--screenshot={target}", page.as_uri()]
    subprocess.run(command, check=True, capture_output=True)
    few_colors(target)


def few_colors(path: Path) -> None:
    """Write a picture again with 128 colours, in a third of the bytes."""
    Image.open(path).convert("RGB").quantize(128).save(path, optimize=True)


def main() -> None:
    """Draw all pictures."""
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = results(folder)
        draw_plots(made)
        draw_cards(made, folder)
        draw_pages(folder)


if __name__ == "__main__":
    main()
