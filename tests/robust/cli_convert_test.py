"""`check` lists what is left out and added by default, `convert` writes scenes as .glb and pictures in other formats, and a tree that cannot select
lights says so."""

import json
import struct
import zlib

from cli_run import CliTest, gltf_with_cameras, main, read_exr, read_png, write

SMALL = ["--size", "12x9", "--spp", "2", "--device", "cpu"]


class Check(CliTest):
    def test_the_status_says_whether_anything_is_left_out_or_made_up(self):
        outcome = self.run_pertev("check", "cornell-box", "--json")
        self.assertEqual(outcome.status, 0, outcome)
        done = outcome.events("check")[0]
        self.assertEqual((done["complete"], done["left_out"], done["made_up"]), (True, [], []))
        write(self.path("a.pbrt"), 'WorldBegin\nShape "sphere"\nShap "sphere"\n')
        outcome = self.run_pertev("check", "a.pbrt", "--json")
        self.assertEqual(outcome.status, 1, outcome)
        done = outcome.events("check")[0]
        self.assertRegex(done["left_out"][0], "^a.pbrt:3: ")
        self.assertEqual(len(done["made_up"]), 1, done)  # the view
        self.assertIn("a.pbrt:3", [event["text"][:8] for event in outcome.events("warning")])
        outcome = self.run_pertev("check", "a.pbrt")
        self.assertRegex(outcome.stdout, r"(?m)^left out {10}a\.pbrt:3: ")
        self.assertRegex(outcome.stdout, r"(?m)^added by default  ")
        self.assertEqual((outcome.status, outcome.stderr), (1, ""))
        self.refuse(2, "check", "gone.obj", says=["gone.obj"])


class Convert(CliTest):
    def test_a_scene_as_glb_gives_the_same_picture(self):
        done = self.succeed("convert", "cornell-box", "box.glb", "--json").events("convert")[0]
        self.assertEqual((done["path"], done["left_out"]), ("box.glb", []))
        hashes = [self.succeed("render", scene, "-o", "x.exr", "--json", *SMALL).events("done")[0]["hash"] for scene in ["cornell-box", "box.glb"]]
        self.assertEqual(*hashes)
        info = self.succeed("info", "box.glb", "--json").events("info")[0]
        self.assertEqual(info["object_list"], self.succeed("info", "cornell-box", "--json").events("info")[0]["object_list"])

    def test_what_is_lost_is_named_or_refused(self):
        write(self.path("a.xml"), '<scene version="3.0.0"><shape type="sphere"><bsdf type="conductor" id="shine"/></shape>'
                                  '<emitter type="constant"/></scene>')
        self.refuse(2, "convert", "a.xml", "a.glb", "--strict", says=["--strict: "])
        lost = self.succeed("convert", "a.xml", "a.glb", "--json").events("convert")[0]["left_out"]
        self.assertTrue(any("shine" in text and "refraction" in text for text in lost), lost)
        self.assertTrue(any("environment" in text for text in lost), lost)
        self.refuse(2, "convert", "a.xml", "a.obj", says=["a.obj", ".glb"])
        self.refuse(2, "convert", "a.glb", "a.png", says=["a.png", ".glb"])

    def test_pictures_are_converted_and_bytes_stay(self):
        self.succeed("render", "cornell-box", "-o", "a.png", "-o", "a.exr", "--tone-map", "srgb", "--exposure", "0", "--aov", "albedo", *SMALL)
        self.succeed("convert", "a.png", "b.exr")
        self.succeed("convert", "b.exr", "c.png")
        self.assertEqual(read_png(self.path("c.png")), read_png(self.path("a.png")))
        lost = self.succeed("convert", "a.exr", "d.png", "--json").events("convert")[0]["left_out"]
        self.assertTrue(any("albedo.R" in text for text in lost), lost)
        self.assertEqual(read_png(self.path("d.png")), read_png(self.path("a.png")))
        self.refuse(2, "convert", "a.exr", "./a.exr", says=["overwritten"])

    def test_colours_are_multiplied_by_alpha_but_in_png(self):
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        rows = zlib.compress(bytes([0, 200, 100, 50, 128, 10, 220, 30, 255]))
        with open(self.path("a.png"), "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 2, 1, 8, 6, 0, 0, 0)) + chunk(b"IDAT", rows) + chunk(b"IEND", b""))
        for source, to in [("a.png", "a.exr"), ("a.exr", "b.png"), ("b.png", "b.exr")]:
            self.succeed("convert", source, to)
        first, again = (read_exr(self.path(name))[2] for name in ["a.exr", "b.exr"])
        self.assertEqual(first, again)
        self.assertAlmostEqual(first["A"][0][0], 128 / 255, places=6)
        self.assertAlmostEqual(first["R"][0][0], 0.577580 * 128 / 255, places=5)

    def test_pictures_have_other_formats_without_alpha(self):
        self.succeed("render", "cornell-box", "-o", "a.exr", *SMALL)
        for name in ["e.jpg", "e.hdr"]:
            self.succeed("convert", "a.exr", name)
            self.assertEqual(self.info(name)["width"], 12)
        self.succeed("convert", "e.hdr", "f.exr")
        self.assertEqual(set(read_exr(self.path("f.exr"))[2]), {"R", "G", "B"})
        self.refuse(2, "convert", "a.exr", "a.glb", says=["a.glb"])


class Notices(CliTest):
    def test_lights_that_are_selected_by_power_in_spite_of_a_tree_are_named(self):
        tree = ["render", "cornell-box", "-o", "x.exr", *SMALL, "--light-choice", "tree"]
        self.assertEqual(self.remarks(*tree, about="light_choice"), [])
        frames = [*tree[:3], "x-#.exr", "--size", "12x9", "--device", "cpu", "--light-choice", "tree", "--real-time", "--frames", "0-1", "--restir", "di"]
        self.assertEqual(self.remarks(*frames, about="light_choice"), [])
        self.assertIn("media", self.remarks(*frames[:-2], "--medium", "sigma_a=0.1", about="light_choice")[0]["text"])
        model = json.loads(gltf_with_cameras())
        write(self.path("dark.gltf"), json.dumps(model))
        warned = self.remarks("render", "dark.gltf", "-o", "y.exr", "--environment", "1,1,1", *SMALL, "--light-choice", "tree", about="light_choice")
        self.assertIn("no light has a position", warned[0]["text"])

    def test_a_sky_of_the_sun_lights_a_scene_and_is_recorded(self):
        write(self.path("a.gltf"), gltf_with_cameras())
        line = ["render", "a.gltf", "-o", "x.exr", "--sun-sky", "30,120,4", "--json", *SMALL]
        self.assertEqual(self.succeed(*line).events("done")[0]["made_up"], [])
        self.assertEqual(self.info("x.exr")["pertev.sun_sky"], "30,120,4")
        self.refuse(2, "render", "a.gltf", "-o", "y.exr", "--sun-sky", "100,0", *SMALL, says=["--sun-sky 100,0", "0 to 90"])
        self.refuse(2, "render", "a.gltf", "-o", "y.exr", "--sun-sky", "10,0", "--environment", "1,1,1", *SMALL, says=["--environment"])


if __name__ == "__main__":
    main()
