#!/usr/bin/env python3
"""Renders one scene by every integrator and puts the pictures on one sheet, docs/pictures/integrators.jpg.

    tools/make_integrator_sheet.py build/bin/pertev docs/pictures/integrators.jpg

The scene is the Cornell box with a ball of glass in place of the short block, and a point light below the emitter,
because some integrators support only punctual lights. Needs Pillow.
"""

import argparse
import json
import math
import pathlib
import sys
import tempfile

from gltf_buffer import GltfBuffer
from make_first_views import render, write_sheet

ROOT = pathlib.Path(__file__).resolve().parent.parent
CENTRE, RADIUS, STACKS = (0.185, 0.0901, 0.17), 0.09, 48
INTEGRATORS = ["path", "direct", "indirect", "hybrid", "cast", "whitted", "distributed", "raster", "reyes", "light",
               "bidirectional", "photon_map", "irradiance_cache", "radiosity"]


def ball():
    """Positions, which are normals too, and triangles of a unit sphere."""
    points = [(math.sin(math.pi * j / STACKS) * math.cos(math.pi * i / STACKS), math.cos(math.pi * j / STACKS),
               math.sin(math.pi * j / STACKS) * math.sin(math.pi * i / STACKS))
              for j in range(STACKS + 1) for i in range(2 * STACKS)]
    corners = []
    for j in range(STACKS):
        for i in range(2 * STACKS):
            a, b = j * 2 * STACKS + i, j * 2 * STACKS + (i + 1) % (2 * STACKS)
            corners += ([a, b, b + 2 * STACKS] if j else []) + ([a, b + 2 * STACKS, a + 2 * STACKS] if j < STACKS - 1 else [])
    return points, corners


def make_scene(path):
    scene = json.loads((ROOT / "scenes/cornell-box/cornell-box.gltf").read_text(encoding="utf-8"))
    buffer = GltfBuffer(scene["bufferViews"], scene["accessors"], len(scene["buffers"]))
    points, corners = ball()
    positions, indices = buffer.add(points, "f", "VEC3", has_bounds=True), buffer.add(corners, "I", "SCALAR")
    scene["buffers"].append(buffer.describe())
    scene["bufferViews"], scene["accessors"] = buffer.views, buffer.accessors
    scene["materials"].append({"name": "glass", "pbrMetallicRoughness": {"roughnessFactor": 0, "metallicFactor": 0},
                               "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
                                              "KHR_materials_volume": {"thicknessFactor": 1}, "KHR_materials_ior": {"ior": 1.5}}})
    scene["meshes"].append({"name": "ball", "primitives": [{"attributes": {"POSITION": positions, "NORMAL": positions},
                                                            "indices": indices, "material": len(scene["materials"]) - 1}]})
    nodes = scene["nodes"]
    short = next(i for i, node in enumerate(nodes) if "short" in node.get("name", ""))
    nodes[short] = {"name": "ball", "mesh": len(scene["meshes"]) - 1, "translation": CENTRE, "scale": [RADIUS] * 3}
    scene.setdefault("extensions", {})["KHR_lights_punctual"] = {"lights": [{"type": "point", "intensity": 0.12, "name": "bulb"}]}
    nodes.append({"name": "bulb", "translation": [0.278, 0.42, 0.28], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    scene["scenes"][0]["nodes"].append(len(nodes) - 1)
    scene["extensionsUsed"] = sorted({*scene.get("extensionsUsed", []), "KHR_lights_punctual", "KHR_materials_transmission",
                                      "KHR_materials_volume", "KHR_materials_ior"})
    path.write_text(json.dumps(scene), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pertev")
    parser.add_argument("sheet")
    parser.add_argument("--spp", type=int, default=128)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "box.gltf"
        make_scene(scene)
        views = [(name, render(arguments.pertev, scene, (180, 180), arguments.spp, ["--integrator", name, "--exposure", "-0.5"])) for name in INTEGRATORS]
        write_sheet(arguments.sheet, views, 5, 85)


if __name__ == "__main__":
    sys.exit(main())
