#!/usr/bin/env python3
"""Mean of grey Sponza under a constant sky, against pbrt's: 0.05784 with at most 5 scatterings, 0.06252 with 8.

Two more renderers agree with these to 0.12 %. The mean does not depend on the size of the picture, whose shape is kept.
Bounds: 0.2 %, and on the CPU three standard errors on top. The standard deviation of a sample is 0.2 (measured).
"""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from reference_job import ReferenceJob  # noqa: E402

MEANS = {"S5": 0.05784, "S8": 0.06252}
DEVIATION = 0.2
SETTINGS = {"ci": (320, 180, 16), "long": (1280, 720, 16), "cuda": (1920, 1080, 256)}  # width, height, samples


def main():
    job = ReferenceJob(__doc__.splitlines()[0])
    scene = job.scene("crytek-sponza/sponza.obj")
    width, height, samples = SETTINGS[job.effort]
    standard_error = DEVIATION / math.sqrt(width * height * samples)
    for name, mean in MEANS.items():
        done = job.run("job", "bench", "render", "--job", name, "--scene", scene, "--size", f"{width}x{height}",
                       "--spp", samples, "--device", job.device)
        bound = 0.002 * mean + (0 if job.effort == "cuda" else 3 * standard_error)
        job.check(f"mean of {name}", done["mean"], mean - bound, mean + bound)
        job.check("samples that were not finite", done["invalid_samples"], 0, 0)
    job.end()


if __name__ == "__main__":
    main()
