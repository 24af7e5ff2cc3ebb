#!/usr/bin/env python3
"""The test of the tests: breaks the renderer in one known way at a time and sees which tests notice.

The ways are those of tools/mutations.py. Works on a copy of the tree under build-mutations/, which holds only the test
files that they name, with a build folder of its own (with ccache it takes minutes). Each mutation replaces text that
must be there exactly once, so a patch that no longer applies is found; then the tests named for it run, and each of
them must fail. Without a mutation all of them must pass, and that is tried first.

`tools/test_the_tests.py [NAME ...]` runs the mutations of these names only, `--list` names them all, `--check` tells in
a moment whether all of them still apply, and whether tools/check_gpu.sh names tests that exist. Prints a table, and exits 1 when a mutation went unnoticed by a test named for
it, did not apply or did not build.
"""

import argparse
import collections
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

import mutations

Mutation = collections.namedtuple("Mutation", "name tests edits")
MUTATIONS = [Mutation(name, tests.split(), edits) for name, tests, *edits in mutations.MUTATIONS]
ROOT = pathlib.Path(__file__).resolve().parent.parent
WORK = ROOT / "build-mutations"
TREE, BUILD = WORK / "tree", WORK / "tree/build"  # paths like in a checkout, so that ccache finds earlier results
TIMEOUT_S = 300  # for one test; a mutation may make it hang, which counts as noticed


def tracked_files():
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                            check=True, capture_output=True).stdout.decode().split("\0")
    return [name for name in listed if name and (ROOT / name).is_file()]


def test_names(chosen):
    return sorted({test for mutation in chosen for test in mutation.tests})


def wanted(name, tests):
    """All but the test files that no mutation names."""
    return not name.endswith("_test.cpp") or name[len("tests/"):-len("_test.cpp")] in tests


def apply(edits, contents):
    """Makes the edits in `contents`, bytes by name. Returns what does not apply."""
    for file, old, new in edits:
        count = contents.get(file, b"").count(old.encode())
        if count != 1:
            return f"{file} has {count} times: {old}"
        contents[file] = contents[file].replace(old.encode(), new.encode())
    return None


def check_that_all_apply():
    """Exits 1 when one does not."""
    good = True
    for mutation in MUTATIONS:
        files = {file for file, _, _ in mutation.edits if (ROOT / file).is_file()}
        problem = apply(mutation.edits, {file: (ROOT / file).read_bytes() for file in files})
        if problem:
            good = False
            print(f"{mutation.name}: does not apply: {problem}")
    sys.exit(0 if good else 1)


def check_gpu_list():
    """Exits 1 when tools/check_gpu.sh names a test or a file of tests that is not there."""
    sources = {path: path.read_text() for path in (ROOT / "tests").rglob("*_test.cpp")}
    literals = [found for text in sources.values() for found in re.findall(r'TEST_CASE(?:_TEMPLATE)?\(\s*((?:"[^"]*"\s*)+)', text)]
    names = [re.sub(r'"\s*"', "", literal).strip().strip('"') for literal in literals]
    script = (ROOT / "tools/check_gpu.sh").read_text()
    tests = ",".join(re.findall(r"--test-case='([^']+)'", script)).split(",")
    files = ",".join(re.findall(r"files\+?=',?([^']+)'", script)).split(",")
    absent = [pattern for pattern in tests if not fnmatch.filter(names, pattern)]
    absent += [pattern for pattern in files if not fnmatch.filter(map(str, sources), pattern)]
    if absent:
        sys.exit("tools/check_gpu.sh: no test has this name: " + ", ".join(absent))


def write_tree(edits, tests):
    """Brings the copy to the tree's content with `edits` made; files that are right already keep their times. Returns
    what does not apply."""
    contents = {name: (ROOT / name).read_bytes() for name in tracked_files() if wanted(name, tests)}
    problem = apply(edits, contents)
    if problem:
        return problem
    for path in list(TREE.rglob("*")):
        if path.is_file() and BUILD not in path.parents and str(path.relative_to(TREE)) not in contents:
            path.unlink()
    for name, content in contents.items():
        path = TREE / name
        if not path.is_file() or path.read_bytes() != content:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
            shutil.copymode(ROOT / name, path)
    return None


def build(jobs, tests):
    """Error text, or nothing."""
    environment = {**os.environ, "CCACHE_BASEDIR": str(TREE), "CCACHE_NOHASHDIR": "1"}
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    steps = [["cmake", "-G", "Ninja", "-S", TREE, "-B", BUILD, "-DPERTEV_CUDA=OFF", *launcher]]
    if any(not test.startswith("sources/") for test in tests):
        program = ["pertev"] if any((ROOT / f"tests/{test}_test.py").is_file() for test in tests) else []
        steps.append(["cmake", "--build", BUILD, "-j", str(jobs), "--target", "pertev_tests", *program])
    for step in steps:
        done = subprocess.run(step, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if done.returncode != 0:
            return done.stdout.decode(errors="replace")[-2000:]
    return None


def failed_tests(tests):
    """Runs `tests` and returns the ones that fail."""
    report = WORK / "report.xml"
    report.unlink(missing_ok=True)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PERTEV_")}
    pattern = "^(" + "|".join(map(re.escape, tests)) + ")$"
    subprocess.run(["ctest", "--test-dir", BUILD, "-R", pattern, "--timeout", str(TIMEOUT_S), "--output-junit", report],
                   env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    status = {case.get("name"): case.get("status") for case in ElementTree.parse(report).getroot().iter("testcase")}
    missing = [test for test in tests if test not in status]
    if missing:
        sys.exit(f"CTest has no test named {', '.join(missing)}")
    return [test for test in tests if status[test] != "run"]


def try_mutation(mutation, all_tests, jobs):
    """(whether all is well, what to say)"""
    problem = write_tree(mutation.edits, all_tests)
    if problem:
        return False, "does not apply: " + problem
    problem = build(jobs, mutation.tests)
    if problem:
        return False, "does not build:\n" + problem
    failed = failed_tests(mutation.tests)
    blind = [test for test in mutation.tests if test not in failed]
    text = ("noticed by " + ", ".join(failed)) if failed else "noticed by none"
    return not blind, text + ("; NOT by " + ", ".join(blind) if blind else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="mutations to try; all where none is named")
    parser.add_argument("--list", action="store_true", help="name the mutations and the tests that must notice")
    parser.add_argument("--check", action="store_true", help="only see whether all mutations still apply, and the tests that run on a GPU exist")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="compilers at once")
    arguments = parser.parse_args()
    if arguments.check:
        check_gpu_list()
        check_that_all_apply()
    unknown = set(arguments.names) - {mutation.name for mutation in MUTATIONS}
    if unknown:
        sys.exit(f"no mutation is named {', '.join(map(repr, sorted(unknown)))}; --list names them")
    chosen = [m for m in MUTATIONS if not arguments.names or m.name in arguments.names]
    if arguments.list:
        for mutation in chosen:
            print(f"{mutation.name}: {', '.join(mutation.tests)}")
        return

    all_tests, tests = test_names(MUTATIONS), test_names(chosen)
    write_tree([], all_tests)
    problem = build(arguments.jobs, tests)
    if problem:
        sys.exit("the tree does not build without a mutation:\n" + problem)
    failed = failed_tests(tests)
    if failed:
        sys.exit("these tests fail without a mutation: " + ", ".join(failed))

    good = True
    width = max(len(mutation.name) for mutation in chosen)
    for mutation in chosen:
        start = time.monotonic()
        ok, text = try_mutation(mutation, all_tests, arguments.jobs)
        good &= ok
        print(f"{'ok    ' if ok else 'FAILED'} {mutation.name:{width}}  {text}  [{time.monotonic() - start:.0f} s]",
              flush=True)
    write_tree([], all_tests)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
