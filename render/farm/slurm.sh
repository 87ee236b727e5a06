#!/bin/sh
# One picture by SLURM: a job for pass one, an array for the slices, a job for the merge, each after the one before.
#   render/farm/slurm.sh SCENE PICTURE SLICES [RENDER OPTIONS]     options must hold --spp, of the whole picture
# Prints the numbers of the three jobs. What a node that died was rendering is started again by SLURM and goes on from
# its checkpoint. Where a job failed, give the same command again: it does what is left.
# $SBATCH_OPTIONS goes to all jobs, $SLICE_OPTIONS to the array, e.g. "--cpus-per-task=16 --mem=8G --time=4:00:00".
set -eu
[ $# -ge 3 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0" >&2; exit 2; }
scene=$(realpath "$1") picture=$(realpath -m "$2") slices=$3
shift 3
step=$(dirname "$(realpath "$0")")/step.sh
folder=$picture.farm
mkdir -p "$folder/logs"
# submit LOG ...
submit() {
  log=$1
  shift
  # shellcheck disable=SC2086
  sbatch --parsable --job-name="${log%%[-.]*}" --requeue --open-mode=append --output="$folder/logs/$log" \
    ${SBATCH_OPTIONS:-} "$@"
}
solve=$(submit solve.log "$step" solve "$scene" "$folder" "$@")
slice=$(submit slice-%a.log --array="1-$slices" --dependency="afterok:$solve" ${SLICE_OPTIONS:-} \
  "$step" slice "$scene" "$folder" array "$slices" "$@")
merge=$(submit merge.log --dependency="afterok:$slice" --kill-on-invalid-dep=yes "$step" merge "$folder" "$picture")
echo "$solve $slice $merge"
