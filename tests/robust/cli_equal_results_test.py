#!/usr/bin/env python3
"""The table of docs/scale.md: however a picture is divided, interrupted or put together, its files have the hashes of one thread's run."""

import os
import signal
import subprocess
import time

from cli_run import PATIENCE_S, PROGRAM, UNMETERED, CliTest, main

SPP = 24
SMALL = ["--size", "24x18", "--device", "cpu", *UNMETERED, "--json"]
PICTURES = {
    "path": [],
    "bidirectional": ["--integrator", "bidirectional"],
    "photon map": ["--integrator", "photon_map", "--photons", "4000"],
    "layers and ids": ["--aov", "albedo,normal,depth,position,ids", "--lpe", "diffuse=LD+E", "--transparent"],
    "denoised": ["--denoise", "svgf"],
}
HASHES = ["hash", "layers_hash", "denoised_hash", "samples", "invalid_samples"]


class EqualResults(CliTest):
    def command(self, output, picture, *flags):
        samples = [] if "--samples" in flags or "--spp" in flags else ["--spp", SPP]
        return [*map(str, ["render", "cornell-box", "-o", output, "-o", "beside.pvf", *SMALL, *samples, *PICTURES[picture], *flags])]

    def hashes(self, *arguments):
        done = self.succeed(*arguments).events("done")[0]
        return {key: done[key] for key in HASHES}

    def together(self, *commands):
        """Runs commands at the same time."""
        programs = [subprocess.Popen([PROGRAM, *command], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                                     stdout=subprocess.DEVNULL) for command in commands]
        for program in programs:
            self.addCleanup(program.kill)
            self.assertEqual(program.wait(timeout=PATIENCE_S), 0)

    def each(self, way, spp=SPP):
        """Compares the hashes that `way` returns for each kind of picture with those of one thread."""
        for picture in PICTURES:
            with self.subTest(picture):
                known = self.hashes(*self.command("known.exr", picture, "--threads", "1", "--spp", spp))
                self.assertEqual(known["samples"], spp)
                self.assertEqual(way(picture), known)

    def test_two_threads_give_the_bytes_of_one(self):
        self.each(lambda picture: self.hashes(*self.command("x.exr", picture, "--threads", "2")))

    def test_two_processes_at_the_same_time_give_the_bytes_of_one(self):
        def way(picture):
            self.together(*(self.command(f"{i}.pvf", picture, "--part", f"{i}/2") for i in (1, 2)))
            return self.hashes("merge", "2.pvf", "1.pvf", "-o", "x.exr", "--json")

        self.each(way)

    def test_parts_of_rows_and_samples_merge_to_the_bytes_of_one_run(self):
        def way(picture):
            if picture == "bidirectional":
                self.refuse(2, *self.command("x.pvf", picture, "--rows", "0:9"), says=["--rows"])
                return self.hashes(*self.command("x.exr", picture))
            for i, part in enumerate(["--rows 0:7", "--rows 7:18 --part 1/2", "--rows 7:18 --part 2/2"]):
                self.succeed(*self.command(f"{i}.pvf", picture, *part.split()))
            return self.hashes("merge", "2.pvf", "0.pvf", "1.pvf", "-o", "x.exr", "--json")

        self.each(way)

    def test_a_killed_worker_s_part_is_rendered_again(self):
        spp = 60

        def way(picture):
            part = self.command("2.pvf", picture, "--spp", spp, "--part", "2/2", "--checkpoint", "c.pvf", "--checkpoint-every", "0.01")
            worker = subprocess.Popen([PROGRAM, *part], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
            self.addCleanup(worker.kill)
            until = time.monotonic() + PATIENCE_S
            while not os.path.exists(self.path("c.pvf")) and time.monotonic() < until:
                time.sleep(0.002)
            worker.send_signal(signal.SIGKILL)
            worker.wait(timeout=PATIENCE_S)
            self.succeed(*self.command("1.pvf", picture, "--spp", spp, "--part", "1/2"))
            self.succeed(*part)
            for name in ("c.pvf", "c.pvf.previous"):
                if os.path.exists(self.path(name)):
                    os.remove(self.path(name))
            return self.hashes("merge", "1.pvf", "2.pvf", "-o", "x.exr", "--json")

        self.each(way, spp)

    def test_a_resumed_run_gives_the_bytes_of_an_uninterrupted_one(self):
        def way(picture):
            self.succeed(*self.command("x.exr", picture, "--checkpoint", "c.pvf", "--spp", SPP // 3))
            done = self.hashes(*self.command("x.exr", picture, "--checkpoint", "c.pvf"))
            os.remove(self.path("c.pvf"))
            os.remove(self.path("c.pvf.previous"))
            return done

        self.each(way)

    def test_samples_added_to_a_merged_picture_give_the_bytes_of_one_run(self):
        def way(picture):
            for i, samples in enumerate(["0:5", "5:11"]):
                self.succeed(*self.command(f"{i}.pvf", picture, "--samples", samples))
            self.succeed("merge", "1.pvf", "0.pvf", "--partial", "-o", "first.pvf", "-q")
            self.succeed(*self.command("more.pvf", picture, "--samples", f"11:{SPP}"))
            return self.hashes("merge", "more.pvf", "first.pvf", "-o", "x.exr", "--json")

        self.each(way)


if __name__ == "__main__":
    main()
