"""Tests the overhead of a call besides its samples, in time and memory."""

import os
import subprocess
import sys
import time
import unittest

import numpy

import pertev

from device_argument import DEVICE

sys.argv.pop(1)


def seconds_of(size, bound, **values):
    """Returns a call's time minus that of Session::render in C++. It is the minimum of many, because other processes may
    run: of all calls in five seconds, or of those until one is within `bound`."""
    scene = pertev.load("cornell-box", device=DEVICE)
    end = time.perf_counter() + 5
    least = 1.0
    while least >= bound and time.perf_counter() < end:
        start = time.perf_counter()
        picture = pertev.render(scene, size=size, spp=1, **values)
        least = min(least, time.perf_counter() - start - picture._first_pixel_seconds)
    return least


def arrays_of(width, height):
    return {"color": numpy.empty((height, width, 3), numpy.float32), "depth": numpy.empty((height, width), numpy.float32),
            "ids": numpy.empty((height, width, 3), numpy.uint32)}


class Time(unittest.TestCase):
    def test_a_picture_takes_less_than_a_millisecond(self):
        self.assertLess(seconds_of((64, 64), 1e-3), 1e-3)

    def test_a_picture_into_given_arrays_takes_less_than_50_microseconds(self):
        for size in ((1, 1), (32, 32)):
            out = {"color": numpy.empty((*size, 3), numpy.float32)}
            self.assertLess(seconds_of(size, 50e-6, out=out), 50e-6)


# Prints, for a call after others, the bytes that it requests of the C library, the largest request, and what Python's
# objects take at most.
ALLOCATIONS = """
import ctypes, os, tracemalloc
import overhead_test, pertev
width, height = {size}
counter = ctypes.CDLL(os.environ["LD_PRELOAD"])
counter.allocated.restype = counter.largest.restype = ctypes.c_size_t
scene = pertev.load("cornell-box", device="cpu", threads=1)
out = {out}
call = lambda: pertev.render(scene, size=(width, height), spp=2, layers=["depth", "ids"], out=out)
for _ in range(3): call()
before = counter.allocated()
counter.largest()
call()
print(counter.allocated() - before, counter.largest())
tracemalloc.start()
call()
before = tracemalloc.get_traced_memory()[0]
tracemalloc.reset_peak()
call()
print(tracemalloc.get_traced_memory()[1] - before)
"""


@unittest.skipUnless(DEVICE == "cpu", "a GPU's driver allocates")
class Memory(unittest.TestCase):
    @staticmethod
    def allocations(size, out="overhead_test.arrays_of(width, height)"):
        environment = {**os.environ, "LD_PRELOAD": os.environ["PERTEV_COUNT_ALLOCATIONS"],
                       "PYTHONPATH": os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), os.environ["PYTHONPATH"]])}
        done = subprocess.run([sys.executable, "-c", ALLOCATIONS.format(size=size, out=out), "program"], env=environment,
                              capture_output=True, text=True, timeout=60)
        return [int(word) for word in done.stdout.split()]

    def test_a_picture_into_given_arrays_allocates_little(self):
        """A call allocates little memory, and no more for a larger picture."""
        small, large = self.allocations((64, 64)), self.allocations((256, 128))
        for of_size in (small, large):
            self.assertEqual(len(of_size), 3)
            allocated, largest, of_python = of_size
            self.assertLess(allocated, 16384)
            self.assertLess(largest, 2048)
            self.assertLess(of_python, 8192)
        self.assertAlmostEqual(small[0], large[0], delta=1024)

    def test_the_allocation_counters_work(self):
        allocated, largest, _ = self.allocations((256, 128), "None")
        self.assertGreater(largest, 256 * 128 * 3 * 4 - 1)
        self.assertGreater(allocated, 256 * 128 * 7 * 4 - 1)


if __name__ == "__main__":
    unittest.main()
