#!/usr/bin/env python3
"""Which faces emit and which are visible: --two-sided-lights, --show-back-faces, and messages about both."""

from cli_run import CliTest, gltf_with_cameras, main, write

# A floor, and an emitter above it that faces down.
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
        write(self.path("sheet.gltf"), gltf_with_cameras())  # no surface is double sided

    def told(self, about, *arguments):
        """Returns kind, file and reason of each remark about a setting."""
        return [(event["event"], event.get("place", {}).get("file"), event["reason"]) for event in self.remarks(
            "render", *arguments, "-o", "x.png", "--size", "16x16", "--spp", "1", "--device", "cpu", about=about)]

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
        ((kind, file, reason),) = self.told("two_sided_lights", "lamp.obj")  # there is no warning about fronts besides
        self.assertEqual((kind, file), ("notice", "lamp.obj"))
        self.assertRegex(reason, r"\b1\b.*\bbulb\b")
        self.assertEqual(self.told("two_sided_lights", "lamp.obj", "--two-sided-lights"), [])
        self.assertEqual(self.told("two_sided_lights", "cornell-box"), [])

    def test_the_camera_sees_through_back_faces_unless_they_are_requested(self):
        hidden = self.render(*FROM_BEHIND, scene="sheet.gltf")["hash"]
        shown = self.render(*FROM_BEHIND, "--show-back-faces", scene="sheet.gltf")["hash"]
        empty = self.render("--eye", "0,0,-4", "--target", "0,0,-8", scene="sheet.gltf")["hash"]
        self.assertEqual(len({hidden, shown, empty}), 3)
        self.mean(*FROM_BEHIND, "--show-back-faces", scene="sheet.gltf")

    def test_a_view_through_back_faces_is_reported_with_the_flag_that_shows_them(self):
        ((kind, _, reason),) = self.told("show_back_faces", "sheet.gltf", *FROM_BEHIND)
        self.assertEqual(kind, "notice")
        self.assertRegex(reason, r"\b\d+ %")
        for quiet in [["sheet.gltf"], ["sheet.gltf", *FROM_BEHIND, "--show-back-faces"],
                      ["sheet.gltf", "--eye", "0,0,-60", "--target", "0,0,0"], ["lamp.obj", *FROM_ABOVE]]:
            self.assertEqual(self.told("show_back_faces", *quiet), [], quiet)
        for threads in [1, 2]:
            self.assertEqual(self.told("show_back_faces", "sheet.gltf", *FROM_BEHIND, "--threads", threads)[0][2], reason)

    def test_face_flags_without_effect_on_a_scene_cause_a_warning(self):
        for flag, scene in [("two-sided-lights", "sheet.gltf"), ("show-back-faces", "lamp.obj")]:
            self.assertEqual([kind for kind, _, _ in self.told(flag.replace("-", "_"), scene, "--" + flag)], ["warning"])


if __name__ == "__main__":
    main()
