"""Tests many cameras in one call: pictures have the bytes of single renders, in chunks and in reused arrays, and errors."""

import ctypes
import gc
import importlib
import json
import pathlib
import sys
import tempfile
import time
import unittest

import numpy
import pertev
from pertev import _settings

from device_argument import DEVICE

PROGRAM = sys.argv.pop(1)
SMALL = {"size": (24, 16), "spp": 2}
LAYERS = ["depth", "normal", "ids"]


def poses(count):
    """Cameras in front of the Cornell box, which is behind the world's origin. They move sideways and turn slightly."""
    made = numpy.tile(numpy.eye(4), (count, 1, 1))
    for k in range(count):
        angle = 0.05 * k
        turned = [[numpy.cos(angle), 0, numpy.sin(angle)], [0, 1, 0], [-numpy.sin(angle), 0, numpy.cos(angle)]]
        made[k, :3, :3] = numpy.diag([-1, 1, -1]) @ turned
        made[k, :3, 3] = [0.278 + 0.03 * k, 0.273, -0.8]
    return made


def has_oidn():
    try:
        pertev.render("cornell-box", size=(8, 8), spp=1, device=DEVICE, denoise="oidn")
    except pertev.InputError:
        return False
    return True


def host(array):
    return array.numpy() if isinstance(array, pertev.DeviceArray) else array


class Cameras(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = pertev.load("cornell-box", device=DEVICE)

    def test_each_picture_has_the_bytes_of_a_single_render(self):
        K = [[22, 0, 11], [0, 20, 9], [0, 0, 1]]
        for more in ({}, {"layers_at": "centre"}, {"integrator": "bidirectional"}):
            batch = pertev.render(self.scene, cameras=pertev.Cameras(poses(3), K), seeds=[4, 5, 6], layers=LAYERS, **SMALL, **more)
            self.assertEqual((len(batch), batch.color.shape, batch.depth.shape), (3, (3, 16, 24, 3), (3, 16, 24)))
            self.assertGreater(host(batch.color).mean(axis=(1, 2, 3)).min(), 0.01)
            self.assertGreater(numpy.median(host(batch.depth)), 0.8)
            for k, pose in enumerate(poses(3)):
                alone = pertev.render(self.scene, camera_pose=pose.ravel(), intrinsics=numpy.ravel(K), seed=4 + k, layers=LAYERS,
                                      **SMALL, **more)
                for name in ["color", *LAYERS]:
                    self.assertEqual(host(getattr(batch, name))[k].tobytes(), getattr(alone, name).tobytes(), (name, k, more))

    def test_pictures_on_the_device_are_denoised(self):
        """They have the bytes of denoised single pictures in the host's memory: in a batch, in chunks, in arrays that are filled again."""
        cameras, layers = poses(3), ["depth", "ids"]
        for more in ({"denoise": "svgf"}, {"denoise": "svgf", "layers_at": "centre", "transparent": True}, {"denoise": "oidn"}):
            if more["denoise"] == "oidn" and not has_oidn():
                continue
            of_all = {"layers": layers, **SMALL, **more}
            here = pertev.render(self.scene, seed=4, **of_all)
            there = pertev.render(self.scene, seed=4, on_device=True, **of_all)
            alone = [pertev.render(self.scene, camera_pose=pose.ravel(), seed=4 + k, **of_all) for k, pose in enumerate(cameras)]
            batch = pertev.render(self.scene, cameras=cameras, seeds=[4, 5, 6], **of_all)
            chunks = list(pertev.render_chunks(self.scene, cameras, chunk=2, seeds=[4, 5, 6], **of_all))
            self.assertEqual(type(there.color), numpy.ndarray if DEVICE == "cpu" else pertev.DeviceArray)
            self.assertEqual(["denoiser" in info for info in (here.info, there.info, batch.info[1])], 3 * [more["denoise"] == "oidn"])
            for name in ["color", *layers]:
                self.assertEqual(host(getattr(there, name)).tobytes(), getattr(here, name).tobytes(), (name, more))
                for k, picture in enumerate(alone):
                    self.assertEqual(host(getattr(batch, name))[k].tobytes(), getattr(picture, name).tobytes(), (name, k, more))
                parts = b"".join(host(getattr(chunk, name)).tobytes() for chunk in chunks)
                self.assertEqual(parts, host(getattr(batch, name)).tobytes(), (name, more))
            self.assertNotEqual(alone[0].color.tobytes(), alone[0].noisy.tobytes())
            color = batch.color
            pertev.render(self.scene, cameras=cameras[::-1], seeds=[6, 5, 4], out=batch, **of_all)
            self.assertEqual(host(color)[2].tobytes(), alone[0].color.tobytes())

    def test_denoising_supports_a_distorting_lens(self):
        """Denoising removes as much of the error as with a straight lens."""
        left = {}
        for lens in ((), (-0.3, 0.1, 0, 0), (0.25, 0, 0.01, -0.01)):
            view = {"camera_pose": poses(1)[0].ravel(), "intrinsics": (60, 60, 24, 24), "distortion": lens or None, "size": (48, 48)}
            reference = pertev.render(self.scene, spp=512, **view)
            picture = pertev.render(self.scene, spp=4, seed=7, denoise="svgf", **view)
            error, noise = (((array - reference.color) ** 2).mean() for array in (picture.color, picture.noisy))
            left[lens] = error / noise
        self.assertLess(max(left.values()), 0.3)
        self.assertLess(max(left.values()), 1.2 * left[()])

    def test_there_may_be_one_K_or_one_for_each_camera(self):
        K = numpy.array([[[20, 0, 12], [0, 20, 8], [0, 0, 1]], [[40, 0, 12], [0, 40, 8], [0, 0, 1]]])
        both = host(pertev.render(self.scene, cameras=pertev.Cameras(poses(2), K), **SMALL).color)
        for k in range(2):
            one = host(pertev.render(self.scene, cameras=pertev.Cameras(poses(2), K[k]), **SMALL).color)
            self.assertEqual(both[k].tobytes(), one[k].tobytes())
            self.assertNotEqual(both[1 - k].tobytes(), one[1 - k].tobytes())

    def test_poses_may_have_the_axes_of_opencv(self):
        turned = poses(2) @ numpy.diag([1, -1, -1, 1])
        pictures = [host(pertev.render(self.scene, cameras=pertev.Cameras(of, convention=convention), **SMALL).color)
                    for of, convention in ((poses(2), None), (turned, "opencv"))]
        self.assertEqual(pictures[0].tobytes(), pictures[1].tobytes())

    def test_settings_of_the_call_hold_where_cameras_have_none(self):
        turned = poses(2) @ numpy.diag([1, -1, -1, 1])
        straight = host(pertev.render(self.scene, cameras=poses(2), **SMALL).color)
        for cameras in (turned, pertev.Cameras(turned)):
            self.assertEqual(host(pertev.render(self.scene, cameras=cameras, convention="opencv", **SMALL).color).tobytes(), straight.tobytes())
            chunks = pertev.render_chunks(self.scene, cameras, chunk=1, convention="opencv", **SMALL)
            self.assertEqual(b"".join(host(chunk.color).tobytes() for chunk in chunks), straight.tobytes())
        K, bent = [22, 20, 11, 9], (-0.3, 0.1, 0, 0)
        for more in ({"intrinsics": K}, {"intrinsics": K, "distortion": bent}, {"intrinsics": K, "intrinsics_size": (48, 32)},
                     {"intrinsics": K, "lens": "fisheye"}):
            own = {**more}
            of_cameras = pertev.Cameras(poses(2), own.pop("intrinsics"), **own)
            alone = [pertev.render(self.scene, camera_pose=pose.ravel(), **more, **SMALL).color.tobytes() for pose in poses(2)]
            for call in ({"cameras": of_cameras}, {"cameras": poses(2), **more}, {"cameras": of_cameras, **own}):
                color = host(pertev.render(self.scene, **call, **SMALL).color)
                self.assertEqual([picture.tobytes() for picture in color], alone, call)
                self.assertNotEqual(color.tobytes(), straight.tobytes())
        known = pertev.Cameras(poses(2), K, convention="opengl", distortion=bent)
        for name, value in (("convention", "opencv"), ("distortion", (0.1, 0, 0, 0)), ("intrinsics", K), ("camera_pose", poses(1)[0].ravel())):
            with self.assertRaises(pertev.InputError) as refused:
                pertev.render(self.scene, cameras=known, **{name: value}, **SMALL)
            self.assertEqual(refused.exception.setting, name)

    def test_chunks_are_the_parts_of_the_whole(self):
        whole = pertev.render(self.scene, cameras=poses(5), seeds=numpy.arange(5), layers=LAYERS, **SMALL)
        parts = list(pertev.render_chunks(self.scene, poses(5), chunk=2, seeds=numpy.arange(5), layers=LAYERS, **SMALL))
        self.assertEqual([len(part) for part in parts], [2, 2, 1])
        for name in ["color", *LAYERS]:
            together = numpy.concatenate([host(getattr(part, name)) for part in parts])
            self.assertEqual(host(getattr(whole, name)).tobytes(), together.tobytes())
        self.assertEqual([len(part) for part in pertev.render_chunks(self.scene, poses(5), **SMALL)], [5])
        for wrong in ({"chunk": 0}, {"chunk": -1}, {"seeds": [1, 2]}, {"seeds": range(6)}):
            with self.subTest(wrong), self.assertRaises(ValueError):
                list(pertev.render_chunks(self.scene, poses(5), **{"chunk": 2, **wrong}, **SMALL))
        with self.assertRaises(TypeError):
            list(pertev.render_chunks(self.scene, poses(5), chunk=1.5, **SMALL))
        of_one = list(pertev.render_chunks(self.scene, poses(1), chunk=1, seeds=numpy.int64(3), **SMALL))
        self.assertEqual(len(of_one), 1)

    def test_several_devices_share_a_batch(self):
        call = {"cameras": poses(9), "seeds": numpy.arange(9), "layers": LAYERS, **SMALL}
        for devices in ("cpu,cpu", "cpu,cpu,cpu"):
            scene = pertev.load("cornell-box", device=devices)
            for more in ({}, {"layers_at": "centre"}, {"integrator": "bidirectional"}):
                alone, together = pertev.render(self.scene, **call, **more), pertev.render(scene, **call, **more)
                for name in ["color", *LAYERS]:
                    self.assertEqual(host(getattr(together, name)).tobytes(), host(getattr(alone, name)).tobytes(), (devices, name, more))
            before, changed = together, pertev.load("cornell-box", device=DEVICE)
            for edited in (scene, changed):  # on all devices
                edited.params["materials/white/base_color"] = (0.2, 0.5, 0.9)
            together = pertev.render(scene, **call, **more)
            self.assertEqual(host(together.color).tobytes(), host(pertev.render(changed, **call, **more).color).tobytes())
            self.assertNotEqual(host(together.color).tobytes(), host(before.color).tobytes())

    def test_layers_need_no_color(self):
        batch = pertev.render(self.scene, cameras=poses(2), color=False, layers=LAYERS, layers_at="centre", size=(24, 16))
        self.assertEqual(sorted(batch.arrays), sorted(LAYERS))
        with self.assertRaises(AttributeError):
            batch.color
        ids = host(batch.ids)
        self.assertEqual((ids.dtype, ids.shape), (numpy.uint32, (2, 16, 24, 3)))
        with self.assertRaises(pertev.InputError):
            pertev.render(self.scene, cameras=poses(2), color=False, layers=LAYERS, size=(24, 16))

    def test_arrays_outlive_the_scene_and_their_result(self):
        scene = pertev.load("cornell-box", device=DEVICE)
        color = pertev.render(scene, cameras=poses(2), **SMALL).color
        before = host(color).tobytes()
        del scene
        gc.collect()
        self.assertEqual(host(color).tobytes(), before)

    def test_out_fills_the_same_memory_again(self):
        scene = pertev.load("cornell-box", device=DEVICE) # that of other tests is opened again for other settings
        first = pertev.render(scene, cameras=poses(2), layers=LAYERS, **SMALL)
        color = first.color
        before = host(color).copy()
        again = pertev.render(scene, cameras=poses(3)[1:], layers=LAYERS, out=first, **SMALL)
        self.assertIs(again, first)
        self.assertEqual(before[1].tobytes(), host(color)[0].tobytes())
        for other, says in (({"cameras": poses(3)}, "2 pictures; expected 3"), ({"layers": []}, "expected none"), ({"layers": "depth"}, "expected depth"),
                            ({"size": (24, 12)}, "24x16; expected 24x12"), ({"transparent": True}, "3 channels; expected 4"),
                            ({"cameras": None, "on_device": True}, "many cameras")):
            with self.assertRaisesRegex(pertev.InputError, says) as refused:
                pertev.render(scene, **{"layers": LAYERS, "cameras": poses(2), **SMALL, **other}, out=first)
            self.assertEqual(refused.exception.setting, "out")
        with self.assertRaisesRegex(pertev.InputError, "another scene"):
            pertev.render("cornell-box", cameras=poses(2), layers=LAYERS, out=first, **SMALL)

    def test_errors_name_the_wrong_argument(self):
        for arguments, name in [(({"cameras": numpy.eye(4)}), "cameras"), ({"cameras": numpy.zeros((0, 4, 4))}, "cameras"),
                                ({"cameras": poses(2), "seeds": [1, 2, 3]}, "seeds"),
                                ({"cameras": poses(2), "seeds": [-1]}, "seeds"),
                                ({"cameras": 0 * poses(2)}, "cameras"),
                                ({"cameras": poses(2), "denoise": "svgf", "color": False, "layers": "depth", "layers_at": "centre"},
                                 "denoise")]:
            with self.assertRaises(pertev.InputError) as refused:
                pertev.render(self.scene, **arguments, **SMALL)
            self.assertEqual(refused.exception.setting, name, arguments)
        for K in (numpy.zeros((3, 3, 3)), numpy.zeros((2, 2))):
            with self.assertRaises(pertev.InputError) as refused:
                pertev.Cameras(poses(2), K)
            self.assertEqual(refused.exception.setting, "K")
        for name, value in {"camera": 0, "eye": (0, 1, 3), "target": (0, 0, 0), "up": (0, 1, 0), "camera_pose": poses(1)[0], "camera_from": "a.exr",
                            "camera_path": "a.json"}.items():
            for call in (lambda **values: pertev.render(self.scene, **values), lambda **values: pertev.render_chunks(self.scene, **values)):
                with self.assertRaisesRegex(pertev.InputError, f"^{name}: .*cameras") as refused:
                    call(cameras=poses(2), **{name: value}, **SMALL)
                self.assertEqual(refused.exception.setting, name)
        with self.assertRaisesRegex(pertev.InputError, "^intrinsics: .*cameras"):
            pertev.render(self.scene, cameras=pertev.Cameras(poses(2), [22, 20, 11, 9]), intrinsics=[22, 20, 11, 9], **SMALL)
        for arguments in ({"seeds": [1]}, {"color": False}, {"cameras": poses(1), "output": "x.png"}):
            with self.assertRaises(TypeError):
                pertev.render(self.scene, **arguments, **SMALL)

    def test_layers_that_a_batch_lacks_are_refused_with_those_that_it_has(self):
        refused = []
        for layer in _settings.OF_PICTURES["aov"]["choices"]:
            try:
                self.assertEqual(list(pertev.render(self.scene, cameras=poses(1), layers=layer, **SMALL).arrays), ["color", layer])
            except pertev.InputError as error:
                self.assertEqual((error.setting, error.value), ("layers", layer))
                refused.append(error)
        self.assertEqual([error.value for error in refused], ["motion", "uv", "crypto_object", "crypto_material", "samples", "variance"])
        self.assertIn("only albedo, normal, depth, position, ids, distance", refused[1].reason)

    def test_rays_through_centres_give_the_layers_of_centres(self):
        """These are the settings of docs/python.md for the highest rate, beside `layers_at`."""
        fast = {"light_sampling": "nee", "max_depth": 1, "filter": "box", "filter_radius": 2**-20, "spp": 1, "size": (24, 16)}
        own, centres = (pertev.render(self.scene, cameras=poses(2), layers=LAYERS, layers_at=layers_at, **fast) for layers_at in ("samples", "centre"))
        self.assertEqual(host(own.color).tobytes(), host(centres.color).tobytes())
        self.assertEqual(host(own.ids).tobytes(), host(centres.ids).tobytes())
        for name in ("depth", "normal"):
            numpy.testing.assert_allclose(host(getattr(own, name)), host(getattr(centres, name)), rtol=2e-6, atol=2e-6)

    def test_a_single_picture_stays_on_the_device(self):
        for more in ({}, {"layers_at": "centre", "seed": 3}, {"transparent": True}, {"integrator": "bidirectional"},
                     {"lens": "fisheye", "layers_at": "centre"}):
            here = pertev.render(self.scene, layers=LAYERS, **SMALL, **more)
            there = pertev.render(self.scene, on_device=True, layers=LAYERS, **SMALL, **more)
            self.assertEqual((there.color.shape, there.depth.shape), (here.color.shape, (16, 24)))
            self.assertEqual(type(there.color), numpy.ndarray if DEVICE == "cpu" else pertev.DeviceArray)
            for name in ["color", *LAYERS]:
                self.assertEqual(host(getattr(there, name)).tobytes(), getattr(here, name).tobytes(), (name, more))
        first = pertev.render(self.scene, on_device=True, **SMALL)
        color = first.color
        self.assertIs(pertev.render(self.scene, on_device=True, seed=9, out=first, **SMALL), first)
        self.assertEqual(host(color).tobytes(), pertev.render(self.scene, seed=9, **SMALL).color.tobytes())
        for arguments in ({"layers": ["depth"], "out": first}, {"cameras": poses(1), "out": first}):
            with self.assertRaises(pertev.InputError):
                pertev.render(self.scene, on_device=True, **arguments, **SMALL)
        with self.assertRaises(TypeError):
            pertev.render(self.scene, on_device=True, output="x.png", **SMALL)

    def test_asarray_copies_from_any_device(self):
        color = pertev.render(self.scene, cameras=poses(1), **SMALL).color
        self.assertEqual(numpy.asarray(color).tobytes(), host(color).tobytes())
        self.assertEqual(numpy.asarray(color, dtype=numpy.float64).dtype, numpy.float64)

    def test_a_picture_states_its_camera(self):
        picture = pertev.render(self.scene, **SMALL)
        again = pertev.render(self.scene, cameras=pertev.Cameras(picture.pose[None], picture.K), layers="depth", **SMALL)
        self.assertEqual(picture.pose[:3, 3].tolist(), numpy.float32([0.278, 0.273, -0.8]).tolist())
        self.assertTrue((picture.pose[:3, :3] == numpy.diag([-1, 1, -1])).all())
        self.assertAlmostEqual(numpy.degrees(2 * numpy.arctan(8 / picture.K[1, 1])), 39.3076, 3)
        self.assertLess(pertev.compare(host(again.color)[0], picture)["rel_mse"], 1e-3)
        K = [[22, 0, 11], [0, 20, 9], [0, 0, 1.0]]
        of_half = pertev.render(self.scene, intrinsics=numpy.ravel(K), intrinsics_size=(48, 32), **SMALL).K
        self.assertEqual(of_half.tolist(), [[11, 0, 5.5], [0, 10, 4.5], [0, 0, 1]])
        with self.assertRaises(AttributeError):
            pertev.render(self.scene, projection="orthographic", **SMALL).K

    def test_a_scene_has_names_and_a_box(self):
        picture = pertev.render(self.scene, layers="ids", layers_at="centre", filter="box", **SMALL)
        seen = [number for number in numpy.unique(picture.ids[..., 0]).tolist() if number != 0xFFFFFFFF]
        self.assertEqual({str(number): self.scene.instance_names[number] for number in seen}, picture.info["instances"])
        self.assertEqual(self.scene.material_names, ["white", "green", "red", "light"])
        self.assertTrue(numpy.allclose(self.scene.bounds, [[0, 0, 0], [0.556, 0.5488, 0.5592]], atol=0.004))
        box = pertev.Scene(meshes={"a": {"vertices": [[0, 0, 0], [1, 0, 0], [0, 2, 0]], "faces": [[0, 1, 2]]}},
                           instances={"one": {"mesh": "a"}, "two": {"mesh": "a"}}, ground="off")
        moved = numpy.eye(4)
        moved[:3, 3] = 1, 2, 3
        box.params["instances/two/transform"] = moved
        self.assertEqual((box.instance_names, box.bounds.tolist()), (["one", "two"], [[0, 0, 0], [2, 4, 3]]))

    def test_cameras_are_read_from_files(self):
        path = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "views.json"

        def read(*cameras, **more):
            path.write_text(json.dumps({"cameras": cameras, **more}))
            return pertev.read_cameras(path)

        views = [{"name": f"view {k}", "camera_pose": pose[:3].tolist(), "intrinsics": [22, 20, 11, 9]} for k, pose in enumerate(poses(3))]
        cameras = read(*views, intrinsics_size="24x16", distortion=[0.1, 0, 0, 0])
        self.assertEqual((cameras.names, cameras[1:].names), (["view 0", "view 1", "view 2"], ["view 1", "view 2"]))
        self.assertTrue((cameras.poses == poses(3)).all() and (cameras.K == [22, 20, 11, 9]).all())
        own = pertev.Cameras(poses(3), [22, 20, 11, 9], distortion=[0.1, 0, 0, 0])
        of_file, of_arrays = (host(pertev.render(self.scene, cameras=of, **SMALL).color) for of in (cameras, own))
        self.assertEqual(of_file.tobytes(), of_arrays.tobytes())
        for wrong in ([{"eye": [0, 0, 0]}], [{**views[0], "lens": "fisheye"}, views[1]], [views[0], {"name": "b"}],
                      [{**views[0], "fov": 40}]):
            with self.assertRaises(pertev.InputError):
                read(*wrong)
        for name, value, says in (("eye", [0, 0, 0], "^eye: .*camera_pose"), ("K", [22, 20, 11, 9], "no setting 'K'; did you mean 'intrinsics'"), ("spq", 1, "no setting 'spq'; did you mean 'spp'"),
                                  ("camera_pose", "1,0,a", "camera 'view 0': camera_pose: expected numbers, not '1,0,a'"), ("camera_pose", [1, 2, 3], "expected 12 or 16 numbers, not 3"),
                                  ("intrinsics", [1, 2, 3, 4, 5], "expected 4 or 9 numbers, not 5")):
            with self.assertRaises(pertev.InputError) as caught:
                read({**views[0], name: value})
            self.assertRegex(caught.exception.reason, says)
            self.assertEqual(caught.exception.file, str(path))
        with self.assertRaises(pertev.InputError):
            pertev.read_cameras(path.with_name("none.json"))

    def test_poses_of_another_package_are_copied_to_the_host(self):
        class Tensor:  # has what NumPy refuses, as a tensor on a GPU
            def __init__(self, copy):
                setattr(self, copy, lambda: poses(2))

            def __array__(self, *_, **__):
                raise TypeError("it is on a GPU")

        expected = host(pertev.render(self.scene, cameras=poses(2), **SMALL).color).tobytes()
        for copy in ("cpu", "get", "numpy"):
            self.assertEqual(host(pertev.render(self.scene, cameras=Tensor(copy), **SMALL).color).tobytes(), expected)

    @unittest.skipIf(DEVICE == "cpu", "arrays on a GPU are those of CUDA")
    def test_arrays_on_a_gpu_are_shared(self):
        batch = pertev.render(self.scene, cameras=poses(2), layers=LAYERS, **SMALL)
        self.assertIsInstance(batch.color, pertev.DeviceArray)
        description = batch.depth.__cuda_array_interface__
        self.assertEqual((description["shape"], description["typestr"], description["version"]), ((2, 16, 24), "<f4", 3))
        self.assertEqual(batch.color.__dlpack_device__()[0], 2)
        try:
            import torch
        except ImportError:
            self.skipTest("torch is not installed")
        tensor = torch.from_dlpack(batch.color)
        self.assertEqual((tensor.device.type, tensor.cpu().numpy().tobytes()), ("cuda", batch.color.numpy().tobytes()))
        self.assertEqual(torch.as_tensor(batch.depth, device="cuda").data_ptr(), description["data"][0])
        again = pertev.render(self.scene, cameras=torch.as_tensor(poses(2), device="cuda"), layers=LAYERS, **SMALL)
        self.assertEqual(again.color.numpy().tobytes(), batch.color.numpy().tobytes())
        with torch.cuda.stream(torch.cuda.Stream()):  # a consumer's stream of its own
            self.assertEqual(torch.from_dlpack(again.depth).sum().item(), tensor.new_tensor(batch.depth.numpy()).sum().item())

    @unittest.skipIf(DEVICE == "cpu", "arrays on a GPU are those of CUDA")
    def test_arrays_are_filled_again_after_what_still_reads_them(self):
        driver, stream, kept = ctypes.CDLL("libcuda.so.1"), ctypes.c_void_p(), ctypes.c_uint64()
        work = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(lambda _: time.sleep(1))  # such as the kernels before one that reads

        def call(name, *arguments):
            self.assertEqual(getattr(driver, name)(*arguments), 0, name)

        batch = pertev.render(self.scene, cameras=poses(2), **SMALL)
        before, size = batch.color.numpy(), ctypes.c_size_t(batch.color.numpy().nbytes)
        address = ctypes.c_uint64(batch.color.__cuda_array_interface__["data"][0])
        call("cuStreamCreate", ctypes.byref(stream), 1)  # non-blocking: it waits for no other stream
        call("cuMemAlloc_v2", ctypes.byref(kept), size)
        call("cuLaunchHostFunc", stream, work, None)
        call("cuMemcpyDtoDAsync_v2", kept, address, size, stream)
        pertev.render(self.scene, cameras=poses(4)[2:], out=batch, **SMALL)
        call("cuStreamSynchronize", stream)
        read = numpy.empty_like(before)
        call("cuMemcpyDtoH_v2", read.ctypes.data_as(ctypes.c_void_p), kept, size)
        self.assertEqual(read.tobytes(), before.tobytes())
        self.assertNotEqual(batch.color.numpy().tobytes(), before.tobytes())
        # The host also waits for what others write.
        call("cuLaunchHostFunc", stream, work, None)
        call("cuMemcpyDtoDAsync_v2", address, kept, size, stream)
        self.assertEqual(batch.color.numpy().tobytes(), before.tobytes())
        call("cuMemFree_v2", kept)

    def test_views_of_arrays_show_what_they_are_filled_with_again(self):
        batch = pertev.render(self.scene, cameras=poses(2), layers=LAYERS, **SMALL)
        arrays, kept = batch.arrays, {name: host(array).copy() for name, array in batch.arrays.items()}
        other = pertev.render(self.scene, cameras=poses(4)[2:], layers=LAYERS, **SMALL)
        self.assertIs(pertev.render(self.scene, cameras=poses(4)[2:], layers=LAYERS, out=batch, **SMALL), batch)
        for name, array in arrays.items():
            self.assertEqual(host(array).tobytes(), host(other.arrays[name]).tobytes())
            self.assertNotEqual(host(array).tobytes(), kept[name].tobytes())

    @unittest.skipIf(DEVICE == "cpu", "arrays on a GPU are those of CUDA")
    def test_other_packages_read_arrays_on_a_gpu(self):
        batch = pertev.render(self.scene, cameras=poses(2), layers=LAYERS, **SMALL)
        readers = {"cupy": lambda cupy, array: cupy.asarray(array).get(),
                   "jax": lambda jax, array: numpy.asarray(jax.dlpack.from_dlpack(array)),
                   "warp": lambda warp, array: warp.from_dlpack(array).numpy()}
        for name, read in readers.items():
            with self.subTest(name):
                try:
                    package = importlib.import_module(name)
                    if name == "jax":
                        importlib.import_module("jax.dlpack")
                except ImportError:
                    self.skipTest(f"{name} is not installed")
                for array in (batch.color, batch.depth, batch.ids):
                    self.assertEqual(read(package, array).tobytes(), array.numpy().tobytes())

    @unittest.skipIf(DEVICE == "cpu", "arrays on a GPU are those of CUDA")
    def test_meshes_on_a_gpu_give_the_picture_of_those_on_the_host(self):
        try:
            import torch
        except ImportError:
            self.skipTest("torch is not installed")
        corners = numpy.float32([(-1, 0, 0), (1, 0, 0), (0, 1, 0)])
        floats, faces = torch.as_tensor(corners, device="cuda"), torch.as_tensor([[0, 1, 2]], device="cuda")
        view = {"eye": (0, 0, 3), "target": (0, 0, 0), "environment": (1, 1, 1), "device": DEVICE, **SMALL}
        hashes = {pertev.render(pertev.Scene(meshes={"a": {"vertices": vertices, "faces": of}}, instances={"a": {"mesh": "a"}}), **view).hash
                  for vertices, of in ((corners, [[0, 1, 2]]), (floats, faces))}
        self.assertEqual(len(hashes), 1)


if __name__ == "__main__":
    unittest.main()
