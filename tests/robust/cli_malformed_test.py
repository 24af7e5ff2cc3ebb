#!/usr/bin/env python3
"""A damaged file, wherever it is used, causes an error that names it or a warning and a picture. It never causes a
crash, a hang or an allocation that its size does not justify. The files are damaged here or come from the public
collection under PERTEV_SCENES."""

import json
import os
import re
import resource
import shutil
import struct
import unittest
import zlib

from cli_run import SANITIZED, UNMETERED, CliTest, limit_addresses, main

MAX_SECONDS = 60 if SANITIZED else 5  # processor time, because the machine may be loaded
IMAGES = (".png", ".jpg", ".exr", ".hdr")
SCENES = (".obj", ".ply", ".stl", ".gltf", ".glb", ".pbrt", ".xml")

SQUARE = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"


def public_files(extensions):
    root = os.path.join(os.environ.get("PERTEV_SCENES", ""), "malformed")
    if "PERTEV_SCENES" not in os.environ or not os.path.isdir(root):
        raise unittest.SkipTest("PERTEV_SCENES does not name the folder of the public scenes (docs/scenes.md)")
    found = [os.path.join(folder, name) for folder, _, names in os.walk(root) for name in names]
    return sorted(path for path in found if path.endswith(extensions))


class MalformedTest(CliTest):
    gibibytes = 4

    def survive(self, name, *arguments, warns=False):
        """Tests that a run ends with an error that names `name`, or with a picture or description. With `warns` there
        is a warning that names it. Returns the status."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        outcome = self.run_pertev(*arguments, preexec_fn=limit_addresses(self.gibibytes))
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.assertIn(outcome.status, (0, 2, 3), outcome)
        self.assertLess(seconds, MAX_SECONDS, outcome)
        if outcome.status != 0:
            self.assertIn(name, outcome.stderr, outcome)
            self.assertEqual(outcome.stdout, "")
        elif warns:
            self.assertRegex(outcome.stderr, f"(?m)^warning: .*{re.escape(name)}", outcome)
        return outcome.status

    def survive_render(self, name, scene, *arguments, warns=False):
        picture = self.path("picture.png")
        status = self.survive(name, "render", scene, "-o", picture, "--size", "32x32", "--spp", "1", "--device", "cpu",
                              *UNMETERED, *arguments, warns=warns)
        self.assertEqual(os.path.exists(picture), status == 0)
        if status == 0:
            os.remove(picture)
        return status

    def use_image(self, path, warns):
        """Reads the image in each use: as a picture, as a texture of an OBJ and a glTF file, and as environment."""
        name = os.path.basename(path)
        here = self.path(name)
        if os.path.abspath(path) != here:
            shutil.copy(path, here)
            os.chmod(here, 0o644)
        statuses = [self.survive(name, "info", name, warns=warns),
                    self.survive_render(name, "cornell-box", "--environment", name, warns=warns)]
        with open(self.path("model.obj"), "w", encoding="utf-8") as file:
            file.write("mtllib model.mtl\nusemtl m\n" + SQUARE)
        with open(self.path("model.mtl"), "w", encoding="utf-8") as file:
            file.write(f"newmtl m\nKd 1 1 1\nmap_Kd {name}\n")
        statuses.append(self.survive_render(name, "model.obj", warns=warns))
        with open(self.path("model.gltf"), "w", encoding="utf-8") as file:
            file.write(gltf_with_texture(name))
        statuses.append(self.survive_render(name, "model.gltf", warns=warns))
        return statuses


def gltf_with_texture(name):
    positions = "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"  # (-1,-1,0) (1,-1,0) (0,1,0), which are also the uv
    texture = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "images": [{"uri": name}], "textures": [{"source": 0}], "materials": [texture],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0],
                       "max": [1, 1, 0]},
                      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + positions}]})


class FilesDamagedHere(MalformedTest):
    def setUp(self):
        super().setUp()
        self.pictures = [f"whole{extension}" for extension in IMAGES]
        outputs = [argument for name in self.pictures for argument in ("-o", name)]
        self.succeed("render", "cornell-box", *outputs, "--size", "24x24", "--spp", "1", "--device", "cpu",
                     *UNMETERED)
        shutil.move(self.folder, self.folder + "-whole")
        os.mkdir(self.folder)

    def whole(self, name):
        with open(os.path.join(self.folder + "-whole", name), "rb") as file:
            return file.read()

    def put(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)
        return self.path(name)

    def test_intact_pictures_are_accepted_in_every_use(self):
        for name in ["whole.png", "whole.jpg"]:
            self.assertEqual(self.use_image(self.put(name, self.whole(name)), warns=False), [0, 0, 0, 0], name)
        for name in ["whole.exr", "whole.hdr"]:
            self.assertEqual(self.use_image(self.put(name, self.whole(name)), warns=False)[:2], [0, 0], name)

    def test_a_picture_cut_anywhere_is_refused_or_shown_with_a_warning(self):
        for name in self.pictures:
            content = self.whole(name)
            for length in [0, 1, 9, 40, len(content) // 2, len(content) - 1]:
                with self.subTest(picture=name, length=length):
                    self.use_image(self.put(f"cut{name[5:]}", content[:length]), warns=True)

    def test_a_picture_with_damaged_bytes_is_refused_or_shown(self):
        for name in self.pictures:
            content = self.whole(name)
            for seed in range(4):
                damaged = bytearray(content)
                for i in range(8):
                    damaged[(seed * 7919 + i * i * 6151) % (len(content) if seed else 64)] ^= 1 << (i + seed) % 8
                with self.subTest(picture=name, seed=seed):
                    # Only PNG has checksums. In other formats changed bytes may be another valid picture.
                    self.use_image(self.put(f"damaged{name[5:]}", bytes(damaged)), warns=name.endswith(".png"))

    def test_other_files_with_a_picture_extension_are_refused(self):
        for extension in IMAGES:
            for content in [b"v 0 0 0\n", b"\0" * 4096, b"<html>not here</html>"]:
                with self.subTest(extension=extension, content=content[:8]):
                    self.assertEqual(self.use_image(self.put("fake" + extension, content), warns=True)[:2], [2, 2])

    def test_other_files_with_a_scene_extension_are_refused(self):
        for extension in (".obj", ".ply", ".stl", ".gltf", ".glb"):
            for content in [b"", b"\0" * 4096, b"<html>not here</html>", b"{}", b"[" * 50000, b"ply\n", b"\xff\xfe\n" * 99]:
                name = "fake" + extension
                self.put(name, content)
                with self.subTest(extension=extension, content=content[:8]):
                    self.assertEqual(self.survive(name, "info", name), 2)
                    self.assertEqual(self.survive_render(name, name), 2)

    def test_meshes_without_area_are_refused_and_invalid_faces_are_skipped(self):
        whole = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        for text, status in [("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", 2), ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 2),
                             (whole + "v inf 0 0\nf 1 2 4\n", 0), (whole + "v 1e39 0 0\nf 1 2 4\n", 0),
                             (whole + "f 1 2 9\n", 0), (whole + "f 1 1 2\n", 0), ("v 0 0 0\n", 2)]:
            self.put("mesh.obj", text.encode())
            with self.subTest(text=text):
                self.assertEqual(self.survive("mesh.obj", "info", "mesh.obj"), status)
                self.assertEqual(self.survive_render("mesh.obj", "mesh.obj"), status)

    def test_a_texture_outside_the_scenes_folder_needs_allow_path(self):
        inner = self.path("inner")
        os.mkdir(inner)
        self.put("whole.png", self.whole("whole.png"))
        with open(os.path.join(inner, "model.gltf"), "w", encoding="utf-8") as file:
            file.write(gltf_with_texture("../whole.png"))
        self.assertEqual(self.survive_render("whole.png", "inner/model.gltf", warns=True), 0)
        self.assertIn("--allow-path", self.run_pertev("info", "inner/model.gltf").stderr)
        self.refuse(2, "render", "inner/model.gltf", "-o", "x.png", "--strict", says=["whole.png", "--allow-path"])
        self.assertEqual(self.survive_render("whole.png", "inner/model.gltf", "--allow-path", "."), 0)


def picture_of_one_colour(side, bits):
    """A grey PNG, whose size is about a thousandth of its pixels' bytes."""
    row = b"\0" * (1 + side * bits // 8)
    packer = zlib.compressobj(9)
    packed = b"".join(packer.compress(row) for _ in range(side)) + packer.flush()
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", side, side, bits, 0, 0, 0, 0)), (b"IDAT", packed), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks)


class SmallFilesThatUnfold(MalformedTest):
    gibibytes = 2  # address space, including that of the program and its libraries

    def put(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)
        return self.path(name)

    def test_a_large_picture_of_one_colour_is_accepted(self):
        wall = self.put("wall.png", picture_of_one_colour(2048 if SANITIZED else 4096, 8))
        self.assertEqual(self.use_image(wall, warns=False), [0, 0, 0, 0])
        self.put("model.png", picture_of_one_colour(8192, 1))
        with open(self.path("model.gltf"), "w", encoding="utf-8") as file:
            file.write(gltf_with_texture("model.png"))
        self.assertNotIn("model.png", self.succeed("info", "model.gltf").stderr)

    def test_a_picture_far_too_large_for_its_file_size_is_refused(self):
        bomb = picture_of_one_colour(16384, 1)
        self.assertLess(len(bomb), 40000)
        self.assertEqual(self.use_image(self.put("bomb.png", bomb), warns=True), [3, 3, 0, 0])
        self.assertRegex(self.run_pertev("info", "model.gltf").stderr, r"bomb\.png: .*\b1024 MiB")
        # The pixels fit as bytes, but not as floats of an environment.
        self.assertEqual(self.survive_render("8k.png", "cornell-box", "--environment",
                                             self.put("8k.png", picture_of_one_colour(8192, 1))), 3)

    def test_the_limit_by_file_size_covers_all_pictures_of_a_scene_together(self):
        picture = picture_of_one_colour(8192, 1)
        model = json.loads(gltf_with_texture(""))
        model["images"] = [{"bufferView": 1 + i, "mimeType": "image/png"} for i in range(8)]
        model["textures"] = [{"source": i} for i in range(8)]
        model["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(8)]
        model["bufferViews"] += [{"buffer": 1, "byteLength": len(picture) + i} for i in range(8)]  # all names refer to one picture
        model["buffers"].append({"byteLength": len(picture) + 8, "uri": "one.bin"})
        primitive = model["meshes"][0]["primitives"][0]
        model["meshes"][0]["primitives"] = [{**primitive, "material": i} for i in range(8)]
        self.put("one.bin", picture + b"\0" * 8)
        self.put("model.gltf", json.dumps(model).encode())
        self.assertEqual(self.survive_render("model.gltf: /images/1", "model.gltf"), 3)

        for i in range(8):
            self.put(f"{i}.png", picture)
        self.put("model.mtl", b"".join(b"newmtl %d\nmap_Kd %d.png\n" % (i, i) for i in range(8)))
        faces = "".join(f"usemtl {i}\nf 1/1 2/2 3/3\n" for i in range(8))
        self.put("model.obj", ("mtllib model.mtl\n" + SQUARE + faces).encode())
        self.assertEqual(self.survive_render("1.png", "model.obj"), 3)


class ThePublicCollection(MalformedTest):
    def test_every_public_scene_gives_a_picture_or_an_error_that_names_it(self):
        for path in public_files(SCENES):
            name = os.path.basename(path)
            legal = name.startswith("issue-295-")
            with self.subTest(scene=path):
                self.assertEqual(self.survive(name, "info", path, warns=not legal),
                                 self.survive_render(name, path, warns=not legal))

    def test_every_public_image_is_read_or_refused_in_every_use(self):
        for path in public_files(IMAGES):
            with self.subTest(image=path):
                self.use_image(path, warns=True)


if __name__ == "__main__":
    main()
