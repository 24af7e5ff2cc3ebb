#!/usr/bin/env bash
# Everything that touches device code, on a machine with a GPU, in one go:
#   tools/check_gpu.sh BIN SCENES [PART ...]
# BIN is the folder of pertev and pertev_tests (build/bin, or a bundle of tools/make_portable.sh), SCENES the folder of the
# public test scenes (docs/scenes.md), with those of tools/make_record_scenes.py, without which bench leaves out rays. Parts: tests,
# python, long, pictures, counters, sanitizers, stalls, references, bench, viewer; all without any. Exits 1 when something failed.
set -uo pipefail
bin=$1 scenes=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
parts=("$@")
[ ${#parts[@]} -gt 0 ] || parts=(tests python long pictures counters sanitizers stalls references bench viewer)
export PERTEV_SCENES=$scenes
status=0

run() {
    echo "--- $*"
    "$@" || { echo "FAILED: $*"; status=1; }
}

for part in "${parts[@]}"; do
    echo "=== $part"
    case $part in
    tests)
        files='*/consistency/*,*/seams/*,*/watertight_test.cpp,*/ray_sets_test.cpp,*/glowing_room_test.cpp,*/path_parts_test.cpp'
        files+=',*/light_leak_test.cpp,*/meter_exposure_test.cpp,*/session_test.cpp,*/emitter_faces_test.cpp,*/hidden_back_test.cpp'
        files+=',*/shadow_terminator_test.cpp,*/film_test.cpp,*/film_add_test.cpp,*/scene_on_device_test.cpp,*/predicted_bytes_test.cpp,*/queue_test.cpp,*/isolated_rays_test.cpp,*/device_builder_test.cpp,*/structure_on_device_test.cpp,*/viewer_frames_test.cpp,*/raster_test.cpp,*/reyes_test.cpp,*/subpaths_test.cpp,*/bidirectional_test.cpp,*/photon_map_test.cpp,*/irradiance_cache_test.cpp,*/irradiance_picture_test.cpp,*/frame_bias_test.cpp,*/motion_blur_test.cpp'
        files+=',*/cast_test.cpp,*/whitted_test.cpp,*/distributed_test.cpp,*/light_paths_test.cpp,*/thin_walls_test.cpp,*/order_hits_test.cpp,*/measure_irradiance_test.cpp,*/thesis_pictures_test.cpp,*/motion_vectors_test.cpp,*/restir_test.cpp'
        run "$bin/pertev_tests" --device cuda --source-file="$files"
        run python3 "$here/../tests/robust/cli_records_test.py" "$bin/pertev" --device cuda
        [ -z "${PERTEV_OIDN:-}" ] || run python3 "$here/../tests/robust/cli_oidn_test.py" "$bin/pertev" --device cuda
        ;;
    python) # the package of the build folder; a bundle has none
        if [ -d "$bin/../python/pertev" ]; then
            for test in cameras batches params arrays scene session parts overhead; do
                run env PYTHONPATH="$bin/../python" python3 "$here/../tests/python/${test}_test.py" "$bin/pertev" --device cuda
            done
        fi
        ;;
    long)
        files='*/device_functions_test.cpp,*/lab_test.cpp,*/lab_scenes_test.cpp,*/watertight_test.cpp'
        run "$bin/pertev_tests" --device cuda --long --source-file="$files"
        ;;
    pictures) run "$here/compare_devices.py" "$bin/pertev" "$scenes" 1 16 64 ;;
    counters)
        if command -v cuobjdump >/dev/null; then run "$here/check_warp_counters.py" "$bin/pertev"; else echo "no cuobjdump"; fi
        ;;
    sanitizers)
        for tool in memcheck racecheck initcheck synccheck; do
            run compute-sanitizer --tool "$tool" --error-exitcode 1 "$bin/pertev_tests" --device cuda \
                --test-case='the GPU gives the bytes*,pictures and frames of two wavefronts*,frames that split light after*,ray setup has the same bits*,BSDFs have the same bits*,light samples*,every distribution of rays to threads*,the active lanes*,each kind of ray can have*,two queues used*,a picture whose samples are split*,one*two and three devices render*,a device that fails in the middle*,batches by three devices*,a new camera and most*,a GPU builds the bytes*,frames of moving scenes*,a step in time uploads*,a frame with ReSTIR counts*,memory of a denoised render*,pictures of ray trees*,pictures of light subpaths*,hybrid has*kinds of surfaces*,rasterised pictures do not*,pictures of micropolygons do not*,pictures by photon mapping*,pictures by irradiance caching*,pictures of a radiosity*,layers do not depend*,pictures with motion blur*,layers of light paths with motion blur*,blur from camera motion*,every tracer finds the same hits*,a light tree gives the same bytes*,camera rays and shadow rays*,a film of a window has the bytes of that part of the*,two parts of a film stored*,a schedule defined by a test*,a film target defined by a test*'
        done
        ;;
    stalls) run python3 "$here/check_stalls.py" "$bin/pertev" ;;
    references)
        for script in images/bitterli_scenes images/mitsuba_tests images/bitterli_water_caustic images/mcguire_cornell_box statistical/sponza_energy; do
            run python3 "$here/../tests/$script.py" "$bin/pertev" --device cuda
        done
        ;;
    bench) run "$here/measure.py" "$bin/pertev" "$scenes" "$(mktemp -d)" record start ;;
    viewer) # nvJPEG is found in the bundle's lib/, too (the file libnvjpeg.so.13 of PyPI's nvidia-nvjpeg), or by LD_LIBRARY_PATH
        run python3 "$here/view_latency.py" "$bin/pertev" "$scenes/crytek-sponza/sponza.obj"
        run python3 "$here/view_latency.py" "$bin/pertev" "$scenes/crytek-sponza/sponza.obj" --size 3840x2160 --most 200
        ;;
    *) echo "no such part: $part" && status=1 ;;
    esac
done
[ $status -eq 0 ] && echo "all of: ${parts[*]} - passed"
exit $status
