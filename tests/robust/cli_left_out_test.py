"""Unreadable parts are left out with a warning, --strict refuses them, and lists name what was left out or added."""

import json

from cli_run import CliTest, gltf_with_cameras, main, read_exr, write

SMALL_EXR = ["--size", "8x8", "--spp", "1", "--device", "cpu"]
SMALL = [*SMALL_EXR, "--exposure", "0"]
SQUARE = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n"


class LeftOut(CliTest):
    def model(self, name="model.gltf", **members):
        """A triangle in front of two cameras, with additional members."""
        write(self.path(name), json.dumps({**json.loads(gltf_with_cameras()), **members}))
        return name

    def test_an_unknown_required_extension_is_skipped_but_refused_with_strict(self):
        scene = self.model(extensionsUsed=["EXT_new"], extensionsRequired=["EXT_new"])
        outcome = self.succeed("render", scene, "-o", "x.png", "--json", *SMALL)
        done = outcome.events("done")[0]
        self.assertEqual(len(done["left_out"]), 1, done)
        self.assertRegex(done["left_out"][0], r"^model\.gltf: /extensionsRequired/0: .*\bEXT_new\b")
        self.assertEqual([event["text"] for event in outcome.events("warning")], done["left_out"])
        self.refuse(2, "render", scene, "-o", "y.png", "--strict", *SMALL,
                    says=["--strict: ", "/extensionsRequired/0", "EXT_new"])

    def test_every_verb_that_renders_or_measures_a_scene_has_strict(self):
        scene = self.model(extensionsUsed=["EXT_new"])
        lines = [["measure", scene, "--at", "0,0,-1", "--normal", "0,0,1", "--spp", "1", "--device", "cpu"],
                 ["solve", "radiosity", scene, "-o", "x.rad", "--patch-rays", "16"],
                 ["lab", scene, "--structures", "binned", "--traversals", "if-if", "--runs", "1", "--device", "cpu", "--size", "16x12"],
                 ["bench", "frames", scene, "--frames", "1", "--size", "16x12", "--device", "cpu"],
                 ["bench", "sequence", scene, "--turntable", "2", "--size", "16x12", "--device", "cpu"]]
        for line in lines:
            with self.subTest(line=line):
                outcome = self.refuse(2, *line, "--strict", says=["--strict: ", "EXT_new"])
                self.assertEqual(outcome.stdout, "")
        self.refuse(2, "view", scene, "--strict", "--no-browser", "--port", "0", "--device", "cpu", says=["--strict: ", "EXT_new"])
        self.succeed(*lines[0])
        self.succeed("measure", self.model("whole.gltf"), *lines[0][2:], "--strict")

    def test_strict_names_the_first_skipped_part_and_the_number_of_parts(self):
        scene = self.model(extensionsUsed=["EXT_new", "EXT_newer", "EXT_newest"])
        self.refuse(2, "render", scene, "-o", "y.png", "--strict", "--json", *SMALL,
                    says=["EXT_new, ", " 2 "])

    def test_a_pbrt_scene_is_rendered_as_it_says_and_gets_no_light(self):
        text = ('Film "rgb" "integer xresolution" 12 "integer yresolution" 8\nSampler "sobol" "integer pixelsamples" 2\n'
                'LookAt 0 0 -3 0 0 0 0 1 0\nCamera "perspective" "float fov" 60\nWorldBegin\nShape "sphere"\n')
        write(self.path("dark.pbrt"), text)
        outcome = self.succeed("render", "dark.pbrt", "-o", "x.exr", "--json", "--strict", "--device", "cpu")
        done, picture = outcome.events("done")[0], outcome.events("picture")[0]
        self.assertEqual((done["left_out"], done["made_up"]), ([], []))
        self.assertEqual((picture["width"], picture["height"], picture["spp"]), (12, 8, 2))
        channels = read_exr(self.path("x.exr"))[2]
        self.assertEqual({value for rows in channels.values() for row in rows for value in row}, {0.0})
        info = self.succeed("info", "dark.pbrt", "--json").events("info")[0]
        self.assertEqual(info["makes_up"], [])
        self.assertIn("max_depth=5", info["suggests"])
        write(self.path("fault.pbrt"), text + 'Shap "sphere"\n')
        done = self.succeed("render", "fault.pbrt", "-o", "x.exr", "--json", "--device", "cpu").events("done")[0]
        self.assertRegex(done["left_out"][0], r'^fault\.pbrt:7: "Shap" .*"Shape"')
        self.refuse(2, "render", "fault.pbrt", "-o", "y.exr", "--strict", "--device", "cpu", says=["--strict: ", "fault.pbrt:7: "])

    def test_a_mitsuba_scene_is_rendered_as_it_says_with_defined_values(self):
        text = ('<scene version="3.0.0">\n<default name="spp" value="2"/><default name="r" value="1"/>\n'
                '<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="8"/>'
                '</film><sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>\n'
                '<emitter type="constant"><rgb name="radiance" value="$r"/></emitter><shape type="sphere"><bsdf type="dielectric"/></shape>\n')
        write(self.path("grey.xml"), text + "</scene>")
        outcome = self.succeed("render", "grey.xml", "-o", "x.exr", "--json", "--strict", "--device", "cpu", "-D", "spp=3", "--define", "r=0")
        done, picture = outcome.events("done")[0], outcome.events("picture")[0]
        self.assertEqual((done["left_out"], done["made_up"]), ([], []))
        self.assertEqual((picture["width"], picture["height"], picture["spp"]), (12, 8, 3))
        channels = read_exr(self.path("x.exr"))[2]
        self.assertEqual({value for rows in channels.values() for row in rows for value in row}, {0.0})
        warned = self.succeed("info", "grey.xml", "--json", "--define", "sp=3").events("warning")[0]
        self.assertEqual((warned["setting"], warned["value"]), ("define", "sp"))
        self.refuse(2, "info", "grey.xml", "--define", "spp", says=["--define spp"])
        write(self.path("fault.xml"), text + '<shap type="sphere"/></scene>')
        done = self.succeed("render", "fault.xml", "-o", "x.exr", "--json", "--device", "cpu").events("done")[0]
        self.assertRegex(done["left_out"][0], r'^fault\.xml:5: .*"shape"')
        self.refuse(2, "render", "fault.xml", "-o", "y.exr", "--strict", "--device", "cpu", says=["--strict: ", "fault.xml:5: "])

    def test_the_error_for_a_scene_without_triangles_lists_the_skipped_parts(self):
        accessors = [{"componentType": 5126, "count": 3, "type": "VEC3"}]
        meshes = [{"primitives": [{"attributes": {"POSITION": 0},
                                   "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}}]}]
        scene = self.model(accessors=accessors, meshes=meshes, extensionsRequired=["KHR_draco_mesh_compression"])
        for flags in [[], ["-q"], ["--json"], ["--strict"]]:
            self.refuse(2, "render", scene, "-o", "x.png", *flags, *SMALL, says=["KHR_draco_mesh_compression"])

    def test_a_complete_scene_skips_no_part_and_missing_light_and_camera_are_added(self):
        done = self.succeed("render", self.model(), "-o", "x.png", "--json", "--strict", *SMALL).events("done")[0]
        self.assertEqual(done["left_out"], [])
        self.assertEqual(len(done["made_up"]), 1, done)  # the light
        self.assertIn("light", done["made_up"][0])
        write(self.path("square.obj"), SQUARE + "f 4 3 2 1\n")
        done = self.succeed("render", "square.obj", "-o", "y.png", "--json", "--strict", *SMALL).events("done")[0]
        self.assertEqual(len([text for text in done["made_up"] if "camera" in text]), 1, done)
        self.assertEqual(self.succeed("render", "cornell-box", "-o", "z.png", "--json", *SMALL).events("done")[0]["made_up"],
                         [])

    def test_metadata_and_info_list_skipped_and_added_parts(self):
        scene = self.model(extensionsUsed=["EXT_new"])
        done = self.succeed("render", scene, "-o", "x.exr", "--json", *SMALL_EXR).events("done")[0]
        info = self.succeed("info", "x.exr", "--json").events("info")[0]
        self.assertEqual(json.loads(info["pertev.left_out"]), done["left_out"])
        self.assertEqual(json.loads(info["pertev.made_up"]), done["made_up"])
        info = self.succeed("info", scene, "--json").events("info")[0]
        self.assertEqual(info["left_out"], done["left_out"])

    def test_measure_and_sequences_list_skipped_parts(self):
        scene = self.model(extensionsUsed=["EXT_new"])
        at = ["--at", "0,0,1", "--normal", "0,0,1", "--spp", "1", "--device", "cpu"]
        self.assertEqual(len(self.succeed("measure", scene, "--json", *at).events("measure")[0]["left_out"]), 1)
        outcome = self.succeed("render", scene, "-o", "f###.png", "--turntable", "2", "--json", *SMALL)
        self.assertEqual(len(outcome.events("sequence")[0]["left_out"]), 1)

    def test_unreadable_faces_and_lines_are_skipped(self):
        good = SQUARE + "f 4 3 2 1\n"
        write(self.path("m.mtl"), "newmtl m\nKd 1 oops 0\nKe 1 1 1\n")
        write(self.path("bad.mtl.obj"), "mtllib m.mtl\nusemtl m\n" + good)
        write(self.path("past.obj"), good + "f 1 2 9\n")
        write(self.path("word.obj"), good + "f 1 2 three\n")
        header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        body = "0 0 0\n1 0 0\n0 1 0\n"
        faces = "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
        write(self.path("past.ply"), header + faces + body + "3 0 1 2\n3 0 1 7\n")
        write(self.path("cut.ply"), header + faces + body + "3 0 1 2\n3 0\n")
        for scene, place in [("bad.mtl.obj", "m.mtl:2: Kd"), ("past.obj", "past.obj:6: "), ("word.obj", "word.obj:6: "),
                             ("past.ply", "past.ply:"), ("cut.ply", "cut.ply:")]:
            with self.subTest(scene=scene):
                done = self.succeed("render", scene, "-o", "x.exr", "--json", *SMALL_EXR).events("done")[0]
                self.assertEqual(len(done["left_out"]), 1, done)
                self.assertIn(place, done["left_out"][0])
                self.assertTrue(read_exr(self.path("x.exr")))
                self.refuse(2, "render", scene, "-o", "y.exr", "--strict", *SMALL_EXR, says=["--strict: ", place])
        write(self.path("none.obj"), SQUARE + "f 1 2 9\n")
        self.refuse(2, "render", "none.obj", "-o", "x.exr", *SMALL_EXR, says=["none.obj"])


if __name__ == "__main__":
    main()
