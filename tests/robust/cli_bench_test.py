#!/usr/bin/env python3
"""`pertev bench` and its verbs: nothing is measured before the whole line is known to be right, and Ctrl-C is heard."""

import json
import os
import signal
import subprocess
import tempfile
import time

from cli_run import FLOOR, PROGRAM, CliTest, main, write

SMALL = ["--device", "cpu", "--size", "16x16", "--spp", "1"]


class Bench(CliTest):
    def test_scenes_are_measured_as_a_user_meets_them(self):
        made = self.succeed("bench", *SMALL, "--scene", "cornell-box", "--json").events("bench")
        self.assertEqual([(of["scene"], of["triangles"]) for of in made], [("cornell-box", 38)])
        for key in ["samples_per_second", "camera_rays_per_second", "bounce_rays_per_second", "tree_bytes_per_triangle"]:
            self.assertGreater(made[0][key], 0, key)
        text = self.succeed("bench", *SMALL, "--scene", "cornell-box", "--scene", "cornell-box").stdout
        self.assertRegex(text, r"(?s)^seconds: .*\nscene +device .*\ncornell-box .*\ncornell-box .*\n$")

    def test_a_flag_before_a_verb_of_bench_ends_with_2_and_says_where_it_belongs(self):
        for flag in ["--device cuda", "--scene nowhere.obj", "--size 8x8", "--spp 1", "--threads 1", "--json", "-q"]:
            for verb in [["rays", "--count", "100"], ["render"]]:
                with self.subTest(flag=flag, verb=verb[0]):
                    outcome = self.refuse(2, "bench", *flag.split(), *verb, "--scene", "cornell-box",
                                          says=[flag.split()[0].replace("-q", "--quiet"), f"`bench {verb[0]}`"])
                    self.assertEqual(len(outcome.stdout.splitlines()), flag == "--json")
        self.refuse(2, "bench", "rays", "render", "--scene", "cornell-box", says=["render"])

    def test_errors_of_the_line_come_before_anything_is_measured_or_printed(self):
        rays = ["bench", "rays", "--count", "100", "--device", "cpu"]
        lines = [(["bench", "--scene", "cornell-box", "--size", "0x0"], "--size 0x0"),
                 (["bench", "--scene", "cornell-box", "--scene", "nowhere.obj"], "--scene nowhere.obj"),
                 (["bench", "--scene", "cornell-box", "--scene", "spnza"], "--scene spnza"),
                 (["bench", "render", "--scene", "nowhere.obj", "-o", "x.exr"], "--scene nowhere.obj"),
                 (["bench", "render", "--scene", "cornell-box", "-o", "x.bmp"], "x.bmp"),
                 ([*rays, "--scene", "cornell-box", "--scene", "nowhere.obj"], "--scene nowhere.obj"),
                 ([*rays, "--scene", "cornell-box", "--scene", "spnza"], "sponza, bunny or forest"),
                 ([*rays, "--scene", "cornell-box", "--scene", "sponza"], "PERTEV_SCENES")]
        environment = dict(self.environment, PERTEV_SCENES=self.folder)
        for line, says in lines:
            with self.subTest(line=line):
                self.assertEqual(self.refuse(2, *line, says=[says], env=environment).stdout, "")
        write(self.path("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        for verb in [["bench"], rays]:  # what only its content tells
            self.assertEqual(self.refuse(2, *verb, "--scene", "flat.obj", says=["no geometry"]).stdout, "")

    def test_an_interrupt_ends_each_of_them_with_75_and_keeps_what_is_printed(self):
        endless = {"bench": ["--size", "512x512", "--spp", "1000000"],
                   "bench render": ["--size", "512x512", "--spp", "1000000", "-o", "x.exr"],
                   "bench rays": ["--count", "400000", "--runs", "10000"]}
        for verb, flags in endless.items():
            for kind in [signal.SIGINT, signal.SIGTERM]:
                with self.subTest(verb=verb, signal=kind), tempfile.TemporaryDirectory() as scratch:
                    program = subprocess.Popen([PROGRAM, *verb.split(), "--device", "cpu", "--scene", "cornell-box", *flags],
                                               cwd=self.folder, env=dict(self.environment, TMPDIR=scratch),
                                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                    self.addCleanup(program.kill)
                    self.wait_while(program, is_listening=False)
                    time.sleep(0.5)  # it is measuring
                    start = time.monotonic()
                    program.send_signal(kind)
                    stdout, stderr = program.communicate(timeout=300)
                    self.assertEqual(program.returncode, 75, stderr)
                    self.assertLess(time.monotonic() - start, 60)
                    self.assertRegex(stderr.decode(), r"pertev: interrupted( before .*)?\n$")  # the latter while it loads
                    self.assertEqual(os.listdir(scratch), [])
                    self.assertEqual(self.files(), [])
                    self.assertEqual(stdout, b"")

    def test_an_interrupt_keeps_the_sets_that_are_done(self):
        write(self.path("floor.obj"), FLOOR)
        program = subprocess.Popen([PROGRAM, "bench", "rays", "--device", "cpu", "--json", "--runs", "300", "--count",
                                    "100000", "--scene", "floor.obj", *8 * ["--scene", "cornell-box"]], cwd=self.folder,
                                   env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        said = []
        while not said or json.loads(said[-1])["event"] != "rays":
            said.append(program.stdout.readline())
        program.send_signal(signal.SIGINT)
        rest, stderr = program.communicate(timeout=300)
        self.assertEqual(program.returncode, 75, stderr)
        events = [json.loads(line)["event"] for line in b"".join([*said, rest]).splitlines()]
        self.assertLess(events.count("rays"), 45)


if __name__ == "__main__":
    main()
