#!/bin/sh
# Debian's assimp-testmodels, well-formed and malformed, through `twopass info`: each OBJ, PLY and glTF file loads
# (exit code 0) or fails with one clear line (1), within a minute; never a crash, a hang or a number that is none.
#   tests/models.sh [TWOPASS] [--install]     --install: fetches the package where it is missing (21 MB; as root)
# Exit code 77 where the package is missing: ctest counts the test as skipped.
folder=/usr/share/assimp/models
program=$(dirname "$0")/../build/release/twopass
for argument; do
  case $argument in
    --install) [ -d $folder ] || apt-get install -y --no-install-recommends assimp-testmodels || exit 1 ;;
    *) program=$argument ;;
  esac
done
[ -d $folder ] || { echo "assimp-testmodels is not installed: skipped" >&2; exit 77; }

output=$(mktemp -d)
trap 'rm -rf "$output"' EXIT
find $folder -iname '*.obj' -o -iname '*.ply' -o -iname '*.gltf' -o -iname '*.glb' | LC_ALL=C sort >"$output/files"
loaded=0 refused=0 failures=0
complain() {
  echo "$file: $1" >&2
  failures=$((failures + 1))
}
while IFS= read -r file; do
  timeout 60 "$program" info "$file" >"$output/out" 2>"$output/err"
  code=$?
  case $code in
    0) loaded=$((loaded + 1)) ;;
    1)
      refused=$((refused + 1))
      [ "$(wc -l <"$output/err")" -eq 1 ] || complain "refused with $(wc -l <"$output/err") lines: $(cat "$output/err")"
      grep -q '.: .*; ' "$output/err" || complain "unclear: $(cat "$output/err")"
      ;;
    124) complain "takes more than a minute" ;;
    *) complain "exit code $code" ;;
  esac
  grep -qiwE -- '-?(nan|inf)' "$output/out" && complain "numbers that are none: $(grep -iwE -- '-?(nan|inf)' "$output/out")"
done <"$output/files"
echo "$loaded loaded, $refused refused, $failures failures"
[ "$failures" -eq 0 ] && [ "$((loaded + refused))" -gt 0 ]
