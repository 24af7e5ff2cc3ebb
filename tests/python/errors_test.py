"""Tests errors: each has its kind and names the wrong setting or argument by its Python name."""

import ctypes
import errno
import fractions
import pathlib
import pickle
import signal
import sys
import tempfile
import threading
import time
import types
import unittest

import numpy

import pertev
from pertev import _settings

sys.argv.pop(1)
SMALL = {"size": (8, 6), "spp": 1, "device": "cpu"}
POSES = numpy.tile(numpy.diag([-1.0, 1, -1, 1]), (2, 1, 1))


class Elsewhere:
    """An array that claims by DLPack to be in the memory of a GPU."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        capsule = self.array.__dlpack__()
        ctypes.pythonapi.PyCapsule_GetPointer.restype = ctypes.c_void_p
        ctypes.pythonapi.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
        tensor = ctypes.pythonapi.PyCapsule_GetPointer(capsule, b"dltensor")
        ctypes.c_int32.from_address(tensor + 8).value = 2 # the kind of device follows the pointer, here CUDA
        return capsule

    def __dlpack_device__(self):
        return (2, 0)


class OfJax:
    """An array that must not change, which its DLPack does not say."""
    __module__ = "jaxlib._jax"

    def __init__(self, array):
        self.__dlpack__, self.__dlpack_device__ = array.__dlpack__, array.__dlpack_device__


def after(seconds):
    """Presses Ctrl-C."""
    threading.Timer(seconds, lambda: signal.raise_signal(signal.SIGINT)).start()


class Errors(unittest.TestCase):
    def setUp(self):
        self.scene = pertev.load("cornell-box", device="cpu")

    def refused(self, kind, setting, call):
        with self.assertRaises(kind) as caught:
            call()
        self.assertEqual(caught.exception.setting, setting)
        self.assertIsInstance(caught.exception, pertev.Error)
        return caught.exception

    def test_errors_have_their_kind(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "is a folder.png").mkdir()
        for kind, of_python, setting, values in [
                (pertev.InputError, ValueError, "max_depth", {"max_depth": "deep"}), (pertev.LimitError, ValueError, "size", {"size": (10**6, 10**6)}),
                (pertev.MemoryLimitError, MemoryError, "max_memory", {"max_memory": 1, "size": (4096, 4096)})]:
            with self.subTest(values):
                error = self.refused(kind, setting, lambda: pertev.render(self.scene, **{**SMALL, **values}))
                self.assertIsInstance(error, of_python)
        with self.assertRaises(OSError) as caught:
            pertev.write(folder / "is a folder.png", numpy.zeros((2, 2, 3)))
        self.assertIsInstance(caught.exception, pertev.WriteError)
        for kind, of_python in ((pertev.DeviceError, RuntimeError), (pertev.InterruptedRender, RuntimeError)):
            self.assertTrue(issubclass(kind, of_python) and issubclass(kind, pertev.Error))

    def test_errors_of_files_have_the_attributes_of_python(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        gone, picture = str(folder / "a.glb"), pertev.render(self.scene, **SMALL)
        for call in (lambda: pertev.load(gone), lambda: pertev.read(gone), lambda: pertev.read_cameras(gone), lambda: pertev.merge(gone),
                     lambda: pertev.render(self.scene, settings=gone, **SMALL)):
            error = self.refused(pertev.MissingFileError, "", call)
            self.assertIsInstance(error, FileNotFoundError)
            self.assertIsInstance(error, pertev.InputError)
            self.check_file(error, gone)
        gone = str(folder / "none" / "a.exr")
        self.assertEqual(self.refused(pertev.MissingFileError, "scene", lambda: pertev.load(gone)).filename, str(folder / "none"))
        for call in (lambda: pertev.write(gone, picture), lambda: pertev.write(gone, picture.color),
                     lambda: pertev.render(self.scene, output=gone, **SMALL)):
            self.check_file(self.refused(pertev.WriteError, "", call), gone)

    def check_file(self, error, file):
        for same in (error, pickle.loads(pickle.dumps(error))):
            self.assertEqual((same.errno, same.filename, same.file), (errno.ENOENT, file, file))
            self.assertIn(file, str(same))

    def test_arguments_of_a_wrong_type_are_named(self):
        surrogate = "\udcff"
        for name, call in [("layers", lambda: pertev.render(self.scene, layers=3)), ("output", lambda: pertev.render(self.scene, output=3)),
                           ("settings", lambda: pertev.render(self.scene, settings={"spp": 3})), ("cameras", lambda: pertev.render_chunks(self.scene, None)),
                           ("size", lambda: pertev.read_cameras("a.json", size=3)), ("chunk", lambda: pertev.render_chunks(self.scene, POSES, chunk="a")),
                           ("name", lambda: pertev.Scene(meshes={}, instances={}, name=3)), ("source", lambda: pertev.Scene(3)),
                           ("path", lambda: pertev.read(None)), ("color", lambda: pertev.render(self.scene, cameras=POSES, color=None)),
                           ("color", lambda: pertev.render_chunks(self.scene, POSES, color="a")), ("on_device", lambda: pertev.render(self.scene, on_device=1)),
                           ("partial", lambda: pertev.merge("a.pvf", partial="a")), ("browser", lambda: pertev.view(self.scene, browser=1)),
                           ("curve", lambda: pertev.tone_map(numpy.zeros((2, 2, 3)), curve=3))]:
            with self.subTest(name), self.assertRaises((TypeError, pertev.InputError)) as caught:
                call()
            self.assertTrue(str(caught.exception).startswith(name + ": "), caught.exception)
        mesh, array, null = {"vertices": numpy.eye(3), "faces": [[0, 1, 2]]}, numpy.zeros((6, 8, 3), numpy.float32), "a\0b"
        folder = self.enterContext(tempfile.TemporaryDirectory())
        for name, call in [("name", lambda: pertev.Scene(meshes={"m": mesh}, instances={"i": {"mesh": "m"}}, name=surrogate)),
                           ("meshes", lambda: pertev.Scene(meshes={surrogate: mesh}, instances={})), ("instances/i/mesh", lambda: pertev.Scene(meshes={"m": mesh}, instances={"i": {"mesh": null}})),
                           ("meshes/m", lambda: pertev.Scene(meshes={"m": {**mesh, surrogate: 1}}, instances={})), ("curve", lambda: pertev.tone_map(array, curve=surrogate)),
                           ("out", lambda: pertev.render(self.scene, **SMALL, out={surrogate: array})), ("out", lambda: pertev.render(self.scene, **SMALL, out={3: array})),
                           ("path", lambda: pertev.write(f"{folder}/{null}.png", array)), ("environment", lambda: pertev.render(self.scene, environment=null, **SMALL)),
                           ("color", lambda: pertev.render_chunks(self.scene, POSES, color=False, **SMALL)), ("cameras", lambda: pertev.Cameras(numpy.eye(4))),
                           ("K", lambda: pertev.Cameras(POSES, numpy.eye(2))), ("K", lambda: pertev.Cameras(POSES, numpy.ones((3, 4))))]:
            with self.subTest(name):
                self.refused(pertev.InputError, name, call)
        for name, call in [("cameras", lambda: pertev.Cameras({})), ("path", lambda: pertev.read(surrogate)), ("source", lambda: pertev.load(surrogate)),
                           ("environment", lambda: pertev.render(self.scene, environment=surrogate, **SMALL)), ("path", lambda: self.scene.save("a.obj")),
                           ("chunk", lambda: pertev.render_chunks(self.scene, POSES, chunk=0)), ("seeds", lambda: pertev.render_chunks(self.scene, POSES, seeds=[0.5], **SMALL)),
                           ("cameras", lambda: pertev.render_chunks(self.scene, 0 * POSES, **SMALL)), ("max_depth", lambda: pertev.render_chunks(self.scene, POSES, max_depth=-1))]:
            with self.subTest(name):
                self.refused(pertev.InputError, name, call)
        huge, picture = 10**400, numpy.zeros((2, 2, 3), numpy.float32)
        for name, call in [("exposure", lambda: pertev.tone_map(picture, exposure=huge)), ("port", lambda: pertev.view(self.scene, port=huge)),
                           ("chunk", lambda: pertev.render_chunks(self.scene, POSES, chunk=huge)), ("max_depth", lambda: pertev.render(self.scene, max_depth=10**5000)),
                           ("exposure", lambda: pertev.view(self.scene, exposure=fractions.Fraction(huge)))]:
            with self.subTest(name):
                self.refused(pertev.InputError, name, call)
        for name in ("host", "jpeg"):
            for wrong in (True, pathlib.Path("a")):
                with self.assertRaisesRegex(TypeError, f"^{name}: expected a text, not "):
                    pertev.view(self.scene, **{name: wrong})
        for wrong in (3, None, surrogate):
            with self.assertRaises(KeyError):
                self.scene.params[wrong]
            with self.assertRaises(KeyError):
                self.scene.params[wrong] = 1

    def test_numbers_of_another_kind_or_shape_are_refused(self):
        render = lambda **values: pertev.render(self.scene, **{"size": (6, 4), "spp": 1, **values})
        for name, wrong in [("spp", b"1"), ("spp", numpy.array([1])), ("spp", (1,)), ("seed", bytearray(b"1")), ("eye", memoryview(b"013")), ("eye", {1, 2, 3}), ("eye", {1: 2}),
                            ("eye", (1j, 0, 3)), ("eye", numpy.array([1j, 0, 3])), ("clamp", numpy.complex64(1))]:
            with self.subTest(name, wrong=wrong), self.assertRaisesRegex(TypeError, f"^{name}: "):
                render(**{name: wrong})
        for name, wrong in [("eye", numpy.ones((3, 1))), ("camera_pose", numpy.ones((2, 8))), ("camera_pose", [[1, 0], [0]]),
                            ("intrinsics", numpy.ones((9, 1))), ("environment", [[1, 1, 1]])]:
            with self.subTest(name, wrong=wrong):
                self.refused(pertev.InputError, name, lambda: render(**{name: wrong}))
        self.refused(pertev.InputError, "reference", lambda: pertev.compare(numpy.zeros((4, 4, 3)), numpy.zeros((5, 4, 3))))

        class OnDevice:  # It has what an array of Warp has.
            def __init__(self, values):
                self.numpy = lambda: numpy.array(values)

            __dlpack__ = None

        same = [render(eye=eye, intrinsics=K, spp=spp).hash for eye, K, spp in [
            ((0, 1, 3), (8, 8, 3, 2), 2), (map(float, (0, 1, 3)), list(numpy.array([8., 8, 3, 2])), 2), ([numpy.array(x) for x in (0, 1, 3)], (8, 8, 3, 2), 2), (OnDevice([0, 1, 3]), OnDevice([[8, 0, 3], [0, 8, 2], [0, 0, 1]]), OnDevice(2))]]
        self.assertEqual(len(set(same)), 1)

    def test_cameras_are_chosen_by_number(self):
        cameras = pertev.Cameras(numpy.arange(3 * 16).reshape(3, 4, 4), [[8, 8, 4, k] for k in range(3)], convention="opencv")
        self.assertEqual([(len(one), one.poses[0, 0, 0], one.K[0, 3], one.settings["convention"]) for one in cameras],
                         [(1, 16 * k, k, "opencv") for k in range(3)])
        self.assertEqual((cameras[-1].poses[0, 0, 0], len(cameras[1:]), cameras[[2, 0]].K[:, 3].tolist()), (32, 2, [2, 0]))
        with self.assertRaises(IndexError):
            cameras[3]
        one_K = pertev.Cameras(cameras.poses, [[8, 8, 4, 3]])[1:]
        self.assertEqual((len(one_K), one_K.K.tolist()), (2, [[8, 8, 4, 3]]))

    def test_unknown_settings_are_suggested_if_one_is_meant(self):
        session = pertev.Session(self.scene, **SMALL)
        for meant, names in {"intrinsics": ["K", "camera_matrix", "intrinsic"], "camera_pose": ["pose", "extrinsics", "c2w"], "cameras": ["poses"], "fov": ["fov_deg"],
                             "size": ["width", "height", "resolution", "image_size"], "spp": ["samples_per_pixel", "num_samples", "Spp", "sp"],
                             "max_depth": ["bounces", "max_bounces", "depth", "max_dept"], "eye": ["position", "eye_position"], "target": ["look_at"], "device": ["gpu"],
                             "output": ["outputs"], "aov": ["layer"], "seed": ["random_seed"], "": ["noisy", "xyz", "qwerty", "x" * 1000, "\udcff", "ä"]}.items():
            for name in names:
                with self.subTest(name), self.assertRaises(TypeError) as caught:
                    pertev.render(self.scene, **{name: 1})
                self.assertTrue(str(caught.exception).endswith(f"; did you mean '{meant}'?" if meant else f"no setting '{name}'"), caught.exception)
        calls = [lambda **values: pertev.render(self.scene, **values), lambda **values: pertev.render(self.scene, cameras=POSES, **values),
                 lambda **values: pertev.render_chunks(self.scene, POSES, **values), lambda **values: pertev.load("cornell-box", **values),
                 lambda **values: pertev.Session(self.scene, **values), session.set, lambda **values: pertev.view(self.scene, **values)]
        for call in calls:
            with self.assertRaisesRegex(TypeError, "'intrinsics'"):
                call(K=numpy.eye(3))
        for name, said, calls in [("stereo", "`pertev render`", calls), ("frames", "Session", calls[:4] + calls[6:]), ("part", "render", calls[3:]), ("output", "render", calls[3:])]:
            for call in calls:
                with self.assertRaisesRegex(TypeError, f"^'{name}' is for .*{said}"):
                    call(**{name: 1})
        self.assertEqual(set(_settings.ARGUMENTS), pertev.render.__kwdefaults__.keys() - {"layers"})
        for name, meant in (("cornel-box", "; did you mean 'cornell-box'?"), ("teapot", "")):
            with self.assertRaisesRegex(pertev.InputError, f"'{name}'{meant}$".replace("?", "[?]")):
                pertev.scene(name)

    def test_settings_have_the_names_of_python(self):
        for values, setting in [({"filter_radius": -1}, "filter_radius"), ({"layers": "deepness"}, "layers"), ({"aov": "deepness"}, "aov"), ({"transparent": 1}, "transparent"),
                                ({"layers": "motion", "cameras": POSES}, "layers"), ({"aov": "motion", "cameras": POSES}, "aov"), ({"eye": (1, 2)}, "eye"),
                                ({"layers": "uv", "on_device": True}, "layers"), ({"camera_pose": range(5)}, "camera_pose"), ({"device": "cuda:99"}, "device"),
                                ({"false_color_range": "1", "false_color": "luminance"}, "false_color_range")]:
            with self.subTest(values):
                error = self.refused(pertev.InputError, setting, lambda: pertev.render(self.scene, **{**SMALL, **values}))
                self.assertNotIn("--", str(error))

    def test_errors_say_layers_unless_the_call_has_aov(self):
        for setting, values in [("layers_at", {"layers_at": "centre"}), ("layers_at", {"layers": "uv", "layers_at": "centre"}), ("denoise", {"layers": "variance", "denoise": "svgf"})]:
            error = self.refused(pertev.InputError, setting, lambda: pertev.render(self.scene, **SMALL, **values))
            for text in (str(error), error.reason):
                self.assertRegex(text, r"\blayers\b")
                self.assertNotIn("aov", text)
        error = self.refused(pertev.InputError, "layers_at", lambda: pertev.render(self.scene, **SMALL, aov="uv", layers_at="centre"))
        self.assertIn("aov='uv'", str(error))

    def test_values_in_messages_are_python_s(self):
        for text, values in [("spp=0 ", {"spp": 0}), ("eye=(1,2)", {"eye": (1, 2)}), ("fov=400", {"fov": 400}), ("device='gpu'", {"device": "gpu"})]:
            error = self.refused(pertev.InputError, next(iter(values)), lambda: pertev.render(self.scene, **{**SMALL, **values}))
            self.assertTrue(str(error).startswith(text), error)

    def test_arrays_of_wrong_shape_type_or_device_are_refused(self):
        mesh = {"vertices": numpy.eye(3), "faces": numpy.array([[0, 1, 2]])}
        picture, folder = numpy.zeros((4, 4, 3), numpy.float32), self.enterContext(tempfile.TemporaryDirectory())

        def scene_of(**changes):
            return lambda: pertev.Scene(meshes={"m": {**mesh, **changes}}, instances={"i": {"mesh": "m"}})

        def batch_of(*arguments, **more):
            return lambda: pertev.render(self.scene, cameras=pertev.Cameras(*arguments), **SMALL, **more)

        for name, call in [("meshes/m/vertices", scene_of(vertices=Elsewhere(numpy.eye(3)))), ("meshes/m/faces", scene_of(faces=numpy.eye(3))),
                           ("meshes/m/vertices", scene_of(vertices=numpy.eye(3, dtype=complex))), ("cameras", batch_of(POSES[:, :, :2])),
                           ("K", batch_of(POSES, numpy.eye(2))), ("seeds", batch_of(POSES, seeds=[0.5, 1.5])),
                           *(("picture", lambda kind=kind, of=of: of((255 * picture).astype(kind))) for kind in (numpy.uint8, numpy.int32)
                             for of in (pertev.tone_map, lambda whole: pertev.compare(whole, picture), lambda whole: pertev.write(f"{folder}/a.png", whole))),
                           ("picture", lambda: pertev.tone_map(picture[None])), ("picture", lambda: pertev.tone_map(Elsewhere(picture)))]:
            with self.subTest(name):
                self.refused(pertev.InputError, name, call)

    def test_cameras_that_are_none_are_named_with_their_number(self):
        places = numpy.repeat(POSES, 3, 0)

        def with_number(array, at, number):
            changed = numpy.array(array, float)
            changed[at] = number
            return changed

        K = [[8, 0, 4], [0, 8, 3], [0, 0, 1]]
        for name, said, arguments in [
                ("cameras", "[1, 0, 3]", (with_number(places, (1, 0, 3), numpy.nan),)), ("cameras", "[0, 2, 2]", (with_number(places, (0, 2, 2), numpy.inf),)),
                ("cameras", "camera 2", (with_number(places, (2, 0, 0), 3),)), ("cameras", "camera 0", (with_number(places, (0, 0, 0), 3),)),
                ("K", "camera 0", (places, numpy.zeros((3, 3)))), ("K", "[0, 1, 1] is nan", (places, with_number(K, (1, 1), numpy.nan))),
                ("K", "camera 1", (places, with_number([K] * len(places), (1, 0, 1), 2))), ("cameras", "float", (1.0,)), ("cameras", "<U", (["a", "b"],)),
                ("cameras", "", ([[1, 2], [3]],))]:
            with self.subTest((name, said)):
                error = self.refused(pertev.InputError, name, lambda: pertev.render(self.scene, cameras=pertev.Cameras(*arguments), **SMALL))
                self.assertIn(said, str(error))
        self.refused(pertev.InputError, "camera_pose", lambda: pertev.render(self.scene, camera_pose=with_number(POSES[0], (0, 0), numpy.nan), **SMALL))

    def test_whole_numbers_out_of_range_are_named(self):
        mesh = {"vertices": numpy.eye(3)}
        for number in (2**64 - 1, 2**63, 3):
            faces = numpy.array([[0, 1, number]], numpy.uint64)
            error = self.refused(pertev.InputError, "meshes/m/faces", lambda: pertev.Scene(meshes={"m": {**mesh, "faces": faces}}, instances={"i": {"mesh": "m"}}))
            self.assertIn(f"{number} is out of range", str(error))
        for seeds, number in ((numpy.array([2**63 + 5], numpy.uint64), 2**63 + 5), ([2**32], 2**32), (-1, -1)):
            error = self.refused(pertev.InputError, "seeds", lambda: pertev.render(self.scene, cameras=POSES, seeds=seeds, **SMALL))
            self.assertIn(f"{number} is out of range", str(error))

    def test_parts_of_scenes_that_are_no_dictionaries_or_not_finite_are_named(self):
        mesh = {"vertices": numpy.eye(3), "faces": [[0, 1, 2]]}
        good = {"meshes": {"m": mesh}, "instances": {"i": {"mesh": "m"}}}
        error = self.refused(pertev.InputError, "instances/i/mesh", lambda: pertev.Scene(**{**good, "instances": {"i": {"mesh": "n"}}}))
        self.assertTrue(str(error).startswith("instances/i/mesh='n'"), error)
        error = self.refused(pertev.InputError, "meshes/m", lambda: pertev.Scene(**{**good, "meshes": {"m": numpy.eye(3)}}))
        self.assertIn("faces", str(error))
        for name, change in [("instances/i", {"instances": {"i": "m"}}), ("instances/i/transform", {"instances": {"i": {"mesh": "m", "transform": numpy.full((4, 4), numpy.inf)}}}),
                             ("cameras/c/eye", {"cameras": {"c": {"eye": (0, numpy.nan, 0), "target": (0, 0, 0)}}}),
                             ("materials/a/roughness", {"materials": {"a": {"roughness": numpy.nan}}}), ("lights/l/range", {"lights": {"l": {"range": numpy.nan}}}),
                             ("lights/l/intensity", {"lights": {"l": {"intensity": (1, -1, 1)}}}), ("lights/l/outer_cone", {"lights": {"l": {"kind": "spot", "outer_cone": 181}}}), ("lights/l/inner_cone", {"lights": {"l": {"kind": "spot", "inner_cone": 50, "outer_cone": 20}}}),
                             ("lights/l/direction", {"lights": {"l": {"kind": "spot", "direction": (0, 0, 0)}}}), ("cameras/c/view_height", {"cameras": {"c": {"projection": "orthographic", "view_height": 0}}}),
                             ("cameras/c/aperture", {"cameras": {"c": {"aperture": -1}}}), ("cameras/c/aspect", {"cameras": {"c": {"aspect": -1}}}),
                             ("materials/a/roughness", {"materials": {"a": {"roughness": 2}}}), ("materials/a/base_color", {"materials": {"a": {"base_color": (1, 2, 1)}}}),
                             ("materials/a/base_color_texture", {"materials": {"a": {"base_color_texture": numpy.full((2, 2, 3), 255, numpy.int32)}}}),
                             ("materials/a/roughness_texture", {"materials": {"a": {"roughness_texture": numpy.full((2, 2), 255, numpy.uint16)}}}),
                             ("meshes/m/colors", {"meshes": {"m": {**mesh, "colors": numpy.full((3, 4), 255, numpy.int32)}}}), ("environment", {"environment": numpy.full((2, 4, 3), 255, numpy.uint8)}),
                             ("environment", {"environment": numpy.full(3, 255, numpy.uint8)})]:
            with self.subTest(name):
                self.refused(pertev.InputError, name, lambda: pertev.Scene(**{**good, **change}))
        error = self.refused(pertev.InputError, "cameras/c/fov", lambda: pertev.Scene(**good, cameras={"c": {"fov": 190}}))
        self.assertIn("190", str(error))  # degrees, as it was given
        view = {"eye": (0.3, 0.3, 2), "target": (0.3, 0.3, 0), "environment": (1, 1, 1), "ground": "off", **SMALL}
        hashes = {pertev.render(pertev.Scene(**{**good, "meshes": {"m": {**mesh, "colors": colors}}}), **view).hash
                  for colors in (numpy.full((3, 4), 51, numpy.uint8), numpy.full((3, 4), numpy.float32(51) / 255))}
        self.assertEqual(len(hashes), 1)  # uint8 counts from 0 to 255

    def test_what_is_no_scene_is_a_type_error_that_says_what_is_one(self):
        for call in (lambda: pertev.render(None), lambda: pertev.render(3, **SMALL), lambda: pertev.load(None), lambda: pertev.Session(None),
                     lambda: next(pertev.render_chunks(None, POSES)), lambda: pertev.load(self.scene)):
            with self.assertRaises(TypeError) as caught:
                call()
            self.assertIn("built-in scene", str(caught.exception))

    def test_an_array_of_out_is_that_of_color(self):
        color = numpy.zeros((6, 8, 3), numpy.float32)
        picture = pertev.render(self.scene, **SMALL, out=color)
        self.assertIs(picture.color, color)
        self.assertEqual(picture.hash, pertev.render(self.scene, **SMALL).hash)
        self.assertTrue((color == pertev.render(self.scene, **SMALL).color).all())
        for wrong in (color, {"color": color}):
            self.refused(pertev.InputError, "out", lambda: pertev.render(self.scene, cameras=POSES, **SMALL, out=wrong))
        with self.assertRaises(TypeError):
            pertev.render(self.scene, **SMALL, out=pertev.render(self.scene, cameras=POSES, **SMALL))

    def test_unsuitable_out_arrays_are_refused(self):
        read_only = numpy.empty((6, 8, 3), numpy.float32)
        read_only.flags.writeable = False
        whole, unaligned = numpy.empty((6, 8, 6), numpy.float32), numpy.empty(577, numpy.uint8)[1:].view(numpy.float32).reshape(6, 8, 3)
        for wrong, says in [(numpy.empty((8, 6, 3), numpy.float32), r"\(8, 6, 3\); expected \(6, 8, 3\)"), (whole, r"\(6, 8, 6\); expected"), (whole[:, :, 0].copy(), r"\(6, 8\); expected"),
                            (numpy.empty((6, 8, 3)), "float64; expected float32"), (numpy.empty((6, 8, 3), bool), "bool; expected"), (numpy.empty((6, 8, 3), "u1"), "uint8; expected"),
                            (whole[:, :, ::2], "not C-contiguous"), (numpy.asfortranarray(whole[:, :, :3]), "not C-contiguous"),
                            (Elsewhere(whole[:, :, :3].copy()), "is on cuda:0; expected one in the CPU's memory"), (read_only, "read-only"), (unaligned, "multiple of 4"),
                            (numpy.empty((6, 8, 3), ">f4"), "ndarray of >f4 is not"), (OfJax(whole[:, :, :3].copy()), "read-only"), ([1, 2], "list is not an array"), (None, "NoneType is not an array")]:
            error = self.refused(pertev.InputError, "out", lambda: pertev.render(self.scene, **SMALL, out={"color": wrong}))
            self.assertEqual(error.value, "color")
            self.assertRegex(error.reason, says)
        for name in ("depth", "colour", "id"):
            error = self.refused(pertev.InputError, "out", lambda: pertev.render(self.scene, **SMALL, layers="ids", out={name: read_only}))
            self.assertEqual((error.value, error.reason.endswith(" has color, noisy, ids")), (name, True))
        ids = numpy.zeros((6, 8, 3), numpy.int32)
        error = self.refused(pertev.InputError, "out", lambda: pertev.render(self.scene, **SMALL, layers="ids", out={"color": 0 * ids.astype("f4"), "ids": ids}))
        self.assertRegex(error.reason, "int32; expected uint32")
        color = numpy.zeros((6, 8, 3), numpy.float32)
        self.assertIs(pertev.render(self.scene, **SMALL, out=types.MappingProxyType({"color": color})).color, color)

    def test_results_have_their_layers_and_say_why_they_are_not_pickled(self):
        result = pertev.render(self.scene, **SMALL)
        for thing in (result, pertev.Session(self.scene, **SMALL), pertev.render(self.scene, cameras=POSES, **SMALL)):
            with self.assertRaisesRegex(TypeError, "is not pickled; "):
                pickle.dumps(thing)
        layers = pertev.render(self.scene, **SMALL, layers=["uv", "motion"])
        self.assertEqual((layers.uv.shape, layers.motion.shape), ((6, 8, 2), (6, 8, 2)))
        cameras = pickle.loads(pickle.dumps(pertev.Cameras(POSES, [8, 8, 4, 3], convention="opencv")))
        self.assertEqual((cameras.poses == POSES).all() and cameras.settings["convention"], "opencv")


class Interrupts(unittest.TestCase):
    def test_batches_and_frames_end_soon_and_can_continue(self):
        scene = pertev.load("cornell-box", device="cpu")
        session = pertev.Session(scene, size=(16, 12))
        first = next(session).hash
        poses = numpy.repeat(POSES, 500, 0)
        poses[:, :3, 3] = 0.278, 0.273, -0.8
        for work in (lambda: pertev.render(scene, cameras=poses, size=(64, 64), spp=4096),
                     lambda: pertev.render(scene, on_device=True, size=(640, 480), spp=65536), lambda: [0 for _ in session]):
            begun = time.monotonic()
            after(0.3)
            with self.assertRaises(KeyboardInterrupt):
                work()
            self.assertLess(time.monotonic() - begun, 5)
        session.reset()
        self.assertEqual(next(session).hash, first)
        self.assertEqual(pertev.render(scene, **SMALL).hash, pertev.render("cornell-box", **SMALL).hash)

    def test_two_threads_render_at_the_same_time(self):
        """One thread finishes pictures while another renders a picture that takes five seconds."""
        alone = [pertev.render("cornell-box", **SMALL, seed=seed).hash for seed in range(3)]
        long = threading.Thread(target=lambda: pertev.render("cornell-box", size=(64, 48), spp=65536, time_limit=5, threads=1, device="cpu"))
        long.start()
        beside = [pertev.render("cornell-box", **SMALL, seed=seed, threads=1).hash for seed in range(3)]
        self.assertTrue(long.is_alive())
        self.assertEqual(beside, alone)
        long.join()


if __name__ == "__main__":
    unittest.main()
