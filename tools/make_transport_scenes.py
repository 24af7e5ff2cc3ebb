#!/usr/bin/env python3
"""Writes scenes/transport/: small scenes in which light comes to what the camera sees by narrow ways, and one of soft light.

blind: an emitter in a housing under the ceiling, behind slanted slats, so that most of the light has met these first.
caustic: a small emitter over a ball of clear glass, whose light gathers on the floor.
uplight: an emitter in a bowl that lights only the ceiling.
door: a room lit through a door that is ajar, from the room next to it.
cove: a diffuse room lit only by its ceiling, from emitters behind a ledge.

OBJ and MTL in metres, +y up; all faces are flat, so that no normal is interpolated. bench/jobs.json has the cameras.

`make_transport_scenes.py --check` writes nothing and fails when a file is not what this script would write.
"""

import math
import pathlib

from written_scenes import write_or_check

TARGET = pathlib.Path(__file__).resolve().parent.parent / "scenes/transport"
MATERIALS = {
    "white": "Kd 0.7 0.7 0.7",
    "red": "Kd 0.6 0.15 0.1",
    "blue": "Kd 0.15 0.25 0.6",
    "dark": "Kd 0.2 0.2 0.2",
    "plastic": "Kd 0.4 0.4 0.35\nPm 0\nPr 0.4",
    "glass": "Kd 0 0 0\nillum 6\nNi 1.5\nTf 1 1 1",
    "lamp": "Kd 0 0 0\nKe 60 54 45",
}


def sphere(centre, radius, sides=48):
    """Quads (triangles at the poles) of a sphere, counter-clockwise seen from outside."""
    rows = sides // 2

    def corner(i, j):
        theta, phi = math.pi * i / rows, 2 * math.pi * j / sides
        return [c + radius * d for c, d in zip(centre, (
            math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi)))]

    for i in range(rows):
        for j in range(sides):
            quad = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]
            yield [p for k, p in enumerate(quad) if not (i == 0 and k == 3) and not (i == rows - 1 and k == 2)]


class Obj:
    """Polygons by material; a face's front is where its corners go counter-clockwise."""

    def __init__(self):
        self.lines, self.count, self.used = [], 0, []

    def face(self, material, *corners):
        if material not in self.used:
            self.used.append(material)
        self.lines.append(f"usemtl {material}")
        self.lines += ["v " + " ".join(f"{c:.6g}" for c in corner) for corner in corners]
        self.lines.append("f " + " ".join(str(self.count + 1 + i) for i in range(len(corners))))
        self.count += len(corners)

    def sheet(self, material, centre, x, y):
        """centre + s x + t y for s, t in [-1, 1]; its front is where x cross y points."""
        corner = lambda s, t: [c + s * a + t * b for c, a, b in zip(centre, x, y)]  # noqa: E731
        self.face(material, corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1))

    def box(self, material, centre, half, inward=False, without=()):
        """`without`: (axis, side) of faces that are left out."""
        for axis in range(3):
            for side in (1, -1):
                if (axis, side) in without:
                    continue
                x, y, at = [0.0] * 3, [0.0] * 3, list(centre)
                x[(axis + 1) % 3], y[(axis + 2) % 3] = half[(axis + 1) % 3], half[(axis + 2) % 3]
                at[axis] += side * half[axis]
                if (side > 0) == inward:
                    x, y = y, x
                self.sheet(material, at, x, y)

    def ball(self, material, centre, radius):
        for polygon in sphere(centre, radius):
            self.face(material, *polygon)

    def write(self, name):
        mtl = "".join(f"newmtl {m}\n{MATERIALS[m]}\n" for m in self.used)
        return {f"{name}.obj": f"mtllib {name}.mtl\n" + "\n".join(self.lines) + "\n", f"{name}.mtl": mtl}


def room(obj):
    """4 x 3 x 4 m about (0, 1.5, 0), one wall red and one blue, with two boxes in it."""
    obj.sheet("white", (0, 0, 0), (0, 0, 2), (2, 0, 0))
    obj.sheet("white", (0, 3, 0), (2, 0, 0), (0, 0, 2))
    obj.sheet("white", (0, 1.5, -2), (2, 0, 0), (0, 1.5, 0))
    obj.sheet("white", (0, 1.5, 2), (0, 1.5, 0), (2, 0, 0))
    obj.sheet("red", (-2, 1.5, 0), (0, 1.5, 0), (0, 0, 2))
    obj.sheet("blue", (2, 1.5, 0), (0, 0, 2), (0, 1.5, 0))
    obj.box("plastic", (-0.8, 0.5, -0.7), (0.4, 0.5, 0.4))
    obj.box("white", (0.8, 0.3, -0.2), (0.35, 0.3, 0.35))


def blind():
    obj = Obj()
    room(obj)
    for side in (1, -1):
        obj.box("white", (side * 0.42, 2.75, 0), (0.02, 0.25, 0.44))
        obj.box("white", (0, 2.75, side * 0.42), (0.4, 0.25, 0.02))
    obj.sheet("lamp", (0, 2.9, 0), (0.1, 0, 0), (0, 0, 0.1))
    for i in range(9):  # each slat hides what is above the gap beside it
        obj.sheet("white", (-0.36 + 0.09 * i, 2.55, 0), (0.055, 0.055, 0), (0, 0, 0.4))
    return obj.write("blind")


def caustic():
    obj = Obj()
    obj.sheet("white", (0, 0, 0), (0, 0, 2), (2, 0, 0))
    obj.sheet("white", (0, 1.5, -2), (2, 0, 0), (0, 1.5, 0))
    obj.sheet("red", (-2, 1.5, 0), (0, 1.5, 0), (0, 0, 2))
    obj.ball("glass", (0, 0.6, 0), 0.4)
    obj.sheet("lamp", (0.8, 2.6, 0.3), (0.06, 0, 0), (0, 0, 0.06))
    return obj.write("caustic")


def uplight():
    obj = Obj()
    room(obj)
    for side in (1, -1):
        obj.box("dark", (1.4 + side * 0.16, 2.1, -1.4), (0.01, 0.2, 0.17))
        obj.box("dark", (1.4, 2.1, -1.4 + side * 0.16), (0.15, 0.2, 0.01))
    obj.box("dark", (1.4, 1.91, -1.4), (0.15, 0.01, 0.15))
    obj.sheet("lamp", (1.4, 1.95, -1.4), (0, 0, 0.08), (0.08, 0, 0))
    return obj.write("uplight")


def door():
    obj = Obj()
    obj.sheet("white", (0, 0, 0), (0, 0, 2), (2, 0, 0))
    obj.sheet("white", (0, 3, 0), (2, 0, 0), (0, 0, 2))
    obj.sheet("white", (0, 1.5, -2), (2, 0, 0), (0, 1.5, 0))
    obj.sheet("white", (0, 1.5, 2), (0, 1.5, 0), (2, 0, 0))
    obj.sheet("red", (-2, 1.5, 0), (0, 1.5, 0), (0, 0, 2))
    # The wall at x = 2 has a doorway, z from -1 to 0 and 2 m high.
    obj.sheet("blue", (2, 1.5, -1.5), (0, 0, 0.5), (0, 1.5, 0))
    obj.sheet("blue", (2, 1.5, 1), (0, 0, 1), (0, 1.5, 0))
    obj.sheet("blue", (2, 2.5, -0.5), (0, 0, 0.5), (0, 0.5, 0))
    obj.box("white", (2.06, 1.0, -0.62), (0.04, 1.0, 0.38))  # the door: 24 cm are open
    obj.box("plastic", (-0.8, 0.5, -0.7), (0.4, 0.5, 0.4))
    obj.box("white", (0.8, 0.3, -0.2), (0.35, 0.3, 0.35))
    obj.box("white", (4, 1.5, -0.5), (2, 1.5, 1.5), inward=True, without=[(0, -1)])  # the next room
    obj.sheet("lamp", (4.5, 2.9, 0.3), (0.15, 0, 0), (0, 0, 0.15))
    return obj.write("door")


def cove():
    obj = Obj()
    obj.sheet("white", (0, 0, 0), (0, 0, 2), (2, 0, 0))
    obj.sheet("white", (0, 3, 0), (2, 0, 0), (0, 0, 2))
    obj.sheet("white", (0, 1.19, -2), (2, 0, 0), (0, 1.19, 0))  # in two: no patch is lit above the ledge and dark below it
    obj.sheet("white", (0, 2.69, -2), (2, 0, 0), (0, 0.31, 0))
    obj.sheet("white", (0, 1.5, 2), (0, 1.5, 0), (2, 0, 0))
    obj.sheet("red", (-2, 1.5, 0), (0, 1.5, 0), (0, 0, 2))
    obj.sheet("blue", (2, 1.5, 0), (0, 0, 2), (0, 1.5, 0))
    obj.box("white", (-0.8, 0.5, -0.7), (0.4, 0.5, 0.4))
    obj.box("white", (0.8, 0.3, -0.2), (0.35, 0.3, 0.35))
    obj.box("white", (0, 2.38, -1.8), (2.01, 0.02, 0.21))  # the ledge goes into the walls
    obj.box("white", (0, 2.46, -1.6), (2.01, 0.1, 0.01))
    for i in range(4):
        obj.sheet("lamp", (-1.5 + i, 2.42, -1.8), (0, 0, 0.04), (0.2, 0, 0))
    return obj.write("cove")


if __name__ == "__main__":
    write_or_check(__doc__, {TARGET / name: text for scene in (blind, caustic, uplight, door, cove) for name, text in scene().items()})
