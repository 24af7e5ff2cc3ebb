#!/usr/bin/env python3
"""OBJ, PLY and STL files of other programs: units and axes, names of files, colours, textures, invisible materials."""

import struct
import zlib

from cli_run import CliTest, gltf_with_cameras, main, read_exr, write

# A uniformly lit square of 2 by 2 m that faces +z, and a view of it.
SQUARE = "v -1 -1 0{0}\nv 1 -1 0{0}\nv 1 1 0{0}\nv -1 1 0{0}\n"
TEXTURED = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n"
VIEW = ["--projection", "orthographic", "--view-height", "2", "--eye", "0,0,5", "--target", "0,0,0", "--environment", "1,1,1",
        "--max-depth", "1", "--filter", "box"]
RED = (1, 0, 0)
# Geometry that faces the eye above in the file's own coordinates, in millimetres: a step of 1 m by 3 m, with z, y and
# x up.
STEP = "usemtl step\nf 1 2 3 4\n"
STEPS = {"z": "v 0 0 0\nv 1000 0 0\nv 1000 0 3000\nv 0 0 3000\n", "y": "v 0 0 0\nv 1000 0 0\nv 1000 3000 0\nv 0 3000 0\n",
         "x": "v 0 0 0\nv 0 -1000 0\nv 3000 -1000 0\nv 3000 0 0\n"}


def write_png(path, rgb):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(b"\0" + bytes(rgb))) + chunk(b"IEND", b""))


class Meshes(CliTest):
    def mean(self, scene, *flags):
        self.render(*VIEW, *flags, scene=scene, output="x.exr", spp=64)
        return self.info("x.exr")["mean"]

    def assert_near(self, mean, right, delta=0.02):
        for value, expected in zip(mean, right):
            self.assertAlmostEqual(value, expected, delta=delta, msg=f"{mean}, not {right}")

    def warnings_of(self, scene):
        picture = ["-o", "x.png", "--size", "8x8", "--spp", "1", "--device", "cpu"]
        return [event for event in self.remarks("render", scene, *picture) if event["event"] == "warning"]

    def test_unit_and_up_axis_convert_a_file_and_are_in_the_metadata(self):
        pictures = set()
        for axis, vertices in STEPS.items():
            write(self.path(f"{axis}.obj"), vertices + STEP)
            bounds = self.info(f"{axis}.obj")
            self.assertEqual(max(bounds["bounds_high"]), 3000)
            flags = ["--up-axis", axis, "--unit", "mm"]
            done = self.render("--eye", "0.5,1.5,9", "--target", "0.5,1.5,0", *flags, scene=f"{axis}.obj", output="x.exr")
            pictures.add(done["hash"])
            made = self.info("x.exr")
            self.assertEqual((made["pertev.up_axis"], made["pertev.unit"], made["pertev.eye"]), (axis, "mm", [0.5, 1.5, 9]))
            of_scene = self.succeed("info", f"{axis}.obj", *flags, "--json").events("info")[0]
            self.assert_near(of_scene["bounds_high"], (1, 3, 0), 1e-5)
            self.assert_near(of_scene["bounds_low"], (0, 0, 0), 1e-5)
        self.assertEqual(len(pictures), 1, "one picture, whichever way is up in the file")
        metres = self.render("--eye", "0.5,1.5,9", "--target", "0.5,1.5,0", "--unit", "0.001", scene="y.obj", output="x.exr")
        self.assertIn(metres["hash"], pictures)
        self.assertNotIn("pertev.up_axis", self.info("x.exr"))

    def test_continuing_with_another_unit_is_refused_and_gltf_ignores_the_unit(self):
        write(self.path("y.obj"), STEPS["y"] + STEP)
        frames = ["render", "y.obj", "-o", "f-#.png", "--size", "8x8", "--spp", "1", "--exposure", "0", "--turntable", "2",
                  "--frames", "0-1", "--device", "cpu", "--eye", "0.5,1.5,9", "--target", "0.5,1.5,0"]
        self.succeed(*frames, "--unit", "mm")
        self.succeed(*frames, "--unit", "mm", "--continue")
        self.refuse(2, *frames, "--unit", "cm", "--continue", says=["--unit"])
        self.refuse(2, *frames, "--continue", says=["--unit"])
        (warning,) = self.remarks("render", "cornell-box", "-o", "x.png", "--size", "8x8", "--spp", "1", "--unit", "mm", about="unit")
        self.assertEqual((warning["event"], warning["place"]), ("warning", {"file": "cornell-box"}))

    def test_files_are_found_with_another_case_or_in_another_folder(self):
        write_png(self.path("Plain.PNG"), (255, 0, 0))
        write(self.path("My Model.mtl"), "newmtl a\nKd 1 1 1\nmap_Kd C:\\Users\\someone\\plain.png -bm 1\n")
        write(self.path("a.obj"), "mtllib my model.MTL\n" + SQUARE.format("") + TEXTURED)
        self.assert_near(self.mean("a.obj"), RED)
        of_obj, of_mtl = self.warnings_of("a.obj")
        self.assertEqual((of_obj["place"]["line"], of_mtl["place"]["line"]), (1, 3))
        self.assertIn(self.path("My Model.mtl"), of_obj["reason"])
        self.assertIn(self.path("Plain.PNG"), of_mtl["reason"])
        write_png(self.path("plain.Png"), (0, 255, 0))
        candidates = self.warnings_of("a.obj")[1]["reason"]  # both files match, so none is read
        self.assertTrue(self.path("Plain.PNG") in candidates and self.path("plain.Png") in candidates)

    def test_ply_files_have_colours_in_bytes_and_textures(self):
        write(self.path("bytes.obj"), SQUARE.format(" 255 128 0") + "f 1 2 3 4\n")
        self.assert_near(self.mean("bytes.obj"), (1, 0.216, 0))
        write_png(self.path("red.png"), (255, 0, 0))
        head = "ply\nformat ascii 1.0\ncomment TextureFile red.png\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        write(self.path("a.ply"), head + "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
              "end_header\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n")
        self.assert_near(self.mean("a.ply"), RED)

    def test_invisible_materials_are_reported(self):
        for statement in ["Tr 1", "d 0"]:
            write(self.path("a.mtl"), f"newmtl ghost\nKd 1 0 0\n{statement}\n")
            write(self.path("a.obj"), "mtllib a.mtl\n" + SQUARE.format("") + "usemtl ghost\nf 1 2 3 4\n")
            (warning,) = self.warnings_of("a.obj")
            self.assertEqual(warning["place"], {"file": "a.obj"})
            self.assertIn("ghost", warning["reason"])
        write(self.path("a.mtl"), "newmtl ghost\nKd 1 0 0\nd 1\nTr 1\n")
        self.assertEqual(self.warnings_of("a.obj"), [])
        self.assert_near(self.mean("a.obj"), RED)

    def test_an_stl_file_is_grey_and_a_material_is_set_by_its_name_in_the_syntax_of_info(self):
        corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        facets = [struct.pack("<12fH", *[0] * 3, *corners[0], *corners[i], *corners[i + 1], 0) for i in (1, 2)]
        with open(self.path("sheet.stl"), "wb") as file:
            file.write(b"solid binary".ljust(80) + struct.pack("<I", 2) + b"".join(facets))
        self.assert_near(self.mean("sheet.stl"), (0.5, 0.5, 0.5))
        self.assert_near(self.mean("sheet.stl", "--material", "sheet base_color=1,0,0"), RED)
        self.assertEqual(self.info("x.exr")["pertev.material"], "sheet base_color=1,0,0")
        listed = self.succeed("info", "sheet.stl", "--material", "sheet roughness=0.25", "--json").events("info")[0]["material_list"]
        self.assertEqual(listed, ["sheet kind=metallic_roughness base_color=0.5 roughness=0.25"])
        self.refuse(2, "render", "sheet.stl", "-o", "y.png", "--material", "shoot base_color=1", says=["--material 'shoot base_color=1'", "'sheet'"])
        self.refuse(2, "render", "sheet.stl", "-o", "y.png", "--material", "sheet", says=["--material sheet"])

    def test_exr_metadata_have_the_author_and_licence_of_a_gltf_file_unless_flags_state_others(self):
        write(self.path("a.gltf"), gltf_with_cameras().replace('"version": "2.0"', '"version": "2.0", "extras": {"author": "Ada", "license": "CC0"}'))
        made = ["render", "a.gltf", "-o", "x.exr", "--size", "8x8", "--spp", "1", "--device", "cpu"]
        hashes = set()
        for flags, license in [([], "CC0"), (["--license", "mine"], "mine")]:
            hashes.add(self.succeed(*made, *flags, "--json").events("done")[0]["hash"])
            info = self.info("x.exr")
            self.assertEqual((info["pertev.author"], info["pertev.license"]), ("Ada", license))
        self.assertEqual(len(hashes), 1)

    def test_exr_metadata_map_ids_to_object_names(self):
        write(self.path("a.obj"), SQUARE.format("") + "o left door\nf 1 2 3\no right door\nf 1 3 4\n")
        self.render(*VIEW, "--aov", "ids", scene="a.obj", output="x.exr")
        self.assertEqual(self.info("x.exr")["pertev.instances"], '{"0":"left door","1":"right door"}')
        ids = read_exr(self.path("x.exr"))[2]["id.instance"]
        self.assertEqual({value for row in ids for value in row}, {0, 1})


if __name__ == "__main__":
    main()
