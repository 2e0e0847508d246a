#!/usr/bin/env bash
# Train under Slurm with Apptainer: sbatch docker/cluster/slurm.sh SCENE.toml SET/ [--random 200 ...]
#
# Submit it again, or several times at once: jobs share a set, and solve what is missing of it. FINGERFEM_IMAGE names the
# image (fingerfem.sif, made by docker/cluster/apptainer.def). Ranks exchange no messages, so any srun works, with PMIx or
# without; only --ranks-per-finger needs MPI between them: srun --mpi=pmix, and an Open MPI in the image that fits.
#SBATCH --job-name=fingerfem
#SBATCH --ntasks=64
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=2G
#SBATCH --time=04:00:00
#SBATCH --signal=TERM@30
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
[ $# -ge 2 ] || { echo "usage: sbatch $0 SCENE.toml SET/ [OPTIONS]" >&2; exit 2; }
image=${FINGERFEM_IMAGE:-fingerfem.sif}
[ -e "$image" ] || { echo "FINGERFEM_IMAGE must name an Apptainer image, got $image" >&2; exit 2; }
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# Compiled forms: on the node's own disk, where locks work.
export APPTAINERENV_XDG_CACHE_HOME=${SLURM_TMPDIR:-${TMPDIR:-/tmp}}/fingerfem-$(id -u)
# One rank that dies shall not end the others.
srun --kill-on-bad-exit=0 --wait=0 apptainer exec --bind "$PWD" --pwd "$PWD" "$image" \
    python3 -m fingerfem snapshots "$@" --progress plain
