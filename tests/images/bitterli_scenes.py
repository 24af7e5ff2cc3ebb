#!/usr/bin/env python3
"""Renders Bitterli's scenes from their files of pbrt and Mitsuba, as they say, and compares them with his reference pictures.

CI compares means of blocks of pixels (`pertev compare --blocks`). With --long, on a GPU, or with --spp, each scene is rendered by two
seeds, A and B, and held to three bounds; R is the reference, w = 1 / (R^2 + 0.01):

- relMSE, the mean of w (A - R)^2, is at most 1.3 times the sum of both pictures' noise. Ours is the mean of w (A - B)^2 / 2. The
  reference's is that times the ratio of both by second differences, whose variance is 6 times a pixel's, as median / 0.455 in blocks
  of 16 x 16 along each axis: edges and outliers do not count, and the lesser axis has less of the scene in it. Medians alone leave
  outliers out, which means contain: half of our noise in veach-mis, an eighth in veach-ajar. Both pictures are by path tracing, so
  that they have them alike. Tungsten samples its filter (PinholeCamera::sampleDirection), so its noise is white: differences of the
  second, third and fourth order give 6.39, 6.39 and 6.40e-6 as medians in the Cornell box. A filter of radius 1 that is splatted
  correlates neighbours, and the second order would find 11 % more than the fourth, and two thirds of the noise. Half floats round by
  a relative 4e-8 in variance, which second differences contain. Pixels within two of an emitter's edge are left out: Tungsten's table
  of its tent has each bin a 31st of a pixel too far out (ReconstructionFilter::sample), so that its edges of emitters are wider, by
  what the table predicts (0.166 and 0.871 of the light beside the edge of the Cornell box's, where a tent has 0.145 and 0.891; the
  reference has 0.167 and 0.873). That is 39 % of all squared error there.
- Means of blocks of 32 x 32 agree within a bound, up to as many standard errors (of the seeds and the reference's noise) as the largest of so
  many has with a probability of 0.001. The emission alone is rendered
  to find the edges of emitters. Blocks darker than 0.001 are compared with that.
- The median of the blocks' errors is within a quarter of that bound, half of one above 1 %, and three standard errors.

At last the same has to fail with a picture that is 2 % brighter, where the bound is 1 %.

Tungsten reads a texture as floor(255 (texel / 255)^2.2) / 255, so that wood loses up to 14 % of its blue; the scenes get their textures
so. What the files do not have, or that they lost on their way from Tungsten, is left out by rectangles (UNLIKE).

    tests/images/bitterli_scenes.py build/bin/pertev [--device cuda] [--long] [--spp N] [--only NAME] [--results FILE]
"""

import dataclasses
import pathlib
import re
import statistics
import struct
import sys
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[1] / "support"), str(HERE.parents[2] / "tools")]
import measurement  # noqa: E402
from read_exr import read_exr  # noqa: E402
from reference_job import SKIPPED, ReferenceJob  # noqa: E402

FOLDER = pathlib.Path("bitterli")
BLOCK = 32
LEAST_P = 1e-3
NOISE_RATIO = 1.3
# CI's samples, relMSE at most by side of a block, and the largest error of a channel's mean. Measured were 1.9e-3 and 2.8e-5 by 4
# samples, 1.5e-4 and 0.06 % by one. Leaving out the worst 2 % of blocks, mostly bright outliers, darkens means by 0.08 %.
BOX = 4, {4: 2.5e-3, 32: 5e-5}, 2e-3
PBRT_BOX = 1, {32: 2.5e-4}, 4e-3


@dataclasses.dataclass
class Scene:
    file: str
    depth: int  # scatterings
    spp: dict   # by effort
    bound: float  # the largest relative error of a block's mean
    ci: tuple = ()  # samples, relMSE at most by side of a block, the largest error of a channel's mean
    rel_mse: float = None  # at most, on a GPU
    share: float = 1.0  # that many of the blocks are within the bound
    unlike: tuple = ()  # rectangles that are left out: left, upper, right, lower pixel
    flags: tuple = ()
    changed: tuple = ()  # texts of the file, and others in their place
    noise_bound: bool = True  # false where the picture is biased or materials are approximated
    median: float = None  # bound of the blocks' median error, if it is not that of `bound`


# cornell-box: two blocks of 3072 are the dark side of a bright edge, which Tungsten's filter widens.
# veach-ajar: by 4096 samples 44 % of the blocks differ by up to 26 % (the floor beside the door), in patterns that follow surfaces, and
# the median by 0.8 %. Mitsuba 3.9 makes our picture there, so the file is not what Tungsten rendered.
# veach-ajar: the glass teapot. By 12 scatterings it is 1.5 times as bright as the reference's, in Mitsuba 3.9 as well; by 8 it is
# equal, but all else too dark, so Tungsten's took other paths.
# kitchen: the file has lost the albedo of metals (0.58: the cooker's wall and hood, microwave and what they light); the cooker's
# front is a layered material, which is approximated.
# water-caustic: below.
UNLIKE = {
    "veach-ajar": ((624, 376, 816, 528),),
    "kitchen": ((192, 160, 704, 544), (320, 448, 448, 720)),
}

# The reference of water-caustic has another depth and light than the file. By 7 scatterings all three channels of walls above the
# water and below are one share of it, 0.934 (medians of blocks); by 8, which is Mitsuba's maxDepth of 9, they are 0.98, 0.97 and
# 0.96. Tungsten, which made it, counts the emitter's edge in its max_bounces of 8. That share is that of `LAMP`: its own pixels add up
# to 1.066 times what the file's radiance over its 0.542 pixels does. Both pictures are by photons, and blurred.
LAMP = 1.066
RADIANCE = "541127, 381972, 127324"
WATER = ("--integrator", "photon_map", "--max-depth", 7, "--photons", 1048576, "--gather", "final")

# The kitchen's reference has 0.388 of the window's light behind the blinds, so that one of their two sides transmits it; the file lost
# that, and now each of the two transmits the root.
BLINDS = (" ".join(3 * ["0.612066"]), " ".join(3 * [f"{1 - (1 - 0.612066) ** 0.5:.6f}"]))

SCENES = {
    "cornell-box": Scene("scene_mitsuba3.xml", 64, {"long": 16, "cuda": 4096}, 0.01, BOX, 2e-4, share=0.999),
    "cornell-box-pbrt": Scene("scene.pbrt", 65, {"long": 16, "cuda": 4096}, 0.01, PBRT_BOX, 2e-4, share=0.999),
    "veach-mis": Scene("scene_mitsuba3.xml", 1, {"long": 16, "cuda": 4096}, 0.01, (1, {32: 2e-3}, 1e-2)),
    "veach-ajar": Scene("scene_mitsuba3.xml", 12, {"long": 8, "cuda": 4096}, 0.01, share=0.55, unlike=UNLIKE["veach-ajar"], median=0.01),
    "kitchen": Scene("scene.pbrt", 17, {"long": 8, "cuda": 2048}, 0.03, share=0.8, unlike=UNLIKE["kitchen"], noise_bound=False,
                     changed=((f'"rgb opacity" [ {BLINDS[0]} ]', f'"rgb opacity" [ {BLINDS[1]} ]'),)),
    "water-caustic": Scene("scene_mitsuba0.6.xml", 7, {"long": 1, "cuda": 64}, 0.03, share=0.8, flags=WATER, noise_bound=False,
                           changed=((RADIANCE, ", ".join(str(LAMP * float(c)) for c in RADIANCE.split(", "))),)),
}


def write_exr(path, pixels):
    """Writes an array [row][column][R, G, B] as float32 without compression."""
    height, width, _ = pixels.shape
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = [("channels", "chlist", b"".join(name + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"),
                  ("compression", "compression", b"\0"), ("dataWindow", "box2i", box), ("displayWindow", "box2i", box),
                  ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                  ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))]
    header = struct.pack("<2I", 20000630, 2) + b"".join(
        name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value for name, kind, value in attributes) + b"\0"
    first, row = len(header) + 8 * height, 8 + 12 * width
    lines = (struct.pack("<2i", y, 12 * width) + pixels[y, :, ::-1].T.astype("<f4").tobytes() for y in range(height))
    path.write_bytes(header + struct.pack(f"<{height}Q", *range(first, first + row * height, row)) + b"".join(lines))


class Arrays:
    """Pictures as arrays of numpy."""

    def __init__(self, job, folder):
        try:
            import numpy  # CI does without
        except ImportError:
            print("skipped: this needs numpy")
            sys.exit(SKIPPED)
        self.numpy, self.job, self.folder = numpy, job, folder

    def read(self, path):
        rows = read_exr(path)[2]
        return self.numpy.stack([self.numpy.array(rows[channel], dtype=float) for channel in "RGB"], axis=-1)

    def converted(self, path):
        target = self.folder / "converted.exr"
        self.job.run("convert", "convert", path, target)
        return self.read(target)

    def as_tungsten_reads(self, path, target):
        """Writes a texture whose linear colours are Tungsten's."""
        numpy, linear = self.numpy, self.converted(path)
        encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * numpy.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
        write_exr(target, numpy.floor(255 * numpy.rint(255 * encoded) ** 2.2 / 255 ** 2.2 + 1e-9) / 255)

    def block_sums(self, picture, side):
        """Sums of blocks; those at the right and lower edge may be smaller."""
        numpy = self.numpy
        rows = numpy.add.reduceat(picture, range(0, picture.shape[0], side), axis=0)
        return numpy.add.reduceat(rows, range(0, picture.shape[1], side), axis=1)

    def block_medians(self, picture, side):
        rows, columns = (size // side for size in picture.shape[:2])
        blocks = picture[:rows * side, :columns * side].reshape(rows, side, columns, side, -1)
        return self.numpy.median(blocks.transpose(0, 2, 4, 1, 3).reshape(rows, columns, picture.shape[2], -1), axis=-1)

    def white_noise(self, picture, weight):
        """The weighted variance of a pixel, by second differences along the axis that has less of them."""
        found = []
        for axis in (0, 1):
            squares = self.numpy.diff(picture, 2, axis) ** 2
            inner = self.numpy.delete(weight, (0, -1), axis)
            found.append(self.block_medians(squares * inner, 16).mean() / 0.4549 / 6)
        return min(found)

    def near_edges(self, mask, reach):
        """The pixels within `reach` of one of each kind."""
        def grown(mask):
            for axis in (0, 1):
                for _ in range(reach):
                    mask = mask | self.numpy.roll(mask, 1, axis) | self.numpy.roll(mask, -1, axis)
            return mask
        return grown(mask) & grown(~mask)


def prepared(job, name, arrays):
    """Returns the scene's file, with its textures and meshes, in the folder of `arrays`."""
    scene, folder = SCENES[name], arrays.folder
    source = job.scene(FOLDER / name.removesuffix("-pbrt") / scene.file)
    text = source.read_text(encoding="utf-8")
    for old, new in scene.changed:
        assert old in text, f"{scene.file} lacks {old}"
        text = text.replace(old, new)
    for part in ("models", "textures"):
        if (source.parent / part).is_dir():
            (folder / part).symlink_to(source.parent / part)
    if (source.parent / "models.zip").is_file():
        zipfile.ZipFile(source.parent / "models.zip").extractall(folder)
    lines = text.splitlines()
    for i, line in enumerate(lines):
        match = re.search(r'textures/[^"]+', line)
        if match and '"float" "imagemap"' not in line:
            target = folder / (pathlib.Path(match[0]).stem + ".exr")
            if not target.exists():
                arrays.as_tungsten_reads(source.parent / match[0], target)
            lines[i] = line.replace(match[0], target.name)
    file = folder / scene.file
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return source.parent, file


@dataclasses.dataclass
class Errors:
    whole: float  # relMSE, mean of our two pictures
    rel_mse: float  # relMSE without the edges of emitters
    ours: float  # relMSE by our noise, likewise
    reference: float  # relMSE by the reference's noise
    largest: float  # largest error of a block that is not left out
    median: float
    median_error: float  # its standard error, if a block's channels are one
    excess: float  # the most by which a block is beyond its bound and standard errors, for the share of them that has to hold
    beyond: int  # number of such blocks
    blocks: int


def errors_of(arrays, scene, a, b, reference, emission):
    numpy = arrays.numpy
    finite = numpy.isfinite(reference).all(axis=-1)
    reference = numpy.where(finite[..., None], reference, 0)
    kept = finite.copy()
    for x0, y0, x1, y1 in scene.unlike:
        kept[y0:y1, x0:x1] = False
    weight = kept[..., None] / (reference ** 2 + 0.01)
    whole = float((weight * ((a - reference) ** 2 + (b - reference) ** 2)).sum() / 6 / kept.sum())
    kept &= ~arrays.near_edges(emission.max(axis=-1) > 0, 2)
    weight = weight * kept[..., None]
    count = 3 * kept.sum()
    rel_mse = (weight * ((a - reference) ** 2 + (b - reference) ** 2) / 2).sum() / count
    difference = (a - b) / 2 ** 0.5
    ours = (weight * difference ** 2).sum() / count
    share = arrays.white_noise(reference, weight) / arrays.white_noise(difference, weight)  # the reference's variance over ours
    inside = kept[..., None].astype(float)
    sums = {key: arrays.block_sums(value * inside, BLOCK) for key, value in (
        ("pixels", 1), ("ours", (a + b) / 2), ("reference", reference), ("variance", (a - b) ** 2 / 4),
        ("square", share * difference ** 2))}
    is_whole = numpy.broadcast_to(sums["pixels"] >= BLOCK, sums["ours"].shape)
    dark = numpy.maximum(sums["reference"], 1e-3 * sums["pixels"])[is_whole]
    error = (sums["ours"] - sums["reference"])[is_whole] / dark
    deviation = numpy.sqrt(sums["variance"] + sums["square"])[is_whole] / dark
    most = statistics.NormalDist().inv_cdf(1 - LEAST_P / 2 / error.size)
    excess = numpy.sort(abs(error) - scene.bound - most * deviation)
    place = numpy.argwhere(is_whole)
    for i in numpy.argsort(scene.bound + most * deviation - abs(error))[:5]:
        if abs(error[i]) > scene.bound:
            row, column, channel = place[i]
            print(f"       block at {BLOCK * column},{BLOCK * row} {'RGB'[channel]}: {100 * error[i]:+.2f} %, standard error {100 * deviation[i]:.2f} %")
    return Errors(whole, rel_mse, ours, share * ours, abs(error).max(), float(numpy.median(error)),
                  1.25 * float(numpy.median(deviation)) / (error.size / 3) ** 0.5, excess[int(numpy.ceil(scene.share * error.size)) - 1],
                  int((excess > 0).sum()), error.size)


def compare(job, name, folder, rows):
    scene, arrays = SCENES[name], Arrays(job, folder)
    home, file = prepared(job, name, arrays)
    samples = job.spp or scene.spp[job.effort]

    def render(picture, *flags):
        done = job.run("done", "render", file, "-o", folder / picture, "--device", job.device, "--no-bvh-cache", "--allow-path", home, *flags)
        job.check("samples that were not finite", done["invalid_samples"], 0, 0)
        return done["seconds"], arrays.read(folder / picture)

    seconds, a = render("a.exr", *scene.flags, "--spp", samples, "--seed", 1)
    _, b = render("b.exr", *scene.flags, "--spp", samples, "--seed", 2)
    _, emission = render("emission.exr", "--max-depth", 0, "--spp", 16)
    job.check("scatterings", int(job.run("info", "info", folder / "a.exr")["pertev.max_depth"]), scene.depth, scene.depth)
    reference = arrays.converted(home / "reference.exr")
    found = errors_of(arrays, scene, a, b, reference, emission)
    print(f"       {name}: noise {found.ours:.3g} and {found.reference:.3g}; largest error of a block {100 * found.largest:.2f} %, "
          f"beyond {found.beyond} of {found.blocks}; {seconds:.1f} s a picture")
    if scene.noise_bound:
        job.check(f"{name}: relMSE over the noise of both", found.rel_mse / (found.ours + found.reference), 0, NOISE_RATIO)
    if scene.rel_mse and job.effort == "cuda":
        job.check(f"{name}: relMSE", found.whole, 0, scene.rel_mse)
    job.check(f"{name}: most that {100 * scene.share:g} % of the blocks are beyond their bound", float(found.excess), -1, 0)
    median_bound = (scene.median or scene.bound / (4 if scene.bound <= 0.01 else 2)) + 3 * found.median_error
    job.check(f"{name}: median error of blocks", found.median, -median_bound, median_bound)
    if scene.bound <= 0.01:
        wrong = errors_of(arrays, scene, 1.02 * a, 1.02 * b, reference, emission)
        job.check(f"{name}: median error of blocks that are 2 % brighter", wrong.median, median_bound, 1)
    rows.append([name, samples, *(float(f"{value:.3g}") for value in (found.whole, found.ours, found.reference, found.rel_mse / (found.ours + found.reference))),
                 *(float(f"{100 * value:.3g}") for value in (found.largest, found.median)), found.beyond, found.blocks])


def compare_in_ci(job, name, folder):
    scene = SCENES[name]
    home = FOLDER / name.removesuffix("-pbrt")
    samples, bounds, mean_error = scene.ci
    done = job.run("done", "render", job.scene(home / scene.file), "-o", folder / "a.exr", "--spp", samples, "--device", job.device, "--no-bvh-cache", "--strict")
    job.check("samples that were not finite", done["invalid_samples"], 0, 0)
    job.check("defaults that were added", len(done["made_up"]), 0, 0)
    job.check("scatterings", int(job.run("info", "info", folder / "a.exr")["pertev.max_depth"]), scene.depth, scene.depth)
    job.check_blocks(folder / "a.exr", job.scene(home / "reference.exr"), bounds, mean_error)


COLUMNS = (("scene", "scene", None), ("spp", "samples", None), ("rel_mse", "relMSE", None), ("ours", "our noise", None),
           ("theirs", "the reference's", None), ("ratio", "relMSE over both noises", None), ("largest", "largest error of a block", "%"),
           ("median", "median", "%"), ("beyond", "blocks beyond the bound", None), ("blocks", "blocks", None))


def main():
    job = ReferenceJob(__doc__.splitlines()[0], only=SCENES)
    rows = []
    for name in job.only:
        with tempfile.TemporaryDirectory() as folder:
            if job.effort != "ci" or job.spp:
                job.effort = "long" if job.effort == "ci" else job.effort
                compare(job, name, pathlib.Path(folder), rows)
            elif SCENES[name].ci:
                compare_in_ci(job, name, pathlib.Path(folder))
            else:
                print(f"skipped: {name} needs --long, --spp or a GPU")
    if job.results:
        measurement.write_measurement(job.results, job.program, "Against Bitterli's references", COLUMNS, rows, job.device, job.threads)
    job.end()


if __name__ == "__main__":
    main()
