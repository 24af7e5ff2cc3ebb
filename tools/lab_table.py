#!/usr/bin/env python3
"""Markdown tables for docs/lab.md out of a report.csv of `pertev lab`: structures down, walks across, Mrays/s of one set.

lab_table.py REPORT.csv SET [--filter walk=... --filter rta=on ...] [--column nodes_per_ray]
"""

import argparse
import csv


def number(text, column):
    if not text:
        return ""
    value = float(text) / 1e6 if column == "rays_per_second" else float(text)
    return f"{value:.2f}" if value < 100 else f"{value:.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("report")
    parser.add_argument("set")
    parser.add_argument("--column", default="rays_per_second")
    parser.add_argument("--filter", action="append", default=[], help="NAME=VALUE of a column; rta=on near_first=1 tests=exact "
                        "distribution=one-a-thread unless given")
    arguments = parser.parse_args()
    wanted = {"rta": "on", "near_first": "1", "tests": "exact", "distribution": "one-a-thread", "set": arguments.set}
    wanted.update(f.split("=", 1) for f in arguments.filter)
    cells, walks = {}, []
    with open(arguments.report, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if any(row[name] != value for name, value in wanted.items()):
                continue
            cells.setdefault(row["structure"], {})[row["walk"]] = number(row[arguments.column], arguments.column)
            if row["walk"] not in walks:
                walks.append(row["walk"])
    print("| structure | " + " | ".join(walks) + " |")
    print("| --- |" + " ---: |" * len(walks))
    for structure, row in cells.items():
        print(f"| {structure} | " + " | ".join(row.get(walk, "") for walk in walks) + " |")


if __name__ == "__main__":
    main()
