#!/usr/bin/env python3
"""Several devices by the command line: a picture, its parts and its checkpoint have the bytes of one device's, what only
one device does is refused by name, and `bench devices` measures. Two CPUs stand for devices."""

import json
import signal
import subprocess

from cli_frames_test import moving_gltf
from cli_lab_run import rows_of
from cli_run import PATIENCE_S, PROGRAM, UNMETERED, CliTest, main, write

SIZE = ["--size", "24x18"]
TWO, THREE, ONE = ["--device", "cpu,cpu"], ["--device", "cpu,cpu,cpu"], ["--device", "cpu"]


class Devices(CliTest):
    def done(self, *flags, output="x.exr"):
        shows = UNMETERED if output.endswith(".pvf") or "--checkpoint" in flags else []
        return self.succeed("render", "cornell-box", "-o", output, *SIZE, *shows, *flags, "--json").events("done")[0]

    def test_devices_together_make_the_picture_of_one(self):
        for flags in [["--spp", "9"], ["--spp", "300", "--aov", "albedo,normal,depth,ids"], ["--spp", "4", "--integrator", "photon_map"],
                      ["--spp", "7", "--integrator", "bidirectional"], ["--spp", "5", "--aov", "albedo,ids", "--layers-at", "centre"]]:
            with self.subTest(flags=flags):
                alone = self.done(*flags, *ONE)
                for devices in [TWO, THREE]:
                    together = self.done(*flags, *devices)
                    self.assertEqual([together[key] for key in ("hash", "layers_hash", "samples", "invalid_samples")],
                                     [alone[key] for key in ("hash", "layers_hash", "samples", "invalid_samples")])
                    self.assertEqual(together["device"], f"{devices[1].count('cpu')} x CPU")

    def test_a_file_names_all_devices(self):
        self.done("--spp", "2", *TWO)
        self.assertEqual(self.info("x.exr")["pertev.device"], "2 x CPU")

    def test_parts_by_several_devices_are_merged_to_the_picture_of_one(self):
        whole = self.done("--spp", "30", *ONE)
        for part, devices in zip("123", [TWO, ONE, THREE], strict=True):
            self.done("--spp", "30", "--part", f"{part}/3", *devices, output=f"{part}.pvf")
        self.assertEqual(self.succeed("merge", "2.pvf", "1.pvf", "3.pvf", "-o", "m.exr", "--json").events("done")[0]["hash"], whole["hash"])
        self.done("--spp", "30", "--rows", "0:7", *TWO, output="a.pvf")
        self.done("--spp", "30", "--rows", "7:18", *THREE, output="b.pvf")
        self.assertEqual(self.succeed("merge", "a.pvf", "b.pvf", "-o", "m.exr", "--json").events("done")[0]["hash"], whole["hash"])
        self.done("--samples", "0:11", *TWO, output="a.pvf")
        self.done("--samples", "11:30", *TWO, output="b.pvf")
        self.assertEqual(self.succeed("merge", "a.pvf", "b.pvf", "-o", "m.exr", "--json").events("done")[0]["hash"], whole["hash"])

    def test_a_checkpoint_goes_on_with_other_devices(self):
        keeps = ["--checkpoint", "c.pvf"]
        self.done("--spp", "6", *TWO, *keeps)
        self.done("--spp", "9", *ONE, *keeps)
        self.assertEqual(self.done("--spp", "20", *THREE, *keeps)["hash"], self.done("--spp", "20", *ONE)["hash"])

    def test_a_time_limit_and_ctrl_c_end_at_whole_samples(self):
        endless = ["--spp", "8000000"]
        limited = self.done(*endless, "--time-limit", "0.5", *TWO)
        self.assertGreater(limited["samples"], 2)
        self.assertEqual(limited["hash"], self.done("--spp", str(limited["samples"]), *ONE)["hash"])
        program = subprocess.Popen([PROGRAM, "render", "cornell-box", "-o", "y.exr", *SIZE, *endless, *TWO, "--json"], cwd=self.folder,
                                   env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        self.addCleanup(program.kill)
        self.addCleanup(program.stdout.close)
        for line in program.stdout:
            event = json.loads(line)
            if event["event"] == "progress" and event.get("samples"):
                program.send_signal(signal.SIGINT)
                break
        done = [json.loads(line) for line in program.communicate(timeout=PATIENCE_S)[0].decode().splitlines()][-1]
        self.assertEqual((program.returncode, done["event"], done["interrupted"]), (75, "done", True))
        self.assertEqual(done["hash"], self.done("--spp", str(done["samples"]), *ONE)["hash"])

    def test_frames_of_a_moving_scene_and_pictures_of_many_cameras_have_the_bytes_of_one_device(self):
        write(self.path("moving.gltf"), moving_gltf())
        views = [{"eye": [0.3, 0.35, -0.8], "target": [0.3, 0.35, 0.2], "fov": 40 + k, "size": f"{16 + 4 * k}x12"} for k in range(2)]
        write(self.path("views.json"), json.dumps({"cameras": views}))
        for scene, flags, count in [("moving.gltf", ["--frames", "0-3", "--fps", "2", "--spp", "5",], 4),
                                    ("cornell-box", ["--turntable", "3", "--spp", "5"], 2),
                                    ("cornell-box", ["--cameras", "views.json", "--spp", "5"], 2)]:
            with self.subTest(scene=scene, flags=flags):
                line = ["render", scene, "-o", "f-####.exr", *(SIZE if "--cameras" not in flags else []), *flags, "--json"]
                alone, together = [[event["hash"] for event in self.succeed(*line, *devices).events("frame")] for devices in (ONE, THREE)]
                self.assertEqual(together, alone)
                self.assertEqual(len(set(together)), count)

    def test_frames_in_real_time_have_the_bytes_of_one_device(self):
        write(self.path("moving.gltf"), moving_gltf())
        for flags in [["moving.gltf", "--fps", "2"], ["cornell-box", "--turntable", "9", "--restir", "gi", "--aov", "depth"],
                      ["cornell-box", "--turntable", "9", "--resolution-scale", "0.5"]]:
            with self.subTest(flags=flags):
                line = ["render", *flags, "--frames", "0-3", "--real-time", "-o", "f-####.exr", "--size", "40x36", "--json"]
                alone, together = [[event["hash"] for event in self.succeed(*line, *devices).events("frame")] for devices in (ONE, THREE)]
                self.assertEqual(together, alone)
                self.assertGreater(len(set(together)), 2)
        line = ["bench", "sequence", "cornell-box", "--frames", "0-2", "--size", "40x36", "--json"]
        alone, together = [self.succeed(*line, *devices).events("sequence_errors")[0] for devices in (ONE, TWO)]
        self.assertEqual((together["last_frame"], together["device"]), (alone["last_frame"], "2 x CPU"))
        line = ["bench", "frames", "cornell-box", "--frames", "3", "--size", "40x36", "--restir", "di", "--json"]
        alone, together = [self.succeed(*line, *devices).events("frames")[0] for devices in (ONE, TWO)]
        self.assertEqual((together["picture"], together["device"]), (alone["picture"], "2 x CPU"))

    def test_the_viewer_starts_with_several_devices(self):
        program = subprocess.Popen([PROGRAM, "view", "cornell-box", *SIZE, "--port", "0", "--no-browser", *TWO, "--json"], cwd=self.folder,
                                   env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        self.addCleanup(program.kill)
        self.addCleanup(program.stdout.close)
        self.assertTrue(any(json.loads(line)["event"] == "listening" for line in program.stdout))
        program.send_signal(signal.SIGINT)
        self.assertEqual(program.wait(timeout=PATIENCE_S), 0)

    def test_what_one_device_does_alone_is_refused_by_name(self):
        for line in [["measure", "cornell-box", "--at", "0,0,0", "--normal", "0,1,0"], ["lab", "cornell-box", "-o", "report"], ["bench", "--scene", "cornell-box"],
                     ["bench", "render", "--scene", "cornell-box"], ["bench", "noise", "cornell-box"], ["bench", "rays", "--scene", "cornell-box"],
                     ["bench", "frames", "cornell-box", "--integrator", "photon_map"]]:
            with self.subTest(line=line):
                self.refuse(2, *line, *TWO, says=["--device cpu,cpu"])

    def test_names_that_are_no_devices_are_refused(self):
        for name in ["cpu,gpu", "cuda:0,x", "cpu,", "cuda:all", "cuda:0,1", "GPU-8c4d7a52", "auto,cpu", "cpu,1"]:
            with self.subTest(name=name):
                self.refuse(2, "render", "cornell-box", "-o", "x.png", "--device", name, says=[f"--device {name}: "])

    def test_bench_devices_compares_each_number_of_devices_with_one(self):
        line = ["bench", "devices", "--scene", "cornell-box", "--job", "cornell-box-8", "--size", "16x16", "--runs", "2", "--pictures", "3", "--frames", "3"]
        outcome = self.succeed(*line, *THREE, "--spp", "300", "--report", "devices.json", "--json")
        made = outcome.events("devices")
        self.assertEqual([(row["samples"], row["devices"]) for row in made], [(spp, n) for spp in (300, 256) for n in (1, 2, 3)])
        for row in made:
            one = next(other for other in made if (other["samples"], other["devices"]) == (row["samples"], 1))
            self.assertEqual((row["hash"], row["runs"], row["width"]), (one["hash"], 2, 16))
            self.assertAlmostEqual(row["ratio_to_one"], one["median_seconds"] / row["median_seconds"], 4)
            self.assertAlmostEqual(row["share_of_ideal"] * row["devices"], row["ratio_to_one"], 4)
            self.assertEqual(row["sum_seconds"] == 0, row["devices"] == 1)
        expected = outcome.events("devices_expected")
        self.assertEqual([(row["samples"], row["devices"]) for row in expected], [(spp, n) for spp in (300, 256) for n in (4, 8)])
        for row in expected:
            one, three = [next(r for r in made if (r["samples"], r["devices"]) == (row["samples"], n)) for n in (1, 3)]
            n, loss = row["devices"], (three["median_seconds"] - three["sum_seconds"]) * 3
            self.assertAlmostEqual(row["expected_seconds"], loss / n + three["sum_seconds"] * n / 3, 6)
            self.assertAlmostEqual(row["ratio_to_one"], one["median_seconds"] / row["expected_seconds"], 3)
        with open(self.path("devices.json"), encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual([{"event": "devices", **row} for row in rows_of(report, "devices")], made)
        alike = self.succeed("bench", "render", "--scene", "cornell-box", "--job", "cornell-box-8", "--size", "16x16", "--spp", "300", *ONE,
                             "--json").events("job")[0]
        self.assertEqual(made[0]["hash"], alike["hash"])
        batches = outcome.events("devices_cameras")
        self.assertEqual([(row["devices"], row["pictures"], row["width"], row["hash"]) for row in batches],
                         [(n, 3, 128, batches[0]["hash"]) for n in (1, 2, 3)])
        for row in batches:
            self.assertAlmostEqual(row["ratio_to_one"], batches[0]["median_seconds"] / row["median_seconds"], 4)
        frames = outcome.events("devices_frames")
        self.assertEqual([(row["devices"], row["runs"], row["hash"]) for row in frames], [(n, 3, frames[0]["hash"]) for n in (1, 2, 3)])
        for row in frames:
            self.assertAlmostEqual(row["ratio_to_one"], frames[0]["median_seconds"] / row["median_seconds"], 4)
            self.assertLess(row["reconstruction_seconds"], row["greatest_seconds"])
        line[-6:] = ["--runs", "1", "--pictures", "1", "--frames", "1"]
        some = self.succeed(*line, *THREE, "--spp", "2", "--numbers", "3", "--json")
        for event in ("devices", "devices_cameras", "devices_frames"):
            self.assertEqual([row["devices"] for row in some.events(event)], [1, 3])
        self.assertGreater(some.events("devices")[0]["peak_bytes"], 1 << 20)
        self.refuse(2, *line, *TWO, "--numbers", "1,3", says=["--numbers 3"])
        single = self.succeed(*line, *ONE, "--spp", "2", "--json")
        self.assertEqual((len(single.events("devices")), single.events("devices_expected")), (1, []))
        self.assertRegex(self.succeed(*line, *TWO, "--spp", "2").stdout, r"(?s)^job +devices .*\ncornell-box-8 +1 .*\ncornell-box-8 +2 ")
        self.refuse(2, *line, *TWO, "--runs", "0", says=["--runs"])
        self.refuse(2, "bench", "devices", *TWO, "--scene", "nowhere.obj", says=["nowhere.obj"])


if __name__ == "__main__":
    main()
