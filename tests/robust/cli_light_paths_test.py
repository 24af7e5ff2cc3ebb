#!/usr/bin/env python3
"""--lpe on the command line: layers of an EXR, refused expressions, and the metadata."""

import os

from cli_run import CliTest, main, read_exr, write


def lpe(expressions):
    return [flag for name, text in expressions.items() for flag in ("--lpe", f"{name}={text}")]


class Layers(CliTest):
    def test_the_exr_holds_the_layers_and_an_unchanged_picture(self):
        flags = ["--size", "24x24", "--spp", "4", "--device", "cpu", "--json"]
        plain = self.succeed("render", "cornell-box", "-o", "plain.exr", *flags).events("done")[0]
        expressions = ["seen=LE", "direct=LDE", "bounced=LD{2,}E"]
        run = self.succeed("render", "cornell-box", "-o", "x.exr", *flags, *lpe(dict(text.split("=") for text in expressions)))
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

    def test_light_groups_are_the_light_of_lights_by_name_and_add_up_to_the_picture(self):
        write(self.path("room.mtl"), "newmtl key\nKe 5 4 3\nnewmtl fill 'a'\nKe 1 2 6\nnewmtl grey\nKd 0.7 0.7 0.7\n")
        triangles = {"grey": "-4 0 -4 / -4 0 4 / 4 0 4", "key": "0 2 0 / 1 2 0 / 0 2 1", "fill 'a'": "-2 1 -1 / -1 1 -1 / -2 1 0"}
        text, count = "mtllib room.mtl\n", 0
        for name, corners in triangles.items():
            text += f"o {name}\nusemtl {name}\n" + "".join(f"v {corner.strip()}\n" for corner in corners.split("/"))
            text, count = text + f"f {count + 1} {count + 2} {count + 3}\n", count + 3
        write(self.path("room.obj"), text)
        flags = ["room.obj", "--size", "16x12", "--spp", "4", "--device", "cpu", "--eye", "0,1,6", "--target", "0,1,0", "--environment", "0.3,0.2,0.1", "--two-sided-lights"]
        groups = ["key=key", "fill=fi*", "sky=environment", "rest=^key,environment"]
        self.succeed("render", *flags, "-o", "plain.exr")
        self.succeed("render", *flags, "-o", "x.exr", *[flag for group in groups for flag in ("--light-group", group)], "--lpe", "seen=LE")
        _, _, rows = read_exr(self.path("x.exr"))
        self.assertEqual(rows["G"], read_exr(self.path("plain.exr"))[2]["G"])
        for channel in "RGB":
            for whole, key, fill, sky, rest in zip(*[sum(map(list, rows[name + channel]), []) for name in ("", "key.", "fill.", "sky.", "rest.")]):
                self.assertLessEqual(abs(key + fill + sky - whole), 1e-6 * whole)
                self.assertEqual(fill, rest)
        for name in "key.R", "fill.R", "sky.R":
            self.assertGreater(max(map(max, rows[name])), 0.05, name)
        info = self.info("x.exr")
        self.assertEqual((info["pertev.light_group"], info["pertev.lpe"]), ("\n".join(groups), "seen=LE"))
        for group, says in {"a=kex": "did you mean \"key\"", "a=": "NAME=LIGHT", "key": "NAME=LIGHT", "a b=key": "letters", "a=key,": "empty", "albedo=key": "another layer", "a=grey": "no light"}.items():
            self.refuse(2, "render", *flags, "-o", "y.exr", "--light-group", group, says=["--light-group", says])
        self.refuse(2, "render", *flags, "-o", "y.exr", "--light-group", "a=key", "--integrator", "light", says=["--light-group"])
        self.refuse(2, "render", *flags, "-o", "y.exr", "--light-group", "a=key", "--lpe", "a=LE", says=["same name"])

    def test_each_frame_has_its_layers(self):
        self.succeed("render", "cornell-box", "-o", "f-#.exr", "--turntable", "2", "--size", "8x8", "--spp", "1", "--lpe",
                     "direct=LDE")
        lit = [sum(map(sum, read_exr(self.path(f"f-{frame}.exr"))[2]["direct.G"])) for frame in range(2)]
        self.assertGreater(lit[0], 0)
        self.assertEqual(lit[1], 0)  # seen from behind, where the backs of the walls are dark
        self.refuse(2, "render", "cornell-box", "-o", "f-#.exr", "--turntable", "2", "--size", "8x8", "--spp", "1",
                    "--continue", "--lpe", "direct=LDDE", says=["--continue"])

    def test_each_of_a_hundred_layers_equals_a_render_with_one_layer(self):
        flags = ["--size", "12x9", "--spp", "2", "--device", "cpu", "--json"]
        many = {f"n{i}": f"L{'D' if i % 2 else ''}.{{{i // 2 % 7}}}{['', 'D', '[^S]', '.*'][i // 14 % 4]}E" for i in range(100)}
        run = self.succeed("render", "cornell-box", "-o", "x.exr", *flags, *lpe(many))
        self.assertGreater(run.events("picture")[0]["predicted_bytes"], 12 * 9 * 100 * 3 * 16)
        _, _, channels = read_exr(self.path("x.exr"))
        self.assertEqual(len(channels), 303)
        self.assertEqual(self.info("x.exr")["pertev.lpe"], "\n".join(f"{name}={text}" for name, text in many.items()))
        for name in ("n0", "n31", "n32", "n63", "n64", "n95", "n96", "n99"):
            self.succeed("render", "cornell-box", "-o", "one.exr", *flags, "--lpe", f"{name}={many[name]}")
            alone = read_exr(self.path("one.exr"))[2]
            for channel in "RGB":
                self.assertEqual(channels[f"{name}.{channel}"], alone[f"{name}.{channel}"], name)
            self.assertGreater(sum(map(sum, alone[f"{name}.G"])), 0, name)

    def test_a_render_over_the_memory_limit_is_refused(self):
        flags = ["--size", "64x48", "--spp", "1", "--device", "cpu", *lpe({f"n{i}": "LE" for i in range(100)})]
        bytes = self.succeed("render", "cornell-box", "-o", "x.exr", "--json", *flags).events("picture")[0]["predicted_bytes"]
        self.succeed("render", "cornell-box", "-o", "x.exr", *flags, "--max-memory", repr(bytes / 2**20))
        os.remove(self.path("x.exr"))
        self.refuse(4, "render", "cornell-box", "-o", "x.exr", *flags, "--max-memory", repr((bytes - 1) / 2**20),
                    says=["--max-memory", "100 layers of --lpe", "--size"])
        self.refuse(4, "render", "cornell-box", "-o", "x.exr", "--size", "32768x32768", *flags[2:],
                    says=["100 layers of --lpe"])  # more than any machine has: 4.8 TiB
        for verb in ("view cornell-box", "bench noise cornell-box", "bench frames cornell-box",
                     "bench sequence cornell-box --turntable 2"):
            self.refuse(4, *verb.split(), "--device", "cpu", "--max-memory", "5", says=["--max-memory: ", "5.0 MiB"])

    def test_wrong_expressions_are_reported_before_anything_is_rendered(self):
        def refuse(status, *flags, says):
            self.refuse(status, "render", "cornell-box", "-o", "x.exr", *flags, says=says)

        refuse(2, "--lpe", "a=L(DE", says=["--lpe a: character 2: ", "\n  L(DE\n   ^"])
        refuse(2, "--lpe", "a=L<'none'>E", says=["--lpe a: character 4: "])
        refuse(2, "--lpe", "LDE", says=["--lpe"])
        refuse(2, "--lpe", "a=LE", "--lpe", "a=LDE", says=["--lpe a: "])
        refuse(2, "--lpe", "depth=LE", says=["--lpe depth: "])
        refuse(2, "--lpe", "a=LE", "--integrator", "whitted", "--ambient", "0", says=["--lpe", "whitted"])
        refuse(2, "--lpe", "a=LE", "--denoise", "svgf", says=["--lpe", "--denoise svgf"])
        refuse(3, "--lpe", "a=L.{15}D.*E", says=["16384"])
        many = {f"n{i}": f"L.{{{i}}}E" for i in range(100)}
        refuse(2, *lpe(many), "--lpe", "n57=LDE",
               says=["--lpe n57: ", "\n  n57=L.{57}E\n  n57=LDE"])
        refuse(2, *lpe(many | {"n98": "L.{2}(E"}), says=["--lpe n98: character 6: ", "\n  L.{2}(E\n       ^"])
        refuse(2, *lpe(many | {"noisy": "LE"}), says=["--lpe noisy: "])
        refuse(3, *lpe({f"n{i}": f"L(.{{{2 * i + 3}}})*E" for i in range(40)}), says=["16384"])
        for unnamed in (" ", "=", "a", "=LE"):
            refuse(2, "--lpe", unnamed, says=["--lpe "])
        for empty in ("a=", "a= "):
            refuse(2, "--lpe", empty, says=["--lpe a: character 1: "])
        refuse(2, "--lpe=", says=["--lpe"])
        refuse(2, "--lpe", "a=CDL", says=["--lpe a: character 1: "])
        refuse(2, "--lpe", "a=LDE,b=LE", says=["--lpe a: character 4: "])
        self.refuse(2, "render", "cornell-box", "-o", "x.png", "--lpe", "a=LE", says=["--lpe"])


if __name__ == "__main__":
    main()
