#!/usr/bin/env python3
"""Simulates a farm that renders a picture in parts: what share of its nodes' time becomes samples, by parts per node, with nodes of
different speed, stragglers, failures, and the costs of each part that --measure takes from the program.

    tools/simulate_farm.py --measure SCENE --size 1920x1080 --program build/bin/pertev -o bench/results/farm_costs.json
    tools/simulate_farm.py --costs bench/results/farm_costs.json --program build/bin/pertev -o bench/results/farm_slicing.json

Nodes take the next part when they are free, as the engines do. A node that fails loses what its part has done since the last checkpoint,
and comes back later. The driver merges parts as they arrive, one after the other, or groups of them are merged on nodes before.
"""

import argparse
import dataclasses
import heapq
import json
import math
import pathlib
import random
import resource
import subprocess
import tempfile

import measurement

PARTS_PER_NODE = (1, 2, 4, 8, 16, 32)
NEVER = math.inf


@dataclasses.dataclass
class Farm:
    nodes: int = 1000
    hours: float = 1.0           # work for each node, if all had the same speed
    spread: float = 0.05         # standard deviation of the logarithm of speeds
    stragglers: float = 0.02     # share of nodes ...
    straggler_speed: float = 0.3  # ... with this speed
    failure_hours: float = 20    # between failures of a node; NEVER: none
    repair_s: float = 300        # until a failed node comes back
    notice_s: float = 30         # until its part is given to another
    checkpoint_s: float = 60     # NEVER: none
    seed: int = 1


@dataclasses.dataclass
class Costs:
    start_s: float = 0  # for each part: process, scene, trees, writing the film file
    merge_s: float = 0  # for each part, at the driver


def speeds_of(farm, source):
    speeds = [math.exp(source.gauss(0, farm.spread)) for _ in range(farm.nodes)]
    for node in source.sample(range(farm.nodes), round(farm.stragglers * farm.nodes)):
        speeds[node] *= farm.straggler_speed
    return speeds


def arrivals(farm, costs, parts, speeds, source):
    """Returns when each part is finished, in order, and how often a part was begun again."""
    work = farm.nodes * farm.hours * 3600 / parts
    rate = 1 / (farm.failure_hours * 3600)
    fails = [source.expovariate(rate) if rate > 0 else NEVER for _ in range(farm.nodes)]
    waiting, left = list(range(parts)), [work] * parts
    events = [(0.0, 0, node) for node in range(farm.nodes)]  # (time, 0, node that is free) or (time, 1, part that is given back)
    idle, finished, again = [], [], 0
    heapq.heapify(events)
    while len(finished) < parts:
        now, is_part, which = heapq.heappop(events)
        if is_part:
            waiting.append(which)
            if idle:
                heapq.heappush(events, (now, 0, idle.pop()))
            continue
        if not waiting:
            idle.append(which)
            continue
        while fails[which] <= now:  # it failed while it was idle
            fails[which] += source.expovariate(rate)
        part = waiting.pop()
        end = now + costs.start_s + left[part] / speeds[which]
        if fails[which] >= end:
            finished.append(end)
            heapq.heappush(events, (end, 0, which))
            continue
        fail, again = fails[which], again + 1
        kept = math.floor(max(fail - now - costs.start_s, 0) / farm.checkpoint_s) * farm.checkpoint_s if farm.checkpoint_s < NEVER else 0
        left[part] -= kept * speeds[which]
        fails[which] = fail + farm.repair_s + source.expovariate(rate)
        heapq.heappush(events, (fail + farm.repair_s, 0, which))
        heapq.heappush(events, (fail + farm.notice_s, 1, part))
    return sorted(finished), again


def merged_at(times, merge_s, group):
    """When the driver has merged all parts; with groups, nodes merge the parts of a group first, which then count as one."""
    if group > 1:
        times = [merged_at(times[i : i + group], merge_s, 1) for i in range(0, len(times), group)]
    now = 0.0
    for arrival in sorted(times):
        now = max(now, arrival) + merge_s
    return now


def simulate(farm, costs, parts_per_node, group=1):
    """Returns the share of the nodes' time that became samples, and how often a part was begun again."""
    source = random.Random(farm.seed)
    speeds = speeds_of(farm, source)
    times, again = arrivals(farm, costs, farm.nodes * parts_per_node, speeds, source)
    return farm.nodes * farm.hours * 3600 / sum(speeds) / merged_at(times, costs.merge_s, group), again


def seconds_of(*command):
    """Processor time of a program with one thread, which other programs hardly change."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure(options):
    """Measures what a part costs one thread of this machine: the line through renders of few and more samples, and merges of two and of eight parts."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        render = [options.program, "render", options.measure, "--size", options.size, "--device", options.device, "--threads", "1", "--exposure", "0", "-q"]
        seconds_of(*render, "--spp", 1, "-o", folder / "warm.pvf")  # trees are in the cache afterwards, as on a node's second part
        few, more = options.spp, 4 * options.spp
        a = min(seconds_of(*render, "--samples", f"0:{few}", "-o", folder / "a.pvf") for _ in range(options.runs))
        b = min(seconds_of(*render, "--samples", f"0:{more}", "-o", folder / "b.pvf") for _ in range(options.runs))
        sample = max(b - a, 1e-6) / (more - few)
        files = []
        for i in range(8):
            files.append(folder / f"{i}.pvf")
            seconds_of(*render, "--spp", 8 * few, "--part", f"{i + 1}/8", "-o", files[-1])
        two, eight = (min(seconds_of(options.program, "merge", *files[:count], "--partial", "-o", folder / "m.exr", "-q") for _ in range(options.runs))
                      for count in (2, 8))
        rows = [["start of a part", "s", round(max(a - few * sample, 0), 3)], ["a sample of each pixel", "s", round(sample, 4)],
                ["merge of a part", "s", round(max(eight - two, 0) / 6, 4)], ["film file of a part", "MB", round(files[0].stat().st_size / 1e6, 2)]]
    measurement.write_measurement(options.output, options.program, f"Costs of a part: {pathlib.Path(options.measure).stem}, {options.size}, {few} spp",
                                  [("cost", "cost", None), ("unit", "unit", None), ("value", "value", None)], rows, options.device, 1)


def costs_of(file):
    rows = {row[0]: row[2] for row in json.loads(pathlib.Path(file).read_text(encoding="utf-8"))["tables"][0]["rows"]}
    return Costs(start_s=rows["start of a part"], merge_s=rows["merge of a part"])


def table(farm, costs):
    """Rows of efficiencies in per cent: like nodes, whose parts cost nothing to merge, something, or are merged in groups before; then
    failures of like nodes, with checkpoints and without; then stragglers; then all of it."""
    alike = dataclasses.replace(farm, spread=0, stragglers=0, failure_hours=NEVER)
    failing = dataclasses.replace(farm, spread=0, stragglers=0)
    unkept = dataclasses.replace(failing, checkpoint_s=NEVER)
    steady = dataclasses.replace(farm, failure_hours=NEVER)
    alone = dataclasses.replace(costs, merge_s=0)
    rows = []
    for parts in PARTS_PER_NODE:
        shares = [simulate(alike, alone, parts)[0], simulate(alike, costs, parts)[0], simulate(alike, costs, parts, group=32)[0],
                  simulate(failing, alone, parts)[0], simulate(unkept, alone, parts)[0], simulate(steady, alone, parts)[0],
                  simulate(farm, costs, parts, group=32)[0]]
        rows.append([parts, *(round(100 * share, 1) for share in shares)])
    return rows


COLUMNS = [("parts", "parts per node", None), ("alike", "like nodes", "%"), ("merged", "merged at the driver", "%"),
           ("grouped", "merged by 32 before", "%"), ("failures", "failures", "%"), ("unkept", "no checkpoints", "%"),
           ("stragglers", "stragglers", "%"), ("all", "all", "%")]


FARM_FLAGS = ("--nodes", "--hours", "--spread", "--stragglers", "--straggler-speed", "--failure-hours", "--repair-s", "--notice-s",
              "--checkpoint-s", "--seed")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", metavar="SCENE")
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--spp", type=int, default=2)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--program", default="build/bin/pertev")
    parser.add_argument("--costs", metavar="FILE")
    fields = {field.name: field for field in dataclasses.fields(Farm)}
    for flag in FARM_FLAGS:
        field = fields[flag.removeprefix("--").replace("-", "_")]
        parser.add_argument(flag, type=field.type, default=field.default)
    parser.add_argument("-o", "--output")
    options = parser.parse_args()
    if options.measure:
        measure(options)
        return
    farm = Farm(**{name: getattr(options, name) for name in fields})
    costs = costs_of(options.costs) if options.costs else Costs()
    rows = table(farm, costs)
    for row in rows:
        print("  ".join(f"{cell:>8}" for cell in row))
    if options.output:
        title = f"{farm.nodes} simulated nodes, {farm.hours:g} h of work each"
        measurement.write_measurement(options.output, options.program, title, COLUMNS, rows, "cpu", 1)


if __name__ == "__main__":
    main()
