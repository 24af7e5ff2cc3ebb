#!/usr/bin/env python3
"""examples/slurm_parts.sh: its parts make the picture of one run, and an ended task goes on. A stand-in of Slurm sets what an array's task
sees and records the arguments of `scontrol`; Slurm itself runs nothing here."""

import os
import pathlib
import signal
import subprocess
import time

from cli_run import PATIENCE_S, PROGRAM, UNMETERED, CliTest, main

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "examples" / "slurm_parts.sh"
SMALL = ["--size", "20x16", "--device", "cpu", *UNMETERED]


class SlurmParts(CliTest):
    def setUp(self):
        super().setUp()
        commands = pathlib.Path(self.folder, "commands")
        commands.mkdir()
        (commands / "scontrol").write_text('#!/bin/sh\necho "$@" >> "$PWD/asked"\n')
        (commands / "scontrol").chmod(0o755)
        self.environment.update(PATH=f"{commands}:{self.environment['PATH']}", PERTEV=PROGRAM)

    def task(self, first, last, number, *flags, **more):
        """Starts a task of `sbatch --array=first-last`."""
        array = {"SLURM_ARRAY_JOB_ID": "7", "SLURM_ARRAY_TASK_ID": number, "SLURM_ARRAY_TASK_MIN": first, "SLURM_ARRAY_TASK_MAX": last,
                 "SLURM_ARRAY_TASK_COUNT": last - first + 1, **more}
        program = subprocess.Popen(["bash", SCRIPT, "cornell-box", "parts", *SMALL, *map(str, flags)], cwd=self.folder, stdin=subprocess.DEVNULL,
                                   env={**self.environment, **{name: str(value) for name, value in array.items()}}, stderr=subprocess.PIPE)
        self.addCleanup(program.stderr.close)
        self.addCleanup(program.kill)
        return program

    def run_task(self, *arguments, status=0, **more):
        program = self.task(*arguments, **more)
        said = program.communicate(timeout=PATIENCE_S)[1].decode()
        self.assertEqual(program.returncode, status, said)
        return said

    def merged(self):
        parts = sorted(name for name in os.listdir(self.path("parts")) if name.startswith("part."))
        return self.succeed("merge", *(f"parts/{name}" for name in parts), "-o", "all.exr", "--json").events("done")[0]["hash"]

    def whole(self, spp):
        return self.succeed("render", "cornell-box", "-o", "whole.exr", "-o", "whole.pvf", *SMALL, "--spp", spp, "--json").events("done")[0]["hash"]

    def test_arrays_that_count_from_0_or_1_make_the_picture_of_one_run(self):
        for first in (0, 1):
            with self.subTest(first=first):
                for number in range(first, first + 4):
                    self.run_task(first, first + 3, number, "--spp", 6)
                names = os.listdir(self.path("parts"))
                self.assertEqual(sorted(names), [f"part.{number}.pvf" for number in range(first, first + 4)])
                self.assertEqual(self.merged(), self.whole(6))
                for name in names:
                    os.remove(self.path(f"parts/{name}"))

    def test_one_task_is_repeated_with_the_numbers_of_the_whole_array(self):
        for number in (0, 1, 3):
            self.run_task(0, 3, number, "--spp", 6)
        self.run_task(2, 2, 2, "--spp", 6, PARTS=4, PART_BASE=0)
        self.assertEqual(self.merged(), self.whole(6))
        self.run_task(0, 6, 2, "--spp", 6, SLURM_ARRAY_TASK_COUNT=4, status=2)

    def test_an_ended_task_is_queued_again_and_goes_on(self):
        spp = 20000
        self.run_task(1, 2, 1, "--spp", spp)
        program = self.task(1, 2, 2, "--spp", spp, "--checkpoint-every", "0.05")
        until = time.monotonic() + PATIENCE_S
        while not os.path.exists(self.path("parts/checkpoint.2.pvf")) and time.monotonic() < until:
            time.sleep(0.01)
        program.send_signal(signal.SIGTERM)
        said = program.communicate(timeout=PATIENCE_S)[1].decode()
        self.assertEqual(program.returncode, 75, said)
        with open(self.path("asked"), encoding="utf-8") as asked:
            self.assertEqual(asked.read().split(), ["requeue", "7_2"])
        self.assertIn("resumes from", self.run_task(1, 2, 2, "--spp", spp))
        self.assertEqual(self.merged(), self.whole(spp))

    def test_a_task_that_cannot_succeed_is_not_queued_again(self):
        self.run_task(1, 2, 1, "--spp", 0, status=2)
        self.assertFalse(os.path.exists(self.path("asked")))


if __name__ == "__main__":
    main()
