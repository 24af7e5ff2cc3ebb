#!/usr/bin/env python3
"""Flags select how rays are traced, which changes no picture. Impossible combinations are refused with the reason."""

from cli_run import FLOOR, CliTest, main, write

SMALL = ["--size", "24x18", "--spp", "2", "--device", "cpu"]


class HowRaysAreTraced(CliTest):
    def hash_of(self, *arguments, scene="cornell-box"):
        done = self.succeed("render", scene, "-o", "x.exr", *SMALL, "--json", *arguments).events("done")
        return done[0]["hash"]

    def test_every_structure_and_traversal_gives_the_same_picture(self):
        wanted = self.hash_of()
        for line in ["--structure sbvh --traversal restart-trail --rta off", "--traversal brute-force", "--structure kd-sah",
                     "--traversal octree", "--structure ploc --traversal compressed --rta nodes",
                     "--traversal while-while --order off", "--traversal shadow=kd --structure bounce=insertion",
                     "--traversal camera=packet --traversal bounce=short-stack --traversal shadow=skip-links", "--build fast",
                     "--build balanced", "--build best", "--build best --structure ploc",
                     "--build fast --structure shadow=sbvh-reinsertion"]:
            with self.subTest(line=line):
                self.assertEqual(self.hash_of(*line.split()), wanted)

    def test_an_impossible_combination_is_refused_with_the_reason(self):
        for line, why in [("--structure kd-sah --traversal if-if", "needs the traversal kd"),
                          ("--structure octree --traversal wide8", "needs the traversal octree"),
                          ("--traversal skip-links --order off", "this traversal has no order of children"),
                          ("--traversal if-if --rta nodes", "for the compressed traversal"),
                          ("--traversal compressed --distribution dynamic-fetch", "a CPU's threads"),
                          ("--traversal camera=wide9", "not one of if-if"),
                          ("--traversal eye=kd", "camera, bounce or shadow")]:
            with self.subTest(line=line):
                self.refuse(2, "render", "cornell-box", "-o", "x.png", "--device", "cpu", *line.split(), says=[why])

    def test_brute_force_is_refused_for_large_scenes(self):
        side = 200  # 80,000 triangles
        vertices = "".join(f"v {i % (side + 1)} 0 {i // (side + 1)}\n" for i in range((side + 1) ** 2))
        faces = "".join(f"f {a} {a + side + 1} {a + side + 2} {a + 1}\n"
                        for a in (z * (side + 1) + x + 1 for z in range(side) for x in range(side)))
        write(self.path("field.obj"), vertices + faces)
        self.refuse(3, "render", "field.obj", "-o", "x.png", *SMALL, "--traversal", "brute-force", says=["80000 triangles"])
        write(self.path("floor.obj"), FLOOR)
        self.assertEqual(self.hash_of("--traversal", "brute-force", scene="floor.obj"), self.hash_of(scene="floor.obj"))

    def test_the_last_event_has_the_number_of_frames_and_seconds_per_frame(self):
        done = self.succeed("render", "cornell-box", "-o", "x.exr", *SMALL, "--json").events("done")[0]
        self.assertEqual(done["frames"], 2)
        self.assertAlmostEqual(done["seconds_per_frame"] * 2, done["seconds"], places=4)


if __name__ == "__main__":
    main()
