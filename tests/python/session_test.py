"""Tests sessions: frames have the bytes of `pertev render --frames`, and scenes at a time those of `--time`."""

import base64
import json
import pathlib
import signal
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
SMALL = {"size": (24, 16), "device": DEVICE}
FLAGS = ["--size", "24x16", "--device", DEVICE]


def moving_scene(folder):
    """A triangle that moves to the right for a second in front of a larger one, with a light that brightens."""
    points = [(-0.5, 0, 0), (0.5, 0, 0), (0, 1, 0), (-2, -1, -1), (2, -1, -1), (0, 3, -1)]
    data = b"".join(struct.pack("<3f", *p) for p in points) + struct.pack("<3H", 0, 1, 2) + b"\0\0"
    data += struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 1, 0, 0)
    lengths = (36, 36, 6, 8, 24)
    starts = (0, 36, 72, 80, 88)
    gltf = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"name": "slides", "mesh": 0}, {"name": "stays", "mesh": 1}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": k}, "indices": 2}]} for k in range(2)],
        "animations": [{"samplers": [{"input": 3, "output": 4}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}],
        "accessors": [{"bufferView": k, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [min(p[i] for p in points[3 * k:3 * k + 3]) for i in range(3)],
                       "max": [max(p[i] for p in points[3 * k:3 * k + 3]) for i in range(3)]} for k in range(2)] +
                     [{"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"},
                      {"bufferView": 3, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
                      {"bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": length} for at, length in zip(starts, lengths)],
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]}
    path = pathlib.Path(folder) / "moves.gltf"
    path.write_text(json.dumps(gltf))
    return path


def frames_of_program(scene, *flags):
    with tempfile.TemporaryDirectory() as folder:
        lines = subprocess.run([PROGRAM, "render", str(scene), *FLAGS, *flags, "--json", "-o", f"{folder}/f#.exr"],
                               check=True, capture_output=True, text=True).stdout.splitlines()
    return [event["hash"] for event in map(json.loads, lines) if event.get("event") == "frame"]


class Sessions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.moves = moving_scene(folder.name)

    def test_a_cut_starts_the_history_again(self):
        frames = [frame.hash for frame in pertev.Session(self.moves, frames="0-4", fps=4, cuts=[2], **SMALL)]
        self.assertEqual(frames, frames_of_program(self.moves, "--real-time", "--frames", "0-4", "--fps", "4", "--cuts", "2"))
        self.assertEqual(frames[2:], [frame.hash for frame in pertev.Session(self.moves, frames="2-4", fps=4, **SMALL)])
        self.assertNotEqual(frames[3], [frame.hash for frame in pertev.Session(self.moves, frames="0-4", fps=4, **SMALL)][3])

    def test_several_devices_make_frames_together(self):
        for flags in ({"real_time": False, "spp": 3}, {}, {"restir": "gi"}):
            alone, together = [[frame.hash for frame in self.session_on(devices, **flags)] for devices in ("cpu", "cpu,cpu")]
            self.assertEqual(together, alone, flags)
            self.assertGreater(len(set(alone)), 4)

    def session_on(self, devices, **flags):
        return pertev.Session(pertev.load(self.moves), fps=4, frames="0-5", size=(40, 36), device=devices, **flags)

    def test_frames_of_a_moving_scene_are_those_of_the_program(self):
        session = pertev.Session(pertev.load(self.moves), fps=4, frames="0-5", layers=["depth"], **SMALL)
        frames = list(session)
        self.assertEqual([frame.hash for frame in frames],
                         frames_of_program(self.moves, "--frames", "0-5", "--fps", "4", "--real-time", "--aov", "depth"))
        self.assertEqual(frames[0].depth.shape, (16, 24))
        self.assertEqual([frame.info["frame"] for frame in frames], list(range(6)))
        self.assertEqual(frames[3].info["time"], 0.75)
        self.assertEqual(len({frame.hash for frame in frames}), 6)

    def test_frames_of_a_turntable_are_those_of_the_program(self):
        frames = [frame.hash for frame in pertev.Session("cornell-box", turntable=4, **SMALL)]
        self.assertEqual(frames, frames_of_program("cornell-box", "--turntable", "4", "--real-time"))

    def test_frames_may_be_ordinary_pictures(self):
        frames = [frame.hash for frame in pertev.Session(self.moves, real_time=False, spp=2, fps=2, frames="1-2", **SMALL)]
        self.assertEqual(frames, frames_of_program(self.moves, "--frames", "1-2", "--fps", "2", "--spp", "2"))

    def test_an_interrupted_frame_is_made_again_with_its_history(self):
        # One thread takes so long that the signal comes before its end.
        given = {"real_time": False, "denoise": "svgf", "frames": "0-1", "spp": 64, "size": (64, 64), "threads": 1}
        whole = [frame.color for frame in pertev.Session("cornell-box", turntable=40, **given)]
        session = pertev.Session("cornell-box", turntable=40, **given)
        next(session)
        old = signal.signal(signal.SIGALRM, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGALRM, old)
        with self.assertRaises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, 0.005)
            next(session)
        self.assertEqual(session.frame, 1)
        numpy.testing.assert_array_equal(numpy.asarray(next(session).color), numpy.asarray(whole[1]))
        without = list(pertev.Session("cornell-box", turntable=40, **{**given, "frames": "1-1"}))[0]
        self.assertFalse(numpy.array_equal(numpy.asarray(without.color), numpy.asarray(whole[1])))

    def test_reset_restarts_the_sequence(self):
        session = pertev.Session("cornell-box", **SMALL)
        first = [next(session).hash for _ in range(3)]
        self.assertEqual(session.frame, 3)
        session.reset()
        self.assertEqual([next(session).hash for _ in range(3)], first)
        self.assertEqual(len(set(first)), 3)

    def test_setting_a_camera_between_frames_keeps_the_history(self):
        views = [((0, 0.2, 0.9 - 0.05 * k), (0, 0.2, -1)) for k in range(4)]
        session = pertev.Session("cornell-box", fps=1, **SMALL)
        frames = []
        for eye, target in views:
            session.set(eye=eye, target=target)
            frames.append(next(session).hash)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "path.json"
            path.write_text(json.dumps({"keys": [{"time": float(k), "eye": eye, "target": target}
                                                 for k, (eye, target) in enumerate(views)]}))
            try:
                of_path = frames_of_program("cornell-box", "--frames", "0-3", "--fps", "1", "--real-time", "--camera-path",
                                            str(path))
            except subprocess.CalledProcessError as error:
                self.fail(error.stderr)
        self.assertEqual(frames, of_path)

    def test_frames_show_a_changed_scene(self):
        scene = pertev.load("cornell-box")
        material = next(path for path in scene.params if path.endswith("/base_color"))
        session = pertev.Session(scene, **SMALL)
        next(session)
        scene.params[material] = (0.1, 0.2, 0.9)
        changed = next(session)
        unchanged = pertev.Session("cornell-box", **SMALL)
        next(unchanged)
        self.assertNotEqual(changed.hash, next(unchanged).hash)
        self.assertEqual(changed.info["first_frame"], 0) # the history was kept

    def test_pictures_of_the_scene_do_not_affect_frames(self):
        scene = pertev.load("cornell-box")
        session = pertev.Session(scene, **SMALL)
        frames = []
        for spp in range(1, 4):
            frames.append(next(session).hash)
            pertev.render(scene, spp=spp, integrator="direct", **SMALL)
        session.reset()
        self.assertEqual([next(session).hash for _ in range(3)], frames)

    def test_threads_take_turns(self):
        session = pertev.Session("cornell-box", **SMALL)
        expected = [next(session).hash for _ in range(16)]
        session.reset()
        found, begun = [], threading.Barrier(3)

        def take(count):
            begun.wait()
            for _ in range(count):
                found.append(next(session).hash)

        def change():
            begun.wait()
            for _ in range(50):
                session.set(spp=None, eye=None)
                self.assertLessEqual(session.frame or 0, 16)

        threads = [threading.Thread(target=take, args=(8,)), threading.Thread(target=take, args=(8,)), threading.Thread(target=change)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(found), sorted(expected))

    def test_wrong_settings_are_refused(self):
        with self.assertRaises(TypeError):
            pertev.Session("cornell-box", fpss=3)
        scene = pertev.load("cornell-box", device=DEVICE)
        for setting, values in [("spp", {"spp": "deep"}), ("real_time", {"transparent": True}), ("layers", {"layers": "deepness"}),
                                ("frames", {"frames": "9-3"}), ("spp", {"spp": 4}), ("layers", {"layers": "uv"})]:
            with self.assertRaises(pertev.InputError) as caught:
                pertev.Session(scene, **SMALL, **values)
            self.assertEqual(caught.exception.setting, setting)

    def test_a_wrong_value_is_refused_when_it_is_set_and_changes_nothing(self):
        expected = pertev.Session("cornell-box", **SMALL)
        expected = [next(expected).hash for _ in range(2)]
        for kind, setting, values in [(pertev.InputError, "spp", {"spp": -1, "eye": (0, 1, 3)}), (pertev.InputError, "real_time", {"transparent": True}), (pertev.InputError, "camera", {"camera": "none"}),
                                      (pertev.InputError, "environment", {"environment": "none.exr"}), (pertev.InputError, "device", {"device": "tpu"}), (pertev.InputError, "frames", {"frames": "5-2"}),
                                      (pertev.MissingFileError, "", {"camera_path": "none.json"}), (pertev.LimitError, "size", {"size": (10**6, 10**6)}), (TypeError, None, {"spp": b"1"})]:
            with self.subTest(values):
                session = pertev.Session("cornell-box", **SMALL)
                frames = [next(session).hash]
                with self.assertRaises(kind) as caught:
                    session.set(**values)
                self.assertEqual(getattr(caught.exception, "setting", None), setting)
                frames.append(next(session).hash) # with the history of the first
                self.assertEqual(frames, expected)
        session = pertev.Session("cornell-box", **SMALL) # its scene is not open yet
        for values in ({"spp": -1}, {"spp": 4}, {"frames": "9-3"}):
            with self.assertRaises(pertev.InputError):
                session.set(**values)
        self.assertEqual([next(session).hash for _ in range(2)], expected)


class Times(unittest.TestCase):
    def test_an_open_scene_is_rendered_at_any_time(self):
        with tempfile.TemporaryDirectory() as folder:
            file = moving_scene(folder)
            scene = pertev.load(file)
            loads = set()
            for values in ({}, {"time": 0.25}, {"time": 0.75, "spp": 3}, {"time": 0}, {"time": 0.5, "seed": 3},
                           {"time": 0.5, "eye": (1, 1, 4), "target": (0, 0, 0)}):
                kept, fresh = (pertev.render(of, **{"spp": 2, "ground": "off", **SMALL, **values}) for of in (scene, file))
                self.assertEqual(kept.hash, fresh.hash)
                self.assertEqual(kept.info["settings"], fresh.info["settings"])
                self.assertEqual(kept.info["made_up"], fresh.info["made_up"])
                loads.add(kept.info["load_seconds"])
            self.assertEqual(len(loads), 1) # the scene was not read again
            rest = pertev.render(scene, spp=2, ground="off", **SMALL) # this setting reads it again
            self.assertEqual(rest.hash, pertev.render(file, spp=2, ground="off", **SMALL).hash)
            self.assertNotIn(rest.info["load_seconds"], loads)


if __name__ == "__main__":
    unittest.main()
