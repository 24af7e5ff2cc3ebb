#!/usr/bin/env python3
"""`pertev bench` and its verbs: nothing is measured before the whole command line is checked, and Ctrl-C ends each."""

import csv
import json
import os
import re
import signal
import subprocess
import tempfile
import time

from cli_lab_run import rows_of
from cli_run import FLOOR, PROGRAM, CliTest, main, write

SMALL = ["--device", "cpu", "--size", "16x16", "--spp", "1"]


class Bench(CliTest):
    def test_bench_reports_the_rates_of_each_scene(self):
        made = self.succeed("bench", *SMALL, "--scene", "cornell-box", "--json").events("bench")
        self.assertEqual([(of["scene"], of["triangles"]) for of in made], [("cornell-box", 38)])
        for key in ["samples_per_second", "camera_rays_per_second", "bounce_rays_per_second"]:
            self.assertGreater(made[0][key], 0, key)
        text = self.succeed("bench", *SMALL, "--scene", "cornell-box", "--scene", "cornell-box").stdout
        self.assertRegex(text, r"(?s)^scene +device .*\ncornell-box .*\ncornell-box .*\n$")

    def test_a_job_has_the_hash_of_render_and_has_ratios_only_on_the_reference_gpu(self):
        line = ["--scene", "cornell-box", *SMALL]
        tent, view = ["--filter", "tent", "--filter-radius", "1"], ["--eye=0,1.6,29.5", "--target=0,1.5,0", "--fov", "60"]
        for job, depth, flags in [("cornell-box-65", 64, tent), ("cornell-box-8", 7, tent), ("corridor", 1, ["--filter", "box", *view])]:
            made = self.succeed("bench", "render", "--job", job, *line, "--json").events("job")[0]
            self.assertEqual((made["job"], made["width"], made["samples"], made["triangles"]), (job, 16, 1, 38))
            self.assertEqual([made["ratio_to_" + other] for other in ("mitsuba", "cycles", "pbrt")], [None] * 3)
            alike = self.succeed("render", "cornell-box", "-o", "x.exr", "--device", "cpu", "--size", "16x16", "--spp", "1",
                                 *flags, "--max-depth", depth, "--json").events("done")
            self.assertEqual(made["hash"], alike[0]["hash"])
        text = self.succeed("bench", "render", *line).stdout
        self.assertRegex(text, r"(?s)^job +S8\ndevice +CPU\n.*samples per second .*\n"
                               r"no ratios to others: .* NVIDIA H200, 1920x1080, 256 spp, 262204 triangles [^\n]*\n$")
        self.assertEqual([made[key] for key in ("moved_samples_per_second", "ratio_to_isolated_rays")], [None] * 2)
        held = self.succeed("bench", "render", *line, "--isolated", "--json").events("job")[0]
        self.assertGreater(held["ratio_to_isolated_rays"], 0)
        moved = self.succeed("bench", "render", *line, "--moves", "3", "--json").events("job")[0]
        self.assertGreater(moved["moved_samples_per_second"], 0)
        self.assertRegex(self.succeed("bench", "render", *line, "--moves", "3").stdout, r"\nsamples per second after a move +\d")
        self.refuse(2, "bench", "render", "--job", "S6", *line, says=["--job", "S5", "cornell-box-8"])
        self.refuse(2, "bench", "render", "--size", "", "--scene", "cornell-box", says=["--size"])

    def test_builds_have_ratios_only_on_the_reference_gpu(self):
        line = ["bench", "build", "--scene", "cornell-box", "--device", "cpu", "--runs", "1"]
        made = self.succeed(*line, "--compare", "--json").events("build")
        trees = ["sbvh", "sbvh-reinsertion", "reinsertion", "binned", "ploc", "hploc"]
        self.assertEqual([of["tree"] for of in made], trees)
        for of in made:
            self.assertIsNone(of["ratio_to_optix_fast_trace"])
            self.assertIsNone(of["ratio_to_optix_fast_build"])
        self.assertRegex(self.succeed(*line).stdout, r"(?m)^cornell-box +hploc .* - +- +-$")
        refits = self.succeed(*line, "--json").events("refit")
        self.assertEqual([(of["scene"], of["tree"]) for of in refits], [("cornell-box", "hploc")])
        self.assertGreater(refits[0]["median_seconds"], 0)
        self.assertRegex(self.succeed(*line).stdout, r"(?m)^cornell-box +hploc +38 ")

    def test_reports_hold_device_command_and_rows_and_are_joined_to_a_page(self):
        line = ["bench", "rays", "--scene", "cornell-box", "--device", "cpu", "--count", "500", "--runs", "1"]
        said = self.succeed(*line, "--report", "rays.json", "--json").events("rays")
        with open(self.path("rays.json"), encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual((report["format"], report["version"], report["device"]), ("pertev-measurement", 1, None))
        self.assertIn("bench rays --scene cornell-box", report["command"])
        self.assertEqual([{"event": "rays", **row} for row in rows_of(report, "rays")], said)
        self.succeed("bench", "noise", "cornell-box", *SMALL, "--seeds", "2", "--report", "noise.json")
        self.succeed(*line, "--report", "rays.csv")
        with open(self.path("rays.csv"), encoding="utf-8") as file:
            self.assertEqual([row["set"] for row in csv.DictReader(file)], [row["set"] for row in said])
        self.succeed("bench", "page", "rays.json", "noise.json", "-o", "page.html")
        with open(self.path("page.html"), encoding="utf-8") as file:
            found = re.findall(r'class="measurement">(.*?)</script>', file.read())
        self.assertEqual(json.loads(found[0]), report)
        self.assertEqual(json.loads(found[1])["title"], "Variance of a picture")
        write(self.path("other.json"), '{"format": "x"}')
        self.refuse(2, "bench", "page", "other.json", "-o", "x.html", says=["other.json", "pertev-measurement"])
        self.refuse(2, *line, "--report", "rays.txt", says=["rays.txt", ".json"])
        self.refuse(6, *line, "--report", "nowhere/x.json", says=["nowhere/x.json"])

    def test_a_flag_before_a_verb_of_bench_ends_with_2_and_names_its_verb(self):
        for flag in ["--device cuda", "--scene nowhere.obj", "--size 8x8", "--spp 1", "--threads 1", "--json", "-q"]:
            for verb in [["rays", "--count", "100"], ["render"]]:
                with self.subTest(flag=flag, verb=verb[0]):
                    outcome = self.refuse(2, "bench", *flag.split(), *verb, "--scene", "cornell-box",
                                          says=[flag.split()[0].replace("-q", "--quiet"), f"`bench {verb[0]}`"])
                    self.assertEqual(len(outcome.stdout.splitlines()), flag == "--json")
        self.refuse(2, "bench", "rays", "render", "--scene", "cornell-box", says=["render"])

    def test_errors_of_the_command_line_come_before_anything_is_measured_or_printed(self):
        rays = ["bench", "rays", "--count", "100", "--device", "cpu"]
        lines = [(["bench", "--scene", "cornell-box", "--size", "0x0"], "--size 0x0"),
                 (["bench", "--scene", "cornell-box", "--scene", "nowhere.obj"], "nowhere.obj: the file does not exist"),
                 (["bench", "--scene", "cornell-box", "--scene", "spnza"], "spnza: neither"),
                 (["bench", "render", "--scene", "nowhere.obj", "-o", "x.exr"], "nowhere.obj: the file does not exist"),
                 (["bench", "render", "--scene", "cornell-box", "-o", "x.bmp"], "x.bmp"),
                 ([*rays, "--scene", "cornell-box", "--scene", "nowhere.obj"], "nowhere.obj: the file does not exist"),
                 ([*rays, "--scene", "cornell-box", "--scene", "spnza"], "sponza, bunny or forest"),
                 ([*rays, "--scene", "cornell-box", "--scene", "sponza"], "PERTEV_SCENES")]
        environment = dict(self.environment, PERTEV_SCENES=self.folder)
        for line, says in lines:
            with self.subTest(line=line):
                self.assertEqual(self.refuse(2, *line, says=[says], env=environment).stdout, "")
        write(self.path("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        for verb in [["bench"], rays]:  # only its content shows the fault
            self.assertEqual(self.refuse(2, *verb, "--scene", "flat.obj", says=["flat.obj"]).stdout, "")

    def test_an_interrupt_ends_every_benchmark_with_75_and_leaves_no_files(self):
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
                    time.sleep(0.5)  # the program is measuring
                    start = time.monotonic()
                    program.send_signal(kind)
                    stdout, stderr = program.communicate(timeout=300)
                    self.assertEqual(program.returncode, 75, stderr)
                    self.assertLess(time.monotonic() - start, 60)
                    self.assertRegex(stderr.decode(), r"pertev: interrupted( before .*)?\n$")  # the latter arrives while the program loads
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

    def test_noise_reports_the_variance_of_both_samplers_over_the_same_pixels(self):
        line = ["bench", "noise", "cornell-box", "--device", "cpu", "--size", "32x32"]
        small = [*line, "--spp", "4", "--seeds", "3"]
        made = self.succeed(*small, "--json").events("noise")
        self.assertEqual(len(made), 1)
        all_pixels = made[0]
        for key, value in {"scene": "cornell-box", "device": "CPU", "width": 32, "height": 32, "samples": 4, "seeds": 3,
                           "keep_percent": 100, "pixels": 1024, "invalid_samples": 0}.items():
            self.assertEqual(all_pixels[key], value, key)
        for key in ["rel_mse", "rel_mse_independent", "mean", "mean_independent", "efficiency", "efficiency_independent"]:
            self.assertGreater(all_pixels[key], 0, key)
        self.assertAlmostEqual(all_pixels["ratio"], all_pixels["rel_mse_independent"] / all_pixels["rel_mse"], 4)
        self.assertLess(all_pixels["rel_mse"], 1)
        text = self.succeed(*small).stdout
        self.assertRegex(text, rf"(?m)^relMSE +{all_pixels['rel_mse']:.3e}$")
        self.assertRegex(text, rf"(?m)^relMSE of independent samples +{all_pixels['rel_mse_independent']:.3e}$")
        self.assertRegex(text, r"(?m)^of the pixels +100 %$")

        half = self.succeed(*small, "--keep", "50", "--json").events("noise")[0]
        self.assertEqual(half["pixels"], 512)
        self.assertLess(half["rel_mse"], all_pixels["rel_mse"] / 4)
        # The pixels are not the best half of that sampler, which would vary as little: the two choices differ.
        self.assertGreater(half["ratio"], 2 * all_pixels["ratio"])

        # The integrand is smooth, and the number of samples fills whole strata.
        fine = self.succeed(*line, "--integrator", "direct", "--spp", "64", "--seeds", "4", "--json").events("noise")[0]
        self.assertGreater(fine["ratio"], 1.5)
        self.assertLess(abs(fine["mean"] / fine["mean_independent"] - 1), 0.05)

    def test_frames_are_deterministic_and_follow_their_flags(self):
        line = ["bench", "frames", "cornell-box", "--device", "cpu", "--size", "48x36", "--frames", "6"]
        made = [self.succeed(*line, "--json").events("frames")[0] for _ in range(2)]
        self.assertEqual(made[0]["picture"], made[1]["picture"])
        self.assertGreater(made[0]["median_seconds"], made[0]["reconstruction_seconds"] + made[0]["copy_seconds"])
        still = self.succeed(*line, "--still", "--json").events("frames")[0]
        self.assertNotEqual(still["picture"], made[0]["picture"])
        shared = [self.succeed(*line, "--restir", name, "--json").events("frames")[0] for name in ("di", "gi")]
        self.assertEqual([event["reconstruction"]["restir"] for event in [made[0], *shared]], ["off", "di", "gi"])
        self.assertEqual(len({event["picture"] for event in [made[0], *shared]}), 3)
        coarse = self.succeed(*line, "--resolution-scale", "0.5", "--passes", "2", "--no-anti-alias", "--json").events("frames")[0]
        self.assertEqual({name: value for name, value in coarse["reconstruction"].items() if made[0]["reconstruction"][name] != value},
                         {"resolution_scale": 0.5, "passes": 2, "no_anti_alias": True})
        self.refuse(2, *line, "--restir", "all", says=["--restir", "off", "di", "gi"])
        self.refuse(2, *line, "--spp", "4", says=["--spp"])

    def test_batches_of_cameras_have_rates_beside_one_large_picture(self):
        line = ["bench", "cameras", "cornell-box", "--device", "cpu", "--size", "8x8", "--spp", "2", "--pictures", "33", "--runs", "1"]
        run = self.succeed(*line, "--json")
        jobs = {event["job"]: event for event in run.events("cameras")}
        self.assertEqual([(name, job["pictures"], job["samples"], job["max_depth"]) for name, job in jobs.items()],
                         [("centres", 33, 0, 5), ("direct", 33, 1, 1), ("paths", 2, 2, 5)])
        rays = {}  # per pixel
        for name, job in jobs.items():
            self.assertAlmostEqual(job["pictures_per_second"] * job["median_seconds"] / job["pictures"], 1, delta=1e-3)
            rays[name] = job["rays_per_second"] / job["pictures_per_second"] / 64
        self.assertAlmostEqual(rays["centres"], 1, 3)
        self.assertTrue(1 < rays["direct"] <= 2.001, rays)  # one serves sample and layers, and a shadow ray follows it
        self.assertGreater(rays["paths"], 2.999)
        self.assertIsNone(jobs["centres"]["in_turn_pictures_per_second"])
        large = run.events("large_picture")[0]
        self.assertAlmostEqual(large["ratio_of_batch"], jobs["paths"]["samples_per_second"] / large["samples_per_second"], delta=1e-3)

    def test_a_sequence_is_compared_with_its_samples_as_they_are_and_denoised(self):
        line = ["bench", "sequence", "cornell-box", "--device", "cpu", "--size", "32x24", "--turntable", "90", "--frames", "0-2"]
        made = self.succeed(*line, "--reference", "32", "--denoise", "svgf", "--json").events("sequence_errors")[0]
        for way in ("ours", "denoised"):
            self.assertLess(made[way]["hdr_flip"], made["sample"]["hdr_flip"])
            self.assertLess(made[way]["flicker"], made["sample"]["flicker"])
        self.assertGreater(made["reference_noise"], 0)
        self.assertEqual(made["denoiser"], "svgf")
        alone = self.succeed(*line, "--reference", "32", "--json").events("sequence_errors")[0]
        self.assertEqual((alone["denoised"], alone["ours"], alone["sample"]), (None, made["ours"], made["sample"]))
        plain, shared, coarse = (self.succeed(*line, *flags, "--json").events("sequence_errors")[0]["last_frame"]
                                 for flags in [[], ["--restir", "gi"], ["--resolution-scale", "0.5"]])
        self.assertEqual(len({plain, shared, coarse}), 3)
        self.refuse(2, *line, "--denoise", "svgf", says=["--reference"])
        self.refuse(2, "bench", "sequence", "cornell-box", says=["--frames"])

    def test_noise_refuses_invalid_values_before_it_reads_the_scene(self):
        for flags, says in [("--seeds 1", "--seeds"), ("--seeds 1025", "--seeds"), ("--keep 0", "--keep"),
                            ("--keep 101", "--keep"), ("--size 0x0", "--size 0x0"), ("--spp 0", "--spp")]:
            for json_flag in [[], ["--json"]]:
                with self.subTest(flags=flags, json=json_flag):
                    self.refuse(2, "bench", "noise", "nowhere.obj", "--device", "cpu", *flags.split(), *json_flag,
                                says=[says])
        self.assertNotEqual(self.run_pertev("bench", "noise", "nowhere.obj").status, 0)

    def test_an_interrupt_ends_noise_with_75_and_an_object(self):
        program = subprocess.Popen([PROGRAM, "bench", "noise", "cornell-box", "--device", "cpu", "--json", "--size",
                                    "512x512", "--spp", "100000"], cwd=self.folder, env=self.environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        self.wait_while(program, is_listening=False)
        time.sleep(0.5)  # the program is measuring
        program.send_signal(signal.SIGINT)
        stdout, stderr = program.communicate(timeout=300)
        self.assertEqual((program.returncode, stderr), (75, b""))
        last = json.loads(stdout.splitlines()[-1])
        self.assertEqual((last["event"], last["status"], last["interrupted"]), ("error", 75, True))

    def test_the_seed_of_a_job_changes_its_hash_but_hardly_its_mean(self):
        # Five sides of a hall around the job's camera at (-110, 18, -2), which looks along +x. The roof is open.
        corners = [f"v {x} {y} {z}\n" for x in (-120, 70) for y in (-2, 60) for z in (-20, 20)]
        sides = ["1 2 4 3", "1 5 6 2", "1 3 7 5", "2 6 8 4", "5 7 8 6"]
        write(self.path("hall.obj"), "".join(corners) + "".join(f"f {side}\n" for side in sides))
        job = ["bench", "render", "--job", "S5", "--scene", "hall.obj", "--size", "16x16", "--spp", "16", "--device", "cpu",
               "--json"]
        plain, zero, one, again = (self.succeed(*job, *seed).events("job")[0]
                                   for seed in [[], ["--seed", "0"], ["--seed", "1"], ["--seed", "1"]])
        self.assertEqual(plain["hash"], zero["hash"])
        self.assertNotEqual(zero["hash"], one["hash"])
        self.assertEqual(one["hash"], again["hash"])
        self.assertLess(abs(one["mean"] / zero["mean"] - 1), 0.1)
        self.assertLess(one["mean"], 0.9)  # the camera shows the hall
        for seed in ["-1", "4294967296", "x"]:
            self.refuse(2, *job, "--seed", seed, says=["--seed"])


if __name__ == "__main__":
    main()
