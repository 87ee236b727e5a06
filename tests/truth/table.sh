#!/bin/bash
# table.sh [BUILD]: runs the truth suite through the program and writes its table between the marks of README.md beside
# this script. BUILD: a build folder, default build/release.
set -e
here=$(cd "$(dirname "$0")" && pwd)
build=${1:-$here/../../build/release}
table=$(mktemp)
trap 'rm -f "$table"' EXIT
TWOPASS_TRUTH_TABLE=$table "$build/program_truth_test" --gtest_brief=1
{
  sed '/<!-- table -->/q' "$here/README.md"
  printf '\n| case | truth | ours | error |\n|---|---|---|---|\n'
  cat "$table"
} > "$here/README.new"
mv "$here/README.new" "$here/README.md"
