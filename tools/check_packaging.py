#!/usr/bin/env python3
"""Fails where packaging/ or .github/workflows could not be read by what they are for: an image's recipe has only known instructions, copies
from stages and folders that there are, and is accepted by hadolint; a workflow is YAML, runs files that there are, and is accepted by
check-jsonschema, which has GitHub's schema; systemd accepts the unit. It says which of these tools are missing, also in build/test-tools, where .ci/run puts them, and then ends
with 77; it runs nothing of the files.

    tools/check_packaging.py
    tools/check_packaging.py --self-test
"""

import functools
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINTERS = {"hadolint": [], "check-jsonschema": ["--builtin-schema", "vendor.github-workflows"]}  # with their options
INSTRUCTIONS = {"FROM", "ARG", "WORKDIR", "COPY", "RUN", "ENV", "USER", "ENTRYPOINT"}


def faults_of_recipe(text):
    faults, stages = [], set()
    for line in re.sub(r"\\\n", " ", text).splitlines():
        words = line.split()
        if not words or line.startswith("#"):
            continue
        if words[0] not in INSTRUCTIONS or len(words) == 1 or (not stages and words[0] != "FROM"):
            faults.append(f"no such instruction here: {line}")
        if words[0] == "FROM":
            stages.add(words[3] if words[2:3] == ["AS"] else str(len(stages)))
        if words[0] == "COPY" and words[1].startswith("--from=") and words[1].removeprefix("--from=") not in stages:
            faults.append(f"no such stage: {line}")
        if words[0] == "RUN":
            faults += [f"there is no {script}" for script in re.findall(r"\./(\S+\.sh)", line) if not (ROOT / script).is_file()]
    return faults + ([] if stages else ["it has no stage"])


def faults_of_workflow(text):
    import yaml  # pylint: disable=import-outside-toplevel
    try:
        read = yaml.safe_load(text)
        faults = [f"{key} is missing" for key in ("name", "jobs") if key not in read]
        for name, job in read.get("jobs", {}).items():
            if "runs-on" not in job or not all(("run" in step) != ("uses" in step) for step in job["steps"]):
                faults.append(f"{name} has no machine, or a step that neither runs nor uses something")
            runs = " ".join(step.get("run", "") for step in job["steps"])
            faults += [f"there is no {script}" for script in re.findall(r"\.ci/\w+", runs) if not (ROOT / script).is_file()]
        return faults
    except (yaml.YAMLError, AttributeError, KeyError, TypeError) as error:
        return [f"it is no workflow: {error}"]


def faults_of_unit(text):
    """Returns what systemd says of it, with a program that there is in place of ours."""
    with tempfile.TemporaryDirectory() as folder:
        unit = pathlib.Path(folder, "checked@.service")
        unit.write_text(text.replace("ExecStart=/usr/bin/pertev", f"ExecStart={shutil.which('true')}"), encoding="utf-8")
        done = subprocess.run(["systemd-analyze", "verify", "--man=no", unit], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return [line for line in done.stdout.splitlines() if "checked@" in line]


@functools.cache
def linter(name):
    """Returns the linter's program, or None: the system's, or the one of build/test-tools. One that does not start, such as a script whose
    Python is gone, is none."""
    for program in filter(None, (shutil.which(name, path=path) for path in (None, ROOT / "build/test-tools/bin"))):
        try:
            subprocess.run([program, "--version"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
            return program
        except (OSError, subprocess.CalledProcessError):
            continue
    return None


def faults_by_linter(name, file):
    program = linter(name)
    if program is None:
        return []
    done = subprocess.run([program, *LINTERS[name], file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.stdout.splitlines() if done.returncode else []


def missing_tools():
    missing = [name for name in LINTERS if linter(name) is None]
    missing += [] if shutil.which("systemd-analyze") else ["systemd-analyze"]
    return missing + ([] if importlib.util.find_spec("yaml") else ["PyYAML"])


def self_test():
    good = (ROOT / "packaging/Dockerfile").read_text(encoding="utf-8")
    assert not faults_of_recipe(good)
    for bad in [good.replace("ENTRYPOINT", "ENTRYPIONT"), good.replace("--from=build", "--from=made"), good.replace("setup.sh", "set.sh"), "", "RUN x"]:
        assert faults_of_recipe(bad), bad
    workflow = (ROOT / ".github/workflows/check.yml").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        for name, file, bad in [("hadolint", "Dockerfile", good.replace("WORKDIR /work", "WORKDIR work")),
                                ("check-jsonschema", "check.yml", workflow.replace("steps:", "stages:"))]:
            path = pathlib.Path(folder, file)
            path.write_text(bad, encoding="utf-8")
            assert linter(name) is None or faults_by_linter(name, path), bad
        script = pathlib.Path(folder, "no-linter")
        script.write_text("#!/no/python\n", encoding="utf-8")
        script.chmod(0o755)
        path, os.environ["PATH"] = os.environ["PATH"], folder
        assert linter(script.name) is None, "its Python is gone"
        os.environ["PATH"] = path
    missing = missing_tools()
    for bad in [workflow.replace(".ci/run", ".ci/rum"), workflow.replace("- uses:", "- use:"), "a: [", "", workflow.replace("jobs:", "job:")]:
        assert "PyYAML" in missing or faults_of_workflow(bad), bad
    if "systemd-analyze" in missing:
        return
    unit = (ROOT / "packaging/pertev-view@.service").read_text(encoding="utf-8")
    for bad in [unit.replace("Restart=on-failure", "Restart=never-ever"), unit.replace("ExecStart=", "ExecBegin=")]:
        assert faults_of_unit(bad), bad


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return 0
    missing = missing_tools()
    tools = {faults_of_workflow: "PyYAML", faults_of_unit: "systemd-analyze"}
    faults = []
    for pattern, look, by in [("packaging/Dockerfile", faults_of_recipe, "hadolint"), (".github/workflows/*.yml", faults_of_workflow, "check-jsonschema"),
                                  ("packaging/*.service", faults_of_unit, None)]:
        for file in sorted(ROOT.glob(pattern)):
            if tools.get(look) not in missing:
                faults += [f"{file.relative_to(ROOT)}: {fault}" for fault in look(file.read_text(encoding="utf-8"))]
            if by:
                faults += faults_by_linter(by, file)
    print("\n".join(faults) or "packages, workflow and unit are read by what they are for")
    if missing:
        print(f"skipped: there is no {', '.join(missing)}")
    return 1 if faults else 77 if missing else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--help"]:
        print(__doc__)
        sys.exit()
    sys.exit(main(sys.argv[1:]))
