"""Tests pictures as arrays and files: they have the bytes and numbers of the program."""

import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy

import pertev

PROGRAM = sys.argv.pop(1)


def program(*arguments):
    lines = subprocess.run([PROGRAM, *map(str, arguments), "--json"], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    return [json.loads(line) for line in lines]


class Images(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.picture = pertev.render("cornell-box", size=(24, 16), spp=2, device="cpu")

    def test_written_pictures_are_read_back(self):
        for picture in (self.picture, self.picture.color):
            pertev.write(self.folder / "a.exr", picture)
            self.assertTrue((pertev.read(self.folder / "a.exr") == self.picture.color).all())
        info = program("info", self.folder / "a.exr")
        self.assertIn(self.picture.hash, json.dumps(info))

    def test_a_result_is_written_with_layers_and_metadata(self):
        picture = pertev.render("cornell-box", size=(24, 16), spp=2, device="cpu", layers=["depth", "ids"],
                                output=self.folder / "a.exr")
        pertev.write(self.folder / "b.exr", picture)
        a, b = (program("info", self.folder / name)[-1] for name in ("a.exr", "b.exr"))
        self.assertIn("depth", json.dumps(b))
        self.assertIn("scene_hash", json.dumps(b))
        self.assertEqual(json.dumps(a).replace("a.exr", ""), json.dumps(b).replace("b.exr", ""))
        with self.assertRaises(pertev.InputError):
            pertev.write(self.folder / "a.tga", picture)
        with self.assertRaises(pertev.WriteError):
            pertev.write("/nowhere/a.exr", picture)

    def test_tone_mapping_is_that_of_the_program(self):
        pertev.render("cornell-box", size=(24, 16), spp=2, device="cpu", tone_map="agx", exposure=1.5,
                      output=self.folder / "a.png")
        for picture in (self.picture, self.picture.color):
            pertev.write(self.folder / "b.png", picture, curve="agx", exposure=1.5)
            self.assertTrue((pertev.read(self.folder / "a.png") == pertev.read(self.folder / "b.png")).all())
        shown = pertev.tone_map(self.picture, curve="agx", exposure=1.5)
        self.assertEqual((shown.shape, shown.dtype), ((16, 24, 4), numpy.uint8))
        pertev.write(self.folder / "c.png", self.picture, curve="srgb")
        self.assertFalse((pertev.read(self.folder / "a.png") == pertev.read(self.folder / "c.png")).all())

    def test_compare_has_the_numbers_of_the_program(self):
        other = pertev.render("cornell-box", size=(24, 16), spp=4, seed=5, device="cpu")
        files = [self.folder / "a.exr", self.folder / "b.exr"]
        for file, picture in zip(files, (self.picture, other)):
            pertev.write(file, picture)
        for blocks in (1, 4):
            printed = program("compare", *files, "--blocks", blocks)[-1]
            for found in (pertev.compare(self.picture, other, blocks=blocks), pertev.compare(*files, blocks=blocks)):
                for name, value in found.items():
                    self.assertEqual(float(f"{value:.9g}"), printed[name], name)
        self.assertTrue(pertev.compare(other, files[1])["equal"])

    def test_pixels_that_are_not_finite_differ_entirely(self):
        black = numpy.zeros((8, 10, 3), numpy.float32)
        for value in (numpy.nan, numpy.inf, -numpy.inf):
            picture = black.copy()
            picture[3, 4, 1] = value
            for a, b in ((picture, black), (black, picture)):
                found = pertev.compare(a, b)
                self.assertEqual(found["rel_mse"], numpy.inf)
                self.assertGreaterEqual(min(found["flip"], found["hdr_flip"]), 1 / 80)
            pertev.write(self.folder / "a.exr", picture)
            pertev.write(self.folder / "b.exr", black)
            self.assertEqual(program("compare", self.folder / "a.exr", self.folder / "b.exr")[-1]["flip"], float(f"{found['flip']:.9g}"))
        picture[3, 4, 1] = numpy.nan
        self.assertEqual((pertev.compare(picture, black)["flip"], pertev.compare(black, black)["flip"]), (1 / 80, 0))

    def test_pictures_show_themselves(self):
        png = self.picture._repr_png_()
        (self.folder / "a.png").write_bytes(png)
        self.assertEqual(pertev.read(self.folder / "a.png").shape, (16, 24, 3))

    def setting_of(self, call):
        with self.assertRaises(pertev.InputError) as caught:
            call()
        return caught.exception.setting

    def test_wrong_arguments_are_refused(self):
        with self.assertRaises(pertev.InputError) as caught:
            pertev.tone_map(self.picture, curve="none")
        self.assertEqual(caught.exception.setting, "curve")
        with self.assertRaises(pertev.InputError) as caught:
            pertev.write(self.folder / "a.exr", numpy.zeros((2, 2, 7)))
        self.assertEqual(caught.exception.setting, "picture")
        with self.assertRaises(pertev.InputError):
            pertev.compare(self.picture, numpy.zeros((2, 2, 3)))
        picture = numpy.zeros((2, 2, 3))
        for shape in ((0, 4, 3), (4, 0, 3), (0, 4), (4, 0, 4)):
            empty = numpy.zeros(shape)
            for call in (lambda: pertev.compare(empty, empty), lambda: pertev.compare(empty, picture), lambda: pertev.tone_map(empty),
                         *(lambda file=self.folder / f"a.{kind}": pertev.write(file, empty) for kind in ("png", "exr", "hdr", "jpg"))):
                self.assertEqual(self.setting_of(call), "picture")
        for shape in ((2, 2), (2, 2, 1), (2, 2, 2)):
            self.assertEqual(self.setting_of(lambda: pertev.compare(numpy.zeros(shape), picture)), "picture")
            self.assertEqual(self.setting_of(lambda: pertev.compare(picture, numpy.zeros(shape))), "reference")
        self.assertEqual(self.setting_of(lambda: pertev.compare(None, picture)), "picture")
        self.assertEqual(self.setting_of(lambda: pertev.tone_map(None)), "picture")
        self.assertEqual(self.setting_of(lambda: pertev.write(self.folder / "a.exr", None)), "picture")
        self.assertEqual(self.setting_of(lambda: pertev.tone_map(picture, exposure=float("nan"))), "exposure")
        self.assertEqual(self.setting_of(lambda: pertev.compare(picture, picture, blocks=-1)), "blocks")
        self.assertEqual(self.setting_of(lambda: pertev.read("\udcff.exr")), "path")
        for name, call in (("exposure", lambda: pertev.write(self.folder / "a.exr", picture, exposure="a")), ("curve", lambda: pertev.tone_map(picture, curve=3)),
                           ("blocks", lambda: pertev.compare(picture, picture, blocks="a")), ("path", lambda: pertev.write(3, picture))):
            with self.assertRaisesRegex(TypeError, f"^{name}: "):
                call()
        with self.assertRaises(pertev.InputError):
            pertev.read(self.folder / "none.exr")


class Threads(unittest.TestCase):
    def test_other_threads_work_meanwhile_and_compare_is_interrupted(self):
        """The main thread's work takes 0.1 s and more, in which another thread notes the time again and again."""
        picture = numpy.random.default_rng(1).random((900, 1200, 3)).astype(numpy.float32)
        times, done = [], threading.Event()

        def note():
            while not done.is_set():
                times.append(time.monotonic())
                time.sleep(0.002)

        thread = threading.Thread(target=note)
        thread.start()
        try:
            for work in (lambda: pertev.tone_map(picture), lambda: pertev.write("/dev/null/none.png", picture)):
                begun = time.monotonic()
                try:
                    work()
                except pertev.WriteError:
                    pass
                ended = time.monotonic()
                noted = [begun, *(at for at in times if begun < at < ended), ended]
                self.assertLess(max(b - a for a, b in zip(noted, noted[1:])), 0.5 * (ended - begun) + 0.05)
        finally:
            done.set()
            thread.join()
        timer = threading.Timer(0.1, lambda: signal.raise_signal(signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            pertev.compare(picture, picture[::-1])


class Out(unittest.TestCase):
    def compare(self, out, layers, **values):
        """Tests that a render into `out` has the bytes of an ordinary result and no other arrays."""
        scene = pertev.load("cornell-box", size=(24, 16), spp=2, device="cpu")
        for seed in (1, 2):
            expected = pertev.render(scene, seed=seed, layers=layers, **values)
            made = pertev.render(scene, seed=seed, layers=layers, out=out, **values)
            for name, array in out.items():
                self.assertEqual(array.tobytes(), expected.layers.get(name, getattr(expected, name, None)).tobytes(), name)
                self.assertIs(made.layers.get("id" if name == "ids" else name, getattr(made, name, None)), array)
            self.assertEqual(set(made.layers), {"id" if name == "ids" else name for name in out} - {"color", "noisy"})
            for name in ("hash", "color", "noisy"):
                self.assertTrue((getattr(made, name) == getattr(expected, name)).all() if name != "hash"
                                else made.hash == expected.hash, name)
            self.assertEqual({**made.info, "render_seconds": 0}, {**expected.info, "render_seconds": 0})
            self.assertEqual(made._repr_png_(), expected._repr_png_())
        return made, expected

    def arrays(self):
        return {"color": numpy.empty((16, 24, 3), numpy.float32), "depth": numpy.empty((16, 24), numpy.float32),
                "ids": numpy.empty((16, 24, 3), numpy.uint32)}

    def test_arrays_are_filled(self):
        for layers_at in ("samples", "centre"):
            made, expected = self.compare(self.arrays(), ["depth", "ids"], layers_at=layers_at)
        with tempfile.TemporaryDirectory() as folder:
            for name, picture in (("a", made), ("b", expected)):
                pertev.write(f"{folder}/{name}.exr", picture)
            self.assertEqual(*(pertev.read(f"{folder}/{name}.exr").tobytes() for name in "ab"))
        self.compare({"color": numpy.empty((16, 24, 4), numpy.float32)}, [], transparent=True)
        self.compare({"noisy": numpy.empty((16, 24, 3), numpy.float32)}, [])
        self.compare({"depth": numpy.empty((16, 24), numpy.float32)}, ["depth"])
        more = {"noisy": numpy.empty((16, 24, 3), numpy.float32), **self.arrays(), "normal": numpy.empty((16, 24, 3), numpy.float32)}
        for layers_at in ("samples", "centre"):
            self.compare(more, ["depth", "ids", "normal"], layers_at=layers_at)

    def test_arrays_of_quantities_without_a_film_are_filled(self):
        self.compare({"motion": numpy.empty((16, 24, 2), numpy.float32)}, ["motion"])
        self.compare({"direct": numpy.empty((16, 24, 3), numpy.float32)}, [], lpe="direct=LDE")
        self.compare({**self.arrays(), "noisy": numpy.empty((16, 24, 3), numpy.float32)}, ["depth", "ids"], denoise="svgf")

    def test_the_hash_is_of_the_picture(self):
        scene = pertev.load("cornell-box", size=(24, 16), spp=1, device="cpu")
        out = {"color": numpy.empty((16, 24, 3), numpy.float32)}
        first = pertev.render(scene, out=out)
        self.assertNotEqual(pertev.render(scene, seed=5, out=out).hash, first.hash)
        self.assertEqual(pertev.render(scene).hash, first.hash)

    def test_wrong_arrays_are_refused(self):
        scene = pertev.load("cornell-box", size=(24, 16), spp=1, device="cpu")
        for out in ({"color": numpy.empty((24, 16, 3), numpy.float32)}, {"color": numpy.empty((16, 24, 3))},
                    {"depth": numpy.empty((16, 24), numpy.float32)},
                    {"color": numpy.empty((16, 24, 6), numpy.float32)[..., ::2]}):
            with self.assertRaises(pertev.InputError) as caught:
                pertev.render(scene, out=out)
            self.assertEqual(caught.exception.setting, "out")


if __name__ == "__main__":
    unittest.main()
