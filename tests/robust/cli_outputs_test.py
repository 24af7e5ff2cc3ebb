#!/usr/bin/env python3
"""Numbers of files (half, 16 bits), the standard output, look-up tables, and `compare` with thresholds."""

import subprocess
import struct

from cli_run import PROGRAM, CliTest, decode_png, main, read_exr, read_png, write

PICTURE = ["render", "cornell-box", "--size", "12x9", "--spp", "4", "--device", "cpu"]
FIXED = ["--exposure", "0.5"]


def cube(side, change, low=(0, 0, 0), high=(1, 1, 1)):
    """The text of a table of change(r, g, b) over a domain."""
    steps = [[low[c] + (high[c] - low[c]) * i / (side - 1) for i in range(side)] for c in range(3)]
    domain = "" if high == (1, 1, 1) else f"DOMAIN_MIN {low[0]} {low[1]} {low[2]}\nDOMAIN_MAX {high[0]} {high[1]} {high[2]}\n"
    return f"# test\nTITLE \"x\"\nLUT_3D_SIZE {side}\n{domain}\n" + "".join(
        "{} {} {}\n".format(*change(r, g, b)) for b in steps[2] for g in steps[1] for r in steps[0])


class Numbers(CliTest):
    def test_half_colours_are_rounded_and_other_layers_keep_32_bits(self):
        layers = ["--aov", "albedo,position,ids,crypto_object,variance"]
        self.succeed(*PICTURE, "-o", "whole.exr", *layers)
        self.succeed(*PICTURE, "-o", "half.exr", *layers, "--exr-colors", "half")
        whole, half = read_exr(self.path("whole.exr"))[2], read_exr(self.path("half.exr"))[2]
        self.assertEqual(list(whole), list(half))
        for name, rows in whole.items():
            is_color = name in "RGB" or name.startswith("albedo")
            wanted = [tuple(struct.unpack("e", struct.pack("e", x))[0] for x in row) for row in rows] if is_color else rows
            self.assertEqual([tuple(row) for row in half[name]], [tuple(row) for row in wanted], name)
        self.assertNotEqual(half["R"], whole["R"])
        self.assertEqual(self.info("half.exr")["pertev.hash"], self.info("whole.exr")["pertev.hash"])

    def test_png_of_16_bits_rounds_to_that_of_8(self):
        self.succeed(*PICTURE, "-o", "8.png", *FIXED)
        self.succeed(*PICTURE, "-o", "16.png", *FIXED, "--png-bits", "16")
        narrow, wide = read_png(self.path("8.png")), read_png(self.path("16.png"))
        self.assertGreater(max(max(pixel) for pixel in wide), 255)
        for a, b in zip(narrow, wide):
            for x, y in zip(a, b):
                self.assertLessEqual(abs(x - y / 257), 0.502)
        self.assertGreater(len({value % 257 for pixel in wide for value in pixel}), 20)
        self.refuse(2, *PICTURE, "-o", "x.png", "--png-bits", "12", says=["--png-bits"])
        self.refuse(2, *PICTURE, "-o", "x.exr", "--png-bits", "16", says=["PNG"])

    def test_a_picture_goes_to_the_standard_output(self):
        self.succeed(*PICTURE, "-o", "file.png", *FIXED)
        for name in "png", "exr":
            run = subprocess.run([PROGRAM, *PICTURE, "-o", "-", "--output-format", name, *(FIXED if name == "png" else [])], cwd=self.folder, env=self.environment, capture_output=True, check=True)
            if name == "png":
                with open(self.path("file.png"), "rb") as file:
                    self.assertEqual(run.stdout, file.read())
                self.assertEqual(len(decode_png(run.stdout)), 12 * 9)
            else:
                self.assertEqual(run.stdout[:4], b"\x76\x2f\x31\x01")
            self.assertIn(b"spp", run.stderr)
        self.refuse(2, *PICTURE, "-o", "-", says=["--output-format"])
        self.refuse(2, *PICTURE, "-o", "-", "--output-format", "png", "--json", says=["--json"])
        self.refuse(2, *PICTURE, "-o", "x.exr", "--output-format", "exr", says=["--output-format"])
        self.refuse(2, *PICTURE, "-o", "-", "-o", "-", "--output-format", "exr", says=["same file"])
        self.refuse(2, *PICTURE, "-o", "-", "--output-format", "gif", says=["--output-format"])


class Tables(CliTest):
    def show(self, *flags, output="x.png"):
        self.succeed(*PICTURE, "-o", output, *FIXED, *flags)
        return read_png(self.path(output))

    def test_a_table_follows_the_tone_map_or_replaces_it(self):
        plain = self.show()
        write(self.path("same.cube"), cube(5, lambda r, g, b: (r, g, b)))
        self.assertLessEqual(max(abs(x - y) for a, b in zip(plain, self.show("--lut", "same.cube")) for x, y in zip(a, b)), 0)
        write(self.path("swap.cube"), cube(3, lambda r, g, b: (1 - g, b, r)))
        for (r, g, b), shown in zip(plain, self.show("--lut", "swap.cube")):
            for x, y in zip((255 - g, b, r), shown):
                self.assertLessEqual(abs(x - y), 1)
        write(self.path("light.cube"), cube(9, lambda r, g, b: (r / 8, g / 8, b / 8), high=(8, 8, 8)))
        self.succeed(*PICTURE, "-o", "x.exr")
        _, _, rows = read_exr(self.path("x.exr"))
        light = zip(*[sum(map(list, rows[name]), []) for name in "RGB"])
        for pixel, shown in zip(light, self.show("--lut", "light.cube", "--lut-input", "light")):
            for x, y in zip(pixel, shown):
                self.assertLessEqual(abs(min(x * 2**0.5, 8) / 8 * 255 - y), 0.51)

    def test_parts_with_a_table_merge_to_the_shown_picture(self):
        write(self.path("swap.cube"), cube(3, lambda r, g, b: (1 - g, b, r)))
        whole = self.show("--lut", "swap.cube")
        for i in "12":
            self.succeed(*PICTURE, "-o", i + ".pvf", *FIXED, "--part", i + "/2", "--lut", "swap.cube")
        self.succeed("merge", "1.pvf", "2.pvf", "-o", "all.png", "-o", "all.exr")
        self.assertEqual(read_png(self.path("all.png")), whole)
        self.assertEqual(self.info("all.exr")["pertev.lut"], "swap.cube")
        write(self.path("same.cube"), cube(2, lambda r, g, b: (r, g, b)))
        self.succeed("merge", "1.pvf", "2.pvf", "-o", "same.png", "--lut", "same.cube")
        self.assertEqual(read_png(self.path("same.png")), self.show())

    def test_a_damaged_table_is_refused_with_its_line(self):
        good = cube(2, lambda r, g, b: (r, g, b))
        for text, says in {good[:-12]: "cut off", good + "0 0 0\n": ":13", good.replace("LUT_3D_SIZE 2", "LUT_3D_SIZE 1"): ":3", good.replace("LUT_3D", "LUT_1D"): ":7",
                           "0 0 0\n" + good: ":1", good.replace("TITLE", "TITEL"): "TITEL", "": "LUT_3D_SIZE", good.replace("1.0 1.0 1.0", "1.0 nan 1.0"): "three numbers",
                           good.replace("LUT_3D_SIZE 2", "LUT_3D_SIZE 2\nDOMAIN_MAX 0 1 1"): "DOMAIN_MIN"}.items():
            write(self.path("bad.cube"), text)
            self.refuse(2, "render", "nowhere.obj", "-o", "x.png", "--lut", "bad.cube", says=["bad.cube", says])
        self.refuse(2, "render", "nowhere.obj", "-o", "x.png", "--lut", "none.cube", says=["none.cube"])
        self.refuse(2, "render", "nowhere.obj", "-o", "x.png", "--lut-input", "light", says=["--lut"])


class Compare(CliTest):
    def compare(self, *arguments, status=0):
        outcome = self.run_pertev("compare", *arguments, "--json")
        self.assertEqual(outcome.status, status, outcome)
        return outcome.events("compare")[0]

    def test_a_threshold_decides_the_status_by_any_metric(self):
        for seed in "12":
            self.succeed(*PICTURE, "-o", seed + ".exr", "--seed", seed)
        found = self.compare("1.exr", "2.exr")
        self.assertIsNone(found["within"])
        for metric in "rel_mse", "rel_mse_98", "mse", "mape", "smape", "flip", "hdr_flip":
            self.assertGreater(found[metric], 0)
            for factor, status in (1.01, 0), (0.99, 1):
                judged = self.compare("1.exr", "2.exr", "--metric", metric, "--threshold", repr(found[metric] * factor), status=status)
                self.assertEqual(judged["within"], status == 0)
        rows = [read_exr(self.path(name))[2] for name in ("1.exr", "2.exr")]
        pairs = [(a, b) for c in "RGB" for x, y in zip(rows[0][c], rows[1][c]) for a, b in zip(x, y)]
        self.assertAlmostEqual(found["mape"], sum(abs(a - b) / (abs(b) + 0.01) for a, b in pairs) / len(pairs), places=6)
        self.assertAlmostEqual(found["smape"], sum(abs(a - b) / ((abs(a) + abs(b)) / 2 + 0.01) for a, b in pairs) / len(pairs), places=6)
        self.refuse(2, "compare", "1.exr", "2.exr", "--metric", "p_value", "--threshold", "0.01", says=["--metric", "variance"])
        self.refuse(2, "compare", "1.exr", "2.exr", "--metric", "psnr", says=["--metric"])
        for other, status in ("1.exr", 0), ("2.exr", 1):
            self.compare("1.exr", other, "--metric", "mse", "--threshold", "0", status=status)
        self.refuse(2, "compare", "1.exr", "2.exr", "--threshold", "-1", says=["--threshold"])

    def test_a_difference_and_its_p_values_tell_noise_from_bias(self):
        flags = ["--aov", "variance", "--sampler", "independent", "--spp", "64", "--filter", "box"]
        for name, more in {"a": "--seed 1", "b": "--seed 2", "dim": "--seed 3 --max-depth 1"}.items():
            self.succeed(*PICTURE[:4], "-o", name + ".exr", *flags, "--device", "cpu", *more.split())
        same = self.compare("a.exr", "b.exr", "--difference", "d.exr", "--metric", "p_value", "--threshold", "1e-4")
        self.assertLess(same["p_below"], 0.06)
        self.assertGreater(same["p_value"], 1e-4)
        other = self.compare("a.exr", "dim.exr", "--metric", "p_value", "--threshold", "1e-4", status=1)
        self.assertGreater(other["p_below"], 0.2)
        a, b, d = (read_exr(self.path(name + ".exr"))[2] for name in "abd")
        for x, y, z, p in zip(a["G"][4], b["G"][4], d["G"][4], d["p_value.G"][4]):
            self.assertAlmostEqual(x - y, z, places=6)
            self.assertTrue(0 <= p <= 1)
        self.compare("a.exr", "b.exr", "--difference", "d.png")
        self.assertEqual(len(read_png(self.path("d.png"))), 12 * 9)
        self.refuse(2, "compare", "a.exr", "b.exr", "--difference", "d.gif", says=["d.gif"])


if __name__ == "__main__":
    main()
