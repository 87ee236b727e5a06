#!/bin/sh
# One step of a picture that many machines render, for schedulers to run. Each may be run again: it does what is left.
#   step.sh solve SCENE FOLDER [RENDER OPTIONS]       pass one, once
#   step.sh slice SCENE FOLDER K N [RENDER OPTIONS]   share K of N of the samples; K may be `array`: SLURM's task
#   step.sh merge FOLDER PICTURE                      the picture
# FOLDER, on a disk that all machines see, keeps the solution, the parts and their checkpoints.
# $TWOPASS is the program (default: twopass), $SOLVE_OPTIONS are options of twopass solve.
set -eu
twopass=${TWOPASS:-twopass}
threads=${SLURM_CPUS_PER_TASK:+--threads $SLURM_CPUS_PER_TASK}
step=$1
shift

# Integrators that read no solution.
without_solution() {
  case " $* " in
    *" path "* | *" direct "* | *"=path "* | *"=direct "*) return 0 ;;
    *) return 1 ;;
  esac
}

case $step in
  solve)
    scene=$1 folder=$2
    shift 2
    if without_solution "$@" || [ -f "$folder/solution.radiosity" ]; then exit 0; fi
    mkdir -p "$folder"
    exec "$twopass" solve "$scene" -o "$folder/solution.radiosity" $threads ${SOLVE_OPTIONS:-}
    ;;
  slice)
    scene=$1 folder=$2 number=$3 count=$4
    shift 4
    [ "$number" != array ] || number=$SLURM_ARRAY_TASK_ID
    mkdir -p "$folder/parts" "$folder/checkpoints"
    part=$folder/parts/$number.exr checkpoint=$folder/checkpoints/$number.exr
    # What an earlier try left: a part that may be finished, else a checkpoint.
    if [ -f "$part" ]; then
      set -- "$@" --resume "$part"
    elif [ -f "$checkpoint" ]; then
      set -- "$@" --resume "$checkpoint"
    fi
    without_solution "$@" || set -- "$@" --solution "$folder/solution.radiosity"
    exec "$twopass" render "$scene" --slice "$number/$count" -o "$part" --checkpoint "$checkpoint" $threads "$@"
    ;;
  merge)
    exec "$twopass" merge "$1"/parts/*.exr -o "$2" $threads
    ;;
  *)
    echo "step.sh: unknown step '$step'; use solve, slice or merge" >&2
    exit 2
    ;;
esac
