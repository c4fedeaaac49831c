#!/usr/bin/env bash
# The plugin for QGIS, in the QGIS of Debian: installs that, makes the zip, and runs every algorithm by qgis_process;
# their results are compared with those of shapely, SciPy and Rasterio. Then QGIS itself is opened on a screen in memory,
# and its picture is left in out/qgis.png.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

packages=(qgis qgis-providers python3-qgis xvfb xauth)
for name in "${packages[@]}"; do
    dpkg --status "$name" >/dev/null 2>&1 && continue
    ((EUID == 0)) || stop "this needs, as root: apt-get install ${packages[*]}"
    install_packages "${packages[@]}"
    break
done
make_test_environment
.venv-test/bin/python scripts/qgis_plugin
