#!/usr/bin/env python3
"""Writes the scenes of rays on the record that are made (docs/ray_sets.md): tools/make_record_scenes.py SCENES

SCENES is the folder that PERTEV_SCENES names (docs/scenes.md). It gets record/forest.ply, 280 MB, and, where it has
stanford/bunny.obj, record/bunny.ply. Their bits are the same on every machine: floats are rounded as src/math rounds them, operation by
operation. Needs numpy.
"""

import pathlib
import sys

if __name__ == "__main__" and sys.argv[1:] == ["--help"]:  # packages may be missing
    print(__doc__)
    sys.exit()

import numpy as np

F = np.float32
np.seterr(over="ignore")  # words of a hash wrap

# The seeds are such that no leaves hide the record's camera and as many of its rays hit as in the record.
GROUND_NUMBERS, TREE_NUMBERS, LEAF_NUMBERS = 1144, 4, 0x4C454146
SIDE, HILLS, CELL, OCTAVES = F(200), F(12), F(50), 6  # metres: the ground's side, its noise's amplitude and its coarsest cells
SIDES, RINGS = 6, 4  # a trunk has
WALL_QUADS, ROUGHNESS = 32, F(0.05)  # quads along each side of a wall, and roughness by the length of an edge


def unit(x, y, z):
    """Numbers in [0, 1): the first word of hash_words in src/math/random.h."""
    x, y, z = (np.asarray(word, np.uint32) * np.uint32(1664525) + np.uint32(1013904223) for word in (x, y, z))
    x = x + y * z
    y = y + z * x
    z = z + x * y
    x, y, z = (word ^ (word >> np.uint32(16)) for word in (x, y, z))
    return ((x + y * z) >> np.uint32(8)).astype(F) * F(2**-24)


def between(number, low, high):
    return F(low) + number * (F(high) - F(low))


def fma(a, b, c):
    return (np.asarray(a, np.float64) * b + c).astype(F)


def polynomial(x, *coefficients):
    p = F(float.fromhex(coefficients[0]))
    for coefficient in coefficients[1:]:
        p = fma(p, x, F(float.fromhex(coefficient)))
    return p


def sin_cos_of_turns(u):
    """sin_cos_2pi of src/math/portable_trig.h."""
    q = (F(4) * u + F(1.5 * 2**23)) - F(1.5 * 2**23)
    f = fma(q, F(-0.25), u)
    square, quadrant = f * f, q.astype(np.int64)
    p = polynomial(square, "0x1.443a72p5", "-0x1.32adaap6", "0x1.466b78p6", "-0x1.4abbcep5", "-0x1.777a5cp-23")
    r = polynomial(square, "0x1.846342p6", "0x1.bb9a7ap5", "-0x1.5591aep6", "0x1.03c196p6", "-0x1.3bd3ccp4")
    a, b = fma(f, F(float.fromhex("0x1.921fb6p2")), f * p), fma(r, square, F(1))
    s, c = np.where(quadrant & 1, b, a), np.where(quadrant & 1, a, b)
    return np.where(quadrant & 2, -s, s), np.where((quadrant + 1) & 2, -c, c)


def vector(*components):
    return np.stack(np.broadcast_arrays(*components), -1).astype(F)


def dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def normalized(a):
    """Unit vectors; zero for zero."""
    squared = dot(a, a)[..., None]
    return np.where(squared > 0, (F(1) / np.sqrt(np.where(squared > 0, squared, F(1)))) * a, F(0))


def direction_at_height(z, turns):
    radius = np.sqrt(np.maximum(fma(-z, z, F(1)), F(0)))
    sine, cosine = sin_cos_of_turns(turns)
    return vector(radius * cosine, radius * sine, z)


def frame_about(n):
    """Tangent and bitangent as src/math/frame.h has them."""
    x, y, z = n[..., 0], n[..., 1], n[..., 2]
    sign = np.copysign(F(1), z)
    a = F(-1) / (sign + z)
    b = x * y * a
    return vector(F(1) + sign * x * x * a, sign * b, -sign * x), vector(b, sign + y * y * a, -y)


def ground_height(x, z):
    def smooth(t):
        return t * t * (F(3) - F(2) * t)

    def noise(x, z, octave):
        fx, fz = np.floor(x), np.floor(z)
        (a, b), (c, d) = ([unit((fx.astype(np.int64) + i).astype(np.uint32), (fz.astype(np.int64) + j).astype(np.uint32), GROUND_NUMBERS + octave)
                           for i in (0, 1)] for j in (0, 1))
        s, t = smooth(x - fx), smooth(z - fz)
        low, high = a + s * (b - a), c + s * (d - c)
        return low + t * (high - low)

    total, weights, weight, scale = F(0), F(0), F(1), F(1) / CELL
    for octave in range(OCTAVES):
        total, weights = total + weight * noise(scale * x, scale * z, octave), weights + weight
        weight, scale = weight * F(0.5), scale * F(2)
    return HILLS * (total / weights)


def grid(quads, order):
    """Triangles of quads x quads vertices' quads; `order` has each quad's corners, (across, up)."""
    first = (np.arange(quads)[:, None] * (quads + 1) + np.arange(quads)).ravel()
    a, b, c, d = (first + i + j * (quads + 1) for i, j in order)
    return np.stack([a, b, c, a, c, d], -1).reshape(-1, 3)


def make_forest(ground_quads=700, trees=1200, leaves=3000):
    """Positions and triangles: the ground, then each tree with its trunk and leaves."""
    at = SIDE * (np.arange(ground_quads + 1).astype(F) / F(ground_quads) - F(0.5))
    x, z = np.meshgrid(at, at)
    positions = [vector(x, ground_height(x, z), z).reshape(-1, 3)]
    triangles = [grid(ground_quads, [(0, 0), (0, 1), (1, 1), (1, 0)])]
    ring, side = np.divmod(np.arange(SIDES * (RINGS - 1)), SIDES)
    a, d = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
    trunk = np.stack([a, a + SIDES, d + SIDES, a, d + SIDES, d], -1).reshape(-1, 3)
    leaf = 4 * np.arange(leaves)[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]]) + SIDES * RINGS
    sine, cosine = sin_cos_of_turns(np.arange(SIDES).astype(F) / F(SIDES))
    up = (np.arange(RINGS).astype(F) / F(RINGS - 1))[:, None]
    for tree in range(trees):
        x, z, height, radius, tall = (unit(TREE_NUMBERS, tree, k) for k in range(5))
        x, z = between(x, F(-0.5) * SIDE, F(0.5) * SIDE), between(z, F(-0.5) * SIDE, F(0.5) * SIDE)
        height, radius = between(height, 5, 11), between(radius, 1.6, 3.2)
        foot = vector(x, ground_height(np.array([x]), np.array([z]))[0] - F(0.2), z)
        r = F(0.03) * height * (F(1) - F(0.6) * up)
        triangles += [part.reshape(-1, 3) + sum(map(len, positions)) for part in (trunk, leaf)]
        positions.append((foot + vector(r * cosine, up * height, r * sine)).reshape(-1, 3))
        radii, crown = vector(radius, radius * between(tall, 1, 1.5), radius), foot + vector(F(0), height, F(0))
        positions.append(make_leaves(tree, leaves, crown, radii))
    return np.concatenate(positions), np.concatenate(triangles)


def make_leaves(tree, leaves, crown, radii):
    around, height, out, turn, tilt, spin, half = unit(LEAF_NUMBERS, tree, 7 * np.arange(leaves) + np.arange(7)[:, None])
    p = crown + radii * (np.sqrt(np.sqrt(out))[:, None] * direction_at_height(between(height, -1, 1), around))
    tangent, bitangent = frame_about(direction_at_height(between(tilt, -1, 1), turn))
    sine, cosine, half = (values[:, None] for values in (*sin_cos_of_turns(spin), between(half, 0.06, 0.12)))
    along, across = half * (cosine * tangent + sine * bitangent), F(0.6) * half * (cosine * bitangent - sine * tangent)
    return np.stack([p - along - across, p + along - across, p + along + across, p - along + across], 1).reshape(-1, 3)


def subdivide(positions, triangles):
    """Each triangle becomes four; a new vertex lies off the middle of its edge, on a smooth surface and by up to 5 % of the edge beside it."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    e, f = b - a, c - a
    normals = np.zeros_like(positions)
    normal = vector(*(e[:, i] * f[:, j] - e[:, j] * f[:, i] for i, j in ((1, 2), (2, 0), (0, 1))))
    np.add.at(normals, triangles.ravel(), np.repeat(normal, 3, axis=0))
    normals = normalized(normals)
    ends = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
    _, first, number = np.unique(ends[:, 0] << 32 | ends[:, 1], return_index=True, return_inverse=True)
    order = np.argsort(first)
    low, high = ends[first[order]].T
    a, b, na, nb = positions[low], positions[high], normals[low], normals[high]
    bulge = F(0.125) * dot(nb - na, b - a)
    rough = (F(2) * unit(low.astype(np.uint32), high.astype(np.uint32), 1) - F(1)) * ROUGHNESS * np.sqrt(dot(b - a, b - a))
    middles = F(0.5) * (a + b) + (bulge + rough)[:, None] * normalized(na + nb)
    ab, bc, ca = (len(positions) + np.argsort(order)[number].reshape(-1, 3)).T
    a, b, c = triangles.T
    return np.concatenate([positions, middles]), np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], -1).reshape(-1, 3)


def make_bunny(obj):
    """The mesh of an OBJ, sixteen times finer, 2 high on the floor of a box without front and ceiling."""
    lines = [line.split() for line in obj.read_text().splitlines()]
    positions = np.array([[float(c) for c in words[1:4]] for words in lines if words[:1] == ["v"]]).astype(F)
    triangles = np.array([[int(c.split("/")[0]) - 1 for c in words[1:4]] for words in lines if words[:1] == ["f"]])
    _, first, number = np.unique(triangles, return_index=True, return_inverse=True)  # vertices in the order in which triangles name them
    positions, triangles = positions[triangles.ravel()[np.sort(first)]], np.argsort(np.argsort(first))[number].reshape(-1, 3)
    positions, triangles = subdivide(*subdivide(positions, triangles))
    low, high = positions.min(0), positions.max(0)
    middle = F(0.5) * (low + high)
    parts, faces = [F(2) / (high - low)[1] * (positions - vector(middle[0], low[1], middle[2]))], [triangles]
    share = np.arange(WALL_QUADS + 1).astype(F) / F(WALL_QUADS)
    for corner, across, up in (((-3, 0, 3), (6, 0, 0), (0, 0, -6)), ((-3, 0, -3), (6, 0, 0), (0, 4, 0)),
                               ((-3, 0, 3), (0, 0, -6), (0, 4, 0)), ((3, 0, -3), (0, 0, 6), (0, 4, 0))):
        faces.append(grid(WALL_QUADS, [(0, 0), (1, 0), (1, 1), (0, 1)]) + sum(map(len, parts)))
        parts.append((vector(*map(F, corner)) + share[:, None] * vector(*map(F, across)) + share[:, None, None] * vector(*map(F, up))).reshape(-1, 3))
    return np.concatenate(parts), np.concatenate(faces)


def write_ply(path, positions, triangles):
    path.parent.mkdir(exist_ok=True)
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<u4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\nproperty float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n"
    path.write_bytes(head.encode() + positions.astype("<f4").tobytes() + faces.tobytes())


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    scenes = pathlib.Path(arguments[0])
    if (scenes / "stanford/bunny.obj").exists():
        write_ply(scenes / "record/bunny.ply", *make_bunny(scenes / "stanford/bunny.obj"))
    write_ply(scenes / "record/forest.ply", *make_forest())


if __name__ == "__main__":
    main(sys.argv[1:])
