#!/usr/bin/env python3
"""tools/simulate_farm.py: farms whose efficiency is known without simulating, and its measurement of costs, at a small size."""

import dataclasses
import json
import pathlib
import subprocess
import sys

from cli_run import PROGRAM, CliTest, main

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
sys.path.insert(0, str(TOOLS))
import make_tables
from simulate_farm import NEVER, Costs, Farm, arrivals, merged_at, simulate, table

ALIKE = Farm(nodes=40, spread=0, stragglers=0, failure_hours=NEVER)
FAILING = dataclasses.replace(ALIKE, failure_hours=3)


class Simulation(CliTest):
    def test_like_nodes_lose_what_their_parts_cost(self):
        self.assertAlmostEqual(simulate(ALIKE, Costs(), 4)[0], 1)
        self.assertAlmostEqual(simulate(ALIKE, Costs(start_s=90), 4)[0], 3600 / (3600 + 4 * 90))

    def test_merging_at_the_driver_waits_for_the_last_part_and_takes_its_time(self):
        self.assertAlmostEqual(merged_at([5, 1, 1], 2, 1), 7)
        self.assertAlmostEqual(merged_at([1] * 8, 1, 1), 9)
        self.assertAlmostEqual(merged_at([1] * 8, 1, 4), 7)  # two groups of four at once, then two
        self.assertAlmostEqual(simulate(ALIKE, Costs(merge_s=10), 1)[0], 3600 / (3600 + 40 * 10))

    def test_a_straggler_holds_the_farm_up_by_its_last_part(self):
        farm = dataclasses.replace(ALIKE, stragglers=1 / 40, straggler_speed=0.5)
        shares = [simulate(farm, Costs(), parts)[0] for parts in (1, 4, 16)]
        self.assertAlmostEqual(shares[0], 3600 / (39.5 / 40) / 7200)
        self.assertLess(shares[0], shares[1])
        self.assertLess(shares[1], shares[2])

    def test_each_part_is_finished_once_and_checkpoints_save_time(self):
        import random
        times, again = arrivals(FAILING, Costs(), 80, [1.0] * 40, random.Random(1))
        self.assertEqual(len(times), 80)
        self.assertGreater(again, 0)
        unkept = dataclasses.replace(FAILING, checkpoint_s=NEVER)
        self.assertLess(simulate(unkept, Costs(), 2)[0], simulate(FAILING, Costs(), 2)[0])
        self.assertLess(simulate(FAILING, Costs(), 2)[0], 1)

    def test_a_seed_gives_one_table(self):
        farm = dataclasses.replace(FAILING, stragglers=0.1, spread=0.05)
        self.assertEqual(table(farm, Costs(1, 0.01)), table(farm, Costs(1, 0.01)))

    def test_costs_are_measured_and_simulated_with(self):
        command = [sys.executable, TOOLS / "simulate_farm.py", "--program", PROGRAM]
        subprocess.run([*command, "--measure", "cornell-box", "--size", "24x16", "--spp", "1", "--runs", "1", "-o", self.path("costs.json")],
                       check=True, env=self.environment, cwd=self.folder)
        subprocess.run([*command, "--costs", self.path("costs.json"), "--nodes", "20", "-o", self.path("slicing.json")], check=True,
                       stdout=subprocess.DEVNULL, cwd=self.folder)
        for name in ("costs.json", "slicing.json"):
            with open(self.path(name), encoding="utf-8") as file:
                measured = json.load(file)
            self.assertEqual([fault for fault in make_tables.faults_of(name, measured) if "names no commit" not in fault], [])
        self.assertEqual([row[0] for row in measured["tables"][0]["rows"]], [1, 2, 4, 8, 16, 32])


if __name__ == "__main__":
    main()
