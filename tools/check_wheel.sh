#!/usr/bin/env bash
# Checks wheels as a stranger meets them, in bare systems of Debian 12 (Python 3.11) and Debian 13 (Python 3.13) that
# have python3-venv and no more: tools/check_wheel.sh [--report MEASUREMENT.json] WHEELS PROGRAM [ROOTS]. The folder WHEELS
# is that of tools/make_wheel.sh; PROGRAM is a build of the same sources, whose picture theirs must be. ROOTS (build/roots)
# keeps the systems. The report has sizes and times. Needs root, debootstrap and the network.
set -euo pipefail
command="tools/check_wheel.sh $*" report=
[[ ${1:-} != --report ]] || { report=$(realpath -m "$2"); shift 2; }
measurement=$(realpath "$(dirname "${BASH_SOURCE[0]}")/measurement.py")
wheels=$(realpath "$1") program=$(realpath "$2") roots=$(realpath -m "${3:-build/roots}")
picture=(cornell-box --size 64x48 --spp 4 --seed 3 --device cpu)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
hash_of() { sed -n 's/.*"hash":"\([0-9a-f]\{32\}\)".*/\1/p' | tail -1; }
hash=$("$program" render "${picture[@]}" --json -o "$work/a.png" | hash_of)
[[ -n $hash ]]

cat >"$work/check.py" <<'END'
import subprocess, sys, time, urllib.request
start = time.perf_counter()
import pertev
seconds = time.perf_counter() - start
assert seconds < 0.3, f"import pertev took {seconds} s"
assert "libcuda" not in open("/proc/self/maps").read(), "import pertev loads CUDA's driver"
picture = pertev.render("cornell-box", size=(64, 48), spp=4, seed=3, device="cpu")
assert picture.hash == sys.argv[1], f"the picture is {picture.hash}"
with pertev.view("cornell-box", device="cpu", size=(64, 48)) as viewer:
    assert b"<html" in urllib.request.urlopen(viewer.url, timeout=20).read().lower()
try:
    pertev.render("cornell-box", size=(64, 48), spp=4, seed=3, device="cpu", denoise="oidn")
    raise SystemExit("Open Image Denoise was found before it was installed")
except pertev.Error as error:
    assert "pyoidn" in str(error), error
print(f"import {1000 * seconds:.0f} ms")
END
cat >"$work/denoised.py" <<'END'
import sys
import pertev
picture = pertev.render("cornell-box", size=(64, 48), spp=4, seed=3, device="cpu", denoise="oidn")
assert picture.hash == sys.argv[1] and (picture.color != picture.noisy).any()
END

in_root() { # ROOT COMMAND: with /proc, /dev, this machine's names and certificates
    unshare -m bash -c 'root=$1; shift
        mount -t proc proc "$root/proc" && mount --rbind /dev "$root/dev" && mount --bind "$wheels" "$root/mnt" &&
        for kept in /etc/resolv.conf /etc/ssl/certs; do mount --bind "$kept" "$root$kept"; done &&
        exec chroot "$root" env -i HOME=/root PATH=/usr/bin:/bin PIP_DISABLE_PIP_VERSION_CHECK=1 ${PIP_CERT:+PIP_CERT=$PIP_CERT} bash -euc "$1"' _ "$@"
}
export wheels

printf 'wheel=wheel\tsystem=system\tcommit=commit\tfile_mb=file=MB\tinstalled_mb=installed=MB\tnumpy_mb=with NumPy=MB\tinstall_s=installing=s\timport_ms=import=ms\n' >"$work/rows"
megabytes() { du -sb --total "$@" | tail -1 | awk '{ printf "%.1f", $1 / 1e6 }'; }
checked=0
for suite in bookworm trixie; do
    root=$roots/$suite
    [[ -e $root.made ]] || { debootstrap --variant=minbase --include=python3,python3-venv,ca-certificates "$suite" "$root" \
        >"$work/log" && touch "$root.made" "$root/etc/resolv.conf"; }
    cp "$work"/*.py "$root/tmp"
    [[ $suite == bookworm ]] && tag=cp311 || tag=abi3
    for wheel in "$wheels"/pertev-*"$tag"*.whl; do # with CUDA and without; by their names, because pip would take the former
        name=/mnt/$(basename "$wheel")
        rm -rf "$root/tmp/v"
        start=${EPOCHREALTIME/[^0-9]/}
        in_root "$root" "python3 -m venv /tmp/v && /tmp/v/bin/pip -q install '$name'"
        seconds=$(awk "BEGIN { print (${EPOCHREALTIME/[^0-9]/} - $start) / 1e6 }")
        packages=$(echo "$root"/tmp/v/lib/python3*/site-packages)
        import=$(in_root "$root" "cd /tmp; v/bin/python check.py $hash")
        [[ $wheel == *+cu* ]] && kind="with CUDA" || kind="for the CPU"
        [[ $tag == cp311 ]] && kind="$kind, Python 3.11" || kind="$kind, Python 3.12 and later"
        version=$(in_root "$root" "/tmp/v/bin/pertev --version" | sed -n '1s/.*(\(.*\))/\1/p')
        printf '%s\t' "$kind" "Debian $(cut -d. -f1 "$root/etc/debian_version")" "$version" "$(megabytes "$wheel")" \
            "$(megabytes "$packages"/pertev*)" "$(megabytes "$packages"/{pertev,numpy}*)" "$(printf %.0f "$seconds")" >>"$work/rows"
        echo "${import//[^0-9]/}" >>"$work/rows"
        tail -1 "$work/rows"
        [[ $(in_root "$root" "cd /tmp; v/bin/pertev render ${picture[*]} --json -o a.png" | hash_of) == "$hash" ]]
        in_root "$root" "cd /tmp; v/bin/pip -q install '${name}[oidn]' && v/bin/python denoised.py $hash"
        checked=$((checked + 1))
    done
done
[[ -z $report ]] || python3 "$measurement" "$report" "$program" "Wheels in bare systems, which give this program's picture" "$command" <"$work/rows"
echo "$checked wheels of $wheels give the picture $hash"
