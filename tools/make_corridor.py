#!/usr/bin/env python3
"""Writes a corridor lit by 5,000 small emitters as OBJ, and its MTL beside it: tools/make_corridor.py OUT.obj

A closed corridor 3 m wide, 3 m high and 60 m long with its floor at y = 0, diffuse, of reflectance 0.6. The emitters are triangles with
edges of 2 cm that hang within half a metre of the ceiling, in any orientation that faces down, all equally bright: 50 W/(sr m2),
from the front. +y up; look along -z from (0, 1.6, 29.5).
"""

import math
import pathlib
import random
import sys

WIDTH, HEIGHT, LENGTH = 3.0, 3.0, 60.0
LAMPS, EDGE, EMISSION, REFLECTANCE = 5000, 0.02, 50, 0.6


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return [c / length for c in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def lamp(random_):
    """Corners of one triangle, counterclockwise as seen from its emitting side."""
    centre = [random_.uniform(-0.48, 0.48) * WIDTH, HEIGHT - random_.uniform(0.03, 0.5), random_.uniform(-0.495, 0.495) * LENGTH]
    normal = unit([random_.uniform(-0.7, 0.7), -1, random_.uniform(-0.7, 0.7)])
    side = unit(cross(normal, [0, 0, 1]))
    up = cross(normal, side)
    angles = [2 * math.pi * i / 3 for i in range(3)]
    radius = EDGE / math.sqrt(3)
    return [[centre[k] + radius * (math.cos(a) * side[k] + math.sin(a) * up[k]) for k in range(3)] for a in angles]


def text(material_file):
    random_ = random.Random(5000)
    x, z = WIDTH / 2, LENGTH / 2
    lines = [f"mtllib {material_file}"]
    lines += [f"v {i * x:g} {j * HEIGHT:g} {k * z:g}" for k in (-1, 1) for j in (0, 1) for i in (-1, 1)]
    lines.append("usemtl wall")  # faces look inwards
    lines += ["f 1 5 6", "f 1 6 2", "f 3 4 8", "f 3 8 7", "f 1 3 7", "f 1 7 5", "f 2 6 8", "f 2 8 4", "f 1 2 4", "f 1 4 3", "f 5 7 8",
              "f 5 8 6"]
    lines.append("usemtl lamp")
    for i in range(LAMPS):
        lines += ["v " + " ".join(f"{c:.6f}" for c in corner) for corner in lamp(random_)]
        lines.append("f -3 -2 -1")
    return "\n".join(lines) + "\n"


def write(target):
    """Writes the OBJ `target` and its MTL."""
    material_file = target.with_suffix(".mtl")
    material_file.write_text(f"newmtl wall\nKd {REFLECTANCE} {REFLECTANCE} {REFLECTANCE}\n"
                             f"newmtl lamp\nKd 0 0 0\nKe {EMISSION} {EMISSION} {EMISSION}\n")
    target.write_text(text(material_file.name))


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    write(pathlib.Path(sys.argv[1]))
