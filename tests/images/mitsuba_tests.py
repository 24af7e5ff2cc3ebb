#!/usr/bin/env python3
"""Renders the scenes of Mitsuba's own tests and compares them with its mean and variance pictures by a z-test a pixel.

All is in CIE XYZ, because Mitsuba computed its variances there and wrote them with the matrix of colours to RGB, where
they mean nothing (its test converts them back, too). A pixel's z is the difference over the square root of the sum of:

- our variance: of the mean, from the layer `variance` of independent samples, as if R, G, B were fully correlated,
  and at least the reference's sample variance over our samples. Without the latter, a pixel of which our samples
  missed a rare part (an edge, a highlight) would have no variance;
- the reference's sample variance over its samples;
- the reference's rounding: Mitsuba sums N samples in float32, which puts a constant off by up to N 2^-25.

Where both variances are 0, the values must agree within 1e-4; what is darker than a thousandth of the picture's mean is not
compared. The smallest p-value is Sidak corrected; how many are below 0.01 has a binomial bound, by channel, because a pixel's
channels share their samples; the mean of the picture is tested alike, which notices what is small everywhere. Each must have
a probability of at least 1e-3.

The reference's sample count is not recorded. It is estimated from second differences of (ours - reference), where the
picture cancels: their median square is 0.455 times their variance. While our noise hides it, the test takes Mitsuba's
default of 32000, which then hardly matters. At last the test has to fail with surfaces 2 % too bright, if that is five standard
errors of the mean.

Our plastics approximate Mitsuba's (docs/formats.md), so the squares around them are left out, and their means have a
wider bound. Rounded sums make 5e-4 of difference, so more than 10^6 samples show nothing more.

    tests/images/mitsuba_tests.py build/bin/pertev [--device cuda] [--long] [--spp N] [--only NAME]
"""

import math
import pathlib
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[1] / "support"), str(HERE.parents[2] / "tools")]
import measurement  # noqa: E402
from read_exr import read_exr  # noqa: E402
from reference_job import ReferenceJob  # noqa: E402

FOLDER = pathlib.Path("mitsuba-tests/tests/scenes")
# Left, upper, right, lower pixel around the spheres of plastic and roughplastic in bsdf_spheres/fragments/sphere_grid.xml.
PLASTICS = [(9, 9, 18, 18), (19, 9, 28, 18), (9, 19, 18, 28)]
# Where the light leaves the two diffuse spheres of that file: our terminator is raised (shading/shadow_terminator.h), Mitsuba's jagged.
TERMINATORS = [(29, 23, 48, 28)]
SPHERES = "bsdf_spheres/test_{}_path.xml", "bsdf_spheres/refs/test_{}_ref_rgb"
# The scenes lit by a panorama, whose first and last rows lie at the poles. Ours has four rows for each, between them, which still blurs
# an edge of one texel by up to 2 %, so their pixels may deviate by that (as two standard errors), but not their mean.
PANORAMAS = "envmap", "roughdielectric", "textured_diffuse", "infinite_mirrors"
BLUR = 0.01
# Scene, reference without its extension, scatterings, squares that are left out. CI does without arealight, whose few bright pixels
# need more samples.
SCENES = {
    "envmap": (SPHERES[0].format("envmap"), SPHERES[1].format("envmap"), 1, PLASTICS),
    **{name: (SPHERES[0].format(name), SPHERES[1].format(name), 1, PLASTICS + TERMINATORS)
       for name in ("constant", "arealight", "pointlight")},
    **{name: (SPHERES[0].format(name), SPHERES[1].format(name), 1, []) for name in ("roughdielectric", "textured_diffuse")},
    "directional": ("floating_sphere/test_directional_direct.xml", "floating_sphere/refs/test_directional_ref_rgb", 1, []),
    "infinite_mirrors": ("infinite_mirrors/scene_path.xml", "infinite_mirrors/refs/scene_ref_rgb", 7, []),
}
SAMPLES = {"ci": 64, "long": 4096, "cuda": 131072}
DEFAULT_COUNT = 32000  # samples a pixel of test_renders.py in mitsuba3/src/render/tests
LEAST_P = 1e-3
MOST_ERROR = 0.1  # a square that is left out may deviate so much; few samples find the highlights there
XYZ_OF_RGB = ((0.412453, 0.357580, 0.180423), (0.212671, 0.715160, 0.072169), (0.019334, 0.119193, 0.950227))


def xyz(rows, layer=""):
    """Returns [(X, Y, Z) of each pixel], row by row."""
    colors = zip(*([value for row in rows[layer + channel] for value in row] for channel in "RGB"))
    return [tuple(sum(m * c for m, c in zip(line, color)) for line in XYZ_OF_RGB) for color in colors]


def largest_variances(rows):
    """Returns the variances of X, Y and Z of each pixel's mean if its R, G and B are fully correlated."""
    deviations = {channel: [[math.sqrt(max(value, 0)) for value in row] for row in rows[f"variance.{channel}"]] for channel in "RGB"}
    return [tuple(value ** 2 for value in pixel) for pixel in xyz(deviations)]


def any_of(p, count):
    """Returns the probability of one or more of `count` independent events of probability p each (Sidak)."""
    return -math.expm1(count * math.log1p(-p)) if p < 1 else 1.0


def binomial_tail(least, count, p):
    """Returns the probability of at least `least` of `count` events of probability p each."""
    terms = (math.lgamma(count + 1) - math.lgamma(k + 1) - math.lgamma(count - k + 1) + k * math.log(p) +
             (count - k) * math.log1p(-p) for k in range(least))
    return max(0.0, 1 - math.fsum(math.exp(term) for term in terms))


class Comparison:
    """Our picture and the reference, channel by channel: lists of all pixels, of which `kept` are compared."""

    def __init__(self, ours, reference, variance, samples, squares, blur):
        width, height, rows = ours
        self.width, self.samples, self.squares, self.blur = width, samples, squares, blur
        self.ours, self.reference = xyz(rows), xyz(reference)
        self.our_variance, self.variance = largest_variances(rows), xyz(variance)
        self.kept = [not any(x0 <= x < x1 and y0 <= y < y1 for x0, y0, x1, y1 in squares)
                     for y in range(height) for x in range(width)]
        self.black = 1e-3 * sum(sum(pixel) for pixel in self.reference) / (3 * len(self.reference))
        self.count, self.share = self.estimated_count()

    def parts(self, i, c):
        """Returns our variance of channel `c` of pixel `i`, and the reference's of one sample."""
        of_one = max(self.variance[i][c], 0)
        return max(self.our_variance[i][c], of_one / self.samples), of_one

    def is_constant(self, i):
        """Returns whether both variances are 0 in all channels, up to the rounding of a square."""
        return all(self.our_variance[i][c] <= 1e-12 * self.ours[i][c] ** 2 and
                   abs(self.variance[i][c]) <= 1e-6 * self.reference[i][c] ** 2 for c in range(3))

    def estimated_count(self):
        """Returns the reference's samples a pixel, and the share of its noise in the differences. The count is the
        default while that share would be below 0.1, or few pixels have much more noise than rounding."""
        terms = []  # squared second difference, our variance, the reference's of one sample
        for i, is_kept in enumerate(self.kept):
            for step in (1, self.width):
                before, after = i - step, i + step
                if step == 1 and not 0 < i % self.width < self.width - 1 or before < 0 or after >= len(self.kept):
                    continue
                if not (is_kept and self.kept[before] and self.kept[after]):
                    continue
                for c in range(3):
                    far = [self.ours[j][c] - self.reference[j][c] for j in (before, i, after)]
                    own, one = zip(*((self.our_variance[j][c], self.variance[j][c]) for j in (before, i, after)))
                    if min(own) > 0 and min(one) > 0.1 * max(self.reference[j][c] for j in (before, i, after)) ** 2:
                        terms.append(((far[0] - 2 * far[1] + far[2]) ** 2, own[0] + 4 * own[1] + own[2], one[0] + 4 * one[1] + one[2]))
        self.terms = len(terms)

        def share_of(count):
            return statistics.median(one / count / (own + one / count) for _, own, one in terms)

        if len(terms) < 300 or share_of(DEFAULT_COUNT) < 0.1:
            return DEFAULT_COUNT, share_of(DEFAULT_COUNT) if terms else 0.0
        low, high = 1e2, 1e7
        for _ in range(20):
            count = math.sqrt(low * high)
            is_more = statistics.median(square / (own + one / count) for square, own, one in terms) < 0.4549
            low, high = (count, high) if is_more else (low, count)
        return count, share_of(count)

    def p_values(self, brighter=1.0):
        """Returns those of each channel's kept pixels, of the noisy ones alone, and of the channels' means, for our light
        times `brighter`."""
        everywhere, noisy, of_means = [], ([], [], []), []
        for c in range(3):
            far, variance, light = 0.0, 0.0, 0.0
            for i, is_kept in enumerate(self.kept):
                if not is_kept:
                    continue
                a, b = brighter * self.ours[i][c], self.reference[i][c]
                own, one = self.parts(i, c)
                of_pixel = own + one / self.count
                far, variance, light = far + a - b, variance + of_pixel, light + b
                if max(a, b) <= self.black:
                    everywhere.append(1.0)
                elif self.is_constant(i):
                    everywhere.append(1.0 if abs(a - b) <= 1e-4 * max(a, b) else 0.0)
                else:
                    z = abs(a - b) / math.sqrt(of_pixel + (self.rounding() ** 2 + self.blur ** 2) * b ** 2)
                    noisy[c].append(math.erfc(z / math.sqrt(2)))
            of_means.append(math.erfc(abs(far) / math.sqrt(2 * (variance + (self.rounding() * light) ** 2))))
            everywhere += noisy[c]
        return everywhere, noisy, of_means

    def rounding(self):
        """The reference's relative standard error by rounding, if its error is even up to the bound."""
        return self.count * 2.0 ** -25 / math.sqrt(3)

    def verdict(self, brighter=1.0):
        """Returns the probabilities of the least p-value, of the number below 0.01, and of the picture's mean."""
        everywhere, noisy, of_means = self.p_values(brighter)
        tails = [binomial_tail(sum(p < 0.01 for p in one), len(one), 0.01) for one in noisy if one]
        return any_of(min(everywhere), len(everywhere)), any_of(min(tails), len(tails)), any_of(min(of_means), 3)

    def deviation(self):
        """Returns the relative standard error of the luminance of all kept pixels."""
        kept = [i for i, is_kept in enumerate(self.kept) if is_kept]
        variance = math.fsum(own + one / self.count for own, one in (self.parts(i, 1) for i in kept))
        return math.sqrt(variance) / math.fsum(self.reference[i][1] for i in kept)

    def square_errors(self):
        """Returns our luminance over the reference's, less 1, of each square that is left out."""
        for x0, y0, x1, y1 in self.squares:
            inside = [y * self.width + x for y in range(y0, y1) for x in range(x0, x1)]
            yield sum(self.ours[i][1] for i in inside) / sum(self.reference[i][1] for i in inside) - 1


def compare(job, name, folder, rows):
    scene, reference, depth, squares = SCENES[name]
    scene, samples = job.scene(FOLDER / scene), job.spp or SAMPLES[job.effort]
    picture, mean, variance = (pathlib.Path(folder, file) for file in ("ours.exr", "mean.exr", "variance.exr"))
    done = job.run("done", "render", scene, "-o", picture, "--spp", samples, "--sampler", "independent", "--aov", "variance",
                   "--device", job.device, "--no-bvh-cache", "--allow-path", job.scene("mitsuba-tests/common/meshes/sphere.obj").parent.parent)
    job.check("samples that were not finite", done["invalid_samples"], 0, 0)
    job.check("defaults that were added", len(done["made_up"]), 0, 0)
    # A leaf's back, which is black there, faces away from the camera.
    job.check("parts left out besides black backs", sum("the black back of" not in text for text in done["left_out"]), 0, 0)
    job.check("scatterings of the file", int(job.run("info", "info", picture)["pertev.max_depth"]), depth, depth)
    for source, target in ((f"{reference}.exr", mean), (f"{reference}_var.exr", variance)):
        job.run("convert", "convert", job.scene(FOLDER / source), target)
    both = Comparison(read_exr(picture), read_exr(mean)[2], read_exr(variance)[2], samples, squares, BLUR if name in PANORAMAS else 0.0)
    from_noise = f"{both.count:.0f}" if both.count != DEFAULT_COUNT else f"not estimated, {both.count} taken"
    print(f"       {name}: samples of the reference: {from_noise} (its share of the noise: {both.share:.2f}, of {both.terms} differences)")
    if both.count != DEFAULT_COUNT:  # an error of ours that looks like noise would make it small
        job.check(f"{name}: samples of the reference", both.count, DEFAULT_COUNT / 2, 2 * DEFAULT_COUNT)
    verdict = both.verdict()
    for what, p in zip(("least p-value", "number of p-values below 0.01", "means"), verdict):
        job.check(f"{name}: probability of the {what}", p, LEAST_P, 1)
    if both.deviation() < 0.02 / 5:
        job.check(f"{name}: the same for light that is 2 % brighter", min(both.verdict(1.02)), 0, LEAST_P)
    errors = list(both.square_errors())
    for error in errors:
        job.check(f"{name}: error of a square that is left out", error, -MOST_ERROR, MOST_ERROR)
    largest = float(f"{100 * max(map(abs, errors)):.2g}") if errors else None
    estimated = round(both.count, -2) if both.count != DEFAULT_COUNT else None
    rows.append([name, samples, estimated, *(float(f"{p:.2g}") for p in verdict), largest])


COLUMNS = (("scene", "scene", None), ("spp", "samples", None), ("count", "the reference's", None), ("least", "p of the least p-value", None),
           ("number", "p of the number below 0.01", None), ("means", "p of the means", None),
           ("left_out", "error of squares left out", "%"))


def main():
    job, rows = ReferenceJob(__doc__.splitlines()[0], only=SCENES), []
    with tempfile.TemporaryDirectory() as folder:
        for name in job.only:
            if name != "arealight" or job.spp or job.effort != "ci":
                compare(job, name, folder, rows)
    if job.results:
        measurement.write_measurement(job.results, job.program, "Against Mitsuba's tests", COLUMNS, rows, job.device, job.threads)
    job.end()


if __name__ == "__main__":
    main()
