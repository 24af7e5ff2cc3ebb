#!/usr/bin/env python3
"""`render --records FILE`: parts share irradiance records or a radiosity solution by a file that the first one writes, and the picture stays
the same. The file of another picture, and a damaged one, are refused.
cli_records_test.py PERTEV [--device cuda]"""

import json
import os
import signal
import subprocess

from cli_run import DEVICE, PATIENCE_S, PROGRAM, CliTest, main, write

SHARED = ["--records", "r.pvr"]
KINDS = {"irradiance_cache": ["--hemisphere-rays", "48"], "radiosity": ["--patch-size", "0.4"]}


class Records(CliTest):
    def line(self, output, *flags, scene="cornell-box", size="32x24"):
        return ["render", scene, "-o", output, "--size", size, "--device", DEVICE, "--json", *map(str, flags)]

    def done(self, output, *flags):
        return self.succeed(*self.line(output, *flags)).events("done")[0]

    def read(self, name="r.pvr"):
        with open(self.path(name), "rb") as file:
            return file.read()

    def metadata(self, name):
        return {key: value for key, value in self.info(name).items() if key not in ("file", "pertev.rays") and not key.endswith("_seconds")}

    def test_parts_that_share_records_are_merged_to_the_picture_of_one_run(self):
        for kind, flags in KINDS.items():
            with self.subTest(kind):
                flags = ["--integrator", kind, *flags, "--spp", 4]
                whole = self.done("whole.exr", *flags)
                first = self.succeed(*self.line("1.pvf", *flags, *SHARED, "--part", "1/2"))
                kept, written = self.read(), os.stat(self.path("r.pvr")).st_mtime_ns
                second = self.succeed(*self.line("2.pvf", *flags, *SHARED, "--part", "2/2"))
                self.assertEqual((self.read(), os.stat(self.path("r.pvr")).st_mtime_ns), (kept, written))
                if kind == "radiosity":
                    self.assertEqual([len(part.events("radiosity_solved")) for part in (first, second)], [1, 0])
                merged = self.succeed("merge", "2.pvf", "1.pvf", "-o", "all.exr", "--json").events("done")[0]
                self.assertEqual((merged["hash"], merged["invalid_samples"]), (whole["hash"], whole["invalid_samples"]))
                self.assertEqual(self.metadata("all.exr"), self.metadata("whole.exr"))
                rays = [self.info(name)["pertev.rays"] for name in ("all.exr", "whole.exr")]
                self.assertLess(rays[0], rays[1]) if kind == "irradiance_cache" else self.assertEqual(rays[0], rays[1])
                self.assertEqual(self.done("rows.exr", *flags, *SHARED, "--rows", "0:24")["hash"], whole["hash"])
                os.remove(self.path("r.pvr"))

    def test_parts_that_start_at_the_same_moment_are_both_right(self):
        for kind, flags in KINDS.items():
            with self.subTest(kind):
                flags = ["--integrator", kind, *flags, "--spp", 4]
                whole = self.done("whole.exr", *flags)
                parts = [subprocess.Popen([PROGRAM, *self.line(f"{i}.pvf", *flags, *SHARED, "--part", f"{i}/3")], cwd=self.folder, env=self.environment,
                                          stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for i in (1, 2, 3)]
                for part in parts:
                    errors = part.communicate(timeout=PATIENCE_S)[1]
                    self.assertEqual(part.returncode, 0, errors)
                merged = self.succeed("merge", "1.pvf", "2.pvf", "3.pvf", "-o", "all.exr", "--json").events("done")[0]
                self.assertEqual(merged["hash"], whole["hash"])
                kept = self.read()
                os.remove(self.path("r.pvr"))
                self.assertEqual(self.done("again.exr", *flags, *SHARED)["hash"], whole["hash"])
                self.assertEqual(self.read(), kept)
                self.assertEqual([name for name in self.files() if name.startswith(".")], [])
                os.remove(self.path("r.pvr"))

    def test_records_of_another_picture_are_refused_by_what_differs(self):
        others = {"irradiance_cache": [("--seed", 1), ("--accuracy", 0.5), ("--max-depth", 3), ("--eye", "0,1,3.5")],
                  "radiosity": [("--seed", 1), ("--contrast", 0.77)]}
        for kind, flags in KINDS.items():
            flags = ["--integrator", kind, *flags, "--spp", 2]
            self.done("a.exr", *flags, *SHARED)
            for name, value in others[kind]:
                with self.subTest((kind, name)):
                    says = ["r.pvr", "--records", "" if kind == "radiosity" else name.strip("-").split("-")[0]]
                    self.refuse(2, *self.line("b.exr", *flags, *SHARED, name, value), says=says)
            if kind == "irradiance_cache":
                self.refuse(2, *self.line("b.exr", *flags, *SHARED, size="24x24"), says=["r.pvr", "--size"])
            self.refuse(2, *self.line("b.exr", *flags, *SHARED, scene="blind"), says=["r.pvr", "hash of the scene"])
            other = ["--exposure", "1"] if kind == "irradiance_cache" else ["--eye", "0,1,3.5"]
            self.done("c.png" if kind == "irradiance_cache" else "c.exr", *flags, *SHARED, *other)
            os.remove(self.path("r.pvr"))

    def test_damaged_records_are_refused(self):
        for kind, flags in KINDS.items():
            flags = ["--integrator", kind, *flags, "--spp", 2]
            self.done("a.exr", *flags, *SHARED)
            kept = self.read()
            for damage in (kept[:-1], kept[:40], kept[:8], b"", kept[:-40] + bytes([kept[-40] ^ 1]) + kept[-39:], kept + b"x"):
                with self.subTest((kind, len(damage))):
                    with open(self.path("r.pvr"), "wb") as file:
                        file.write(damage)
                    self.refuse(2, *self.line("b.exr", *flags, *SHARED), says=["r.pvr"])
                    self.assertEqual(self.read(), damage)
            os.remove(self.path("r.pvr"))
            write(self.path("text.pvr"), "a text\n" * 9)
            self.refuse(2, *self.line("b.exr", *flags, "--records", "text.pvr"), says=["text.pvr"])
            self.refuse(6, *self.line("b.exr", *flags, "--records", "nowhere/r.pvr"), says=["nowhere/r.pvr"])

    def test_settings_that_records_do_not_support_are_refused(self):
        for flags in (["--integrator", "path"], ["--integrator", "radiosity", "--solution", "s.pvs"], ["--integrator", "irradiance_cache", "--turntable", "4"]):
            with self.subTest(flags):
                self.refuse(2, *self.line("x-#.exr", *SHARED, *flags), says=["--records"])
        flags = ["--integrator", "irradiance_cache"]
        self.refuse(2, *self.line("x.exr", *flags, "--records", "./x.exr"), says=["--records"])
        self.refuse(2, *self.line("x.exr", *flags, "--records", "c.pvf", "--checkpoint", "c.pvf"), says=["--records"])

    def test_an_interrupt_before_the_records_are_made_leaves_no_file(self):
        program = subprocess.Popen([PROGRAM, *self.line("x.exr", "--integrator", "irradiance_cache", "--hemisphere-rays", 65536, *SHARED, size="640x480")],
                                   cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        next(line for line in program.stdout if json.loads(line)["event"] == "progress" and json.loads(line).get("share", 0) > 0)
        program.send_signal(signal.SIGINT)
        program.communicate(timeout=PATIENCE_S)
        self.assertEqual(program.returncode, 75)
        self.assertEqual(self.files(), [])


if __name__ == "__main__":
    main()
