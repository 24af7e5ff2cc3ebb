"""Tests of packages that this Python may lack: Debian's own has its torch, and .ci/run puts others into build/test-tools."""

import functools
import importlib.util
import os
import pathlib
import subprocess
import sys

PYTHONS = (sys.executable, "/usr/bin/python3", pathlib.Path(__file__).resolve().parents[2] / "build/test-tools/bin/python")


def python_with(*packages):
    """Returns the first of these Pythons that can import the packages, or None."""
    return next((python for python in PYTHONS if os.path.exists(python) and subprocess.run(
        [python, "-c", "import " + ", ".join(packages)], check=False, stderr=subprocess.DEVNULL).returncode == 0), None)


def needs(package):
    """Decorates a test: where this Python lacks the package, one that has it and can load the module runs the test."""
    def decorated(test):
        @functools.wraps(test)
        def run(self):
            if importlib.util.find_spec(package):
                return test(self)
            python = python_with("pertev", package)
            if python is None:
                self.skipTest(f"{package} is not installed")
            name = self.id().removeprefix("__main__.")
            done = subprocess.run([python, *sys.orig_argv[1:], name], check=False, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertNotIn("skipped", done.stderr)
        return run
    return decorated
