"""Whichever allocation fails: batches change all or nothing, and maps of files are given back."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).with_name("failing_memory.cpp")
SETUP = """
import ctypes
import numpy as np
import liftmesh

memory = ctypes.CDLL(None)
line = np.column_stack([np.arange(150.0), np.zeros(150)])
cloud = np.unique(np.random.default_rng(0).integers(0, 40, (200, 2)).astype(float), axis=0)
both = np.concatenate([line[:60], cloud[:100] + [0, 50]])

rows = np.concatenate([line[:30], line[:30] + [0.5, 1], line[:30] + [0, 2], [[4.7, 4.0]]])
inputs = np.array([[0, 29], [60, 89], [30, 59], [0, 30], [5, 12], [90, 63]])

def state(tri):
    edges = tri.constraints, *tri.constraint_inputs, tri.is_constrained, tri.input_edges
    told = tri.vertices, tri.simplices, tri.find(both), *edges
    return [each.tolist() for each in told]

def built(start):
    return liftmesh.DynamicTriangulation(*(start if isinstance(start, tuple) else (start,)))

def failures(start, change):
    "How many allocations of a change have failed, each once, and changed nothing."
    for number in range(1, 10_000):
        tri = built(start)
        before = state(tri)
        memory.fail_at(number)
        try:
            change(tri)
        except MemoryError:
            assert state(tri) == before, number
            change(tri)  # as if nothing had been
            again = built(start)
            change(again)
            assert state(tri)[0] == state(again)[0]
        if memory.allocations_left() > 0:
            memory.fail_at(0)
            return number - 1
"""
CASES = {
    "to a line": ("line[:20]", "insert(line[20:])"),
    "off a line": ("line[:20]", "insert(cloud)"),
    "one off a line": ("line[:5]", "insert([[2.0, 7.0]])"),
    "to a cloud": ("cloud[:60]", "insert(cloud[60:])"),
    "from a cloud": ("cloud", "remove(tri.vertices[:100])"),
    "down to a line": ("both", "remove(np.arange(60, 160))"),
    "from a line": ("line", "remove(np.arange(60, 150))"),
    "all": ("cloud", "remove(tri.vertices)"),
    "a constraint": ("rows, inputs[1:]", "insert_constraint(0, 29)"),
    "across": ("rows", "insert_constraint(0, 90)"),
    "no constraint": ("rows, inputs", "remove_constraint(0, 29)"),
    "none across": ("rows, [[0, 90]]", "remove_constraint(0, 90)"),
    "on a constraint": ("rows, inputs", "insert([[5.25, 0.0]])"),
    "off a constraint": ("rows, inputs", "remove(15)"),
    "beside constraints": ("rows, inputs", "insert(cloud)"),
    "from constraints": ("rows, inputs", "remove(np.setdiff1d(tri.vertices, inputs))"),
    "a line with constraints": ("line, [[0, 149], [7, 9]]", "insert([[2.0, 7.0]])"),
    "to a line with constraints": ("line[::2], [[0, 74]]", "insert(line[:70])"),
    "a constraint of a line": ("line", "insert_constraint(0, 149)"),
}


@pytest.mark.slow
def test_a_batch_that_memory_fails_changes_nothing(tmp_path: Path) -> None:
    calls = (
        f"print({name!r}, failures(({start}), lambda tri: tri.{change}), sep=':')"
        for name, (start, change) in CASES.items()
    )
    told = dict(line.split(":") for line in output("\n".join(calls), tmp_path).splitlines())
    assert told.keys() == CASES.keys()
    assert {name: count for name, count in told.items() if int(count) <= 10} == {}


CALLS = """
space = np.random.default_rng(1).integers(0, 9, (160, 3)).astype(float)
square, hole = np.array([[0, 0], [40, 0], [40, 40], [0, 40]]) * 1.0, [[9, 9], [31, 9], [9, 31]]
rings = [square, np.array(hole) * 1.0]
hills = [np.column_stack([p, np.sin(p[:, 0])]) for p in (cloud[::2], cloud[1::2] + 0.25)]
flat, solid = liftmesh.delaunay(cloud), liftmesh.tetrahedralize(space)
carved = liftmesh.constrained_delaunay(cloud, polygons=[rings], carve="holes")
surfaces = [liftmesh.triangulate(each) for each in hills]

def ball():
    return liftmesh.spherical_delaunay(space - 4.25)

def shaped(tri):
    return tri.alpha_shape().faces, tri.alpha_complex(3.0).edge_radii

calls = {
    "constrained": lambda: liftmesh.constrained_delaunay(
        cloud, polygons=[rings], carve="holes"
    ).simplices,
    "verified": lambda: str(liftmesh.verify(carved)),
    "refined": lambda: liftmesh.refine(carved, smooth=1).triangulation.simplices,
    "laid over": lambda: liftmesh.difference(*surfaces).faces,
    "tetrahedra": lambda: liftmesh.tetrahedralize(space, threads=1).simplices,
    "checked in space": lambda: str(liftmesh.verify(solid)),
    "alpha": lambda: shaped(flat),
    "graphs": lambda: [flat.graph(kind).data for kind in ("gabriel", "minimum_spanning_tree")],
    "influence": lambda: flat.graph("sphere_of_influence").data,
    "many": lambda: liftmesh.delaunay_many(cloud, [0, 9, 60, len(cloud)], threads=1).triangles,
    "alpha in space": lambda: shaped(solid),
    "sphere": lambda: ball().simplices,
    "cells of the sphere": lambda: ball().cells,
}

def failures(call):
    "How many allocations of a call have failed, after each of which it is as if nothing had been."
    expected, failed, number = repr(call()), 0, 1
    while True:
        memory.fail_at(number)
        try:
            call()
        except MemoryError:
            failed += 1
        if memory.allocations_left() > 0:
            memory.fail_at(0)
            assert repr(call()) == expected
            return failed
        number += 1 + number // 64
"""


@pytest.mark.slow
def test_a_call_that_memory_fails_raises(tmp_path: Path) -> None:
    told = output(
        CALLS + "for name in calls: print(name, failures(calls[name]), sep=':')", tmp_path
    )
    counts = dict(line.split(":") for line in told.splitlines())
    assert len(counts) == 13
    assert {name: count for name, count in counts.items() if int(count) <= 5} == {}


@pytest.mark.slow
def test_maps_of_files_are_given_back(tmp_path: Path) -> None:
    program = """
points = np.random.default_rng(0).random((300_000, 2))

def maps():
    with open("/proc/self/maps") as lines:
        return lines.read().count("(deleted)")

liftmesh.delaunay(points, scratch=FOLDER)  # which imports the kernel
before, most, number, is_done = maps(), 0, 0, False
while not is_done:
    number += 1
    memory.fail_at(number)
    try:
        found = liftmesh.delaunay(points, scratch=FOLDER, threads=1)
        most = maps()
        del found
    except MemoryError:
        pass
    is_done = memory.allocations_left() > 0
    memory.fail_at(0)
    assert maps() == before, number
print(number if most > before else 0)
"""
    assert int(output(program.replace("FOLDER", repr(str(tmp_path))), tmp_path)) > 10


def output(program: str, folder: Path) -> str:
    """What a program prints in which allocations of the kernel can fail."""
    library = folder / "failing_memory.so"
    compiler = shlex.split(os.environ.get("CXX", "c++"))
    flags = ["-std=c++17", "-O1", "-shared", "-fPIC", "-Wall", "-Werror"]
    subprocess.run([*compiler, *flags, str(SOURCE), "-o", str(library)], check=True)
    done = subprocess.run(
        [sys.executable, "-c", SETUP + program],
        capture_output=True,
        text=True,
        env={**os.environ, "LD_PRELOAD": str(library)},
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
