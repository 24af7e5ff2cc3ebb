#!/usr/bin/env python3
"""`mpirun pertev render`: ranks divide a picture, whose files have the bytes of one run, and a dead rank costs its part alone.

CTest runs it for the program, which is built without MPI by default, as robust/cli_mpi, and for one with MPI, if that is there, as
robust/cli_ranks. Tests of ranks are skipped without mpirun, and for a program without MPI."""

import json
import os
import re
import shutil
import signal
import subprocess
import time
import unittest

from cli_run import PATIENCE_S, PROGRAM, UNMETERED, CliTest, main

MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--bind-to", "none"]
STAND_IN = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(PROGRAM))), "tests/liboidn_stand_in.so")
SMALL = ["--size", "24x18", "--device", "cpu", "--threads", "1", *UNMETERED]


def has_mpi():
    linked = subprocess.run(["ldd", PROGRAM], stdout=subprocess.PIPE, text=True, check=False).stdout
    return bool(shutil.which("mpirun")) and "libmpi" in linked


def can_divide_the_network():
    return os.geteuid() == 0 and bool(shutil.which("ip")) and subprocess.run(["ip", "netns", "list"], capture_output=True, check=False).returncode == 0


def ip(*words):
    return subprocess.run(["ip", *words], check=True, stdout=subprocess.PIPE, text=True).stdout


class Ranks(CliTest):
    def command(self, count, *flags, output="x.exr"):
        return [*MPIRUN, "-n", str(count), PROGRAM, "render", "cornell-box", "-o", output, "-o", f"{output}.pvf", *map(str, SMALL + [*flags])]

    def ranks(self, count, *flags, status=0, **options):
        done = subprocess.run(self.command(count, *flags, **options), cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, check=False,
                              timeout=PATIENCE_S, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def whole(self, *flags):
        return self.succeed("render", "cornell-box", "-o", "whole.exr", "-o", "whole.png", *SMALL, *flags, "--json").events("done")[0]

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def check(self, count, *flags):
        whole = self.whole(*flags)
        self.ranks(count, "-o", "x.png", *flags)
        info = self.info("x.exr")
        self.assertEqual((info["pertev.hash"], info["pertev.spp"]), (whole["hash"], whole["samples"]))
        compared = self.succeed("merge", "x.exr.pvf", "-o", "y.exr", "--json").events("done")[0]
        for key in ("hash", "layers_hash", "samples", "invalid_samples"):
            self.assertEqual(compared[key], whole[key], key)
        self.assertEqual(self.read("x.png"), self.read("whole.png"))
        known = {key: value for key, value in self.info("whole.exr").items() if not re.search("seconds|file|device", key)}
        self.assertEqual({key: info[key] for key in known}, known)
        self.assertEqual([name for name in self.files() if ".part-" in name], [])

    @unittest.skipUnless(has_mpi(), "no mpirun, or a build without MPI")
    def test_ranks_make_the_files_of_one_run(self):
        for picture in ([], ["--integrator", "bidirectional"], ["--integrator", "photon_map"],
                        ["--aov", "normal,ids", "--lpe", "diffuse=LD+E", "--transparent"], ["--aov", "depth,ids", "--layers-at", "centre"]):
            with self.subTest(picture):
                self.check(4, "--spp", 7, *picture)

    @unittest.skipUnless(has_mpi(), "no mpirun, or a build without MPI")
    def test_ranks_divide_the_frames_of_a_sequence(self):
        line = ["--size", "24x18", "--device", "cpu", "--threads", "1", "--turntable", "5"]
        for folder, more in (("still", ["--spp", "2"]), ("real", ["--real-time", "--cuts", "3"])):
            os.makedirs(self.path(folder + "/whole"))
            self.succeed("render", "cornell-box", "-o", f"{folder}/whole/f#.png", *line, *more)
            done = subprocess.run([*MPIRUN, "-n", "3", PROGRAM, "render", "cornell-box", "-o", f"{folder}/f#.png", *line, *more], cwd=self.folder,
                                  env=self.environment, stdin=subprocess.DEVNULL, check=False, timeout=PATIENCE_S, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            for frame in range(5):
                self.assertEqual(self.read(f"{folder}/f{frame}.png"), self.read(f"{folder}/whole/f{frame}.png"))

    @unittest.skipUnless(has_mpi(), "no mpirun, or a build without MPI")
    def test_there_may_be_more_ranks_than_samples(self):
        self.check(3, "--spp", 2)

    @unittest.skipUnless(has_mpi(), "no mpirun, or a build without MPI")
    def test_events_are_those_of_the_first_rank(self):
        lines = self.ranks(3, "--spp", 6, "--json").stdout.splitlines()
        self.assertEqual(sum('"event":"done"' in line for line in lines), 1)

    @unittest.skipUnless(has_mpi(), "no mpirun, or a build without MPI")
    def test_a_dead_rank_costs_its_part_alone(self):
        spp = 8000
        job = subprocess.Popen(self.command(3, "--spp", spp), cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(job.kill)
        until, victim = time.monotonic() + PATIENCE_S, None
        while victim is None and time.monotonic() < until:
            time.sleep(0.05)
            with open(f"/proc/{job.pid}/task/{job.pid}/children", encoding="ascii") as children:
                victim = next(iter(children.read().split()), None)
        time.sleep(1.5)
        os.kill(int(victim), signal.SIGKILL)
        self.assertNotEqual(job.wait(timeout=PATIENCE_S), 0)
        self.assertFalse(os.path.exists(self.path("x.exr")))
        kept = [name for name in self.files() if re.fullmatch(r"x[.]exr[.]part-\d-of-3[.]pvf", name)]
        self.assertGreaterEqual(len(kept), 1)
        self.ranks(3, "--spp", spp)
        self.assertEqual(self.info("x.exr")["pertev.hash"], self.whole("--spp", spp)["hash"])

    @unittest.skipUnless(has_mpi() and can_divide_the_network(), "no mpirun, a build without MPI, or no network namespaces")
    def test_ranks_with_two_addresses_sum_their_films_over_the_network(self):
        names = [f"pertev-{side}-{os.getpid()}" for side in "ab"]
        try:
            for name in names:
                ip("netns", "add", name)
                self.addCleanup(ip, "netns", "del", name)
                ip("-n", name, "link", "set", "lo", "up")
            ip("link", "add", "va", "netns", names[0], "type", "veth", "peer", "name", "vb", "netns", names[1])
            for name, device, host in zip(names, ("va", "vb"), (1, 2)):
                ip("-n", name, "addr", "add", f"10.77.0.{host}/24", "dev", device)
                ip("-n", name, "link", "set", device, "up")
        except subprocess.CalledProcessError as error:
            self.skipTest(f"network namespaces cannot be made: {error}")
        with open(self.path("agent"), "w", encoding="utf-8") as agent:  # in place of ssh: HOST COMMAND
            agent.write(f'#!/bin/sh\nhost=$1\nshift\ncase $host in *.1) n={names[0]} ;; *) n={names[1]} ;; esac\nexec ip netns exec $n sh -c "$*"\n')
        os.chmod(self.path("agent"), 0o755)
        whole = self.whole("--spp", 6)
        network = [word for layer in ("btl_tcp_if_include", "oob_tcp_if_include") for word in ("--mca", layer, "10.77.0.0/24")]
        done = subprocess.run(["ip", "netns", "exec", names[0], *MPIRUN, "--mca", "plm_rsh_agent", self.path("agent"), "--mca", "btl", "self,tcp",
                               *network, "-H", "10.77.0.1,10.77.0.2", *self.command(2, "--spp", 6)[len(MPIRUN):]],
                              cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, timeout=PATIENCE_S, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.info("x.exr")["pertev.hash"], whole["hash"])
        sent = json.loads(ip("-n", names[1], "-s", "-j", "link", "show", "vb"))[0]["stats64"]["tx"]["bytes"]
        self.assertGreater(sent, 24 * 18 * 4 * 16)

    @unittest.skipUnless(has_mpi() and os.path.exists(STAND_IN), "no mpirun, a build without MPI, or no stand-in for Open Image Denoise")
    def test_the_first_rank_denoises_the_picture_of_all(self):
        self.environment["PERTEV_OIDN"] = STAND_IN
        self.check(3, "--spp", 20, "--denoise", "svgf")
        self.check(3, "--spp", 20, "--denoise", "oidn")
        self.assertEqual(self.info("x.exr")["pertev.denoiser"], self.info("whole.exr")["pertev.denoiser"])
        self.succeed("render", "cornell-box", "-o", "plain.png", *SMALL, "--spp", "20")
        self.assertNotEqual(self.read("x.png"), self.read("plain.png"))

    @unittest.skipUnless(has_mpi(), "no mpirun, or a build without MPI")
    def test_settings_unsupported_with_ranks_are_refused(self):
        for flags in (["--checkpoint", "c.pvf"], ["--time-limit", "1"]):
            with self.subTest(flags):
                self.ranks(2, "--spp", 2, *flags, status=2)

    @unittest.skipUnless(has_mpi(), "no mpirun, or a build without MPI")
    def test_processes_with_parts_of_their_own_are_no_ranks(self):
        self.ranks(1, "--spp", 4, "--part", "1/2", output="1.exr")
        self.ranks(2, "--spp", 4, "--part", "2/2", output="2.exr")
        self.assertEqual(self.succeed("merge", "1.exr.pvf", "2.exr.pvf", "-o", "y.exr", "--json").events("done")[0]["hash"], self.whole("--spp", 4)["hash"])

    def test_a_build_without_mpi_refuses_to_render_the_whole_picture_in_each_rank(self):
        if has_mpi():
            self.skipTest("this build has MPI")
        environment = {**self.environment, "OMPI_COMM_WORLD_SIZE": "2"}
        self.refuse(2, "render", "cornell-box", "-o", "x.pvf", *SMALL, env=environment)
        self.succeed("render", "cornell-box", "-o", "x.pvf", *SMALL, "--part", "1/2", "--spp", "2", env=environment)


if __name__ == "__main__":
    main()
