#!/usr/bin/env bash
# Runs the fuzz targets of tests/fuzz under libFuzzer, with AddressSanitizer and UndefinedBehaviorSanitizer:
#     tools/fuzz.sh [SECONDS [TARGET...]]
# SECONDS (60) for each target in turn; without names all of them. Needs clang-16 (or CLANG=clang++-17). Inputs that reach new code
# are kept in build-fuzz/corpus/TARGET, and the next run begins with them and with tests/fuzz/corpus. An input that fails is left as
# build-fuzz/crash-TARGET-HASH: mend the reader and copy the input to tests/fuzz/corpus/TARGET, which CTest reads.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit

seconds=${1:-60}
shift || true
compiler=${CLANG:-clang++-16}
jobs=${PERTEV_JOBS:-$(nproc)}
readers=(pbrt mitsuba serialized gltf obj ply stl ies cube cameras camera_path exr png jpeg hdr)
sessions=(film history settings)
targets=("$@")
((${#targets[@]})) || targets=("${readers[@]}" "${sessions[@]}")

program_of() {
    case " ${readers[*]} " in *" $1 "*) echo readers && return ;; esac
    case " ${sessions[*]} " in *" $1 "*) echo sessions && return ;; esac
    echo "tools/fuzz.sh: no target is named '$1' (${readers[*]} ${sessions[*]})" >&2
    return 2
}

programs=()
for target in "${targets[@]}"; do
    program=$(program_of "$target") || exit 2
    [[ " ${programs[*]} " == *" libfuzzer_$program fuzz_$program "* ]] || programs+=("libfuzzer_$program" "fuzz_$program")
done
if ! command -v "$compiler" >/dev/null; then
    echo "tools/fuzz.sh: $compiler is not installed (apt-get install clang-16)" >&2
    exit 2
fi
launcher=()
! command -v ccache >/dev/null || launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
cmake -S . -B build-fuzz -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS_RELEASE=-O1 \
    -DPERTEV_CUDA=OFF -DPERTEV_TESTS=ON -DPERTEV_SANITIZE=address,undefined,float-cast-overflow,fuzzer-no-link "${launcher[@]}" \
    >build-fuzz.log 2>&1 && cmake --build build-fuzz -j "$jobs" --target "${programs[@]}" >>build-fuzz.log 2>&1 ||
    { tail -30 build-fuzz.log >&2; exit 1; }
mv build-fuzz.log build-fuzz/build.log

failed=()
for target in "${targets[@]}"; do
    program=$(program_of "$target")
    mkdir -p "build-fuzz/corpus/$target" && "build-fuzz/bin/fuzz_$program" "$target" --seeds "build-fuzz/corpus/$target" || exit 1
    log=build-fuzz/$target.log
    corpora=("build-fuzz/corpus/$target")
    [[ ! -d tests/fuzz/corpus/$target ]] || corpora+=("tests/fuzz/corpus/$target")
    PERTEV_FUZZ_TARGET=$target "build-fuzz/bin/libfuzzer_$program" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=3072 \
        -print_final_stats=1 -artifact_prefix="build-fuzz/crash-$target-" "${corpora[@]}" \
        >"$log" 2>&1 || failed+=("$target")
    printf '%-12s %s inputs, %s kept, coverage %s%s\n' "$target" \
        "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" "$(find "build-fuzz/corpus/$target" -type f | wc -l)" \
        "$(sed -n 's/.* cov: \([0-9]*\).*/\1/p' "$log" | tail -1)" \
        "$(sed -n 's/.*Test unit written to /; failed on /p' "$log")"
done
((${#failed[@]} == 0)) && exit
echo "failed: ${failed[*]} (build-fuzz/TARGET.log)"
exit 1
