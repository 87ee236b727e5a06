#!/bin/sh
# From nothing to pictures: installs what is missing, builds, renders the Cornell box both ways and compares them.
set -eu
cd "$(dirname "$0")/.."
render/install_packages.sh
mkdir -p build
cmake --preset release >build/demo-configure.log 2>&1 || { cat build/demo-configure.log >&2; exit 1; }
cmake --build --preset release --target twopass

program=build/release/twopass
out=build/demo
mkdir -p "$out"
echo
echo "== Two passes: radiosity, then a final gather =="
"$program" render scenes/cornell-box/scene.xml --integrator twopass --spp 64 \
  -o "$out/cornell-box-twopass.exr" -o "$out/cornell-box-twopass.png" --stats "$out/cornell-box-twopass.json"
echo
echo "== Ground truth: path tracing, with twice the samples =="
"$program" render scenes/cornell-box/scene.xml --integrator path --spp 128 \
  -o "$out/cornell-box-path.exr" -o "$out/cornell-box-path.png" --stats "$out/cornell-box-path.json"
echo
echo "== With a mirror and glass =="
"$program" render scenes/cornell-box-specular/scene.xml --integrator twopass --spp 64 \
  -o "$out/cornell-box-specular-twopass.exr" -o "$out/cornell-box-specular-twopass.png"
echo
echo "== The two-pass picture against the path-traced one =="
"$program" compare "$out/cornell-box-twopass.exr" "$out/cornell-box-path.exr" --json "$out/comparison.json" \
  --html "$out/comparison.html"
echo
echo "Open $PWD/$out/comparison.html to look at both, or cornell-box-twopass.png and cornell-box-path.png beside it;"
echo "the .exr files beside them are scene-linear, for compositing."
