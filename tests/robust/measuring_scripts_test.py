#!/usr/bin/env python3
"""Scripts that measure the jobs of bench/jobs.json: they write measurements, and a difference between devices has status 1; and the
search of device code for registers that are read too early."""

import pathlib
import subprocess
import sys

from cli_run import PROGRAM, CliTest, main

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import check_stalls  # noqa: E402  pylint: disable=wrong-import-position
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
