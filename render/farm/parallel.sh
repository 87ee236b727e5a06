#!/bin/sh
# One picture by GNU parallel, on this machine or, with a list of them, on many:
#   render/farm/parallel.sh SCENE PICTURE SLICES [RENDER OPTIONS]     options must hold --spp, of the whole picture
# $PARALLEL_OPTIONS goes to parallel, e.g. "--sshloginfile hosts --jobs 1". Where something failed, give the same command
# again: it does what is left.
set -eu
[ $# -ge 3 ] || { sed -n '2,5s/^# \{0,1\}//p' "$0" >&2; exit 2; }
scene=$(realpath "$1") picture=$(realpath -m "$2") slices=$3
shift 3
step=$(dirname "$(realpath "$0")")/step.sh
folder=$picture.farm
"$step" solve "$scene" "$folder" "$@"
# shellcheck disable=SC2086
parallel --quote --retries 3 --halt soon,fail=1 --env TWOPASS ${PARALLEL_OPTIONS:---jobs 1} \
  "$step" slice "$scene" "$folder" {} "$slices" "$@" ::: $(seq "$slices")
exec "$step" merge "$folder" "$picture"
