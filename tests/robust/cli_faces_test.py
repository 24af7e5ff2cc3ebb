#!/usr/bin/env python3
"""Which faces shine and which are seen: --two-sided-lights, --show-back-faces, and what is said of both."""

from cli_run import CliTest, gltf_with_cameras, main, write

# A floor, and a lamp above it that faces down.
LAMP = """mtllib lamp.mtl
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
f 4 3 2 1
v -0.5 2 -0.5
v 0.5 2 -0.5
v 0.5 2 0.5
v -0.5 2 0.5
usemtl bulb
f 5 6 7 8
"""
FROM_ABOVE = ["--eye", "0,4,0.1", "--target", "0,0,0"]
FROM_BEHIND = ["--eye", "0,0,-4", "--target", "0,0,0"]


class FacesTest(CliTest):
    def setUp(self):
        super().setUp()
        write(self.path("lamp.mtl"), "newmtl bulb\nKe 5 5 5\n")
        write(self.path("lamp.obj"), LAMP)
        write(self.path("sheet.gltf"), gltf_with_cameras())  # nothing in it is double sided

    def said(self, *arguments):
        return self.succeed("render", *arguments, "-o", "x.png", "--size", "16x16", "--spp", "1", "--device", "cpu").stderr

    def mean(self, *arguments, scene):
        self.render(*arguments, scene=scene, output="x.exr", spp=8)
        made = self.info("x.exr")
        self.assertEqual((made["pertev.two_sided_lights"], made["pertev.show_back_faces"]),
                         ("--two-sided-lights" in arguments, "--show-back-faces" in arguments))
        return made["mean"][0]

    def test_an_emitter_of_an_obj_emits_from_its_front_unless_both_sides_are_requested(self):
        front = self.mean(*FROM_ABOVE, scene="lamp.obj")
        both = self.mean(*FROM_ABOVE, "--two-sided-lights", scene="lamp.obj")
        self.assertGreater(front, 0)  # the floor
        self.assertGreater(both, front + 0.1)

    def test_one_sided_emitters_of_an_obj_are_reported_with_the_flag_for_two_sides(self):
        said = self.said("lamp.obj")
        self.assertRegex(said, r"note: lamp\.obj: 1 emitter with light on the front only: bulb; .*--two-sided-lights")
        self.assertNotIn("turn its faces round", said)
        self.assertNotIn("bulb", self.said("lamp.obj", "--two-sided-lights"))
        self.assertNotIn("on the front only", self.said("cornell-box"))

    def test_the_camera_sees_through_back_faces_unless_they_are_requested(self):
        hidden = self.render(*FROM_BEHIND, scene="sheet.gltf")["hash"]
        shown = self.render(*FROM_BEHIND, "--show-back-faces", scene="sheet.gltf")["hash"]
        empty = self.render("--eye", "0,0,-4", "--target", "0,0,-8", scene="sheet.gltf")["hash"]
        self.assertEqual(len({hidden, shown, empty}), 3)
        self.mean(*FROM_BEHIND, "--show-back-faces", scene="sheet.gltf")

    def test_a_view_through_back_faces_is_reported_with_the_flag_that_shows_them(self):
        said = self.said("sheet.gltf", *FROM_BEHIND)
        self.assertRegex(said, r"note: the camera looks through the backs of surfaces at \d+ % of the picture.*"
                               r"--show-back-faces")
        for quiet in [["sheet.gltf"], ["sheet.gltf", *FROM_BEHIND, "--show-back-faces"],
                      ["sheet.gltf", "--eye", "0,0,-60", "--target", "0,0,0"], ["lamp.obj", *FROM_ABOVE]]:
            self.assertNotIn("looks through", self.said(*quiet), quiet)
        shares = {self.said("sheet.gltf", *FROM_BEHIND, "--threads", threads).split("surfaces at ")[1].split(" %")[0]
                  for threads in [1, 2]}
        self.assertEqual(len(shares), 1)

    def test_face_flags_without_effect_on_a_scene_cause_a_warning(self):
        self.assertIn("warning: --two-sided-lights: ", self.said("sheet.gltf", "--two-sided-lights"))
        self.assertIn("warning: --show-back-faces: ", self.said("lamp.obj", "--show-back-faces"))


if __name__ == "__main__":
    main()
