#!/usr/bin/env bash
# Prints a line that names the public scenes (docs/scenes.md) that PERTEV_SCENES lacks, and the tests that are skipped
# without them, wholly or in part; nothing if no test lacks a scene.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

users=$(grep -rlE 'test_scene\(|job\.scene\(|environ\.get\("PERTEV_SCENES"' tests --include='*_test.cpp' --include='*.py')
missing=()
for folder in $(sed -n '/^\$PERTEV_SCENES/,/^```/s|^  \([a-z-]*\)/.*|\1|p' docs/scenes.md); do
    [[ -n ${PERTEV_SCENES:-} && -d $PERTEV_SCENES/$folder ]] || missing+=("$folder")
done
((${#missing[@]})) || exit 0
# shellcheck disable=SC2086 # file names without spaces
tests=$({ grep -lE "\"($(IFS='|'; echo "${missing[*]}"))[/\"]" $users || true; } |
    sed -E 's|^tests/||; s|(_test)?\.[a-z]+$||' | sort | paste -sd ' ')
[[ -n $tests ]] || exit 0
[[ -n ${PERTEV_SCENES:-} ]] && where="PERTEV_SCENES has no ${missing[*]}" || where="PERTEV_SCENES is not set"
echo "$where (docs/scenes.md); skipped in whole or in part: $tests"
