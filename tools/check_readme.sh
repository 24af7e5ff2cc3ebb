#!/usr/bin/env bash
# Runs the two commands of README.md, section "Start", as a stranger would, in a clone of this checkout's HEAD in bare systems
# of Debian 12 and Debian 13, which have certificates and no more: tools/check_readme.sh [--report MEASUREMENT.json] PROGRAM [ROOTS].
# PROGRAM is a build of the same sources, whose picture theirs must be. ROOTS (build/bare-roots) keeps the systems, each with what
# the commands have installed, and the logs. A folder CCACHE_DIR is shared with them, under the same path as the clone's, which is
# this checkout's. SUITES names other systems. Needs root, debootstrap and the network; takes the time of two builds and two runs of the tests.
set -euo pipefail
command="tools/check_readme.sh $*" report=
[[ ${1:-} != --report ]] || { report=$(realpath -m "$2"); shift 2; }
here=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
program=$(realpath "$1") roots=$(realpath -m "${2:-$here/build/bare-roots}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# The section's blocks that begin with ./setup.sh.
mapfile -t commands < <(sed -n '/^## Start/,/^## Use/p' "$here/README.md" | awk '/^```/ { inside = !inside; next } inside && /^\.\/setup\.sh/')
[[ ${#commands[@]} == 2 && ${commands[0]} == *render* && ${commands[1]} == *--tests* ]] || { echo "README.md has other commands"; exit 1; }

in_root() { # ROOT COMMAND: with /proc, /dev, this machine's names, certificates and compiler cache
    unshare -m bash -c 'root=$1; shift
        mount -t proc proc "$root/proc" && mount --rbind /dev "$root/dev" &&
        for kept in /etc/hosts /etc/resolv.conf /etc/ssl/certs ${CCACHE_DIR:-}; do
            [[ -d $kept ]] && mkdir -p "$root$kept" || : >>"$root$kept"
            mount --bind "$kept" "$root$kept" || exit
        done &&
        exec chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin PIP_DISABLE_PIP_VERSION_CHECK=1 \
            ${PIP_CERT:+PIP_CERT=$PIP_CERT} ${CCACHE_DIR:+CCACHE_DIR=$CCACHE_DIR} bash -euc "$1"' _ "$@"
}
seconds_of() { # COMMAND...: runs it and prints how long it took
    local start=${EPOCHREALTIME/[^0-9]/}
    "$@" && awk "BEGIN { printf \"%.0f\", (${EPOCHREALTIME/[^0-9]/} - $start) / 1e6 }"
}

printf 'system=system\tcommit=commit\tfirst_s=first command=s\ttests_s=second command=s\ttests=tests\n' >"$work/rows"
hash_of() { grep -oE '\b[0-9a-f]{32}\b' "$1" | tail -1; }
"$program" render cornell-box -o "$work/cornell-box.png" >"$work/first.log" 2>&1
hash=$(hash_of "$work/first.log")
[[ -n $hash ]] || { echo "$program prints no hash"; exit 1; }
for suite in ${SUITES:-bookworm trixie}; do
    root=$roots/$suite clone=$roots/$suite$here
    [[ -e $root.made ]] || { mkdir -p "$roots"; debootstrap --variant=minbase --include=ca-certificates "$suite" "$root" >"$root.log" && touch "$root.made"; }
    rm -rf "$clone" && git clone -q "$here" "$clone"
    first=$(seconds_of in_root "$root" "cd '$here'; ${commands[0]}" 2>&1 | tee "$root.first.log" | tail -1)
    [[ -s $clone/cornell-box.png && $(hash_of "$root.first.log") == "$hash" ]] || { echo "the picture on $suite is not $hash"; exit 1; }
    tests=$(seconds_of in_root "$root" "cd '$here'; ${commands[1]}" 2>&1 | tee "$root.tests.log" | tail -1)
    passed=$(sed -n 's/.*tests passed, 0 tests failed out of \([0-9]*\).*/\1/p' "$root.tests.log")
    [[ -n $passed ]] || { tail -40 "$root.tests.log"; exit 1; }
    printf '%s\t' "Debian $(cut -d. -f1 "$root/etc/debian_version")" "$(git -C "$clone" rev-parse --short=12 HEAD)" "$first" "$tests" >>"$work/rows"
    echo "$passed" >>"$work/rows"
    tail -1 "$work/rows"
done
[[ -z $report ]] || python3 "$here/tools/measurement.py" "$report" "$program" "README's commands in bare systems" "$command" <"$work/rows"
