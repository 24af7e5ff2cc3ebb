#!/usr/bin/env python3
"""Holds the tangents that Pertev makes against the npm package mikktspace, on random meshes and on glTF files.

    npm install --prefix FOLDER mikktspace
    tools/compare_tangents.py FOLDER build/bin/pertev_tests [--meshes 1000] [--glb FILE.glb ...]

writes meshes with the tangents that the package makes into a temporary file, and runs the test of
tests/unit/corner_tangents_test.cpp that reads it: groups of corners that share a tangent must be equal, and tangents
within 1e-5. `--store FILE` writes the few meshes that the test holds at all times (tests/support/mikktspace_meshes.inl).
"""

import argparse
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
import textwrap

ORACLE = """
const fs = require('fs');
const data = fs.readFileSync(process.argv[2]);
const floats = new Float32Array(data.buffer, data.byteOffset, data.length / 4);
const words = new Uint32Array(data.buffer, data.byteOffset, data.length / 4);
const results = [];
for (let at = 0; at < words.length;) {
    const corners = words[at++];
    const take = count => { const part = floats.slice(at, at + count); at += count; return part; };
    const positions = take(3 * corners), normals = take(3 * corners), uv = take(2 * corners);
    let tangents;
    try {
        tangents = require('mikktspace').generateTangents(positions, normals, uv);
    } catch (error) { // it reads past its memory at times, and is of no more use then
        delete require.cache[require.resolve('mikktspace')];
        tangents = new Float32Array(4 * corners);
    }
    results.push(Buffer.from(tangents.buffer.slice(0)));
}
fs.writeFileSync(process.argv[3], Buffer.concat(results));
"""


def to_float(x):
    return struct.unpack("<f", struct.pack("<f", x))[0]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return tuple(to_float(x / length) for x in v) if length > 0 else (0.0, 0.0, 1.0)


class Mesh:
    """Vertices are (position, normal, coordinate); a triangle is three of their numbers."""

    def __init__(self, name):
        self.name, self.vertices, self.indices, self.numbers = name, [], [], {}

    def add(self, position, normal, uv):
        self.vertices.append(tuple(tuple(to_float(x) for x in v) for v in (position, normal, uv)))
        return len(self.vertices) - 1

    def shared(self, position, normal, uv):
        key = tuple(tuple(to_float(x) for x in v) for v in (position, normal, uv))
        if key not in self.numbers:
            self.numbers[key] = self.add(*key)
        return self.numbers[key]

    def triangle(self, a, b, c):
        self.indices += [a, b, c]

    def corners(self):
        return [self.vertices[i] for i in self.indices]


def affine(rng):
    """A map of the plane that may turn, stretch, shear and mirror."""
    while True:
        a, b, c, d = (rng.uniform(-2, 2) for _ in range(4))
        if abs(a * d - b * c) > 0.2:
            return lambda u, v: (a * u + b * v, c * u + d * v)


def height_field(rng):
    """A curved grid; its texture may be mirrored at its middle, and have triangles that show one texel."""
    mesh, n = Mesh("height field"), rng.randint(1, 6)
    height = {(i, j): rng.uniform(-0.4, 0.4) for i in range(n + 1) for j in range(n + 1)}
    mapped, mirrored, jitter = affine(rng), rng.random() < 0.4, rng.uniform(0, 0.2)
    middle = n / 2 if rng.random() < 0.5 else n // 2
    hard = rng.random() < 0.2
    texels = rng.random() < 0.3
    points, normals, uvs = {}, {}, {}
    for i in range(n + 1):
        for j in range(n + 1):
            points[i, j] = (i + rng.uniform(-jitter, jitter), j + rng.uniform(-jitter, jitter), height[i, j])
            normals[i, j] = unit((rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), 1))
            uvs[i, j] = mapped(abs(i - middle) if mirrored else i, j)
    for i in range(n):
        for j in range(n):
            quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            turn = rng.randint(0, 3)
            quad = quad[turn:] + quad[:turn]
            for triangle in (quad[:3], [quad[0], quad[2], quad[3]]):
                flat = unit((rng.uniform(-1, 1), rng.uniform(-1, 1), 2)) if hard and rng.random() < 0.5 else None
                texel = texels and rng.random() < 0.2
                turn = rng.randint(0, 2)
                mesh.triangle(*(mesh.shared(points[k], flat or normals[k], uvs[triangle[0]] if texel else uvs[k])
                                for k in triangle[turn:] + triangle[:turn]))
    return mesh


def sphere(rng):
    """Closed, with a seam, and with triangles of two equal positions at its poles."""
    mesh, rings, sides = Mesh("sphere"), rng.randint(2, 5), rng.randint(3, 8)
    mirrored, pinched = rng.random() < 0.3, rng.random() < 0.5

    def vertex(i, j):
        theta, phi = math.pi * i / rings, 2 * math.pi * (j % sides) / sides
        p = (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
        if i in (0, rings):
            p = (0.0, p[1], 0.0)
        u = abs(j / sides - 0.5) if mirrored else j / sides
        if pinched and i in (0, rings):
            u = 0.5
        return mesh.shared(p, unit(p), (u, i / rings))

    for i in range(rings):
        for j in range(sides):
            a, b, c, d = vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)
            mesh.triangle(a, c, b)
            mesh.triangle(a, d, c)
    return mesh


def box(rng):
    """Hard edges, every face with its own part of the texture, some of them mirrored or turned."""
    mesh, size = Mesh("box"), [rng.uniform(0.2, 3) for _ in range(3)]
    for axis in range(3):
        for side in (-1, 1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            mapped = affine(rng) if rng.random() < 0.5 else (lambda a, b: (a, b))
            numbers = []
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = [0.0] * 3
                p[axis], p[u], p[v] = side * size[axis], a * size[u], b * size[v]
                n = [0.0] * 3
                n[axis] = float(side)
                numbers.append(mesh.add(p, n, mapped(a, b)))
            if side < 0:
                numbers.reverse()
            mesh.triangle(*numbers[:3])
            mesh.triangle(numbers[0], numbers[2], numbers[3])
    return mesh


def fan(rng):
    """Triangles round one vertex, closed or open, with textures that turn at will from one to the next."""
    mesh, sides = Mesh("fan"), rng.randint(2, 9)
    tip = mesh.add((0, 0, rng.uniform(-1, 1)), unit((rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), 1)), (0, 0))
    rim = []
    for i in range(sides):
        phi = 2 * math.pi * (i + rng.uniform(-0.2, 0.2)) / max(sides, 3)
        rim.append(mesh.add((math.cos(phi), math.sin(phi), 0), unit((math.cos(phi), math.sin(phi), 1)),
                            (rng.randint(-2, 2), rng.randint(-2, 2))))
    closed = sides > 2 and rng.random() < 0.5
    order = [(rim[i], rim[(i + 1) % sides]) for i in range(sides if closed else sides - 1)]
    rng.shuffle(order)
    for a, b in order:
        mesh.triangle(tip, a, b)
    return mesh


def lattice(rng):
    """Anything at all: few places and coordinates, edges of many triangles, repeated triangles, opposite textures."""
    mesh, size = Mesh("lattice"), rng.randint(1, 2)
    flat = rng.random() < 0.7
    vertices = []
    for _ in range(rng.randint(4, 12)):
        position = (rng.randint(0, size), rng.randint(0, size), 0 if flat else rng.randint(0, size))
        normal = (0, 0, 1) if flat or rng.random() < 0.7 else (0, 1, 0)
        vertices.append(mesh.add(position, normal, (rng.randint(-1, 1), rng.randint(-1, 1))))
    for _ in range(rng.randint(2, 24)):
        mesh.triangle(*(rng.choice(vertices) for _ in range(3)))
    return mesh


FAMILIES = (height_field, height_field, height_field, sphere, box, fan, lattice)


def random_meshes(count, seed):
    rng = random.Random(seed)
    meshes = []
    for i in range(count):
        mesh = FAMILIES[i % len(FAMILIES)](rng)
        mesh.name += " %d" % i
        meshes.append(mesh)
    return meshes


def read_glb(path):
    """The primitives of a .glb whose attributes are floats side by side, as NormalTangentTest's are."""
    with open(path, "rb") as file:
        data = file.read()
    length = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20:20 + length]), data[28 + length:]

    def read(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        letter = {5126: "f", 5125: "I", 5123: "H", 5121: "B"}[accessor["componentType"]]
        each = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        size = struct.calcsize("<%d%s" % (each, letter))
        step = view.get("byteStride", size)
        return [struct.unpack_from("<%d%s" % (each, letter), binary, start + i * step) for i in range(accessor["count"])]

    meshes = []
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            attributes = primitive["attributes"]
            if not {"NORMAL", "TEXCOORD_0"} <= attributes.keys() or "indices" not in primitive:
                continue
            result = Mesh(os.path.basename(path))
            result.vertices = list(zip(*(read(attributes[k]) for k in ("POSITION", "NORMAL", "TEXCOORD_0"))))
            result.indices = [i for (i,) in read(primitive["indices"])]
            meshes.append(result)
    return meshes


# A triangle that touches no other, behind those of each mesh. mikktspace leaves the last of its runs of edges unsorted, and
# so misses neighbours there; now that run has one edge, and the mesh gets what every other of its edges gets.
APART = [((x, y, -1000.0), (0.0, 0.0, 1.0), (x, y)) for x, y in ((900.0, 900.0), (901.0, 900.0), (900.0, 901.0))]


def ask_oracle(folder, meshes):
    """The tangents of all corners of each mesh, with glTF's handedness: the package takes v to point up. Where it finds
    no direction, as where those of the triangles cancel, (1, 0, 0) is as good as any."""
    with tempfile.TemporaryDirectory() as scratch:
        script, asked, answered = (os.path.join(scratch, name) for name in ("oracle.js", "asked", "answered"))
        with open(script, "w", encoding="utf-8") as file:
            file.write(ORACLE)
        with open(asked, "wb") as file:
            for mesh in meshes:
                corners = mesh.corners() + APART
                file.write(struct.pack("<I", len(corners)))
                for part in range(3):
                    for corner in corners:
                        file.write(struct.pack("<%df" % len(corner[part]), *corner[part]))
        modules = os.path.join(os.path.abspath(folder), "node_modules")
        subprocess.run(["node", script, asked, answered], check=True, env={**os.environ, "NODE_PATH": modules})
        with open(answered, "rb") as file:
            numbers = [(t[:3] if any(t[:3]) or t[3] == 0 else (1.0, 0.0, 0.0)) + (-t[3],)
                       for t in struct.iter_unpack("<4f", file.read())]
    tangents = []
    for mesh in meshes:
        count = len(mesh.indices)
        tangents.append(numbers[:count])
        numbers = numbers[count + len(APART):]
    return tangents


def write_binary(path, meshes, tangents):
    with open(path, "wb") as file:
        for mesh, expected in zip(meshes, tangents):
            file.write(struct.pack("<II", len(mesh.vertices), len(mesh.indices)))
            for part in range(3):
                for vertex in mesh.vertices:
                    file.write(struct.pack("<%df" % len(vertex[part]), *vertex[part]))
            file.write(struct.pack("<%dI" % len(mesh.indices), *mesh.indices))
            for tangent in expected:
                file.write(struct.pack("<4f", *tangent))


def named_meshes():
    """A few meshes that each show one rule."""
    up = (0, 0, 1)

    def flat(name, vertices, triangles):
        mesh = Mesh(name)
        for x, y, u, v in vertices:
            mesh.add((x, y, 0), up, (u, v))
        for triangle in triangles:
            mesh.triangle(*triangle)
        return mesh

    tent = Mesh("a bent strip, so that angles weigh")
    for i, (x, z) in enumerate(((0, 0), (1, 0.5), (1.5, 2))):
        for y in (0, 1):
            tent.add((x, y, z), unit((-z, 0.2 * y, 1)), (0.5 * i + 0.1 * y, y))
    for i in (0, 2):
        tent.triangle(i, i + 2, i + 3)
        tent.triangle(i, i + 3, i + 1)
    return [
        flat("a square", [(0, 0, 0, 1), (1, 0, 1, 1), (1, 1, 1, 0), (0, 1, 0, 0)], [(0, 1, 2), (0, 2, 3)]),
        tent,
        flat("a texture mirrored at a shared edge", [(-1, 0, 1, 1), (0, 0, 0, 1), (1, 0, 1, 1), (-1, 1, 1, 0), (0, 1, 0, 0), (1, 1, 1, 0)],
             [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)]),
        flat("two triangles that share a vertex alone", [(0, 0, 0, 0), (1, 0, 1, 0), (1, 1, 1, 1), (-1, 0, 0, -2), (-1, -1, 2, -1)],
             [(0, 1, 2), (0, 3, 4)]),
        flat("a triangle whose coordinates lie on a line", [(0, 0, 0, 0), (1, 0, 1, 0.2), (1, 1, 1, 1), (0, 1, 0, 1), (2, 0, 1, 0.5), (2, 1, 3, 1)],
             [(1, 4, 2), (0, 1, 2), (0, 2, 3), (2, 4, 5)]),
        flat("a triangle with two equal positions", [(0, 0, 0, 0), (1, 0, 1, 0.3), (1, 1, 1, 1), (1, 0, 1, 0.3), (5, 5, 0, 0)],
             [(0, 1, 2), (1, 3, 2), (4, 4, 4)]),
        flat("three triangles at one edge", [(0, 0, 0, 0), (1, 0, 1, 0), (0.3, 1, 0, 1), (0.6, 1, 2, 1), (0.5, -1, 0.3, -1)],
             [(0, 1, 2), (0, 1, 3), (1, 0, 4)]),
        flat("a fan whose ends have opposite directions", [(0, 0, 0, 0), (1, 0, 1, 0), (1, 1, 1, 1), (0, 1, -2, 1), (-1, 1, 1, -1), (-1, 0, 1, 0)],
             [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]),
    ]


def write_store(path, meshes, tangents):
    def number(x):
        return "%.9g" % (x + 0.0) if x == int(x) else "%.9gf" % x

    def vectors(values):
        return "{%s}" % ", ".join("{%s}" % ", ".join(number(x) for x in v) for v in values)

    def write(text):
        file.write(textwrap.fill(text, 118, subsequent_indent=" ") + "\n")

    with open(path, "w", encoding="utf-8") as file:
        file.write("// Meshes and their tangents at each corner by the npm package mikktspace 1.1.1, with glTF's\n"
                   "// handedness. tools/compare_tangents.py --store writes this file.\n")
        for mesh, expected in zip(meshes, tangents):
            write('{.name = "%s",' % mesh.name)
            for part, name in enumerate(("positions", "normals", "uv")):
                write(" .%s = %s," % (name, vectors(v[part] for v in mesh.vertices)))
            write(" .indices = {%s}," % ", ".join(str(i) for i in mesh.indices))
            write(" .tangents = %s}," % vectors(expected))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("oracle", help="the folder with node_modules/mikktspace")
    parser.add_argument("tests", nargs="?", help="pertev_tests")
    parser.add_argument("--meshes", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--glb", nargs="*", default=[])
    parser.add_argument("--store", metavar="FILE")
    arguments = parser.parse_args()
    if arguments.store:
        meshes = named_meshes()
        write_store(arguments.store, meshes, ask_oracle(arguments.oracle, meshes))
        return 0
    if not arguments.tests:
        parser.error("name pertev_tests")
    meshes = random_meshes(arguments.meshes, arguments.seed)
    for path in arguments.glb:
        meshes += read_glb(path)
    tangents = ask_oracle(arguments.oracle, meshes)
    answered = [i for i, expected in enumerate(tangents) if any(t[3] != 0 for t in expected)]
    print("%d meshes, to %d of which mikktspace gives no answer:" % (len(meshes), len(meshes) - len(answered)),
          ", ".join(mesh.name for i, mesh in enumerate(meshes) if i not in set(answered)))
    meshes, tangents = [meshes[i] for i in answered], [tangents[i] for i in answered]
    with tempfile.TemporaryDirectory() as scratch:
        path = os.path.join(scratch, "meshes")
        write_binary(path, meshes, tangents)
        test = "tangents of the meshes in PERTEV_TANGENT_MESHES equal MikkTSpace's"
        return subprocess.run([arguments.tests, "--test-case=" + test],
                              env={**os.environ, "PERTEV_TANGENT_MESHES": path}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
