#!/usr/bin/env python3
"""Writes a room with a ball of glass, a block of glass, a mirror and a ball of metal, for measuring denoisers:
make_glass_room.py OUT.obj [--nested]

Stripes on the back wall and squares on the floor show through the glass and in the mirror; the emitter is below the ceiling.
With --nested the ball holds a bubble of air, and the block a ball of denser glass.
OBJ and MTL in metres, +y up. Camera: --eye 0,1.15,3.4 --target 0,0.85,-0.5 --fov 42.
"""

import math
import pathlib
import sys

MATERIALS = {
    "white": "Kd 0.72 0.71 0.68", "red": "Kd 0.6 0.12 0.1", "green": "Kd 0.12 0.42 0.16", "grey": "Kd 0.3 0.3 0.32",
    "dark": "Kd 0.08 0.1 0.3", "glass": "Kd 0 0 0\nillum 6\nNi 1.5\nTf 1 1 1",
    "air": "Kd 0 0 0\nillum 6\nNi 1.0003\nTf 1 1 1", "dense": "Kd 0 0 0\nillum 6\nNi 1.8\nTf 1 1 1",
    "mirror": "Kd 0.9 0.9 0.9\nPm 1\nPr 0", "lamp": "Kd 0 0 0\nKe 14 13 11"}
HALF, HEIGHT, DEPTH = 1.5, 2.4, 1.6 # half of the room's width; the back wall is at z = -DEPTH
SIDES = 96


class Obj:
    def __init__(self):
        self.lines, self.corners = [], 0

    def face(self, material, corners, normals):
        self.lines.append(f"usemtl {material}")
        self.lines += ["v " + " ".join(f"{c:.7g}" for c in corner) for corner in corners]
        self.lines += ["vn " + " ".join(f"{c:.7g}" for c in normal) for normal in normals]
        self.lines.append("f " + " ".join(f"{self.corners + 1 + i}//{self.corners + 1 + i}" for i in range(len(corners))))
        self.corners += len(corners)

    def sheet(self, material, corner, x, y):
        """A parallelogram, whose front is where x cross y points."""
        add = lambda *vectors: [sum(values) for values in zip(*vectors)]  # noqa: E731
        cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
        normal = [c / math.hypot(*cross) for c in cross]
        self.face(material, [corner, add(corner, x), add(corner, x, y), add(corner, y)], [normal] * 4)

    def box(self, material, centre, half, turn_deg):
        c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
        axes = [[half[0] * c, 0, -half[0] * s], [0, half[1], 0], [half[2] * s, 0, half[2] * c]]
        for axis in range(3):
            for side in (1, -1):
                n, x, y = ([side * v for v in axes[axis]], axes[(axis + 1) % 3], [side * v for v in axes[(axis + 2) % 3]])
                self.sheet(material, [p + a - b - d for p, a, b, d in zip(centre, n, x, y)], [2 * v for v in x], [2 * v for v in y])

    def ball(self, material, centre, radius):
        rows = SIDES // 2
        normal = lambda i, j: [  # noqa: E731
            math.sin(math.pi * i / rows) * math.cos(2 * math.pi * j / SIDES), math.cos(math.pi * i / rows),
            -math.sin(math.pi * i / rows) * math.sin(2 * math.pi * j / SIDES)]
        for i in range(rows):
            for j in range(SIDES):
                quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                if i == 0:
                    quad = quad[:3]
                elif i == rows - 1:
                    quad = [quad[0], quad[1], quad[3]]
                normals = [normal(*at) for at in quad]
                self.face(material, [[c + radius * d for c, d in zip(centre, n)] for n in normals], normals)


def main(out, is_nested):
    obj = Obj()
    tiles, bars = 12, 10
    for i in range(tiles):
        for k in range(tiles):
            x, z, wide, deep = -HALF + 2 * HALF * i / tiles, 2 - (2 + DEPTH) * k / tiles, 2 * HALF / tiles, (2 + DEPTH) / tiles
            obj.sheet("white" if (i + k) % 2 else "grey", [x, 0, z], [wide, 0, 0], [0, 0, -deep])
    for i in range(bars):
        obj.sheet("dark" if i % 2 else "white", [-HALF + 2 * HALF * i / bars, 0, -DEPTH], [2 * HALF / bars, 0, 0], [0, HEIGHT, 0])
    obj.sheet("white", [-HALF, HEIGHT, -DEPTH], [2 * HALF, 0, 0], [0, 0, 2 + DEPTH])
    obj.sheet("red", [-HALF, 0, 2], [0, 0, -2 - DEPTH], [0, HEIGHT, 0])
    obj.sheet("green", [HALF, 0, -DEPTH], [0, 0, 2 + DEPTH], [0, HEIGHT, 0])
    obj.sheet("lamp", [-0.5, HEIGHT - 0.02, -0.6], [1, 0, 0], [0, 0, 0.8])
    obj.sheet("mirror", [HALF - 0.02, 0.5, -1.3], [0, 0, 1.6], [0, 1.3, 0])
    obj.ball("glass", [-0.35, 0.45, 0.1], 0.44)
    obj.box("glass", [0.75, 0.45, -0.3], [0.25, 0.44, 0.2], 25)
    if is_nested:
        obj.ball("air", [-0.35, 0.5, 0.1], 0.2)
        obj.ball("dense", [0.75, 0.5, -0.3], 0.15)
    obj.ball("mirror", [-0.95, 0.36, -0.85], 0.35)
    obj.box("white", [0.25, 0.3, -1.1], [0.22, 0.3, 0.22], -15)
    out = pathlib.Path(out)
    out.write_text("\n".join([f"mtllib {out.with_suffix('.mtl').name}", *obj.lines]) + "\n")
    out.with_suffix(".mtl").write_text("\n".join(f"newmtl {name}\n{text}" for name, text in MATERIALS.items()) + "\n")


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith("-") or sys.argv[2:] not in ([], ["--nested"]):
        sys.exit(__doc__)
    main(sys.argv[1], len(sys.argv) == 3)
