# For scripts that bring libraries along (source it): which ones a program loads, and their licences.

# libraries_of FILE...: prints the files of the libraries that these load, except those of the C library.
libraries_of() {
    ldd "$@" | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' |
        grep -vE '/(libc|libm|libdl|libpthread|librt|ld-linux[^/]*)\.so' | sort -u
}

# copy_licences FOLDER FILE...: copies what Debian records of the packages that these files are of, and of the one whose
# headers are compiled into ours (the licence of Boost, which is the other, asks it of sources alone).
copy_licences() {
    local folder=$1 file package
    shift
    for file in "$@" /usr/include/CLI/CLI.hpp; do
        package=$(dpkg -S "*/$(basename "$(readlink -f "$file")")" 2>/dev/null | cut -d: -f1 | head -1) || true
        [[ ! -f /usr/share/doc/$package/copyright ]] || cp "/usr/share/doc/$package/copyright" "$folder/$package"
    done
}
