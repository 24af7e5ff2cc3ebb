"""Tests the Python package in the build folder: `render_test.py PROGRAM`. Its pictures must equal the program's."""

import json
import logging
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock

import numpy

import pertev

PROGRAM = sys.argv.pop(1)


def rendered_by_program(*arguments):
    with tempfile.TemporaryDirectory() as folder:
        lines = subprocess.run([PROGRAM, "render", *arguments, "--json", "-o", f"{folder}/a.exr"], check=True,
                               capture_output=True, text=True).stdout.splitlines()
    return next(line for line in map(json.loads, lines) if "layers_hash" in line)


class Render(unittest.TestCase):
    def test_a_picture_equals_the_command_lines(self):
        picture = pertev.render("cornell-box", size=(48, 32), spp=4, seed=7, eye=(0, 1, 3.5), device="cpu")
        by_program = rendered_by_program("cornell-box", "--size", "48x32", "--spp", "4", "--seed", "7", "--eye",
                                         "0,1,3.5", "--device", "cpu")
        self.assertEqual(picture.hash, by_program["hash"])
        self.assertEqual(picture.color.shape, (32, 48, 3))
        self.assertEqual(picture.color.dtype, numpy.float32)
        self.assertEqual(picture.info["spp"], 4)
        self.assertEqual(picture.info["settings"]["settings"]["size"], "48x32")

    def test_a_picture_has_the_layers_that_were_requested(self):
        picture = pertev.render("cornell-box", size="16x8", spp=2, layers=["depth", "albedo", "normal", "ids"])
        self.assertEqual(sorted(picture.layers), ["albedo", "depth", "id", "normal"])
        self.assertEqual(picture.depth.shape, (8, 16))
        self.assertEqual(picture.ids.dtype, numpy.uint32)
        self.assertTrue(0 < picture.depth[4, 8] < 10)
        lengths = numpy.linalg.norm(picture.normal, axis=2)
        self.assertTrue((lengths < 1.001).all() and lengths.max() > 0.9)
        with self.assertRaises(AttributeError):
            picture.position

    def test_arrays_outlive_the_result(self):
        color = pertev.render("cornell-box", size=(8, 8), spp=1).color
        kept = color.copy()
        for _ in range(3):
            pertev.render("cornell-box", size=(8, 8), spp=1, seed=5)
        self.assertTrue((color == kept).all())

    def test_a_result_has_the_denoised_and_the_noisy_picture(self):
        picture = pertev.render("cornell-box", size=(16, 16), spp=1, denoise="svgf")
        plain = pertev.render("cornell-box", size=(16, 16), spp=1)
        self.assertEqual(picture.hash, plain.hash)
        self.assertTrue((picture.noisy == plain.color).all())
        self.assertFalse((picture.color == plain.color).all())

    def test_files_are_written(self):
        with tempfile.TemporaryDirectory() as folder:
            names = [pathlib.Path(folder) / "a.exr", pathlib.Path(folder) / "a.png"]
            picture = pertev.render("cornell-box", size=(8, 8), spp=1, output=names)
            info = json.loads(subprocess.run([PROGRAM, "info", names[0], "--json"], check=True, capture_output=True,
                                             text=True).stdout.splitlines()[-1])
            self.assertIn(picture.hash, json.dumps(info))
            self.assertEqual(names[1].read_bytes()[:4], b"\x89PNG")

    def test_info_has_all_metadata_of_an_exr(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = pertev.render("cornell-box", size=(8, 8), spp=1, denoise="svgf", layers=["crypto_object"], output=f"{folder}/a.exr")
            info = json.loads(subprocess.run([PROGRAM, "info", f"{folder}/a.exr", "--json"], check=True, capture_output=True, text=True).stdout)
        names = {name.removeprefix("pertev.") for name in info if name.startswith(("pertev.", "cryptomatte/"))}
        self.assertEqual(set(picture.info), names)
        self.assertIn("tall block", next(str(value) for name, value in picture.info.items() if name.endswith("/manifest")))

    def test_the_albedo_of_a_conductor_is_its_reflectance_at_normal_incidence(self):
        eta, k = numpy.array([0.2, 0.9, 1.1]), numpy.array([3.9, 2.4, 1.9])
        metal = f"white kind=conductor eta={','.join(map(str, eta))} k={','.join(map(str, k))}"
        before, after = (pertev.render("cornell-box", size=(16, 16), spp=1, layers=["albedo"], layers_at="centre", material=material).albedo
                         for material in ([], [metal]))
        changed = (before != after).any(-1)
        self.assertGreater(changed.sum(), 50)
        numpy.testing.assert_allclose(after[changed], numpy.broadcast_to(((eta - 1)**2 + k**2) / ((eta + 1)**2 + k**2), (changed.sum(), 3)), rtol=1e-5)

    def test_layers_may_be_requested_with_a_file_that_has_none(self):
        with tempfile.TemporaryDirectory() as folder:
            picture = pertev.render("cornell-box", size=(8, 8), spp=1, layers="depth", output=f"{folder}/a.png")
            self.assertEqual(picture.depth.shape, (8, 8))
            with self.assertRaises(pertev.InputError) as caught:
                pertev.render("cornell-box", size=(8, 8), spp=1, exposure=1, output=f"{folder}/a.exr")
            self.assertEqual(caught.exception.setting, "exposure")

    def test_values_may_have_all_types(self):
        """NumPy's scalars and arrays are valid values, like Python's."""
        a = pertev.render("cornell-box", size=numpy.array([8, 6]), spp=numpy.int64(1), exposure=numpy.float32(0),
                          transparent=numpy.True_, output=())
        self.assertEqual(a.color.shape, (6, 8, 4))


class Errors(unittest.TestCase):
    def test_the_error_for_a_wrong_value_names_the_setting(self):
        with self.assertRaises(pertev.InputError) as caught:
            pertev.render("cornell-box", spp=-1)
        self.assertEqual((caught.exception.setting, caught.exception.value), ("spp", "-1"))
        self.assertIsInstance(caught.exception, ValueError)

    def test_values_over_a_limit_are_refused(self):
        with self.assertRaises(pertev.LimitError) as caught:
            pertev.render("cornell-box", size=(10**6, 10**6))
        self.assertEqual(caught.exception.setting, "size")

    def test_unknown_names_and_types_are_refused(self):
        for wrong in ({"sppp": 1}, {"spp": object()}, {"spp": True}, {"spp": numpy.True_}):
            with self.assertRaises(TypeError):
                pertev.render("cornell-box", **wrong)

    def test_a_missing_or_broken_file_is_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            broken = pathlib.Path(folder) / "broken.gltf"
            broken.write_text('{"asset":')
            for path in (broken, broken.with_name("none.glb")):
                with self.assertRaises(pertev.InputError) as caught:
                    pertev.render(path)
                self.assertEqual(caught.exception.file, str(path))

    def test_a_file_that_cannot_be_written_is_an_error(self):
        with self.assertRaises(pertev.Error):
            pertev.render("cornell-box", size=(4, 4), spp=1, output="/nowhere/a.png")

    def test_sequences_are_refused(self):
        with self.assertRaises(TypeError):
            pertev.render("cornell-box", frames="0-3")
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "settings.json"
            file.write_text('{"version":1,"settings":{"frames":"0-3","turntable":4}}')
            with self.assertRaises(pertev.InputError) as caught:
                pertev.render("cornell-box", settings=file)
            self.assertEqual(caught.exception.setting, "frames")

    def test_settings_that_exclude_each_other_are_refused(self):
        with self.assertRaises(pertev.InputError):
            pertev.render("cornell-box", integrator="path", photons=10)

    def test_messages_have_python_names(self):
        with self.assertRaises(pertev.Error) as caught:
            pertev.render("cornell-box", integrator="path", photons=10)
        self.assertNotIn("--", str(caught.exception))
        self.assertNotIn("`", str(caught.exception))


class Running(unittest.TestCase):
    def test_messages_are_logged(self):
        with self.assertLogs("pertev", logging.INFO) as logged:
            pertev.render("cornell-box", size=(4, 4), spp=1, time=1)
        self.assertTrue(any(record.levelno == logging.WARNING for record in logged.records))

    def test_keyboard_interrupt_ends_a_render(self):
        begun = time.monotonic()
        threading.Timer(0.5, lambda: signal.raise_signal(signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            pertev.render("cornell-box", size=(1920, 1080), spp=65536, device="cpu")
        self.assertLess(time.monotonic() - begun, 10)

    def test_a_keyboard_interrupt_ends_the_reading_of_a_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "big.obj"
            file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n" * 4_000_000)
            begun = time.process_time()  # processor time does not depend on other processes
            threading.Timer(0.2, lambda: signal.raise_signal(signal.SIGINT)).start()
            with self.assertRaises(KeyboardInterrupt):
                pertev.load(file)
            self.assertLess(time.process_time() - begun, 2.5)  # reading all takes over ten

    def test_a_keyboard_interrupt_changes_no_files(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "a.exr"
            file.write_text("old")
            threading.Timer(0.5, lambda: signal.raise_signal(signal.SIGINT)).start()
            with self.assertRaises(KeyboardInterrupt):
                pertev.render("cornell-box", size=(640, 480), spp=65536, device="cpu", output=file)
            self.assertEqual(file.read_text(), "old")

    def test_a_log_handler_that_raises_does_not_end_a_render(self):
        class Raising(logging.Handler):
            def emit(self, record):
                raise RuntimeError("of the test")

        handler = Raising()
        logging.getLogger("pertev").addHandler(handler)
        try:
            with unittest.mock.patch("sys.unraisablehook") as hook:
                picture = pertev.render("cornell-box", size=(4, 4), spp=1, time=1)
        finally:
            logging.getLogger("pertev").removeHandler(handler)
        self.assertEqual(picture.color.shape, (4, 4, 3))
        self.assertTrue(hook.called)

    def test_threads_render_side_by_side(self):
        alone = [pertev.render("cornell-box", size=(32, 32), spp=8, seed=seed).hash for seed in range(4)]
        beside = [None] * 4

        def work(seed):
            beside[seed] = pertev.render("cornell-box", size=(32, 32), spp=8, seed=seed, threads=1).hash

        threads = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(alone, beside)

    def test_the_interpreter_lock_is_released(self):
        count = 0
        done = threading.Event()

        def render():
            pertev.render("cornell-box", size=(640, 480), spp=16, device="cpu", threads=1)
            done.set()

        threading.Thread(target=render).start()
        while not done.wait(0.005):
            count += 1
        self.assertGreater(count, 5)


if __name__ == "__main__":
    unittest.main()
