#!/usr/bin/env python3
"""`render --checkpoint`: however a render ends, the next one resumes it, and the picture is that of one run."""

import json
import os
import random
import resource
import signal
import subprocess
import sys
import threading
import unittest

from cli_run import PATIENCE_S, PROGRAM, SANITIZED, UNMETERED, CliTest, main, write

KILLS = 1000 if os.environ.get("PERTEV_LONG_TESTS") else 20
PAIRS = ["--size", "20x16", "--device", "cpu", *UNMETERED]
SMALL = [*PAIRS, "--json"]
FILE = ["--checkpoint", "c.pvf"]
ALWAYS = [*FILE, "--checkpoint-every", "1e-9"]  # after each pass


def with_default(flags, defaults):
    """Returns the flags and those defaults, in pairs, that they do not set."""
    return [*flags, *(text for flag, value in zip(defaults[::2], defaults[1::2], strict=True) if flag not in flags for text in (flag, value))]


class Checkpoints(CliTest):
    def whole(self, *flags):
        """Returns the event of a render without a checkpoint. The film file makes it meter the exposure."""
        return self.succeed("render", "cornell-box", "-o", "whole.exr", "-o", "whole.pvf", *SMALL, *flags).events("done")[0]

    def go_on(self, *flags, output="x.exr"):
        """Renders with the checkpoint, which succeeds, and returns the events."""
        return self.succeed("render", "cornell-box", "-o", output, *SMALL, *(FILE if "--checkpoint" not in flags else []), *flags).events()

    def done(self, *flags, **options):
        return next(event for event in self.go_on(*flags, **options) if event["event"] == "done")

    def start(self, *flags):
        program = subprocess.Popen([PROGRAM, "render", "cornell-box", "-o", "x.exr", *SMALL, *with_default(flags, ALWAYS)], cwd=self.folder,
                                   env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        self.addCleanup(program.kill)
        self.addCleanup(program.stdout.close)
        return program

    def samples(self, name="c.pvf"):
        """Returns the number of samples in an existing, complete film file."""
        self.succeed("merge", name, "--partial", "-o", "preview.exr")
        return int(self.info(name)["samples"].split(":")[1])

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def flip(self, name, at=-60):
        data = bytearray(self.read(name))
        data[at] ^= 4
        with open(self.path(name), "wb") as file:
            file.write(data)

    def metadata(self, name):
        return {key: value for key, value in self.info(name).items() if key != "file" and not key.endswith("_seconds")}

    def test_a_render_that_is_killed_at_any_moment_loses_one_interval_at_most(self):
        self.whole("--spp", "1")  # fills the cache
        kept, spp, moments = 0, 8000000, random.Random(1)
        for kill in range(KILLS):
            program = self.start("--spp", str(spp))
            threading.Timer(moments.uniform(0, 0.3 if not SANITIZED else 6), program.kill).start()
            events = [json.loads(line) for line in program.communicate(timeout=PATIENCE_S)[0].decode().splitlines(keepends=True)
                      if line.endswith("\n")]
            self.assertEqual(program.returncode, -signal.SIGKILL)
            passes = sorted({event["samples"] for event in events if event["event"] == "progress" and event.get("samples")})
            # The checkpoint of a pass is written before the next one begins.
            least = max([kept, *passes[:-1]])
            if os.path.exists(self.path("c.pvf")):
                with self.subTest(kill=kill):
                    samples = self.samples()
                    self.assertGreaterEqual(samples, least)
                    kept = samples
            else:
                self.assertEqual(least, 0)
        self.assertGreater(kept, 0)
        left = [name for name in self.files() if name.startswith(".")]
        self.assertLessEqual(len(left), 1)  # the last one was killed between two names
        write(self.path(".c.pvf.4194305.0"), "no process has this number")
        write(self.path(f".c.pvf.{os.getpid()}.0"), "this one lives")
        events = self.go_on("--spp", kept + 7)
        self.assertIn(f"resumes from {kept} of {kept + 7} samples in c.pvf", [event.get("text") for event in events])
        self.assertEqual([name for name in self.files() if name.startswith(".")], [f".c.pvf.{os.getpid()}.0"])
        self.assertEqual(events[-1]["samples"], kept + 7)
        self.assertEqual(events[-1]["hash"], self.whole("--spp", kept + 7)["hash"])
        self.assertEqual(self.metadata("x.exr"), self.metadata("whole.exr"))

    def test_a_signal_writes_the_checkpoint_and_ends_with_75(self):
        for kind in [signal.SIGTERM, signal.SIGINT]:
            program = self.start("--spp", "1000000", "--checkpoint-every", "1000")
            for line in program.stdout:
                if json.loads(line)["event"] == "progress" and json.loads(line)["samples"] > 0:
                    break
            self.assertNotIn("c.pvf", self.files())
            program.send_signal(kind)
            done = json.loads(program.communicate(timeout=PATIENCE_S)[0].splitlines()[-1])
            self.assertEqual((program.returncode, done["event"], done["interrupted"]), (75, "done", True))
            self.assertEqual(self.samples(), done["samples"])
            spp = done["samples"] + 3
            self.assertEqual(self.done("--spp", spp)["hash"], self.whole("--spp", spp)["hash"])
            for name in ("c.pvf", "c.pvf.previous"):
                os.remove(self.path(name))

    def test_a_finished_render_keeps_its_samples_and_more_are_added(self):
        events = self.go_on("--spp", "4")
        self.assertIn("c.pvf keeps the samples; a larger --spp adds to them", [event.get("text") for event in events])
        self.assertEqual([event["path"] for event in events if event["event"] == "output"], ["x.exr", "c.pvf"])
        self.assertEqual(self.files(), ["c.pvf", "x.exr"])
        before = self.read("c.pvf")
        again = self.done("--spp", "4", output="again.png")
        self.assertEqual((again["samples"], again["hash"]), (4, events[-1]["hash"]))
        self.assertEqual(self.read("c.pvf"), before)
        self.assertEqual(self.done("--spp", "9")["hash"], self.whole("--spp", "9")["hash"])
        self.assertEqual(self.read("c.pvf.previous"), before)
        self.refuse(2, "render", "cornell-box", "-o", "y.exr", *SMALL, *FILE, "--spp", "5", says=["c.pvf", "up to 9", "--spp"])

    def test_every_integrator_and_all_layers_support_a_checkpoint(self):
        kinds = [[kind] for kind in ["direct", "indirect", "hybrid", "distributed", "light", "bidirectional", "photon_map",
                                     "irradiance_cache"]]
        kinds += [["radiosity", "--patch-size", "0.3", "--patch-rays", "16", "--subdivisions", "0"]]
        kinds += [[kind, "--ambient", "0.5"] for kind in ["cast", "whitted", "raster", "reyes"]]
        kinds += [["path", "--aov", "albedo,normal,ids", "--lpe", "diffuse=LD+E", "--transparent"],
                  ["path", "--aov", "normal,ids", "--layers-at", "centre"], ["path", "--denoise", "svgf"]]
        for kind in kinds:
            with self.subTest(kind=kind):
                flags = ["--integrator", *kind]
                self.done("--spp", "2", *flags)
                got, whole = self.done("--spp", "5", *flags), self.whole("--spp", "5", *flags)
                for key in ["hash", "layers_hash", "denoised_hash", "invalid_samples", "samples"]:
                    self.assertEqual(got[key], whole[key], key)
                got, whole = self.metadata("x.exr"), self.metadata("whole.exr")
                if kind[0] in ("irradiance_cache", "radiosity"):  # each run makes its records first, and their rays count
                    del got["pertev.rays"], whole["pertev.rays"]
                self.assertEqual(got, whole)
                os.remove(self.path("c.pvf"))

    def test_a_part_resumes_and_merges_and_a_checkpoint_is_a_film_file(self):
        part = ["--spp", "9", "--part", "2/3"]
        self.succeed("render", "cornell-box", "-o", "1.pvf", *SMALL, "--spp", "9", "--part", "1/3")
        self.succeed("render", "cornell-box", "-o", "2.pvf", *SMALL, *part, *FILE)
        self.assertEqual(self.info("c.pvf")["samples"], "3:6")
        self.refuse(2, "render", "cornell-box", "-o", "y.pvf", *SMALL, "--spp", "9", "--part", "3/3", *FILE,
                    says=["c.pvf", "begin with number 3, not 6", "--part"])
        self.succeed("render", "cornell-box", "-o", "3.pvf", *SMALL, "--samples", "3:9", *FILE)
        done = self.succeed("merge", "1.pvf", "3.pvf", "-o", "all.exr", "--json").events("done")[0]
        self.assertEqual(done["hash"], self.whole("--spp", "9")["hash"])
        self.assertEqual(self.succeed("merge", "1.pvf", "c.pvf", "-o", "all.exr", "--json").events("done")[0]["hash"], done["hash"])

    def test_denoised_rows_resume_beside_glass_that_the_part_cuts(self):
        room = self.path("room.obj")
        subprocess.run([sys.executable, os.path.join(os.path.dirname(__file__), "../../tools/make_glass_room.py"), room], check=True)
        view = [room, "--size", "48x36", "--device", "cpu", "--eye", "0,1.15,3.4", "--target", "0,0.85,-0.5", "--fov", "42", "--denoise", "svgf"]
        for samples in ("2", "4"):
            self.succeed("render", *view, "--rows", "0:21", "--spp", samples, "-o", "1.pvf", *FILE)
        self.succeed("render", *view, "--rows", "21:36", "--spp", "4", "-o", "2.pvf")
        whole = self.succeed("render", *view, "--spp", "4", "-o", "whole.exr", "--json").events("done")[0]
        merged = self.succeed("merge", "1.pvf", "2.pvf", "-o", "all.exr", "--json").events("done")[0]
        self.assertEqual((merged["hash"], merged["denoised_hash"]), (whole["hash"], whole["denoised_hash"]))

    def test_a_time_limit_applies_to_each_run(self):
        first = self.done("--spp", "8000000", "--time-limit", "0.2")["samples"]
        second = self.done("--spp", "8000000", "--time-limit", "0.2", "--checkpoint-every", "0.05")["samples"]
        self.assertGreater(second, first)
        self.assertEqual(self.samples(), second)
        self.assertEqual(self.done("--spp", second)["hash"], self.whole("--spp", second)["hash"])

    def test_a_damaged_checkpoint_is_detected_and_the_previous_generation_is_used(self):
        self.done("--spp", "3")
        whole = self.whole("--spp", "8")["hash"]
        for name, damage in [("flipped", lambda: self.flip("c.pvf")), ("header", lambda: self.flip("c.pvf", 40)),
                             ("torn", lambda: os.truncate(self.path("c.pvf"), os.path.getsize(self.path("c.pvf")) - 100)),
                             ("empty", lambda: os.truncate(self.path("c.pvf"), 0))]:
            with self.subTest(name):
                self.done("--spp", "5")
                earlier = self.read("c.pvf.previous")
                damage()
                events = self.go_on("--spp", "8")
                warnings = [event["text"] for event in events if event["event"] == "warning"]
                self.assertEqual(len(warnings), 1)
                self.assertIn("c.pvf.previous, is used", warnings[0])
                self.assertEqual((events[-1]["hash"], events[-1]["warnings"]), (whole, warnings))
                self.assertEqual(self.read("c.pvf.previous"), earlier)  # this is not the damaged one
                for kept in ("c.pvf", "c.pvf.previous"):
                    os.remove(self.path(kept))
                self.done("--spp", "3")
        self.done("--spp", "5")
        self.flip("c.pvf")
        self.flip("c.pvf.previous")
        self.refuse(2, "render", "cornell-box", "-o", "y.exr", *SMALL, *FILE, says=["c.pvf", "start again"])
        os.remove(self.path("c.pvf"))
        events = self.go_on("--spp", "5", "-q")
        self.assertEqual([event for event in events if event["event"] == "warning"], [])
        self.assertEqual(len(events[-1]["warnings"]), 1)
        self.assertIn("c.pvf.previous", events[-1]["warnings"][0])

    def test_a_checkpoint_of_another_picture_is_refused_with_the_difference(self):
        self.done("--spp", "2")
        for flags, name in [(["--max-depth", "3"], "--max-depth"), (["--seed", "7"], "--seed"), (["--size", "16x16"], "--size"),
                            (["--aov", "depth"], "--aov"), (["--exposure", "1"], "exposure")]:
            with self.subTest(flags=flags):
                self.refuse(2, "render", "cornell-box", "-o", "y.png", "--json", *FILE, *with_default(flags, PAIRS), says=["c.pvf", name, "there, not"])
        self.refuse(2, "render", "blind", "-o", "y.exr", *SMALL, *FILE, says=["c.pvf", "hash of the scene's file"])
        with open(self.path("text.pvf"), "w", encoding="ascii") as file:
            file.write("a text\n" * 9)
        self.refuse(2, "render", "cornell-box", "-o", "y.exr", *SMALL, "--checkpoint", "text.pvf", says=["text.pvf", "not a film file"])
        self.refuse(6, "render", "nowhere.obj", "-o", "y.exr", *SMALL, "--checkpoint", "nowhere/c.pvf", says=["nowhere/c.pvf"])

    def test_settings_that_a_checkpoint_does_not_support_are_refused(self):
        for flags in ["--aov motion", "--turntable 4", "--frames 0-3", "--checkpoint-every 0"]:
            with self.subTest(flags=flags):
                self.refuse(2, "render", "cornell-box", "-o", "y-#.exr", *SMALL, *FILE, *flags.split(),
                            says=["--continue" if "frames" in flags or "turn" in flags else flags.split()[0]])
        self.refuse(2, "render", "cornell-box", "-o", "y.exr", *SMALL, "--checkpoint-every", "9", says=["--checkpoint"])
        self.refuse(2, "render", "cornell-box", "-o", "./c.pvf", *SMALL, *FILE, says=["--checkpoint c.pvf"])

    def test_a_checkpoint_that_cannot_be_written_leaves_the_picture_and_ends_with_6(self):
        def limit_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        flags = ["--no-bvh-cache", "--spp", "40"]
        outcome = self.run_pertev("render", "cornell-box", "-o", "x.png", *SMALL, *ALWAYS, *flags, preexec_fn=limit_files)
        self.assertEqual(outcome.status, 6, outcome)
        self.assertIn("c.pvf", outcome.error())
        self.assertTrue(any("without this checkpoint" in event["text"] for event in outcome.events("warning")), outcome)
        self.assertEqual(self.files(), ["x.png"])
        picture = self.read("x.png")
        self.succeed("render", "cornell-box", "-o", "x.png", *SMALL, *flags)
        self.assertEqual(self.read("x.png"), picture)

    def test_a_disk_on_which_two_generations_do_not_fit_is_refused_before_the_first_sample(self):
        script = 'mkdir small && mount -t tmpfs -o size=64k x small && "$@"; status=$?; ls small; umount small && rmdir small; exit $status'
        if subprocess.run(["unshare", "-rm", "true"], check=False, stderr=subprocess.DEVNULL).returncode != 0:
            raise unittest.SkipTest("no mounts of its own")
        done = subprocess.run(["unshare", "-rm", "sh", "-c", script, "-", PROGRAM, "render", "cornell-box", "-o", "x.exr", "--json",
                               *with_default(["--size", "320x240"], PAIRS), "--checkpoint", "small/c.pvf"], cwd=self.folder, env=self.environment, check=False,
                              capture_output=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 6, done)
        self.assertIn(b"two generations of this checkpoint", done.stdout)
        self.assertNotIn(b'"event":"progress"', done.stdout)
        self.assertEqual(self.files(), [])


if __name__ == "__main__":
    main()
