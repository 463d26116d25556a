#!/usr/bin/env bash
#SBATCH --job-name=glowworm
#SBATCH --nodes=4
#SBATCH --ntasks-per-node=1
#SBATCH --cpus-per-task=16
#SBATCH --mem=32G
#SBATCH --time=02:00:00
#SBATCH --signal=TERM@60
#SBATCH --requeue
# Bakes one cloud that memory does not hold on several machines of a cluster, by Slurm and Open MPI.
#
#   sbatch slurm_bake.sh CLOUD.ply OUTPUT.ply [option of glowworm bake]...
#
# One process a machine, which share the points; CLOUD.ply and OUTPUT.ply lie where all machines
# see them, on a file system where several may write one file at a time, such as Lustre. What is
# done when the time is over, or a machine fails, is kept beside OUTPUT.ply: submit the same again,
# and it goes on. Where Slurm has no PMIx, put mpirun in the place of srun --mpi=pmix. Copy this
# script and put in your own lamps.
set -eu
GLOWWORM=${GLOWWORM:-glowworm}
cloud=$1
output=$2
shift 2

# A part of a machine's memory, so that the first process, which bakes, always finds it; the same
# each time, since it says how many points are baked. With all points in memory nothing is shared.
srun --mpi=pmix "$GLOWWORM" bake "$cloud" --memory "${BAKE_MEMORY:-8G}" \
	-j "${SLURM_CPUS_PER_TASK:-1}" --resume --light 'sky radiance 1' "$@" -o "$output"
