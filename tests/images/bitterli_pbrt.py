#!/usr/bin/env python3
"""Renders Bitterli's Cornell box from its pbrt form, as the file says, and compares it with his reference picture.

Size, filter and depth are those that the file suggests. The bounds are those of bitterli_cornell_box.py, which renders the
Mitsuba form. His other pbrt forms are not compared: veach-ajar's lacks the checks of the floor, and kitchen's meshes are in an archive.
"""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from bitterli_cornell_box import MEAN_ERROR, SETTINGS  # noqa: E402
from reference_job import ReferenceJob  # noqa: E402

FOLDER = pathlib.Path("bitterli/cornell-box")


def main():
    job = ReferenceJob(__doc__.splitlines()[0])
    scene, reference = job.scene(FOLDER / "scene.pbrt"), job.scene(FOLDER / "reference.exr")
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
