#!/usr/bin/env python3
"""Holds src/ to the module order: fails on each include that points where it must not, with file and line.

A module may include only itself and modules before it in ORDER. Beyond that order: scene and formats never see a GPU
type, accel and trace never see a material, only device/cuda and .cu files include CUDA's headers, and no integrator includes
another.

`check_includes.py [ROOT]` checks ROOT/src; `--self-test` makes trees that break each rule and must be caught.
"""

import pathlib
import re
import sys
import tempfile

ORDER = ["base", "math", "image", "device", "scene", "formats", "accel", "trace", "shading", "render", "integrators",
         "denoise", "session", "lab"]

# Modules that lie before but are still out of bounds.
FORBIDDEN = {
    "scene": {"device"},
    "formats": {"device"},
    "accel": {"scene", "formats", "image"},
    "trace": {"scene", "formats", "image"},
}

INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
CUDA_HEADER = re.compile(r"^(cuda|cub/|thrust/|cooperative_groups|nccl|device_launch_parameters|curand|nvtx)")
SUFFIXES = {".h", ".cpp", ".cu", ".inl"}


def fault_of(path, module, quoted, target):
    """Why the include of `target` in `path` (relative to src) is wrong; None where it is not."""
    in_cuda = path.suffix == ".cu" or path.parts[:2] == ("device", "cuda")
    if CUDA_HEADER.match(target) and not in_cuda:
        return "CUDA headers belong in device/cuda and .cu files"
    if target.startswith("device/cuda/") and not in_cuda:
        return "device/cuda is reached through device/"
    if not quoted:
        return None
    if ".." in pathlib.PurePath(target).parts:
        return "paths start at src/"
    owner = target.split("/")[0]
    if owner not in ORDER:
        return f"'{owner}' is no module; system headers stand in <>"
    if ORDER.index(owner) > ORDER.index(module):
        return f"{module} comes before {owner}"
    if owner in FORBIDDEN.get(module, ()):
        return f"{module} must not see {owner}"
    parts = pathlib.PurePath(target).parts
    if owner == "integrators" and len(parts) > 2 and path.parts[:2] != parts[:2] and path.stem != "make_integrator":
        return "an integrator's folder is seen by itself and integrators/make_integrator alone"
    return None


def check(root):
    faults = []
    source = root / "src"
    files = sorted(p for p in source.rglob("*") if p.suffix in SUFFIXES)
    if not files:
        faults.append(f"{source}: no sources found")
    for file in files:
        path = file.relative_to(source)
        if path.parts[0] not in ORDER:
            faults.append(f"src/{path}: '{path.parts[0]}' is not in the module order")
            continue
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            fault = match and fault_of(path, path.parts[0], match[1] == '"', match[2])
            if fault:
                faults.append(f"src/{path}:{number}: #include {match[2]}: {fault}")
    return faults


# File, include line, and whether that is allowed.
CASES = [
    ("math/vec3.h", '#include "base/limits.h"', True),
    ("math/vec3.h", '#include "math/scalar.h"', True),
    ("math/vec3.h", "#include <cstdint>", True),
    ("math/vec3.h", '#include "scene/mesh.h"', False),
    ("base/error.h", '#include "math/vec3.h"', False),
    ("trace/walk.h", '#  include "render/queue.h"', False),
    ("trace/walk.h", '#include "accel/bvh/node.h"', True),
    ("trace/walk.h", '#include "scene/material.h"', False),
    ("accel/build.cpp", '#include "shading/bsdf.h"', False),
    ("scene/mesh.h", '#include "device/buffer.h"', False),
    ("formats/read.cpp", '#include "device/buffer.h"', False),
    ("render/film.h", '#include "device/buffer.h"', True),
    ("render/film.h", '#include "device/cuda/stream.h"', False),
    ("render/film.cu", "#include <cuda_runtime.h>", True),
    ("render/film.h", "#include <cuda_runtime.h>", False),
    ("render/film.cpp", "#include <cub/cub.cuh>", False),
    ("device/cuda/queue.cpp", "#include <cuda_runtime.h>", True),
    ("device/queue.cpp", "#include <cuda_runtime.h>", False),
    ("render/film.h", '#include "../math/vec3.h"', False),
    ("render/film.h", '#include "film_sum.h"', False),
    ("integrators/path/stages.h", '#include "integrators/path/state.h"', True),
    ("integrators/path/stages.h", '#include "integrators/integrator.h"', True),
    ("integrators/make_integrator.h", '#include "integrators/path/stages.h"', True),
    ("integrators/photon_map/gather.h", '#include "integrators/path/state.h"', False),
    ("integrators/integrator.h", '#include "integrators/path/state.h"', False),
    ("session/session.h", '#include "integrators/path/state.h"', False),
    ("session/session.h", '#include "integrators/integrator.h"', True),
    ("integrators/integrator.h", '#include "session/session.h"', False),
    ("helpers/film.h", "#include <cstdint>", False),
]


def self_test():
    failures = 0
    for file, line, allowed in CASES:
        with tempfile.TemporaryDirectory() as folder:
            target = pathlib.Path(folder) / "src" / file
            target.parent.mkdir(parents=True)
            target.write_text(f"#pragma once\n{line}\n")
            faults = check(pathlib.Path(folder))
            if bool(faults) == allowed:
                failures += 1
                print(f"{file}: {line}: {'refused: ' + faults[0] if allowed else 'not noticed'}")
    with tempfile.TemporaryDirectory() as folder:
        if not check(pathlib.Path(folder)):
            failures += 1
            print("an empty tree passed")
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        sys.exit(1 if self_test() else 0)
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    faults = check(root)
    print("\n".join(faults) or "every include points down")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
