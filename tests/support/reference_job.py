"""Shared parts of the tests against published pictures and figures: their command line, the scenes they need, and
the renderer's JSON lines. A script is run as `SCRIPT PERTEV [--device cuda] [--long]`."""

import argparse
import json
import os
import pathlib
import subprocess
import sys

SKIPPED = 77  # CTest's SKIP_RETURN_CODE


def last_event(program, arguments, *events):
    """Runs the program with --json and returns its first line of one of these events."""
    command = [str(word) for word in (program, *arguments, "--json")]
    print("+", *command, flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    if done.returncode != 0:
        last = done.stdout.decode("utf-8", "replace").strip().rsplit("\n", 1)[-1]
        sys.exit(f"the program ended with status {done.returncode}: {last}")
    for line in done.stdout.splitlines():
        values = json.loads(line)
        if values["event"] in events:
            return values
    sys.exit(f"the program printed no line of the event {' or '.join(events)}")


class ReferenceJob:
    """`effort` is "ci", "long" (--long or PERTEV_LONG_TESTS=1) or "cuda" (--device cuda); `spp` is a number or None; `only` has the
    names of the scenes to compare."""

    def __init__(self, description, only=()):
        parser = argparse.ArgumentParser(description=description)
        parser.add_argument("pertev", help="the program")
        parser.add_argument("--device", default="cpu", help="cpu or cuda")
        parser.add_argument("--long", action="store_true", help="the long setting, on the CPU")
        parser.add_argument("--spp", type=int, help="samples a pixel instead of those of the setting")
        if only:
            parser.add_argument("--only", action="append", choices=list(only), help="compares this scene, or several; without it, all")
            parser.add_argument("--results", help="a JSON file for what was found (tools/measurement.py)")
        arguments = parser.parse_args()
        self.program, self.device = arguments.pertev, arguments.device
        is_long = arguments.long or os.environ.get("PERTEV_LONG_TESTS") == "1"
        self.effort = "cuda" if self.device.startswith("cuda") else "long" if is_long else "ci"
        self.spp, self.only = arguments.spp, getattr(arguments, "only", None) or list(only)
        self.results, self.threads = getattr(arguments, "results", None), os.cpu_count()
        self.failures = 0

    def scene(self, relative):
        """A file under the folder that PERTEV_SCENES names; where it is not there, ends the test, as skipped if nothing failed before."""
        root = os.environ.get("PERTEV_SCENES")
        path = pathlib.Path(root or "", relative)
        if not root or not path.is_file():
            print(f"skipped: {path} is not there (set PERTEV_SCENES, see docs/scenes.md)")
            sys.exit(1 if self.failures else SKIPPED)
        return path

    def run(self, event, *arguments):
        return last_event(self.program, arguments, event)

    def check(self, what, value, low, high):
        good = value is not None and low <= value <= high
        print(f"{'ok    ' if good else 'FAILED'} {what}: {value} in [{low:.6g}, {high:.6g}]")
        self.failures += not good

    def check_blocks(self, picture, reference, bounds, mean_error):
        """Compares over blocks of pixels. `bounds`: relMSE at most, by side of a block; `mean_error`: of a channel."""
        for side, error in bounds.items():
            far = self.run("compare", "compare", picture, reference, "--blocks", side)
            self.check(f"relMSE of blocks of {side} x {side}", far["rel_mse_98"], 0, error)
            for channel, mean, wanted in zip("RGB", far["mean_98"], far["reference_mean_98"]):
                self.check(f"mean of {channel}", mean, wanted * (1 - mean_error), wanted * (1 + mean_error))

    def end(self):
        sys.exit(1 if self.failures else 0)
