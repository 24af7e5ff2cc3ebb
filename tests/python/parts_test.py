"""Tests of parts, checkpoints and merged pictures: they have the bytes of one render, as the program's have."""

import json
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy

import pertev

from device_argument import DEVICE

PROGRAM = sys.argv.pop(1)
SMALL = {"size": (20, 16), "device": DEVICE, "exposure": 0}


class Parts(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.scene = pertev.load("cornell-box", device=DEVICE)

    def parts(self, count, **values):
        """Renders the parts, and returns their files."""
        files = [self.folder / f"{i}.pvf" for i in range(1, count + 1)]
        for i, file in enumerate(files, 1):
            pertev.render(self.scene, part=(i, count), output=file, **SMALL, **values)
        return files

    def refused(self, kind, setting, call):
        with self.assertRaises(kind) as caught:
            call()
        self.assertEqual(getattr(caught.exception, "setting", ""), setting)
        return caught.exception

    def test_merged_parts_are_the_whole_picture(self):
        for values in ({}, {"integrator": "photon_map"}, {"integrator": "bidirectional"}, {"transparent": True, "layers": ["ids", "normal"]}):
            with self.subTest(values):
                whole = pertev.render(self.scene, spp=5, **SMALL, **values)
                files = self.parts(3, spp=5, **values)
                merged = pertev.merge(files[::-1])
                self.assertEqual((merged.hash, merged.samples), (whole.hash, 5))
                numpy.testing.assert_array_equal(merged.color, whole.color)
                self.assertEqual(merged.layers.keys(), whole.layers.keys())
                for name, layer in whole.layers.items():
                    numpy.testing.assert_array_equal(merged.layers[name], layer)
                differ = {key for key in whole.info if merged.info[key] != whole.info[key]}
                self.assertLessEqual(differ, {key for key in whole.info if key.endswith("_seconds")})

    def test_outputs_of_a_merge_are_those_of_a_render(self):
        names = ["a.exr", "a.png"]
        pertev.render(self.scene, spp=4, output=[self.folder / f"whole.{name}" for name in names], **SMALL)
        pertev.merge(self.parts(2, spp=4), output=[self.folder / name for name in [*names, "all.pvf"]])
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "whole.a.png").read_bytes())
        self.assertTrue(pertev.compare(self.folder / "a.exr", self.folder / "whole.a.exr")["equal"])
        again = pertev.merge(self.folder / "all.pvf")
        self.assertTrue(pertev.compare(again, self.folder / "a.exr")["equal"])
        pertev.write(self.folder / "b.png", again, curve="agx")
        pertev.write(self.folder / "b.exr", again)
        self.assertEqual((self.folder / "b.png").read_bytes(), (self.folder / "a.png").read_bytes())
        info = json.loads(subprocess.run([PROGRAM, "info", self.folder / "b.exr", "--json"], check=True, capture_output=True, text=True).stdout)
        self.assertEqual(info["pertev.hash"], again.hash)
        self.assertNotIn("pertev.exposure", info)
        with self.assertRaises(AttributeError):
            again.pose
        with self.assertRaises(AttributeError):
            again.K

    def test_a_merge_is_shown_as_requested(self):
        shown = {"tone_map": "aces", "exposure": -1.5}
        pertev.render(self.scene, spp=4, output=self.folder / "whole.png", **{**SMALL, **shown})
        merged = pertev.merge(self.parts(2, spp=4), output=self.folder / "a.png", **shown)
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "whole.png").read_bytes())
        self.assertEqual((merged.info["tone_map"], merged.info["exposure"]), ("aces", -1.5))
        for setting, wrong in (("tone_map", "sepia"), ("exposure", "bright"), ("exposure", "auto")):
            self.refused(pertev.InputError, setting, lambda: pertev.merge([self.folder / "1.pvf", self.folder / "2.pvf"], **{setting: wrong}))

    def test_the_programs_parts_and_those_of_a_call_are_parts_of_one_picture(self):
        whole = pertev.render(self.scene, spp=6, **SMALL)
        pertev.render(self.scene, spp=6, part=(0, 2), part_base=0, output=self.folder / "0.pvf", **SMALL)
        subprocess.run([PROGRAM, "render", "cornell-box", "--size", "20x16", "--device", DEVICE, "--exposure", "0", "--spp", "6", "--part", "2/2",
                        "-o", self.folder / "1.pvf", "-q"], check=True)
        self.assertEqual(pertev.merge([self.folder / "0.pvf", self.folder / "1.pvf"]).hash, whole.hash)

    def test_samples_merge_to_a_partial_picture_and_then_to_the_whole_one(self):
        first = pertev.render(self.scene, samples=(0, 3), output=self.folder / "a.pvf", **SMALL)
        self.assertEqual(first.hash, pertev.render(self.scene, spp=3, **SMALL).hash)
        pertev.render(self.scene, samples="5:8", output=self.folder / "b.pvf", **SMALL)
        files = [self.folder / "a.pvf", self.folder / "b.pvf"]
        error = self.refused(pertev.InputError, "", lambda: pertev.merge(files))
        self.assertEqual(error.file, str(files[0]))
        some = pertev.merge(files, partial=True, output=self.folder / "some.pvf")
        self.assertEqual((some.samples, "least_spp" in some.info), (6, False))
        pertev.render(self.scene, samples="3:5", output=self.folder / "c.pvf", **SMALL)
        self.assertEqual(pertev.merge([self.folder / "c.pvf", self.folder / "some.pvf"]).hash, pertev.render(self.scene, spp=8, **SMALL).hash)

    def test_a_partial_picture_of_rows_says_what_they_have(self):
        pertev.render(self.scene, spp=3, rows="0:4", output=self.folder / "a.pvf", **SMALL)
        some = pertev.merge(self.folder / "a.pvf", partial=True)
        self.assertEqual((some.samples, some.info["least_spp"], some.info["row_samples"]), (3, 0, {"0:4": 3, "4:16": 0}))
        numpy.testing.assert_array_equal(some.color[:4], pertev.render(self.scene, spp=3, **SMALL).color[:4])
        self.assertFalse(some.color[4:].any())

    def test_a_part_without_samples_is_black_and_warned_of(self):
        with self.assertLogs("pertev", "WARNING") as logged:
            part = pertev.render(self.scene, spp=1, part=(1, 4), **SMALL)
        self.assertEqual((part.samples, part.color.any(), len(logged.output)), (0, False, 1))
        self.assertIn("no samples", logged.output[0])
        with self.assertNoLogs("pertev", "WARNING"):
            self.assertEqual(pertev.render(self.scene, spp=1, part=(4, 4), **SMALL).samples, 1)

    def test_a_part_does_not_open_the_scene_again(self):
        pertev.render(self.scene, spp=2, **SMALL)
        before = pertev.render(self.scene, spp=2, **SMALL).info["build_seconds"]
        part = pertev.render(self.scene, spp=2, part=(1, 2), **SMALL)
        self.assertEqual((part.samples, part.info["build_seconds"]), (1, before))

    def test_a_checkpoint_goes_on_to_the_same_picture(self):
        file = self.folder / "c.pvf"
        pertev.render(self.scene, spp=3, checkpoint=file, **SMALL)
        self.assertEqual(pertev.merge(file, partial=True).samples, 3)
        more = pertev.render(self.scene, spp=7, checkpoint=file, checkpoint_every=30, layers=(), **SMALL)
        whole = pertev.render(self.scene, spp=7, **SMALL)
        self.assertEqual((more.hash, more.samples), (whole.hash, 7))
        out = numpy.zeros((16, 20, 3), numpy.float32)
        self.assertIs(pertev.render(self.scene, spp=7, checkpoint=file, out={"color": out}, **SMALL).color, out)
        numpy.testing.assert_array_equal(out, whole.color)
        pertev.render(self.scene, spp=7, checkpoint=file, output=self.folder / "all.pvf", **SMALL)
        self.assertEqual(pertev.merge(self.folder / "all.pvf").hash, whole.hash)
        self.refused(pertev.InputError, "checkpoint", lambda: pertev.render(self.scene, spp=7, seed=1, checkpoint=file, **SMALL))

    def test_an_interrupted_render_leaves_its_checkpoint(self):
        file = self.folder / "c.pvf"

        def press():
            for _ in range(600):
                time.sleep(0.1)
                if file.exists():
                    break
            signal.raise_signal(signal.SIGINT)

        thread = threading.Thread(target=press)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            pertev.render(self.scene, spp=1_000_000, checkpoint=file, checkpoint_every=0.1, output=self.folder / "x.exr", **SMALL)
        thread.join()
        self.assertFalse((self.folder / "x.exr").exists())
        kept = pertev.merge(file, partial=True).samples
        whole = pertev.render(self.scene, spp=kept + 1, checkpoint=self.folder / "d.pvf", **SMALL)
        self.assertEqual(pertev.render(self.scene, spp=kept + 1, checkpoint=file, **SMALL).hash, whole.hash)

    def test_refusals_are_exceptions_of_their_kinds(self):
        files = self.parts(2, spp=4)
        overlap = self.refused(pertev.InputError, "", lambda: pertev.merge([*files, files[1]]))
        self.assertEqual(overlap.file, str(files[1]))
        self.assertEqual(pickle.loads(pickle.dumps(overlap)).file, overlap.file)
        self.refused(pertev.InputError, "files", lambda: pertev.merge([]))
        self.refused(pertev.InputError, "", lambda: pertev.merge(self.folder / "nowhere.pvf"))
        self.refused(pertev.WriteError, "", lambda: pertev.merge(files, output=self.folder / "nowhere" / "x.exr"))
        pertev.render(self.scene, spp=4, seed=1, part=(2, 2), output=self.folder / "other.pvf", **SMALL)
        self.assertEqual(self.refused(pertev.InputError, "", lambda: pertev.merge([files[0], self.folder / "other.pvf"])).file,
                         str(self.folder / "other.pvf"))
        bytes_of = files[0].read_bytes()
        (self.folder / "flipped.pvf").write_bytes(bytes_of[:-30] + bytes([bytes_of[-30] ^ 1]) + bytes_of[-29:])
        self.refused(pertev.InputError, "", lambda: pertev.merge([self.folder / "flipped.pvf", files[1]]))
        for setting, values in [("part", {"part": (3, 2)}), ("part", {"part": "x"}), ("samples", {"samples": (4, 4)}), ("part_base", {"part_base": 0}),
                                ("output", {"checkpoint": self.folder / "x.pvf", "output": self.folder / "x.pvf"})]:
            with self.subTest(values):
                self.refused(pertev.InputError, setting, lambda: pertev.render(self.scene, **SMALL, **values))
        for values in ({"part": (1, 2)}, {"samples": (0, 1)}, {"checkpoint": "x.pvf"}):
            with self.subTest(values):
                for call in (lambda: pertev.render(self.scene, on_device=True, **SMALL, **values), lambda: pertev.load("cornell-box", **values),
                             lambda: pertev.Session(self.scene, fps=24, **values)):
                    with self.assertRaises(TypeError):
                        call()


if __name__ == "__main__":
    unittest.main()
