#!/usr/bin/env python3
"""Renders Bitterli's water caustic by photons from his scene file and compares with his reference picture.

All of the light under water comes through its waves, and the camera looks in through a face of it: photons alone find
that. Errors are relMSE over the best 98 % of blocks of pixels (`pertev compare --blocks`), and the channel means over
the same blocks: what photons blur and a pass has of noise is finer than a block of 64. Light within the water that is
not counted by its refractive index, 1.8, would be 3.2 times as bright.
"""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from mitsuba_to_gltf import convert  # noqa: E402
from reference_job import ReferenceJob  # noqa: E402

FOLDER = pathlib.Path("bitterli/water-caustic")
# Passes, photons and how light of other surfaces is found; for each side of a block relMSE at most.
SETTINGS = {
    "ci": (1, 131072, "direct", {8: 2.4e-2, 64: 1.8e-3}),
    "long": (4, 262144, "final", {8: 9e-3, 64: 7e-4}),
    "cuda": (64, 1048576, "final", {8: 9e-3, 64: 7e-4}),
}
MEAN_ERROR = 0.07  # of a channel; the blur of the edge of each caustic and corner darkens


def main():
    job = ReferenceJob(__doc__.splitlines()[0])
    source, reference = job.scene(FOLDER / "scene_mitsuba0.6.xml"), job.scene(FOLDER / "reference.exr")
    passes, photons, gather, bounds = SETTINGS[job.effort]
    with tempfile.TemporaryDirectory() as folder:
        scene, picture = pathlib.Path(folder, "water.gltf"), pathlib.Path(folder, "picture.exr")
        text, width, height = convert(source)
        scene.write_text(text)
        # Mitsuba's depth of 9 counts the ray from the camera too.
        done = job.run("done", "render", scene, "-o", picture, "--size", f"{width}x{height}", "--integrator",
                       "photon_map", "--spp", passes, "--photons", photons, "--gather", gather, "--filter", "tent",
                       "--filter-radius", 1, "--max-depth", 8, "--device", job.device, "--no-bvh-cache")
        job.check("samples that were not finite", done["invalid_samples"], 0, 0)
        job.check_blocks(picture, reference, bounds, MEAN_ERROR)
    job.end()


if __name__ == "__main__":
    main()
