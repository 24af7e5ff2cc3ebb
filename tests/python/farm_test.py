"""Tests of pertev.farm with the real Ray and Dask: the picture of parts is that of one render, also if a worker is killed.

It runs by the Python of PERTEV_FARM_PYTHON, which has PyPI's `ray` and `dask[distributed]` (.ci/run makes one), and skips what is not there."""

import importlib.util
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

FARM_PYTHON = os.environ.get("PERTEV_FARM_PYTHON", "")
if FARM_PYTHON and os.path.realpath(sys.prefix) != os.path.realpath(pathlib.Path(FARM_PYTHON).parent.parent):
    os.execv(FARM_PYTHON, [FARM_PYTHON, *sys.argv])

os.environ.update(RAY_USAGE_STATS_ENABLED="0", RAY_DEDUP_LOGS="0")

import numpy

import pertev
import pertev.farm

JOB = {"size": (48, 36), "spp": 2048, "threads": 1, "device": "cpu", "exposure": 0}  # seconds for each part


def has(name):
    return importlib.util.find_spec(name) is not None


def commands():
    """The command lines and parents of all processes that there are, by their numbers."""
    found = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            parent = int((folder / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()[1])
            found[int(folder.name)] = ((folder / "cmdline").read_bytes().decode(errors="replace"), parent)
        except (OSError, ValueError):
            pass  # it has ended
    return found


def descends(process, known):
    while process in known:
        if process == os.getpid():
            return True
        process = known[process][1]
    return False


class Killer(threading.Thread):
    """Kills the first of our processes that `finds` returns, once, after it has worked for a moment."""

    def __init__(self, finds):
        super().__init__()
        self.finds, self.killed = finds, None
        self.start()

    def run(self):
        until = time.monotonic() + 120
        while self.killed is None and time.monotonic() < until:
            time.sleep(0.05)
            victim = self.finds()
            if victim is not None:
                time.sleep(0.3)
                os.kill(victim, signal.SIGKILL)
                self.killed = victim


class Farm(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def check(self, merged, killer):
        killer.join()
        self.assertIsNotNone(killer.killed)
        self.assertEqual(merged.samples, JOB["spp"])
        self.assertEqual(merged.hash, pertev.render("cornell-box", **{**JOB, "threads": 2}).hash)
        self.assertTrue(pertev.compare(merged, self.folder / "a.exr")["equal"])

    @unittest.skipUnless(has("ray"), "ray is not installed")
    def test_ray_renders_the_part_of_a_killed_worker_again(self):
        import ray
        ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, configure_logging=False)
        self.addCleanup(ray.shutdown)

        def worker():
            known = commands()
            return next((process for process, (line, _) in known.items()
                         if line.startswith("ray::_render_part") and descends(process, known)), None)

        killer = Killer(worker)
        merged = pertev.farm.ray("cornell-box", parts=3, output=self.folder / "a.exr", **JOB)
        self.check(merged, killer)
        with self.assertRaises(pertev.InputError) as caught:
            pertev.farm.ray("cornell-box", parts=2, **{**JOB, "max_depth": -1})
        self.assertEqual(caught.exception.setting, "max_depth")

    @unittest.skipUnless(has("ray"), "ray is not installed")
    def test_the_example_of_ray_has_the_bytes_of_one_render(self):
        example = pathlib.Path(__file__).parents[2] / "examples/ray_farm.py"
        done = subprocess.run([sys.executable, example, "cornell-box", self.folder / "a.exr", self.folder / "a.png", "--parts", "3", "--spp", "8", "--size",
                               "24x18"], capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = pertev.render("cornell-box", size=(24, 18), spp=8, device="cpu", output=self.folder / "b.png")
        self.assertEqual(done.stdout.splitlines()[-1], f"8 spp, {whole.hash}")
        self.assertTrue(pertev.compare(whole, self.folder / "a.exr")["equal"])
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())

    @unittest.skipUnless(has("distributed"), "dask[distributed] is not installed")
    def test_dask_renders_the_part_of_a_killed_worker_again(self):
        import dask
        from distributed import Client, LocalCluster
        dask.config.set({"distributed.admin.tick.limit": "1h"})
        cluster = self.enterContext(LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50))
        client = self.enterContext(Client(cluster))
        processes = client.run(os.getpid)

        def worker():
            return next((processes[address] for address, tasks in client.processing().items() if tasks and address in processes), None)

        killer = Killer(worker)
        merged = pertev.farm.dask(client, pertev.load("cornell-box"), parts=3, output=self.folder / "a.exr", **JOB)
        self.check(merged, killer)
        with self.assertRaises(pertev.InputError) as caught:
            pertev.farm.dask(client, "cornell-box", parts=2, **{**JOB, "max_depth": -1})
        self.assertEqual(caught.exception.setting, "max_depth")

    def test_errors_of_every_worker_are_raised_by_the_caller(self):
        for values, kind in [({"parts": 0}, ValueError), ({"parts": 2, "part": (1, 2)}, TypeError), ({"parts": 2, "samples": (0, 1)}, TypeError),
                             ({"parts": 2, "checkpoint": "c.pvf"}, TypeError)]:
            with self.subTest(values), self.assertRaises(kind):
                pertev.farm.dask(None, "cornell-box", **values)

    def test_the_number_of_parts_is_an_integer_of_any_kind(self):
        from pertev import farm
        numbers = [farm._source_of("cornell-box", parts, {})[1] for parts in (2, numpy.int64(2), numpy.array(2))]
        self.assertEqual(numbers, [2, 2, 2])
        for wrong in (numpy.int64(0), 2.0, "2", None):
            with self.subTest(repr(wrong)), self.assertRaises(ValueError):
                farm._source_of("cornell-box", wrong, {})

    def test_parts_that_cannot_be_merged_are_kept(self):
        from pertev import farm
        job = {**JOB, "spp": 4}
        films = [farm._render_part("cornell-box", i, 2, job) for i in (1, 2)]
        with self.assertRaises(pertev.Error) as caught:
            farm._merged(iter(films), str(self.folder / "no such folder" / "a.exr"))
        kept = pathlib.Path(caught.exception.__notes__[0].removeprefix("the parts are kept in "))
        self.addCleanup(shutil.rmtree, kept)
        merged = pertev.merge(sorted(kept.glob("*.pvf")), output=self.folder / "a.exr")
        self.assertEqual(merged.hash, pertev.render("cornell-box", **job).hash)


if __name__ == "__main__":  # workers that are spawned import this file
    sys.argv.pop(1)
    unittest.main()
