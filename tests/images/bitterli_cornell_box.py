#!/usr/bin/env python3
"""Renders Bitterli's Cornell box from his file of Mitsuba, as it says, and compares it with his reference picture.

Errors are relMSE over the best 98 % of blocks of pixels (`pertev compare --blocks`) and the channel means over the same
blocks. The render has the reference's size, filter and depth, so the mean over a block is a mean over the same light in
both: blocks change only the noise. The samples of a pixel are scrambled Sobol points, so the error falls faster than
0.2 / samples of a block, which holds for few samples. Measured: relMSE 1.9e-3 for blocks of 4 and
2.8e-5 for blocks of 32 at 4 samples a pixel, 1.32e-3 for pixels and 8.5e-5 for blocks of 4 at 64. Bounds on relMSE are
1.3 to 1.8 times that; for 4096 samples they are 0.001, and 3e-5 over blocks of 4. The reference's own noise is small
in comparison, 1.6e-5 per pixel (from its second differences). Leaving out the worst 2 %, mostly bright outliers,
darkens the means: by 0.08 % in the noisiest setting. The limit is always 0.2 %.
"""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from reference_job import ReferenceJob  # noqa: E402

FOLDER = pathlib.Path("bitterli/cornell-box")
# Samples per pixel, and the largest relMSE for each size of a block.
SETTINGS = {
    "ci": (4, {4: 2.5e-3, 32: 5e-5}),
    "long": (64, {1: 2e-3, 4: 1.3e-4}),
    "cuda": (4096, {1: 1e-3, 4: 3e-5}),
}
MEAN_ERROR = 2e-3  # per channel


def main():
    job = ReferenceJob(__doc__.splitlines()[0])
    scene, reference = job.scene(FOLDER / "scene_mitsuba3.xml"), job.scene(FOLDER / "reference.exr")
    samples, bounds = SETTINGS[job.effort]
    with tempfile.TemporaryDirectory() as folder:
        picture = pathlib.Path(folder, "picture.exr")
        done = job.run("done", "render", scene, "-o", picture, "--spp", samples, "--device", job.device, "--no-bvh-cache", "--strict")
        job.check("samples that were not finite", done["invalid_samples"], 0, 0)
        job.check("defaults that were added", len(done["made_up"]), 0, 0)
        job.check_blocks(picture, reference, bounds, MEAN_ERROR)
    job.end()


if __name__ == "__main__":
    main()
