#!/usr/bin/env python3
"""Denoises the samples that `pertev bench sequence --write-samples FOLDER` wrote, one frame after the other, by Intel's
Open Image Denoise in high quality with albedo and normals: frame-0000-denoised.pfm and so on, for --peer FOLDER.

denoise_by_oidn.py FOLDER [PROGRAM [OPTION ...]]

PROGRAM is its `oidnDenoise`, which the package pyoidn of PyPI brings; left out, that of the package is taken. OPTIONs go
to it, as `-d cuda`.
"""

import concurrent.futures
import importlib.util
import os
import pathlib
import subprocess
import sys


def program_of_package():
    spec = importlib.util.find_spec("pyoidn")
    if spec is None:
        sys.exit("no oidnDenoise: name the program, or install pyoidn")
    return str(pathlib.Path(spec.origin).parent / "oidn/bin/oidnDenoise")


def denoise(program, options, color):
    stem = str(color)[:-len(".pfm")]
    done = subprocess.run([program, "--hdr", str(color), "--alb", stem + "-albedo.pfm", "--nrm", stem + "-normal.pfm",
                           "-o", stem + "-denoised.pfm", "-q", "high", *options], capture_output=True, text=True)
    return "" if done.returncode == 0 else f"{color}: {done.stdout}{done.stderr}"


def main(folder, program=None, *options):
    frames = sorted(pathlib.Path(folder).glob("frame-[0-9][0-9][0-9][0-9].pfm"))
    if not frames:
        sys.exit(f"{folder}: no frames")
    program = program or program_of_package()
    with concurrent.futures.ThreadPoolExecutor(min(8, os.cpu_count() or 1)) as pool:
        faults = [fault for fault in pool.map(lambda frame: denoise(program, options, frame), frames) if fault]
    if faults:
        sys.exit("\n".join(faults))
    print(f"{len(frames)} frames")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
