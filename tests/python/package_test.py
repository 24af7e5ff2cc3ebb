"""Tests the package's metadata: names, versions and the command that pip installs. No wheel is made here."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import tomllib
import unittest

PROGRAM = sys.argv.pop(1)
ROOT = pathlib.Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
OVERRIDES = PROJECT["tool"]["scikit-build"]["overrides"]


def versions_of(metadata):
    """Returns the version that scikit-build-core makes of these settings."""
    rule = metadata["version"]
    value = re.search(rule["regex"], (ROOT / rule["input"]).read_text(encoding="utf-8"))["value"]
    return rule.get("result", "{value}").format(value=value)


class Names(unittest.TestCase):
    def test_versions_are_those_of_the_program(self):
        printed = subprocess.run([PROGRAM, "-V"], check=True, capture_output=True, text=True).stdout
        version = versions_of(PROJECT["tool"]["scikit-build"]["metadata"])
        self.assertIn(version, printed.split()[1].split("-")[0])
        with_cuda = next(row for row in OVERRIDES if row["if"].get("env") == {"PERTEV_WHEEL_CUDA": True})
        self.assertEqual(versions_of(with_cuda["metadata"]), f"{version}+cu13")

    def test_the_stable_abi_requires_a_cmake_that_supports_it(self):
        row = next(row for row in OVERRIDES if "python-version" in row["if"])
        self.assertEqual(PROJECT["tool"]["scikit-build"]["wheel"]["py-api"], "cp312")
        self.assertEqual((row["if"]["python-version"], row["cmake"]["version"]), (">=3.12", ">=3.26"))

    def test_named_files_exist(self):
        files = PROJECT["tool"]["scikit-build"]["wheel"]
        for name in files["packages"] + files["license-files"]:
            self.assertTrue((ROOT / name).exists(), name)


class Wheels(unittest.TestCase):
    def test_a_wheel_over_80_megabytes_is_a_fault(self):
        """The script runs without a Python, so that it makes no wheel, beside a wheel of that size."""
        with tempfile.TemporaryDirectory() as folder:
            tools = pathlib.Path(folder, "tools")
            tools.mkdir()
            for name in ("make_wheel.sh", "bundled_libraries.sh"):
                shutil.copy(ROOT / "tools" / name, tools / name)
            installed = pathlib.Path(folder, "build", "wheel", "tools", "bin")
            installed.mkdir(parents=True)
            for name, program in (("auditwheel", "true"), ("cmake", "true"), ("pip", "false")):  # nothing is fetched
                (installed / name).symlink_to(f"/bin/{program}")
            wheel = pathlib.Path(folder, "out", "pertev-0-cp311.whl")
            wheel.parent.mkdir()
            for size, status in ((80_000_000, 0), (80_000_001, 1)):
                with wheel.open("wb") as file:
                    file.truncate(size)
                done = subprocess.run(["bash", tools / "make_wheel.sh", wheel.parent], env={"PATH": os.environ["PATH"], "PERTEV_PYTHONS": "no-python"},
                                      capture_output=True, text=True, check=False)
                self.assertEqual((done.returncode, wheel.name in done.stderr), (status, bool(status)), done.stderr)


class Command(unittest.TestCase):
    def run_command(self, *words):
        """Runs the command of pyproject.toml, as pip installs it."""
        module, function = PROJECT["project"]["scripts"]["pertev"].split(":")
        return subprocess.run([sys.executable, "-c", f"import {module}; {module}.{function}()", *words], text=True,
                              capture_output=True, check=False)

    def test_the_command_is_the_program(self):
        program = subprocess.run([PROGRAM, "-V"], check=True, capture_output=True, text=True)
        self.assertEqual(self.run_command("-V").stdout, program.stdout)

    def test_arguments_and_status_are_passed_on(self):
        program = subprocess.run([PROGRAM, "render", "no such.glb", "-o", "a.png"], capture_output=True, text=True, check=False)
        done = self.run_command("render", "no such.glb", "-o", "a.png")
        self.assertEqual((done.returncode, done.stderr), (program.returncode, program.stderr))
        self.assertNotEqual(done.returncode, 0)

    def test_its_picture_is_that_of_the_program(self):
        flags = ["cornell-box", "--size", "16x16", "--spp", "2", "--device", "cpu", "--json", "-o"]
        with tempfile.TemporaryDirectory() as folder:
            for name, words in (("a", [PROGRAM]), ("b", [sys.executable, "-m", "pertev_program"])):
                subprocess.run([*words, "render", *flags, f"{folder}/{name}.png"], check=True, capture_output=True)
            self.assertEqual(pathlib.Path(folder, "a.png").read_bytes(), pathlib.Path(folder, "b.png").read_bytes())

    def test_a_signal_ends_it_as_it_ends_the_program(self):
        flags = ["render", "cornell-box", "--size", "512x512", "--spp", "65536", "--device", "cpu", "--json", "-o"]
        for words in ([PROGRAM], [sys.executable, "-m", "pertev_program"]):
            with tempfile.TemporaryDirectory() as folder, \
                 subprocess.Popen([*words, *flags, f"{folder}/a.exr"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
                process.stdout.readline()  # the first event: it renders
                process.send_signal(signal.SIGINT)
                process.stdout.read()
                self.assertEqual(process.wait(timeout=30), 75)

    def test_the_command_loads_the_module_alone(self):
        shown = "import sys, pertev_program\ntry: pertev_program.main()\nfinally: print(sorted({'pertev', 'numpy'} & set(sys.modules)))"
        done = subprocess.run([sys.executable, "-c", shown, "-V"], capture_output=True, text=True, check=True)
        self.assertTrue(done.stdout.endswith("[]\n"), done.stdout)


if __name__ == "__main__":
    unittest.main()
