"""Tests what a BatchResult says of its pictures, and cameras of files."""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy

import pertev

from device_argument import DEVICE

PROGRAM = sys.argv.pop(1)
SMALL = {"size": (20, 16), "spp": 2}
POSES = numpy.tile(numpy.eye(4), (3, 1, 1))
POSES[:, :3, :3] = numpy.diag([-1, 1, -1])
POSES[:, :3, 3] = [[0.2, 0.273, -0.8], [0.278, 0.273, -0.8], [0.3, 0.273, -0.8]]
K = [[22, 0, 10], [0, 22, 8], [0, 0, 1]]
OF_A_RUN = {"render_seconds", "load_seconds", "build_seconds", "rays", "invalid_samples"}


def host(array):
    return array.numpy() if isinstance(array, pertev.DeviceArray) else array


class Batches(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = pertev.load("cornell-box", device=DEVICE)

    def test_each_picture_has_the_hash_and_the_metadata_of_a_single_render(self):
        for more in ({}, {"integrator": "photon_map"}, {"denoise": "svgf"}, {"layers": ["ids"], "layers_at": "centre"}, {"transparent": True}):
            with self.subTest(more):
                batch = pertev.render(self.scene, cameras=pertev.Cameras(POSES, K), seeds=[4, 5, 6], **SMALL, **more)
                alone = [pertev.render(self.scene, camera_pose=pose.ravel(), intrinsics=numpy.ravel(K), seed=seed, **SMALL, **more)
                         for pose, seed in zip(POSES, (4, 5, 6))]
                self.assertEqual(batch.hash, [picture.hash for picture in alone])
                self.assertEqual([info["hash"] for info in batch.info], batch.hash)
                for info, picture in zip(batch.info, alone):
                    expected = {name: value for name, value in picture.info.items() if name not in OF_A_RUN}
                    self.assertEqual({name: value for name, value in info.items() if name not in OF_A_RUN}, expected)
                    self.assertFalse({"rays", "render_seconds"} & info.keys())
        self.assertEqual(len(set(batch.hash)), 3)

    def test_a_thread_reads_what_another_fills_in_turn(self):
        batch = pertev.BatchResult()
        self.assertEqual((len(batch), batch.seconds, batch.samples, batch.hash, batch.arrays), (0, 0, 0, [], {}))
        first = threading.Thread(target=lambda: pertev.render(self.scene, cameras=POSES, seeds=1, out=batch, size=(100, 80), spp=16))
        first.start()
        while first.is_alive():  # nothing of a batch is there before all of it
            self.assertIn((len(batch), batch.seconds > 0), ((0, False), (3, True), (0, True)))
            self.assertIn(repr(batch).split("of ")[1], ("0 pictures 0x0>", "3 pictures 100x80>"))
        first.join()
        batch = pertev.render(self.scene, cameras=POSES, seeds=1, **SMALL)
        states = [pertev.render(self.scene, cameras=POSES, seeds=seed, **SMALL).hash for seed in (1, 2)]
        done = threading.Event()

        def fill():
            for seed in (2, 1) * 20:
                pertev.render(self.scene, cameras=POSES, seeds=seed, out=batch, **SMALL)
            done.set()

        thread = threading.Thread(target=fill)
        thread.start()
        while not done.is_set():
            self.assertIn(batch.hash, states)
            seed, hashes = zip(*((int(info["seed"]), info["hash"]) for info in batch.info))
            self.assertEqual(list(hashes), states[seed[0] - 1])
            self.assertEqual(batch.picture(1).hash in (states[0][1], states[1][1]), True)
        thread.join()
        self.assertEqual(batch.hash, states[0])

    def test_a_single_picture_on_the_device_has_those_of_a_result(self):
        picture = pertev.render(self.scene, layers="ids", **SMALL)
        on_device = pertev.render(self.scene, layers="ids", on_device=True, **SMALL)
        self.assertEqual(on_device.hash, picture.hash)
        self.assertEqual({name: value for name, value in on_device.info.items() if not name.endswith("_seconds")},
                         {name: value for name, value in picture.info.items() if not name.endswith("_seconds")})
        self.assertIn("instances", on_device.info)

    def test_seeds_and_chunks_are_integers_of_any_kind(self):
        def render(**values):
            return pertev.render(self.scene, cameras=POSES, **values, **SMALL).hash

        expected = render(seeds=[3])
        self.assertNotEqual(render(), expected)
        for one in (3, numpy.int64(3), numpy.uint8(3), numpy.array(3), numpy.array([3])):
            with self.subTest(repr(one)):
                self.assertEqual(render(seeds=one), expected)
                for chunk in (2, numpy.int32(2), numpy.array(2)):
                    parts = list(pertev.render_chunks(self.scene, POSES, chunk=chunk, seeds=one, **SMALL))
                    self.assertEqual([len(part) for part in parts], [2, 1])
                    self.assertEqual([hash for part in parts for hash in part.hash], expected)
                self.assertEqual(pertev.render(self.scene, on_device=True, seeds=one, **SMALL).hash,
                                 pertev.render(self.scene, seed=3, **SMALL).hash)
        for wrong in (3.5, numpy.float32(3), numpy.array(3.0), [1, 2], -1, 2**32):
            with self.subTest(repr(wrong)):
                for call in (lambda: render(seeds=wrong), lambda: list(pertev.render_chunks(self.scene, POSES, seeds=wrong, **SMALL)),
                             lambda: pertev.render(self.scene, on_device=True, seeds=wrong, **SMALL)):
                    with self.assertRaises(pertev.InputError) as caught:
                        call()
                    self.assertIn(caught.exception.setting, ("seed", "seeds"))

    def test_sizes_of_cameras_are_integers_of_any_kind(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        frames = [{"file_path": "a", "transform_matrix": POSES[0].tolist()}]
        (folder / "transforms.json").write_text(json.dumps({"frames": frames, "camera_angle_x": 0.8}))
        K = [pertev.read_cameras(folder / "transforms.json", size=size).K.tolist()
             for size in ((20, 16), numpy.array([20, 16]), (numpy.int64(20), numpy.uint16(16)))]
        self.assertEqual(K, K[:1] * 3)

    def test_a_hash_is_that_of_the_array_as_it_is(self):
        batch = pertev.render(self.scene, cameras=POSES, **SMALL)
        before = batch.hash
        self.assertEqual(batch.hash, before)
        if isinstance(batch.color, numpy.ndarray):  # only other libraries write into arrays of a device
            batch.color[1, 0, 0, 0] += 1
            self.assertEqual([a == b for a, b in zip(batch.hash, before)], [True, False, True])
        self.assertEqual(batch.info[1]["hash"], batch.hash[1])
        pertev.render(self.scene, cameras=POSES[::-1], out=batch, **SMALL)
        self.assertEqual(batch.hash, before[::-1])

    def test_a_single_picture_on_the_device_is_used_as_a_result(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        for more in ({"layers": ["ids", "depth"]}, {"denoise": "svgf"}, {"transparent": True}):
            with self.subTest(more):
                picture = pertev.render(self.scene, **SMALL, **more)
                on_device = pertev.render(self.scene, on_device=True, **SMALL, **more)
                self.assertEqual(on_device._repr_png_(), picture._repr_png_())
                for name in ("pose", "K", "samples", "hash"):
                    self.assertTrue(numpy.array_equal(getattr(on_device, name), getattr(picture, name)), name)
                for name in ("color", "noisy"):
                    self.assertEqual(host(getattr(on_device, name)).tobytes(), getattr(picture, name).tobytes())
                self.assertEqual(pertev.tone_map(on_device).tobytes(), pertev.tone_map(picture).tobytes())
                self.assertTrue(pertev.compare(on_device, picture)["equal"])
                pertev.write(folder / "a.exr", on_device)
                pertev.write(folder / "b.exr", picture)
                info = [self.of_file(folder / name) for name in ("a.exr", "b.exr")]
                self.assertEqual(info[0], info[1])
                pertev.write(folder / "a.png", on_device)
                pertev.write(folder / "b.png", picture)
                self.assertEqual((folder / "a.png").read_bytes(), (folder / "b.png").read_bytes())
                copy = on_device.picture()
                self.assertIsInstance(copy, pertev.Result)
                self.assertEqual((copy.hash, copy.noisy.tobytes(), set(copy.layers)), (picture.hash, picture.noisy.tobytes(), set(picture.layers)))
                for name, layer in picture.layers.items():
                    self.assertEqual(copy.layers[name].tobytes(), layer.tobytes())

    def of_file(self, file):
        """Returns what the program says of an EXR, without seconds and its name."""
        line = subprocess.run([PROGRAM, "info", file, "--json"], check=True, capture_output=True, text=True).stdout
        return {name: value for name, value in json.loads(line).items() if not name.endswith("_seconds") and name != "file"}

    def test_pictures_of_a_batch_are_taken_out_as_results(self):
        batch = pertev.render(self.scene, cameras=pertev.Cameras(POSES, K), seeds=[4, 5, 6], layers="depth", denoise="svgf", **SMALL)
        self.assertTrue(numpy.allclose(batch.pose, POSES, atol=1e-6))
        self.assertTrue(numpy.allclose(batch.K, [K] * 3))
        self.assertEqual(batch.samples, 2)
        self.assertNotEqual(host(batch.color).tobytes(), host(batch.noisy).tobytes())
        for number, of in ((0, 0), (2, 2), (-1, 2)):
            alone = pertev.render(self.scene, camera_pose=POSES[of].ravel(), intrinsics=numpy.ravel(K), seed=4 + of, layers="depth", denoise="svgf", **SMALL)
            picture = batch.picture(number)
            for name in ("color", "noisy", "depth", "pose", "K", "hash", "samples"):
                self.assertTrue(numpy.array_equal(getattr(picture, name), getattr(alone, name)), name)
            self.assertEqual({name: value for name, value in picture.info.items() if name not in OF_A_RUN},
                             {name: value for name, value in alone.info.items() if name not in OF_A_RUN})
        self.assertEqual(batch.picture(numpy.int8(2)).hash, batch.picture(number=2).hash)
        for number in (1.5, "1", None):
            with self.assertRaisesRegex(TypeError, "^number: "):
                batch.picture(number)
        for number in (3, -4, 2**80):
            with self.assertRaises(IndexError):
                batch.picture(number)
        self.assertTrue(batch._repr_png_().startswith(b"\x89PNG"))
        self.assertEqual(struct.unpack(">II", batch._repr_png_()[16:24]), (40, 32))  # two rows of two
        for call in (lambda: pertev.write("x.png", batch), lambda: pertev.tone_map(batch), lambda: pertev.compare(batch, batch)):
            with self.assertRaises(pertev.InputError) as caught:
                call()
            self.assertEqual(caught.exception.setting, "picture")

    def test_arrays_that_are_filled_again_without_denoising_have_their_own_hashes(self):
        batch = pertev.render(self.scene, cameras=POSES, denoise="svgf", **SMALL)
        noisy = host(batch.noisy).copy()
        pertev.render(self.scene, cameras=POSES, seeds=8, out=batch, **SMALL)
        self.assertEqual(batch.hash, pertev.render(self.scene, cameras=POSES, seeds=8, **SMALL).hash)
        self.assertEqual(host(batch.noisy).tobytes(), host(batch.color).tobytes())
        self.assertNotIn("noisy", batch.arrays)
        pertev.render(self.scene, cameras=POSES, denoise="svgf", out=batch, **SMALL)
        self.assertEqual(host(batch.noisy).tobytes(), noisy.tobytes())

    def test_arrays_of_a_scene_that_was_opened_again_are_refused(self):
        batch = pertev.render(self.scene, cameras=POSES, environment=(1, 1, 1), **SMALL)
        with self.assertRaisesRegex(pertev.InputError, "opened again"):
            pertev.render(self.scene, cameras=POSES, out=batch, **SMALL)

    def test_without_colour_there_is_no_hash(self):
        batch = pertev.render(self.scene, cameras=POSES, color=False, layers="depth", layers_at="centre", size=(20, 16))
        with self.assertRaises(AttributeError):
            batch.hash
        self.assertNotIn("hash", batch.info[0])
        self.assertIsNone(batch._repr_png_())
        with self.assertRaises(AttributeError):
            batch.picture(0)
        for name in ("color", "noisy"):
            with self.assertRaisesRegex(AttributeError, "request it by color=True"):
                getattr(batch, name)
        self.assertEqual((batch.samples, batch.pose.shape), (0, (3, 4, 4)))

    def test_cameras_of_a_file_are_rendered(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        expected = pertev.render(self.scene, cameras=pertev.Cameras(POSES, K), **SMALL).hash
        cameras = [{"camera_pose": pose.ravel().tolist(), "intrinsics": numpy.ravel(K).tolist()} for pose in POSES]
        (folder / "a.json").write_text(json.dumps({"cameras": cameras}))
        for name in (folder / "a.json", str(folder / "a.json")):
            self.assertEqual(pertev.render(self.scene, cameras=name, **SMALL).hash, expected)
        self.assertEqual([hash for part in pertev.render_chunks(self.scene, folder / "a.json", chunk=2, **SMALL) for hash in part.hash], expected)
        (folder / "b.json").write_text(json.dumps({"cameras": [{**camera, "size": "20x16"} for camera in cameras]}))
        self.assertEqual(pertev.render(self.scene, cameras=folder / "b.json", spp=2).hash, expected)
        self.assertEqual(pertev.render(self.scene, cameras=folder / "b.json", size="10x8", spp=2).color.shape, (3, 8, 10, 3))
        (folder / "c.json").write_text(json.dumps({"cameras": [{**camera, "size": f"{20 + i}x16"} for i, camera in enumerate(cameras)]}))
        for wrong in ("c.json", "nowhere.json"):
            with self.assertRaises(pertev.InputError):
                pertev.render(self.scene, cameras=folder / wrong, spp=2)


if __name__ == "__main__":
    unittest.main()
