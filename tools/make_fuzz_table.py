#!/usr/bin/env python3
"""Writes src/shading/lobes/fuzz_table.inl, the numbers of fuzz_lobe.h. Needs numpy and scipy; takes ten minutes.

Light is followed through a layer of upright fibres: depth 1 and density 1, specular SGGX flakes of width roughness^2
along the normal, which absorb nothing (Zeltner, Burley, Chiang, "Practical Multiple-Scattering Sheen Using Linearly
Transformed Cosines", 2022). For each roughness and cosine of the view, a transformed cosine is fitted to the directions
in which it leaves (greatest likelihood). The lobe takes the harmonic mean of both directions' fits, which is reciprocal;
their magnitudes are found so that its albedo is that of the layer, or as much as samples of a weight below kMostWeight
return.

A row of the table is a node: a, b / sine of the view, the magnitude, and the albedo, rather too much between nodes.
"""
import pathlib
import sys

if __name__ == "__main__" and sys.argv[1:] == ["--help"]:  # packages may be missing
    print(__doc__)
    sys.exit()

import numpy as np
from scipy.optimize import minimize

kRoughnessNodes, kMuNodes, kRoughnessMin = 16, 20, 0.1
kCount, kMostWeight = 600_000, 1.42
kOutput = pathlib.Path(__file__).parent.parent / "src/shading/lobes/fuzz_table.inl"

ROUGHNESSES = kRoughnessMin + (1 - kRoughnessMin) * np.arange(kRoughnessNodes) / (kRoughnessNodes - 1)
COSINES = np.maximum((np.arange(kMuNodes) / (kMuNodes - 1)) ** 2, 2e-4)


def leaving_directions(mu, width, count, random):
    """Returns the directions (3, n) in which light from cosine `mu` and azimuth 0 leaves the layer upwards."""
    direction = np.repeat([[-np.sqrt(1 - mu * mu)], [0], [-mu]], count, axis=1)
    depth = np.zeros(count)
    stretch = np.array([1, 1, width])[:, None]
    leaving = []
    while direction.shape[1] > 0:
        area = np.sqrt(((stretch * direction) ** 2).sum(0))
        depth = depth - direction[2] * -np.log1p(-random.random(len(depth))) / area
        leaving.append(direction[:, depth < 0])
        inside = (depth >= 0) & (depth <= 1)
        direction, depth = direction[:, inside], depth[inside]
        if len(depth) == 0:
            break
        # Flakes are the normals of an ellipsoid, a stretched ball.
        view = -stretch * direction
        view /= np.sqrt((view * view).sum(0))
        radius, angle = np.sqrt(random.random(len(depth))), 2 * np.pi * random.random(len(depth))
        sign = np.where(view[2] < 0, -1.0, 1.0)
        p = -1 / (sign + view[2])
        q = view[0] * view[1] * p
        across = np.stack([1 + sign * view[0] ** 2 * p, sign * q, -sign * view[0]])
        aside = np.stack([q, sign + view[1] ** 2 * p, -view[1]])
        flake = stretch * (radius * np.cos(angle) * across + radius * np.sin(angle) * aside +
                           np.sqrt(1 - radius * radius) * view)
        flake /= np.sqrt((flake * flake).sum(0))
        direction = direction - 2 * (flake * direction).sum(0) * flake
    return np.concatenate(leaving, axis=1)


def fit_layer():
    """Returns a, b / sine and the albedo of each node."""
    random = np.random.default_rng(7)
    nodes = np.zeros((kRoughnessNodes, kMuNodes, 3))
    for r in reversed(range(kRoughnessNodes)):
        for m, mu in enumerate(COSINES):
            x, y, z = leaving_directions(mu, ROUGHNESSES[r] ** 2, kCount, random)
            nodes[r, m, 2] = len(x) / kCount
            if m > 0 and (len(x) < 2e-3 * kCount or m == kMuNodes - 1):  # too dark for a fit, or without an azimuth
                nodes[r, m, :2] = nodes[r, m - 1, :2]
                continue
            z, sine = np.maximum(z, 1e-7), np.sqrt(1 - mu * mu)
            best = None
            for start in [nodes[min(r + 1, kRoughnessNodes - 1), m], nodes[r, max(m - 1, 0)]]:
                if start[0] == 0:
                    start = [0.8, 0]
                found = minimize(lambda p: 2 * np.mean(np.log((np.exp(p[0]) * x + p[1] * sine * z) ** 2 +
                                                              (np.exp(p[0]) * y) ** 2 + z * z) - p[0]),
                                 [np.log(start[0]), start[1]], method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-8})
                if best is None or found.fun < best.fun:
                    best = found
            nodes[r, m, :2] = np.exp(best.x[0]), best.x[1]
        print(f"roughness {ROUGHNESSES[r]:.2f}", flush=True)
    return nodes


HEIGHTS, WEIGHTS = np.polynomial.legendre.leggauss(160)
HEIGHTS, WEIGHTS = (HEIGHTS + 1) / 2, WEIGHTS / 2
ANGLES = (np.arange(64) + 0.5) / 64 * np.pi


def at(row, x):
    """Interpolates a row of nodes (kMuNodes, n) at x = sqrt(cosine)."""
    place = np.asarray(x) * (kMuNodes - 1)
    i = np.minimum(place.astype(int), kMuNodes - 2)
    return row[i] + (row[i + 1] - row[i]) * (place - i)[..., None]


def lobe(view, mu, from_cosine, to_cosine, cos_angle):
    a, b = view[..., 0], view[..., 1]
    s_o, s_i = np.sqrt(1 - from_cosine**2), np.sqrt(1 - to_cosine**2)
    d = a * a * s_i * s_i + 2 * a * b * s_o * s_i * cos_angle * to_cosine + (b * b * s_o * s_o + 1) * to_cosine**2
    return a * a / (np.pi * d * d)


def albedo_and_weight(row, mu):
    """Returns the albedo at a cosine of the lobe of a row (a, b / sine, magnitude), and the largest weight of a sample."""
    here, there = at(row, np.sqrt(mu)), at(row, HEIGHTS)[:, None, :]
    cosines, turn = (HEIGHTS**2)[:, None], np.cos(ANGLES)[None, :]
    f = here[2] * lobe(here, mu, mu, cosines, turn)
    g = there[..., 2] * lobe(there, mu, cosines, mu, turn)
    share = g / (f + g + 1e-30)
    value = 2 * f * share
    return (value * (2 * HEIGHTS * WEIGHTS)[:, None] * cosines).sum() * 2 * np.pi / len(ANGLES), (2 * here[2] * share).max()


def tabulate(nodes):
    table = np.zeros((kRoughnessNodes, kMuNodes, 4))
    table[..., :3] = nodes
    for r in range(kRoughnessNodes):
        for _ in range(40):
            found = np.array([albedo_and_weight(table[r], mu) for mu in COSINES])
            table[r, :, 2] *= np.minimum(nodes[r, :, 2] / (found[:, 0] + 1e-12), kMostWeight / (found[:, 1] + 1e-12))
        table[r, :, 3] = [albedo_and_weight(table[r], mu)[0] for mu in COSINES]
    # Between the nodes too no more light is scattered than the albedo says.
    for _ in range(3):
        for r in range(kRoughnessNodes - 1):
            for m in range(kMuNodes - 1):
                excess = 0
                for p in (0, 0.5):
                    row = table[r] + p * (table[r + 1] - table[r])
                    for q in (0, 0.25, 0.5, 0.75):
                        x = (m + q) / (kMuNodes - 1)
                        excess = max(excess, albedo_and_weight(row, max(x * x, 1e-6))[0] - at(row, x)[3])
                table[r : r + 2, m : m + 2, 3] += max(excess, 0)
    lines = ["// Written by tools/make_fuzz_table.py: a, b / sine, magnitude and albedo of each cosine, by roughness.\n"]
    for row in table.reshape(-1, 4):
        lines.append("".join(f"{v:.5g}f, " if v % 1 else f"{v:.1f}f, " for v in row).rstrip() + "\n")
    kOutput.write_text("".join(lines))


if __name__ == "__main__":
    tabulate(fit_layer())
