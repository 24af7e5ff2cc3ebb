#!/usr/bin/env python3
"""`--denoise oidn` with Open Image Denoise from PERTEV_OIDN or this Python's pyoidn, and the error without it. Without
the library the other tests are skipped. `--device cuda` runs all of them on a GPU."""

import glob
import importlib.util
import json
import os
import subprocess
import sys
import unittest

from cli_run import DEVICE, CliTest, main, read_exr

PACKAGE = importlib.util.find_spec("pyoidn")
LIBRARY = os.environ.get("PERTEV_OIDN") or (os.path.join(os.path.dirname(PACKAGE.origin), "oidn/lib") if PACKAGE else None)
SIZE = "96x96"
CHANNELS = {"": "RGB", "noisy": "RGB", "albedo": "RGB", "normal": "XYZ"}


def layer(rows, name):
    prefix = name + "." if name else ""
    return [value for row in zip(*(rows[prefix + channel] for channel in CHANNELS[name])) for pixel in zip(*row) for value in pixel]


def mean_difference(a, b):
    return sum(abs(x - y) for x, y in zip(a, b)) / len(a)


def relative_error(a, reference):
    return sum((x - y) ** 2 / (y ** 2 + 0.01) for x, y in zip(a, reference)) / len(a)


class Refused(CliTest):
    def test_without_the_library_nothing_is_read_or_rendered(self):
        self.environment["PERTEV_OIDN"] = "/nowhere"
        for flags in [["-o", "x.exr", "--denoise", "oidn"], ["-o", "x-#.exr", "--turntable", "90", "--frames", "0-1", "--real-time",
                                                             "--frame-denoiser", "oidn"]]:
            self.refuse(2, "render", "no-such-scene.gltf", *flags, "--json", says=["pip install pyoidn"])
        self.refuse(2, "bench", "sequence", "cornell-box", "--turntable", "90", "--frames", "0-1", "--denoise", "svgf", says=["--reference"])


@unittest.skipIf(LIBRARY is None, "there is no Open Image Denoise")
class Denoised(CliTest):
    def setUp(self):
        super().setUp()
        self.environment["PERTEV_OIDN"] = LIBRARY

    def picture(self, name, *arguments, spp=4):
        done = self.render("--aov", "albedo,normal", *arguments, size=SIZE, spp=spp, output=name)
        return done, read_exr(self.path(name))[2]

    def test_pictures_through_distorting_lenses_are_denoised(self):
        view = ["--eye", "0.278,0.273,-0.3", "--target", "0.278,0.273,0"]
        for lens in (["--distortion", "0.2,0,0,0"], ["--lens", "fisheye"]):
            _, noisy = self.picture("plain.exr", *view, *lens)
            _, rows = self.picture("x.exr", *view, *lens, "--denoise", "oidn")
            _, reference = self.picture("reference.exr", *view, *lens, "--seed", "9", spp=128)
            self.assertEqual(layer(rows, "noisy"), layer(noisy, ""))
            errors = [relative_error(layer(of, ""), layer(reference, "")) for of in (rows, noisy)]
            self.assertLess(errors[0], 0.3 * errors[1], lens)

    def test_several_devices_have_the_film_of_one_and_its_denoised_picture(self):
        line = ["render", "cornell-box", "--size", SIZE, "--spp", "24", "--denoise", "oidn", "--aov", "albedo,normal", "--json"]
        whole = self.succeed(*line, "-o", "one.exr", "--device", "cpu").events("done")[0]
        shared = self.succeed(*line, "-o", "two.exr", "-o", "two.pvf", "--device", "cpu,cpu").events("done")[0]
        alone, together = (read_exr(self.path(name))[2] for name in ("one.exr", "two.exr"))
        self.assertEqual((shared["hash"], shared["layers_hash"]), (whole["hash"], whole["layers_hash"]))
        self.assertRegex(self.info("two.exr")["pertev.denoiser"], "^Open Image Denoise 2")
        apart = mean_difference(layer(alone, ""), layer(alone, "noisy"))
        self.assertLess(mean_difference(layer(together, ""), layer(alone, "")), 1e-3 * apart)
        self.succeed("merge", "two.pvf", "-o", "merged.exr")
        self.assertLess(mean_difference(layer(read_exr(self.path("merged.exr"))[2], ""), layer(alone, "")), 1e-3 * apart)

    def test_four_samples_are_much_closer_to_the_reference_and_the_film_is_unchanged(self):
        plain, noisy = self.picture("plain.exr")
        done, rows = self.picture("x.exr", "--denoise", "oidn")
        self.assertEqual((done["hash"], done["rays_per_second"] > 0), (plain["hash"], True))
        self.assertEqual(layer(rows, "noisy"), layer(noisy, ""))
        _, reference = self.picture("reference.exr", "--seed", "9", spp=256)
        errors = [relative_error(layer(of, ""), layer(reference, "")) for of in (rows, noisy)]
        print(f"relMSE of 4 samples {errors[1]:.5f}, denoised {errors[0]:.5f}")
        self.assertLess(errors[0], 0.1 * errors[1])
        told = self.info("x.exr")
        self.assertRegex(told["pertev.denoiser"], rf"^Open Image Denoise 2\.\d+\.\d+ on {'the CPU' if DEVICE == 'cpu' else 'NVIDIA.*'}, high quality$")
        self.assertEqual(told["pertev.hash"], plain["hash"])
        self.assertNotIn("pertev.denoiser", self.info("plain.exr"))
        said = self.succeed("render", "cornell-box", "-o", "y.exr", "--size", SIZE, "--spp", "4", "--denoise", "oidn", "--device", DEVICE)
        self.assertIn("Open Image Denoise 2.", said.stdout + said.stderr)

    def test_the_picture_is_that_of_pyoidn_with_the_same_layers(self):
        python = next((path for path in [sys.executable, *glob.glob(os.path.join(LIBRARY, "../../../../../../bin/python3"))]
                       if subprocess.run([path, "-c", "import pyoidn, numpy"], check=False, stderr=subprocess.DEVNULL).returncode == 0), None)
        if python is None:
            self.skipTest("no Python has pyoidn and numpy")
        _, rows = self.picture("x.exr", "--denoise", "oidn", "--transparent", spp=16)
        alpha = [value for row in rows["A"] for value in row]  # normals are means over the samples that hit something
        guides = [layer(rows, "albedo"), [value * alpha[i // 3] for i, value in enumerate(layer(rows, "normal"))]]
        script = ("import json, sys, numpy, pyoidn\n"
                  "layers = [numpy.array(v, numpy.float32).reshape(96, 96, 3) for v in json.load(sys.stdin)]\n"
                  "made = pyoidn.denoise(layers[0], albedo=layers[1], normal=layers[2], hdr=True, clean_aux=True, quality='high')\n"
                  "json.dump(made.ravel().tolist(), sys.stdout)\n")
        done = subprocess.run([python, "-c", script], input=json.dumps([layer(rows, "noisy"), *guides]),
                              stdout=subprocess.PIPE, text=True, check=True)
        theirs, ours = json.loads(done.stdout), layer(rows, "")
        print(f"mean difference from pyoidn {mean_difference(ours, theirs):.3g}, from the samples {mean_difference(ours, layer(rows, 'noisy')):.3g}")
        self.assertLess(mean_difference(ours, theirs), 1e-3 * mean_difference(ours, layer(rows, "noisy")))

    def test_frames_are_denoised_and_their_hashes_are_those_before_denoising(self):
        line = ["render", "cornell-box", "--size", "48x48", "--device", DEVICE, "--turntable", "90", "--frames", "0-2", "--real-time", "--json"]
        plain = self.succeed(*line, "-o", "a-#.exr", "--no-reconstruction").events("frame")
        made = self.succeed(*line, "-o", "b-#.exr", "--frame-denoiser", "oidn").events("frame")
        self.assertEqual([event["hash"] for event in made], [event["hash"] for event in plain])
        rows, before = (read_exr(self.path(name))[2] for name in ("b-2.exr", "a-2.exr"))
        self.assertEqual(layer(rows, "noisy"), layer(before, ""))
        self.assertNotEqual(layer(rows, ""), layer(before, ""))
        self.assertRegex(self.info("b-2.exr")["pertev.denoiser"], "fast quality$")

    def test_a_sequence_is_compared_with_denoised_pictures(self):
        line = ["bench", "sequence", "cornell-box", "--device", DEVICE, "--size", "48x48", "--turntable", "90", "--frames", "0-2"]
        made = self.succeed(*line, "--reference", "32", "--denoise", "oidn", "--json").events("sequence_errors")[0]
        self.assertLess(made["denoised"]["hdr_flip"], 0.7 * made["sample"]["hdr_flip"])
        self.assertIn("Open Image Denoise 2.", made["denoiser"])
        plain, shown = (self.succeed(*line, "--reference", "32", *flags, "--json").events("sequence_errors")[0]
                        for flags in (["--no-reconstruction"], ["--frame-denoiser", "oidn"]))
        self.assertEqual(shown["last_frame"], plain["last_frame"])
        self.assertLess(shown["ours"]["hdr_flip"], 0.8 * plain["ours"]["hdr_flip"])


if __name__ == "__main__":
    if LIBRARY is None:
        refused = unittest.TextTestRunner().run(unittest.defaultTestLoader.loadTestsFromTestCase(Refused))
        sys.exit(77 if refused.wasSuccessful() else 1)
    main()
