#!/usr/bin/env python3
"""Finds the numbers by which sheen_lobe.h draws directions: fit_sheen_sampling.py. Needs numpy and scipy; takes minutes.

The density is a mixture of a uniform one, a transformed cosine, and a band near the horizon: sin of half the azimuth
from the view is uniform, and the cosine has a normal distribution of a width that falls with cos of half the azimuth,
as light of Charlie's distribution has that grazes the surface. Shares, widths and the transform are functions of
roughness and of the view's cosine. Their coefficients are those of the least variance and of weights of at most 1.4,
over a grid of both; the result is printed with the largest weight and the largest second moment.
"""
import sys

if __name__ == "__main__" and sys.argv[1:] == ["--help"]:  # packages may be missing
    print(__doc__)
    sys.exit()

import numpy as np
from scipy.optimize import minimize
from scipy.special import erf

kLeastRoughness, kMostWeight, kRounds, kSteps = 0.2, 1.4, 6, 1100
ROUGHNESSES = (0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 1)
VIEWS = (1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.06, 0.12, 0.2, 0.35, 0.6, 0.85, 1)
HEIGHTS, AZIMUTHS = 56, 40  # nodes of the rule over directions; heights gather at the horizon

ROOTS = (np.arange(HEIGHTS) + 0.5) / HEIGHTS
Z, AZIMUTH = np.meshgrid(ROOTS * ROOTS, (np.arange(AZIMUTHS) + 0.5) / AZIMUTHS * np.pi, indexing="ij")
AREA = (2 * ROOTS / HEIGHTS)[:, None] * (2 * np.pi / AZIMUTHS) * np.ones_like(Z)
SINE = np.sqrt(1 - Z * Z)

# The coefficients of sheen_lobe.h: width 0-1, share of the band 2-4, scale 5-7, shear 8-11, uniform share 12,
# of which 0.45 was found: 0.55 bounds the weights of light to the zenith too, which the rule does not reach.
IN_USE = (2.9, -0.1, 0.2, 0.06, 1.94, 0.17, 1, -0.18, -0.85, 1.45, -0.43, -0.7, 0.55)


def formula(roughness, view):
    """Returns value times cosine of Charlie's sheen, before the division that keeps its energy."""
    across = np.sqrt(1 - view * view)
    length2 = 2 * (1 + view * Z + across * SINE * np.cos(AZIMUTH))
    sine2 = np.clip(1 - (view + Z) ** 2 / np.maximum(length2, 1e-12), 0, 1)
    distribution = (2 + roughness**-2) / (2 * np.pi) * sine2 ** (0.5 * roughness**-2)
    return distribution * Z / (4 * (view + Z - view * Z))


def values():
    """Returns value times cosine for each roughness and view."""
    all_values = []
    for roughness in ROUGHNESSES:
        there = np.array([(formula(roughness, z) * AREA).sum() for z in Z[:, 0]])[:, None]
        for view in VIEWS:
            value = formula(roughness, view)
            all_values.append(value / np.maximum(1, np.maximum(there, (value * AREA).sum())))
    return np.array(all_values)


def density(x):
    r = np.repeat(ROUGHNESSES, len(VIEWS))[:, None, None]
    z = np.tile(VIEWS, len(ROUGHNESSES))[:, None, None]
    uniform = np.clip(x[12] * (r - kLeastRoughness), 0, 1)
    band = (1 - uniform) / np.maximum(1 + x[2] * r + z * (x[3] + x[4] * z) / (r * r), 1)
    width = r * (x[0] + x[1] * r)
    spread = width * np.cos(AZIMUTH / 2)
    of_band = np.exp(-((Z / spread) ** 2)) / (2 * np.sqrt(np.pi) * width * erf(1 / spread))
    scale = np.maximum(x[5] + x[6] * r + x[7] * z, 0.05)
    shear = (x[8] + x[9] * r + np.sqrt(z) * (x[10] + x[11] * r)) * np.sqrt(1 - z * z)
    length2 = scale**2 * SINE**2 + 2 * scale * shear * SINE * np.cos(AZIMUTH) * Z + (shear**2 + 1) * Z * Z
    of_cosine = scale**2 * Z / (np.pi * length2 * length2)
    return uniform / (2 * np.pi) + band * of_band + (1 - uniform - band) * of_cosine


def main():
    value = values()
    albedo = (value * AREA).sum((1, 2))

    def measure(x):
        weight = value / density(x)
        return weight.max((1, 2)), (weight * value * AREA).sum((1, 2))

    def cost(x):
        largest, second = measure(x)
        variance = 3 * ((second / albedo**2 - 1) * (albedo + 0.1)).mean() + 0.3 * np.maximum(second - 1, 0).max()
        excess = largest - kMostWeight
        total = variance + 1.5 * np.maximum(excess, 0).max() + 0.1 * np.maximum(excess + 0.05, 0).sum()
        return total if np.isfinite(total) else 1e9

    def show(name, x):
        largest, second = measure(x)
        print(f"{name}: {np.round(x, 3).tolist()}; largest weight {largest.max():.3f}, second moment {second.max():.3f}", flush=True)

    np.seterr(all="ignore")
    show("in use", np.array(IN_USE))
    x = np.array(IN_USE)
    for _ in range(kRounds):
        x = minimize(cost, x, method="Nelder-Mead", options={"maxfev": kSteps, "adaptive": True, "xatol": 1e-4, "fatol": 1e-6}).x
        show("found", x)


if __name__ == "__main__":
    main()
