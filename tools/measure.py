#!/usr/bin/env python3
"""Runs jobs of bench/jobs.json, keeps each measurement as JSON, and makes one page of all:
tools/measure.py PERTEV SCENES OUT PART... [--count RAYS] [-- FLAG ...]

SCENES is a folder laid out as docs/scenes.md says, OUT one for files. Parts are those of bench/jobs.json (noise, transport,
lab, peers, profile, moving, still, start, record), or PART/JOB for one job; further flags go to each command (--device cuda). Jobs
whose scene is missing are left out. Prints the main figures as a table in Markdown.
"""

import argparse
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

from measurement import write_measurement

OWN = pathlib.Path(__file__).resolve().parent.parent
SECONDS = [("job", "job", None), ("median_s", "median", "s"), ("least_s", "least", "s"), ("greatest_s", "greatest", "s")]


def make_scenes(scenes, work):
    """Scenes and the sky that jobs name by {work}."""
    def run(*command, output=None):
        done = subprocess.run([sys.executable, *command], stdout=subprocess.PIPE if output else None, check=True)
        if output:
            output.write_bytes(done.stdout)

    run(OWN / "tools/make_sky.py", work / "sky.exr")
    run(OWN / "tools/make_moving_box.py", work / "box.gltf")
    run(OWN / "tools/make_moving_box.py", work / "mirror_box.gltf", "--mirror")
    run(OWN / "tools/make_crossing_box.py", work / "crossing.gltf")
    run(OWN / "tools/make_glass_room.py", work / "room.obj")
    run(OWN / "tools/make_glass_room.py", work / "nested.obj", "--nested")
    veach, box = (scenes / f"bitterli/{name}/scene_mitsuba3.xml" for name in ("veach-mis", "cornell-box"))
    if veach.exists():
        run(OWN / "tools/make_veach_mis.py", veach, work / "veach-mis.obj")
    if box.exists():
        run(OWN / "tests/images/mitsuba_to_gltf.py", box, output=work / "bitterli.gltf")


def words_of(line, places):
    return [word.format(**places) for word in shlex.split(line)]


def with_flags(words, flags):
    """The job's words; further flags take the place of its own of the same name."""
    named = {flag.partition("=")[0] for flag in flags if flag.startswith("--")}
    kept, is_dropped = [], False
    for word in words:
        is_flag = word.startswith("-") and not word.lstrip("-")[:1].isdigit()
        is_dropped = word.partition("=")[0] in named if is_flag else is_dropped
        if not is_dropped:
            kept.append(word)
    return [*kept, *flags]


def time_processes(command, count):
    """The median, the least and the most seconds of whole processes, after one that is not timed."""
    seconds = []
    for _ in range(count + 1):
        begin = time.perf_counter()
        subprocess.run(command, check=True)
        seconds.append(time.perf_counter() - begin)
    return [statistics.median(seconds[1:]), min(seconds[1:]), max(seconds[1:])]


def rows_of(path):
    """The rows of the last table of a measurement, as dictionaries."""
    table = json.loads(path.read_text(encoding="utf-8"))["tables"][-1]
    return [dict(zip([column["key"] for column in table["columns"]], row)) for row in table["rows"]]


def run_job(job, part, given, places, flags):
    """Rows to show; none where its scene is missing."""
    places = {**places, **job, "file": job.get("file", "").format(**places)}
    if os.path.isabs(places["file"]) and not os.path.exists(places["file"]):
        print(f"{job['name']} is left out: {places['file']} is not there", file=sys.stderr)
        return []
    command = [given.pertev, *with_flags(words_of(job["line"], places), flags)]
    report = pathlib.Path(given.out, job["name"].replace(" ", "-") + ".json")
    if "processes" in job:
        row = [job["name"], *time_processes(command, job["processes"])]
        write_measurement(report, given.pertev, part["about"], SECONDS, [row], dict(zip(flags, flags[1:])).get("--device", "auto"), os.cpu_count(), [shlex.join(command[1:])])
        return [dict(zip([key for key, *_ in SECONDS][1:], row[1:]))]
    if "prefix" in part:
        with open(report.with_suffix(".csv"), "w", encoding="utf-8") as output:
            subprocess.run([*words_of(part["prefix"], places), *command], stdout=output, check=True)
        return []
    subprocess.run([*command, *([] if "-o" in command else ["-q", "--report", report])], check=True)
    return rows_of(report) if "columns" in part else []


def main():
    own = sys.argv[1:]
    flags = own[own.index("--") + 1:] if "--" in own else []
    parts = json.loads((OWN / "bench/jobs.json").read_text(encoding="utf-8"))["parts"]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("pertev", "scenes", "out"):
        parser.add_argument(name)
    parser.add_argument("parts", nargs="+", metavar="part", help=", ".join(parts))
    parser.add_argument("--count", default="8294400", help="rays of a set of the record")
    given = parser.parse_args(own[:own.index("--")] if "--" in own else own)
    given.out = os.path.abspath(given.out)
    os.makedirs(given.out, exist_ok=True)
    os.environ["PERTEV_SCENES"] = os.path.abspath(given.scenes)
    failed = 0
    with tempfile.TemporaryDirectory() as work:
        places = {"scenes": os.environ["PERTEV_SCENES"], "work": work, "own": OWN, "out": given.out, "count": given.count}
        make_scenes(pathlib.Path(places["scenes"]), pathlib.Path(work))
        for name in given.parts:
            part, _, only = name.partition("/")
            part, columns = parts[part], None
            for job in part["jobs"]:
                if only and job["name"] != only:
                    continue
                try:
                    rows = run_job(job, part, given, places, flags)
                except (subprocess.CalledProcessError, OSError) as error:
                    print(f"{job['name']}: {error}", file=sys.stderr)
                    failed += 1
                    continue
                for row in rows:
                    if columns is None:
                        columns = part.get("columns", list(row))
                        print("| job | " + " | ".join(columns) + " |\n| --- |" + " ---: |" * len(columns))
                    cells = [f"{row[key]:.4g}" if isinstance(row[key], float) else str(row[key]) for key in columns]
                    print(f"| {job['name']} | " + " | ".join(cells) + " |", flush=True)
    patterns = ("*.json", "*/report.json", "*/thesis.json")
    reports = sorted(str(path) for pattern in patterns for path in pathlib.Path(given.out).glob(pattern))
    if reports:
        subprocess.run([given.pertev, "bench", "page", *reports, "-o", os.path.join(given.out, "page.html")], check=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
