#!/usr/bin/env bash
# Libraries that call scipy.spatial.Delaunay, run with liftmesh's class in its place: their results must be those
# with SciPy's. Installs them and liftmesh into .venv-callers. Arguments are names of callers, such as metpy.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

prepare_machine build
make_environment .venv-callers "pyproject.toml README.md LICENSE liftmesh" --editable '.[callers]'
.venv-callers/bin/python scripts/scipy_callers "$@"
