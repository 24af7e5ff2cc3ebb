#!/usr/bin/env python3
"""Mean of grey Sponza under a constant sky, against pbrt's: 0.05784 with at most 5 scatterings, 0.06252 with 8.

Two more renderers agree with these to 0.12 %. The mean does not depend on the size of the picture, whose shape is kept.
A sample deviates by 2.75 means (from pictures of nine sizes), so the standard error is 0.07 % in the long setting and
0.01 % on a GPU. Many samples of few pixels are stratified better: of eight seeds, 64 samples of 80x45 pixels have a
standard error of 0.30 %, 16 of 160x90 have 0.43 %. So CI takes half as many samples. By the former its error is 0.11 %,
by seven seeds with 256 samples of 80x45 pixels 0.14 %. A picture is the same on every run: 0.2 % is asked of the last
two, 0.3 % in CI, where less would need minutes. A change that draws other random numbers may miss that by chance; then
the long setting tells.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from reference_job import ReferenceJob  # noqa: E402

MEANS = {"S5": 0.05784, "S8": 0.06252}
# Width, height, samples a pixel; the mean's largest relative error.
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
