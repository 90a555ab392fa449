#!/bin/bash
# Meshes a network on a Slurm cluster: an array of shards, then one job that joins them.
#
#   submit.sh SHARDS WORK_DIR NETWORK MESH [more options of `anastomesh mesh`]
#
# WORK_DIR lies on a file system that all nodes share, with locks that hold on all of them. What Slurm is to give each job is
# said by SBATCH_OPTIONS ("--time=2:00:00 --partition=long --constraint=milan").
set -euo pipefail
[ $# -ge 4 ] || { sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 2; }
shards=$1 work=$2 network=$3 mesh=$4
shift 4
here=$(dirname "$(readlink -f "$0")")
read -ra given <<<"${SBATCH_OPTIONS:-}"
command=(mesh "$network" -o "$mesh" --work-dir "$work" "$@")

array=$(sbatch --parsable "${given[@]}" --array="1-$shards" "$here/shard.sbatch" "$shards" "${command[@]}")
last=$(sbatch --parsable "${given[@]}" --dependency="afterok:${array%%;*}" --kill-on-invalid-dep=yes \
    "$here/join.sbatch" "${command[@]}")
echo "shards: ${array%%;*}, joined by: ${last%%;*}"
