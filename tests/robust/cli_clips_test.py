#!/usr/bin/env python3
"""Files with several animations, scenes or variants of materials: which one is shown, and how to choose them."""

import base64
import json
import os
import struct

from cli_lab_run import rows_of
from cli_run import CliTest, main, write

TINY = ["--size", "24x16", "--spp", "2", "--device", "cpu", "--exposure", "0"]

# Each moves node 0 (the last one changes the light's colour) from its position at 0 s to another one at its end.
CLIPS = [("go", (2, 0, 0), 2), ("rise", (0, 1, 0), 1), ("twin", (-1, 0, 0), 1), ("twin", (0, -1, 0), 4), (None, (1, 1, 0), 3),
         ("1", (-2, 0, 0), 1), ("dim", (0.25, 0, 0), 1)]


def gltf(clips, scenes=(("one", [0, 1, 2]),), shown=None):
    """A triangle that the clips move, a camera, a light, and another triangle."""
    numbers = struct.pack("<9f", -1, -1, 0, 1, -1, 0, 0, 1, 0)
    views, accessors, animations = [(0, 36)], [(3, "VEC3", {"min": [-1, -1, 0], "max": [1, 1, 0]})], []

    def add(kind, count, *values):
        nonlocal numbers
        views.append((len(numbers), 4 * len(values)))
        numbers += struct.pack(f"<{len(values)}f", *values)
        accessors.append((count, kind, {"min": [values[0]], "max": [values[-1]]} if kind == "SCALAR" else {}))
        return len(accessors) - 1

    for name, to, end in clips:
        times, values = add("SCALAR", 2, 0, end), add("VEC3", 2, *((0, 0, 0) if name != "dim" else (1, 1, 1)), *to)
        target = {"node": 0, "path": "translation"}
        if name == "dim":
            target = {"path": "pointer", "extensions": {"KHR_animation_pointer": {
                "pointer": "/extensions/KHR_lights_punctual/lights/0/color"}}}
        animations.append({"samplers": [{"input": times, "output": values}],
                           "channels": [{"sampler": 0, "target": target}], **({"name": name} if name else {})})
    uri = "data:application/octet-stream;base64," + base64.b64encode(numbers).decode()
    return json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_lights_punctual", "KHR_animation_pointer"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 3}]}},
        **({} if shown is None else {"scene": shown}),
        "scenes": [{"nodes": nodes, **({"name": name} if name else {})} for name, nodes in scenes],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]},
                  {"extensions": {"KHR_lights_punctual": {"light": 0}}},
                  {"mesh": 0, "scale": [0.5, 1, 1]}, {"mesh": 0, "translation": [0.5, 0, 0]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        **({"animations": animations} if animations else {}),
        "accessors": [{"bufferView": view, "componentType": 5126, "count": count, "type": kind, **limits}
                      for view, (count, kind, limits) in enumerate(accessors)],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
        "buffers": [{"byteLength": len(numbers), "uri": uri}]})


class Clips(CliTest):
    def setUp(self):
        super().setUp()
        write(self.path("m.gltf"), gltf(CLIPS))
        for number, clip in enumerate(CLIPS):
            write(self.path(f"alone-{number}.gltf"), gltf([clip]))

    def hash_at(self, *arguments, scene="m.gltf"):
        return self.succeed("render", scene, "-o", "one.png", *TINY, "--json", *arguments).events("done")[0]["hash"]

    def test_the_chosen_animation_plays_or_the_first_by_default(self):
        alone = [self.hash_at("--time", "0.5", scene=f"alone-{number}.gltf") for number in range(len(CLIPS))]
        self.assertEqual(len(set(alone)), len(CLIPS))
        self.assertEqual(self.hash_at("--time", "0.5"), alone[0])
        for words, number in [("go", 0), ("0", 0), ("rise", 1), ("2", 2), ("3", 3), ("4", 4), ("1", 5), ("5", 5), ("dim", 6)]:
            self.assertEqual(self.hash_at("--time", "0.5", "--animation", words), alone[number], words)
        together = self.hash_at("--time", "0.5", "--animation", "all")
        self.assertNotIn(together, alone)
        write(self.path("last.gltf"), gltf(CLIPS[5:]))  # among animations of one property the later one counts
        self.assertEqual(self.hash_at("--time", "0.5", "--animation", "all", scene="last.gltf"), together)
        self.assertEqual(self.hash_at("--animation", "all"), self.hash_at())  # nothing plays at rest

    def test_the_error_for_an_unknown_animation_lists_the_known_ones(self):
        write(self.path("still.gltf"), gltf([]))
        write(self.path("floor.obj"), "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
        for words, says in [("jump", ["--animation jump: ", "go", "rise", "2 (twin)", "3 (twin)", "4"]), ("7", ["--animation 7: "]),
                            ("twin", ["--animation twin: ", "2 (twin)", "3 (twin)"]), ("-1", ["--animation -1: "])]:
            self.refuse(2, "render", "m.gltf", "-o", "x.png", *TINY, "--time", "1", f"--animation={words}", says=["m.gltf", *says])
        for scene in ["still.gltf", "floor.obj", "cornell-box"]:
            for words in ["go", "0", "all"]:
                self.refuse(2, "render", scene, "-o", "x.png", *TINY, "--animation", words, says=[scene, "--animation"])
        self.refuse(2, "render", "m.gltf", "-o", "x.png", "--animation", "", says=["--animation"])

    def test_a_notice_names_the_animation_that_plays_by_default(self):
        def notices(about, *arguments, scene="m.gltf"):
            return [event["reason"] for event in self.remarks("render", scene, "-o", "x.png", *TINY, *arguments, about=about)]

        (which,) = notices("animation", "--time", "1")
        self.assertRegex(which, r"\b7\b.*\bgo\b.*2 \(twin\), 3 \(twin\), 4, 1, dim")
        self.assertEqual(notices("animation", "--time", "1", "--animation", "rise"), [])
        self.assertEqual(notices("animation", "--time", "1", scene="alone-0.gltf"), [])
        for arguments, end in [([], 2), (["--animation", "4"], 3), (["--animation", "all"], 4)]:
            (times,) = notices("time", *arguments)
            self.assertIn(f"0 to {end} s", times)
        told = self.info("m.gltf")
        self.assertEqual(told["animations"], ["go (2 s)", "rise (1 s)", "2 (twin) (1 s)", "3 (twin) (4 s)", "4 (3 s)", "1 (1 s)",
                                              "dim (1 s)"])
        self.assertEqual(told["plays"], "go")
        alone = self.info("alone-1.gltf")
        self.assertEqual((alone["animations"], "plays" in alone), (["rise (1 s)"], False))

    def test_metadata_name_the_animation_to_reproduce_the_picture(self):
        def made(*arguments):
            end = self.succeed("render", "m.gltf", "-o", "x.exr", *TINY[:-2], "--time", "0.5", "--json", *arguments).events("done")[0]
            return end["hash"], self.info("x.exr").get("pertev.animation")

        for words, told in [([], "go"), (["--animation", "rise"], "rise"), (["--animation", "3"], "3"), (["--animation", "5"], "1"),
                            (["--animation", "all"], "all")]:
            first = made(*words)
            self.assertEqual(first[1], told)
            self.assertEqual(made("--animation", told), first)
        self.succeed("render", "alone-0.gltf", "-o", "y.exr", *TINY[:-2], "--time", "1")
        self.assertNotIn("pertev.animation", self.info("y.exr"))

    def test_frames_continue_only_with_the_same_animation(self):
        frames = ["render", "m.gltf", "-o", "f-#.png", *TINY, "--fps", "2"]
        first = self.succeed(*frames, "--frames", "0-1", "--json").events("frame")
        self.assertEqual(first[1]["hash"], self.hash_at("--time", "0.5", scene="alone-0.gltf"))
        for words in ["rise", "all"]:
            self.refuse(2, *frames, "--frames", "0-2", "--continue", "--animation", words, says=["--animation", '"go"', f'"{words}"'])
        for words in [[], ["--animation", "go"], ["--animation", "0"]]:  # name and number choose the same animation
            end = self.succeed(*frames, "--frames", "0-2", "--continue", "--json", *words).events("sequence")[0]
            self.assertEqual(end["written"] + end["kept"], 3)

    def test_measure_and_solve_use_the_chosen_animation(self):
        at = ["--at", "0,0,-1", "--normal", "0,0,1", "--spp", "4", "--device", "cpu", "--json"]

        def measured(scene, *arguments):
            return self.succeed("measure", scene, *at, *arguments).events("measure")[0]["irradiance"]["value"]

        alone = [measured(f"alone-{number}.gltf", "--time", "1") for number in [0, 6]]
        self.assertEqual(measured("m.gltf", "--time", "1"), alone[0])
        self.assertEqual(measured("m.gltf", "--time", "1", "--animation", "dim"), alone[1])

        def solved(scene, *arguments):
            self.succeed("solve", "radiosity", scene, "-o", "x.rad", "--time", "0.5", "--patch-rays", "16", *arguments)
            return [self.info("x.rad")[name] for name in ["hash", "geometry"]]

        lit = ["--environment", "1,1,1"]
        alone = [solved(f"alone-{number}.gltf", *lit) for number in [0, 1]]
        self.assertEqual(solved("m.gltf", *lit), alone[0])
        self.assertEqual(solved("m.gltf", *lit, "--animation", "rise"), alone[1])
        self.assertNotEqual(*alone)

    def test_benchmarks_of_frames_use_the_chosen_animation(self):
        bench = ["bench", "sequence", "m.gltf", "--frames", "0-2", "--fps", "4", "--size", "24x16", "--device", "cpu", "--json"]
        plain, first, other = [self.succeed(*bench, *words).events("sequence_errors")[0]["last_frame"]
                               for words in [[], ["--animation", "go"], ["--animation", "rise"]]]
        self.assertEqual(plain, first)
        self.assertNotEqual(plain, other)


class FileScenes(CliTest):
    SCENES = (("one", [0, 1, 2]), ("two", [3, 1, 2]), (None, [4, 1, 2]))

    def setUp(self):
        super().setUp()
        write(self.path("m.gltf"), gltf([], self.SCENES))
        write(self.path("second.gltf"), gltf([], self.SCENES, shown=1))
        for number, scene in enumerate(self.SCENES):
            write(self.path(f"alone-{number}.gltf"), gltf([], [scene]))

    def hash_of(self, scene, *arguments):
        return self.succeed("render", scene, "-o", "one.exr", *TINY[:-2], "--json", *arguments).events("done")[0]["hash"]

    def test_a_scene_of_the_file_is_chosen_by_name_or_number(self):
        alone = [self.hash_of(f"alone-{number}.gltf") for number in range(3)]
        self.assertEqual(len(set(alone)), 3)
        self.assertNotIn("pertev.file_scene", self.info("one.exr"))
        self.assertEqual((self.hash_of("m.gltf"), self.hash_of("second.gltf")), (alone[0], alone[1]))
        for words, number, told in [("one", 0, "one"), ("1", 1, "two"), ("two", 1, "two"), ("2", 2, "2")]:
            self.assertEqual(self.hash_of("second.gltf", "--file-scene", words), alone[number], words)
            self.assertEqual(self.info("one.exr")["pertev.file_scene"], told)

    def test_a_notice_names_the_scene_that_is_shown_and_an_unknown_one_is_refused(self):
        (shown,) = self.remarks("render", "second.gltf", "-o", "x.png", *TINY, about="file_scene")
        self.assertRegex(shown["reason"], r"\b3\b.* one, two, 2")
        self.assertEqual(self.remarks("render", "m.gltf", "-o", "x.png", *TINY, "--file-scene", "0", about="file_scene"), [])
        self.refuse(2, "render", "m.gltf", "-o", "y.png", "--file-scene", "three", says=["m.gltf: --file-scene three: ", "one", "two"])
        self.refuse(2, "render", "cornell-box", "-o", "y.png", "--file-scene", "three", says=["cornell-box: --file-scene three: "])
        write(self.path("floor.obj"), "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
        self.refuse(2, "info", "floor.obj", "--file-scene", "0", says=["floor.obj", "--file-scene"])
        self.refuse(2, "info", "x.png", "--file-scene", "0", says=["--file-scene", "x.png"])

    def test_info_and_lab_use_the_chosen_scene_of_the_file(self):
        told = self.info("second.gltf")
        self.assertEqual((told["file_scenes"], told["shows"]), (["one", "two", "2"], "two"))
        self.assertEqual(told["bounds_high"], [0.5, 1, 0])
        told = self.succeed("info", "second.gltf", "--file-scene", "2", "--json").events("info")[0]
        self.assertEqual((told["shows"], told["bounds_high"]), ("2", [1.5, 1, 0]))
        self.assertNotIn("file_scenes", self.info("alone-0.gltf"))
        lab = ["lab", "second.gltf", "--structures", "binned", "--traversals", "if-if", "--runs", "1", "--device", "cpu", "--size",
               "16x12", "--rays", "primary", "--json"]
        shares = [rows_of(self.succeed(*lab, *words).events("lab")[0], "sets")[0]["hit_share"] for words in [[], ["--file-scene", "one"]]]
        self.assertLess(*shares)
        self.refuse(2, "lab", "forest", "--file-scene", "one", "--device", "cpu", says=["--file-scene"])

    def test_frames_continue_only_with_the_same_scene_of_the_file(self):
        frames = ["render", "m.gltf", "-o", "f-#.png", *TINY, "--turntable", "2"]
        self.succeed(*frames)
        self.refuse(2, *frames, "--continue", "--file-scene", "two", says=["--file-scene", '"one"', '"two"'])
        self.succeed(*frames, "--continue", "--file-scene", "0")
        self.assertTrue(os.path.exists(self.path("f-1.png")))


class Variants(CliTest):
    def setUp(self):
        super().setUp()
        colors = {"day": (0.9, 0.8, 0.1), "night": (0.1, 0.1, 0.7)}
        document = json.loads(gltf([]))
        document["materials"] += [{"name": name, "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [*color, 1]}}
                                  for name, color in colors.items()]
        primitive = document["meshes"][0]["primitives"][0]
        for number, name in enumerate(colors, 1):
            primitive["material"] = number
            write(self.path(f"{name}.gltf"), json.dumps(document))
        primitive["material"] = 0
        document["extensionsUsed"].append("KHR_materials_variants")
        document["extensions"]["KHR_materials_variants"] = {"variants": [{"name": name} for name in colors]}
        primitive["extensions"] = {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}, {"material": 2, "variants": [1]}]}}
        write(self.path("m.gltf"), json.dumps(document))

    def test_a_variant_of_the_materials_is_chosen_by_name_or_number_and_an_unknown_one_is_refused_with_the_list(self):
        def hash_of(scene, *arguments):
            return self.succeed("render", scene, "-o", "one.exr", *TINY[:-2], "--json", *arguments).events("done")[0]["hash"]

        day, night, default = hash_of("day.gltf"), hash_of("night.gltf"), hash_of("m.gltf")
        self.assertEqual(len({day, night, default}), 3)
        self.assertNotIn("pertev.variant", self.info("one.exr"))
        for words, expected, told in [("day", day, "day"), ("1", night, "night")]:
            self.assertEqual(hash_of("m.gltf", "--variant", words), expected)
            self.assertEqual(self.info("one.exr")["pertev.variant"], told)
        self.assertEqual(self.info("m.gltf")["variants"], ["day", "night"])
        (shown,) = self.remarks("render", "m.gltf", "-o", "x.png", *TINY, about="variant")
        self.assertRegex(shown["reason"], "day, night")
        self.refuse(2, "render", "m.gltf", "-o", "y.png", "--variant", "dusk", says=["m.gltf: --variant dusk: ", "day", "night"])
        self.refuse(2, "render", "cornell-box", "-o", "y.png", "--variant", "day", says=["cornell-box: --variant day: "])
        frames = ["render", "m.gltf", "-o", "f-#.png", *TINY, "--turntable", "2"]
        self.succeed(*frames, "--variant", "day")
        self.refuse(2, *frames, "--continue", "--variant", "night", says=["--variant", '"day"', '"night"'])
        self.succeed(*frames, "--continue", "--variant", "0")


if __name__ == "__main__":
    main()
