#!/usr/bin/env bash
# The laboratory's figures of docs/lab.md, on a machine with a GPU or without:
#   tools/measure_lab.sh BIN SCENES OUT [--device cpu|cuda] [--count RAYS] [PART ...]
# BIN is the folder of pertev, SCENES that of the public scenes (docs/scenes.md), OUT a folder for the reports, one a part.
# Parts: thesis sponza sibenik dragon forest (the whole matrix with RTA), switches (RTA, order and tests on and off), peers
# (what public tracers were timed on, with their tests and with ours), profile (counters by ncu, where that is installed).
set -uo pipefail
bin=$1 scenes=$2 out=$3
shift 3
device=cuda count=8294400 parts=()
while [ $# -gt 0 ]; do
    case $1 in
    --device) device=$2 && shift ;;
    --count) count=$2 && shift ;;
    *) parts+=("$1") ;;
    esac
    shift
done
[ ${#parts[@]} -gt 0 ] || parts=(thesis sponza sibenik dragon forest switches peers profile)
export PERTEV_SCENES=$scenes
status=0

lab() { # name, arguments
    local name=$1
    shift
    echo "--- $name"
    "$bin/pertev" lab "$@" --device "$device" -o "$out/$name" || { echo "FAILED: $name"; status=1; }
}
record=(--rays record --count "$count" --no-heat-maps)

for part in "${parts[@]}"; do
    case $part in
    thesis) lab thesis --thesis --depths 1-8 --size 1024x768 ;;
    sponza) lab sponza sponza "${record[@]}" --rta on ;;
    sibenik) lab sibenik "$scenes/sibenik/sibenik.obj" "${record[@]}" --rta on ;;
    dragon) lab dragon "$scenes/stanford/dragon_res2.ply" "${record[@]}" --rta on ;;
    forest) lab forest forest "${record[@]}" --rta on ;;
    switches) lab switches sponza "${record[@]}" --structures sbvh,kd-sah,octree --rta both --order both --tests both ;;
    peers)
        for scene in sponza bunny forest; do
            lab "peers-$scene" $scene "${record[@]}" --structures binned,sbvh --rta on --order both --tests both \
                --walks while-while,speculative,wide8,compressed --runs 25
        done
        ;;
    profile)
        command -v ncu >/dev/null || { echo "--- profile: ncu is not installed"; continue; }
        for pair in while-while:WhileWhileWalk speculative:SpeculativeWalk packet:WarpPacketWalk \
            compressed:CompressedWalk; do
            walk=${pair%:*}
            # Five launches a set (one checked, three to warm up, one timed), five sets, each way of handing out rays.
            ncu --csv --clock-control none --kernel-name-base demangled --launch-count 75 \
                --kernel-name "regex:(TraceRays<|run_dynamic_fetch<).*${pair#*:}" \
                --section SpeedOfLight --section Occupancy --section WarpStateStats --section MemoryWorkloadAnalysis --section SchedulerStats \
                "$bin/pertev" lab sponza "${record[@]}" --structures sbvh --walks "$walk" --rta on --runs 1 \
                --device cuda -q >"$out/profile-$walk.csv" || status=1
        done
        ;;
    *) echo "no such part: $part" && status=1 ;;
    esac
done
exit $status
