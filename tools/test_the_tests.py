#!/usr/bin/env python3
"""The test of the tests: breaks the renderer in one known way at a time and sees which tests notice.

The ways are those of tools/mutations.py. Each mutation replaces text that must be there exactly once, so a patch that no
longer applies is found; then the tests named for it run, and each of them must fail. Without a mutation all of them must
pass, which is tried as well. The tree is built once, without a mutation and with the named test files alone; mutations are
built in copies of it (tools/mutation_trees.py), N at once. Those that take long begin first.

`tools/test_the_tests.py [NAME ...]` runs the mutations of these names only, `--list` names them all, `--check` tells in a
moment whether all of them still apply, and whether tools/check_gpu.sh names tests that exist. Prints a row for each as it
ends, and exits 1 unless every mutation was noticed by all tests named for it.

Runs of several days or machines make one: `--shard I/N` takes every Nth mutation from the Ith on, and `--results FILE` appends a
line for each that was tried, with its commit. A later run with that file skips those noticed before whose text, files and tests
have the same bytes. bench/results/mutations.jsonl is such a file, of the latest runs.
"""

import argparse
import collections
import concurrent.futures
import fnmatch
import hashlib
import itertools
import json
import os
import pathlib
import queue
import re
import shutil
import subprocess
import sys
import threading
import time

import mutations
from mutation_trees import ROOT, Base, Copy, OutOfTime, Runner, apply

Mutation = collections.namedtuple("Mutation", "name tests edits")
MUTATIONS = [Mutation(name, tests.split(), edits) for name, tests, *edits in mutations.MUTATIONS]
LIMIT_S = 300  # for one test; a mutation may make it hang, which counts as noticed
TEST_S = 15  # about what a test and its linking take, beside the time of compilers


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


def files_of(test):
    """Files of a test's own; a check of the sources is a tool."""
    if test.startswith("sources/"):
        return [ROOT / f"tools/check_{test.removeprefix('sources/')}.py"]
    return [ROOT / f"tests/{test}_test{suffix}" for suffix in (".cpp", ".py")]


def digest_of(mutation):
    """The hash of its text, and of the files that it edits and the tests that must notice it."""
    paths = [ROOT / file for file, _, _ in mutation.edits] + [path for test in mutation.tests for path in files_of(test)]
    texts = [path.read_bytes().hex() if path.is_file() else "" for path in paths]
    return hashlib.sha256(json.dumps([*mutation, texts]).encode()).hexdigest()


class Results:
    """Rows of this run and earlier ones, a JSON object a line in a file; the last line of a mutation counts."""

    def __init__(self, path):
        self.path, self.rows = path, {}
        self.commit = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, check=False, capture_output=True, text=True).stdout.strip()
        if path and path.is_file():
            self.rows = {row["name"]: row for row in map(json.loads, path.read_text().splitlines())}

    def counts(self, mutation):
        row = self.rows.get(mutation.name, {})
        return row.get("state") == "noticed" and row["digest"] == digest_of(mutation)

    def add(self, mutation, row):
        if self.path:
            kept = {"name": mutation.name, "digest": digest_of(mutation), "commit": self.commit}
            kept |= {key: row[key] for key in ("state", "noticed_by", "unnoticed_by", "reason", "seconds") if row.get(key)}
            self.rows[mutation.name] = kept
            with self.path.open("a") as file:
                file.write(json.dumps(kept) + "\n")

    def summary(self):
        commits = collections.Counter(self.rows[m.name]["commit"] for m in MUTATIONS if self.counts(m))
        return f"{commits.total()} of {len(MUTATIONS)} mutations are noticed and unchanged since; by commit: {dict(commits)}"


class Report:
    """Rows as they come, on the screen and in files."""

    def __init__(self, chosen, path, results):
        self.chosen, self.path, self.results, self.begin, self.lock = chosen, path, results, time.monotonic(), threading.Lock()
        self.passes = {}  # tests without a mutation: whether they pass
        self.rows = {mutation.name: {"tests": mutation.tests, "state": "not run"} for mutation in chosen}
        self.unprinted = []
        self.width = max(len(mutation.name) for mutation in chosen)

    def add(self, mutation, row):
        with self.lock:
            self.rows[mutation.name].update(row)
            self.unprinted.append(mutation)
            self.settle()

    def add_unmutated(self, test, passes, output):
        with self.lock:
            self.passes[test] = passes
            if not passes:
                print(f"       without a mutation fails or does not run: {test}\n{output}", flush=True)
            self.settle()

    def settle(self):
        """Prints rows whose tests have all run without a mutation."""
        for mutation in [m for m in self.unprinted if all(test in self.passes for test in m.tests)]:
            self.unprinted.remove(mutation)
            row = self.rows[mutation.name]
            bad = [test for test in mutation.tests if not self.passes[test]]
            if bad and row["state"] in ("noticed", "unnoticed"):
                row |= {"state": "cannot be tried", "reason": "without a mutation fails or does not run: " + ", ".join(bad)}
            self.print_row(mutation.name, row)
            self.results.add(mutation, row)
        self.write()

    def print_row(self, name, row):
        text = row["state"]
        if row.get("noticed_by"):
            text = "noticed by " + ", ".join(row["noticed_by"])
        if row.get("unnoticed_by"):
            text += "; NOT by " + ", ".join(row["unnoticed_by"])
        if row.get("reason"):
            text += ": " + row["reason"]
        print(f"{'ok    ' if row['state'] == 'noticed' else 'FAILED'} {name:{self.width}}  {text}  [{row.get('seconds', 0):.0f} s]", flush=True)

    def write(self):
        if self.path:
            counts = collections.Counter(row["state"] for row in self.rows.values())
            text = json.dumps({"seconds": round(time.monotonic() - self.begin), "counts": counts,
                               "fail_without_a_mutation": [test for test, passes in self.passes.items() if not passes],
                               "rows": self.rows}, indent=1)
            temporary = self.path.with_name(self.path.name + ".new")
            temporary.write_text(text + "\n")
            temporary.replace(self.path)

    def finish(self):
        """Returns whether all is well."""
        for mutation in self.unprinted:  # whether their tests pass without it is not known
            row = self.rows[mutation.name]
            row["reason"] = "its tests were not run without a mutation; with it: " + row["state"]
            row["state"] = "not run"
            self.print_row(mutation.name, row)
        untried = [name for name, row in self.rows.items() if row["state"] == "not run" and "reason" not in row]
        for name in untried:
            print(f"NOT RUN {name}", flush=True)
        self.write()
        print(f"{dict(collections.Counter(row['state'] for row in self.rows.values()))} in {time.monotonic() - self.begin:.0f} s")
        return all(row["state"] == "noticed" for row in self.rows.values())


def try_mutation(copy, mutation, limits):
    """The row of its report."""
    begin = time.monotonic()
    copy.bring()
    problem = copy.mutate(mutation.edits)
    if problem:
        return {"state": "does not apply", "reason": problem}
    problem = copy.make(mutation)
    built = time.monotonic()
    if problem:
        return {"state": "does not build", "reason": problem[-2000:]}
    found = copy.run_tests(mutation.tests, limits)
    passed = [test for test in mutation.tests if found.get(test, ("",))[0] == "run"]
    failed = [test for test in mutation.tests if found.get(test, ("",))[0] in ("fail", "timeout")]
    return {"state": "noticed" if len(failed) == len(mutation.tests) else "unnoticed", "noticed_by": failed, "unnoticed_by": passed,
            "timeouts": [test for test in failed if found[test][0] == "timeout"], "seconds": round(time.monotonic() - begin, 1),
            "build_seconds": round(built - begin, 1), "output": {test: found[test][2] for test in failed}}


def try_all(chosen, base, report, parallel):
    """Tries the mutations and, among them, the tests without one; what takes long first, and nothing for which no time is left."""
    seconds = {mutation.name: base.compile_seconds(mutation) for mutation in chosen}
    jobs = sorted(chosen, key=lambda mutation: seconds[mutation.name])
    left = base.runner.left() * parallel - TEST_S * sum(len(mutation.tests) for mutation in chosen)
    while sum(seconds[mutation.name] for mutation in jobs) > left and jobs:
        mutation = jobs.pop()
        report.rows[mutation.name]["compile_seconds"] = round(seconds[mutation.name])
        left += TEST_S * len(mutation.tests)
    longest = jobs[::-1]
    unmutated = [Mutation("", [test], []) for test in sorted({test for mutation in jobs for test in mutation.tests} - report.passes.keys())]
    cut = min(sum(seconds[mutation.name] > 60 for mutation in longest), parallel // 2)  # half of the workers, which compile for long
    waiting = queue.SimpleQueue()
    for job in longest[:cut] + unmutated + longest[cut:]:
        waiting.put(job)
    durations = {}

    def limits(test):  # many run at once
        return min(LIMIT_S, round(60 + 10 * durations[test])) if test in durations else LIMIT_S

    def work(number):
        mine = set(itertools.islice(itertools.cycle(cores), 2 * number, 2 * number + 2))
        copy = Copy(base.path.with_name(f"tree{number + 1:03}"), base, mine)
        try:
            while not waiting.empty():
                job = waiting.get_nowait()
                row = try_mutation(copy, job, limits)
                if not job.name and row.get("noticed_by"):  # perhaps because much else runs
                    row = try_mutation(copy, job, limits)
                if job.name:
                    report.add(job, row | {"compile_seconds": round(seconds[job.name])})
                else:
                    durations[job.tests[0]] = row.get("seconds", 0)
                    report.add_unmutated(job.tests[0], row.get("unnoticed_by") == job.tests, row.get("reason") or str(row.get("output", "skipped")))
        except (OutOfTime, queue.Empty):
            pass
        finally:
            shutil.rmtree(copy.path, ignore_errors=True)

    cores = sorted(os.sched_getaffinity(0))
    with concurrent.futures.ThreadPoolExecutor(parallel) as pool:
        for done in [pool.submit(work, number) for number in range(min(parallel, waiting.qsize()))]:
            done.result()


def find_objects(base, tests, parallel):
    with concurrent.futures.ThreadPoolExecutor(parallel) as pool:
        for done in [pool.submit(base.find_objects, test) for test in tests]:
            done.result()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="mutations to try; all where none is named")
    parser.add_argument("--list", action="store_true", help="name the mutations and the tests that must notice")
    parser.add_argument("--check", action="store_true", help="only see whether all mutations still apply, and the tests that run on a GPU exist")
    parser.add_argument("--parallel", type=int, default=os.cpu_count(), help="mutations, and compilers, at once")
    parser.add_argument("--time-limit", type=float, default=500000, help="seconds for all of it, after which the rest is listed as not run")
    parser.add_argument("--json", type=pathlib.Path, help="write the rows to this file too, as they come")
    parser.add_argument("--shard", metavar="I/N", default="1/1", help="try every Nth mutation, from the Ith on, 1 to N")
    parser.add_argument("--results", type=pathlib.Path, metavar="FILE", help="append rows to this file; skip those that it has and that count")
    parser.add_argument("--assume-passing", action="store_true", help="do not run the tests without a mutation: they are known to pass")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build-mutations", help="folder for the trees, e.g. one in /dev/shm")
    parser.add_argument("--setting", action="append", default=[], help="another setting for CMake, e.g. CMAKE_CXX_FLAGS_RELEASE=-O1")
    arguments = parser.parse_args()
    if arguments.check:
        check_gpu_list()
        check_that_all_apply()
    unknown = set(arguments.names) - {mutation.name for mutation in MUTATIONS}
    if unknown:
        sys.exit(f"no mutation is named {', '.join(map(repr, sorted(unknown)))}; --list names them")
    shard = re.fullmatch(r"(\d+)/(\d+)", arguments.shard)
    if not shard or not 1 <= int(shard[1]) <= int(shard[2]):
        sys.exit(f"--shard {arguments.shard}: expected I/N with I from 1 to N")
    results = Results(arguments.results)
    chosen = [m for m in MUTATIONS if not arguments.names or m.name in arguments.names]
    chosen = [m for m in chosen[int(shard[1]) - 1::int(shard[2])] if not results.counts(m)]
    if arguments.list:
        for mutation in chosen:
            print(f"{mutation.name}: {', '.join(mutation.tests)}")
        return
    if not chosen:
        print(results.summary())
        return

    deadline = time.monotonic() + arguments.time_limit
    work = arguments.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    runner = Runner(work, arguments.parallel, deadline)
    report = Report(chosen, arguments.json, results)
    tests = sorted({test for mutation in chosen for test in mutation.tests})
    if arguments.assume_passing:
        report.passes = dict.fromkeys(tests, True)
    base = Base(work / "tree000", runner, tests)
    try:
        problem = base.make([f"-D{setting}" for setting in arguments.setting])
        if problem:
            sys.exit("the tree does not build without a mutation:\n" + problem[-4000:])
        base.read_build()
        find_objects(base, [test for test in tests if not test.startswith("sources/")], arguments.parallel)
        base.list_files()
        print(f"built without a mutation in {time.monotonic() - report.begin:.0f} s", flush=True)
        try_all(chosen, base, report, arguments.parallel)
    except OutOfTime:
        print("no time was left to build without a mutation")
    finally:
        runner.close()
    all_is_well = report.finish()
    if arguments.results:
        print(results.summary())
    sys.exit(0 if all_is_well else 1)


if __name__ == "__main__":
    main()
