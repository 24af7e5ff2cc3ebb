#!/usr/bin/env bash
# Gathers programs of a build folder with every library they load (but the C library's own) into one folder that runs
# on another machine, whose libraries may be fewer or older: tools/make_portable.sh build OUT pertev pertev_tests ...
# An OUT that ends with .tar.gz is that folder as an archive.
# Licences go with them: ours, docs/notices.md, and those of the libraries' Debian packages. Needs patchelf.
set -euo pipefail
build=$1 out=$2
shift 2
archive=
if [[ $out == *.tar.gz ]]; then
    archive=$out
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    out=$work/$(basename "$archive" .tar.gz)
fi
mkdir -p "$out/bin" "$out/lib" "$out/licences"
root=$(cd "$(dirname "$0")/.." && pwd)
source "$root/tools/bundled_libraries.sh"
cp "$root/LICENSE" "$root/docs/notices.md" "$out/licences/"
for program in "$@"; do
    cp "$build/bin/$program" "$out/bin/"
    strip "$out/bin/$program"
    mapfile -t libraries < <(libraries_of "$build/bin/$program")
    cp -Ln "${libraries[@]}" "$out/lib/"
    copy_licences "$out/licences" "${libraries[@]}"
    patchelf --set-rpath '$ORIGIN/../lib' --force-rpath "$out/bin/$program"
done
for library in "$out"/lib/*; do patchelf --set-rpath '$ORIGIN' "$library"; done
[[ -z $archive ]] || tar -C "$(dirname "$out")" -czf "$archive" "$(basename "$out")"
du -sh "${archive:-$out}" | cut -f1
