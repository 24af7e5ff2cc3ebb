"""Parts of the benches against other renderers: grey geometry, runs of Pertev, and the file of a measurement."""

import datetime
import json
import pathlib
import platform
import re
import subprocess
import sys


def write_grey_obj(source, target, grey):
    """Positions and faces of an OBJ alone, with one diffuse material of that reflectance beside it."""
    kept = [line for line in source.read_text().splitlines() if line[:2] in ("v ", "f ")]
    faces = [re.sub(r"/\S*", "", line) for line in kept]
    target.with_suffix(".mtl").write_text(f"newmtl grey\nKd {grey} {grey} {grey}\n")
    target.write_text("\n".join([f"mtllib {target.stem}.mtl", "usemtl grey", *faces, ""]))


def run_pertev(program, arguments):
    """The event with which a render or a job of `pertev bench` ends, without reading and trees in its seconds."""
    done = subprocess.run([str(word) for word in (program, *arguments, "--json")], stdout=subprocess.PIPE, check=True)
    for line in done.stdout.splitlines():
        values = json.loads(line)
        if values["event"] in ("job", "done"):
            return values
    sys.exit("no line of the event job or done")


def seconds_of(event):
    return event.get("render_seconds", event.get("seconds"))


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def gpu():
    """Name and driver of the first GPU."""
    query = ["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"]
    return subprocess.run(query, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()[0].split(", ")


def write_measurement(path, program, title, threads, on_gpu, notes, columns, rows):
    """A `pertev-measurement` of one table, `jobs`; columns are (key, title, unit)."""
    version = subprocess.run([program, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()[0]
    device, driver = gpu() if on_gpu else (None, None)
    measured = {
        "format": "pertev-measurement", "version": 1, "program": version,
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "command": " ".join([f"bench/{pathlib.Path(sys.argv[0]).name}", *sys.argv[1:]]),
        "processor": processor(), "threads": threads, "device": device, "driver": driver, "title": title, "notes": notes,
        "tables": [{"name": "jobs", "title": title,
                    "columns": [dict(zip(("key", "title", "unit"), column)) for column in columns], "rows": rows}],
    }
    path.write_text(json.dumps(measured, indent=1) + "\n")
