"""Run a benchmark: ``python scripts/bench.py NAME [options]``.

`python scripts/bench.py NAME --help` tells what it measures, how, and its options. Every benchmark
is a module of `scripts/benchmark/tasks` with `add_options` and `run`.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from importlib import import_module

from benchmark.measuring import JOB, run_job

BENCHMARKS = {
    "delaunay": "planar triangulations beside SciPy, triangle, shull, CGAL and others",
    "small": "the latency of small calls",
    "progress": "the cost of a progress callback",
    "weighted": "weights, metrics and farthest points beside CGAL and SciPy",
    "constraints": "edges of constrained triangulations, beside CGAL, CDT and triangle",
    "changing": "points inserted into, and removed from, what is there, beside CGAL",
    "refine": "angles and sizes of meshes beside triangle and Gmsh",
    "space": "tetrahedra and their proof, beside CGAL, SciPy and shull",
    "shapes": "alpha surfaces and spheres, beside Open3D, shull and SciPy",
    "graphs": "graphs of near points beside libpysal, many small sets beside SciPy",
    "disks": "graphs and cells of disks, and stars, beside CGAL and delaunay",
    "cells": "Voronoi diagrams and cells beside SciPy, shapely and geogram",
    "locate": "points located, beside SciPy and matplotlib",
    "verify": "verify beside the triangulation of the same points",
    "surface": "heights, rasters and contours beside SciPy, matplotlib, CGAL, PDAL and GDAL",
    "simplify": "rasters in few triangles, beside pydelatin",
    "plugins": "plugins beside PyVista, shapely, matplotlib and mapbox_earcut",
    "text": "numbers as text, read and written, beside polars",
    "stl": "binary STL, read and written, beside trimesh",
    "ground": "errors of ground filters on scenes whose ground is known",
    "lidar": "from LAZ to the mesh of its ground, beside decoding alone",
    "pipeline": "from a PLY file to another, stage by stage",
    "tiles": "a file in tiles, beside one call and tiles with buffers",
}
MODULES = {"small": "delaunay", "progress": "delaunay"}  # of others: their name


def main(words: list[str]) -> None:
    """Run the benchmark that is named, or list all."""
    if not words or words[0] not in BENCHMARKS:
        listed = "\n".join(f"  {name:12}{what}" for name, what in BENCHMARKS.items())
        parser = ArgumentParser(
            description=__doc__, epilog=listed, formatter_class=RawDescriptionHelpFormatter
        )
        parser.add_argument("name", choices=BENCHMARKS, metavar="NAME")
        parser.parse_args(words or ["--help"])
    name = words[0]
    task = import_module(f"benchmark.tasks.{MODULES.get(name, name)}")
    parser = ArgumentParser(
        prog=f"bench.py {name}",
        description=task.__doc__,
        formatter_class=RawDescriptionHelpFormatter,
    )
    if name in MODULES:
        parser.set_defaults(profile=name)
    task.add_options(parser)
    task.run(parser.parse_args(words[1:]))


if __name__ == "__main__":
    if sys.argv[1:2] == [JOB]:
        run_job(*sys.argv[2:])
    else:
        main(sys.argv[1:])
