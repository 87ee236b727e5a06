#!/bin/bash
# The farm recipes of render/farm, for real: SLURM with a controller and two nodes on this machine, one of which loses
# its power while it renders; GNU parallel, with a slice that is killed; OpenCue's job, run by a stand-in for it. Each
# picture must be the one that a single machine renders.
#   tests/farm.sh [TWOPASS] [--install]     --install: fetches the packages where they are missing (as root)
# Exit code 77 where SLURM or parallel is missing, or we are not root: ctest counts the test as skipped.
set -u
here=$(dirname "$(realpath "$0")")
TWOPASS=$here/../build/release/twopass
packages="slurmctld slurmd slurm-client parallel"
for argument; do
  case $argument in
    --install) apt-get install -y --no-install-recommends $packages || exit 1 ;;
    *) TWOPASS=$(realpath "$argument") ;;
  esac
done
export TWOPASS
for program in slurmctld slurmd sbatch parallel unshare python3; do
  command -v $program >/dev/null || { echo "$program is not installed: skipped" >&2; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "only root can start a SLURM of its own: skipped" >&2; exit 77; }

work=$(mktemp -d) || exit 1
pids=()
cleanup() {
  [ -z "${node2-}" ] || kill -9 "$node2" 2>/dev/null
  [ ${#pids[@]} -eq 0 ] || kill "${pids[@]}" 2>/dev/null
  wait 2>/dev/null
  rm -rf "$work"
}
trap cleanup EXIT
fail() {
  echo "FAILED: $1" >&2
  tail -n 5 "$work"/*.log "$work"/*.farm/logs/* >&2 2>/dev/null
  exit 1
}
# wait_for SECONDS COMMAND...
wait_for() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $end ] || return 1
    sleep 0.2
  done
}

scene=$here/../scenes/cornell-box/scene.xml
options=(--size 64x64 --spp 800 --exr-type float)
farm=$here/../render/farm
"$TWOPASS" solve "$scene" -o "$work/solution.radiosity" --quiet || fail "solving"
"$TWOPASS" render "$scene" -o "$work/single.exr" --solution "$work/solution.radiosity" --quiet "${options[@]}" || fail "the picture of a single machine"
same_picture() {
  "$TWOPASS" compare "$1" "$work/single.exr" --max relmse=1e-12 >"$work/compare.log" 2>&1 || fail "$1 is another picture: $(cat "$work/compare.log")"
}

# SLURM: ports that nobody uses, found by asking the system for them.
read -r port0 port1 port2 < <(python3 -c '
import socket
s = [socket.socket() for _ in range(3)]
for x in s: x.bind(("127.0.0.1", 0))
print(*(x.getsockname()[1] for x in s))')
mkdir "$work/state"
export SLURM_CONF=$work/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$port0
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdTimeout=5
KillWait=2
SchedulerParameters=sched_interval=1,sched_min_interval=100000
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd-%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd-%n.log
JobCompType=jobcomp/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
NodeName=n1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$port1 CPUs=1 RealMemory=100
NodeName=n2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$port2 CPUs=1 RealMemory=100
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld -D -f "$SLURM_CONF" >"$work/slurmctld.out" 2>&1 &
pids+=($!)
slurmd -D -N n1 -f "$SLURM_CONF" >"$work/n1.out" 2>&1 &
pids+=($!)
# The second node has processes of its own, which all die with its first one.
unshare --pid --fork --kill-child --mount-proc slurmd -D -N n2 -f "$SLURM_CONF" >"$work/n2.out" 2>&1 &
node2=$!
disown
idle() { [ "$(sinfo -h -t idle -o %D 2>/dev/null)" = 2 ]; }
wait_for 120 idle || { echo "SLURM does not start here: skipped" >&2; cat "$work"/*.out >&2; exit 77; }

jobs=$("$farm/slurm.sh" "$scene" "$work/slurm.exr" 4 "${options[@]}" --checkpoint-interval 0.1) || fail "submitting"
read -r _ slices merge <<<"$jobs"
# The power goes when the node has a checkpoint to lose no more than.
lost_slice() { lost=$(squeue -h -w n2 -j "$slices" -t R -o %K 2>/dev/null); [ -n "$lost" ] && [ -f "$work/slurm.exr.farm/checkpoints/$lost.exr" ]; }
wait_for 300 lost_slice || fail "no slice runs on the second node"
kill -9 "$node2" && node2=
echo "slice $lost is lost with its node"
waits_again() { squeue -h -j "${slices}_$lost" -t PD -o %K 2>/dev/null | grep -q .; }
wait_for 300 waits_again || fail "SLURM does not start the lost slice again"
scontrol update JobId="${slices}_$lost" StartTime=now  # it would wait two minutes
done_() { ! squeue -h -o %i | grep -q .; }
wait_for 900 done_ || fail "the jobs do not end: $(squeue)"
grep -q "^resumed .*checkpoints/$lost.exr" "$work/slurm.exr.farm/logs/slice-$lost.log" || fail "the lost slice began anew"
echo "and went on from its checkpoint"
[ -f "$work/slurm.exr" ] || fail "there is no picture (job $merge)"
same_picture "$work/slurm.exr"
echo "SLURM: the same picture"

# GNU parallel, one slice of which is killed at first.
kill_one() {
  wait_for 120 test -f "$work/parallel.exr.farm/checkpoints/2.exr" || return
  for process in $(pgrep -x twopass); do
    tr '\0' ' ' <"/proc/$process/cmdline" | grep -q "parallel.exr.farm/parts/2.exr" && kill -9 "$process" && echo "slice 2 is killed"
  done
}
kill_one &
PARALLEL_OPTIONS="--jobs 2" "$farm/parallel.sh" "$scene" "$work/parallel.exr" 3 "${options[@]}" --checkpoint-interval 0.1 >"$work/parallel.log" 2>&1 ||
  fail "parallel.sh: $(cat "$work/parallel.log")"
same_picture "$work/parallel.exr"
echo "parallel: the same picture"

# OpenCue: a module of the same name as its own takes the job and runs it, layer by layer.
mkdir -p "$work/python/outline/modules"
cat >"$work/python/outline/__init__.py" <<'PYTHON'
class Outline:
    def __init__(self, name, shot, show, user):
        self.layers = []

    def add_layer(self, layer):
        self.layers.append(layer)
PYTHON
touch "$work/python/outline/modules/__init__.py"
cat >"$work/python/outline/modules/shell.py" <<'PYTHON'
class Shell:
    def __init__(self, name, command, chunk, range):
        self.command, self.after, self.done = command, [], False
        self.first, self.last = map(int, range.split("-"))

    def depend_on(self, other):
        self.after.append(other)
PYTHON
cat >"$work/python/outline/cuerun.py" <<'PYTHON'
import subprocess


def launch(job, use_pycuerun):
    for layer in job.layers:
        assert all(other.done for other in layer.after)
        for frame in range(layer.first, layer.last + 1):
            subprocess.run([word.replace("#IFRAME#", str(frame)) for word in layer.command], check=True)
        layer.done = True
PYTHON
PYTHONPATH=$work/python "$farm/opencue.py" "$scene" "$work/opencue.exr" 2 "${options[@]}" >"$work/opencue.log" 2>&1 || fail "opencue.py: $(cat "$work/opencue.log")"
same_picture "$work/opencue.exr"
echo "OpenCue's job: the same picture"
