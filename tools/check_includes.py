#!/usr/bin/env python3
"""Holds src/ to what each module may know: fails on each include that points where it must not, with file and line.

ALLOWED is the "may know" column of docs/architecture.md: a module may include itself and the modules that stand there, all
of which come before it. Beyond that table: only device/cuda and .cu files include CUDA's headers, no integrator includes
another, except the parts that several share (integrators/ray_tree, subpaths), other modules include of an
integrator only its settings (*_settings.h), and neither files nor folders include each other in a circle: the files that
lie in a folder itself count as one, each folder below it as another. NAMED_IN lists the files that may name a kind.

`check_includes.py [ROOT]` checks ROOT/src; `--self-test` makes trees that break each rule and must be caught.
"""

import pathlib
import re
import sys
import tempfile

# In their order: a module may know none that comes later.
ALLOWED = {
    "base": set(),
    "math": {"base"},
    "image": {"base", "math"},
    "device": {"base"},
    "scene": {"base", "math", "image"},
    "formats": {"base", "math", "image", "scene"},
    "accel": {"base", "math"},
    "trace": {"base", "math", "device", "accel"},
    "shading": {"base", "math", "scene"},
    "device_scene": {"base", "math", "image", "device", "scene", "accel", "trace", "shading"},
}
ALLOWED["tracer"] = ALLOWED["device_scene"] | {"device_scene"}
ALLOWED["render"] = ALLOWED["tracer"] | {"tracer"}
ALLOWED["radiosity"] = ALLOWED["render"] | {"render"}
ALLOWED["integrators"] = ALLOWED["radiosity"] | {"radiosity"}
ALLOWED["denoise"] = ALLOWED["render"] | {"render"}
ALLOWED["restir"] = ALLOWED["render"] | {"render"}
ALLOWED["settings"] = set(ALLOWED)
ALLOWED["session"] = set(ALLOWED)
ALLOWED["lab"] = set(ALLOWED)

# The machines that several integrators are made of.
SHARED = (("integrators", "ray_tree"), ("integrators", "subpaths"))

# Where all of them are known.
KINDS = ("integrators", "kinds")

# Only these files name a kind: of camera, the camera, its readers, the table of settings, and the maker of the light meter's
# camera; of lens, the lens, its rays, the table of settings, and those who check, measure, open or write a lens.
NAMED_IN = {"Projection::": {"scene/camera.h", "scene/projection_features.h", "render/camera_view.h", "render/camera_view.cpp",
                             "formats/gltf/camera.cpp", "formats/mitsuba/view.cpp", "formats/pbrt/camera.cpp",
                             "settings/value_names.h", "session/measure_irradiance.cpp"},
            "LensModel::": {"scene/lens_model.h", "scene/camera.h", "render/lens_distortion.h", "render/lens_distortion.cpp",
                            "render/panorama.h", "formats/gltf_writer/write_glb.cpp", "settings/value_names.h",
                            "session/check_integrator.cpp", "session/degrees.h", "session/opening/calibrated_camera.cpp"}}

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
    if owner not in ALLOWED:
        return f"'{owner}' is no module; system headers stand in <>"
    if owner != module and owner not in ALLOWED[module]:
        known = ", ".join(name for name in ALLOWED if name in ALLOWED[module])
        return f"{module} may know {known or 'nothing of ours'}, and not {owner}"
    parts = pathlib.PurePath(target).parts
    is_shared = path.parts[0] == "integrators" and len(path.parts) > 2 and parts[:2] in SHARED
    is_inside = path.parts[:2] in (parts[:2], KINDS)
    is_settings = module != "integrators" and target.endswith("_settings.h")
    is_open = is_inside or is_shared or is_settings
    if owner == "integrators" and len(parts) > 2 and parts[:2] != KINDS and not is_open:
        return "only an integrator's own folder and integrators/kinds may include it, except for its settings"
    return None


def circles(includes):
    """The first circle that is found from each file, as a line of text; `includes` is {file: files that it includes}."""
    faults, done = [], set()
    for start in sorted(includes):
        way, rest = [start], [iter(includes[start])]
        while way:
            following = next((file for file in rest[-1] if file in includes and file not in done), None)
            if following is None:
                done.add(way.pop())
                rest.pop()
            elif following in way:
                faults.append("a circle: " + " -> ".join(way[way.index(following):] + [following]))
            else:
                way.append(following)
                rest.append(iter(includes[following]))
        done.add(start)
    return faults


def by_folder(includes):
    """Includes between folders: {folder: folders that its own files include}."""
    folders = {}
    for file, included in includes.items():
        folder = str(pathlib.PurePath(file).parent)
        known = folders.setdefault(folder, [])
        known.extend(sorted({str(pathlib.PurePath(f).parent) for f in included if f in includes} - {folder}))
    return folders


def check(root):
    faults, includes = [], {}
    source = root / "src"
    files = sorted(p for p in source.rglob("*") if p.suffix in SUFFIXES)
    if not files:
        faults.append(f"{source}: no sources found")
    for file in files:
        path = file.relative_to(source)
        if path.parts[0] not in ALLOWED:
            faults.append(f"src/{path}: '{path.parts[0]}' is no module")
            continue
        included = includes[str(path)] = []
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            fault = match and fault_of(path, path.parts[0], match[1] == '"', match[2])
            if fault:
                faults.append(f"src/{path}:{number}: #include {match[2]}: {fault}")
            if match and match[1] == '"':
                included.append(match[2])
            code = line.partition("//")[0]
            faults += [f"src/{path}:{number}: {name} is named here; ask for a feature of it" for name, known in NAMED_IN.items()
                       if name in code and str(path) not in known]
    return faults + (circles(includes) or circles(by_folder(includes)))


# File, include line, and whether that is allowed.
CASES = [
    ("math/vec3.h", '#include "base/limits.h"', True),
    ("math/vec3.h", '#include "math/scalar.h"', True),
    ("math/vec3.h", "#include <cstdint>", True),
    ("math/vec3.h", '#include "scene/mesh.h"', False),
    ("base/error.h", '#include "math/vec3.h"', False),
    ("trace/traverse.h", '#  include "render/queue.h"', False),
    ("trace/traverse.h", '#include "accel/bvh/node.h"', True),
    ("trace/traverse.h", '#include "scene/material.h"', False),
    ("accel/build.cpp", '#include "shading/bsdf.h"', False),
    ("accel/build.cpp", '#include "device/queue.h"', False),
    ("trace/warps.h", '#include "device/queue.h"', True),
    ("shading/bsdf.h", '#include "scene/material.h"', True),
    ("shading/bsdf.h", '#include "trace/intersect/ray.h"', False),
    ("render/prepare.cpp", '#include "formats/read_scene.h"', False),
    ("integrators/integrator.h", '#include "formats/read_scene.h"', False),
    ("denoise/filter.h", '#include "render/film.h"', True),
    ("denoise/filter.h", '#include "integrators/integrator.h"', False),
    ("radiosity/patches.h", '#include "device_scene/surface.h"', True),
    ("radiosity/patches.h", '#include "integrators/integrator.h"', False),
    ("integrators/radiosity/radiosity.h", '#include "radiosity/patches.h"', True),
    ("restir/reservoir.h", '#include "device_scene/surface.h"', True),
    ("restir/reservoir.h", '#include "denoise/filter.h"', False),
    ("session/open.cpp", '#include "formats/read_scene.h"', True),
    ("session/open.cpp", '#include "lab/report.h"', False),
    ("math/vec3.h", '#include "math/vec3.h"', False),
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
    ("integrators/kinds/make_integrator.h", '#include "integrators/path/stages.h"', True),
    ("integrators/photon_map/gather.h", '#include "integrators/path/state.h"', False),
    ("integrators/photon_map/gather.h", '#include "integrators/ray_tree/stages.h"', True),
    ("integrators/ray_tree/stages.h", '#include "integrators/photon_map/gather.h"', False),
    ("integrators/integrator.h", '#include "integrators/ray_tree/stages.h"', False),
    ("integrators/integrator.h", '#include "integrators/path/state.h"', False),
    ("session/session.h", '#include "integrators/path/state.h"', False),
    ("session/session.h", '#include "integrators/path/path_settings.h"', True),
    ("integrators/photon_map/gather.h", '#include "integrators/path/path_settings.h"', False),
    ("session/session.h", '#include "integrators/integrator.h"', True),
    ("integrators/integrator.h", '#include "session/session.h"', False),
    ("helpers/film.h", "#include <cstdint>", False),
    ("render/camera_view.h", "case Projection::Cosine:", True),
    ("denoise/filter.h", "case Projection::Cosine:", False),
    ("denoise/filter.h", "// Projection::Cosine", True),
    ("render/panorama.h", "case LensModel::Cube:", True),
    ("integrators/path/state.h", "case LensModel::Cube:", False),
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
    with tempfile.TemporaryDirectory() as folder:
        files = {"a": "bc", "b": "d", "c": "d", "d": "e", "e": "b"}  # b, d and e in a circle
        target = pathlib.Path(folder) / "src" / "math"
        target.mkdir(parents=True)
        for name, included in files.items():
            (target / f"{name}.h").write_text("".join(f'#include "math/{other}.h"\n' for other in included))
        faults = check(pathlib.Path(folder))
        if faults != ["a circle: math/b.h -> math/d.h -> math/e.h -> math/b.h"]:
            failures += 1
            print(f"not the one circle that there is: {faults}")
    with tempfile.TemporaryDirectory() as folder:
        files = {"math/a.h": "math/deep/b.h", "math/deep/b.h": "math/c.h", "math/c.h": None}
        for name, included in files.items():
            target = pathlib.Path(folder) / "src" / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(f'#include "{included}"\n' if included else "\n")
        faults = check(pathlib.Path(folder))
        if faults != ["a circle: math -> math/deep -> math"]:
            failures += 1
            print(f"not the one circle of folders that there is: {faults}")
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        sys.exit(1 if self_test() else 0)
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    faults = check(root)
    print("\n".join(faults) or "every include points down")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    main()
