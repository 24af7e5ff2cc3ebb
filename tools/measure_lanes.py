#!/usr/bin/env python3
"""Times pictures on a CPU with vertices shaded in lanes, eight at once (AVX2) or sixteen (AVX-512), and one by one:
tools/measure_lanes.py PERTEV SCENES [--runs N] [-o MEASUREMENT.json]

SCENES is a folder laid out as docs/scenes.md says. Each figure is the median of N runs (5), the three in turns.
"""

import argparse
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import tempfile

import make_material_balls
from measurement import machine, write_measurement

BALLS = "material-balls.xml"
SPONZA = "--environment 1,1,1 --eye 0,2,5 --target 0,2,0 --size 480x270 --spp 32"
PICTURES = [("textured Sponza", "crytek-sponza/sponza.obj", SPONZA), ("DamagedHelmet", "gltf/DamagedHelmet/DamagedHelmet.glb", "--size 400x400 --spp 32"),
            ("Veach's door", "bitterli/veach-ajar/scene.pbrt", "--size 320x180 --spp 32"), ("40 material balls", BALLS, "--size 320x180 --spp 32")]
WIDTHS = [("one", "1"), ("eight", "8"), ("sixteen", "")]


def samples_per_second(pertev, scene, flags, lanes, folder):
    command = [pertev, "render", scene, *shlex.split(flags), "-o", folder / "picture.exr", "--device", "cpu", "--json"]
    done = subprocess.run(command, env={**os.environ, "PERTEV_LANES": lanes}, stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])["samples_per_second"] * 1e-6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pertev")
    parser.add_argument("scenes", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("-o", "--output", metavar="MEASUREMENT.json")
    given = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        make_material_balls.write(folder / BALLS)
        for name, file, flags in PICTURES:
            scene = (folder if file == BALLS else given.scenes) / file
            runs = [[samples_per_second(given.pertev, scene, flags, lanes, folder) for _, lanes in WIDTHS] for _ in range(given.runs)]
            rates = [float(f"{statistics.median(rate):.4g}") for rate in zip(*runs)]
            rows.append([name, *rates, float(f"{rates[-1] / rates[0]:.3g}")])
            print(*rows[-1], sep="\t", flush=True)
    if given.output:
        columns = [("picture", "picture", None), *((key, key, "Msamples/s") for key, _ in WIDTHS), ("ratio", "sixteen to one", None)]
        write_measurement(given.output, given.pertev, f"Lanes of shading, {machine('cpu')}", columns, rows, "cpu", os.cpu_count(),
                          ["The third is eight where the processor has no AVX-512."])


if __name__ == "__main__":
    main()
