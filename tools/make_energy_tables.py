#!/usr/bin/env python3
"""Writes src/shading/lobes/energy_table_data.h: how much energy GGX microfacets lose to single scattering.

Run from anywhere, needs numpy, takes about two minutes of one core:  tools/make_energy_tables.py

Each value is an integral over the distribution of visible normals (Heitz 2018; Dupuy and Benyoub 2023 for the warp),
done with a product rule: Gauss-Legendre along the cap's height, midpoints about its axis (the integrand is even and
periodic there). Axes and meaning are stated in src/shading/lobes/energy_tables.h, which must agree with this file.

The tables are interpolated linearly. Where the chord lies above the curve a lookup would give energy away that was
never lost, so nodes are lowered where the inside of a cell overshoots by more than OVERSHOOT.
"""

import pathlib
import sys

import numpy as np

MU_NODES, R_NODES, ETA_NODES, AVERAGE_NODES = 36, 20, 14, 64
ALPHA_MIN, ETA_MIN, ETA_MAX = 1e-3, 1.1, 3.0
R_MIN = np.sqrt(ALPHA_MIN)
OVERSHOOT = 2e-4


def kappa_sqrt(eta):
    return np.sqrt((eta - 1) / (eta + 1))


Q_MIN, Q_MAX = kappa_sqrt(ETA_MIN), kappa_sqrt(ETA_MAX)

_x, _w = np.polynomial.legendre.leggauss(96)
_x, _w = (_x + 1) / 2, _w / 2
U = (_x * _x * (3 - 2 * _x))[:, None]  # nodes gather at both ends of the cap
PHI = ((np.arange(48) + 0.5) / 48 * np.pi)[None, :]
WEIGHT = np.repeat((_w * 6 * _x * (1 - _x) / 48)[:, None], 48, 1)
COS_PHI, SIN_PHI = np.cos(PHI), np.sin(PHI)


def visible_normals(mu, alpha):
    wx, wz = np.sqrt(max(0.0, 1 - mu * mu)) * alpha, mu
    norm = np.hypot(wx, wz)
    wx, wz = wx / norm, wz / norm
    t = U * (1 + wz)
    s = np.sqrt(t * (2 - t))
    x, y, z = alpha * (s * COS_PHI + wx), alpha * (s * SIN_PHI), 1 - t + wz
    norm = np.sqrt(x * x + y * y + z * z)
    return x / norm, z / norm


def smith_lambda(z, alpha):
    z2 = np.maximum(z * z, 1e-24)
    return 0.5 * (np.sqrt(1 + alpha * alpha * np.maximum(0, 1 - z2) / z2) - 1)


def fresnel(c, eta):
    """Reflectance and cosine of refraction; eta is the far side's index over the near side's."""
    t2 = 1 - (1 - c * c) / (eta * eta)
    t = np.sqrt(np.maximum(0, t2))
    rs, rp = (c - eta * t) / (c + eta * t), (eta * c - t) / (eta * c + t)
    return np.where(t2 <= 0, 1.0, 0.5 * (rs * rs + rp * rp)), t


def scattered(mu, alpha, eta=None):
    """(energy, energy weighted by (1 - cos)^5) of one bounce with F = 1, or of reflection and refraction at eta."""
    mx, mz = visible_normals(mu, alpha)
    c = np.clip(np.sqrt(max(0.0, 1 - mu * mu)) * mx + mu * mz, 0, 1)
    lam = smith_lambda(np.float64(mu), alpha)

    def masking(z, ok):
        return np.where(ok, (1 + lam) / (1 + lam + smith_lambda(z, alpha)), 0)

    z = 2 * c * mz - mu
    g = masking(z, z > 0)
    if eta is None:
        return np.sum(WEIGHT * g), np.sum(WEIGHT * g * (1 - c) ** 5)
    f, t = fresnel(c, eta)
    z = (c / eta - t) * mz - mu / eta
    return np.sum(WEIGHT * (f * g + (1 - f) * masking(z, z < 0))), 0.0


def mu_at(x, alpha):
    p = x * (MU_NODES - 1)
    x = np.where(p < 1, np.sqrt(p), p) / (MU_NODES - 1)  # in the first cell the curves are linear in mu
    t = alpha * x * x
    return np.maximum(t / ((1 - x) ** 2 + t), 1e-7)


def x_at(mu, alpha):
    p = np.sqrt(mu) / (np.sqrt(mu) + np.sqrt(alpha * (1 - mu))) * (MU_NODES - 1)
    return np.where(p < 1, p * p, p) / (MU_NODES - 1)


def alpha_at(r):
    return (R_MIN + (1 - R_MIN) * r) ** 2


def eta_at(q):
    k = (Q_MIN + (Q_MAX - Q_MIN) * q) ** 2
    return (1 + k) / (1 - k)


def nodes(n):
    return np.arange(n) / (n - 1)


def lowered(value_at, table):
    """`table` over nodes of each axis, lowered where linear interpolation overshoots inside a cell."""
    corners = np.stack(np.meshgrid(*[[0, 1]] * table.ndim, indexing="ij"), -1).reshape(-1, table.ndim)
    inner = [n - 1 for n in table.shape]
    # The middle of the cell, of each face and of each edge, and three places along mu, where the curves bend most.
    places = np.stack(np.meshgrid(*[[0, 0.5]] * (table.ndim - 1), [0, 0.25, 0.5, 0.75], indexing="ij"), -1)
    checks = []
    for place in places.reshape(-1, table.ndim)[1:]:  # the first is a corner
        counts = [n - 1 if p else n for n, p in zip(table.shape, place)]
        grid = [(np.arange(c) + p) / (n - 1) for c, p, n in zip(counts, place, table.shape)]
        points = np.stack(np.meshgrid(*grid, indexing="ij"), -1).reshape(-1, table.ndim)
        checks.append((place, counts, np.array([value_at(*p) for p in points]).reshape(counts)))

    for _ in range(4):  # a node that would fall below 0 leaves the rest to its neighbours
        excess, worst = np.zeros(inner), 0
        for place, counts, truth in checks:
            error = -truth
            for corner in corners:
                weight = np.prod(np.where(corner == 1, place, 1 - place))
                if weight > 0:
                    error = error + weight * table[tuple(slice(c, c + k) if p else slice(0, k)
                                                         for c, k, p in zip(corner, counts, place))]
            worst = max(worst, error.max())
            for corner in corners:  # a face belongs to both cells beside it
                if np.all((corner == 0) | (place == 0)):
                    part = error[tuple(slice(c, c + k) if p == 0 else slice(None)
                                       for c, k, p in zip(corner, inner, place))]
                    excess = np.maximum(excess, part - OVERSHOOT)
        print(f"  largest overshoot {worst:.5f}", file=sys.stderr)
        drop = np.zeros(table.shape)
        for corner in corners:
            at = tuple(slice(c, c + k) for c, k in zip(corner, inner))
            drop[at] = np.maximum(drop[at], excess)
        table = np.maximum(table - drop, 0)
    return table


def tabulate(value_at, shape):
    grid = np.stack(np.meshgrid(*[nodes(n) for n in shape], indexing="ij"), -1).reshape(-1, len(shape))
    return np.array([value_at(*p) for p in grid]).reshape(shape)


def interpolate(table, position):
    """Linear interpolation of the first axes of `table` at one position in [0, 1] each, as energy_tables.h does it."""
    for p in position:
        n = table.shape[0]
        i = min(int(p * (n - 1)), n - 2)
        f = p * (n - 1) - i
        table = (1 - f) * table[i] + f * table[i + 1]
    return table


_am, _aw = np.polynomial.legendre.leggauss(400)
_am, _aw = ((_am + 1) / 2) ** 2, _aw / 2 * (_am + 1)  # mu = x^2: dmu = 2 x dx
AVERAGE_WEIGHT = 2 * _am * _aw
AVERAGE_R = nodes(AVERAGE_NODES) ** 2  # dense where roughness is least: there the averages change the fastest


def average(row, alpha):
    """2 int row(mu) mu dmu, where `row` holds values at the nodes of x."""
    return np.sum(AVERAGE_WEIGHT * np.interp(x_at(_am, alpha), nodes(MU_NODES), row))


def quantised(table):
    return np.round(np.clip(table, 0, 1) * 65535).astype(int)


def array(kind, name, values, comment):
    out = [f"/// {comment}", f"HD inline {kind} {name}(int i) {{", f"    static constexpr {kind} k[] = {{"]
    line = "       "
    for v in values:
        text = f" {v}," if kind == "uint16_t" else f" {float(np.float32(v)):.9g}f,".replace(" 0f", " 0.0f")
        if len(line) + len(text) > 118:
            out.append(line)
            line = "       "
        line += text
    return "\n".join(out + [line, "    };", "    return k[i];", "}", ""])


def main():
    print("metal", file=sys.stderr)
    metal = lambda r, x: 1 - scattered(mu_at(x, alpha_at(r)), alpha_at(r))[0]
    lost = quantised(lowered(metal, tabulate(metal, (R_NODES, MU_NODES))))
    # Schlick's weight of the half vector less that of mu itself: goes to 0 with alpha. Rather too much than too little,
    # since what the coat takes the base does not get.
    def schlick(r, x):
        mu = mu_at(x, alpha_at(r))
        e, b = scattered(mu, alpha_at(r))
        return 0.5 * (1 - (b / e - (1 - mu) ** 5))
    schlick_part = quantised(1 - lowered(schlick, tabulate(schlick, (R_NODES, MU_NODES))))

    average_lost, average_schlick = [], []
    for r in AVERAGE_R:
        row = interpolate(lost / 65535, [r])
        average_lost.append(average(row, alpha_at(r)) / alpha_at(r))
        x = x_at(_am, alpha_at(r))
        e = 1 - np.interp(x, nodes(MU_NODES), row)
        b = (1 - _am) ** 5 + 2 * np.interp(x, nodes(MU_NODES), interpolate(schlick_part / 65535, [r])) - 1
        average_schlick.append(np.sum(AVERAGE_WEIGHT * e * b))

    glass, average_glass = [], []
    for inside in (False, True):
        print("dielectric,", "inside" if inside else "outside", file=sys.stderr)
        def value(q, r, x):
            eta = eta_at(q)
            return 1 - scattered(mu_at(x, alpha_at(r)), alpha_at(r), 1 / eta if inside else eta)[0]
        table = quantised(lowered(value, tabulate(value, (ETA_NODES, R_NODES, MU_NODES))))
        glass.append(table)
        average_glass.append([[average(interpolate(table[q] / 65535, [r]), alpha_at(r)) / alpha_at(r)
                               for r in AVERAGE_R] for q in range(ETA_NODES)])

    flat = lambda t: np.asarray(t).reshape(-1)
    header = f"""#pragma once

// Written by tools/make_energy_tables.py: run it again instead of editing. Meaning and axes: energy_tables.h.
// The arrays stand inside functions because that is where device code may read a constexpr array.

#include <cstdint>

#include "base/host_device.h"

// clang-format off
namespace pertev::energy_table {{

inline constexpr int kMuNodes = {MU_NODES}, kRoughnessNodes = {R_NODES}, kIorNodes = {ETA_NODES}, kAverageNodes = {AVERAGE_NODES};
inline constexpr float kAlphaMin = {ALPHA_MIN:g}f, kIorMin = {ETA_MIN:g}f, kIorMax = {ETA_MAX:.1f}f;

"""
    body = [
        array("uint16_t", "metal_lost_at", flat(lost), "65535 (1 - E), F = 1: [roughness][mu]"),
        array("uint16_t", "metal_schlick_at", flat(schlick_part), "65535 (1 + B / E - (1 - mu)^5) / 2: [roughness][mu]"),
        array("float", "metal_average_lost_at", average_lost, "average of 1 - E, over alpha: [roughness]"),
        array("float", "metal_average_schlick_at", average_schlick, "average of B: [roughness]"),
        array("uint16_t", "glass_lost_at", flat(glass), "65535 (1 - E): [outside, inside][ior][roughness][mu]"),
        array("float", "glass_average_lost_at", flat(average_glass),
              "average of 1 - E, over alpha: [outside, inside][ior][roughness]"),
    ]
    path = pathlib.Path(__file__).resolve().parent.parent / "src/shading/lobes/energy_table_data.h"
    path.write_text(header + "\n".join(body) + "\n} // namespace pertev::energy_table\n// clang-format on\n")


if __name__ == "__main__":
    main()
