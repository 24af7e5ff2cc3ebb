#!/usr/bin/env python3
"""Writes what tests print as a measurement: tools/measure_tests.py TESTS FILE [-o MEASUREMENT.json] [-- FLAG ...]

TESTS is build/bin/pertev_tests, FILE the test file, as '*frame_bias_test.cpp'. A message "NAME, NAME: KEY VALUE, KEY VALUE" is a row, and
rows with the same keys are a table. Further flags go to the tests (--device cuda).
"""

import argparse
import pathlib
import re
import subprocess
import sys

from measurement import write_tables

MESSAGE = re.compile(r"MESSAGE: (.*?): (.* -?[\d.e+-]+)$")


def cells_of(name):
    """The names of a row, with numbers as such."""
    return [float(cell) if re.fullmatch(r"-?[\d.]+", cell) else cell for cell in name.split(", ")]


def key_of(title):
    return re.sub(r"\W+", "_", title)


def tables_of(output, titles):
    """Tables as (name, columns, rows) of the messages in what doctest prints. Titles are those of the names."""
    found = {}
    for line in output.splitlines():
        if match := MESSAGE.search(line):
            names, values = cells_of(match[1]), [pair.rpartition(" ") for pair in match[2].split(", ")]
            row = [*names, *(float(f"{float(value):.3g}") for _, _, value in values)]
            found.setdefault((len(names), *(key for key, _, _ in values)), []).append(row)
    for (count, *keys), rows in found.items():
        yield key_of(keys[0]), [(key_of(title), title, None) for title in (*titles[:count], *keys)], rows


def main():
    own = sys.argv[1:]
    flags = own[own.index("--") + 1:] if "--" in own else []
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tests", type=pathlib.Path)
    parser.add_argument("file")
    parser.add_argument("--titles", nargs="+", default=["name", "part"], help="heads of the columns of names")
    parser.add_argument("-o", "--output", metavar="MEASUREMENT.json")
    given = parser.parse_args(own[:own.index("--")] if "--" in own else own)
    done = subprocess.run([given.tests, f"--source-file={given.file}", *flags], stdout=subprocess.PIPE, text=True, check=True)
    tables = list(tables_of(done.stdout, given.titles))
    for _, columns, rows in tables:
        print(*(title for _, title, _ in columns), sep="\t")
        for row in rows:
            print(*row, sep="\t")
    if not tables:
        sys.exit("the tests print no rows")
    if given.output:
        title = (pathlib.Path(given.file).name.removeprefix("*").removesuffix("_test.cpp").replace("_", " ")).capitalize()
        device = dict(zip(flags, flags[1:])).get("--device", "cpu")
        write_tables(given.output, given.tests.parent / "pertev", title, tables, device, None, ["Values that a test prints and bounds."])


if __name__ == "__main__":
    main()
