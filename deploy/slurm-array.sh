#!/usr/bin/env bash
# One data set by a Slurm array: no service, only a folder that all nodes see.
#   d3dgen dataset snapshot --out .                 once, on any machine
#   sbatch --array=0-63 deploy/slurm-array.sh wards.toml snapshot-0123456789abcdef.json.gz /scratch/wards
#   d3dgen dataset merge /scratch/wards/part-* --out wards
# A task that was preempted or ran out of time is submitted again with the same number: it goes on where it stopped.
#SBATCH --cpus-per-task=8
#SBATCH --mem-per-cpu=1G
#SBATCH --time=08:00:00
#SBATCH --requeue
set -eu
spec=$1 snapshot=$2 out=$3
exec d3dgen dataset make "$spec" --snapshot "$snapshot" \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --threads "$SLURM_CPUS_PER_TASK" \
    --out "$out/part-$SLURM_ARRAY_TASK_ID"
