#!/usr/bin/env python3
"""pertev solve radiosity, its file and pictures of it: messages, and requests that are refused before any work."""

import json
import os
import signal
import subprocess
import time

from cli_frames_test import moving_gltf
from cli_run import FLOOR, PATIENCE_S, PROGRAM, UNMETERED, CliTest, main, write

COARSE = ["--patch-size", "0.3", "--patch-rays", "16", "--subdivisions", "0"]
SMALL = ["--integrator", "radiosity", "--size", "16x16", "--spp", "1", "--device", "cpu", *UNMETERED]
MIRROR = "newmtl a\nillum 3\nKd 0 0 0\nKs 1 1 1\nNs 1000\n"


class Radiosity(CliTest):
    def solve(self, *arguments, scene="cornell-box", output="box.rad"):
        outcome = self.succeed("solve", "radiosity", scene, "-o", output, "--json", *arguments)
        return outcome.events("radiosity_solved")[0], outcome.events("radiosity")[0]

    def picture(self, *arguments, scene="cornell-box"):
        return self.succeed("render", scene, *SMALL, "-o", "x.png", "--json", *arguments).events("done")[0]["hash"]

    def hash_of(self, *flags):
        """Returns the hash of a picture of 16x16 pixels with one sample, unless flags change these."""
        given = ["--integrator", "radiosity", "--device", "cpu", *UNMETERED, *flags]
        for flag, value in [("--size", "16x16"), ("--spp", "1")]:
            given += [] if flag in flags else [flag, value]
        return self.succeed("render", "cornell-box", *given, "-o", "x.png", "--json").events("done")[0]["hash"]

    def test_a_solution_file_gives_the_same_picture_as_solving_within_render(self):
        told, before = self.solve(*COARSE)
        self.assertLessEqual(told["patches"], before["most_patches"])
        self.assertLessEqual(told["bytes"], before["predicted_bytes"])
        self.assertLess(told["left"], 1e-4)
        self.assertEqual(self.picture("--solution", "box.rad"), self.picture(*COARSE))
        self.assertNotEqual(self.picture("--solution", "box.rad"), self.picture("--solution", "box.rad", "--flat-patches"))
        hashes = {self.solve(*COARSE, *flags)[0]["hash"]
                  for flags in [[], ["--solver", "southwell"], ["--solver", "matrix"], ["--seed", "1"],
                                ["--solver", "southwell", "--steps", "20"], ["--form-factors", "hemicube", "--hemicube", "16"],
                                ["--environment", "1,1,1"], ["--lamp", "light=100lm"]]}
        self.assertEqual(len(hashes), 8)
        # With subdivided patches and each solver the file is accepted, and the picture equals that without a file.
        divided = [*COARSE[:-1], "1", "--contrast", "0.02"]
        for flags in [["--solver", "southwell"], ["--solver", "southwell", "--steps", "50"], ["--solver", "matrix"], []]:
            solved, _ = self.solve(*divided, *flags)
            self.assertEqual(self.picture("--solution", "box.rad"), self.picture(*divided, *flags), flags)
            facts = self.succeed("info", "box.rad", "--json").events("info")[0]
            self.assertEqual((facts["hash"], facts["shown"], facts["holds"]), (solved["hash"], solved["shown"], "all light"))
            self.assertIn(flags[1] if flags else "gauss-seidel", facts["made_by"])
        self.assertEqual(self.solve(*COARSE, "--threads", "1")[0]["hash"], told["hash"])

    def test_a_solution_is_accepted_for_any_view_and_refused_under_other_light(self):
        self.solve(*COARSE)
        solved = self.hash_of(*COARSE)
        for view in [["--eye", "0.3,0.2,2", "--fov", "50"], ["--size", "9x7"], ["--spp", "2"], ["--max-depth", "2"]]:
            taken = self.hash_of("--solution", "box.rad", *view)
            self.assertEqual(taken, self.hash_of(*COARSE, *view), view)
            if view[0] != "--max-depth":
                self.assertNotEqual(taken, solved, view)
        show = ["render", "cornell-box", *SMALL, "-o", "x.png", "--solution", "box.rad"]
        for light, says in [(["--lamp", "light=100lm"], "with other materials"),
                            (["--environment", "1,1,1"], "under other lights")]:
            self.refuse(2, *show, *light, says=["box.rad: ", says, "solve the scene again with the same settings"])
            self.solve(*COARSE, *light, output="other.rad")
            self.assertEqual(self.picture("--solution", "other.rad", *light), self.picture(*COARSE, *light), light)
            self.refuse(2, *show[:-1], "other.rad", says=["other.rad: ", says])
        # A scene without light gets a default light, which does not depend on the view.
        write(self.path("floor.mtl"), "newmtl a\nKd 0.5 0.5 0.5\n")
        write(self.path("floor.obj"), "mtllib floor.mtl\nusemtl a\n" + FLOOR)
        self.solve(*COARSE, scene="floor.obj", output="floor.rad")
        self.picture("--solution", "floor.rad", "--eye", "0,2,4", "--target", "0,0,0", scene="floor.obj")
        self.picture("--solution", "floor.rad", "--eye", "1,5,0", scene="floor.obj")
        write(self.path("floor.mtl"), "newmtl a\nKd 0.5 0.5 0.6\n")
        self.refuse(2, "render", "floor.obj", *SMALL, "-o", "x.png", "--solution", "floor.rad", says=["floor.rad: "])

    def test_weak_emitters_are_solved_and_shown_without_a_default_sky(self):
        cube = "".join(f"v {x} {y} {z}\n" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))
        body = "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
        lamp = "".join(f"v {x} 1.01 {z}\n" for x in (0, 0.02) for z in (0, 0.02))
        write(self.path("weak.mtl"), "newmtl b\nKd .5 .5 .5\nnewmtl l\nKd 0 0 0\nKe 5 5 5\n")
        write(self.path("weak.obj"), "mtllib weak.mtl\n" + cube + "usemtl b\n" + body + lamp + "usemtl l\nf 9 10 12 11\n")
        self.solve(*COARSE, scene="weak.obj", output="weak.rad")
        shown = self.picture("--solution", "weak.rad", scene="weak.obj")
        self.assertEqual(shown, self.picture(*COARSE, "--environment", "0,0,0", scene="weak.obj"))
        self.assertNotEqual(shown, self.picture(*COARSE, scene="weak.obj"))

    def test_a_solution_is_refused_at_another_time(self):
        scene = json.loads(moving_gltf())
        scene["materials"] = [{"pbrMetallicRoughness": {"metallicFactor": 0}}]
        scene["meshes"][0]["primitives"][0]["material"] = 0
        write(self.path("m.gltf"), json.dumps(scene))
        self.solve(*COARSE, "--time", "1", scene="m.gltf")
        self.assertEqual(self.picture("--solution", "box.rad", "--time", "1", scene="m.gltf"),
                         self.picture(*COARSE, "--time", "1", scene="m.gltf"))
        for time_s in [["--time", "1.5"], []]:
            self.refuse(2, "render", "m.gltf", *SMALL, "-o", "x.png", "--solution", "box.rad", *time_s,
                        says=["box.rad: ", "--time"])

    def start(self, *arguments):
        program = subprocess.Popen([PROGRAM, *arguments, "--json"], cwd=self.folder, env=self.environment,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        return program

    def end(self, program):
        """Sends Ctrl-C and returns the events that follow and their processor time."""
        before = spent = sum(self.times_of(program))
        program.send_signal(signal.SIGINT)
        while program.poll() is None:
            spent = sum(self.times_of(program))
            time.sleep(0.01)
        lines = program.communicate(timeout=PATIENCE_S)[0].decode().splitlines()
        return [json.loads(line) for line in lines], spent - before

    @staticmethod
    def times_of(program):
        """Returns the seconds of user and system time."""
        with open(f"/proc/{program.pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return [int(fields[i]) / os.sysconf("SC_CLK_TCK") for i in (11, 12)]

    def test_an_interrupted_render_has_the_hash_of_a_render_with_as_many_samples(self):
        self.solve(*COARSE)
        flags = ["render", "cornell-box", "--integrator", "radiosity", "--solution", "box.rad", "--size", "16x16",
                 "--device", "cpu", "-o", "x.exr"]
        program = self.start(*flags, "--spp", "8388607", "--threads", "2")
        next(line for line in program.stdout if json.loads(line)["event"] == "progress")
        done = next(event for event in self.end(program)[0] if event["event"] == "done")
        self.assertEqual((program.returncode, done["interrupted"]), (75, True))
        again = self.succeed(*flags, "--spp", done["samples"], "--threads", "1", "--json").events("done")[0]
        self.assertEqual(again["hash"], done["hash"])

    def test_an_interrupt_while_rows_are_computed_leaves_no_file(self):
        long = ["--patch-size", "0.1", "--patch-rays", "1048576"]
        for arguments in [["solve", "radiosity", "cornell-box", "-o", "long.rad", *long],
                          ["render", "cornell-box", *SMALL, "-o", "long.png", *long]]:
            program = self.start(*arguments)
            next(line for line in program.stdout if json.loads(line)["event"] == "radiosity")
            self.wait_while(program, False)
            time.sleep(0.3)
            events, seconds = self.end(program)
            self.assertEqual(program.returncode, 75)
            self.assertLess(seconds, 1)  # a single row takes as long
            self.assertEqual([event["event"] for event in events if event["event"] != "progress"], ["error"])
            self.assertEqual(events[-1]["code"], "interrupted")
        self.assertEqual([name for name in self.files() if name.startswith("long")], [])

    def check_unfinished(self, file, holds):
        """Tests that a picture of an unfinished solution has a warning that names the file's light."""
        warnings = [event for event in self.remarks("render", "cornell-box", *SMALL, "-o", "x.png", "--solution", file)
                    if event.get("place") == {"file": file}]
        self.assertEqual([event["event"] for event in warnings], ["warning"])
        self.assertIn(holds, warnings[0]["reason"])

    def test_an_interrupt_while_links_are_made_keeps_an_unfinished_solution(self):
        program = self.start("solve", "radiosity", "cornell-box", "-o", "ended.rad", "--solver", "hierarchical",
                             "--patch-size", "0.01", "--link-error", "0.001")
        next(line for line in program.stdout if json.loads(line)["event"] == "radiosity")
        self.wait_while(program, False)
        time.sleep(0.3)
        events, _ = self.end(program)
        self.assertEqual(program.returncode, 75)
        (solved,) = [event for event in events if event["event"] == "radiosity_solved"]
        self.assertTrue(solved["interrupted"])
        self.assertEqual([events[-1][key] for key in ["event", "interrupted", "hash"]], ["done", True, solved["hash"]])
        self.assertIn("light", solved["holds"])
        self.check_unfinished("ended.rad", solved["holds"])

    def test_an_interrupt_while_the_matrix_is_eliminated_keeps_direct_light(self):
        program = self.start("solve", "radiosity", "cornell-box", "-o", "ended.rad", "--solver", "matrix", "--threads", "1",
                             "--patch-size", "0.1", "--patch-rays", "16")
        next(line for line in program.stdout if json.loads(line).get("step") == "solving")
        events, _ = self.end(program)
        self.assertEqual(program.returncode, 75)
        (solved,) = [event for event in events if event["event"] == "radiosity_solved"]
        self.assertEqual((solved["interrupted"], solved["steps"]), (True, 0))
        self.assertIn("only direct light", solved["holds"])
        self.check_unfinished("ended.rad", solved["holds"])

    def test_progress_names_each_step_and_the_last_event_has_the_result(self):
        keys = ["event", "seconds", "step", "share", "seconds_left"]
        for solver, steps in [("gauss-seidel", ["form factors", "solving", "dividing patches"]),
                              ("matrix", ["form factors", "solving", "dividing patches"]),
                              ("hierarchical", ["direct light", "links, pass 1", "dividing patches"])]:
            outcome = self.succeed("solve", "radiosity", "cornell-box", "-o", "box.rad", "--solver", solver, "--json",
                                   "--patch-size", "0.2", "--patch-rays", "64", "--contrast", "0.02")
            self.assertEqual(outcome.stderr, "")
            told = outcome.events("progress")
            self.assertEqual({tuple(event) for event in told}, {tuple(keys)})
            self.assertLessEqual(set(steps), {event["step"] for event in told})
            self.assertTrue(all(0 <= event["share"] <= 1 for event in told))
            seconds = [event["seconds"] for event in told]
            self.assertEqual(seconds, sorted(seconds))
            kinds = [event["event"] for event in outcome.events() if event["event"] not in ["notice", "warning", "progress"]]
            self.assertEqual(kinds, ["radiosity", "radiosity_solved", "output", "done"])
            done, solved = outcome.events()[-1], outcome.events("radiosity_solved")[0]
            self.assertEqual((done["hash"], done["interrupted"]), (solved["hash"], False))
            self.assertLessEqual(done["seconds"], done["total_seconds"])
            self.assertGreater(done["peak_bytes"], 2**20)
            self.assertEqual(solved["link_error"], 0.1 if solver == "hierarchical" else None)
        # Solving within a render reports it, too.
        outcome = self.succeed("render", "cornell-box", *SMALL, "-o", "x.png", "--json", *COARSE)
        self.assertIn("form factors", [event["step"] for event in outcome.events("progress")])
        self.assertEqual(outcome.events("progress")[-1]["step"], "samples")

    def test_a_solution_file_with_a_picture_extension_is_refused(self):
        for name in ["box.png", "box.EXR"]:
            self.refuse(2, "solve", "radiosity", "cornell-box", "-o", name, *COARSE, says=["box.rad"])

    def test_memory_stays_below_the_prediction_and_a_lower_limit_is_refused(self):
        for flags in [["--patch-size", "0.05"], ["--patch-size", "0.05", "--solver", "southwell"],
                      ["--patch-size", "0.08", "--form-factors", "hemicube", "--hemicube", "16"],
                      ["--patch-size", "0.05", "--solver", "hierarchical"]]:
            flags = [*flags, "--patch-rays", "64", "--subdivisions", "1"]
            program = self.start("solve", "radiosity", "cornell-box", "-o", "box.rad", *flags)
            predicted = next(json.loads(line) for line in program.stdout if b'"radiosity"' in line)["predicted_bytes"]
            program.kill()
            told, before = self.solve(*flags, "--max-memory", predicted / 2**20 + 0.01)
            self.assertEqual(before["predicted_bytes"], predicted)
            self.assertLess(told["peak_bytes"] - before["peak_bytes"], predicted, flags)
            self.assertLessEqual(told["shown"], before["most_shown"])
            self.refuse(4, "solve", "radiosity", "cornell-box", "-o", "m.rad", *flags, "--max-memory",
                        predicted / 2**20 - 0.01, says=["--max-memory",
                                                        "--solver gauss-seidel" if "hierarchical" in flags else "--patch-rays"])

    def test_a_picture_too_large_for_memory_is_refused_before_the_scene_is_solved(self):
        outcome = self.refuse(4, "render", "cornell-box", "-o", "x.png", "--integrator", "radiosity", "--size", "4096x4096",
                              "--max-memory", "200", "--json", says=["--max-memory"])
        self.assertEqual(outcome.events("radiosity"), [])

    def test_a_closed_scene_without_absorption_is_refused(self):
        box = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
        for a, b, c, d in [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]:
            box += f"f {a} {d} {c} {b}\n"  # inwards
        write(self.path("white.mtl"), "newmtl a\nKd 1 1 1\nKe 1 1 1\n")
        write(self.path("white.obj"), "mtllib white.mtl\nusemtl a\n" + box)
        self.refuse(2, "solve", "radiosity", "white.obj", "-o", "w.rad", "--patch-size", "0.5", says=["radiosity: "])

    def test_errors_of_invalid_requests_name_the_setting_or_the_file(self):
        write(self.path("mirror.mtl"), MIRROR)
        write(self.path("mirror.obj"), "mtllib mirror.mtl\nusemtl a\n" + FLOOR)
        write(self.path("text.rad"), "no solution at all")
        self.solve(*COARSE)
        with open(self.path("box.rad"), "rb") as whole, open(self.path("cut.rad"), "wb") as cut:
            cut.write(whole.read()[:-7])
        write(self.path("floor.obj"), FLOOR)
        look = ["--eye", "0,2,4", "--target", "0,0,0"]
        for arguments, status, named in [ # a setting, or a file
                ("solve radiosity mirror.obj -o m.rad --environment 1,1,1", 2, "scene"),
                ("solve radiosity nowhere.obj -o m.rad --steps 5", 2, "steps"),
                ("solve radiosity nowhere.obj -o m.rad --hemicube 64", 2, "hemicube"),
                ("solve radiosity nowhere.obj -o m.rad --solver matrix --tolerance 0.1", 2, "tolerance"),
                ("solve radiosity nowhere.obj -o m.rad --patch-size 0", 2, "patch_size"),
                ("solve radiosity nowhere.obj -o nowhere/m.rad", 6, "nowhere/m.rad"),
                ("solve radiosity cornell-box -o m.rad --patch-size 1e-5", 3, "patch_size"),
                ("solve radiosity cornell-box -o m.rad --patch-size 0.01 --patch-rays 16 --solver matrix", 3, "solver"),
                ("render nowhere.obj -o x.png --solution box.rad", 2, "solution"),
                ("render nowhere.obj -o x.png --patch-size 1", 2, "patch_size"),
                ("render nowhere.obj -o x.png --integrator radiosity --solution none.rad", 2, "solution"),
                ("render nowhere.obj -o x.png --integrator radiosity --solution box.rad --patch-rays 64", 2, "patch_rays"),
                ("render nowhere.obj -o x.png --integrator radiosity --denoise svgf", 2, "denoise"),
                ("render nowhere.obj -o x.png --integrator radiosity --lpe seen=LE -o x.exr", 2, "lpe"),
                ("render nowhere.obj -o x.png --integrator radiosity --max-depth 256", 3, "max_depth"),
                ("render cornell-box -o x.png --integrator radiosity --shutter 0.1", 2, "shutter"),
                ("render cornell-box -o x.png --integrator radiosity --solution text.rad", 2, "text.rad"),
                ("render cornell-box -o x.png --integrator radiosity --solution cut.rad", 2, "cut.rad"),
                ("render floor.obj -o x.png --integrator radiosity --solution box.rad", 2, "box.rad")]:
            with self.subTest(arguments=arguments):
                more = look if "render floor.obj" in arguments else []
                error = self.refuse(status, *arguments.split(), *more, "--json").events("error")[0]
                self.assertEqual(error.get("setting", error.get("place", {}).get("file")), named, error)
                self.assertNotIn("\n", error["text"])
                self.assertFalse(os.path.exists(self.path("m.rad")))
        self.refuse(2, "solve", "nothing", says=["nothing"])
        self.assertNotIn("x.png", self.files())

    def test_metadata_record_how_the_radiosity_was_solved(self):
        self.solve(*COARSE, "--solver", "southwell")
        self.succeed("render", "cornell-box", *SMALL[:-2], "-o", "x.exr", "--solution", "box.rad")
        told = self.info("x.exr")
        made = json.loads(told["pertev.radiosity"])
        self.assertEqual((made["solver"], made["rays"], made["form_factors"]), ("southwell", 16, "rays"))
        self.assertEqual(len(told["pertev.radiosity_hash"]), 32)


if __name__ == "__main__":
    main()
