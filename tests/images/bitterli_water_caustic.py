#!/usr/bin/env python3
"""Renders Bitterli's water caustic by photon mapping from his scene file and compares it with his reference picture.

All light under water comes through its waves, and the camera looks in through one of its faces, so only photons find

it. Errors are relMSE over the best 98 % of blocks of pixels (`pertev compare --blocks`), and the channel means over
the same blocks: blur and noise are finer than a block of 64. Without scaling by the refractive index of 1.8, light in
the water would be 3.2 times as bright.

With --long, and on a GPU, `path` renders for the same time, and both errors are printed without a limit.
"""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from mitsuba_to_gltf import convert  # noqa: E402
from reference_job import ReferenceJob  # noqa: E402

FOLDER = pathlib.Path("bitterli/water-caustic")
# Passes, photons and how light of other surfaces is found; for each side of a block relMSE at most.
SETTINGS = {
    "ci": (1, 131072, "direct", {8: 2.2e-2, 64: 1.4e-3}),
    "long": (4, 262144, "final", {8: 9e-3, 64: 7e-4}),
    "cuda": (64, 1048576, "final", {8: 9e-3, 64: 7e-4}),
}
PATH_BLOCK = 4  # pixels per side of the blocks whose means compare path and photons
MEAN_ERROR = 0.04  # per channel; the blur of the edge of each caustic and corner darkens

# The reference has another depth and light than the file. By 7 scatterings all three channels of walls above the water and
# below are one share of it, 0.934 (medians of blocks); by 8, which is Mitsuba's maxDepth of 9, they are 0.98, 0.97 and
# 0.96. Tungsten, which made it, counts the emitter's edge in its max_bounces of 8. That share is that of `LAMP`: its own
# pixels add up to 1.066 times what the file's radiance over its 0.542 pixels does, in green and in blue.
DEPTH = 7
LAMP = 1.066


def brightened(text):
    """Returns the glTF with the reference's light."""
    scene = json.loads(text)
    for material in scene["materials"]:
        strength = material.get("extensions", {}).get("KHR_materials_emissive_strength")
        if strength:
            strength["emissiveStrength"] *= LAMP
    return json.dumps(scene)


def compare_with_path(job, render, picture, reference, photon_seconds):
    """Prints the relMSE of photons, of `path` after the same time, and their ratio."""
    other = picture.with_name("path.exr")
    path = job.run("done", *render(other), "--integrator", "path", "--spp", 65536, "--time-limit", photon_seconds)
    print(f"       photon_map {photon_seconds:.1f} s, path {path['seconds']:.1f} s ({path['samples']} samples)")
    photons, paths = (job.run("compare", "compare", one, reference, "--blocks", PATH_BLOCK) for one in (picture, other))
    for what, name in [("best 98 %", "rel_mse_98"), ("all values", "rel_mse")]:
        if None in (photons[name], paths[name]):
            print(f"       relMSE of {what}: not finite")
            continue
        print(f"       relMSE of blocks of {PATH_BLOCK} x {PATH_BLOCK}, {what}: photon_map {photons[name]:.3g}, "
              f"path {paths[name]:.3g}, {paths[name] / photons[name]:.3g} times as much")


def main():
    job = ReferenceJob(__doc__.splitlines()[0])
    source, reference = job.scene(FOLDER / "scene_mitsuba0.6.xml"), job.scene(FOLDER / "reference.exr")
    passes, photons, gather, bounds = SETTINGS[job.effort]
    with tempfile.TemporaryDirectory() as folder:
        scene, picture = pathlib.Path(folder, "water.gltf"), pathlib.Path(folder, "picture.exr")
        text, width, height = convert(source)
        scene.write_text(brightened(text))

        def render(to):
            return ["render", scene, "-o", to, "--size", f"{width}x{height}", "--filter", "tent", "--filter-radius", 1,
                    "--max-depth", DEPTH, "--device", job.device, "--no-bvh-cache"]

        done = job.run("done", *render(picture), "--integrator", "photon_map", "--spp", passes, "--photons", photons,
                       "--gather", gather)
        job.check("samples that were not finite", done["invalid_samples"], 0, 0)
        job.check_blocks(picture, reference, bounds, MEAN_ERROR)
        if job.effort != "ci":
            compare_with_path(job, render, picture, reference, done["seconds"])
    job.end()


if __name__ == "__main__":
    main()
