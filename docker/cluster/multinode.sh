#!/usr/bin/env bash
# Train on several machines that share this folder, by plain mpirun: docker/cluster/multinode.sh HOSTFILE SCENE.toml SET/ [OPTIONS]
#
# HOSTFILE as mpirun takes it: one line "host slots=8" a machine. Each has the same DOLFINx (Debian 13, conda) and this
# checkout at the same path. A rank that dies leaves its line to the others; run it again and only what is missing is solved.
set -euo pipefail
[ $# -ge 3 ] || { echo "usage: $0 HOSTFILE SCENE.toml SET/ [OPTIONS]" >&2; exit 2; }
hosts=$1; shift
[ -e "$hosts" ] || { echo "HOSTFILE must be a file, got $hosts" >&2; exit 2; }
exec mpirun --hostfile "$hosts" --enable-recovery --bind-to core -x OMP_NUM_THREADS=1 -x OPENBLAS_NUM_THREADS=1 \
    python3 -m fingerfem snapshots "$@" --progress plain
