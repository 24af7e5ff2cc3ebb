#!/usr/bin/env python3
"""`pertev lab --transport`: its files, which agree, refused requests, and its end by Ctrl-C."""

import csv
import json
import os
import re
import signal
import subprocess
import time

from cli_lab_run import rows_of
from cli_run import PATIENCE_S, PROGRAM, SANITIZED, CliTest, main, write

SMALL = {"--size": "12x12", "--max-depth": 3, "--spp": 4, "--repetitions": 3, "--reference-spp": 8, "--device": "cpu"}


class Transport(CliTest):
    def transport(self, *arguments):
        """Returns a command line with small default sizes."""
        left = [str(part) for pair in SMALL.items() if pair[0] not in arguments for part in pair]
        return ["lab", "--transport", *left, *(str(argument) for argument in arguments)]

    def repetitions(self, *arguments):
        return rows_of(self.succeed(*self.transport(*arguments, "--json")).events("transport")[-1], "repetitions")

    def read(self, name):
        with open(self.path(name), encoding="utf-8", newline="") as file:
            return file.read()

    def test_html_csv_and_json_are_written_and_agree(self):
        outcome = self.succeed(*self.transport("--integrators", "path,bidirectional,cast", "-o", "new/out", "--json"))
        report = outcome.events("transport")[-1]
        self.assertEqual(outcome.events()[-1], report)
        self.assertGreater(len(outcome.events("progress")), 0)
        self.assertEqual(json.loads(self.read("new/out/transport.json"))["tables"], report["tables"])
        self.assertEqual(sorted(os.listdir(self.path("new/out"))),
                         ["transport-1-bidirectional.exr", "transport-1-path.exr", "transport-1-reference.exr",
                          "transport.csv", "transport.html", "transport.json"])
        (scene,) = rows_of(report, "scenes")
        self.assertEqual((scene["scene"], scene["reference_samples"]), ("cornell", 8))
        self.assertGreater(scene["reference_rel_mse"], 0)
        repetitions = rows_of(report, "repetitions")
        self.assertEqual(len(repetitions), 2 * 3 * 3 + 1)
        self.assertTrue(repetitions[-1]["refused"])
        self.assertIsNone(repetitions[-1]["rel_mse"])
        rows = list(csv.DictReader(self.read("new/out/transport.csv").splitlines()))
        self.assertEqual(len(rows), len(repetitions))
        points = {(row["integrator"], row["samples"]): row for row in rows_of(report, "points")}
        for name in ("path", "bidirectional"):
            ran = [row for row in repetitions if row["integrator"] == name]
            self.assertEqual([row["samples"] for row in ran], [1, 2, 4] * 3)
            mean = sum(row["rel_mse"] for row in ran if row["samples"] == 4) / 3
            self.assertAlmostEqual(points[name, 4]["rel_mse"] / mean, 1, 6)
            self.assertAlmostEqual(points[name, 4]["efficiency"] * mean * points[name, 4]["seconds"], 1, 6)
            self.assertGreater(ran[0]["device_bytes"], 0)
            self.assertEqual([float(row["rel_mse"]) for row in rows if row["integrator"] == name],
                             [row["rel_mse"] for row in ran])
        html = self.read("new/out/transport.html")
        self.assertTrue(html.rstrip().endswith("</html>"))
        (data,) = re.findall(r'class="measurement">(.*?)</script>', html)
        pictures = json.loads(data)["pictures"]
        self.assertEqual([(one["title"], one["exr"]) for one in pictures],
                         [(name, f"transport-1-{name}.exr") for name in ("reference", "path", "bidirectional")])
        self.assertEqual([one["error"] is None for one in pictures], [True, False, False])
        made = self.succeed("compare", "new/out/transport-1-path.exr", "new/out/transport-1-reference.exr", "--json")
        last = [row for row in repetitions if row["integrator"] == "path" and row["repetition"] == 0][-1]
        self.assertAlmostEqual(made.events("compare")[0]["rel_mse"] / last["rel_mse"], 1, 2)

    def test_radiosity_repetitions_have_finer_and_finer_solutions(self):
        outcome = self.succeed(*self.transport("--integrators", "path,radiosity", "--seconds", "3", "-o", "out", "--json"))
        report = outcome.events("transport")[-1]
        path, solved = ([row for row in rows_of(report, "repetitions") if row["integrator"] == name]
                        for name in ("path", "radiosity"))
        self.assertEqual((path[0]["is_solved"], solved[0]["is_solved"], solved[0]["refused"]), (False, True, None))
        self.assertGreater(solved[0]["host_bytes"], 0)
        self.assertEqual(path[0]["host_bytes"], 0)
        for number in range(3):
            patches = [row["patches"] for row in solved if row["repetition"] == number]
            self.assertEqual(patches, sorted(patches))
            self.assertGreater(patches[0], 0)
        self.assertIsNone(path[0]["patches"])
        rows = [row for row in csv.DictReader(self.read("out/transport.csv").splitlines())
                if row["integrator"] == "radiosity"]
        self.assertEqual(len(rows), len(solved))

    def test_errors_depend_only_on_the_seed_and_equal_those_of_compare(self):
        first, again, other = (
            [row["rel_mse"] for row in self.repetitions("--integrators", "path", *seed)] for seed in ([], [], ["--seed", 7]))
        self.assertEqual(first, again)
        self.assertNotEqual(first, other)
        # If the reference is the picture's own 4 samples of seed 0, the error is 0.
        self.render("--max-depth", "3", size="12x12", spp=4, output="given.exr")
        ran = self.repetitions("cornell-box", "--reference", "given.exr", "--integrators", "path")
        last = {row["repetition"]: row for row in ran if row["samples"] == 4}
        self.assertLess(last[0]["rel_mse"], 1e-6)
        self.assertLess(last[0]["hdr_flip"], 1e-3)
        self.assertGreater(ran[0]["rel_mse"], 1e-4)
        self.assertIsNone(ran[0]["reference_rel_mse"])
        self.render("--max-depth", "3", "--seed", "1", size="12x12", spp=4, output="other.exr")
        compared = self.succeed("compare", "other.exr", "given.exr", "--json").events("compare")[0]
        self.assertAlmostEqual(last[1]["rel_mse"] / compared["rel_mse"], 1, 2)  # files have half precision
        self.assertAlmostEqual(last[1]["hdr_flip"] / compared["hdr_flip"], 1, 2)

    def test_every_preset_is_built_in(self):
        report = self.succeed(*self.transport("--preset", "all", "--integrators", "path", "--spp", "1", "--repetitions",
                                              "2", "--reference-spp", "2", "--json")).events("transport")[-1]
        self.assertEqual([scene["scene"] for scene in rows_of(report, "scenes")],
                         ["cornell", "caustic", "blind", "door", "cove", "many-lights"])
        for row in rows_of(report, "repetitions"):
            self.assertGreater(row["rel_mse"], 0)

    def test_a_bad_line_ends_with_2_and_leaves_nothing(self):
        self.render(size="10x10", output="small.exr")
        for shown in ["shown.png", "shown.jpg"]:
            self.render(size="12x12", output=shown)
        wanted = {"--integrators path,foo": "bidirectional", "--preset kitchen": "many-lights", "--seconds 0": "above 0",
                  "--repetitions 0": "whole number from 1", "--reference nowhere.exr": "nowhere.exr",
                  "cornell-box --reference small.exr": "10x10 pixels, the pictures 12x12",
                  "cornell-box --preset door": "SCENE", "--preset door --eye 0,0,0": "camera",
                  "cornell-box --reference shown.png": "shown.png: the picture is tone-mapped",
                  "cornell-box --reference shown.jpg": "EXR or HDR",
                  "--preset all --reference small.exr": "one preset", "--integrators cast": "none of the integrators",
                  "--reference-integrator cast": "path", "--structures binned": "--transport",
                  "--thesis": "--transport", "--size 0x1": "WIDTHxHEIGHT"}
        for line, says in wanted.items():
            with self.subTest(line=line):
                self.refuse(2, *self.transport(*line.split()), says=[says])
        self.refuse(2, "lab", "cornell-box", "--preset", "door", says=["--transport"])

    def test_a_folder_that_cannot_be_written_ends_with_6_before_anything_is_rendered(self):
        write(self.path("file"), "mine")
        outcome = self.refuse(6, *self.transport("-o", "file/out", "--json"), says=["file/out"])
        self.assertEqual(outcome.events("progress"), [])

    def interrupt(self, line, when):
        with subprocess.Popen([PROGRAM, *line], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
            for text in program.stdout:
                if re.search(when, json.loads(text).get("step", "")):
                    break
            program.send_signal(signal.SIGINT)
            begin = time.monotonic()
            stdout, stderr = program.communicate(timeout=PATIENCE_S)
        self.assertEqual(program.returncode, 75, stderr)
        if not SANITIZED:
            self.assertLess(time.monotonic() - begin, 10)
        return json.loads(stdout.splitlines()[-1])

    def test_ctrl_c_keeps_what_was_measured_and_ends_with_75(self):
        line = ["--integrators", "path,whitted", "--spp", "65536", "-o", "out", "--json"]
        report = self.interrupt(self.transport(*line, "--reference-spp", 1 << 24), "reference")
        self.assertEqual((report["event"], report["interrupted"], rows_of(report, "scenes")), ("transport", True, []))
        self.assertFalse(os.path.exists(self.path("out/transport.html")))
        report = self.interrupt(self.transport(*line, "--seconds", 3), "path, 2 of 3")
        self.assertTrue(report["interrupted"])
        self.assertEqual({row["repetition"] for row in rows_of(report, "repetitions") if row["integrator"] == "path"}, {0})
        kept = json.loads(self.read("out/transport.json"))
        self.assertEqual((kept["interrupted"], kept["tables"]), (True, report["tables"]))


if __name__ == "__main__":
    main()
