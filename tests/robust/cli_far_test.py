#!/usr/bin/env python3
"""Scenes far from the origin of their files, in survey coordinates: flags, pictures and numbers keep their digits."""

import math

from cli_run import CliTest, main, read_exr, write

EAST, NORTH = 448262.257, 5411933.125  # UTM


def fence(x, y):
    """Returns an OBJ of four slats of 0.125 m, one above the other, with gaps of the same height."""
    text = ""
    for i in range(4):
        low, high = y + 0.25 * i, y + 0.25 * i + 0.125
        text += "".join(f"v {a:.4f} {b:.4f} 0\n" for a, b in [(x, low), (x + 1, low), (x + 1, high), (x, high)])
    return text + "".join(f"f {4 * i + 1} {4 * i + 2} {4 * i + 3} {4 * i + 4}\n" for i in range(4))


def flag(numbers):
    return ",".join(repr(x) for x in numbers)


class Far(CliTest):
    def setUp(self):
        super().setUp()
        write(self.path("near.obj"), fence(0, 0))
        write(self.path("far.obj"), fence(EAST, NORTH))

    def see(self, scene, x, y, output):
        """Returns an orthographic view from 5 m in front of the centre of the fence with this corner."""
        return self.render("--projection", "orthographic", "--view-height", "1.2", "--eye", f"{x + .5!r},{y + .4375!r},5",
                           "--target", f"{x + .5!r},{y + .4375!r},0", "--environment", "1,1,1", "--transparent",
                           "--aov", "position", scene=scene, size="48x48", output=output)

    def test_a_fence_far_from_the_origin_has_the_picture_of_one_near_it(self):
        pictures = []
        for scene, x, y in [("near.obj", 0, 0), ("far.obj", EAST, NORTH)]:
            self.see(scene, x, y, f"{scene}.exr")
            _, _, rows = read_exr(self.path(f"{scene}.exr"))
            column = [rows["A"][j][24] > 0.5 for j in range(48)]
            self.assertEqual(sum(1 for a, b in zip(column, column[1:]) if b and not a), 4, scene)
            pictures.append(rows["A"])
        for near, far in zip(*pictures):  # except at edges
            self.assertLess(sum(abs(a - b) for a, b in zip(near, far)), 2)

    def test_metadata_gives_the_flags_and_the_origin_of_positions(self):
        first = self.see("far.obj", EAST, NORTH, "first.exr")
        told = self.info("first.exr")
        again = self.render("--projection", "orthographic", "--view-height", "1.2", "--eye", flag(told["pertev.eye"]), "--target",
                            flag(told["pertev.target"]), "--up", flag(told["pertev.up"]), "--environment", "1,1,1", "--transparent",
                            "--aov", "position", scene="far.obj", size="48x48", output="again.exr")
        self.assertEqual(again["hash"], first["hash"])
        for got, wanted in zip(told["pertev.eye"], [EAST + 0.5, NORTH + 0.4375, 5]):
            self.assertAlmostEqual(float(got), wanted, delta=1e-6)
        origin = told["pertev.position_origin"]
        _, _, rows = read_exr(self.path("first.exr"))
        hits = [(j, i) for j in range(48) for i in range(48) if rows["A"][j][i] == 1]
        self.assertGreater(len(hits), 300)
        for j, i in hits:
            self.assertAlmostEqual(origin[0] + rows["position.X"][j][i], EAST + 0.5 + (i + .5 - 24) * 1.2 / 48, delta=.06)
            self.assertAlmostEqual(origin[1] + rows["position.Y"][j][i], NORTH + .4375 - (j + .5 - 24) * 1.2 / 48, delta=.06)
        self.see("near.obj", 0, 0, "near.exr")
        self.assertNotIn("pertev.position_origin", self.info("near.exr"))

    def test_the_flags_in_the_notice_of_a_default_view_reproduce_it(self):
        outcome = self.succeed("render", "far.obj", "-o", "a.exr", "--size", "16x16", "--spp", "1", "--device", "cpu")
        flags = outcome.stderr.split("(--eye ")[1].split(")")[0].split(" --target ")
        eye, target = ([float(x) for x in flag.split(",")] for flag in flags)
        told = self.info("a.exr")
        for got, wanted in zip(told["pertev.eye"], eye):
            self.assertAlmostEqual(float(got), wanted, delta=1e-3)
        self.assertLess(math.dist(target, [EAST + 0.5, NORTH + 0.4375, 0]), 0.01)

    def test_info_and_measure_use_the_coordinates_of_the_file(self):
        told = self.info("far.obj")
        for got, wanted in zip(told["bounds_low"] + told["bounds_high"], [EAST, NORTH, 0, EAST + 1, NORTH + 0.875, 0]):
            self.assertAlmostEqual(got, wanted, delta=1e-6)
        # The point is 5 cm behind a gap and faces the fence, which blocks a part of the sky.
        numbers = []
        for scene, x, y in [("near.obj", 0, 0), ("far.obj", EAST, NORTH)]:
            outcome = self.succeed("measure", scene, "--at", f"{x + .5!r},{y + .1875!r},0.05", "--normal", "0,0,-1", "--spp",
                                   "4", "--max-depth", "0", "--environment", "1,1,1", "--device", "cpu", "--json")
            numbers.append(outcome.events("measure")[0]["irradiance"]["value"])
        self.assertLess(numbers[0], 0.95 * math.pi)
        self.assertAlmostEqual(numbers[0], numbers[1], delta=0.02)


if __name__ == "__main__":
    main()
