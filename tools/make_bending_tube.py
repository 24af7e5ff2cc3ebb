#!/usr/bin/env python3
"""Writes a glTF file of a tube on a floor that bends by a skin of eight joints, for measurements of deformed meshes.

`make_bending_tube.py OUT.gltf [RINGS SEGMENTS]`: 2 * RINGS * SEGMENTS triangles, 262144 of them without numbers.
"""

import json
import math
import sys

from gltf_buffer import GltfBuffer

JOINTS, HEIGHT, RADIUS = 8, 4.0, 0.5
STEP = HEIGHT / (JOINTS - 1)


def tube(binary, rings, segments):
    positions, normals, joints, weights, indices = [], [], [], [], []
    for ring in range(rings + 1):
        y = HEIGHT * ring / rings
        joint = min(int(y / STEP), JOINTS - 2)
        share = y / STEP - joint
        for segment in range(segments):
            angle = 2 * math.pi * segment / segments
            x, z = math.cos(angle), math.sin(angle)
            positions += [RADIUS * x, y, RADIUS * z]
            normals += [x, 0, z]
            joints += [joint, joint + 1, 0, 0]
            weights += [1 - share, share, 0, 0]
    for ring in range(rings):
        for segment in range(segments):
            a, b = ring * segments + segment, ring * segments + (segment + 1) % segments
            indices += [a, a + segments, b, b, a + segments, b + segments]
    return {"attributes": {"POSITION": binary.add(positions, "f", "VEC3", has_bounds=True),
                           "NORMAL": binary.add(normals, "f", "VEC3"),
                           "JOINTS_0": binary.add(joints, "H", "VEC4"),
                           "WEIGHTS_0": binary.add(weights, "f", "VEC4")},
            "indices": binary.add(indices, "I", "SCALAR"), "material": 0}


def floor(binary):
    corners = [-4, 0, -4, 4, 0, -4, 4, 0, 4, -4, 0, 4]
    return {"attributes": {"POSITION": binary.add(corners, "f", "VEC3", has_bounds=True)},
            "indices": binary.add([0, 2, 1, 0, 3, 2], "I", "SCALAR"), "material": 1}


def turn(angle_deg):
    half = math.radians(angle_deg) / 2
    return [0, 0, math.sin(half), math.cos(half)]


def make(rings, segments):
    binary = GltfBuffer()
    meshes = [{"name": "tube", "primitives": [tube(binary, rings, segments)]},
              {"name": "floor", "primitives": [floor(binary)]}]
    first = 3  # node of the first joint
    nodes = [{"name": "tube", "mesh": 0, "skin": 0}, {"name": "floor", "mesh": 1},
             {"camera": 0, "translation": [0, 2, 8]}]
    inverse = []
    for joint in range(JOINTS):
        nodes.append({"translation": [0, STEP if joint else 0, 0]})
        if joint + 1 < JOINTS:
            nodes[-1]["children"] = [first + joint + 1]
        inverse += [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -joint * STEP, 0, 1]
    sampler = {"input": binary.add([0, 1, 2, 3], "f", "SCALAR", has_bounds=True),
               "output": binary.add(turn(0) + turn(18) + turn(-14) + turn(0), "f", "VEC4")}
    channels = [{"sampler": 0, "target": {"node": first + joint, "path": "rotation"}} for joint in range(1, JOINTS)]
    skin = {"joints": list(range(first, first + JOINTS)), "inverseBindMatrices": binary.add(inverse, "f", "MAT4")}
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1, 2, first]}], "nodes": nodes,
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}], "meshes": meshes,
            "materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.3, 0.2, 1],
                                                                  "metallicFactor": 0, "roughnessFactor": 0.5}},
                          {"name": "grey", "doubleSided": True, "pbrMetallicRoughness":
                           {"baseColorFactor": [0.6, 0.6, 0.6, 1], "metallicFactor": 0}}],
            "skins": [skin], "animations": [{"samplers": [sampler], "channels": channels}],
            "accessors": binary.accessors, "bufferViews": binary.views, "buffers": [binary.describe()]}


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    if len(sys.argv) not in (2, 4) or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    rings, segments = (int(sys.argv[2]), int(sys.argv[3])) if len(sys.argv) == 4 else (512, 256)
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        json.dump(make(rings, segments), out)
