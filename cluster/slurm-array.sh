#!/bin/sh
#SBATCH --job-name=study
#SBATCH --array=1-8
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --mem=2G
#SBATCH --time=04:00:00
#SBATCH --output=study-%A-%a.log
# A study in parts, one for each task of the array; sim-host has to be in PATH on the nodes.
#   job=$(sbatch --parsable cluster/slurm-array.sh faults --runs 100000 --seed 7)
#   sbatch --dependency=afterany:"$job" cluster/slurm-merge.sh
# Another number of parts: PARTS=32 sbatch --array=1-32 cluster/slurm-array.sh ...
# One of them again:       sbatch --array=3 cluster/slurm-array.sh ... with the same arguments
set -eu
parts=${PARTS:-8}
part=${SLURM_ARRAY_TASK_ID:?this is a task of an array: sbatch --array=1-$parts}
if [ "${SLURM_ARRAY_TASK_MAX:-$part}" -gt "$parts" ]; then
    echo "tasks up to $SLURM_ARRAY_TASK_MAX of $parts parts: set PARTS" >&2
    exit 2
fi
export RAYON_NUM_THREADS="${SLURM_CPUS_PER_TASK:-1}"
exec sim-host "$@" --shard "$part/$parts" --out "${OUT:-parts}"
