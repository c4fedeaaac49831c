#!/usr/bin/env bash
# GLB in Blender, which is 0.4 GB from PyPI (bpy, for Python 3.11): what liftmesh writes is opened there, and its size,
# its way up, its colours and its place are compared. BLENDER_PYTHON names an interpreter that has bpy already.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

make_test_environment
outside=$(mktemp -d)
trap 'rm -rf "$outside"' EXIT
if [[ -z ${BLENDER_PYTHON:-} ]]; then
    run_quietly "Making an environment outside the repository" .venv-test/bin/python -m venv "$outside/environment"
    run_quietly "Installing Blender there" pip_install "$outside/environment" --no-compile bpy
    BLENDER_PYTHON=$outside/environment/bin/python
fi
mkdir "$outside/files"
.venv-test/bin/python scripts/blender/make.py "$outside/files"
"$BLENDER_PYTHON" scripts/blender/check.py "$outside/files"
