#!/bin/bash
# table.sh [BUILD]: runs the truth suite through the program, writes its table between the marks of README.md beside this
# script, and the largest error of each kind of case between those of the main README. BUILD: a build folder, default
# build/release.
set -e
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
build=${1:-$root/build/release}
table=$(mktemp)
trap 'rm -f "$table"' EXIT
TWOPASS_TRUTH_TABLE=$table "$build/program_truth_test" --gtest_brief=1
{
  sed '/<!-- table -->/q' "$here/README.md"
  printf '\n| case | truth | ours | error |\n|---|---|---|---|\n'
  cat "$table"
} > "$here/README.new"
mv "$here/README.new" "$here/README.md"

# "name: way" to a row a kind of case, a column a way.
awk -F ' *[|] *' '
  {
    n = split($2, part, ": ")
    way = n > 1 ? part[n] : "rays"
    sub(/ .*/, "", way)
    if (way ~ /^--/ || way == "point" || way == "hemicube" || way == "exact" || way == "rays") way = "solve"
    kind = part[1]
    if (kind ~ /^F/) {
      kind = n > 1 ? part[n] : "rays"
      sub(/ .*/, "", kind)
      kind = "form factors: " kind
    } else if (kind ~ /^CIE/) sub(/,.*/, "", kind)
    else sub(/(, | at ).*/, "", kind)
    if (!(kind in rows)) { order[++count] = kind; rows[kind] = 0 }
    ++rows[kind]
    error = $5 + 0
    if (error < 0) error = -error
    if (!((kind, way) in worst) || error > worst[kind, way]) worst[kind, way] = error
  }
  END {
    columns = split("path unbiased twopass radiosity solve direct", ways, " ")
    printf "| case | values | `path` | `unbiased` | `twopass` | `radiosity` | `solve`, `form-factors` | `direct` |\n"
    printf "|---|---|---|---|---|---|---|---|\n"
    for (i = 1; i <= count; ++i) {
      printf "| %s | %d |", order[i], rows[order[i]]
      for (c = 1; c <= columns; ++c)
        if ((order[i], ways[c]) in worst) printf " %.1e |", worst[order[i], ways[c]]
        else printf " |"
      printf "\n"
    }
  }' "$table" > "$table.summary"
sed -i -e '/<!-- truth -->/,/<!-- end of truth -->/{/<!--/!d}' -e "/<!-- truth -->/r $table.summary" "$root/README.md"
rm "$table.summary"
