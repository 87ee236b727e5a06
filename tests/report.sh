#!/usr/bin/env bash
# The report of `twopass compare --html` in a real browser: opened as a file, without network. Usage: report.sh TWOPASS.
# Exits with 77 (skipped) where there is no Chromium.
set -eu
program=$1
scene="$(cd "$(dirname "$0")/.." && pwd)/scenes/cornell-box/scene.xml"
browser=$(command -v chromium || command -v chromium-browser) || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() { echo "report.sh: $*" >&2; exit 1; }
open() {  # open FRAGMENT OPTION...: the page in the browser
  local fragment=$1
  shift
  timeout 100 "$browser" --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --hide-scrollbars --force-device-scale-factor=1 \
    --host-resolver-rules="MAP * ~NOTFOUND" --user-data-dir="$folder/profile" --window-size=900,900 \
    "$@" "file://$folder/report.html#$fragment" 2>"$folder/browser.log"
}

for integrator in path twopass; do
  "$program" render "$scene" --size 48x40 --spp 4 --integrator $integrator --exr-type float -o $integrator.exr --quiet
done
"$program" compare twopass.exr path.exr --html report.html --quiet

# The script runs, and reads out the very numbers of the files.
dom=$(open 'mode=swipe&probe=20,30' --dump-dom)
grep -q '<section id="viewer">' <<<"$dom" || fail "the viewer is still hidden: $(tail -3 browser.log)"
grep -q 'pixel 20, 30' <<<"$dom" || fail "no pixel is read out"
number() { grep -A4 'pixel 20, 30' <<<"$dom" | awk -v row="$1" '$1 == row { print $2 }'; }
test_red=$(number test) reference_red=$(number reference)
"$program" compare twopass.exr path.exr --crop 20,30,1,1 --json pixel.json --quiet
ratio=$(grep -A1 '"energy_ratio"' pixel.json | head -2 | tail -1 | tr -d ' ,')
awk -v t="$test_red" -v r="$reference_red" -v ratio="$ratio" \
  'BEGIN { exit !(r > 0 && t > 0 && (t / r - ratio) ^ 2 < (1e-5 * ratio) ^ 2) }' ||
  fail "the pixel is read out as $test_red and $reference_red, their ratio is $ratio"

# Each way to look shows something else; the same way the same.
for mode in test signed swipe side; do
  open "mode=$mode" --screenshot="$folder/$mode.png" >/dev/null
  [ -s $mode.png ] || fail "no screenshot of $mode: $(tail -3 browser.log)"
done
open "mode=test" --screenshot="$folder/again.png" >/dev/null
"$program" compare again.png test.png --max mse=0 --quiet || fail "two screenshots of one view differ"
for mode in signed swipe side; do
  if "$program" compare $mode.png test.png --max mse=1e-5 --quiet 2>/dev/null; then fail "$mode looks like test"; fi
done

# Every picture is as wide on the page as it is meant to be.
cp report.html whole.html
sed "s|</body>|<script>for (const i of document.querySelectorAll('figure img')) document.body.append(\`(width \${i.clientWidth} of \${i.getAttribute('width')})\`)</script>&|" \
  whole.html >report.html
open '' --dump-dom | grep -o '(width [0-9]* of [0-9]*)' >widths || fail "no picture on the page"
awk '{ sub(")", "", $4) } $2 != $4 { exit 1 }' widths || fail "pictures are squeezed: $(head -5 widths)"
mv whole.html report.html

# Where scripts are not allowed there are pictures and tables.
sed "s/script-src 'unsafe-inline'/script-src 'none'/" report.html >page.html && mv page.html report.html
dom=$(open '' --dump-dom)
grep -q '<section id="viewer" hidden="">' <<<"$dom" || fail "without JavaScript the viewer shows"
grep -q 'alt="heat map of test minus reference"' <<<"$dom" || fail "without JavaScript there is no heat map"
