#!/usr/bin/env python3
"""--lpe on the command line: layers of an EXR, what is refused, and what of it stands in the file."""

from cli_run import CliTest, main, read_exr


class Layers(CliTest):
    def test_layers_stand_in_the_exr_beside_the_same_picture(self):
        flags = ["--size", "24x24", "--spp", "4", "--device", "cpu", "--json"]
        plain = self.succeed("render", "cornell-box", "-o", "plain.exr", *flags).events("done")[0]
        expressions = ["seen=LE", "direct=LDE", "bounced=LD{2,}E"]
        lpe = [flag for text in expressions for flag in ("--lpe", text)]
        run = self.succeed("render", "cornell-box", "-o", "x.exr", *flags, *lpe)
        self.assertEqual(run.events("done")[0]["hash"], plain["hash"])
        self.assertGreater(run.events("picture")[0]["predicted_bytes"], 24 * 24 * 3 * 3 * 16)
        _, _, channels = read_exr(self.path("x.exr"))
        for channel in "RGB":
            for y in range(24):
                for x in range(24):
                    parts = [channels[f"{name}.{channel}"][y][x] for name in ("seen", "direct", "bounced")]
                    whole = channels[channel][y][x]
                    self.assertLessEqual(abs(sum(parts) - whole), 1e-6 * whole)
        self.assertEqual(self.info("x.exr")["pertev.lpe"], "\n".join(expressions))

    def test_each_frame_has_its_layers(self):
        self.succeed("render", "cornell-box", "-o", "f-#.exr", "--turntable", "2", "--size", "8x8", "--spp", "1", "--lpe",
                     "direct=LDE")
        lit = [sum(map(sum, read_exr(self.path(f"f-{frame}.exr"))[2]["direct.G"])) for frame in range(2)]
        self.assertGreater(lit[0], 0)
        self.assertEqual(lit[1], 0)  # from behind: the backs of the walls are dark
        self.refuse(2, "render", "cornell-box", "-o", "f-#.exr", "--turntable", "2", "--size", "8x8", "--spp", "1",
                    "--continue", "--lpe", "direct=LDDE", says=["--continue"])

    def test_what_is_wrong_is_told_before_anything_is_rendered(self):
        def refuse(status, *flags, says):
            self.refuse(status, "render", "cornell-box", "-o", "x.exr", *flags, says=says)

        refuse(2, "--lpe", "a=L(DE", says=["--lpe a: character 2: this ( is not closed\n  L(DE\n   ^"])
        refuse(2, "--lpe", "a=L<'none'>E", says=["character 4: no light of the scene is called so; there are"])
        refuse(2, "--lpe", "LDE", says=["expected NAME=EXPRESSION"])
        refuse(2, "--lpe", "a=LE", "--lpe", "a=LDE", says=["two expressions have this name"])
        refuse(2, "--lpe", "depth=LE", says=["another layer of this name"])
        refuse(2, "--lpe", "a=LE", "--integrator", "whitted", "--ambient", "0", says=["--lpe", "not by whitted"])
        refuse(2, "--lpe", "a=LE", "--denoise", "svgf", says=["--lpe", "--denoise svgf"])
        refuse(3, *[flag for i in range(33) for flag in ("--lpe", f"n{i}=LE")], says=["33 expressions", "32 at most"])
        refuse(3, "--lpe", "a=L.{15}D.*E", says=["16384 states"])
        self.refuse(2, "render", "cornell-box", "-o", "x.png", "--lpe", "a=LE", says=["EXR files alone"])


if __name__ == "__main__":
    main()
