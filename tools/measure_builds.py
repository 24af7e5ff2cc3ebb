#!/usr/bin/env python3
"""Measures what building and testing take: time, core seconds and the size of the build folder.

    tools/measure_builds.py [STEP ...] [--commits COMMIT ...] [-o MEASUREMENT.json]

Each commit (HEAD) is cloned into a new folder and built without a compiler cache. Steps, in this order: `first` is README's first
command up to its picture, `tests` builds the tests besides, `fast` runs those with that label, `lobe` builds and runs the
chi-square tests of lobes after a lobe's header has changed, `cuda` is the first command with --cuda, for one architecture, `ci` is .ci/run; the last
two have clones of their own. Without names the first four are measured. The last column has what other processes took meanwhile, of
all cores, because a figure counts only where that is little.
"""

import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

from measurement import ROOT, write_measurement

PICTURE = "build/bin/pertev render cornell-box -o cornell-box.png"
NEW_CLONE = ("first", "cuda", "ci")
STEPS = {  # title, what is done before, and what is measured
    "first": ("README's first command", "true", f"./setup.sh && {PICTURE}"),
    "tests": ("tests besides, built", "true", "./setup.sh --tests --build-only"),
    "fast": ("`ctest -L fast -j 2`", "true", "ctest --test-dir build -L fast -j 2"),
    "lobe": ("a lobe's chi-square tests after it was edited", "ninja -C build pertev_shading_tests && touch src/shading/lobes/diffuse_lobe.h",
             "ninja -C build pertev_shading_tests && build/bin/pertev_shading_tests --source-file='*bsdf_sampling*'"),
    "cuda": ("the first with `--cuda`", "true", f"./setup.sh --cuda && {PICTURE}"),
    "ci": ("`.ci/run`", "true", ".ci/run"),
}
COLUMNS = [("what", "what", None), ("commit", "commit", None), ("seconds", "time", "s"), ("core_seconds", "core time", "s"),
           ("build_mb", "build folder", "MB"), ("others", "cores of other processes", None)]


def core_seconds():
    """Seconds of cores that ended children of this process have taken, and those of all processes."""
    own = resource.getrusage(resource.RUSAGE_CHILDREN)
    busy = pathlib.Path("/proc/stat").read_text(encoding="utf-8").split("\n", 1)[0].split()
    return own.ru_utime + own.ru_stime, sum(map(int, [*busy[1:4], *busy[6:9]])) / os.sysconf("SC_CLK_TCK")  # without idle, waiting and guests


def measured(command, folder):
    """Returns seconds, core seconds and the cores that others took meanwhile; ends with the command's status if that is not 0."""
    environment = {**os.environ, "CCACHE_DISABLE": "1"}
    start, (own, all_cores) = time.perf_counter(), core_seconds()
    done = subprocess.run(["bash", "-euc", command], cwd=folder, env=environment, stdout=sys.stderr, check=False)
    seconds, (own_end, all_end) = time.perf_counter() - start, core_seconds()
    if done.returncode != 0:
        sys.exit(f"status {done.returncode}: {command}")
    return seconds, own_end - own, max(0, all_end - all_cores - own_end + own) / seconds


def rounded(value):
    return round(value) if value >= 100 else float(f"{value:.3g}")


def megabytes(folder):
    return sum(path.lstat().st_size for path in folder.rglob("*")) / 1e6


def rows_of(commit, steps, work):
    """Yields the rows of a commit, and the program that the last of its clones has built."""
    folder = None
    for step in steps:
        title, before, command = STEPS[step]
        if folder is None or step in NEW_CLONE:
            folder = pathlib.Path(tempfile.mkdtemp(dir=work))
            subprocess.run(["git", "clone", "-q", ROOT, folder], check=True)
            subprocess.run(["git", "-C", folder, "checkout", "-q", commit], check=True)
        measured(before, folder)
        seconds, cores, others = measured(command, folder)
        yield [title, commit, *(rounded(value) for value in (seconds, cores, megabytes(folder / "build"))), round(others, 2)], folder / "build/bin/pertev"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("steps", nargs="*", metavar="STEP", help=", ".join(STEPS))
    parser.add_argument("--commits", nargs="+", default=["HEAD"], metavar="COMMIT")
    parser.add_argument("--work", help="a folder for the clones, which are removed at the end")
    parser.add_argument("-o", "--output", metavar="MEASUREMENT.json")
    given = parser.parse_args()
    steps = given.steps or list(STEPS)[:4]
    if unknown := set(steps) - STEPS.keys():
        parser.error(f"no step is named {', '.join(sorted(unknown))}")
    with tempfile.TemporaryDirectory(dir=given.work) as work:
        rows = []
        for commit in given.commits:
            short = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short=8", commit], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
            for row, program in rows_of(short, steps, work):
                rows.append(row)
                print(*row, sep="\t", flush=True)
        if given.output:
            notes = ["Each commit in a new clone, without a compiler cache.", "Cores of other processes are a mean over the time; figures are those of an idle machine where it is 0."]
            write_measurement(given.output, program, "Times of building and testing", COLUMNS, rows, "cpu", os.cpu_count(), notes)


if __name__ == "__main__":
    main()
