#!/usr/bin/env python3
"""Writes a box that crosses a lit floor, for measuring contact shadows in motion: make_crossing_box.py OUT.gltf

The box floats 3 cm above the floor and moves at 3 m/s for one second along x. Camera: --eye 0,1.1,3 --target 0,0.25,0 --fov 40.
"""

import json
import pathlib
import sys

from gltf_buffer import GltfBuffer

GAP, SIZE, SPEED, SECONDS = 0.03, 0.5, 3.0, 1.0 # metres, m/s
FACES = (((0, 1, 0), (0, 0, 1), (1, 0, 0)), ((1, 0, 0), (0, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0), (0, 1, 0)))


def sheet(centre, x, y):
    """Corners of a parallelogram, whose front is where x cross y points."""
    return [[c + s * a + t * b for c, a, b in zip(centre, x, y)] for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def box(size):
    half, corners = size / 2, []
    for normal, x, y in FACES:
        for side in (1, -1):
            along = [half * side * v for v in x]
            corners += sheet([half * side * v for v in normal], along, [half * v for v in y])
    return corners


def main(out):
    buffer, meshes, nodes = GltfBuffer(), [], []

    def place(name, corners, material, at):
        first = [4 * (k // 6) + (0, 1, 2, 0, 2, 3)[k % 6] for k in range(6 * len(corners) // 4)]
        meshes.append({"primitives": [{"material": material, "indices": buffer.add(first, "I", "SCALAR"), "attributes": {
            "POSITION": buffer.add(corners, "f", "VEC3", has_bounds=True)}}]})
        nodes.append({"name": name, "mesh": len(meshes) - 1, "translation": at})

    place("floor", sheet([0, 0, 0], [0, 0, 4], [4, 0, 0]), 0, [0, 0, 0])
    place("lamp", sheet([0, 0, 0], [0.4, 0, 0], [0, 0, 0.4]), 1, [0.5, 3, 0.8])
    place("box", box(SIZE), 2, [-SPEED * SECONDS / 2, GAP + SIZE / 2, 0])
    way = [[s * SPEED * SECONDS / 2, GAP + SIZE / 2, 0] for s in (-1, 1)]
    clock, places = buffer.add([0, SECONDS], "f", "SCALAR", has_bounds=True), buffer.add(way, "f", "VEC3")
    color = lambda *rgb: {"pbrMetallicRoughness": {"baseColorFactor": [*rgb, 1], "metallicFactor": 0, "roughnessFactor": 1}}  # noqa: E731
    scene = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes,
        "materials": [color(0.6, 0.6, 0.6), {**color(0, 0, 0), "emissiveFactor": [1, 1, 1], "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 40}}}, color(0.7, 0.3, 0.2)],
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "animations": [{"samplers": [{"input": clock, "output": places}],
                        "channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}]}],
        "bufferViews": buffer.views, "accessors": buffer.accessors, "buffers": [buffer.describe()]}
    pathlib.Path(out).write_text(json.dumps(scene) + "\n")


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    main(sys.argv[1])
