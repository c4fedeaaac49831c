#!/usr/bin/env bash
# A demonstration on a fresh machine: installs liftmesh into .venv, triangulates the shipped terrain and
# compares the result with trimesh's convex hull of the lifted points.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

environment=.venv

prepare_machine build
# Editable, so that Python started in this folder finds the kernel and not the bare sources.
make_environment $environment "pyproject.toml README.md LICENSE liftmesh" --editable '.[cli,scipy,trimesh]'
mkdir -p out

show liftmesh info data/jacksboro.ply
show liftmesh triangulate data/jacksboro.ply out/jacksboro.ply
show liftmesh triangulate data/jacksboro.ply out/jacksboro.obj
show liftmesh compare data/jacksboro.ply --lower out/lower.ply --hull out/hull.ply

cat <<END

Results:
  out/jacksboro.ply, out/jacksboro.obj   the Delaunay mesh of the terrain
  out/lower.ply                          its lift: the lower hull on the paraboloid, by liftmesh
  out/hull.ply                           trimesh's convex hull of the same lifted points
Open them in MeshLab, Blender, trimesh or Open3D. To use liftmesh yourself: source .venv/bin/activate
END
