#!/usr/bin/env python3
"""Help of the command line: suggestions for misspelled words and missing files, and progress in logs."""

import os
import pty
import re
import signal
import subprocess
import time

from cli_run import FLOOR, PROGRAM, CliTest, listen_to, main, write

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SMALL = ["--size", "8x8", "--spp", "1", "--device", "cpu"]


class Flags(CliTest):
    def long_flags(self, *verb):
        text = self.succeed(*verb, "--help", "all").stdout
        return sorted(set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", re.sub(r" {3,}.*", "", text))))

    def test_unknown_flags_are_listed_in_order_with_suggestions(self):
        self.refuse(2, "render", "cornell-box", "--sppp", "4", "-o", "x.png", "--qwertz", "--max_depth=3", "-Q", says=[
            "pertev: --sppp: no such flag (did you mean --spp?); --qwertz: no such flag; --max_depth: no such flag "
            "(did you mean --max-depth?); -Q: no such flag (did you mean -q?)\n"])
        self.refuse(2, "info", "--zzz", "--aaa", says=["--zzz: no such flag; --aaa: no such flag\n"])

    def test_an_unknown_flag_is_reported_before_errors_that_follow_from_it(self):
        for line, meant in [("render cornell-box --ouptut x.png", "--output"), ("render cornell-box --out x.png", "--output"),
                            ("render --sp 4 cornell-box -o x.png", "--spp"), ("lab --thesys", "--thesis"),
                            ("compare x.png --block 2", "--blocks"), ("bench render --sceen x.obj", "--scene"),
                            ("bench rays --cuont 3", "--count"), ("render cornell-box -o x.png --depth 3", "--max-depth"),
                            ("render cornell-box -o x.png -spp 3", "--spp"), ("--verison", "--version"),
                            ("render cornell-box -o x.png --Seed=3", "--seed"), ("render cornell-box -o x.png --width 3", "--size"),
                            ("render cornell-box -o x.png --bounces=3", "--max-depth"), ("render cornell-box -o x.png --fov-deg 3", "--fov")]:
            with self.subTest(line=line):
                outcome = self.refuse(2, *line.split(), says=[f"no such flag (did you mean {meant}?)"])
                self.assertNotIn("required:", outcome.stderr.replace("a verb is required:", ""))

    def test_a_flag_with_two_swapped_letters_gets_the_right_suggestion(self):
        for verb in [["render"], ["lab"], ["bench", "rays"]]:
            for flag in self.long_flags(*verb):
                if len(flag) < 6:
                    continue
                swapped = flag[:4] + flag[5] + flag[4] + flag[6:]
                if swapped != flag:
                    self.refuse(2, *verb, swapped, says=[f"{swapped}: no such flag (did you mean {flag}?)"])

    def test_an_extra_word_is_reported_with_a_suggestion(self):
        self.refuse(2, "rendr", "cornell-box", says=["rendr: not understood (did you mean render?)", "a verb is required"])
        self.refuse(2, "rendr", "cornell-box", "-o", "x.png", says=["pertev: rendr: not understood (did you mean render?); a"])
        self.refuse(2, "bench", "ray", says=["ray: not understood (did you mean rays?)"])
        self.refuse(2, "render", "cornell-box", "-o", "a.png", "b.exr", says=["b.exr: not understood", "its own -o"])
        self.refuse(2, "info", "cornell-box", "x.png", says=["x.png: not understood\n"])
        self.refuse(2, "render", "cornell-box", "-o", "x.png", "--eyes", "-.5,0,1", says=["--eyes", "--eye?)\n"])

        self.refuse(2, "render", "cornell-box", "-o", "x.png", "--eye", "1", "2", "3",
                    says=["2, 3: not understood; components of a vector are joined by commas: 1,2,3\n"])
        self.refuse(2, "bench", "cornell-box", says=["cornell-box: not understood; scenes are named by --scene\n"])

    def test_help_before_a_verb_is_the_help_of_the_verb(self):
        for verb in [[], ["render"], ["bench", "sequence"]]:
            self.assertEqual(self.succeed("help", *verb).stdout, self.succeed(*verb, "--help").stdout)
        self.refuse(2, "help", "rendr", says=["rendr: not understood"])

    def test_version_and_devices_are_listed(self):
        self.assertEqual(self.succeed("-V").stdout, self.succeed("--version").stdout)
        lines = self.succeed("--list-devices").stdout.splitlines()
        self.assertRegex(lines[-1], rf"^cpu +.+, \d+ MiB, {len(os.sched_getaffinity(0))} threads, (8|16) lanes$")
        for line in lines[:-1]:  # CUDA_VISIBLE_DEVICES is empty; a build without CUDA has another message
            self.assertRegex(line, "^(no CUDA device: |cuda:\\d+ )")

    def test_an_empty_name_is_reported_as_empty(self):
        for line, what in [(["render", "", "-o", "x.png"], "SCENE"), (["render", "cornell-box", "-o", ""], "--output"),
                           (["info", ""], "FILE"), (["compare", "", "x.png"], "A"), (["compare", "x.png", ""], "B"),
                           (["lab", ""], "SCENE")]:
            self.refuse(2, *line, says=[f"pertev: {what}: the name is empty\n"])

    def test_the_error_for_a_flag_before_its_verb_names_the_verb(self):
        self.refuse(2, "--spp", "4", "render", "cornell-box", "-o", "x.png", says=["--spp is a flag of render"])
        self.refuse(2, "--json", "info", "cornell-box", says=[])

    def test_json_that_is_switched_off_gives_errors_as_text(self):
        for off in [["--json=false"], ["--json=No"], ["--json=0"], ["--json", "--json=off"]]:
            for line in [["info", "gone.obj"], ["render", "--qwertz"]]:
                outcome = self.run_pertev(*line, *off)
                self.assertEqual((outcome.status, outcome.stdout), (2, ""), outcome)
                self.assertRegex(outcome.stderr, "^pertev: ")
        for on in [["--json"], ["--json=true"], ["--json=false", "--json"]]:
            outcome = self.run_pertev("info", "gone.obj", *on)
            self.assertEqual((outcome.stderr, outcome.events("error")[0]["status"]), ("", 2), outcome)
        self.refuse(2, "--quiet", "bench", "rays", says=["--quiet is a flag of bench"])

    def test_a_comma_separated_list_of_outputs_is_refused_with_the_right_flags(self):
        for given, meant in [("a.png,b.exr", "-o a.png -o b.exr\n"), ("a.png,b", "-o a.png -o b\n"),
                             ("x/a.png,b.exr,c.jpg", "-o x/a.png -o b.exr -o c.jpg\n")]:
            self.refuse(2, "render", "nowhere.obj", "-o", given, says=[f"-o {given}: ", meant])
        self.assertNotIn("-o", self.succeed("render", "cornell-box", "-o", "one,two.png", *SMALL).stderr)

    def test_verbs_with_one_output_refuse_lists_and_explain_number_signs(self):
        self.refuse(2, "solve", "radiosity", "nowhere.obj", "-o", "x.rad,y.rad", says=["-o x.rad -o y.rad"])
        self.refuse(2, "bench", "render", "--scene", "nowhere.obj", "-o", "a.png,b.exr", says=["-o a.png -o b.exr"])
        for line in [["solve", "radiosity", "nowhere.obj", "-o", "x-##.rad"], ["bench", "render", "--scene", "nowhere.obj", "-o", "a-##.png"]]:
            self.assertIn("# and {name} are replaced", self.refuse(2, *line, says=["nowhere.obj"]).stderr)

    def test_an_output_named_twice_is_refused_before_the_scene_is_read(self):
        os.mkdir(self.path("f"))
        os.symlink("b.png", self.path("link.png"))
        for first, second in [("a.png", "a.png"), ("a.png", "./a.png"), ("f/../a.png", "a.png"), ("b.png", "link.png"),
                              ("a.png", self.path("a.png"))]:
            with self.subTest(first=first, second=second):
                self.refuse(2, "render", "nowhere.obj", "-o", first, "-o", "c.exr", "-o", second, says=["-o " + first, "same file"])
        frames = ["--frames", "0-10"]
        self.refuse(2, "render", "nowhere.obj", "-o", "f-#.png", "-o", "f-##.png", *frames, says=["f-##.png", "frame 10"])
        self.succeed("render", "cornell-box", "-o", "f-#.png", "-o", "f-##.png", *SMALL, "--exposure", "0", "--frames", "8-9")
        self.succeed("render", "cornell-box", "-o", "a.png", "-o", "a.exr", "-o", "f/a.png", *SMALL)

    def test_a_frame_number_in_a_name_without_frames_is_reported(self):
        outcome = self.succeed("render", "cornell-box", "-o", "a-###.png", *SMALL)
        self.assertIn("-o 'a-###.png': # and {name} are replaced only with --frames", outcome.stderr)
        self.assertEqual(self.files(), ["a-###.png"])
        for name, flags in [("a.png", []), ("b-#.png", ["--frames", "0-0"]), ("c-#.png", ["--turntable", "1"])]:
            self.assertNotIn("# stands", self.succeed("render", "cornell-box", "-o", name, *SMALL, *flags).stderr)

    def test_help_and_readme_name_every_built_in_scene(self):
        unknown = self.refuse(2, "render", "nothing", "-o", "x.png").stderr
        names = re.search(r"built-in scene \(([^)]*)\)", unknown).group(1).split()
        self.assertIn("cornell-box", names)
        self.assertGreater(len(names), 5)
        with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
            readme = file.read()
        for verb in [["render"], ["view"], ["info"], ["measure"], ["lab"], ["solve", "radiosity"], ["bench", "frames"]]:
            text = self.succeed(*verb, "--help").stdout
            for name in names:
                self.assertRegex(text, rf"[ (]{name}[,;.) \n]", f"{verb}")
        for name in names:
            self.assertIn(f"`{name}`", readme)

    def test_the_first_command_of_the_readme_leaves_nothing_untracked(self):
        with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
            output = re.search(r"pertev render cornell-box -o (\S+)", file.read()).group(1)
        git = subprocess.run(["git", "check-ignore", "-q", "--no-index", output], cwd=ROOT, check=False, stderr=subprocess.DEVNULL)
        if git.returncode == 128:
            self.skipTest("no repository")
        self.assertEqual(git.returncode, 0, output)


class Strictness(CliTest):
    def test_strict_fails_before_rendering_where_a_texture_or_its_file_is_missing_or_broken(self):
        square = FLOOR.replace("f 4 3 2 1", "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 4/4 3/3 2/2 1/1")
        write(self.path("broken.png"), "no picture")
        for name, material in [("gone", "newmtl m\nmap_Kd gone.png\n"), ("broken", "newmtl m\nmap_Kd broken.png\n"),
                               ("plain", "newmtl m\nKd 1 0 0\n")]:
            write(self.path(name + ".mtl"), material)
            write(self.path(name + ".obj"), f"mtllib {name}.mtl\nusemtl m\n{square}")
        write(self.path("nowhere.obj"), f"mtllib nowhere.mtl\nusemtl m\n{square}")
        write(self.path("two.mtl"), "newmtl m\nmap_Kd gone.png\nmap_Ke broken.png\n")
        write(self.path("two.obj"), f"mtllib two.mtl\nusemtl m\n{square}")
        look = ["--eye", "0,2,4", "--target", "0,0,0", *SMALL]
        for scene, missing in [("gone", "gone.png"), ("broken", "broken.png"), ("nowhere", "nowhere.mtl")]:
            for flags in [["--strict"], ["--strict", "-q"], ["--strict", "--json"]]:
                with self.subTest(scene=scene, flags=flags):
                    outcome = self.refuse(2, "render", scene + ".obj", "-o", "x.png", *flags, *look,
                                          says=["--strict: ", missing, "nothing was rendered"])
                    self.assertNotIn("progress", outcome.stdout)
        self.refuse(2, "render", "two.obj", "-o", "x.png", "--strict", *look, says=["gone.png", "and 1 warning like it"])
        for scene in ["gone", "broken", "nowhere"]:
            self.succeed("render", scene + ".obj", "-o", scene + ".png", *look)
        self.succeed("render", "plain.obj", "-o", "plain.png", "--strict", *look)
        self.assertIn("--strict", self.succeed("render", "--help").stdout)

    def test_strict_counts_a_gltf_files_pictures_too(self):
        write(self.path("m.gltf"), """{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "images": [{"uri": "gone.png"}], "textures": [{"source": 0}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0],
                           "max": [1, 1, 0]}, {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri":
                "data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}]}""")
        self.succeed("render", "m.gltf", "-o", "x.png", *SMALL)
        self.refuse(2, "render", "m.gltf", "-o", "y.png", "--strict", *SMALL, says=["gone.png"])


class Pipes(CliTest):
    def test_a_closed_pipe_is_not_an_error(self):
        self.succeed("render", "cornell-box", "-o", "a.exr", *SMALL)
        for arguments in [["--help"], ["--version"], ["render", "--help"], ["info", "cornell-box"], ["info", "a.exr", "--json"],
                          ["compare", "a.exr", "a.exr"], ["measure", "cornell-box", "--at", "0.3,0,0.3", "--normal", "0,1,0", "--spp", "1"]]:
            with self.subTest(arguments=arguments):
                reading, writing = os.pipe()
                os.close(reading)
                outcome = self.run_pertev(*arguments, stdout=writing)
                os.close(writing)
                self.assertEqual(outcome.status, 0, outcome)
                self.assertNotIn("standard output", outcome.stderr)
        reading, writing = os.pipe()
        os.close(reading)
        outcome = self.run_pertev("info", "nowhere.obj", "--json", stdout=writing)  # the error is reported and determines the status
        os.close(writing)
        self.assertEqual(outcome.status, 2, outcome)
        self.assertIn("nowhere.obj", outcome.stderr)
        self.assertNotIn("standard output", outcome.stderr)


class SignsOfLife(CliTest):
    def start(self, *flags, size="32x32", **options):
        program = subprocess.Popen([PROGRAM, "render", "cornell-box", "-o", "x.png", "--device", "cpu", "--threads", "1",
                                    "--size", size, "--spp", "8388607", *flags], cwd=self.folder,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   **{"stderr": subprocess.PIPE, "env": self.environment, **options})
        self.addCleanup(program.kill)
        return program

    def on_a_terminal(self, *flags, **terms):
        """Returns the output on a terminal with this value of TERM, or without TERM."""
        leader, follower = pty.openpty()
        environment = {name: value for name, value in self.environment.items() if name != "TERM"}
        program = self.start(*flags, stderr=follower, env={**environment, **terms})
        os.close(follower)
        return program, *listen_to(leader)

    def test_without_a_progress_bar_a_line_every_10_s_reports_progress(self):
        enough = ["--time-limit", "10.4", "--exposure", "0"]
        to_a_file = self.start(*enough)
        quiet = self.start(*enough, "-q")
        dumb, listener, said = self.on_a_terminal(*enough, TERM="dumb")
        in_a_sample = self.start("--exposure", "0", size="4000x2250")
        # They sleep for most of that time, which the clock measures, so other tests can use the processor.
        time.sleep(1)
        for signalled, seconds in [(signal.SIGSTOP, 8), (signal.SIGCONT, 0)]:
            for program in [to_a_file, quiet, dumb, in_a_sample]:
                program.send_signal(signalled)
            time.sleep(seconds)
        beat = next(line for line in in_a_sample.stderr if re.match(rb"\d+ s: ", line))
        self.assertRegex(beat, rb"^\d+ s: rendering$")
        in_a_sample.kill()
        in_a_sample.communicate()
        for program in [to_a_file, quiet]:
            program.said = program.communicate(timeout=300)[1].decode()
        dumb.communicate(timeout=300)
        listener.join()
        self.assertEqual(quiet.said, "")
        for program, text in [(to_a_file, to_a_file.said), (dumb, b"".join(said).decode().replace("\r\n", "\n"))]:
            self.assertEqual(program.returncode, 0, text)
            beats = re.findall(r"(?m)^(\d+) s: (.*)$", text)
            self.assertGreater(len(beats), 0, text)
            self.assertEqual([int(seconds) // 10 for seconds, _ in beats], list(range(1, len(beats) + 1)), text)
            self.assertRegex(beats[0][1], r"^\d+ %  \d+/8388607 spp  [\d.]+ Mrays/s  \d+ s left$")
            self.assertNotRegex(text, r"[\x1b\r]")

    def test_an_unknown_terminal_gets_no_escape_sequences(self):
        for terms, draws in [({"TERM": "dumb"}, False), ({}, False), ({"TERM": "xterm"}, True)]:
            program, listener, said = self.on_a_terminal("--time-limit", "0.3", **terms)
            program.communicate(timeout=300)
            listener.join()
            text = b"".join(said)
            self.assertEqual((program.returncode, b"\x1b" in text, b"\r[" in text), (0, draws, draws), text)


if __name__ == "__main__":
    main()
