#!/usr/bin/env bash
# Sets up Pertev on Debian 12, Ubuntu 24.04 or newer: installs what is missing, configures and builds into ./build, and
# says what was found and what was left out. Run it again at any time; it does only what is still to do.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

usage() {
    cat <<'END'
usage: ./setup.sh [--cpu | --cuda | --check-kernels] [--lab] [--tests [--build-only]] [--no-apt] [--help]

  --cpu            build without CUDA
  --cuda           build with CUDA; where no nvcc is found, fetch one from PyPI into build/cuda (about 300 MB)
  --check-kernels  build without CUDA, but compile the kernels to see whether they compile (needs nvcc)
  --lab            build every traversal that `pertev lab` can compare, not only those that pictures use by default
  --tests          build the tests and the laboratory too and run the tests; the exit status is theirs
  --build-only     with --tests: run none of them
  --no-apt         install nothing; say what is missing

Without --cpu or --cuda, CUDA is used if there is a GPU's driver; nvcc is fetched if there is none. Kernels are compiled
for this machine's GPU.
END
}

readonly oldest_systems="Debian 12 or Ubuntu 24.04"
readonly build=build
cuda=auto lab=false tests=false run=true apt=true
for arg in "$@"; do
    case $arg in
        --cpu | --cuda | --check-kernels)
            [[ $cuda == auto ]] || { echo "setup.sh: --cpu, --cuda and --check-kernels exclude each other" >&2; exit 2; }
            cuda=$arg
            ;;
        --lab) lab=true ;;
        --tests) tests=true lab=true ;;
        --build-only) run=false ;;
        --no-apt) apt=false ;;
        -h | --help) usage; exit 0 ;;
        *) echo "setup.sh: unknown flag '$arg'" >&2; usage >&2; exit 2 ;;
    esac
done

step() { printf '== %s\n' "$*"; }
fail() { printf 'setup.sh: %s\n' "$*" >&2; exit 1; }

# at_least 3.25.1 3.25: is the first version not older than the second?
at_least() { [[ $(printf '%s\n%s\n' "$2" "$1" | sort -V | head -n 1) == "$2" ]]; }

# run_quietly LOG COMMAND...: output goes to LOG; on failure its end is shown.
run_quietly() {
    local log=$1
    shift
    if ! "$@" >"$log" 2>&1; then
        tail -n 60 "$log" >&2
        return 1
    fi
}

# ---- Packages ---------------------------------------------------------------------------------------------------

# Package, or package=command where any copy of that command will do.
packages=("cmake=cmake" "ninja-build=ninja" "g++=c++" "ccache=ccache" "pkg-config=pkg-config" libtbb-dev
    libopenexr-dev libimath-dev libpng-dev zlib1g-dev libjpeg-dev libsimdjson-dev libmeshoptimizer-dev libpugixml-dev
    libwebp-dev libdraco-dev
    libcli11-dev libfmt-dev libxxhash-dev libboost-dev)
installed_something=false

# missing_packages PACKAGE[=COMMAND]...: prints those that are not there.
missing_packages() {
    local entry names=() installed=""
    for entry in "$@"; do names+=("${entry%%=*}"); done
    if command -v dpkg-query >/dev/null; then
        # shellcheck disable=SC2016 # dpkg-query expands it
        installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${names[@]}" 2>/dev/null || true)
    fi
    for entry in "$@"; do
        grep -qxF "${entry%%=*} installed" <<<"$installed" && continue
        [[ $entry == *=* ]] && command -v "${entry#*=}" >/dev/null && continue
        echo "${entry%%=*}"
    done
}

# without_candidate PACKAGE...: prints those that apt could not install.
without_candidate() {
    local name known
    known=$(apt-cache policy "$@" 2>/dev/null |
        awk '/^[^ ]/ { name = $1; sub(/:$/, "", name) } $1 == "Candidate:" && $2 != "(none)" { print name }')
    for name in "$@"; do
        grep -qxF "$name" <<<"$known" || echo "$name"
    done
}

install_packages() {
    local missing unknown as_root=()
    mapfile -t missing < <(missing_packages "$@")
    ((${#missing[@]})) || return 0
    if ! $apt || ! command -v apt-get >/dev/null; then
        echo "Not installed, by their Debian names (nothing is installed $($apt && echo 'without apt-get' || echo \
            'with --no-apt')): ${missing[*]}"
        return 0
    fi
    if ((EUID != 0)); then
        command -v sudo >/dev/null || fail "neither root nor sudo, so these cannot be installed. As root, run:
  apt-get install --no-install-recommends ${missing[*]}"
        as_root=(sudo)
    fi
    as_root+=(env DEBIAN_FRONTEND=noninteractive)

    step "Installing ${missing[*]}"
    local log
    log=$(mktemp)
    mapfile -t unknown < <(without_candidate "${missing[@]}")
    local install=("${as_root[@]}" apt-get install -y -q --no-install-recommends -o DPkg::Lock::Timeout=600 "${missing[@]}")
    if ((${#unknown[@]})); then
        run_quietly "$log" "${as_root[@]}" apt-get update -q || fail "apt-get update failed"
        mapfile -t unknown < <(without_candidate "${missing[@]}")
        ((${#unknown[@]} == 0)) || fail "apt knows no package ${unknown[*]}. Pertev needs $oldest_systems or newer (on
Ubuntu with the component 'universe'); elsewhere install these libraries yourself and pass --no-apt."
        run_quietly "$log" "${install[@]}" || fail "apt-get install failed"
    elif ! "${install[@]}" >"$log" 2>&1; then # the package lists may be out of date
        run_quietly "$log" "${as_root[@]}" apt-get update -q || fail "apt-get update failed"
        run_quietly "$log" "${install[@]}" || fail "apt-get install failed"
    fi
    rm -f "$log"
    installed_something=true
}

check_tools() {
    [[ $(uname -m) == x86_64 ]] || fail "this is $(uname -m); Pertev is built for x86-64 with AVX2 and FMA"
    local tool
    for tool in cmake ninja "${CXX:-c++}"; do
        command -v "$tool" >/dev/null || fail "$tool is not installed"
    done
    local version
    version=$(cmake --version | head -n 1 | grep -oE '[0-9]+\.[0-9.]+')
    at_least "$version" 3.25 || fail "CMake $version is too old: 3.25 is needed ($oldest_systems has it)"
    if [[ $("${CXX:-c++}" --version) != *clang* ]]; then
        version=$("${CXX:-c++}" -dumpfullversion)
        at_least "$version" 12 || fail "g++ $version is too old: 12 is needed ($oldest_systems has it)"
    fi
    if ! grep -qw avx2 /proc/cpuinfo || ! grep -qw fma /proc/cpuinfo; then
        echo "Note: this processor has no AVX2 and FMA. Pertev will be built, but cannot run here."
    fi
}

# ---- CUDA -------------------------------------------------------------------------------------------------------

nvcc="" nvcc_release="" cuda_architectures=${CUDAARCHS:-90-real} cuda_note=""
driver="" gpu=""

find_driver() {
    if command -v nvidia-smi >/dev/null; then
        driver=$(nvidia-smi --query-gpu=driver_version --format=csv,noheader 2>/dev/null |
            grep -xE '[0-9]+(\.[0-9]+)+' | head -n 1 || true)
        gpu=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader 2>/dev/null |
            grep -xE '[0-9]+\.[0-9]+' | sort -uV || true)
    fi
    if [[ -z $driver && -r /proc/driver/nvidia/version ]]; then
        driver=$(grep -oE 'Module.* [0-9]+\.[0-9]+(\.[0-9]+)*' /proc/driver/nvidia/version | head -n 1 |
            grep -oE '[0-9]+\.[0-9.]+$' || true)
    fi
    # One architecture: this machine's GPU (all of them where they differ), or an H100 or H200; $CUDAARCHS overrules it.
    if [[ -n $gpu && -z ${CUDAARCHS:-} ]]; then
        cuda_architectures=$(tr -d . <<<"$gpu" | sed 's/$/-real/' | paste -sd ';')
    fi
}

# The driver runs CUDA 13 from 580 on; without a driver any release will do.
driver_runs() { [[ -z $driver ]] || at_least "$driver" 580 || ! at_least "$1" 13; }

# The first usable nvcc at the usual places, one that this driver can run before one that it cannot.
find_nvcc() {
    local candidate release fallback="" fallback_release=""
    local candidates=("${CUDACXX:-}" "$(command -v nvcc || true)" /usr/local/cuda/bin/nvcc)
    local others
    mapfile -t others < <(compgen -G '/usr/local/cuda-*/bin/nvcc' | sort -rV)
    for candidate in "${candidates[@]}" "${others[@]}" /opt/cuda/bin/nvcc "$PWD/$build/cuda/bin/nvcc"; do
        [[ -x $candidate ]] || continue
        release=$("$candidate" --version 2>/dev/null | sed -n 's/.*release \([0-9.]*\).*/\1/p')
        if ! at_least "${release:-0}" 12.3; then
            cuda_note="$candidate is release ${release:-unknown}, 12.3 is needed for C++20 and words of 128 bits"
        elif driver_runs "$release"; then
            nvcc=$candidate nvcc_release=$release
            return
        elif [[ -z $fallback ]]; then
            fallback=$candidate fallback_release=$release
        fi
    done
    if [[ -n $fallback ]]; then
        nvcc=$fallback nvcc_release=$fallback_release
        cuda_note="driver $driver is older than 580 and cannot run CUDA $nvcc_release"
    fi
}

# nvcc and what it needs from PyPI into build/cuda; one folder, laid out like a toolkit. Sets cuda_note on failure.
fetch_nvcc() {
    install_packages "python3=python3" python3-venv
    step "Fetching nvcc 13.0 from PyPI into $build/cuda"
    local temporary=$build/cuda.new toolkit
    rm -rf "$temporary" "$build/cuda"
    mkdir -p "$build"
    if ! run_quietly "$build/fetch_nvcc.log" python3 -m venv "$temporary"; then
        cuda_note="no nvcc found, and python3 -m venv failed (package python3-venv)"
        return 1
    fi
    if ! run_quietly "$build/fetch_nvcc.log" "$temporary/bin/pip" -qq install --disable-pip-version-check --no-deps \
        'nvidia-cuda-nvcc==13.0.*' 'nvidia-cuda-crt==13.0.*' 'nvidia-cuda-runtime==13.0.*' \
        'nvidia-cuda-cccl==13.0.*' 'nvidia-nvvm==13.0.*'; then
        cuda_note="no nvcc found, and it could not be fetched from PyPI"
        return 1
    fi
    toolkit=$(echo "$temporary"/lib/python3*/site-packages/nvidia/cu13)
    if [[ ! -x $toolkit/bin/nvcc ]]; then
        cuda_note="no nvcc found, and the packages from PyPI hold none"
        return 1
    fi
    ln -sfn lib "$toolkit/lib64" # where nvcc looks for the runtime library
    mv "$toolkit" "$build/cuda"
    rm -rf "$temporary"
}

# Does nvcc work with this g++? Each release knows compilers only up to some version.
nvcc_works() {
    local folder status=0
    folder=$(mktemp -d)
    echo '#include <cstdint>' >"$folder/probe.cu"
    "$nvcc" -std=c++20 -ccbin "${CXX:-c++}" -c "$folder/probe.cu" -o "$folder/probe.o" >"$folder/log" 2>&1 || status=1
    ((status == 0)) || cuda_note="nvcc $nvcc_release does not work with $("${CXX:-c++}" --version | head -n 1): \
$(grep -m 1 -i error "$folder/log" || head -n 1 "$folder/log")"
    rm -rf "$folder"
    return "$status"
}

choose_cuda() {
    if [[ $cuda == --cpu ]]; then
        cuda_note="--cpu"
        return
    fi
    find_driver
    if [[ $cuda == auto && -z $driver ]]; then
        cuda_note="there is no GPU's driver; ./setup.sh --cuda builds with CUDA nevertheless"
        return
    fi
    find_nvcc
    local no_fetch=""
    if [[ -n $driver ]] && ! at_least "$driver" 580; then
        # PyPI's packages of CUDA 12 hold no nvcc, only ptxas.
        no_fetch="driver $driver runs CUDA 12 at most, and PyPI has nvcc only from 13.0: install NVIDIA's \
toolkit 12.x or a driver from 580 on, then run ./setup.sh again"
    fi
    if [[ -z $nvcc && $cuda != --check-kernels ]]; then
        if [[ -n $no_fetch ]]; then
            [[ $cuda == auto ]] || fail "$no_fetch"
            cuda_note=$no_fetch
            return
        fi
        [[ $cuda == --cuda ]] || echo "Found a GPU's driver ($driver) but no nvcc: fetching one (--cpu does without)."
        if fetch_nvcc; then
            find_nvcc
        elif [[ $cuda == --cuda ]]; then
            fail "$cuda_note"
        fi
    fi
    if [[ -z $nvcc ]]; then
        cuda_note=${cuda_note:-"no nvcc found"}
        [[ $cuda != --check-kernels ]] || fail "$cuda_note, and --check-kernels needs one"
        return
    fi
    if [[ ! -e $build/setup.options || $(<"$build/setup.options") != *"CUDA_COMPILER=$nvcc "* ]] && ! nvcc_works; then
        [[ $cuda == auto ]] || fail "$cuda_note"
        nvcc=""
    fi
}

# ---- Python -----------------------------------------------------------------------------------------------------

# The tests hold the Python module too, where its tools are there or PyPI has them: nanobind and numpy, in a virtual
# environment in build/python-tools. Sets python, or python_note.
python="" python_note="./setup.sh --tests builds it for its tests; pip install . installs it"
find_python() {
    local tools=$build/python-tools
    local needs="import nanobind, numpy; assert tuple(map(int, nanobind.__version__.split('.')[:2])) >= (2, 4)"
    $tests || [[ -x $tools/bin/python ]] || return 0
    python_note="python3 has no headers, nanobind or numpy, and PyPI cannot be reached"
    if [[ ! -x $tools/bin/python ]] || ! "$tools/bin/python" -c "$needs" 2>/dev/null; then
        mkdir -p "$build"
        rm -rf "$tools"
        if ! { python3 -m venv --system-site-packages "$tools" &&
            { "$tools/bin/python" -c "$needs" ||
                "$tools/bin/pip" -q install --disable-pip-version-check --timeout 20 --retries 0 'nanobind>=2.4' numpy; }; } \
            >"$build/fetch_nanobind.log" 2>&1; then
            rm -rf "$tools"
            return
        fi
    fi
    "$tools/bin/python" -c 'import pathlib, sys, sysconfig
sys.exit(not (pathlib.Path(sysconfig.get_path("include")) / "Python.h").exists() or sys.version_info < (3, 11))' || return 0
    python=$PWD/$tools/bin/python
}

# ---- Configure and build ----------------------------------------------------------------------------------------

# had OPTION: did the last run configure with this option?
had() { [[ -e $build/setup.options ]] && grep -q "$1" "$build/setup.options"; }

configure() {
    local options=(-G Ninja -DCMAKE_BUILD_TYPE=Release -DPERTEV_UNITY=ON)
    if command -v ccache >/dev/null; then
        # Without these it would not keep what is compiled with precompiled headers.
        options+=("-DCMAKE_CXX_COMPILER_LAUNCHER=cmake;-E;env;CCACHE_SLOPPINESS=pch_defines,time_macros;ccache")
        [[ -z $nvcc ]] || options+=(-DCMAKE_CUDA_COMPILER_LAUNCHER=ccache)
    fi
    if [[ -n $nvcc ]]; then
        local mode=ON
        [[ $cuda != --check-kernels ]] || mode=CHECK
        options+=("-DPERTEV_CUDA=$mode" "-DCMAKE_CUDA_COMPILER=$nvcc" "-DCMAKE_CUDA_ARCHITECTURES=$cuda_architectures")
    else
        options+=(-DPERTEV_CUDA=OFF)
    fi
    # A build folder that has tests or the laboratory keeps them: a plain run does not throw work away.
    if $lab || had LAB_KERNELS=ON; then
        options+=(-DPERTEV_LAB_KERNELS=ON)
    else
        options+=(-DPERTEV_LAB_KERNELS=OFF)
    fi
    if $tests || had TESTS=ON; then
        options+=(-DPERTEV_TESTS=ON)
        find_python
        [[ -z $python ]] || options+=(-DPERTEV_PYTHON=ON "-DPython_EXECUTABLE=$python")
    else
        options+=(-DPERTEV_TESTS=OFF)
    fi
    local wanted="${options[*]} in $PWD with ${CXX:-c++}"
    if ! $installed_something && [[ -e $build/build.ninja && -e $build/setup.options &&
        $(<"$build/setup.options") == "$wanted" ]]; then
        return
    fi
    step "Configuring"
    mkdir -p "$build"
    rm -f "$build/setup.options"
    run_quietly "$build/configure.log" cmake --fresh -S . -B "$build" "${options[@]}" ||
        fail "CMake failed; the whole log is $build/configure.log"
    echo "$wanted" >"$build/setup.options"
}

compile() {
    local jobs memory_gb
    memory_gb=$(awk '/MemAvailable/ { print int($2 / 1048576) }' /proc/meminfo)
    jobs=$(nproc)
    ((jobs <= memory_gb * 2 / 5)) || jobs=$((memory_gb * 2 / 5)) # the largest files take 2.4 GB to compile
    ((jobs >= 1)) || jobs=1
    local targets=(pertev)
    ! $tests || targets=(all)
    step "Building"
    if [[ -t 1 ]]; then
        ninja -C "$build" -j "$jobs" "${targets[@]}" || fail "the build failed"
    else
        run_quietly "$build/build.log" ninja -C "$build" -j "$jobs" "${targets[@]}" ||
            fail "the build failed; the whole log is $build/build.log"
    fi
}

summary() {
    local name=pertev
    name=$("$build/bin/pertev" --version 2>/dev/null | head -n 1) || name=pertev
    echo
    echo "${name:-pertev} is built: $build/bin/pertev"
    echo "  compiler  $("${CXX:-c++}" --version | head -n 1)"
    if [[ $cuda == --check-kernels ]]; then
        echo "  CUDA      left out: --check-kernels; nvcc $nvcc_release ($nvcc) has compiled the kernels"
    elif [[ -n $nvcc ]]; then
        echo "  CUDA      on: nvcc $nvcc_release ($nvcc), architectures $cuda_architectures"
        if [[ -n $cuda_note ]]; then
            echo "            but $cuda_note"
        elif [[ -z $driver ]]; then
            echo "            but no GPU's driver is here: pictures are rendered on the CPU"
        fi
    else
        echo "  CUDA      left out: $cuda_note"
    fi
    if ! grep -q 'PERTEV_LAB_KERNELS:BOOL=ON' "$build/CMakeCache.txt"; then
        echo "  lab       has only the traversals of pictures: ./setup.sh --lab builds all"
    fi
    if ! grep -q 'PERTEV_TESTS:BOOL=ON' "$build/CMakeCache.txt"; then
        echo "  tests     left out: ./setup.sh --tests builds and runs them"
        echo "  Embree    left out: only the tests compare with it"
    elif grep -qE '^embree_DIR:PATH=/' "$build/CMakeCache.txt"; then
        echo "  Embree    found: tests compare hits with it"
    else
        echo "  Embree    left out: libembree-dev is not installed; the tests that compare with it are not built"
    fi
    if [[ -n $python ]] && $tests; then
        echo "  Python    module built in $build/python"
    else
        echo "  Python    left out: $python_note"
    fi
}

! $tests || packages+=(doctest-dev libembree-dev "git=git" "python3=python3" "python3-dev=python3-config" python3-venv)
install_packages "${packages[@]}"
check_tools
choose_cuda
configure
compile
summary

if $tests && $run; then
    echo
    tools/missing_scenes.sh
    ctest --test-dir "$build" --output-on-failure -j 3 # some of them wait
fi
