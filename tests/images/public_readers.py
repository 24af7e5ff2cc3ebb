#!/usr/bin/env python3
"""Lets public readers read Pertev's pictures: EXR of floats and halves, PNG of 8 and 16 bits, JPEG and HDR.

Each file is one render's, so the floats of the EXR give what the others must hold. The readers come from PyPI (OpenEXR,
pypng, Pillow, opencv-python-headless); one that is missing is skipped:

    tests/images/public_readers.py build/bin/pertev
"""

import argparse
import importlib.util
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from late_import import LateImport  # noqa: E402

numpy = LateImport("numpy")

LAYERS = "albedo,normal,depth,position,ids,uv,crypto_object"
HALVES = ("R", "G", "B", "A", "albedo")


def srgb(linear):
    c = numpy.clip(linear, 0, 1)
    return numpy.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


class Job:
    def __init__(self, program, folder):
        self.program, self.folder, self.failures, self.ran = program, folder, 0, 0

    def has(self, module):
        if importlib.util.find_spec(module):
            return True
        print(f"skipped: {module} is not installed")
        return False

    def render(self, name, *flags):
        shown = [] if name.endswith((".exr", ".hdr")) else ["--exposure", "0", "--tone-map", "srgb"]
        subprocess.run([self.program, "render", "cornell-box", "-o", self.folder / name, "--size", "61x47", "--spp", "16", "-q", *shown, *flags], check=True)
        return str(self.folder / name)

    def check(self, what, value, most):
        self.ran += 1
        self.failures += not value <= most
        print(f"{'ok    ' if value <= most else 'FAILED'} {what}: {value:.3g}, at most {most:.3g}")

    def channels(self, file):
        import OpenEXR
        return {name: channel.pixels for name, channel in OpenEXR.File(file, separate_channels=True).channels().items()}

    def exr(self):
        whole, half = self.channels(self.render("whole.exr", "--aov", LAYERS)), self.channels(self.render("half.exr", "--aov", LAYERS, "--exr-colors", "half"))
        self.check("channels of the half EXR that the other has not", len(set(whole) ^ set(half)), 0)
        for name, values in whole.items():
            wanted = values.astype(numpy.float16) if name.split(".")[0] in HALVES else values
            kind = numpy.uint32 if name.startswith("id.") else numpy.float32
            right = values.dtype == kind and half[name].dtype == wanted.dtype and (half[name] == wanted).all()
            self.check(f"layer {name}, {half[name].dtype} of {values.dtype}", 0 if right else 1, 0)

    def display(self, alpha):
        """Returns what a display shows of the floats, in double, with straight alpha."""
        flags = ["--transparent"] if alpha else []
        read = self.channels(self.render("light.exr", *flags))
        color = numpy.stack([read[c] for c in "RGB"], axis=-1).astype(float)
        if not alpha:
            return srgb(color), flags
        a = read["A"][..., None].astype(float)
        return numpy.concatenate([srgb(color / numpy.where(a > 0, a, 1)), numpy.clip(a, 0, 1)], axis=-1), flags

    def png(self):
        for alpha in False, True:
            wanted, flags = self.display(alpha)
            for bits in 8, 16:
                file = self.render("shown.png", "--png-bits", str(bits), *flags)
                if self.has("png"):
                    import png
                    width, height, rows, about = png.Reader(filename=file).read()
                    found = numpy.vstack([numpy.array(row) for row in rows]).reshape(height, width, -1)
                    self.check(f"PNG, bits that are not {bits}", abs(about["bitdepth"] - bits), 0)
                    self.check(f"PNG of {found.shape[2]} x {bits} bits by pypng, steps", abs(found[..., :wanted.shape[2]] - wanted * (2**bits - 1)).max(), 0.51)
                if bits == 8 and self.has("PIL"):
                    from PIL import Image
                    found = numpy.array(Image.open(file)).astype(float)
                    self.check("PNG by Pillow, steps", abs(found[..., :wanted.shape[2]] - wanted * 255).max(), 0.51)

    def jpeg(self):
        from PIL import Image
        wanted, _ = self.display(False)
        found = numpy.array(Image.open(self.render("shown.jpg"))).astype(float)
        self.check("JPEG by Pillow, root of the mean square in steps", ((found - 255 * wanted) ** 2).mean() ** 0.5, 4)

    def hdr(self):
        import cv2
        read = self.channels(self.render("light.exr"))
        wanted = numpy.stack([read[c] for c in "RGB"], axis=-1)
        found = cv2.imread(self.render("light.hdr"), cv2.IMREAD_UNCHANGED)[..., ::-1]
        self.check("HDR by OpenCV, of the largest channel", (abs(found - wanted) / wanted.max(axis=-1, keepdims=True).clip(1e-30)).max(), 1 / 128)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        job = Job(options.program, pathlib.Path(folder))
        if not job.has("OpenEXR"):
            sys.exit(77)
        job.exr()
        job.png()
        if job.has("PIL"):
            job.jpeg()
        if job.has("cv2"):
            job.hdr()
    sys.exit(1 if job.failures else 0)


if __name__ == "__main__":
    main()
