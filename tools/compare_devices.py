#!/usr/bin/env python3
"""Compares pictures, frames and measured light of the devices of bench/jobs.json, by hashes and to the last digit:
tools/compare_devices.py PERTEV SCENES [SPP ...] [--only NAME ...] [--report MEASUREMENT.json]

SCENES is a folder laid out as docs/scenes.md says. Pictures are rendered with each number of samples (4). With --devices A B other
devices than cpu and cuda are compared. Exits 1 when one differs, or cannot be made.
"""

import argparse
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from measure import OWN, make_scenes, words_of
from measurement import write_measurement


def result_of(command, event, keys):
    """Returns what the lines of an event say under the keys, or None if there is no such line."""
    done = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    lines = [json.loads(line) for line in done.stdout.splitlines() if b'"event":"%s"' % event.encode() in line]
    said = [[line[key] for key in keys if line.get(key) is not None] for line in lines]
    if done.returncode != 0 or not said or not all(said):
        return None
    return "+".join(said[0]) if len(said) == 1 and all(isinstance(one, str) for one in said[0]) else hashlib.md5(json.dumps(said).encode()).hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("pertev")
    parser.add_argument("scenes")
    parser.add_argument("samples", nargs="*", type=int, default=[4])
    parser.add_argument("--only", nargs="+", metavar="NAME")
    parser.add_argument("--devices", nargs=2, default=["cpu", "cuda"])
    parser.add_argument("--report", metavar="MEASUREMENT.json", help="a file for the hashes")
    given, rows = parser.parse_args(), []
    kinds = json.loads((OWN / "bench/jobs.json").read_text(encoding="utf-8"))["devices"]
    with tempfile.TemporaryDirectory() as work:
        places = {"scenes": os.path.abspath(given.scenes), "work": work, "own": OWN, "out": f"{work}/picture"}
        make_scenes(pathlib.Path(given.scenes), pathlib.Path(work))
        for what, kind in kinds.items():
            for spp in given.samples if "{spp}" in kind["line"] else [None]:
                for job in kind["jobs"]:
                    if given.only and job["name"] not in given.only:
                        continue
                    words = words_of(f"{job['line']} {kind['line']}", {**places, "spp": spp})
                    found = [result_of([given.pertev, *words, "--json", "--device", device], kind["event"], kind["keys"]) for device in given.devices]
                    is_same = found[0] is not None and found[0] == found[1]
                    rows.append([job["name"], what if spp is None else f"{spp} spp", *found, "yes" if is_same else "no"])
                    print(f"{job['name']:24} {what if spp is None else f'{spp} spp':9} ", "  ".join(f"{device} {one or 'failed'}" for device, one in
                          zip(given.devices, found)), " same" if is_same else " DIFFERENT", flush=True)
    if given.report:
        columns = [("picture", "picture", None), ("samples", "samples, or what else is compared", None),
                   *((f"hash_{number}", device, None) for number, device in enumerate(given.devices)), ("is_same", "same", None)]
        device = "cuda" if any(name.startswith("cuda") for name in given.devices) else "cpu"
        write_measurement(given.report, given.pertev, "Hashes by device", columns, rows, device, os.cpu_count(),
                          ["A hash of what is not one picture is that of the printed values."], "hashes")
    sys.exit(1 if any(row[-1] == "no" for row in rows) else 0)


if __name__ == "__main__":
    main()
