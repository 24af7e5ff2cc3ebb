#!/usr/bin/env python3
"""pertev solve radiosity, its file, and pictures of it: what a user is told, and what is refused before it costs time."""

import json
import os

from cli_run import FLOOR, UNMETERED, CliTest, main, write

COARSE = ["--patch-size", "0.3", "--patch-rays", "16", "--subdivisions", "0"]
SMALL = ["--integrator", "radiosity", "--size", "16x16", "--spp", "1", "--device", "cpu", *UNMETERED]
MIRROR = "newmtl a\nillum 3\nKd 0 0 0\nKs 1 1 1\nNs 1000\n"


class Radiosity(CliTest):
    def solve(self, *arguments, scene="cornell-box", output="box.rad"):
        outcome = self.succeed("solve", "radiosity", scene, "-o", output, "--json", *arguments)
        return outcome.events("radiosity_solved")[0], outcome.events("radiosity")[0]

    def picture(self, *arguments, scene="cornell-box"):
        return self.succeed("render", scene, *SMALL, "-o", "x.png", "--json", *arguments).events("done")[0]["hash"]

    def test_a_solution_serves_every_picture_as_if_the_scene_were_solved_for_it(self):
        told, before = self.solve(*COARSE)
        self.assertLessEqual(told["patches"], before["most_patches"])
        self.assertLessEqual(told["bytes"], before["predicted_bytes"])
        self.assertLess(told["left"], 1e-4)
        self.assertEqual(self.picture("--solution", "box.rad"), self.picture(*COARSE))
        self.assertNotEqual(self.picture("--solution", "box.rad"), self.picture("--solution", "box.rad", "--flat-patches"))
        hashes = {self.solve(*COARSE, *flags)[0]["hash"]
                  for flags in [[], ["--solver", "southwell"], ["--solver", "matrix"], ["--seed", "1"],
                                ["--solver", "southwell", "--steps", "20"], ["--form-factors", "hemicube", "--hemicube", "16"],
                                ["--environment", "1,1,1"], ["--lamp", "light=100lm"]]}
        self.assertEqual(len(hashes), 8)
        self.assertEqual(self.solve(*COARSE, "--threads", "1")[0]["hash"], told["hash"])

    def test_what_cannot_be_is_one_line(self):
        write(self.path("mirror.mtl"), MIRROR)
        write(self.path("mirror.obj"), "mtllib mirror.mtl\nusemtl a\n" + FLOOR)
        write(self.path("text.rad"), "no solution at all")
        self.solve(*COARSE)
        with open(self.path("box.rad"), "rb") as whole, open(self.path("cut.rad"), "wb") as cut:
            cut.write(whole.read()[:-7])
        write(self.path("floor.obj"), FLOOR)
        look = ["--eye", "0,2,4", "--target", "0,0,0"]
        for arguments, status, says in [
                ("solve radiosity mirror.obj -o m.rad --environment 1,1,1", 2, "no surface of this scene reflects diffusely"),
                ("solve radiosity nowhere.obj -o m.rad --steps 5", 2, "--steps: of --solver southwell"),
                ("solve radiosity nowhere.obj -o m.rad --hemicube 64", 2, "--hemicube: of --form-factors hemicube"),
                ("solve radiosity nowhere.obj -o m.rad --solver matrix --tolerance 0.1", 2, "--tolerance: --solver matrix"),
                ("solve radiosity nowhere.obj -o m.rad --patch-size 0", 2, "--patch-size"),
                ("solve radiosity nowhere.obj -o nowhere/m.rad", 6, "nowhere/m.rad"),
                ("solve radiosity cornell-box -o m.rad --patch-size 1e-5", 3, "--patch-size 1e-05: divides this scene into"),
                ("solve radiosity cornell-box -o m.rad --patch-size 0.01 --patch-rays 16 --solver matrix", 3, "--solver matrix: "),
                ("solve nothing", 2, "nothing"),
                ("render nowhere.obj -o x.png --solution box.rad", 2, "--solution: of --integrator radiosity; path has none"),
                ("render nowhere.obj -o x.png --patch-size 1", 2, "--patch-size: of --integrator radiosity; path has no patches"),
                ("render nowhere.obj -o x.png --integrator radiosity --solution none.rad", 2, "--solution none.rad: there is no such"),
                ("render nowhere.obj -o x.png --integrator radiosity --solution box.rad --patch-rays 64", 2,
                 "--patch-rays: --solution has been solved already"),
                ("render nowhere.obj -o x.png --integrator radiosity --denoise svgf", 2, "--denoise svgf: reconstructs pictures"),
                ("render nowhere.obj -o x.png --integrator radiosity --lpe seen=LE -o x.exr", 2, "--lpe: light paths are told apart"),
                ("render nowhere.obj -o x.png --integrator radiosity --max-depth 256", 3, "--max-depth 256: with --integrator radiosity"),
                ("render cornell-box -o x.png --integrator radiosity --shutter 0.1", 2, "--shutter"),
                ("render cornell-box -o x.png --integrator radiosity --solution text.rad", 2, "text.rad: no radiosity solution"),
                ("render cornell-box -o x.png --integrator radiosity --solution cut.rad", 2, "cut.rad: a radiosity solution that was cut"),
                ("render floor.obj -o x.png --integrator radiosity --solution box.rad", 2, "box.rad: a radiosity solution of another scene")]:
            with self.subTest(arguments=arguments):
                more = look if "render floor.obj" in arguments else []
                self.refuse(status, *arguments.split(), *more, says=[says])
                self.assertFalse(os.path.exists(self.path("m.rad")))
        self.assertNotIn("x.png", self.files())

    def test_a_picture_says_how_its_light_was_solved(self):
        self.solve(*COARSE, "--solver", "southwell")
        self.succeed("render", "cornell-box", *SMALL[:-2], "-o", "x.exr", "--solution", "box.rad")
        told = self.info("x.exr")
        made = json.loads(told["pertev.radiosity"])
        self.assertEqual((made["solver"], made["rays"], made["form_factors"]), ("southwell", 16, "rays"))
        self.assertEqual(len(told["pertev.radiosity_hash"]), 32)


if __name__ == "__main__":
    main()
