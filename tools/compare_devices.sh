#!/usr/bin/env bash
# Renders scenes on the CPU and in CUDA and compares the hashes of the pictures, of their layers and of the denoised pictures:
# tools/compare_devices.sh PERTEV SCENES [SPP ...]. SCENES is a folder laid out as docs/scenes.md says. Then sequences, and
# frames of moving pictures, reconstructed. Exits 1 when a picture differs.
set -uo pipefail
pertev=$1 scenes=$2
shift 2
counts=("${@:-4}")
status=0

hashes_in() { # event; prints the hashes of the picture and, if there are any, of its layers and of the denoised picture
    sed -n 's/.*"event":"'"$1"'".*"hash":"\([0-9a-f]*\)","layers_hash":\([^,]*\),"denoised_hash":\([^,]*\),.*/\1 \2 \3/p' |
        sed 's/ null//g; s/"//g; s/ /+/g'
}
hash_of() { # spp, device, scene and its flags
    local spp=$1 device=$2
    shift 2
    "$pertev" render "$@" --device "$device" --spp "$spp" --size 640x360 -o "$work/$device.exr" --json 2>&1 | hashes_in done
}
sequence_of() { # device, scene and its flags; prints a hash of the frames' hashes, all of which must exist
    local device=$1 frames
    shift
    frames=$("$pertev" render "$@" --device "$device" --frames 0-3 --size 320x180 -o "$work/$device-#.exr" --json 2>&1 | hashes_in frame)
    [ "$(wc -l <<<"$frames")" = 4 ] && md5sum <<<"$frames" | cut -c1-32
}

# Prints the hash of the 31st frame of a sequence in docs/real_time.md.
frame_of() { # device, scene and its flags
    local device=$1
    shift
    "$pertev" bench sequence "$@" --device "$device" --size 320x240 -q --json 2>&1 |
        sed -n 's/.*"last_frame":"\([0-9a-f]*\)".*/\1/p'
}
# Prints all results of measuring light at a point, to the last digit.
light_at() { "$pertev" measure "$@" --json -q 2>&1 | grep '"event":"measure"' | sed 's/"seconds":[0-9.e+-]*//; s/"device":"[^"]*"//'; }

verdict_of() { # result of the CPU, result of CUDA; sets verdict
    verdict=same
    [ -n "$1" ] && [ "$1" = "$2" ] || { verdict=DIFFERENT; status=1; }
}
each_row() { # quantity, and the command that prints it for a device and a row; rows with a name and arguments on stdin
    local what=$1 name arguments cpu cuda
    shift
    while read -r name arguments; do
        # shellcheck disable=SC2086 # the arguments are words
        cpu=$("$@" cpu $arguments) cuda=$("$@" cuda $arguments)
        verdict_of "$cpu" "$cuda"
        printf '%-16s %s  cpu %s  cuda %s  %s\n' "$name" "$what" "${cpu:-failed}" "${cuda:-failed}" "$verdict"
    done
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
here=$(cd "$(dirname "$0")" && pwd)
python3 "$here/make_moving_box.py" "$work/box.gltf"
python3 "$here/make_moving_box.py" "$work/mirror_box.gltf" --mirror
for spp in "${counts[@]}"; do
    each_row "$(printf '%5s spp' "$spp")" hash_of "$spp" <<LIST
cornell-box cornell-box
sponza $scenes/crytek-sponza/sponza.obj
sibenik $scenes/sibenik/sibenik.obj
helmet $scenes/gltf/DamagedHelmet/DamagedHelmet.glb
glass $scenes/cornell-box-mcguire/CornellBox-Glass.obj
mirror $scenes/cornell-box-mcguire/CornellBox-Mirror.obj
water $scenes/cornell-box-mcguire/CornellBox-Water.obj
direct $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --integrator direct
indirect $scenes/sibenik/sibenik.obj --integrator indirect
irradiance $scenes/sibenik/sibenik.obj --false-color illuminance
cast $scenes/sibenik/sibenik.obj --integrator cast
whitted $scenes/cornell-box-mcguire/CornellBox-Glass.obj --integrator whitted --ambient 0.5
whitted-lamps $scenes/cornell-box-mcguire/CornellBox-Mirror.obj --integrator whitted --environment 0.3,0.4,0.5
distributed $scenes/cornell-box-mcguire/CornellBox-Glass.obj --integrator distributed
distributed-lens $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --integrator distributed --aperture 0.05
hybrid $scenes/crytek-sponza/sponza.obj --integrator hybrid
raster $scenes/crytek-sponza/sponza.obj --integrator raster --ambient 0.5
raster-gouraud $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --integrator raster --shading gouraud
wireframe $scenes/sibenik/sibenik.obj --integrator raster --wireframe --ambient 1
reyes $scenes/sibenik/sibenik.obj --integrator reyes --ambient 0.5
reyes-fine $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --integrator reyes --shading-rate 0.5
reyes-displaced $scenes/crytek-sponza/sponza.obj --integrator reyes --ambient 0.5 --displacement bricks=$scenes/crytek-sponza/textures/bricks.jpg,0.05,0.5
light $scenes/cornell-box-mcguire/CornellBox-Glass.obj --integrator light
light-lens $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --integrator light --aperture 0.05
bidirectional $scenes/cornell-box-mcguire/CornellBox-Water.obj --integrator bidirectional
photon_map $scenes/cornell-box-mcguire/CornellBox-Water.obj --integrator photon_map
photon_map-direct $scenes/cornell-box-mcguire/CornellBox-Glass.obj --integrator photon_map --gather direct --nearest 50
photon_map-sky $scenes/crytek-sponza/sponza.obj --integrator photon_map --max-depth 6
photon_map-crowded caustic --integrator photon_map --max-depth 8
irradiance_cache cornell-box --integrator irradiance_cache
irradiance_cache-mirror $scenes/cornell-box-mcguire/CornellBox-Mirror.obj --integrator irradiance_cache --accuracy 0.5
irradiance_cache-records $scenes/sibenik/sibenik.obj --integrator irradiance_cache --show-records --max-depth 6
radiosity $scenes/cornell-box-mcguire/CornellBox-Mirror.obj --integrator radiosity --patch-size 0.3 --patch-rays 32
radiosity-flat $scenes/sibenik/sibenik.obj --integrator radiosity --flat-patches --patch-rays 16 --subdivisions 0
bidirectional-sky $scenes/crytek-sponza/sponza.obj --integrator bidirectional --max-depth 6
denoised cornell-box --denoise svgf
denoised-layers $scenes/crytek-sponza/sponza.obj --denoise svgf --aov albedo,normal
layers $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --lpe seen=LE --lpe diffuse=L.*DE --lpe glossy=L.*[GS]E
blurred $work/box.gltf --time 1 --shutter 0.2
blurred-distributed $work/box.gltf --time 1 --shutter=-0.1,0.1 --integrator distributed
blurred-layers $work/box.gltf --time 1 --shutter 0.2 --lpe seen=LE --lpe others=L.+E
blurred-camera $scenes/sibenik/sibenik.obj --camera-path $here/../bench/sequences/sibenik_turn.json --time 0.5 --shutter 0.1
blurred-depth $scenes/sibenik/sibenik.obj --camera-path $here/../bench/sequences/sibenik_turn.json --time 0.5 --shutter 0.1 --aov depth
blurred-direct $scenes/sibenik/sibenik.obj --integrator direct --camera-path $here/../bench/sequences/sibenik_turn.json --time 0.5 --shutter 0.1
blurred-indirect $scenes/sibenik/sibenik.obj --integrator indirect --camera-path $here/../bench/sequences/sibenik_turn.json --time 0.5 --shutter 0.1
blurred-whitted $work/mirror_box.gltf --time 1 --shutter 0.2 --integrator whitted --ambient 0.5
blurred-cast $scenes/sibenik/sibenik.obj --integrator cast --camera-path $here/../bench/sequences/sibenik_turn.json --time 0.5 --shutter 0.1
LIST
done

for scene in cornell-box "$scenes/sibenik/sibenik.obj"; do
    place=(--at 0.278,0,0.28 --normal 0,1,0)
    cpu=$(light_at "$scene" "${place[@]}" --device cpu) cuda=$(light_at "$scene" "${place[@]}" --device cuda)
    verdict_of "$cpu" "$cuda"
    printf '%-16s measured at a place  %s  %s\n' "$(basename "$scene")" "$(md5sum <<<"$cpu" | cut -c1-8)" "$verdict"
done

# Four frames of each sequence, with all that a file holds of them.
each_row "frames 0-3" sequence_of <<LIST
sequence-layers $work/box.gltf --fps 4 --spp 4 --lpe seen=LE --lpe others=L.+E --aov motion
sequence-denoised $work/box.gltf --fps 4 --spp 4 --denoise svgf
sequence-real-time $work/box.gltf --fps 4 --real-time --aov albedo,depth
LIST

each_row "frame 30" frame_of <<LIST
sponza-flight $scenes/crytek-sponza/sponza.obj --camera-path $here/../bench/sequences/sponza_flight.json --frames 0-30
sibenik-turn $scenes/sibenik/sibenik.obj --camera-path $here/../bench/sequences/sibenik_turn.json --frames 0-30
helmet-turn $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --turntable 120 --frames 0-30
box-moving $work/box.gltf --frames 0-30
sponza-di $scenes/crytek-sponza/sponza.obj --camera-path $here/../bench/sequences/sponza_flight.json --frames 0-30 --restir di
box-gi $work/box.gltf --frames 0-30 --restir gi
helmet-gi $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --turntable 120 --frames 0-30 --restir gi
sibenik-scaled $scenes/sibenik/sibenik.obj --camera-path $here/../bench/sequences/sibenik_turn.json --frames 0-30 --resolution-scale 0.5
helmet-scaled $scenes/gltf/DamagedHelmet/DamagedHelmet.glb --turntable 120 --frames 0-30 --resolution-scale 0.5 --restir di
LIST
exit $status
