#!/bin/sh
# ctest: long, waits, nightly
# dea sweep --slurm against a real munged, slurmctld and slurmd on this computer, with all processes
# of the node killed in the middle. Skipped where Slurm is not installed, or not by root. Many designs
# of the membrane, as docs/verification/sweep.md has them: DEA_SLURM_MODEL=3d DEA_SLURM_SAMPLES=2000.
set -eu
export PATH="$PATH:/usr/sbin:/sbin"
for program in munged slurmctld slurmd sbatch scontrol; do
  command -v $program >/dev/null || { echo "$program is not installed: skipped"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "the daemons of Slurm need root here: skipped"; exit 77; }
folder=$(mktemp -d "${TMPDIR:-/tmp}/dea-slurm.XXXXXX")
host=$(hostname -s)
stop() { # NAME...: the daemons of this folder
  for name; do
    [ ! -s "$folder/$name.pid" ] || kill -9 "$(cat "$folder/$name.pid")" 2>/dev/null || :
    rm -f "$folder/$name.pid"
  done
}
trap 'stop slurmd slurmctld munged; rm -rf "$folder"' EXIT
trap 'exit 143' INT TERM # dash does not leave by the line above otherwise
chmod 755 "$folder"
mkdir "$folder/state" "$folder/spool"
head -c 1024 /dev/urandom >"$folder/key"
chmod 600 "$folder/key"
cat >"$folder/slurm.conf" <<EOF
ClusterName=dea
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.sock
CredType=cred/munge
SlurmctldPort=$((20000 + $$ % 20000))
SlurmdPort=$((40000 + $$ % 20000))
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
SlurmdTimeout=5
SchedulerParameters=sched_interval=1,requeue_delay=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP MaxTime=INFINITE
EOF
export SLURM_CONF="$folder/slurm.conf"
munged --force --socket="$folder/munge.sock" --key-file="$folder/key" \
  --pid-file="$folder/munged.pid" --log-file="$folder/munged.log" --seed-file="$folder/seed" ||
  { echo "munged does not start here: skipped"; exit 77; }
if ! slurmctld -c || ! slurmd -c; then
  echo "Slurm does not start here: skipped"
  exit 77
fi
for _ in $(seq 30); do
  [ "$(sinfo -h -o %T 2>/dev/null)" != idle ] || break
  sleep 1
done
[ "$(sinfo -h -o %T)" = idle ] || { echo "Slurm does not run here: skipped"; exit 77; }

cd "$folder"
samples=${DEA_SLURM_SAMPLES:-400}
model=${DEA_SLURM_MODEL:-lumped}
design=frdea-4.yaml
[ "$model" != 3d ] || design=explore/fibres-3d.yaml
cat >many.yaml <<EOF
dea_explore: 1
name: many
design: $1/examples/$design
model: $model
voltages: [2 kV, 4 kV]
quantities: [electrode_edge_u_m]
plan: sobol
samples: $samples
variables:
  - {name: film.thickness, low: 90 um, high: 110 um}
  - {name: pre_stretch, low: 1.45, high: 1.55}
EOF
# shellcheck disable=SC2086 # several words, or none
"$DEA_COMMAND" sweep many.yaml -o out --slurm 4
for _ in $(seq $((60 + samples))); do # until some of it is done
  [ "$(cat out/part-* 2>/dev/null | wc -l)" -lt $((samples / 20)) ] || break
  sleep 0.2
done
done_before=$(cat out/part-* | wc -l)
# the node fails: its daemon, the steps and what they run
stop slurmd
for process in /proc/[0-9]*; do
  if { tr '\0' ' ' <"$process/cmdline"; } 2>/dev/null | grep -qE "^slurmstepd: |sweep many.yaml.* -o out "; then
    if grep -qF "$folder" "$process/environ" 2>/dev/null; then
      kill -9 "${process#/proc/}" 2>/dev/null || :
    fi
  fi
done
sleep 7 # SlurmdTimeout
slurmd -c
for _ in $(seq $((240 + 5 * samples))); do
  [ ! -f out/cases.csv ] || [ -n "$(squeue -h)" ] || break
  sleep 0.5
done
rows=$(tail -n +2 out/cases.csv | wc -l)
twice=$(cat out/part-* | grep -v '^#' | grep . | cut -d, -f1 | sort | uniq -d | wc -l)
echo "done before the node failed: $done_before; in the table: $rows; twice: $twice"
echo "parts $(cat out/part-* | wc -c) bytes, $(find out -name 'part-*' | wc -l) files;" \
  "cases.csv $(wc -c <out/cases.csv), cases.h5 $(wc -c <out/cases.h5) bytes;" \
  "with a reason: $(tail -n +2 out/cases.csv | awk -F, '$NF != ""' | wc -l)"
if [ "$rows" -ne "$samples" ] || [ "$twice" -ne 0 ]; then
  squeue || :
  sinfo || :
  tail -n 20 slurmctld.log slurmd.log
  exit 1
fi
