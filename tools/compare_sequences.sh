#!/usr/bin/env bash
# The table "Beside another denoiser" of docs/real_time.md: four moving pictures and four still ones, frames against Open Image
# Denoise (tools/denoise_by_oidn.py), scored against pictures of many samples; strips of the moving ones.
#   tools/compare_sequences.sh BIN SCENES OUT OIDN_PROGRAM [moving|still] [OIDN_OPTION ...]
# BIN is the folder of pertev, SCENES that of the public test scenes (docs/scenes.md). The samples go to a temporary folder: 2 GB a
# moving sequence. SIZE, SPP (of the references) and DEVICE may be set in the environment.
set -uo pipefail
bin=$1 scenes=$2 out=$3 oidn=$4 part=${5:-moving}
shift $(($# < 5 ? $# : 5))
here=$(cd "$(dirname "$0")" && pwd)
size=${SIZE:-1280x720} spp=${SPP:-512} device=${DEVICE:-cuda}
samples=$(mktemp -d)
trap 'rm -rf "$samples"' EXIT
mkdir -p "$out"
python3 "$here/make_moving_box.py" "$samples/box.gltf"

# score NAME ARGUMENT...: renders, denoises and scores one sequence.
score() {
    local name=$1 folder=$samples/$1
    shift
    mkdir -p "$folder" "$out/$name"
    "$bin/pertev" bench sequence "$@" --size "$size" --device "$device" --write-samples "$folder" -q >/dev/null &&
        python3 "$here/denoise_by_oidn.py" "$folder" "$oidn" "${oidn_options[@]}" >/dev/null &&
        "$bin/pertev" bench sequence "$@" --size "$size" --device "$device" --reference "$spp" --peer "$folder" \
            --strips "$out/$name" -q --json >"$out/$name.json" || echo "$name: failed" >&2
    rm -rf "$folder"
}
oidn_options=("$@")

sponza=$scenes/crytek-sponza/sponza.obj sibenik=$scenes/sibenik/sibenik.obj
helmet=$scenes/gltf/DamagedHelmet/DamagedHelmet.glb paths=$here/../bench/sequences
if [[ $part == moving ]]; then
    (
        score sponza "$sponza" --camera-path "$paths/sponza_flight.json" --frames 0-59
        score helmet "$helmet" --turntable 120 --frames 0-59
    ) &
    score box "$samples/box.gltf" --frames 0-59
    score sibenik "$sibenik" --camera-path "$paths/sibenik_turn.json" --frames 0-59
else
    # A camera that stands: its first view, for thirty frames.
    first_view() {
        python3 -c 'import json, sys
key = json.load(open(sys.argv[1]))["keys"][0]
print("--eye=" + ",".join(map(str, key["eye"])), "--target=" + ",".join(map(str, key["target"])))' "$1"
    }
    # shellcheck disable=SC2046 # two words
    (
        score sponza-still "$sponza" $(first_view "$paths/sponza_flight.json") --frames 0-29
        score helmet-still "$helmet" --frames 0-29
    ) &
    score box-still cornell-box --frames 0-29
    # shellcheck disable=SC2046
    score sibenik-still "$sibenik" $(first_view "$paths/sibenik_turn.json") --frames 0-29
fi
wait
cat "$out"/*.json
