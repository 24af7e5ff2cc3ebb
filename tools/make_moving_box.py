#!/usr/bin/env python3
"""Writes the Cornell box with a moving emitter and a moving block, for `pertev bench sequence`: make_moving_box.py OUT.gltf
[--mirror]

The box is scenes/cornell-box/cornell-box.gltf. In 2.5 s the emitter sinks below the ceiling and swings from side to side,
the short block slides away from its wall and back. With --mirror the tall block is a mirror.
"""

import json
import math
import pathlib
import sys

from gltf_buffer import GltfBuffer

BOX = pathlib.Path(__file__).resolve().parent.parent / "scenes/cornell-box/cornell-box.gltf"
SECONDS, STEPS = 2.5, 25


def main(out, has_mirror):
    box = json.loads(BOX.read_text())
    names = [node.get("name") for node in box["nodes"]]
    times = [SECONDS * k / STEPS for k in range(STEPS + 1)]
    turn = [2 * math.pi * t / SECONDS for t in times]
    lamp = [(0.12 * math.sin(a), -0.05 * (1 - math.cos(a)) - 0.001, 0.0) for a in turn]
    slide = [(0.06 * (1 - math.cos(a)), 0.0, -0.05 * math.sin(a)) for a in turn]
    buffer = GltfBuffer(box["bufferViews"], box["accessors"], len(box["buffers"]))
    clock = buffer.add(times, "f", "SCALAR", has_bounds=True)
    moves = [(names.index("light"), buffer.add(lamp, "f", "VEC3")), (names.index("short block"), buffer.add(slide, "f", "VEC3"))]
    box["animations"] = [{
        "name": "lamp and block",
        "samplers": [{"input": clock, "output": output} for _, output in moves],
        "channels": [{"sampler": k, "target": {"node": node, "path": "translation"}}
                     for k, (node, _) in enumerate(moves)]}]
    if has_mirror:
        box["materials"].append({"name": "mirror", "doubleSided": True, "pbrMetallicRoughness": {
            "baseColorFactor": [0.9, 0.9, 0.9, 1], "metallicFactor": 1, "roughnessFactor": 0}})
        tall = box["nodes"][names.index("tall block")]["mesh"]
        box["meshes"][tall]["primitives"][0]["material"] = len(box["materials"]) - 1
    box |= {"bufferViews": buffer.views, "accessors": buffer.accessors, "buffers": [*box["buffers"], buffer.describe()]}
    pathlib.Path(out).write_text(json.dumps(box) + "\n")


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    arguments = [argument for argument in sys.argv[1:] if argument != "--mirror"]
    if len(arguments) != 1 or arguments[0].startswith("-"):
        sys.exit(__doc__)
    main(arguments[0], "--mirror" in sys.argv)
