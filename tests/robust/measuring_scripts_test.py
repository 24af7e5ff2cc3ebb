#!/usr/bin/env python3
"""Scripts that measure jobs and builds: they write measurements, and a difference between devices has status 1; and the
search of device code for registers that are read too early."""

import pathlib
import subprocess
import sys
import unittest.mock

from cli_run import PROGRAM, CliTest, main

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import check_stalls  # noqa: E402  pylint: disable=wrong-import-position
import measure_builds  # noqa: E402  pylint: disable=wrong-import-position
import measure_tests  # noqa: E402  pylint: disable=wrong-import-position
import make_tables  # noqa: E402  pylint: disable=wrong-import-position


def device_code(*instructions):
    """The text of nvdisasm for a kernel of instructions with their stall cycles."""
    lines = [".text.kernel:"]
    for i, (instruction, stall) in enumerate(instructions):
        lines += [f"        /*{16 * i:04x}*/   {instruction} ;  /* 0x0000000000067805 */", f"   /* 0x{stall << 41:016x} */"]
    return "\n".join([*lines, ""])


class Scripts(CliTest):
    def run_script(self, name, *arguments):
        return subprocess.run([sys.executable, ROOT / "tools" / name, PROGRAM, self.path("no-scenes"), *arguments], cwd=self.path("."),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)

    def rows_of(self, name):
        """Returns the rows of the last table of a file, which must be a measurement."""
        measured = make_tables.load(pathlib.Path(self.path(name)).read_text(encoding="utf-8"))
        measured["command"] = measured["command"].replace(PROGRAM, "build/bin/pertev")
        faults = [fault for fault in make_tables.faults_of("x", measured) if "names no commit" not in fault]  # for a build without Git
        self.assertEqual(faults, [])
        return measured["tables"][-1]["rows"]

    def test_measuring_jobs_writes_measurements_and_a_page(self):
        small = ["--", "--size", "24x16", "--spp", "1", "--device", "cpu"]
        done = self.run_script("measure.py", "out", "transport/cornell-box, path", "noise/bunny", *small)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("bunny", done.stderr)
        self.assertEqual(len(self.rows_of("out/cornell-box,-path.json")), 1)
        self.assertTrue(pathlib.Path(self.path("out/page.html")).exists())

    def test_comparing_devices_that_differ_or_fail_ends_with_1(self):
        same = self.run_script("compare_devices.py", "1", "--only", "cornell-box", "--devices", "cpu", "cpu", "--report", "same.json")
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        picture, light = self.rows_of("same.json")
        self.assertEqual((picture[:2], picture[-1], light[-1]), (["cornell-box", "1 spp"], "yes", "yes"))
        self.assertRegex(picture[2], "^[0-9a-f]{32}$")
        self.assertEqual(same.stdout.count(" same\n"), 2)  # a picture, and light at a point
        bad = self.run_script("compare_devices.py", "1", "--only", "cornell-box", "--devices", "cpu", "nothing")
        self.assertEqual((bad.returncode, bad.stdout.count(" DIFFERENT\n")), (1, 2))

    def test_errors_of_pictures_and_what_tests_print_become_tables(self):
        done = self.run_script("measure_errors.py", "denoiser", "--seeds", "1", "-o", "errors.json", "--", "--size", "24x16")
        self.assertEqual(done.returncode, 0, done.stderr)
        (scene, *flips), = self.rows_of("errors.json")
        self.assertEqual(scene, "cornell-box")  # the folder has no other
        self.assertTrue(flips[0] > flips[2] > 0 and min(flips) > 0, flips)
        printed = "x.cpp(3): MESSAGE: box, 1 pass: whole -0.0031, block 2e-05\nx.cpp(9): MESSAGE: 32 rays: variance 0.00157\nno row: 1\n"
        self.assertEqual(list(measure_tests.tables_of(printed, ["scene", "part"])),
                         [("whole", [("scene", "scene", None), ("part", "part", None), ("whole", "whole", None), ("block", "block", None)], [["box", "1 pass", -0.0031, 2e-5]]),
                          ("variance", [("scene", "scene", None), ("variance", "variance", None)], [["32 rays", 0.00157]])])

    def test_a_viewer_at_rest_has_a_time_for_each_size(self):
        subprocess.run([ROOT / "tools/view_latency.py", PROGRAM, "cornell-box", "--device", "cpu", "--rest", "--size", "64x48", "-o", self.path("rest.json")],
                       check=True, stdout=subprocess.DEVNULL)
        hello, setting = self.rows_of("rest.json")
        self.assertEqual((hello[0], setting[0]), ("the page's hello", "a setting"))
        self.assertTrue(0 < hello[-1] < 60 and 0 < setting[-1] < 60)

    def test_tables_of_shell_scripts_become_measurements(self):
        subprocess.run([ROOT / "tools/measurement.py", self.path("table.json"), PROGRAM, "A title", "tools/check_wheel.sh WHEELS PROGRAM"], check=True,
                       input="what=what\tsize=size=MB\nwheel, 3.11\t79.9\n", text=True)
        self.assertEqual(self.rows_of("table.json"), [["wheel, 3.11", 79.9]])

    def test_a_build_is_measured_in_a_new_clone(self):
        if not (ROOT / ".git").exists():
            self.skipTest("a clone is needed")
        wasted = "python3 -c 'import time\nwhile time.process_time() < 0.3: pass'"
        with unittest.mock.patch.dict(measure_builds.STEPS, {"ci": ("made", "true", f"test -e setup.sh && mkdir -p build/bin && head -c 2000000 /dev/zero > build/x && {wasted}")}):
            (row, program), = measure_builds.rows_of("HEAD", ["ci"], self.path("."))
        self.assertEqual(row[:2], ["made", "HEAD"])
        self.assertGreaterEqual(min(row[2:4]), 0.3)
        self.assertAlmostEqual(row[4], 2, delta=0.02)
        self.assertEqual(program.parts[-3:], ("build", "bin", "pertev"))

    def test_scripts_beside_other_programs_show_their_help_without_these(self):
        for script in ROOT.glob("bench/against_*.py"):
            done = subprocess.run([sys.executable, "-S", script, "--help"], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""), script)
            self.assertIn("--output", done.stdout)

    def test_registers_that_are_read_too_early_are_found(self):
        def cycles(*instructions):
            return [found[1] for found in check_stalls.early_reads(device_code(*instructions))]

        clear, may_write = ("CS2R R6, SRZ", 2), ("@!P0 IMAD.WIDE.U32 R6, R11, 0x3d4, R12", 3)
        compare, high = ("ISETP.NE.U32.AND P0, PT, R6, RZ, PT", 4), ("ISETP.NE.AND.EX P0, PT, R7, RZ, PT, P0", 13)
        self.assertEqual(cycles(clear, may_write, compare, high), [5])  # ptxas 13.0 writes this
        self.assertEqual(cycles(clear, ("@!P0 IMAD.WIDE.U32 R6, R11, 0x3d4, R12", 4), compare, high), [])
        self.assertEqual(cycles(clear, ("LD.E R9, desc[UR8][R6.64]", 1)), [2])
        self.assertEqual(cycles(clear, ("MOV R6, R3", 1), ("MOV R7, R4", 1), compare), [])
        self.assertEqual(cycles(clear, ("STG.E.64 desc[UR8][R2.64], R6", 1)), [])
        self.assertEqual(cycles(clear, ("BRA `(.L_x_1)", 1), compare), [])
        self.assertEqual(cycles(("CS2R RZ, SRZ", 2), compare), [])


if __name__ == "__main__":
    main()
