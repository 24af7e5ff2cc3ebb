#!/usr/bin/env python3
"""Prints the polynomial coefficients of src/math/portable_*.h, with the error of each polynomial (needs mpmath and numpy).

Each is the minimax fit of a weighted function on an interval, by Lawson's iteration. Coefficients are rounded to float
from the lowest degree up, and the rest is fitted again after each rounding, so that the higher ones take up the error.
"""

import struct
import sys

if __name__ == "__main__" and sys.argv[1:] == ["--help"]:  # packages may be missing
    print(__doc__)
    sys.exit()

import numpy
from mpmath import mp, mpf, acos, asin, atan, cos, exp, log, pi, sin, sqrt, tan

mp.dps = 50
GRID = 1200


def to_float(x):
    return mpf(struct.unpack("f", struct.pack("f", float(x)))[0])


def minimax(points, values, weights, count):
    """First coefficient of sum c_k x^k, k < count, that about minimises max |weight * (value - polynomial)| (Lawson)."""
    low, high = points[0], points[-1]
    basis = numpy.polynomial.chebyshev.chebvander((2 * points - low - high) / (high - low), count - 1)
    importance = numpy.full(len(points), 1.0 / len(points))
    best = None
    for _ in range(200):
        scale = numpy.sqrt(importance) * weights
        c = numpy.linalg.lstsq(basis * scale[:, None], values * scale, rcond=None)[0]
        error = numpy.abs(weights * (values - basis @ c))
        if best is None or error.max() < best[0]:
            best = error.max(), c
        importance *= error
        importance /= importance.sum()
    chebyshev = numpy.polynomial.Chebyshev(best[1], domain=[low, high])
    return chebyshev.convert(kind=numpy.polynomial.Polynomial).coef[0]


def fit(name, target, weight, low, high, degrees, fixed=()):
    """`target` ~ sum of c_d x^d on [low, high]; `fixed` gives the values of the first coefficients."""
    low, high = mpf(low), mpf(high)
    exact = [low + (high - low) * (1 - cos(pi * i / (GRID - 1))) / 2 for i in range(GRID)]
    exact = [x for x in exact if abs(x) > 1e-9]
    points = numpy.array([float(x) for x in exact])
    values = numpy.array([float(target(x)) for x in exact])
    weights = numpy.array([abs(float(weight(x))) for x in exact])
    rounded = []
    for k in range(len(degrees)):
        if k < len(fixed):
            c = float(fixed[k])
        else:
            c = float(to_float(minimax(points, values / points**k, weights * points**k, len(degrees) - k)))
        rounded.append(c)
        values = values - c * points**k
    error = numpy.abs(weights * values).max()
    print(f"{name}: error 2^{float(log(error, 2)):.2f}")
    for d, c in zip(degrees, rounded):
        print(f"    x^{d}: {c.hex()}f")


def halves(name, value):
    """A constant as a sum of three floats."""
    parts = []
    for _ in range(3):
        parts.append(to_float(value))
        value -= parts[-1]
    print(f"{name}: " + ", ".join(float(p).hex() + "f" for p in parts))


def main():
    halves("pi/2", pi / 2)
    halves("2 pi", 2 * pi)
    halves("pi", pi)
    halves("2/pi", 2 / pi)
    halves("ln 2", log(2))
    halves("1/ln 2", 1 / log(2))
    halves("1/12", mpf(1) / 12)

    quarter = pi / 4 * (1 + mpf(2) ** -8)
    # Odd and even functions are fitted in s = x^2; the weight makes the error relative to the function (or to 1).
    fit("sin: (sin(x) - x) / x^3", lambda s: (sin(sqrt(s)) - sqrt(s)) / (s * sqrt(s)),
        lambda s: s * sqrt(s) / sin(sqrt(s)), 1e-6, quarter**2, range(3))
    fit("cos: (cos(x) - 1 + x^2/2) / x^4", lambda s: (cos(sqrt(s)) - 1 + s / 2) / s**2, lambda s: s**2 / cos(sqrt(s)),
        1e-6, quarter**2, range(3))
    fit("tan: (tan(x) - x) / x^3", lambda s: (tan(sqrt(s)) - sqrt(s)) / (s * sqrt(s)),
        lambda s: s * sqrt(s) / tan(sqrt(s)), 1e-6, quarter**2, range(7))
    eighth = mpf(1) / 8
    fit("sin(2 pi x) / x - 2 pi, over x^2", lambda s: (sin(2 * pi * sqrt(s)) / sqrt(s) - 2 * pi) / s,
        lambda s: s * sqrt(s) / sin(2 * pi * sqrt(s)), 1e-7, eighth**2, range(4))
    fit("(cos(2 pi x) - 1) / x^2", lambda s: (cos(2 * pi * sqrt(s)) - 1) / s, lambda s: s / cos(2 * pi * sqrt(s)),
        1e-7, eighth**2, range(5))
    fit("asin: (asin(x) - x) / x^3", lambda s: (asin(sqrt(s)) - sqrt(s)) / (s * sqrt(s)),
        lambda s: s * sqrt(s) / asin(sqrt(s)), 1e-6, 0.25, range(5))
    fit("atan: (atan(x) - x) / x^3", lambda s: (atan(sqrt(s)) - sqrt(s)) / (s * sqrt(s)),
        lambda s: s * sqrt(s) / atan(sqrt(s)), 1e-6, 1, range(9))
    half_ln2 = log(2) / 2 * (1 + mpf(2) ** -10)
    fit("exp: (exp(x) - 1 - x) / x^2", lambda x: (exp(x) - 1 - x) / x**2, lambda x: x**2 / exp(x),
        -half_ln2, half_ln2, range(5))
    fit("exp2: (2^x - 1) / x", lambda x: (2**x - 1) / x, lambda x: x / 2**x, -0.5, 0.5, range(6))
    low, high = sqrt(mpf(1) / 2) - 1, sqrt(mpf(2)) - 1
    fit("log: (log(1 + x) - x) / x^2", lambda x: (log(1 + x) - x) / x**2, lambda x: x**2 / log(1 + x),
        low, high, range(10), (-0.5,))
    fit("log2: (log2(1 + x) / x - 1/ln 2) / x", lambda x: (log(1 + x) / log(2) / x - 1 / log(2)) / x,
        lambda x: x**2 / log(1 + x), low, high, range(10))
    # log(m) = u + u^3/12 + u^5 * this(u^2), u = 2 (m - 1) / (m + 1), m in [sqrt(1/2), sqrt(2)].
    atanh = lambda x: (log(1 + x) - log(1 - x)) / 2
    fit("pow: log(m)'s tail", lambda s: (2 * atanh(sqrt(s) / 2) - sqrt(s) - s * sqrt(s) / 12) / (s * s * sqrt(s)),
        lambda s: s * s, 1e-4, mpf("0.1178"), range(3))


if __name__ == "__main__":
    main()
