#!/usr/bin/env python3
"""Renders McGuire's Cornell box, whose emitter is 2 cm under the ceiling, and compares its mean with Mitsuba's.

Mitsuba 3.9 has a red mean of 0.1666 for the view that a scene without a camera gets. An emitter that also emits from
its back lights the ceiling: 14 % more light, which few paths find.
"""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from reference_job import ReferenceJob  # noqa: E402

RED = 0.1666
SETTINGS = {"ci": (128, 64, 0.01), "long": (256, 256, 0.005), "cuda": (512, 1024, 0.003)}  # side, samples, error


def main():
    job = ReferenceJob(__doc__.splitlines()[0])
    scene = job.scene(pathlib.Path("cornell-box-mcguire/CornellBox-Original.obj"))
    side, samples, error = SETTINGS[job.effort]
    with tempfile.TemporaryDirectory() as folder:
        picture = pathlib.Path(folder, "picture.exr")
        for flags, red in [([], RED), (["--two-sided-lights"], 1.14 * RED)]:
            job.run("done", "render", scene, "-o", picture, "--size", f"{side}x{side}", "--spp", samples, "--device",
                    job.device, *flags)
            mean = job.run("info", "info", picture)["mean"][0]
            job.check(f"mean of red {' '.join(flags)}", mean, red * (1 - error), red * (1 + error))
    job.end()


if __name__ == "__main__":
    main()
