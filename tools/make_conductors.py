#!/usr/bin/env python3
"""Writes src/formats/mitsuba/conductor_table.inl: indices of conductors by Mitsuba's names, as its RGB variants have them.

    tools/make_conductors.py    with the package mitsuba of PyPI (3.9.1)

That package (BSD-3-Clause) holds tables of n and k by wavelength from luxpop.com, most of Palik's Handbook of Optical Constants of Solids.
Mitsuba integrates n and k against the observer's curves; a flat index of 1 becomes (1.205, 0.948, 0.909). Its spectral variants, which
nearly all reflect less red, do not. The name NAME_palik is there where it differs from NAME.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def main():
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    folder = pathlib.Path(mitsuba.__file__).parent / "data/ior"
    found = {}
    for file in sorted(folder.glob("*.eta.spd")):
        name = file.name.removesuffix(".eta.spd")
        values = mitsuba.traverse(mitsuba.load_dict({"type": "conductor", "material": name}))
        found[name] = [[float(f"{x:.5g}") for x in values[f"{part}.value"]] for part in ("eta", "k")]
    lines = []
    for name, parts in found.items():
        if name.endswith("_palik") and parts == found.get(name.removesuffix("_palik")):
            continue
        values = ", ".join("{" + ", ".join(f"{x:#.5g}f" for x in part) + "}" for part in parts)
        lines.append(f'{{"{name}", {{{values}}}}},\n')
    text = "// Written by tools/make_conductors.py from the data of Mitsuba 3.9.1 (luxpop.com): name, eta, k.\n// clang-format off\n"
    (ROOT / "src/formats/mitsuba/conductor_table.inl").write_text(text + "".join(lines))


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    main()
