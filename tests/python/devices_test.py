"""Tests pictures by several devices: arrays, layers, parts and files have the bytes of one device."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

import pertev

PROGRAM = sys.argv.pop(1)
SMALL = {"size": (20, 16), "spp": 5}
LAYERS = ["depth", "normal", "ids"]


class Devices(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.one = pertev.load("cornell-box", device="cpu")
        cls.two = pertev.load("cornell-box", device="cpu,cpu")

    def both(self, call):
        """Returns what the call gives with one device and with two."""
        return call(self.one), call(self.two)

    def test_pictures_have_the_bytes_of_one_device_and_of_the_program(self):
        for more in ({}, {"layers": LAYERS}, {"layers": LAYERS, "layers_at": "centre"}, {"transparent": True}, {"lpe": ["direct=LDE"]},
                     {"integrator": "photon_map"}, {"integrator": "bidirectional"}, {"spp": None, "samples": (2, 5)}, {"rows": (3, 9)}):
            with self.subTest(more):
                a, b = self.both(lambda scene, more=more: pertev.render(scene, **{**SMALL, **more}))
                self.assertEqual((a.hash, a.info["hash"]), (b.hash, b.info["hash"]))
                self.assertEqual(a.layers.keys(), b.layers.keys())
                for name, layer in a.layers.items():
                    numpy.testing.assert_array_equal(b.layers[name], layer)
        picture = pertev.render(self.two, **SMALL)
        self.assertEqual(picture.info["device"], "2 x " + pertev.render(self.one, **SMALL).info["device"])
        folder = self.enterContext(tempfile.TemporaryDirectory())
        said = subprocess.run([PROGRAM, "render", "cornell-box", "-o", f"{folder}/x.exr", "--size", "20x16", "--spp", "5", "--device", "cpu,cpu"],
                              check=True, capture_output=True, text=True)
        self.assertIn(picture.hash, said.stdout + said.stderr)

    def test_arrays_of_the_caller_are_filled(self):
        out = {"color": numpy.zeros((16, 20, 3), numpy.float32), "depth": numpy.zeros((16, 20), numpy.float32),
               "ids": numpy.zeros((16, 20, 3), numpy.uint32)}
        filled = pertev.render(self.two, **SMALL, layers=LAYERS, out=out)
        alone = pertev.render(self.one, **SMALL, layers=LAYERS)
        self.assertEqual(filled.hash, alone.hash)
        self.assertIs(filled.color, out["color"])
        for name, array in out.items():
            numpy.testing.assert_array_equal(array, getattr(alone, name))

    def test_pictures_and_batches_in_turn_have_the_bytes_of_one_device(self):
        """A batch is divided by pictures, and a picture by samples: neither disturbs the other."""
        poses = numpy.tile(numpy.eye(4), (3, 1, 1))
        poses[:, :3, :3] = numpy.diag([-1, 1, -1])
        poses[:, :3, 3] = [[0.2, 0.273, -0.8], [0.278, 0.273, -0.8], [0.3, 0.273, -0.8]]
        for integrator in ("path", "photon_map"):
            for _ in range(2):
                a, b = self.both(lambda scene: pertev.render(scene, **SMALL, integrator=integrator).hash)
                self.assertEqual(a, b)
                a, b = self.both(lambda scene: pertev.render(scene, cameras=poses, **SMALL, integrator=integrator).hash)
                self.assertEqual((a, len(set(a))), (b, 3))

    def test_changes_of_the_scene_reach_all_devices(self):
        one, two = (pertev.load("cornell-box", device=device) for device in ("cpu", "cpu,cpu"))
        before = pertev.render(two, **SMALL).hash
        for path in [next(path for path in two.params if path.endswith("base_color")), next(path for path in two.params if path.endswith("transform"))]:
            value = two.params[path]
            value = value * 0.5 if value.ndim == 1 else value + 0.05 * numpy.eye(4)[:, :1] @ [[0, 0, 0, 1]]
            for scene in (one, two):
                scene.params[path] = value
            after = pertev.render(two, **SMALL).hash
            self.assertEqual(after, pertev.render(one, **SMALL).hash)
            self.assertNotEqual(after, before)
            before = after

    def test_parts_and_checkpoints_have_the_bytes_of_one_device(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        whole = pertev.render(self.one, **SMALL, output=folder / "one.exr")
        pertev.render(self.two, **SMALL, output=folder / "two.exr")
        self.assertTrue(pertev.compare(folder / "one.exr", folder / "two.exr")["equal"])
        files = [folder / "1.pvf", folder / "2.pvf"]
        for i, (scene, file) in enumerate(zip((self.two, self.one), files), 1):
            pertev.render(scene, **SMALL, part=(i, 2), output=file)
        self.assertEqual(pertev.merge(files).hash, whole.hash)
        pertev.render(self.two, **{**SMALL, "spp": 3}, checkpoint=folder / "c.pvf")
        for scene in (self.one, self.two):
            self.assertEqual(pertev.render(scene, **SMALL, checkpoint=folder / "c.pvf").hash, whole.hash)

    def test_a_denoised_picture_has_the_bytes_of_one_device(self):
        together, alone = (pertev.render(scene, **SMALL, denoise="svgf") for scene in (self.two, self.one))
        self.assertTrue((together.color == alone.color).all())


if __name__ == "__main__":
    unittest.main()
