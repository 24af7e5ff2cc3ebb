#!/usr/bin/env python3
"""Tests of every integrator's pictures, and of properties that only one integrator has.
cli_integrators_test.py PERTEV [--device cuda]"""

import base64
import json
import signal
import struct
import subprocess
import time
import unittest

from cli_run import DEVICE, PATIENCE_S, PROGRAM, CliTest, main, write

INTEGRATORS = ["path", "direct", "indirect", "hybrid", "cast", "whitted", "distributed", "raster", "reyes", "light", "bidirectional",
               "photon_map"]
VIEW = ["--eye", "0.3,0.3,2", "--target", "0.3,0.3,0"]  # the lit triangle


def lit_triangle():
    """A glTF file of a triangle with a point light in front of it. The texture coordinates are the positions."""
    corners = base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()
    light = {"KHR_lights_punctual": {"light": 0}}
    return json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_lights_punctual"], "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}},
        "nodes": [{"mesh": 0}, {"extensions": light, "translation": [0.2, 0.3, 0.5]}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + corners}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteLength": 36, "byteStride": 12}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}],
        "materials": [{"name": "skin"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}]})


class Integrators(CliTest):
    def test_a_time_limited_render_has_the_hash_of_a_render_with_as_many_samples(self):
        write(self.path("lit.gltf"), lit_triangle())
        for integrator in INTEGRATORS:
            flags = ["--integrator", integrator, *VIEW]
            done = self.render(*flags, "--time-limit", "0.1", scene="lit.gltf", size="24x24", spp=8388607)
            again = self.render(*flags, scene="lit.gltf", size="24x24", spp=done["samples"])
            self.assertEqual(again["hash"], done["hash"], integrator)

    def test_an_interrupted_render_has_the_hash_of_a_render_with_as_many_samples(self):
        write(self.path("lit.gltf"), lit_triangle())
        for integrator in INTEGRATORS:
            flags = ["--integrator", integrator, *VIEW, "--threads", "2"]
            program = subprocess.Popen([PROGRAM, "render", "lit.gltf", "-o", "ended.exr", "--size", "24x24", "--spp", "8388607",
                                        "--device", DEVICE, "--json", *flags], cwd=self.folder, env=self.environment,
                                       stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.addCleanup(program.kill)
            first = next(line for line in program.stdout
                         if json.loads(line)["event"] == "progress" and json.loads(line)["samples"] > 0)
            program.send_signal(signal.SIGINT)
            lines = (first + program.communicate(timeout=PATIENCE_S)[0]).decode().splitlines()
            done = next(json.loads(line) for line in lines if json.loads(line)["event"] == "done")
            self.assertEqual((program.returncode, done["interrupted"]), (75, True), integrator)
            self.assertLess(0, done["samples"], integrator)
            again = self.render(*flags[:-1], "1", scene="lit.gltf", size="24x24", spp=done["samples"], output="again.exr")
            self.assertEqual(again["hash"], done["hash"], integrator)

    def check_nothing_is_kept(self, kind, *arguments):
        """Tests that a signal of this kind ends the program after its first progress and before its first sample."""
        program = subprocess.Popen([PROGRAM, *arguments, "--json"], cwd=self.folder, env=self.environment,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        while json.loads(program.stdout.readline())["event"] != "progress":
            self.assertIsNone(program.poll())
        program.send_signal(kind)
        stdout, stderr = program.communicate(timeout=30)
        last = json.loads(stdout.splitlines()[-1])
        self.assertEqual((program.returncode, last["code"], last["interrupted"]), (75, "interrupted", True))
        self.assertEqual((last["text"].split()[0], stderr), ("interrupted", b""))

    def test_an_interrupt_while_irradiance_records_are_computed_leaves_no_file(self):
        long = ["render", "cornell-box", "-o", "x.exr", "--size", "320x240", "--spp", "4", "--device", DEVICE, "--integrator",
                "irradiance_cache", "--accuracy", "0.02", "--hemisphere-rays", "4096"]  # computing the records takes hours
        for flags in [[], ["--json"]]:
            began = time.monotonic()
            outcome = self.refuse(75, *long, "--time-limit", "0.5", *flags, says=["--time-limit 0.5"])
            self.assertLess(time.monotonic() - began, 30, outcome)
            for kind in [signal.SIGINT, signal.SIGTERM]:
                self.check_nothing_is_kept(kind, *long)
                self.assertEqual(self.files(), [])

    def test_irradiance_caching_reports_progress_before_the_first_sample(self):
        flags = ["render", "cornell-box", "-o", "x.exr", "--size", "96x96", "--spp", "2", "--device", DEVICE, "--integrator",
                 "irradiance_cache", "--hemisphere-rays", "64"]
        told = self.succeed(*flags, "--json").events("progress")
        before = [event for event in told if event["step"] == "before_samples"]
        self.assertGreater(len(before), 10)
        self.assertEqual(told[:len(before)], before)
        self.assertEqual({event["samples"] for event in before}, {0})
        shares = [event["share"] for event in before]
        self.assertEqual((shares[0], shares), (0, sorted(shares)))
        self.assertGreater(shares[-1], 0.9)
        self.assertGreater(len(set(shares)), 5)
        for event in before:
            if event["share"] != 0.01:
                self.assertEqual(event["seconds_left"] is None, event["share"] < 0.01, event)
        self.assertEqual([(event["samples"], event["share"], event["seconds_left"]) for event in told[-1:]], [(2, 1, 0)])
        self.assertRegex(self.stderr_on_a_terminal(flags),
                         r"\r\[=* *\] +\d+ %  before the first sample  [\d.]+ Mrays/s  \d+ s left\x1b\[K")

    @unittest.skipIf(DEVICE != "cpu", "a GPU may have samples, or be at the limit of work, before the signal comes")
    def test_reyes_can_be_interrupted_while_it_dices(self):
        self.render(output="heights.png", size="64x64")
        write(self.path("lit.gltf"), lit_triangle())
        fine = ["cornell-box", "--ambient", "1", "--shading-rate", "0.125"]  # dicing takes minutes before the first sample
        folded = ["lit.gltf", *VIEW, "--displacement", "skin=heights.png,30"]
        for scene, kind in [(fine, signal.SIGINT), (folded, signal.SIGTERM)]:
            self.check_nothing_is_kept(kind, "render", *scene, "-o", "x.exr", "--integrator", "reyes", "--size", "1920x1080",
                                       "--spp", "64", "--device", DEVICE)
            self.assertEqual(self.files(), ["heights.png", "lit.gltf"])

    def test_too_large_displacements_are_refused(self):
        self.render(output="heights.png", size="64x64")
        write(self.path("lit.gltf"), lit_triangle())
        flags = ["render", "lit.gltf", *VIEW, "-o", "x.exr", "--integrator", "reyes", "--size", "32x24", "--spp", "1", "--device",
                 DEVICE]
        self.refuse(3, *flags, "--displacement", "skin=heights.png,1000", says=["--displacement"], timeout=120)
        self.succeed(*flags, "--displacement", "skin=heights.png,0.2")

    def test_each_layer_changes_the_hash_of_layers(self):
        flags = ["--aov", "depth,albedo", "--lpe", "seen=LE", "--lpe", "others=L.+E"]
        one = self.render(*flags, output="x.exr")
        self.assertRegex(one["layers_hash"], "^[0-9a-f]{32}$")
        self.assertEqual(self.render(*flags, "--threads", "1", output="x.exr")["layers_hash"], one["layers_hash"])
        others = [flags[2:], flags[:-2], [*flags[:-1], "others=L..+E"], [*flags[:-1], "rest=L.+E"]]
        hashes = {self.render(*other, output="x.exr")["layers_hash"] for other in others}
        self.assertEqual(len(hashes | {one["layers_hash"]}), len(others) + 1)
        bare = self.render(output="x.exr")
        self.assertEqual((bare["layers_hash"], bare["hash"]), (None, one["hash"]))

    def test_the_shading_rate_and_interpolation_change_the_hash(self):
        write(self.path("lit.gltf"), lit_triangle())
        hashes = [self.render(*VIEW, "--ambient", "0", "--integrator", *flags, scene="lit.gltf")["hash"]
                  for flags in [["raster"], ["raster", "--shading", "flat"], ["raster", "--shading", "gouraud"], ["reyes"],
                                ["reyes", "--shading-rate", "3"]]]
        self.assertEqual(len(set(hashes)), len(hashes))


if __name__ == "__main__":
    main()
