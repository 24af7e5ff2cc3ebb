#!/usr/bin/env python3
"""Scripts that measure the jobs of bench/jobs.json: they write measurements, and a difference between devices has status 1."""

import pathlib
import subprocess
import sys

from cli_run import PROGRAM, CliTest, main

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import make_tables  # noqa: E402  pylint: disable=wrong-import-position


class Scripts(CliTest):
    def run_script(self, name, *arguments):
        return subprocess.run([sys.executable, ROOT / "tools" / name, PROGRAM, self.path("no-scenes"), *arguments], cwd=self.path("."),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)

    def test_measuring_jobs_writes_measurements_and_a_page(self):
        small = ["--", "--size", "24x16", "--spp", "1", "--device", "cpu"]
        done = self.run_script("measure.py", "out", "transport/cornell-box, path", "noise/bunny", *small)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("bunny", done.stderr)
        measured = make_tables.load(pathlib.Path(self.path("out/cornell-box,-path.json")).read_text(encoding="utf-8"))
        faults = [fault for fault in make_tables.faults_of("x", measured) if "names no commit" not in fault]  # for a build without Git
        self.assertEqual(faults, [])
        self.assertEqual(len(measured["tables"][-1]["rows"]), 1)
        self.assertTrue(pathlib.Path(self.path("out/page.html")).exists())

    def test_comparing_devices_that_differ_or_fail_ends_with_1(self):
        same = self.run_script("compare_devices.py", "1", "--only", "cornell-box", "--devices", "cpu", "cpu")
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        self.assertEqual(same.stdout.count(" same\n"), 2)  # a picture, and light at a point
        bad = self.run_script("compare_devices.py", "1", "--only", "cornell-box", "--devices", "cpu", "nothing")
        self.assertEqual((bad.returncode, bad.stdout.count(" DIFFERENT\n")), (1, 2))


if __name__ == "__main__":
    main()
