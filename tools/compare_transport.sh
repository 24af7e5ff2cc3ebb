#!/usr/bin/env bash
# Bidirectional path tracing against path tracing at equal time, as a table in Markdown:
#   tools/compare_transport.sh PERTEV [FLAG ...]
# Further flags go to pertev bench noise (--device cuda, --size 640x480, --spp 64). relMSE is the mean of variance /
# (mean^2 + 0.01) over pixels and channels, from eight pictures of different seeds. Variance falls as one over the time, so
# the ratio at equal time is that of relMSE times seconds: over 1, bidirectional is the better one. cornell-box stands for
# ordinary light.
set -uo pipefail
pertev=$1
shift
flags=("$@")
scenes=$(cd "$(dirname "$0")/../scenes/transport" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

echo "| scene | path: relMSE | s a picture | bidirectional: relMSE | s a picture | variance ratio at equal time |"
echo "| --- | ---: | ---: | ---: | ---: | ---: |"
while read -r name file arguments; do
    rm -f "$work"/*.json
    for integrator in path bidirectional; do
        # shellcheck disable=SC2086 # the arguments are words
        "$pertev" bench noise "$file" $arguments --max-depth 8 --json "${flags[@]}" --integrator $integrator \
            >"$work/$integrator.json" 2>"$work/err" || {
            echo "$name, $integrator: $(cat "$work/$integrator.json" "$work/err")" >&2
            status=1
        }
    done
    python3 - "$name" "$work/path.json" "$work/bidirectional.json" <<'PYTHON'
import json
import sys

found = []
for path in sys.argv[2:]:
    for line in open(path, encoding="utf-8"):
        d = json.loads(line)
        if d.get("event") == "noise":
            found.append((d["rel_mse"], d["seconds"]))
if len(found) == 2:
    (path, path_s), (both, both_s) = found
    print(f"| {sys.argv[1]} | {path:.2e} | {path_s:.3f} | {both:.2e} | {both_s:.3f} | "
          f"{path * path_s / (both * both_s):.2f} |", flush=True)
PYTHON
done <<LIST
blind $scenes/blind.obj --eye 0,1.5,1.9 --target 0,1.2,0 --fov 75
caustic $scenes/caustic.obj --eye 0.5,1.6,2.6 --target 0,0.5,0 --fov 50
uplight $scenes/uplight.obj --eye 0,1.5,1.9 --target 0,1.2,0 --fov 75
door $scenes/door.obj --eye 0,1.5,1.9 --target 0,1.2,0 --fov 75
cornell-box cornell-box
LIST
exit $status
