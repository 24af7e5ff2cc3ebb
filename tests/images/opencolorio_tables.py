#!/usr/bin/env python3
"""Shows random colours through look-up tables by Pertev and by OpenColorIO, and compares them.

A sky of random light, also far outside the tables' domains, is rendered to an EXR and, through a table, to a PNG of 16
bits. OpenColorIO reads the same table and processes the EXR's colours by tetrahedra. Its Baker also makes tables, of
ACES 2.0's display. It comes from PyPI, as do the files' readers (opencolorio, OpenEXR, pypng):

    tests/images/opencolorio_tables.py build/bin/pertev [--keep FOLDER]
"""

import argparse
import importlib.util
import itertools
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from late_import import LateImport  # noqa: E402

numpy = LateImport("numpy")

SIZE = (256, 128)
STEP = 1 / 65535  # a PNG of 16 bits has this
TOLERANCE = 1.5  # steps: half of one is the PNG's rounding, one is for floats of coordinates up to 64 in the table
NAMES = {"light": "Linear Rec.709 (sRGB)", "display": "sRGB - Display"}
STOPS = 12  # a shaper has these, up to light of 16


def rows(values):
    return "".join("{:.9g} {:.9g} {:.9g}\n".format(*row) for row in values)


def random_rows(count, low=-0.2, high=1.2, seed=1):
    return rows(numpy.random.default_rng(seed).uniform(low, high, (count, 3)))


def grid_rows(side, change):
    """Values of change(r, g, b) over [0, 1]^3, red fastest."""
    steps = numpy.arange(side) / (side - 1)
    b, g, r = (axis.ravel() for axis in numpy.meshgrid(steps, steps, steps, indexing="ij"))
    return rows(numpy.stack(change(r, g, b), axis=-1))


def domain(low, high):
    return "DOMAIN_MIN {} {} {}\nDOMAIN_MAX {} {} {}\n".format(*low, *high)


def baked(form, table_input, side, shaper=0):
    """A table of ACES 2.0's display that OpenColorIO has made."""
    import PyOpenColorIO as ocio
    baker = ocio.Baker()
    config = ocio.Config.CreateFromFile("ocio://default")
    logarithm = ocio.LogAffineTransform(linSideOffset=[2.0 ** (4 - STOPS)] * 3, logSideSlope=[1 / STOPS] * 3, logSideOffset=[1 - 4 / STOPS] * 3,
                                        direction=ocio.TRANSFORM_DIR_INVERSE)
    logarithm.setBase(2)
    to_reference = ocio.GroupTransform()
    to_reference.appendTransform(logarithm)
    to_reference.appendTransform(ocio.ColorSpaceTransform(src=NAMES["light"], dst="ACES2065-1"))  # the reference
    config.addColorSpace(ocio.ColorSpace(name="shaper", toReference=to_reference))
    baker.setConfig(config)
    baker.setFormat(form)
    baker.setInputSpace(NAMES[table_input])
    baker.setDisplayView("sRGB - Display", "ACES 2.0 - SDR 100 nits (Rec.709)")
    baker.setCubeSize(side)
    if shaper:
        baker.setShaperSpace("shaper"), baker.setShaperSize(shaper)
    return baker.bake()


def cases():
    """Tables as (name, --lut-input, text)."""
    size = "LUT_3D_SIZE {}\n".format
    wild = domain((0.1, 0.02, -3), (4, 0.9, 7.5))
    swapped = lambda r, g, b: (0.2 + 0.7 * b * r, 1 - g**2, 0.5 * r + 0.5 * b * g)
    for side in 2, 3, 5, 17, 33, 64:
        yield f"random, {side}", "light", size(side) + random_rows(side**3, seed=side)
    yield "random, 17, domain", "light", size(17) + wild + random_rows(17**3)
    yield "words and blanks", "light", "# a\r\nTITLE \"b c\"\r\n\r\n" + wild + size(3) + "\n" + random_rows(27).replace("\n", "\r\n\t").replace(" 0.", "  +0.").rstrip("\t")
    yield "smooth, 9", "display", size(9) + grid_rows(9, swapped)
    yield "smooth, 33, domain", "display", size(33) + domain((0.2, 0.2, 0.2), (0.7, 0.8, 0.9)) + grid_rows(33, swapped)
    yield "ACES, 33", "display", baked("iridas_cube", "display", 33)
    yield "curves, 2", "light", "LUT_1D_SIZE 2\n" + random_rows(2)
    yield "curves, 4096, domain", "light", "LUT_1D_SIZE 4096\n" + wild + rows(numpy.cumsum(numpy.random.default_rng(2).uniform(0, 5e-4, (4096, 3)), axis=0))
    yield "Resolve's range", "light", "LUT_3D_SIZE 17\nLUT_3D_INPUT_RANGE 0.25 6\n" + random_rows(17**3)
    yield "Resolve's curves", "light", "LUT_1D_SIZE 100\nLUT_1D_INPUT_RANGE 0.5 4\n" + random_rows(100, 0, 1)
    yield "Resolve's shaper, random", "light", "LUT_1D_SIZE 33\nLUT_1D_INPUT_RANGE 0.1 9\nLUT_3D_SIZE 5\nLUT_3D_INPUT_RANGE 0.1 0.8\n" + random_rows(33, 0, 1) + random_rows(125, seed=3)
    yield "ACES by a shaper, 33", "light", baked("resolve_cube", "light", 33, 4096)


def srgb(linear):
    c = numpy.clip(linear, 0, 1)
    return numpy.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def by_opencolorio(path, colors, interpolation):
    import PyOpenColorIO as ocio
    transform = ocio.FileTransform(src=str(path), interpolation=interpolation)
    processor = ocio.Config.CreateRaw().getProcessor(transform).getOptimizedCPUProcessor(ocio.OPTIMIZATION_NONE)
    result = numpy.array(colors, dtype=numpy.float32)
    processor.applyRGB(result)
    return numpy.clip(result.astype(float), 0, 1)


class Job:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.folder.mkdir(parents=True, exist_ok=True)
        import OpenEXR
        light = numpy.random.default_rng(7)
        sky = (2 ** light.uniform(-9, 4, (SIZE[1] // 2, SIZE[0] // 2, 3))).astype(numpy.float32)
        sky[light.random(sky.shape) < 0.1] = 0
        OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, {"RGB": sky}).write(str(folder / "sky.exr"))
        (folder / "below.obj").write_text("v 0 -1e3 0\nv 1 -1e3 0\nv 0 -1e3 1\nf 1 2 3\n")

    def picture(self, name, *flags):
        subprocess.run([self.program, "render", self.folder / "below.obj", "-o", self.folder / name, "--environment", self.folder / "sky.exr", "--lens", "equirectangular", "--size", "{}x{}".format(*SIZE),
                        "--spp", "1", "--eye", "0,0,0", "--target", "0,0,-1", "--ground", "off", "--max-depth", "0", "--no-bvh-cache", "-q", *flags], check=True)
        return self.folder / name

    def light(self):
        import OpenEXR
        return OpenEXR.File(str(self.picture("light.exr"))).channels()["RGB"].pixels.reshape(-1, 3)

    def shown(self, table, table_input):
        import png
        file = self.picture("shown.png", "--png-bits", "16", "--exposure", "0", "--tone-map", "srgb", "--lut", table, "--lut-input", table_input)
        width, height, values, about = png.Reader(filename=str(file)).read()
        pixels = numpy.vstack([numpy.array(row) for row in values]).reshape(width * height, -1)
        assert about["bitdepth"] == 16
        return pixels[:, :3] * STEP


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--keep", help="a folder for the tables and pictures")
    options = parser.parse_args()
    if missing := [name for name in ("PyOpenColorIO", "OpenEXR", "png") if not importlib.util.find_spec(name)]:
        print("skipped:", *missing, "not installed")
        sys.exit(77)
    import PyOpenColorIO as ocio
    ocio.SetLoggingLevel(ocio.LOGGING_LEVEL_NONE)  # else it says that curves have no tetrahedra
    failed = False
    with tempfile.TemporaryDirectory() as temporary:
        job = Job(options.program, pathlib.Path(options.keep or temporary))
        light = job.light()
        print("| table | input | largest difference, steps of 16 bits | mean | of trilinear |\n|---|---|---:|---:|---:|")
        for number, (name, table_input, text) in enumerate(cases()):
            table = job.folder / f"{number}.cube"
            table.write_bytes(text.encode())
            colors = light if table_input == "light" else srgb(light.astype(float))
            far = {way: abs(job_shown - by_opencolorio(table, colors, way)) / STEP for job_shown in [job.shown(table, table_input)] for way in (ocio.INTERP_TETRAHEDRAL, ocio.INTERP_LINEAR)}
            worst = far[ocio.INTERP_TETRAHEDRAL]
            good = worst.max() <= TOLERANCE
            failed = failed or not good
            print(f"| {name} | {table_input} | {worst.max():.2f}{'' if good else ' FAILED'} | {worst.mean():.2f} | {far[ocio.INTERP_LINEAR].max():.2f} |", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
