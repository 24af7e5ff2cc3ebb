"""Tests what a BatchResult says of its pictures, and cameras of files."""

import json
import pathlib
import sys
import tempfile
import unittest

import numpy

import pertev

sys.argv.pop(1)
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
        cls.scene = pertev.load("cornell-box", device="cpu")

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
        batch.color[1, 0, 0, 0] += 1
        self.assertEqual([a == b for a, b in zip(batch.hash, before)], [True, False, True])
        self.assertEqual(batch.info[1]["hash"], batch.hash[1])
        pertev.render(self.scene, cameras=POSES[::-1], out=batch, **SMALL)
        self.assertEqual(batch.hash, before[::-1])

    def test_without_colour_there_is_no_hash(self):
        batch = pertev.render(self.scene, cameras=POSES, color=False, layers="depth", layers_at="centre", size=(20, 16))
        with self.assertRaises(AttributeError):
            batch.hash
        self.assertNotIn("hash", batch.info[0])

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
