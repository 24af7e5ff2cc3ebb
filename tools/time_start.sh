#!/usr/bin/env bash
# Seconds from a start to a picture on disk: tools/time_start.sh PERTEV SCENE [RUNS [FLAG ...]]
# Whole processes of `pertev render SCENE`, 1920x1080, one sample a pixel, a PNG; the median, least and greatest of RUNS (14), after
# one that leaves the trees in the cache. FLAGs go to the command.
set -euo pipefail
pertev=$1 scene=$2 runs=${3:-14}
flags=("${@:4}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
render() {
    "$pertev" render "$scene" --size 1920x1080 --spp 1 -q "${flags[@]}" -o "$folder/picture.png" 2>"$folder/log" ||
        { cat "$folder/log" >&2 && exit 1; }
}
render
times=$(for ((i = 0; i < runs; ++i)); do
    from=${EPOCHREALTIME/[.,]/}
    render
    echo $((${EPOCHREALTIME/[.,]/} - from))
done)
sort -n <<<"$times" | awk '{ t[NR] = $1 / 1e6 } END { printf "%.3f s from a start to a picture (median of %d; %.3f to %.3f)\n",
    (t[int((NR + 1) / 2)] + t[int(NR / 2) + 1]) / 2, NR, t[1], t[NR] }'
