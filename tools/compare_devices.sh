#!/usr/bin/env bash
# Renders scenes on the CPU and in CUDA and compares the hashes of the pictures: tools/compare_devices.sh PERTEV SCENES
# [SPP ...]. SCENES is a folder laid out as docs/scenes.md says. Exits 1 when a picture differs.
set -uo pipefail
pertev=$1 scenes=$2
shift 2
counts=("${@:-4}")
status=0

hash_of() { # device, spp, scene and its flags
    local device=$1 spp=$2
    shift 2
    "$pertev" render "$@" --device "$device" --spp "$spp" --size 640x360 -o "$work/$device.exr" --json 2>&1 |
        sed -n 's/.*"event":"done".*"hash":"\([0-9a-f]*\)".*/\1/p'
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for spp in "${counts[@]}"; do
    while read -r name arguments; do
        # shellcheck disable=SC2086 # the arguments are words
        cpu=$(hash_of cpu "$spp" $arguments) cuda=$(hash_of cuda "$spp" $arguments)
        verdict=same
        [ -n "$cpu" ] && [ "$cpu" = "$cuda" ] || { verdict=DIFFERENT; status=1; }
        printf '%-16s %5s spp  cpu %s  cuda %s  %s\n' "$name" "$spp" "${cpu:-failed}" "${cuda:-failed}" "$verdict"
    done <<LIST
cornell-box cornell-box
sponza $scenes/crytek-sponza/sponza.obj
sibenik $scenes/sibenik/sibenik.obj
helmet $scenes/gltf/DamagedHelmet/DamagedHelmet.glb
glass $scenes/cornell-box-mcguire/CornellBox-Glass.obj
mirror $scenes/cornell-box-mcguire/CornellBox-Mirror.obj
water $scenes/cornell-box-mcguire/CornellBox-Water.obj
cast $scenes/sibenik/sibenik.obj --integrator cast
whitted $scenes/cornell-box-mcguire/CornellBox-Glass.obj --integrator whitted --ambient 0.5
whitted-lamps $scenes/sibenik/sibenik.obj --integrator whitted
distributed $scenes/cornell-box-mcguire/CornellBox-Glass.obj --integrator distributed
distributed-lens $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --integrator distributed --aperture 0.05
LIST
done
exit $status
