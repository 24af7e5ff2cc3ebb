#!/usr/bin/env python3
"""Emitters in photometric units, false colours with their scale, and a camera's exposure, on the command line."""

from cli_run import CliTest, main, read_exr, read_png


class Photometry(CliTest):
    def test_twice_the_lumens_of_a_lamp_give_twice_the_light(self):
        pictures = []
        for amount in ["400lm", "800lm"]:
            self.render("--lamp", f"light={amount}", output="x.exr")
            pictures.append(read_exr(self.path("x.exr"))[2])
            self.assertEqual(self.info("x.exr")["pertev.lamp"], f"light={amount}")
        for half, whole in zip(sum(pictures[0]["G"], ()), sum(pictures[1]["G"], ())):
            self.assertAlmostEqual(2 * half, whole, delta=1e-5 * whole)
        measured = [self.succeed("measure", "cornell-box", "--at", "0.278,0,0.28", "--normal", "0,1,0", "--spp", "1", "--lamp",
                                 f"light={amount}", "--json").events("measure")[0]["illuminance"]["value"]
                    for amount in ["400lm", "800lm"]]
        self.assertAlmostEqual(2 * measured[0], measured[1], delta=1e-4 * measured[1])

    def test_a_false_colour_picture_has_a_scale_and_leaves_the_film_unchanged(self):
        def shown(what, output, size, *flags):
            return self.succeed("render", "cornell-box", "-o", output, "--size", size, "--spp", "1", "--json",
                                "--false-color", what, *flags).events("done")[0]["hash"]

        shown("luminance", "x.png", "64x16", "--false-color-range", "1,1000")
        self.assertEqual(len(read_png(self.path("x.png"))), 64 * (16 + 32))
        plain = self.render(output="plain.exr")["hash"]
        self.assertEqual(shown("luminance", "y.png", "16x16"), plain)
        self.assertNotEqual(shown("illuminance", "z.exr", "16x16"), plain)
        self.assertEqual(self.info("z.exr")["pertev.quantity"], "irradiance")

    def test_f_number_shutter_time_and_iso_set_the_exposure_in_stops(self):
        def exposure(*flags):
            return self.succeed("render", "cornell-box", "-o", "x.png", "--size", "8x8", "--spp", "1", "--json",
                                *flags).events("exposure")[0]["stops"]

        stops = exposure("--f-number", "4", "--shutter-time", "0.01")
        self.assertAlmostEqual(stops, 9.1527 - 10.6439, places=3)  # log2(683 / 1.2) - log2(1600)
        self.assertAlmostEqual(exposure("--f-number", "4", "--shutter-time", "0.01", "--iso", "800"), stops + 3, places=4)
        self.assertAlmostEqual(exposure("--f-number", "4", "--shutter-time", "0.02"), stops + 1, places=4)

    def test_invalid_values_and_incompatible_flags_are_refused(self):
        def refuse(*flags, says, output="x.png"):
            self.refuse(2, "render", "cornell-box", "-o", output, *flags, says=says)

        refuse("--lamp", "light=800", says=["--lamp light=800"])
        refuse("--lamp", "sun=800lm", says=["--lamp sun=800lm: ", "'light'"])
        refuse("--false-color", "luminance", "--exposure", "1", says=["--false-color"])
        refuse("--false-color", "luminance", output="x.exr", says=["--false-color"])
        refuse("--false-color-range", "1,10", says=["--false-color-range"])
        refuse("--false-color", "luminance", "--false-color-range", "10,1", says=["--false-color-range 10,1: "])
        refuse("--false-color", "illuminance", "--denoise", "svgf", says=["--false-color"])
        refuse("--false-color", "illuminance", "--integrator", "whitted", "--ambient", "0", says=["whitted"])
        refuse("--false-color", "luminance", "--turntable", "2", output="x-#.png", says=["--false-color-range"])
        refuse("--f-number", "4", says=["--f-number: ", "--shutter-time"])
        refuse("--f-number", "4", "--iso", "400", says=["--f-number: ", "--shutter-time"])
        refuse("--shutter-time", "1", says=["--shutter-time: ", "--f-number"])
        refuse("--iso", "400", says=["--iso: ", "--f-number"])
        refuse("--f-number", "4", "--shutter-time", "1", "--exposure", "0", says=["--exposure"])
        refuse("--f-number", "4", "--shutter-time", "1", output="x.exr", says=["--f-number"])


if __name__ == "__main__":
    main()
