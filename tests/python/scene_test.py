"""Tests scenes that stay open: their pictures are those of scenes opened for each picture."""

import pathlib
import sys
import tempfile
import threading
import time
import unittest

import numpy

import pertev

from device_argument import DEVICE

sys.argv.pop(1)

# Each differs from the previous one in another setting.
PICTURES = [
    {},
    {},
    {"spp": 3},
    {"seed": 4},
    {"size": (20, 24)},
    {"eye": (0.2, 0.3, -0.7)},
    {"eye": (0.2, 0.3, -0.7), "target": (0.3, 0.2, 0), "fov": 60},
    {"max_depth": 2},
    {"integrator": "bidirectional"},
    {"integrator": "distributed", "aperture": None},
    {"integrator": "direct", "filter": "box"},
    {"layers": ["depth"]},
    {"transparent": True},
    {"denoise": "svgf"},
    {"environment": (1, 0, 0)},
    {"environment": (0, 1, 0)},
    {"device": DEVICE, "threads": 1},
    {"integrator": "radiosity", "patch_size": 0.2},
    {},
]
SMALL = {"size": (24, 16), "spp": 2}


class KeptScene(unittest.TestCase):
    def test_pictures_are_those_of_scenes_opened_for_each(self):
        scene = pertev.load("cornell-box")
        for values in PICTURES:
            with self.subTest(**values):
                kept, fresh = (pertev.render(of, **{**SMALL, **values}) for of in (scene, "cornell-box"))
                self.assertEqual(kept.hash, fresh.hash)
                self.assertEqual((kept.color == fresh.color).all(), True)
                self.assertEqual(kept.info["settings"], fresh.info["settings"])
                self.assertEqual({name: layer.tobytes() for name, layer in kept.layers.items()},
                                 {name: layer.tobytes() for name, layer in fresh.layers.items()})

    def test_a_scene_is_opened_once(self):
        scene = pertev.load("cornell-box")
        first = pertev.render(scene, **SMALL)
        other = pertev.render(scene, **SMALL, seed=1, eye=(0.2, 0.3, -0.7), max_memory=4096, no_bvh_cache=True)
        self.assertEqual(first.info["load_seconds"], other.info["load_seconds"]) # equal bits, so the scene was not read again
        with self.assertRaises(pertev.MemoryLimitError):
            pertev.render(scene, **SMALL, max_memory=0.01)
        again = pertev.render(scene, **SMALL, environment=(1, 1, 1))
        self.assertNotEqual(first.info["load_seconds"], again.info["load_seconds"])

    def test_a_call_costs_less_than_a_millisecond(self):
        scene = pertev.load("cornell-box", size=(8, 8), spp=1, integrator="direct", device=DEVICE)
        out = {"color": numpy.empty((8, 8, 3), numpy.float32)}
        for values in ({}, {"out": out}, {"eye": True}):
            costs = []
            for number in range(50):
                if "eye" in values: # a different one each time
                    values = {"eye": (0.1 + 0.001 * number, 0.3, -0.7), "target": (0, 0, 0)}
                begun = time.perf_counter()
                picture = pertev.render(scene, **values)
                costs.append(time.perf_counter() - begun - picture.seconds)
            self.assertLess(min(costs), 1e-3)

    def test_a_result_lists_the_defaults_of_its_picture(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "triangle.obj"
            file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
            scene = pertev.load(file)
            for values in ({"ground": "off"}, {"ground": "off", "eye": (0, 0, 2)}, {"ground": "off"}, {}):
                kept, fresh = (pertev.render(of, **SMALL, **values) for of in (scene, file))
                self.assertEqual(kept.hash, fresh.hash)
                self.assertEqual(kept.info["made_up"], fresh.info["made_up"])

    def test_settings_of_load_hold_for_all_pictures(self):
        for given in ({"environment": (1, 0, 0)}, {"environment": "0,1,0", "seed": 3}):
            self.assertEqual(pertev.render(pertev.load("cornell-box", **given), **SMALL).hash,
                             pertev.render("cornell-box", **SMALL, **given).hash)
        scene = pertev.load("cornell-box", max_depth=1, spp=1)
        self.assertEqual(pertev.render(scene, size=(8, 8)).hash,
                         pertev.render("cornell-box", size=(8, 8), max_depth=1, spp=1).hash)
        self.assertEqual(pertev.render(scene, size=(8, 8), max_depth=3).info["max_depth"], 3)

    def test_a_settings_file_overrides_the_settings_of_load(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "settings.json"
            file.write_text('{"version":1,"settings":{"max_depth":3}}')
            scene = pertev.load("cornell-box", max_depth=1, spp=1)
            self.assertEqual(pertev.render(scene, size=(8, 8), settings=file).info["max_depth"], 3)
            self.assertEqual(pertev.render(scene, size=(8, 8), settings=file, max_depth=2).info["max_depth"], 2)
            self.assertEqual(pertev.render(scene, size=(8, 8)).info["max_depth"], 1)

    def test_a_wrong_setting_leaves_the_scene_open(self):
        scene = pertev.load("cornell-box")
        before = pertev.render(scene, **SMALL)
        for wrong in ({"environment": "no-such-file.exr"}, {"displacement": "x=none.png", "integrator": "reyes"},
                      {"device": "cuda:99"}):
            with self.assertRaises(pertev.Error):
                pertev.render(scene, **SMALL, **wrong)
            after = pertev.render(scene, **SMALL)
            self.assertEqual(after.info["load_seconds"], before.info["load_seconds"])
            self.assertEqual(after.hash, before.hash)

    def test_an_error_leaves_the_scene_as_it_was(self):
        scene = pertev.load("cornell-box")
        before = pertev.render(scene, **SMALL)
        for wrong in ({"spp": 0}, {"camera": "none"}, {"eye": (0, 0, 0), "target": (0, 0, 0)}, {"device": "cuda:99"}):
            with self.assertRaises(pertev.Error):
                pertev.render(scene, **{**SMALL, **wrong})
        self.assertEqual(pertev.render(scene, **SMALL).hash, before.hash)

    def test_a_picture_has_the_hash_of_the_scene_that_was_read(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "[a].obj"
            file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
            scene = pertev.load(file)
            before = pertev.render(scene, **SMALL).info["scene_hash"]
            file.write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
            self.assertEqual(pertev.render(scene, **SMALL).info["scene_hash"], before)
            self.assertNotEqual(pertev.render(file, **SMALL).info["scene_hash"], before)

    def test_remarks_on_a_settings_file_are_separate_from_those_of_the_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "settings.json"
            file.write_text('{"version":1,"settings":{"sppp":3}}')
            scene = pertev.load("cornell-box")
            given = {**SMALL, "environment": (1, 1, 1)}
            self.assertEqual(len(pertev.render(scene, settings=file, **given).info["left_out"]), 1)
            self.assertEqual(pertev.render(scene, **given).info["left_out"], [])

    def test_load_raises_errors(self):
        with self.assertRaises(pertev.InputError):
            pertev.load("no-such-scene.glb")

    def test_threads_take_turns(self):
        scene = pertev.load("cornell-box")
        hashes = [None] * 6

        def work(number):
            hashes[number] = pertev.render(scene, **SMALL, seed=number % 2).hash

        threads = [threading.Thread(target=work, args=(number,)) for number in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(hashes[:2] * 3, hashes)
        self.assertNotEqual(hashes[0], hashes[1])


if __name__ == "__main__":
    unittest.main()
