#!/usr/bin/env python3
"""Compiles headers by themselves, so that each can be included first and, where it has device code, by any compiler.

The first --cxx compiles each header but those that their own .cpp includes first: after nothing but headers that it
includes itself, at once or through others. So a file that includes base/box.h and then scene/scene.h, which includes
base/box.h, shows both to be complete. Host-device headers (those that say HD) are compiled by every other --cxx and by
--nvcc too, gathered into one generated file. `--self-test` feeds the check headers that must fail.
"""

import argparse
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HOST_FLAGS = ["-x", "c++", "-std=c++20", "-fsyntax-only", "-ffp-contract=off", "-march=x86-64-v3", "-Wall", "-Wextra",
              "-Wpedantic", "-Wshadow", "-Wdouble-promotion", "-Wfloat-conversion", "-Werror"]
NVCC_FLAGS = ["-x", "cu", "-std=c++20", "-ptx", "-arch=compute_90", "--expt-relaxed-constexpr", "-fmad=false",
              "-Werror=all-warnings", "-o", os.devnull]
FIRST_INCLUDE = re.compile(r'^#include [<"](.*?)[>"]', re.MULTILINE)
OWN_INCLUDE = re.compile(r'^#include "(.*?)"', re.MULTILINE)
HOST_DEVICE = re.compile(r"^\s*(template\s*<.*>\s*)?(\[\[\w+\]\]\s*)?(constexpr\s+|static\s+)*HD\b", re.MULTILINE)


def compile_includes(command, headers, source):
    """The compiler's complaint about a file that includes `headers`; empty where there is none."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / ("gathered.cu" if "cu" in command else "alone.cpp")
        file.write_text("".join(f'#include "{h}"\n' for h in headers))
        run = subprocess.run([*command, f"-I{source}", str(file)], capture_output=True, text=True)
        return "" if run.returncode == 0 else run.stderr + run.stdout


def built_alone(header, source):
    """Does the header's own .cpp include it first?"""
    own = (source / header).with_suffix(".cpp")
    first = own.exists() and FIRST_INCLUDE.search(own.read_text(encoding="utf-8"))
    return bool(first) and first.group(1) == header.as_posix()


def closures(headers, source):
    """All that each header includes, at once or through others, of our own."""
    known = {}

    def of(header):
        if header not in known:
            known[header] = set()  # where headers include each other in a circle
            for name in map(pathlib.Path, OWN_INCLUDE.findall((source / header).read_text(encoding="utf-8"))):
                if (source / name).exists():
                    known[header] |= {name} | of(name)
        return known[header]

    return {h: of(h) for h in headers}


def chains(headers, source):
    """The headers in as few lists as can be, in which each includes all that come before it (a largest matching of
    headers with ones that they include, by augmenting paths; Fulkerson 1956)."""
    included = closures(headers, source)
    below = {h: [other for other in headers if other != h and other in included[h]] for h in headers}
    next_of = {}  # a header, and that which comes after it in its list

    def find_before(header, seen):
        for other in below[header]:
            if other not in seen:
                seen.add(other)
                if other not in next_of or find_before(next_of[other], seen):
                    next_of[other] = header
                    return True
        return False

    for header in headers:
        find_before(header, set())
    followed = set(next_of.values())
    for first in (h for h in headers if h not in followed):
        chain = [first]
        while chain[-1] in next_of:
            chain.append(next_of[chain[-1]])
        yield chain


def jobs_for(source, compilers, nvcc, folders):
    """(what it is, command, headers) for each compilation."""
    headers = [h.relative_to(source) for h in sorted(source.rglob("*.h")) if "cuda" not in h.parts]
    host_device = [h for h in headers if HOST_DEVICE.search((source / h).read_text(encoding="utf-8"))]
    includes = [f"-I{folder}" for folder in folders]
    others = [[c, *HOST_FLAGS, *includes] for c in compilers[1:]] + ([[nvcc, *NVCC_FLAGS, *includes]] if nvcc else [])
    for command in others:
        yield f"host-device headers by {command[0]}", command, host_device
    for chain in chains([h for h in headers if not built_alone(h, source)], source):
        yield f"{', '.join(map(str, chain))} by {compilers[0]}", [compilers[0], *HOST_FLAGS, *includes], chain


def check(source, compilers, nvcc, threads, folders=()):
    jobs = list(jobs_for(source, compilers, nvcc, folders))
    with concurrent.futures.ThreadPoolExecutor(threads) as pool:
        complaints = list(pool.map(lambda job: compile_includes(job[1], job[2], source), jobs))
    return [f"{what}:\n{text}" for (what, _, _), text in zip(jobs, complaints) if text], len(jobs)


GOOD = '#pragma once\n#include "base/host_device.h"\n'
BAD_HEADERS = {  # each compiles for somebody, and must fail for the compiler named
    "cxx": "#pragma once\nHD inline int f(Vec3 v) { return 0; }\n",
    "nvcc": GOOD + "inline int on_host(int x) { return x; }\nHD inline int f(int x) { return on_host(x); }\n",
}


def self_test(compilers, nvcc):
    failures = 0
    for who, text in BAD_HEADERS.items():
        if who == "nvcc" and not nvcc:
            continue
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder)
            (source / "base").mkdir()
            shutil.copy(ROOT / "src/base/host_device.h", source / "base/host_device.h")
            (source / "base/good.h").write_text(GOOD + "HD inline int g(int x) { return x; }\n")
            (source / "base/bad.h").write_text(text)
            (source / "base/bad.cpp").write_text('#include "base/good.h"\n#include "base/bad.h"\n')  # not first
            faults, _ = check(source, compilers, nvcc, 1)
            expected = len(compilers) + (1 if nvcc else 0) if who == "cxx" else 1
            if len(faults) != expected:
                failures += 1
                print(f"bad for {who}: {len(faults)} complaints, expected {expected}\n" + "\n".join(faults))
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cxx", action="append", required=True, help="host compiler; may be repeated")
    parser.add_argument("--nvcc", help="CUDA compiler")
    parser.add_argument("--include", action="append", help="folder of headers that the build writes (build*/generated)")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--self-test", action="store_true")
    args = parser.parse_args()
    absent = [c for c in args.cxx if not shutil.which(c)]
    for compiler in absent:
        print(f"skipped: {compiler} is not here, so no header was compiled with it")
    compilers = [c for c in args.cxx if c not in absent]
    if args.self_test:
        sys.exit(1 if self_test(compilers, args.nvcc) else 0)
    folders = args.include or sorted(ROOT.glob("build*/generated"))
    faults, count = check(ROOT / "src", compilers, args.nvcc, args.jobs, folders)
    print("\n".join(faults) or f"{count} compilations, no complaint")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
