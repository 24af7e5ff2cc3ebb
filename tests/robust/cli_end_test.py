#!/usr/bin/env python3
"""How a render ends early: by one or two Ctrl-C, or by a limit."""

import json
import os
import pty
import resource
import signal
import subprocess
import time

from cli_run import PATIENCE_S, PROGRAM, SANITIZED, CliTest, listen_to, main


def user_seconds(pid):
    """Returns the processor time that a running process has used in its own code. Unlike the clock, other processes do not affect it."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        return int(file.read().rpartition(")")[2].split()[11]) / os.sysconf("SC_CLK_TCK")


class WhenItEnds(CliTest):
    def start(self, *arguments):
        program = subprocess.Popen([PROGRAM, "render", "cornell-box", *arguments], cwd=self.folder,
                                   env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(program.kill)
        return program

    def test_an_interrupt_writes_the_complete_samples_and_ends_with_75(self):
        for kind in [signal.SIGINT, signal.SIGTERM]:
            program = self.start("-o", "part.exr", "-o", "part.png", "--size", "48x48", "--spp", "8388607", "--json")
            seen = 0
            for line in program.stdout:
                seen += json.loads(line)["event"] == "progress"
                if seen == 2:
                    break
            program.send_signal(kind)
            stdout, stderr = program.communicate(timeout=300)
            self.assertEqual(program.returncode, 75, stderr)
            done = json.loads(stdout.splitlines()[-1])
            self.assertEqual((done["event"], done["interrupted"]), ("done", True))
            self.assertGreaterEqual(done["samples"], 2)
            part = self.info("part.exr")
            self.assertEqual((part["hash"], part["pertev.spp"]), (done["hash"], done["samples"]))
            self.assertEqual(self.render(size="48x48", spp=done["samples"], output="whole.exr")["hash"], done["hash"])
            self.assertEqual(self.files(), ["part.exr", "part.png", "whole.exr"])

    def test_a_second_interrupt_ends_at_once_and_leaves_no_file(self):
        leader, follower = pty.openpty()
        listener, said = listen_to(leader)
        program = subprocess.Popen([PROGRAM, "render", "cornell-box", "-o", "x.exr", "--size", "1200x1200", "--spp", "640",
                                    "--threads", "1", "--device", "cpu"], cwd=self.folder, env=self.environment, stderr=follower)
        self.addCleanup(program.kill)
        os.close(follower)
        while b"/640 spp" not in b"".join(said):  # one sample is complete, and the next has begun
            self.assertIsNone(program.poll())
            time.sleep(0.01)
        program.send_signal(signal.SIGINT)
        self.wait_while(program, is_listening=True)  # until the first signal is handled
        self.assertIsNone(program.poll(), "the first interrupt waits for the sample to be whole")
        program.send_signal(signal.SIGINT)
        program.wait(300)
        listener.join()
        self.assertEqual(program.returncode, -signal.SIGINT)
        self.assertEqual(self.files(), [])
        self.assertEqual(b"".join(said).count(b"again ends at once"), 1)

    def test_an_interrupt_in_the_first_sample_ends_at_once_with_75(self):
        program = self.start("-o", "x.exr", "--size", "6000x6000", "--spp", "64", "--threads", "1", "--device", "cpu")
        while b"; rendering " not in program.stderr.readline():
            self.assertIsNone(program.poll())
        self.wait_while(program, is_listening=False)
        time.sleep(1)
        ended_before, running = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, user_seconds(program.pid)
        program.send_signal(signal.SIGINT)
        program.communicate(timeout=PATIENCE_S)
        self.assertEqual((program.returncode, self.files()), (75, []))
        if not SANITIZED:  # a sample takes half a minute
            self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - ended_before - running, 5)

    def test_an_interrupt_while_a_scene_is_read_ends_at_once_with_75(self):
        with open(os.path.join(self.folder, "big.obj"), "w", encoding="ascii") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n" * 4_000_000)
        for kind in [signal.SIGINT, signal.SIGTERM]:
            program = subprocess.Popen([PROGRAM, "render", "big.obj", "-o", "x.exr", "--json"], cwd=self.folder,
                                       env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.addCleanup(program.kill)
            self.wait_while(program, is_listening=False)
            time.sleep(0.2)
            self.assertIsNone(program.poll())
            program.send_signal(kind)
            began = time.monotonic()
            stdout, stderr = program.communicate(timeout=PATIENCE_S)
            took = time.monotonic() - began
            self.assertEqual((program.returncode, stderr, self.files()), (75, b"", ["big.obj"]))
            events = [json.loads(line) for line in stdout.splitlines()]
            self.assertEqual((events[-1]["event"], events[-1]["code"]), ("error", "interrupted"))
            self.assertNotIn("scene", [event["event"] for event in events])
            if not SANITIZED:
                self.assertLess(took, 2)

    def test_a_time_limit_ends_at_a_whole_sample_with_0(self):
        done = self.render("--time-limit", "0.5", size="48x48", spp=8388607)
        self.assertLess(done["seconds"], 60)
        self.assertEqual(self.render(size="48x48", spp=done["samples"])["hash"], done["hash"])
        self.assertEqual(self.render("--time-limit", "1e-9", size="48x48", spp=100)["samples"], 1)


if __name__ == "__main__":
    main()
