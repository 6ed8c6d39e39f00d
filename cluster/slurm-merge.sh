#!/bin/sh
#SBATCH --job-name=study-merge
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --mem=4G
#SBATCH --time=00:30:00
#SBATCH --output=study-merge-%j.log
# Puts the parts of cluster/slurm-array.sh together. A part that is missing is in the log, with the command that makes it.
set -eu
exec sim-host merge "${OUT:-parts}"/*.parquet --out "${RESULTS:-results}"
