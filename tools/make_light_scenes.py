#!/usr/bin/env python3
"""Writes a scene of many lights as OBJ, and its MTL beside it: tools/make_light_scenes.py NAME OUT.obj [--lights N]

corridor    10,000 emitters of one triangle below the ceiling of a closed corridor (make_corridor.py)
city        lit windows on 20 by 20 blocks at night, 8 shades of light
chandelier  one mesh of 1,000 glowing beads with 8,000 triangles, in rings in a closed room
dust        250,000 glowing tetrahedra with 10^6 triangles in clusters above a floor, 8 shades of light

All is diffuse and emits from the front. Metres, +y up. The last line of output is the view for the command line.
"""

import argparse
import math
import pathlib
import random

import make_corridor

VIEWS = {"corridor": "--eye=0,1.6,29.5 --target=0,1.5,0 --fov 60", "city": "--eye=25,2,-20 --target=30,12,300 --fov 60",
         "chandelier": "--eye=0,1.6,2.9 --target=0,1.5,0 --fov 70", "dust": "--eye=0,6,48 --target=0,2,0 --fov 60"}


class Obj:
    """Lines of an OBJ and of its MTL."""

    def __init__(self):
        self.lines, self.materials, self.count = [], [], 0

    def material(self, name, albedo, emission):
        self.materials.append(f"newmtl {name}\nKd {albedo} {albedo} {albedo}\nKe " + " ".join(f"{c:.4g}" for c in emission))

    def use(self, name):
        self.lines.append(f"usemtl {name}")

    def face(self, corners, faces):
        """Adds corners, and faces by the numbers of their corners."""
        self.lines += ["v " + " ".join(f"{c:.5f}" for c in corner) for corner in corners]
        self.lines += ["f " + " ".join(str(self.count + 1 + i) for i in face) for face in faces]
        self.count += len(corners)

    def box(self, low, high, inwards):
        corners = [[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]
        faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
        self.face(corners, [face[::-1] if inwards else face for face in faces])


def shades(obj, name, random_, strength):
    """Makes eight emissive materials and returns their names."""
    for i in range(8):
        warm = random_.uniform(0, 1)
        power = strength * 2 ** random_.uniform(-2, 1)
        obj.material(f"{name}{i}", 0, [power, power * (0.95 - 0.35 * warm), power * (0.9 - 0.7 * warm)])
    return [f"{name}{i}" for i in range(8)]


def make_city(obj, random_, lights):
    obj.material("wall", 0.5, [0, 0, 0])
    obj.use("wall")
    obj.face([[-60, 0, -60], [-60, 0, 660], [660, 0, 660], [660, 0, -60]], [(0, 1, 2, 3)])
    windows = [[] for _ in range(8)]
    blocks = [(30 * x, 30 * z, random_.uniform(8, 60)) for x in range(20) for z in range(20)]
    for x, z, height in blocks:
        obj.box([x, 0, z], [x + 20, height, z + 20], False)
    for x, z, height in blocks:
        for floor in range(int(height / 3)):
            for side in range(4):
                for k in range(4):
                    if random_.random() < 0.6:
                        continue
                    y, from_, to = 3 * floor + 1, 5 * k + 1.25, 5 * k + 3.75
                    at = [lambda s: (x + s, z + 20.02), lambda s: (x + 20.02, z + 20 - s), lambda s: (x + 20 - s, z - 0.02),
                          lambda s: (x - 0.02, z + s)][side]
                    (x0, z0), (x1, z1) = at(from_), at(to)
                    windows[random_.randrange(8)].append([[x0, y, z0], [x1, y, z1], [x1, y + 1.4, z1], [x0, y + 1.4, z0]])
    for name, quads in zip(shades(obj, "window", random_, 8), windows):
        obj.use(name)
        for quad in quads[:lights]:
            obj.face(quad, [(0, 1, 2, 3)])


def make_chandelier(obj, random_, lights):
    obj.material("wall", 0.6, [0, 0, 0])
    obj.use("wall")
    obj.box([-3, 0, -3], [3, 3, 3], True)
    obj.material("bead", 0, [60, 52, 40])
    obj.use("bead")
    size = 0.01
    for i in range(lights or 1000):
        ring = i % 5
        radius, angle = 0.25 + 0.12 * ring, random_.uniform(0, 2 * math.pi)
        at = [radius * math.cos(angle), 2.6 - 0.15 * ring, radius * math.sin(angle)]
        corners = [[at[k] + (sign * size if k == axis else 0) for k in range(3)] for axis in range(3) for sign in (1, -1)]
        obj.face(corners, [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])


def make_dust(obj, random_, lights):
    obj.material("floor", 0.5, [0, 0, 0])
    obj.use("floor")
    obj.face([[-60, 0, -60], [-60, 0, 60], [60, 0, 60], [60, 0, -60]], [(0, 1, 2, 3)])
    for i in range(12):
        x, z = random_.uniform(-30, 30), random_.uniform(-30, 30)
        obj.box([x, 0, z], [x + random_.uniform(1, 4), random_.uniform(1, 8), z + random_.uniform(1, 4)], False)
    names = shades(obj, "speck", random_, 300)
    left = lights or 250_000
    while left > 0:
        obj.use(random_.choice(names))
        middle = [random_.uniform(-50, 50), random_.uniform(1, 20), random_.uniform(-50, 50)]
        for _ in range(min(left, 64)):
            at = [c + random_.uniform(-0.5, 0.5) for c in middle]
            size = 0.005 * 2 ** random_.uniform(-1, 1)
            corners = [[at[k] + size * c[k] for k in range(3)] for c in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))]
            obj.face(corners, [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])
        left -= 64


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", choices=sorted(VIEWS))
    parser.add_argument("target", type=pathlib.Path)
    parser.add_argument("--lights", type=int, help="number of triangles, beads or specks; of windows a shade")
    arguments = parser.parse_args()
    if arguments.name == "corridor":
        make_corridor.LAMPS = arguments.lights or 10_000
        make_corridor.write(arguments.target)
    else:
        obj = Obj()
        make = {"city": make_city, "chandelier": make_chandelier, "dust": make_dust}[arguments.name]
        make(obj, random.Random(arguments.name), arguments.lights)
        materials = arguments.target.with_suffix(".mtl")
        materials.write_text("\n".join(obj.materials) + "\n")
        arguments.target.write_text("\n".join([f"mtllib {materials.name}", *obj.lines]) + "\n")
    print(VIEWS[arguments.name])


if __name__ == "__main__":
    main()
