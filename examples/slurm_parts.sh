#!/usr/bin/env bash
#SBATCH --job-name=pertev
#SBATCH --array=1-4
#SBATCH --requeue
#SBATCH --signal=B:TERM@60
#SBATCH --open-mode=append
# Renders a picture in as many parts as the array has tasks; any first number will do:
#
#   sbatch --array=0-3 examples/slurm_parts.sh scene.glb folder --spp 4096
#   sbatch --dependency=afterok:JOB --wrap 'pertev merge folder/part.*.pvf -o picture.exr'
#
# Slurm says when a task's time ends or its node is taken: the task then keeps its samples in a checkpoint and is queued
# again, and goes on from there. To repeat one task alone, PARTS and PART_BASE have the numbers of the whole array:
#
#   PARTS=4 PART_BASE=0 sbatch --array=2 examples/slurm_parts.sh scene.glb folder --spp 4096
set -uo pipefail

if (($# < 2)); then
    echo "usage: sbatch --array=A-B slurm_parts.sh SCENE FOLDER [FLAG]..." >&2
    exit 2
fi
scene=$1 folder=$2
shift 2
task=$SLURM_ARRAY_TASK_ID parts=${PARTS:-$SLURM_ARRAY_TASK_COUNT} base=${PART_BASE:-$SLURM_ARRAY_TASK_MIN}
if [[ -z ${PARTS:-} ]] && ((SLURM_ARRAY_TASK_MAX - SLURM_ARRAY_TASK_MIN + 1 != parts)); then
    echo "the array's numbers have gaps; PARTS and PART_BASE are needed" >&2
    exit 2
fi
mkdir -p "$folder" || exit 6

"${PERTEV:-pertev}" render "$scene" -o "$folder/part.$task.pvf" --part "$task/$parts" --part-base "$base" \
    --checkpoint "$folder/checkpoint.$task.pvf" "$@" &
render=$!
trap 'kill -TERM $render' TERM
wait $render
status=$?
while kill -0 $render 2>/dev/null; do # the signal ended the waiting alone
    wait $render
    status=$?
done
if ((status == 75)); then # interrupted, and resumable
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$task"
elif ((status == 0)); then
    rm -f "$folder/checkpoint.$task.pvf" "$folder/checkpoint.$task.pvf.previous"
fi
exit $status
