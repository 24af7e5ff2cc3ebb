#!/usr/bin/env python3
"""Measures errors and times of pictures beside references: tools/measure_errors.py PERTEV SCENES SET [-o MEASUREMENT.json] [-- FLAG ...]

SCENES is a folder laid out as docs/scenes.md says, SET one of "errors" in bench/jobs.json: scenes, pictures of each, and the reference, if
it has one. Values are means over --seeds (3). Times are those of rendering and of all cores; the latter hardly depend on what else runs.
`equal` is the core time in which a picture reaches the error of the set's first one, over that one's, as errors of independent samples
fall. Further flags go to all pictures (--device cuda).
"""

import argparse
import json
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile

from measure import OWN, with_flags, words_of
from measurement import machine, write_tables

COLUMNS = [("scene", "scene", None), ("picture", "picture", None), ("rel_mse", "relMSE", None), ("rel_mse_98", "relMSE of the best 98 %", None),
           ("hdr_flip", "HDR-FLIP", None), ("light", "light, more or less", "%"), ("seconds", "rendering", "s"), ("core_seconds", "core time", "s"),
           ("equal", "core time to the first's error, over its own", None)]


def event_of(command, name):
    """Returns the event of that name which a command prints, and its core seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([*map(str, command), "--json"], stdout=subprocess.PIPE, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return next(line for line in lines if line["event"] == name), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Pictures:
    """The pictures of one scene of a set."""

    def __init__(self, program, scene, kind, places, flags):
        self.program, self.kind, self.flags, self.folder = program, kind, flags, pathlib.Path(places["work"])
        self.words = words_of(f"render {scene['file']} {scene.get('line', '')} {kind['line']}", places)

    def render(self, line, seed, path):
        return event_of([self.program, *with_flags(with_flags(self.words, line.split()), self.flags), "--seed", seed, "-o", path], "done")

    def row_of(self, line, seeds, reference):
        """Means of the columns from `rel_mse` to `core_seconds`."""
        rows = []
        for seed in range(1, seeds + 1):
            path = self.folder / "picture.exr"
            done, cores = self.render(line, seed, path)
            errors = [None] * 4
            if reference:
                found, _ = event_of([self.program, "compare", path, reference], "compare")
                light = 100 * (statistics.mean(found["mean_98"]) / statistics.mean(found["reference_mean_98"]) - 1)
                errors = [found["rel_mse"], found["rel_mse_98"], found["hdr_flip"], light]
            rows.append([*errors, done["seconds"], cores])
        return [None if column[0] is None else statistics.mean(column) for column in zip(*rows)]

    def rows(self, seeds):
        """Yields the name of each picture and its values."""
        reference = None
        if "reference" in self.kind:
            reference = self.folder / "reference.exr"
            self.render(self.kind["reference"], 1000, reference)
        first = None
        for picture in self.kind["pictures"]:
            values = self.row_of(picture["line"], seeds, reference)
            cost = values[1] and values[1] * values[5]
            first = first or cost
            yield picture["name"], [*values, cost and cost / first]


def across(value, rows):
    """Returns a table of one value, with a row for each scene and a column for each picture."""
    key, title, unit = COLUMNS[value]
    names = list(dict.fromkeys(row[1] for row in rows))
    scenes = {}
    for row in rows:
        scenes.setdefault(row[0], []).append(row[value])
    return key, [("scene", title, None), *((re.sub(r"\W+", "_", name), name, unit) for name in names)], [[scene, *values] for scene, values in scenes.items()]


def main():
    own = sys.argv[1:]
    flags = own[own.index("--") + 1:] if "--" in own else []
    sets = json.loads((OWN / "bench/jobs.json").read_text(encoding="utf-8"))["errors"]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pertev")
    parser.add_argument("scenes")
    parser.add_argument("set", choices=sets)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("-o", "--output", metavar="MEASUREMENT.json")
    given = parser.parse_args(own[:own.index("--")] if "--" in own else own)
    kind, rows = sets[given.set], []
    with tempfile.TemporaryDirectory() as work:
        places = {"scenes": os.path.abspath(given.scenes), "work": work, "own": OWN}
        for scene in kind["scenes"]:
            file = scene["file"].format(**places)
            if os.path.isabs(file) and not os.path.exists(file):
                print(f"{scene['name']} is left out: {file} is not there", file=sys.stderr)
                continue
            for name, values in Pictures(given.pertev, scene, kind, places, flags).rows(given.seeds):
                rows.append([scene["name"], name, *(None if value is None else float(f"{value:.3g}") for value in values)])
                print(*rows[-1], sep="\t", flush=True)
    used = [column for column in range(len(COLUMNS)) if any(row[column] is not None for row in rows)]
    if given.output:
        notes = [kind["about"], *([f"The reference, whose noise errors include: {kind['reference']}."] if "reference" in kind else []), f"Means of {given.seeds} seeds; {' '.join(with_flags(kind['line'].split(), flags))}."]
        device = dict(zip(flags, flags[1:])).get("--device", "cpu")
        tables = [("errors", [COLUMNS[i] for i in used], [[row[i] for i in used] for row in rows])]
        if "across" in kind:
            tables.append(across([key for key, *_ in COLUMNS].index(kind["across"]), rows))
        write_tables(given.output, given.pertev, f"{kind['title']}, {machine(device)}", tables, device, os.cpu_count(), notes)


if __name__ == "__main__":
    main()
