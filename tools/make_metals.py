#!/usr/bin/env python3
"""Writes src/scene/metal_table.inl: indices of measured metals, one complex number a channel of linear Rec. 709.

    tools/make_metals.py DATABASE    a clone of github.com/polyanskiy/refractiveindex.info-database (CC0)

A channel's index is that whose reflectance (unpolarised, exact) is the channel's reflectance of the metal under D65 at 0 degrees, and
closest to it at others. A channel over 0.995, of a metal more saturated than Rec. 709, is cut to that. The observer is that
of tests/statistical/thin_film_test.cpp.
"""

import math
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
METALS = [  # the name, the file in database/data
    ("aluminium", "main/Al/nk/Rakic"), ("aluminium-antimonide", "main/AlSb/nk/Djurisic"), ("aluminium-arsenide", "main/AlAs/nk/Rakic"),
    ("beryllium", "main/Be/nk/Rakic-LD"), ("brass", "other/alloys/Cu-Zn/nk/Querry-Cu70Zn30"), ("caesium-iodide", "main/CsI/nk/Querry"),
    ("carbon", "main/C/nk/Arakawa"), ("chromium", "main/Cr/nk/Johnson"), ("cobalt", "main/Co/nk/Johnson"),
    ("copper", "main/Cu/nk/Johnson"), ("gold", "main/Au/nk/Johnson"), ("iridium", "main/Ir/nk/Schmitt-MS"), ("iron", "main/Fe/nk/Johnson"),
    ("lithium", "main/Li/nk/Inagaki"), ("mercury", "main/Hg/nk/Inagaki"), ("molybdenum", "main/Mo/nk/Kirillova"),
    ("nickel", "main/Ni/nk/Johnson"), ("niobium", "main/Nb/nk/Weaver"), ("palladium", "main/Pd/nk/Johnson"),
    ("platinum", "main/Pt/nk/Rakic-LD"), ("potassium", "main/K/nk/Smith"), ("rhodium", "main/Rh/nk/Weaver"),
    ("silicon-carbide", "main/SiC/nk/Larruquert"), ("silver", "main/Ag/nk/Johnson"),
    ("sodium", "main/Na/nk/Inagaki"), ("tantalum", "main/Ta/nk/Werner"), ("tellurium", "main/Te/nk/Ciesielski"),
    ("titanium", "main/Ti/nk/Johnson"), ("titanium-carbide", "main/TiC/nk/Pfluger"), ("titanium-nitride", "main/TiN/nk/Pfluger"),
    ("tungsten", "main/W/nk/Rakic-LD"), ("vanadium", "main/V/nk/Johnson"), ("vanadium-carbide", "main/VC/nk/Pfluger"),
    ("vanadium-nitride", "main/VN/nk/Pfluger")]
RGB_FROM_XYZ = ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560), (0.0556434, -0.2040259, 1.0572252))
COSINES = [math.cos(math.radians(angle)) for angle in range(0, 90, 5)]


def observer():
    text = (ROOT / "tests/statistical/thin_film_test.cpp").read_text()
    table = text.split("kObserved[41][3] = {")[1].split("};")[0]
    rows = [[float(number) for number in row.split(",")] for row in re.findall(r"\{([^{}]*)\}", table)]
    assert len(rows) == 41, "the observer has other rows"
    return rows


def nk_of(path):
    """Wavelengths in micrometres with n and k, in order."""
    rows = []
    for line in path.read_text(encoding="utf-8").split("type: tabulated nk")[1].splitlines():
        numbers = line.split()
        if len(numbers) == 3 and all(re.fullmatch(r"[-+.0-9eE]+", number) for number in numbers):
            rows.append([float(number) for number in numbers])
    return sorted(rows)


def at(rows, wavelength):
    for low, high in zip(rows, rows[1:]):
        if low[0] <= wavelength <= high[0]:
            part = (wavelength - low[0]) / (high[0] - low[0])
            return [(1 - part) * low[i] + part * high[i] for i in (1, 2)]
    raise SystemExit(f"no data at {wavelength} micrometres")


def reflectance(cosine, n, k):
    index = complex(n, -k)
    inner = (1 - (1 - cosine * cosine) / (index * index)) ** 0.5
    s = (cosine - index * inner) / (cosine + index * inner)
    p = (index * cosine - inner) / (index * cosine + inner)
    return 0.5 * (abs(s) ** 2 + abs(p) ** 2)


def channels_of(rows, observed):
    """Reflectance of each channel at each of COSINES."""
    result = []
    for cosine in COSINES:
        xyz, white = [0, 0, 0], [0, 0, 0]
        for i, weights in enumerate(observed):
            value = reflectance(cosine, *at(rows, 0.38 + 0.01 * i))
            for c in range(3):
                xyz[c] += weights[c] * value
                white[c] += weights[c]
        result.append([sum(a * b for a, b in zip(row, xyz)) / sum(a * b for a, b in zip(row, white)) for row in RGB_FROM_XYZ])
    return [[min(one[c], 0.995) for one in result] for c in range(3)]


def k_for(n, at_normal):
    return math.sqrt(max((at_normal * (n + 1) ** 2 - (n - 1) ** 2) / (1 - at_normal), 0))


def index_of(wanted):
    """The n and k with the wanted reflectance at 0 degrees that come closest at all others, by the golden section over log n."""
    root = math.sqrt(wanted[0])
    most = (1 + root) / (1 - root)  # there k is 0

    def error(log_n):
        n = math.exp(log_n)
        k = k_for(n, wanted[0])
        return sum((reflectance(cosine, n, k) - value) ** 2 for cosine, value in zip(COSINES, wanted))

    low, high = math.log(1 / most), math.log(most)
    best = min(range(101), key=lambda i: error(low + (high - low) * i / 100))
    low, high = low + (high - low) * max(best - 1, 0) / 100, low + (high - low) * min(best + 1, 100) / 100
    for _ in range(60):
        a, b = high - 0.618034 * (high - low), low + 0.618034 * (high - low)
        low, high = (low, b) if error(a) < error(b) else (a, high)
    n = math.exp((low + high) / 2)
    return n, k_for(n, wanted[0]), math.sqrt(error((low + high) / 2) / len(COSINES))


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    observed, lines = observer(), []
    for name, file in METALS:
        wanted = channels_of(nk_of(pathlib.Path(sys.argv[1]) / "database/data" / (file + ".yml")), observed)
        found = [index_of(channel) for channel in wanted]
        print(f"{name:10} reflects {', '.join(f'{channel[0]:.4f}' for channel in wanted)}, off by {max(f[2] for f in found):.4f}")
        values = ", ".join("{" + ", ".join(f"{f[i]:.5g}f" if "." in f"{f[i]:.5g}" else f"{f[i]:.5g}.0f" for f in found) + "}" for i in (0, 1))
        lines.append(f'{{"{name}", {values}}}, // {file}\n')
    text = "// Written by tools/make_metals.py from refractiveindex.info (CC0): name, eta, k, file.\n// clang-format off\n"
    (ROOT / "src/scene/metal_table.inl").write_text(text + "".join(lines))


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    main()
