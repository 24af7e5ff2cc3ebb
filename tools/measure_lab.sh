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
    "$bin/pertev" lab -q "$@" --device "$device" -o "$out/$name" || { echo "FAILED: $name"; status=1; }
}
record=(--rays record --count "$count" --no-heat-maps)

for part in "${parts[@]}"; do
    case $part in
    thesis) lab thesis --thesis --depths 1-8 --size 1024x768 ;;
    sponza) lab sponza sponza "${record[@]}" --rta on,nodes ;;
    sibenik) lab sibenik "$scenes/sibenik/sibenik.obj" "${record[@]}" --rta on,nodes ;;
    dragon) lab dragon "$scenes/stanford/dragon_res2.ply" "${record[@]}" --rta on,nodes ;;
    forest) lab forest forest "${record[@]}" --rta on,nodes ;;
    switches) lab switches sponza "${record[@]}" --structures sbvh,kd-sah,octree --rta both,nodes --order both --tests exact,fast ;;
    peers)
        for scene in sponza bunny forest; do
            lab "peers-$scene" $scene "${record[@]}" --structures binned,sbvh --rta on,nodes --order both --tests exact,fast,woop \
                --walks while-while,speculative,wide8,compressed --runs 25
        done
        ;;
    profile)
        command -v ncu >/dev/null || { echo "--- profile: ncu is not installed"; continue; }
        stalls=(long_scoreboard short_scoreboard lg_throttle math_pipe_throttle not_selected wait no_instruction
            branch_resolving dispatch_stall selected)
        metrics=smsp__issue_active.avg.pct_of_peak_sustained_active,smsp__inst_executed.sum
        metrics+=,smsp__thread_inst_executed_per_inst_executed.ratio,sm__warps_active.avg.pct_of_peak_sustained_active
        metrics+=,sm__inst_executed_pipe_alu.avg.pct_of_peak_sustained_active,gpu__time_duration.sum
        metrics+=,l1tex__t_sector_hit_rate.pct,l1tex__throughput.avg.pct_of_peak_sustained_elapsed
        metrics+=,lts__t_sector_hit_rate.pct,lts__throughput.avg.pct_of_peak_sustained_elapsed
        metrics+=,dram__throughput.avg.pct_of_peak_sustained_elapsed
        for stall in "${stalls[@]}"; do
            metrics+=,smsp__average_warps_issue_stalled_${stall}_per_issue_active.ratio
        done
        for job in compressed:CompressedWalk:on compressed:CompressedWalk:nodes speculative:SpeculativeWalk:on \
            while-while:WhileWhileWalk:on packet:WarpPacketWalk:on; do
            IFS=: read -r walk kernel rta <<<"$job"
            # Five launches a set (one checked, three to warm up, one timed): the last one of each is looked at.
            ncu --csv --page raw --clock-control none --kernel-name-base demangled --metrics "$metrics" \
                --kernel-id "::regex:(TraceRays<|run_dynamic_fetch<).*$kernel:5|10|15|20" \
                "$bin/pertev" lab sponza "${record[@]}" --structures sbvh --walks "$walk" --rta "$rta" --runs 1 \
                --device cuda -q >"$out/profile-$walk-rta-$rta.csv" || status=1
        done
        ;;
    *) echo "no such part: $part" && status=1 ;;
    esac
done
exit $status
