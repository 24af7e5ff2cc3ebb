#!/usr/bin/env bash
# The variance of ten scenes, of the low-discrepancy sampler and of independent samples, as a table in Markdown:
#   tools/measure_noise.sh PERTEV SCENES [FLAG ...]
# SCENES is a folder laid out as docs/scenes.md says; further flags go to pertev bench noise (--device cuda, --spp 16).
# relMSE is the mean of variance / (mean^2 + 0.01) over pixels and channels, from eight pictures of different seeds.
set -uo pipefail
pertev=$1 scenes=$2
shift 2
flags=("$@")
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

veach="--eye 28.2792,3.5,0 --target 0,3.5,0 --fov 20.11 --max-depth 1"
if [ ! -e "$scenes/bitterli/veach-mis/scene_mitsuba3.xml" ] ||
    ! python3 "$here/make_veach_mis.py" "$scenes/bitterli/veach-mis/scene_mitsuba3.xml" "$work/veach-mis.obj"; then
    echo "veach-mis is left out: bitterli/veach-mis/scene_mitsuba3.xml is not there" >&2
fi
if [ ! -e "$scenes/bitterli/cornell-box/scene_mitsuba3.xml" ] ||
    ! python3 "$here/../tests/images/mitsuba_to_gltf.py" "$scenes/bitterli/cornell-box/scene_mitsuba3.xml" >"$work/bitterli.gltf"; then
    echo "Bitterli's Cornell box is left out: bitterli/cornell-box/scene_mitsuba3.xml is not there" >&2
fi

echo "| scene | size | spp | relMSE | independent | times less | s a picture | 1 / (relMSE s) | independent |"
echo "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
while read -r name file arguments; do
    [ -e "$file" ] || [ "$file" = cornell-box ] || continue
    # shellcheck disable=SC2086 # the arguments are words
    "$pertev" bench noise "$file" $arguments --json "${flags[@]}" >"$work/out" 2>"$work/err" || {
        echo "$name: $(cat "$work/out" "$work/err")" >&2
        status=1
    }
    python3 - "$name" "$work/out" <<'PYTHON'
import json
import sys

for line in open(sys.argv[2], encoding="utf-8"):
    d = json.loads(line)
    if d.get("event") != "noise":
        continue
    kept = "" if d["keep_percent"] == 100 else f", best {d['keep_percent']:g} %"
    print(f"| {sys.argv[1]}{kept} | {d['width']}x{d['height']} | {d['samples']} | {d['rel_mse']:.2e} | "
          f"{d['rel_mse_independent']:.2e} | {d['ratio']:.2f} | {d['seconds']:.4f} | {d['efficiency']:.3g} | "
          f"{d['efficiency_independent']:.3g} |", flush=True)
PYTHON
done <<LIST
bunny $scenes/stanford/bunny.obj --size 640x360 --spp 64
helmet-in-Venice $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --environment $scenes/envmaps/venice_sunset_1k.hdr --size 640x360 --spp 64
SheenChair $scenes/gltf/SheenChair/SheenChair.gltf --size 640x360 --spp 64
NegativeScaleTest $scenes/gltf/NegativeScaleTest/NegativeScaleTest.glb --size 640x360 --spp 64
cornell-box,-direct-light cornell-box --integrator direct --size 1024x1024 --spp 64
Bitterli's-Cornell-box $work/bitterli.gltf --max-depth 64 --filter tent --filter-radius 1 --size 1024x1024 --spp 16
veach-mis $work/veach-mis.obj $veach --size 1280x720 --spp 64 --keep 98
Sponza $scenes/crytek-sponza/sponza.obj --size 640x360 --spp 64
Sibenik $scenes/sibenik/sibenik.obj --size 640x360 --spp 64
CornellBox-Glass $scenes/cornell-box-mcguire/CornellBox-Glass.obj --size 480x480 --spp 64
LIST
exit $status
