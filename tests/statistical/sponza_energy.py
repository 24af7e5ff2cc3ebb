#!/usr/bin/env python3
"""Compares the mean of grey Sponza under a constant sky with pbrt's: 0.05784 with at most 5 scatterings, 0.06252 with

8. Two more renderers agree with these to 0.12 %. The mean does not depend on the picture's size for the same aspect.

A sample deviates by 2.75 means (from pictures of nine sizes), so the standard error is 0.07 % in the long setting and
0.01 % on a GPU. Many samples of few pixels are stratified better: of eight seeds, 64 samples of 80x45 pixels have a
standard error of 0.30 %, 16 of 160x90 have 0.43 %. So CI takes half as many samples. Its error is 0.11 % by the
former, and 0.14 % by seven seeds with 256 samples of 80x45 pixels. A picture is the same on every run. The limit is
0.2 % for the last two, and 0.3 % in CI, where less would need minutes. A change that draws other random numbers may
fail by chance; then the long setting decides.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from reference_job import ReferenceJob  # noqa: E402

MEANS = {"S5": 0.05784, "S8": 0.06252}
# Width, height, samples per pixel, and the largest relative error of the mean.
SETTINGS = {"ci": (160, 90, 128, 3e-3), "long": (1280, 720, 16, 2e-3), "cuda": (1920, 1080, 256, 2e-3)}


def main():
    job = ReferenceJob(__doc__.splitlines()[0])
    scene = job.scene("crytek-sponza/sponza.obj")
    width, height, samples, error = SETTINGS[job.effort]
    for name, mean in MEANS.items():
        done = job.run("job", "bench", "render", "--job", name, "--scene", scene, "--size", f"{width}x{height}",
                       "--spp", samples, "--build", "fast", "--device", job.device)
        job.check(f"mean of {name}", done["mean"], mean * (1 - error), mean * (1 + error))
        job.check("samples that were not finite", done["invalid_samples"], 0, 0)
    job.end()


if __name__ == "__main__":
    main()
