#!/usr/bin/env python3
"""`pertev lab`: the files that it writes, those that it keeps, and its end when it is interrupted."""

import csv
import glob
import json
import os
import re
import signal
import struct
import subprocess
import time
import xml.etree.ElementTree as ElementTree
import zlib

from cli_lab_run import BOX, INSIDE, SMALL, LabTest, lab_report, rows_of
from cli_run import PATIENCE_S, PROGRAM, SANITIZED, main, write


def read_text(path):
    with open(path, encoding="utf-8", newline="") as file:
        return file.read()


def write_grid(path, side):
    """Returns a PLY file of side * side squares in the unit square, with two triangles each."""
    points = b"".join(struct.pack("<3f", x / side, y / side, 0) for y in range(side + 1) for x in range(side + 1))
    corners = (y * (side + 1) + x for y in range(side) for x in range(side))
    face = struct.Struct("<B3iB3i")
    faces = b"".join(face.pack(3, c, c + 1, c + side + 1, 3, c + 1, c + side + 2, c + side + 1) for c in corners)
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {(side + 1) ** 2}\nproperty float x\n"
            f"property float y\nproperty float z\nelement face {2 * side * side}\n"
            "property list uchar int vertex_indices\nend_header\n")
    with open(path, "wb") as file:
        file.write(head.encode() + points + faces)


class WhatIsWritten(LabTest):
    def check_html(self, path):
        """Tests that the page is complete and needs no network. Returns the measurement in it."""
        html = read_text(path)
        self.assertTrue(html.startswith("<!DOCTYPE html>"))
        self.assertTrue(html.rstrip().endswith("</html>"))
        self.assertNotRegex(html, r"<link|<script[^>]*src=|@import")
        self.assertEqual(html.count("http"), html.count("http://www.w3.org/2000/svg"))  # the name of a namespace
        (data,) = re.findall(r'<script type="application/json" class="measurement">(.*?)</script>', html)
        self.assertNotIn("<", data)
        return json.loads(data)

    def read_report(self, path):
        measurement = json.loads(read_text(path))
        self.assertEqual((measurement["format"], measurement["version"]), ("pertev-measurement", 1))
        self.assertIn("pertev lab ", measurement["command"])
        self.assertTrue(measurement["processor"])
        self.assertIsNone(measurement["driver"])
        self.assertRegex(measurement["date"], r"^20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        return measurement

    def read_csv(self, path):
        rows = list(csv.DictReader(read_text(path).splitlines(), restkey="too many", restval=None))
        for row in rows:
            self.assertNotIn("too many", row)
            self.assertNotIn(None, row.values())
        return rows

    def test_tables_report_and_heat_maps_are_written_and_agree(self):
        for _ in range(2):  # into a new folder, then over existing files
            report = self.report("cornell-box", *SMALL, "-o", "new/out")
        measurement = self.read_report(self.path("new/out/report.json"))
        self.assertEqual(lab_report({**measurement, "event": "lab"}), report)
        rows = self.read_csv(self.path("new/out/report.csv"))
        self.assertEqual([(row["combination"], row["set"]) for row in rows],
                         [(of["name"], run["set"]) for of in report["combinations"] for run in of["runs"]])
        for row in rows:
            self.assertEqual((row["scene"], row["scene_triangles"], row["refused"]), ("cornell-box", "38", ""))
            self.assertGreater(float(row["rays_per_second"]), 0)
        page = self.check_html(self.path("new/out/report.html"))
        self.assertEqual(page["tables"], measurement["tables"])
        self.assertTrue(all(picture["image"].startswith("data:image/png;base64,") for picture in page["pictures"]))
        titles = [f"binned {traversal} rta near" for traversal in ("if-if", "wide8")]
        for kind in ["nodes", "triangles"]:
            self.assertCountEqual([picture["title"] for picture in page["pictures"] if picture["group"].endswith(kind)], titles)
        self.assertEqual(sorted(os.listdir(self.path("new/out"))), ["report.csv", "report.html", "report.json"])

    def test_no_heat_maps_omits_the_pictures(self):
        self.report("cornell-box", *SMALL, "--no-heat-maps", "-o", "out")
        self.assertEqual(self.check_html(self.path("out/report.html"))["pictures"], [])

    def test_heat_maps_show_the_first_combination_of_each_structure_and_traversal(self):
        for flags, switches in [("--rta off", "no-rta near"), ("--order off", "rta unordered"),
                                ("--tests fast --rta on", "rta near fast-tests"), ("--order both", "rta near"),
                                ("--tests fast,exact --rta off,nodes,on", "rta near"),
                                ("--rays record --count 3000", "rta near")]:
            with self.subTest(flags=flags):
                self.report("cornell-box", "--structures", "binned", "--traversals", "if-if", *flags.split(), "-o", "out")
                self.assertEqual([picture["title"] for picture in self.check_html(self.path("out/report.html"))["pictures"]],
                                 [f"binned if-if {switches}"] * 2)
        for flags in ["--rays shadow", "--rays record --count 500"]:  # there is no frame of camera rays
            with self.subTest(flags=flags):
                self.report("cornell-box", *SMALL, *flags.split(), "-o", "none")
                self.assertEqual(self.check_html(self.path("none/report.html"))["pictures"], [])

    def test_scene_names_may_contain_invalid_utf_8(self):
        odd = b"odd\xff\xc3"
        with open(os.path.join(self.folder.encode(), odd + b".obj"), "w", encoding="utf-8") as file:
            file.write(BOX)
        name = os.fsdecode(odd + b".obj")
        report = lab_report(json.loads(subprocess.run([PROGRAM, *self.lab(name, *INSIDE, *SMALL, "-o", "out", "--json")],
                                                      cwd=self.folder, env=self.environment, stdout=subprocess.PIPE,
                                                      check=True).stdout.splitlines()[-1]))
        self.assertEqual(report["scene"], "odd\ufffd\ufffd")
        self.assertEqual({row["scene"] for row in self.read_csv(self.path("out/report.csv"))}, {report["scene"]})
        self.assertIn(report["scene"], self.check_html(self.path("out/report.html"))["title"])

    def test_a_thesis_without_pictures_adds_no_light_and_names_its_tree(self):
        outcome = self.succeed(*self.lab("--thesis", "box.obj", *INSIDE, "--depths", "1"))
        self.assertNotIn("light", outcome.stderr)
        self.assertRegex(outcome.stdout, r"\bbinned\b")

    def test_scene_names_are_escaped_in_every_file(self):
        name = 'a,"b" <i>&amp;'
        write(self.path(name + ".obj"), BOX)
        report = self.report(name + ".obj", *INSIDE, *SMALL, "-o", "out")
        self.assertEqual(report["scene"], name)
        self.assertEqual({row["scene"] for row in self.read_csv(self.path("out/report.csv"))}, {name})
        self.assertEqual(rows_of(self.check_html(self.path("out/report.html")), "scene")[0]["scene"], name)

    def test_the_thesis_handles_equal_and_long_scene_names_and_its_commands_reproduce_the_pictures(self):
        os.mkdir(self.path("mine"))
        longest = "x" * 246 + ".obj"
        for scene in ["mine/cornell-box.obj", longest]:
            write(self.path(scene), BOX)
            with self.subTest(scene=scene):
                outcome = self.succeed(*self.lab("--thesis", scene, *INSIDE, "--depths", "1-2", "-o", "out", "--json"))
                reports = [lab_report(event) for event in outcome.events("lab")]
                self.assertEqual([report["triangles"] for report in reports], [38, 12])
                for report in reports:
                    for of in report["combinations"]:
                        self.assertIsNone(of["refused"])
                        self.assertEqual(len(of["frame_seconds"]), 2)
                page = self.check_html(self.path("out/thesis.html"))
                self.assertRegex(page["notes"][-1], r"\bbinned\b")
                self.assertEqual(page["tables"], self.read_report(self.path("out/thesis.json"))["tables"])
                pictures = self.check_thesis_pictures(outcome, page)
                self.assertEqual(sum(picture["image"] is not None for picture in page["pictures"]),
                                 4 + sum(name.endswith(".png") for name in pictures))
                frames = rows_of(page, "frames")  # figures 6.9 to 6.11
                self.assertEqual({row["variant"] for row in frames}, {"SWW", "SWW-R", "Packet", "Packet-R", "A"})
                self.assertEqual(sorted({row["depth"] for row in frames}), [1, 2])
                self.assertEqual(len(frames), 2 * 5 * 2)  # tables 6.3 to 6.6, which the page draws of them
                self.assertEqual(self.read_csv(self.path("out/thesis.csv"))[0]["variant"], "SWW")
                self.assertEqual(len(glob.glob(self.path("out/figure-6.[78]-*al.png"))), 4)
                tables = glob.glob(self.path("out/thesis-[12].csv"))
                counts = [{row["scene_triangles"] for row in self.read_csv(table)} for table in tables]
                self.assertCountEqual(counts, [{"38"}, {"12"}])
                self.assertEqual({row["scene"] for row in self.read_csv(self.path("out/thesis-2.csv"))},
                                 {os.path.basename(scene).removesuffix(".obj")})
                self.assertIn("light", "".join(event["reason"] for event in outcome.events("notice")))
                for file in glob.glob(self.path("out/*")):
                    with open(file, "rb") as written:
                        self.assertNotEqual(written.read(), b"earlier", file)
                    if scene != longest:
                        write(file, "earlier")
        # A run that is interrupted before its first measurement keeps all files.
        self.check_interrupt_leaves_all("--thesis", "box.obj", *INSIDE)
        self.check_commands_beneath_pictures(outcome)

    def test_the_thesis_lists_missing_results(self):
        os.makedirs(self.path("out/figure-3.6.png"))  # a picture of this name cannot be written
        line = self.lab("--thesis", "--depths", "1-2", "-o", "out", "--json")
        outcome = self.refuse(6, *line, says=["figure-3.6.png"],
                              env=dict(self.environment, PERTEV_SCENES=self.path("nowhere")))
        thesis = outcome.events("thesis")[-1]
        unwritten, lacking = sorted((row["what"] for row in rows_of(thesis, "lacking")),
                                    key=lambda what: not what.startswith("figure-3.6: "))
        self.assertTrue(unwritten.startswith("figure-3.6: "), unwritten)
        for text in ["6.4", "6.8", "sibenik/sibenik.obj", "PERTEV_SCENES", "SCENE"]:
            self.assertIn(text, lacking)
        self.assertEqual([lab_report(event)["scene"] for event in outcome.events("lab")], ["cornell-box"])
        self.assertIn(lacking, "".join(event["text"] for event in outcome.events("warning")))
        page = self.check_html(self.path("out/thesis.html"))
        for what in (unwritten, lacking):
            self.assertEqual(len([note for note in page["notes"] if note.endswith(what)]), 1)
        pictures = rows_of(thesis, "pictures")
        self.assertEqual(rows_of(page, "pictures"), pictures)
        for picture in pictures:
            self.assertTrue(os.path.isfile(self.path("out/" + picture["file"])), picture["file"])
        names = [picture["file"] for picture in pictures]
        self.assertIn("chapter-4-octree.png", names)
        self.assertNotIn("figure-3.6.png", names)
        self.assertTrue(os.path.exists(self.path("out/figure-6.7-local.png")))
        self.assertFalse(os.path.exists(self.path("out/figure-6.8-local.png")))
        self.assertFalse(os.path.exists(self.path("out/thesis-2.csv")))
        # It succeeds without pictures, but a named scene must exist.
        self.assertIn(lacking, self.succeed(*self.lab("--thesis", "--depths", "1")).stdout)
        self.refuse(2, *self.lab("--thesis", "nowhere.obj", "--json"), says=["nowhere.obj"])

    def check_thesis_pictures(self, outcome, page):
        """Tests that page, files and the last event have the same pictures of chapters 2 to 4. Returns their files."""
        pictures = rows_of(outcome.events("thesis")[-1], "pictures")
        self.assertEqual(rows_of(page, "pictures"), pictures)
        files = [picture["file"] for picture in pictures]
        for name in ["3.3", "3.4", "3.6", "3.7a", "3.7b", "3.7c", "3.7d", "3.8", "3.9a", "3.9b", "3.9c", "3.10a", "3.10b"]:
            self.assertIn(f"figure-{name}.png", files)
        written = glob.glob(self.path("out/*-[234]*.png")) + glob.glob(self.path("out/*-[234]*.svg"))
        self.assertCountEqual([os.path.basename(name) for name in written], files)
        shown = {picture["file"]: picture for picture in page["pictures"]}
        for picture in pictures:
            self.assertIn(picture["shows"], shown[picture["file"]]["caption"])
            self.assertEqual(shown[picture["file"]]["group"], f"{picture['place']}: {picture['title']}")
            self.assertIn(picture["command"] or "Made by the laboratory alone.", shown[picture["file"]]["caption"])
            if picture["file"].endswith(".svg"):
                ElementTree.parse(self.path("out/" + picture["file"]))
                self.assertIsNone(picture["samples"])
                continue
            self.assertFalse(picture["interrupted"])
            if picture["integrator"]:
                self.assertGreater(picture["rays"], -1)
                self.assertGreater(picture["render_seconds"], 0)
            if picture["file"].startswith("figure-3.7"):
                self.assertGreater(picture["solve_seconds"], 0)
        return files

    def check_commands_beneath_pictures(self, outcome):
        """Tests that the command below a picture of the thesis reproduces its bytes."""
        commands = {picture["file"]: picture["command"] for picture in rows_of(outcome.events("thesis")[-1], "pictures")
                    if picture["command"]}
        self.assertGreater(len(commands), 8)
        for file, command in commands.items():
            with self.subTest(command=command):
                program, *arguments = command.split()
                self.assertEqual(program, "pertev")
                self.succeed(*arguments, "--device", "cpu")
                self.assertEqual(self.pixels(file), self.pixels("out/" + file))

    def pixels(self, name):
        """Returns a PNG file's header fields and its decompressed rows."""
        with open(self.path(name), "rb") as file:
            data = file.read()
        rows, at = b"", 8
        while at < len(data):
            (size,) = struct.unpack(">I", data[at:at + 4])
            if data[at + 4:at + 8] == b"IDAT":
                rows += data[at + 8:at + 8 + size]
            at += 12 + size
        self.assertGreater(len(rows), 0)
        return data[16:29], zlib.decompress(rows)

    def interrupt(self, line, when, after_s=0.2):
        """Sends SIGINT this long after the first progress whose text contains `when`. Returns the report, which is the last line."""
        with subprocess.Popen([PROGRAM, *line], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
            for text in program.stdout:
                if re.search(when, json.loads(text).get("step", "")):
                    break
            time.sleep(after_s)
            program.send_signal(signal.SIGINT)
            begin = time.monotonic()
            try:
                stdout, stderr = program.communicate(timeout=PATIENCE_S if SANITIZED else 10)
            except subprocess.TimeoutExpired:
                program.kill()
                program.communicate()
                self.fail("10 s after an interrupt it still runs")
        self.assertEqual(program.returncode, 75, stderr)
        if not SANITIZED:
            self.assertLess(time.monotonic() - begin, 5)
        said = [json.loads(text) for text in stdout.splitlines()]
        self.assertTrue(said[-1]["interrupted"], said[-1])
        if "--thesis" in line:
            self.assertEqual(said.pop()["event"], "thesis")
        self.assertEqual((said[-1]["event"], said[-1]["interrupted"]), ("lab", True))
        report = lab_report(said[-1])
        for of in report["combinations"]:
            self.assertTrue(of["runs"] or of["refused"], of)
        self.assertIn("interrupt", report["combinations"][-1]["refused"])
        return report

    def test_an_interrupt_in_the_middle_of_a_long_set_keeps_what_was_measured_and_ends_with_75(self):
        # Each of twelve sets takes at least a third of a second for its runs.
        report = self.interrupt(self.lab("cornell-box", *SMALL, "--depths", "2", "--size", "256x192", "--threads", "1",
                                         "-o", "out", "--json", runs=100), "^binned .*: shadow")
        self.assertEqual([run["set"] for of in report["combinations"] for run in of["runs"]][:1], ["primary"])
        self.assertEqual(lab_report({**self.read_report(self.path("out/report.json")), "event": "lab"}), report)
        self.read_csv(self.path("out/report.csv"))
        self.check_html(self.path("out/report.html"))

    def test_an_interrupted_thesis_writes_what_it_has_and_ends_with_75(self):
        self.interrupt(self.lab("--thesis", "box.obj", *INSIDE, "--size", "64x48", "--threads", "1", "-o", "out",
                                "--json", runs=1000), "^binned .*: diffuse1")
        self.check_html(self.path("out/thesis.html"))

    def test_an_interrupted_thesis_keeps_its_finished_pictures(self):
        line = self.lab("--thesis", "box.obj", *INSIDE, "--depths", "1", "--size", "64x48", "-o", "out", "--json")
        with subprocess.Popen([PROGRAM, *line], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as program:
            for text in program.stdout:
                if json.loads(text).get("step", "").startswith("figure-3.7a: form factors"):
                    break
            program.send_signal(signal.SIGINT)
            stdout, stderr = program.communicate(timeout=PATIENCE_S)
        self.assertEqual(program.returncode, 75, stderr)
        report = json.loads(stdout.splitlines()[-1])
        self.assertEqual((report["event"], report["interrupted"]), ("thesis", True))
        files = [picture["file"] for picture in rows_of(report, "pictures")]
        self.assertEqual(files[-1], "figure-3.6.png")  # a solution that has just begun has no picture
        for file in files:
            self.assertTrue(os.path.exists(self.path("out/" + file)))
        self.assertEqual(len(self.check_html(self.path("out/thesis.html"))["pictures"]), 4 + len(files))

    def check_interrupt_leaves_all(self, *scene):
        before = self.contents("out")
        report = self.interrupt(self.lab(*scene, "--size", "256x192", "-o", "out", "--json", runs=10000),
                                "^binned .*: primary")
        self.assertEqual([of["runs"] for of in report["combinations"] if of["runs"]], [])
        self.assertEqual(self.contents("out"), before)

    def test_an_interrupt_before_anything_is_measured_leaves_an_earlier_report_as_it_is(self):
        self.succeed(*self.lab("cornell-box", *SMALL, "-o", "out"))
        self.check_interrupt_leaves_all("cornell-box", *SMALL)

    def test_the_check_against_brute_force_can_be_interrupted(self):
        side = 100 if SANITIZED else 600
        write_grid(self.path("grid.ply"), side)
        line = self.lab("grid.ply", "--eye", "0.5,0.5,1", "--target", "0.5,0.4,0", *SMALL, "--threads", "1", "--json")
        report = self.interrupt(line, "brute force", 0 if SANITIZED else 0.1)
        self.assertEqual((report["sets"], report["structures"]), ([], []))

    def contents(self, folder):
        """Returns the bytes of each file in the folder by its name."""
        found = {}
        for name in os.listdir(self.path(folder)):
            with open(os.path.join(self.path(folder), name), "rb") as file:
                found[name] = file.read()
        return found


if __name__ == "__main__":
    main()
