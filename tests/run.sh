#!/bin/sh
# Installs what is missing, builds everything in the release preset and runs all tests. Arguments go to ctest.
set -eu
cd "$(dirname "$0")/.."
render/install_packages.sh
mkdir -p build
cmake --preset release >build/configure.log 2>&1 || { cat build/configure.log >&2; exit 1; }
cmake --build --preset release
ctest --preset release --parallel "$(nproc)" "$@"
