#!/bin/sh
# The page of `twopass view` in a real browser: what WebGL shows from the scene's camera against our own picture of the same
# solution, in a room whose lamp is not seen (the mesh has lamps in their colour, our picture in white). Usage: walk.sh PROGRAM SOURCE_FOLDER. Skipped (77) without Chromium.
set -eu
program=$1
source=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || { echo "no Chromium"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
scene=$source/scenes/cove/scene.xml
"$program" solve "$scene" --elements 3000 --quiet -o room.radiosity -o room.glb
"$program" view room.radiosity --quiet -o room.html
"$program" view room.glb --quiet -o other.html
cmp room.html other.html

chromium() {
  timeout 120 "$browser" --headless --no-sandbox --disable-dev-shm-usage --user-data-dir="$folder/profile" --hide-scrollbars \
    --use-angle=swiftshader --enable-unsafe-swiftshader --virtual-time-budget=4000 "$@" 2>browser.log
}
chromium --dump-dom "file://$folder/room.html" >dom.html || { cat browser.log; exit 1; }
grep -q 'data-triangles="[1-9][0-9]*"' dom.html || { echo "the page shows no triangles"; grep -o '<p id="trouble"[^/]*' dom.html; exit 1; }
chromium --window-size=256,256 --screenshot=seen.png "file://$folder/room.html#bare" >/dev/null || { cat browser.log; exit 1; }

# The mesh holds colours at their exposure; our picture is given the same, in 16 bits, where dithering does not show.
exposure=$(grep -a -o '"exposure":[^,}]*' room.glb | cut -d: -f2)
stops=$(awk "BEGIN { printf \"%.6f\", log($exposure) / log(2) }")
"$program" render "$scene" --integrator radiosity --elements 3000 --size 256x256 --spp 16 --exposure "$stops" --quiet -o ours.tif
# Rounding to the 8 bits of the page is 2e-5 of this.
"$program" compare seen.png ours.tif --max flip=0.03 --max relmse=4e-5
