#!/usr/bin/env bash
# The variance of ten scenes, of the low-discrepancy sampler and of independent samples, as a table in Markdown:
#   tools/measure_noise.sh PERTEV SCENES [FLAG ...]
# SCENES is a folder laid out as docs/scenes.md says; further flags go to pertev bench noise (--device cuda, --spp 16).
# relMSE is the mean of variance / (mean^2 + 0.01) over pixels and channels, from eight pictures of different seeds.
# Views and the sky are written out, so that figures of different versions are of the same pictures: they are those that
# Pertev made up in November 2026 where a file has none. The lamps of Sibenik, a closed room, are still made up.
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

python3 "$here/make_sky.py" "$work/sky.exr" || exit 1
sky="--environment $work/sky.exr"

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
bunny $scenes/stanford/bunny.obj $sky --eye 0.13355729,0.22500323,0.21722342 --target -0.016840503,0.110154,-0.0015369952 --fov 40 --size 640x360 --spp 64
helmet-in-Venice $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --environment $scenes/envmaps/venice_sunset_1k.hdr --eye 1.9249593,1.4718745,2.6163955 --target -0.0024815798,1.04904175e-05,-0.18715477 --fov 40 --size 640x360 --spp 64
SheenChair $scenes/gltf/SheenChair/SheenChair.gltf $sky --eye 0.81768495,0.9680354,1.1988487 --target -0.00074338913,0.34305376,0.008407712 --fov 40 --size 640x360 --spp 64
NegativeScaleTest $scenes/gltf/NegativeScaleTest/NegativeScaleTest.glb $sky --eye 8.518875,6.5053225,12.39109 --target 0,0,0 --fov 40 --size 640x360 --spp 64
cornell-box,-direct-light cornell-box --integrator direct --eye 0.278,0.273,-0.8 --target 0.278,0.273,0.2 --fov 39.3076439 --size 1024x1024 --spp 64
Bitterli's-Cornell-box $work/bitterli.gltf --max-depth 64 --filter tent --filter-radius 1 --eye 0,1,6.8 --target 0,1,5.8 --fov 19.5 --size 1024x1024 --spp 16
veach-mis $work/veach-mis.obj $veach --size 1280x720 --spp 64 --keep 98
Sponza $scenes/crytek-sponza/sponza.obj $sky --eye -117.42479,19.796486,-3.8689995 --target 125.72853,36.979717,-3.8689995 --fov 65 --size 640x360 --spp 64
Sibenik $scenes/sibenik/sibenik.obj --eye -16.533972,-11.015999,0 --target 19.1635,-7.343999,0 --fov 65 --size 640x360 --spp 64
CornellBox-Glass $scenes/cornell-box-mcguire/CornellBox-Glass.obj --eye -0.00999999,0.995,4.0681486 --target -0.00999999,0.995,-0.025 --fov 40 --size 480x480 --spp 64
LIST
exit $status
