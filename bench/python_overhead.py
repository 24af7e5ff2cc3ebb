#!/usr/bin/env python3
"""Measures what a call of pertev.render() takes besides the samples: `bench/python_overhead.py PERTEV [--device cuda] [-o FILE.json]`.

Needs the package `pertev` of the same build on PYTHONPATH, and NumPy. A row is a size of the Cornell box, with one sample a pixel: the
time of a call minus that of Session::render in C++, which the call includes, for a new Result, for arrays of the caller (`out`), and for
these with depth and ids. Each is the least of all calls in some seconds, because other processes may run.
"""

import argparse
import pathlib
import sys
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
from late_import import LateImport  # pylint: disable=wrong-import-position
from measurement import write_measurement  # pylint: disable=wrong-import-position

numpy, pertev = LateImport("numpy"), LateImport("pertev")

SIZES = ((1, 1), (64, 64), (128, 128), (320, 240), (640, 480))


def least_overhead(scene, size, seconds, **values):
    end, least = time.perf_counter() + seconds, float("inf")
    while time.perf_counter() < end:
        start = time.perf_counter()
        picture = pertev.render(scene, size=size, spp=1, **values)
        least = min(least, time.perf_counter() - start - picture._first_pixel_seconds)  # pylint: disable=protected-access
    return least


def row_of(scene, size, seconds):
    width, height = size
    color = {"color": numpy.empty((height, width, 3), numpy.float32)}
    layers = {"depth": numpy.empty((height, width), numpy.float32), "ids": numpy.empty((height, width, 3), numpy.uint32)}
    calls = ({}, {"out": color}, {"out": {**color, **layers}, "layers": list(layers)})
    return [f"{width}x{height}", *(float(f"{1e3 * least_overhead(scene, size, seconds, **values):.2g}") for values in calls)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program of the build, whose version the file names")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", type=int, default=2, help="of a CPU")
    parser.add_argument("--seconds", type=float, default=4, help="for each figure")
    parser.add_argument("-o", "--output", help="a file for the measurement")
    parser.add_argument("--note", action="append", default=[], help="what else its reader must know of the machine")
    given = parser.parse_args()
    scene = pertev.load("cornell-box", device=given.device, threads=given.threads)
    rows = [row_of(scene, size, given.seconds) for size in SIZES]
    for row in rows:
        print(*row, sep="\t")
    if given.output:
        columns = [("picture", "picture", None), ("result", "a call adds", "ms"), ("out", "with `out=`", "ms"), ("layers", "with `out=` of depth and ids too", "ms")]
        write_measurement(given.output, given.program, "Overhead of a call from Python", columns, rows, given.device, given.threads,
                          ["The least of all calls in some seconds, with one sample a pixel, minus Session::render.", *given.note])


if __name__ == "__main__":
    main()
