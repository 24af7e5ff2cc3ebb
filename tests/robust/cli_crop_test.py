#!/usr/bin/env python3
"""`render --crop` gives the whole picture's bytes of some pixels, in every file, and refuses crops that no picture has."""

import struct

from cli_run import CliTest, main, read_exr, read_png

SIZE, CROP = "23x17", (5, 3, 9, 8)
FLAG = ["--crop", ",".join(map(str, CROP))]


def inside(rows, crop=CROP):
    """Returns the values of a whole picture's channel that lie in the crop."""
    x, y, width, height = crop
    return [row[x : x + width] for row in rows[y : y + height]]


def box(data, name):
    """Returns a window of an EXR's header."""
    return struct.unpack_from("<4i", data, data.index(name + b"\0box2i\0") + len(name) + 7 + 4)


class Crop(CliTest):
    def compare(self, *flags, scene="cornell-box", spp=3):
        """Tests that all channels of a crop have the whole picture's bytes."""
        self.render(*flags, scene=scene, size=SIZE, spp=spp, output="whole.exr")
        done = self.render(*flags, *FLAG, scene=scene, size=SIZE, spp=spp, output="crop.exr")
        whole, crop = read_exr(self.path("whole.exr")), read_exr(self.path("crop.exr"))
        self.assertEqual(crop[:2], CROP[2:])
        self.assertEqual(list(crop[2]), list(whole[2]))
        for name, rows in whole[2].items():
            self.assertEqual([tuple(row) for row in crop[2][name]], inside(rows), name)
        self.assertGreater(len({value for row in crop[2]["R"] for value in row}), 2)
        return done

    def test_a_crop_has_the_bytes_of_the_whole_picture_by_every_integrator(self):
        layers = ["--aov", "albedo,normal,depth,position,ids", "--transparent"]
        flags = {"photon_map": ["--photons", "500"], "radiosity": ["--patch-size", "0.4", "--patch-rays", "16"]}
        flags.update({integrator: ["--ambient", "0.5"] for integrator in ["cast", "whitted", "raster", "reyes"]})
        for integrator in ["path", "direct", "indirect", "bidirectional", "light", "photon_map", "distributed", "hybrid", "cast", "whitted", "raster", "reyes",
                           "irradiance_cache", "radiosity"]:
            with self.subTest(integrator=integrator):
                self.compare("--integrator", integrator, *flags.get(integrator, []), *(layers if integrator != "light" else []))
        self.compare("--lpe", "direct=LDE", "--aov", "depth,ids", "--layers-at", "centre", "--sampler", "independent")

    def test_the_files_of_a_crop_say_where_it_is_and_are_exposed_as_the_whole(self):
        for name, flags in {"whole": [], "crop": FLAG}.items():
            self.succeed("render", "cornell-box", "-o", name + ".png", "-o", name + ".exr", "--size", SIZE, "--spp", "2", "--device", "cpu", *flags)
        pixels = read_png(self.path("whole.png"))
        rows = [pixels[23 * y : 23 * (y + 1)] for y in range(17)]
        self.assertEqual(read_png(self.path("crop.png")), sum(inside(rows), []))
        with open(self.path("crop.exr"), "rb") as file:
            data = file.read()
        self.assertEqual((box(data, b"displayWindow"), box(data, b"dataWindow")), ((0, 0, 22, 16), (5, 3, 13, 10)))
        info = self.info("crop.exr")
        self.assertEqual(info["pertev.crop"], list(CROP))
        self.assertEqual(info["pertev.exposure"], self.info("whole.exr")["pertev.exposure"])
        self.assertNotIn("pertev.crop", self.info("whole.exr"))
        with open(self.path("settings.json"), "w", encoding="utf-8") as file:
            file.write(self.succeed("info", "crop.exr", "--settings").stdout)
        again = self.succeed("render", "cornell-box", "-o", "again.exr", "--settings", "settings.json", "--device", "cpu", "--json")
        self.assertEqual(again.events("done")[0]["hash"], info["pertev.hash"])
        self.assertEqual(again.events("picture")[0]["crop"], list(CROP))

    def test_parts_and_checkpoints_of_a_crop_merge_to_the_crop(self):
        whole = self.render(*FLAG, "--aov", "normal", size=SIZE, spp=5, output="one.exr")
        for part in "1/2", "2/2":
            self.render(*FLAG, "--aov", "normal", "--part", part, "--exposure", "0", size=SIZE, spp=5, output=part[0] + ".pvf")
        merged = self.succeed("merge", "1.pvf", "2.pvf", "-o", "all.exr", "-o", "all.pvf", "--json").events("done")[0]
        self.assertEqual([merged[key] for key in ("hash", "layers_hash")], [whole[key] for key in ("hash", "layers_hash")])
        with open(self.path("all.exr"), "rb") as file:
            self.assertEqual(box(file.read(), b"dataWindow"), (5, 3, 13, 10))
        self.assertEqual(self.info("all.exr")["pertev.crop"], list(CROP))
        self.render("--crop", "5,3,9,7", "--aov", "normal", "--part", "2/2", "--exposure", "0", size=SIZE, spp=5, output="other.pvf")
        self.refuse(2, "merge", "1.pvf", "other.pvf", "-o", "x.exr", says=["other.pvf", "--crop"])
        for spp in 2, 5:
            self.render(*FLAG, "--checkpoint", "kept.pvf", size=SIZE, spp=spp, output="x.exr")
        self.assertEqual(self.info("x.exr")["pertev.hash"], whole["hash"])

    def test_frames_and_motion_vectors_of_a_crop_are_those_of_the_whole(self):
        flags = ["cornell-box", "--turntable", "4", "--size", SIZE, "--spp", "2", "--aov", "motion", "--device", "cpu"]
        self.succeed("render", *flags, "-o", "w#.exr")
        self.succeed("render", *flags, "-o", "c#.exr", *FLAG)
        whole, crop = read_exr(self.path("w1.exr"))[2], read_exr(self.path("c1.exr"))[2]
        for name, rows in whole.items():
            self.assertEqual([tuple(row) for row in crop[name]], inside(rows), name)

    def test_a_crop_that_no_picture_has_is_refused_before_the_scene_is_read(self):
        for crop in ["", "1,2,3", "1,2,3,4,5", "0,0,0,4", "0,0,4,0", "-1,0,4,4", "0.5,0,4,4", "a,b,c,d", "20,0,4,4", "0,14,4,4", "1e9,0,1,1"]:
            with self.subTest(crop=crop):
                self.refuse(2, "render", "nowhere.obj", "-o", "x.exr", "--size", SIZE, "--crop", crop, says=["--crop"])
        self.refuse(2, "render", "cornell-box", "-o", "x.exr", "--crop", "1280,0,1,1", says=["--crop", "last pixel"])
        for flags in ["--rows 0:4", "--denoise svgf", "--real-time", "--false-color luminance"]:
            self.refuse(2, "render", "nowhere.obj", "-o", "x.png", "--size", SIZE, *FLAG, *flags.split(), says=["crop"])


if __name__ == "__main__":
    main()
