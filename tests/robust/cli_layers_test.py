#!/usr/bin/env python3
"""An EXR file's layers (at edges and on the background) and metadata are those that docs/formats.md names."""

import os
import re

from cli_run import FLOOR, CliTest, main, read_exr, write

NONE = 4294967295
DOWN = ["--eye", "0,3,0", "--target", "0,0,0", "--projection", "orthographic", "--view-height", "4", "--filter", "box",
        "--environment", "1,1,1", "--aov", "albedo,normal,depth,position,ids"]  # pixels are 4/9 m wide, so edges lie between them
BELOW = "v -9 -1 -9\nv 9 -1 -9\nv 9 -1 9\nv -9 -1 9\nf 8 7 6 5\n"

# The results of a render. Everything else in the metadata is a flag.
RESULTS = {"version", "scene", "world_from_camera", "fov_y", "device", "hash", "invalid_samples", "load_seconds", "build_seconds",
           "render_seconds", "rays", "made_up", "left_out", "position_origin", "scene_hash", "by_default", "by_scene", "by_settings", "by_caller"}


class Layers(CliTest):
    def pixels(self, scene, spp, *flags):
        self.render(*DOWN, *flags, scene=scene, size="9x9", spp=spp, output="x.exr")
        width, height, layers = read_exr(self.path("x.exr"))
        return [{name: rows[y][x] for name, rows in layers.items()} for y in range(height) for x in range(width)]

    def test_layers_at_centres_have_one_hit_and_do_not_depend_on_samples(self):
        write(self.path("floor.obj"), FLOOR)
        pixels = self.pixels("floor.obj", 16, "--layers-at", "centre")
        one = self.pixels("floor.obj", 1, "--layers-at", "centre", "--seed", "5")
        names = [name for name in pixels[0] if "." in name]
        self.assertEqual([[pixel[name] for name in names] for pixel in pixels], [[pixel[name] for name in names] for pixel in one])
        self.assertNotEqual([pixel["R"] for pixel in pixels], [pixel["R"] for pixel in one])
        for i, pixel in enumerate(pixels):
            x, z = (i % 9 - 4) * 4 / 9, (i // 9 - 4) * 4 / 9
            hit = max(abs(x), abs(z)) < 1
            wanted = {"albedo.R": 0.5, "normal.Y": 1, "depth.Z": 3, "position.X": x, "position.Z": z}
            for name, value in wanted.items():
                self.assertAlmostEqual(pixel[name], value if hit else 0, places=5)
            self.assertEqual(pixel["id.instance"] == NONE, not hit)
        self.refuse(2, "render", "floor.obj", "-o", "y.exr", "--layers-at", "centre", says=["--aov"])

    def test_at_an_edge_only_hits_count_for_normal_depth_and_position(self):
        write(self.path("floor.obj"), FLOOR)
        first = self.pixels("floor.obj", 1, "--transparent")
        pixels = self.pixels("floor.obj", 64, "--transparent")
        shares = [pixel["A"] for pixel in pixels]
        self.assertGreater(len([share for share in shares if 0.1 < share < 0.9]), 8)
        self.assertTrue(0 in shares and 1 in shares)
        for pixel, of_first in zip(pixels, first):
            share = pixel["A"]
            self.assertAlmostEqual(pixel["albedo.R"], 0.5 * share, places=5)
            wanted = {"normal.X": 0, "normal.Y": 1, "normal.Z": 0, "depth.Z": 3, "position.Y": 0}
            for name, value in wanted.items():
                self.assertAlmostEqual(pixel[name], value if share > 0 else 0, places=5)
            self.assertLessEqual(max(abs(pixel["position.X"]), abs(pixel["position.Z"])), 1)
            ids = [pixel["id." + name] for name in ["instance", "primitive", "material"]]
            self.assertEqual(ids, [of_first["id." + name] for name in ["instance", "primitive", "material"]])
            self.assertEqual(ids[0], 0 if of_first["A"] == 1 else NONE)
            if share == 0:
                self.assertEqual((ids, pixel["position.X"], pixel["position.Z"]), ([NONE] * 3, 0, 0))
        # Sample 0 may miss a surface that others hit, and the reverse.
        self.assertTrue(any(pixel["id.instance"] == NONE and pixel["A"] > 0 for pixel in pixels))
        self.assertTrue(any(pixel["id.instance"] != NONE and pixel["A"] < 1 for pixel in pixels))

    def test_two_surfaces_in_a_pixel_give_a_mean_depth_and_position(self):
        write(self.path("two.obj"), FLOOR + BELOW)
        depths = []
        for pixel in self.pixels("two.obj", 64):
            depths.append(pixel["depth.Z"])
            self.assertAlmostEqual(pixel["position.Y"], 3 - pixel["depth.Z"], places=4)
            self.assertTrue(3 - 1e-5 <= pixel["depth.Z"] <= 4 + 1e-5)
        self.assertGreater(len([depth for depth in depths if 3.1 < depth < 3.9]), 8)


class Denoised(CliTest):
    def test_a_denoised_exr_keeps_the_noisy_picture_and_its_hash(self):
        flags = ["--spp", "2", "--size", "40x30", "--aov", "depth"]
        plain = self.succeed("render", "cornell-box", "-o", "plain.exr", "--json", *flags).events("done")[0]
        done = self.succeed("render", "cornell-box", "-o", "x.exr", "--json", "--denoise", "svgf", *flags).events("done")[0]
        self.assertEqual(done["hash"], plain["hash"])
        facts = self.info("x.exr")
        self.assertEqual((facts["pertev.denoise"], facts["pertev.hash"]), ("svgf", plain["hash"]))
        self.assertNotEqual(facts["hash"], plain["hash"])
        self.assertEqual((done["denoised_hash"], plain["denoised_hash"]), (facts["hash"], None))
        self.assertNotIn("pertev.denoise", self.info("plain.exr"))
        _, _, before = read_exr(self.path("plain.exr"))
        _, _, layers = read_exr(self.path("x.exr"))
        for name in "RGB":
            self.assertEqual(layers["noisy." + name], before[name])
            self.assertNotEqual(layers[name], before[name])
        self.assertEqual(layers["depth.Z"], before["depth.Z"])

    def test_each_frame_of_a_sequence_without_history_is_denoised_independently(self):
        flags = ["--spp", "2", "--size", "40x30", "--denoise", "svgf", "--turntable", "3", "--history", "0"]
        told = self.succeed("render", "cornell-box", "-o", "a-#.exr", "--json", *flags).events("frame")
        self.assertEqual([event["denoised_hash"] for event in told], [self.info(f"a-{frame}.exr")["hash"] for frame in range(3)])
        self.assertEqual([event["hash"] for event in told], [self.info(f"a-{frame}.exr")["pertev.hash"] for frame in range(3)])
        self.succeed("render", "cornell-box", "-o", "b-#.exr", *flags)
        os.remove(self.path("b-1.exr"))
        self.succeed("render", "cornell-box", "-o", "b-#.exr", "--continue", *flags)
        for frame in range(3):
            self.assertEqual(self.info(f"a-{frame}.exr")["hash"], self.info(f"b-{frame}.exr")["hash"])
        for other in (flags[:-2], [*flags[:4], "--turntable", "3"]):  # with a history, and not denoised
            self.refuse(2, "render", "cornell-box", "-o", "b-#.exr", "--continue", *other, says=["--continue"])


class Metadata(CliTest):
    def test_metadata_keys_are_names_of_flags(self):
        write(self.path("floor.obj"), FLOOR)
        flags = set(re.findall(r"(?<![\w-])--([a-z][a-z-]*)", self.succeed("render", "--help", "all").stdout))
        for more in [["--aperture", "0.1"], ["--projection", "orthographic"]]:
            self.render("--eye", "0,2,4", "--target", "0,0,0", *more, scene="floor.obj", output="x.exr")
            names = {name[7:] for name in self.info("x.exr") if name.startswith("pertev.")}
            self.assertEqual({name for name in names - RESULTS if name.replace("_", "-") not in flags}, set())
            self.assertLessEqual({"spp", "max_depth", "seed", "eye", "environment_scale"}, names)
            self.assertNotIn("samples", names)


if __name__ == "__main__":
    main()
