#!/usr/bin/env python3
"""`pertev lab`: errors of invalid requests, and equal hits of all combinations."""

import base64
import json
import re
import struct

from cli_lab_run import BOX, CORNERS, FRAME_SETS, INSIDE, SIDES, SMALL, LabTest, lab_report
from cli_run import SANITIZED, limit_addresses, main, write


def gltf_of_nested_boxes():
    """The box as one mesh in two nodes, of which one is three times as large as the other. An animation that moves neither keeps
    both from being baked."""
    indices = [side[k] for side in SIDES for k in (0, 1, 2, 0, 2, 3)]
    data = b"".join(struct.pack("<3f", *corner) for corner in CORNERS) + struct.pack(f"<{len(indices)}H", *indices)
    data += struct.pack("<4f", 0, 0, 0, 0)
    positions, times = 12 * len(CORNERS), len(data) - 16
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "inner"}, {"mesh": 0, "name": "outer", "scale": [3, 3, 3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(CORNERS), "type": "VEC3",
                       "min": [-1, -1, -1], "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": len(indices), "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 1, "type": "SCALAR", "min": [0], "max": [0]},
                      {"bufferView": 2, "byteOffset": 4, "componentType": 5126, "count": 1, "type": "VEC3"}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}} for node in (0, 1)],
                        "samplers": [{"input": 2, "output": 3}]}],
        "bufferViews": [{"buffer": 0, "byteLength": positions},
                        {"buffer": 0, "byteOffset": positions, "byteLength": times - positions},
                        {"buffer": 0, "byteOffset": times, "byteLength": 16}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64,"
                     + base64.b64encode(data).decode()}]})


class WhatIsRefused(LabTest):
    def test_a_bad_flag_or_value_ends_with_2_and_lists_valid_ones(self):
        wanted = {"--structures sah": "binned", "--structures binned,sah": "octree", "--traversals x": "while-while",
                  "--rays x": "diffuse", "--rta x": "both", "--order x": "both", "--tests x": "exact",
                  "--persistent x": "both", "--runs 0": "whole number from 1", "--runs 1.5": "whole number from 1",
                  "--count 0": "whole number from 1", "--threads 0": "whole number from 1", "--device gpu": "cpu",
                  "--foo": "--help"}
        wanted.update({f"--depths {bad}": "1-8" for bad in ["0", "9-3", "1-99", "x", "-3", "1-", "1-2-3", "1.5"]})
        wanted.update({f"--size {bad}": "WIDTHxHEIGHT" for bad in ["0x10", "10", "x", "10x", "-1x10", "10x10x10"]})
        for flag, right in wanted.items():
            with self.subTest(flag=flag):
                self.refuse(2, *self.lab("cornell-box", *flag.split()), says=[flag.split()[0], right])
        for size in ["70000x1", "65536x65536"]:
            self.refuse(3, *self.lab("cornell-box", "--size", size), says=["--size", "limit"])

    def test_lab_refuses_environment_flags(self):
        for flag in ["--environment 1,1,1", "--environment-rotation 90", "--environment-scale 2"]:
            with self.subTest(flag=flag):
                self.refuse(2, *self.lab("cornell-box", *flag.split()), says=[flag.split()[0]])

    def test_lab_refuses_lens_flags(self):
        for flag in ["--aperture 0.1", "--focus 2"]:
            self.refuse(2, *self.lab("cornell-box", *flag.split()), says=[flag.split()[0]])

    def test_an_empty_folder_name_is_refused_before_anything_is_read(self):
        for scene in [["nowhere.obj"], ["--thesis", "nowhere.obj"]]:
            outcome = self.refuse(2, *self.lab(*scene, "-o", ""), says=["-o", "empty"])
            self.assertNotIn("nowhere", outcome.stderr)

    def test_the_error_for_an_unknown_scene_lists_the_known_ones(self):
        for line in [["spnza"], ["--thesis", "spnza"], ["a" * 300]]:
            self.refuse(2, *self.lab(*line), says=[line[-1], "cornell-box", "sponza", "bunny", "forest"])
        # The record's scenes are scenes of --thesis, too, if their files exist.
        self.refuse_unmeasured(2, "--thesis", "sponza", says=["PERTEV_SCENES", "crytek-sponza/sponza.obj"])

    def test_combinations_that_cannot_be_measured_end_with_2_and_the_reasons(self):
        for line, reason in [("--structures octree --traversals while-while", "octree needs the traversal octree"),
                             ("--structures binned --traversals kd", "kd-sah"), ("--structures kd-sah --traversals if-if", "kd"),
                             ("--structures sbvh --traversals octree", "octree"),
                             ("--rta off --order off --tests fast", "fast and woop tests"),
                             ("--structures binned --traversals if-if --tests woop", "while-while and speculative"),
                             ("--structures binned --traversals if-if --rta nodes", "compressed traversal"),
                             ("--structures binned --traversals skip-links --order off", "no order of children")]:
            with self.subTest(line=line):
                self.refuse_unmeasured(2, "box.obj", *INSIDE, *line.split(), "-o", "out", says=["--traversal: ", reason])

    def test_more_rays_than_memory_holds_are_refused_with_the_flag_for_fewer(self):
        if SANITIZED:
            self.skipTest("addresses cannot be limited, and there may be memory")
        # The first two need more memory than most machines have, the third more than its limit here.
        for line, flag, size in [("--rays record --count 1073741824", "--count", "44.0 GiB"),
                                 ("--size 32768x32768", "--size", "44.0 GiB"),
                                 ("--rays record --count 400000000", "--count", "16.4 GiB")]:
            self.refuse(4, *self.lab("cornell-box", *SMALL, *line.split()), preexec_fn=limit_addresses(6),
                        says=[size, flag])

    def test_help_explains_depths(self):
        text = " ".join(self.succeed("lab", "--help").stdout.split())
        self.assertIn("at most 9", text)

    def test_a_scene_is_required_and_must_have_triangles(self):
        self.refuse(2, *self.lab(), says=["SCENE"])
        write(self.path("points.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n")
        write(self.path("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        for name in ["points.obj", "flat.obj"]:
            self.refuse(2, *self.lab(name), says=[name, "triangle"])
        self.refuse(2, *self.lab("nowhere.obj"), says=["nowhere.obj"])

    def test_the_error_for_a_missing_record_scene_names_its_path(self):
        for folder in [None, self.path("nowhere")]:
            environment = dict(self.environment, **({"PERTEV_SCENES": folder} if folder else {}))
            for name, file in [("sponza", "crytek-sponza/sponza.obj"), ("bunny", "record/bunny.ply"), ("forest", "record/forest.ply")]:
                self.refuse_unmeasured(2, name, env=environment, says=["PERTEV_SCENES", file])

    def test_an_output_folder_that_cannot_be_created_ends_with_6_before_any_measurement(self):
        for folder in ["/proc/x", "/proc", "box.obj", "box.obj/x", "a" * 300]:
            with self.subTest(folder=folder):
                self.refuse_unmeasured(6, "cornell-box", *SMALL, "-o", folder, says=[folder])
        self.refuse_unmeasured(6, "--thesis", "box.obj", "-o", "box.obj", says=["box.obj"])

    def test_the_output_folder_is_not_made_for_a_scene_that_cannot_be_read(self):
        write(self.path("points.obj"), "v 0 0 0\n")
        for k, scene in enumerate([["nowhere.obj"], ["points.obj"], ["sponza"], [], ["--thesis", "nowhere.obj"],
                                   ["--thesis", "points.obj"]]):
            with self.subTest(scene=scene):
                self.refuse(2, *self.lab(*scene, "-o", f"out{k}"))

    def test_diffuse_rays_alone_need_a_depth_of_2(self):
        outcome = self.refuse(2, *self.lab("box.obj", *INSIDE, *SMALL, "--rays", "diffuse", "--depths", "1"),
                              says=["diffuse"])
        self.assertRegex(outcome.stderr, r"depth.*\b2\b")
        report = self.report("box.obj", *INSIDE, *SMALL, "--rays", "diffuse", "--depths", "2")
        self.assertEqual([rays["name"] for rays in report["sets"]], ["diffuse1"])

    def test_persistent_threads_are_reported_as_missing_on_a_cpu(self):
        outcome = self.run_pertev(*self.lab("box.obj", *INSIDE, *SMALL, "--persistent", "on"))
        self.assertIn(outcome.status, [0, 2], outcome)
        self.assertRegex(outcome.stderr, "(?i)persistent")
        self.assertRegex(outcome.stderr, "CPU|CUDA")
        self.assertNotRegex(outcome.stdout, r"(?m)^binned (if-if|wide8) .*\d\.\d", "measured as something else")

    def test_the_thesis_refuses_flags_that_choose_combinations_or_rays(self):
        for flag in ["--structures binned", "--traversals packet", "--rta on", "--order off", "--tests fast",
                     "--rays primary", "--rta both", "--no-heat-maps"]:
            with self.subTest(flag=flag):
                self.refuse_unmeasured(2, "--thesis", "box.obj", *flag.split(), says=["--thesis", flag.split()[0]])


class WhatIsMeasured(LabTest):
    def test_a_plain_run_prints_a_table_with_every_structure_and_traversal(self):
        outcome = self.succeed(*self.lab("cornell-box"))
        self.assertNotIn("WRONG", outcome.stdout + outcome.stderr)
        structures, rates = outcome.stdout.split("million rays per second")
        for name in self.names_of("--structures"):
            self.assertRegex(structures, rf"(?m)^{name} +\d+ +\d+ +[\d.e-]+ ")
        for name in self.names_of("--traversals"):
            if name != "brute-force":  # only when named
                self.assertRegex(rates, rf"(?m)^[a-z-]+ {name} (no-)?rta.* \d+\.\d")
        self.assertNotIn("brute-force", rates)

    def test_quiet_prints_nothing(self):
        outcome = self.succeed(*self.lab("cornell-box", *SMALL, "-q"))
        self.assertEqual((outcome.stdout, outcome.stderr), ("", ""))

    def test_json_ends_with_one_report_of_all_structures_and_correct_hits(self):
        events = self.succeed(*self.lab("cornell-box", "--json")).events()
        self.assertEqual([event["event"] for event in events].count("lab"), 1)
        report = lab_report(events[-1])
        self.assertEqual((report["event"], report["scene"], report["triangles"]), ("lab", "cornell-box", 38))
        self.assertEqual((report["width"], report["height"], report["runs"]), (16, 12, 1))
        self.assertEqual([rays["name"] for rays in report["sets"]], FRAME_SETS)
        self.check_hits(report)
        names = [of["name"] for of in report["combinations"]]
        self.assertEqual(sorted(set(names)), sorted(names))
        self.assertGreater(len(names), 100)
        for structure in self.names_of("--structures"):
            self.assertIn(structure, [of["structure"] for of in report["combinations"]])

    def test_rays_and_work_do_not_depend_on_the_number_of_threads(self):
        reports = [self.report("cornell-box", *SMALL, "--threads", threads) for threads in [1, 3]]
        for report in reports:
            self.check_hits(report)
        self.assertEqual(reports[0]["sets"], reports[1]["sets"])
        work = [[(run["nodes_per_ray"], run["triangles_per_ray"]) for of in report["combinations"]
                 for run in of["runs"]] for report in reports]
        self.assertEqual(work[0], work[1])

    def test_in_a_closed_box_every_ray_hits_and_brute_force_tests_every_triangle(self):
        report = self.report("box.obj", *INSIDE, "--structures", "binned", "--traversals", "brute-force,if-if", "--rta",
                             "on")
        self.check_hits(report)
        self.assertEqual([(rays["name"], rays["rays"], rays["hit_share"]) for rays in report["sets"]],
                         [("primary", 192, 1), ("shadow", 192, 0), ("diffuse1", 192, 1), ("diffuse2", 192, 1)])
        brute = next(of for of in report["combinations"] if of["traversal"] == "brute-force")
        self.assertEqual([run["triangles_per_ray"] for run in brute["runs"]], [12] * len(brute["runs"]))

    def test_depths_and_kinds_of_rays_follow_their_flags(self):
        report = self.report("box.obj", *INSIDE, *SMALL, "--depths", "2-4", "--rays", "primary,diffuse")
        self.assertEqual([rays["name"] for rays in report["sets"]], ["primary", "diffuse1", "diffuse2", "diffuse3"])
        for of in report["combinations"]:
            self.assertEqual(len(of["frame_seconds"]), 3)
            self.assertEqual(of["frame_seconds"], sorted(of["frame_seconds"]))
            self.assertGreater(of["frame_seconds"][0], 0)
        report = self.report("box.obj", *INSIDE, *SMALL, "--rays", "primary", "--depths", "1")
        self.assertEqual([rays["name"] for rays in report["sets"]], ["primary"])

    def test_record_rays_are_five_sets_of_the_requested_size(self):
        report = self.report("box.obj", *INSIDE, *SMALL, "--rays", "record", "--count", "500")
        self.check_hits(report)
        self.assertEqual([(rays["name"], rays["rays"], rays["hit_share"]) for rays in report["sets"]],
                         [("primary", 500, 1), ("shadow", 500, 0), ("diffuse1", 500, 1), ("diffuse2", 500, 1),
                          ("diffuse3", 500, 1)])

    def test_every_traversal_runs_in_a_scene_of_shared_meshes(self):
        write(self.path("boxes.gltf"), gltf_of_nested_boxes())
        traversals = self.names_of("--traversals")
        self.assertIn("brute-force", traversals)
        # Between the boxes a ray hits the inner one or else the outer one.
        report = self.report("boxes.gltf", "--eye", "0.3,0.2,2.5", "--target", "0,0,0", "--traversals", ",".join(traversals),
                             "--structures", "binned,sbvh,kd-sah,octree")
        self.assertEqual((report["instances"], report["triangles"]), (2, 12))  # the mesh counts once
        self.check_hits(report, ["brute force has no nodes", "needs "])
        self.assertEqual({rays["name"]: rays["hit_share"] for rays in report["sets"] if not rays["any_hit"]},
                         {"primary": 1, "diffuse1": 1, "diffuse2": 1})
        self.assertEqual({of["traversal"] for of in report["combinations"] if of["runs"]}, set(traversals))

    def test_impossible_combinations_are_listed_with_the_reason(self):
        pair = ["box.obj", *INSIDE, "--structures", "octree,binned", "--traversals", "while-while,kd"]
        printed = self.succeed(*self.lab(*pair)).stdout
        report = self.report(*pair)
        for of in report["combinations"]:
            self.assertEqual(of["runs"] == [], of["refused"] is not None)
            if of["refused"]:
                self.assertIn(of["name"], printed)
                self.assertIn(of["refused"], printed)
        self.assertEqual({of["name"] for of in report["combinations"] if of["runs"]},
                         {"binned while-while rta near", "binned while-while no-rta near"})

    def test_names_of_combinations_are_unique_including_refused_ones(self):
        report = self.report("box.obj", *INSIDE, "--structures", "binned,octree", "--traversals",
                             ",".join(self.names_of("--traversals")), "--order", "both", "--tests", "exact,fast,woop")
        names = [of["name"] for of in report["combinations"]]
        self.assertEqual(sorted(set(names)), sorted(names))
        reasons = {of["name"]: of["refused"] for of in report["combinations"]}
        self.assertIsNone(reasons["binned skip-links rta"])
        self.assertTrue(reasons["binned skip-links rta unordered"])

    def test_sets_without_rays_are_reported(self):
        away = ["--eye", "0,0,9", "--target", "0,0,10"]
        report = self.report("box.obj", *away, *SMALL)
        self.assertEqual([rays["name"] for rays in report["sets"]], ["primary"])
        self.assertEqual([note.split(":")[0] for note in report["notes"]], ["shadow", "diffuse1", "diffuse2"])
        outcome = self.succeed(*self.lab("box.obj", *away, *SMALL, "--rays", "record", "--count", "3"))
        for name in ["shadow", "diffuse1", "diffuse2", "diffuse3"]:
            self.assertIn(f"{name}: ", outcome.stdout)

    def test_every_tree_has_a_cost_and_a_depth_but_an_array_has_neither(self):
        write(self.path("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        report = self.report("one.obj", "--structures", "binned,kd-sah,octree", "--traversals",
                             "brute-force,if-if,skip-links,wide4,kd,octree")
        for structure in report["structures"]:
            known = structure["name"] != "binned triangles"
            self.assertEqual((structure["sah_cost"] is not None, structure["depth"] is not None), (known, known))

    def test_the_camera_of_a_report_gives_the_same_rays_again(self):
        for flags in [[], ["--projection", "orthographic"], ["--up", "1,1,0", "--fov", "33"]]:
            with self.subTest(flags=flags):
                first = self.report("cornell-box", *flags, "--eye", "0.123,1.01,3", "--target", "0.01,0.99,0", *SMALL)
                camera = first["camera"].split()
                again = self.report("cornell-box", *camera, *SMALL)
                self.assertEqual(again["camera"].split()[::2], first["camera"].split()[::2])
                for one, other in zip(first["sets"], again["sets"]):
                    self.assertAlmostEqual(one["hit_share"], other["hit_share"], delta=0.02)

    def test_the_old_name_of_traversals_is_accepted_and_hidden(self):
        report = self.report("box.obj", *INSIDE, "--structures", "binned", "--walks", "if-if")
        self.assertEqual({of["traversal"] for of in report["combinations"]}, {"if-if"})
        shown = self.succeed("lab", "--help", "all").stdout
        self.assertIn("--traversals", shown)
        self.assertNotIn("--walks", shown)

    def test_a_name_given_twice_is_measured_once(self):
        once = self.report("box.obj", *INSIDE, "--structures", "binned,octree", "--traversals", "if-if,octree")
        for twice in [["--structures", "binned,octree,binned", "--traversals", "if-if,octree"],
                      ["--structures", "binned,octree", "--structures", "binned", "--traversals", "if-if,octree"],
                      ["--structures", "binned,octree", "--traversals", "if-if,octree,if-if"]]:
            report = self.report("box.obj", *INSIDE, *twice)
            for key in ["structures", "combinations"]:
                self.assertEqual([of["name"] for of in report[key]], [of["name"] for of in once[key]], twice)


if __name__ == "__main__":
    main()
