#!/usr/bin/env bash
# The plugins of libraries that the tests' environment lacks, as PyVista, whose VTK takes half a gigabyte. Installs the
# wheel of liftmesh and these libraries into a fresh environment outside of the repository, as users do, and runs
# scripts/host_tests there, with the examples of docs/guide/plugins.md. Arguments are those of pytest.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

make_test_environment
outside=$(mktemp -d)
trap 'rm -rf "$outside"' EXIT
build_wheel "$outside"
run_quietly "Making an environment outside the repository" .venv-test/bin/python -m venv "$outside/environment"
wheels=("$outside"/*.whl)
run_quietly "Installing the wheel and the libraries there" pip_install "$outside/environment" --no-compile \
    "${wheels[0]}[cli,scipy,trimesh,pyvista,open3d,plot,xarray,solvers,shapes,las,e57]" pytest hypothesis
"$outside/environment/bin/pytest" -q -p no:cacheprovider --basetemp "$outside/tests" scripts/host_tests "$@"
