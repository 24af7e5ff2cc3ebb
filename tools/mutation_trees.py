"""One build without a mutation and copies of it, for tools/test_the_tests.py.

A copy has the times and, at a path of the same length, the paths of the first tree, so that ninja has nothing to do in it.
A mutation compiles only those files that the programs of its tests link: the linker's map of each test's own program says which.
"""

import contextlib
import importlib.util
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent
BINARY = {".o", ".a", ".so", ".gch"}
LAUNCHER = """#!/bin/bash
# Runs a compiler when one of the slots is free.
[[ -p {slots} ]] || exec "$@"
exec 9<>{slots}
read -r -n 1 -u 9
"$@" 9>&-
status=$?
printf . >&9
exit $status
"""


class OutOfTime(Exception):
    pass


class Runner:
    """Runs commands until a deadline, and holds the slots: so many compilers, or pairs of a test's threads, run at once."""

    def __init__(self, work, count, deadline):
        self.count, self.deadline = count, deadline
        self.launcher, self.slots_file = work / "wait_for_slot", work / "slots"
        self.launcher.write_text(LAUNCHER.format(slots=shlex.quote(str(self.slots_file))))
        self.launcher.chmod(0o755)
        self.slots_file.unlink(missing_ok=True)
        os.mkfifo(self.slots_file)
        self.slots = os.open(self.slots_file, os.O_RDWR)
        os.write(self.slots, b"." * count)
        self.taking = threading.Lock()
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("PERTEV_")}
        self.environment |= {"CCACHE_BASEDIR": str(work), "CCACHE_NOHASHDIR": "1", "CCACHE_SLOPPINESS": "pch_defines,time_macros"}

    def close(self):
        self.slots_file.unlink(missing_ok=True)

    def left(self):
        return self.deadline - time.monotonic()

    @contextlib.contextmanager
    def hold(self, count):
        count = min(count, self.count)
        with self.taking:
            for _ in range(count):
                os.read(self.slots, 1)
        try:
            yield
        finally:
            os.write(self.slots, b"." * count)

    def run(self, command, folder=None):
        """(exit status, output). Throws OutOfTime, after the end of the command and its children, at the deadline."""
        process = subprocess.Popen([str(word) for word in command], cwd=folder, env=self.environment, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            output, _ = process.communicate(timeout=max(0, self.left()))
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            raise OutOfTime from None
        return process.returncode, output.decode(errors="replace")


def tracked_files():
    """All files of the tree except what is built. An exported tree, which has no .git, will do."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, check=False,
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    if (ROOT / ".git").exists() and listed.returncode == 0:
        names = listed.stdout.decode().split("\0")
    else:
        names = [str(path.relative_to(ROOT)) for top in ROOT.iterdir() if not top.name.startswith((".git", "build"))
                 for path in ([top] if top.is_file() else top.rglob("*")) if "__pycache__" not in path.parts]
    return [name for name in names if name and (ROOT / name).is_file()]


def apply(edits, contents):
    """Makes the edits in `contents`, bytes by name. Returns what does not apply."""
    for file, old, new in edits:
        count = contents.get(file, b"").count(old.encode())
        if count != 1:
            return f"{file} has {count} times: {old}"
        contents[file] = contents[file].replace(old.encode(), new.encode())
    return None


@contextlib.contextmanager
def threads_on(cores):
    """Processes that this thread starts have these cores alone."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, cores)
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def list_files(top):
    """{path below `top`: (time, size)} of all files."""
    found, length = {}, len(str(top)) + 1
    for folder, _, names in os.walk(top):
        for name in names:
            path = os.path.join(folder, name)
            status = os.lstat(path)
            found[path[length:]] = (status.st_mtime_ns, status.st_size)
    return found


def has_script(test):
    """Whether the test is a script that runs the program."""
    return (ROOT / f"tests/{test}_test.py").is_file()


class Tree:
    """A tree, and its build folder within it, as in a checkout."""

    def __init__(self, path, runner):
        self.path, self.build, self.runner = path, path / "build", runner
        self.cores = os.sched_getaffinity(0)

    def ninja(self, targets):
        """Error text, or nothing."""
        status, text = self.runner.run(["ninja", "-C", self.build, "-k", "0", "-j", self.runner.count, *targets])
        bad = [line for line in text.splitlines() if re.search(r"\berror\b|undefined reference|cannot find", line) and not line.startswith("[")]
        return None if status == 0 else "\n".join(bad + [text[-1500:]])

    def configure(self, *settings):
        status, text = self.runner.run(["cmake", "-G", "Ninja", "-S", self.path, "-B", self.build, *settings])
        return None if status == 0 else text

    def tell(self, *question):
        status, text = self.runner.run(["ninja", "-C", self.build, "-t", *question])
        assert status == 0, text
        return text

    def run_tests(self, tests, limits):
        """{test: (status, seconds, output)} of CTest. Tests that it does not know are missing. `limits` in seconds."""
        found = {}
        for test in tests:
            report = self.path / "report.xml"
            report.unlink(missing_ok=True)
            with self.runner.hold(2), threads_on(self.cores):
                self.runner.run(["ctest", "--test-dir", self.build, "-R", f"^{re.escape(test)}$", "--timeout", limits(test),
                                 "--output-junit", report])
            for case in ElementTree.parse(report).getroot().iter("testcase") if report.is_file() else []:
                failure = case.find("failure")
                status = "timeout" if failure is not None and failure.get("message") == "Timeout" else case.get("status")
                found[case.get("name")] = (status, float(case.get("time")), (case.findtext("system-out") or "")[-1500:])
        return found


class Base(Tree):
    """The tree without a mutation; of the test files it has only `tests`."""

    def __init__(self, path, runner, tests):
        super().__init__(path, runner)
        self.tests = tests
        self.contents = {name: (ROOT / name).read_bytes() for name in tracked_files() if self.is_wanted(name)}
        self.programs = ["pertev_tests"] if any(not test.startswith("sources/") and not has_script(test) for test in tests) else []
        if any(has_script(test) for test in tests):
            self.programs.append("pertev")
        self.has_python = any(test.startswith("python/") for test in tests) and importlib.util.find_spec("nanobind") is not None
        if self.has_python:
            self.programs.append("python/all")
        self.objects_of, self.sources_of, self.seconds_of = {}, {}, {}

    def is_wanted(self, name):
        return not name.endswith("_test.cpp") or name[len("tests/"):-len("_test.cpp")] in self.tests

    def write(self):
        """Files that are right already keep their times."""
        for path in self.path.rglob("*"):
            if path.is_file() and self.build not in path.parents and str(path.relative_to(self.path)) not in self.contents:
                path.unlink()
        for name, content in self.contents.items():
            path = self.path / name
            if not path.is_file() or path.read_bytes() != content:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
                shutil.copymode(ROOT / name, path)

    def make(self, settings):
        """Writes, configures and builds. Returns error text, or nothing."""
        self.write()
        launcher = str(self.runner.launcher) + (";ccache" if shutil.which("ccache") else "")
        problem = self.configure("-DPERTEV_CUDA=OFF", "-DPERTEV_WERROR=OFF", f"-DPERTEV_PYTHON={'ON' if self.has_python else 'OFF'}",
                                 f"-DPython_EXECUTABLE={sys.executable}", f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}", *settings)
        if problem or not self.programs:
            return problem
        return self.ninja(self.programs)

    def read_build(self):
        """Learns from ninja which objects read a file and how long each took."""
        if not self.programs:
            return
        for line in (self.build / ".ninja_log").read_text().splitlines()[1:]:
            start, end, _, output, _ = line.split("\t")
            self.seconds_of[output] = (int(end) - int(start)) / 1000
        output = None
        for line in self.tell("deps").splitlines():
            if not line.startswith(" "):
                output = line.split(":")[0]
            elif str(self.path) in line or ".." in line:
                source = os.path.relpath(os.path.normpath(self.build / line.strip()), self.path)
                self.sources_of.setdefault(source, set()).add(output)
        if "pertev_tests" not in self.programs:
            return
        words = shlex.split(self.tell("commands", "bin/pertev_tests").splitlines()[-1])
        words = words[words.index("&&") + 1:]
        words = words[:words.index("&&")]
        at = words.index("-o")
        del words[at:at + 2]
        self.objects = [word for word in words if word.endswith(".o")]
        self.archives = [word for word in words if word.endswith(".a") and (self.build / word).is_file() and not word.startswith("/")]
        self.link_words = [word for word in words if word not in self.objects + self.archives and "whole-archive" not in word]
        members = {}
        for archive in set(self.archives):
            for word in self.tell("query", archive).split():
                if word.endswith(".o"):
                    members.setdefault(f"{archive}({pathlib.Path(word).name})", []).append(word)
        support = [word for word in self.objects if not word.endswith(("_test.cpp.o", "pertev_tests.dir/main.cpp.o"))]
        self.support_archive = self.path.parent / "support.a"
        self.support_archive.unlink(missing_ok=True)
        status, text = self.runner.run(["ar", "qcs", self.support_archive, *support], self.build)
        assert status == 0, text
        for word in support:
            members.setdefault(f"{self.support_archive}({pathlib.Path(word).name})", []).append(word)
        self.members = members

    def find_objects(self, test):
        """Links the test's file alone, whereby the map names what it takes from each archive."""
        own = [word for word in self.objects if word.endswith((f"pertev_tests.dir/{test}_test.cpp.o", "pertev_tests.dir/main.cpp.o"))]
        if len(own) != 2:
            return
        program = self.path.parent / ("link_" + test.replace("/", "_"))
        compiler, *flags = self.link_words
        with self.runner.hold(1):
            status, text = self.runner.run([compiler, *own, self.support_archive, *self.archives, *flags, "-o", program,
                                            f"-Wl,-Map={program}.map"], self.build)
        if status == 0:
            taken = re.findall(r"^(\S+\.a\([^)]+\))", pathlib.Path(f"{program}.map").read_text(errors="replace"), re.MULTILINE)
            self.objects_of[test] = own + sorted({word for name in taken for word in self.members.get(name, [])})
        else:
            print(f"{test} cannot be linked alone: {text[-500:]}")
        program.unlink(missing_ok=True)
        pathlib.Path(f"{program}.map").unlink(missing_ok=True)

    def compile_seconds(self, mutation):
        """The seconds that its compilers took in the first build."""
        read = set().union(*(self.sources_of.get(file, set()) for file, _, _ in mutation.edits))
        if not any(has_script(test) for test in mutation.tests):
            read &= set().union(*(self.objects_of.get(test, read) for test in mutation.tests))
        else:
            read = {word for word in read if not word.startswith("tests/")}
        return sum(self.seconds_of.get(word, 0) for word in read)

    def list_files(self):
        """Remembers what the copies hold, and which files name the tree's path."""
        self.files = {file: status for file, status in list_files(self.path).items()
                      if file not in ("build/bin/pertev_tests", "report.xml") and not file.startswith("build/Testing/")}
        own = str(self.path)
        self.naming = {file for file in self.files
                       if (own in os.readlink(self.path / file) if (self.path / file).is_symlink() else
                           pathlib.Path(file).suffix not in BINARY and "build/bin/" not in file and own.encode() in (self.path / file).read_bytes())}


class Copy(Tree):
    """A copy of the base, at a path that is as long."""

    def __init__(self, path, base, cores):
        super().__init__(path, base.runner)
        self.base, self.cores = base, cores
        assert len(str(path)) == len(str(base.path))

    def bring(self):
        """Makes the copy equal to the base again, times included. Nothing is linked: a compiler may write into a file."""
        if not self.path.exists():
            status, text = self.runner.run(["cp", "-a", "--reflink=auto", self.base.path, self.path])
            assert status == 0, text
            there = list_files(self.path) | dict.fromkeys(self.base.naming)
        else:
            there = list_files(self.path)
        for file in there.keys() - self.base.files.keys():
            (self.path / file).unlink()
        for file, status in self.base.files.items():
            if there.get(file) != status:
                self.bring_file(file)

    def bring_file(self, file):
        old, new = self.base.path / file, self.path / file
        new.parent.mkdir(parents=True, exist_ok=True)
        new.unlink(missing_ok=True)
        if file not in self.base.naming:
            shutil.copy2(old, new, follow_symlinks=False)
            return
        status = old.lstat()
        if old.is_symlink():
            new.symlink_to(os.readlink(old).replace(str(self.base.path), str(self.path)))
        else:
            content = old.read_bytes().replace(str(self.base.path).encode(), str(self.path).encode())
            if file == "build/CMakeFiles/rules.ninja": # ninja compares no command of such a rule with its log, where paths differ
                content = re.sub(rb"(?m)^(rule .*)$", rb"\1\n  generator = 1", content)
            new.write_bytes(content)
            shutil.copymode(old, new)
        os.utime(new, ns=(status.st_atime_ns, status.st_mtime_ns), follow_symlinks=False)

    def mutate(self, edits):
        """Returns what does not apply."""
        contents = {file: self.base.contents[file] for file, _, _ in edits if file in self.base.contents}
        problem = apply(edits, contents)
        for file, content in contents.items() if not problem else ():
            (self.path / file).write_bytes(content)
        return problem

    def make(self, mutation):
        """Builds what the mutation's tests run. Returns error text, or nothing."""
        tests = [test for test in mutation.tests if not test.startswith("sources/")]
        if any(file.endswith(("CMakeLists.txt", ".cmake")) for file, _, _ in mutation.edits):
            return self.configure() or (self.ninja(self.base.programs) if tests else None)
        if not tests:
            return None
        scripts = [test for test in tests if has_script(test)]
        compiled = [test for test in tests if test not in scripts]
        if any(test not in self.base.objects_of for test in compiled):
            return self.ninja(self.base.programs)
        objects = sorted(set().union(*(self.base.objects_of[test] for test in compiled)))
        targets = objects + (["pertev"] if scripts else [])
        if self.base.has_python and any(test.startswith("python/") for test in scripts):
            targets.append("python/all")
        problem = self.ninja(targets)
        if problem or not compiled:
            return problem
        compiler, *flags = self.base.link_words
        status, text = self.runner.run([compiler, *objects, *flags, "-o", "bin/pertev_tests"], self.build)
        if status == 0:
            return None
        return self.ninja(["pertev_tests"]) # the mutation calls what the test did not need before
