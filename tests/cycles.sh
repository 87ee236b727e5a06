#!/usr/bin/env bash
# Blender Cycles renders our scenes as we do: `twopass bench` finds the same light in both. Usage: cycles.sh TWOPASS. Exits with
# 77 (skipped) where there is no Blender.
set -eu
program=$1
scene="$(cd "$(dirname "$0")/.." && pwd)/scenes/cornell-box/scene.xml"
command -v blender >/dev/null || exit 77
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" bench "$scene" -o "$folder" --size 32 --seeds 2 --time 2 --reference-time 4 --integrators path --quiet
# The last line of each method: its energy ratios and its bias.
awk -F, '
  NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
  $2 ~ /^Cycles/ { found = 1; for (i = 1; i <= NF; ++i) last[i] = $i }
  END {
    if (!found) { print "cycles.sh: Cycles rendered nothing"; exit 1 }
    for (c in column) if (c ~ /^energy/) {
      ratio = last[column[c]]
      if (ratio < 0.99 || ratio > 1.01) { print "cycles.sh: " c " of Cycles is " ratio; exit 1 }
    }
    if (last[column["bias2"]] > 1e-3) { print "cycles.sh: bias2 of Cycles is " last[column["bias2"]]; exit 1 }
  }' "$folder/results.csv"
