#!/usr/bin/env bash
# Blender's compositor reads our layers as render/image/README.md says. Usage: blender.sh TWOPASS. Exits with 77 (skipped)
# where there is no Blender.
set -eu
program=$1
here=$(cd "$(dirname "$0")" && pwd)
scene="$here/../scenes/cornell-box-specular/scene.xml"
command -v blender >/dev/null || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" render "$scene" --size 48x48 --spp 16 --exr-type float --quiet --aov light --cryptomatte object -o "$folder/a.exr"
objects=$("$program" info "$scene" --json | python3 -c '
import json, sys
print(*(shape["name"] for shape in json.load(sys.stdin)["shapes_by_name"]))')
blender -b --factory-startup --python-exit-code 1 --python "$here/blender.py" -- "$folder/a.exr" "$folder" $objects \
  >"$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
same() {  # same A B WHAT
  "$program" compare "$folder/$1" "$folder/$2" --max relmse=1e-8 >"$folder/log" || { echo "blender.sh: $3" >&2; cat "$folder/log" >&2; exit 1; }
}
same beauty_0001.exr a.exr "the picture is not ours"
same sum_0001.exr beauty_0001.exr "the light layers do not add up to the picture"
same coverage_0001.exr alpha_0001.exr "the mattes of all objects do not add up to alpha"
if "$program" compare "$folder/matte_0001.exr" "$folder/alpha_0001.exr" --max relmse=0.01 >/dev/null; then
  echo "blender.sh: the matte of one object is that of all" >&2
  exit 1
fi
