#!/usr/bin/env python3
"""Writes src/shading/lobes/sheen_table_data.h: the directional albedo of the sheen lobe.

Run from anywhere, needs numpy, takes seconds:  tools/make_sheen_table.py

The integral of D V cos(wi) over the hemisphere, by a product rule: Gauss-Legendre in the square root of the height, midpoints
about the normal. Lobe and axes are stated in src/shading/lobes/sheen_lobe.h, which must agree with this file.
"""

import pathlib

import numpy as np

from make_energy_tables import array, lowered, tabulate

MU_NODES, ROUGHNESS_NODES, ROUGHNESS_MIN = 24, 16, 0.2

_x, _w = np.polynomial.legendre.leggauss(96)
Z, WEIGHT = (((_x + 1) / 2) ** 2)[:, None], (_w / 2 * (_x + 1))[:, None]
PHI = ((np.arange(96) + 0.5) / 96 * np.pi)[None, :]


def albedo(mu, alpha):
    across_o, across_i = np.sqrt(1 - mu * mu), np.sqrt(1 - Z * Z)
    x, y, z = across_o + across_i * np.cos(PHI), across_i * np.sin(PHI), mu + Z
    sine2 = (x * x + y * y) / (x * x + y * y + z * z)
    d = (2 + 1 / alpha) / (2 * np.pi) * sine2 ** (0.5 / alpha)
    return np.sum(WEIGHT * d * Z / (4 * (mu + Z - mu * Z))) * 2 * np.pi / 96


def main():
    # Rather too much than too little, since what the sheen takes the lobes beneath do not get: turned over, so that
    # lowered() raises it.
    def value(r, x):
        return 4 - albedo(max(x * x, 1e-7), (ROUGHNESS_MIN + (1 - ROUGHNESS_MIN) * r) ** 2)

    table = 4 - lowered(value, tabulate(value, (ROUGHNESS_NODES, MU_NODES)))
    header = f"""#pragma once

// Written by tools/make_sheen_table.py: run it again instead of editing. Meaning and axes: sheen_lobe.h.

#include "base/host_device.h"

// clang-format off
namespace pertev::sheen_table {{

inline constexpr int kMuNodes = {MU_NODES}, kRoughnessNodes = {ROUGHNESS_NODES};
inline constexpr float kRoughnessMin = {ROUGHNESS_MIN:g}f;

"""
    body = array("float", "albedo_at", table.reshape(-1), "[roughness][mu]")
    path = pathlib.Path(__file__).resolve().parent.parent / "src/shading/lobes/sheen_table_data.h"
    path.write_text(header + body + "\n} // namespace pertev::sheen_table\n// clang-format on\n")


if __name__ == "__main__":
    main()
