#!/usr/bin/env python3
"""The JSON of a measurement (src/lab/measurement.h) as scripts write it: what was measured when, where and by which command.

    tools/measurement.py MEASUREMENT.json PERTEV TITLE COMMAND  writes the rows of standard input, whose cells tabulators separate; the
    first row has the columns' keys, titles and units as KEY=TITLE or KEY=TITLE=UNIT
"""

import datetime
import json
import pathlib
import platform
import re
import shlex
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def gpu_of(device):
    """Name and driver of the first GPU, where the device is that or `auto` finds it."""
    if device == "cpu" or device == "auto" and not shutil.which("nvidia-smi"):
        return None, None
    query = ["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"]
    return subprocess.run(query, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()[0].split(", ")


def machine(device):
    """The GPU's name, or the processor's. It ends titles, by which readers tell measurements of several machines apart."""
    return gpu_of(device)[0] or processor()


def own_command():
    script = pathlib.Path(sys.argv[0]).resolve()
    return shlex.join([str(script.relative_to(ROOT) if script.is_relative_to(ROOT) else script.name), *sys.argv[1:]])


def write_measurement(path, program, title, columns, rows, device, threads, notes=(), table="jobs", command=None):
    """Writes a measurement with one table; columns are (key, title, unit)."""
    write_tables(path, program, title, [(table, columns, rows)], device, threads, notes, command)


def write_tables(path, program, title, tables, device, threads, notes=(), command=None):
    """Writes a measurement of tables (name, columns, rows). The command is that of this process unless it is given."""
    version = subprocess.run([program, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()[0]
    name, driver = gpu_of(device)
    measured = {
        "format": "pertev-measurement", "version": 1, "program": version,
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"), "command": command or own_command(),
        "processor": processor(), "threads": threads, "device": name, "driver": driver, "title": title, "notes": list(notes),
        "tables": [{"name": name, "title": title, "columns": [dict(zip(("key", "title", "unit"), column)) for column in columns], "rows": rows}
                   for name, columns, rows in tables],
    }
    pathlib.Path(path).write_text(json.dumps(measured, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def cell_of(text):
    """A number where the text is one."""
    try:
        return json.loads(text) if re.fullmatch(r"-?[\d.]+", text) else text
    except ValueError:
        return text


def main(path, program, title, command):
    head, *rows = [line.split("\t") for line in sys.stdin.read().splitlines()]
    columns = [(*column.split("="), None)[:3] for column in head]
    write_measurement(path, program, title, columns, [[cell_of(cell) for cell in row] for row in rows], "cpu", None, command=command)


if __name__ == "__main__":
    if len(sys.argv) != 5:
        print(__doc__)
        sys.exit(0 if sys.argv[1:] == ["--help"] else 2)
    main(*sys.argv[1:])
