#!/usr/bin/env python3
"""`pertev lab --transport`: what it writes, that its files agree, what it refuses, and how Ctrl-C ends it."""

import csv
import json
import os
import re
import signal
import subprocess
import time

from cli_run import PATIENCE_S, PROGRAM, SANITIZED, CliTest, main, write

SMALL = {"--size": "12x12", "--max-depth": 3, "--spp": 4, "--repetitions": 3, "--reference-spp": 8, "--device": "cpu"}


class Transport(CliTest):
    def transport(self, *arguments):
        """A command line, small where it does not say otherwise."""
        left = [str(part) for pair in SMALL.items() if pair[0] not in arguments for part in pair]
        return ["lab", "--transport", *left, *(str(argument) for argument in arguments)]

    def read(self, name):
        with open(self.path(name), encoding="utf-8", newline="") as file:
            return file.read()

    def test_html_csv_and_json_are_written_and_agree(self):
        outcome = self.succeed(*self.transport("--integrators", "path,bidirectional,cast", "-o", "new/out", "--json"))
        report = outcome.events("transport")[-1]
        self.assertEqual(outcome.events()[-1], report)
        self.assertGreater(len(outcome.events("progress")), 0)
        self.assertEqual(json.loads(self.read("new/out/transport.json")), report)
        self.assertEqual(sorted(os.listdir(self.path("new/out"))),
                         ["transport.csv", "transport.html", "transport.json"])
        (scene,) = report["scenes"]
        self.assertEqual((scene["scene"], scene["equal_samples"], scene["reference"]["samples"]), ("cornell", 4, 8))
        self.assertGreater(scene["reference"]["rel_mse"], 0)
        path, both, cast = scene["integrators"]
        self.assertRegex(cast["refused"], "^point, spot .* lamps alone")
        self.assertEqual(cast["repetitions"], [])
        rows = list(csv.DictReader(self.read("new/out/transport.csv").splitlines()))
        self.assertEqual(len(rows), 2 * 3 * 3 + 1)
        for of in (path, both):
            self.assertEqual([[one["samples"] for one in ran] for ran in of["repetitions"]], [[1, 2, 4]] * 3)
            last = [ran[-1] for ran in of["repetitions"]]
            point = of["at_equal_samples"]
            mean = sum(one["rel_mse"] for one in last) / 3
            self.assertAlmostEqual(point["rel_mse"]["mean"] / mean, 1, 6)
            self.assertAlmostEqual(point["efficiency"] * mean * point["seconds"]["mean"], 1, 6)
            self.assertGreater(of["device_bytes"], 0)
            mine = [row for row in rows if row["integrator"] == of["name"]]
            self.assertEqual([float(row["rel_mse"]) for row in mine],
                             [one["rel_mse"] for ran in of["repetitions"] for one in ran])
        html = self.read("new/out/transport.html")
        self.assertTrue(html.rstrip().endswith("</html>"))
        self.assertEqual(html.count("<svg"), 4)
        self.assertEqual(html.count("<img"), 3)
        self.assertNotIn("http", re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "",
                                        html.replace('"http://www.w3.org/2000/svg"', "")))
        for text in ["bidirectional", "lamps alone", "Student"]:
            self.assertIn(text, html)

    def test_radiosity_takes_part_by_solutions(self):
        outcome = self.succeed(*self.transport("--integrators", "path,radiosity", "--seconds", "3", "-o", "out", "--json"))
        (scene,) = outcome.events("transport")[-1]["scenes"]
        path, solved = scene["integrators"]
        self.assertIsNone(solved["refused"])
        self.assertEqual((path["is_solved"], solved["is_solved"]), (False, True))
        self.assertGreater(solved["host_bytes"], 0)
        self.assertEqual(path["host_bytes"], 0)
        self.assertIsNone(solved["at_equal_samples"])
        self.assertEqual(scene["equal_samples"], 4)
        for ran in solved["repetitions"]:
            patches = [one["patches"] for one in ran]
            self.assertEqual(patches, sorted(patches))
            self.assertGreater(patches[0], 0)
        self.assertIsNone(path["repetitions"][0][0]["patches"])
        html = self.read("out/transport.html")
        self.assertIn("no samples: it is solved", html)
        rows = [row for row in csv.DictReader(self.read("out/transport.csv").splitlines())
                if row["integrator"] == "radiosity"]
        self.assertEqual(len(rows), sum(len(ran) for ran in solved["repetitions"]))

    def test_errors_are_a_function_of_the_seeds_and_those_of_compare(self):
        first, again, other = (
            self.succeed(*self.transport("--integrators", "path", "--json", *seed)).events("transport")[-1]["scenes"][0]
            for seed in ([], [], ["--seed", 7]))
        errors = [[one["rel_mse"] for ran in scene["integrators"][0]["repetitions"] for one in ran]
                  for scene in (first, again, other)]
        self.assertEqual(errors[0], errors[1])
        self.assertNotEqual(errors[0], errors[2])
        # Against a picture that is given: its own 4 samples of seed 0 leave no error.
        self.render("--max-depth", "3", size="12x12", spp=4, output="given.exr")
        scene = self.succeed(*self.transport("cornell-box", "--reference", "given.exr", "--integrators", "path", "--json")
                             ).events("transport")[-1]["scenes"][0]
        ran = scene["integrators"][0]["repetitions"]
        self.assertLess(ran[0][-1]["rel_mse"], 1e-6)
        self.assertLess(ran[0][-1]["hdr_flip"], 1e-3)
        self.assertGreater(ran[0][0]["rel_mse"], 1e-4)
        self.assertIsNone(scene["reference"]["rel_mse"])
        self.render("--max-depth", "3", "--seed", "1", size="12x12", spp=4, output="other.exr")
        compared = self.succeed("compare", "other.exr", "given.exr", "--json").events("compare")[0]
        self.assertAlmostEqual(ran[1][-1]["rel_mse"] / compared["rel_mse"], 1, 2)  # files have half precision
        self.assertAlmostEqual(ran[1][-1]["hdr_flip"] / compared["hdr_flip"], 1, 2)

    def test_every_preset_is_built_in(self):
        report = self.succeed(*self.transport("--preset", "all", "--integrators", "path", "--spp", "1", "--repetitions",
                                              "2", "--reference-spp", "2", "--json")).events("transport")[-1]
        self.assertEqual([scene["scene"] for scene in report["scenes"]],
                         ["cornell", "caustic", "blind", "door", "cove", "many-lights"])
        for scene in report["scenes"]:
            self.assertGreater(scene["integrators"][0]["repetitions"][0][0]["rel_mse"], 0)

    def test_a_bad_line_ends_with_2_and_leaves_nothing(self):
        self.render(size="10x10", output="small.exr")
        for shown in ["shown.png", "shown.jpg"]:
            self.render(size="12x12", output=shown)
        wanted = {"--integrators path,foo": "bidirectional", "--preset kitchen": "many-lights", "--seconds 0": "above 0",
                  "--repetitions 0": "whole number from 1", "--reference nowhere.exr": "nowhere.exr",
                  "cornell-box --reference small.exr": "it is 10x10, the pictures 12x12",
                  "cornell-box --preset door": "SCENE", "--preset door --eye 0,0,0": "camera",
                  "cornell-box --reference shown.png": "shown.png: a picture for displays",
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
                if re.search(when, json.loads(text).get("doing", "")):
                    break
            program.send_signal(signal.SIGINT)
            begin = time.monotonic()
            stdout, stderr = program.communicate(timeout=PATIENCE_S)
        self.assertEqual(program.returncode, 75, stderr)
        if not SANITIZED:
            self.assertLess(time.monotonic() - begin, 10)
        return json.loads(stdout.splitlines()[-1])

    def test_ctrl_c_keeps_what_was_measured_and_ends_with_75(self):
        line = self.transport("--integrators", "path,whitted", "--spp", "65536", "--seconds", "20", "-o", "out",
                              "--json")
        report = self.interrupt(line, "reference")
        self.assertEqual((report["event"], report["interrupted"], report["scenes"]), ("transport", True, []))
        self.assertFalse(os.path.exists(self.path("out/transport.html")))
        line[line.index("--seconds") + 1] = "3"
        report = self.interrupt(line, "path, 2 of 3")
        self.assertTrue(report["interrupted"])
        self.assertEqual(len(report["scenes"][0]["integrators"][0]["repetitions"]), 1)
        self.assertEqual(json.loads(self.read("out/transport.json")), report)
        self.assertIn("Interrupted", self.read("out/transport.html"))


if __name__ == "__main__":
    main()
