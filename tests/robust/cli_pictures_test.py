"""PNG and JPEG output, which is exposed and tone-mapped without a flag, and cameras whose flags are incomplete."""

import json
import math
import re

from cli_run import FLOOR, CliTest, as_flag, gltf_with_cameras, main, read_exr, read_png, write

# The floor, and an upright sheet behind its far edge.
SHEET = FLOOR + "v -1 0 -1\nv 1 0 -1\nv 1 2 -1\nv -1 2 -1\nf 5 6 7 8\n"
VIEW = ["--eye", "0,2,4", "--target", "0,0,0"]
PLAIN = ["--tone-map", "srgb", "--exposure", "0"]


class HowPicturesAreShown(CliTest):
    def show(self, *arguments, scene="cornell-box", size="16x16", spp=1, outputs=("x.png",)):
        """Renders on the CPU and returns the notices about exposure."""
        named = [word for output in outputs for word in ("-o", output)]
        said = self.succeed("render", scene, *named, "--size", size, "--spp", spp, "--device", "cpu", "--json",
                            *arguments)
        return [event["text"] for event in said.events("notice") if "--tone-map" in event["text"]]

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def test_the_exposure_and_the_tone_map_are_an_object_of_the_json_lines(self):
        def told(*arguments, output="x.png"):
            return self.succeed("render", "cornell-box", "-o", output, "--size", "16x16", "--spp", 1, "--device", "cpu",
                                "--json", *arguments).events("exposure")

        found = told()
        self.assertEqual([(one["auto"], one["tone_map"]) for one in found], [(True, "agx")])
        given = told("--exposure", -1.5, "--tone-map", "aces")
        self.assertEqual([(one["auto"], one["tone_map"], one["stops"]) for one in given], [(False, "aces", -1.5)])
        self.assertEqual(told(output="x.exr"), [])

    def flags_in(self, notice):
        return re.search(r"\((--exposure \S+ --tone-map \S+) ", notice).group(1).split()

    def test_the_flags_in_the_exposure_notice_reproduce_the_file(self):
        for name in ["x.png", "x.jpg"]:
            for flags in [[], ["--tone-map", "srgb"], ["--exposure", "auto"]]:
                with self.subTest(name=name, flags=flags):
                    notices = self.show(*flags, outputs=[name])
                    self.assertEqual(len(notices), 1)
                    again = self.flags_in(notices[0])
                    self.assertEqual(again[3], "srgb" if "srgb" in flags else "agx")
                    self.assertNotEqual(float(again[1]), 0)
                    found = self.read(name)
                    self.assertEqual(self.show(*again, outputs=[name]), [])
                    self.assertEqual(self.read(name), found)

    def test_samples_noise_seed_and_size_do_not_change_the_exposure(self):
        write(self.path("sheet.obj"), SHEET)
        for scene, flags in [("cornell-box", []), ("sheet.obj", VIEW)]:
            notices = {notice for spp, seed, size in [(1, 0, "16x9"), (64, 0, "16x9"), (2, 99, "32x18")]
                       for notice in self.show(*flags, "--seed", seed, scene=scene, size=size, spp=spp)}
            self.assertEqual(len(notices), 1, notices)

    def test_ten_times_the_light_lowers_the_exposure_by_log2_of_10(self):
        write(self.path("sheet.obj"), SHEET)
        stops = [float(self.flags_in(self.show(*VIEW, "--environment", light, scene="sheet.obj")[0])[1])
                 for light in ["0.5,0.5,0.5", "5,5,5"]]
        self.assertAlmostEqual(stops[0] - stops[1], math.log2(10), delta=0.011)

    def test_png_without_tone_mapping_matches_the_exr_and_an_exr_alone_is_not_metered(self):
        write(self.path("floor.obj"), FLOOR)
        away = ["--eye", "0,1,5", "--target", "0,1,9", "--environment", "0.5,0.25,0.125"]
        self.assertEqual(self.show(*away, *PLAIN, scene="floor.obj"), [])
        encoded = tuple(round(255 * (1.055 * light ** (1 / 2.4) - 0.055)) for light in [0.5, 0.25, 0.125])
        self.assertEqual(set(read_png(self.path("x.png"))), {encoded})
        self.assertEqual(self.show(*away, scene="floor.obj", outputs=["x.exr", "x.hdr"]), [])
        _, _, layers = read_exr(self.path("x.exr"))
        self.assertEqual([layers[channel][3][3] for channel in "RGB"], [0.5, 0.25, 0.125])

    def test_an_exr_beside_a_png_is_linear_and_records_the_tone_map_of_the_png(self):
        exposure = self.flags_in(self.show(outputs=["x.exr", "x.png"])[0])[1]
        told = self.info("x.exr")
        self.assertEqual((told["pertev.tone_map"], round(told["pertev.exposure"], 2)), ("agx", float(exposure)))
        beside = self.info("x.exr")["hash"]
        self.show(outputs=["x.exr"])
        self.assertEqual(self.info("x.exr")["hash"], beside)
        self.assertNotIn("pertev.exposure", self.info("x.exr"))

    def test_auto_exposure_of_the_cornell_box_clips_few_pixels_and_has_a_medium_mean(self):
        self.show(size="64x64", spp=64)
        pixels = read_png(self.path("x.png"))
        self.render("--max-depth", 0, size="64x64", spp=64, output="lamp.exr")
        _, _, layers = read_exr(self.path("lamp.exr"))
        emitted = [light for row in layers["G"] for light in row]
        surfaces = [pixel for pixel, light in zip(pixels, emitted) if light == 0]
        self.assertGreater(len(surfaces), 0.9 * len(pixels))
        self.assertLess(sum(pixel == (255, 255, 255) for pixel in surfaces), 0.01 * len(pixels))
        self.assertTrue(100 < sum(green for _, green, _ in surfaces) / len(surfaces) < 160)


class RecordedPictures(CliTest):
    """A change of these hashes needs a reason and new records (bench/results/one_picture.json has the second one)."""

    def test_the_cornell_box_has_the_recorded_hashes(self):
        recorded = {("320x240", 4): "ac245b79834309455f77746a055129b2",
                    ("640x360", 1): "222529ebdf8a58d54f8155a0322d65c5"}
        for (size, spp), picture in recorded.items():
            said = self.succeed("render", "cornell-box", "-o", "x.exr", "--size", size, "--spp", spp, "--device", "cpu",
                                "--json")
            self.assertEqual(said.events("done")[0]["hash"], picture)


class WhatHalfACameraSees(CliTest):
    def notices(self, *arguments, scene):
        said = self.succeed("render", scene, "-o", "x.exr", "--size", "32x32", "--spp", 4, "--device", "cpu", "--json",
                            "--aov", "position,depth,ids", *arguments)
        _, _, self.layers = read_exr(self.path("x.exr"))
        return [event["text"] for event in said.events("notice")], said.events("done")[0]["hash"]

    def hash_again(self, flags, scene):
        return self.notices(*flags, scene=scene)[1]

    def test_an_eye_alone_looks_at_the_centre_of_the_scene_with_a_notice(self):
        write(self.path("sheet.obj"), SHEET)
        write(self.path("two.gltf"), gltf_with_cameras())
        for scene, middle in [("sheet.obj", (0, 1, 0)), ("two.gltf", (0, 0, 0))]:
            for eye in [(3, 2.5, 4), (-2, 5, -3)]:
                with self.subTest(scene=scene, eye=eye):
                    given = "{},{},{}".format(*eye)
                    notices, made = self.notices("--eye", given, scene=scene)
                    told = [text for text in notices if "--eye" in text]
                    self.assertEqual(len(told), 1, notices)  # no unused camera is named
                    flags = re.search(r"\((--eye \S+ --target \S+)\)", told[0]).group(1).split()
                    self.assertEqual(flags[1], given)
                    self.assertEqual(tuple(float(x) for x in flags[3].split(",")), middle)
                    self.assertEqual(self.hash_again(flags, scene), made)
                    told = self.info("x.exr")
                    again = [word for name in ["eye", "target", "up"]
                             for word in ["--" + name, as_flag(told["pertev." + name])]]
                    self.assertEqual(self.hash_again(again, scene), made)

    def test_lab_aims_an_eye_without_a_target_too(self):
        write(self.path("sheet.obj"), SHEET)
        said = self.succeed("lab", "sheet.obj", "--eye", "3,2.5,4", "--structures", "binned", "--traversals", "if-if", "--runs",
                            "1", "--device", "cpu", "--size", "16x12", "--json")
        self.assertEqual(len([event for event in said.events("notice") if "--target 0,1,0)" in event["text"]]), 1)

    def test_the_notice_for_a_target_alone_has_the_chosen_eye(self):
        write(self.path("sheet.obj"), SHEET)
        notices, _ = self.notices("--target", "0,2,0", scene="sheet.obj")
        told = [text for text in notices if "--target" in text]
        self.assertEqual(len(told), 1, notices)
        self.assertIn("--target 0,2,0", told[0])

    def test_an_aperture_alone_focuses_on_the_centre_of_the_picture_with_a_notice(self):
        cameras = json.loads(gltf_with_cameras())  # the first is 4 m in front of a triangle at the picture's centre
        write(self.path("two.gltf"), json.dumps(cameras))
        notices, made = self.notices("--aperture", "0.2", scene="two.gltf")
        told = [text for text in notices if "--focus" in text]
        self.assertEqual(len(told), 1, notices)
        self.assertIn("4 m", told[0])
        self.assertEqual(self.info("x.exr")["pertev.focus"], 4)
        self.assertEqual(self.hash_again(["--aperture", "0.2", "--focus", "4"], "two.gltf"), made)
        self.assertNotEqual(self.hash_again(["--aperture", "0.2", "--focus", "1"], "two.gltf"), made)
        self.assertEqual(self.notices(scene="two.gltf")[0][-1].count("--focus"), 0)

    def test_without_a_surface_in_the_centre_the_focus_is_at_the_centre_of_the_scene(self):
        cameras = json.loads(gltf_with_cameras())
        cameras["nodes"][1]["translation"] = [3, 0, 4]  # the camera looks past the triangle
        write(self.path("two.gltf"), json.dumps(cameras))
        notices, _ = self.notices("--aperture", "0.2", scene="two.gltf")
        self.assertEqual(len([text for text in notices if "(--focus 5)" in text]), 1, notices)

    def test_a_given_target_is_in_focus_or_else_the_surface_in_the_centre(self):
        write(self.path("sheet.obj"), SHEET)
        notices, _ = self.notices("--eye", "0,1,5", "--aperture", "0.1", scene="sheet.obj")
        self.assertEqual(len([text for text in notices if "(--focus 6)" in text]), 1, notices)
        notices, _ = self.notices("--eye", "0,1,5", "--target", "0,1,2", "--aperture", "0.1", scene="sheet.obj")
        self.assertEqual([text for text in notices if "--focus" in text], [])
        self.assertEqual(self.info("x.exr")["pertev.focus"], 3)


if __name__ == "__main__":
    main()
