"""Tests processes: forks, workers, pickled scenes and the viewer."""

import gc
import multiprocessing
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
import urllib.request

import numpy

import pertev

PROGRAM = sys.argv.pop(1) if len(sys.argv) > 1 else ""
SMALL = {"size": (16, 8), "spp": 1, "device": "cpu"}


def hash_of(scene):
    return pertev.render(scene, **SMALL).hash


def run_python(text, environment=None):
    return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, env=environment)


class Processes(unittest.TestCase):
    def test_pyoidn_is_found_where_python_finds_it(self):
        with tempfile.TemporaryDirectory() as folder:
            library = pathlib.Path(folder, "pyoidn/oidn/lib/libOpenImageDenoise.so.2")
            library.parent.mkdir(parents=True)
            library.write_text("no library")
            pathlib.Path(folder, "pyoidn/__init__.py").write_text("raise AssertionError('it was imported')")
            render = "try:\n    pertev.render('cornell-box', size=(4, 4), spp=1, device='cpu', denoise='oidn')\nexcept pertev.InputError as error:\n    print(error)\n"
            for code, path in ((f"import pertev\n{render}", folder), (f"import pertev, sys\nsys.path.append({folder!r})\n{render}", "")):
                environment = {**os.environ, "PYTHONPATH": os.pathsep.join([os.environ.get("PYTHONPATH", ""), path])}
                environment.pop("PERTEV_OIDN", None)
                done = run_python(code, environment)
                if done.stdout: # no other library is there
                    self.assertIn("pip install pyoidn", done.stdout)
                    self.assertIn(str(library), done.stdout)
                else:
                    self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_fork_before_any_work_renders(self):
        done = run_python("import os, pertev\nif os.fork() == 0:\n"
                          "    print(pertev.render('cornell-box', size=(4, 4), spp=1, device='cpu').hash)\n"
                          "else:\n    os.wait()\n")
        self.assertEqual(len(done.stdout.strip()), 32, done.stderr)

    def test_a_fork_after_work_raises_an_error_with_advice(self):
        done = run_python("import os, pertev\nr = lambda: pertev.render('cornell-box', size=(4, 4), spp=1, device='cpu')\n"
                          "r()\nif os.fork() == 0:\n"
                          "    try:\n        r()\n    except pertev.DeviceError as error:\n        print(error, flush=True)\n"
                          "        os._exit(0)\nelse:\n    os.wait()\n    r()\n    print('parent')\n")
        self.assertIn("spawn", done.stdout, done.stderr)
        self.assertIn("parent", done.stdout, done.stderr)

    def test_workers_get_scenes_by_pickling(self):
        scene = pertev.load("cornell-box", max_depth=2)
        expected = hash_of(scene)
        self.assertEqual(hash_of(pickle.loads(pickle.dumps(scene))), expected)
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        with unittest.mock.patch.dict(os.environ, environment):
            with multiprocessing.get_context("spawn").Pool(2) as pool:
                self.assertEqual(pool.map(hash_of, [scene, scene]), [expected] * 2)

    def test_a_forked_pool_whose_argument_is_a_scene_raises_the_error(self):
        done = run_python("import multiprocessing, pertev\ndef hash_of(scene):\n    return pertev.render(scene, size=(4, 4), spp=1).hash\n"
                          "def name_of(scene):\n    return scene.name\n"
                          "scene = pertev.load('cornell-box', device='cpu', max_depth=2)\nscene.params['materials/red/base_color'] = (0, 0, 1)\n"
                          "with multiprocessing.get_context('fork').Pool(1) as pool:\n    for call in (hash_of, name_of):\n"
                          "        try:\n            pool.map(call, [scene])\n        except pertev.DeviceError as error:\n            print('spawn' in str(error))\n")
        self.assertEqual(done.stdout.split(), ["True", "True"], done.stderr)

    def test_a_pickled_scene_that_is_gone_raises_the_error_at_its_first_use(self):
        with tempfile.TemporaryDirectory() as folder:
            pertev.scene("cornell-box", device="cpu").save(f"{folder}/a.glb")
            pickled = pickle.dumps(pertev.load(f"{folder}/a.glb", device="cpu"))
        scene = pickle.loads(pickled)
        for use in (hash_of, pertev.Session, lambda scene: scene.params, lambda scene: scene.bounds):
            with self.assertRaises(pertev.MissingFileError):
                use(scene)

    def test_python_ends_while_daemon_threads_render(self):
        for size, spp in (((800, 600), 4000), ((4, 4), 1)):  # one long picture, and many that begin and end
            with self.subTest(size):
                done = run_python("import pertev, threading, time\nscene = pertev.load('cornell-box', device='cpu')\ndef work():\n    while True:\n"
                                  f"        pertev.render(scene, size={size}, spp={spp})\n"
                                  "for _ in range(3):\n    threading.Thread(target=work, daemon=True).start()\ntime.sleep(0.4)\n")
                self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_importing_is_quick_and_loads_no_driver(self):
        with tempfile.TemporaryDirectory() as folder:  # a library that CUDA's loader would find
            shutil.copy(next(line.split()[-1] for line in pathlib.Path("/proc/self/maps").read_text().splitlines() if "/libm.so" in line),
                        f"{folder}/libcuda.so.1")
            with unittest.mock.patch.dict(os.environ, {"LD_LIBRARY_PATH": folder}):
                # Processor time, because other tests run at the same time.
                done = [run_python("import time; t = time.process_time(); import pertev\n"
                                   "print(time.process_time() - t, 'libcuda' in open('/proc/self/maps').read())").stdout.split()
                        for _ in range(3)]
        self.assertLess(min(float(seconds) for seconds, _ in done), 0.3)
        self.assertEqual({loads for _, loads in done}, {"False"})


class Viewer(unittest.TestCase):
    def test_the_viewer_starts_and_ends(self):
        with unittest.mock.patch.dict(os.environ, {"PERTEV_PROGRAM": PROGRAM}):
            with pertev.view("cornell-box", device="cpu", size=(64, 48), port=0) as viewer:
                page = urllib.request.urlopen(viewer.url, timeout=20).read()
                self.assertIn(b"<html", page.lower())
                self.assertIn(viewer.url, viewer._repr_html_())
                self.assertNotIn("X-Frame-Options", urllib.request.urlopen(viewer.url, timeout=20).headers)
            with self.assertRaises(OSError):
                urllib.request.urlopen(viewer.url, timeout=5)

    def test_view_shows_a_loaded_scene_with_its_settings(self):
        started = []
        with unittest.mock.patch.dict(os.environ, {"PERTEV_PROGRAM": PROGRAM}), \
                unittest.mock.patch("webbrowser.open", started.append):
            scene = pertev.scene("cornell-box", device="cpu", size=(48, 32), max_depth=2, aov=["albedo"])
            with pertev.view(scene, max_depth=3, browser=True) as viewer:
                self.assertEqual(started, [viewer.url])
                command = pathlib.Path(f"/proc/{viewer._process.pid}/cmdline").read_text().split("\0")
            self.assertEqual([command[command.index(flag) + 1] for flag in ("view", "--size", "--max-depth", "--device")],
                             ["cornell-box", "48x32", "3", "cpu"])
            self.assertNotIn("--aov", command)

    def command_of(self, viewer):
        """Returns the viewer's file and settings."""
        words = pathlib.Path(f"/proc/{viewer._process.pid}/cmdline").read_text().split("\0")
        at = words.index("view")
        flags = words[at + 2:-1]
        return words[at + 1], {name[2:].replace("-", "_"): value for name, value in zip(flags, flags[1:]) if name.startswith("--")}

    def test_view_shows_scenes_of_arrays_and_changed_parameters(self):
        triangle = {"vertices": [(0, 0, 0), (1, 0, 0), (0, 1, 0)], "faces": [(0, 1, 2)]}
        sky = numpy.random.default_rng(1).random((4, 8, 3))
        small = {"device": "cpu", "size": (16, 12), "spp": 4}
        of_arrays = pertev.Scene(meshes={"a": triangle}, instances={"a": {"mesh": "a"}}, environment=sky,
                                 cameras={"front": {"eye": (0.3, 0.3, 2), "target": (0.3, 0.3, 0)}}, **small)
        of_arrays.params["environment/scale"] = (1, 0.5, 2)
        of_arrays.params["environment/rotation"] = 90
        changed = pertev.scene("cornell-box", environment=(0.3, 0.2, 0.1), environment_scale=2, material=["white roughness=0.5"], **small)
        changed.params["environment/scale"] = (1, 2, 3)
        changed.params["materials/red/base_color"] = (0, 0, 1)
        of_defaults = pertev.Scene(meshes={"a": triangle}, instances={"a": {"mesh": "a"}}, **small)  # a sky and a ground
        with unittest.mock.patch.dict(os.environ, {"PERTEV_PROGRAM": PROGRAM}):
            for scene in of_arrays, changed, of_defaults:
                with self.subTest(scene=scene.name), pertev.view(scene) as viewer:
                    file, settings = self.command_of(viewer)
                    self.assertEqual(settings["efficacy"], "683")
                    kept = {name: value for name, value in settings.items() if name.startswith("environment") or name == "ground"}
                    shown, wanted = (pertev.render(of, **small, **values).color for of, values in ((file, kept), (scene, {})))
                    self.assertLess(numpy.abs(shown - wanted).mean(), 0.01 * wanted.mean())
                self.assertFalse(pathlib.Path(file).exists())
            with pertev.view(of_arrays, environment=(1, 1, 1)) as viewer:
                settings = self.command_of(viewer)[1]
                self.assertEqual((settings["environment"], "environment_rotation" in settings), ("1,1,1", False))

    def test_errors_are_those_of_render(self):
        with unittest.mock.patch.dict(os.environ, {"PERTEV_PROGRAM": PROGRAM}):
            for kind, setting, value, call in ((pertev.MissingFileError, "", "", lambda: pertev.view("none.glb")),
                                               (pertev.InputError, "max_depth", "deep", lambda: pertev.view("cornell-box", max_depth="deep"))):
                with self.assertRaises(kind) as caught:
                    call()
                self.assertEqual((caught.exception.setting, caught.exception.value), (setting, value))
                self.assertNotIn("--", str(caught.exception))
            with self.assertRaisesRegex(TypeError, "^'denoise' is for pictures, not for the viewer"):
                pertev.view("cornell-box", denoise="oidn")

    def test_view_has_the_settings_of_the_program(self):
        with tempfile.NamedTemporaryFile("w") as file, unittest.mock.patch.dict(os.environ, {"PERTEV_PROGRAM": PROGRAM}):
            os.chmod(file.name, 0o600)
            file.write("0123456789abcdef0123456789abcdef")
            file.flush()
            with pertev.view("cornell-box", device="cpu", size=(16, 12), restir="di", host="localhost", token_file=file.name) as viewer:
                settings = self.command_of(viewer)[1]
                self.assertEqual((settings["restir"], settings["host"], settings["token_file"]), ("di", "localhost", file.name))
                self.assertTrue(viewer.url.startswith("http://localhost:"))

    def test_a_viewer_ends_with_its_last_reference_and_with_python(self):
        with unittest.mock.patch.dict(os.environ, {"PERTEV_PROGRAM": PROGRAM}):
            viewer = pertev.view("cornell-box", device="cpu", size=(16, 12))
            process = viewer._process
            del viewer
            gc.collect()
            self.assertIsNotNone(process.poll())
            for end in ("", "os._exit(0)", "os.kill(os.getpid(), 9)"):  # the last ones run no code of Python's
                with self.subTest(end):
                    done = run_python("import os, pertev\nv = pertev.view('cornell-box', device='cpu', size=(16, 12))\n"
                                      f"print(v._process.pid, flush=True)\n{end}\n")
                    begun, command = time.monotonic(), pathlib.Path(f"/proc/{done.stdout.strip()}/cmdline")
                    while command.exists() and command.read_bytes() and time.monotonic() - begun < 20:
                        time.sleep(0.02)
                    self.assertFalse(command.exists() and command.read_bytes(), done.stderr)


if __name__ == "__main__":
    unittest.main()
