#!/usr/bin/env python3
"""Writes scenes/many-lights/many-lights.gltf: a hall lit by 10,000 small triangles of 100 colours, for ReSTIR.

One swarm of 100 triangles hangs in the hall 100 times, each time in another colour and turned another way; pillars and
boxes stand in their light. The floor is glossy, the rest is nearly diffuse. Metres, +y up.

`make_many_lights.py --check` writes nothing and fails when the file is not what this script would write.
"""

import colorsys
import json
import math
import pathlib
import random

from gltf_buffer import GltfBuffer
from written_scenes import write_or_check

TARGET = pathlib.Path(__file__).resolve().parent.parent / "scenes/many-lights/many-lights.gltf"
SWARMS, TRIANGLES = 100, 100
HALF_WIDTH, HEIGHT, HALF_LENGTH = 8.0, 6.0, 12.0
RADIUS = 0.4  # radius of a swarm
SIZE = 0.015  # about the length of a triangle's edges
EMISSION = 800.0  # W/(sr m2), of the brightest channel


def swarm(random_):
    """Corners of triangles within a ball, turned every way."""
    corners = []
    for _ in range(TRIANGLES):
        while True:
            centre = [random_.uniform(-1, 1) for _ in range(3)]
            if sum(c * c for c in centre) <= 1:
                break
        for _ in range(3):
            corners.append([RADIUS * c + random_.uniform(-SIZE, SIZE) for c in centre])
    return corners


def place_apart(random_, places):
    """A place in the hall that is apart from the others, so that no ball reaches into another."""
    while True:
        at = [random_.uniform(-7.3, 7.3), random_.uniform(0.6, 5.4), random_.uniform(-11.3, 7)]
        if all(math.dist(at, other) > 2 * RADIUS for other in places):
            places.append(at)
            return at


def box(low, high, inward=False):
    """Corners of the twelve triangles of a box, seen from without, or from within."""
    corners = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            quad = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                point = [0.0, 0.0, 0.0]
                point[axis] = (low, high)[side][axis]
                point[u] = (low, high)[a][u]
                point[v] = (low, high)[b][v]
                quad.append(point)
            if (side == 0) != inward:
                quad.reverse()
            corners += [quad[i] for i in (0, 1, 2, 0, 2, 3)]
    return corners


class Document:
    def __init__(self):
        self.buffer, self.meshes, self.materials, self.nodes = GltfBuffer(), [], [], []

    def positions(self, corners):
        return self.buffer.add(corners, "f", "VEC3", has_bounds=True)

    def mesh(self, name, accessor, material):
        self.materials.append({"name": name, **material})
        self.meshes.append({"name": name, "primitives": [
            {"attributes": {"POSITION": accessor}, "material": len(self.materials) - 1}]})
        return len(self.meshes) - 1

    def text(self):
        document = {
            "asset": {"version": "2.0", "generator": "tools/make_many_lights.py"},
            "extensionsUsed": ["KHR_materials_emissive_strength"],
            "scene": 0,
            "scenes": [{"nodes": list(range(len(self.nodes)))}],
            "nodes": self.nodes,
            "cameras": [{"name": "hall", "type": "perspective",
                         "perspective": {"yfov": 0.95, "aspectRatio": 1.7777778, "znear": 0.1}}],
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.buffer.accessors,
            "bufferViews": self.buffer.views,
            "buffers": [self.buffer.describe()],
        }
        return json.dumps(document, separators=(",", ":")) + "\n"


def surface(color, roughness):
    return {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": roughness}}


def make():
    random_ = random.Random(10000)
    document = Document()
    hall = box((-HALF_WIDTH, 0, -HALF_LENGTH), (HALF_WIDTH, HEIGHT, HALF_LENGTH), inward=True)
    is_floor = [all(c[1] == 0 for c in hall[i:i + 3]) for i in range(0, len(hall), 3)]
    floor = [c for i, c in enumerate(hall) if is_floor[i // 3]]
    walls = [c for i, c in enumerate(hall) if not is_floor[i // 3]]
    pillars, boxes = [], []
    for z in (-8, -4, 0, 4, 8):
        for x in (-4.5, 4.5):
            pillars += box((x - 0.35, 0, z - 0.35), (x + 0.35, HEIGHT, z + 0.35))
    for _ in range(14):
        x, z = random_.uniform(-3.4, 3.4), random_.uniform(-10, 6)
        size, height = random_.uniform(0.3, 0.7), random_.uniform(0.4, 1.8)
        boxes += box((x - size, 0, z - size), (x + size, height, z + size))
    for name, corners, material in (("floor", floor, surface((0.55, 0.55, 0.55), 0.35)),
                                    ("walls", walls, surface((0.7, 0.7, 0.7), 1)),
                                    ("pillars", pillars, surface((0.6, 0.55, 0.5), 0.9)),
                                    ("boxes", boxes, surface((0.5, 0.5, 0.55), 0.7))):
        document.nodes.append({"name": name, "mesh": document.mesh(name, document.positions(corners), material)})
    lights = document.positions(swarm(random_))
    places = []
    for k in range(SWARMS):
        color = [round(c, 4) for c in colorsys.hsv_to_rgb(random_.random(), random_.uniform(0.55, 0.95), 1)]
        black = surface((0, 0, 0), 1)
        mesh = document.mesh(f"swarm {k}", lights, {
            **black, "emissiveFactor": color, "doubleSided": True,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": EMISSION}}})
        at = place_apart(random_, places)
        half = 0.5 * random_.uniform(0, 2 * math.pi)
        document.nodes.append({
            "name": f"swarm {k}", "mesh": mesh, "translation": [round(c, 4) for c in at],
            "rotation": [0, round(math.sin(half), 6), 0, round(math.cos(half), 6)]})
    document.nodes.append({"name": "camera", "camera": 0, "translation": [0, 2.1, 11.2],
                           "rotation": [-0.0499792, 0, 0, 0.9987503]})
    return document.text()


if __name__ == "__main__":
    write_or_check(__doc__, {TARGET: make()})
