#!/usr/bin/env bash
# Prepares and samples a list of meshes as an array of Slurm: each task takes every Nth mesh of the list.
#
#   sbatch --array=0-63 deploy/batch/slurm.sh /data/meshes.txt /scratch/points -n 50000 --format drc
#
# What follows the list and the folder goes to `curvecast batch` as it is (see curvecast batch --help). A task that is killed,
# preempted or out of time goes on where it was when it is started again; only meshes that are missing or have changed are made.
# An array of some of the tasks alone has to say how many shards there are:
#
#   SHARDS=64 sbatch --array=3,17 deploy/batch/slurm.sh /data/meshes.txt /scratch/points -n 50000 --format drc
#
# At the end /scratch/points/index-*-of-64.jsonl say what became of each mesh. Statuses: 0 all are made; 3 some meshes failed, and
# the index says why; 4 the disk or the machine failed: start the task again; 130 stopped before its end, as by Slurm.
#
# $CURVECAST: the command, where it is not in the path.
#
#SBATCH --job-name=curvecast
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --time=04:00:00
#SBATCH --requeue
# A minute before the end of the time the command is told to stop, and takes leave of the mesh that it is at.
#SBATCH --signal=B:TERM@60
#SBATCH --output=curvecast-%A-%a.log
set -euo pipefail

if (($# < 2)); then
  echo "Usage: sbatch --array=0-(N-1) slurm.sh LIST FOLDER [OPTION of curvecast batch]..." >&2
  exit 2
fi
list=$1
folder=$2
shift 2

# Of what the task may have, the command leaves some to the libraries. Large blocks beyond that lie in a file in $TMPDIR.
limits=()
[[ -z ${SLURM_CPUS_PER_TASK-} ]] || limits+=(--threads "$SLURM_CPUS_PER_TASK")
[[ -z ${SLURM_MEM_PER_NODE-} ]] || limits+=(--memory "$((SLURM_MEM_PER_NODE * 7 / 10))MB")
[[ -z ${SHARDS-} ]] || limits+=(--shards "$SHARDS")

# exec: so that Slurm's signals reach the command.
exec "${CURVECAST:-curvecast}" batch "$list" --out "$folder" --shard auto "${limits[@]}" "$@"
