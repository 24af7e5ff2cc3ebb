#!/usr/bin/env python3
"""A file that is opened without flags gets a default light, ground and view if it has none."""

import base64
import json
import math
import struct
import zlib

from cli_run import CliTest, main, read_exr, write

BACKGROUND = 4294967295


def png(value):
    """Returns one grey pixel of `value` out of 255."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", 1, 1, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(bytes([0, value]))) + chunk(b"IEND", b""))


def quad(corners):
    return [*corners[0], *corners[1], *corners[2], *corners[0], *corners[2], *corners[3]]


def box(half, at):
    """Returns the six sides of a box, facing outwards."""
    numbers = []
    for axis in range(3):
        for sign in (-1, 1):
            u, v = [0, 0, 0], [0, 0, 0]
            u[(axis + 1) % 3], v[(axis + 2) % 3] = half, half * sign
            middle = [0, 0, 0]
            middle[axis] = half * sign
            corners = [[at[k] + middle[k] + a * u[k] + b * v[k] for k in range(3)]
                       for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            numbers += quad(corners)
    return numbers


def gltf(parts, cameras=()):
    """Writes a mesh for each (vertex indices of triangles, material), and cameras that look along -z."""
    file = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "materials": [], "accessors": [], "bufferViews": [], "buffers": [], "textures": [{"source": 0}],
            "images": [{"uri": "data:image/png;base64," + base64.b64encode(png(255)).decode()}]}
    for number, (numbers, material) in enumerate(parts):
        data = struct.pack("<%df" % len(numbers), *numbers)
        file["buffers"].append({"byteLength": len(data), "uri": "data:application/octet-stream;base64," +
                                base64.b64encode(data).decode()})
        file["bufferViews"].append({"buffer": number, "byteLength": len(data)})
        file["accessors"].append({"bufferView": number, "componentType": 5126, "count": len(numbers) // 3, "type": "VEC3",
                                  "min": [min(numbers[k::3]) for k in range(3)],
                                  "max": [max(numbers[k::3]) for k in range(3)]})
        file["materials"].append(material)
        file["meshes"].append({"primitives": [{"attributes": {"POSITION": number}, "material": number}]})
        file["nodes"].append({"mesh": number})
    if cameras:
        file["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}]
        file["nodes"] += [{"camera": 0, "translation": list(place)} for place in cameras]
    file["scenes"][0]["nodes"] = list(range(len(file["nodes"])))
    return json.dumps(file)


GREY = {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}
LAMP = {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}, "emissiveFactor": [1, 1, 1]}
TEXTURED_LAMP = {**LAMP, "emissiveTexture": {"index": 0}}


def lamp_above(y, half):
    """A square that faces down."""
    return quad([(-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)])


class FirstView(CliTest):
    def measured(self, scene):
        told = self.succeed("measure", scene, "--at", "0,0.001,0", "--normal", "0,1,0", "--max-depth", "0", "--spp", "4",
                            "--device", "cpu", "--json").events("measure")[0]
        return told["irradiance"]["value"]

    def seen(self, scene, *arguments, output="x.exr", size="48x48", spp=4):
        self.succeed("render", scene, "-o", output, "--size", size, "--spp", spp, "--device", "cpu", *arguments)
        return read_exr(self.path(output))[2]

    def share_of_black(self, layers):
        dark = [all(layers[c][y][x] < 1e-4 for c in "RGB") for y in range(48) for x in range(48)]
        return sum(dark) / len(dark)

    def test_a_textured_emitter_lights_a_scene_without_a_default_sky(self):
        floor = quad([(-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)])
        # The result is radiance 1 times the form factor of a square of 2 m from 1 m above its centre.
        right = 4 * math.sqrt(0.5) * math.atan(math.sqrt(0.5))
        for name, lamp in (("plain.gltf", LAMP), ("textured.gltf", TEXTURED_LAMP)):
            write(self.path(name), gltf([(floor, GREY), (lamp_above(1, 1), lamp)]))
            self.assertAlmostEqual(self.measured(name), right, delta=0.01)

    def test_a_scene_with_too_weak_an_emitter_gets_a_default_sky_from_any_camera(self):
        lamp = [x for corner in (0, 2, 1) for x in ((-.01, .501, -.01), (.01, .501, -.01), (.01, .501, .01))[corner]]
        write(self.path("body.gltf"), gltf([(box(0.5, (0, 0, 0)), GREY), (lamp, LAMP)]))
        for more in ([], ["--eye", "3,2,1", "--target", "0,0,0"], ["--seed", "7", "--max-depth", "1"]):
            layers = self.seen("body.gltf", *more)
            self.assertEqual(self.info("x.exr")["pertev.environment"], "made up")
            self.assertLess(self.share_of_black(layers), 0.01)
        said = self.succeed("render", "body.gltf", "-o", "f##.exr", "--turntable", "2", "--size", "16x16", "--spp", "1",
                            "--device", "cpu", "--json")
        self.assertTrue(any("light too little" in notice["text"] for notice in said.events("notice")))
        self.assertEqual(self.info("f01.exr")["pertev.environment"], "made up")
        self.assertEqual(self.measured("body.gltf"), 0)
        self.seen("body.gltf", "--environment", "0,0,0")
        self.assertEqual(self.info("x.exr")["pertev.environment"], [0, 0, 0])

    def test_the_default_ground_counts_as_background_in_all_layers(self):
        write(self.path("body.gltf"), gltf([(box(0.5, (7, 9, 0)), GREY)]))
        aovs = ["--aov", "ids,depth,normal,position,albedo"]
        on, off = self.seen("body.gltf", *aovs), self.seen("body.gltf", *aovs, "--ground", "off", output="off.exr")
        self.assertEqual(self.info("x.exr")["pertev.ground"], "on")
        self.assertNotIn("pertev.ground", self.info("off.exr"))
        for layer in on:
            if layer not in "RGB":
                self.assertEqual(on[layer], off[layer], layer)
        ids = {value for row in on["id.instance"] for value in row}
        self.assertEqual(ids, {0, BACKGROUND})
        # The object's shadow darkens the ground, and no pixel is brighter.
        darker = sum(on["G"][y][x] < 0.8 * off["G"][y][x] for y in range(48) for x in range(48)
                     if on["id.instance"][y][x] == BACKGROUND)
        self.assertGreater(darker, 20)

    def test_a_default_ground_is_added_only_with_a_default_camera_and_light(self):
        write(self.path("body.gltf"), gltf([(box(0.5, (0, 0, 0)), GREY)]))
        write(self.path("seen.gltf"), gltf([(box(0.5, (0, 0, 0)), GREY)], cameras=[(0, 0, 3)]))
        for scene, more, has_ground in (("body.gltf", [], True), ("body.gltf", ["--environment", "1,1,1"], False),
                                        ("body.gltf", ["--eye", "2,1,2"], False), ("seen.gltf", [], False),
                                        ("seen.gltf", ["--ground", "on"], True), ("body.gltf", ["--transparent"], False)):
            self.seen(scene, *more, size="8x8", spp=1)
            self.assertEqual("pertev.ground" in self.info("x.exr"), has_ground, (scene, more))


if __name__ == "__main__":
    main()
